//! Files that describe scenes or parts of them: bytes in, calls on the [`Builder`](crate::Builder) out.
//!
//! Nothing here opens a file by itself, and nothing trusts what it reads: every fault in a file becomes a
//! [`Diagnostic`](crate::diag::Diagnostic) with its file, line and column.

#![allow(
    clippy::result_large_err,
    reason = "an error ends the run, so its size is paid for once"
)]

mod arrays;
mod assembly;
mod assets;
mod command;
mod convert;
mod course;
mod gltf;
mod guard;
mod hdr;
mod json;
mod kept;
mod look;
mod mtl;
mod obj;
mod ply;
mod stl;
mod text;
mod texture;
mod wavefront;

pub use arrays::{mesh_from_arrays, set_colors, set_normals, set_uvs};
pub use assets::{AssetCache, Assets};
pub use convert::script_from_course;
pub use course::{Course, further_errors as further_course_errors, load_course};
pub use kept::KeptAssets;
pub use obj::{Polygons, load_mesh, load_mesh_shape, load_obj, load_obj_shape, load_polygons};
