//! glTF 2.0 files (Khronos Group, "glTF 2.0 Specification", 2021), as text with files beside it or as one file of bytes.
//!
//! Nothing in such a file is trusted: a number that leads somewhere is compared with how many there are, a list in a buffer with
//! the buffer's bytes, and only what a triangle uses is made.

mod accessor;
mod bytes;
mod item;
mod look;
mod nodes;
mod pictures;
mod shape;
mod uv;

use std::sync::Arc;

use self::{
    bytes::Buffers,
    item::{Document, Item, Kind},
    pictures::Pictures,
    shape::Triangles,
};
use super::{
    assembly,
    assets::Assets,
    json,
    kept::Gltf,
    obj::set_materials,
    text::{Source, quoted},
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    scene::{Builder, Mesh},
};

const SCENE: Kind = Kind {
    one: "scene",
    list: "scenes",
};
const NODE: Kind = Kind {
    one: "node",
    list: "nodes",
};
const MESH: Kind = Kind {
    one: "mesh",
    list: "meshes",
};
const MATERIAL: Kind = Kind {
    one: "material",
    list: "materials",
};

/// What a file may ask for, beside extensions of materials, which only say how things look.
const EXTENSIONS: [&str; 4] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    "KHR_xmp_json_ld",
];

/// Whether a file is a glTF file.
pub(super) fn is_gltf(path: &str, bytes: &[u8]) -> bool {
    let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending);
    let is = |wanted: &str| ending.eq_ignore_ascii_case(wanted);
    bytes::is_glb(bytes) || is("gltf") || is("glb") || bytes.trim_ascii_start().starts_with(b"{")
}

/// The meshes of a glTF file, where its nodes place them, as one.
///
/// # Errors
/// With the way to what is wrong, where the file is malformed, asks for what is not known, or passes a limit; where a file that
/// it names cannot be read.
pub(super) fn load(
    path: &str,
    file: Vec<u8>,
    with_materials: bool,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Arc<Mesh>, Diagnostic> {
    let (mesh, kept) = read(path, &file, with_materials, assets, builder)?;
    if let (Some(gltf), Some(kept)) = (kept, assets.kept()) {
        kept.keep_gltf(path, file, assets.limits(), gltf);
    }
    Ok(mesh)
}

/// The mesh, and what later runs need of the file, where any are to come and none has left it.
fn read(
    path: &str,
    file: &[u8],
    with_materials: bool,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<(Arc<Mesh>, Option<Gltf>), Diagnostic> {
    let is_text = !bytes::is_glb(file);
    let (text, binary) = if is_text {
        (file, None)
    } else {
        bytes::parts(path, file)?
    };
    let Ok(text) = std::str::from_utf8(text) else {
        return Err(Diagnostic::error(ErrorKind::Input, "the file is not text in UTF-8").at(path, 0, 0));
    };
    let document = Document {
        source: Source::new(path, text, ErrorKind::Input),
        is_text,
    };
    let json = json::parse(&document.source, assets).map_err(|error| match error.kind {
        ErrorKind::Input if !is_text => {
            let message = format!("in its JSON, at character {}: {}", error.column, error.message);
            Diagnostic::error(error.kind, message).at(path, 0, 0)
        }
        _ => error,
    })?;
    let root = Item::root(&document, &json);
    check(&root)?;
    let buffers = Buffers::new(path, root.count("buffers")?, binary);
    let known = assets
        .kept()
        .and_then(|kept| kept.gltf(path, with_materials, file, assets.limits()));
    if let Some(known) = known.filter(|known| buffers.are_as_before(&known.files, assets)) {
        let ids = look::materials(
            &root,
            (&known.materials, &known.colored),
            Pictures::new(path, &buffers),
            assets,
            builder,
        )?;
        builder.repeat_warnings(&known.warnings);
        if ids == known.ids {
            return Ok((Arc::clone(&known.mesh), None));
        }
        let mut mesh = Mesh::clone(&known.mesh);
        mesh.face_materials.clone_from(&known.slots);
        set_materials(&mut mesh, &ids);
        return Ok((Arc::new(mesh), None));
    }
    let before = builder.warnings().len();
    warn(&root, builder)?;
    let mut triangles = Triangles::new(&buffers, with_materials, assets);
    nodes::add_all(&root, &mut triangles, builder)?;
    let (checked, materials, colored) = (triangles.checked, triangles.materials, triangles.colored);
    if checked.faces.is_empty() {
        let error = Diagnostic::error(ErrorKind::Input, "the scene of the file has no triangles");
        return Err(error.at(path, 0, 0));
    }
    let mut mesh = assembly::mesh(&document.source, checked, assets, builder)?;
    let warnings = builder.warnings().get(before..).unwrap_or_default().to_vec();
    let ids = look::materials(
        &root,
        (&materials, &colored),
        Pictures::new(path, &buffers),
        assets,
        builder,
    )?;
    let slots = assets.kept().map(|_| mesh.face_materials.clone());
    set_materials(&mut mesh, &ids);
    let mesh = Arc::new(mesh);
    let kept = slots.map(|slots| Gltf {
        with_materials,
        mesh: Arc::clone(&mesh),
        slots,
        ids,
        materials,
        colored,
        files: buffers.files(),
        warnings,
    });
    Ok((mesh, kept))
}

/// Refuses what is of another version, or cannot be read without what is not known.
fn check(root: &Item<'_, '_>) -> Result<(), Diagnostic> {
    let asset = root.needed("asset")?;
    let version = asset.needed("version")?;
    for version in [Some(version), asset.get("minVersion")?].into_iter().flatten() {
        let text = version.string()?;
        if text.split('.').next() != Some("2") {
            return Err(version.error(format!("expected glTF 2.0, found {}", quoted(text))));
        }
    }
    if let Some(required) = root.get("extensionsRequired")? {
        for item in required.entries()? {
            let name = item.string()?;
            if !EXTENSIONS.contains(&name) && !name.starts_with("KHR_materials_") {
                let error = item.error(format!(
                    "the file needs the extension {}, which is not known",
                    quoted(name)
                ));
                return Err(error.hint("export the model without it, meshes and pictures uncompressed"));
            }
        }
    }
    Ok(())
}

/// What the file has and a mesh has not.
fn warn(root: &Item<'_, '_>, builder: &mut Builder) -> Result<(), Diagnostic> {
    if let Some(animations) = root.get("animations")?
        && animations.entries()?.len() > 0
    {
        let message = "animations are not used: the meshes stand where the nodes place them";
        animations.warn(builder, message, None);
    }
    let extensions = root.get("extensions")?;
    if let Some(extensions) = &extensions
        && let Some(lights) = extensions.get("KHR_lights_punctual")?
    {
        lights.warn(
            builder,
            "the lights of the file are not used",
            Some("point(...) and the like make lights"),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests;
