//! The tree of a level and its leaves.

use rayon::prelude::*;

use super::{super::interrupt::Interrupt, level::Level};
use crate::accel::{BLOCK, Bvh, Cuboids, Kinds, NONE, Primitive, Spheres, Triangles, prefetch};

/// Blocks that are filled between two looks at the interrupt, and the fewest that are worth another thread.
const PIECE: usize = 1024;
/// Blocks between the look at a triangle's numbers of corners and the use of the corners.
const AHEAD: usize = 6;

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
    let ask = |when: Ahead, index: u32| match when {
        Ahead::Far => prefetch(level.triangles.as_ptr().wrapping_add(index as usize)),
        Ahead::Near => level.ask_for_corners(level.triangles[index as usize]),
    };
    level.triangle_blocks = blocks(
        &triangles,
        Triangles::EMPTY,
        interrupt,
        ask,
        |block, lane, index| {
            block.set(lane, index, level.corners(index), level.triangles[index as usize]);
        },
    );
    level.sphere_blocks = blocks(
        &spheres,
        Spheres::EMPTY,
        interrupt,
        |_, _| {},
        |block, lane, index| {
            let index = index - kinds.triangles as u32;
            let sphere = &level.spheres[index as usize];
            block.set(lane, index, sphere.center, sphere.radius);
        },
    );
    level.cuboid_blocks = blocks(
        &cuboids,
        Cuboids::EMPTY,
        interrupt,
        |_, _| {},
        |block, lane, index| {
            if let Some((cuboid, object_from_level)) = level.cuboid(index) {
                block.set(lane, index, object_from_level, cuboid.half());
            }
        },
    );
}

/// How long before a primitive is put into a block.
#[derive(Clone, Copy)]
enum Ahead {
    Far,
    Near,
}

/// A block for each leaf; `set` puts the primitive of an index into a lane, `ask` asks for the memory that this will need.
fn blocks<B: Copy + Send + Sync>(
    leaves: &[[u32; BLOCK]],
    empty: B,
    interrupt: &Interrupt<'_>,
    ask: impl Fn(Ahead, u32) + Sync,
    set: impl Fn(&mut B, usize, u32) + Sync,
) -> Vec<B> {
    let ask_for = |when, n: usize| {
        let indices = leaves.get(n).into_iter().flatten();
        indices
            .filter(|index| **index != NONE)
            .for_each(|index| ask(when, *index));
    };
    let block = |(n, indices): (usize, &[u32; BLOCK])| {
        let mut block = empty;
        ask_for(Ahead::Far, n + 2 * AHEAD);
        ask_for(Ahead::Near, n + AHEAD);
        if interrupt.is_stopped() || n.is_multiple_of(PIECE) && interrupt.poll() {
            return block;
        }
        for (lane, index) in indices.iter().enumerate() {
            if *index != NONE {
                set(&mut block, lane, *index);
            }
        }
        block
    };
    let leaves = leaves.par_iter().enumerate();
    leaves.with_min_len(PIECE).map(block).collect()
}
