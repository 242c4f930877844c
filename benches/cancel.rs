//! How long a run goes on after its host has asked to stop, from another thread at random moments of each phase.
//!
//! usage: `cargo bench --bench cancel [PHASE]`; prints a table in Markdown: milliseconds until the call has returned, and
//! until no thread of a script is left, which is when everything has been dropped. A promise of 20 ms is worth what the
//! slowest says. PHASE is a part of the names of the phases to measure.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::indexing_slicing
)]

use std::{
    fmt::Write,
    hint::black_box,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use rtscript::{
    Builder, DVec3, Error, Host, Limits, MemoryHost, RenderOptions, RunOptions, Scene, Script, Term,
    diag::ErrorKind,
    host::HostError,
    math::sin,
    render,
    scene::{Camera, Mesh},
};

/// Runs of each phase that are stopped.
const TRIALS: u32 = 30;

struct Switch {
    off: AtomicBool,
    files: MemoryHost,
    /// Held while a file is read: that is the host's time, which nobody can cut short but itself.
    reads: Mutex<()>,
}

impl Switch {
    fn new(files: MemoryHost) -> Self {
        Self {
            off: AtomicBool::new(false),
            files,
            reads: Mutex::new(()),
        }
    }
}

impl Host for Switch {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let _reads = self.reads.lock();
        self.files.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        self.off.load(Ordering::Relaxed)
    }
}

/// A surface of waves of `2 (n - 1)^2` triangles.
fn waves(n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let at = |i: u32, j: u32| {
        let (x, z) = (f64::from(i) * 0.01, f64::from(j) * 0.01);
        DVec3::new(x, 0.3 * sin(3.0 * x) * sin(2.0 * z), z)
    };
    let positions = (0..n).flat_map(|i| (0..n).map(move |j| at(i, j))).collect();
    let quads = (1..n).flat_map(|i| (1..n).map(move |j| i * n + j));
    let triangles = quads.flat_map(|k| [[k, k - 1, k - n - 1], [k, k - n - 1, k - n]]);
    (positions, triangles.collect())
}

fn mesh(n: u32, copies: u32) -> Scene {
    let (positions, triangles) = waves(n);
    let mesh = Arc::new(Mesh::new("waves", positions, triangles).unwrap());
    let mut b = Builder::new();
    for _ in 0..copies {
        // Moved, so that it is copied as well.
        b.translate(DVec3::new(0.0, 1.0, 0.1)).unwrap();
        b.mesh(&mesh).unwrap();
    }
    b.finish().value
}

fn spheres(n: u32) -> Scene {
    let mut b = Builder::new();
    for i in 0..n {
        let x = f64::from(i);
        b.sphere(DVec3::new(sin(x), sin(1.7 * x), sin(2.3 * x)) * 50.0, 0.1)
            .unwrap();
    }
    b.finish().value
}

/// Balls of glass between mirrors under lights of 65,536 points, with 1024 samples: hours of work.
fn endless() -> Scene {
    let mut b = Builder::new();
    b.size(640, 480).unwrap();
    b.samples(1024).unwrap();
    b.max_depth(64).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, DVec3::Y, 45.0).unwrap());
    b.area_light(
        DVec3::new(-2.0, 5.0, -2.0),
        DVec3::X * 4.0,
        DVec3::Z * 4.0,
        DVec3::ONE,
        256,
    )
    .unwrap();
    b.material_mut().diffuse = Term::color(DVec3::splat(0.5));
    b.material_mut().transmission = Term::color(DVec3::ONE);
    b.material_mut().reflection = Some(Term::color(DVec3::ONE));
    for i in 0..27 {
        let at = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0;
        b.sphere(at * 1.2, 0.6).unwrap();
    }
    b.finish().value
}

/// Whether a thread of this process runs a script. Where the system does not tell: no.
fn script_runs() -> bool {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else {
        return false;
    };
    let names = tasks
        .flatten()
        .flat_map(|task| std::fs::read_to_string(task.path().join("comm")));
    // Linux keeps fifteen letters.
    names.into_iter().any(|name| name.starts_with("rtscript script"))
}

