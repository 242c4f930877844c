//! What can be typed after `rtscript`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::range;
use crate::parameters::{Parameters, parse_size};

const AFTER_HELP: &str = "\
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

const AFTER_TEST: &str = "\
A scene is a script (.rhai) or a course scene (.test). Without paths, these are tested: below the current folder, \
every scene that has a snapshot, and every scene in a folder called tests. A folder that is given is searched for \
all scenes. Hidden files, names that begin with _, and the folders lib, modules, target and node_modules are passed \
over.

The snapshot of scene.rhai is scene.rtsnap, a small text to be kept beside it, and its reference picture is \
scene.rtsnap.png, which also carries the script, so that a report can tell what changed in it. A scene is \
rendered in the size on record; a new one in its own size, but at most 320 pixels along the longer edge.

Exit codes: 0 all as on record, 1 something changed, is new or fails, 2 usage, 3 a path is missing, 4 a report or \
a snapshot cannot be written, 130, 143, 129 stopped by a signal.";

const AFTER_SWEEP: &str = "\
Examples:
  rtscript sweep scene.rhai -D radius=0.1..1:10                 ten pictures
  rtscript sweep scene.rhai -D radius=0.1..1:5 -D seed=1..4 --grid --size 160x120";

const AFTER_WHY: &str = "\
Examples:
  rtscript why scene.rhai 320,240                      the pixel in column 320, row 240 from the top left
  rtscript why scene.png 320,240                       the same of a picture that rtscript wrote
  rtscript why scene.rhai 320,240 --image rays.png     its rays drawn into the picture: reflected cyan, refracted
                                                       magenta, to lights yellow, tinted green, blocked red

The terms of all rays add up to the pixel's linear value. A scene's size decides what its pixels are: give the --size \
that the picture was rendered with.";

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
    /// Compare scenes with their snapshots, or put them on record
    #[command(after_help = AFTER_TEST)]
    Test(TestArgs),
    /// Write a starter scene
    New(NewArgs),
    /// Say whether scenes are sound, without rendering them
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
}

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Scenes to render: scripts (.rhai) or course scenes (.test), or - for a script on standard input
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    /// Where the picture goes: a .png, .jpg or .ppm file, or - for PNG on standard output; with several scenes, a
    /// folder. Of several pictures that a script renders, the last [default: the scene's name with .png, in the
    /// current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    #[command(flatten)]
    pub(super) overrides: Overrides,

    /// Threads to render with; the picture is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Show something else than light, through the middle of each pixel: normals, texture coordinates, distances,
    /// objects or lines of the script by color, what each pixel costs [default name: scene-WHAT.png]
    #[arg(long, value_name = "WHAT", conflicts_with = "stats")]
    pub(super) show: Option<ShowWhat>,

    /// Leave out of a PNG what it was made from: script, modules, parameters, version, hash
    #[arg(long)]
    pub(super) no_recipe: bool,

    /// Only errors: no progress, no warnings, no line for each picture
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// What it took, on standard error: rays by kind, seconds by stage, memory. As JSON, one line for each scene
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "text")]
    pub(super) stats: Option<StatsFormat>,
}

/// What is decided on the command line instead of in the scene.
#[derive(Debug, Args)]
pub(super) struct Overrides {
    /// Size of the picture in pixels, such as 640x480, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,

    /// Rays per pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) samples: Option<u32>,

    /// Seed of every random choice, in place of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) seed: Option<u64>,

    #[command(flatten)]
    pub(super) define: Defines,
}

