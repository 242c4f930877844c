use crate::{
    Builder, Limits, MemoryHost,
    diag::Diagnostic,
    import::{AssetCache, Assets, load_mesh},
    scene::Mesh,
};

fn load(bytes: &[u8]) -> Result<Mesh, Diagnostic> {
    let (host, limits) = (MemoryHost::new().with("a.ply", bytes), Limits::default());
    let mut cache = AssetCache::default();
    let mut assets = Assets::new(&host, &limits, &mut cache);
    load_mesh("a.ply", &mut assets, &mut Builder::new()).map(|mesh| Mesh::clone(&mesh))
}

/// A quad with normals and texture coordinates in a format, and an element that nobody knows before it.
fn quad(format: &str, end: &str) -> Vec<u8> {
    let head = [
        "ply",
        &format!("format {format} 1.0"),
        "comment \u{e9}",
        "element thing 2",
        "property list uchar short stuff",
        "element vertex 4",
        "property float x",
        "property float y",
        "property double z",
        "property char nx",
        "property char ny",
        "property char nz",
        "property float u",
        "property float v",
        "element face 1",
        "property list ushort int vertex_indices",
        "property uint flags",
        "end_header",
        "",
    ];
    let mut bytes = head.join(end).into_bytes();
    let vertices = [(0i8, 0i8), (2, 0), (2, 1), (0, 1)];
    if format == "ascii" {
        let mut lines = vec!["2 7 -7".to_owned(), "0".to_owned()];
        lines.extend(vertices.map(|(x, y)| format!("{x} {y}.5 -1 0 0 1 {x} {y}")));
        lines.push("4 0 1 2 3 9".to_owned());
        bytes.extend(lines.join(end).into_bytes());
        return bytes;
    }
    let big = format == "binary_big_endian";
    macro_rules! put {
        ($($x:expr),*) => { $( bytes.extend(if big { $x.to_be_bytes().to_vec() } else { $x.to_le_bytes().to_vec() }); )* };
    }
    put!(2u8, 7i16, -7i16, 0u8);
    for (x, y) in vertices {
        put!(
            f32::from(x),
            f32::from(y) + 0.5,
            -1f64,
            0i8,
            0i8,
            1i8,
            f32::from(x),
            f32::from(y)
        );
    }
    put!(4u16, 0i32, 1i32, 2i32, 3i32, 9u32);
    bytes
}

#[test]
fn every_format_gives_the_same_mesh() {
    let first = load(&quad("ascii", "\n")).unwrap();
    assert_eq!(first.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(first.bounds().max.to_array(), [2.0, 1.5, -1.0]);
    assert_eq!(
        first.normals.as_ref().unwrap().corners(1).unwrap()[2].to_array(),
        [0.0, 0.0, 1.0]
    );
    assert_eq!(
        first.uvs.as_ref().unwrap().corners(0).unwrap()[1].to_array(),
        [2.0, 0.0]
    );
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for end in ["\n", "\r\n", "\r"] {
            assert_eq!(load(&quad(format, end)).unwrap(), first, "{format} {end:?}");
        }
    }
}

#[test]
fn strips_are_triangles_that_face_one_way() {
    let strip = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n";
    let mesh = load(strip.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [0, 1, 2]]);
}

#[test]
fn whatever_is_cut_off_or_changed_ends_with_an_answer() {
    let mut rng = 12345u64;
    let mut below = |n: usize| {
        rng = rng
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (rng >> 33) as usize % n
    };
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let whole = quad(format, "\n");
        // The last of its numbers is not needed as text, where it is shortened.
        for end in 0..whole.len() - 1 {
            assert!(load(&whole[..end]).is_err(), "{format} up to {end}");
        }
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            for _ in 0..1 + below(4) {
                let at = below(bytes.len());
                bytes[at] = below(256) as u8;
            }
            if let Err(error) = load(&bytes) {
                assert!(!error.message.is_empty() && error.message.len() < 4096);
            }
        }
    }
}

