//! Runs a script of a stranger, as a program does that has nothing else to lose: `benches/abuse.py` runs many.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program tells what happened"
)]

use std::{env, fs, process::ExitCode};

use rtscript::{DirHost, Error, Limits, RenderOptions, RunOptions, Script, meter::Meter, render};

#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

fn main() -> ExitCode {
    let Some(path) = env::args_os().nth(1) else {
        eprintln!("which script?");
        return ExitCode::from(2);
    };
    let folder = std::path::Path::new(&path)
        .parent()
        .unwrap_or("".as_ref())
        .to_owned();
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) => {
            eprintln!("{e}");
            return ExitCode::from(3);
        }
    };
    match run(&text, &DirHost::new(folder)) {
        Ok(rays) => {
            println!("{rays} rays");
            ExitCode::SUCCESS
        }
        Err(e) => {
            eprintln!("{e}");
            ExitCode::from(1)
        }
    }
}

fn run(text: &str, host: &DirHost) -> Result<u64, Error> {
    let limits = Limits::untrusted();
    let run = Script::compile("scene.rhai", text, &limits)?
        .run(host, &RunOptions::default())?
        .value;
    let rendered = render(&run.scene, &RenderOptions::default().within(&limits), host)?;
    Ok(rendered.value.stats.rays())
}
