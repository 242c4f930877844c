//! What went wrong or looks wrong.

use std::{
    ffi::{CStr, CString, c_char},
    ptr,
};

use rtscript::{
    Error,
    diag::{Diagnostic, ErrorKind},
    host::HostError,
};

use crate::border::{ask, c_string, free};

/// How a function ended: well, or whose fault it was that it did not.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RtsStatus {
    /// It is done.
    Ok = 0,
    /// The script or the scene that it describes is wrong.
    Script = 1,
    /// A file that was to be read is missing or malformed.
    Input = 2,
    /// The picture cannot be written.
    Output = 3,
    /// A limit was reached; the message names it.
    Limit = 4,
    /// The script asked for what it may not have, such as a file outside of its folder.
    Denied = 5,
    /// It was stopped by the progress callback or by rts_options_cancel.
    Cancelled = 6,
    /// A fault of rtscript's own.
    Internal = 7,
    /// A fault of the caller: a NULL where a value is needed, a text that is not UTF-8, an unknown number.
    Argument = 8,
}

impl From<ErrorKind> for RtsStatus {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Script => Self::Script,
            ErrorKind::Input => Self::Input,
            ErrorKind::Output => Self::Output,
            ErrorKind::Limit => Self::Limit,
            ErrorKind::Denied => Self::Denied,
            ErrorKind::Cancelled => Self::Cancelled,
            ErrorKind::Internal => Self::Internal,
        }
    }
}

/// One message with its place: an error or a warning.
#[derive(Debug)]
pub struct RtsDiagnostic {
    code: CString,
    message: CString,
    file: Option<CString>,
    line: u32,
    column: u32,
    source_line: Option<CString>,
    notes: Vec<CString>,
    hints: Vec<CString>,
    text: CString,
}

impl RtsDiagnostic {
    pub(crate) fn list(diagnostics: &[Diagnostic]) -> Vec<Self> {
        diagnostics.iter().map(Self::from).collect()
    }
}

impl From<&Diagnostic> for RtsDiagnostic {
    fn from(diagnostic: &Diagnostic) -> Self {
        let all = |texts: &[String]| texts.iter().map(|text| c_string(text)).collect();
        Self {
            code: c_string(diagnostic.code.name()),
            message: c_string(&diagnostic.message),
            file: diagnostic.file.as_deref().map(c_string),
            line: diagnostic.line,
            column: diagnostic.column,
            source_line: diagnostic.source_line.as_deref().map(c_string),
            notes: all(&diagnostic.notes),
            hints: all(&diagnostic.hints),
            text: c_string(&diagnostic.to_string()),
        }
    }
}

/// Why something was not done: one error or several, and the warnings that came before.
#[derive(Debug)]
pub struct RtsError {
    pub(crate) status: RtsStatus,
    text: CString,
    diagnostics: Vec<RtsDiagnostic>,
    warnings: Vec<RtsDiagnostic>,
}

impl RtsError {
    /// A fault of the caller.
    pub(crate) fn argument(message: impl Into<String>) -> Self {
        let mut error = Self::from(Error::from(Diagnostic::error(ErrorKind::Script, message)));
        error.status = RtsStatus::Argument;
        for diagnostic in &mut error.diagnostics {
            diagnostic.code = c_string("argument");
        }
        error
    }

    /// A fault of rtscript's own that was caught at the border.
    pub(crate) fn internal() -> Self {
        let what = "a fault of rtscript's own, in its C API";
        Error::from(Diagnostic::error(ErrorKind::Internal, what).hint("please report this, with the script"))
            .into()
    }
}

impl From<Error> for RtsError {
    fn from(error: Error) -> Self {
        Self {
            status: error.kind().into(),
            text: c_string(&error.to_string()),
            diagnostics: error.all().map(RtsDiagnostic::from).collect(),
            warnings: RtsDiagnostic::list(&error.warnings),
        }
    }
}

impl From<HostError> for RtsError {
    fn from(error: HostError) -> Self {
        Error::from(Diagnostic::error(error.kind, error.message)).into()
    }
}

