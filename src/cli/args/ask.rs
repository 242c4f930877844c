//! Commands that tell about a scene, or about two: `why blame hash params check diff`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{Defines, Overrides, Threads};

pub(super) const AFTER_WHY: &str = "\
Examples:
  rtscript why scene.rhai 320,240                      the pixel in column 320, row 240 from the top left
  rtscript why scene.png 320,240                       the same of a picture that rtscript wrote
  rtscript why scene.rhai 320,240 --image rays.png     its rays drawn into the picture: reflected cyan, refracted
                                                       magenta, to lights yellow, tinted green, blocked red

The terms of all rays add up to the pixel's linear value. A scene's size decides what its pixels are: give the --size \
that the picture was rendered with.";

#[derive(Debug, Args)]
pub(in crate::cli) struct WhyArgs {
    /// The scene (.rhai or .test), - for a script on standard input, or a PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// The pixel: column and row from the top left, both from 0
    #[arg(value_name = "X,Y", value_parser = parse_pixel)]
    pub(in crate::cli) pixel: (u32, u32),

    /// The sample whose rays are told, from 0
    #[arg(long, value_name = "N", default_value = "0")]
    pub(in crate::cli) sample: u32,

    /// As JSON, with all digits and all rays
    #[arg(long)]
    pub(in crate::cli) json: bool,

    /// Draw the rays into the picture and write it here: a .png, .jpg or .ppm file
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) image: Option<PathBuf>,

    /// Where pictures and models are that the script reads [default: the file's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,
}

/// `320,240` to column and row.
fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    let pixel = text
        .split_once(',')
        .and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    pixel.ok_or_else(|| "expected column and row from the top left, such as 320,240".to_owned())
}

#[derive(Debug, Args)]
pub(in crate::cli) struct BlameArgs {
    /// The scene (.rhai or .test), - for a script on standard input, or a PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// Write a heat map here, what costs most white: a .png, .jpg or .ppm file
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) image: Option<PathBuf>,

    /// As JSON: an array of objects with file, line, text, pixels, rays, shadow_rays, boxes
    #[arg(long)]
    pub(in crate::cli) json: bool,

    /// Where pictures and models are that the script reads [default: the file's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct HashArgs {
    /// Scenes to hash. With one, the line is PIXELS SCENE; with several, the name follows
    #[arg(value_name = "FILE", required = true)]
    pub(in crate::cli) files: Vec<PathBuf>,

    /// Only the hash of the scene: nothing is rendered that the script does not render itself
    #[arg(long)]
    pub(in crate::cli) scene: bool,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ParamsArgs {
    /// The script, or - for standard input
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// As JSON: an array of objects with name, type, default, value, min, max, choices, doc, line
    #[arg(long)]
    pub(in crate::cli) json: bool,

    #[command(flatten)]
    pub(in crate::cli) define: Defines,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    /// Scenes to look at: scripts (.rhai) or course scenes (.test), or - for a script on standard input
    #[arg(value_name = "FILE", required = true)]
    pub(in crate::cli) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) define: Defines,

    /// Only errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

pub(super) const AFTER_DIFF: &str = "\
Examples:
  rtscript diff old.rhai new.rhai                     what is different, as text
  rtscript diff old.rhai new.rhai -o diff.png         and both pictures with what differs between them
  rtscript diff old.png scene.rhai                    the script that a picture carries against the script of now

Things are the same where all about them is, wherever a script makes them; otherwise they are matched by the line that \
made them, as far as the lines of both scripts belong together, and then by form, look and place. What many things of \
one line have in common is told once.

Exit codes: 0 nothing is different, 1 something is, 2 usage, or an error in a scene; all others as everywhere.";

#[derive(Debug, Args)]
pub(in crate::cli) struct DiffArgs {
    /// The scene as it was: .rhai, .test, - for a script on standard input, or a PNG that rtscript wrote
    #[arg(value_name = "BEFORE")]
    pub(in crate::cli) before: PathBuf,

    /// The scene as it is
    #[arg(value_name = "AFTER")]
    pub(in crate::cli) after: PathBuf,

    /// Render both and write before | difference | after side by side: a .png, .jpg or .ppm file
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// As JSON: an object with equal, settings, changes and, with -o, pixels
    #[arg(long)]
    pub(in crate::cli) json: bool,

    #[command(flatten)]
    pub(in crate::cli) overrides: Overrides,

    #[command(flatten)]
    pub(in crate::cli) threads: Threads,

    /// No warnings
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}
