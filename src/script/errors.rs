//! From Rhai's errors to diagnostics: our words, the place, the calls that led there, and what to do.

use rhai::{AST, Dynamic, EvalAltResult, LexError, ParseError, ParseErrorType, Position};

use super::{
    call::{kind_name, quoted},
    names::{self, Names},
    session::Source,
    value::ScriptError,
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    limits::Limits,
};

/// Longest message: a script can throw megabytes.
const LONGEST: usize = 4096;

/// Calls listed at each end of a long chain.
const FIRST_CALLS: usize = 8;
const LAST_CALLS: usize = 2;

/// Rhai counts lines in 16 bits and stays at the last.
const LAST_LINE: u32 = 65_535;

/// What an error can be explained by.
pub(super) struct Context<'a> {
    pub(super) sources: &'a [Source],
    pub(super) limits: &'a Limits,
    /// The script, where it could be read.
    pub(super) ast: Option<&'a AST>,
}

impl Context<'_> {
    fn text(&self, file: &str) -> &str {
        self.sources
            .iter()
            .find(|s| s.name == file)
            .map_or("", |s| &s.text)
    }

    fn main(&self) -> &str {
        self.sources.first().map_or("", |s| &s.name)
    }

    /// Adds the place, with the line's text.
    fn place(&self, d: Diagnostic, file: &str, pos: Position) -> Diagnostic {
        let line = pos.line().unwrap_or(0) as u32;
        let text = self.text(file);
        if line == LAST_LINE && text.lines().count() > LAST_LINE as usize {
            return d.at(file, line, 0).note(format!(
                "the place is at or past line {LAST_LINE}; lines are not counted any further"
            ));
        }
        d.at(file, line, pos.position().unwrap_or(0) as u32)
            .with_source(text)
    }
}

/// A script that cannot be read.
pub(super) fn of_parse(error: &ParseError, file: &str, context: &Context<'_>) -> Diagnostic {
    let d = parse_message(&error.0, error.1, context.text(file), context);
    finish(context.place(d, file, error.1))
}

/// A run that ended with an error.
pub(super) fn of_run(error: &EvalAltResult, context: &Context<'_>) -> Diagnostic {
    let mut file = context.main().to_owned();
    let mut caller: Option<&str> = None;
    let mut calls = Vec::new();
    let mut error = error;
    loop {
        match error {
            EvalAltResult::ErrorInFunctionCall(name, source, inner, pos) => {
                calls.push(call_note(caller, &file, *pos));
                caller = Some(name);
                if !source.is_empty() {
                    file.clone_from(source);
                }
                error = inner;
            }
            EvalAltResult::ErrorInModule(name, inner, pos) => {
                calls.push(format!("imported at {}", at(&file, *pos)));
                caller = None;
                file.clone_from(name);
                error = inner;
            }
            _ => break,
        }
    }
    let mut pos = error.position();
    if let Some((source, raised)) = script_error(error).and_then(|e| e.place) {
        pos = raised;
        file = source.unwrap_or(file);
    }
    let mut d = match script_error(error).and_then(|e| e.of_file) {
        Some(d) => {
            calls.push(format!("named at {}", at(&file, pos)));
            *d
        }
        None => {
            let d = run_message(error, pos, context.text(&file), context);
            context.place(d, &file, pos)
        }
    };
    calls.reverse();
    let left_out = calls.len().saturating_sub(FIRST_CALLS + LAST_CALLS);
    if left_out > 0 {
        let gap = format!("... and {left_out} calls more ...");
        calls.splice(FIRST_CALLS..FIRST_CALLS + left_out, [gap]);
    }
    d.notes.extend(calls);
    finish(d)
}

fn at(file: &str, pos: Position) -> String {
    match (pos.line(), pos.position()) {
        (Some(line), Some(column)) => format!("{file}:{line}:{column}"),
        (Some(line), None) => format!("{file}:{line}"),
        (None, _) => file.to_owned(),
    }
}

fn call_note(caller: Option<&str>, file: &str, pos: Position) -> String {
    match caller {
        Some(name) if names::is_closure(name) => format!("called from a closure at {}", at(file, pos)),
        Some(name) => format!("called from {name}() at {}", at(file, pos)),
        None => format!("called at {}", at(file, pos)),
    }
}

