//! `rtscript check`: whether scenes are sound, without rendering them.

use std::sync::Arc;

use super::{args::CheckArgs, host::SilentHost, input::Input, report::Reporter, signals::Signals};
use crate::{
    diag::{Diagnostic, Error, ErrorKind, Report},
    limits::Limits,
    parameters::Parameters,
    script::{Run, RunOptions},
    source,
};

/// Reads and runs each scene up to the complete description, shows warnings, and says what it holds. Pictures that a
/// script renders on the way are one pixel large.
///
/// # Errors
/// The error of the first scene that has one, after all were looked at.
pub(super) fn check(args: &CheckArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    let mut first = None;
    let mut wrong = 0;
    for file in &args.files {
        let input = Input::new(file);
        match dry_run(&input, args.define.parameters(), signals) {
            Ok(run) => {
                reporter.warnings(&run.warnings);
                let holds: Vec<String> = run
                    .value
                    .scene
                    .holds()
                    .iter()
                    .map(|(what, n)| format!("{n} {what}"))
                    .collect();
                let holds = if holds.is_empty() {
                    "nothing".to_owned()
                } else {
                    holds.join(", ")
                };
                reporter.line(&format!("{}: ok, {holds}", input.name()));
            }
            Err(error) => {
                reporter.error(&error);
                wrong += 1;
                first.get_or_insert(error.kind());
            }
        }
        if signals.caught().is_some() {
            break;
        }
    }
    match first {
        None => Ok(()),
        Some(ErrorKind::Cancelled) => {
            Err(Diagnostic::error(ErrorKind::Cancelled, "stopped by a signal").into())
        }
        Some(kind) => {
            let scenes = args.files.len();
            Err(Diagnostic::error(kind, format!("{wrong} of {scenes} scenes cannot be rendered")).into())
        }
    }
}

/// Runs a scene up to the complete description, pictures that it renders on the way one pixel large.
///
/// # Errors
/// Whatever keeps it from running to its end.
pub(super) fn dry_run(
    input: &Input,
    mut parameters: Parameters,
    signals: &Arc<Signals>,
) -> Result<Report<Run>, Error> {
    let limits = Limits::default();
    let text = input.read_armed(&limits, signals)?;
    (parameters.size, parameters.samples) = (Some((1, 1)), Some(1));
    let host = SilentHost::new(input.folder(), Arc::clone(signals));
    source::load(
        input.name(),
        &text,
        &host,
        &limits,
        &RunOptions::from(&parameters),
    )
}
