//! What can be typed after `rtscript`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

const AFTER_HELP: &str = "\
Examples:
  rtscript scene.rhai                        writes scene.png in the current folder
  rtscript scene.rhai -o big.png --size 1920x1080 --samples 64
  rtscript *.rhai -o pictures                one picture for each script
  rtscript - < scene.rhai                    reads standard input, writes out.png
  rtscript convert scene1.test -o scene1.rhai

A script reads files below its own folder only. Pictures it names itself, render(\"name.png\"), go below \
the current folder. What it prints goes to standard output, everything else to standard error.

Exit codes: 0 done, 1 script or scene error, 2 usage, 3 input missing or malformed, 4 output cannot be \
written, 5 a limit was hit, 6 access denied, 70 internal error, 130, 143, 129 stopped by SIGINT, SIGTERM, \
SIGHUP.";

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
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render scenes, as without a command; for a file called render or convert write ./render
    #[command(after_help = AFTER_HELP)]
    Render(RenderArgs),
    /// Turn a scene of the CSE167 course into a script that gives the same pixels
    Convert(ConvertArgs),
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

    /// Size of the picture in pixels, such as 640x480, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,

    /// Rays per pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) samples: Option<u32>,

    /// Threads to render with; the picture is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Seed of every random choice, in place of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) seed: Option<u64>,

    /// Only errors: no progress, no warnings, no line for each picture
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// What it took, on standard error: rays by kind, seconds by stage, memory. As JSON, one line for each scene
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "text")]
    pub(super) stats: Option<StatsFormat>,
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

/// `640x480` to its two numbers, both at least 1.
fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let edge = |digits: &str| digits.parse::<u32>().ok().filter(|&n| n > 0);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some((edge(width)?, edge(height)?)))
        .ok_or_else(|| "expected two whole numbers above 0 with an x between, such as 640x480".to_owned())
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
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        assert_eq!(parse_size("1X1"), Ok((1, 1)));
        for bad in [
            "640",
            "640x",
            "x480",
            "0x480",
            "640x0",
            "-1x5",
            "640 x 480",
            "1x2x3",
            "99999999999x1",
        ] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
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
