//! From binary trees to nodes of eight children, by the least costs they found.

use rayon::prelude::*;

use super::{
    Aabb, Bvh, Context, Items, LEAF_MAX, Leaves, Primitive, Stop,
    binary::{self, Binary},
    divide::{Part, Subtree},
};
use crate::accel::{
    blocks::NONE,
    boxes::{Box32, Child, LeafKind, Node},
};

/// The nodes above, and what is below them.
pub(super) struct Collapsed {
    /// A child that is a leaf here stands for the part of that index.
    top: Vec<Node>,
    parts: Vec<(Child, Output)>,
    /// Around everything.
    bounds: Box32,
}

/// Builds the subtrees as binary trees, and sees them all as one tree of nodes of eight children.
pub(super) fn collapse(top: Part<'_>, context: &Context<'_>) -> Collapsed {
    let mut subtrees = Vec::new();
    let shape = shape(top, &mut subtrees);
    let (items, built): (Vec<&[Primitive]>, Vec<Vec<Binary>>) = subtrees
        .into_par_iter()
        .map_init(Vec::new, |scratch, subtree| build(subtree, context, scratch))
        .unzip();
    if (context.stop)() {
        return Collapsed::nothing();
    }
    let mut tree = Vec::with_capacity(2 * built.len());
    join(&shape, &built, context.memory, &mut tree);
    let trees: Vec<&[Binary]> = std::iter::once(&tree)
        .chain(&built)
        .map(|tree| &tree[..])
        .collect();
    let root = Place::root(&trees, 0);
    let mut ends = Vec::new();
    let mut above = Emitter {
        trees: &trees,
        home: 0,
        memory: context.memory,
        output: Output::default(),
        leaf: |_: &mut Output, end: Place, _: &[Binary]| {
            ends.push(end);
            Child::leaf(LeafKind::Others, ends.len() - 1, 1)
        },
    };
    if tree.len() > 1 {
        above.node(root);
    } else {
        above.child(root);
    }
    let top = above.output.nodes;
    let parts = ends
        .into_par_iter()
        .filter(|_| !(context.stop)())
        .map(|end| {
            let mut emitter = Emitter {
                trees: &trees,
                home: end.tree,
                memory: context.memory,
                output: Output::default(),
                leaf: |output: &mut Output, _: Place, leaves: &[Binary]| {
                    let items = items[end.tree - 1];
                    output.leaf(leaves[0].kind, leaves.iter().flat_map(|leaf| leaf.items(items)))
                },
            };
            let child = emitter.child(end);
            let mut output = emitter.output;
            output.nodes.shrink_to_fit();
            output.others.shrink_to_fit();
            output.leaves.triangles.shrink_to_fit();
            output.leaves.spheres.shrink_to_fit();
            output.leaves.cuboids.shrink_to_fit();
            (child, output)
        })
        .collect();
    let bounds = tree.last().map_or(Box32::EMPTY, |root| root.bounds);
    Collapsed { top, parts, bounds }
}

/// The binary tree of a subtree, and the items its leaves speak of.
fn build<'a>(
    subtree: Subtree<'a>,
    context: &Context<'_>,
    scratch: &mut Vec<Binary>,
) -> (&'a [Primitive], Vec<Binary>) {
    let Items { all, count } = subtree.items;
    let items = Items {
        all: &mut *all,
        count,
    };
    scratch.clear();
    if (context.stop)() {
        return (all, Vec::new());
    }
    binary::build(items, context, &subtree.summary, 0, subtree.depth, scratch);
    (all, scratch.to_vec())
}

impl Collapsed {
    fn nothing() -> Self {
        Self {
            top: Vec::new(),
            parts: Vec::new(),
            bounds: Box32::EMPTY,
        }
    }

    /// Puts everything into one list.
    pub(super) fn assemble(self, stop: &Stop<'_>) -> (Bvh, Leaves) {
        let Self { top, parts, bounds } = self;
        let total = |count: fn(&Output) -> usize| parts.iter().map(|(_, part)| count(part)).sum::<usize>();
        let mut all = Output::default();
        all.nodes
            .reserve_exact(top.len().max(1) + total(|o| o.nodes.len()));
        all.others.reserve_exact(total(|o| o.others.len()));
        let leaves = &mut all.leaves;
        leaves
            .triangles
            .reserve_exact(total(|o| o.leaves.triangles.len()));
        leaves.spheres.reserve_exact(total(|o| o.leaves.spheres.len()));
        leaves.cuboids.reserve_exact(total(|o| o.leaves.cuboids.len()));
        let above = top.len();
        all.nodes.extend(top);
        let roots: Vec<Child> = parts
            .into_iter()
            .take_while(|_| !stop())
            .map(|(child, part)| all.append(child, part))
            .collect();
        for node in &mut all.nodes[..above] {
            for child in node.children.iter_mut().filter(|child| child.is_leaf()) {
                *child = roots.get(child.range().start).copied().unwrap_or(Child::NOTHING);
            }
        }
        // A single leaf, without a node above.
        if let (true, [leaf]) = (all.nodes.is_empty(), &roots[..]) {
            let mut root = Node::EMPTY;
            root.set(0, &bounds, *leaf);
            all.nodes.push(root);
        }
        let Output {
            nodes,
            others,
            leaves,
        } = all;
        let extent = nodes.first().map_or(0.0, Node::extent);
        let bvh = Bvh {
            nodes,
            others,
            extent,
        };
        (bvh, leaves)
    }
}

