//! What is said of a script that cannot be read.

use rhai::{LexError, ParseErrorType, Position};

use super::{Context, habits, limit, runtime::too_large, script, uncapitalized};
use crate::{
    diag::{Code, Diagnostic, ErrorKind},
    scene::CsgOp,
    script::{call::quoted, names, recover},
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
        P::UnexpectedEOF => script(Code::Unclosed, "the script ends in the middle of a statement")
            .hint("is a bracket or a brace left open?"),
        P::BadInput(LexError::UnexpectedInput(bar)) if !limits.closures && (bar == "|" || bar == "||") => {
            limit("closures are switched off", "closures", limits.closures).hint(
                "define a function and hand it on by its name: fn twice(x) { x * 2 } list.map(Fn(\"twice\"))",
            )
        }
        P::BadInput(e) => lex_message(e),
        P::VariableUndefined(name) => names::unknown_variable(name, pos, text),
        P::ModuleUndefined(name) => script(Code::UnknownModule, format!("no module is imported as {name}"))
            .hint(format!("import \"{name}\" as {name};")),
        P::VariableExpected if names::line_before(text, pos).trim_end().ends_with("for (") => of_for(),
        P::VariableExpected => {
            let word = names::word_at(text, pos);
            let d = script(Code::Syntax, "expected the name of a variable");
            match word.chars().next() {
                Some(c) if c.is_ascii_digit() => d.hint("a name begins with a letter"),
                Some(_) => d.hint(format!("'{word}' is a reserved word: choose another name")),
                None => d,
            }
        }
        P::ExprExpected(what) if what == "a literal" || what == "literal" => {
            script(Code::Syntax, "expected a value written out, such as 1 or \"a\"")
                .hint("switch x { 1 => box(), 2 | 3 => disk(), _ => () }")
        }
        P::MissingToken(token, why) if token == "," && why.contains("this array") => {
            script(Code::Syntax, "expected ',' or ']' after an item of this array")
        }
        P::MissingToken(_, why) if why.contains("iteration variable") => of_for(),
        P::MissingToken(token, why) => missing_token(token, why, pos, text),
        P::Reserved(word) if word == "#" => {
            let d = script(Code::Syntax, "'#' begins nothing");
            match names::line_after(text, pos).strip_prefix('#') {
                Some(rest) if rest.starts_with(char::is_alphabetic) => {
                    d.hint("let R = 2; declares a variable, fn ball(r) { ... } a function")
                }
                _ => d.hint("comments begin with //"),
            }
        }
        P::Reserved(word) if rhai::is_valid_identifier(word) => {
            let d = script(Code::ReservedWord, format!("'{word}' is a reserved word"));
            let declares = ["let", "const", "fn", "for", "as"];
            let before = names::line_before(text, pos);
            match habits::word(word) {
                _ if declares.iter().any(|word| before.trim_end().ends_with(word)) => {
                    d.hint("choose another name")
                }
                Some(here) => d.hint(here),
                None if names::BUILTINS.contains(word.as_str()) => {
                    d.hint(format!("{word} is a function, which is called: {word}(...)"))
                }
                None => d.hint("choose another name"),
            }
        }
        P::Reserved(symbol) => script(Code::Syntax, format!("'{symbol}' has no meaning here")),
        P::PropertyExpected => match names::word_at(text, pos) {
            word @ ("eval" | "curry") => not_available(word),
            _ => script(Code::Syntax, "expected the name of a property or a method"),
        },
        P::UnknownOperator(op) => {
            let d = script(Code::Syntax, format!("there is no operator '{op}'"));
            match op.as_str() {
                "++" => d.hint("write x += 1"),
                "--" => d.hint("write x -= 1"),
                _ => d,
            }
        }
        P::WrongFnDefinition => script(
            Code::Syntax,
            "a function can only be defined at the top level, not inside a block or another function",
        )
        .hint("a closure may stand anywhere: let ball = |r| sphere(0, 0, 0, r); ball.call(1);"),
        P::AssignmentToConstant(name) if name.is_empty() => {
            script(Code::ConstantChanged, "only a variable can be assigned to").hint("== compares")
        }
        P::AssignmentToConstant(name) => script(
            Code::ConstantChanged,
            format!("{name} is a constant and cannot be changed"),
        )
        .hint("declare it with let"),
        P::AssignmentToInvalidLHS(_) => {
            script(Code::ConstantChanged, "this cannot be assigned to").hint("== compares")
        }
        P::LoopBreak => script(Code::Syntax, "break and continue only stand inside a loop"),
        P::ExprTooDeep => limit(
            "expressions or blocks are nested too deep",
            "expression_depth",
            limits.expression_depth,
        ),
        P::TooManyFunctions => limit("too many functions are defined", "functions", limits.functions),
        P::LiteralTooLarge(what, _) => too_large(what, limits),
        P::FnDuplicatedDefinition(name, n) => {
            let plural = if *n == 1 { "" } else { "s" };
            script(
                Code::DuplicateFunction,
                format!("the function {name} with {n} parameter{plural} is defined twice"),
            )
        }
        P::MismatchedType(wanted, given) => {
            let wrong = |what: &str| script(Code::ArgumentType, format!("expected {what}, not {given}"));
            match wanted.as_str() {
                "an iterable value" => wrong("a range, an array or a string to run through")
                    .hint("a range 0..10 runs from 0 to 9"),
                "a boolean expression" => wrong("a condition, true or false").hint("compare: x != 0"),
                wanted => wrong(wanted),
            }
        }
        P::WrongDocComment => {
            script(Code::Syntax, "a /// comment can only stand before a function").hint("write // instead")
        }
        other => script(Code::Syntax, uncapitalized(&other.to_string())),
    }
}

