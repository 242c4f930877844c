//! Commands that make pictures from pictures or parameters, and scenes: `sweep rerun verify new expand`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{Overrides, Threads, parse_values};
use crate::parameters::parse_size;

pub(super) const AFTER_SWEEP: &str = "\
Examples:
  rtscript sweep scene.rhai -D radius=0.1..1:10                 ten pictures
  rtscript sweep scene.rhai -D radius=0.1..1:5 -D seed=1..4 --grid --size 160x120";

#[derive(Debug, Args)]
pub(in crate::cli) struct NewArgs {
    /// Name of the scene: without an ending, .rhai is added
    #[arg(value_name = "NAME")]
    pub(in crate::cli) name: PathBuf,
}

pub(super) const AFTER_EXPAND: &str = "\
Examples:
  rtscript expand scene.rhai                     every object that the script makes, a line each
  rtscript expand scene.rhai -o flat.rhai        the same in a file, which rtscript renders to the same pixels
  rtscript expand scene.rhai --no-places         without the lines that made them, to be compared with another

Pictures and models stay files, relative to the scene's folder: a text that names some belongs into it.";

#[derive(Debug, Args)]
pub(in crate::cli) struct ExpandArgs {
    /// The scene: a script (.rhai) or a course scene (.test), or - for a script on standard input
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// The script to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Leave out which line of the scene made what
    #[arg(long)]
    pub(in crate::cli) no_places: bool,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    /// Only errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct SweepArgs {
    /// The script, or - for standard input
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// Values of a parameter: 0.1..1:10 are ten from 0.1 to 1, 1..4 the whole numbers from 1 to 4, a,b,c these three
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUES", required = true, value_parser = parse_values)]
    pub(in crate::cli) define: Vec<(String, Vec<String>)>,

    /// All pictures on one sheet, each with its values below; those of the last parameter stand in a row
    #[arg(long)]
    pub(in crate::cli) grid: bool,

    /// The folder for the pictures, or with --grid the file for the sheet [default: the current folder, the script's
    /// name with -sweep.png]
    #[arg(short, long, value_name = "PATH")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Size of each picture in pixels, such as 160x120, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(in crate::cli) size: Option<(u32, u32)>,

    /// Rays per pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(in crate::cli) samples: Option<u32>,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,

    /// Only errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct RerunArgs {
    /// A PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// Where the new picture goes [default: the old one's name with -rerun.png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Print the recipe, scripts and all, instead of rendering it
    #[arg(long)]
    pub(in crate::cli) print: bool,

    /// Where pictures and models are that the script reads [default: the PNG's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct VerifyArgs {
    /// PNGs that rtscript wrote
    #[arg(value_name = "FILE", required = true)]
    pub(in crate::cli) files: Vec<PathBuf>,

    /// Where pictures and models are that the scripts read [default: each PNG's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,
}
