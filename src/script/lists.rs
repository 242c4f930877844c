//! Lists of tuples of numbers: nested arrays, one flat array, or a blob of floats as `write_le` writes them.

use rhai::{Array, Blob, Dynamic};

use super::{
    call::{Call, kind_of, number_of},
    value::Outcome,
};
use crate::math::DVec3;

/// Bytes of a float in a blob: Rhai's floats are of 64 bits.
const FLOAT_BYTES: usize = 8;

/// The tuples of the list `d`, of `N` finite numbers each. `nested` reads what an array of no numbers holds; it is
/// given the entry's name for messages.
///
/// # Errors
/// With the first entry that is wrong.
pub(super) fn tuples_with<const N: usize>(
    call: &Call<'_, '_>,
    name: &str,
    d: &Dynamic,
    nested: impl Fn(&dyn Fn() -> String, &Dynamic) -> Outcome<[f64; N]>,
) -> Outcome<Vec<[f64; N]>> {
    if let Some(blob) = d.read_lock::<Blob>() {
        return of_blob(call, name, &blob);
    }
    let Some(array) = d.read_lock::<Array>() else {
        return Err(call.wrong_kind(name, "an array or a blob", d));
    };
    let items = array.iter().enumerate();
    if array.first().and_then(number_of).is_none() {
        return items
            .map(|(i, d)| nested(&|| format!("{name}[{i}]"), d))
            .collect();
    }
    let numbers: Outcome<Vec<f64>> = items
        .map(|(i, d)| number(call, || format!("{name}[{i}]"), d))
        .collect();
    in_tuples(call, name, &numbers?)
}

/// As [`tuples_with`], the nested entries being arrays of `N` numbers.
///
/// # Errors
/// With the first entry that is wrong.
pub(super) fn tuples<const N: usize>(call: &Call<'_, '_>, name: &str, d: &Dynamic) -> Outcome<Vec<[f64; N]>> {
    tuples_with(call, name, d, |name, d| tuple(call, name, d))
}

fn in_tuples<const N: usize>(call: &Call<'_, '_>, name: &str, numbers: &[f64]) -> Outcome<Vec<[f64; N]>> {
    let (tuples, rest) = numbers.as_chunks::<N>();
    if !rest.is_empty() {
        return Err(call.error(format!(
            "{name} has {} numbers, which do not come in {N}s",
            numbers.len()
        )));
    }
    Ok(tuples.to_vec())
}

fn of_blob<const N: usize>(call: &Call<'_, '_>, name: &str, blob: &[u8]) -> Outcome<Vec<[f64; N]>> {
    let (floats, rest) = blob.as_chunks::<FLOAT_BYTES>();
    if !rest.is_empty() {
        return Err(call
            .error(format!(
                "{name} is a blob of {} bytes, but every number takes {FLOAT_BYTES}",
                blob.len()
            ))
            .hint("blob.write_le(8 * i, 8, x) writes the float x as number i"));
    }
    let numbers: Outcome<Vec<f64>> = floats
        .iter()
        .enumerate()
        .map(|(i, bytes)| call.finite_number(|| format!("{name}, number {i}"), f64::from_le_bytes(*bytes)))
        .collect();
    in_tuples(call, name, &numbers?)
}

/// `N` numbers in an array; a `vec3` stands for three, or for its first two.
///
/// # Errors
/// With the number that is wrong, after `name`.
pub(super) fn tuple<const N: usize>(
    call: &Call<'_, '_>,
    name: &dyn Fn() -> String,
    d: &Dynamic,
) -> Outcome<[f64; N]> {
    let mut to = [0.0; N];
    if let Some(v) = d.read_lock::<DVec3>().filter(|_| N <= 3) {
        // A vec3 stands for a point, or for a uv of which the third component is of no use.
        to.iter_mut().zip(v.to_array()).for_each(|(to, x)| *to = x);
        return Ok(to);
    }
    let Some(array) = d.read_lock::<Array>() else {
        return Err(call.error(format!("{} must be {N} numbers, not {}", name(), kind_of(d))));
    };
    if array.len() != N {
        return Err(call.error(format!("{} must be {N} numbers, not {}", name(), array.len())));
    }
    for (i, (to, d)) in to.iter_mut().zip(array.iter()).enumerate() {
        *to = number(call, || format!("{}[{i}]", name()), d)?;
    }
    Ok(to)
}

/// A finite number; `name` is only asked for where it is none.
///
/// # Errors
/// With `name` and what it is instead.
pub(super) fn number(call: &Call<'_, '_>, name: impl FnOnce() -> String, d: &Dynamic) -> Outcome<f64> {
    match number_of(d) {
        Some(x) if x.is_finite() => Ok(x),
        _ => call.number_from(&name(), d),
    }
}