/// What is said at another place than the parser's, because the mistake is there: at a bracket that is never closed,
/// which the parser misses at the end of the text, and after a statement whose semicolon it misses a line below.
pub(super) fn elsewhere(error: &ParseErrorType, pos: Position, text: &str) -> Option<(Diagnostic, Position)> {
    use ParseErrorType as P;
    let at = recover::offset(text, pos);
    let rest = at.and_then(|at| text.get(at..)).unwrap_or_default();
    match error {
        P::UnexpectedEOF | P::MissingToken(..) if rest.trim().is_empty() => {
            let (open, bracket) = recover::left_open(text)?;
            let d = script(Code::Unclosed, format!("this '{bracket}' is never closed"));
            Some((d, recover::position(text, open)))
        }
        P::MissingToken(token, _) if token == ";" => {
            let before = text.get(..at?)?;
            let statement = before.trim_end();
            let (last, _) = statement.char_indices().next_back()?;
            let is_above = before.get(statement.len()..)?.contains('\n');
            let line = statement.rsplit('\n').next()?;
            if !is_above || line.contains("//") || statement.ends_with("*/") {
                return None;
            }
            let d = script(Code::Syntax, "expected ';' after this statement");
            Some((d, recover::position(text, last)))
        }
        _ => None,
    }
}

fn not_available(word: &str) -> Diagnostic {
    script(
        Code::NotAvailable,
        format!("{word} is not available in scene scripts"),
    )
}

/// A loop whose head is that of another language.
fn of_for() -> Diagnostic {
    script(Code::Syntax, "for takes a name and what it runs through")
        .hint("for i in 0..5 { ... } counts from 0 to 4")
}

/// `pos` is the place where `token` should stand.
fn missing_token(token: &str, why: &str, pos: Position, text: &str) -> Diagnostic {
    let (why, before) = (why.trim(), names::line_before(text, pos));
    if let (",", Some(function)) = (
        token,
        why.strip_prefix("to separate the arguments to function call "),
    ) {
        let function = function.trim_matches('\'');
        return script(
            Code::Syntax,
            format!("expected ',' or ')' after an argument of {function}"),
        );
    }
    let code = match token {
        "}" | ")" | "]" => Code::Unclosed,
        _ => Code::Syntax,
    };
    let d = script(
        code,
        match why {
            "" => format!("expected '{token}'"),
            _ if why.contains("in this expression") => {
                format!("expected '{token}' at the end of these brackets")
            }
            _ if why.contains("object map literal") => format!("expected '{token}' after a key of this map"),
            _ => format!("expected '{token}' {why}"),
        },
    );
    match token {
        "{" if before.trim_end().trim_end_matches('(').ends_with("group") => {
            d.hint("group { ... } holds a block of statements; nothing else can be called group")
        }
        "{" if let Some(op) = solid_block(before) => d.hint(format!(
            "{op} {{ ... }} holds a block of statements, which make what it is put together from"
        )),
        "{" => d.hint("a block stands in braces: for i in 0..5 { ... }"),
        ";" => d.hint(habits::instead_of_an_end(pos, text)),
        "in" => d.hint("for i in 0..5 { ... } counts from 0 to 4"),
        ")" if why.contains("in this expression") => d.hint("a list or a vector is written [1, 2, 3]"),
        "," if why.contains("parameters") => match habits::in_parameters(pos, text) {
            Some(here) => d.hint(here),
            None => d,
        },
        _ => d,
    }
}

/// The block that makes a solid whose name stands at the end of a text.
fn solid_block(before: &str) -> Option<CsgOp> {
    let before = before.trim_end().trim_end_matches('(');
    CsgOp::ALL.into_iter().find(|op| before.ends_with(op.name()))
}

fn lex_message(error: &LexError) -> Diagnostic {
    match error {
        LexError::Runtime(message) => Diagnostic::error(ErrorKind::Limit, message),
        LexError::ImproperSymbol(symbol, _) if symbol == "eval" || symbol == "curry" => not_available(symbol),
        LexError::ImproperSymbol(symbol, why) if why.contains("This is not") => {
            let d = script(Code::Syntax, format!("{} has no meaning here", quoted(symbol)));
            let mut instead = why.split('\'').rev();
            match instead.nth(1).filter(|_| why.contains("Should it be")) {
                Some(instead) => d.hint(format!("write {instead}")),
                None => d,
            }
        }
        LexError::ImproperSymbol(_, why) if !why.is_empty() => script(Code::Syntax, uncapitalized(why)),
        LexError::MalformedChar(text) => script(
            Code::Syntax,
            format!("single quotes hold one character, not {}", quoted(text)),
        )
        .hint("a string stands in double quotes: \"abc\""),
        LexError::UnterminatedString => script(Code::Unclosed, "the string is not closed")
            .hint("a string over several lines stands in backticks: `...`"),
        LexError::UnexpectedInput(what) => {
            let d = script(Code::Syntax, format!("unexpected {}", quoted(what)));
            match what.as_str() {
                "#" => d.hint("comments begin with //"),
                "}" => d.hint("no '{' before it is left to be closed"),
                "." => d.hint("a number begins with a digit: 0.5"),
                what => match habits::character(what) {
                    Some(here) => d.hint(here),
                    None => d,
                },
            }
        }
        LexError::MalformedEscapeSequence(what) => {
            script(Code::Syntax, format!("'{what}' is no escape sequence"))
                .hint(r"\\ is a backslash, \n a new line, \t a tab, \u263a a character by its number")
        }
        LexError::MalformedNumber(text) if text.is_empty() => script(Code::Syntax, "a number without digits")
            .hint("0x1F is hexadecimal, 0b101 binary, 0o17 octal"),
        other => script(Code::Syntax, uncapitalized(&other.to_string())),
    }
}
