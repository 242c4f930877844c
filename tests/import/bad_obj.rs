//! OBJ and MTL files that are wrong: every fault with its place, and no panic from any bytes at all.

use proptest::prelude::*;
use rtscript::{
    Builder, ErrorKind, Limits, MemoryHost,
    import::{AssetCache, Assets, load_obj},
};

use crate::{obj::try_load, pictures::png};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn error_of(host: &MemoryHost) -> (ErrorKind, String) {
    let error = try_load(host, "a.obj").err().expect("an error");
    (error.kind, error.to_string())
}

#[test]
fn bad_obj_lines_say_where_and_what() {
    let cases: &[(&str, &str)] = &[
        // Vertices.
        (
            "v 0 0",
            "4:1: error: v takes 3 numbers (x y z), 4 (x y z w) or 6 (x y z r g b), not 2",
        ),
        (
            "v",
            "4:1: error: v takes 3 numbers (x y z), 4 (x y z w) or 6 (x y z r g b), not 0",
        ),
        (
            "v 0 0 0 1 1",
            "4:1: error: v takes 3 numbers (x y z), 4 (x y z w) or 6 (x y z r g b), not 5",
        ),
        (
            "v 0 0 0 1 1 1 1 1",
            "4:1: error: v takes 3 numbers (x y z), 4 (x y z w) or 6 (x y z r g b), not 8",
        ),
        (
            "v nan 0 0",
            "4:3: error: expected a number within 1e15, found 'nan'",
        ),
        (
            "v 0 inf 0",
            "4:5: error: expected a number within 1e15, found 'inf'",
        ),
        (
            "v 0 0 -infinity",
            "4:7: error: expected a number within 1e15, found '-infinity'",
        ),
        (
            "v 0 0 1e400",
            "4:7: error: expected a number within 1e15, found '1e400'",
        ),
        (
            "v 0 0 1e16",
            "4:7: error: expected a number within 1e15, found '1e16'",
        ),
        ("v 0 zero 0", "4:5: error: expected a number, found 'zero'"),
        ("v 1,5 0 0", "4:3: error: expected a number, found '1,5'"),
        (
            "v 0 0 0 0",
            "4:9: error: the vertex divided by its weight '0' is not within 1e15 of the origin",
        ),
        (
            "v 1 0 0 1e-300",
            "4:9: error: the vertex divided by its weight '1e-300' is not within 1e15 of the origin",
        ),
        ("v 0 0 0 red 0 0", "4:9: error: expected a number, found 'red'"),
        ("vt", "4:1: error: vt takes 1 to 3 numbers (u v [w]), not 0"),
        (
            "vt 0 0 0 0",
            "4:1: error: vt takes 1 to 3 numbers (u v [w]), not 4",
        ),
        (
            "vt 0 nan",
            "4:6: error: expected a number within 1e15, found 'nan'",
        ),
        ("vn 0 1", "4:1: error: vn takes 3 numbers (x y z), not 2"),
        ("vn 0 1 0 0", "4:1: error: vn takes 3 numbers (x y z), not 4"),
        ("vn 0 1 x", "4:8: error: expected a number, found 'x'"),
        // Faces.
        (
            "f",
            "4:1: error: f takes 3 or more corners (v, v/vt, v//vn or v/vt/vn), not 0",
        ),
        (
            "f 1 2",
            "4:1: error: f takes 3 or more corners (v, v/vt, v//vn or v/vt/vn), not 2",
        ),
        (
            "f 1 2 0",
            "4:7: error: expected the number of a vertex, counted from 1 or back from -1, found '0'",
        ),
        (
            "f 1 2 4",
            "4:7: error: there is no vertex 4: the file has 3 vertices",
        ),
        (
            "f 1 2 -4",
            "4:7: error: there is no vertex -4: 3 vertices come before this line",
        ),
        (
            "f 1 2 x",
            "4:7: error: expected the number of a vertex, counted from 1 or back from -1, found 'x'",
        ),
        (
            "f 1 2 3.0",
            "4:7: error: expected the number of a vertex, counted from 1 or back from -1, found '3.0'",
        ),
        (
            "f 1 2 99999999999999999999",
            "4:7: error: expected the number of a vertex, counted from 1 or back from -1, found '99999999999999999999'",
        ),
        (
            "f 1 2 6148914691236517207",
            "4:7: error: there is no vertex 6148914691236517207: the file has 3 vertices",
        ),
        (
            "f 1//6148914691236517207 2 3",
            "4:6: error: there is no normal 6148914691236517207: the file has 0 normals",
        ),
        (
            "f 1 2 -9223372036854775808",
            "4:7: error: there is no vertex -9223372036854775808: 3 vertices come before this line",
        ),
        (
            "f 1/1 2/1 3/1",
            "4:5: error: there is no texture coordinate 1: the file has 0 texture coordinates",
        ),
        (
            "vt 0 0\nf 1/1 2/2 3/1",
            "5:9: error: there is no texture coordinate 2: the file has 1 texture coordinate",
        ),
        (
            "vn 0 0 1\nf 1//1 2//-2 3//1",
            "5:11: error: there is no normal -2: 1 normal comes before this line",
        ),
        (
            "vn 0 0 1\nf 1//0 2//1 3//1",
            "5:6: error: expected the number of a normal, counted from 1 or back from -1, found '0'",
        ),
        (
            "f 1/2/3/4 2 3",
            "4:3: error: expected a corner like 1, 1/2, 1//3 or 1/2/3, found '1/2/3/4'",
        ),
        (
            "f /1 2 3",
            "4:3: error: expected a corner like 1, 1/2, 1//3 or 1/2/3, found '/1'",
        ),
        (
            "vt 0 0\nf /1 2 3",
            "5:3: error: expected a corner like 1, 1/2, 1//3 or 1/2/3, found '/1'",
        ),
        (
            "f // 2 3",
            "4:3: error: expected a corner like 1, 1/2, 1//3 or 1/2/3, found '//'",
        ),
        (
            "f 1 2 9\nf 1 2 8",
            "4:7: error: there is no vertex 9: the file has 3 vertices",
        ),
        (
            "f 1 2 5\nf 1 2 4\nv 0 0 0",
            "4:7: error: there is no vertex 5: the file has 4 vertices",
        ),
        (
            "f 1 2 \\\n9",
            "5:1: error: there is no vertex 9: the file has 3 vertices",
        ),
        // Names.
        (
            "usemtl",
            "4:1: error: usemtl takes the name of a material; it has none",
        ),
        (
            "mtllib",
            "4:1: error: mtllib takes the name of a file; it has none",
        ),
        // Keywords.
        (
            "usemlt red",
            "4:1: error: unknown OBJ keyword 'usemlt'\n  help: did you mean 'usemtl'?",
        ),
        (
            "ff 1 2 3",
            "4:1: error: unknown OBJ keyword 'ff'\n  help: is this a Wavefront OBJ file? its lines begin with v, vt, vn, f, o, g, s, usemtl, mtllib or #",
        ),
        (
            "<!DOCTYPE html>",
            "4:1: error: unknown OBJ keyword '<!DOCTYPE'\n  help: is this a Wavefront OBJ file? its lines begin with v, vt, vn, f, o, g, s, usemtl, mtllib or #",
        ),
        (
            "\u{7}bell",
            "4:1: error: unknown OBJ keyword '\\u{7}bell'\n  help: is this a Wavefront OBJ file? its lines begin with v, vt, vn, f, o, g, s, usemtl, mtllib or #",
        ),
    ];
    for (line, wanted) in cases {
        for ending in ["\n", "\r\n"] {
            let text = format!("{TRIANGLE}{line}\nf 1 2 3\n").replace('\n', ending);
            let (kind, message) = error_of(&MemoryHost::new().with("a.obj", text));
            assert_eq!(message, format!("a.obj:{wanted}"), "{line:?}");
            assert_eq!(kind, ErrorKind::Input, "{line:?}");
        }
    }
}

