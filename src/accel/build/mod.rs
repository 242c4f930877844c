//! Building: the binned surface area heuristic from the top down, then the best way to see the binary tree as
//! nodes of eight children.
//!
//! First the primitives are divided, in parallel, until no part is larger than a subtree that fits the cache
//! ([`divide`]). Subtrees then become binary trees, many at once ([`binary`]). All of them together are collapsed
//! to nodes ([`collapse`]). Memory counts wherever costs are compared ([`memory`]). The tree does not depend on the
//! number of threads.

mod binary;
mod binning;
mod bins;
mod collapse;
mod divide;
mod memory;
mod spatial;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::{
    blocks::BLOCK,
    boxes::{Box32, Child, LeafKind, Node},
    four::F4,
    lanes::{Lanes, Simd},
};
use crate::math::DVec3;

/// Cost of visiting a node, in tests of one block.
const NODE_COST: f32 = 1.0;
/// Cost of a primitive that stands alone, in tests of one block.
const ALONE_COST: u32 = 2;
/// Most primitives in a leaf.
const LEAF_MAX: usize = BLOCK;
/// A leaf may be divided where its halves' areas together are less than this part of its own.
const APART: f32 = 0.95;
/// Below this depth every split halves, which bounds the depth of the tree and so the traversal's stack.
const SAH_DEPTH: usize = 48;

/// Large parts are worked on in pieces of so many items, in parallel. A constant, so that the tree is the same for
/// any number of threads.
const PIECE: usize = 1 << 15;

/// A tree over primitives that are known by their boxes and kinds only.
#[derive(Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Indices of the primitives that are in no block, in the order of the leaves.
    others: Vec<u32>,
    /// Largest coordinate of any box.
    extent: f32,
}

/// The primitives of each leaf that is a block, in the order of the blocks;
/// [`NONE`](super::NONE) fills what is left over.
#[derive(Debug, Default)]
pub struct Leaves {
    /// Blocks of [`LeafKind::Triangles`].
    pub triangles: Vec<[u32; BLOCK]>,
    /// Blocks of [`LeafKind::Spheres`], counted as all primitives are, triangles first.
    pub spheres: Vec<[u32; BLOCK]>,
    /// Blocks of [`LeafKind::Cuboids`], counted as all primitives are.
    pub cuboids: Vec<[u32; BLOCK]>,
}

/// What the builder knows of a primitive: the corners of its box, behind the smallest its index and behind the largest
/// its area. One register holds it, and no line of a cache ends inside.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Primitive([f32; 8]);

impl Primitive {
    /// With these bits added an index is an f32 between 2 and 2^17. Were it left a tiny number, arithmetic on all
    /// lanes would be slow.
    const INDEX: u32 = 0x4000_0000;
    /// Added to the index of a box that shares blocks; what it makes of it is no more than 2^34.
    const CUBOID: u32 = 0x1000_0000;

    /// A primitive with a box around it; one in an empty box is never found. `area` says how much light it can
    /// block, its surface area, roughly; it decides only the order in which shadow rays look.
    #[inline]
    #[must_use]
    pub fn new(index: u32, bounds: Box32, area: f32) -> Self {
        let Box32 {
            min: [x, y, z],
            max: [right, top, near],
        } = bounds;
        let index = f32::from_bits(Self::INDEX | index);
        Self([x, y, z, index, right, top, near, area])
    }

    /// The same, which may be known as a box: those share blocks, but are numbered among the others.
    #[inline]
    #[must_use]
    pub fn with_cuboid(mut self, is_cuboid: bool) -> Self {
        let mark = if is_cuboid { Self::CUBOID } else { 0 };
        self.0[3] = f32::from_bits(self.0[3].to_bits() | mark);
        self
    }

    #[inline(always)]
    fn is_cuboid(&self) -> bool {
        self.0[3].to_bits() & Self::CUBOID != 0
    }

    /// Its index.
    #[inline(always)]
    #[must_use]
    pub fn index(&self) -> u32 {
        self.0[3].to_bits() & !(Self::INDEX | Self::CUBOID)
    }

    /// All that the builder knows of it, as bits: of two that have the same, either will do.
    #[must_use]
    pub fn bits(&self) -> [u32; 8] {
        self.0.map(f32::to_bits)
    }

    #[inline(always)]
    fn area(&self) -> f32 {
        self.0[7]
    }

    /// The box around it.
    #[inline]
    #[must_use]
    pub fn bounds(&self) -> Box32 {
        self.aabb().to_box()
    }

    /// The box around some.
    #[must_use]
    pub fn around(all: &[Self]) -> Box32 {
        let mut around = Aabb::empty();
        for primitive in all {
            around.grow(&primitive.aabb());
        }
        around.to_box()
    }

