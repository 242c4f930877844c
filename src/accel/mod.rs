//! Bounding volume hierarchy: boxes around boxes around primitives, eight children to a node.
//!
//! The tree never decides a value. Its box tests are conservative: rounded outwards on every step, they may let
//! a ray in that misses, and never keep one out that hits. So the nearest hit is a matter of the primitives
//! alone, and neither the shape of the tree nor the instructions used can move a bit of a picture.

mod blocks;
mod boxes;
mod build;
mod four;
mod lanes;
mod packet;
mod ray;
mod shaft;
mod traverse;

pub use blocks::{BLOCK, Candidates, NONE, Range, Spheres, Triangles};
pub use boxes::{Box32, Child, LeafKind, round_down, round_up};
pub use build::{Bvh, Kinds, Leaves, Primitive};
pub use lanes::{Lanes, Simd, prefetch};
pub use packet::{DONE, Decide, PACKET, Place, RayPacket, Search, rays};
pub use ray::{Ray32, RayBlock, RayBox, RaySphere};
pub use shaft::Shaft;
pub use traverse::{Control, Visitor};
