//! Wavefront OBJ meshes with their materials.

mod materials;

use std::{borrow::Cow, ops::Range, sync::Arc};

use self::materials::materials;
pub(super) use self::materials::set_materials;

use super::{
    assembly,
    assets::Assets,
    gltf,
    guard::{self, Checked, Corner, Ignored},
    kept::{Obj, OwnedNames},
    ply, stl,
    text::{Source, counted},
    wavefront::{self, warn_at},
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::{DVec2, DVec3},
    scene::{Builder, Mesh},
};

/// Reads the OBJ file `path` with the material libraries and textures it names, all through the host.
///
/// Objects and groups become one mesh. Faces of more than three corners are cut into triangles, concave ones too.
/// A face is smooth where all its corners have normals, whatever `s` says, and flat elsewhere; a normal of length
/// zero is none. A face without `usemtl` looks as the object that places the mesh ([`MaterialId::INHERIT`](crate::scene::MaterialId::INHERIT)).
/// The ambient term of an MTL material is its Ka, at most its Kd, times the current ambient color; so the same
/// `Arc` comes back for the same path under the same ambient color.
///
/// Warnings go to the builder, at their place in the file: faces without area, which are left out; lines, points,
/// curves and vertex colors; a material that no library has, whose faces look as those without.
///
/// # Errors
/// With file, line and column where the file or a library is malformed, where a library or a texture cannot be
/// read, where a name leads outside the host's folder, or where a limit is passed. Where the file itself cannot be
/// read the error has no place: it belongs to the call that names the file.
///
/// ```
/// # use rtscript::{Builder, Limits, MemoryHost, import::{AssetCache, Assets, load_obj}};
/// let host = MemoryHost::new()
///     .with("card.obj", "mtllib card.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
///     .with("card.mtl", "newmtl red\nKd 1 0 0\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// let mesh = load_obj("card.obj", &mut assets, &mut Builder::new()).map_err(rtscript::Error::from)?;
/// assert_eq!((mesh.positions.len(), mesh.face_materials.len()), (3, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load_obj(path: &str, assets: &mut Assets<'_>, builder: &mut Builder) -> Result<Arc<Mesh>, Diagnostic> {
    load(path, true, Kinds::Obj, assets, builder)
}

/// As [`load_obj`], without the file's materials: all faces look as the object that places the mesh, and no
/// library is read.
///
/// # Errors
/// As [`load_obj`].
///
/// ```
/// # use rtscript::{Builder, Limits, MemoryHost, import::{AssetCache, Assets, load_obj_shape}};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// let mesh = load_obj_shape("card.obj", &mut assets, &mut Builder::new()).map_err(rtscript::Error::from)?;
/// // It takes the material of the moment.
/// assert!(mesh.face_materials.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load_obj_shape(
    path: &str,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    load(path, false, Kinds::Obj, assets, builder)
}

/// Reads a mesh from a file of any kind that is known: an OBJ file as [`load_obj`] does, a PLY file (ascii or binary, with
/// normals and texture coordinates), an STL file (ascii or binary, flat) or a glTF 2.0 file (`.gltf` or `.glb`). Which it is, is
/// told by how the file begins, and where that says nothing by the ending of its name.
///
/// Of a glTF file the meshes of its scene become one, each where its node stands, in the pose that the nodes have: skins, morph
/// targets and animations are warned of. Its materials become terms of ours: what is no metal has a diffuse color under a mirror
/// by Fresnel's equations, metals a conductor of their color, or where metal and other things alternate by a texture, a mirror
/// that is the same at all angles; roughness, relief, emission, varnish, glass, and transparency by `alphaMode`.
///
/// # Errors
/// As [`load_obj`]; where a file is binary, the message names the byte, and of a glTF file the way to what is wrong, as
/// `meshes[3].primitives[0]`.
///
/// ```
/// # use rtscript::{Builder, Limits, MemoryHost, import::{AssetCache, Assets, load_mesh}};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// let mut b = Builder::new();
/// assert!(load_mesh("card.obj", &mut assets, &mut b).is_ok());
/// assert!(load_mesh("card.doc", &mut assets, &mut b).is_err());
/// ```
pub fn load_mesh(
    path: &str,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    load(path, true, Kinds::All, assets, builder)
}

/// As [`load_mesh`], without the file's materials.
///
/// # Errors
/// As [`load_mesh`].
///
/// ```
/// # use rtscript::{Builder, Limits, MemoryHost, import::{AssetCache, Assets, load_mesh_shape}};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// assert!(load_mesh_shape("card.obj", &mut assets, &mut Builder::new()).is_ok());
/// ```
pub fn load_mesh_shape(
    path: &str,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    load(path, false, Kinds::All, assets, builder)
}

/// The faces of a file as they stand there, not cut into triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    /// Corners.
    pub positions: Vec<DVec3>,
    /// Corners of each face as indices into `positions`.
    pub faces: Vec<Vec<u32>>,
    /// Texture coordinates of each face, one for each of its corners or none; empty where no face has any.
    pub uvs: Vec<Vec<DVec2>>,
}