    #[inline(always)]
    fn aabb(&self) -> Aabb {
        Aabb {
            min: F4::from_array([self.0[0], self.0[1], self.0[2], self.0[3]]),
            max: F4::from_array([self.0[4], self.0[5], self.0[6], self.0[7]]),
        }
    }

    /// Where its box begins along an axis.
    #[inline(always)]
    fn min(&self, axis: usize) -> f32 {
        self.0[axis & 3]
    }

    /// Where its box ends.
    #[inline(always)]
    fn max(&self, axis: usize) -> f32 {
        self.0[axis & 3 | 4]
    }

    #[inline(always)]
    fn lanes<L: Lanes>(&self, lanes: L) -> L::F8 {
        lanes.load(&self.0)
    }

    #[inline(always)]
    fn from_lanes<L: Lanes>(lanes: L, all: L::F8) -> Self {
        Self(lanes.store(all))
    }

    fn is_empty(&self) -> bool {
        (0..3).any(|k| !(self.min(k) <= self.max(k)))
    }
}

/// How many primitives there are of the kinds that share blocks and have numbers of their own. They are numbered in
/// the order of the fields, and all others after them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kinds {
    /// Triangles.
    pub triangles: usize,
    /// Spheres.
    pub spheres: usize,
}

impl Kinds {
    #[inline]
    fn of(self, item: &Primitive) -> LeafKind {
        let index = item.index() as usize;
        if index < self.triangles {
            LeafKind::Triangles
        } else if index < self.triangles + self.spheres {
            LeafKind::Spheres
        } else if item.is_cuboid() {
            LeafKind::Cuboids
        } else {
            LeafKind::Others
        }
    }

    #[inline]
    fn can_be_cut(self, item: &Primitive) -> bool {
        (item.index() as usize) < self.triangles
    }

    /// Whether all of these may stand in one leaf.
    fn are_one(self, items: &[Primitive]) -> bool {
        let mut kinds = items.iter().map(|item| self.of(item));
        kinds.next().is_none_or(|first| kinds.all(|kind| kind == first))
    }
}

/// What all parts of a build need to know.
struct Context<'a> {
    kinds: Kinds,
    corners: &'a Corners<'a>,
    /// Half the surface of the box around everything.
    root_area: f32,
    /// What a block or a node costs for the memory it takes: tests of a block times half the surface of its box.
    memory: f32,
    simd: Simd,
    stop: &'a Stop<'a>,
}

/// Corners of a triangle.
type Corners<'a> = dyn Fn(u32) -> [DVec3; 3] + Sync + 'a;

/// Whether to give up. Once true it stays so, and what is being built is dropped: any tree will do, the sooner the
/// better.
type Stop<'a> = dyn Fn() -> bool + Sync + 'a;

/// Items in the front part of a slice, and room behind them for those that splits add.
struct Items<'a> {
    all: &'a mut [Primitive],
    count: usize,
}

impl<'a> Items<'a> {
    /// The items.
    fn live(&mut self) -> &mut [Primitive] {
        &mut self.all[..self.count]
    }

    /// Two parts, each with a share of the room.
    fn split_at(self, middle: usize) -> [Self; 2] {
        let Self { all, count } = self;
        let room = ((all.len() - count) as u64 * middle as u64 / count as u64) as usize;
        if room > 0 {
            // The order of the right part does not matter: its first go behind its last where that is shorter.
            let moved = if count - middle > room {
                middle + room
            } else {
                count
            };
            all.copy_within(middle..moved, count.max(middle + room));
        }
        let (left, right) = all.split_at_mut(middle + room);
        [
            Self {
                all: left,
                count: middle,
            },
            Self {
                all: right,
                count: count - middle,
            },
        ]
    }
}

/// A box in registers; what the fourth lane holds does not matter.
#[derive(Clone, Copy)]
struct Aabb {
    min: F4,
    max: F4,
}

impl Aabb {
    #[inline(always)]
    fn empty() -> Self {
        Self {
            min: F4::splat(f32::INFINITY),
            max: F4::splat(f32::NEG_INFINITY),
        }
    }

    /// Grows to contain another box. NaN is left out: the second operand stays.
    #[inline(always)]
    fn grow(&mut self, other: &Self) {
        self.min = other.min.min(self.min);
        self.max = other.max.max(self.max);
    }

    /// The part inside another box.
    #[inline(always)]
    fn overlap(&self, other: &Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Whether it is empty.
    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.max.below(self.min).bits() & 7 != 0
    }

    /// Grows to contain a point. NaN is left out.
    #[inline(always)]
    fn grow_point(&mut self, p: F4) {
        self.min = p.min(self.min);
        self.max = p.max(self.max);
    }

    /// Twice the center.
    #[inline(always)]
    fn center(&self) -> F4 {
        self.min.add(self.max)
    }

