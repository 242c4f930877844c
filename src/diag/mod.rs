//! What went wrong or looks wrong, and where: one type for scripts, importers, validation and rendering.
//!
//! The library never prints. Errors come back as [`Error`], warnings beside the value in a [`Report`]; the
//! command turns both into text for a terminal. Messages are lower case without a full stop and say what was
//! expected; hints say what to write instead.

mod code;
mod near;

pub use code::Code;
pub use near::nearest_names;

use std::{fmt, sync::Arc};

/// A place in a source file. Lines and columns count from 1; 0 means unknown.
///
/// ```
/// use rtscript::{Builder, DVec3, diag::SourceLoc};
/// let mut b = Builder::new();
/// let file = b.file("made.txt");
/// b.set_loc(SourceLoc { file, line: 7, column: 1 });
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// assert_eq!(scene.root().objects[0].loc.line, 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SourceLoc {
    /// Line, from 1; 0 where unknown.
    pub line: u32,
    /// Column in characters, from 1; 0 where unknown.
    pub column: u16,
    /// Index into [`Scene::files`](crate::Scene::files).
    pub file: u16,
}

/// Whether the run can go on.
///
/// ```
/// use rtscript::diag::{Code, Diagnostic, ErrorKind, Severity};
/// assert_eq!(Diagnostic::error(ErrorKind::Input, "no such file").severity, Severity::Error);
/// assert_eq!(Diagnostic::warning(Code::NoLight, "there is no light").severity, Severity::Warning);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The run ends without a picture.
    Error,
    /// The picture is made, but may not be what was meant.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// Whose fault an error is; the command's exit code follows from it.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, Script, diag::ErrorKind};
/// let script = Script::compile("a.rhai", "loop { }", &Limits::untrusted())?;
/// let error = script.run(&NoHost, &RunOptions::default()).unwrap_err();
/// assert_eq!(error.kind(), ErrorKind::Limit);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The script or the scene it describes is wrong.
    Script,
    /// A file that was to be read is missing or malformed.
    Input,
    /// The picture cannot be written.
    Output,
    /// A limit was reached.
    Limit,
    /// The host refuses access.
    Denied,
    /// The host asked to stop.
    Cancelled,
    /// A fault of rtscript's own.
    Internal,
}

impl ErrorKind {
    /// One word in lower case, such as `script` or `limit`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Script => "script",
            Self::Input => "input",
            Self::Output => "output",
            Self::Limit => "limit",
            Self::Denied => "denied",
            Self::Cancelled => "cancelled",
            Self::Internal => "internal",
        }
    }
}

/// One message with its place.
///
/// ```
/// use rtscript::diag::{Diagnostic, ErrorKind};
/// let fault = Diagnostic::error(ErrorKind::Input, "3 numbers were expected, not 2")
///     .at("model.obj", 7, 3)
///     .with_source("v 1 2")
///     .note("a vertex has a place in space")
///     .hint("write v 1 2 0");
/// assert!(fault.to_string().starts_with("model.obj:7:3: error: 3 numbers were expected, not 2"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Whose fault it is.
    pub kind: ErrorKind,
    /// Which class of errors or warnings it belongs to.
    pub code: Code,
    /// What is wrong: lower case, no full stop. [`Diagnostic::error`] puts it on one line of at most 4096 bytes and
    /// escapes control characters, and so it is with notes and hints; what a script throws may hold any.
    pub message: String,
    /// The file as its reader knows it (never an absolute path made up by the library).
    pub file: Option<Arc<str>>,
    /// Line from 1, 0 where unknown.
    pub line: u32,
    /// Column in characters from 1, 0 where unknown.
    pub column: u32,
    /// The text of that line, for the excerpt.
    pub source_line: Option<String>,
    /// Further facts, such as the calls that led here.
    pub notes: Vec<String>,
    /// What to do about it.
    pub hints: Vec<String>,
}

impl Diagnostic {
    /// An error without a place yet.
    #[must_use]
    pub fn error(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            kind,
            code: kind.into(),
            message: on_one_line(message.into()),
            file: None,
            line: 0,
            column: 0,
            source_line: None,
            notes: Vec::new(),
            hints: Vec::new(),
        }
    }

    /// A warning of the class `code` without a place yet.
    #[must_use]
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            code,
            ..Self::error(ErrorKind::Script, message)
        }
    }

    /// Puts it into a class narrower than that of its kind.
    #[must_use]
    pub fn class(mut self, code: Code) -> Self {
        self.code = code;
        self
    }

    /// The same as a warning: what would be an error if the run came by.
    ///
    /// ```
    /// use rtscript::diag::{Code, Diagnostic, ErrorKind, Severity};
    /// // A reader that goes on where it could end.
    /// let fault = Diagnostic::error(ErrorKind::Input, "the color has four numbers").class(Code::IgnoredInput);
    /// let warning = fault.as_warning();
    /// assert_eq!((warning.severity, warning.code), (Severity::Warning, Code::IgnoredInput));
    /// ```
    #[must_use]
    pub fn as_warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }

    /// Adds the place. `line` and `column` count from 1.
    #[must_use]
    pub fn at(mut self, file: &str, line: u32, column: u32) -> Self {
        self.file = Some(file.into());
        self.line = line;
        self.column = column;
        self
    }

    /// Takes the excerpt from the file's whole text, where the line is known.
    #[must_use]
    pub fn with_source(mut self, text: &str) -> Self {
        if self.line > 0 {
            self.source_line = text
                .lines()
                .nth(self.line as usize - 1)
                .map(|line| line.chars().take(400).collect());
        }
        self
    }

    /// Adds a hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(on_one_line(hint.into()));
        self
    }

    /// Adds a note.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(on_one_line(note.into()));
        self
    }
}

