//! Scripts that mean harm: whatever they do, what comes back is an error that names what stopped them.
//!
//! `RTSCRIPT_ACCEPT=1 cargo test --test abuse` writes the expected messages anew.

#![allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test that fails panics"
)]

mod attacks;
mod calls;
mod files;
mod limits;

use std::{fs, path::Path};

use rtscript::{Error, Host, HostError, Limits, Report, Run, RunOptions, Script, meter::Meter};

#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

/// Compiles and runs a script.
fn run(source: &str, limits: &Limits, host: &dyn Host) -> Result<Report<Run>, Error> {
    Script::compile("scene.rhai", source, limits)?.run(host, &RunOptions::default())
}

/// The first line of an error: place, kind and message.
fn first_line(error: &Error) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Compares with the file `name` beside this one, or writes it where that is asked for.
fn settle(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/abuse")
        .join(name);
    if std::env::var_os("RTSCRIPT_ACCEPT").is_some() {
        fs::write(&path, text).unwrap();
        return;
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    let differing = expected
        .lines()
        .zip(text.lines())
        .find(|(a, b)| a != b)
        .map(|(a, b)| format!("\n- {a}\n+ {b}"));
    assert!(
        expected == text,
        "{name} is stale ({} lines, {} expected); RTSCRIPT_ACCEPT=1 writes it anew{}",
        text.lines().count(),
        expected.lines().count(),
        differing.unwrap_or_default()
    );
}

/// A host without an outside that swallows what is printed and takes every picture.
struct Quiet;

impl Host for Quiet {
    fn read(&self, path: &str, _max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let what = format!("cannot read '{path}': no such file");
        Err(HostError::new(rtscript::ErrorKind::Input, what))
    }

    fn write_image(&self, _name: &str, _image: &rtscript::Image) -> Result<(), HostError> {
        Ok(())
    }
}
