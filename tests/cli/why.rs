//! `rtscript why`: what it says, of scenes and of pictures.

use super::*;

/// A floor, a ball in the way of one light, a ball of glass from a module, placed as an instance.
const SCENE: &str = "\
import \"parts\" as parts;
size(64, 40);
maxDepth(2);
camera([0, 2, 8], [0, 0, 0], [0, 1, 0], 40);
background([0.1, 0.2, 0.4]);
light([0, 5, 0], [1, 1, 1]);
directional([0, -1, 0], [1, 1, 1]);
diffuse([0.5, 0.5, 0.5]);
for i in 0..3 {
    group { parts::ball(i * 2.5 - 2.5); }
}
define \"bubble\" { parts::glass(); }
group { translate(2.5, 0, 3); instance(\"bubble\"); }
translate(0, -1, 0);
plane();
";

const PARTS: &str = "\
fn ball(x) {
    place(x);
}
fn place(x) {
    translate(x, 0, 0);
    sphere(0, 0, 0, 1);
}
fn glass() {
    diffuse([0, 0, 0]); transmission([0.9, 0.9, 0.9]); reflection([0.1, 0.1, 0.1]);
    sphere(0, 0, 0, 0.6);
}
";

fn folder() -> Folder {
    let folder = Folder::with(SCENE);
    folder.write("parts.rhai", PARTS);
    folder
}

fn told(folder: &Folder, args: &[&str]) -> String {
    String::from_utf8(folder.ok(&[&["why"], args].concat()).stdout).unwrap()
}

#[test]
fn a_ball_names_the_calls_that_made_it() {
    insta::assert_snapshot!(told(&folder(), &["scene.rhai", "17,21"]));
}

#[test]
fn a_shadow_names_what_casts_it() {
    insta::assert_snapshot!(told(&folder(), &["scene.rhai", "32,28"]));
}

#[test]
fn glass_shows_the_rays_behind_it() {
    insta::assert_snapshot!(told(&folder(), &["scene.rhai", "51,25"]));
}

#[test]
fn the_background_is_the_background() {
    insta::assert_snapshot!(told(&folder(), &["scene.rhai", "0,0"]));
}

#[test]
fn samples_are_counted_by_what_they_show() {
    insta::assert_snapshot!(told(
        &folder(),
        &["scene.rhai", "32,13", "--samples", "16", "--sample", "15"]
    ));
}

/// Each eye has samples of its own and shows some channels only: what the pixel takes of them gives the pixel.
#[test]
fn a_sample_of_an_anaglyph_counts_for_the_channels_of_its_eye() {
    let folder = Folder::with(SCENE);
    folder.write("parts.rhai", PARTS);
    folder.write(
        "eyes.rhai",
        SCENE.replace(
            "maxDepth(2);",
            "maxDepth(2);\nstereo(0.4, #{ layout: \"anaglyph\" });",
        ),
    );
    let asked = |sample: &str| {
        let text = told(
            &folder,
            &["eyes.rhai", "32,13", "--samples", "2", "--sample", sample],
        );
        let json = told(
            &folder,
            &[
                "eyes.rhai",
                "32,13",
                "--samples",
                "2",
                "--sample",
                sample,
                "--json",
            ],
        );
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let color = |name: &str| -> Vec<f64> {
            let all = json[name].as_array().unwrap();
            all.iter().map(|v| v.as_f64().unwrap()).collect()
        };
        (
            text,
            color("sample_value"),
            color("sample_share"),
            color("linear"),
        )
    };
    let mut sum = [0.0; 3];
    let mut whole = Vec::new();
    for sample in ["0", "1", "2", "3"] {
        let (text, value, share, linear) = asked(sample);
        let (words, expected) = if share[0] > 0.0 {
            ("of which the pixel takes 1/2 of red\n", [0.5, 0.0, 0.0])
        } else {
            (
                "of which the pixel takes 1/2 of green and blue\n",
                [0.0, 0.5, 0.5],
            )
        };
        assert!(text.contains(words), "{text}");
        assert_eq!(share, expected);
        (0..3).for_each(|i| sum[i] += share[i] * value[i]);
        whole = linear;
    }
    assert!(
        (0..3).all(|i| (sum[i] - whole[i]).abs() < 1e-15),
        "{sum:?} is not {whole:?}"
    );
}

#[test]
fn a_picture_is_asked_by_its_recipe() {
    let folder = folder();
    folder.ok(&["scene.rhai", "--size", "32x20", "--samples", "2"]);
    let arguments = ["--size", "32x20", "--samples", "2"];
    let of_script = told(&folder, &[&["scene.rhai", "16,10"], &arguments[..]].concat());
    fs::remove_file(folder.path("scene.rhai")).unwrap();
    fs::remove_file(folder.path("parts.rhai")).unwrap();
    assert_eq!(told(&folder, &["scene.png", "16,10"]), of_script);
    folder.write("bare.png", fs::read(folder.path("scene.png")).unwrap());
    let other = told(&folder, &["scene.png", "16,10", "--samples", "1"]);
    assert!(other.contains("it shows sphere"), "{other}");
}

#[test]
fn json_has_what_the_text_has() {
    let json = told(&folder(), &["scene.rhai", "51,25", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    let mut sum = [0.0; 3];
    for ray in json["rays"].as_array().unwrap() {
        for (sum, added) in sum.iter_mut().zip(numbers(&ray["added"])) {
            *sum += added;
        }
    }
    assert_eq!(numbers(&json["linear"]), sum);
    assert_eq!(json["made_by"][0]["object"]["name"], "instance \"bubble\"");
    assert_eq!(json["made_by"][1]["calls"][0]["function"], "glass");
    assert_eq!(json["rays"][0]["hit"]["branches"][0]["outcome"], "followed");
}

#[test]
fn the_rays_are_drawn_into_the_picture() {
    let folder = folder();
    folder.ok(&["scene.rhai"]);
    let ran = folder.ok(&["why", "scene.rhai", "51,25", "--image", "rays.png"]);
    assert!(
        ran.stderr.starts_with("rays.png  the pixel white"),
        "{}",
        ran.stderr
    );
    let [plain, rays] = ["scene.png", "rays.png"].map(|name| load_picture(&folder.path(name)).unwrap());
    assert_eq!((rays.width(), rays.height()), (64, 40));
    let white = rays.rgb8().chunks(3).filter(|p| *p == [255, 255, 255]).count();
    assert_eq!(white, 16, "four strokes of four pixels");
    let brighter = rays
        .rgb8()
        .iter()
        .zip(plain.rgb8())
        .filter(|(r, p)| **r > *p)
        .count();
    assert!(brighter > 60, "{brighter}");
}

#[test]
fn mistakes_are_explained() {
    let folder = folder();
    folder.fails(
        &["why", "scene.rhai", "64,0"],
        1,
        &["there is no pixel 64,0 in a picture of 64 x 40"],
    );
    folder.fails(
        &["why", "scene.rhai", "1,1", "--sample", "1"],
        1,
        &["there is no sample 1"],
    );
    folder.fails(
        &["why", "scene.rhai", "middle"],
        2,
        &["expected column and row from the top left, such as 320,240"],
    );
    folder.fails(&["why", "scene.rhai"], 2, &["<X,Y>"]);
    folder.fails(
        &["why", "none.rhai", "1,1"],
        3,
        &["cannot read 'none.rhai': no such file"],
    );
    folder.ok(&["scene.rhai", "--no-recipe"]);
    folder.fails(
        &["why", "scene.png", "1,1"],
        3,
        &["'scene.png' carries no recipe"],
    );
    folder.fails(
        &["why", "scene.rhai", "1,1", "--image", "scene.rhai"],
        4,
        &["not a picture format"],
    );
}

#[test]
fn rays_that_count_for_too_little_are_named_with_the_least_weight() {
    let scene = "size(16, 12); camera([0, 0, 4], [0, 0, 0], [0, 1, 0], 40); directional([1, 2, 3], [1, 1, 1]);\n\
         specular([0, 0, 0]); reflection([0.015625, 0, 0]); sphere(0, 0, 0, 1);";
    let folder = Folder::with(scene);
    folder.write("coarse.rhai", format!("minWeight(0.03125);\n{scene}"));
    folder.write("dark.rhai", scene.replace("0.015625", "0.0000001"));
    let told = |file: &str| told(&folder, &[file, "8,6"]);
    assert!(told("scene.rhai").contains("reflected 0.015625 0 0, see below"));
    let coarse = "reflected 0.015625 0 0, not followed: weight 0.015625 0 0 is below minWeight, 0.03125";
    assert!(told("coarse.rhai").contains(coarse), "{}", told("coarse.rhai"));
    let dark = "reflected 1e-7 0 0, not followed: weight 1e-7 0 0 is below 2^-20";
    assert!(told("dark.rhai").contains(dark), "{}", told("dark.rhai"));
}

#[test]
fn textures_of_all_terms_are_named_with_what_they_are_there() {
    let folder = Folder::with(
        "size(16, 12);\n\
         maxDepth(1);\n\
         camera([0, 1, 4], [0, 0, 0], [0, 1, 0], 40);\n\
         directional([1, 2, 3], [1, 1, 1]);\n\
         let tiles = checker([1, 1, 1], [0.25, 0.5, 0.75], 100);\n\
         diffuse(tiles);\n\
         specular([0, 0, 0]);\n\
         reflection(mixed(tiles, [0, 0, 0], [0.5, 0.5, 0.5]));\n\
         roughness(checker([0.5, 0.5, 0.5], [0.1, 0.1, 0.1], 100));\n\
         sphere(0, 0, 0, 1);\n",
    );
    insta::assert_snapshot!(told(&folder, &["scene.rhai", "8,6"]));
    let json: serde_json::Value =
        serde_json::from_str(&told(&folder, &["scene.rhai", "8,6", "--json"])).unwrap();
    let textures = json["rays"][0]["hit"]["textures"].as_array().unwrap();
    let terms: Vec<_> = textures
        .iter()
        .map(|used| used["term"].as_str().unwrap())
        .collect();
    assert_eq!(terms, ["diffuse", "reflection", "roughness"]);
    assert_eq!(textures[2]["value"], serde_json::json!([0.5, 0.5, 0.5]));
    assert!(textures[2]["text"].as_str().unwrap().starts_with("checker("));
}
