//! From binary trees to nodes of eight children, by the least costs they found.

use rayon::prelude::*;

use super::{
    Aabb, Bvh, Context, Items, Kinds, LEAF_MAX, Leaves, Primitive, Stop,
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
    join(&shape, &built, &mut tree);
    let trees: Vec<&[Binary]> = std::iter::once(&tree)
        .chain(&built)
        .map(|tree| &tree[..])
        .collect();
    let root = Place::root(&trees, 0);
    let mut ends = Vec::new();
    let mut above = Emitter {
        trees: &trees,
        home: 0,
        output: Output::default(),
        leaf: |_: &mut Output, end: Place, _: &Binary| {
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
                output: Output::default(),
                leaf: |output: &mut Output, _: Place, binary: &Binary| {
                    let items = &items[end.tree - 1][binary.first as usize..];
                    output.leaf(&items[..usize::from(binary.count)], context.kinds)
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
fn join(shape: &Shape, built: &[Vec<Binary>], tree: &mut Vec<Binary>) -> usize {
    match shape {
        Shape::Subtree(index) => {
            let root = built[*index].last().copied();
            tree.extend(root.map(|root| Binary::link(root, *index)));
        }
        Shape::Pair(parts, bounds) => {
            let left = join(&parts[0], built, tree);
            join(&parts[1], built, tree);
            tree.push(Binary::join(tree, left, bounds, None));
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
    fn leaf(&mut self, items: &[Primitive], kinds: Kinds) -> Child {
        let mut indices = [NONE; LEAF_MAX];
        for (index, item) in indices.iter_mut().zip(items) {
            *index = item.index();
        }
        // What is not used stays last. The halves of a triangle that was cut may meet again.
        indices.sort_unstable();
        for i in (1..LEAF_MAX).rev() {
            if indices[i] == indices[i - 1] {
                indices[i] = NONE;
            }
        }
        indices.sort_unstable();
        let kind = items.first().map_or(LeafKind::Others, |item| kinds.of(item));
        let blocks = match kind {
            LeafKind::Triangles => &mut self.leaves.triangles,
            LeafKind::Spheres => &mut self.leaves.spheres,
            LeafKind::Cuboids => &mut self.leaves.cuboids,
            LeafKind::Others => {
                self.others.extend_from_slice(&indices[..items.len()]);
                return Child::leaf(kind, self.others.len() - items.len(), items.len());
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

/// Makes nodes of the binary tree `home`; `leaf` makes its leaves, and what of other trees is a child.
struct Emitter<'a, F> {
    trees: &'a [&'a [Binary]],
    home: usize,
    output: Output,
    leaf: F,
}

impl<F: FnMut(&mut Output, Place, &Binary) -> Child> Emitter<'_, F> {
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
            (self.leaf)(&mut self.output, place, &binary)
        } else {
            self.node(place)
        }
    }

    /// Makes a node whose children are the best cut of a binary node in eight.
    fn node(&mut self, place: Place) -> Child {
        let mut children = Children::default();
        self.share(place, 8, &mut children);
        let node = self.output.nodes.len();
        self.output.nodes.push(Node::EMPTY);
        for lane in 0..children.count {
            let place = children.places[lane];
            let child = self.child(place);
            let bounds = self.at(place).1.bounds;
            self.output.nodes[node].set(lane, &bounds, child);
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
            children.push(place, binary);
        }
    }
}

/// The children of a node, in ascending order of promise: a shadow ray goes to the last lane it enters first,
/// which is to be the one that blocks most for its cost.
#[derive(Default)]
struct Children {
    count: usize,
    places: [Place; 8],
    promises: [f32; 8],
}

impl Children {
    fn push(&mut self, at: Place, binary: &Binary) {
        let promise = binary.area / binary.cost[0].max(f32::MIN_POSITIVE);
        let mut place = self.count;
        while place > 0 && promise < self.promises[place - 1] {
            self.places[place] = self.places[place - 1];
            self.promises[place] = self.promises[place - 1];
            place -= 1;
        }
        (self.places[place], self.promises[place]) = (at, promise);
        self.count += 1;
    }
}
