//! `--show`: pictures of something else than light.

use std::sync::Arc;

use super::{
    args::{RenderArgs, ShowWhat},
    job::{Job, Target},
    report::Reporter,
    signals::Signals,
    subject::Subject,
    without_place, write_stdout,
};
use crate::{
    diag::Error,
    output::{self, Format},
    render::{
        RenderOptions,
        show::{Show, show},
    },
};

impl From<ShowWhat> for Show {
    fn from(what: ShowWhat) -> Self {
        match what {
            ShowWhat::Normal => Self::Normal,
            ShowWhat::Uv => Self::Uv,
            ShowWhat::Depth => Self::Depth,
            ShowWhat::Object => Self::Object,
            ShowWhat::Line => Self::Line,
            ShowWhat::Cost => Self::Cost,
        }
    }
}

/// Renders the scene of a job as `what` says, and writes it without a recipe. Pictures that the script renders by itself
/// are not written.
///
/// # Errors
/// Whatever keeps the picture from being made or written.
pub(super) fn run(
    job: &Job,
    what: ShowWhat,
    args: &RenderArgs,
    signals: &Arc<Signals>,
    reporter: Reporter,
) -> Result<(), Error> {
    let input = job.input.path().map(std::path::Path::to_owned);
    let inputs: Vec<_> = input.iter().cloned().collect();
    if let Some(path) = job.target.path() {
        output::check_target(path, &inputs).map_err(without_place)?;
    }
    let file = input.unwrap_or_else(|| "-".into());
    let subject = Subject::read(&file, None, &args.overrides, signals)?;
    let run = subject.load()?;
    reporter.warnings(&run.warnings);
    let options = RenderOptions {
        threads: args.threads.count(),
        ..RenderOptions::default()
    };
    let image = show(&run.value.scene, what.into(), &options, subject.host())?;
    match &job.target {
        Target::Given(path) | Target::Default(path) => {
            output::save(path, &image).map_err(without_place)?;
            reporter.line(&format!(
                "{}  {}x{}",
                path.display(),
                image.width(),
                image.height()
            ));
            Ok(())
        }
        Target::Stdout => {
            let bytes = output::encode(&image, Format::Png).map_err(|e| {
                without_place(crate::host::HostError::new(
                    crate::diag::ErrorKind::Output,
                    output::reason(&e),
                ))
            })?;
            write_stdout(&bytes).map_err(without_place)
        }
    }
}
