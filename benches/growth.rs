//! How cost grows with what a scene holds: time and memory for each unit, which should hardly change from row to
//! row. A step in it is something that does not scale.
//!
//! usage: `cargo bench --bench growth [-- --full]`; prints a table in Markdown, up to 1e5 of everything, with
//! `--full` up to 1e7 triangles and spheres and 1e6 instances (minutes, and some 6 GiB). One thread, processor
//! seconds. Each row is measured in a process of its own, so that its peak of memory is its own.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::indexing_slicing
)]

mod common;

use std::process::Command;

use common::{median, one_thread, scenes, timed};
use rtscript::{DVec3, NoHost, RenderOptions, Scene, Term, math::sin, render, render::World, shape::Shape};

/// What a row was measured to take.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Nanoseconds of building the description, for each unit.
    scene: f64,
    /// Nanoseconds of compiling it, for each unit.
    compile: f64,
    /// Bytes of the compiled world, for each unit.
    bytes: f64,
    /// MiB of the whole process at its largest.
    peak: f64,
    /// Nanoseconds for each ray, or for each ray of each unit where all units are asked.
    trace: f64,
    /// Rays for each pixel.
    rays: f64,
}

fn peak_mebibytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<f64>().ok())
        .map_or(f64::NAN, |kib| kib / 1024.0)
}

/// A world of `n` of something, and rays through it.
fn many(n: usize, make: fn(usize) -> Scene) -> Row {
    let (scene_took, scene) = timed(|| make(n));
    let pool = one_thread();
    let (compile_took, world) = timed(|| pool.install(|| World::compile(&scene)).unwrap());
    let peak = peak_mebibytes();
    let rays = scenes::scattered_rays(100_000);
    let shoot = || {
        rays.iter()
            .filter(|r| world.nearest_t(r, f64::INFINITY).is_some())
            .count()
    };
    let trace = median((0..3).map(|_| timed(shoot).0).collect());
    Row {
        scene: scene_took / n as f64 * 1e9,
        compile: compile_took / n as f64 * 1e9,
        bytes: world.bytes() as f64 / n as f64,
        peak,
        trace: trace / rays.len() as f64 * 1e9,
        rays: f64::NAN,
    }
}

/// A picture; `units` share what tracing it takes.
fn picture(scene: &Scene, units: f64) -> Row {
    let pool = one_thread();
    let pixels = f64::from(scene.settings.width * scene.settings.height);
    let mut times = Vec::new();
    let mut rays = 0;
    for _ in 0..3 {
        let (took, rendered) = timed(|| {
            pool.install(|| render(scene, &RenderOptions::default(), &NoHost))
                .unwrap()
        });
        times.push(took);
        rays = rendered.value.stats.rays();
    }
    Row {
        scene: f64::NAN,
        compile: f64::NAN,
        bytes: f64::NAN,
        peak: peak_mebibytes(),
        trace: median(times) / pixels / units * 1e9,
        rays: rays as f64 / pixels,
    }
}

/// A few balls on a plane under `n` lamps, each of which reaches everything.
fn lights(n: usize) -> Row {
    let mut b = scenes::stage(96, 96);
    for i in 1..n {
        let angle = i as f64;
        let at = DVec3::new(4.0 * sin(angle), 5.0, 4.0 * sin(angle * 1.7));
        b.point(at, DVec3::splat(1.0 / n as f64)).unwrap();
    }
    for i in 0..9 {
        let (x, z) = (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0);
        b.sphere(DVec3::new(x, 0.0, z), 0.4).unwrap();
    }
    b.translate(DVec3::NEG_Y * 0.4).unwrap();
    b.shape(Shape::Plane(rtscript::shape::Plane)).unwrap();
    picture(&b.finish().value, n as f64)
}

/// Mirror balls between two mirrors, where every ray goes on until it may not. Under glass each ray becomes two, and
/// their number is what grows; here it is what one more bounce costs.
fn depth(n: usize) -> Row {
    let mut b = scenes::stage(96, 96);
    b.max_depth(n as u32).unwrap();
    b.material_mut().reflection = Some(Term::color(DVec3::splat(0.95)));
    for i in 0..27 {
        let at = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0;
        b.sphere(at * 0.8, 0.39).unwrap();
    }
    for z in [-6.0, 6.0] {
        b.push_transform().unwrap();
        b.translate(DVec3::Z * z).unwrap();
        b.rotate(DVec3::X, 90.0).unwrap();
        b.shape(Shape::Plane(rtscript::shape::Plane)).unwrap();
        b.pop_transform().unwrap();
    }
    let row = picture(&b.finish().value, 1.0);
    Row {
        trace: row.trace / row.rays,
        ..row
    }
}

const SUBJECTS: [(&str, &[usize], usize); 5] = [
    (
        "triangles",
        &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
        100_000,
    ),
    (
        "spheres",
        &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
        100_000,
    ),
    (
        "instances",
        &[1, 10, 100, 1_000, 10_000, 100_000, 1_000_000],
        100_000,
    ),
    ("lights", &[1, 10, 100, 1_000], 100),
    ("depth", &[1, 2, 5, 10, 20, 50], 50),
];

fn measure(subject: &str, n: usize) -> Row {
    match subject {
        "triangles" => many(n, scenes::triangles),
        "spheres" => many(n, scenes::spheres),
        "instances" => many(n, scenes::instances),
        "lights" => lights(n),
        _ => depth(n),
    }
}

/// The row as measured by a process of its own.
fn apart(subject: &str, n: usize) -> Row {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--row", subject, &n.to_string()])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    let numbers: Vec<f64> = text.trim().split(',').map(|x| x.parse().unwrap()).collect();
    let [scene, compile, bytes, peak, trace, rays] = numbers.try_into().expect("six numbers");
    Row {
        scene,
        compile,
        bytes,
        peak,
        trace,
        rays,
    }
}

/// A number with three figures; nothing where there is none.
fn cell(x: f64) -> String {
    match x {
        x if x.is_nan() => String::new(),
        x if x.abs() >= 100.0 => format!("{x:.0}"),
        x if x.abs() >= 10.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}

fn main() {
    let (args, _) = common::arguments(0);
    if let [row, subject, n] = &args[..]
        && row == "--row"
    {
        let r = measure(subject, n.parse().unwrap());
        println!(
            "{},{},{},{},{},{}",
            r.scene, r.compile, r.bytes, r.peak, r.trace, r.rays
        );
        return;
    }
    let full = args.iter().any(|a| a == "--full");
    println!(
        "| scene | description, ns a unit | compile, ns a unit | times the row before | bytes a unit | peak MiB | trace, ns | times the row before | rays a pixel |\n\
         |-------|---:|---:|---:|---:|---:|---:|---:|---:|"
    );
    for (subject, counts, quick) in SUBJECTS {
        let mut before: Option<Row> = None;
        for &n in counts.iter().filter(|&&n| full || n <= quick) {
            eprintln!("{subject}: {n}");
            let r = apart(subject, n);
            let times = |of: fn(&Row) -> f64| cell(before.as_ref().map_or(f64::NAN, |b| of(&r) / of(b)));
            let unit = match subject {
                "lights" => " (trace: a pixel and light)",
                "depth" => " (trace: a ray)",
                _ => "",
            };
            println!(
                "| {n} {subject}{unit} | {} | {} | {} | {} | {} | {} | {} | {} |",
                cell(r.scene),
                cell(r.compile),
                times(|r| r.compile),
                cell(r.bytes),
                cell(r.peak),
                cell(r.trace),
                times(|r| r.trace),
                cell(r.rays)
            );
            before = Some(r);
        }
    }
}
