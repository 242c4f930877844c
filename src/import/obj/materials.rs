//! The materials of an OBJ file: from the names in it, by its MTL files, to those of the scene.

use std::borrow::Cow;

use super::{
    super::{
        assets::Assets,
        look,
        mtl::{self, Library},
        text::{Source, counted, quoted},
        wavefront::{self, warn_at},
    },
    Names,
};
use crate::{
    diag::{Diagnostic, ErrorKind, nearest_names},
    host::resolve,
    scene::{Builder, MaterialId, Mesh},
};

/// The material of each name that `usemtl` gives.
pub(super) fn materials(
    source: &Source<'_>,
    names: &Names<'_>,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Vec<MaterialId>, Diagnostic> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for (name, at) in &names.libraries {
        let path = resolve(source.name, name);
        if files.iter().any(|(known, _)| *known == path) {
            continue;
        }
        match assets.read(&path) {
            Ok(bytes) => files.push((path, bytes)),
            Err(error) if error.kind == ErrorKind::Input => {
                let hint = format!(
                    "mesh(\"{}\", #{{ materials: false }}) takes the shape without its materials",
                    source.name
                );
                return Err(source.place(error, at).hint(hint));
            }
            Err(error) => return Err(source.place(error, at)),
        }
    }
    let texts = files.iter().map(|(path, bytes)| wavefront::text(path, bytes));
    let texts = texts.collect::<Result<Vec<Cow<'_, str>>, _>>()?;
    let sources = files
        .iter()
        .zip(&texts)
        .map(|((path, _), text)| Source::new(path, text, ErrorKind::Input));
    let mut libraries = Vec::new();
    for source in sources {
        let library = mtl::parse(&source)?;
        warn_library(&source, &library, builder);
        libraries.push((source, library));
    }
    let mut unknown = Vec::new();
    let mut ids = vec![MaterialId::INHERIT; names.materials.len()];
    let used = ids
        .iter_mut()
        .zip(&names.materials)
        .zip(&names.is_used)
        .filter(|(_, used)| **used);
    for ((id, (name, at)), _) in used {
        // As with one name twice in one file, the last one counts.
        let found = libraries
            .iter()
            .rev()
            .find_map(|(source, library)| Some((source, library.materials.get(name)?)));
        match found {
            Some((source, mtl)) => {
                let light = builder.material().ambient.color;
                let material = look::material(mtl, light, source, assets, builder)?;
                *id = builder.material_id(&material);
            }
            None => unknown.push((name, *at)),
        }
    }
    if let Some((name, at)) = unknown.first() {
        let others = match unknown.len() - 1 {
            0 => String::new(),
            n => format!(", nor {n} more that usemtl names"),
        };
        let known = libraries
            .iter()
            .flat_map(|(_, library)| library.materials.keys().map(AsRef::as_ref));
        let hint = match nearest_names(name, known).first() {
            Some(near) => format!("did you mean '{near}'?"),
            None if libraries.is_empty() => {
                "a line 'mtllib file.mtl' names the file with the materials".to_owned()
            }
            None => "its faces look as the object that places the mesh".to_owned(),
        };
        let message = format!("no material is called {}{others}", quoted(name));
        warn_at(source, at, builder, message, Some(&hint));
    }
    Ok(ids)
}

fn warn_library(source: &Source<'_>, library: &Library<'_>, builder: &mut Builder) {
    let maps = |n| {
        format!(
            "{} not used: only map_Kd, map_Ka, map_Ks and map_Ke are",
            counted(
                n,
                "texture of this kind is",
                "textures of this and other kinds are"
            )
        )
    };
    library.unused_maps.warn(source, builder, maps, None);
    let options = |n| {
        format!(
            "{} not used: the texture is laid as it is",
            counted(n, "texture option is", "texture options are")
        )
    };
    library.unused_options.warn(source, builder, options, None);
    let unknown = |n| {
        format!(
            "{} left out",
            counted(n, "unknown MTL statement is", "unknown MTL statements are")
        )
    };
    library.unknown.warn(source, builder, unknown, None);
}

/// Gives each face the material in its slot of the file's names.
pub(in crate::import) fn set_materials(mesh: &mut Mesh, ids: &[MaterialId]) {
    for id in &mut mesh.face_materials {
        *id = ids.get(id.index()).copied().unwrap_or(MaterialId::INHERIT);
    }
    if mesh.face_materials.iter().all(|id| *id == MaterialId::INHERIT) {
        mesh.face_materials = Vec::new();
    }
}
