//! What the fuzz targets do: each takes bytes, makes something of them that rtscript is given, and panics where what
//! comes back is not as promised. That they are not merely free of panics is in [`oracle`].

#![allow(
    clippy::result_large_err,
    reason = "an error ends the run, so its size is paid for once"
)]

pub mod builder;
pub mod bytes;
pub mod calls;
pub mod course;
#[cfg(fuzzing)]
pub mod lsp;
pub mod models;
pub mod mtl;
pub mod obj;
pub mod oracle;
pub mod path;
pub mod recipe;
pub mod scene;
pub mod script;
pub mod snapshot;
pub mod texture;

/// A target: its name, which is that of its folder of seeds, and what it does with an input.
pub type Target = (&'static str, fn(&[u8]));

/// Every target that needs no instrumentation.
pub const TARGETS: &[Target] = &[
    ("script", script::run),
    ("calls", calls::run),
    ("course", course::run),
    ("obj", obj::run),
    ("mtl", mtl::run),
    ("ply", models::ply),
    ("stl", models::stl),
    ("gltf", models::gltf),
    ("texture", texture::run),
    ("path", path::run),
    ("builder", builder::run),
    ("scene", scene::run),
    ("recipe", recipe::run),
    ("snapshot", snapshot::run),
];
