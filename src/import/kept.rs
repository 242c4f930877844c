//! Files that outlive a run: what was made of their bytes is there for the next run that reads the same bytes.
//!
//! A file is read again in every run, through the host and within the limits, so that a run with kept files does and
//! refuses what a run without does; only decoding and parsing are spared.

use std::{
    collections::BTreeSet,
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use crate::{
    diag::Diagnostic,
    limits::Limits,
    scene::{MaterialId, Mesh, Texture},
};

/// Bytes of files and what was made of them, together.
const MOST: usize = 512 << 20;

/// Meshes and textures kept from one run to the next, by path and content: up to 512 MiB, the longest unused go first.
/// Clones share what is kept.
///
/// ```
/// use rtscript::{MemoryHost, RunOptions, Script, import::KeptAssets};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// let script = Script::compile("a.rhai", r#"mesh("card.obj");"#, &Default::default())?;
/// let mut options = RunOptions::default();
/// let kept = KeptAssets::new();
/// options.assets = Some(kept.clone());
/// // The second run finds what the first one read.
/// script.run(&host, &options)?;
/// script.run(&host, &options)?;
/// assert_eq!(kept.counts(), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct KeptAssets(Arc<Mutex<Kept>>);

#[derive(Debug, Default)]
struct Kept {
    /// The longest unused first.
    files: Vec<File>,
    decoded: u64,
    reused: u64,
}

#[derive(Debug)]
struct File {
    path: String,
    bytes: Vec<u8>,
    /// What decides beside the bytes whether they are accepted.
    limits: (usize, u32, u64),
    made: Made,
}

#[derive(Clone, Debug)]
enum Made {
    Texture(Arc<Texture>),
    Obj(Arc<Obj>),
    Gltf(Arc<Gltf>),
}

/// What a glTF file holds: a mesh, and what must be looked up anew in each run.
#[derive(Debug)]
pub(super) struct Gltf {
    /// Whether its materials were read.
    pub(super) with_materials: bool,
    /// The mesh, with the materials of the run that made it.
    pub(super) mesh: Arc<Mesh>,
    /// For each face, which of the materials that are used it has.
    pub(super) slots: Vec<MaterialId>,
    /// The materials of that run.
    pub(super) ids: Vec<MaterialId>,
    /// The numbers of the file's materials that are used.
    pub(super) materials: Vec<usize>,
    /// Those of them that a primitive with colors has.
    pub(super) colored: BTreeSet<usize>,
    /// The files of its buffers and hashes of them.
    pub(super) files: Vec<(String, blake3::Hash)>,
    /// What was said of the file itself.
    pub(super) warnings: Vec<Diagnostic>,
}

/// What an OBJ file holds: a mesh, and what must be looked up anew in each run.
#[derive(Debug)]
pub(super) struct Obj {
    /// Whether its materials were read.
    pub(super) with_materials: bool,
    /// The mesh, with the materials of the run that made it.
    pub(super) mesh: Arc<Mesh>,
    /// For each face, which of the file's names of materials it has.
    pub(super) slots: Vec<MaterialId>,
    /// The materials of that run, name by name.
    pub(super) ids: Vec<MaterialId>,
    /// The names.
    pub(super) names: OwnedNames,
    /// What was said of the file itself.
    pub(super) warnings: Vec<Diagnostic>,
}

/// Names in a file that lead to materials, and where in its text they stand.
#[derive(Debug)]
pub(super) struct OwnedNames {
    /// The files that `mtllib` names.
    pub(super) libraries: Vec<(String, Range<usize>)>,
    /// What `usemtl` names.
    pub(super) materials: Vec<(String, Range<usize>)>,
    /// Whether a face has the material.
    pub(super) is_used: Vec<bool>,
}

impl KeptAssets {
    /// Nothing, so far.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Files that were decoded or parsed, and files for which that was spared, since the beginning.
    #[must_use]
    pub fn counts(&self) -> (u64, u64) {
        let kept = self.kept();
        (kept.decoded, kept.reused)
    }

    /// The texture that was made of these bytes of this file.
    pub(super) fn texture(&self, path: &str, bytes: &[u8], limits: &Limits) -> Option<Arc<Texture>> {
        self.find(path, bytes, limits, |made| match made {
            Made::Texture(texture) => Some(Arc::clone(texture)),
            _ => None,
        })
    }

    /// What was made of these bytes of an OBJ file.
    pub(super) fn obj(
        &self,
        path: &str,
        with_materials: bool,
        bytes: &[u8],
        limits: &Limits,
    ) -> Option<Arc<Obj>> {
        self.find(path, bytes, limits, |made| match made {
            Made::Obj(obj) if obj.with_materials == with_materials => Some(Arc::clone(obj)),
            _ => None,
        })
    }

    /// What was made of these bytes of a glTF file.
    pub(super) fn gltf(
        &self,
        path: &str,
        with_materials: bool,
        bytes: &[u8],
        limits: &Limits,
    ) -> Option<Arc<Gltf>> {
        self.find(path, bytes, limits, |made| match made {
            Made::Gltf(gltf) if gltf.with_materials == with_materials => Some(Arc::clone(gltf)),
            _ => None,
        })
    }

    fn find<T>(
        &self,
        path: &str,
        bytes: &[u8],
        limits: &Limits,
        of_kind: impl Fn(&Made) -> Option<T>,
    ) -> Option<T> {
        let mut kept = self.kept();
        let found = kept.files.iter().enumerate().find_map(|(index, file)| {
            let is_it = file.path == path && file.limits == that_count(limits) && file.bytes == bytes;
            Some((index, is_it.then(|| of_kind(&file.made))??))
        });
        let (index, made) = found?;
        kept.reused += 1;
        let file = kept.files.remove(index);
        kept.files.push(file);
        Some(made)
    }

    /// Keeps a texture.
    pub(super) fn keep_texture(&self, path: &str, bytes: Vec<u8>, limits: &Limits, texture: &Arc<Texture>) {
        self.keep(path, bytes, limits, Made::Texture(Arc::clone(texture)));
    }

    /// Keeps what was made of an OBJ file.
    pub(super) fn keep_obj(&self, path: &str, bytes: Vec<u8>, limits: &Limits, obj: Obj) {
        self.keep(path, bytes, limits, Made::Obj(Arc::new(obj)));
    }

    /// Keeps what was made of a glTF file.
    pub(super) fn keep_gltf(&self, path: &str, bytes: Vec<u8>, limits: &Limits, gltf: Gltf) {
        self.keep(path, bytes, limits, Made::Gltf(Arc::new(gltf)));
    }

    fn keep(&self, path: &str, bytes: Vec<u8>, limits: &Limits, made: Made) {
        let mut kept = self.kept();
        kept.decoded += 1;
        let same = |file: &File| match (&file.made, &made) {
            (Made::Obj(a), Made::Obj(b)) => a.with_materials == b.with_materials,
            (Made::Gltf(a), Made::Gltf(b)) => a.with_materials == b.with_materials,
            (Made::Texture(_), Made::Texture(_)) => true,
            _ => false,
        };
        kept.files.retain(|file| !(file.path == path && same(file)));
        kept.files.push(File {
            path: path.to_owned(),
            bytes,
            limits: that_count(limits),
            made,
        });
        let mut total: usize = kept.files.iter().map(File::size).sum();
        kept.files.retain(|file| {
            let stays = total <= MOST;
            if !stays {
                total -= file.size();
            }
            stays
        });
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl File {
    /// Bytes that it takes, roughly.
    fn size(&self) -> usize {
        self.bytes.len()
            + match &self.made {
                Made::Texture(texture) => match &**texture {
                    Texture::Image(image) => image.width as usize * image.height as usize * 3,
                    _ => 0,
                },
                Made::Obj(obj) => size_of_mesh(&obj.mesh, &obj.slots),
                Made::Gltf(gltf) => size_of_mesh(&gltf.mesh, &gltf.slots),
            }
    }
}

fn size_of_mesh(mesh: &Mesh, slots: &[MaterialId]) -> usize {
    let corners = 12 * mesh.triangles.len();
    let of_normals = mesh.normals.as_ref().map_or(0, |n| 24 * n.values.len() + corners);
    let of_uvs = mesh.uvs.as_ref().map_or(0, |n| 16 * n.values.len() + corners);
    let of_colors = mesh.colors.as_ref().map_or(0, |c| 24 * c.values.len() + corners);
    24 * mesh.positions.len()
        + corners
        + of_normals
        + of_uvs
        + of_colors
        + 4 * (mesh.face_materials.len() + slots.len())
}

fn that_count(limits: &Limits) -> (usize, u32, u64) {
    (limits.primitives, limits.texture_side, limits.decode_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        MemoryHost,
        script::{RunOptions, Script},
    };

    const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nl 1 2\nusemtl red\nf 1 2 3\n\
        usemtl blue\nf 1 3 4\nusemtl nothing\nf 1 2 2\nf 2 3 4\n";
    const MTL: &str = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nmap_Kd a.ppm.png\n";

    fn texture(level: u8) -> Vec<u8> {
        let image = crate::testing::from_rgb8(2, 1, &[level, 0, 0, 0, level, 0]);
        crate::output::encode(&image, crate::output::Format::Png).unwrap()
    }

    /// Scene and warnings of a run, as text.
    fn run(script: &str, host: &MemoryHost, kept: Option<&KeptAssets>) -> String {
        let options = RunOptions {
            assets: kept.cloned(),
            ..RunOptions::default()
        };
        let script = Script::compile("a.rhai", script, &Limits::default()).unwrap();
        match script.run(host, &options) {
            Ok(run) => format!(
                "{}{:?}{:?}",
                run.value.scene.dump(),
                run.value.scene.files,
                run.warnings
            ),
            Err(error) => format!("{error} {:?}", error.warnings),
        }
    }

    #[test]
    fn what_did_not_change_is_not_decoded_again_and_nothing_tells() {
        let files = |obj: &str, mtl: &str, level| {
            MemoryHost::new()
                .with("a.obj", obj)
                .with("a.mtl", mtl)
                .with("a.ppm.png", texture(level))
        };
        let kept = KeptAssets::new();
        let plain = "mesh(\"a.obj\"); diffuse(image(\"a.ppm.png\")); sphere(0, 0, 0, 1);";
        let other_materials_first = "diffuse(0.3, 0.4, 0.5); sphere(0, 0, 0, 1); mesh(\"a.obj\");";
        let one_material_for_two =
            "ambient(0, 0, 0); mesh(\"a.obj\", #{ materials: false }); mesh(\"a.obj\");";
        let blue_is_red = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 1 0 0\n";
        for (script, host, counts) in [
            (plain, files(OBJ, MTL, 9), (2, 0)),
            (plain, files(OBJ, MTL, 9), (2, 2)),
            (other_materials_first, files(OBJ, MTL, 9), (2, 4)),
            (one_material_for_two, files(OBJ, MTL, 9), (3, 6)),
            // One file after the other.
            (plain, files(OBJ, MTL, 8), (4, 7)),
            (plain, files(OBJ, blue_is_red, 8), (4, 9)),
            // Two names that were one material are two again.
            (one_material_for_two, files(OBJ, MTL, 8), (4, 12)),
            (plain, files(&OBJ.replace("v 0 1 0", "v 0 2 0"), MTL, 8), (5, 13)),
            // What is wrong is as wrong as ever.
            (plain, files(OBJ, "newmtl red\nKd 1 0\n", 8), (5, 13)),
            (plain, files("f 1 2 3", MTL, 8), (5, 13)),
        ] {
            let expected = run(script, &host, None);
            assert_eq!(run(script, &host, Some(&kept)), expected);
            assert_eq!(kept.counts(), counts, "{expected}");
        }
    }
}
