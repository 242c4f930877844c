//! `rtscript expand`. That every scene of the package comes back from its text is tested in `tests/expand.rs`.

use super::*;

/// A bit of everything: a module, textures that are shared, a group with a light, one matrix for several things.
const SCENE: &str = r##"import "lib/tree" as tree;
size(24, 18);
samples(4);
camera([0, 1, 6], [0, 0, 0], [0, 1, 0], 50);
let check = checker("#fff", "#333", 0.5);
define "lamp" {
  emission(1, 0.9, 0.5);
  sphere(0, 0, 0, 0.2);
  light([0, 0.5, 0], [0.4, 0.4, 0.4]);
}
directional([1, 2, 3], [0.7, 0.7, 0.7]);
attenuation(1, 0, 0.1);
light([0, 4, 2], [1, 1, 1]);
diffuse(check);
group { translate(0, -1, 0); plane(); }
translate(-1.5, 0, 0);
diffuse(check * vec3(1, 0.5, 0.2));
for i in 0..2 { sphere(i, 0, 0, 0.4); }
group { rotate(0, 1, 0, 30); box(0.5, 1, 0.5); }
sphere(0, 1, 0, 0.2);
loadIdentity();
tree::tree(2);
instance("lamp");
mesh(#{ positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], uvs: [[0, 0], [1, 0], [0, 1]] });
areaLight([-1, 3, -1], [2, 0, 0], [0, 0, 2], [0.2, 0.2, 0.2], 2);
"##;

const TREE: &str = "fn tree(n) {
  if n == 0 { return; }
  material(#{ diffuse: [0.3, 0.2, 0.1], transmission: [0.1, 0.1, 0.1] });
  cylinder(0.1, 1);
  for side in [-1, 1] {
    group { rotate(0, 0, 1, 40 * side); translate(0, 0.8, 0); scale(0.6); tree(n - 1); }
  }
}
";

fn folder() -> Folder {
    let folder = Folder::with(SCENE);
    folder.write("lib/tree.rhai", TREE);
    folder
}

fn text(ran: &Ran) -> String {
    String::from_utf8(ran.stdout.clone()).unwrap()
}

/// Both hashes of a scene.
fn hashes(folder: &Folder, args: &[&str]) -> String {
    text(&folder.ok(&[&["hash"], args].concat()))
}

#[test]
fn everything_has_a_line_and_its_place() {
    let ran = folder().ok(&["expand", "scene.rhai"]);
    assert_eq!(ran.stderr, "");
    insta::assert_snapshot!(text(&ran));
}

#[test]
fn the_text_renders_to_the_same_pixels() {
    let folder = folder();
    let ran = folder.ok(&["expand", "scene.rhai", "-o", "flat.rhai"]);
    assert_eq!((text(&ran), ran.stderr), (String::new(), String::new()));
    assert_eq!(hashes(&folder, &["flat.rhai"]), hashes(&folder, &["scene.rhai"]));
    let once = folder.ok(&["expand", "scene.rhai", "--no-places"]);
    let twice = folder.ok(&["expand", "flat.rhai", "--no-places"]);
    assert_eq!(text(&once), text(&twice));
    assert!(!text(&once).contains("//"), "{}", text(&once));
}

#[test]
fn what_the_command_line_decides_is_in_the_text() {
    let folder =
        Folder::with("let r = param(\"r\", 1.0); sphere(random(), 0, 0, r); light([0, 0, 5], [1, 1, 1]);");
    let args = ["-D", "r=0.25", "--size", "8x6", "--samples", "4", "--seed", "7"];
    let flat = text(&folder.ok(&[&["expand", "scene.rhai", "--no-places"][..], &args].concat()));
    for line in ["size(8, 6);\n", "samples(4);\n", ", 0.25);\n"] {
        assert!(flat.contains(line), "{line} in {flat}");
    }
    folder.write("flat.rhai", &flat);
    assert_eq!(
        hashes(&folder, &["flat.rhai"]),
        hashes(&folder, &[&["scene.rhai"][..], &args].concat())
    );
}

#[test]
fn every_seed_has_a_literal() {
    let folder = Folder::with("samples(4); sphere(0, 0, 0, 1); light([0, 0, 5], [1, 1, 1]);");
    for seed in [
        "9223372036854775807",
        "9223372036854775808",
        "18446744073709551615",
    ] {
        let args = ["scene.rhai", "--size", "8x6", "--seed", seed];
        folder.write("flat.rhai", folder.ok(&[&["expand"][..], &args].concat()).stdout);
        assert_eq!(hashes(&folder, &["flat.rhai"]), hashes(&folder, &args), "{seed}");
    }
}

#[test]
fn files_stay_files() {
    let folder = Folder::with(
        "mesh(\"a/tri.obj\"); mesh(\"a/tri.obj\", #{ materials: false }); light([0, 0, 5], [1, 1, 1]);",
    );
    folder.write(
        "a/tri.obj",
        "mtllib tri.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    folder.write("a/tri.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("elsewhere/here", "");
    let flat = text(&folder.ok(&["expand", "scene.rhai", "--no-places"]));
    assert!(
        flat.ends_with("mesh(\"a/tri.obj\");\nmesh(\"a/tri.obj\", #{ materials: false });\n"),
        "{flat}"
    );
    let ran = folder.ok(&["expand", "scene.rhai", "-o", "elsewhere/flat.rhai"]);
    assert!(ran.stderr.contains("does not lie there"), "{}", ran.stderr);
    folder.ok(&["expand", "scene.rhai", "-o", "flat.rhai"]);
    assert_eq!(hashes(&folder, &["flat.rhai"]), hashes(&folder, &["scene.rhai"]));
}

#[test]
fn pictures_that_the_script_renders_become_numbers() {
    let script = "size(4, 3); light([0, 0, 5], [1, 1, 1]); diffuse(1, 0.3, 0.1); sphere(0, 0, 0, 1); \
                  let seen = render(); render(); diffuse(seen); box(1, 1, 1);";
    let folder = Folder::with(script);
    let ran = folder.ok(&["expand", "scene.rhai"]);
    assert!(
        ran.stderr
            .contains("the scene renders 2 pictures; this is how it stands at its end")
    );
    assert!(text(&ran).contains("const texture_0 = image(#{ width: 4, height: 3, pixels: [\n"));
    folder.write("flat.rhai", text(&ran));
    let scene = |name| hashes(&folder, &["--scene", name]);
    assert_eq!(scene("flat.rhai"), scene("scene.rhai"));
}

#[test]
fn course_scenes_expand_too() {
    let folder = Folder::new();
    folder.write(
        "a.test",
        "size 8 6\ncamera 0 0 4 0 0 0 0 1 0 40\npoint 0 0 5 1 1 1\ntranslate 0.5 0 0\ndiffuse 1 0 0\nsphere 0 0 0 1\n",
    );
    let ran = folder.ok(&["expand", "a.test", "-o", "a.rhai"]);
    assert_eq!(ran.stderr, "");
    let flat = fs::read_to_string(folder.path("a.rhai")).unwrap();
    assert!(
        flat.contains("encoding(\"raw\");") && flat.ends_with(" // a.test:6:1\n"),
        "{flat}"
    );
    assert_eq!(hashes(&folder, &["a.rhai"]), hashes(&folder, &["a.test"]));
}

#[test]
fn names_are_kept_as_far_as_they_tell_groups_apart() {
    let folder = Folder::with(
        "for i in 0..2 { define \"a \\\"b\\\"\" { sphere(i, 0, 0, 0.3); } instance(\"a \\\"b\\\"\"); } light([0, 0, 5], [1, 1, 1]);",
    );
    let flat = text(&folder.ok(&["expand", "scene.rhai", "--no-places"]));
    for line in [
        "define \"a \\\"b\\\"\" {\n",
        "define \"a \\\"b\\\" (2)\" {\n",
        "\ninstance(\"a \\\"b\\\" (2)\");\n",
    ] {
        assert!(flat.contains(line), "{line} in {flat}");
    }
}

#[test]
fn what_cannot_be_expanded_is_said() {
    let folder = Folder::with("sphere(0, 0, 0);");
    folder.fails(&["expand", "scene.rhai"], 1, &["scene.rhai:1:1"]);
    folder.fails(&["expand", "none.rhai"], 3, &["no such file"]);
    folder.write("good.rhai", BALL);
    folder.fails(
        &["expand", "good.rhai", "-o", "good.rhai"],
        4,
        &["it is one of the files"],
    );
    folder.fails(
        &["expand", "good.rhai", "-o", "no/flat.rhai"],
        4,
        &["there is no folder 'no'"],
    );
    assert_eq!(folder.files(), ["good.rhai", "scene.rhai"]);
}
