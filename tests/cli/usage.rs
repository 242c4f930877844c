//! Help, version, and what cannot be asked for.

use super::*;

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = Folder::new();
    let help = String::from_utf8(folder.ok(&["--help"]).stdout).unwrap();
    for text in [
        "--size",
        "--samples",
        "--threads",
        "--seed",
        "--quiet",
        "--stats",
        "--output",
        "Exit codes",
        "convert",
    ] {
        assert!(help.contains(text), "{text}");
    }
    let version = folder.ok(&["--version"]).stdout;
    assert_eq!(
        String::from_utf8(version).unwrap(),
        format!("rtscript {}\n", env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn wrong_usage_ends_with_2() {
    let folder = Folder::with(BALL);
    folder.write("sub/scene.rhai", BALL);
    for (args, text) in [
        (&[][..], "<FILE>..."),
        (&["scene.rhai", "--frobnicate"], "--frobnicate"),
        (&["scene.rhai", "--size", "640"], "such as 640x480"),
        (&["scene.rhai", "--size", "0x4"], "such as 640x480"),
        (&["scene.rhai", "--samples", "0"], "--samples"),
        (&["scene.rhai", "--samples", "many"], "--samples"),
        (&["scene.rhai", "--threads", "0"], "--threads"),
        (&["scene.rhai", "--threads", "100000"], "--threads"),
        (&["scene.rhai", "--seed", "-1"], "--seed"),
        (&["scene.rhai", "--stats=xml"], "text, json"),
        (&["scene.rhai", "--quiet", "convert", "--nothing"], "--nothing"),
        (&["convert"], "<FILE>"),
        (&["convert", "a.test", "b.test"], "b.test"),
        (&["-", "-"], "only once"),
        (
            &["scene.rhai", "sub/scene.rhai"],
            "both be written to 'scene.png'",
        ),
        (
            &["scene.rhai", "sub/scene.rhai", "-o", "a.png"],
            "must name a folder",
        ),
        (&["scene.rhai", "sub/scene.rhai", "-o", "-"], "must name a folder"),
    ] {
        let ran = folder.fails(args, 2, &["error: ", text, "try '--help'"]);
        assert!(ran.stdout.is_empty());
    }
    assert_eq!(folder.files(), ["scene.rhai", "sub/scene.rhai"]);
}

#[test]
fn a_scene_called_like_a_command_is_reached_by_its_path() {
    let folder = Folder::new();
    folder.write("convert", BALL);
    folder.ok(&["./convert"]);
    assert_eq!(folder.files(), ["convert", "convert.png"]);
}
