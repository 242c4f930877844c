//! Shell completions and manual pages, from the definition of the arguments.

use clap::{CommandFactory, error::ErrorKind as UsageError};

use super::{
    args::{Cli, CompletionsArgs, ManArgs},
    usage, without_place, write_stdout,
};
use crate::{
    diag::{Error, ErrorKind},
    host::HostError,
};

/// Prints the script that a shell reads.
///
/// # Errors
/// `Output` where it cannot be written.
pub(super) fn completions(args: &CompletionsArgs) -> Result<(), Error> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "rtscript", &mut script);
    write_stdout(&script).map_err(without_place)
}

/// Prints a page in the format of man and returns the exit code: 2 where there is no such command.
///
/// # Errors
/// `Output` where it cannot be written.
pub(super) fn page(args: &ManArgs) -> Result<u8, Error> {
    let mut command = Cli::command();
    command.build();
    let command = match args.command.as_deref() {
        None => command,
        Some(name) => match command.find_subcommand(name) {
            Some(found) => found.clone(),
            None => {
                let message = format!("there is no command '{name}'");
                return Ok(usage(&command.error(UsageError::InvalidValue, message)));
            }
        },
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|e| without_place(HostError::new(ErrorKind::Internal, e.to_string())))?;
    write_stdout(&page).map(|()| 0).map_err(without_place)
}
