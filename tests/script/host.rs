//! A host for tests, and scripts run on it.

use std::{collections::BTreeMap, sync::Mutex};

use rtscript::{
    Error, Host, Image, Limits, Report, RunOptions, Script, diag::ErrorKind, host::HostError, script::Run,
};

/// A host that has a few files and keeps what is printed and written.
#[derive(Default)]
pub(crate) struct Notes {
    files: BTreeMap<String, Vec<u8>>,
    printed: Mutex<Vec<String>>,
    written: Mutex<Vec<String>>,
}

impl Notes {
    /// A host with these files.
    pub(crate) fn with(files: &[(&str, &str)]) -> Self {
        let files = files
            .iter()
            .map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec()))
            .collect();
        Self {
            files,
            ..Self::default()
        }
    }

    /// Adds a file.
    pub(crate) fn insert(&mut self, name: &str, bytes: Vec<u8>) {
        self.files.insert(name.to_owned(), bytes);
    }

    /// Lines printed so far.
    pub(crate) fn printed(&self) -> Vec<String> {
        self.printed.lock().unwrap().clone()
    }

    /// Pictures written so far, as "name width x height".
    pub(crate) fn written(&self) -> Vec<String> {
        self.written.lock().unwrap().clone()
    }
}

impl Host for Notes {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let Some(bytes) = self.files.get(path) else {
            let what = format!("cannot read '{path}': no such file");
            return Err(HostError::new(ErrorKind::Input, what));
        };
        if bytes.len() as u64 > max_bytes {
            return Err(HostError::new(ErrorKind::Limit, format!("'{path}' is too large")));
        }
        Ok(bytes.clone())
    }

    fn print(&self, text: &str) {
        self.printed.lock().unwrap().push(text.to_owned());
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        let line = format!("{name} {} x {}", image.width(), image.height());
        self.written.lock().unwrap().push(line);
        Ok(())
    }
}

/// Runs a script on a host.
pub(crate) fn run_on(host: &Notes, source: &str) -> Result<Report<Run>, Error> {
    Script::compile("scene.rhai", source, &Limits::default())?.run(host, &RunOptions::default())
}

/// Runs a script on a host without files.
pub(crate) fn try_run(source: &str) -> Result<Report<Run>, Error> {
    run_on(&Notes::default(), source)
}

/// Runs a script that must be right.
pub(crate) fn run(source: &str) -> Run {
    match try_run(source) {
        Ok(report) => report.value,
        Err(e) => panic!("{e}\n{source}"),
    }
}

/// What a script prints.
pub(crate) fn printed(source: &str) -> Vec<String> {
    let host = Notes::default();
    if let Err(e) = run_on(&host, source) {
        panic!("{e}\n{source}");
    }
    host.printed()
}