#[test]
fn claims_take_neither_memory_nor_time() {
    let head = |count: &str, properties: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
             property float z\nelement face 4000000000\n{properties}end_header\n\0\0\0@\0\0\0\0"
        )
    };
    let list = "property list uint int vertex_indices\n";
    for (text, said) in [
        (
            head("4294967295", list),
            "the file ends at byte 186, in 'vertex' 1 of 4294967295",
        ),
        (
            head("0", list),
            "'vertex_indices' in 'face' 1 of 4000000000 is to have 1073741824 numbers, but there are at most 1, before byte 174",
        ),
        (head("0", ""), "no face of the file has an area"),
        (
            head("99999999999999999999999", list),
            "expected how many there are, found '99999999999999999999999'",
        ),
    ] {
        let message = load(text.as_bytes()).unwrap_err().message;
        let plain = |text: &str| {
            text.split(|c: char| c.is_ascii_digit())
                .next()
                .unwrap_or_default()
                .to_owned()
        };
        assert_eq!(plain(&message), plain(said), "{message}");
    }
}

/// A triangle with these properties of its vertices behind x, y and z, as text.
fn triangle(properties: &str, values: [&str; 3]) -> String {
    let head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let vertices: Vec<String> = ["0 0 0", "1 0 0", "0 1 0"]
        .iter()
        .zip(values)
        .map(|(at, values)| format!("{at} {values}\n"))
        .collect();
    let face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    format!("{head}{properties}{face}{}3 2 0 1\n", vertices.concat())
}

fn rgb(kind: &str, names: [&str; 3]) -> String {
    let [r, g, b] = names.map(|name| format!("property {kind} {name}\n"));
    format!("{r}{g}{b}")
}

#[test]
fn colors_follow_their_vertices() {
    let names = ["red", "green", "blue"];
    let colors = |properties: &str, values: [&str; 3]| {
        let mesh = load(triangle(properties, values).as_bytes()).unwrap();
        let colors = mesh.colors.unwrap();
        // Vertices stand in the order in which the faces use them.
        let corners = colors.corners(0).unwrap().map(|c| c.to_array());
        [corners[1], corners[2], corners[0]]
    };
    let half = crate::color::linear_from_srgb(51.0 / 255.0);
    let expected = [[1.0, 0.0, half], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let bytes = ["255 0 51", "0 255 0", "0 0 255"];
    assert_eq!(colors(&rgb("uchar", names), bytes), expected);
    // What is wider than it need be holds bytes all the same, but two bytes are two bytes.
    assert_eq!(colors(&rgb("int", names), bytes), expected);
    let wide = ["65535 0 13107", "0 65535 0", "0 0 65535"];
    assert_eq!(colors(&rgb("ushort", ["r", "g", "b"]), wide), expected);
    // Numbers that are no bytes are light as it is, and may be more than 1.
    let alpha = rgb("float", ["diffuse_red", "diffuse_green", "diffuse_blue"]) + "property float alpha\n";
    assert_eq!(
        colors(&alpha, ["0.25 0 1.5 1", "0 0 0 1", "0 1 0 0"]),
        [[0.25, 0.0, 1.5], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
    // A lone r may be a radius.
    let mesh = load(triangle("property float r\n", ["1", "2", "3"]).as_bytes()).unwrap();
    assert_eq!(mesh.colors, None);
}

#[test]
fn wrong_colors_are_refused_with_their_place() {
    let names = ["red", "green", "blue"];
    for (properties, last, line, wanted) in [
        (
            rgb("uchar", names),
            "0 256 0",
            15,
            "expected a number from 0 to 255 for 'green' in 'vertex' 3 of 3, found 256",
        ),
        (
            rgb("uchar", names),
            "0 0 -1",
            15,
            "expected a number from 0 to 255 for 'blue' in 'vertex' 3 of 3, found -1",
        ),
        (
            rgb("ushort", names),
            "65536 0 0",
            15,
            "expected a number from 0 to 65535 for 'red'",
        ),
        (
            rgb("float", names),
            "0 0 -0.01",
            15,
            "expected a number from 0 to 1000000 for 'blue'",
        ),
        (rgb("float", names), "0 nan 0", 15, "nan"),
        (
            rgb("uchar", names),
            "0 0",
            15,
            "'vertex' 3 of 3 has no value for 'blue'",
        ),
        (
            "property uchar red\nproperty uchar blue\n".to_owned(),
            "0 0",
            7,
            "the vertices have a property 'red', but none called 'green'; a color takes red, green and blue",
        ),
        (
            rgb("list uchar uchar", names),
            "1 0 1 0 1 0",
            7,
            "the vertices' property 'red' is a list; expected a number",
        ),
    ] {
        let error = load(triangle(&properties, ["0 0 0", "0 0 0", last]).as_bytes()).unwrap_err();
        assert!(error.message.contains(wanted), "{error}");
        assert_eq!(error.line, line, "{error}");
        assert_eq!(error.file.as_deref(), Some("a.ply"));
    }
}
