//! The binary tree over one subtree. On the way up each node learns what it costs as 1 to 8 children of a wide
//! node.

use super::{
    ALONE_COST, APART, Aabb, Context, Items, LEAF_MAX, NODE_COST, Primitive, Summary, divide::halves,
};
use crate::accel::{
    boxes::{Box32, LeafKind},
    four::F4,
};

/// A node of the binary tree over consecutive items.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Box32,
    /// Surface of its items.
    pub(super) area: f32,
    /// Least expected cost as at most 1, 2, ... 8 children.
    pub(super) cost: [f32; 8],
    /// Index of the left part; the right part stands before the node itself. In a node without parts, a leaf's or
    /// a link's, nothing.
    pub(super) left: u32,
    /// The first of a leaf's items, or the tree a link leads to.
    pub(super) first: u32,
    /// Items of a leaf.
    pub(super) count: u8,
    /// What a leaf holds.
    pub(super) kind: LeafKind,
    /// As one child it is a leaf.
    pub(super) is_leaf: bool,
    is_link: bool,
}

/// Appends the subtree over `items`, its root last. `first` is the place of the first item in the subtree's slice.
pub(super) fn build(
    mut items: Items<'_>,
    context: &Context<'_>,
    summary: &Summary,
    first: usize,
    depth: usize,
    out: &mut Vec<Binary>,
) {
    let n = items.count;
    if n == 1 || n <= LEAF_MAX && context.kinds.are_one(items.live()) {
        few(items.live(), context, &summary.bounds, first, out);
        return;
    }
    let [(left, left_summary), (right, right_summary)] = halves(items, context, summary, depth);
    let right_first = first + left.all.len();
    build(left, context, &left_summary, first, depth + 1, out);
    let left = out.len() - 1;
    build(right, context, &right_summary, right_first, depth + 1, out);
    out.push(Binary::join(out, left, &summary.bounds, context.memory));
}

/// Appends what fits one leaf: as a leaf, or, where their boxes are so far apart that it pays, as several.
fn few(items: &mut [Primitive], context: &Context<'_>, bounds: &Aabb, first: usize, out: &mut Vec<Binary>) {
    let boxes: [Aabb; LEAF_MAX] =
        std::array::from_fn(|i| items.get(i).map_or(Aabb::empty(), Primitive::aabb));
    let around = |mask: usize| {
        let mut around = Aabb::empty();
        for (i, bounds) in boxes.iter().enumerate() {
            if mask >> i & 1 == 1 {
                around.grow(bounds);
            }
        }
        around
    };
    // Bits of the items that go left; the last item stays right, so that no division is tried twice.
    let last = 1 << (items.len() - 1);
    let all = 2 * last - 1;
    let (mut least, mut left) = (APART * bounds.half_area(), 0);
    for mask in 1..last {
        let area = around(mask).half_area() + around(all & !mask).half_area();
        if area < least {
            (least, left) = (area, mask);
        }
    }
    if left == 0 {
        out.push(Binary::leaf(items, context, bounds, first));
        return;
    }
    let mut middle = 0;
    for i in 0..items.len() {
        if left >> i & 1 == 1 {
            items.swap(middle, i);
            middle += 1;
        }
    }
    let as_leaf = Binary::leaf(items, context, bounds, first);
    let (left_items, right_items) = items.split_at_mut(middle);
    few(left_items, context, &around(left), first, out);
    let left_node = out.len() - 1;
    few(right_items, context, &around(all & !left), first + middle, out);
    let divided = Binary::join(out, left_node, bounds, context.memory);
    out.push(divided.or_leaf(&as_leaf));
}

impl Binary {
    /// A leaf of items of one kind.
    fn leaf(items: &[Primitive], context: &Context<'_>, bounds: &Aabb, first: usize) -> Self {
        let kind = items
            .first()
            .map_or(LeafKind::Others, |item| context.kinds.of(item));
        let cost = match kind {
            LeafKind::Others => bounds.half_area() * (ALONE_COST * items.len() as u32) as f32,
            _ => bounds.half_area() + context.memory,
        };
        Self {
            bounds: bounds.to_box(),
            area: items.iter().map(Primitive::area).sum(),
            cost: [cost; 8],
            left: 0,
            first: first as u32,
            count: items.len() as u8,
            kind,
            is_leaf: true,
            is_link: false,
        }
    }

    /// Stands for the root of another tree.
    pub(super) fn link(root: Self, tree: usize) -> Self {
        Self {
            first: tree as u32,
            is_link: true,
            ..root
        }
    }

    /// The tree a link leads to.
    #[inline]
    pub(super) fn linked(&self) -> Option<usize> {
        self.is_link.then_some(self.first as usize)
    }

    /// Its items of all that its tree is over, where it is a leaf.
    pub(super) fn items<'i>(&self, all: &'i [Primitive]) -> &'i [Primitive] {
        &all[self.first as usize..][..usize::from(self.count)]
    }

    /// The node above the one at `left` and the last. The least cost as j children is the least sum over all ways to
    /// share j between the parts (Wald, Benthin and Boulos, "Getting rid of packets", 2008, do this greedily; by dynamic
    /// programming it is exact). As one child it costs `memory` more.
    pub(super) fn join(nodes: &[Self], left: usize, bounds: &Aabb, memory: f32) -> Self {
        let (l, r) = (&nodes[left], &nodes[nodes.len() - 1]);
        // Behind infinities, so that loading from k places before gives the costs of the rest, j - k.
        let mut rest = [f32::INFINITY; 16];
        rest[8..].copy_from_slice(&r.cost);
        let load = |at: usize| F4::from_array([rest[at], rest[at + 1], rest[at + 2], rest[at + 3]]);
        let (mut low, mut high) = (F4::splat(f32::INFINITY), F4::splat(f32::INFINITY));
        for k in 1..8 {
            let share = F4::splat(l.cost[k - 1]);
            low = share.add(load(8 - k)).min(low);
            high = share.add(load(12 - k)).min(high);
        }
        let own = high.to_array()[3];
        let bound = F4::splat(bounds.half_area() * NODE_COST + own + memory);
        let ([a, b, c, d], [e, f, g, h]) = (low.min(bound).to_array(), high.min(bound).to_array());
        Self {
            bounds: bounds.to_box(),
            area: l.area + r.area,
            cost: [a, b, c, d, e, f, g, h],
            left: left as u32,
            first: l.first,
            // Without meaning where it is no leaf.
            count: 0,
            kind: LeafKind::Others,
            is_leaf: false,
            is_link: false,
        }
    }

    /// The same, or a leaf where that costs no more.
    fn or_leaf(self, leaf: &Self) -> Self {
        if !(leaf.cost[0] <= self.cost[0]) {
            return self;
        }
        Self {
            cost: self.cost.map(|cost| cost.min(leaf.cost[0])),
            left: self.left,
            ..*leaf
        }
    }
}
