//! What the stages of one scene take in processor seconds, on one thread: what `versus/run.py` puts beside other
//! renderers.
//!
//! usage: `cargo bench --bench scene -- SCENE.rhai [--reps N]`; one line of comma-separated values: script,
//! compile, trace (seconds, medians), rays, primitives, bytes of the compiled world.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

mod common;

use std::path::Path;

use common::{arguments, median, one_thread, timed};
use rtscript::{DirHost, Limits, RenderOptions, RunOptions, Script, render, render::World};

fn main() {
    let (args, reps) = arguments(3);
    let [path] = &args[..] else {
        println!("usage: cargo bench --bench scene -- SCENE.rhai [--reps N]");
        return;
    };
    let path = Path::new(path);
    let host = DirHost::new(path.parent().unwrap());
    let name = path.file_name().unwrap().to_str().unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let (script, scene) = timed(|| {
        let script = Script::compile(name, &text, &Limits::default()).unwrap();
        script.run(&host, &RunOptions::default()).unwrap().value.scene
    });
    let pool = one_thread();
    let (mut compiles, mut renders, mut stats) = (Vec::new(), Vec::new(), None);
    for _ in 0..reps {
        let (compile, world) = timed(|| pool.install(|| World::compile(&scene)).unwrap());
        drop(world);
        let (whole, rendered) = timed(|| {
            pool.install(|| render(&scene, &RenderOptions::default(), &host))
                .unwrap()
        });
        compiles.push(compile);
        renders.push(whole);
        stats = Some(rendered.value.stats);
    }
    let (compile, whole, stats) = (median(compiles), median(renders), stats.unwrap());
    println!(
        "{script:.6},{compile:.6},{:.6},{},{},{}",
        whole - compile,
        stats.rays(),
        stats.primitives,
        stats.world_bytes
    );
}
