//! `rtscript render`, which is also `rtscript` alone, and `rtscript convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::shared::{Overrides, Threads};

pub(super) const AFTER_HELP: &str = "\
Examples:
  rtscript scene.rhai                        writes scene.png in the current folder
  rtscript scene.rhai -o big.png --size 1920x1080 --samples 64
  rtscript *.rhai -o pictures                one picture for each script
  rtscript - < scene.rhai                    reads standard input, writes out.png
  rtscript convert scene1.test -o scene1.rhai
  rtscript test --accept scenes              puts pictures on record; rtscript test scenes compares with them
  rtscript hash scene.rhai                   prints the hash of the pixels and the hash of the scene

A script reads files below its own folder only. Pictures it names itself, render(\"name.png\"), go below \
the current folder. What it prints goes to standard output, everything else to standard error.

Exit codes: 0 done, 1 script or scene error, 2 usage, 3 input missing or malformed, 4 output cannot be \
written, 5 a limit was hit, 6 access denied, 70 internal error, 130, 143, 129 stopped by SIGINT, SIGTERM, \
SIGHUP.";

#[derive(Debug, Args)]
pub(in crate::cli) struct RenderArgs {
    /// Scenes to render: scripts (.rhai) or course scenes (.test), or - for a script on standard input
    #[arg(value_name = "FILE", required = true)]
    pub(in crate::cli) files: Vec<PathBuf>,

    /// Where the picture goes: a .png, .jpg, .ppm, .exr, .hdr or .pfm file, or - for PNG on standard output; with several scenes, a
    /// folder. Of several pictures that a script renders, the last [default: the scene's name with .png, in the
    /// current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,

    /// Show something else than light, through the middle of each pixel: normals, texture coordinates, distances,
    /// objects or lines of the script by color, what each pixel costs [default name: scene-WHAT.png]
    #[arg(long, value_name = "WHAT", conflicts_with = "stats")]
    pub(in crate::cli) show: Option<ShowWhat>,

    /// Run scripts of strangers: seconds of work, megabytes of memory, no imports, no closures
    #[arg(long)]
    pub(in crate::cli) untrusted: bool,

    /// Leave out of a PNG what it was made from: script, modules, parameters, version, hash
    #[arg(long)]
    pub(in crate::cli) no_recipe: bool,

    /// Only errors: no progress, no warnings, no line for each picture
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,

    /// What it took, on standard error: rays by kind, seconds by stage, memory. As JSON, one line for each scene
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "text")]
    pub(in crate::cli) stats: Option<StatsFormat>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum StatsFormat {
    /// For people
    Text,
    /// For programs
    Json,
}

/// What a picture shows instead of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ShowWhat {
    /// Normals in world space: x, y, z from -1 to 1 as red, green, blue
    Normal,
    /// Texture coordinates: u as red, v as green
    Uv,
    /// Distance from the camera: near white, far dark, evenly in 1 / distance
    Depth,
    /// A color for each object
    Object,
    /// A color for each line of the script
    Line,
    /// What each pixel costs: much is white
    Cost,
}

impl ShowWhat {
    /// As it is typed.
    pub(in crate::cli) fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Uv => "uv",
            Self::Depth => "depth",
            Self::Object => "object",
            Self::Line => "line",
            Self::Cost => "cost",
        }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ConvertArgs {
    /// The course scene (.test), or - for standard input
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// The script to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
}
