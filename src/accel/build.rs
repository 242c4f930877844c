//! Building: binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007), eight children at once by splitting the child of largest area again and again (as
//! Embree does), subtrees in parallel.

use rayon::prelude::*;

use super::boxes::{Box32, Child, Node};

const BINS: usize = 16;
/// Cost of visiting a node, in primitive tests.
const NODE_COST: f32 = 2.0;
/// A leaf of this size is not split further where that does not pay.
const LEAF_MAX: usize = 4;
/// Below this depth every split halves, which bounds the depth of the tree and so the traversal's stack.
const SAH_DEPTH: usize = 20;
/// Subtrees above this size are built in parallel.
const PARALLEL: usize = 4096;

/// A tree over primitives that are known by their boxes only.
#[derive(Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Primitive indices in the order of the leaves.
    pub(super) order: Vec<u32>,
}

/// A primitive while the tree is being built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Box32,
    index: u32,
}

/// What is to become a child: consecutive items, their box, and how best to split them.
struct Part<'a> {
    items: &'a mut [Item],
    bounds: Box32,
    split: Option<Split>,
}

/// Items below `plane` in bin units along `axis` go left.
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

impl Bvh {
    /// A tree over `boxes`; primitive `i` has the box `boxes[i]`. An empty box is never hit.
    #[must_use]
    pub fn build(boxes: &[Box32]) -> Self {
        let count = boxes.len().min(Child::PRIMITIVES_MAX);
        let mut items: Vec<Item> = boxes[..count]
            .iter()
            .zip(0..)
            .map(|(&bounds, index)| Item { bounds, index })
            .collect();
        if items.is_empty() {
            return Self::default();
        }
        let nodes = build_node(&mut items, 0, 0);
        Self {
            nodes,
            order: items.iter().map(|item| item.index).collect(),
        }
    }

    /// Bytes of memory the tree takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.order.len() * size_of::<u32>()
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Box32 {
        let mut bounds = Box32::EMPTY;
        if let Some(root) = self.nodes.first() {
            for lane in 0..8 {
                let plane = |k: usize| root.planes[k][lane];
                bounds.grow(&Box32 {
                    min: [plane(0), plane(1), plane(2)],
                    max: [plane(3), plane(4), plane(5)],
                });
            }
        }
        bounds
    }
}

/// Nodes of the subtree over `items`, its root first. `first` is the place of `items[0]` in the whole order;
/// node indices count from the subtree's root.
fn build_node(items: &mut [Item], first: usize, depth: usize) -> Vec<Node> {
    let count = items.len();
    let mut parts = vec![Part::new(items, depth)];
    while parts.len() < 8 {
        let widest = (0..parts.len())
            .filter(|&i| parts[i].should_split(parts.len() == 1))
            .max_by(|&a, &b| {
                parts[a]
                    .weight(depth)
                    .total_cmp(&parts[b].weight(depth))
                    .then(b.cmp(&a))
            });
        let Some(widest) = widest else { break };
        let (left, right) = parts.remove(widest).divide(depth);
        parts.insert(widest, right);
        parts.insert(widest, left);
    }
    let mut at = first;
    let starts: Vec<usize> = parts
        .iter()
        .map(|part| {
            at += part.items.len();
            at - part.items.len()
        })
        .collect();
    let boxes: Vec<Box32> = parts.iter().map(|part| part.bounds).collect();
    let subtree = |(part, start): (Part<'_>, usize)| {
        if part.is_leaf() {
            Err(Child::leaf(start, part.items.len()))
        } else {
            Ok(build_node(part.items, start, depth + 1))
        }
    };
    let work = parts.into_iter().zip(starts);
    let subtrees: Vec<Result<Vec<Node>, Child>> = if count > PARALLEL {
        work.collect::<Vec<_>>().into_par_iter().map(subtree).collect()
    } else {
        work.map(subtree).collect()
    };

    let mut nodes = vec![Node::EMPTY];
    for (lane, (subtree, bounds)) in subtrees.into_iter().zip(&boxes).enumerate() {
        let child = match subtree {
            Err(leaf) => leaf,
            Ok(mut below) => {
                let offset = nodes.len() as u32;
                for node in &mut below {
                    for child in &mut node.children {
                        if !child.is_leaf() {
                            child.0 += offset;
                        }
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
    fn new(items: &'a mut [Item], depth: usize) -> Self {
        let mut bounds = Box32::EMPTY;
        let mut centers = Box32::EMPTY;
        for item in items.iter() {
            bounds.grow(&item.bounds);
            let center = [0, 1, 2].map(|k| item.bounds.center2(k));
            centers.grow(&Box32 {
                min: center,
                max: center,
            });
        }
        let split = if depth < SAH_DEPTH && items.len() > 1 {
            best_split(items, &centers)
        } else {
            None
        };
        Self { items, bounds, split }
    }

    /// The part of greatest weight is split next: the largest, or the fullest where splits only halve.
    fn weight(&self, depth: usize) -> f32 {
        if depth < SAH_DEPTH {
            self.bounds.half_area()
        } else {
            self.items.len() as f32
        }
    }

    fn is_leaf(&self) -> bool {
        !self.should_split(false)
    }

    /// Whether splitting pays; a root is always split if it can be.
    fn should_split(&self, is_root: bool) -> bool {
        let n = self.items.len();
        if n <= 1 {
            return false;
        }
        if n > LEAF_MAX || is_root {
            return true;
        }
        let area = self.bounds.half_area();
        self.split
            .is_some_and(|split| split.cost + NODE_COST * area < n as f32 * area)
    }

    fn divide(self, depth: usize) -> (Self, Self) {
        let middle = match self.split {
            Some(split) => partition(self.items, |item| split.bin(item) < split.plane),
            // All centers are the same, or the tree is too deep: halve.
            None => self.items.len() / 2,
        };
        let (left, right) = self.items.split_at_mut(middle);
        (Part::new(left, depth), Part::new(right, depth))
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

/// The split of least cost (area times number, left plus right) over all three axes; `None` where all centers
/// coincide.
fn best_split(items: &[Item], centers: &Box32) -> Option<Split> {
    let mut boxes = [[Box32::EMPTY; BINS]; 3];
    let mut counts = [[0u32; BINS]; 3];
    let scales = [0, 1, 2].map(|k| {
        let scale = BINS as f32 * 0.9999 / (centers.max[k] - centers.min[k]);
        if scale.is_finite() { scale } else { 0.0 }
    });
    for item in items {
        for k in 0..3 {
            let i = bin(item.bounds.center2(k), centers.min[k], scales[k]);
            boxes[k][i].grow(&item.bounds);
            counts[k][i] += 1;
        }
    }
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        if scales[axis] == 0.0 {
            continue;
        }
        let mut right_cost = [f32::INFINITY; BINS];
        let (mut bounds, mut count) = (Box32::EMPTY, 0);
        for i in (1..BINS).rev() {
            bounds.grow(&boxes[axis][i]);
            count += counts[axis][i];
            if count > 0 {
                right_cost[i] = bounds.half_area() * count as f32;
            }
        }
        (bounds, count) = (Box32::EMPTY, 0);
        for plane in 1..BINS {
            bounds.grow(&boxes[axis][plane - 1]);
            count += counts[axis][plane - 1];
            let cost = bounds.half_area() * count as f32 + right_cost[plane];
            if count > 0 && cost.is_finite() && best.is_none_or(|b| cost < b.cost) {
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
