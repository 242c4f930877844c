//! Models that mean harm: the OBJ files under `models/` and larger or odder ones made here, each loaded by a script.

#![cfg(unix)]

use std::{f64::consts::TAU, fmt::Write as _, fs, path::Path, process::Command};

use rtscript::{Limits, MemoryHost, math};

use crate::{empty_folder, outcome, settle_files};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A face with these corners.
fn outline(count: usize, radius: impl Fn(usize) -> f64) -> String {
    let mut text = String::new();
    for i in 0..count {
        let (sin, cos) = math::sin_cos_degrees(360.0 * i as f64 / count as f64);
        let _ = writeln!(text, "v {} {} 0", radius(i) * cos, radius(i) * sin);
    }
    text + face(count).as_str()
}

/// A face of the first `count` vertices.
fn face(count: usize) -> String {
    let corners: String = (1..=count).map(|i| format!(" {i}")).collect();
    format!("f{corners}\n")
}

/// A band wound into a spiral: half its corners are reflex, and few of the others can be cut off at a time.
fn spiral(count: usize) -> String {
    let side = |i: usize, apart: f64| {
        let angle = i as f64 * 0.7;
        let radius = 1.0 + apart + angle / TAU;
        format!(
            "v {} {} 0\n",
            radius * math::cos(angle),
            radius * math::sin(angle)
        )
    };
    let out = (0..count / 2).map(|i| side(i, 0.0));
    let back = (0..count / 2).rev().map(|i| side(i, 0.5));
    out.chain(back).collect()
}

fn made() -> Vec<(&'static str, Vec<u8>)> {
    let many = |n: usize, piece: &dyn Fn(usize) -> String| -> String {
        TRIANGLE.to_owned() + (0..n).map(piece).collect::<String>().as_str()
    };
    let utf16 = |text: &str| -> Vec<u8> {
        let units = [0xfeff].into_iter().chain(text.encode_utf16());
        units.flat_map(u16::to_le_bytes).collect()
    };
    let whole = format!("{TRIANGLE}f 1 2 3\n");
    vec![
        ("mark-at-the-start", format!("\u{feff}{whole}").into_bytes()),
        ("carriage-returns", whole.replace('\n', "\r").into_bytes()),
        ("utf-16", utf16(&whole)),
        ("not-utf-8", [whole.as_bytes(), b"g \xff\xfe\nf 1 2 9\n"].concat()),
        ("nul", format!("{TRIANGLE}f 1 2 3\0\n").into_bytes()),
        ("nothing", Vec::new()),
        (
            "noise",
            (0..100_000u32)
                .map(|i| (i.wrapping_mul(2_654_435_769) >> 24) as u8)
                .collect(),
        ),
        (
            "continued-100k",
            format!("{whole}g a{}", "\\\n".repeat(100_000)).into_bytes(),
        ),
        (
            "line-of-10-mb",
            format!("{whole}g {}\n", "a ".repeat(5 << 20)).into_bytes(),
        ),
        (
            "number-of-1-mb",
            format!("v 0 0 {}\n", "9".repeat(1 << 20)).into_bytes(),
        ),
        (
            "faces-3m",
            many(3_000_000, &|_| "f 1 2 3\n".to_owned()).into_bytes(),
        ),
        (
            "faces-300k",
            many(300_000, &|_| "f 1 2 3\n".to_owned()).into_bytes(),
        ),
        (
            "file-of-17-mb",
            format!("{whole}{}", "# \n".repeat(17 << 20 >> 1)).into_bytes(),
        ),
        (
            "vertices-1m",
            many(1_000_000, &|i| format!("v {i} 0 0\n")).into_bytes(),
        ),
        (
            "groups-200k",
            many(200_000, &|i| format!("g {i}\nf 1 2 3\n")).into_bytes(),
        ),
        (
            "materials-200k",
            many(200_000, &|i| format!("usemtl {i}\nf 1 2 3\n")).into_bytes(),
        ),
        ("libraries-2k", {
            let libraries = many(2_000, &|i| format!("mtllib l{i}.mtl\n"));
            (libraries + "usemtl b\nf 1 2 3\n").into_bytes()
        }),
        (
            "indices-ahead-1m",
            many(333_333, &|i| format!("f {0} {0}1 {0}2\n", i + 4)).into_bytes(),
        ),
        ("corners-100k-round", outline(100_000, |_| 1.0).into_bytes()),
        (
            "corners-100k-star",
            outline(100_000, |i| 1.0 + (i % 2) as f64).into_bytes(),
        ),
        (
            "corners-100k-crossing",
            outline(100_000, |i| ((i * 7919) % 1000) as f64).into_bytes(),
        ),
        (
            "corners-100k-spiral",
            (spiral(100_000) + face(100_000).as_str()).into_bytes(),
        ),
        (
            "spirals-of-1000",
            (spiral(1_000) + face(1_000).repeat(195).as_str()).into_bytes(),
        ),
    ]
}

