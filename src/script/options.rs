//! Options of a function: the values of a map by name, each checked where it is taken.

use rhai::{Dynamic, Map};

use super::{
    call::{Call, quoted},
    value::Outcome,
};

/// A map of options whose keys are known.
pub(super) struct Options<'c, 'a, 'd> {
    call: &'c Call<'a, 'd>,
    map: Map,
}

impl<'c, 'a, 'd> Options<'c, 'a, 'd> {
    /// The options `given`, or none.
    ///
    /// # Errors
    /// Where it is no map, or a key is not among `known`.
    pub(super) fn new(call: &'c Call<'a, 'd>, given: Option<&Dynamic>, known: &[&str]) -> Outcome<Self> {
        let map = match given {
            None => Map::new(),
            Some(given) => given
                .read_lock::<Map>()
                .map(|map| map.clone())
                .ok_or_else(|| call.wrong_kind("options", "a map", given))?,
        };
        call.known_keys(&map, known)?;
        Ok(Self { call, map })
    }

    /// A value as it is; `()` counts as none.
    pub(super) fn get(&self, key: &str) -> Option<&Dynamic> {
        self.map.get(key).filter(|d| !d.is_unit())
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str) -> Outcome<Option<f64>> {
        self.get(key).map(|d| self.call.number_from(key, d)).transpose()
    }

    /// A finite number greater than 0.
    pub(super) fn positive(&self, key: &str) -> Outcome<Option<f64>> {
        match self.number(key)? {
            Some(x) if x <= 0.0 => Err(self.call.error(format!("{key} must be greater than 0, not {x}"))),
            other => Ok(other),
        }
    }

    /// A whole number from `least` to `most`.
    pub(super) fn count(&self, key: &str, least: usize, most: usize) -> Outcome<Option<usize>> {
        let Some(d) = self.get(key) else {
            return Ok(None);
        };
        let x = self.call.number_from(key, d)?;
        if x.trunc() != x || !(x >= least as f64 && x <= most as f64) {
            return Err(self.call.error(format!(
                "{key} must be a whole number from {least} to {most}, not {x}"
            )));
        }
        Ok(Some(x as usize))
    }

    /// True or false.
    pub(super) fn flag(&self, key: &str, default: bool) -> Outcome<bool> {
        match self.get(key) {
            None => Ok(default),
            Some(d) => d
                .as_bool()
                .map_err(|_| self.call.wrong_kind(key, "true or false", d)),
        }
    }

    /// A string.
    pub(super) fn text(&self, key: &str) -> Outcome<Option<String>> {
        let Some(d) = self.get(key) else {
            return Ok(None);
        };
        let text = d.clone().into_immutable_string();
        text.map(|text| Some(text.to_string()))
            .map_err(|_| self.call.wrong_kind(key, "a string", d))
    }

    /// One of a few words, with what it stands for.
    pub(super) fn choice<T: Copy>(&self, key: &str, choices: &[(&str, T)], default: T) -> Outcome<T> {
        let Some(text) = self.text(key)? else {
            return Ok(default);
        };
        let found = choices.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
            self.call.error(format!(
                "{key} must be {}, not {}",
                names.join(" or "),
                quoted(&text)
            ))
        })
    }
}
