//! More than one error of a script that cannot be read: the statement with the error is taken out, and what is left is
//! read again.

use rhai::{ParseError, ParseErrorType, Position};

use super::{clock::Clock, engine, errors, language::Language, names, session::Source};
use crate::{
    diag::{Code, Diagnostic},
    limits::Limits,
};

/// Errors told of at most. What comes after so many is mostly their consequence.
const MOST: usize = 10;

/// The errors of a script after its first, in the order of their places. Errors that may only be there because of what
/// was taken out are not among them.
pub(super) fn further_errors(
    first: &ParseError,
    source: &Source,
    limits: &Limits,
    language: &Language,
) -> Vec<Diagnostic> {
    let context = errors::Context {
        sources: std::slice::from_ref(source),
        limits,
        language,
        ast: None,
    };
    let declared = names::declared(&source.text);
    let mut text = source.text.to_string();
    let mut found = Vec::new();
    let mut position = first.1;
    // All of it takes no longer than the first reading may.
    let clock = Clock::start();
    while found.len() + 1 < MOST {
        let Some(at) = offset(&text, position) else { break };
        let end = blank_statement(&mut text, at);
        let limits = Limits {
            compile_time: limits.compile_time.saturating_sub(clock.elapsed()),
            ..limits.clone()
        };
        let Ok(Err(next)) = engine::compile(&text, &limits, language) else {
            break;
        };
        // Nothing more is to be learned where the place does not move on, or where the rest of the text makes no sense without what was taken out.
        if offset(&text, next.1).is_none_or(|next| next < end || next <= at) || is_about_the_end(&next) {
            break;
        }
        let is_consequence = match &*next.0 {
            ParseErrorType::VariableUndefined(name) => declared.contains(name),
            ParseErrorType::ModuleUndefined(_) => true,
            _ => false,
        };
        if !is_consequence {
            found.push(errors::of_parse(&next, &source.name, &context));
        }
        position = next.1;
    }
    found.retain(|d| d.code != Code::Limit);
    found
}

/// Errors that the missing part of the text may have caused anywhere before.
fn is_about_the_end(error: &ParseError) -> bool {
    matches!(&*error.0, ParseErrorType::UnexpectedEOF) || error.1.is_none()
}

/// The byte that a position stands for; `None` past the end of the text.
pub(super) fn offset(text: &str, position: Position) -> Option<usize> {
    let (line, column) = (position.line()?, position.position()?);
    let start = text
        .split_inclusive('\n')
        .take(line - 1)
        .map(str::len)
        .sum::<usize>();
    let rest = text.get(start..)?.lines().next()?;
    let (i, _) = rest.char_indices().nth(column.checked_sub(1)?)?;
    Some(start + i)
}

/// Replaces the statement around the byte `at` by blanks; lines stay lines. Returns where it ended.
fn blank_statement(text: &mut String, at: usize) -> usize {
    let marks = marks(text);
    let (before, after) = marks.split_at(marks.partition_point(|(i, _)| *i < at));
    let start = before.last().map_or(0, |(i, _)| i + 1);
    let mut end = text.len();
    let mut depth = 0usize;
    for &(i, mark) in after {
        match mark {
            '{' => depth += 1,
            ';' if depth == 0 => {
                end = i + 1;
                break;
            }
            // A brace that closes nothing is taken out itself.
            '}' if depth == 0 => {
                end = if i == at { i + 1 } else { i };
                break;
            }
            '}' => {
                depth -= 1;
                if depth == 0 && !goes_on(&text[i + 1..]) {
                    end = i + 1;
                    break;
                }
            }
            _ => {}
        }
    }
    let blanks: String = text[start..end]
        .chars()
        .flat_map(|c| {
            std::iter::repeat_n(
                if c == '\n' { '\n' } else { ' ' },
                if c == '\n' { 1 } else { c.len_utf8() },
            )
        })
        .collect();
    text.replace_range(start..end, &blanks);
    end
}

