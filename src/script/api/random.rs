//! Random numbers that are the same everywhere.

use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use rhai::{Array, Dynamic, FuncRegistration, Module};

use super::{int, number, string};
use crate::{
    host::Host,
    math::{self, DVec3, PI},
    noise::mix,
    script::{
        call::Call,
        session::State,
        steps::PIECE,
        table::{Entry, Group, Kind, Param},
        value::Outcome,
    },
};

/// SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014): the n-th
/// number is a hash of `seed` and n, integer operations only.
#[derive(Clone, Debug)]
pub(crate) struct Stream {
    state: u64,
}

impl Stream {
    pub(crate) fn new(seed: u64) -> Self {
        // Hashed once, so that neighbouring seeds do not give shifted copies of one another's numbers.
        Self { state: mix(seed) }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.state)
    }

    /// In [0, 1): a multiple of 2^-53.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// In [min, max), where `min < max`.
    fn between(&mut self, min: f64, max: f64) -> f64 {
        let u = self.unit();
        // Each end is weighted, so that no difference can overflow; rounding may reach max, which is outside.
        let x = min * (1.0 - u) + max * u;
        if x < max { x.max(min) } else { max.next_down() }
    }

    /// A direction, all alike: its height is even (Archimedes' hat box).
    fn direction(&mut self) -> DVec3 {
        let y = self.between(-1.0, 1.0);
        let angle = 2.0 * PI * self.unit();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * math::cos(angle), y, r * math::sin(angle))
    }

    /// A number of the standard normal distribution (Box and Muller, 1958).
    fn normal(&mut self) -> f64 {
        // 1 - u is not 0.
        let r = (-2.0 * math::ln(1.0 - self.unit())).sqrt();
        r * math::cos(2.0 * PI * self.unit())
    }

    /// In [min, max], where `min <= max`: the high half of a product (Lemire, 2019), whose bias is below
    /// (max - min) / 2^64.
    fn int_between(&mut self, min: i64, max: i64) -> i64 {
        let span = (i128::from(max) - i128::from(min) + 1) as u128;
        let offset = (u128::from(self.next()) * span) >> 64;
        (i128::from(min) + offset as i128) as i64
    }
}

/// A row of random numbers of its own. Copies go on where the others are.
#[derive(Clone, Debug)]
pub(in crate::script) struct StreamValue {
    name: Arc<str>,
    state: Arc<AtomicU64>,
}

impl StreamValue {
    /// The row that `name` has under a seed.
    fn new(seed: u64, name: &str) -> Self {
        let words = name.bytes().map(u64::from).chain([name.len() as u64]);
        let key = words.fold(mix(seed), |key, word| {
            mix(key.wrapping_add(word ^ 0x9e37_79b9_7f4a_7c15))
        });
        Self {
            name: name.into(),
            state: Arc::new(AtomicU64::new(Stream::new(key).state)),
        }
    }
}

impl fmt::Display for StreamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "randomStream({:?})", self.name)
    }
}

/// Draws from the stream that the call names first, or from the script's.
fn draw<T>(
    call: &mut Call<'_, '_>,
    state: &mut State,
    f: impl FnOnce(&mut Call<'_, '_>, &mut Stream) -> Outcome<T>,
) -> Outcome<T> {
    let own = call
        .peek()
        .and_then(|d| d.read_lock::<StreamValue>().map(|stream| stream.clone()));
    let Some(own) = own else {
        return f(call, &mut state.random);
    };
    call.any()?;
    let mut stream = Stream {
        state: own.state.load(Ordering::Relaxed),
    };
    let drawn = f(call, &mut stream);
    own.state.store(stream.state, Ordering::Relaxed);
    drawn
}

/// What is no function of the table.
pub(super) fn extend(module: &mut Module) {
    module.set_custom_type::<StreamValue>("random stream");
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |s: &mut StreamValue| s.to_string());
    }
}

