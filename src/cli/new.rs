//! `rtscript new`: a scene to begin with.

use std::path::PathBuf;

use super::{args::NewArgs, report::Reporter, without_place};
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
    if !output::write_new(&path, text.as_bytes()).map_err(without_place)? {
        let message = format!("cannot write '{shown}': file exists");
        return Err(Diagnostic::error(ErrorKind::Output, message)
            .hint("name a scene that is not there yet")
            .into());
    }
    reporter.line(&format!("{shown}: a starter scene; rtscript {shown} renders it"));
    Ok(())
}
