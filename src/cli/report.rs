//! Diagnostics on a terminal: the source line, a caret under the place, notes, hints.

use std::io::Write;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use serde_json::json;

use super::args::MessageFormat;
use crate::diag::{Diagnostic, Error, Severity};

/// Longest message shown, in characters: a script can throw a text of megabytes.
const MESSAGE: usize = 4_000;

/// Writes to standard error, in color where that is a terminal and `NO_COLOR` is not set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reporter {
    quiet: bool,
    format: MessageFormat,
}

impl Reporter {
    /// A reporter; `quiet` ones show errors only.
    pub(super) fn new(quiet: bool, format: MessageFormat) -> Self {
        Self { quiet, format }
    }

    /// Whether people read it, so that a progress line is of use.
    pub(super) fn is_for_people(self) -> bool {
        !self.quiet && self.format == MessageFormat::Text
    }

    /// Shows the errors after the warnings that came before them.
    pub(super) fn error(self, error: &Error) {
        self.warnings(&error.warnings);
        error.all().for_each(|diagnostic| self.show(diagnostic));
    }

    /// Shows warnings.
    pub(super) fn warnings(self, warnings: &[Diagnostic]) {
        for warning in warnings {
            self.show(warning);
        }
    }

    fn show(self, diagnostic: &Diagnostic) {
        if self.quiet && diagnostic.severity == Severity::Warning {
            return;
        }
        self.write_line(&match self.format {
            MessageFormat::Text => {
                let mut text = text(diagnostic, &Renderer::styled());
                // What takes several lines is set apart from what follows.
                if text.contains('\n') {
                    text.push('\n');
                }
                text
            }
            MessageFormat::Json => as_json(diagnostic).to_string(),
        });
    }

    /// Writes a line that is no diagnostic, unless quiet.
    pub(super) fn line(self, text: &str) {
        if !self.quiet {
            self.write(text);
        }
    }

    /// Writes a line in any case.
    pub(super) fn write(self, text: &str) {
        match self.format {
            MessageFormat::Text => self.write_line(text),
            MessageFormat::Json => {
                self.write_line(&json!({ "severity": "info", "message": text }).to_string())
            }
        }
    }

    /// Writes a line that is JSON already where JSON is wanted.
    pub(super) fn write_line(self, text: &str) {
        // Where standard error is closed, nobody is left to tell.
        let _ = writeln!(anstream::stderr().lock(), "{text}");
    }
}

/// The diagnostic in colors, for a screen that is drawn as a whole; lines without an end of the last.
pub(super) fn colored(diagnostic: &Diagnostic) -> String {
    text(diagnostic, &Renderer::styled())
}

/// The diagnostic as one object. Without a place, file, line and column are null.
fn as_json(diagnostic: &Diagnostic) -> serde_json::Value {
    let known = |n: u32| (n > 0).then_some(n);
    json!({
        "severity": diagnostic.severity.name(),
        "kind": diagnostic.kind.name(),
        "code": diagnostic.code.name(),
        "message": diagnostic.message,
        "file": diagnostic.file.as_deref(),
        "line": known(diagnostic.line),
        "column": known(diagnostic.column),
        "source": diagnostic.source_line,
        "notes": diagnostic.notes,
        "hints": diagnostic.hints,
    })
}

/// The diagnostic as text of several lines, without a line end.
fn text(diagnostic: &Diagnostic, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let mut group = Group::with_title(
        level
            .primary_title(shortened(&diagnostic.message))
            .id(diagnostic.code.name()),
    );
    let path = diagnostic.file.as_deref().map(shortened);
    if let (Some(line), 1..) = (&diagnostic.source_line, diagnostic.line) {
        let line = shortened(line);
        let span = token(&line, diagnostic.column);
        group = group.element(
            Snippet::source(line)
                .line_start(diagnostic.line as usize)
                .path(path)
                .annotation(AnnotationKind::Primary.span(span)),
        );
    } else if let Some(path) = path {
        let mut origin = Origin::path(path);
        if diagnostic.line > 0 {
            origin = origin.line(diagnostic.line as usize);
        }
        if diagnostic.column > 0 {
            origin = origin.char_column(diagnostic.column as usize);
        }
        group = group.element(origin);
    }
    let notes = diagnostic
        .notes
        .iter()
        .map(|note| Level::NOTE.message(shortened(note)));
    let hints = diagnostic
        .hints
        .iter()
        .map(|hint| Level::HELP.message(shortened(hint)));
    renderer.render(&[group.elements(notes).elements(hints)])
}

