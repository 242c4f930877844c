//! Models in one file: PLY, STL and glTF, of text or of bytes.

use rtscript::{
    Builder, MemoryHost,
    import::{AssetCache, Assets, load_mesh},
};

use crate::{
    obj::render_mesh,
    oracle::{check, limits},
};

pub fn ply(data: &[u8]) {
    load("a.ply", data);
}

pub fn stl(data: &[u8]) {
    load("a.stl", data);
}

/// The file `a.bin` beside it has every byte once.
pub fn gltf(data: &[u8]) {
    load("a.gltf", data);
}

fn load(name: &str, data: &[u8]) {
    let host = MemoryHost::new()
        .with(name, data)
        .with("a.bin", (0..=255).collect::<Vec<u8>>());
    let text = String::from_utf8_lossy(data);
    let texts = [(name, &*text)];
    let limits = limits();
    let mut builder = Builder::with_limits(limits.clone());
    let mut cache = AssetCache::default();
    let loaded = load_mesh(name, &mut Assets::new(&host, &limits, &mut cache), &mut builder);
    builder
        .take_warnings()
        .iter()
        .for_each(|warning| check(warning, &texts));
    match loaded {
        Ok(mesh) => render_mesh(builder, &mesh, &host),
        Err(error) => check(&error, &texts),
    }
}
