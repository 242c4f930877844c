//! OBJ meshes, their material libraries and textures, as they should be.

use std::sync::Arc;

use rtscript::{
    Builder, DVec3, Host, Limits, MemoryHost, Term,
    diag::ErrorKind,
    host::HostError,
    import::{AssetCache, Assets, load_obj, load_obj_shape},
    scene::{Material, MaterialId, Mesh, Texels, Texture},
};

use crate::pictures::png;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// What a file gives: its mesh, the builder with its materials, and the warnings.
pub(crate) struct Loaded {
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) builder: Builder,
    pub(crate) warnings: Vec<String>,
}

impl Loaded {
    fn material(&mut self, face: usize) -> Material {
        let id = self.mesh.face_materials[face];
        self.builder.snapshot().materials[id.index()].clone()
    }
}

pub(crate) fn try_load(host: &dyn Host, path: &str) -> Result<Loaded, rtscript::diag::Diagnostic> {
    let mut builder = Builder::new();
    let (limits, mut cache) = (Limits::default(), AssetCache::default());
    let mesh = load_obj(path, &mut Assets::new(host, &limits, &mut cache), &mut builder)?;
    let warnings = builder.take_warnings().iter().map(ToString::to_string).collect();
    Ok(Loaded {
        mesh,
        builder,
        warnings,
    })
}

fn load(text: &str) -> Loaded {
    let host = MemoryHost::new().with("a.obj", text);
    try_load(&host, "a.obj").unwrap_or_else(|e| panic!("{e}"))
}

fn load_with(obj: &str, mtl: &str) -> Loaded {
    let host = MemoryHost::new()
        .with("m/a.obj", format!("mtllib a.mtl\n{SQUARE}{obj}"))
        .with("m/a.mtl", mtl)
        .with("m/red.png", png(2, 1, &[[255, 0, 0], [128, 0, 0]]));
    try_load(&host, "m/a.obj").unwrap_or_else(|e| panic!("{e}"))
}

/// The material of a file with this MTL text for the material `a`.
fn look(mtl: &str) -> Material {
    let mut loaded = load_with("usemtl a\nf 1 2 3\n", &format!("newmtl a\n{mtl}"));
    assert_eq!(loaded.warnings, [""; 0]);
    loaded.material(0)
}

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect()
}

#[test]
fn indices_count_from_one_or_back_from_the_last() {
    let wanted = [[DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]];
    for face in ["f 1 2 3", "f -4 -3 -2", "f 1 -3 +3", "fo 1// 2/ 3"] {
        let loaded = load(&format!("{SQUARE}{face}\n"));
        assert_eq!(corners(&loaded.mesh), wanted, "{face}");
        assert_eq!((&loaded.mesh.normals, &loaded.mesh.uvs), (&None, &None));
        assert!(loaded.mesh.face_materials.is_empty());
        assert_eq!(loaded.warnings, [""; 0]);
    }
    // Relative indices count back from where they stand, and a face may come before its vertices.
    let loaded = load("v 9 9 9\nv 0 0 0\nv 1 0 0\nf 2 3 4\nv 0 1 0\nf -3 -2 -1\n");
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 1, 2]]);
}

#[test]
fn normals_and_texture_coordinates_have_indices_of_their_own() {
    let loaded = load(&format!(
        "{SQUARE}vt .25 .5\nvt 1\nvt 0 1 9\nvn 0 0 1\nvn 0 1 1\nf 1/3/1 2/2/1 3/1/2 4/3/2\n"
    ));
    let mesh = &loaded.mesh;
    assert_eq!(mesh.triangles.len(), 2);
    let uvs = mesh.uvs.as_ref().unwrap();
    let uv = uvs.corners(0).unwrap().map(|uv| uv.to_array());
    assert_eq!(uv, [[0.0, 1.0], [1.0, 0.0], [0.25, 0.5]]);
    let normals = mesh.normals.as_ref().unwrap();
    assert_eq!(
        normals.corners(0).unwrap(),
        [DVec3::Z, DVec3::Z, DVec3::new(0.0, 1.0, 1.0)]
    );
    assert!(normals.values.iter().all(|n| n.is_finite()));
    assert!(uvs.values.iter().all(|uv| uv.is_finite()));
}

