//! `rtscript convert`: a course scene to a script.

use std::path::Path;

use super::{args::ConvertArgs, input::Input, without_place, write_stdout};
use crate::{diag::Error, import, limits::Limits, output};

/// Writes the script that gives the same pixels as the course scene.
///
/// # Errors
/// Where the scene cannot be read or is malformed, or the script cannot be written.
pub(super) fn convert(args: &ConvertArgs) -> Result<(), Error> {
    let input = Input::new(&args.file);
    let target = args.output.as_deref().filter(|path| *path != Path::new("-"));
    if let Some(path) = target {
        let inputs: Vec<_> = input.path().map(Path::to_owned).into_iter().collect();
        output::check_writable(path, &inputs).map_err(without_place)?;
    }
    let text = input.read(&Limits::default())?;
    let script = import::script_from_course(input.name(), &text)?;
    match target {
        Some(path) => output::write_atomically(path, script.as_bytes()),
        None => write_stdout(script.as_bytes()),
    }
    .map_err(without_place)
}