/// Most bytes of a message: what it quotes may be megabytes.
const LONGEST: usize = 4096;

/// A text on one line without what would upset a terminal, and not too long: scripts, files and their names say what
/// they like.
pub(crate) fn on_one_line(text: String) -> String {
    if text.len() <= LONGEST && !text.chars().any(char::is_control) {
        return text;
    }
    let mut line = String::new();
    for c in text.chars() {
        if line.len() > LONGEST - 16 {
            line.push_str("...");
            break;
        }
        match c {
            '\t' | '\n' | '\r' => line.push(' '),
            c if c.is_control() => line.extend(c.escape_default()),
            c => line.push(c),
        }
    }
    line
}

/// `file:line:column: error: message`, then notes and hints on lines of their own.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{file}:")?;
            match (self.line, self.column) {
                (0, _) => {}
                (line, 0) => write!(f, "{line}:")?,
                (line, column) => write!(f, "{line}:{column}:")?,
            }
            write!(f, " ")?;
        }
        write!(f, "{}: {}", self.severity.name(), self.message)?;
        for note in &self.notes {
            write!(f, "\n  note: {note}")?;
        }
        for hint in &self.hints {
            write!(f, "\n  help: {hint}")?;
        }
        Ok(())
    }
}

/// Why a run gave no result: the error, what else is wrong, and the warnings that came before it.
///
/// ```
/// use rtscript::{Limits, Script};
/// let error = Script::compile("a.rhai", "sphere(0, 0, 0, 1;", &Limits::default()).unwrap_err();
/// assert_eq!((error.diagnostic.line, error.all().count()), (1, 1));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// What ended the run.
    pub diagnostic: Box<Diagnostic>,
    /// Further errors that were found in the script without running it, in the order of their places.
    pub more: Vec<Diagnostic>,
    /// Warnings up to then.
    pub warnings: Vec<Diagnostic>,
}

impl Error {
    /// All errors: what ended the run, then what else is wrong.
    pub fn all(&self) -> impl Iterator<Item = &Diagnostic> {
        std::iter::once(&*self.diagnostic).chain(&self.more)
    }

    /// Whose fault it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.diagnostic.kind
    }
}

impl From<Diagnostic> for Error {
    fn from(diagnostic: Diagnostic) -> Self {
        Self {
            diagnostic: Box::new(diagnostic),
            more: Vec::new(),
            warnings: Vec::new(),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)?;
        self.more
            .iter()
            .try_for_each(|diagnostic| write!(f, "\n{diagnostic}"))
    }
}

impl std::error::Error for Error {}

/// A value with the warnings that came up on the way to it.
///
/// ```
/// use rtscript::{Builder, Report};
/// let Report { value: scene, warnings } = Builder::new().finish();
/// // It has a default camera, and nothing that it could see.
/// assert!(scene.root().objects.is_empty());
/// println!("{} warnings", warnings.len());
/// ```
#[derive(Clone, Debug)]
pub struct Report<T> {
    /// The result.
    pub value: T,
    /// What looked wrong without ending the run.
    pub warnings: Vec<Diagnostic>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_of_bounded_length_without_control_characters() {
        let d = Diagnostic::error(ErrorKind::Input, "cannot read 'a\u{1b}[2J\n\u{e9}'")
            .note("\u{7}")
            .hint("a\r");
        assert_eq!(d.message, "cannot read 'a\\u{1b}[2J \u{e9}'");
        assert_eq!((&*d.notes[0], &*d.hints[0]), ("\\u{7}", "a "));
        let long = Diagnostic::error(ErrorKind::Script, "\u{e9}".repeat(5000)).message;
        assert!(
            long.ends_with("\u{e9}...") && (4070..=4096).contains(&long.len()),
            "{}",
            long.len()
        );
    }

    #[test]
    fn a_diagnostic_reads_like_a_compilers() {
        let d = Diagnostic::error(ErrorKind::Script, "radius must be greater than 0")
            .at("a.rhai", 3, 8)
            .hint("write sphere(0, 0, 0, 1)");
        assert_eq!(
            d.to_string(),
            "a.rhai:3:8: error: radius must be greater than 0\n  help: write sphere(0, 0, 0, 1)"
        );
    }
}