    /// Half the surface area; never NaN, but without meaning for the empty box.
    #[inline(always)]
    fn half_area(&self) -> f32 {
        let size = self.max.sub(self.min);
        let faces = size.mul(size.rotate());
        let two = faces.add(faces.rotate());
        two.add(faces.rotate().rotate()).first().min(f32::MAX)
    }

    #[inline(always)]
    fn to_box(self) -> Box32 {
        let corner = |v: F4| {
            let [x, y, z, _] = v.to_array();
            [x, y, z]
        };
        Box32 {
            min: corner(self.min),
            max: corner(self.max),
        }
    }
}

/// What primitives cost, in fourths of the test of a block: triangles and spheres, which share blocks, one each. Boxes
/// share blocks as well, but where they count as if they stood alone they are sooner divided from what they cannot stand
/// with.
#[derive(Clone, Copy, Default)]
struct Load(u32);

impl Load {
    #[inline(always)]
    fn of(item: &Primitive, kinds: Kinds) -> Self {
        let shares = (item.index() as usize) < kinds.triangles + kinds.spheres;
        Self(if shares { 1 } else { ALONE_COST * BLOCK as u32 })
    }

    #[inline(always)]
    fn add(&mut self, other: Self) {
        self.0 += other.0;
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    /// In tests of whole blocks. No more than 2^28, since a tree has fewer than 2^27 places.
    #[inline(always)]
    fn blocks(self) -> u32 {
        self.0.div_ceil(BLOCK as u32)
    }
}

/// What is known of items before they are split.
#[derive(Clone, Copy)]
struct Summary {
    bounds: Aabb,
    /// Around twice the centers.
    centers: Aabb,
}

impl Summary {
    fn empty() -> Self {
        Self {
            bounds: Aabb::empty(),
            centers: Aabb::empty(),
        }
    }

    fn of(items: &[Primitive]) -> Self {
        if items.len() > PIECE {
            let pieces = items.par_chunks(PIECE).map(Self::of);
            return pieces.reduce(Self::empty, Self::union);
        }
        let mut summary = Self::empty();
        for item in items {
            let bounds = item.aabb();
            summary.bounds.grow(&bounds);
            summary.centers.grow_point(bounds.center());
        }
        summary
    }

    fn union(mut self, other: Self) -> Self {
        self.bounds.grow(&other.bounds);
        self.centers.grow(&other.centers);
        self
    }
}

impl Bvh {
    /// How many primitives there may be of so many when some have been cut.
    #[must_use]
    pub fn room(count: usize, kinds: Kinds, cuts: f64) -> usize {
        let more = (cuts * kinds.triangles.min(count) as f64) as usize;
        (count + more).min(Child::PLACES_MAX.max(count))
    }

    /// A tree over `primitives`, on the threads of the current pool. The primitives of a leaf are of one kind; the
    /// second value says which stand in each leaf that is a block.
    ///
    /// Where boxes overlap much, triangles are cut in two and stand in several leaves, `cuts` of them for each
    /// triangle at the most. Their corners are asked from `corners`.
    ///
    /// Asks `stop` every millisecond or so whether to give up, which must stay true once it is. The tree is then of no
    /// use.
    #[must_use]
    pub fn build(
        mut primitives: Vec<Primitive>,
        kinds: Kinds,
        cuts: f64,
        corners: impl Fn(u32) -> [DVec3; 3] + Sync,
        stop: impl Fn() -> bool + Sync,
    ) -> (Self, Leaves) {
        primitives.truncate(Child::PLACES_MAX);
        primitives.retain(|p| !p.is_empty());
        let Some(first) = primitives.first().copied() else {
            return Default::default();
        };
        let count = primitives.len();
        let all = Self::room(count, kinds, cuts);
        if all > count {
            primitives.reserve_exact(all - count);
            primitives.resize(all, first);
        }
        let summary = Summary::of(&primitives[..count]);
        let context = Context {
            kinds,
            corners: &corners,
            root_area: summary.bounds.half_area(),
            memory: memory::charge(&primitives[..count]),
            simd: Simd::detect(),
            stop: &stop,
        };
        let items = Items {
            all: &mut primitives,
            count,
        };
        let parts = divide::divide(items, &context, summary, 0);
        if stop() {
            return Default::default();
        }
        let collapsed = collapse::collapse(parts, &context);
        drop(primitives);
        collapsed.assemble(&stop)
    }

    /// Largest size of a coordinate of any box.
    #[inline]
    #[must_use]
    pub fn extent(&self) -> f32 {
        self.extent
    }

    /// Bytes of memory the tree takes, blocks not counted.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.others)
    }

    /// The primitives of a leaf of [`LeafKind::Others`].
    #[inline]
    #[must_use]
    pub fn others(&self, leaf: Child) -> &[u32] {
        self.others.get(leaf.range()).unwrap_or_default()
    }
}
