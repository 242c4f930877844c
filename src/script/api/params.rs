//! Parameters: what a script lets its caller decide.

use rhai::{Dynamic, ImmutableString, Map};

use super::{map, string};
use crate::{
    diag::{Code, SourceLoc, nearest_names},
    parameters::{Declared, ParameterKind, RESERVED, is_name},
    script::{
        call::{Call, kind_of, quoted},
        session::State,
        table::{Entry, Group, Kind, Param},
        value::{Outcome, ScriptError},
    },
};

const OPTIONS: [&str; 4] = ["min", "max", "choices", "doc"];
const NAME: Param = string("name", "letters, digits and _; not size, samples or seed");
const DEFAULT: Param = Param::new(
    "default",
    Kind::Any,
    "none",
    "the value where nothing is given: a number, true or false, or a string; it decides what may be given",
);

pub(super) const ENTRIES: &[Entry] = &[Entry::scene(Group::Parameters, "param", param)
    .takes(&[
        &[NAME, DEFAULT],
        &[
            NAME,
            DEFAULT,
            map(
                "options",
                "min and max of a number, choices as an array of all that may be given, doc as a sentence",
            )
            .keys(&OPTIONS),
        ],
    ])
    .returns("the default's type")
    .doc("A value that the caller may decide: rtscript scene.rhai -D radius=0.7. A whole number as default takes whole numbers only, 0.5 takes any number. rtscript params scene.rhai lists a script's parameters.")
    .usage("param(\"radius\", 0.5, #{ min: 0, max: 2 })")
    .example("let count = param(\"count\", 5, #{ min: 1, max: 50, doc: \"balls in a row\" });\nlet shine = param(\"shine\", 0.3);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(1 - shine, 0.2, 0.2); specular(shine, shine, shine); shininess(40);\nfor i in 0..count { sphere(i - (count - 1) / 2.0, 0, 0, 0.45); }")
    .also(&["parameter", "argument", "option", "declare", "clock"])];

fn param(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    let default = call.any()?.clone();
    let options = match call.rest() {
        0 => Map::new(),
        _ => {
            let given = call.any()?;
            let map = given.clone().try_cast::<Map>();
            map.ok_or_else(|| call.wrong_kind("options", "a map", given))?
        }
    };
    call.end()?;
    if !is_name(&name) {
        return Err(call
            .error(format!("{} is no name for a parameter", quoted(&name)))
            .hint("a name has letters, digits and _, and begins with no digit"));
    }
    if RESERVED.contains(&name.as_str()) {
        return Err(call
            .error(format!(
                "{} is taken: the caller decides it for every scene",
                quoted(&name)
            ))
            .hint("size(), samples() and seed() give the values that count where the caller says nothing"));
    }
    let mut declared = declare(call, &name, &default, &options)?;
    declared.loc = state.builder.loc();
    if let Some(before) = state.parameters.iter().find(|p| *p.name == *name) {
        let as_before = Declared {
            value: before.value.clone(),
            loc: before.loc,
            ..declared.clone()
        };
        if as_before != *before {
            return Err(call
                .error(format!(
                    "{} was declared in line {} with another default or other options",
                    quoted(&name),
                    before.loc.line
                ))
                .hint("declare it once, and keep the value in a variable or a constant"));
        }
        return value(&declared, &before.value)
            .ok_or_else(|| call.error("a value that it did not take before"));
    }
    let result = match state.given.get(name.as_str()) {
        None => default,
        Some(text) => {
            let result = value(&declared, text).ok_or_else(|| refused(call, &declared, text))?;
            declared.value.clone_from(text);
            result
        }
    };
    state.parameters.push(declared);
    Ok(result)
}

