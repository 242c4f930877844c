//! Scenes that cannot be read and pictures that cannot be written.

use super::*;

#[test]
fn unreadable_scenes_end_with_3() {
    let folder = Folder::new();
    fs::create_dir(folder.path("folder.rhai")).unwrap();
    folder.write("latin.rhai", b"size(4, 4);\n// caf\xe9\n");
    folder.write("empty.rhai", " \n");
    folder.write("empty.test", "");
    folder.fails(
        &["missing.rhai"],
        3,
        &["cannot read 'missing.rhai': no such file"],
    );
    folder.fails(
        &["folder.rhai"],
        3,
        &["cannot read 'folder.rhai': it is a folder"],
    );
    folder.fails(
        &["latin.rhai"],
        3,
        &["not UTF-8", "latin.rhai:2:7", "save it as UTF-8"],
    );
    folder.fails(&["empty.rhai"], 3, &["the file is empty", "empty.rhai:1:1"]);
    folder.fails(&["empty.test"], 3, &["the file is empty", "empty.test:1:1"]);
    folder.fails(&["-"], 3, &["the file is empty", "<stdin>:1:1"]);
    folder.fails(&["json"], 3, &["no such file", "--stats=json"]);
    assert_eq!(folder.files(), ["empty.rhai", "empty.test", "latin.rhai"]);
}

#[test]
fn a_scene_without_end_is_a_limit() {
    if Path::new("/dev/zero").exists() {
        Folder::new().fails(&["/dev/zero", "-o", "a.png"], 5, &["'source_bytes'"]);
    }
}

#[test]
fn byte_order_marks_and_foreign_line_ends_are_taken() {
    let folder = Folder::with(BALL);
    let plain = folder.hash(&[]);
    folder.write("scene.rhai", format!("\u{feff}{}", BALL.replace('\n', "\r\n")));
    assert_eq!(folder.hash(&[]), plain);
}

#[test]
fn impossible_outputs_end_with_4_before_anything_runs() {
    let folder = Folder::with("print(\"ran\");\n");
    fs::create_dir(folder.path("folder.png")).unwrap();
    folder.write("file", "");
    for (output, text) in [
        ("no/such/a.png", "there is no folder 'no/such'"),
        ("file/a.png", "'file' is not a folder"),
        ("folder.png", "it is a folder"),
        (
            "a.gif",
            "the ending '.gif' is not a picture format; known are .png, .jpg, .jpeg, .ppm, .exr, .hdr, .pfm",
        ),
        ("picture", "no ending"),
        ("..", "no ending"),
    ] {
        let ran = folder.fails(&["scene.rhai", "-o", output], 4, &["cannot write '", text]);
        assert!(ran.stdout.is_empty(), "the script ran for {output}");
    }
    if Path::new("/proc/self").exists() {
        folder.fails(
            &["scene.rhai", "-o", "/proc/a.png"],
            4,
            &["cannot write '/proc/a.png'"],
        );
    }
    assert_eq!(folder.files(), ["file", "scene.rhai"]);
}

#[test]
fn a_picture_never_overwrites_what_it_is_made_from() {
    let folder = Folder::with(BALL);
    folder.ok(&["scene.rhai", "-o", "wood.png"]);
    folder.write(
        "scene.rhai",
        format!("{BALL}diffuse(image(\"wood.png\"));\nsphere(1, 0, 0, 1);\n"),
    );
    let before = fs::read(folder.path("wood.png")).unwrap();
    folder.fails(
        &["scene.rhai", "-o", "wood.png", "--size", "5x5"],
        4,
        &["cannot write 'wood.png'", "made from"],
    );
    assert_eq!(fs::read(folder.path("wood.png")).unwrap(), before);
    folder.write("script.png", BALL);
    folder.fails(&["script.png"], 4, &["made from"]);
    assert_eq!(fs::read(folder.path("script.png")).unwrap(), BALL.as_bytes());
}

#[test]
fn a_script_that_fails_leaves_the_old_picture() {
    let folder = Folder::with(BALL);
    folder.ok(&["scene.rhai"]);
    let before = fs::read(folder.path("scene.png")).unwrap();
    folder.write("scene.rhai", format!("{BALL}popTransform();\n"));
    folder.fails(&["scene.rhai"], 1, &["scene.rhai:5:1"]);
    assert_eq!(fs::read(folder.path("scene.png")).unwrap(), before);
    assert_eq!(folder.files(), ["scene.png", "scene.rhai"]);
}
