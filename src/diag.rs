//! What went wrong or looks wrong, and where: one type for scripts, importers, validation and rendering.
//!
//! The library never prints. Errors come back as [`Error`], warnings beside the value in a [`Report`]; the
//! command turns both into text for a terminal. Messages are lower case without a full stop and say what was
//! expected; hints say what to write instead.

use std::{fmt, sync::Arc};

/// A place in a source file. Lines and columns count from 1; 0 means unknown.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The run ends without a picture.
    Error,
    /// The picture is made, but may not be what was meant.
    Warning,
}

/// Whose fault an error is; the command's exit code follows from it.
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

/// One message with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Whose fault it is.
    pub kind: ErrorKind,
    /// What is wrong: lower case, no full stop.
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
            message: message.into(),
            file: None,
            line: 0,
            column: 0,
            source_line: None,
            notes: Vec::new(),
            hints: Vec::new(),
        }
    }

    /// A warning without a place yet.
    #[must_use]
    pub fn warning(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(ErrorKind::Script, message)
        }
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
        self.hints.push(hint.into());
        self
    }

    /// Adds a note.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
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
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}: {}", self.message)?;
        for note in &self.notes {
            write!(f, "\n  note: {note}")?;
        }
        for hint in &self.hints {
            write!(f, "\n  help: {hint}")?;
        }
        Ok(())
    }
}

/// Why a run gave no result: the error, and the warnings that came before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// What ended the run.
    pub diagnostic: Box<Diagnostic>,
    /// Warnings up to then.
    pub warnings: Vec<Diagnostic>,
}

impl Error {
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
            warnings: Vec::new(),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl std::error::Error for Error {}

/// A value with the warnings that came up on the way to it.
#[derive(Clone, Debug)]
pub struct Report<T> {
    /// The result.
    pub value: T,
    /// What looked wrong without ending the run.
    pub warnings: Vec<Diagnostic>,
}

/// The candidates nearest to a misspelt `name`, best first, at most three; for "did you mean".
///
/// Distance is Damerau-Levenshtein on lower-case text without underscores, so that `push_transform` and
/// `pushtransform` both find `pushTransform`. Names of more than 256 bytes are near to nothing.
#[must_use]
pub fn nearest_names<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let fold = |s: &str| {
        s.chars()
            .filter(|c| *c != '_')
            .flat_map(char::to_lowercase)
            .collect::<Vec<_>>()
    };
    // Names come from files too, and the table of distances is as large as the product of both lengths.
    if name.len() > 256 {
        return Vec::new();
    }
    let wanted = fold(name);
    let bound = (wanted.len() / 3).max(1);
    let mut found: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= 256)
        .map(|candidate| (edit_distance(&wanted, &fold(candidate)), candidate))
        .filter(|(distance, _)| *distance <= bound)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
        .into_iter()
        .take(3)
        .map(|(_, candidate)| candidate)
        .collect()
}

/// Number of insertions, deletions, replacements and swaps of neighbours between two words (Damerau, 1964).
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let width = b.len() + 1;
    let mut table = vec![0; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = table[(i - 1) * width + j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut best = replaced
                    .min(table[(i - 1) * width + j] + 1)
                    .min(table[i * width + j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(table[(i - 2) * width + j - 2] + 1);
                }
                best
            };
        }
    }
    table[table.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_names_see_through_case_and_underscores() {
        let names = ["pushTransform", "popTransform", "sphere", "scale", "diffuse"];
        assert_eq!(
            nearest_names("push_transform", names),
            ["pushTransform", "popTransform"]
        );
        assert_eq!(nearest_names("shpere", names), ["sphere"]);
        assert_eq!(nearest_names("difuse", names), ["diffuse"]);
        assert!(nearest_names("quaternion", names).is_empty());
        let long = "x".repeat(1 << 20);
        assert!(nearest_names(&long, [long.as_str()]).is_empty());
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
