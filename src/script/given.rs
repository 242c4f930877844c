//! Numbers of a message as the script gave them.

use rhai::{Array, Dynamic, Map};

use super::call::number_of;
use crate::scene::Told;

/// Values among the arguments of a call that failed, within each other too, in which numbers are looked for.
const MOST_LOOKED_AT: usize = 1000;

/// From here on a float does not tell whole numbers apart.
const FIRST_ROUNDED: f64 = 9_007_199_254_740_992.0;

/// A number whose text as a float is another one, or a very long one, as a script has it.
pub(super) fn exact(d: &Dynamic) -> Option<String> {
    let x = number_of(d).filter(|x| x.is_finite() && x.abs() >= FIRST_ROUNDED)?;
    Some(d.as_int().map_or_else(|_| format!("{x:e}"), |i| i.to_string()))
}

/// Notes such numbers of a call's arguments.
#[cold]
pub(super) fn note_rounded(told: &Told, arguments: &[&mut Dynamic]) {
    let mut left = MOST_LOOKED_AT;
    for argument in arguments {
        note_within(told, argument, &mut left);
    }
}

fn note_within(told: &Told, d: &Dynamic, left: &mut usize) {
    let Some(fewer) = left.checked_sub(1) else {
        return;
    };
    *left = fewer;
    if let Some(array) = d.read_lock::<Array>() {
        array
            .iter()
            .take(fewer)
            .for_each(|item| note_within(told, item, left));
    } else if let Some(map) = d.read_lock::<Map>() {
        map.values()
            .take(fewer)
            .for_each(|value| note_within(told, value, left));
    } else if let (Some(as_float), Some(given)) = (number_of(d), exact(d)) {
        told.note(as_float, given);
    }
}