/// Milliseconds from the wish to stop to the return, in order of size, and to the end of the script's thread at most, over
/// all trials; the run takes `lasts` if it is let.
fn stop(
    switch: &Switch,
    lasts: Duration,
    run: impl Fn(&Switch) -> Result<(), Error> + Sync,
) -> (Vec<f64>, f64) {
    let (mut took, mut gone) = (Vec::new(), 0.0);
    for trial in 0..TRIALS {
        switch.off.store(false, Ordering::Relaxed);
        let wait = lasts.mul_f64((f64::from(trial) + 0.5) / f64::from(TRIALS));
        let (ended, asked) = thread::scope(|scope| {
            let run = scope.spawn(|| (run(switch), Instant::now()));
            thread::sleep(wait);
            let reads = switch.reads.lock();
            let asked = Instant::now();
            switch.off.store(true, Ordering::Relaxed);
            drop(reads);
            (run.join().unwrap(), asked)
        });
        while script_runs() {
            thread::sleep(Duration::from_micros(200));
        }
        let all_gone = asked.elapsed().as_secs_f64() * 1e3;
        match ended.0 {
            Err(e) if e.kind() == ErrorKind::Cancelled => {
                took.push(ended.1.saturating_duration_since(asked).as_secs_f64() * 1e3);
                gone = f64::max(gone, all_gone);
            }
            // It was done before.
            Ok(()) => {}
            Err(e) => panic!("{e}"),
        }
    }
    took.sort_by(f64::total_cmp);
    (took, gone)
}

fn row(name: &str, files: MemoryHost, run: impl Fn(&Switch) -> Result<(), Error> + Sync) {
    // Cargo adds arguments of its own.
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    if wanted.is_some_and(|wanted| !name.contains(&wanted)) {
        return;
    }
    let switch = Switch::new(files);
    // At most a second of it.
    let lasts = thread::scope(|scope| {
        let start = Instant::now();
        let run = scope.spawn(|| run(&switch));
        while !run.is_finished() && start.elapsed() < Duration::from_secs(1) {
            thread::sleep(Duration::from_millis(1));
        }
        switch.off.store(true, Ordering::Relaxed);
        start.elapsed()
    });
    let (took, gone) = stop(&switch, lasts, run);
    if let (Some(median), Some(most)) = (took.get(took.len() / 2), took.last()) {
        println!(
            "| {name} | {} | {median:.1} | {most:.1} | {gone:.1} |",
            took.len()
        );
    }
}

fn script(text: &str) -> impl Fn(&Switch) -> Result<(), Error> + Sync {
    // The host ends it, nothing else.
    let mut limits = Limits::default();
    (limits.operations, limits.script_time) = (u64::MAX, Duration::from_secs(3600));
    let script = Script::compile("bench.rhai", text, &limits).unwrap();
    move |switch| {
        script
            .run(switch, &RunOptions::default())
            .map(|run| drop(black_box(run)))
    }
}

fn picture(scene: Scene) -> impl Fn(&Switch) -> Result<(), Error> + Sync {
    move |switch| render(&scene, &RenderOptions::default(), switch).map(|image| drop(black_box(image)))
}

fn main() {
    println!("| phase | runs stopped | median, ms | most, ms | all freed, most, ms |");
    println!("|---|---:|---:|---:|---:|");
    let none = MemoryHost::new;
    row("script, an endless loop", none(), script("loop { }"));
    row(
        "script, spheres for ever",
        none(),
        script("loop { sphere(0, 0, 0, 1); }"),
    );
    row(
        "script, spheres in materials of their own for ever",
        none(),
        script("let i = 0.0; loop { i += 1e-6; diffuse(i, i, i); sphere(i, 0, 0, 1); }"),
    );
    row(
        "script, copies of two million texts",
        none(),
        script("let a = []; for i in 0..2000000 { a.push(`${i}`); } loop { let b = a; b.push(1); }"),
    );
    row(
        "script, a hundred thousand texts written into one",
        none(),
        script("let a = []; for i in 0..100000 { a.push(`${i}`); } loop { let b = `${a}`; }"),
    );
    row(
        "script, sorting 2 million values",
        none(),
        script("let a = shuffle(linspace(0, 1, 2000000)); loop { a.sort(); a.sort_desc(); }"),
    );
    row(
        "script, sorting them by a function of its own",
        none(),
        script("let a = shuffle(linspace(0, 1, 2000000)); loop { a.sort(|x, y| x < y); a.reverse(); }"),
    );
    let (positions, triangles) = waves(708);
    let mut obj = String::new();
    for p in positions {
        writeln!(obj, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    let files = MemoryHost::new().with("waves.obj", obj);
    row(
        "reading an OBJ file of a million triangles",
        files,
        script("mesh(\"waves.obj\");"),
    );
    row(
        "compiling a mesh of a million triangles",
        none(),
        picture(mesh(708, 1)),
    );
    row(
        "compiling four of them, overlapping",
        none(),
        picture(mesh(708, 4)),
    );
    row("compiling a million spheres", none(), picture(spheres(1_000_000)));
    row(
        "tracing glass under lights of 65,536 points",
        none(),
        picture(endless()),
    );
}