/// The declaration, its default checked against its own options.
fn declare(
    call: &Call<'_, '_>,
    name: &ImmutableString,
    default: &Dynamic,
    options: &Map,
) -> Outcome<Declared> {
    let kind = if default.is_bool() {
        ParameterKind::Bool
    } else if default.is_int() {
        ParameterKind::Int
    } else if default.is_float() {
        ParameterKind::Number
    } else if default.is_string() {
        ParameterKind::Text
    } else {
        return Err(call.wrong_kind("default", "a number, true, false or a string", default));
    };
    call.known_keys(options, &OPTIONS)?;
    let bound = |key: &str| match options.get(key) {
        None => Ok(None),
        Some(_) if !matches!(kind, ParameterKind::Int | ParameterKind::Number) => Err(call.error(format!(
            "{key} is for numbers, and the default is {}",
            kind_of(default)
        ))),
        Some(value) => call.number_from(key, value).map(Some),
    };
    let choices = match options.get("choices") {
        None => Vec::new(),
        Some(given) => {
            let list = given.read_lock::<rhai::Array>();
            let list = list.ok_or_else(|| call.wrong_kind("choices", "an array", given))?;
            list.iter().map(text_of).collect()
        }
    };
    let doc = match options.get("doc") {
        None => String::new(),
        Some(given) => given
            .clone()
            .into_string()
            .map_err(|_| call.wrong_kind("doc", "a string", given))?,
    };
    let declared = Declared {
        name: name.to_string(),
        kind,
        default: text_of(default),
        value: text_of(default),
        min: bound("min")?,
        max: bound("max")?,
        choices,
        doc,
        loc: SourceLoc::default(),
    };
    if value(&declared, &declared.default).is_none() {
        return Err(call.error(format!(
            "the default {} is not {}",
            declared.default,
            declared.expected()
        )));
    }
    Ok(declared)
}

/// A value as it would be given.
fn text_of(value: &Dynamic) -> String {
    match value.as_float() {
        Ok(x) => x.to_string(),
        Err(_) => value.to_string(),
    }
}

/// What a given text stands for; `None` where the parameter does not take it.
fn value(declared: &Declared, text: &str) -> Option<Dynamic> {
    let within = |x: f64| declared.min.is_none_or(|min| x >= min) && declared.max.is_none_or(|max| x <= max);
    let result = match declared.kind {
        ParameterKind::Bool => Dynamic::from(text.parse::<bool>().ok()?),
        ParameterKind::Int => {
            let n = text.parse::<i64>().ok()?;
            within(n as f64).then(|| Dynamic::from(n))?
        }
        ParameterKind::Number => {
            let x = text.parse::<f64>().ok().filter(|x| x.is_finite())?;
            within(x).then(|| Dynamic::from(x))?
        }
        ParameterKind::Text => Dynamic::from(text.to_owned()),
    };
    let same = |choice: &String| match (choice.parse::<f64>(), text.parse::<f64>()) {
        (Ok(a), Ok(b)) if declared.kind == ParameterKind::Number => a == b,
        _ => choice == text,
    };
    (declared.choices.is_empty() || declared.choices.iter().any(same)).then_some(result)
}

#[cold]
fn refused(call: &Call<'_, '_>, declared: &Declared, text: &str) -> Box<ScriptError> {
    let error = call.error(format!(
        "the parameter {} must be {}, not {}",
        quoted(&declared.name),
        declared.expected(),
        quoted(text)
    ));
    error.hint(format!(
        "give another value: -D {}={}",
        declared.name, declared.default
    ))
}

/// The error for values given to parameters that the script does not have.
pub(in crate::script) fn unknown(state: &State) -> Option<Box<ScriptError>> {
    let known: Vec<&str> = state.parameters.iter().map(|p| p.name.as_str()).collect();
    let name = state.given.keys().find(|name| !known.contains(&name.as_str()))?;
    let error = ScriptError::new(format!("the script has no parameter {}", quoted(name)))
        .class(Code::UnknownParameter);
    Some(
        match (
            nearest_names(name, known.iter().copied()).first(),
            known.is_empty(),
        ) {
            (Some(near), _) => error.hint(format!("did you mean {near}?")),
            (None, true) => error.hint(format!("a script declares one by param(\"{name}\", 1.0)")),
            (None, false) => error.hint(format!("its parameters are {}", known.join(", "))),
        },
    )
}
