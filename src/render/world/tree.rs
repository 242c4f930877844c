//! The tree of a level and its leaves.

use rayon::prelude::*;

use super::{super::interrupt::Interrupt, level::Level};
use crate::accel::{BLOCK, Bvh, Cuboids, Kinds, NONE, Primitive, Spheres, Triangles};

/// Blocks that are filled between two looks at the interrupt, and the fewest that are worth another thread.
const PIECE: usize = 1024;

/// Builds the tree over all primitives that have bounds, and fills its leaves.
pub(super) fn build(
    level: &mut Level<'_>,
    primitives: Vec<Primitive>,
    kinds: Kinds,
    cuts: f64,
    interrupt: &Interrupt<'_>,
) {
    let (bvh, leaves) = Bvh::build(
        primitives,
        kinds,
        cuts,
        |index| level.corners(index),
        || interrupt.poll(),
    );
    level.bvh = bvh;
    let (triangles, spheres, cuboids) = (leaves.triangles, leaves.spheres, leaves.cuboids);
    level.triangle_blocks = blocks(triangles, Triangles::EMPTY, interrupt, |block, lane, index| {
        block.set(lane, index, level.corners(index));
        block.corners[lane] = level.triangles[index as usize];
    });
    level.sphere_blocks = blocks(spheres, Spheres::EMPTY, interrupt, |block, lane, index| {
        let index = index - kinds.triangles as u32;
        let sphere = &level.spheres[index as usize];
        block.set(lane, index, sphere.center, sphere.radius);
    });
    level.cuboid_blocks = blocks(cuboids, Cuboids::EMPTY, interrupt, |block, lane, index| {
        if let Some((cuboid, object_from_level)) = level.cuboid(index) {
            block.set(lane, index, object_from_level, cuboid.half());
        }
    });
}

/// A block for each leaf; `set` puts the primitive of an index into a lane.
fn blocks<B: Copy + Send + Sync>(
    leaves: Vec<[u32; BLOCK]>,
    empty: B,
    interrupt: &Interrupt<'_>,
    set: impl Fn(&mut B, usize, u32) + Sync,
) -> Vec<B> {
    let block = |(n, indices): (usize, [u32; BLOCK])| {
        let mut block = empty;
        if interrupt.is_stopped() || n.is_multiple_of(PIECE) && interrupt.poll() {
            return block;
        }
        for (lane, index) in indices.into_iter().enumerate() {
            if index != NONE {
                set(&mut block, lane, index);
            }
        }
        block
    };
    let leaves = leaves.into_par_iter().enumerate();
    leaves.with_min_len(PIECE).map(block).collect()
}
