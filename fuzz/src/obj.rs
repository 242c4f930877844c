//! Models.

use std::sync::Arc;

use rtscript::{
    Builder, MemoryHost,
    diag::Diagnostic,
    import::{AssetCache, Assets, load_obj, load_obj_shape},
    render,
    scene::Mesh,
};

use crate::oracle::{check, limits};

const MATERIALS: &str =
    "newmtl red\nKd 1 0 0\nnewmtl glass\nKd 0 0 1\nillum 6\nd 0.5\nNi 1.5\nmap_Kd wood.png\n";

pub fn run(data: &[u8]) {
    let host = crate::oracle::host()
        .with("a.obj", data)
        .with("a.mtl", MATERIALS)
        .with("sub/a.mtl", MATERIALS);
    let text = String::from_utf8_lossy(data);
    let _ = load(&host, true, &[("a.obj", &text), ("a.mtl", MATERIALS)]);
    let _ = load(&host, false, &[("a.obj", &text)]);
}

/// Loads `a.obj`, and renders what it holds.
pub fn load(host: &MemoryHost, with_materials: bool, texts: &[(&str, &str)]) -> Result<(), Diagnostic> {
    let limits = limits();
    let mut builder = Builder::with_limits(limits.clone());
    let mut cache = AssetCache::default();
    let mut assets = Assets::new(host, &limits, &mut cache);
    let loaded = if with_materials {
        load_obj("a.obj", &mut assets, &mut builder)
    } else {
        load_obj_shape("a.obj", &mut assets, &mut builder)
    };
    builder
        .take_warnings()
        .iter()
        .for_each(|warning| check(warning, texts));
    let mesh = loaded.inspect_err(|error| check(error, texts))?;
    render_mesh(builder, &mesh, host);
    Ok(())
}

/// Checks a mesh, and renders it where it is small.
pub(crate) fn render_mesh(mut builder: Builder, mesh: &Arc<Mesh>, host: &MemoryHost) {
    check_mesh(mesh);
    let triangles = mesh.triangles.len();
    if builder.mesh(mesh).is_ok() && triangles < 500 {
        builder.size(4, 4).expect("a small picture");
        let scene = builder.finish().value;
        let rendered =
            render(&scene, &rtscript::RenderOptions::default(), host).expect("a scene of one mesh");
        let pixels = rendered.value.image.pixels().iter().flatten();
        assert!(pixels.clone().all(|v| v.is_finite()), "a pixel that is no number");
    }
}

fn check_mesh(mesh: &Arc<Mesh>) {
    assert!(
        mesh.positions.iter().all(|p| p.is_finite()),
        "a corner that is no number"
    );
    let within = |indices: &[[u32; 3]], len: usize| indices.iter().flatten().all(|i| (*i as usize) < len);
    assert!(
        within(&mesh.triangles, mesh.positions.len()),
        "a corner that there is not"
    );
    if let Some(normals) = &mesh.normals {
        assert_eq!(normals.indices.len(), mesh.triangles.len());
        assert!(
            normals.values.iter().all(|n| n.is_finite()),
            "a normal that is no number"
        );
    }
    if let Some(uvs) = &mesh.uvs {
        assert_eq!(uvs.indices.len(), mesh.triangles.len());
        assert!(
            uvs.values.iter().all(|uv| uv.is_finite()),
            "a texture coordinate that is no number"
        );
    }
    let faces = mesh.face_materials.len();
    assert!(faces == 0 || faces == mesh.triangles.len(), "{faces} materials");
}