/// The last touches: no message is longer than a page, none has a line break.
fn finish(mut d: Diagnostic) -> Diagnostic {
    d.message = shortened(&d.message);
    for text in d.notes.iter_mut().chain(&mut d.hints) {
        *text = shortened(text);
    }
    d
}

fn shortened(text: &str) -> String {
    let mut short: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .scan(0, |bytes, c| {
            *bytes += c.len_utf8();
            (*bytes <= LONGEST - 3).then_some(c)
        })
        .collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    short
}

/// The error of a scene function that the engine carries.
fn script_error(error: &EvalAltResult) -> Option<ScriptError> {
    match error {
        EvalAltResult::ErrorRuntime(value, _) | EvalAltResult::ErrorTerminated(value, _) => {
            value.read_lock::<ScriptError>().map(|e| e.clone())
        }
        _ => None,
    }
}

fn script(message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(ErrorKind::Script, message)
}

fn limit(what: &str, name: &str, value: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::error(ErrorKind::Limit, format!("{what}: the limit '{name}' is {value}"))
}

/// Rhai's words, as ours begin: in lower case.
fn uncapitalized(text: &str) -> String {
    let mut chars = text.chars();
    let first = chars.next().map(|c| c.to_lowercase().to_string());
    let rest = chars.as_str();
    // "BLOB" and "I" stay.
    if rest.starts_with(char::is_uppercase) {
        return text.to_owned();
    }
    format!("{}{rest}", first.unwrap_or_default())
}

