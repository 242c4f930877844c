//! Lines, words and numbers of a text file, and where in it a word stands.

use crate::diag::{Diagnostic, ErrorKind, SourceLoc};

/// A text file that is being read. Words taken from it are slices of it, so that a place need only be worked
/// out for the few that turn out wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    /// What the file is called.
    pub(super) name: &'a str,
    /// Its text without a byte order mark.
    pub(super) text: &'a str,
    /// Whose fault an error in it is.
    pub(super) kind: ErrorKind,
}

impl<'a> Source<'a> {
    pub(super) fn new(name: &'a str, text: &'a str, kind: ErrorKind) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { name, text, kind }
    }

    /// An error at `part`, which must be a slice of the text.
    pub(super) fn error(&self, part: &str, message: impl Into<String>) -> Diagnostic {
        self.place(Diagnostic::error(self.kind, message), part)
    }

    /// An error at a word that should have been a number.
    pub(super) fn no_number(&self, word: &str, message: impl Into<String>) -> Diagnostic {
        let error = self.error(word, message);
        match instead_of(word) {
            Some(hint) => error.hint(hint),
            None => error,
        }
    }

    /// Gives a diagnostic the place of `part`, which must be a slice of the text.
    pub(super) fn place(&self, diagnostic: Diagnostic, part: &str) -> Diagnostic {
        let (line, column, text) = self.find(part);
        let mut diagnostic = diagnostic.at(self.name, line, column);
        diagnostic.source_line = Some(text.chars().take(400).collect());
        diagnostic
    }

    /// The place of `part`, a slice of the text, in the file with index `file`.
    pub(super) fn loc(&self, part: &str, file: u16) -> SourceLoc {
        let (line, column, _) = self.find(part);
        SourceLoc {
            line,
            column: u16::try_from(column).unwrap_or(u16::MAX),
            file,
        }
    }

    /// Line and column of `part` from 1, and the line's text.
    fn find(&self, part: &str) -> (u32, u32, &'a str) {
        let offset = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        let mut last = (1, 1, "");
        for (number, line) in (1u32..).zip(lines(self.text)) {
            let start = line.as_ptr() as usize - self.text.as_ptr() as usize;
            if start > offset {
                break;
            }
            let before = line.get(..offset - start).unwrap_or(line);
            last = (number, count(before.chars()) + 1, line);
        }
        last
    }
}

fn count(items: impl Iterator) -> u32 {
    u32::try_from(items.count()).unwrap_or(u32::MAX)
}

/// The lines of a text, ended by LF, by CR LF or by CR alone.
pub(super) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest?;
        let Some(end) = text.bytes().position(|b| matches!(b, b'\n' | b'\r')) else {
            rest = None;
            return (!text.is_empty()).then_some(text);
        };
        let (line, after) = text.split_at(end);
        rest = Some(
            after
                .strip_prefix("\r\n")
                .unwrap_or_else(|| after.get(1..).unwrap_or("")),
        );
        Some(line)
    })
}

/// The words of a line up to a comment: a word that begins with `#`.
pub(super) fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split_ascii_whitespace()
        .take_while(|word| !word.starts_with('#'))
}

/// A word as it is shown in a message: in quotes, not too long, nothing that would upset a terminal.
pub(super) fn quoted(word: &str) -> String {
    let mut shown: String = word.chars().take(40).flat_map(printable).collect();
    if word.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    format!("'{shown}'")
}

fn printable(c: char) -> impl Iterator<Item = char> {
    let (plain, escaped) = if c.is_control() {
        (None, Some(c.escape_default()))
    } else {
        (Some(c), None)
    };
    plain.into_iter().chain(escaped.into_iter().flatten())
}

/// A number within 1e15.
///
/// # Errors
/// With what was wrong: no number at all, or not finite or too large.
pub(super) fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(x) if x.abs() <= 1e15 => Ok(x),
        Ok(_) => Err(format!("expected a number within 1e15, found {}", quoted(word))),
        Err(_) => Err(format!("expected a number, found {}", quoted(word))),
    }
}

/// What is to be done about a word that should have been a number, where it is told by its signs.
fn instead_of(word: &str) -> Option<&'static str> {
    let digits = |part: &str| part.chars().any(|c| c.is_ascii_digit());
    if let Some(rest) = word.strip_suffix(';') {
        return digits(rest).then_some("a line ends without a ';'");
    }
    if word.contains(['(', ')', '[', ']', '<', '>']) {
        return digits(word).then_some("values stand without brackets around them");
    }
    match word.split_once(',') {
        Some((_, "")) => Some("values are separated by blanks, without commas"),
        Some((_, rest)) if digits(rest) => {
            Some("values are separated by blanks, and fractions are written with a point: 1.5")
        }
        _ => None,
    }
}

/// A whole number, 0 or greater.
///
/// # Errors
/// As [`number`], and where it is negative or has a fraction.
pub(super) fn whole(word: &str) -> Result<u64, String> {
    let x = number(word)?;
    if x < 0.0 || x.fract() != 0.0 {
        return Err(format!(
            "expected a whole number, 0 or greater, found {}",
            quoted(word)
        ));
    }
    Ok(x as u64)
}

/// `1 value`, `2 values`.
pub(super) fn counted(n: usize, one: &str, many: &str) -> String {
    match n {
        1 => format!("1 {one}"),
        n => format!("{n} {many}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_end_ends_a_line_once() {
        for text in ["a\nb\n\nc", "a\r\nb\r\n\r\nc", "a\rb\r\rc", "a\nb\r\n\rc\n"] {
            assert_eq!(lines(text).collect::<Vec<_>>(), ["a", "b", "", "c"], "{text:?}");
        }
        assert_eq!(lines("").count(), 0);
    }

    #[test]
    fn places_count_characters_from_one() {
        let source = Source::new("x.obj", "\u{feff}v 1\r\n\u{e9} 2 bad\r3", ErrorKind::Input);
        let bad = source.text.split_ascii_whitespace().nth(4).unwrap();
        assert_eq!(bad, "bad");
        let error = source.error(bad, "no");
        assert_eq!((error.line, error.column), (2, 5));
        assert_eq!(error.source_line.as_deref(), Some("\u{e9} 2 bad"));
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number("+.5"), Ok(0.5));
        assert_eq!(number("-1e3"), Ok(-1000.0));
        for bad in ["nan", "inf", "-infinity", "1e400", "1e16"] {
            assert_eq!(
                number(bad).unwrap_err(),
                format!("expected a number within 1e15, found '{bad}'")
            );
        }
        for bad in ["", "1,5", "x", "0x10", "1_000"] {
            assert_eq!(
                number(bad).unwrap_err(),
                format!("expected a number, found '{bad}'")
            );
        }
        assert!(whole("1.5").is_err() && whole("-1").is_err());
        assert_eq!(whole("8.0"), Ok(8));
    }

    #[test]
    fn messages_show_no_control_characters() {
        assert_eq!(quoted("a\u{1b}[2J"), "'a\\u{1b}[2J'");
        assert_eq!(quoted(&"x".repeat(50)), format!("'{}...'", "x".repeat(40)));
    }
}
