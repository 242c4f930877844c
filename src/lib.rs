//! Pictures written as code: an embeddable scene-scripting ray tracer.
//!
//! ```text
//! source text -> script -> scene::Builder -> Scene -> render -> Image -> output
//! ```

pub mod accel;
#[cfg(feature = "cli")]
pub mod cli;
pub mod color;
pub mod diag;
pub mod host;
pub mod import;
pub mod limits;
pub mod math;
pub mod output;
pub mod render;
pub mod scene;
pub mod script;
pub mod shape;
pub mod source;
pub mod testing;

pub use diag::{Diagnostic, Error, ErrorKind, Report};
pub use host::{DirHost, Host, HostError, MemoryHost, NoHost};
pub use limits::Limits;
pub use math::DVec3;
pub use render::{Image, RenderOptions, Rendered, render};
pub use scene::{Builder, Material, Scene, SceneError, Term};
pub use script::{Picture, Run, RunOptions, Script};