/// The faces of an OBJ file, with their texture coordinates where all corners of a face have them. Nothing else of the file is
/// used.
///
/// # Errors
/// As [`load_obj`].
///
/// ```
/// # use rtscript::{Limits, MemoryHost, import::{AssetCache, Assets, Polygons, load_polygons}};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// let Polygons { faces, .. } = load_polygons("card.obj", &mut assets).map_err(rtscript::Error::from)?;
/// assert_eq!(faces, [[0, 1, 2, 3]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load_polygons(path: &str, assets: &mut Assets<'_>) -> Result<Polygons, Diagnostic> {
    let bytes = assets.read(path)?;
    let text = wavefront::text(path, &bytes)?;
    let source = Source::new(path, &text, ErrorKind::Input);
    let checked = guard::check(&source, assets)?;
    let mut polygons = Polygons::default();
    let mut start = 0;
    for face in &checked.faces {
        let corners = checked.corners.get(start..face.end).unwrap_or(&[]);
        start = face.end;
        polygons
            .faces
            .push(corners.iter().map(|corner| corner.position).collect());
        let uv = |corner: &Corner| checked.uvs.get(corner.uv as usize).copied();
        polygons
            .uvs
            .push(corners.iter().map(uv).collect::<Option<_>>().unwrap_or_default());
    }
    if polygons.uvs.iter().all(Vec::is_empty) {
        polygons.uvs = Vec::new();
    }
    polygons.positions = checked.positions;
    Ok(polygons)
}

/// Kinds of files that are taken.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kinds {
    Obj,
    All,
}

/// What reads a file of triangles alone, without materials.
type Reader = fn(&str, &[u8], &Assets<'_>, &mut Builder) -> Result<Mesh, Diagnostic>;

/// The reader of a file that is no OBJ file.
fn reader(path: &str, bytes: &[u8]) -> Option<Reader> {
    let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending);
    let is = |wanted: &str| ending.eq_ignore_ascii_case(wanted);
    if ply::is_ply(bytes) || is("ply") {
        Some(ply::read)
    } else if is("stl") || (!is("obj") && stl::is_stl(bytes)) {
        Some(stl::read)
    } else {
        None
    }
}

