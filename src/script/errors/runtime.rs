//! What is said of a script that cannot go on.

use std::fmt::{self, Write};

use rhai::{Dynamic, EvalAltResult, Position};

use super::{Context, limit, script, script_error, syntax, uncapitalized};
use crate::{
    diag::{Code, Diagnostic, ErrorKind},
    limits::Limits,
    math::DVec3,
    script::{
        call::{kind_name, quoted},
        names::{self, Names},
    },
};

pub(super) fn message(error: &EvalAltResult, pos: Position, text: &str, context: &Context<'_>) -> Diagnostic {
    use EvalAltResult as E;
    if let Some(e) = script_error(error) {
        let mut d = Diagnostic::error(e.kind, e.message).class(e.code);
        d.hints = e.hints;
        return d;
    }
    let limits = context.limits;
    match error {
        E::ErrorFunctionNotFound(signature, _) => {
            Names::of(context.ast, context.language).unknown_function(signature, context.sources)
        }
        E::ErrorVariableNotFound(name, _) => names::unknown_variable(name, pos, text),
        E::ErrorParsing(e, pos) => syntax::message(e, *pos, text, context),
        E::ErrorPropertyNotFound(name, _) => script(
            Code::UnknownProperty,
            format!("the map has no property {}", quoted(name)),
        )
        .hint(format!("whether it has one is told by {} in map", quoted(name))),
        E::ErrorDotExpr(message, _) => unknown_property(message),
        E::ErrorModuleNotFound(name, _) => script(
            Code::UnknownModule,
            format!("no module is imported as {}", quoted(name)),
        ),
        E::ErrorMismatchDataType(wanted, given, _) | E::ErrorMismatchOutputType(wanted, given, _) => script(
            Code::ArgumentType,
            format!("expected {}, not {}", kind_name(wanted), kind_name(given)),
        ),
        E::ErrorIndexingType(kind, _) => not_indexable(kind),
        E::ErrorIndexNotFound(index, _) => script(
            Code::IndexRange,
            format!("there is nothing at index {}", quoted(&index.to_string())),
        ),
        E::ErrorArrayBounds(len, index, _) => out_of_bounds("the array", "element", *len, *index),
        E::ErrorStringBounds(len, index, _) => out_of_bounds("the string", "character", *len, *index),
        E::ErrorBitFieldBounds(len, index, _) => out_of_bounds("the number", "bit", *len, *index),
        E::ErrorFor(_) => script(Code::ArgumentType, "for needs something to run through")
            .hint("a range (0..10), an array, a map's keys() or a string's chars()"),
        E::ErrorAssignmentToConstant(name, _) => script(
            Code::ConstantChanged,
            format!("{name} is a constant and cannot be changed"),
        )
        .hint("declare it with let"),
        E::ErrorNonPureMethodCallOnConstant(name, _) => script(
            Code::ConstantChanged,
            format!("a constant cannot be changed by {}", names::plain(name)),
        )
        .hint("declare it with let"),
        E::ErrorUnboundThis(_) => script(
            Code::Syntax,
            "this is only known inside a function called on a value: value.f()",
        ),
        E::ErrorArithmetic(message, _) => arithmetic(message),
        E::ErrorRuntime(value, _) => script(Code::Thrown, thrown_text(value)),
        E::ErrorTooManyVariables(_) => limit("too many variables", "variables", limits.variables),
        E::ErrorTooManyModules(_) => limit("too many files are imported", "modules", limits.modules),
        E::ErrorStackOverflow(_) => limit(
            "functions call one another too deep",
            "call_levels",
            limits.call_levels,
        )
        .hint("does a function that calls itself come to an end?"),
        E::ErrorDataTooLarge(what, _) => too_large(what, limits),
        E::ErrorTerminated(..) => Diagnostic::error(ErrorKind::Cancelled, "the run was stopped"),
        E::LoopBreak(..) => script(Code::Syntax, "break and continue only stand inside a loop"),
        other => script(Code::InvalidValue, uncapitalized(&without_place(other))),
    }
}

/// Rhai's text without the position that it appends.
fn without_place(error: &EvalAltResult) -> String {
    let text = error.to_string();
    match text.rfind(" (line ") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// As much of a text as a message may have: what is thrown may be of any size.
struct Bounded(String);

impl fmt::Write for Bounded {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.extend(text.chars().take(MOST_THROWN));
        if self.0.len() > MOST_THROWN {
            return Err(fmt::Error);
        }
        Ok(())
    }
}

