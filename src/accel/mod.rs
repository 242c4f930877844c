//! Bounding volume hierarchy: boxes around boxes around primitives, eight children to a node.
//!
//! The tree never decides a value. Its box tests are conservative: rounded outwards on every step, they may let
//! a ray in that misses, and never keep one out that hits. So the nearest hit is a matter of the primitives
//! alone, and neither the shape of the tree nor the instructions used can move a bit of a picture.

#![allow(
    clippy::indexing_slicing,
    reason = "a tree refers only to nodes and blocks that its builder made, and lanes are counted by constants"
)]

mod blocks;
mod boxes;
mod build;
mod corners;
mod cuboids;
mod few;
mod four;
mod lanes;
mod packet;
mod ray;
mod shaft;
mod traverse;

pub use blocks::{BLOCK, Candidates, NONE, Range, Spheres, Triangles};
pub use boxes::{Box32, Child, LeafKind, round_down, round_up};
pub use build::{Bvh, Kinds, Leaves, Primitive};
pub use corners::{Corners, Spot};
pub use cuboids::Cuboids;
pub use few::Few;
pub use lanes::{Exact, Four, Lanes, Mask, Simd, Task, Words, prefetch, run};
pub use packet::{BEFORE_END, DONE, Decide, Ends, HasRay, PACKET, Place, RayPacket, Search, rays};
pub use ray::{Ray32, RayBlock, RayBox, RayCuboid, RaySphere};
pub use shaft::Shaft;
pub use traverse::{Control, Visitor};

/// How often a test looks, or at how much: `n`. Under Miri, which takes thousands of times as long, one in 400, though
/// not fewer than ten.
#[cfg(test)]
pub fn cases(n: usize) -> usize {
    if cfg!(miri) { n.min((n / 400).max(10)) } else { n }
}

/// Numbers in [0, 1) for tests, from the generator of Knuth's MMIX.
#[cfg(test)]
pub fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}