/// The mesh of a file without materials.
fn plain_mesh(
    path: &str,
    bytes: &[u8],
    read: Reader,
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<(Arc<Mesh>, Option<Obj>), Diagnostic> {
    let before = builder.warnings().len();
    let mesh = Arc::new(read(path, bytes, assets, builder)?);
    let kept = assets.kept().map(|_| Obj {
        with_materials: false,
        mesh: Arc::clone(&mesh),
        slots: Vec::new(),
        ids: Vec::new(),
        names: Names::default().owned(""),
        warnings: builder.warnings().get(before..).unwrap_or_default().to_vec(),
    });
    Ok((mesh, kept))
}

fn load(
    path: &str,
    with_materials: bool,
    kinds: Kinds,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    let light = with_materials.then(|| builder.material().ambient.color.to_array());
    if let Some(mesh) = assets.known_mesh(path, light) {
        return Ok(mesh);
    }
    let bytes = assets.read(path)?;
    if kinds == Kinds::All && gltf::is_gltf(path, &bytes) {
        let mesh = gltf::load(path, bytes, with_materials, assets, builder)?;
        assets.keep_mesh(path, light, &mesh);
        return Ok(mesh);
    }
    let plain = reader(path, &bytes).filter(|_| kinds == Kinds::All);
    let known = assets
        .kept()
        .and_then(|kept| kept.obj(path, with_materials && plain.is_none(), &bytes, assets.limits()));
    let mesh = match known {
        Some(known) if plain.is_some() => {
            builder.repeat_warnings(&known.warnings);
            Arc::clone(&known.mesh)
        }
        Some(known) => mesh_again(path, &known, &bytes, assets, builder)?,
        None => {
            let (mesh, obj) = match plain {
                Some(read) => plain_mesh(path, &bytes, read, assets, builder)?,
                None => first_mesh(path, with_materials, &bytes, assets, builder)?,
            };
            if let (Some(obj), Some(kept)) = (obj, assets.kept()) {
                kept.keep_obj(path, bytes, assets.limits(), obj);
            }
            mesh
        }
    };
    if plain.is_some() && mesh.colors.is_some() && !builder.shows_vertex_colors() {
        let source = Source::new(path, "", ErrorKind::Input);
        let message = "the colors of the vertices are not used".to_owned();
        let hint = "diffuse(vertexColors()) before it shows them";
        warn_at(&source, source.text, builder, message, Some(hint));
    }
    assets.keep_mesh(path, light, &mesh);
    Ok(mesh)
}

/// The mesh of a file that was not seen before, and what later runs need of the file, where any are to come.
fn first_mesh(
    path: &str,
    with_materials: bool,
    bytes: &[u8],
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<(Arc<Mesh>, Option<Obj>), Diagnostic> {
    let text = wavefront::text(path, bytes)?;
    let source = Source::new(path, &text, ErrorKind::Input);
    let mut checked = guard::check(&source, assets)?;
    if checked.faces.is_empty() {
        let error = Diagnostic::error(ErrorKind::Input, "the file has no faces").at(path, 0, 0);
        return Err(error.hint("a mesh is made of f lines; lines, points and curves are not drawn"));
    }
    let names = if with_materials {
        Names::of(&mut checked)
    } else {
        checked.faces.iter_mut().for_each(|face| face.material = None);
        Names::default()
    };
    let ids = materials(&source, &names, assets, builder)?;
    let unused = std::mem::take(&mut checked.unused);
    let before = builder.warnings().len();
    let mut mesh = assembly::mesh(&source, checked, assets, builder)?;
    warn(&source, &unused, builder);
    let slots = assets.kept().map(|_| mesh.face_materials.clone());
    set_materials(&mut mesh, &ids);
    let mesh = Arc::new(mesh);
    let obj = slots.map(|slots| Obj {
        with_materials,
        mesh: Arc::clone(&mesh),
        slots,
        ids,
        names: names.owned(source.text),
        warnings: builder.warnings().get(before..).unwrap_or_default().to_vec(),
    });
    Ok((mesh, obj))
}

/// The mesh of a file that an earlier run has read: only its materials are looked up anew.
fn mesh_again(
    path: &str,
    known: &Obj,
    bytes: &[u8],
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    let text = wavefront::text(path, bytes)?;
    let source = Source::new(path, &text, ErrorKind::Input);
    let names = Names::again(&known.names, source.text);
    let ids = materials(&source, &names, assets, builder)?;
    builder.repeat_warnings(&known.warnings);
    if ids == known.ids {
        return Ok(Arc::clone(&known.mesh));
    }
    let mut mesh = Mesh::clone(&known.mesh);
    mesh.face_materials.clone_from(&known.slots);
    set_materials(&mut mesh, &ids);
    Ok(Arc::new(mesh))
}

/// The names in a file that lead to materials.
#[derive(Default)]
struct Names<'a> {
    /// As [`Checked::libraries`].
    libraries: Vec<(Cow<'a, str>, &'a str)>,
    /// As [`Checked::materials`].
    materials: Vec<(Cow<'a, str>, &'a str)>,
    /// Whether a face has the material.
    is_used: Vec<bool>,
}

impl<'a> Names<'a> {
    fn of(checked: &mut Checked<'a>) -> Self {
        let mut is_used = vec![false; checked.materials.len()];
        for slot in checked.faces.iter().filter_map(|face| face.material) {
            if let Some(used) = is_used.get_mut(slot as usize) {
                *used = true;
            }
        }
        Self {
            libraries: std::mem::take(&mut checked.libraries),
            materials: std::mem::take(&mut checked.materials),
            is_used,
        }
    }

    /// With places in `text` in place of slices of it.
    fn owned(&self, text: &str) -> OwnedNames {
        let place = |at: &str| {
            let start = at.as_ptr() as usize - text.as_ptr() as usize;
            start..start + at.len()
        };
        let all = |names: &[(Cow<'_, str>, &str)]| {
            let owned = names
                .iter()
                .map(|(name, at)| (name.clone().into_owned(), place(at)));
            owned.collect()
        };
        OwnedNames {
            libraries: all(&self.libraries),
            materials: all(&self.materials),
            is_used: self.is_used.clone(),
        }
    }

    /// The other way round.
    fn again(names: &'a OwnedNames, text: &'a str) -> Self {
        let all = |names: &'a [(String, Range<usize>)]| {
            let slices = names.iter().map(|(name, place)| {
                let at = text.get(place.clone()).unwrap_or_default();
                (Cow::Borrowed(name.as_str()), at)
            });
            slices.collect()
        };
        Self {
            libraries: all(&names.libraries),
            materials: all(&names.materials),
            is_used: names.is_used.clone(),
        }
    }
}

/// What the file has and the mesh has not.
fn warn(source: &Source<'_>, checked: &Ignored<'_>, builder: &mut Builder) {
    let lines_and_points = |n| {
        format!(
            "{} left out: only faces are drawn",
            counted(n, "line or point is", "lines and points are")
        )
    };
    checked
        .lines_and_points
        .warn(source, builder, lines_and_points, None);
    let free_form = |n| {
        format!(
            "{} left out: only faces are drawn",
            counted(n, "curve or surface is", "curves and surfaces are")
        )
    };
    checked
        .free_form
        .warn(source, builder, free_form, Some("export the model as polygons"));
    let colors = |n| {
        format!(
            "the {} not used",
            counted(n, "vertex color is", "vertex colors are")
        )
    };
    checked.colors.warn(source, builder, colors, None);
}
