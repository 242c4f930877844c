//! `rtscript diff`.

use super::*;

const BEFORE: &str = r##"size(48, 36);
camera([0, 1, 8], [0, 0, 0], [0, 1, 0], 45);
directional([1, 2, 3], [0.7, 0.7, 0.7]);
light([0, 4, 2], [0.5, 0.5, 0.5]);
define "post" {
  diffuse(0.5, 0.3, 0.2);
  cylinder(0.1, 2);
}
for x in -2..3 { group { translate(x, 0, -1); instance("post"); } }
diffuse(1, 0.2, 0.1);
shininess(20);
for i in 0..1204 { sphere((i % 43) * 0.1 - 2, (i / 43) * 0.1 - 1.5, 0, 0.04); }
diffuse(0.2, 0.5, 0.8);
group { translate(1.5, -1, 1); rotate(0, 1, 0, 20); box(1, 1, 1); }
torus(1, 0.1);
sphere(0, -1, 2, 0.3);
diffuse(checker("#fff", "#333", 1));
group { translate(0, -1.5, 0); plane(); }
"##;

/// The scene with some of its texts replaced.
fn edited(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(BEFORE.to_owned(), |script, (from, to)| {
        assert!(script.contains(from), "no {from:?}");
        script.replacen(from, to, 1)
    })
}

/// What `diff` prints for the scene and the edited one, and its exit code.
#[track_caller]
fn diff(edits: &[(&str, &str)]) -> (i32, String) {
    let folder = Folder::new();
    folder.write("a.rhai", BEFORE);
    folder.write("b.rhai", edited(edits));
    let ran = folder.run(&["diff", "a.rhai", "b.rhai"]);
    assert_eq!(ran.stderr, "");
    (ran.code, String::from_utf8(ran.stdout).unwrap())
}

#[track_caller]
fn differs(edits: &[(&str, &str)]) -> String {
    let (code, text) = diff(edits);
    assert_eq!(code, 1, "{text}");
    text
}

#[test]
fn each_kind_of_change_has_a_line() {
    insta::assert_snapshot!(differs(&[
        ("45);\n", "50);\n// a line of its own\n\n"),
        ("light([0, 4, 2], [0.5", "light([0, 5, 2], [0.8"),
        ("cylinder(0.1, 2)", "cylinder(0.2, 2)"),
        ("-2..3", "-2..4"),
        ("- 1.5, 0, 0.04", "- 0.5, 0, 0.04"),
        (
            "translate(1.5, -1, 1); rotate(0, 1, 0, 20);",
            "translate(1.5, -1, 1); rotate(0, 1, 0, 50); scale(1, 2, 1);"
        ),
        ("torus(1, 0.1);\n", "torus(1, 0.2);\ncone(0.5, 1);\n"),
        ("sphere(0, -1, 2, 0.3);\n", ""),
        ("\"#333\", 1", "\"#300\", 1"),
    ]));
}

#[test]
fn what_many_have_in_common_is_told_once() {
    assert_eq!(
        differs(&[("- 1.5, 0, 0.04", "- 0.5, 0, 0.04")]),
        "~ 1,204 spheres moved by (0, 1, 0)  a.rhai:12 -> b.rhai:12\n1,204 changed\n"
    );
    // Rows farther apart: each row moved by another way, and the ball of a later line has the material, too.
    assert_eq!(
        differs(&[
            ("shininess(20)", "shininess(30)"),
            ("(i / 43) * 0.1 - 1.5", "(i / 43) * 0.11 - 1.297")
        ]),
        "~ 1,204 spheres moved by 0.203 to 0.473, shininess changed  a.rhai:12 -> b.rhai:12\n\
         ~ box shininess 20 -> 30  a.rhai:14 -> b.rhai:14\n\
         ~ torus shininess 20 -> 30  a.rhai:15 -> b.rhai:15\n\
         ~ sphere shininess 20 -> 30  a.rhai:16 -> b.rhai:16\n\
         ~ plane shininess 20 -> 30  a.rhai:18 -> b.rhai:18\n\
         1,208 changed\n"
    );
}

#[test]
fn equal_scenes_are_equal_however_they_are_written() {
    let same = "the scenes are equal\n";
    assert_eq!(diff(&[]), (0, same.to_owned()));
    assert_eq!(
        diff(&[("size(48, 36);", "// said otherwise\nsize(48, 6 * 6);")]),
        (0, same.to_owned())
    );
    let swapped = diff(&[
        ("directional([1, 2, 3], [0.7, 0.7, 0.7]);\n", ""),
        ("for x in", "directional([1, 2, 3], [0.7, 0.7, 0.7]);\nfor x in"),
    ]);
    let text = "the scenes hold the same things, made in another order or numbered anew\n";
    assert_eq!(swapped, (0, text.to_owned()));
}

#[test]
fn a_scene_and_its_flat_text_are_equal() {
    let folder = Folder::with(BEFORE);
    folder.ok(&["expand", "scene.rhai", "-o", "flat.rhai"]);
    folder.ok(&["diff", "scene.rhai", "flat.rhai", "-o", "diff.png"]);
}

#[test]
fn settings_come_from_the_command_line_too() {
    let text = differs(&[(
        "size(48, 36)",
        "size(24, 18); samples(4); maxDepth(2); seed(3); background(0, 0, 0.5); encoding(\"raw\")",
    )]);
    insta::assert_snapshot!(text);
    let folder = Folder::with("sphere(0, 0, 0, param(\"r\", 1.0)); light([0, 0, 5], [1, 1, 1]);");
    let ran = folder.ok(&["diff", "scene.rhai", "scene.rhai", "-D", "r=2", "--size", "8x6"]);
    assert_eq!(ran.stdout, b"the scenes are equal\n");
}

