//! `rtscript new`: a scene to begin with.

use std::{
    fs::OpenOptions,
    io::{self, Write},
    path::PathBuf,
};

use super::{args::NewArgs, report::Reporter};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    output,
};

const STARTER: &str = include_str!("starter.rhai");

/// Writes the starter scene under the name, with `.rhai` if it has no ending; never over a file that is there.
///
/// # Errors
/// `Output` where it cannot be written.
pub(super) fn new(args: &NewArgs, reporter: Reporter) -> Result<(), Error> {
    let mut path: PathBuf = args.name.clone();
    if path.extension().is_none() {
        path.set_extension("rhai");
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let text = STARTER.replace("NAME", &stem);
    let shown = path.display();
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path)
        .and_then(|mut file| file.write_all(text.as_bytes()));
    if let Err(e) = written {
        let message = format!("cannot write '{shown}': {}", output::reason(&e));
        let error = Diagnostic::error(ErrorKind::Output, message);
        return Err(match e.kind() {
            io::ErrorKind::AlreadyExists => error.hint("name a scene that is not there yet"),
            _ => error,
        }
        .into());
    }
    reporter.line(&format!("{shown}: a starter scene; rtscript {shown} renders it"));
    Ok(())
}