#[test]
fn a_face_with_a_bare_corner_is_flat_and_its_neighbours_stay_smooth() {
    let loaded = load(&format!(
        "{SQUARE}vn 0 0 1\nvn 0 0 0\nvt 1 1\nf 1//1 2//1 3//1\nf 1 3//1 4//1\nf 1//1 3//2 4//1\nf 1/1 3/1 4/1\nf 2//1 3//1 4//1\n"
    ));
    let normals = loaded.mesh.normals.as_ref().unwrap();
    let smooth: Vec<bool> = (0..5).map(|i| normals.corners(i).is_some()).collect();
    assert_eq!(smooth, [true, false, false, false, true]);
    let uvs = loaded.mesh.uvs.as_ref().unwrap();
    let has_uv: Vec<bool> = (0..5).map(|i| uvs.corners(i).is_some()).collect();
    assert_eq!(has_uv, [false, false, false, true, false]);
    assert_eq!(loaded.warnings, [""; 0]);
}

#[test]
fn polygons_become_triangles_of_the_same_area() {
    let loaded = load("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\nf 1 2 4 5\n");
    let area = |c: &[DVec3; 3]| (c[1] - c[0]).cross(c[2] - c[0]).z / 2.0;
    let areas: Vec<f64> = corners(&loaded.mesh).iter().map(area).collect();
    assert_eq!(areas.len(), 5);
    assert!(areas.iter().all(|a| *a > 0.0), "{areas:?}");
    assert_eq!(areas.iter().sum::<f64>(), 9.0);
}

#[test]
fn files_come_in_every_shape_of_text() {
    let wanted = load(&format!("{SQUARE}f 1 2 3 4\n")).mesh;
    let crlf = format!("{SQUARE}f 1 2 3 4\n").replace('\n', "\r\n");
    let cr = crlf.replace('\n', "");
    for text in [
        crlf.as_str(),
        &cr,
        &format!("\u{feff}{SQUARE}f 1 2 3 4"),
        &format!("{SQUARE}f 1 2 \\\n  3 \\\r\n 4"),
        &format!("# x\\\n{SQUARE}\n\n  f  1\t2 3 4 # four\n#"),
        &format!("{SQUARE}o a b\ng\ng x y\ns off\ns 1\nf 1 2 3 4\nlod 3\n"),
    ] {
        assert_eq!(load(text).mesh.triangles, wanted.triangles, "{text:?}");
        assert_eq!(load(text).mesh.positions, wanted.positions, "{text:?}");
    }
    // Names in an encoding of long ago.
    let mut bytes = b"mtllib a.mtl\nusemtl caf\xe9\n".to_vec();
    bytes.extend(format!("{SQUARE}f 1 2 3\n").bytes());
    let host = MemoryHost::new()
        .with("a.obj", bytes)
        .with("a.mtl", b"newmtl caf\xe9\nKd 1 0 0\n");
    assert_eq!(try_load(&host, "a.obj").unwrap().mesh.face_materials.len(), 1);
}

#[test]
fn weights_divide_and_colors_are_left_out() {
    let loaded = load("v 2 4 6 2\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0 1\nf 1 2 3\n");
    assert_eq!(loaded.mesh.positions[0], DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        loaded.warnings,
        ["a.obj:2:1: warning: the 2 vertex colors are not used"]
    );
}

#[test]
fn what_is_not_drawn_is_said_once() {
    let loaded = load(&format!(
        "{SQUARE}l 1 2\np 1\nl 1 2 3\nf 1 2 2\nf 1 1 1 1\nf 1 2 3\ncstype bezier\nsurf 0 1 0 1 1 2 3\nend\n"
    ));
    assert_eq!(loaded.mesh.triangles.len(), 1);
    assert_eq!(
        loaded.warnings,
        [
            "a.obj:8:1: warning: 2 faces without area are left out, this is the first",
            "a.obj:5:1: warning: 3 lines and points are left out: only faces are drawn",
            "a.obj:12:1: warning: 1 curve or surface is left out: only faces are drawn\n  help: export the model as polygons",
        ]
    );
}

