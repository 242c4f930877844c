//! `rtscript sweep`.

use super::*;

const SCRIPT: &str = "\
size(30, 20);
let radius = param(\"radius\", 0.5);
let shape = param(\"shape\", \"ball\");
light([0, 0, 5], [1, 1, 1]);
diffuse([1, 0, 0]);
if shape == \"ball\" { sphere(random(), 0, 0, radius); } else { box(4 * radius, radius, radius); }
";

#[test]
fn each_combination_is_the_picture_of_its_parameters() {
    let folder = Folder::with(SCRIPT);
    folder.ok(&[
        "sweep",
        "scene.rhai",
        "-D",
        "radius=0.2..0.6:3",
        "-D",
        "seed=1..2",
    ]);
    let names = [
        "scene radius=0.2 seed=1.png",
        "scene radius=0.2 seed=2.png",
        "scene radius=0.4 seed=1.png",
        "scene radius=0.4 seed=2.png",
        "scene radius=0.6 seed=1.png",
        "scene radius=0.6 seed=2.png",
        "scene.rhai",
    ];
    assert_eq!(folder.files(), names);
    folder.ok(&["scene.rhai", "-o", "one.png", "-D", "radius=0.4", "--seed", "2"]);
    let pixels = |name: &str| load_picture(&folder.path(name)).unwrap().rgb8();
    assert_eq!(pixels("one.png"), pixels("scene radius=0.4 seed=2.png"));
    assert_ne!(pixels("one.png"), pixels("scene radius=0.4 seed=1.png"));
    let ran = folder.ok(&["verify", "scene radius=0.6 seed=1.png"]);
    assert!(ran.stderr.contains("verified"), "{}", ran.stderr);
}

#[test]
fn a_grid_has_a_row_for_each_value_of_the_first() {
    let folder = Folder::with(SCRIPT);
    let ran = folder.ok(&[
        "sweep",
        "scene.rhai",
        "-D",
        "shape=ball,cube",
        "-D",
        "radius=0.1..0.3:3",
        "--grid",
    ]);
    assert!(ran.stderr.contains("6 pictures"), "{}", ran.stderr);
    assert_eq!(folder.files(), ["scene-sweep.png", "scene.rhai"]);
    assert_eq!(size_of(&folder.path("scene-sweep.png")), (3 * 46, 2 * 48));
    folder.ok(&[
        "sweep",
        "scene.rhai",
        "-D",
        "seed=1..9",
        "--grid",
        "-o",
        "nine.png",
        "--size",
        "20x20",
        "-q",
    ]);
    assert_eq!(size_of(&folder.path("nine.png")), (3 * 36, 3 * 48));
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let folder = Folder::with(SCRIPT);
    for (args, code, texts) in [
        (&["scene.rhai"][..], 2, &["--define"][..]),
        (&["scene.rhai", "-D", "radius=0.1..0.5"], 2, &["0.1..0.5:10"]),
        (&["scene.rhai", "-D", "radius"], 2, &["NAME=VALUES"]),
        (
            &["scene.rhai", "-D", "seed=1..9000", "-D", "radius=0..1:9000"],
            3,
            &["at most 10000 pictures"],
        ),
        (
            &["scene.rhai", "-D", "radus=1,2"],
            1,
            &["no parameter \"radus\"", "did you mean radius?", "with radus=1"],
        ),
        (
            &["scene.rhai", "-D", "radius=1,x"],
            1,
            &["must be a number, not \"x\"", "with radius=x"],
        ),
        (&["scene.rhai", "-D", "seed=1,x"], 2, &["whole number"]),
        (&["missing.rhai", "-D", "seed=1,2"], 3, &["no such file"]),
        (
            &["scene.rhai", "-D", "seed=1,2", "-o", "nowhere"],
            4,
            &["'nowhere' is no folder"],
        ),
        (
            &["scene.rhai", "-D", "seed=1,2", "--grid", "-o", "a.gif"],
            4,
            &["'.gif' is not a picture format"],
        ),
    ] {
        folder.fails(&[&["sweep"], args].concat(), code, texts);
    }
}
