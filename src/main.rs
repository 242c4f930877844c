//! The `rtscript` command.

fn main() {}