#[test]
fn whole_files_can_be_wrong() {
    let utf16: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain("v 0 0 0".encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let none =
        "the file has no faces\n  help: a mesh is made of f lines; lines, points and curves are not drawn";
    let cases: [(&[u8], &str); 6] = [
        (b"", none),
        (b"# nothing\n\n", none),
        (b"v 0 0 0\nv 1 0 0\nl 1 2\n", none),
        (
            b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 1\n",
            "no face of the file has an area",
        ),
        (&utf16, "the file is UTF-16 text; expected UTF-8"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "the file is not text"),
    ];
    for (bytes, wanted) in cases {
        let (kind, message) = error_of(&MemoryHost::new().with("a.obj", bytes));
        assert_eq!(
            (kind, message),
            (ErrorKind::Input, format!("a.obj: error: {wanted}"))
        );
    }
    // The file's own absence has the place of the call, which is not known here.
    let (kind, message) = error_of(&MemoryHost::new());
    assert_eq!(
        (kind, message.as_str()),
        (ErrorKind::Input, "error: cannot read 'a.obj': no such file")
    );
}

#[test]
fn bad_libraries_say_where_and_what() {
    let cases: &[(&str, &str)] = &[
        ("Kd 1 2", "2:1: error: Kd takes 3 numbers (r g b), not 2"),
        ("Ka", "2:1: error: Ka takes 3 numbers (r g b), not 0"),
        ("Ks 1 1 1 1", "2:1: error: Ks takes 3 numbers (r g b), not 4"),
        ("Ke 1 1", "2:1: error: Ke takes 3 numbers (r g b), not 2"),
        ("Kd 1 x 1", "2:6: error: expected a number, found 'x'"),
        (
            "Kd nan nan nan",
            "2:4: error: expected a number within 1e15, found 'nan'",
        ),
        (
            "Ka spectral a.rfl 1",
            "2:4: error: expected a color as 3 numbers (r g b), found 'spectral'",
        ),
        ("Ns", "2:1: error: Ns takes 1 number, not 0"),
        ("Ns -1", "2:4: error: expected a number of at least 0, found '-1'"),
        ("Ns shiny", "2:4: error: expected a number, found 'shiny'"),
        ("d 1.5", "2:3: error: expected a number from 0 to 1, found '1.5'"),
        ("d", "2:1: error: d takes 1 number, not 0"),
        ("d -halo", "2:3: error: expected a number, found '-halo'"),
        (
            "Tr -0.5",
            "2:4: error: expected a number from 0 to 1, found '-0.5'",
        ),
        ("Ni -1", "2:4: error: expected a number of at least 0, found '-1'"),
        ("Ni 1 2", "2:1: error: Ni takes 1 number, not 2"),
        ("illum two", "2:7: error: expected a number, found 'two'"),
        ("illum", "2:1: error: illum takes 1 number (0 to 10), not 0"),
        (
            "illum 2.5",
            "2:7: error: expected a whole number, 0 or greater, found '2.5'",
        ),
        (
            "newmtl",
            "2:1: error: newmtl takes the name of a material; it has none",
        ),
        (
            "map_Kd",
            "2:1: error: map_Kd takes the name of a picture file; it has none",
        ),
        (
            "map_Kd -clamp on",
            "2:1: error: map_Kd takes the name of a picture file; it has none",
        ),
        (
            "map_Kd -clamp",
            "2:8: error: the option -clamp of map_Kd lacks its value",
        ),
        (
            "map_Kd -s a.png",
            "2:8: error: the option -s of map_Kd lacks its value",
        ),
        (
            "map_Kd missing.png",
            "2:8: error: cannot read 't/missing.png': no such file",
        ),
        (
            "map_Kd text.png",
            "2:8: error: 't/text.png' is not a PNG or JPEG picture\n  help: convert the picture to PNG or JPEG",
        ),
        (
            "map_Kd  cut.png",
            "2:9: error: 't/cut.png' is a damaged PNG picture: unexpected end of file",
        ),
    ];
    for (line, wanted) in cases {
        let mut png = png(9, 9, &[[1, 2, 3]; 81]);
        png.truncate(png.len() - 20);
        let host = MemoryHost::new()
            .with("a.obj", format!("mtllib t/a.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\n"))
            .with("t/a.mtl", format!("newmtl a\n{line}\n"))
            .with("t/text.png", "hello")
            .with("t/cut.png", png);
        let (kind, message) = error_of(&host);
        assert_eq!(message, format!("t/a.mtl:{wanted}"), "{line:?}");
        assert_eq!(kind, ErrorKind::Input, "{line:?}");
    }
    let host = MemoryHost::new()
        .with("a.obj", format!("mtllib a.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\n"))
        .with("a.mtl", "# first\nKd 1 1 1\n");
    assert_eq!(
        error_of(&host).1,
        "a.mtl:2:1: error: 'Kd' stands before any newmtl\n  help: a material begins with: newmtl name"
    );
}

#[test]
fn nothing_outside_the_folder_is_read() {
    for (name, why) in [
        (
            "../a.mtl",
            "is outside the script's folder; only files below it can be read",
        ),
        (
            "..\\a.mtl",
            "is outside the script's folder; only files below it can be read",
        ),
        (
            "/etc/passwd",
            "is an absolute path; only files below the script's folder can be read",
        ),
        (
            "C:\\a.mtl",
            "is an absolute path; only files below the script's folder can be read",
        ),
    ] {
        let shown = name.replace('\\', "/");
        let host = MemoryHost::new().with("a.obj", format!("mtllib {name}\n{TRIANGLE}f 1 2 3\n"));
        let wanted = format!("a.obj:1:8: error: '{shown}' {why}");
        assert_eq!(error_of(&host), (ErrorKind::Denied, wanted));
        let host = MemoryHost::new()
            .with("a.obj", format!("mtllib a.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\n"))
            .with("a.mtl", format!("newmtl a\nmap_Kd {name}\n"));
        let wanted = format!("a.mtl:2:8: error: '{shown}' {why}");
        assert_eq!(error_of(&host), (ErrorKind::Denied, wanted));
    }
}

#[test]
fn names_without_end_are_cut_short() {
    let long = "x".repeat(100_000);
    let shown = "x".repeat(40);
    let host = MemoryHost::new()
        .with("a.obj", format!("mtllib a.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\n"))
        .with("a.mtl", format!("newmtl a\nmap_Kd {long}\n"));
    let wanted = format!("a.mtl:2:8: error: the file name '{shown}...' has more than 1024 bytes");
    assert_eq!(error_of(&host), (ErrorKind::Input, wanted));
    let host = MemoryHost::new()
        .with(
            "a.obj",
            format!("mtllib a.mtl\n{TRIANGLE}usemtl {long}\nf 1 2 3\n"),
        )
        .with("a.mtl", format!("newmtl y{long}\n"));
    let warnings = try_load(&host, "a.obj").unwrap().warnings;
    let wanted = format!(
        "a.obj:5:1: warning: no material is called '{shown}...'\n  help: its faces look as the object that places the mesh"
    );
    assert_eq!(warnings, [wanted]);
    let host = MemoryHost::new().with("a.obj", long);
    assert!(
        error_of(&host)
            .1
            .starts_with(&format!("a.obj:1:1: error: unknown OBJ keyword '{shown}...'\n"))
    );
}

#[test]
fn limits_hold_for_files_too() {
    let host = MemoryHost::new()
        .with("a.obj", format!("mtllib a.mtl\n{TRIANGLE}f 1 2 3\nf 1 2 3 1 2\n"))
        .with("a.mtl", "newmtl a\n");
    let limited = |limits: &Limits| {
        let mut cache = AssetCache::default();
        let mut assets = Assets::new(&host, limits, &mut cache);
        let error = load_obj("a.obj", &mut assets, &mut Builder::new()).unwrap_err();
        (error.kind, error.to_string())
    };
    let mut limits = Limits::default();
    limits.primitives = 3;
    let wanted = "a.obj:6:1: error: too many triangles: the limit 'primitives' is 3";
    assert_eq!(limited(&limits), (ErrorKind::Limit, wanted.to_owned()));
    limits = Limits::default();
    limits.files = 1;
    let wanted = "a.obj:1:8: error: 'a.mtl' is one file too many: the limit 'files' is 1";
    assert_eq!(limited(&limits), (ErrorKind::Limit, wanted.to_owned()));
    limits = Limits::default();
    limits.file_bytes = 30;
    let wanted = "error: 'a.obj' is larger than the limit of 30 bytes for one file";
    assert_eq!(limited(&limits), (ErrorKind::Limit, wanted.to_owned()));
}

/// Text that is nearly an OBJ or MTL file.
fn nearly(words: &'static [&'static str]) -> impl Strategy<Value = String> {
    let word = prop_oneof![
        6 => proptest::sample::select(words).prop_map(str::to_owned),
        4 => (-4i32..6).prop_map(|n| n.to_string()),
        1 => any::<f64>().prop_map(|x| x.to_string()),
        1 => "\\PC{0,6}",
    ];
    let end = proptest::sample::select(&["\n", "\n", "\r\n", "\r", " \\\n", "\n\n"][..]);
    let line = (proptest::collection::vec(word, 0..7), end);
    proptest::collection::vec(line, 0..20).prop_map(|lines| {
        let lines = lines.into_iter().map(|(words, end)| words.join(" ") + end);
        lines.collect()
    })
}