const STREAM: Param = Param::new(
    "stream",
    Kind::Stream,
    "none",
    "from which it is drawn; without it, the script's",
);
const MIN: Param = number("min", "none", "the least number");
const MAX: Param = number("max", "none", "the numbers are below it");
const LEAST: Param = int("min", "none", "the least number");
const MOST: Param = int("max", "none", "the greatest number");
const MEAN: Param = number("mean", "none", "the middle").or("0");
const DEVIATION: Param = number("deviation", "none", "standard deviation, at least 0").or("1");
const LIST: Param = Param::new("list", Kind::Array, "none", "the values");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Random, "random", random)
        .takes(&[&[], &[MAX], &[MIN, MAX], &[STREAM], &[STREAM, MAX], &[STREAM, MIN, MAX]])
        .returns("float")
        .doc("A random number from 0 (or min) up to but without 1 (or max). The row of numbers depends on seed(n) alone and is the same on every machine.")
        .usage("random(-1, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..60 {\n  diffuse(random(), random(), random());\n  sphere(random(-2.4, 2.4), random(-1.7, 1.7), random(-2, 0), random(0.1, 0.4));\n}")
        .also(&["rand", "rnd", "uniform"]),
    Entry::scene(Group::Random, "randomRange", random_range)
        .takes(&[&[MIN, MAX], &[STREAM, MIN, MAX]])
        .returns("float")
        .doc("A random number from min up to but without max: the same as random(min, max).")
        .usage("randomRange(2, 5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.2, 0.6, 0.3);\nfor i in -12..13 {\n  let h = randomRange(0.3, 2.5);\n  group { translate(i * 0.2, h / 2 - 1.3, 0); box(0.15, h, 0.15); }\n}")
        .also(&["rands", "randf"]),
    Entry::scene(Group::Random, "randomInt", random_int)
        .takes(&[&[LEAST, MOST], &[STREAM, LEAST, MOST]])
        .returns("int")
        .doc("A random whole number from min to max, both included: randomInt(1, 6) throws a die.")
        .usage("randomInt(1, 6)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.55, 0.15);\nfor x in -3..4 {\n  for y in 0..randomInt(1, 5) {\n    group { translate(x * 0.7, y * 0.6 - 1.4, 0); rotate(0, 1, 0, 20); box(0.5, 0.5, 0.5); }\n  }\n}")
        .also(&["randint", "randInt", "irand"]),
    Entry::scene(Group::Random, "randomUnit", random_unit)
        .takes(&[&[], &[STREAM]])
        .returns("vec3")
        .doc("A random direction: a vector of length 1, all directions alike.")
        .usage("randomUnit()")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.4, 0.2);\nsphere(0, 0, 0, 1.1);\nfor i in 0..250 {\n  let d = randomUnit();\n  group { between(d, d * 1.5); cone(0.05, 1); }\n}")
        .also(&["random3D", "randomDirection", "random_unit_vector"]),
    Entry::scene(Group::Random, "randomGaussian", random_gaussian)
        .takes(&[&[MEAN, DEVIATION], &[STREAM, MEAN, DEVIATION]])
        .returns("float")
        .doc("A random number of the normal distribution: mostly near the mean, and seldom farther off than twice the deviation.")
        .usage("randomGaussian(0, 0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.25, 0.35, 0.8);\nfor i in 0..500 {\n  sphere(randomGaussian(0, 0.6), randomGaussian(0, 0.4), 0, 0.05);\n}")
        .also(&["randomNormal", "gauss", "normalDistribution"]),
    Entry::scene(Group::Random, "pick", pick)
        .takes(&[&[LIST], &[STREAM, LIST]])
        .returns("any")
        .doc("One of the values of a list, each as likely as the others.")
        .usage("pick([\"#e63946\", \"#f1c453\", \"#1d3557\"])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor x in -6..7 {\n  for y in -4..5 {\n    diffuse(pick([\"#e63946\", \"#f1c453\", \"#1d3557\", \"#a8dadc\"]));\n    group { translate(x * 0.4, y * 0.4, 0); box(0.36, 0.36, 0.36); }\n  }\n}")
        .also(&["choice", "choose", "sample", "randomElement"]),
    Entry::scene(Group::Random, "shuffle", shuffle)
        .takes(&[&[LIST], &[STREAM, LIST]])
        .returns("array")
        .doc("The values of a list in a random order, every order as likely as the others. The list itself stays as it is.")
        .usage("shuffle([1, 2, 3])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet heights = shuffle(linspace(0.2, 2.6, 13));\nfor i in 0..13 {\n  let h = heights[i];\n  diffuse(hsv(h * 120, 0.6, 0.9));\n  group { translate(i * 0.35 - 2.1, h / 2 - 1.3, 0); box(0.3, h, 0.3); }\n}")
        .also(&["permute", "randomOrder"]),
    Entry::scene(Group::Random, "randomStream", random_stream)
        .takes(&[&[string("name", "what the numbers are for")]])
        .returns("random stream")
        .doc("Random numbers of their own, by name: let r = randomStream(\"trees\"); r.random(0, 1), r.randomInt(1, 6) and so on. They depend on seed(n) and the name alone, so what is drawn elsewhere changes nothing about the trees.")
        .usage("randomStream(\"trees\")")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet trees = randomStream(\"trees\");\nlet stones = randomStream(\"stones\");\nfor i in 0..20 {\n  diffuse(0.15, trees.random(0.3, 0.6), 0.2);\n  group { translate(trees.random(-2.4, 2.4), -0.4, 0); cone(0.25, 1.2); }\n}\ndiffuse(0.5, 0.5, 0.5);\nfor i in 0..20 { sphere(stones.random(-2.4, 2.4), -1, 0.5, stones.random(0.05, 0.15)); }")
        .also(&["seedStream", "rng", "Random", "RandomState"]),
];

fn random(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        let (min, max) = match call.rest() {
            0 => return Ok(Dynamic::from(stream.unit())),
            1 => (0.0, call.number("max")?),
            _ => (call.number("min")?, call.number("max")?),
        };
        call.end()?;
        between(call, stream, min, max)
    })
}

fn random_range(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        let (min, max) = (call.number("min")?, call.number("max")?);
        call.end()?;
        between(call, stream, min, max)
    })
}

