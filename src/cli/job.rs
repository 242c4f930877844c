//! One scene from its file to its picture.

use std::{
    io::IsTerminal,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use super::{
    args::{RenderArgs, StatsFormat},
    host::CliHost,
    input::Input,
    progress::ProgressLine,
    report::Reporter,
    signals::Signals,
    stats::{self, Stages, Stats},
    without_place, write_stdout,
};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::HostError,
    limits::Limits,
    output::{self, Format},
    recipe::Recipe,
    render::{Image, render, unanswered},
    script::{Picture, RunOptions},
    source::{self, SourceKind},
};

/// Where the picture of a scene goes.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// A file named after the scene, unless the script names pictures itself.
    Default(PathBuf),
    /// The file given by `-o`.
    Given(PathBuf),
    /// Standard output, as PNG.
    Stdout,
}

impl Target {
    /// The file, if it is one.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::Default(path) | Self::Given(path) => Some(path),
            Self::Stdout => None,
        }
    }

    /// Whether the picture can be written, asked before time is spent on it.
    pub(super) fn check(&self, inputs: &[PathBuf]) -> Result<(), HostError> {
        match self.path() {
            Some(path) => output::check_target(path, inputs),
            None if std::io::stdout().is_terminal() => Err(HostError::new(
                ErrorKind::Output,
                "a terminal cannot show a PNG: send standard output to a file or a pipe",
            )),
            None => Ok(()),
        }
    }

    /// Writes the picture.
    pub(super) fn write(&self, image: &Image, recipe: Option<&Recipe>) -> Result<(), HostError> {
        match (self.path(), recipe) {
            (Some(path), Some(recipe)) => output::save_with(path, image, recipe),
            (Some(path), None) => output::save(path, image),
            (None, _) => {
                let bytes = match recipe {
                    Some(recipe) => output::encode_png_with(image, recipe),
                    None => output::encode(image, Format::Png),
                };
                write_stdout(&bytes.map_err(|e| HostError::new(ErrorKind::Output, output::reason(&e)))?)
            }
        }
    }

    /// What messages call it.
    pub(super) fn name(&self) -> String {
        self.path()
            .map_or("<stdout>".to_owned(), |path| path.display().to_string())
    }
}

/// One scene to render.
#[derive(Clone, Debug)]
pub(super) struct Job {
    /// The scene's file.
    pub(super) input: Input,
    /// Where its picture goes.
    pub(super) target: Target,
}