#[test]
fn faces_know_their_materials() {
    let mut loaded = load_with(
        "f 1 2 3\nusemtl red one\nf 1 2 4\ng other\nf 2 3 4\nusemtl blue\nf 1 3 4\n",
        "newmtl red one\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl never\nmap_Kd missing.png\n",
    );
    let ids = &loaded.mesh.face_materials;
    assert_eq!(ids[0], MaterialId::INHERIT);
    assert_eq!(ids[1], ids[2]);
    assert_ne!(ids[1], ids[3]);
    assert_eq!(loaded.material(1).diffuse, Term::color(DVec3::X));
    assert_eq!(loaded.material(3).diffuse, Term::color(DVec3::Z));
    assert_eq!(loaded.warnings, [""; 0]);
}

#[test]
fn a_missing_library_is_an_error_unless_materials_are_not_wanted() {
    let host = MemoryHost::new().with("m/a.obj", format!("mtllib a b.mtl\n{SQUARE}usemtl x\nf 1 2 3\n"));
    let error = try_load(&host, "m/a.obj").err().unwrap();
    assert_eq!(
        error.to_string(),
        "m/a.obj:1:8: error: cannot read 'm/a b.mtl': no such file\n  \
         help: mesh(\"m/a.obj\", #{ materials: false }) takes the shape without its materials"
    );
    let (mut builder, limits, mut cache) = (Builder::new(), Limits::default(), AssetCache::default());
    let mut assets = Assets::new(&host, &limits, &mut cache);
    let mesh = load_obj_shape("m/a.obj", &mut assets, &mut builder).unwrap();
    assert!(mesh.face_materials.is_empty());
    assert!(builder.take_warnings().is_empty());
}

/// An L of six corners, from every corner on and both ways round: a fan would cover the notch.
#[test]
fn concave_polygons_keep_their_notch() {
    let corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];
    let vertices: String = corners.iter().map(|(x, y)| format!("v {x} {y} 0\n")).collect();
    for start in 0..6 {
        for backwards in [false, true] {
            let mut order: Vec<usize> = (0..6).map(|i| (start + i) % 6 + 1).collect();
            if backwards {
                order.reverse();
            }
            let face: Vec<String> = order.iter().map(ToString::to_string).collect();
            let mesh = load(&format!("{vertices}f {}\n", face.join(" "))).mesh;
            let areas: Vec<f64> = (0..mesh.triangles.len())
                .map(|i| mesh.corners(i))
                .map(|[a, b, c]| (b - a).cross(c - a).z / 2.0)
                .collect();
            let sign = if backwards { -1.0 } else { 1.0 };
            assert!(
                areas.iter().all(|area| area * sign > 0.0),
                "{start} {backwards}: {areas:?}"
            );
            assert!((areas.iter().sum::<f64>() * sign - 3.0).abs() < 1e-12);
        }
    }
}

#[test]
fn unknown_materials_are_said_once_with_the_nearest_name() {
    let loaded = load_with(
        "usemtl rde\nf 1 2 3\nusemtl x\nf 1 2 4\nusemtl rde\nf 2 3 4\n",
        "newmtl red\nKd 1 0 0\n",
    );
    assert!(loaded.mesh.face_materials.is_empty());
    assert_eq!(
        loaded.warnings,
        [
            "m/a.obj:6:1: warning: no material is called 'rde', nor 1 more that usemtl names\n  help: did you mean 'red'?"
        ]
    );
    let loaded = load(&format!("{SQUARE}usemtl red\nf 1 2 3\n"));
    assert_eq!(
        loaded.warnings,
        [
            "a.obj:5:1: warning: no material is called 'red'\n  help: a line 'mtllib file.mtl' names the file with the materials"
        ]
    );
}

#[test]
fn several_libraries_on_one_line() {
    let host = MemoryHost::new()
        .with(
            "a.obj",
            format!("mtllib a.mtl b.MTL\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"),
        )
        .with("a.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 1 0 0\n")
        .with("b.MTL", "newmtl b\nKd 0 1 0\n");
    let mut loaded = try_load(&host, "a.obj").unwrap();
    assert_eq!(loaded.material(0).diffuse, Term::color(DVec3::X));
    assert_eq!(loaded.material(1).diffuse, Term::color(DVec3::Y));
}

