//! Course files as scripts.

use rtscript::{Builder, import::load_course, import::script_from_course};

/// The script of a course file, which must at least be one.
fn convert(source: &str) -> String {
    let script = script_from_course("a.test", source).unwrap_or_else(|e| panic!("{e}"));
    let mut engine = rhai::Engine::new_raw();
    engine.set_max_expr_depths(64, 64);
    engine.set_fail_on_invalid_map_property(true);
    if let Err(e) = engine.compile(&script) {
        panic!("{e}\n{script}");
    }
    script
}

fn converted(source: &str) -> String {
    let header = "// a.test, converted from the scene format of CSE167\nencoding(\"raw\");\n\n";
    convert(source).strip_prefix(header).unwrap().to_owned()
}

#[test]
fn a_scene_becomes_a_script_one_would_write() {
    let source = "\
# A scene
size 640 480
maxdepth 3
output scene.png


#camera 0 0 4  0 0 0  0 1 0  30
camera +1 -2 .5  0 0 0  0 1 0  45 # closer

maxverts 3
vertex -1 -1 0
vertex +1 -1 0
# the apex
vertex 0 1e-7 0
maxvertnorms 1
vertexnormal 0 0 0  0 0 1

attenuation 1 .1 0
point 4 0 4 .5 .5 .5
directional 0 0 1 1 1 1
ambient .1 .2 .3
emission 0 0 -0
pushTransform
# inside
translate 0 0 -2.0
rotate 0 0 1 45
tri 0 1 2 # front
tri 2 1 0
popTransform
diffuse 1 0 0
specular .5 .5 .5
shininess 20
pushTransform
scale 2 1 .25
trinormal 0 0 0
sphere 0 0 0 1";
    let wanted = r#"// A scene
size(640, 480);
maxDepth(3);
// output scene.png

// camera([0, 0, 4], [0, 0, 0], [0, 1, 0], 30);
camera([1, -2, 0.5], [0, 0, 0], [0, 1, 0], 45); // closer

let v = [
    [-1, -1, 0],
    [1, -1, 0],
    [0, 1e-7, 0],
];
// the apex
let p = [
    [0, 0, 0],
];
let n = [
    [0, 0, 1],
];

attenuation(1, 0.1, 0);
point([4, 0, 4], [0.5, 0.5, 0.5]);
directional([0, 0, 1], [1, 1, 1]);
ambient(0.1, 0.2, 0.3);
emission(0, 0, -0.0);
pushTransform();
    // inside
    translate(0, 0, -2);
    rotate([0, 0, 1], 45);
    tri(v[0], v[1], v[2]); // front
    tri(v[2], v[1], v[0]);
popTransform();
diffuse(1, 0, 0);
specular(0.5, 0.5, 0.5);
shininess(20);
pushTransform();
    scale(2, 1, 0.25);
    tri(p[0], p[0], p[0], n[0], n[0], n[0]);
    sphere([0, 0, 0], 1);
popTransform();
"#;
    assert_eq!(converted(source), wanted);
}

#[test]
fn many_triangles_in_a_row_become_a_table() {
    let vertices = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
    let script = converted(&format!(
        "{vertices}{}tri 2 1 0\n\ntri 0 1 2\n",
        "tri 0 1 2\n".repeat(29)
    ));
    let (_, table) = script.split_once("];\n").unwrap();
    let row = format!("   {}\n", " [0, 1, 2],".repeat(8));
    let wanted = format!(
        "for t in [\n{row}{row}{row}   {} [2, 1, 0],\n] {{\n    tri(v[t[0]], v[t[1]], v[t[2]]);\n}}\n\ntri(v[0], v[1], v[2]);\n",
        " [0, 1, 2],".repeat(5)
    );
    assert_eq!(table, wanted);

    let vertices = "vertexnormal 0 0 0 0 0 1\n";
    let script = converted(&format!("{vertices}{}", "trinormal 0 0 0\n".repeat(24)));
    assert!(
        script.ends_with("    tri(p[t[0]], p[t[1]], p[t[2]], n[t[0]], n[t[1]], n[t[2]]);\n}\n"),
        "{script}"
    );
}

#[test]
fn flat_and_smooth_triangles_keep_their_order() {
    let script = converted("vertex 0 0 0\nvertexnormal 0 0 0 0 0 1\ntri 0 0 0\ntrinormal 0 0 0\ntri 0 0 0\n");
    let calls: Vec<&str> = script.lines().filter(|line| line.starts_with("tri")).collect();
    let (flat, smooth) = (
        "tri(v[0], v[0], v[0]);",
        "tri(p[0], p[0], p[0], n[0], n[0], n[0]);",
    );
    assert_eq!(calls, [flat, smooth, flat]);
}

#[test]
fn comments_cannot_break_a_script() {
    for comment in [
        "#/ doc",
        "#!inner",
        "#* block */",
        "#\u{c}",
        "# \"",
        "#",
        "# `",
        "#//",
    ] {
        let script = converted(&format!("{comment}\nsphere 0 0 0 1 {comment}\n"));
        assert_eq!(
            script.matches("\nsphere([0, 0, 0], 1); //").count(),
            1,
            "{script}"
        );
    }
    let script = script_from_course("a\nb.test", "sphere 0 0 0 1").unwrap();
    assert!(script.starts_with("// a b.test, "));
}

#[test]
fn line_ends_of_every_kind_give_the_same_script() {
    let source = "# x\nsize 1 1\n\npushTransform\nsphere 0 0 0 1\n";
    let wanted = convert(source);
    assert_eq!(convert(&source.replace('\n', "\r\n")), wanted);
    assert_eq!(convert(&source.replace('\n', "\r")), wanted);
    assert_eq!(convert(&format!("\u{feff}{source}")), wanted);
}

#[test]
fn what_does_not_load_is_not_converted() {
    for source in [
        "shpere 0 0 0 1",
        "size 1 1\ntri 0 1 2",
        "sphere 0 0 0 -1",
        "popTransform",
        "scale 0 1 1\nsphere 0 0 0 1",
    ] {
        let error = load_course("a.test", source, &mut Builder::new()).unwrap_err();
        assert_eq!(script_from_course("a.test", source), Err(error));
    }
}