/// The files under `models/`, those made here, a pipe and a link to a device.
fn put_all(folder: &Path) -> Vec<(String, String)> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abuse/models");
    for file in fs::read_dir(kept).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.join(file.file_name())).unwrap();
    }
    for (name, bytes) in made() {
        fs::write(folder.join(name).with_extension("obj"), bytes).unwrap();
    }
    std::os::unix::fs::symlink("/dev/zero", folder.join("zero.mtl")).unwrap();
    let pipe = Command::new("mkfifo").arg(folder.join("pipe.mtl")).status();
    assert!(pipe.unwrap().success());
    for i in 0..2_000 {
        fs::write(folder.join(format!("l{i}.mtl")), "newmtl a\n").unwrap();
    }
    let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let mut names: Vec<String> = files
        .filter(|file| file.extension().is_some_and(|kind| kind == "obj"))
        .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
        .into_iter()
        .map(|name| (name.clone(), format!("mesh(\"{name}.obj\");\nsize(16, 16);\n")))
        .collect()
}

#[test]
fn every_model_ends_with_what_stopped_it() {
    let folder = empty_folder("models");
    let scripts = put_all(&folder);
    assert!(scripts.len() >= 50, "{} models", scripts.len());
    settle_files("models.txt", &folder, &scripts);
}

/// Reading a model is one step of the script, and may take minutes: it ends when the script's time does.
#[test]
fn a_time_that_is_over_at_once_is_the_limit_that_is_named() {
    const OVER: &str = "error: the script runs too long: the limit 'script_time' is 1ns";
    // What has few steps may be done before anybody looks at the time; what has many may not.
    const SHORT: [&str; 3] = ["", "let a = 1;", "sphere(0, 0, 0, 1);"];
    const LONG: [&str; 3] = [
        "let a = 0; while a < 2000 { a += 1; }",
        "loop { try { loop { } } catch { } }",
        "let a = []; a.pad(20000, 1); a.sort_desc();",
    ];
    let mut limits = Limits::untrusted();
    limits.array_len = 20_000;
    limits.script_time = std::time::Duration::from_nanos(1);
    for (i, script) in SHORT.iter().chain(&LONG).enumerate() {
        let said = outcome("", script, &limits, &MemoryHost::new());
        let is_over = said.starts_with("scene.rhai:1:") && said.ends_with(OVER);
        assert!(
            is_over || i < SHORT.len() && said == "runs to its end",
            "{script}: {said}"
        );
    }
    limits.script_time = std::time::Duration::from_secs(3600);
    for script in SHORT
        .iter()
        .chain(LONG.iter().filter(|script| !script.starts_with("loop")))
    {
        let said = outcome("", script, &limits, &MemoryHost::new());
        assert_eq!(said, "runs to its end", "{script}");
    }
}

#[test]
fn the_time_of_a_script_ends_a_model_too() {
    let mut limits = Limits::untrusted();
    limits.script_time = std::time::Duration::from_nanos(1);
    let model = spiral(1_000) + face(1_000).as_str();
    let host = MemoryHost::new().with("a.obj", model);
    assert_eq!(
        outcome("", "\nmesh(\"a.obj\");", &limits, &host),
        "scene.rhai:2:1: error: the script runs too long: the limit 'script_time' is 1ns"
    );
}
