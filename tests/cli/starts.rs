//! `rtscript new` and `rtscript check`.

use super::*;

#[test]
fn new_writes_a_scene_that_renders_without_a_warning() {
    let folder = Folder::new();
    let ran = folder.ok(&["new", "first"]);
    assert!(
        ran.stderr.contains("rtscript first.rhai renders it"),
        "{}",
        ran.stderr
    );
    let script = fs::read_to_string(folder.path("first.rhai")).unwrap();
    assert!(
        script.contains("rtscript first.rhai ") && !script.contains("NAME"),
        "{script}"
    );
    let ran = folder.ok(&["first.rhai", "--size", "32x20", "--samples", "1"]);
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
    folder.ok(&[
        "first.rhai",
        "-o",
        "b.png",
        "--size",
        "8x5",
        "--samples",
        "1",
        "-D",
        "count=12",
        "-D",
        "shine=1",
    ]);
    folder.fails(&["new", "first"], 4, &["cannot write 'first.rhai'", "exists"]);
    folder.fails(&["new", "no/such/folder"], 4, &["no such file"]);
    assert_eq!(fs::read_to_string(folder.path("first.rhai")).unwrap(), script);
}

#[test]
fn check_says_what_scenes_hold_and_writes_nothing() {
    let folder = Folder::with(&format!("{BALL}render(\"big.png\");\n"));
    folder.write("bad.rhai", "sphere(0, 0, 0, -1);");
    folder.write("worse.rhai", "sphere(");
    folder.write("nothing.rhai", "// nothing\nlet a = 1;");
    let ran = folder.ok(&["check", "scene.rhai", "nothing.rhai"]);
    assert!(
        ran.stderr
            .contains("scene.rhai: ok, 1 object, 1 light, 1 material"),
        "{}",
        ran.stderr
    );
    assert!(ran.stderr.contains("nothing.rhai: ok, nothing"), "{}", ran.stderr);
    assert!(ran.stderr.contains("warning"), "{}", ran.stderr);
    let texts = [
        "bad.rhai:1:1",
        "worse.rhai:1",
        "scene.rhai: ok",
        "2 of 3 scenes cannot be rendered",
    ];
    folder.fails(&["check", "bad.rhai", "worse.rhai", "scene.rhai"], 1, &texts);
    folder.fails(&["check", "missing.rhai"], 3, &["no such file"]);
    assert_eq!(
        folder.files(),
        ["bad.rhai", "nothing.rhai", "scene.rhai", "worse.rhai"]
    );
    let ran = folder.ok(&["check", "-q", "scene.rhai"]);
    assert!(ran.stderr.is_empty(), "{}", ran.stderr);
}
