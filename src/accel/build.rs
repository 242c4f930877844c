//! Building: binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007), eight children at once by splitting the child of largest area again and again (as
//! Embree does), subtrees in parallel.

use rayon::prelude::*;

use super::{
    blocks::BLOCK,
    boxes::{Box32, Child, LeafKind, Node},
};

const BINS: usize = 16;
/// Cost of visiting a node, in tests of one block.
const NODE_COST: f32 = 1.0;
/// Cost of a primitive that stands alone, in tests of one block.
const ALONE_COST: f32 = 2.0;
/// Most primitives in a leaf.
const LEAF_MAX: usize = BLOCK;
/// Below this depth every split halves, which bounds the depth of the tree and so the traversal's stack.
const SAH_DEPTH: usize = 20;
/// Subtrees above this size are built in parallel.
const PARALLEL: usize = 4096;

/// A tree over primitives that are known by their boxes and kinds only.
#[derive(Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Indices of the primitives that are in no block, in the order of the leaves.
    others: Vec<u32>,
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

impl Bvh {
    /// A tree over `boxes`; primitive `i` has the box `boxes[i]`. An empty box is never entered.
    ///
    /// The primitives of a leaf are of one kind. Those of a leaf of triangles or spheres, four at the most, are
    /// handed to `block`, which is to make them the next block of that kind.
    #[must_use]
    pub fn build(boxes: &[Box32], kinds: Kinds, mut block: impl FnMut(LeafKind, &[u32])) -> Self {
        let count = boxes.len().min(Child::PLACES_MAX);
        let mut items: Vec<Item> = boxes[..count]
            .iter()
            .zip(0..)
            .map(|(&bounds, index)| Item { bounds, index })
            .collect();
        if items.is_empty() {
            return Self::default();
        }
        let mut nodes = build_node(&mut items, kinds, 0, 0);
        let mut others = Vec::new();
        let mut blocks = [0; 2];
        let mut indices = Vec::with_capacity(LEAF_MAX);
        for child in nodes.iter_mut().flat_map(|node| &mut node.children) {
            if !child.is_leaf() || *child == Child::NOTHING {
                continue;
            }
            indices.clear();
            indices.extend(items[child.range()].iter().map(|item| item.index));
            // In the order of their numbers, so that the tree alone decides what a block holds.
            indices.sort_unstable();
            *child = match child.kind() {
                LeafKind::Others => {
                    others.extend_from_slice(&indices);
                    Child::leaf(LeafKind::Others, others.len() - indices.len(), indices.len())
                }
                kind => {
                    block(kind, &indices);
                    blocks[kind as usize] += 1;
                    Child::leaf(kind, blocks[kind as usize] - 1, 1)
                }
            };
        }
        Self { nodes, others }
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

/// A primitive while the tree is being built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Box32,
    index: u32,
}

/// Numbers of primitives that share blocks and of those that stand alone.
#[derive(Clone, Copy, Default)]
struct Load {
    packed: u32,
    alone: u32,
}

impl Load {
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

/// What is to become a child: consecutive items, their box, and how best to split them.
struct Part<'a> {
    items: &'a mut [Item],
    bounds: Box32,
    load: Load,
    split: Option<Split>,
}

/// Items in bins below `plane` along `axis` go left.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    min: f32,
    scale: f32,
    plane: usize,
    cost: f32,
}

impl Split {
    #[inline]
    fn bin(&self, item: &Item) -> usize {
        bin(item.bounds.center2(self.axis), self.min, self.scale)
    }
}

#[inline]
fn bin(center2: f32, min: f32, scale: f32) -> usize {
    // A saturating cast: what is not a number lands in bin 0.
    (((center2 - min) * scale) as usize).min(BINS - 1)
}

