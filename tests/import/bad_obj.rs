//! OBJ and MTL files that are wrong as a whole, and no panic from any bytes at all. Wrong lines are in `tests/bad`.

use proptest::prelude::*;
use rtscript::{
    Builder, Limits, MemoryHost,
    diag::ErrorKind,
    import::{AssetCache, Assets, load_obj},
};

use crate::{obj::try_load, pictures::png};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn error_of(host: &MemoryHost) -> (ErrorKind, String) {
    let error = try_load(host, "a.obj").err().expect("an error");
    (error.kind, error.to_string())
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
    let wanted = "error: 'a.obj' is too large: the limit 'file_bytes' is 30";
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
