//! What is said of a script that cannot be read.

use rhai::{LexError, ParseErrorType, Position};

use super::{Context, limit, runtime::too_large, script, uncapitalized};
use crate::{
    diag::{Diagnostic, ErrorKind},
    script::{call::quoted, names},
};

pub(super) fn message(
    error: &ParseErrorType,
    pos: Position,
    text: &str,
    context: &Context<'_>,
) -> Diagnostic {
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
