//! Lists of values.

use rhai::{Array, Dynamic, DynamicReadLock};

use super::{int, number};
use crate::{
    math::DVec3,
    script::{
        call::{Call, number_of},
        session::{State, limit},
        steps::Work,
        table::{Entry, Group, Kind, Param},
        value::Outcome,
    },
};

const LIST: Param = Param::new("list", Kind::Array, "none", "the values");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lists, "linspace", linspace)
        .takes(&[&[
            number("first", "none", "the first number"),
            number("last", "none", "the last number, which is one of them"),
            int("n", "none", "how many, at least 2"),
        ]])
        .returns("array")
        .doc("Numbers evenly apart, both ends included.")
        .usage("linspace(0, 1, 5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nfor x in linspace(-2, 2, 9) { sphere(x, 0, 0, 0.2); }\nprint(linspace(0, 1, 5));")
        .also(&["steps", "arange", "range", "seq"]),
    Entry::scene(Group::Lists, "zip", zip)
        .takes(&[&[
            Param::new("a", Kind::Array, "none", "the first of each pair"),
            Param::new("b", Kind::Array, "none", "the second of each pair"),
        ]])
        .returns("array")
        .doc("Pairs of the values of two lists, as many as the shorter has.")
        .usage("zip([1, 2], [\"one\", \"two\"])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor pair in zip(linspace(-1.8, 1.8, 4), [\"#e63946\", \"#f1c453\", \"#2a9d8f\", \"#1d3557\"]) {\n  diffuse(pair[1]);\n  sphere(pair[0], 0, 0, 0.5);\n}")
        .also(&["pairs", "enumerate"]),
    Entry::scene(Group::Lists, "flatten", flatten)
        .takes(&[&[LIST]])
        .returns("array")
        .doc("The values of the lists in a list, in one list: flatten([[1, 2], [3], 4]) is [1, 2, 3, 4].")
        .usage("flatten([[1, 2], [3]])")
        .example("print(flatten([[1, 2], [3], 4]));")
        .also(&["concat", "chain"]),
    Entry::pure(Group::Lists, "sum", sum)
        .takes(&[&[LIST]])
        .returns("int | float | vec3")
        .doc("The sum of a list of numbers or of vectors, from the first to the last; 0 of nothing.")
        .usage("sum([1, 2, 3.5])")
        .example("print(sum([1, 2, 3.5]));\nprint(sum([vec3(1, 0, 0), vec3(0, 1, 0)]) / 2);")
        .also(&["total", "average", "mean"]),
];

/// Refuses a list of `n` values where that is more than a list may have.
fn room(state: &State, n: usize) -> Outcome<()> {
    let most = state.limits.array_len;
    if n > most {
        return Err(limit(
            &format!("a list of {n} values is too long"),
            "array_len",
            most,
        ));
    }
    Ok(())
}

/// The next argument, an array, without a copy of it.
fn array<'c>(call: &mut Call<'c, '_>, name: &str) -> Outcome<DynamicReadLock<'c, Array>> {
    let d = call.any()?;
    d.read_lock::<Array>()
        .ok_or_else(|| call.wrong_kind(name, "an array", d))
}

fn linspace(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (first, last) = (call.number("first")?, call.number("last")?);
    let n = call.count("n", 2)?;
    call.end()?;
    room(state, n as usize)?;
    let end = f64::from(n - 1);
    let at = |i: u32| {
        let t = f64::from(i) / end;
        Dynamic::from(first * (1.0 - t) + last * t)
    };
    Ok(Dynamic::from((0..n).map(at).collect::<Array>()))
}

fn zip(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (a, b) = (array(call, "a")?, array(call, "b")?);
    call.end()?;
    room(state, a.len().min(b.len()).saturating_mul(3))?;
    let mut work = Work::new();
    let mut pairs = Array::with_capacity(a.len().min(b.len()));
    for (a, b) in a.iter().zip(b.iter()) {
        work.done_in(state, 8)?;
        pairs.push(Dynamic::from(Array::from([a.clone(), b.clone()])));
    }
    Ok(Dynamic::from(pairs))
}

fn flatten(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let list = array(call, "list")?;
    call.end()?;
    let mut flat = Array::new();
    let mut work = Work::new();
    for item in list.iter() {
        match item.read_lock::<Array>() {
            Some(inner) => {
                room(state, flat.len().saturating_add(inner.len()))?;
                for item in inner.iter() {
                    work.done_in(state, 4)?;
                    flat.push(item.clone());
                }
            }
            None => {
                room(state, flat.len() + 1)?;
                work.done_in(state, 4)?;
                flat.push(item.clone());
            }
        }
    }
    Ok(Dynamic::from(flat))
}

fn sum(call: &mut Call<'_, '_>) -> Outcome {
    let d = call.any()?;
    call.end()?;
    let Some(list) = d.read_lock::<Array>() else {
        return Err(call.wrong_kind("list", "an array", d));
    };
    if list.iter().all(Dynamic::is_int) {
        let whole = list
            .iter()
            .try_fold(0i64, |sum, d| sum.checked_add(d.as_int().ok()?));
        return match whole {
            Some(sum) => Ok(Dynamic::from(sum)),
            None => Err(call.error("the sum is beyond what an int can hold")),
        };
    }
    if let Some(numbers) = list.iter().map(number_of).collect::<Option<Vec<f64>>>() {
        return Ok(Dynamic::from(numbers.into_iter().fold(0.0, |sum, x| sum + x)));
    }
    let mut total = DVec3::ZERO;
    for (i, item) in list.iter().enumerate() {
        total += call.vec3_from(&format!("list[{i}]"), item)?;
    }
    Ok(Dynamic::from(total))
}