const OBJ_WORDS: &[&str] = &[
    "v",
    "vt",
    "vn",
    "f",
    "f 1 2 3",
    "v 1 2 3",
    "v 0 0 0",
    "vn 0 0 1",
    "vt 0 1",
    "l",
    "p",
    "usemtl",
    "usemtl a",
    "mtllib a.mtl",
    "o",
    "g",
    "s",
    "#",
    "1//1",
    "1/1/1",
    "-1/-1",
    "2/",
    "nan",
    "0",
    "1e300",
    "f 1 2 3 4",
];
const MTL_WORDS: &[&str] = &[
    "newmtl",
    "newmtl a",
    "Ka",
    "Kd",
    "Kd 1 2",
    "Ks",
    "Ke",
    "Ns",
    "d",
    "Tr",
    "Ni",
    "illum",
    "map_Kd",
    "-s",
    "-o",
    "-clamp",
    "on",
    "a.png",
    "bump",
    "#",
    "\"",
    "nan",
    "Kd 1 1 1",
    "map_Kd a.png",
    "Pr",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_file_is_a_fault_of_ours(obj in nearly(OBJ_WORDS), mtl in nearly(MTL_WORDS)) {
        let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl a\n{obj}");
        let host = MemoryHost::new().with("a.obj", obj).with("a.mtl", mtl).with("a.png", png(1, 1, &[[9; 3]]));
        match try_load(&host, "a.obj") {
            Err(error) => prop_assert!(
                matches!(error.kind, ErrorKind::Input | ErrorKind::Denied) && error.file.is_some(),
                "{error}"
            ),
            Ok(loaded) => {
                let mesh = &loaded.mesh;
                prop_assert!(!mesh.triangles.is_empty());
                prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
                for i in 0..mesh.triangles.len() {
                    let normals = mesh.normals.as_ref().and_then(|n| n.corners(i));
                    prop_assert!(normals.into_iter().flatten().all(|n| n.is_finite() && n.length() > 0.0));
                    let uvs = mesh.uvs.as_ref().and_then(|uvs| uvs.corners(i));
                    prop_assert!(uvs.into_iter().flatten().all(|uv| uv.is_finite()));
                }
            }
        }
    }

    #[test]
    fn no_bytes_are_a_fault_of_ours(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let host = MemoryHost::new().with("a.obj", bytes);
        if let Err(error) = try_load(&host, "a.obj") {
            prop_assert_eq!(error.kind, ErrorKind::Input);
        }
    }
}
