//! `--show` and `rtscript blame`: what is not light.

use super::*;

/// Two balls of one line, a box of another, a floor.
const SCENE: &str = "\
size(48, 30);
camera([0, 2, 8], [0, 0, 0], [0, 1, 0], 40);
light([2, 5, 3], [1, 1, 1]);
diffuse([0.5, 0.5, 0.5]);
for x in [-2.2, 2.2] { group { translate(x, 0, 0); sphere(0, 0, 0, 1); } }
specular([0.5, 0.5, 0.5]);
box(1.5, 1.5, 1.5);
translate(0, -1, 0); plane();
";

/// The distinct colors of the pixels, and how many have each, most first.
fn colors(folder: &Folder, what: &str) -> Vec<usize> {
    folder.ok(&["scene.rhai", "--show", what]);
    let image = load_picture(&folder.path(&format!("scene-{what}.png"))).unwrap();
    let bytes = image.rgb8();
    let mut pixels: Vec<&[u8]> = bytes.chunks(3).collect();
    pixels.sort_unstable();
    let mut counts: Vec<usize> = pixels.chunk_by(|a, b| a == b).map(<[&[u8]]>::len).collect();
    counts.sort_unstable();
    counts.reverse();
    counts
}

#[test]
fn objects_and_lines_have_a_color_each() {
    let folder = Folder::with(SCENE);
    let objects = colors(&folder, "object");
    let lines = colors(&folder, "line");
    assert_eq!((objects.len(), lines.len()), (5, 4), "and the background");
    assert!(
        lines.contains(&(objects[2] + objects[3])),
        "{objects:?} {lines:?}"
    );
    assert!(colors(&folder, "normal").len() > 20);
    assert!(colors(&folder, "uv").len() > 20);
    assert!(colors(&folder, "depth").len() > 20);
    assert!(colors(&folder, "cost").len() > 4);
    let files = folder.files();
    assert!(!files.contains(&"scene.png".to_owned()), "{files:?}");
}

#[test]
fn the_same_on_any_number_of_threads_and_no_recipe_in_it() {
    let folder = Folder::with(SCENE);
    folder.ok(&["scene.rhai", "--show", "cost", "-o", "a.png"]);
    folder.ok(&["scene.rhai", "--show", "cost", "-o", "b.png", "--threads", "1"]);
    let [a, b] = ["a.png", "b.png"].map(|name| fs::read(folder.path(name)).unwrap());
    assert_eq!(a, b);
    folder.fails(&["rerun", "a.png"], 3, &["'a.png' carries no recipe"]);
    let piped = folder.ok(&["scene.rhai", "--show", "depth", "-o", "-"]);
    assert!(piped.stdout.starts_with(b"\x89PNG"));
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let folder = Folder::with(SCENE);
    folder.fails(
        &["scene.rhai", "--show", "colour"],
        2,
        &["normal, uv, depth, object, line, cost"],
    );
    folder.fails(
        &["scene.rhai", "--show", "uv", "-o", "scene.rhai"],
        4,
        &["not a picture format"],
    );
}

#[test]
fn blame_names_the_dearest_lines() {
    let folder = Folder::with(SCENE);
    let ran = folder.ok(&["blame", "scene.rhai", "--image", "heat.png"]);
    insta::assert_snapshot!(String::from_utf8(ran.stdout).unwrap());
    assert_eq!(size_of(&folder.path("heat.png")), (48, 30));
    let json = folder.ok(&["blame", "scene.rhai", "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let sum = |key: &str| -> u64 {
        let lines = json.as_array().unwrap().iter();
        lines.map(|line| line[key].as_u64().unwrap()).sum()
    };
    assert_eq!(sum("pixels"), 48 * 30);
    let stats = folder.ok(&["scene.rhai", "--stats=json"]).stderr;
    let stats: serde_json::Value = serde_json::from_str(stats.lines().last().unwrap()).unwrap();
    assert_eq!(
        sum("rays") + sum("shadow_rays"),
        stats["rays"]["total"].as_u64().unwrap(),
        "{stats}"
    );
}