/// Whether a statement goes on after a closing brace.
fn goes_on(rest: &str) -> bool {
    let rest = rest.trim_start();
    rest.starts_with(|c: char| ")].,;=+-*/<>&|?".contains(c))
        && !rest.starts_with("//")
        && !rest.starts_with("/*")
        || ["else", "while", "until"].iter().any(|word| {
            rest.strip_prefix(word)
                .is_some_and(|r| !r.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        })
}

/// Where statements may begin and end.
fn marks(text: &str) -> Vec<(usize, char)> {
    let mut marks = signs(text);
    marks.retain(|(_, sign)| "{};".contains(*sign));
    marks
}

/// The bracket that is opened last and never closed, with its place.
pub(super) fn left_open(text: &str) -> Option<(usize, char)> {
    let mut open = Vec::new();
    for (i, sign) in signs(text) {
        match sign {
            '(' | '[' | '{' => open.push((i, sign)),
            ')' | ']' | '}' => drop(open.pop()),
            _ => {}
        }
    }
    open.pop()
}

/// Brackets and semicolons outside of comments and strings, with their places in bytes.
fn signs(text: &str) -> Vec<(usize, char)> {
    let mut marks = Vec::new();
    let mut chars = text.char_indices().peekable();
    while let Some((i, c)) = chars.next() {
        match (c, chars.peek().map(|(_, c)| *c)) {
            ('/', Some('/')) => while chars.next().is_some_and(|(_, c)| c != '\n') {},
            ('/', Some('*')) => {
                chars.next();
                let mut last = ' ';
                for (_, c) in chars.by_ref() {
                    if last == '*' && c == '/' {
                        break;
                    }
                    last = c;
                }
            }
            ('"' | '`' | '\'', _) => {
                while let Some((_, next)) = chars.next() {
                    match next {
                        '\\' if c != '`' => {
                            chars.next();
                        }
                        // A string that is not closed ends with its line.
                        '\n' if c != '`' => break,
                        next if next == c => break,
                        _ => {}
                    }
                }
            }
            ('{' | '}' | '(' | ')' | '[' | ']' | ';', _) => marks.push((i, c)),
            _ => {}
        }
    }
    marks
}

/// Line and column of a byte, from 1.
pub(super) fn position(text: &str, at: usize) -> Position {
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    match (u16::try_from(line), u16::try_from(column)) {
        (Ok(line), Ok(column)) => Position::new(line, column),
        _ => Position::NONE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blanked(text: &str, at: &str) -> String {
        let mut text = text.to_owned();
        let at = text.find(at).unwrap();
        let length = text.len();
        blank_statement(&mut text, at);
        assert_eq!(text.len(), length);
        text
    }

    #[test]
    fn a_statement_is_taken_out_whole() {
        assert_eq!(blanked("a; b c; d;", "c"), "a;     d;".replace("    ", "     "));
        assert_eq!(blanked("fn f() { x y; z; }", "y"), "fn f() {      z; }");
        assert_eq!(blanked("for i in 5 { a; b; } c;", "5").trim(), "c;");
        assert_eq!(blanked("if x { a } else { b } c;", "x").trim(), "c;");
        assert_eq!(blanked("f(|x| { a; b }, !); c;", "a"), "f(|x| {    b }, !); c;");
        assert_eq!(blanked("s(\"};\" 1); c;", "1").trim(), "c;");
        assert_eq!(
            blanked("s(/* ; } */ 1 2); // ; {\n c;", "2").trim(),
            "// ; {\n c;"
        );
        assert_eq!(blanked("é ü; c;", "ü").trim(), "c;");
    }

    #[test]
    fn places_are_found_in_characters() {
        let at = |line, column| offset("é(1);\n  ü;\n", Position::new(line, column));
        assert_eq!(at(1, 2), Some(2));
        assert_eq!(at(2, 4), Some(11));
        assert_eq!(at(3, 1), None);
        assert_eq!(at(1, 99), None);
    }
}
