//! Tests of pictures: what to keep of one as text, how two differ, and how to render a scene file in a test.
//!
//! A snapshot of a picture says enough to see what changed without looking: its size, the hash of its pixels, its
//! mean color, a coarse grid of its brightness, and the scene it was made from. Two snapshots are equal exactly
//! where the pixels and the scenes are.
//!
//! With the feature `insta` there are assertions, too: `assert_render_snapshot!("name", scene)` compares with what is on
//! record and shows the difference as a picture. `examples/snapshot-tests` is a crate that uses them.
//!
//! ```
//! use rtscript::{Builder, NoHost, RenderOptions, render, testing::snapshot_text};
//! let mut b = Builder::new();
//! b.size(16, 16)?;
//! let scene = b.finish().value;
//! let image = render(&scene, &RenderOptions::default(), &NoHost)?.value.image;
//! assert!(snapshot_text(&scene, &image).starts_with("size 16 x 16\nhash "));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "insta")]
pub mod assert;
mod blame;
mod compare;
mod files;
mod flip;
mod record;
mod snapshot;
mod taken;
mod tolerance;

#[cfg(feature = "insta")]
#[doc(inline)]
pub use assert::{assert_render_snapshot, glob_render_snapshots};
pub use blame::{LineShare, changed_lines};
pub use compare::{Comparison, Region, changed_pixels, compare, diff_picture, from_rgb8, load_picture};
pub use files::{RenderedFile, find_scenes, intent, render_file, render_text};
pub use flip::{FlipMap, flip};
pub use record::Snapshot;
pub use snapshot::{Look, snapshot_text};
pub use taken::{Snapshotted, Taken};
pub use tolerance::Tolerance;

#[cfg(feature = "cli")]
pub(crate) use compare::channels_apart;
#[cfg(feature = "cli")]
pub(crate) use files::{name_alone, read_scene};
