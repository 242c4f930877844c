//! Bounding volume hierarchy: boxes around boxes around primitives, eight children to a node.
//!
//! The tree never decides a value. Its box tests are conservative: rounded outwards on every step, they may let
//! a ray in that misses, and never keep one out that hits. So the nearest hit is a matter of the primitives
//! alone, and neither the shape of the tree nor the instructions used can move a bit of a picture.

mod boxes;
mod build;
mod traverse;

pub use boxes::Box32;
pub use build::Bvh;
pub use traverse::{Control, RayBox};
