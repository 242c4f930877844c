//! What can be typed after `rtscript`.

mod ask;
mod help;
mod make;
mod render;
mod shared;
mod test;
mod watch;

use clap::{Parser, Subcommand, ValueEnum};

pub(super) use ask::{BlameArgs, CheckArgs, DiffArgs, HashArgs, ParamsArgs, WhyArgs};
pub(super) use help::{CompletionsArgs, HelpArgs, LspArgs, ManArgs};
pub(super) use make::{ExpandArgs, NewArgs, RerunArgs, SweepArgs, VerifyArgs};
pub(super) use render::{ConvertArgs, RenderArgs, ShowWhat, StatsFormat};
pub(super) use shared::Overrides;
pub(super) use test::{TerminalPictures, TestArgs};
pub(super) use watch::WatchArgs;

use ask::{AFTER_DIFF, AFTER_WHY};
use make::{AFTER_EXPAND, AFTER_SWEEP};
use render::AFTER_HELP;
use test::AFTER_TEST;
use watch::AFTER_WATCH;

/// Renders pictures that are written as code.
///
/// A scene is a Rhai script (.rhai) or a scene of the CSE167 course (.test).
#[derive(Debug, Parser)]
#[command(
    name = "rtscript",
    version,
    after_help = AFTER_HELP,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true
)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<Command>,

    #[command(flatten)]
    pub(super) render: RenderArgs,

    /// How errors, warnings and other messages look on standard error
    #[arg(
        long,
        global = true,
        value_name = "FORMAT",
        default_value = "text",
        hide_default_value = true
    )]
    pub(super) message_format: MessageFormat,
}

/// How messages look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum MessageFormat {
    /// For people
    #[default]
    Text,
    /// For programs: a line of JSON for each message
    Json,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render scenes, as without a command; for a file called as a command is, write ./render
    #[command(after_help = AFTER_HELP)]
    Render(RenderArgs),
    /// Turn a scene of the CSE167 course into a script that gives the same pixels
    Convert(ConvertArgs),
    /// Render a scene again whenever it or a file that it reads changes, and show it in the terminal
    #[command(after_help = AFTER_WATCH)]
    Watch(WatchArgs),
    /// Compare scenes with their snapshots, or put them on record
    #[command(after_help = AFTER_TEST)]
    Test(TestArgs),
    /// Write a starter scene
    New(NewArgs),
    /// Say whether scenes are sound and what looks wrong with them, without rendering them
    Check(CheckArgs),
    /// List the parameters that a script declares
    Params(ParamsArgs),
    /// Render a script for many values of its parameters
    #[command(after_help = AFTER_SWEEP)]
    Sweep(SweepArgs),
    /// Render again what a PNG was made from, which rtscript writes into it
    Rerun(RerunArgs),
    /// Check that PNGs are what the scripts they carry give
    Verify(VerifyArgs),
    /// Write a scene as a flat script: every object a line of its own, without loops, variables or functions
    #[command(after_help = AFTER_EXPAND)]
    Expand(ExpandArgs),
    /// Say what is different between two scenes: added, removed, moved, recolored, with the lines of both
    #[command(after_help = AFTER_DIFF)]
    Diff(DiffArgs),
    /// Print the hash of a scene's pixels and the hash of the scene, and nothing else
    Hash(HashArgs),
    /// Tell about a function of the language, or about a command; without a name, list all functions
    Help(HelpArgs),
    /// Print a script that makes a shell complete what is typed after rtscript
    Completions(CompletionsArgs),
    /// Print the manual page, of the program or of one of its commands, for man
    Man(ManArgs),
    /// Tell why a pixel has its value: what it shows, the calls that made that, every ray and light behind it
    #[command(after_help = AFTER_WHY)]
    Why(WhyArgs),
    /// Say which lines of a script the work for a picture goes to, counted in rays and in boxes that they touch
    Blame(BlameArgs),
    /// Tell an editor about scripts while they are written: a server for the Language Server Protocol
    Lsp(LspArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_file_alone_is_rendered() {
        let parse = |args: &[&str]| Cli::try_parse_from([&["rtscript"], args].concat()).unwrap();
        let cli = parse(&["a.rhai", "--stats", "b.rhai"]);
        assert!(cli.command.is_none());
        assert_eq!(cli.render.files.len(), 2);
        assert_eq!(cli.render.stats, Some(StatsFormat::Text));
        assert!(matches!(
            parse(&["render", "a.rhai"]).command,
            Some(Command::Render(_))
        ));
        assert!(parse(&["./convert"]).command.is_none());
        assert!(parse(&["a.rhai", "convert"]).command.is_none());
    }
}
