//! From Rhai's errors to diagnostics: our words, the place, the calls that led there, and what to do.

pub(super) mod habits;
mod runtime;
mod syntax;

use rhai::{AST, EvalAltResult, ParseError, Position};

use super::{CallSite, language::Language, names, session::Source, value::ScriptError};
use crate::{
    diag::{Code, Diagnostic, ErrorKind, on_one_line},
    limits::Limits,
};

/// Calls listed at each end of a long chain.
const FIRST_CALLS: usize = 8;
const LAST_CALLS: usize = 2;

/// Rhai counts lines in 16 bits and stays at the last.
const LAST_LINE: u32 = 65_535;

/// What an error can be explained by.
pub(super) struct Context<'a> {
    pub(super) sources: &'a [Source],
    pub(super) limits: &'a Limits,
    pub(super) language: &'a Language,
    /// The script, where it could be read.
    pub(super) ast: Option<&'a AST>,
}

impl Context<'_> {
    pub(super) fn text(&self, file: &str) -> &str {
        self.sources
            .iter()
            .find(|s| s.name == file)
            .map_or("", |s| &s.text)
    }

    fn main(&self) -> &str {
        self.sources.first().map_or("", |s| &s.name)
    }

    /// Adds the place, with the line's text.
    pub(super) fn place(&self, d: Diagnostic, file: &str, pos: Position) -> Diagnostic {
        let line = pos.line().unwrap_or(0) as u32;
        let text = self.text(file);
        if line == LAST_LINE && text.lines().count() > LAST_LINE as usize {
            return d.at(file, line, 0).note(format!(
                "the place is at or past line {LAST_LINE}; lines are not counted any further"
            ));
        }
        // Behind a text between backticks that has no end, columns go on past the end of the line.
        let end = text.split('\n').nth((line as usize).saturating_sub(1));
        let end = end.map_or(u32::MAX, |text| text.chars().count() as u32 + 1);
        d.at(file, line, end.min(pos.position().unwrap_or(0) as u32))
            .with_source(text)
    }
}

/// A script that cannot be read.
pub(super) fn of_parse(error: &ParseError, file: &str, context: &Context<'_>) -> Diagnostic {
    let text = context.text(file);
    if let Some((d, pos)) = syntax::elsewhere(&error.0, error.1, text) {
        return finish(context.place(d, file, pos));
    }
    let d = syntax::message(&error.0, error.1, text, context);
    finish(context.place(d, file, error.1))
}

/// A run that ended with an error.
pub(super) fn of_run(error: &EvalAltResult, context: &Context<'_>) -> Diagnostic {
    let way = way(error, context.main());
    let (error, file, pos) = (way.error, way.place.file, way.place.pos);
    let mut calls: Vec<String> = way.steps.iter().map(call_note).collect();
    let mut d = match script_error(error).and_then(|e| e.of_file) {
        Some(d) => {
            calls.push(format!("named at {}", at(&file, pos)));
            *d
        }
        None => {
            let d = runtime::message(error, pos, context.text(&file), context);
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

/// A place that a run came through.
struct Step<'e> {
    /// The function it is in; `None` outside all functions.
    function: Option<&'e str>,
    file: String,
    pos: Position,
    /// It is an import, not a call.
    imports: bool,
}

/// How a run came to an error.
struct Way<'e> {
    /// The calls and imports, outermost first.
    steps: Vec<Step<'e>>,
    /// Where the error was raised.
    place: Step<'e>,
    /// The error without the calls around it.
    error: &'e EvalAltResult,
}

/// Takes an error apart that was raised in a run of the file `main`.
fn way<'e>(mut error: &'e EvalAltResult, main: &str) -> Way<'e> {
    let mut file = main.to_owned();
    let mut function: Option<&str> = None;
    let mut steps = Vec::new();
    loop {
        let (imports, pos, inner) = match error {
            EvalAltResult::ErrorInFunctionCall(_, _, inner, pos) => (false, *pos, inner),
            EvalAltResult::ErrorInModule(_, inner, pos) => (true, *pos, inner),
            _ => break,
        };
        steps.push(Step {
            function,
            file: file.clone(),
            pos,
            imports,
        });
        match error {
            EvalAltResult::ErrorInFunctionCall(name, source, ..) => {
                function = Some(name);
                if !source.is_empty() {
                    file.clone_from(source);
                }
            }
            EvalAltResult::ErrorInModule(name, ..) => {
                function = None;
                file.clone_from(name);
            }
            _ => {}
        }
        error = inner;
    }
    let mut pos = error.position();
    if let Some((source, raised)) = script_error(error).and_then(|e| e.place) {
        pos = raised;
        file = source.unwrap_or(file);
    }
    Way {
        steps,
        place: Step {
            function,
            file,
            pos,
            imports: false,
        },
        error,
    }
}

/// The calls that led to an error, innermost first: the one that raised it, then the one that called the function
/// which that stands in, and so on. Empty where the error went through the script's hands on the way.
pub(super) fn call_stack(error: &EvalAltResult, main: &str) -> Vec<CallSite> {
    let way = way(error, main);
    if way.place.pos.is_none() || !matches!(way.error, EvalAltResult::ErrorRuntime(..)) {
        return Vec::new();
    }
    let all = way.steps.into_iter().chain([way.place]);
    let mut sites: Vec<CallSite> = all
        .map(|step| CallSite {
            function: step.function.map(|name| {
                if names::is_closure(name) {
                    "a closure".to_owned()
                } else {
                    name.to_owned()
                }
            }),
            file: step.file,
            line: step.pos.line().unwrap_or(0) as u32,
            column: step.pos.position().unwrap_or(0) as u32,
            imports: step.imports,
        })
        .collect();
    sites.reverse();
    sites
}

fn call_note(step: &Step<'_>) -> String {
    let place = at(&step.file, step.pos);
    match step.function {
        _ if step.imports => format!("imported at {place}"),
        Some(name) if names::is_closure(name) => format!("called from a closure at {place}"),
        Some(name) => format!("called from {name}() at {place}"),
        None => format!("called at {place}"),
    }
}

/// The last touch: none of its texts is longer than a page or has a line break.
pub(super) fn finish(mut d: Diagnostic) -> Diagnostic {
    for text in d.notes.iter_mut().chain(&mut d.hints) {
        *text = on_one_line(std::mem::take(text));
    }
    d
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

fn script(code: Code, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(ErrorKind::Script, message).class(code)
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