fn between(call: &Call<'_, '_>, stream: &mut Stream, min: f64, max: f64) -> Outcome {
    if !(min < max) {
        return Err(call
            .error(format!(
                "max must be greater than min, but {max} is not greater than {min}"
            ))
            .hint("random() lies in [0, 1), random(max) in [0, max), random(min, max) in [min, max)"));
    }
    Ok(Dynamic::from(stream.between(min, max)))
}

fn random_int(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        let (min, max) = (call.int("min")?, call.int("max")?);
        call.end()?;
        if min > max {
            return Err(call.error(format!(
                "max must not be less than min, but {max} is less than {min}"
            )));
        }
        Ok(Dynamic::from(stream.int_between(min, max)))
    })
}

fn random_unit(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        call.end()?;
        Ok(Dynamic::from(stream.direction()))
    })
}

fn random_gaussian(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        let mean = if call.rest() > 0 {
            call.number("mean")?
        } else {
            0.0
        };
        let deviation = if call.rest() > 0 {
            call.number("deviation")?
        } else {
            1.0
        };
        call.end()?;
        if !(deviation >= 0.0) {
            return Err(call.error(format!("deviation must not be negative, and {deviation} is")));
        }
        Ok(Dynamic::from(mean + deviation * stream.normal()))
    })
}

fn pick(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    draw(call, state, |call, stream| {
        let d = call.any()?;
        call.end()?;
        let list = d.read_lock::<Array>();
        let list = list.ok_or_else(|| call.wrong_kind("list", "an array", d))?;
        let i = stream.int_between(0, (list.len() as i64 - 1).max(0));
        let picked = list.get(i as usize).cloned();
        picked.ok_or_else(|| call.error("there is nothing to pick from: list is empty"))
    })
}

/// Fisher and Yates, as Durstenfeld wrote it (Algorithm 235, CACM 1964).
fn shuffle(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let host = state.timed_host();
    let mut stopped = false;
    let shuffled = draw(call, state, |call, stream| {
        let d = call.any()?;
        call.end()?;
        let list = d.read_lock::<Array>().map(|list| list.clone());
        let mut list = list.ok_or_else(|| call.wrong_kind("list", "an array", d))?;
        for i in (1..list.len()).rev() {
            let j = stream.int_between(0, i as i64);
            list.swap(i, j as usize);
            if i % PIECE == 0 && host.should_stop() {
                stopped = true;
                break;
            }
        }
        Ok(Dynamic::from(list))
    });
    if stopped {
        return Err(state.stopped());
    }
    shuffled
}

fn random_stream(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    call.end()?;
    let seed = state.builder.settings().seed;
    Ok(Dynamic::from(StreamValue::new(seed, &name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_fixed_for_ever() {
        let mut stream = Stream::new(0);
        assert_eq!(
            [stream.next(), stream.next()],
            [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4],
            "the published first numbers of SplitMix64 with state 0"
        );
        assert_ne!(Stream::new(1).next(), Stream::new(2).next());
    }

    #[test]
    fn streams_differ_by_name_and_seed_and_copies_go_on_together() {
        let first = |seed, name| StreamValue::new(seed, name).state.load(Ordering::Relaxed);
        let firsts = [
            first(0, "a"),
            first(0, "b"),
            first(1, "a"),
            first(0, ""),
            first(0, "ab"),
        ];
        for (i, a) in firsts.iter().enumerate() {
            assert!(firsts.iter().skip(i + 1).all(|b| a != b), "{i}");
        }
        let stream = StreamValue::new(0, "a");
        let copy = stream.clone();
        copy.state.store(7, Ordering::Relaxed);
        assert_eq!(stream.state.load(Ordering::Relaxed), 7);
    }

    #[test]
    fn directions_are_even_and_gaussians_have_their_moments() {
        let mut stream = Stream::new(11);
        let n = 20_000;
        let mut mean = DVec3::ZERO;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let d = stream.direction();
            assert!((d.length() - 1.0).abs() < 1e-12);
            mean += d / f64::from(n);
            let x = stream.normal();
            sum += x;
            squares += x * x;
        }
        assert!(mean.length() < 0.02, "{mean}");
        let n = f64::from(n);
        assert!(
            (sum / n).abs() < 0.03 && (squares / n - 1.0).abs() < 0.04,
            "{sum} {squares}"
        );
    }

    #[test]
    fn ranges_hold_their_ends() {
        let mut stream = Stream::new(3);
        let throws: Vec<i64> = (0..600).map(|_| stream.int_between(1, 6)).collect();
        for face in 1..=6 {
            assert!(
                (60..140).contains(&throws.iter().filter(|t| **t == face).count()),
                "{face}"
            );
        }
        assert!(throws.iter().all(|t| (1..=6).contains(t)));
        for _ in 0..100 {
            let x = stream.between(1.0, 1.0f64.next_up());
            assert_eq!(x, 1.0);
            assert!(stream.between(-f64::MAX, f64::MAX).is_finite());
            let _ = stream.int_between(i64::MIN, i64::MAX);
        }
        assert_eq!(stream.int_between(i64::MAX, i64::MAX), i64::MAX);
    }
}
