//! Scripts kept as data under `attacks/`, run under both presets. A line `@repeat N TEXT` stands for N times TEXT, with
//! the count in place of `#`.
//!
//! Here a run has fewer steps than the presets give it, so that the test is quick and what stops a script does not depend
//! on the machine; `benches/abuse.py` runs the same files with the presets as they are. One that begins with `// by time`
//! takes for ever in so few steps and rays that only the time of the render ends it.

use std::{fs, path::Path, time::Duration};

use rtscript::MemoryHost;

use crate::{outcome, presets, settle};

/// Steps a run may take here.
const OPERATIONS: u64 = 20_000;

/// The text with its repetitions written out. Lines of repetitions are joined without an end of line.
fn written_out(text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let Some(repeat) = line.strip_prefix("@repeat ") else {
            out += line;
            out.push('\n');
            continue;
        };
        let (count, piece) = repeat.split_once(' ').unwrap();
        let count: usize = count.parse().unwrap();
        (0..count).for_each(|i| out += &piece.replace('#', &i.to_string()));
        out.push('\n');
    }
    out
}

#[test]
fn every_attack_ends_with_what_stopped_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abuse/attacks");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    assert!(files.len() > 90, "{} attacks", files.len());
    let host = MemoryHost::new().with("self.rhai", "import \"self\" as s;");
    let mut text = String::new();
    for (preset, limits) in presets() {
        for file in &files {
            let name = file.file_stem().unwrap().to_string_lossy();
            let script = written_out(&fs::read_to_string(file).unwrap());
            let mut limits = limits.clone();
            if script.starts_with("// by time") {
                limits.render_time = Some(Duration::from_secs(1));
            } else {
                limits.operations = OPERATIONS;
                limits.script_memory = limits.script_memory.min(32 << 20);
                limits.rays = limits.rays.or(Some(1_000_000)).map(|rays| rays.min(1_000_000));
                limits.render_time = limits.render_time.map(|time| time * 100);
                limits.pictures = limits.pictures.min(20);
            }
            let line = outcome(&name, &script, &limits, &host);
            text += &format!("{preset:9} {name:26} {line}\n");
        }
    }
    settle("attacks.txt", &text);
}
