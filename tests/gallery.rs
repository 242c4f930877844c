//! Every script of the gallery, small: it runs without a warning, and its picture is the one it was.
//!
//! The README's ten lines are rendered too.

#![allow(clippy::unwrap_used)]

use std::{fs, path::Path};

use rtscript::{DirHost, Limits, NoHost, RenderOptions, RunOptions, Script, render, testing};

#[test]
fn the_gallery_is_what_it_was() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts");
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "rhai"))
        .collect();
    files.sort();
    assert!(files.len() >= 10);
    let mut options = RunOptions::default();
    (options.size, options.samples) = (Some((48, 36)), Some(1));
    let mut lines = Vec::new();
    for file in files {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let source = fs::read_to_string(&file).unwrap();
        assert!(
            source.starts_with("//"),
            "{name}: the first line says what it shows"
        );
        let rendered = testing::render_file(&file, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(rendered.warnings.is_empty(), "{name}: {:?}", rendered.warnings);
        lines.push(format!("{name} {}", rendered.image.hash()));
    }
    insta::assert_snapshot!("gallery", lines.join("\n"));
}

#[test]
fn the_readmes_script_runs() {
    let readme = include_str!("../README.md");
    let source = readme
        .split("```rhai\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .unwrap();
    let script = Script::compile("README.rhai", source, &Limits::default()).unwrap();
    let mut options = RunOptions::default();
    options.size = Some((64, 40));
    let run = script.run(&NoHost, &options).unwrap();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    let image = render(&run.value.scene, &RenderOptions::default(), &DirHost::new("."))
        .unwrap()
        .value
        .image;
    let lit = image.pixels().iter().filter(|p| p[0] > 0.1).count();
    assert!(lit > 64 * 40 / 2, "{lit}");
}