/// Messages are cut far before.
const MOST_THROWN: usize = 1 << 16;

fn thrown_text(value: &Dynamic) -> String {
    match value.clone().into_immutable_string() {
        Ok(text) if text.trim().is_empty() => "the script threw an empty text".to_owned(),
        Ok(text) => text.to_string(),
        Err(_) if value.is_unit() => "the script threw nothing".to_owned(),
        Err(_) => match value.read_lock::<DVec3>() {
            Some(v) => format!("the script threw [{:?}, {:?}, {:?}]", v.x, v.y, v.z),
            None => {
                let mut text = Bounded("the script threw ".to_owned());
                let _ = write!(text, "{value}");
                text.0
            }
        },
    }
}

pub(super) fn too_large(what: &str, limits: &Limits) -> Diagnostic {
    if what.contains("string") {
        limit("the string is too long", "string_bytes", limits.string_bytes)
    } else if what.contains("map") {
        limit("the map is too large", "map_len", limits.map_len)
    } else {
        limit("the array is too long", "array_len", limits.array_len)
    }
}

/// Rhai's "Addition overflow: 9223372036854775807 + 1" and the like.
fn arithmetic(message: &str) -> Diagnostic {
    let said = uncapitalized(message);
    let Some((what, sum)) = said.split_once(": ") else {
        return script(Code::Arithmetic, said);
    };
    if what.contains("division by zero") && sum.ends_with(" 0") {
        return script(Code::Arithmetic, format!("division by zero: {sum}"));
    }
    if what.ends_with("overflow") {
        return script(Code::Arithmetic, format!("{sum} is beyond the whole numbers"))
            .hint("a number with a point, such as 2.0, may be as large as 1e308");
    }
    script(Code::Arithmetic, said)
}

fn out_of_bounds(what: &str, part: &str, len: usize, index: i64) -> Diagnostic {
    let d = script(
        Code::IndexRange,
        match len {
            0 => format!("{what} is empty: there is no {part} {index}"),
            1 => format!("{what} has 1 {part}: there is no {part} {index}"),
            _ => format!("{what} has {len} {part}s: there is no {part} {index}"),
        },
    );
    if usize::try_from(index).is_ok_and(|i| i == len && len > 0) {
        return d.hint(format!("{part}s count from 0: the last is {}", len - 1));
    }
    d
}

fn not_indexable(kind: &str) -> Diagnostic {
    // Rhai writes "vec3 [string]".
    let (value, index) = kind.split_once(" [").unwrap_or((kind, ""));
    script(
        Code::ArgumentType,
        format!(
            "{} cannot be indexed{}",
            kind_name(value),
            match index.trim_end_matches(']') {
                "" => String::new(),
                index => format!(" by {}", kind_name(index)),
            }
        ),
    )
}

/// Rhai's "Unknown property 'w' - a getter is not registered for type 'vec3'".
fn unknown_property(message: &str) -> Diagnostic {
    let quoted_parts: Vec<&str> = message.split('\'').collect();
    let [_, name, middle, kind, ..] = quoted_parts.as_slice() else {
        return script(Code::UnknownProperty, uncapitalized(message));
    };
    let kind = kind_name(kind);
    if middle.contains("setter") {
        let d = script(
            Code::ArgumentType,
            format!("property {name} of {kind} cannot be set to this"),
        );
        return match kind.as_str() {
            "a vector" => d.hint("a vector has .x .y .z, which are numbers"),
            _ => d,
        };
    }
    let d = script(Code::UnknownProperty, format!("{kind} has no property {name}"));
    match kind.as_str() {
        "a vector" => d.hint("a vector has .x .y .z"),
        "an image" => d.hint("an image has .width and .height, and .pixel(x, y)"),
        "an array" | "a string" if ["length", "size", "count"].contains(name) => {
            d.hint("how many there are is told by .len()")
        }
        "an array" if *name == "x" || *name == "y" || *name == "z" => {
            d.hint("an array has [0] [1] [2]; vec3(x, y, z) has .x .y .z")
        }
        _ => d,
    }
}