#[test]
fn the_ambient_term_is_the_share_that_the_diffuse_color_allows() {
    let ambient = |mtl: &str| {
        look(mtl)
            .ambient
            .color
            .to_array()
            .map(|x| (x * 1e6).round() / 1e6)
    };
    assert_eq!(
        ambient("Ka 1 1 1\nKd .5 0 1\n"),
        [0.1, 0.0, 0.2],
        "what most exporters write"
    );
    assert_eq!(
        ambient("Ka .5 0 1\nKd .5 0 1\n"),
        [0.1, 0.0, 0.2],
        "what the others write"
    );
    assert_eq!(ambient("Kd .5 0 1\n"), [0.1, 0.0, 0.2]);
    assert_eq!(
        ambient("Ka 0\nKd .5 0 1\n"),
        [0.0; 3],
        "black shadows are a choice"
    );
    assert_eq!(ambient("Ka .1 .1 .1\nKd .5 0 1\n"), [0.02, 0.0, 0.02]);
    assert_eq!(ambient("d .5\nKd 1 1 1\n"), [0.1; 3]);
}

#[test]
fn the_same_file_under_the_same_ambient_light_is_read_once() {
    let host = MemoryHost::new()
        .with("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3\n"))
        .with("a.mtl", "newmtl a\nKd 1 1 1\n");
    let (limits, mut cache, mut builder) = (Limits::default(), AssetCache::default(), Builder::new());
    let mut load = |path: &str, ambient: f64| {
        builder.material_mut().ambient = Term::color(DVec3::splat(ambient));
        let mesh = load_obj(path, &mut Assets::new(&host, &limits, &mut cache), &mut builder).unwrap();
        let scene = builder.snapshot();
        let material = &scene.materials[mesh.face_materials[0].index()];
        (Arc::clone(&mesh), material.ambient.color.x, cache.files())
    };
    let (first, ka, files) = load("a.obj", 0.2);
    assert_eq!((ka, files), (0.2, 2));
    let (second, _, files) = load("./a.obj", 0.2);
    assert!(Arc::ptr_eq(&first, &second));
    assert_eq!(files, 2);
    let (third, ka, files) = load("a.obj", 0.05);
    assert!(!Arc::ptr_eq(&first, &third));
    assert_eq!((ka, files), (0.05, 4));
}

#[test]
fn only_mirrors_mirror() {
    let plain = look("Ks .5 .5 .5\nNs 96\n");
    assert_eq!(plain.specular, Term::color(DVec3::splat(0.5)));
    assert_eq!(plain.shininess, 96.0);
    assert!(plain.mirror().is_black());
    assert!(look("Ks .5 .5 .5\nillum 2\n").mirror().is_black());
    let mirror = look("Ks .5 .5 .5\nillum 3\n");
    assert_eq!(mirror.mirror(), mirror.specular);
    assert!(look("Ks .5 .5 .5\nillum 1\n").specular.is_black());
    let bare = look("Ns 3\n");
    assert_eq!(bare.diffuse, Term::color(DVec3::splat(0.8)));
    assert!(bare.specular.is_black() && bare.emission.is_black() && bare.transmission.is_black());
    assert_eq!(
        look("Ke 1 2 3\n").emission,
        Term::color(DVec3::new(1.0, 2.0, 3.0))
    );
}

#[test]
fn dissolved_materials_let_light_through() {
    let half = look("Kd 1 1 1\nd .25\nNi 1.3\n");
    assert_eq!(half.transmission, Term::color(DVec3::splat(0.75)));
    assert_eq!(half.diffuse, Term::color(DVec3::splat(0.25)));
    assert_eq!(half.ior, 1.0, "without glass nothing bends");
    assert_eq!(look("d .25\nNi 1.3\nillum 4\n").ior, 1.3);
    assert_eq!(look("d .25\nillum 6\n").ior, 1.5);
    assert_eq!(look("Tr .25\n").transmission, Term::color(DVec3::splat(0.25)));
    assert!(
        look("Tr 1\nd 1\n").transmission.is_black(),
        "d is the one that exporters agree on"
    );
}

