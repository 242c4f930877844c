//! Where pictures go.

use super::*;

#[test]
fn a_picture_is_named_after_its_script_and_lies_in_the_current_folder() {
    let folder = Folder::new();
    folder.write("scenes/ball.v2.rhai", BALL);
    let ran = folder.ok(&["scenes/ball.v2.rhai"]);
    assert_eq!(folder.files(), ["ball.v2.png", "scenes/ball.v2.rhai"]);
    assert!(ran.stdout.is_empty());
    assert!(ran.stderr.starts_with("ball.v2.png  16x12  "), "{}", ran.stderr);
    let image = load_picture(&folder.path("ball.v2.png")).unwrap();
    assert_eq!((image.width(), image.height()), (16, 12));
    let [red, green, _] = image.pixel(8, 6).unwrap().to_array();
    assert!(red > 0.5 && green < 0.6 * red, "the ball is in the middle");
    assert!(image.pixel(0, 0).unwrap().x < 0.01, "the corner is black");
}

#[test]
fn the_output_flag_takes_any_known_format() {
    let folder = Folder::with(BALL);
    for (name, magic) in [
        ("a.png", &b"\x89PNG"[..]),
        ("b.jpg", b"\xff\xd8\xff"),
        ("c.ppm", b"P6\n16 12\n255\n"),
    ] {
        folder.ok(&["scene.rhai", "-o", name]);
        assert!(fs::read(folder.path(name)).unwrap().starts_with(magic), "{name}");
    }
    assert_eq!(folder.files(), ["a.png", "b.jpg", "c.ppm", "scene.rhai"]);
}

#[test]
fn a_dash_sends_the_picture_to_standard_output_and_prints_elsewhere() {
    let folder = Folder::with(&format!("{BALL}print(\"hello\");\n"));
    folder.ok(&["scene.rhai", "-o", "same.png"]);
    let ran = folder.ok(&["scene.rhai", "-o", "-"]);
    assert_eq!(ran.stdout, fs::read(folder.path("same.png")).unwrap());
    assert!(ran.stderr.starts_with("hello\n<stdout>  16x12"), "{}", ran.stderr);
    assert_eq!(folder.files(), ["same.png", "scene.rhai"]);
}

#[test]
fn what_a_script_prints_goes_to_standard_output() {
    let folder = Folder::with(&format!("{BALL}print(\"hello\");\n"));
    assert_eq!(folder.ok(&["scene.rhai"]).stdout, b"hello\n");
}

#[test]
fn standard_input_is_a_script_with_the_current_folder() {
    let folder = Folder::new();
    folder.write("floor.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mut child = folder
        .command(&["-"])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let script = format!("{BALL}mesh(\"floor.obj\");\n");
    child.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(folder.files(), ["floor.obj", "out.png"]);
}

#[test]
fn several_scenes_go_beside_each_other_or_into_a_folder() {
    let folder = Folder::with(BALL);
    folder.write("other.rhai", BALL);
    folder.ok(&["scene.rhai", "other.rhai"]);
    assert_eq!(
        folder.files(),
        ["other.png", "other.rhai", "scene.png", "scene.rhai"]
    );
    fs::create_dir(folder.path("out")).unwrap();
    folder.ok(&["render", "scene.rhai", "other.rhai", "-o", "out"]);
    assert_eq!(
        folder.files()[1..4],
        ["other.rhai", "out/other.png", "out/scene.png"]
    );
}

#[test]
fn one_bad_scene_does_not_stop_the_others_and_gives_the_exit_code() {
    let folder = Folder::with(BALL);
    folder.write("bad.rhai", "size(0, 0);");
    let ran = folder.fails(
        &["missing.rhai", "bad.rhai", "scene.rhai"],
        3,
        &["missing.rhai", "bad.rhai:1"],
    );
    assert!(ran.stderr.contains("scene.png  16x12"), "{}", ran.stderr);
    assert_eq!(folder.files(), ["bad.rhai", "scene.png", "scene.rhai"]);
}

#[test]
fn a_script_that_names_its_pictures_writes_no_other() {
    let folder = Folder::with(&format!(
        "{BALL}render(\"first.png\");\nsize(8, 8);\nrender(\"second.ppm\");\n"
    ));
    let ran = folder.ok(&["scene.rhai"]);
    assert_eq!(folder.files(), ["first.png", "scene.rhai", "second.ppm"]);
    assert!(
        ran.stderr.contains("first.png  16x12") && ran.stderr.contains("second.ppm  8x8"),
        "{}",
        ran.stderr
    );
    folder.ok(&["scene.rhai", "-o", "last.png"]);
    assert_eq!(size_of(&folder.path("last.png")), (8, 8));
}

#[test]
fn a_picture_rendered_without_a_name_is_not_lost() {
    let folder = Folder::with(&format!("{BALL}render();\nsize(8, 8);\nrender();\n"));
    folder.ok(&["scene.rhai"]);
    assert_eq!(folder.files(), ["scene.png", "scene.rhai"]);
    assert_eq!(size_of(&folder.path("scene.png")), (8, 8));
}
