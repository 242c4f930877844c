//! The examples, run as they are: each says the hash of its picture.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// An example, built as these tests are: `cargo test --test examples` alone builds none.
fn program(name: &str) -> PathBuf {
    let test = env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap();
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--locked", "--example", name, "--target-dir"]);
    cargo.arg(built.parent().unwrap());
    if built.ends_with("release") {
        cargo.arg("--release");
    }
    assert!(
        cargo
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .status()
            .unwrap()
            .success()
    );
    built
        .join("examples")
        .join(format!("{name}{}", env::consts::EXE_SUFFIX))
}

/// Runs an example and returns the last line that it prints.
fn run(name: &str, args: &[&str]) -> String {
    let mut command = Command::new(program(name));
    command.args(args).current_dir(env!("CARGO_MANIFEST_DIR"));
    let out = command.stdin(Stdio::null()).output().unwrap();
    let (told, complaint) = (
        String::from_utf8_lossy(&out.stdout),
        String::from_utf8_lossy(&out.stderr),
    );
    assert!(out.status.success(), "{name}: {complaint}");
    told.lines().last().unwrap_or_default().to_owned()
}

/// A file for an example's picture.
fn picture(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("examples");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let _ = fs::remove_file(&path);
    path
}

#[test]
fn assets_draws_its_bars() {
    let path = picture("assets.png");
    assert_eq!(
        run("assets", &[path.to_str().unwrap()]),
        "b124fe54a0086752f7f8a9fd217355a8"
    );
    assert!(path.exists());
}

#[test]
fn custom_draws_its_gyroid() {
    let path = picture("custom.png");
    assert_eq!(
        run("custom", &[path.to_str().unwrap()]),
        "25e6822465b7336f7336ae1ece2b4867"
    );
    assert!(path.exists());
}

#[test]
fn progress_comes_to_its_end() {
    let scene = "tests/scenes/shapes/sphere/center-and-radius.rhai";
    assert_eq!(run("progress", &[scene]), "c40fe7f2697ccb0d0209c1de83e04198");
}

#[test]
fn minimal_writes_a_picture() {
    let path = picture("minimal.png");
    run(
        "minimal",
        &[
            "tests/scenes/shapes/sphere/center-and-radius.rhai",
            path.to_str().unwrap(),
        ],
    );
    assert!(path.exists());
}
