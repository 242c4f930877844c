//! From text to a run.

use std::{collections::BTreeMap, path::PathBuf};

use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::{PyBool, PyDict, PyFloat, PyInt, PyString},
};
use rtscript::{Limits, MemoryHost, RenderOptions, RunOptions, parameters::Parameters};

use crate::{
    diagnostic::exception,
    host::{Files, Guest},
    run::Run,
};

/// Most threads of one render: far more than make it faster anywhere.
const MOST_THREADS: usize = 1024;

/// A script that has been read and can be run any number of times, by several threads at once.
///
/// Script(text, *, name="scene.rhai", limits="default")
///
/// `name` is the file as messages are to call it. `limits` are "default", for one's own scripts, or "untrusted", for
/// those of strangers; they hold for its runs, too. Raises Error where the text is no script.
#[pyclass(frozen, module = "rtscript")]
pub(crate) struct Script {
    script: rtscript::Script,
}

#[pymethods]
impl Script {
    #[new]
    #[pyo3(signature = (text, *, name = "scene.rhai", limits = "default"))]
    fn new(py: Python<'_>, text: &str, name: &str, limits: &str) -> PyResult<Self> {
        let limits = match limits {
            "default" => Limits::default(),
            "untrusted" => Limits::untrusted(),
            other => {
                let what = format!("expected \"default\" or \"untrusted\" as limits, not {other:?}");
                return Err(PyValueError::new_err(what));
            }
        };
        let script = py
            .detach(|| rtscript::Script::compile(name, text, &limits))
            .map_err(|error| exception(py, &error))?;
        Ok(Self { script })
    }

    /// The name it was read under.
    #[getter]
    fn name(&self) -> &str {
        self.script.name()
    }

    /// Runs it up to the complete scene.
    ///
    /// `parameters` are values of what the script declares by `param(name, default)`: numbers, booleans or texts.
    /// `size` (width, height), `samples` and `seed` take the place of what the script says. It reads the files of
    /// `files` (relative path to bytes) and those below `folder`; without both, none. `print` is called with each line
    /// that it prints. `progress` and `threads` count for what it renders by `render()`; see Run.render.
    ///
    /// Other threads run meanwhile. Raises Error, and whatever a callback raises, which ends the run, as Ctrl-C does.
    #[pyo3(signature = (
        parameters = None, *, size = None, samples = None, seed = None, folder = None, files = None, print = None,
        progress = None, threads = 0
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn run(
        &self,
        py: Python<'_>,
        parameters: Option<&Bound<'_, PyAny>>,
        size: Option<(u32, u32)>,
        samples: Option<u32>,
        seed: Option<u64>,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
        print: Option<Py<PyAny>>,
        progress: Option<Py<PyAny>>,
        threads: usize,
    ) -> PyResult<Run> {
        let mut decided = Parameters::default();
        (decided.size, decided.samples, decided.seed) = (size, samples, seed);
        if let Some(parameters) = parameters {
            for (name, value) in entries(py, parameters)? {
                let value = as_text(&name, &value)?;
                decided.set(&name, &value).map_err(|what| {
                    PyValueError::new_err(format!("the parameter '{name}' cannot be '{value}': {what}"))
                })?;
            }
        }
        let mut options = RunOptions::from(&decided);
        options.render = render_options(threads)?;
        let memory = files.map(|files| {
            let mut memory = MemoryHost::new();
            files
                .into_iter()
                .for_each(|(path, bytes)| memory.insert(&path, bytes));
            memory
        });
        let guest = Guest::new(Files { memory, folder }, print, progress);
        let report = guest.detached(py, |guest| self.script.run(guest, &options))?;
        Ok(Run::new(report))
    }

    fn __repr__(&self) -> String {
        format!("<rtscript.Script {:?}>", self.script.name())
    }
}

/// The options of a render on so many threads.
pub(crate) fn render_options(threads: usize) -> PyResult<RenderOptions> {
    if threads > MOST_THREADS {
        let what = format!("expected at most {MOST_THREADS} threads, not {threads}");
        return Err(PyValueError::new_err(what));
    }
    let mut options = RenderOptions::default();
    options.threads = threads;
    Ok(options)
}

/// Names and values of a mapping.
fn entries<'py>(py: Python<'py>, mapping: &Bound<'py, PyAny>) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let copy = PyDict::new(py);
    copy.call_method1("update", (mapping,))?;
    copy.iter()
        .map(|(name, value)| Ok((name.extract()?, value)))
        .collect()
}

/// The value of a parameter as scripts are given it, those of numpy included.
fn as_text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Some(text) = plain_text(value)? {
        return Ok(text);
    }
    if let Ok(item) = value.call_method0("item")
        && let Some(text) = plain_text(&item)?
    {
        return Ok(text);
    }
    Err(PyTypeError::new_err(format!(
        "the parameter '{name}' is a number, a boolean or a text, not {}",
        value.get_type().name()?
    )))
}

/// A value of Python's own as text; what `repr` makes of a number is read back to the bit.
fn plain_text(value: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    let text = if let Ok(value) = value.cast::<PyBool>() {
        value.is_true().to_string()
    } else if value.is_instance_of::<PyString>() {
        value.extract()?
    } else if value.is_instance_of::<PyInt>() {
        value.call_method0("__index__")?.repr()?.to_string()
    } else if value.is_instance_of::<PyFloat>() {
        // Subclasses, such as numpy's, write more than the number.
        PyFloat::new(value.py(), value.extract()?).repr()?.to_string()
    } else {
        return Ok(None);
    };
    Ok(Some(text))
}
