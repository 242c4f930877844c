//! Random numbers that are the same everywhere.

use rhai::Dynamic;

use super::{int, number};
use crate::{
    noise::mix,
    script::{
        call::Call,
        session::State,
        table::{Entry, Group},
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

    /// In [min, max], where `min <= max`: the high half of a product (Lemire, 2019), whose bias is below
    /// (max - min) / 2^64.
    fn int_between(&mut self, min: i64, max: i64) -> i64 {
        let span = (i128::from(max) - i128::from(min) + 1) as u128;
        let offset = (u128::from(self.next()) * span) >> 64;
        (i128::from(min) + offset as i128) as i64
    }
}

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Random, "random", random)
        .takes(&[
            &[],
            &[number("max", "none", "the numbers are below it")],
            &[
                number("min", "none", "the least number"),
                number("max", "none", "the numbers are below it"),
            ],
        ])
        .returns("float")
        .doc("A random number from 0 (or min) up to but without 1 (or max). The row of numbers depends on seed(n) alone and is the same on every machine.")
        .usage("random(-1, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..60 {\n  diffuse(random(), random(), random());\n  sphere(random(-2.4, 2.4), random(-1.7, 1.7), random(-2, 0), random(0.1, 0.4));\n}")
        .also(&["rand", "rnd", "uniform"]),
    Entry::scene(Group::Random, "randomInt", random_int)
        .takes(&[&[
            int("min", "none", "the least number"),
            int("max", "none", "the greatest number"),
        ]])
        .returns("int")
        .doc("A random whole number from min to max, both included: randomInt(1, 6) throws a die.")
        .usage("randomInt(1, 6)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.55, 0.15);\nfor x in -3..4 {\n  for y in 0..randomInt(1, 5) {\n    group { translate(x * 0.7, y * 0.6 - 1.4, 0); rotate(0, 1, 0, 20); box(0.5, 0.5, 0.5); }\n  }\n}")
        .also(&["randint", "randInt", "irand"]),
];

fn random(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (min, max) = match call.len() {
        0 => return Ok(Dynamic::from(state.random.unit())),
        1 => (0.0, call.number("max")?),
        _ => (call.number("min")?, call.number("max")?),
    };
    call.end()?;
    if !(min < max) {
        return Err(call
            .error(format!(
                "max must be greater than min, but {max} is not greater than {min}"
            ))
            .hint("random() lies in [0, 1), random(max) in [0, max), random(min, max) in [min, max)"));
    }
    Ok(Dynamic::from(state.random.between(min, max)))
}

fn random_int(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (min, max) = (call.int("min")?, call.int("max")?);
    call.end()?;
    if min > max {
        return Err(call.error(format!(
            "max must not be less than min, but {max} is less than {min}"
        )));
    }
    Ok(Dynamic::from(state.random.int_between(min, max)))
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
