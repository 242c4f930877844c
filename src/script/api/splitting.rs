//! Strings into parts, of which there may be a million: here a run that is to end ends between two of them.

use std::any::TypeId;

use rhai::{Array, Dynamic, ImmutableString, Module, NativeCallContext};

use crate::script::{
    caller::Failure,
    engine::{Purity, register},
    steps::Work,
    value::{Outcome, ScriptError},
};

/// What making a part takes, in the measure of [`Work`].
const COST: usize = 8;

/// Which end parts are counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum From {
    Start,
    End,
}

fn collected<'t>(parts: impl Iterator<Item = &'t str>) -> Outcome<Array> {
    let mut work = Work::new();
    let mut array = Array::new();
    for part in parts {
        work.done(COST)?;
        array.push(part.into());
    }
    Ok(array)
}

/// The parts between delimiters, at most so many; one where there is nothing to part.
fn split(text: &ImmutableString, delimiter: &str, most: usize, from: From) -> Outcome<Array> {
    if most <= 1 || text.is_empty() || !text.contains(delimiter) {
        return Ok(Array::from([text.clone().into()]));
    }
    match from {
        From::Start => collected(text.splitn(most, delimiter)),
        From::End => collected(text.rsplitn(most, delimiter)),
    }
}

fn words(text: &ImmutableString) -> Outcome<Array> {
    if text.is_empty() {
        return Ok(Array::from([text.clone().into()]));
    }
    collected(text.split_whitespace())
}

fn call(args: &mut [&mut Dynamic], from: From) -> Result<Dynamic, Failure> {
    let (text, rest) = match args {
        [text, rest @ ..] => (text, rest),
        [] => return Err(ScriptError::new("nothing to split").into()),
    };
    let wrong = |_| Failure::from(ScriptError::new("not the arguments of a split"));
    let text = text.as_immutable_string_ref().map_err(wrong)?;
    let Some((delimiter, most)) = rest.split_first() else {
        return Ok(words(&text)?.into());
    };
    // A negative number of parts is none, and then there is one.
    let most = match most.first() {
        Some(most) => usize::try_from(most.as_int().map_err(wrong)?).unwrap_or(0),
        None => usize::MAX,
    };
    let parts = match delimiter.as_char() {
        Ok(delimiter) => split(&text, delimiter.encode_utf8(&mut [0; 4]), most, from)?,
        Err(_) => split(
            &text,
            &delimiter.as_immutable_string_ref().map_err(wrong)?,
            most,
            from,
        )?,
    };
    Ok(parts.into())
}

pub(super) fn extend(module: &mut Module) {
    let [text, char, int] = [
        TypeId::of::<ImmutableString>(),
        TypeId::of::<char>(),
        TypeId::of::<i64>(),
    ];
    let mut add = |name: &str, types: &[TypeId], from: From| {
        let run = move |ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]| {
            call(args, from).map_err(|failure| failure.raise(ctx.call_source(), ctx.call_position()))
        };
        register(module, name, types, Purity::Pure, run);
    };
    add("split", &[text], From::Start);
    for (name, from) in [("split", From::Start), ("split_rev", From::End)] {
        for delimiter in [text, char] {
            add(name, &[text, delimiter], from);
            add(name, &[text, delimiter, int], from);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::script::api::ordering::tests::{ours, rhais, told};

    const CALLS: [&str; 14] = [
        "s.split()",
        "s.split(d)",
        "s.split(d, n)",
        "s.split('a')",
        "s.split('a', n)",
        "s.split('é', 2)",
        "s.split_rev(d)",
        "s.split_rev(d, n)",
        "s.split_rev('a')",
        "s.split_rev('a', n)",
        "s.split(\"\")",
        "s.split_rev(\"\", n)",
        "const S = \"a b\"; S.split('a')",
        "s.split(n)",
    ];

    proptest! {
        #[test]
        fn strings_are_split_as_by_rhais_own_functions(
            text in "[ab é]{0,8}", delimiter in "[aé ]{0,2}", n in -2i64..5,
        ) {
            let (ours, rhais) = (ours(), rhais());
            for call in CALLS {
                let script = format!("let s = {text:?}; let d = {delimiter:?}; let n = {n}; {call}");
                let (ours, rhais) = (told(&ours, &script), told(&rhais, &script));
                prop_assert_eq!(&ours, &rhais, "{}", script);
                prop_assert!(ours.starts_with('['), "{}", ours);
            }
        }
    }
}
