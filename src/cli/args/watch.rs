//! `rtscript watch`.

use std::path::PathBuf;

use clap::Args;

use super::{
    shared::{Overrides, Threads},
    test::TerminalPictures,
};

pub(super) const AFTER_WATCH: &str = "\
In a terminal the picture is shown as it gets better, and below it what is wrong, if anything; the last good picture \
stays until there is a better one. The keys are q to end and space to render again. Without a terminal there is a line \
for each picture on standard error.

Examples:
  rtscript watch scene.rhai                  writes scene.png again and again
  rtscript watch scene.rhai -o view.png --size 320x240 --pictures blocks";

#[derive(Debug, Args)]
pub(in crate::cli) struct WatchArgs {
    /// The scene: a script (.rhai) or a course scene (.test)
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// Where the picture goes: a .png, .jpg or .ppm file. Of several pictures that a script renders, the last
    /// [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,

    /// Pictures in the terminal
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(in crate::cli) pictures: TerminalPictures,

    /// Leave out of a PNG what it was made from: script, modules, parameters, version, hash
    #[arg(long)]
    pub(in crate::cli) no_recipe: bool,

    /// Without a terminal: only errors, no warnings, no line for each picture
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}
