//! What a PNG carries, `rtscript rerun` and `rtscript verify`.

use rtscript::recipe::Recipe;

use super::*;

const SCRIPT: &str = "\
import \"lib/ball\" as lib;
size(16, 12);
light([0, 0, 5], [1, 1, 1]);
diffuse([param(\"red\", 1.0), 0, 0]);
lib::ball();
";
const MODULE: &str = "fn ball() { sphere(0, 0, 0, 1); }";

fn rendered(args: &[&str]) -> Folder {
    let folder = Folder::with(SCRIPT);
    folder.write("lib/ball.rhai", MODULE);
    folder.ok(&[&["scene.rhai"], args].concat());
    folder
}

fn recipe(folder: &Folder, name: &str) -> Option<Recipe> {
    Recipe::of_png(&fs::read(folder.path(name)).unwrap())
}

#[test]
fn a_png_carries_scripts_parameters_and_hash_and_no_path() {
    let folder = Folder::new();
    folder.write("deep/scene.rhai", SCRIPT);
    folder.write("deep/lib/ball.rhai", MODULE);
    let scene = folder.path("deep/scene.rhai");
    let args = [
        scene.to_str().unwrap(),
        "-o",
        "a.png",
        "--seed",
        "3",
        "-D",
        "red=0.5",
    ];
    let ran = folder.ok(&args);
    let hash = ran.stderr.split_whitespace().last().unwrap();
    let recipe = recipe(&folder, "a.png").unwrap();
    assert_eq!(
        (&*recipe.hash, &*recipe.version),
        (hash, env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(recipe.parameters.to_string(), "seed=3 red=0.5");
    let files: Vec<(&str, &str)> = recipe.files.iter().map(|(a, b)| (&**a, &**b)).collect();
    assert_eq!(files, [("scene.rhai", SCRIPT), ("lib/ball.rhai", MODULE)]);
    let text = recipe.to_text();
    assert!(!text.contains(folder.path("").to_str().unwrap()), "{text}");
}

#[test]
fn it_can_be_left_out_and_pixels_are_the_same() {
    let folder = rendered(&["-o", "a.png"]);
    folder.ok(&["scene.rhai", "-o", "b.png", "--no-recipe"]);
    assert!(recipe(&folder, "b.png").is_none());
    let pixels = |name: &str| load_picture(&folder.path(name)).unwrap().rgb8();
    assert_eq!(pixels("a.png"), pixels("b.png"));
    let piped = folder.ok(&["scene.rhai", "-o", "-"]).stdout;
    assert_eq!(Recipe::of_png(&piped), recipe(&folder, "a.png"));
}

#[test]
fn pictures_that_a_script_names_carry_it_too() {
    let folder = Folder::with(&format!(
        "{BALL}render(\"one.png\");\nsphere(1, 1, 0, 0.3);\nrender(\"two.png\");\n"
    ));
    folder.ok(&["scene.rhai"]);
    let hashes = ["one.png", "two.png"].map(|name| recipe(&folder, name).unwrap().hash);
    assert_ne!(hashes[0], hashes[1]);
    folder.ok(&["verify", "one.png", "two.png"]);
    folder.ok(&["rerun", "one.png", "-o", "again.png"]);
    assert_eq!(recipe(&folder, "again.png").unwrap().hash, hashes[0]);
}

#[test]
fn rerun_needs_nothing_but_the_picture() {
    let folder = rendered(&["-o", "a.png", "-D", "red=0.5", "--size", "20x10"]);
    let other = Folder::new();
    fs::copy(folder.path("a.png"), other.path("a.png")).unwrap();
    other.ok(&["rerun", "a.png"]);
    assert_eq!(other.files(), ["a-rerun.png", "a.png"]);
    assert_eq!(recipe(&other, "a-rerun.png"), recipe(&folder, "a.png"));
    other.ok(&[
        "rerun",
        "a.png",
        "-o",
        "large.png",
        "--size",
        "40x20",
        "-D",
        "red=1",
    ]);
    assert_eq!(size_of(&other.path("large.png")), (40, 20));
    let large = recipe(&other, "large.png").unwrap();
    assert_eq!(large.parameters.to_string(), "size=40x20 red=1");
    let printed = String::from_utf8(other.ok(&["rerun", "a.png", "--print"]).stdout).unwrap();
    assert!(
        printed.contains(SCRIPT) && printed.contains("parameters size=20x10 red=0.5"),
        "{printed}"
    );
    other.fails(
        &["rerun", "a.png", "-o", "a.png"],
        4,
        &["one of the files the picture is made from"],
    );
}

#[test]
fn verify_finds_what_was_changed() {
    let folder = rendered(&["-o", "a.png"]);
    let ran = folder.ok(&["verify", "a.png"]);
    assert!(ran.stderr.contains("a.png: verified, "), "{}", ran.stderr);
    // Other pixels under the same recipe.
    let image = load_picture(&folder.path("a.png")).unwrap();
    let mut bytes = image.rgb8();
    bytes[0] ^= 1;
    let forged = rtscript::testing::from_rgb8(16, 12, &bytes);
    let recipe = recipe(&folder, "a.png").unwrap();
    rtscript::output::save_with(&folder.path("b.png"), &forged, &recipe).unwrap();
    folder.fails(
        &["verify", "a.png", "b.png"],
        1,
        &["'b.png' was changed after it was rendered", &recipe.hash],
    );
    // The same pixels under a recipe that gives others.
    let mut other = recipe.clone();
    other.files[0].1 = SCRIPT.replace("1.0", "0.9");
    other.version = "0.0.1".to_owned();
    rtscript::output::save_with(&folder.path("c.png"), &image, &other).unwrap();
    folder.fails(
        &["verify", "c.png"],
        1,
        &["rendering 'c.png' again gives the hash", "made by rtscript 0.0.1"],
    );
    folder.ok(&["scene.rhai", "-o", "d.png", "--no-recipe"]);
    folder.write("e.png", "no picture");
    for name in ["d.png", "e.png", "scene.rhai"] {
        folder.fails(&["verify", name], 3, &["carries no recipe", "--no-recipe"]);
    }
    folder.fails(&["rerun", "f.png"], 3, &["cannot read 'f.png': no such file"]);
}

#[test]
fn assets_are_looked_for_beside_the_picture_or_where_told() {
    let folder = Folder::new();
    folder.write(
        "scene.rhai",
        format!("{BALL}diffuse(image(\"dot.png\")); sphere(1, 0, 0, 0.5);\n"),
    );
    let dot = |green: u8| {
        let image = rtscript::testing::from_rgb8(1, 1, &[0, green, 0]);
        rtscript::output::save(&folder.path("dot.png"), &image).unwrap();
    };
    dot(255);
    folder.ok(&["scene.rhai", "-o", "a.png"]);
    folder.ok(&["verify", "a.png"]);
    fs::create_dir(folder.path("moved")).unwrap();
    fs::rename(folder.path("a.png"), folder.path("moved/a.png")).unwrap();
    folder.fails(&["verify", "moved/a.png"], 3, &["dot.png"]);
    folder.ok(&["verify", "moved/a.png", "--assets", "."]);
    dot(100);
    folder.fails(
        &["verify", "moved/a.png", "--assets", "."],
        1,
        &["a picture or a model that it reads"],
    );
}
