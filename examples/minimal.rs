//! The least a Rust program does: a script in, a PNG out.
//!
//! `cargo run --release --example minimal -- scene.rhai picture.png`

use std::{error::Error, fs, path::Path};

use rtscript::{DirHost, Limits, RenderOptions, RunOptions, Script, output, render};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let scene = args
        .next()
        .unwrap_or_else(|| "scripts/sphereflake.rhai".to_owned());
    let picture = args.next().unwrap_or_else(|| "minimal.png".to_owned());
    let host = DirHost::new(Path::new(&scene).parent().unwrap_or(Path::new(".")));
    let script = Script::compile(&scene, &fs::read_to_string(&scene)?, &Limits::default())?;
    let run = script.run(&host, &RunOptions::default())?;
    let rendered = render(&run.value.scene, &RenderOptions::default(), &host)?;
    output::save(Path::new(&picture), &rendered.value.image)?;
    Ok(())
}
