//! What scripts say of dispersion: an Abbe number, the name of a glass, or the numbers of a formula.

use rhai::{Array, Dynamic, Map};

use super::{finishes, patterns};
use crate::{
    scene::Dispersion,
    script::{call::Call, session::State, value::Outcome},
};

/// The arguments of `dispersion(...)`.
pub(super) fn arguments(call: &mut Call<'_, '_>, state: &mut State) -> Outcome<Dispersion> {
    let given = call.any()?;
    if call.rest() == 0 {
        return match given.read_lock::<Array>() {
            Some(pairs) => sellmeier(call, &pairs),
            None => value(call, state, "abbe", given),
        };
    }
    let a = call.number_from("a", given)?;
    let b = call.number("b")?;
    let c = if call.rest() > 0 { call.number("c")? } else { 0.0 };
    Ok(Dispersion::Cauchy { a, b, c })
}

/// The value of the key `dispersion`.
pub(super) fn value(
    call: &Call<'_, '_>,
    state: &mut State,
    name: &str,
    given: &Dynamic,
) -> Outcome<Dispersion> {
    if given.is_string() {
        let glass = given.clone().into_immutable_string().unwrap_or_default();
        if let Some((_, known)) = Dispersion::GLASSES.iter().find(|(known, _)| *known == glass) {
            return Ok(*known);
        }
        let names: Vec<&str> = Dispersion::GLASSES.iter().map(|(known, _)| *known).collect();
        return Err(patterns::choice_error(call, "glass", &glass, &names));
    }
    let Some(map) = given.read_lock::<Map>() else {
        return finishes::amount_from(call, state, name, given).map(Dispersion::Abbe);
    };
    call.known_keys(&map, &["cauchy", "sellmeier"])?;
    let list = |key: &str| -> Outcome<Option<Array>> {
        let Some(given) = map.get(key) else {
            return Ok(None);
        };
        let list = given.read_lock::<Array>().map(|list| list.clone());
        list.map(Some)
            .ok_or_else(|| call.wrong_kind(key, "an array", given))
    };
    match (list("cauchy")?, list("sellmeier")?) {
        (Some(numbers), None) => cauchy(call, &numbers),
        (None, Some(pairs)) => sellmeier(call, &pairs),
        _ => Err(call.error(format!("{name} takes either cauchy or sellmeier"))),
    }
}

fn cauchy(call: &Call<'_, '_>, numbers: &[Dynamic]) -> Outcome<Dispersion> {
    let (a, b, c) = match numbers {
        [a, b] => (a, b, None),
        [a, b, c] => (a, b, Some(c)),
        _ => {
            return Err(call.error(format!(
                "cauchy must be 2 or 3 numbers, not an array of {}",
                numbers.len()
            )));
        }
    };
    Ok(Dispersion::Cauchy {
        a: call.number_from("cauchy", a)?,
        b: call.number_from("cauchy", b)?,
        c: c.map_or(Ok(0.0), |c| call.number_from("cauchy", c))?,
    })
}

fn sellmeier(call: &Call<'_, '_>, pairs: &[Dynamic]) -> Outcome<Dispersion> {
    let mut known = [[0.0; 2]; 4];
    if pairs.is_empty() || pairs.len() > known.len() {
        return Err(call
            .error(format!("sellmeier must be 1 to 4 pairs, not {}", pairs.len()))
            .hint("of a catalog with B1, B2, B3 and C1, C2, C3 these are [[B1, C1], [B2, C2], [B3, C3]]"));
    }
    for (pair, known) in pairs.iter().zip(&mut known) {
        let numbers = pair.read_lock::<Array>();
        let Some([b, c]) = numbers.as_deref().map(Vec::as_slice) else {
            return Err(call.wrong_kind("a pair of sellmeier", "an array of 2 numbers", pair));
        };
        *known = [
            call.number_from("sellmeier", b)?,
            call.number_from("sellmeier", c)?,
        ];
    }
    Ok(Dispersion::Sellmeier(known))
}

/// What `material()` returns of it.
pub(super) fn as_value(state: &State, dispersion: &Dispersion) -> Dynamic {
    let entry = |key: &str, list: Array| {
        let map: Map = [(key.into(), Dynamic::from_array(list))].into();
        Dynamic::from_map(map)
    };
    match dispersion {
        Dispersion::Abbe(abbe) => finishes::amount_value(state, *abbe),
        Dispersion::Cauchy { a, b, c } => entry("cauchy", [*a, *b, *c].map(Dynamic::from).into()),
        Dispersion::Sellmeier(pairs) => {
            let pairs = pairs.map(|pair| Dynamic::from_array(pair.map(Dynamic::from).into()));
            entry("sellmeier", pairs.into())
        }
    }
}
