//! What is known of a field in the parts of a box, so that rays need not find it out one by one.
//!
//! The box is divided into an octree. In some of its cells intervals prove that the field has one sign, so rays pass them
//! without a look at it. Every other cell has the tape that is left of the field there, and bounds of the gradient: with
//! these, a ray knows of most cells that the field only rises or only falls along it.

#![allow(
    clippy::indexing_slicing,
    reason = "the tree refers only to nodes, leaves and tapes that its own making put there"
)]

use super::{
    Gradient,
    interval::Interval,
    line::{Line, Place, certain},
    scalar::Slope,
    tape::Tape,
};
use crate::{
    math::{Bounds3, DVec3, Ray, max_abs},
    shape::CrossingSink,
};

/// The cells at the bottom are the box's longest side divided by 2 to this.
const DEEPEST: u32 = 8;
/// What is known of a cell holds this far around it, in units of the tree's side; so places a little beside a cell may
/// count as within.
const AROUND: f64 = 1.0 / (1u64 << 20) as f64;
/// Rays whose numbers are larger than this, in units of the tree's side, are not known well enough to tell their cells.
const FARTHEST: f64 = (1u64 << 16) as f64;
/// A cell in which the gradient turns by no more than about this is not divided: a steeper ray crosses the surface once.
const FLAT: f64 = 0.2;

/// Where a child of the tree leads: what it is in the two lowest bits, and a number in those above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Node(u32);

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The field is nowhere negative in it.
    Outside,
    /// The field is negative everywhere in it.
    Inside,
    /// Eight children.
    Divided(usize),
    Leaf(usize),
}

impl Node {
    const OUTSIDE: Self = Self(0);
    const INSIDE: Self = Self(1);

    fn divided(index: usize) -> Self {
        Self((index as u32) << 2 | 2)
    }

    fn leaf(index: usize) -> Self {
        Self((index as u32) << 2 | 3)
    }

    fn kind(self) -> Kind {
        let index = (self.0 >> 2) as usize;
        match self.0 & 3 {
            0 => Kind::Outside,
            1 => Kind::Inside,
            2 => Kind::Divided(index),
            _ => Kind::Leaf(index),
        }
    }
}

/// A cell that may hold a part of the surface.
#[derive(Clone, Debug)]
struct Leaf {
    /// Bounds of the field's slopes along the axes.
    slopes: [Interval; 3],
    tape: u32,
}

/// See the top of the file.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// Least corner of the tree, which is a cube, and the side of a cell at the bottom.
    least: DVec3,
    side: f64,
    root: Node,
    children: Vec<[Node; 8]>,
    leaves: Vec<Leaf>,
    tapes: Vec<Tape>,
}

/// A cell that is not divided yet, while the tree is made.
struct Open {
    /// Where its node stands; `None` for the root.
    place: Option<(usize, usize)>,
    /// Its least corner, in cells of the bottom.
    corner: [u32; 3],
    slopes: [Interval; 3],
    tape: u32,
}

/// A cell, found by a point in it.
struct Found {
    kind: Kind,
    corner: [u32; 3],
    /// Its side, in cells of the bottom.
    size: u32,
}