fn run_message(error: &EvalAltResult, pos: Position, text: &str, context: &Context<'_>) -> Diagnostic {
    use EvalAltResult as E;
    if let Some(e) = script_error(error) {
        let mut d = Diagnostic::error(e.kind, e.message);
        d.hints = e.hints;
        return d;
    }
    let limits = context.limits;
    match error {
        E::ErrorFunctionNotFound(signature, _) => Names::of(context.ast).unknown_function(signature),
        E::ErrorVariableNotFound(name, _) => names::unknown_variable(name, pos, text),
        E::ErrorParsing(e, pos) => parse_message(e, *pos, text, context),
        E::ErrorPropertyNotFound(name, _) => script(format!("the map has no property {}", quoted(name)))
            .hint(format!("whether it has one is told by {} in map", quoted(name))),
        E::ErrorDotExpr(message, _) => unknown_property(message),
        E::ErrorModuleNotFound(name, _) => script(format!("no module is imported as {}", quoted(name))),
        E::ErrorMismatchDataType(wanted, given, _) | E::ErrorMismatchOutputType(wanted, given, _) => script(
            format!("expected {}, not {}", kind_name(wanted), kind_name(given)),
        ),
        E::ErrorIndexingType(kind, _) => not_indexable(kind),
        E::ErrorIndexNotFound(index, _) => script(format!(
            "there is nothing at index {}",
            quoted(&index.to_string())
        )),
        E::ErrorArrayBounds(len, index, _) => out_of_bounds("the array", "element", *len, *index),
        E::ErrorStringBounds(len, index, _) => out_of_bounds("the string", "character", *len, *index),
        E::ErrorBitFieldBounds(len, index, _) => out_of_bounds("the number", "bit", *len, *index),
        E::ErrorFor(_) => script("for needs something to run through")
            .hint("a range (0..10), an array, a map's keys() or a string's chars()"),
        E::ErrorAssignmentToConstant(name, _) => {
            script(format!("{name} is a constant and cannot be changed")).hint("declare it with let")
        }
        E::ErrorNonPureMethodCallOnConstant(name, _) => {
            script(format!("a constant cannot be changed by {}", names::plain(name)))
                .hint("declare it with let")
        }
        E::ErrorUnboundThis(_) => script("this is only known inside a function called on a value: value.f()"),
        E::ErrorArithmetic(message, _) => script(uncapitalized(message)),
        E::ErrorRuntime(value, _) => script(thrown_text(value)),
        E::ErrorTooManyVariables(_) => limit("too many variables", "variables", limits.variables),
        E::ErrorTooManyModules(_) => limit("too many imports", "files", limits.files),
        E::ErrorStackOverflow(_) => limit(
            "functions call one another too deep",
            "call_levels",
            limits.call_levels,
        )
        .hint("does a function that calls itself come to an end?"),
        E::ErrorDataTooLarge(what, _) => too_large(what, limits),
        E::ErrorTerminated(..) => Diagnostic::error(ErrorKind::Cancelled, "the run was stopped"),
        E::LoopBreak(..) => script("break and continue only stand inside a loop"),
        other => script(uncapitalized(&without_place(other))),
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

fn thrown_text(value: &Dynamic) -> String {
    match value.clone().into_immutable_string() {
        Ok(text) if text.trim().is_empty() => "the script threw an empty text".to_owned(),
        Ok(text) => text.to_string(),
        Err(_) if value.is_unit() => "the script threw nothing".to_owned(),
        Err(_) => match value.read_lock::<crate::math::DVec3>() {
            Some(v) => format!("the script threw [{:?}, {:?}, {:?}]", v.x, v.y, v.z),
            None => format!("the script threw {value}"),
        },
    }
}

fn too_large(what: &str, limits: &Limits) -> Diagnostic {
    if what.contains("string") {
        limit("the string is too long", "string_bytes", limits.string_bytes)
    } else if what.contains("map") {
        limit("the map is too large", "map_len", limits.map_len)
    } else {
        limit("the array is too long", "array_len", limits.array_len)
    }
}

fn out_of_bounds(what: &str, part: &str, len: usize, index: i64) -> Diagnostic {
    let d = script(match len {
        0 => format!("{what} is empty: there is no {part} {index}"),
        1 => format!("{what} has 1 {part}: there is no {part} {index}"),
        _ => format!("{what} has {len} {part}s: there is no {part} {index}"),
    });
    if usize::try_from(index).is_ok_and(|i| i == len && len > 0) {
        return d.hint(format!("{part}s count from 0: the last is {}", len - 1));
    }
    d
}

fn not_indexable(kind: &str) -> Diagnostic {
    // Rhai writes "vec3 [string]".
    let (value, index) = kind.split_once(" [").unwrap_or((kind, ""));
    script(format!(
        "{} cannot be indexed{}",
        kind_name(value),
        match index.trim_end_matches(']') {
            "" => String::new(),
            index => format!(" by {}", kind_name(index)),
        }
    ))
}

/// Rhai's "Unknown property 'w' - a getter is not registered for type 'vec3'".
fn unknown_property(message: &str) -> Diagnostic {
    let quoted_parts: Vec<&str> = message.split('\'').collect();
    let [_, name, middle, kind, ..] = quoted_parts.as_slice() else {
        return script(uncapitalized(message));
    };
    let kind = kind_name(kind);
    if middle.contains("setter") {
        let d = script(format!("property {name} of {kind} cannot be set to this"));
        return match kind.as_str() {
            "a vector" => d.hint("a vector has .x .y .z, which are numbers"),
            _ => d,
        };
    }
    let d = script(format!("{kind} has no property {name}"));
    match kind.as_str() {
        "a vector" => d.hint("a vector has .x .y .z"),
        "an image" => d.hint("an image has .width and .height, and .pixel(x, y)"),
        "an array" if *name == "x" || *name == "y" || *name == "z" => {
            d.hint("an array has [0] [1] [2]; vec3(x, y, z) has .x .y .z")
        }
        _ => d,
    }
}

fn parse_message(error: &ParseErrorType, pos: Position, text: &str, context: &Context<'_>) -> Diagnostic {
    use ParseErrorType as P;
    let limits = context.limits;
    match error {
        P::UnexpectedEOF => {
            script("the script ends in the middle of a statement").hint("is a bracket or a brace left open?")
        }
        P::BadInput(e) => lex_message(e),
        P::VariableUndefined(name) => names::unknown_variable(name, pos, text),
        P::ModuleUndefined(name) => {
            script(format!("no module is imported as {name}")).hint(format!("import \"{name}\" as {name};"))
        }
        P::MissingToken(token, why) => missing_token(token, why, names::line_before(text, pos)),
        P::Reserved(word) if word == "#" => script("'#' begins nothing").hint("comments begin with //"),
        P::Reserved(word) if rhai::is_valid_identifier(word) => {
            script(format!("'{word}' is a reserved word")).hint("give the variable another name")
        }
        P::Reserved(symbol) => script(format!("'{symbol}' has no meaning here")),
        P::PropertyExpected => match names::word_at(text, pos) {
            word @ ("eval" | "curry") => not_available(word),
            _ => script("expected the name of a property or a method"),
        },
        P::UnknownOperator(op) => {
            let d = script(format!("there is no operator '{op}'"));
            match op.as_str() {
                "++" => d.hint("write x += 1"),
                "--" => d.hint("write x -= 1"),
                _ => d,
            }
        }
        P::WrongFnDefinition => {
            script("a function can only be defined at the top level, not inside a block or another function")
        }
        P::AssignmentToConstant(name) if name.is_empty() => {
            script("only a variable can be assigned to").hint("== compares")
        }
        P::AssignmentToConstant(name) => {
            script(format!("{name} is a constant and cannot be changed")).hint("declare it with let")
        }
        P::AssignmentToInvalidLHS(_) => script("this cannot be assigned to").hint("== compares"),
        P::LoopBreak => script("break and continue only stand inside a loop"),
        P::ExprTooDeep => limit(
            "expressions or blocks are nested too deep",
            "expression_depth",
            limits.expression_depth,
        ),
        P::TooManyFunctions => limit("too many functions are defined", "functions", limits.functions),
        P::LiteralTooLarge(what, _) => too_large(what, limits),
        P::FnDuplicatedDefinition(name, n) => {
            let plural = if *n == 1 { "" } else { "s" };
            script(format!(
                "the function {name} with {n} parameter{plural} is defined twice"
            ))
        }
        P::MismatchedType(wanted, given) => {
            let d = script(format!("expected {wanted}, not {given}"));
            match wanted.as_str() {
                "an iterable value" => d.hint("a range 0..10 runs from 0 to 9"),
                "a boolean expression" => d.hint("compare: x != 0"),
                _ => d,
            }
        }
        P::WrongDocComment => {
            script("a /// comment can only stand before a function").hint("write // instead")
        }
        other => script(uncapitalized(&other.to_string())),
    }
}

fn not_available(word: &str) -> Diagnostic {
    script(format!("{word} is not available in scene scripts"))
}

/// `before` is the line up to the place where `token` should stand.
fn missing_token(token: &str, why: &str, before: &str) -> Diagnostic {
    let why = why.trim();
    if let (",", Some(function)) = (
        token,
        why.strip_prefix("to separate the arguments to function call "),
    ) {
        let function = function.trim_matches('\'');
        return script(format!("expected ',' or ')' after an argument of {function}"));
    }
    let d = script(match why {
        "" => format!("expected '{token}'"),
        _ => format!("expected '{token}' {why}"),
    });
    match token {
        "{" if before.trim_end().trim_end_matches('(').ends_with("group") => {
            d.hint("group { ... } holds a block of statements; nothing else can be called group")
        }
        ";" => d.hint("is a ';' missing before this, or are the brackets of a call?"),
        _ => d,
    }
}

fn lex_message(error: &LexError) -> Diagnostic {
    match error {
        LexError::Runtime(message) => Diagnostic::error(ErrorKind::Limit, message),
        LexError::ImproperSymbol(symbol, _) if symbol == "eval" || symbol == "curry" => not_available(symbol),
        LexError::ImproperSymbol(_, why) if !why.is_empty() => script(uncapitalized(why)),
        LexError::UnterminatedString => {
            script("the string is not closed").hint("a string over several lines stands in backticks: `...`")
        }
        LexError::UnexpectedInput(what) => {
            let d = script(format!("unexpected {}", quoted(what)));
            match what.as_str() {
                "#" => d.hint("comments begin with //"),
                "." => d.hint("a number begins with a digit: 0.5"),
                _ => d,
            }
        }
        other => script(uncapitalized(&other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_messages_are_cut_between_characters() {
        let cut = shortened(&"é".repeat(5000));
        assert!(cut.len() <= LONGEST && cut.ends_with("..."), "{}", cut.len());
        assert_eq!(shortened("a\nb"), "a b");
    }
}
