//! What a scene cannot hold.

use std::fmt;

use crate::diag::{Code, Diagnostic, ErrorKind};

/// A value the scene cannot hold. It carries no place: the caller knows the line.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Whose fault it is, usually [`ErrorKind::Script`].
    pub kind: ErrorKind,
    /// Which class of errors it belongs to.
    pub code: Code,
    /// What is wrong: lower case, no full stop.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl SceneError {
    /// A scene error.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Script,
            code: Code::InvalidValue,
            message: message.into(),
            hint: None,
        }
    }

    /// A limit was reached: its name in [`Limits`](crate::Limits) and its value.
    ///
    /// ```
    /// use rtscript::scene::SceneError;
    /// let error = SceneError::limit("too many stars", "stars", 1000);
    /// assert!(error.to_string().contains("'stars' is 1000"), "{error}");
    /// ```
    #[must_use]
    pub fn limit(what: &str, name: &str, value: impl fmt::Display) -> Self {
        Self {
            kind: ErrorKind::Limit,
            code: Code::Limit,
            message: format!("{what}: the limit '{name}' is {value}"),
            hint: None,
        }
    }

    /// Puts it into a narrower class.
    #[must_use]
    pub(crate) fn class(self, code: Code) -> Self {
        Self { code, ..self }
    }

    /// Says which of several things it is about: "sphere 3: ..." for an error of the third sphere of a list.
    #[must_use]
    pub(crate) fn of(self, which: fmt::Arguments<'_>) -> Self {
        Self {
            message: format!("{which}: {}", self.message),
            ..self
        }
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for SceneError {}

impl From<SceneError> for Diagnostic {
    fn from(e: SceneError) -> Self {
        let diagnostic = Self::error(e.kind, e.message).class(e.code);
        match e.hint {
            Some(hint) => diagnostic.hint(hint),
            None => diagnostic,
        }
    }
}