/// Parameters of the script.
#[derive(Debug, Args)]
pub(super) struct Defines {
    /// Value of a parameter that the script declares by param(name, default); rtscript params lists them
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

impl Defines {
    pub(super) fn parameters(&self) -> Parameters {
        let mut parameters = Parameters::default();
        for (name, value) in &self.define {
            // What cannot be set was refused when it was parsed.
            let _ = parameters.set(name, value);
        }
        parameters
    }
}

impl Overrides {
    pub(super) fn parameters(&self) -> Parameters {
        let mut parameters = self.define.parameters();
        parameters.size = self.size.or(parameters.size);
        parameters.samples = self.samples.or(parameters.samples);
        parameters.seed = self.seed.or(parameters.seed);
        parameters
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum StatsFormat {
    /// For people
    Text,
    /// For programs
    Json,
}

#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// The course scene (.test), or - for standard input
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// The script to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct TestArgs {
    /// Scenes, or folders to be searched for scenes
    #[arg(value_name = "PATH")]
    pub(super) paths: Vec<PathBuf>,

    /// Put what changed and what is new on record
    #[arg(long, conflicts_with = "review")]
    pub(super) accept: bool,

    /// Show what changed and what is new, one by one, and ask whether to accept it
    #[arg(long)]
    pub(super) review: bool,

    /// Only scenes whose path contains TEXT; several are alternatives
    #[arg(long, value_name = "TEXT")]
    pub(super) filter: Vec<String>,

    /// Scenes to work on at once [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) jobs: Option<u16>,

    /// Largest mean FLIP error that passes, 0 to 1, where pixels differ; 0.01 is hardly seen. Needs reference pictures
    #[arg(long, value_name = "X", default_value = "0", hide_default_value = true, value_parser = parse_tolerance)]
    pub(super) tolerance: f64,

    #[command(flatten)]
    pub(super) overrides: Overrides,

    /// Keep no reference pictures beside the snapshots; a change is then found, but not shown
    #[arg(long)]
    pub(super) no_pictures: bool,

    /// Write a report to be looked at: one HTML file with all pictures in it
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,

    /// Write a report in JUnit's XML, which CI systems read
    #[arg(long, value_name = "FILE")]
    pub(super) junit: Option<PathBuf>,

    /// Write a report in JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,

    /// Write expected, difference and actual side by side into this folder, for each scene that changed
    #[arg(long, value_name = "FOLDER")]
    pub(super) diffs: Option<PathBuf>,

    /// Pictures in the terminal with --review
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(super) pictures: TerminalPictures,

    /// Only what did not pass, and the last line
    #[arg(short, long)]
    pub(super) quiet: bool,
}

impl TestArgs {
    /// What clap cannot say about arguments that several commands share.
    pub(super) fn check(&self) -> Result<(), String> {
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
pub(super) enum TerminalPictures {
    /// By what the terminal says it can; none where there is no terminal
    #[default]
    Auto,
    /// Kitty's protocol, which Ghostty and WezTerm speak too
    Kitty,
    /// Colored half blocks
    Blocks,
    /// No pictures
    None,
}

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// Name of the scene: without an ending, .rhai is added
    #[arg(value_name = "NAME")]
    pub(super) name: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Scenes to look at: scripts (.rhai) or course scenes (.test), or - for a script on standard input
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) define: Defines,

    /// Only errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct ParamsArgs {
    /// The script, or - for standard input
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// As JSON: an array of objects with name, type, default, value, min, max, choices, doc, line
    #[arg(long)]
    pub(super) json: bool,

    #[command(flatten)]
    pub(super) define: Defines,
}

#[derive(Debug, Args)]
pub(super) struct SweepArgs {
    /// The script, or - for standard input
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// Values of a parameter: 0.1..1:10 are ten from 0.1 to 1, 1..4 the whole numbers from 1 to 4, a,b,c these three
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUES", required = true, value_parser = parse_values)]
    pub(super) define: Vec<(String, Vec<String>)>,

    /// All pictures on one sheet, each with its values below; those of the last parameter stand in a row
    #[arg(long)]
    pub(super) grid: bool,

    /// The folder for the pictures, or with --grid the file for the sheet [default: the current folder, the script's
    /// name with -sweep.png]
    #[arg(short, long, value_name = "PATH")]
    pub(super) output: Option<PathBuf>,

    /// Size of each picture in pixels, such as 160x120, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,

    /// Rays per pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) samples: Option<u32>,

    /// Threads to render with; the pictures are the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Only errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct RerunArgs {
    /// A PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// Where the new picture goes [default: the old one's name with -rerun.png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// Print the recipe, scripts and all, instead of rendering it
    #[arg(long)]
    pub(super) print: bool,

    /// Where pictures and models are that the script reads [default: the PNG's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(super) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(super) overrides: Overrides,