impl Cells {
    /// Cells of a field in a box, made by about so many `operations` of its tape; `None` where `is_stopped` says so.
    pub(super) fn new(
        tape: Tape,
        bounds: &Bounds3,
        operations: usize,
        is_stopped: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let whole = bounds.size().max_element();
        let mut maker = Maker {
            cells: Self {
                least: bounds.min,
                side: whole / f64::from(1u32 << DEEPEST),
                root: Node::OUTSIDE,
                children: Vec::new(),
                leaves: Vec::new(),
                tapes: vec![tape],
            },
            bounds,
            around: whole * AROUND,
            left: operations,
            results: Vec::new(),
            values: Vec::new(),
        };
        let (root, first) = maker.look([0; 3], 1 << DEEPEST, 0, None);
        maker.cells.root = root;
        let mut open: Vec<Open> = first.into_iter().collect();
        for depth in 1..=DEEPEST {
            // All cells of a level are divided or none, so that no part of space is left behind.
            let cost = |open: &Open| 8 * maker.cells.tapes[open.tape as usize].len().max(8);
            if open.iter().map(cost).sum::<usize>() > maker.left {
                break;
            }
            let size = 1 << (DEEPEST - depth);
            let mut next = Vec::new();
            for cell in open {
                if is_stopped() {
                    return None;
                }
                maker.divide(&cell, size, &mut next);
            }
            open = next;
        }
        for cell in open {
            maker.close(&cell);
        }
        let mut cells = maker.cells;
        cells.children.shrink_to_fit();
        cells.leaves.shrink_to_fit();
        cells.tapes.shrink_to_fit();
        Some(cells)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.children)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.tapes)
            + self.tapes.iter().map(Tape::bytes).sum::<usize>()
    }

    /// The tape of the whole box.
    pub(super) fn whole(&self) -> &Tape {
        &self.tapes[0]
    }

    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.leaves.len()
    }

    /// Whether the places of a ray in the box are known well enough.
    pub(super) fn suits(&self, ray: &Ray, bounds: &Bounds3) -> bool {
        let most = FARTHEST * self.side * f64::from(1u32 << DEEPEST);
        let numbers = [ray.origin, bounds.min, bounds.max].map(max_abs);
        numbers.into_iter().fold(0.0, f64::max) <= most
    }

    /// The cell of a point, or the one nearest to it.
    fn find(&self, p: DVec3) -> Found {
        let last = f64::from((1u32 << DEEPEST) - 1);
        let corner = ((p - self.least) / self.side)
            .to_array()
            .map(|x| x.clamp(0.0, last) as u32);
        let mut node = self.root;
        let mut depth = DEEPEST;
        while let Kind::Divided(index) = node.kind() {
            depth -= 1;
            node = self.children[index][octant(corner, depth)];
        }
        Found {
            kind: node.kind(),
            corner: corner.map(|x| x >> depth << depth),
            size: 1 << depth,
        }
    }

    /// The value and gradient of the field at a point; `None` where the point is in no cell of the surface.
    pub(super) fn gradient(
        &self,
        p: DVec3,
        at: [Gradient; 3],
        memory: &mut Vec<Gradient>,
    ) -> Option<Gradient> {
        match self.find(p).kind {
            Kind::Leaf(index) => Some(self.tape(index).run(at, memory)),
            _ => None,
        }
    }

    fn tape(&self, leaf: usize) -> &Tape {
        &self.tapes[self.leaves[leaf].tape as usize]
    }

    /// Tells `out` where the line goes in or out from one of its places to another, in ascending order, as far as it asks;
    /// and its ends as parts `faces` where it is inside there.
    pub(super) fn changes(
        &self,
        line: &mut Line<'_>,
        [from, to]: [i64; 2],
        faces: [u32; 2],
        out: &mut impl CrossingSink,
    ) {
        let dir = line.ray.dir.to_array();
        let per_dir = dir.map(f64::recip);
        let mut at = from;
        let mut is_inside = false;
        // The value where the last cell ended, if it was looked at.
        let mut known: Option<Place> = None;
        while at < to {
            let cell = self.find(line.point(at));
            let end = self.end(line, &cell, at, per_dir).min(to);
            match cell.kind {
                Kind::Leaf(index) => {
                    let leaf = &self.leaves[index];
                    let tape = &self.tapes[leaf.tape as usize];
                    let begin = known.take().unwrap_or_else(|| line.look(tape, at));
                    is_inside = begin.is_inside();
                    if at == 0 && is_inside {
                        out.push(line.t(0), faces[0]);
                    }
                    let along = |axis: usize| leaf.slopes[axis].mul(Interval::point(dir[axis]));
                    let rise = along(0).add(along(1)).add(along(2));
                    if certain(begin.value, rise) < line.t(end) - line.t(at) {
                        let last = line.look(tape, end);
                        line.changes(tape, [begin, last], rise, out, super::SURFACE);
                        is_inside = last.is_inside();
                        known = Some(last);
                    }
                }
                kind => {
                    is_inside = kind == Kind::Inside;
                    known = None;
                    if at == 0 && is_inside {
                        out.push(line.t(0), faces[0]);
                    }
                }
            }
            if out.is_served() {
                return;
            }
            at = end;
        }
        if to == line.last() && is_inside {
            out.push(line.t(to), faces[1]);
        }
    }

    /// The first place of a line beyond a cell, as far as rounding tells.
    fn end(&self, line: &Line<'_>, cell: &Found, at: i64, per_dir: [f64; 3]) -> i64 {
        let (origin, least) = (line.ray.origin.to_array(), self.least.to_array());
        let mut end = f64::INFINITY;
        for axis in 0..3 {
            let per_dir = per_dir[axis];
            let far = cell.corner[axis] + if per_dir > 0.0 { cell.size } else { 0 };
            let t = (least[axis] + f64::from(far) * self.side - origin[axis]) * per_dir;
            if t < end && per_dir.is_finite() {
                end = t;
            }
        }
        (line.before(end) + 1).max(at + 1)
    }
}

/// Makes the tree, level by level.
struct Maker<'a> {
    cells: Cells,
    bounds: &'a Bounds3,
    /// How far around a cell what is known of it holds.
    around: f64,
    /// Operations that may still be done.
    left: usize,
    results: Vec<Slope<3>>,
    values: Vec<Interval>,
}

