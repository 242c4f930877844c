//! Scripts that mean harm: whatever they do, what comes back is an error that names what stopped them.
//!
//! `RTSCRIPT_ACCEPT=1 cargo test --test abuse` writes the expected messages anew.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that fails panics"
)]

mod attacks;
mod calls;
mod files;
mod limits;
mod long_calls;
mod models;
mod nesting;
mod pictures;
mod signatures;

use std::{
    fs,
    path::{Path, PathBuf},
};

use rtscript::{
    DirHost, Error, Host, Limits, Report, RunOptions, Script, diag::ErrorKind, host::HostError, meter::Meter,
    script::Run,
};

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

/// What ends a script: the first line of its error, or that nothing does.
fn outcome(name: &str, script: &str, limits: &Limits, host: &dyn Host) -> String {
    match run(script, limits, host) {
        Ok(_) => "runs to its end".to_owned(),
        Err(error) => {
            assert_ne!(error.kind(), ErrorKind::Internal, "{name}: {error}");
            assert!(error.to_string().len() < 20_000, "{name}: a long error");
            first_line(&error).chars().take(200).collect()
        }
    }
}

/// Both presets with more time to read and run a script: a debug build under load is slow, and what is at stake is which
/// count ends the script.
fn presets() -> [(&'static str, Limits); 2] {
    [("default", Limits::default()), ("untrusted", Limits::untrusted())].map(|(name, mut limits)| {
        limits.compile_time *= 10;
        limits.script_time *= 100;
        (name, limits)
    })
}

/// Loads each file of a folder that means harm by a script of one line, under both presets, and compares what is said.
///
/// The scripts stay beside the files: `benches/abuse.py` runs them too.
fn settle_files(name: &str, folder: &Path, scripts: &[(String, String)]) {
    let host = DirHost::new(folder);
    let mut text = String::new();
    for (preset, limits) in presets() {
        for (attack, script) in scripts {
            fs::write(folder.join(format!("{attack}.rhai")), script).unwrap();
            let line = outcome(attack, script, &limits, &host);
            text += &format!("{preset:9} {attack:26} {line}\n");
        }
    }
    settle(name, &text);
}

/// An empty folder below `target/` for files that mean harm.
fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("abuse").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
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
        Err(HostError::new(rtscript::diag::ErrorKind::Input, what))
    }

    fn write_image(&self, _name: &str, _image: &rtscript::Image) -> Result<(), HostError> {
        Ok(())
    }
}