/// Cut to length, and without what would steer the terminal or turn the direction of writing around: file names
/// and scripts may hold it.
pub(super) fn shortened(text: &str) -> String {
    let harmless = |c: char| match c {
        '\n' | '\t' => c,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => char::REPLACEMENT_CHARACTER,
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    };
    let mut chars = text.chars();
    let mut short: String = chars.by_ref().take(MESSAGE).map(harmless).collect();
    if chars.next().is_some() {
        short.push_str(" ...");
    }
    short
}

/// Byte range of the word, number or string at character `column` (from 1) of a line; the whole line without its
/// indentation where the column is unknown. Rhai and the importers give a point, a caret under a whole word is
/// easier to see.
pub(super) fn token(line: &str, column: u32) -> std::ops::Range<usize> {
    if column == 0 {
        let start = line.len() - line.trim_start().len();
        return start..line.trim_end().len().max(start);
    }
    let Some((start, first)) = line.char_indices().nth(column as usize - 1) else {
        return line.len()..line.len();
    };
    let rest = line[start..].char_indices().skip(1);
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let end = match first {
        '"' => rest
            .clone()
            .find(|(_, c)| *c == '"')
            .map_or(first.len_utf8(), |(i, _)| i + 1),
        c if is_word(c) => rest
            .clone()
            .find(|(_, c)| !is_word(*c))
            .map_or(line.len() - start, |(i, _)| i),
        c => c.len_utf8(),
    };
    start..start + end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{Code, ErrorKind};

    fn plain(diagnostic: &Diagnostic) -> String {
        text(diagnostic, &Renderer::plain())
    }

    #[test]
    fn the_excerpt_points_at_the_word() {
        let source = "size(4, 4);\n  pushTranform();\n";
        let d = Diagnostic::error(ErrorKind::Script, "unknown function 'pushTranform'")
            .class(Code::UnknownFunction)
            .at("a.rhai", 2, 3)
            .with_source(source)
            .note("called from line 9")
            .hint("did you mean pushTransform?");
        assert_eq!(
            plain(&d),
            "\
error[unknown-function]: unknown function 'pushTranform'
 --> a.rhai:2:3
  |
2 |   pushTranform();
  |   ^^^^^^^^^^^^
  |
  = note: called from line 9
  = help: did you mean pushTransform?"
        );
    }

    #[test]
    fn without_an_excerpt_the_place_remains() {
        let d = Diagnostic::error(ErrorKind::Input, "no faces").at("m.obj", 7, 0);
        assert_eq!(plain(&d), "error[malformed-file]: no faces\n--> m.obj:7");
        assert_eq!(
            plain(&Diagnostic::warning(Code::NoLight, "dark")),
            "warning[no-light]: dark"
        );
    }

    #[test]
    fn tokens() {
        let text = |line: &'static str, column| &line[token(line, column)];
        assert_eq!(text("sphere(1)", 1), "sphere");
        assert_eq!(text("x = \"a b\";", 5), "\"a b\"");
        assert_eq!(text("x = \"a b", 5), "\"");
        assert_eq!(text("é + ñandú", 5), "ñandú");
        assert_eq!(text("a + b", 3), "+");
        assert_eq!(text("  tri 1 2 3 ", 0), "tri 1 2 3");
        for beyond in [4, 99] {
            assert_eq!(text("abc", beyond), "");
        }
        assert_eq!(text("", 0), "");
    }

    #[test]
    fn hostile_text_neither_breaks_nor_colors_the_terminal() {
        for line in ["\t\u{1b}[31mred", "\u{202e}abc", "e\u{301}\u{301}", "", "日本語("] {
            for column in 0..8 {
                let d = Diagnostic::error(ErrorKind::Script, "x\u{1b}[31m\ny")
                    .at("a\u{1b}.rhai", 1, column)
                    .with_source(line)
                    .hint(line);
                let shown = plain(&d);
                assert!(!shown.contains(['\u{1b}', '\u{202e}']), "{shown}");
            }
        }
        let long = Diagnostic::error(ErrorKind::Script, "é".repeat(1_000_000));
        assert!(plain(&long).chars().count() < 4_100);
    }
}
