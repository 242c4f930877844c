//! From the binary tree to nodes of eight children, by the cuts it found cheapest.

use super::{Item, Kinds, LEAF_MAX};
use crate::accel::{
    boxes::{Child, LeafKind, Node},
    build::binary::{Binary, Cut, Tree},
};

/// Nodes, the root first, and the primitives in no block in the order of the leaves.
pub(super) fn collapse(
    tree: &Tree,
    items: &[Item],
    kinds: Kinds,
    block: impl FnMut(LeafKind, &[u32]),
) -> (Vec<Node>, Vec<u32>) {
    let mut emitter = Emitter {
        tree,
        items,
        kinds,
        block,
        nodes: Vec::new(),
        others: Vec::new(),
        blocks: [0; 2],
    };
    if let Some(root) = tree.root() {
        emitter.node(root);
    }
    (emitter.nodes, emitter.others)
}

struct Emitter<'a, F> {
    tree: &'a Tree,
    items: &'a [Item],
    kinds: Kinds,
    block: F,
    nodes: Vec<Node>,
    others: Vec<u32>,
    /// Blocks made so far, by kind.
    blocks: [usize; 2],
}

impl<'a, F: FnMut(LeafKind, &[u32])> Emitter<'a, F> {
    fn at(&self, index: u32) -> &'a Binary {
        &self.tree.nodes[index as usize]
    }

    /// Makes a node whose children are the best cut of `binary` in eight.
    fn node(&mut self, binary: &'a Binary) -> Child {
        let mut children: Vec<&Binary> = Vec::with_capacity(8);
        match binary.own {
            Cut::Split(k) => {
                self.gather(self.at(binary.left), usize::from(k), &mut children);
                self.gather(self.at(binary.right), 8 - usize::from(k), &mut children);
            }
            _ => children.push(binary),
        }
        // A shadow ray goes to the last lane it enters first: the one that blocks most for its cost.
        let promise = |b: &Binary| b.area / b.cost[0].max(f32::MIN_POSITIVE);
        children.sort_by(|a, b| promise(a).total_cmp(&promise(b)));
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        for (lane, binary) in children.into_iter().enumerate() {
            let child = if binary.cut[0] == Cut::Node {
                self.node(binary)
            } else {
                self.leaf(binary)
            };
            self.nodes[index].set(lane, &binary.bounds, child);
        }
        Child::node(index)
    }

    /// Collects `binary` as at most `room` children.
    fn gather(&self, binary: &'a Binary, mut room: usize, children: &mut Vec<&'a Binary>) {
        while room > 1 && binary.cut[room - 1] == Cut::Fewer {
            room -= 1;
        }
        match binary.cut[room - 1] {
            Cut::Split(k) if room > 1 => {
                self.gather(self.at(binary.left), usize::from(k), children);
                self.gather(self.at(binary.right), room - usize::from(k), children);
            }
            _ => children.push(binary),
        }
    }

    fn leaf(&mut self, binary: &Binary) -> Child {
        let items = &self.items[binary.first as usize..][..binary.count as usize];
        let mut indices = [0; LEAF_MAX];
        let indices = &mut indices[..items.len()];
        for (index, item) in indices.iter_mut().zip(items) {
            *index = item.index;
        }
        indices.sort_unstable();
        match indices
            .first()
            .map_or(LeafKind::Others, |&index| self.kinds.of(index))
        {
            LeafKind::Others => {
                self.others.extend_from_slice(indices);
                Child::leaf(LeafKind::Others, self.others.len() - indices.len(), indices.len())
            }
            kind => {
                (self.block)(kind, indices);
                self.blocks[kind as usize] += 1;
                Child::leaf(kind, self.blocks[kind as usize] - 1, 1)
            }
        }
    }
}
