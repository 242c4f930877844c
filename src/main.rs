//! The `rtscript` command.

use std::process::ExitCode;

use rtscript::meter::Meter;

/// For the limit on what a script may hold.
#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

fn main() -> ExitCode {
    ExitCode::from(rtscript::cli::run(std::env::args_os()))
}
