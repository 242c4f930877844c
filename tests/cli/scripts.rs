//! What is wrong in a scene: exit code, place, message.

use super::*;

#[test]
fn access_outside_is_denied_with_6() {
    let folder = Folder::new();
    folder.write("secret.obj", "v 0 0 0\n");
    for (call, text) in [
        ("mesh(\"../secret.obj\")", "script's folder"),
        ("mesh(\"/etc/passwd\")", "absolute path"),
        ("render(\"../a.png\")", "below the current folder"),
        ("render(\"/tmp/rtscript-a.png\")", "absolute path"),
    ] {
        folder.write("sub/scene.rhai", format!("{BALL}{call};\n"));
        folder.fails(&["sub/scene.rhai"], 6, &["sub/scene.rhai:5:1", text]);
    }
    assert_eq!(folder.files(), ["secret.obj", "sub/scene.rhai"]);
    assert!(!Path::new("/tmp/rtscript-a.png").exists());
}

#[test]
fn a_picture_that_a_script_names_must_be_writable() {
    for (name, text) in [("a.gif", "known are .png"), ("no/a.png", "there is no folder")] {
        let folder = Folder::with(&format!("{BALL}render(\"{name}\");\n"));
        folder.fails(&["scene.rhai"], 4, &["scene.rhai:5:1", text]);
        assert_eq!(folder.files(), ["scene.rhai"]);
    }
}

#[test]
fn limits_end_with_5() {
    let folder = Folder::with("size(40000, 10);\n");
    folder.fails(&["scene.rhai"], 5, &["scene.rhai:1:1", "'image_side'"]);
    folder.write("scene.rhai", BALL);
    folder.fails(&["scene.rhai", "--size", "40000x10"], 5, &["'image_side'"]);
    folder.fails(&["scene.rhai", "--samples", "100000"], 5, &["'samples'"]);
    assert_eq!(folder.files(), ["scene.rhai"]);
}

#[test]
fn an_error_shows_file_line_caret_and_hint() {
    let folder = Folder::with("size(4, 4);\n  pushTranform();\n");
    let ran = folder.fails(&["scene.rhai"], 1, &[]);
    let excerpt = " --> scene.rhai:2:3\n  |\n2 |   pushTranform();\n  |   ^^^^^^^^^^^^\n";
    assert!(ran.stderr.contains(excerpt), "{}", ran.stderr);
    assert!(
        ran.stderr.contains("= help: did you mean pushTransform?"),
        "{}",
        ran.stderr
    );
    assert!(
        !ran.stderr.contains('\u{1b}'),
        "no colors where it is no terminal: {}",
        ran.stderr
    );
}

