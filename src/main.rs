//! The `rtscript` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(rtscript::cli::run(std::env::args_os()))
}