/// How subtrees are joined.
enum Shape {
    Subtree(usize),
    Pair(Box<[Shape; 2]>, Aabb),
}

fn shape<'a>(part: Part<'a>, subtrees: &mut Vec<Subtree<'a>>) -> Shape {
    match part {
        Part::Subtree(subtree) => {
            subtrees.push(subtree);
            Shape::Subtree(subtrees.len() - 1)
        }
        Part::Pair(parts, bounds) => {
            let parts = (*parts).map(|part| shape(part, subtrees));
            Shape::Pair(Box::new(parts), bounds)
        }
    }
}

/// Appends the binary tree whose ends are links to subtrees; its root's index.
fn join(shape: &Shape, built: &[Vec<Binary>], memory: f32, tree: &mut Vec<Binary>) -> usize {
    match shape {
        Shape::Subtree(index) => {
            let root = built[*index].last().copied();
            tree.extend(root.map(|root| Binary::link(root, *index)));
        }
        Shape::Pair(parts, bounds) => {
            let left = join(&parts[0], built, memory, tree);
            join(&parts[1], built, memory, tree);
            tree.push(Binary::join(tree, left, bounds, memory));
        }
    }
    tree.len() - 1
}

/// Nodes and leaves.
#[derive(Default)]
struct Output {
    nodes: Vec<Node>,
    others: Vec<u32>,
    leaves: Leaves,
}

impl Output {
    /// A leaf of items of one kind, no more than a block holds.
    fn leaf<'i>(&mut self, kind: LeafKind, items: impl Iterator<Item = &'i Primitive>) -> Child {
        let mut indices = [NONE; LEAF_MAX];
        let mut count = 0;
        for (index, item) in indices.iter_mut().zip(items) {
            *index = item.index();
            count += 1;
        }
        // What is not used stays last. The halves of a triangle that was cut may meet again.
        indices.sort_unstable();
        for i in (1..LEAF_MAX).rev() {
            if indices[i] == indices[i - 1] {
                indices[i] = NONE;
            }
        }
        indices.sort_unstable();
        let blocks = match kind {
            LeafKind::Triangles => &mut self.leaves.triangles,
            LeafKind::Spheres => &mut self.leaves.spheres,
            LeafKind::Cuboids => &mut self.leaves.cuboids,
            LeafKind::Others => {
                self.others.extend_from_slice(&indices[..count]);
                return Child::leaf(kind, self.others.len() - count, count);
            }
        };
        blocks.push(indices);
        Child::leaf(kind, blocks.len() - 1, 1)
    }

    /// Appends a part with this root; its root here.
    fn append(&mut self, root: Child, part: Self) -> Child {
        let first = [
            self.leaves.triangles.len(),
            self.leaves.spheres.len(),
            self.leaves.cuboids.len(),
            self.others.len(),
        ];
        let first_node = self.nodes.len();
        let moved = |child: Child| {
            if child == Child::NOTHING {
                child
            } else if child.is_leaf() {
                let range = child.range();
                Child::leaf(
                    child.kind(),
                    range.start + first[child.kind() as usize],
                    range.len(),
                )
            } else {
                Child::node(child.0 as usize + first_node)
            }
        };
        self.nodes.extend(part.nodes.into_iter().map(|mut node| {
            node.children = node.children.map(moved);
            node
        }));
        self.others.extend(part.others);
        self.leaves.triangles.extend(part.leaves.triangles);
        self.leaves.spheres.extend(part.leaves.spheres);
        self.leaves.cuboids.extend(part.leaves.cuboids);
        moved(root)
    }
}

/// A node of one of several binary trees.
#[derive(Clone, Copy, Default)]
struct Place {
    tree: usize,
    index: usize,
}

impl Place {
    fn root(trees: &[&[Binary]], tree: usize) -> Self {
        Self {
            tree,
            index: trees[tree].len() - 1,
        }
    }
}

/// Makes nodes of the binary tree `home`; `leaf` makes its leaves, of several what they hold together, and what of other
/// trees is a child.
struct Emitter<'a, F> {
    trees: &'a [&'a [Binary]],
    home: usize,
    memory: f32,
    output: Output,
    leaf: F,
}

