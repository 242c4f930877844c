//! `rtscript hash`: what a search for the first bad commit wants to know.

use std::sync::Arc;

use super::{args::HashArgs, host::SilentHost, input::Input, signals::Signals, without_place, write_stdout};
use crate::{diag::Error, limits::Limits, script::RunOptions, source, testing::render_text};

/// Prints a line for each scene. What scenes print and warn of is left out, and pictures that they name are not
/// written.
///
/// # Errors
/// Whatever keeps a scene from being rendered; the lines of the scenes before it are printed.
pub(super) fn hash(args: &HashArgs, signals: &Arc<Signals>) -> Result<(), Error> {
    let mut options = RunOptions::from(&args.overrides.parameters());
    options.render.threads = args.threads.count();
    let limits = Limits::default();
    for file in &args.files {
        let input = Input::new(file);
        let text = input.read_armed(&limits, signals)?;
        let host = SilentHost::new(input.folder(), Arc::clone(signals));
        let mut line = if args.scene {
            source::load(input.name(), &text, &host, &limits, &options)?
                .value
                .scene
                .hash()
        } else {
            let rendered = render_text(input.name(), &text, &host, &limits, &options)?;
            format!("{} {}", rendered.image.hash(), rendered.scene.hash())
        };
        if args.files.len() > 1 {
            line += &format!("  {}", input.name());
        }
        line.push('\n');
        write_stdout(line.as_bytes()).map_err(without_place)?;
    }
    Ok(())
}