impl Maker<'_> {
    /// Looks at a cell of the side `size` with what its parent has left of the field: what is known of it, or the cell if
    /// it is to be divided. `siblings` is where tapes of its siblings begin.
    fn look(
        &mut self,
        corner: [u32; 3],
        size: u32,
        tape: u32,
        siblings: Option<usize>,
    ) -> (Node, Option<Open>) {
        let Cells { least, side, .. } = self.cells;
        let lo = least + DVec3::from(corner.map(f64::from)) * side;
        let hi = lo + f64::from(size) * side;
        let lo = lo.max(self.bounds.min) - self.around;
        let hi = hi.min(self.bounds.max) + self.around;
        if lo.cmpgt(hi).any() {
            return (Node::OUTSIDE, None);
        }
        let field = &self.cells.tapes[tape as usize];
        self.left = self.left.saturating_sub(field.len());
        let (lo_of, hi_of) = (lo.to_array(), hi.to_array());
        let point = [0, 1, 2].map(|axis| {
            let mut d = [Interval::point(0.0); 3];
            d[axis] = Interval::point(1.0);
            Slope {
                v: Interval::new(lo_of[axis], hi_of[axis]),
                d,
            }
        });
        let Slope { v: value, d: slopes } = field.run(point, &mut self.results);
        if value.lo >= 0.0 {
            return (Node::OUTSIDE, None);
        }
        if value.hi < 0.0 {
            return (Node::INSIDE, None);
        }
        // From the value in the middle by the slopes, less the rounding of values.
        let middle = ((lo + hi) * 0.5).to_array().map(Interval::point);
        let middle = field.run(middle, &mut self.values);
        let steep = DVec3::from(slopes.map(|d| d.lo.abs().max(d.hi.abs())));
        let reach = steep.dot((hi - lo) * 0.5) * (1.0 + 1e-9) + 16.0 * middle.width();
        if middle.lo - reach > 0.0 {
            return (Node::OUTSIDE, None);
        }
        if middle.hi + reach < 0.0 {
            return (Node::INSIDE, None);
        }
        let tape = match field.within(&self.results) {
            Some(pruned) => {
                let known = siblings.unwrap_or(self.cells.tapes.len());
                let same = self.cells.tapes[known..].iter().position(|tape| *tape == pruned);
                let index = same.map_or(self.cells.tapes.len(), |i| known + i);
                if same.is_none() {
                    self.cells.tapes.push(pruned);
                }
                index as u32
            }
            None => tape,
        };
        let open = Open {
            place: None,
            corner,
            slopes,
            tape,
        };
        if size == 1 || is_flat(slopes) {
            return (self.leaf(&open), None);
        }
        (Node::OUTSIDE, Some(open))
    }

    /// Divides a cell into eight of the side `size`; those that are to be divided again are added to `next`.
    fn divide(&mut self, cell: &Open, size: u32, next: &mut Vec<Open>) {
        let index = self.cells.children.len();
        let siblings = self.cells.tapes.len();
        self.cells.children.push([Node::OUTSIDE; 8]);
        for child in 0..8u32 {
            let [x, y, z] = cell.corner;
            let corner = [
                x + (child & 1) * size,
                y + (child >> 1 & 1) * size,
                z + (child >> 2) * size,
            ];
            let (node, open) = self.look(corner, size, cell.tape, Some(siblings));
            self.cells.children[index][child as usize] = node;
            next.extend(open.map(|open| Open {
                place: Some((index, child as usize)),
                ..open
            }));
        }
        self.put(cell.place, Node::divided(index));
    }

    fn leaf(&mut self, cell: &Open) -> Node {
        self.cells.leaves.push(Leaf {
            slopes: cell.slopes,
            tape: cell.tape,
        });
        Node::leaf(self.cells.leaves.len() - 1)
    }

    /// Leaves a cell as it is.
    fn close(&mut self, cell: &Open) {
        let node = self.leaf(cell);
        self.put(cell.place, node);
    }

    fn put(&mut self, place: Option<(usize, usize)>, node: Node) {
        match place {
            Some((index, child)) => self.cells.children[index][child] = node,
            None => self.cells.root = node,
        }
    }
}

/// Whether the gradient turns little.
fn is_flat(slopes: [Interval; 3]) -> bool {
    let middle = DVec3::from(slopes.map(|d| 0.5 * (d.lo + d.hi)));
    let half = DVec3::from(slopes.map(|d| 0.5 * d.width()));
    half.length() <= FLAT * middle.length()
}

/// Which child of a cell holds a cell of the bottom, where children are cells of 2 to `depth`.
fn octant(corner: [u32; 3], depth: u32) -> usize {
    let [x, y, z] = corner.map(|x| (x >> depth & 1) as usize);
    x | y << 1 | z << 2
}
