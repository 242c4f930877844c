//! Building: a binary tree by the binned surface area heuristic, then the best way to see it as one of eight
//! children to a node.

mod binary;
mod collapse;

use super::{
    blocks::BLOCK,
    boxes::{Box32, Child, LeafKind, Node},
    four::F4,
};

/// Cost of visiting a node, in tests of one block.
const NODE_COST: f32 = 1.0;
/// Cost of a primitive that stands alone, in tests of one block.
const ALONE_COST: f32 = 2.0;
/// Most primitives in a leaf.
const LEAF_MAX: usize = BLOCK;

/// A tree over primitives that are known by their boxes and kinds only.
#[derive(Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Indices of the primitives that are in no block, in the order of the leaves.
    others: Vec<u32>,
    /// Largest coordinate of any box.
    extent: f32,
}

/// What the builder knows of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// A box around it. An empty box is never entered.
    pub bounds: Box32,
    /// How much light it can block: its surface area, roughly. Decides only the order in which shadow rays look.
    pub area: f32,
}

/// How many primitives there are of the kinds that share blocks. They are numbered in the order of the fields,
/// and all others after them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kinds {
    /// Triangles.
    pub triangles: usize,
    /// Spheres.
    pub spheres: usize,
}

impl Kinds {
    #[inline]
    fn of(self, index: u32) -> LeafKind {
        let index = index as usize;
        if index < self.triangles {
            LeafKind::Triangles
        } else if index < self.triangles + self.spheres {
            LeafKind::Spheres
        } else {
            LeafKind::Others
        }
    }
}

/// A box in registers; the fourth lane holds nothing.
#[derive(Clone, Copy)]
struct Aabb {
    min: F4,
    max: F4,
}

impl Aabb {
    #[inline]
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

    /// Grows to contain a point. The center of an empty box is NaN and left out.
    #[inline(always)]
    fn grow_point(&mut self, p: F4) {
        self.min = p.min(self.min);
        self.max = p.max(self.max);
    }

    /// Half the surface area; 0 for the empty box.
    #[inline]
    fn half_area(&self) -> f32 {
        let [x, y, z, _] = self.max.sub(self.min).to_array();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

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

/// A primitive while the tree is being built.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Item {
    min: [f32; 3],
    index: u32,
    max: [f32; 3],
    area: f32,
}

impl Item {
    #[inline(always)]
    fn bounds(&self) -> Aabb {
        let wide = |[x, y, z]: [f32; 3]| F4::from_array([x, y, z, 0.0]);
        Aabb {
            min: wide(self.min),
            max: wide(self.max),
        }
    }
}

/// Numbers of primitives that share blocks and of those that stand alone.
#[derive(Clone, Copy, Default)]
struct Load {
    packed: u32,
    alone: u32,
}

impl Load {
    #[inline]
    fn of(item: &Item, kinds: Kinds) -> Self {
        match kinds.of(item.index) {
            LeafKind::Others => Self { packed: 0, alone: 1 },
            _ => Self { packed: 1, alone: 0 },
        }
    }

    #[inline]
    fn add(&mut self, other: Self) {
        self.packed += other.packed;
        self.alone += other.alone;
    }

    /// In tests of one block.
    #[inline]
    fn cost(self) -> f32 {
        self.packed.div_ceil(BLOCK as u32) as f32 + ALONE_COST * self.alone as f32
    }

    fn is_empty(self) -> bool {
        self.packed + self.alone == 0
    }
}

impl Bvh {
    /// A tree over `primitives`.
    ///
    /// The primitives of a leaf are of one kind. Those of a leaf of triangles or spheres, four at the most, are
    /// handed to `block` in ascending order, which is to make them the next block of that kind.
    #[must_use]
    pub fn build(primitives: &[Primitive], kinds: Kinds, block: impl FnMut(LeafKind, &[u32])) -> Self {
        let count = primitives.len().min(Child::PLACES_MAX);
        let mut items: Vec<Item> = primitives[..count]
            .iter()
            .zip(0..)
            .map(|(p, index)| Item {
                min: p.bounds.min,
                index,
                max: p.bounds.max,
                area: p.area,
            })
            .collect();
        if items.is_empty() {
            return Self::default();
        }
        let tree = binary::Tree::build(&mut items, kinds);
        let (nodes, others) = collapse::collapse(&tree, &items, kinds, block);
        let extent = nodes.first().map_or(0.0, Node::extent);
        Self {
            nodes,
            others,
            extent,
        }
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
