//! What went wrong or looks wrong, as the classes of `python/rtscript/_errors.py`.

use pyo3::{
    prelude::*,
    types::{PyDict, PyTuple},
};
use rtscript::{Error, diag::Diagnostic};

fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("rtscript._errors")?.getattr(name)
}

/// One `Diagnostic`.
fn to_python<'py>(py: Python<'py>, diagnostic: &Diagnostic) -> PyResult<Bound<'py, PyAny>> {
    let known = |n: u32| (n > 0).then_some(n);
    let fields = PyDict::new(py);
    fields.set_item("severity", diagnostic.severity.name())?;
    fields.set_item("kind", diagnostic.kind.name())?;
    fields.set_item("code", diagnostic.code.name())?;
    fields.set_item("message", &diagnostic.message)?;
    fields.set_item("file", diagnostic.file.as_deref())?;
    fields.set_item("line", known(diagnostic.line))?;
    fields.set_item("column", known(diagnostic.column))?;
    fields.set_item("source_line", diagnostic.source_line.as_deref())?;
    fields.set_item("notes", PyTuple::new(py, &diagnostic.notes)?)?;
    fields.set_item("hints", PyTuple::new(py, &diagnostic.hints)?)?;
    fields.set_item("text", diagnostic.to_string())?;
    class(py, "Diagnostic")?.call((), Some(&fields))
}

/// Several of them.
pub(crate) fn list<'py>(py: Python<'py>, diagnostics: &[Diagnostic]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    diagnostics
        .iter()
        .map(|diagnostic| to_python(py, diagnostic))
        .collect()
}

/// The exception for an error.
pub(crate) fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let make = || -> PyResult<PyErr> {
        let all: Vec<Diagnostic> = error.all().cloned().collect();
        let errors = PyTuple::new(py, list(py, &all)?)?;
        let warnings = PyTuple::new(py, list(py, &error.warnings)?)?;
        Ok(PyErr::from_value(class(py, "Error")?.call1((errors, warnings))?))
    };
    make().unwrap_or_else(|e: PyErr| e)
}
