//! `rtscript help`, `completions` and `man`.

use std::path::PathBuf;

use clap::Args;

use super::test::TerminalPictures;

#[derive(Debug, Args)]
pub(in crate::cli) struct HelpArgs {
    /// A function (sphere), a constant, a group of functions (shapes), a command (test) or the class of a message (no-light)
    #[arg(value_name = "NAME")]
    pub(in crate::cli) name: Option<String>,

    /// The whole table as JSON, for programs
    #[arg(long, group = "all", conflicts_with = "name")]
    pub(in crate::cli) json: bool,

    /// Definitions for editors: a .d.rhai file
    #[arg(long, group = "all", conflicts_with = "name")]
    pub(in crate::cli) definitions: bool,

    /// Write the reference into a folder: reference.md with its pictures, api.json, rtscript.d.rhai
    #[arg(long, value_name = "FOLDER", group = "all", conflicts_with = "name")]
    pub(in crate::cli) write: Option<PathBuf>,

    /// The example's picture in the terminal
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(in crate::cli) pictures: TerminalPictures,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub(in crate::cli) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ManArgs {
    /// A command [default: the program]
    #[arg(value_name = "COMMAND")]
    pub(in crate::cli) command: Option<String>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct LspArgs {
    /// Speak on standard input and output, as is always done: some editors say so
    #[arg(long)]
    pub(in crate::cli) stdio: bool,
}
