//! A picture that grows in the terminal while it is traced, and can be stopped: tiles as they are finished, progress,
//! cancellation from another thread, threads of the program's own choosing.
//!
//! `cargo run --release --example progress -- scene.rhai`; Enter stops it.

#![allow(clippy::print_stdout, reason = "a program may print")]

use std::{
    error::Error,
    fs,
    io::{self, Write},
    path::Path,
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use rtscript::{
    DirHost, Host, Limits, RenderOptions, RunOptions, Script,
    diag::ErrorKind,
    host::HostError,
    render,
    render::{Progress, Tile},
};

/// Tells what a render says of itself, and passes on the wish to stop it.
struct Window {
    files: DirHost,
    stop: AtomicBool,
    /// Sum of the light of all tiles, for want of a real window.
    light: Mutex<f64>,
}

impl Host for Window {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.files.read(path, max_bytes)
    }

    fn print(&self, text: &str) {
        println!("{text}");
    }

    // Asked every few milliseconds, also while files are read and trees are built.
    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    // Here a window would copy the pixels to its place (x, y).
    fn tile(&self, tile: &Tile<'_>) {
        if let Ok(mut light) = self.light.lock() {
            *light += tile.pixels.as_flattened().iter().sum::<f64>();
        }
    }

    fn progress(&self, progress: &Progress) {
        let percent = 100 * progress.done / progress.total;
        print!("\r{percent:3} %, {} rays", progress.rays);
        let _ = io::stdout().flush();
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = std::env::args().nth(1);
    let scene = scene.as_deref().unwrap_or("scripts/sphereflake.rhai");
    let window = Window {
        files: DirHost::new(Path::new(scene).parent().unwrap_or(Path::new("."))),
        stop: AtomicBool::new(false),
        light: Mutex::new(0.0),
    };
    let script = Script::compile(scene, &fs::read_to_string(scene)?, &Limits::default())?;
    // Everything is traced on the threads of the pool that a render is called in.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let picture = thread::scope(|scope| {
        let render = scope.spawn(|| {
            pool.install(|| {
                let run = script.run(&window, &RunOptions::default())?;
                render(&run.value.scene, &RenderOptions::default(), &window)
            })
        });
        // The window's own loop would go on here. This one waits for a line, on a thread that ends with the program.
        let (line, lines) = std::sync::mpsc::channel();
        thread::spawn(move || {
            if io::stdin()
                .read_line(&mut String::new())
                .is_ok_and(|bytes| bytes > 0)
            {
                let _ = line.send(());
            }
        });
        while !render.is_finished() {
            if lines.recv_timeout(std::time::Duration::from_millis(20)).is_ok() {
                window.stop.store(true, Ordering::Relaxed);
            }
        }
        render.join()
    });
    match picture {
        Ok(Ok(report)) => println!("\n{}", report.value.image.hash()),
        Ok(Err(e)) if e.kind() == ErrorKind::Cancelled => println!("\nstopped"),
        Ok(Err(e)) => return Err(e.into()),
        Err(_) => return Err("the render panicked".into()),
    }
    Ok(())
}
