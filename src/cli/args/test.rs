//! `rtscript test`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::shared::Overrides;
use crate::parameters::Parameters;

pub(super) const AFTER_TEST: &str = "\
A scene is a script (.rhai) or a course scene (.test). Without paths, these are tested: below the current folder, \
every scene that has a snapshot, and every scene in a folder called tests. A folder that is given is searched for \
all scenes. Hidden files, names that begin with _, and the folders lib, modules, target and node_modules are passed \
over.

The snapshot of scene.rhai is scene.rtsnap, a small text to be kept beside it, and its reference picture is \
scene.rtsnap.png, which also carries the script, so that a report can tell what changed in it. A scene is \
rendered in the size on record; a new one in its own size, but at most 320 pixels along the longer edge.

Exit codes: 0 all as on record, 1 something changed, is new or fails, 2 usage, 3 a path is missing, 4 a report or \
a snapshot cannot be written, 130, 143, 129 stopped by a signal.";

#[derive(Debug, Args)]
pub(in crate::cli) struct TestArgs {
    /// Scenes, or folders to be searched for scenes
    #[arg(value_name = "PATH")]
    pub(in crate::cli) paths: Vec<PathBuf>,

    /// Put what changed and what is new on record
    #[arg(long, conflicts_with = "review")]
    pub(in crate::cli) accept: bool,

    /// Show what changed and what is new, one by one, and ask whether to accept it
    #[arg(long)]
    pub(in crate::cli) review: bool,

    /// Only scenes whose path contains TEXT; several are alternatives
    #[arg(long, value_name = "TEXT")]
    pub(in crate::cli) filter: Vec<String>,

    /// Scenes to work on at once [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(in crate::cli) jobs: Option<u16>,

    /// Largest mean FLIP error that passes, 0 to 1, where pixels differ; 0.01 is hardly seen. Needs reference pictures
    #[arg(long, value_name = "X", default_value = "0", hide_default_value = true, value_parser = parse_tolerance)]
    pub(in crate::cli) tolerance: f64,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    /// Keep no reference pictures beside the snapshots; a change is then found, but not shown
    #[arg(long)]
    pub(in crate::cli) no_pictures: bool,

    /// Write a report to be looked at: one HTML file with all pictures in it
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) html: Option<PathBuf>,

    /// Write a report in JUnit's XML, which CI systems read
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) junit: Option<PathBuf>,

    /// Write a report in JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) json: Option<PathBuf>,

    /// Write expected, difference and actual side by side into this folder, for each scene that changed
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) diffs: Option<PathBuf>,

    /// Pictures in the terminal with --review
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(in crate::cli) pictures: TerminalPictures,

    /// Only what did not pass, and the last line
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

impl TestArgs {
    /// What clap cannot say about arguments that several commands share.
    pub(in crate::cli) fn check(&self) -> Result<(), String> {
        if self.overrides.parameters() != Parameters::default() && !(self.accept || self.review) {
            return Err(
                "--size, --samples, --seed and -D are put on record with --accept or --review; a test renders as the \
                 record says"
                    .to_owned(),
            );
        }
        Ok(())
    }
}

/// How a terminal shows a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum TerminalPictures {
    /// By what the terminal says it can; none where there is no terminal
    #[default]
    Auto,
    /// Kitty's protocol, which Ghostty and WezTerm speak too
    Kitty,
    /// Sixels, which xterm, foot, mlterm, iTerm2, Windows Terminal and others know
    Sixel,
    /// Colored half blocks
    Blocks,
    /// No pictures
    None,
}

/// A share of 1.
fn parse_tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    number
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| "expected a number from 0 (exact) to 1".to_owned())
}
