//! Pictures written as code: an embeddable scene-scripting ray tracer whose pictures are the same to the last bit
//! on every machine.
//!
//! ```text
//! source text -> Script -> Builder (matrix stack, material state) -> Scene
//! .test, .obj, .png ... -> import -> the same Builder              -> Scene
//! Scene -> World (groups compiled, trees) -> rays over tiles       -> Image -> output
//! ```
//!
//! - [`Script`] reads a Rhai script; [`Script::run`] builds a [`Scene`] from it, within [`Limits`], reaching nothing
//!   but the [`Host`] it is given.
//! - [`Builder`] makes scenes without a script, by the same calls.
//! - [`render()`] turns a scene into an [`Image`]; [`render::World`] answers rays of your own.
//! - [`output`] encodes pictures; [`testing`] describes and compares them for snapshot tests.
//! - Everything that went wrong or looks wrong is a [`diag::Diagnostic`] with a place and a hint. The library never prints.
//!
//! ```
//! use rtscript::{Builder, DVec3, NoHost, RenderOptions, Term, render, scene::Camera};
//!
//! let mut b = Builder::new();
//! b.size(32, 24)?;
//! b.camera(Camera::new(DVec3::new(0.0, 1.0, 4.0), DVec3::ZERO, DVec3::Y, 45.0)?);
//! b.directional(DVec3::ONE, DVec3::ONE)?;
//! b.material_mut().diffuse = Term::color(DVec3::new(0.9, 0.3, 0.2));
//! b.sphere(DVec3::ZERO, 1.0)?;
//! let scene = b.finish().value;
//! let image = render(&scene, &RenderOptions::default(), &NoHost)?.value.image;
//! assert_eq!(image.rgb8().len(), 32 * 24 * 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: right-handed, Y up, column vectors, degrees; counter-clockwise is the front; colors are scene-linear
//! RGB with Rec. 709 primaries; the picture's origin is its top left corner. `ARCHITECTURE.md` in the repository
//! tells how it works and why.

#[doc(hidden)]
pub mod accel;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod color;
mod custom;
pub mod diag;
pub mod host;
pub mod import;
pub mod limits;
pub mod math;
pub mod meter;
pub mod noise;
pub mod output;
pub mod parameters;
pub mod recipe;
pub mod render;
pub mod scene;
pub mod script;
pub mod shape;
#[doc(hidden)]
pub mod source;
pub mod spline;
pub mod tessellate;
pub mod testing;

pub use diag::{Error, Report};
pub use host::{DirHost, Host, MemoryHost, NoHost};
pub use limits::Limits;
pub use math::DVec3;
pub use render::{Image, RenderOptions, render};
pub use scene::{Builder, Scene, Term};
pub use script::{RunOptions, Script};

/// The README's program, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The programs of the guide, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/embedding.md")]
struct Embedding;
