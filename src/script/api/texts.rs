//! Arrays and maps as text, no longer than a string may be. Rhai's own functions write all of it first and look at the limit
//! later: ten thousand times the same long string are gigabytes.

use std::{any::TypeId, fmt::Write};

use rhai::{Array, Dynamic, EvalAltResult, Map, Module, NativeCallContext, Position};

use crate::script::{
    engine::{Purity, register},
    steps,
};

/// The names by which Rhai turns an array or a map into text, itself or for `+`, interpolation and `print`.
const NAMES: [&str; 4] = ["print", "to_string", "debug", "to_debug"];

/// A text that is being written; beyond the limit nothing is added, and the run ends.
struct Writing<'a, 'c> {
    ctx: &'a NativeCallContext<'c>,
    text: String,
    most: usize,
    is_full: bool,
}

impl<'a, 'c> Writing<'a, 'c> {
    fn new(ctx: &'a NativeCallContext<'c>) -> Self {
        let most = match ctx.engine().max_string_size() {
            0 => usize::MAX,
            most => most,
        };
        Self {
            ctx,
            text: String::new(),
            most,
            is_full: false,
        }
    }

    /// Whether there was room.
    fn add(&mut self, text: &str) -> bool {
        if self.text.len().saturating_add(text.len()) > self.most {
            self.is_full = true;
            return false;
        }
        self.text.push_str(text);
        true
    }

    fn add_value(&mut self, value: &mut Dynamic) -> bool {
        if let Ok(text) = value.as_immutable_string_ref()
            && text.len() > self.most - self.text.len()
        {
            self.is_full = true;
            return false;
        }
        let name = self.ctx.engine().map_type_name(value.type_name()).to_owned();
        let shown = self.ctx.call_native_fn_raw("to_debug", true, &mut [value]);
        match shown.map(Dynamic::into_immutable_string) {
            Ok(Ok(text)) => self.add(&text),
            _ => self.add(&name),
        }
    }

    /// Whoever asked for the text may pass over an error, as Rhai's interpolation does, and write all of it after all; so
    /// there is a text, and the run ends at its next step. For the same reason the value goes: Rhai measures it behind
    /// this call.
    fn finish(self, args: &mut [&mut Dynamic]) -> Dynamic {
        if self.is_full {
            steps::end_by_string(self.most, self.ctx.call_position());
            if let [value] = args {
                **value = Dynamic::UNIT;
            }
        }
        self.text.into()
    }
}

fn array(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let mut writing = Writing::new(ctx);
    if let [array] = &mut *args
        && let Some(mut array) = array.write_lock::<Array>()
    {
        let mut goes_on = writing.add("[");
        for (i, item) in array.iter_mut().enumerate() {
            goes_on = goes_on && (i == 0 || writing.add(", ")) && writing.add_value(item);
            if !goes_on {
                break;
            }
        }
        let _ = goes_on && writing.add("]");
    }
    Ok(writing.finish(args))
}

fn map(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let mut writing = Writing::new(ctx);
    if let [map] = &mut *args
        && let Some(mut map) = map.write_lock::<Map>()
    {
        let mut goes_on = writing.add("#{");
        for (i, (key, value)) in map.iter_mut().enumerate() {
            let mut key_text = String::new();
            let _ = write!(key_text, "{key:?}: ");
            goes_on = goes_on
                && (i == 0 || writing.add(", "))
                && writing.add(&key_text)
                && writing.add_value(value);
            if !goes_on {
                break;
            }
        }
        let _ = goes_on && writing.add("}");
    }
    Ok(writing.finish(args))
}

/// Bytes that a value takes as text at least; counting ends beyond `most`.
fn at_least(value: &Dynamic, most: usize) -> usize {
    if let Ok(text) = value.as_immutable_string_ref() {
        return text.len();
    }
    let mut sum = 2usize;
    let mut add = |value: &Dynamic| {
        if sum <= most {
            sum = sum.saturating_add(at_least(value, most - sum));
        }
    };
    if let Some(array) = value.read_lock::<Array>() {
        array.iter().for_each(&mut add);
    } else if let Some(map) = value.read_lock::<Map>() {
        map.values().for_each(&mut add);
    }
    sum
}

fn to_json(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let most = ctx.engine().max_string_size();
    let [map] = args else {
        return Ok(Dynamic::UNIT);
    };
    if most > 0 && at_least(map, most) > most {
        return Err(Box::new(EvalAltResult::ErrorDataTooLarge(
            "Length of string".to_owned(),
            Position::NONE,
        )));
    }
    let text = map.read_lock::<Map>().map(|map| rhai::format_map_as_json(&map));
    Ok(text.unwrap_or_default().into())
}

pub(super) fn extend(module: &mut Module) {
    for name in NAMES {
        register(module, name, &[TypeId::of::<Array>()], Purity::Pure, array);
        register(module, name, &[TypeId::of::<Map>()], Purity::Pure, map);
    }
    register(module, "to_json", &[TypeId::of::<Map>()], Purity::Pure, to_json);
}