impl Job {
    /// Reads, runs, renders, writes, reports.
    ///
    /// A script that renders by itself is not rendered again. Its last picture goes to `-o`; without `-o` to the
    /// default file, unless the script gave any picture a name of its own.
    ///
    /// # Errors
    /// Whatever keeps the picture from being made or written.
    pub(super) fn run(
        &self,
        args: &RenderArgs,
        signals: &Arc<Signals>,
        reporter: Reporter,
    ) -> Result<(), Error> {
        let start = Instant::now();
        let limits = match args.untrusted {
            true => Limits::untrusted(),
            false => Limits::default(),
        };
        let own: Vec<PathBuf> = self.input.path().map(Path::to_owned).into_iter().collect();
        if !matches!(self.target, Target::Default(_)) {
            self.target.check(&own).map_err(without_place)?;
        }

        let text = self.input.read_armed(&limits, signals)?;
        let mut stages = Stages {
            read: start.elapsed(),
            ..Stages::default()
        };

        let parameters = args.overrides.parameters();
        let recipe = (!args.no_recipe).then(|| Recipe::new(&self.input.short_name(), &text, &parameters));
        let host = CliHost::new(
            &self.input,
            Arc::clone(signals),
            ProgressLine::new(reporter.is_for_people()),
            matches!(self.target, Target::Stdout),
            recipe,
            (reporter, &text),
        );
        let mut options = RunOptions::from(&parameters);
        options.render = options.render.within(&limits);
        options.render.threads = args.threads.count();
        let running = Instant::now();
        let run = source::load(self.input.name(), &text, &host, &limits, &options)
            .map_err(|e| self.stopped(e, signals))?;
        host.clear_progress();
        let script = running.elapsed();
        host.show(&run.warnings);

        if SourceKind::from_name(self.input.name()) == SourceKind::Script {
            host.show(unanswered(&run.value.scene).as_slice());
        }

        let mut pictures = run.value.pictures;
        let named = pictures.iter().any(|picture| picture.name.is_some());
        let inside: Duration = pictures.iter().map(|p| p.stats.compile + p.stats.trace).sum();
        if pictures.is_empty() {
            // Now it is known that the default file is wanted, and which files the script read.
            self.target.check(&host.inputs()).map_err(without_place)?;
            let rendered =
                render(&run.value.scene, &options.render, &host).map_err(|e| self.stopped(e, signals))?;
            host.clear_progress();
            host.show(&rendered.warnings);
            pictures.push(Picture {
                name: None,
                image: rendered.value.image,
                stats: rendered.value.stats,
            });
        }
        let (reading, writing) = host.times();
        stages.read += reading;
        stages.script = script.saturating_sub(inside + reading + writing);

        let last = pictures
            .last()
            .filter(|_| !(named && matches!(self.target, Target::Default(_))));
        let saving = Instant::now();
        if let Some(picture) = last {
            self.target.check(&host.inputs()).map_err(without_place)?;
            let recipe = host.recipe_of(&picture.image);
            self.target
                .write(&picture.image, recipe.as_ref())
                .map_err(without_place)?;
        }
        stages.write = writing + saving.elapsed();
        stages.total = start.elapsed();
        let written = last.map(|picture| (self.target.name(), picture));
        self.report(args, reporter, &pictures, written, stages);
        Ok(())
    }

    /// The lines that tell what was written, and the statistics.
    fn report(
        &self,
        args: &RenderArgs,
        reporter: Reporter,
        pictures: &[Picture],
        written: Option<(String, &Picture)>,
        mut stages: Stages,
    ) {
        let render = stats::sum(pictures.iter().map(|picture| &picture.stats));
        (stages.compile, stages.trace) = (render.compile, render.trace);
        let named = pictures.iter().filter_map(|p| Some((p.name.clone()?, p)));
        let all: Vec<(String, &Picture)> = named.chain(written).collect();
        // With JSON on standard error, a program reads it.
        if args.stats != Some(StatsFormat::Json) {
            for (path, picture) in &all {
                let took = match pictures.len() {
                    1 => stages.total,
                    _ => picture.stats.compile + picture.stats.trace,
                };
                reporter.line(&stats::picture_line(path, &picture.image, took, &picture.stats));
            }
        }
        let (Some(format), Some((output, last))) = (args.stats, all.last()) else {
            return;
        };
        let stats = Stats {
            scene: self.input.name().to_owned(),
            output: output.clone(),
            hash: last.image.hash(),
            size: (last.image.width(), last.image.height()),
            pictures: pictures.len(),
            threads: match args.threads.count() {
                0 => rayon::current_num_threads(),
                count => count,
            },
            render,
            stages,
            peak_memory: stats::peak_memory(),
        };
        match format {
            StatsFormat::Text => reporter.write(&stats.text()),
            StatsFormat::Json => reporter.write_line(&stats.json()),
        }
    }

    /// Says which signal stopped the run, in place of the library's "the host asked to stop".
    fn stopped(&self, error: Error, signals: &Signals) -> Error {
        let Some(name) = signals
            .caught_name()
            .filter(|_| error.kind() == ErrorKind::Cancelled)
        else {
            return error;
        };
        Error {
            diagnostic: Box::new(Diagnostic::error(
                ErrorKind::Cancelled,
                format!(
                    "stopped by {name}; no picture of '{}' was written",
                    self.input.name()
                ),
            )),
            more: error.more,
            warnings: error.warnings,
        }
    }
}