    /// Threads to render with; the picture is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(super) struct VerifyArgs {
    /// PNGs that rtscript wrote
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    /// Where pictures and models are that the scripts read [default: each PNG's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(super) assets: Option<PathBuf>,

    /// Threads to render with; the answer is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(super) struct HashArgs {
    /// Scenes to hash. With one, the line is PIXELS SCENE; with several, the name follows
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    /// Only the hash of the scene: nothing is rendered that the script does not render itself
    #[arg(long)]
    pub(super) scene: bool,

    #[command(flatten)]
    pub(super) overrides: Overrides,

    /// Threads to render with; the hash is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(super) struct HelpArgs {
    /// A function (sphere), a constant, a group of functions (shapes) or a command (test)
    #[arg(value_name = "NAME")]
    pub(super) name: Option<String>,

    /// The whole table as JSON, for programs
    #[arg(long, group = "all", conflicts_with = "name")]
    pub(super) json: bool,

    /// Definitions for editors: a .d.rhai file
    #[arg(long, group = "all", conflicts_with = "name")]
    pub(super) definitions: bool,

    /// Write the reference into a folder: reference.md with its pictures, api.json, rtscript.d.rhai
    #[arg(long, value_name = "FOLDER", group = "all", conflicts_with = "name")]
    pub(super) write: Option<PathBuf>,

    /// The example's picture in the terminal
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(super) pictures: TerminalPictures,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub(super) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// A command [default: the program]
    #[arg(value_name = "COMMAND")]
    pub(super) command: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct WhyArgs {
    /// The scene (.rhai or .test), - for a script on standard input, or a PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// The pixel: column and row from the top left, both from 0
    #[arg(value_name = "X,Y", value_parser = parse_pixel)]
    pub(super) pixel: (u32, u32),

    /// The sample whose rays are told, from 0
    #[arg(long, value_name = "N", default_value = "0")]
    pub(super) sample: u32,

    /// As JSON, with all digits and all rays
    #[arg(long)]
    pub(super) json: bool,

    /// Draw the rays into the picture and write it here: a .png, .jpg or .ppm file
    #[arg(long, value_name = "FILE")]
    pub(super) image: Option<PathBuf>,

    /// Where pictures and models are that the script reads [default: the file's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(super) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(super) overrides: Overrides,
}

#[derive(Debug, Args)]
pub(super) struct BlameArgs {
    /// The scene (.rhai or .test), - for a script on standard input, or a PNG that rtscript wrote
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// Write a heat map here, what costs most white: a .png, .jpg or .ppm file
    #[arg(long, value_name = "FILE")]
    pub(super) image: Option<PathBuf>,

    /// As JSON: an array of objects with file, line, text, pixels, rays, shadow_rays, boxes
    #[arg(long)]
    pub(super) json: bool,

    /// Where pictures and models are that the script reads [default: the file's folder]
    #[arg(long, value_name = "FOLDER")]
    pub(super) assets: Option<PathBuf>,

    #[command(flatten)]
    pub(super) overrides: Overrides,
}

/// What a picture shows instead of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ShowWhat {
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
    pub(super) fn name(self) -> &'static str {
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

/// `320,240` to column and row.
fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    let pixel = text
        .split_once(',')
        .and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    pixel.ok_or_else(|| "expected column and row from the top left, such as 320,240".to_owned())
}

/// `radius=0.5` to name and value, both as they may be.
fn parse_define(text: &str) -> Result<(String, String), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("expected NAME=VALUE, such as radius=0.5")?;
    Parameters::default().set(name, value)?;
    Ok((name.to_owned(), value.to_owned()))
}

/// `radius=0.1..1:10` to the name and all values.
fn parse_values(text: &str) -> Result<(String, Vec<String>), String> {
    let (name, list) = text
        .split_once('=')
        .ok_or("expected NAME=VALUES, such as radius=0.1..1:10")?;
    let values = range::values(list)?;
    for value in &values {
        Parameters::default().set(name, value)?;
    }
    Ok((name.to_owned(), values))
}

/// A share of 1.
fn parse_tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    number
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| "expected a number from 0 (exact) to 1".to_owned())
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