#[test]
fn pictures_stand_side_by_side_and_are_measured() {
    let folder = Folder::new();
    folder.write("a.rhai", BEFORE);
    folder.write(
        "b.rhai",
        edited(&[("sphere(0, -1, 2, 0.3);", "sphere(0.5, -1, 2, 0.3);")]),
    );
    let ran = folder.run(&["diff", "a.rhai", "b.rhai", "-o", "diff.png"]);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(
        text.contains("~ sphere moved by (0.5, 0, 0)  a.rhai:16 -> b.rhai:16\n1 changed\n"),
        "{text}"
    );
    assert!(
        text.contains(" of 1728 pixels differ ") && text.contains("FLIP 0."),
        "{text}"
    );
    assert_eq!(size_of(&folder.path("diff.png")), (3 * 48 + 8, 36));
    folder.write("b.rhai", edited(&[("size(48, 36)", "size(40, 40)")]));
    let ran = folder.run(&["diff", "a.rhai", "b.rhai", "-o", "diff.png"]);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(
        text.starts_with("~ size 48 x 36 -> 40 x 40\n1 setting\n"),
        "{text}"
    );
    assert!(!text.contains("FLIP"), "sizes differ: {text}");
    assert_eq!(size_of(&folder.path("diff.png")), (3 * 48 + 8, 40));
}

#[test]
fn a_picture_stands_for_the_script_that_it_carries() {
    let folder = Folder::with(BALL);
    folder.ok(&["scene.rhai"]);
    folder.write(
        "scene.rhai",
        BALL.replace("sphere(0, 0, 0, 1)", "sphere(0, 0, 0, 2)"),
    );
    let ran = folder.run(&["diff", "scene.png", "scene.rhai"]);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert_eq!(
        (ran.code, &*text),
        (
            1,
            "~ sphere radius 1 -> 2  scene.rhai:4 -> scene.rhai:4\n1 changed\n"
        )
    );
}

#[test]
fn modules_and_meshes_are_followed() {
    let folder = Folder::new();
    for (name, height) in [("old", 1), ("new", 2)] {
        folder.write(
            &format!("{name}/scene.rhai"),
            "import \"lib/wall\" as w;\nw::wall();\nlight([0, 0, 5], [1, 1, 1]);\nmesh(\"m.obj\");\n",
        );
        folder.write(
            &format!("{name}/lib/wall.rhai"),
            format!("fn wall() {{\n  box(1, {height}, 1);\n}}\n"),
        );
        folder.write(
            &format!("{name}/m.obj"),
            format!("v 0 0 0\nv 1 0 0\nv 0 {height} 0\nf 1 2 3\n"),
        );
    }
    let ran = folder.run(&["diff", "old/scene.rhai", "new/scene.rhai"]);
    insta::assert_snapshot!(String::from_utf8(ran.stdout).unwrap());
}

#[test]
fn programs_read_json() {
    let folder = Folder::new();
    folder.write("a.rhai", BEFORE);
    folder.write(
        "b.rhai",
        edited(&[
            ("45);", "50);"),
            ("box(1, 1, 1)", "scale(2); box(1, 1, 1)"),
            ("- 1.5, 0, 0.04", "- 0.5, 0, 0.04"),
        ]),
    );
    for flag in [&["--json"][..], &["--message-format", "json"]] {
        let ran = folder.run(&[&["diff", "a.rhai", "b.rhai"], flag].concat());
        assert_eq!(ran.code, 1);
        let json: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
        assert_eq!(json["equal"], false);
        assert_eq!(json["settings"][0]["name"], "camera fovy");
        let changes = json["changes"].as_array().unwrap();
        assert_eq!(changes.len(), 2, "{json:#}");
        assert_eq!(changes[0]["count"], 1204);
        assert_eq!(changes[0]["before"]["line"], 12);
        assert_eq!(changes[0]["ways"][0]["ways"][0]["kind"], "moved");
        assert_eq!(
            changes[1]["ways"][0]["ways"][0]["by"],
            serde_json::json!([2.0, 2.0, 2.0])
        );
    }
}

#[test]
fn names_do_not_steer_the_terminal() {
    let folder = Folder::with(
        "define \"a\\u001b[31m\" { sphere(0, 0, 0, 1); } instance(\"a\\u001b[31m\"); light([0, 0, 5], [1, 1, 1]);",
    );
    folder.write("b.rhai", BALL);
    let ran = folder.run(&["diff", "scene.rhai", "b.rhai"]);
    assert!(ran.code == 1 && !ran.stdout.contains(&0x1b), "{:?}", ran.stdout);
    let flat = folder.ok(&["expand", "scene.rhai"]).stdout;
    assert!(!flat.contains(&0x1b));
    folder.write("flat.rhai", flat);
    folder.ok(&["diff", "scene.rhai", "flat.rhai"]);
}

#[test]
fn trouble_is_not_a_difference() {
    let folder = Folder::with(BALL);
    folder.write("bad.rhai", "sphere(0, 0, 0);");
    folder.fails(&["diff", "scene.rhai", "bad.rhai"], 2, &["bad.rhai:1:1"]);
    folder.fails(&["diff", "scene.rhai", "none.rhai"], 3, &["no such file"]);
    folder.fails(&["diff", "-", "-"], 3, &["standard input can be read only once"]);
    folder.fails(&["diff", "scene.rhai"], 2, &["AFTER"]);
    folder.fails(
        &["diff", "scene.rhai", "scene.rhai", "-o", "diff.txt"],
        4,
        &["diff.txt"],
    );
    folder.fails(
        &["diff", "scene.rhai", "scene.rhai", "-o", "no/diff.png"],
        4,
        &["no"],
    );
}