/// The place of a text; NULL where there is none.
pub(crate) fn pointer(text: Option<&CString>) -> *const c_char {
    text.map_or(ptr::null(), |text| text.as_ptr())
}

/// The place of one of several; NULL past their end.
pub(crate) fn nth(all: &[RtsDiagnostic], index: usize) -> *const RtsDiagnostic {
    all.get(index).map_or(ptr::null(), ptr::from_ref)
}

/// A word for a status: "ok", "script", "input", "output", "limit", "denied", "cancelled", "internal", "argument".
/// Is never freed.
#[unsafe(no_mangle)]
pub extern "C" fn rts_status_name(status: u32) -> *const c_char {
    let name: &CStr = match status {
        0 => c"ok",
        1 => c"script",
        2 => c"input",
        3 => c"output",
        4 => c"limit",
        5 => c"denied",
        6 => c"cancelled",
        7 => c"internal",
        8 => c"argument",
        _ => c"unknown",
    };
    name.as_ptr()
}

/// Ends an error, and with it all its texts and diagnostics.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_free(error: *mut RtsError) {
    // SAFETY: a handle is NULL or came from here, and its user is done with it.
    unsafe { free(error) }
}

/// Whose fault it was: what the function that failed has returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_status(error: *const RtsError) -> RtsStatus {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, RtsStatus::Ok, |error| error.status) }
}

/// All errors as text of several lines, as a compiler writes them: place, message, notes, hints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_text(error: *const RtsError) -> *const c_char {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, ptr::null(), |error| error.text.as_ptr()) }
}

/// How many errors there are, at least 1: what ended the run, then what else is wrong with the script.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_count(error: *const RtsError) -> usize {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, 0, |error| error.diagnostics.len()) }
}

/// One of the errors, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_diagnostic(error: *const RtsError, index: usize) -> *const RtsDiagnostic {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, ptr::null(), |error| nth(&error.diagnostics, index)) }
}

/// How many warnings came before the error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_warning_count(error: *const RtsError) -> usize {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, 0, |error| error.warnings.len()) }
}

/// One of the warnings that came before the error, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_error_warning(error: *const RtsError, index: usize) -> *const RtsDiagnostic {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(error, ptr::null(), |error| nth(&error.warnings, index)) }
}

/// The class, which stays where words change: "unknown-function"; `rtscript help CLASS` explains it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_code(diagnostic: *const RtsDiagnostic) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| d.code.as_ptr()) }
}

/// What is wrong, in one line.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_message(diagnostic: *const RtsDiagnostic) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| d.message.as_ptr()) }
}

/// The file that it is about, under the name it was given or named by; NULL where there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_file(diagnostic: *const RtsDiagnostic) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| pointer(d.file.as_ref())) }
}

/// The line, from 1; 0 where unknown.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_line(diagnostic: *const RtsDiagnostic) -> u32 {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, 0, |d| d.line) }
}

/// The column in characters, from 1; 0 where unknown.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_column(diagnostic: *const RtsDiagnostic) -> u32 {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, 0, |d| d.column) }
}

/// The text of that line; NULL where unknown.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_source_line(diagnostic: *const RtsDiagnostic) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| pointer(d.source_line.as_ref())) }
}

/// How many notes there are: further facts, such as the calls that led here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_note_count(diagnostic: *const RtsDiagnostic) -> usize {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, 0, |d| d.notes.len()) }
}

/// One of the notes, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_note(
    diagnostic: *const RtsDiagnostic,
    index: usize,
) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| pointer(d.notes.get(index))) }
}

/// How many hints there are: what to write instead.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_hint_count(diagnostic: *const RtsDiagnostic) -> usize {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, 0, |d| d.hints.len()) }
}

/// One of the hints, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_hint(
    diagnostic: *const RtsDiagnostic,
    index: usize,
) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| pointer(d.hints.get(index))) }
}

/// All of it as text of several lines, as a compiler writes it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_diagnostic_text(diagnostic: *const RtsDiagnostic) -> *const c_char {
    // SAFETY: a diagnostic is NULL or one of a live handle.
    unsafe { ask(diagnostic, ptr::null(), |d| d.text.as_ptr()) }
}
