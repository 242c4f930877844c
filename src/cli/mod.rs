//! The `rtscript` command: arguments, files and signals around the library.
//!
//! Standard output carries pixels (`-o -`), converted scripts and what scripts print; all else goes to standard
//! error. The library underneath never prints and opens no file.

mod args;
mod blame;
mod check;
mod convert;
mod diff;
mod expand;
mod guard;
mod hash;
mod help;
mod host;
mod input;
mod job;
mod lsp;
mod manual;
mod measures;
mod new;
mod params;
mod picture;
mod progress;
mod range;
mod report;
mod rerun;
mod sheet;
mod show;
mod signals;
mod sixel;
mod stats;
mod subject;
mod sweep;
mod test;
mod watch;
mod why;

#[cfg(fuzzing)]
pub use lsp::{LSP_METHODS, lsp_answers};

use std::{
    collections::BTreeMap,
    ffi::OsString,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use clap::{CommandFactory, Parser, error::ErrorKind as UsageError};

use self::{
    args::{Cli, Command, DiffArgs, MessageFormat, RenderArgs, TestArgs},
    input::Input,
    job::{Job, Target},
    report::Reporter,
    signals::Signals,
};
use crate::{
    diag::{Error, ErrorKind},
    host::HostError,
};

/// Does what the arguments ask for (the first is the program's name) and returns the exit code: 0 done, 1 script
/// or scene error, 2 usage, 3 input missing or malformed, 4 output cannot be written, 5 a limit was hit, 6 access
/// denied, 70 internal error, 128 + n stopped by signal n. `rtscript diff` is as diff(1): 1 says that scenes differ, and a
/// script or scene error is 2.
pub fn run(args: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    guard::silence();
    let context = Context {
        signals: Signals::install(),
        format: cli.message_format,
    };
    match cli.command {
        Some(Command::Convert(args)) => context.finish(false, |_, _| convert::convert(&args)),
        Some(Command::Expand(args)) => context.finish(args.quiet, |signals, reporter| {
            expand::expand(&args, signals, reporter)
        }),
        Some(Command::Diff(args)) => context.diff(&args),
        Some(Command::New(args)) => context.finish(false, |_, reporter| new::new(&args, reporter)),
        Some(Command::Check(args)) => context.answer(args.quiet, |signals, reporter| {
            check::check(&args, signals, reporter)
        }),
        Some(Command::Hash(args)) => context.finish(false, |signals, _| hash::hash(&args, signals)),
        Some(Command::Params(args)) => context.finish(false, |signals, _| params::params(&args, signals)),
        Some(Command::Rerun(args)) => {
            context.finish(false, |signals, reporter| rerun::rerun(&args, signals, reporter))
        }
        Some(Command::Verify(args)) => {
            context.finish(false, |signals, reporter| rerun::verify(&args, signals, reporter))
        }
        Some(Command::Sweep(args)) => context.finish(args.quiet, |signals, reporter| {
            sweep::sweep(&args, signals, reporter)
        }),
        Some(Command::Help(args)) => context.answer(false, |_, _| help::help(&args)),
        Some(Command::Completions(args)) => context.finish(false, |_, _| manual::completions(&args)),
        Some(Command::Man(args)) => context.answer(false, |_, _| manual::page(&args)),
        Some(Command::Why(args)) => {
            context.finish(false, |signals, reporter| why::why(&args, signals, reporter))
        }
        Some(Command::Blame(args)) => {
            context.finish(false, |signals, reporter| blame::blame(&args, signals, reporter))
        }
        Some(Command::Watch(args)) => context.answer(args.quiet, |signals, reporter| {
            watch::watch(&args, signals, reporter)
        }),
        Some(Command::Lsp(_)) => context.answer(false, |_, _| Ok(lsp::lsp())),
        Some(Command::Test(args)) => context.test(&args),
        Some(Command::Render(args)) => context.render(&args),
        None => context.render(&cli.render),
    }
}

/// What every command works with.
struct Context {
    signals: Arc<Signals>,
    format: MessageFormat,
}

impl Context {
    /// Runs a command, reports its error and gives the exit code.
    fn finish(&self, quiet: bool, command: impl FnOnce(&Arc<Signals>, Reporter) -> Result<(), Error>) -> u8 {
        self.answer(quiet, |signals, reporter| command(signals, reporter).map(|()| 0))
    }

    /// As [`Context::finish`], for a command that chooses its exit code.
    fn answer(&self, quiet: bool, command: impl FnOnce(&Arc<Signals>, Reporter) -> Result<u8, Error>) -> u8 {
        let reporter = Reporter::new(quiet, self.format);
        match guard::guarded(|| command(&self.signals, reporter)) {
            // It was done before it noticed; what comes after it in a shell script shall not go on all the same.
            Ok(code) => self.signals.caught().map_or(code, stopped_by),
            Err(error) => {
                reporter.error(&error);
                exit_code(error.kind(), self.signals.caught())
            }
        }
    }

    /// Renders all files; one that fails does not keep the others from being rendered. The exit code is that of the
    /// first that failed.
    fn render(&self, args: &RenderArgs) -> u8 {
        let jobs = match jobs(args) {
            Ok(jobs) => jobs,
            Err(message) => return usage(&Cli::command().error(UsageError::ArgumentConflict, message)),
        };
        let mut code = 0;
        for job in &jobs {
            let this = self.finish(args.quiet, |signals, reporter| match args.show {
                Some(what) => show::run(job, what, args, signals, reporter),
                None => job.run(args, signals, reporter),
            });
            code = if code == 0 { this } else { code };
            if self.signals.caught().is_some() {
                break;
            }
        }
        code
    }

    /// Compares two scenes. As in diff(1), 1 says that they differ, so a scene in error, which is 1 elsewhere, is 2.
    fn diff(&self, args: &DiffArgs) -> u8 {
        let reporter = Reporter::new(args.quiet, self.format);
        let json = args.json || self.format == MessageFormat::Json;
        guard::guarded(|| diff::diff(args, json, &self.signals, reporter)).map_or_else(
            |error| {
                reporter.error(&error);
                exit_code(error.kind(), self.signals.caught()).max(2)
            },
            u8::from,
        )
    }

    /// Tests scenes. That some do not pass is said by the code 1, as for a scene that cannot be rendered.
    fn test(&self, args: &TestArgs) -> u8 {
        if let Err(message) = args.check() {
            return usage(&Cli::command().error(UsageError::ArgumentConflict, message));
        }
        self.answer(args.quiet, |signals, reporter| {
            test::run(args, signals, reporter).map(|all_passed| u8::from(!all_passed))
        })
    }
}

/// Which file goes where, checked as a whole.
fn jobs(args: &RenderArgs) -> Result<Vec<Job>, String> {
    let inputs: Vec<Input> = args.files.iter().map(|path| Input::new(path)).collect();
    if inputs.iter().filter(|input| input.is_stdin()).count() > 1 {
        return Err("standard input can be read only once, but - is given more than once".to_owned());
    }
    let folder = match args.output.as_deref() {
        Some(output) if inputs.len() == 1 => {
            let target = if output == Path::new("-") {
                Target::Stdout
            } else {
                Target::Given(output.to_owned())
            };
            return Ok(inputs
                .into_iter()
                .map(|input| Job {
                    input,
                    target: target.clone(),
                })
                .collect());
        }
        Some(output) if output.is_dir() => Some(output.to_owned()),
        Some(output) => {
            return Err(format!(
                "with several scenes -o must name a folder that exists, which '{}' does not",
                output.display()
            ));
        }
        None => None,
    };
    let mut taken: BTreeMap<PathBuf, String> = BTreeMap::new();
    let mut jobs = Vec::new();
    for input in inputs {
        let name = input.picture_name(args.show.map(|what| what.name()));
        let target = match &folder {
            Some(folder) => Target::Given(folder.join(name)),
            None => Target::Default(name),
        };
        if let Some(path) = target.path()
            && let Some(other) = taken.insert(path.to_owned(), input.name().to_owned())
        {
            return Err(format!(
                "'{other}' and '{}' would both be written to '{}'; render one of them by itself with -o",
                input.name(),
                path.display()
            ));
        }
        jobs.push(Job { input, target });
    }
    Ok(jobs)
}

fn usage(error: &clap::Error) -> u8 {
    let printed = error.print().and_then(|()| io::stdout().flush());
    match u8::try_from(error.exit_code()).unwrap_or(2) {
        // What was asked for, such as help, could not be given. Where the terminal is closed, nobody is left to tell.
        0 if printed.is_err_and(|e| e.kind() != io::ErrorKind::BrokenPipe) => 4,
        code => code,
    }
}

/// The one place where an error becomes an exit code; `signal` is the number of the signal that came, if one did.
fn exit_code(kind: ErrorKind, signal: Option<i32>) -> u8 {
    match kind {
        ErrorKind::Script => 1,
        ErrorKind::Input => 3,
        ErrorKind::Output => 4,
        ErrorKind::Limit => 5,
        ErrorKind::Denied => 6,
        ErrorKind::Cancelled => signal.map_or(130, stopped_by),
        ErrorKind::Internal => 70,
    }
}

/// The exit code of a run that a signal stopped, as shells have it.
fn stopped_by(signal: i32) -> u8 {
    u8::try_from(128 + signal).unwrap_or(130)
}

/// Writes to standard output. A reader that went away has what it wanted.
fn write_stdout(bytes: &[u8]) -> Result<(), HostError> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(HostError::new(
            ErrorKind::Output,
            format!("cannot write to standard output: {}", crate::output::reason(&e)),
        )),
        _ => Ok(()),
    }
}

fn without_place(error: HostError) -> Error {
    error.diagnostic().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_error_has_its_code() {
        let code = |kind| exit_code(kind, None);
        assert_eq!(code(ErrorKind::Script), 1);
        assert_eq!(code(ErrorKind::Input), 3);
        assert_eq!(code(ErrorKind::Output), 4);
        assert_eq!(code(ErrorKind::Limit), 5);
        assert_eq!(code(ErrorKind::Denied), 6);
        assert_eq!(code(ErrorKind::Internal), 70);
        let stopped = [2, 15, 1].map(|signal| exit_code(ErrorKind::Cancelled, Some(signal)));
        assert_eq!(stopped, [130, 143, 129]);
    }
}
