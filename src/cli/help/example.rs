//! The examples of the table, run: what each prints, or the picture it gives.

use crate::{
    diag::Error,
    host::MemoryHost,
    limits::Limits,
    render::Image,
    script::{EXAMPLE_FILES, Entry, RunOptions},
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
