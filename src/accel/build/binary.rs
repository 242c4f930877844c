//! The binary tree: binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007), subtrees in parallel. On the way up each node learns what it costs as 1 to 8 children of
//! a wide node.

use super::{Aabb, Item, Kinds, LEAF_MAX, Load, NODE_COST};
use crate::accel::{boxes::Box32, four::F4};

const BINS: usize = 16;
/// Below this depth every split halves, which bounds the depth of the tree and so the traversal's stack.
const SAH_DEPTH: usize = 48;
/// Subtrees above this size are built in parallel.
const PARALLEL: usize = 4096;

/// How a subtree becomes at most j children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// As one child, which is a node of its own.
    Node,
    /// As one child, which is a leaf.
    Leaf,
    /// As with j - 1.
    Fewer,
    /// The left part as at most so many children, the right part as the rest.
    Split(u8),
}

/// A node of the binary tree over consecutive items.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Box32,
    /// Indices of the parts; 0 and 0 in a leaf.
    pub(super) left: u32,
    pub(super) right: u32,
    /// The items it covers.
    pub(super) first: u32,
    pub(super) count: u32,
    /// Surface of its items.
    pub(super) area: f32,
    /// Least expected cost as at most 1, 2, ... 8 children.
    pub(super) cost: [f32; 8],
    pub(super) cut: [Cut; 8],
    /// The cut into exactly the eight children of a node of its own.
    pub(super) own: Cut,
}

/// Nodes of the binary tree; the parts of a node come before it, so the root is the last.
pub(super) struct Tree {
    pub(super) nodes: Vec<Binary>,
}

impl Tree {
    pub(super) fn build(items: &mut [Item], kinds: Kinds) -> Self {
        let mut nodes = Vec::with_capacity(items.len());
        build(items, kinds, 0, 0, &mut nodes);
        Self { nodes }
    }

    pub(super) fn root(&self) -> Option<&Binary> {
        self.nodes.last()
    }
}

/// Appends the subtree over `items`, its root last. `first` is the place of `items[0]` among all items.
fn build(items: &mut [Item], kinds: Kinds, first: usize, depth: usize, out: &mut Vec<Binary>) {
    let summary = Summary::of(items, kinds);
    let n = items.len();
    if n == 1 || n <= 2 && summary.kind_is_one {
        out.push(summary.leaf(first, n));
        return;
    }
    let split = if depth < SAH_DEPTH {
        best_split(items, kinds, &summary.centers)
    } else {
        None
    };
    let middle = match split {
        Some(split) => partition(items, |item| split.is_left(item)),
        // All centers are the same, or the tree is too deep: halve.
        None => n / 2,
    };
    let (left, right) = items.split_at_mut(middle);
    let middle = first + left.len();
    if n > PARALLEL {
        let part = |items: &mut [Item], first: usize| {
            let mut nodes = Vec::with_capacity(items.len());
            build(items, kinds, first, depth + 1, &mut nodes);
            nodes
        };
        let (below_left, below_right) = rayon::join(|| part(left, first), || part(right, middle));
        append(out, below_left);
        let left = out.len() - 1;
        append(out, below_right);
        out.push(summary.inner(first, n, left, out));
    } else {
        build(left, kinds, first, depth + 1, out);
        let left = out.len() - 1;
        build(right, kinds, middle, depth + 1, out);
        out.push(summary.inner(first, n, left, out));
    }
}

fn append(out: &mut Vec<Binary>, nodes: Vec<Binary>) {
    let offset = out.len() as u32;
    out.extend(nodes.into_iter().map(|mut node| {
        if node.left != node.right {
            node.left += offset;
            node.right += offset;
        }
        node
    }));
}

/// What is known of items before they are split.
struct Summary {
    bounds: Aabb,
    /// Around twice the centers.
    centers: Aabb,
    load: Load,
    area: f32,
    kind_is_one: bool,
}

impl Summary {
    fn of(items: &[Item], kinds: Kinds) -> Self {
        let mut summary = Self {
            bounds: Aabb::empty(),
            centers: Aabb::empty(),
            load: Load::default(),
            area: 0.0,
            kind_is_one: true,
        };
        let kind = items.first().map(|item| kinds.of(item.index));
        for item in items {
            let bounds = item.bounds();
            summary.bounds.grow(&bounds);
            summary.centers.grow_point(bounds.min.add(bounds.max));
            summary.load.add(Load::of(item, kinds));
            summary.area += item.area;
            summary.kind_is_one &= Some(kinds.of(item.index)) == kind;
        }
        summary
    }