/// Nodes of the subtree over `items`, its root first. `first` is the place of `items[0]` among all items; node
/// indices count from the subtree's root.
fn build_node(items: &mut [Item], kinds: Kinds, first: usize, depth: usize) -> Vec<Node> {
    let count = items.len();
    let mut parts = vec![Part::new(items, kinds, depth)];
    while parts.len() < 8 {
        let next = (0..parts.len())
            .filter(|&i| parts[i].should_split(kinds, parts.len() == 1))
            .max_by(|&a, &b| {
                parts[a]
                    .weight(depth)
                    .total_cmp(&parts[b].weight(depth))
                    .then(b.cmp(&a))
            });
        let Some(next) = next else { break };
        let (left, right) = parts.remove(next).divide(kinds, depth);
        parts.insert(next, right);
        parts.insert(next, left);
    }
    let mut end = first;
    let work: Vec<(Part<'_>, usize)> = parts
        .into_iter()
        .map(|part| {
            let start = end;
            end += part.items.len();
            (part, start)
        })
        .collect();
    let boxes: Vec<Box32> = work.iter().map(|(part, _)| part.bounds).collect();
    let subtree = |(part, start): (Part<'_>, usize)| {
        if part.should_split(kinds, false) {
            Ok(build_node(part.items, kinds, start, depth + 1))
        } else {
            let kind = part
                .items
                .first()
                .map_or(LeafKind::Others, |item| kinds.of(item.index));
            Err(Child::leaf(kind, start, part.items.len()))
        }
    };
    let subtrees: Vec<Result<Vec<Node>, Child>> = if count > PARALLEL {
        work.into_par_iter().map(subtree).collect()
    } else {
        work.into_iter().map(subtree).collect()
    };

    let mut nodes = vec![Node::EMPTY];
    for (lane, (subtree, bounds)) in subtrees.into_iter().zip(&boxes).enumerate() {
        let child = match subtree {
            Err(leaf) => leaf,
            Ok(mut below) => {
                let offset = nodes.len() as u32;
                for child in below.iter_mut().flat_map(|node| &mut node.children) {
                    if !child.is_leaf() {
                        child.0 += offset;
                    }
                }
                nodes.append(&mut below);
                Child(offset)
            }
        };
        nodes[0].set(lane, bounds, child);
    }
    nodes
}

impl<'a> Part<'a> {
    fn new(items: &'a mut [Item], kinds: Kinds, depth: usize) -> Self {
        let mut bounds = Box32::EMPTY;
        let mut centers = Box32::EMPTY;
        let mut load = Load::default();
        for item in items.iter() {
            bounds.grow(&item.bounds);
            let center = [0, 1, 2].map(|k| item.bounds.center2(k));
            centers.grow(&Box32 {
                min: center,
                max: center,
            });
            load.add(kinds.load(item));
        }
        let split = if depth < SAH_DEPTH && items.len() > 1 {
            best_split(items, kinds, &centers)
        } else {
            None
        };
        Self {
            items,
            bounds,
            load,
            split,
        }
    }

    /// The part of greatest weight is split next: the largest, or the fullest where splits only halve.
    fn weight(&self, depth: usize) -> f32 {
        if depth < SAH_DEPTH {
            self.bounds.half_area()
        } else {
            self.items.len() as f32
        }
    }

    /// Whether it cannot stay one leaf, or splitting pays; a root is always split if it can be.
    fn should_split(&self, kinds: Kinds, is_root: bool) -> bool {
        let n = self.items.len();
        if n <= 1 {
            return false;
        }
        if n > LEAF_MAX || is_root || self.is_mixed(kinds) {
            return true;
        }
        let area = self.bounds.half_area();
        self.split
            .is_some_and(|split| split.cost + NODE_COST * area < self.load.cost() * area)
    }

    fn is_mixed(&self, kinds: Kinds) -> bool {
        let kind = |item: &Item| kinds.of(item.index);
        self.items.windows(2).any(|pair| kind(&pair[0]) != kind(&pair[1]))
    }

    fn divide(self, kinds: Kinds, depth: usize) -> (Self, Self) {
        let middle = match self.split {
            // Too few to be worth a box each, but of different kinds.
            _ if self.items.len() <= LEAF_MAX && self.is_mixed(kinds) => {
                let last = self.items.iter().map(|item| kinds.of(item.index)).max();
                partition(self.items, |item| Some(kinds.of(item.index)) < last)
            }
            Some(split) => partition(self.items, |item| split.bin(item) < split.plane),
            // All centers are the same, or the tree is too deep: halve.
            None => self.items.len() / 2,
        };
        let (left, right) = self.items.split_at_mut(middle);
        (Part::new(left, kinds, depth), Part::new(right, kinds, depth))
    }
}

impl Kinds {
    #[inline]
    fn load(self, item: &Item) -> Load {
        match self.of(item.index) {
            LeafKind::Others => Load { packed: 0, alone: 1 },
            _ => Load { packed: 1, alone: 0 },
        }
    }
}

/// Moves the items for which `left` holds to the front; their number.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) -> usize {
    let (mut begin, mut end) = (0, items.len());
    while begin < end {
        if left(&items[begin]) {
            begin += 1;
        } else {
            end -= 1;
            items.swap(begin, end);
        }
    }
    begin
}

/// The split of least cost (area times load, left plus right) over all three axes; `None` where all centers
/// coincide.
fn best_split(items: &[Item], kinds: Kinds, centers: &Box32) -> Option<Split> {
    let mut boxes = [[Box32::EMPTY; BINS]; 3];
    let mut loads = [[Load::default(); BINS]; 3];
    let scales = [0, 1, 2].map(|k| {
        let scale = BINS as f32 * 0.9999 / (centers.max[k] - centers.min[k]);
        if scale.is_finite() { scale } else { 0.0 }
    });
    for item in items {
        let load = kinds.load(item);
        for k in 0..3 {
            let i = bin(item.bounds.center2(k), centers.min[k], scales[k]);
            boxes[k][i].grow(&item.bounds);
            loads[k][i].add(load);
        }
    }
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        if scales[axis] == 0.0 {
            continue;
        }
        let mut right_cost = [f32::INFINITY; BINS];
        let (mut bounds, mut load) = (Box32::EMPTY, Load::default());
        for i in (1..BINS).rev() {
            bounds.grow(&boxes[axis][i]);
            load.add(loads[axis][i]);
            if !load.is_empty() {
                right_cost[i] = bounds.half_area() * load.cost();
            }
        }
        (bounds, load) = (Box32::EMPTY, Load::default());
        for plane in 1..BINS {
            bounds.grow(&boxes[axis][plane - 1]);
            load.add(loads[axis][plane - 1]);
            let cost = bounds.half_area() * load.cost() + right_cost[plane];
            if !load.is_empty() && cost.is_finite() && best.is_none_or(|b| cost < b.cost) {
                best = Some(Split {
                    axis,
                    min: centers.min[axis],
                    scale: scales[axis],
                    plane,
                    cost,
                });
            }
        }
    }
    best
}