#[test]
fn every_bad_scene_has_its_line_and_code() {
    let folder = Folder::new();
    let png_without_pixels = b"\x89PNG\r\n\x1a\n";
    folder.write("broken.png", png_without_pixels);
    folder.write("text.png", "not a picture");
    folder.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    folder.write(
        "kd.obj",
        "mtllib kd.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n",
    );
    folder.write("kd.mtl", "newmtl a\nKd 1 2\n");
    for (line, code) in [
        ("popTransform();", 1),
        ("sphere(0, 0, 0, 0.0 / 0.0);", 1),
        ("sphere(0, 1.0 / 0.0, 0, 1);", 1),
        ("translate(0, 0, -1.0 / 0.0);", 1),
        ("sphere(0, 0, 0, -1);", 1),
        ("sphere(0, 0, 0, 0);", 1),
        ("scale(1, 0, 1); sphere(0, 0, 0, 1);", 1),
        ("camera([0, 0, 1], [0, 0, 1], [0, 1, 0], 45);", 1),
        ("camera([0, 0, 1], [0, 0, 0], [0, 0, 2], 45);", 1),
        ("camera([0, 0, 1], [0, 0, 0], [0, 1, 0], 0);", 1),
        ("camera([0, 0, 1], [0, 0, 0], [0, 1, 0], 180);", 1),
        ("size(0, 10);", 1),
        ("size(-1, 10);", 1),
        ("size(10.5, 10);", 1),
        ("size(100000, 10);", 5),
        ("samples(0);", 1),
        ("maxDepth(1000);", 5),
        ("shpere(0, 0, 0, 1);", 1),
        ("material(#{ difuse: [1, 0, 0] });", 1),
        ("mesh(#{ positons: [] });", 1),
        ("sphere(\"one\", 2);", 1),
        ("sphere();", 1),
        ("tri([0, 0, 0], [1, 0, 0]);", 1),
        ("diffuse(\"#12345\");", 1),
        ("rotate([0, 0, 0], 45);", 1),
        ("multMatrix([1, 2, 3]);", 1),
        ("instance(\"nothing\");", 1),
        ("encoding(\"gamma\");", 1),
        ("attenuation(0, 0, 0);", 1),
        ("areaLight([0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1], 0);", 1),
        ("directional([0, 0, 0], [1, 1, 1]);", 1),
        ("let x = ;", 1),
        ("sphere(0, 0, 0, radius);", 1),
        ("throw \"stop\";", 1),
        ("mesh(\"missing.obj\");", 3),
        ("mesh(\"nan.obj\");", 3),
        ("mesh(\"range.obj\");", 3),
        ("mesh(\"kd.obj\");", 3),
        ("mesh(\"../scene.obj\");", 6),
        ("image(\"missing.png\");", 3),
        ("image(\"broken.png\");", 3),
        ("image(\"text.png\");", 3),
        ("loop { pushTransform(); }", 5),
        ("fn f(n) { f(n + 1) } f(0);", 5),
        ("let a = \"x\"; loop { a += a; }", 5),
    ] {
        folder.write("scene.rhai", format!("{BALL}{line}\n"));
        let ran = folder.run(&["scene.rhai"]);
        assert_eq!(ran.code, code, "{line}: {}", ran.stderr);
        // The script's own line, or that of the file it names.
        assert!(
            ran.stderr.contains("scene.rhai:5")
                || ran.stderr.contains(".obj:")
                || ran.stderr.contains(".mtl:"),
            "{line}: {}",
            ran.stderr
        );
        assert!(ran.stderr.starts_with("error["), "{line}: {}", ran.stderr);
        assert!(
            !folder.files().contains(&"scene.png".to_owned()),
            "{line} left a picture"
        );
    }
}

#[test]
fn every_bad_course_scene_has_its_line_and_code() {
    let folder = Folder::new();
    for (line, code) in [
        ("spere 0 0 0 1", 3),
        ("sphere 0 0 0", 3),
        ("sphere 0 0 0 one", 3),
        ("sphere 0 0 nan 1", 3),
        ("sphere 0 0 0 -1", 1),
        ("tri 0 1 2", 3),
        ("popTransform", 1),
        ("camera 0 0 5 0 0 5 0 1 0 45", 1),
        ("camera 0 0 5 0 0 0 0 1 0 200", 1),
    ] {
        folder.write("scene.test", format!("size 16 12\n{line}\n"));
        let ran = folder.run(&["scene.test"]);
        assert_eq!(ran.code, code, "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains("scene.test:2"), "{line}: {}", ran.stderr);
        assert_eq!(folder.files(), ["scene.test"], "{line}");
    }
}

#[test]
fn an_empty_scene_shows_its_background_with_a_warning() {
    let folder = Folder::with("// nothing\nsize(4, 4);\nbackground([1, 0, 0]);\n");
    let ran = folder.ok(&["scene.rhai"]);
    assert!(
        ran.stderr.contains("warning[empty-scene]: the scene is empty"),
        "{}",
        ran.stderr
    );
    assert_eq!(
        load_picture(&folder.path("scene.png")).unwrap().rgb8(),
        [255, 0, 0].repeat(16)
    );
}
