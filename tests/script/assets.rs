//! Meshes and pictures from files and arrays.

use rtscript::{DVec3, diag::ErrorKind, scene::Texture};

use crate::host::{Notes, run, run_on, try_run};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

fn png(pixel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(3, 2, image::Rgb(pixel))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn a_mesh_from_a_file_is_read_once() {
    let host = Notes::with(&[("models/square.obj", SQUARE)]);
    let source = "for i in 0..3 { mesh(\"models/square.obj\"); } mesh(\"models/../models/square.obj\");";
    let host = {
        let mut host = host;
        host.insert("models/../models/square.obj", SQUARE.as_bytes().to_vec());
        host
    };
    let scene = run_on(&host, source).unwrap().value.scene;
    assert_eq!(scene.root().objects.len(), 4);
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    assert_eq!(scene.root().objects[2].loc.line, 1);
}

#[test]
fn files_are_relative_to_the_script_that_names_them() {
    let mut host = Notes::with(&[
        (
            "lib/car.rhai",
            "fn car() { mesh(\"car.obj\"); diffuse(image(\"../paint.png\")); sphere(0, 0, 0, 1); }",
        ),
        ("lib/car.obj", SQUARE),
    ]);
    host.insert("lib/../paint.png", png([255, 0, 0]));
    let scene = run_on(&host, "import \"lib/car\" as c; c::car();")
        .unwrap()
        .value
        .scene;
    assert_eq!((scene.meshes.len(), scene.textures.len()), (1, 1));
}

#[test]
fn pictures_are_looked_at_and_used() {
    let mut host = Notes::default();
    host.insert("red.png", png([255, 0, 0]));
    let source = "let i = image(\"red.png\"); print(i); print(i.pixel(2, 1)); print(i.width * 10 + i.height);
                  diffuse(i); sphere(0, 0, 0, 1); diffuse(image(\"red.png\") * 0.5); sphere(0, 0, 0, 1);";
    let scene = run_on(&host, source).unwrap().value.scene;
    assert_eq!(host.printed(), ["image(3 x 2)", "[1.0, 0.0, 0.0]", "32"]);
    assert_eq!(scene.textures.len(), 1, "one file, one texture");
    assert!(matches!(&*scene.textures[0], Texture::Image(i) if i.name == "red.png"));
    assert_eq!(scene.materials[1].diffuse.color, DVec3::splat(0.5));
}

#[test]
fn meshes_from_arrays_nested_or_flat() {
    let nested = run("mesh(#{
        positions: [[0, 0, 0], vec3(1, 0, 0), [1, 1, 0.0], [0, 1, 0]],
        indices: [[0, 1, 2], [0, 2, 3.0]],
        normals: [[0, 0, 1], [0, 0, 1], [0, 0, 1], vec3(0, 0, 2)],
        uvs: [[0, 0], [1, 0], [1, 1], [0, 1]],
    });");
    let flat = run("mesh(#{
        positions: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0],
        indices: [0, 1, 2, 0, 2, 3],
        normals: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 2],
        uvs: [0, 0, 1, 0, 1, 1, 0, 1],
    });");
    assert_eq!(nested.scene.meshes, flat.scene.meshes);
    let mesh = &flat.scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.normals.as_ref().unwrap().values[3], DVec3::Z * 2.0);
    let bare = run("mesh(#{ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], normals: () });");
    assert_eq!(bare.scene.meshes[0].triangles, [[0, 1, 2]]);
}

#[test]
fn arrays_that_make_no_mesh() {
    for (data, message) in [
        ("#{ }", "mesh: the map needs positions"),
        ("#{ position: [] }", "mesh: unknown key \"position\""),
        ("#{ positions: [] }", "the mesh has no positions"),
        (
            "#{ positions: 5 }",
            "mesh: positions must be an array or a blob, not a number",
        ),
        (
            "#{ positions: [0, 1] }",
            "mesh: positions has 2 numbers, which do not come in 3s",
        ),
        (
            "#{ positions: [[0, 0]] }",
            "mesh: positions[0] must be 3 numbers, not 2",
        ),
        (
            "#{ positions: [[0, 0, 0], \"x\"] }",
            "mesh: positions[1] must be 3 numbers, not a string",
        ),
        (
            "#{ positions: [[0, 0, \"x\"]] }",
            "mesh: positions[0][2] must be a number, not a string",
        ),
        (
            "#{ positions: [0, 0, 0.0 / 0.0] }",
            "mesh: positions[2] must be a finite number, but it is NaN",
        ),
        (
            "#{ positions: [0, 0, 0], indices: [0, 0, 1] }",
            "index 2 of the mesh is 1, but its positions are numbered 0 to 0",
        ),
        (
            "#{ positions: [0, 0, 0], indices: [0, 0] }",
            "the mesh has 2 indices, but every triangle takes 3",
        ),
        (
            "#{ positions: [0, 0, 0], indices: [[0, 0, 0, 0]] }",
            "mesh: indices[0] must be 3 ints, not 4",
        ),
        (
            "#{ positions: [0, 0, 0], indices: [0, 0, 0.5] }",
            "mesh: indices[2] must be a whole number, not 0.5",
        ),
        (
            "#{ positions: [0, 0, 0], uvs: [[1, 2, 3]] }",
            "mesh: uvs[0] must be 2 numbers, not 3",
        ),
        (
            "5",
            "mesh: it takes the name of an OBJ, PLY, STL or glTF file or a map of arrays, not a number",
        ),
    ] {
        let e = try_run(&format!("mesh({data});")).unwrap_err();
        assert_eq!(e.diagnostic.message, message, "{data}");
        assert_eq!((e.diagnostic.line, e.diagnostic.column), (1, 1));
    }
}

#[test]
fn a_missing_file_is_the_fault_of_the_call() {
    for call in ["mesh(\"no.obj\")", "image(\"no.png\")"] {
        let e = try_run(&format!("\n  {call};")).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::Input);
        assert!(
            e.to_string()
                .starts_with("scene.rhai:2:3: error: cannot read 'no."),
            "{e}"
        );
    }
}

#[test]
fn a_malformed_file_keeps_its_own_place() {
    let mut host = Notes::with(&[("a.obj", "v 0 0 0\nv 1 0 x\n"), ("b.png", "not a picture")]);
    host.insert("c.obj", b"v 0 0 0\nf 1 1 9\n".to_vec());
    let e = run_on(&host, "fn f() {\n  mesh(\"a.obj\");\n}\nf();").unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Input);
    assert_eq!(
        (e.diagnostic.file.as_deref(), e.diagnostic.line),
        (Some("a.obj"), 2),
        "{e}"
    );
    assert_eq!(
        e.diagnostic.notes,
        ["named at scene.rhai:2:3", "called at scene.rhai:4:1"]
    );
    let e = run_on(&host, "image(\"b.png\");").unwrap_err();
    assert_eq!(e.diagnostic.message, "'b.png' is not a PNG or JPEG picture");
    assert_eq!(e.diagnostic.file.as_deref(), Some("scene.rhai"));
    let e = run_on(&host, "mesh(\"c.obj\");").unwrap_err();
    assert_eq!(
        (e.diagnostic.file.as_deref(), e.diagnostic.line),
        (Some("c.obj"), 2),
        "{e}"
    );
}
