//! What a script reaches, and how Python is asked and told while it runs without the interpreter's lock.

use std::{
    path::PathBuf,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::Duration,
};

use pyo3::prelude::*;
use rtscript::{
    DirHost, Error, Host, Image, MemoryHost, NoHost,
    diag::{Diagnostic, ErrorKind},
    host::HostError,
    render::Progress,
};

use crate::diagnostic::exception;

/// How often Python's signals are looked at while it waits.
const LOOK: Duration = Duration::from_millis(20);

/// Files of a run: in memory first, then of a folder.
#[derive(Debug, Default)]
pub(crate) struct Files {
    pub(crate) memory: Option<MemoryHost>,
    pub(crate) folder: Option<PathBuf>,
}

/// The host of one run or render.
pub(crate) struct Guest {
    files: Files,
    print: Option<Py<PyAny>>,
    progress: Option<Py<PyAny>>,
    stopped: AtomicBool,
    /// The first exception that a callback raised.
    raised: Mutex<Option<PyErr>>,
}

impl Guest {
    pub(crate) fn new(files: Files, print: Option<Py<PyAny>>, progress: Option<Py<PyAny>>) -> Self {
        Self {
            files,
            print,
            progress,
            stopped: AtomicBool::new(false),
            raised: Mutex::new(None),
        }
    }

    /// Does something without the interpreter's lock. What a callback raised comes before what it led to.
    pub(crate) fn detached<T: Send>(
        &self,
        py: Python<'_>,
        f: impl FnOnce(&Self) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let result = py.detach(|| self.watched(f));
        match self.raised().take() {
            Some(raised) => Err(raised),
            None => result.map_err(|error| exception(py, &error)),
        }
    }

    /// Does it on a thread of its own. Python sees signals, Ctrl-C among them, on its main thread alone and only when it
    /// is asked there, so the calling thread has nothing else to do than to ask.
    fn watched<T: Send>(&self, f: impl FnOnce(&Self) -> Result<T, Error> + Send) -> Result<T, Error> {
        thread::scope(|scope| {
            let (done, is_done) = channel::<()>();
            let worker = scope.spawn(move || {
                // Dropped at the end, which is what the other thread waits for, also at a panic.
                let _done = done;
                f(self)
            });
            while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                self.keep(Python::attach(|py| py.check_signals()));
            }
            worker.join().unwrap_or_else(|_| {
                let what = "a fault of rtscript's own, in its Python module";
                Err(Diagnostic::error(ErrorKind::Internal, what)
                    .hint("please report this, with the script")
                    .into())
            })
        })
    }

    fn raised(&self) -> MutexGuard<'_, Option<PyErr>> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the exception of a callback and stops.
    fn keep(&self, result: PyResult<()>) {
        if let Err(raised) = result {
            self.stopped.store(true, Ordering::Relaxed);
            self.raised().get_or_insert(raised);
        }
    }
}

impl Host for Guest {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        match (&self.files.memory, &self.files.folder) {
            (None, None) => NoHost.read(path, max_bytes),
            (Some(memory), None) => memory.read(path, max_bytes),
            (None, Some(folder)) => DirHost::new(folder).read(path, max_bytes),
            (Some(memory), Some(folder)) => match memory.read(path, max_bytes) {
                Err(e) if e.kind == ErrorKind::Input => DirHost::new(folder).read(path, max_bytes),
                known => known,
            },
        }
    }

    fn print(&self, text: &str) {
        if let Some(print) = &self.print {
            self.keep(Python::attach(|py| print.call1(py, (text,)).map(drop)));
        }
    }

    fn should_stop(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn progress(&self, progress: &Progress) {
        let Some(tell) = &self.progress else {
            return;
        };
        if self.should_stop() {
            return;
        }
        self.keep(Python::attach(|py| {
            let answer = tell.call1(py, (progress.done, progress.total))?;
            if answer.extract::<bool>(py).is_ok_and(|goes_on| !goes_on) {
                self.stopped.store(true, Ordering::Relaxed);
            }
            Ok(())
        }));
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        // The run keeps it: `Run.pictures`.
        Ok(())
    }
}
