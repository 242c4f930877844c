//! `rtscript check`: whether scenes are sound, at the cost of a small picture.

use std::sync::Arc;

use super::{args::CheckArgs, exit_code, host::SilentHost, input::Input, report::Reporter, signals::Signals};
use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind, Report},
    limits::Limits,
    parameters::Parameters,
    render::inspect,
    script::{Run, RunOptions},
    source,
};

/// Reads and runs each scene up to the complete description, shows warnings, says what it holds, and gives the
/// exit code. What the
/// camera sees is looked at by rays as of a small picture.
///
/// # Errors
/// Where several scenes were looked at and not all are sound, with the kind of the first one's error.
pub(super) fn check(args: &CheckArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<u8, Error> {
    let mut first = None;
    let mut wrong = 0;
    for file in &args.files {
        let input = Input::new(file);
        match looked_over(&input, args.define.parameters(), signals) {
            Ok((run, text, looks)) => {
                reporter.warnings(&run.warnings);
                for warning in looks {
                    let is_here = warning.file.as_deref() == Some(input.name());
                    reporter.warnings(&[if is_here {
                        warning.with_source(&text)
                    } else {
                        warning
                    }]);
                }
                let holds: Vec<String> = run
                    .value
                    .scene
                    .holds()
                    .iter()
                    .map(|(what, n)| match n {
                        1 => format!("1 {}", what.trim_end_matches('s')),
                        n => format!("{n} {what}"),
                    })
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
        None => Ok(0),
        Some(ErrorKind::Cancelled) => {
            Err(Diagnostic::error(ErrorKind::Cancelled, "stopped by a signal").into())
        }
        // What there is to say was said.
        Some(kind) if args.files.len() == 1 => Ok(exit_code(kind, None)),
        Some(kind) => {
            let scenes = args.files.len();
            Err(
                Diagnostic::error(kind, format!("{wrong} of {scenes} scenes cannot be rendered"))
                    .class(Code::Failed)
                    .into(),
            )
        }
    }
}

/// A scene's run, its text, and what looks wrong about what the camera sees of it.
fn looked_over(
    input: &Input,
    parameters: Parameters,
    signals: &Arc<Signals>,
) -> Result<(Report<Run>, String, Vec<Diagnostic>), Error> {
    let limits = Limits::default();
    let text = input.read_armed(&limits, signals)?;
    let options = RunOptions {
        dry: true,
        lint: true,
        ..RunOptions::from(&parameters)
    };
    let host = SilentHost::new(input.folder(), Arc::clone(signals));
    let run = source::load(input.name(), &text, &host, &limits, &options)?;
    let looks = inspect(&run.value.scene, &host)?;
    Ok((run, text, looks))
}

/// Runs a scene up to the complete description, without the pictures that it renders on the way.
///
/// # Errors
/// Whatever keeps it from running to its end.
pub(super) fn dry_run(
    input: &Input,
    parameters: Parameters,
    signals: &Arc<Signals>,
) -> Result<Report<Run>, Error> {
    let limits = Limits::default();
    let text = input.read_armed(&limits, signals)?;
    let host = SilentHost::new(input.folder(), Arc::clone(signals));
    source::load(
        input.name(),
        &text,
        &host,
        &limits,
        &RunOptions {
            dry: true,
            ..RunOptions::from(&parameters)
        },
    )
}
