//! Arrays, maps and blobs as text, no longer than a string may be. Rhai's own functions write all of it first and look at
//! the limit later: ten thousand times the same long string are gigabytes.

use std::{any::TypeId, fmt::Write};

use rhai::{Array, Blob, Dynamic, EvalAltResult, ImmutableString, Map, Module, NativeCallContext, Position};

use crate::script::{
    engine::{Purity, register},
    steps,
};

/// The names by which Rhai turns such a value into text, itself or for `+`, interpolation and `print`.
const NAMES: [&str; 4] = ["print", "to_string", "debug", "to_debug"];

/// A text that is being written; beyond the limit nothing is added, and the run ends.
struct Writing<'a, 'c> {
    ctx: &'a NativeCallContext<'c>,
    text: String,
    most: usize,
    is_full: bool,
    /// The run has ended, so that no value gives its text any more.
    is_over: bool,
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
            is_over: false,
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
            Err(_) if steps::ended().is_err() => {
                self.is_over = true;
                false
            }
            _ => self.add(&name),
        }
    }

    fn add_array(&mut self, array: &mut Array) -> bool {
        let mut goes_on = self.add("[");
        for (i, item) in array.iter_mut().enumerate() {
            goes_on = goes_on && (i == 0 || self.add(", ")) && self.add_value(item);
            if !goes_on {
                break;
            }
        }
        goes_on && self.add("]")
    }

    fn add_map(&mut self, map: &mut Map) -> bool {
        let mut goes_on = self.add("#{");
        for (i, (key, value)) in map.iter_mut().enumerate() {
            let mut key_text = String::new();
            let _ = write!(key_text, "{key:?}: ");
            goes_on = goes_on && (i == 0 || self.add(", ")) && self.add(&key_text) && self.add_value(value);
            if !goes_on {
                break;
            }
        }
        goes_on && self.add("}")
    }

    /// Two digits a byte, in groups of eight.
    fn add_blob(&mut self, blob: &[u8]) -> bool {
        let digit = |x: u8| char::from_digit(u32::from(x), 16).unwrap_or('0');
        let mut goes_on = self.add("[");
        for (i, bytes) in blob.chunks(8).enumerate() {
            let digits: String = bytes
                .iter()
                .flat_map(|x| [digit(x >> 4), digit(x & 15)])
                .collect();
            goes_on = goes_on && (i == 0 || self.add(" ")) && self.add(&digits);
            if !goes_on {
                break;
            }
        }
        goes_on && self.add("]")
    }
}

/// The text of a value that has others in it.
///
/// Whoever asked for the text may pass over an error, as Rhai's interpolation does, and write all of it after all; so
/// there is a text, and the run ends at its next step. For the same reason the value goes: Rhai measures it behind
/// this call.
fn text_of(ctx: &NativeCallContext<'_>, value: &mut Dynamic) -> String {
    let mut writing = Writing::new(ctx);
    if let Some(mut array) = value.write_lock::<Array>() {
        writing.add_array(&mut array);
    } else if let Some(mut map) = value.write_lock::<Map>() {
        writing.add_map(&mut map);
    } else if let Some(blob) = value.read_lock::<Blob>() {
        writing.add_blob(&blob);
    }
    if writing.is_full {
        steps::end_by_string(writing.most, ctx.call_position());
    }
    if writing.is_full || writing.is_over {
        *value = Dynamic::UNIT;
    }
    writing.text
}

fn shown(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let [value] = args else {
        return Ok(Dynamic::UNIT);
    };
    Ok(text_of(ctx, value).into())
}

/// A string and a value, in either order. Rhai would ask for the text as it asks for that of any value, and where the
/// run ends just then, write all of it after all.
fn joined(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let [first, second] = args else {
        return Ok(Dynamic::UNIT);
    };
    let mut text = String::new();
    for value in [first, second] {
        if !value.is_string() {
            text.push_str(&text_of(ctx, value));
        } else if let Ok(string) = value.as_immutable_string_ref() {
            text.push_str(&string);
        }
    }
    Ok(text.into())
}

fn added(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    if let [string, value] = args
        && let Some(mut string) = string.write_lock::<ImmutableString>()
    {
        *string += text_of(ctx, value);
    }
    Ok(Dynamic::UNIT)
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
    let [array, map, blob, string] = [
        TypeId::of::<Array>(),
        TypeId::of::<Map>(),
        TypeId::of::<Blob>(),
        TypeId::of::<ImmutableString>(),
    ];
    for name in NAMES {
        for value in [array, map, blob] {
            register(module, name, &[value], Purity::Pure, shown);
        }
    }
    // A blob is added as the text that it encodes, by Rhai itself.
    for value in [array, map] {
        register(module, "+", &[string, value], Purity::Pure, joined);
        register(module, "+", &[value, string], Purity::Pure, joined);
        for name in ["+=", "append"] {
            register(module, name, &[string, value], Purity::Changes, added);
        }
    }
    register(module, "to_json", &[map], Purity::Pure, to_json);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::script::api::ordering::tests::{ours, rhais, told};

    const CALLS: [&str; 14] = [
        "b.to_string()",
        "b.to_debug()",
        "`<${b}>`",
        "\"\" + b + [b]",
        "#{ b: b }.to_string()",
        "`<${[b, 1.5, \"a\"]}>`",
        "`<${#{ b: b, c: () }}>`",
        "[b] + \"x\"",
        "#{ b: b } + \"x\"",
        "\"x\" + #{ b: b }",
        "let s = \"x\"; s += [b, 'c']; s",
        "let s = \"x\"; s.append(#{ b: [b] }); s",
        "const S = \"x\"; S + [S]",
        "const S = \"x\"; S += [S]; S",
    ];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn values_are_written_as_by_rhai(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            let pushed: String = bytes.iter().map(|x| format!("b.push({x}); ")).collect();
            for call in CALLS {
                let script = format!("let b = blob(); {pushed} {call}");
                prop_assert_eq!(told(&ours(), &script), told(&rhais(), &script), "{}", script);
            }
        }
    }
}