    fn leaf(&self, first: usize, count: usize) -> Binary {
        let cost = self.bounds.half_area() * self.load.cost();
        Binary {
            bounds: self.bounds.to_box(),
            left: 0,
            right: 0,
            first: first as u32,
            count: count as u32,
            area: self.area,
            cost: [cost; 8],
            cut: [
                Cut::Leaf,
                Cut::Fewer,
                Cut::Fewer,
                Cut::Fewer,
                Cut::Fewer,
                Cut::Fewer,
                Cut::Fewer,
                Cut::Fewer,
            ],
            own: Cut::Leaf,
        }
    }

    /// The node above the subtree that ends at `left` and the one that ends the list. The least cost as j
    /// children is the least sum over all ways to share j between the parts (Wald, Benthin and Boulos, "Getting
    /// rid of packets", 2008, do this greedily; by dynamic programming it is exact).
    fn inner(&self, first: usize, count: usize, left: usize, nodes: &[Binary]) -> Binary {
        let right = nodes.len() - 1;
        let (l, r) = (&nodes[left].cost, &nodes[right].cost);
        let (mut cost, mut cut) = ([f32::INFINITY; 8], [Cut::Fewer; 8]);
        for j in 2..=8 {
            for k in 1..j {
                let sum = l[k - 1] + r[j - k - 1];
                if sum < cost[j - 1] {
                    (cost[j - 1], cut[j - 1]) = (sum, Cut::Split(k as u8));
                }
            }
        }
        // Where costs overflow to infinity any share will do.
        let own = if cut[7] == Cut::Fewer {
            Cut::Split(4)
        } else {
            cut[7]
        };
        let area = self.bounds.half_area();
        (cost[0], cut[0]) = (area * NODE_COST + cost[7], Cut::Node);
        if count <= LEAF_MAX && self.kind_is_one && area * self.load.cost() <= cost[0] {
            (cost[0], cut[0]) = (area * self.load.cost(), Cut::Leaf);
        }
        for j in 1..8 {
            if !(cost[j] < cost[j - 1]) {
                (cost[j], cut[j]) = (cost[j - 1], Cut::Fewer);
            }
        }
        Binary {
            bounds: self.bounds.to_box(),
            left: left as u32,
            right: right as u32,
            first: first as u32,
            count: count as u32,
            area: self.area,
            cost,
            cut,
            own,
        }
    }
}

/// Where twice the centers fall into bins along each axis.
#[derive(Clone, Copy)]
struct Binning {
    min: F4,
    scale: F4,
}

impl Binning {
    fn new(centers: &Aabb) -> Self {
        let scale = centers.max.sub(centers.min).to_array().map(|extent| {
            let scale = BINS as f32 * 0.9999 / extent;
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self {
            min: centers.min,
            scale: F4::from_array(scale),
        }
    }

    /// A saturating cast: what is not a number lands in bin 0.
    #[inline(always)]
    fn bins(&self, bounds: &Aabb) -> [usize; 4] {
        let place = bounds.min.add(bounds.max).sub(self.min).mul(self.scale);
        place.to_array().map(|x| (x as i32 as usize).min(BINS - 1))
    }
}

/// Items in bins below `plane` along `axis` go left.
#[derive(Clone, Copy)]
struct Split {
    binning: Binning,
    axis: usize,
    plane: usize,
    cost: f32,
}

impl Split {
    #[inline]
    fn is_left(&self, item: &Item) -> bool {
        self.binning.bins(&item.bounds())[self.axis] < self.plane
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
fn best_split(items: &[Item], kinds: Kinds, centers: &Aabb) -> Option<Split> {
    let mut boxes = [[Aabb::empty(); BINS]; 3];
    let mut loads = [[Load::default(); BINS]; 3];
    let binning = Binning::new(centers);
    for item in items {
        let load = Load::of(item, kinds);
        let bounds = item.bounds();
        let bins = binning.bins(&bounds);
        for k in 0..3 {
            boxes[k][bins[k]].grow(&bounds);
            loads[k][bins[k]].add(load);
        }
    }
    let scales = binning.scale.to_array();
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        if scales[axis] == 0.0 {
            continue;
        }
        let mut right_cost = [f32::INFINITY; BINS];
        let (mut bounds, mut load) = (Aabb::empty(), Load::default());
        for i in (1..BINS).rev() {
            bounds.grow(&boxes[axis][i]);
            load.add(loads[axis][i]);
            if !load.is_empty() {
                right_cost[i] = bounds.half_area() * load.cost();
            }
        }
        (bounds, load) = (Aabb::empty(), Load::default());
        for plane in 1..BINS {
            bounds.grow(&boxes[axis][plane - 1]);
            load.add(loads[axis][plane - 1]);
            let cost = bounds.half_area() * load.cost() + right_cost[plane];
            if !load.is_empty() && cost.is_finite() && best.is_none_or(|b| cost < b.cost) {
                best = Some(Split {
                    binning,
                    axis,
                    plane,
                    cost,
                });
            }
        }
    }
    best
}
