//! The examples of the table, run: what each prints, or the picture it gives.

use std::collections::BTreeMap;

use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::MemoryHost,
    limits::Limits,
    render::Image,
    script::{EXAMPLE_FILES, Entry, RunOptions, entries},
    testing::render_text,
};

/// Pixels across and down, where the example calls no `size(width, height)`.
const SIZE: (u32, u32) = (160, 120);
/// Rays per pixel, where the example calls no `samples(n)`.
const SAMPLES: u32 = 4;

/// What came of an example.
pub(super) struct Example {
    /// What it printed.
    pub(super) printed: String,
    /// What it shows; `None` where it prints instead.
    pub(super) picture: Option<Image>,
}

impl Example {
    /// Runs the entry's example, small.
    ///
    /// # Errors
    /// Whatever is wrong with it.
    pub(super) fn of(entry: &Entry) -> Result<Self, Error> {
        let host = EXAMPLE_FILES
            .iter()
            .fold(MemoryHost::new(), |host, (name, bytes)| host.with(name, *bytes));
        let options = RunOptions {
            size: (!entry.example.contains("size(")).then_some(SIZE),
            samples: (!entry.example.contains("samples(")).then_some(SAMPLES),
            ..RunOptions::default()
        };
        let name = format!("{}.rhai", entry.name);
        let run = render_text(&name, entry.example, &host, &Limits::default(), &options)?;
        let picture = run.printed.is_empty().then_some(run.image);
        Ok(Self {
            printed: run.printed,
            picture,
        })
    }
}

/// The examples of all entries.
pub(super) struct Examples(BTreeMap<&'static str, Example>);

impl Examples {
    /// Runs all of them, each once.
    ///
    /// # Errors
    /// Whatever is wrong with the first that fails.
    pub(super) fn run() -> Result<Self, Error> {
        let run = entries().map(|entry| Ok((entry.name, Example::of(entry)?)));
        run.collect::<Result<_, Error>>().map(Self)
    }

    /// That of one entry.
    ///
    /// # Errors
    /// Where the table has no such entry.
    pub(super) fn of(&self, entry: &Entry) -> Result<&Example, Error> {
        self.0.get(entry.name).ok_or_else(|| {
            let message = format!("the table of the language has no '{}'", entry.name);
            Diagnostic::error(ErrorKind::Internal, message).into()
        })
    }
}
