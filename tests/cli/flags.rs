//! Flags that change the picture, and flags that do not.

use super::*;

#[test]
fn size_takes_the_place_of_the_scenes() {
    let folder = Folder::with(BALL);
    folder.ok(&["scene.rhai", "--size", "7x5"]);
    assert_eq!(size_of(&folder.path("scene.png")), (7, 5));
}

#[test]
fn samples_and_seed_take_the_place_of_the_scenes() {
    let folder = Folder::with(BALL);
    let hash = |args: &[&str]| folder.hash(args);
    let plain = hash(&[]);
    let many = hash(&["--samples", "9"]);
    assert_ne!(plain, many);
    assert_eq!(hash(&["--samples", "9", "--seed", "0"]), many);
    assert_ne!(hash(&["--samples", "9", "--seed", "1"]), many);
    assert_eq!(hash(&["--samples", "1"]), plain);
}

#[test]
fn threads_change_nothing() {
    let folder = Folder::with(BALL);
    let args = ["1", "2", "7"].map(|n| folder.hash(&["--samples", "4", "--threads", n]));
    assert_eq!(args[0], args[1]);
    assert_eq!(args[0], args[2]);
}

#[test]
fn quiet_leaves_errors_only() {
    let folder = Folder::with("size(4, 4);\n");
    assert!(
        folder
            .ok(&["scene.rhai"])
            .stderr
            .contains("warning[empty-scene]: the scene is empty")
    );
    assert_eq!(folder.ok(&["-q", "scene.rhai"]).stderr, "");
    folder.fails(&["--quiet", "missing.rhai"], 3, &["no such file"]);
}

#[test]
fn stats_tell_rays_seconds_and_memory() {
    let folder = Folder::with(BALL);
    let text = folder.ok(&["scene.rhai", "--stats"]).stderr;
    for name in [
        "rays",
        "camera",
        "shadow",
        "reflected",
        "refracted",
        "rays per second",
        "read",
        "script",
    ] {
        assert!(text.contains(&format!(" {name} ")), "{name} in {text}");
    }
    for name in ["compile", "trace", "write", "threads", "primitives"] {
        assert!(text.contains(&format!(" {name} ")), "{name} in {text}");
    }
    assert_eq!(text, text.trim_start(), "the line of the picture comes first");

    let ran = folder.ok(&["scene.rhai", "--stats=json", "--samples", "4", "--threads", "2"]);
    let json = ran.stderr.trim_end();
    assert!(
        json.starts_with(r#"{"scene":"scene.rhai","output":"scene.png","hash":""#),
        "{json}"
    );
    assert_eq!(json.lines().count(), 1);
    assert!(
        json.contains(r#""width":16,"height":12,"pictures":1,"threads":2,"rays":{"camera":768,"#),
        "{json}"
    );
    assert!(json.contains(r#""camera_per_pixel":4.0000,"#), "{json}");
    assert_eq!(json.matches('{').count(), json.matches('}').count());
    for key in [
        "seconds",
        "read",
        "script",
        "compile",
        "trace",
        "write",
        "total",
        "rays_per_second",
    ] {
        assert!(json.contains(&format!("\"{key}\":")), "{key} in {json}");
    }
    if cfg!(target_os = "linux") {
        assert!(!json.contains(r#""peak_memory_bytes":null"#), "{json}");
    }
}