#[test]
fn maps_multiply_their_colors() {
    let mut loaded = load_with(
        "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n",
        "newmtl a\nKd .5 .5 .5\nmap_Kd red.png\nmap_Ks .\\red.png\nKs 1 1 1\nmap_Ke red.png\n\
         newmtl b\nmap_Kd -clamp off red.png\n",
    );
    assert_eq!(loaded.warnings, [""; 0]);
    let (a, b) = (loaded.material(0), loaded.material(1));
    let scene = loaded.builder.snapshot();
    assert_eq!(scene.textures.len(), 1, "one file is one texture");
    assert_eq!(a.diffuse.color, DVec3::splat(0.5));
    assert_eq!(a.ambient.texture, a.diffuse.texture);
    assert_eq!(a.specular.texture, a.diffuse.texture);
    assert_eq!(
        (a.emission.color, a.emission.texture),
        (DVec3::ONE, a.diffuse.texture)
    );
    assert_eq!(
        (b.diffuse.color, b.diffuse.texture),
        (DVec3::ONE, a.diffuse.texture)
    );
    let Texture::Image(image) = &*scene.textures[0] else {
        panic!("{:?}", scene.textures[0])
    };
    assert_eq!((image.width, image.height), (2, 1));
    assert_eq!(image.texels, Texels::Srgb8(vec![[255, 0, 0], [128, 0, 0]]));
}

#[test]
fn unused_parts_of_a_library_are_said_once() {
    let loaded = load_with(
        "usemtl a\nf 1 2 3\n",
        "newmtl a\nTf 1 1 1\nPr .5\nmap_Bump b.png\nbump b.png\nmap_Kd -s 2 2 1 red.png\nfoo 1 2\n",
    );
    assert_eq!(
        loaded.warnings,
        [
            "m/a.mtl:4:1: warning: 2 textures of this and other kinds are not used: only map_Kd, map_Ka, map_Ks and map_Ke are",
            "m/a.mtl:6:8: warning: 1 texture option is not used: the texture is laid as it is",
            "m/a.mtl:7:1: warning: 1 unknown MTL statement is left out",
        ]
    );
}

#[test]
fn warnings_leave_the_callers_place_alone() {
    let host = MemoryHost::new().with("a.obj", format!("{SQUARE}l 1 2\nf 1 2 3\n"));
    let (limits, mut cache, mut builder) = (Limits::default(), AssetCache::default(), Builder::new());
    let file = builder.file("a.rhai");
    let loc = rtscript::diag::SourceLoc {
        line: 3,
        column: 5,
        file,
    };
    builder.set_loc(loc);
    load_obj(
        "a.obj",
        &mut Assets::new(&host, &limits, &mut cache),
        &mut builder,
    )
    .unwrap();
    assert_eq!(builder.loc(), loc);
    assert_eq!(builder.take_warnings()[0].file.as_deref(), Some("a.obj"));
}

#[test]
fn a_large_file_is_read_in_one_pass() {
    let n = 200;
    let mut text = String::new();
    for i in 0..n * n {
        text += &format!("v {} {} 0\nvt {} 0\n", i % n, i / n, i % 7);
    }
    for i in 0..(n - 1) * (n - 1) {
        let a = i / (n - 1) * n + i % (n - 1) + 1;
        text += &format!(
            "usemtl m{}\nf {a}/{a} {}/{a} {}/{a} {}/{a}\n",
            i % 3000,
            a + 1,
            a + n + 1,
            a + n
        );
    }
    let loaded = load(&text);
    assert_eq!(loaded.mesh.triangles.len(), 2 * (n - 1) * (n - 1));
    assert_eq!(loaded.mesh.positions.len(), n * n);
    assert_eq!(loaded.warnings.len(), 1);
}

/// A host whose owner has lost patience.
struct Impatient(MemoryHost);

impl Host for Impatient {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.0.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        true
    }
}

#[test]
fn reading_stops_when_the_host_asks() {
    let host = Impatient(MemoryHost::new().with("a.obj", format!("{SQUARE}f 1 2 3\n")));
    let error = try_load(&host, "a.obj").err().unwrap();
    assert_eq!(error.kind, ErrorKind::Cancelled);
}