impl<F: FnMut(&mut Output, Place, &[Binary]) -> Child> Emitter<'_, F> {
    /// The node at a place, and where a link to another tree leads to.
    fn at(&self, place: Place) -> (Place, &Binary) {
        let binary = &self.trees[place.tree][place.index];
        match binary.linked() {
            Some(subtree) => self.at(Place::root(self.trees, subtree + 1)),
            None => (place, binary),
        }
    }

    fn child(&mut self, place: Place) -> Child {
        let (place, binary) = self.at(place);
        if place.tree != self.home || binary.is_leaf {
            let binary = *binary;
            (self.leaf)(&mut self.output, place, &[binary])
        } else {
            self.node(place)
        }
    }

    /// Makes a node whose children are the best cut of a binary node in eight.
    fn node(&mut self, place: Place) -> Child {
        let mut children = Children::NONE;
        self.share(place, 8, &mut children);
        children.merge(self.trees[self.home], self.memory);
        let node = self.output.nodes.len();
        self.output.nodes.push(Node::EMPTY);
        for (lane, one) in children.lanes[..children.count].iter().enumerate() {
            let child = match one.leaves {
                0 | 1 => self.child(one.place),
                leaves => {
                    let tree = self.trees[self.home];
                    let leaves = &one.indices.map(|index| tree[index as usize])[..leaves];
                    (self.leaf)(&mut self.output, one.place, leaves)
                }
            };
            self.output.nodes[node].set(lane, &one.bounds, child);
        }
        Child::node(node)
    }

    /// Collects the parts of a binary node as at most `room` children.
    fn share(&self, place: Place, room: usize, children: &mut Children) {
        let binary = &self.trees[place.tree][place.index];
        let [left, right] = [binary.left as usize, place.index.wrapping_sub(1)].map(|index| Place {
            tree: place.tree,
            index,
        });
        let (left_cost, right_cost) = (&self.at(left).1.cost, &self.at(right).1.cost);
        // Where costs overflow to infinity any share will do.
        let (mut least, mut best) = (f32::INFINITY, room / 2);
        for k in 1..room {
            let cost = left_cost[k - 1] + right_cost[room - k - 1];
            if cost < least {
                (least, best) = (cost, k);
            }
        }
        self.gather(left, best, children);
        self.gather(right, room - best, children);
    }

    /// Collects a binary node as at most `room` children.
    fn gather(&self, place: Place, mut room: usize, children: &mut Children) {
        let (place, binary) = self.at(place);
        while room > 1 && binary.cost[room - 2] <= binary.cost[room - 1] {
            room -= 1;
        }
        if room > 1 {
            self.share(place, room, children);
        } else {
            children.push(place, binary, place.tree == self.home);
        }
    }
}

/// A child of a node.
#[derive(Clone, Copy)]
struct Lane {
    place: Place,
    bounds: Box32,
    promise: f32,
    /// The leaves that share its block, and their number: 0 where it is none of this tree.
    indices: [u32; LEAF_MAX],
    leaves: usize,
    /// Items of all of these.
    items: usize,
}

impl Lane {
    const NOTHING: Self = Self {
        place: Place { tree: 0, index: 0 },
        bounds: Box32::EMPTY,
        promise: 0.0,
        indices: [0; LEAF_MAX],
        leaves: 0,
        items: 0,
    };

    /// Takes in what another has, which has room.
    fn join(&mut self, other: &Self) {
        self.bounds = self.bounds.union(&other.bounds);
        self.indices[self.leaves..][..other.leaves].copy_from_slice(&other.indices[..other.leaves]);
        self.leaves += other.leaves;
        self.items += other.items;
    }
}

/// The children of a node, in ascending order of promise: a shadow ray goes to the last lane it enters first,
/// which is to be the one that blocks most for its cost.
struct Children {
    count: usize,
    lanes: [Lane; 8],
}

impl Children {
    const NONE: Self = Self {
        count: 0,
        lanes: [Lane::NOTHING; 8],
    };

    fn push(&mut self, place: Place, binary: &Binary, is_home: bool) {
        let promise = binary.area / binary.cost[0].max(f32::MIN_POSITIVE);
        let leaves = usize::from(is_home && binary.is_leaf);
        let mut lane = self.count;
        while lane > 0 && promise < self.lanes[lane - 1].promise {
            self.lanes[lane] = self.lanes[lane - 1];
            lane -= 1;
        }
        self.lanes[lane] = Lane {
            place,
            bounds: binary.bounds,
            promise,
            indices: [place.index as u32; LEAF_MAX],
            leaves,
            items: leaves * usize::from(binary.count),
        };
        self.count += 1;
    }

    /// Puts leaves of a tree into one block as long as there are two that fit, and their box has less surface than theirs
    /// and what the memory of a block counts for.
    fn merge(&mut self, tree: &[Binary], memory: f32) {
        loop {
            let (mut least, mut best) = (memory, None);
            for right in 1..self.count {
                for left in 0..right {
                    let (a, b) = (&self.lanes[left], &self.lanes[right]);
                    if a.leaves == 0 || b.leaves == 0 || a.items + b.items > LEAF_MAX {
                        continue;
                    }
                    let [kind, other] = [a, b].map(|lane| tree[lane.place.index].kind);
                    if kind != other || kind == LeafKind::Others {
                        continue;
                    }
                    let more =
                        a.bounds.union(&b.bounds).half_area() - a.bounds.half_area() - b.bounds.half_area();
                    if more < least {
                        (least, best) = (more, Some((left, right)));
                    }
                }
            }
            let Some((left, right)) = best else {
                return;
            };
            let less_promising = self.lanes[left];
            self.lanes[right].join(&less_promising);
            self.lanes.copy_within(left + 1..self.count, left);
            self.count -= 1;
        }
    }
}
