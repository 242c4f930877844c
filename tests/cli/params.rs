//! `-D` and `rtscript params`.

use super::*;

const SCRIPT: &str = "\
size(16, 12);
let radius = param(\"radius\", 0.5, #{ min: 0.1, max: 2, doc: \"of the ball\" });
let count = param(\"count\", 1, #{ min: 1 });
let metal = param(\"metal\", false);
let shape = param(\"shape\", \"ball\", #{ choices: [\"ball\", \"cube\"] });
light([0, 0, 5], [1, 1, 1]);
diffuse([1, 0, 0]);
if metal { specular([1, 1, 1]); }
for i in 0..count {
    translate(i, 0, 0);
    if shape == \"ball\" { sphere(0, 0, 0, radius); } else { box(4 * radius, radius, radius); }
}
";

#[test]
fn parameters_change_the_picture_and_their_defaults_do_not() {
    let folder = Folder::with(SCRIPT);
    let plain = folder.hash(&[]);
    let defaults = [
        "-D",
        "radius=0.5",
        "-Dcount=1",
        "--define",
        "metal=false",
        "-D",
        "shape=ball",
    ];
    assert_eq!(folder.hash(&defaults), plain);
    for changed in [
        "radius=1",
        "radius=5e-1",
        "count=3",
        "metal=true",
        "shape=cube",
        "size=20x10",
    ] {
        assert_eq!(
            folder.hash(&["-D", changed]) == plain,
            changed == "radius=5e-1",
            "{changed}"
        );
    }
    assert_eq!(size_of(&folder.path("scene.png")), (20, 10));
    assert_eq!(folder.hash(&["-D", "seed=3", "--size", "16x12"]), plain);
}

#[test]
fn what_a_parameter_does_not_take_is_refused_with_what_it_takes() {
    let folder = Folder::with(SCRIPT);
    for (given, texts) in [
        (
            "radius=3",
            [
                "\"radius\" must be a number from 0.1 to 2, not \"3\"",
                "scene.rhai:2:14",
            ],
        ),
        (
            "radius=big",
            ["must be a number from 0.1 to 2, not \"big\"", "-D radius=0.5"],
        ),
        ("radius=NaN", ["must be a number", "\"NaN\""]),
        ("count=1.5", ["must be a whole number from 1 on", "\"1.5\""]),
        ("count=0", ["must be a whole number from 1 on", "\"0\""]),
        ("metal=yes", ["must be true or false", "\"yes\""]),
        ("shape=cone", ["must be one of ball, cube", "\"cone\""]),
        (
            "radus=1",
            ["the script has no parameter \"radus\"", "did you mean radius?"],
        ),
        (
            "zebra=1",
            [
                "the script has no parameter \"zebra\"",
                "radius, count, metal, shape",
            ],
        ),
    ] {
        folder.fails(&["scene.rhai", "-D", given], 1, &texts);
    }
    folder.fails(&["scene.rhai", "-D", "radius"], 2, &["NAME=VALUE"]);
    folder.fails(&["scene.rhai", "-D", "seed=x"], 2, &["whole number"]);
    folder.write("none.rhai", BALL);
    folder.fails(
        &["none.rhai", "-D", "radius=1"],
        1,
        &["has no parameter \"radius\"", "param(\"radius\", 1.0)"],
    );
    assert!(!folder.path("scene.png").exists());
}

#[test]
fn params_lists_what_a_script_declares() {
    let folder = Folder::with(SCRIPT);
    let ran = folder.ok(&["params", "scene.rhai"]);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert_eq!(
        text,
        "\
radius  a number from 0.1 to 2    0.5    of the ball
count   a whole number from 1 on  1
metal   true or false             false
shape   one of ball, cube         ball
"
    );
    let ran = folder.ok(&["params", "scene.rhai", "--json", "-D", "count=7"]);
    let list: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
    assert_eq!(
        (&list[0]["name"], &list[0]["max"], &list[0]["line"]),
        (&"radius".into(), &2.0.into(), &2.into())
    );
    assert_eq!(
        (&list[1]["value"], &list[1]["default"]),
        (&"7".into(), &"1".into())
    );
    assert_eq!(list[3]["choices"][1], "cube");
    folder.write("none.rhai", BALL);
    assert!(folder.ok(&["params", "none.rhai"]).stdout.is_empty());
    assert_eq!(folder.files(), ["none.rhai", "scene.rhai"]);
}

#[test]
fn parameters_go_on_record() {
    let folder = Folder::with(SCRIPT);
    folder.ok(&[
        "test",
        "--accept",
        "scene.rhai",
        "-D",
        "radius=1.5",
        "-D",
        "shape=cube",
    ]);
    let snapshot = fs::read_to_string(folder.path("scene.rtsnap")).unwrap();
    assert!(
        snapshot.contains("\nparameters radius=1.5 shape=cube\n"),
        "{snapshot}"
    );
    folder.ok(&["test"]);
    let changed = SCRIPT.replace("[1, 0, 0]", "[1, 1, 0]");
    folder.write("scene.rhai", changed);
    folder.fails(&["test", "-D", "radius=1"], 2, &["--accept"]);
    assert_eq!(folder.run(&["test"]).code, 1);
}
