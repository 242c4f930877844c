//! A hierarchy of boxes over the pieces of one shape.

use crate::math::{Bounds3, DVec2, DVec3, Ray, larger, smaller};

/// Boxes around boxes around pieces, so that a line looks at few pieces of many. The boxes are a little wider than what
/// they hold: no rounding may hide a piece that a crossing is on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    /// Depth first.
    nodes: Vec<Node>,
    /// Pieces in the order of the leaves.
    pieces: Vec<u32>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    bounds: Bounds3,
    /// The node to go on with where this one is passed by.
    beyond: u32,
    /// The leaf's pieces; none where it is no leaf.
    first: u32,
    count: u32,
}

/// Pieces in a leaf.
const LEAF: usize = 2;

/// How much wider a box is than its piece, as a part of the size of all.
const MARGIN: f64 = 1e-9;

impl Tree {
    /// The hierarchy over pieces by their bounds.
    pub(super) fn new(bounds: &[Bounds3]) -> Self {
        let all = bounds.iter().fold(Bounds3::EMPTY, |a, b| a.union(b));
        let size = all.min.abs().max(all.max.abs()).max_element();
        let margin = DVec3::splat(size * MARGIN);
        let mut tree = Self {
            nodes: Vec::new(),
            pieces: (0..bounds.len() as u32).collect(),
        };
        let mut pieces = std::mem::take(&mut tree.pieces);
        tree.build(bounds, margin, &mut pieces, 0);
        tree.pieces = pieces;
        tree
    }

    /// The node over `pieces`, which stand from `first` on, and all below it. Halving keeps the depth below 32.
    fn build(&mut self, bounds: &[Bounds3], margin: DVec3, pieces: &mut [u32], first: usize) {
        let of = |i: &u32| bounds.get(*i as usize).copied().unwrap_or(Bounds3::EMPTY);
        let around = pieces.iter().fold(Bounds3::EMPTY, |a, i| a.union(&of(i)));
        let is_leaf = pieces.len() <= LEAF;
        let place = self.nodes.len();
        self.nodes.push(Node {
            bounds: Bounds3::new(around.min - margin, around.max + margin),
            beyond: 0,
            first: first as u32,
            count: if is_leaf { pieces.len() as u32 } else { 0 },
        });
        if !is_leaf {
            let centers = Bounds3::around(pieces.iter().map(|i| of(i).center()));
            let axis = centers.size().max_position();
            let middle = pieces.len() / 2;
            pieces.select_nth_unstable_by(middle, |a, b| {
                let (x, y) = (of(a).center()[axis], of(b).center()[axis]);
                x.total_cmp(&y).then(a.cmp(b))
            });
            let (low, high) = pieces.split_at_mut(middle);
            self.build(bounds, margin, low, first);
            self.build(bounds, margin, high, first + middle);
        }
        let beyond = self.nodes.len() as u32;
        if let Some(node) = self.nodes.get_mut(place) {
            node.beyond = beyond;
        }
    }

    /// Calls `visit` with every piece whose box may be met, `meets` telling of a box whether it is.
    pub(super) fn each(&self, meets: impl Fn(&Bounds3) -> bool, mut visit: impl FnMut(u32)) {
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let is_met = meets(&node.bounds);
            if is_met {
                let from = node.first as usize;
                let leaf = self.pieces.get(from..from + node.count as usize);
                leaf.unwrap_or_default().iter().for_each(|piece| visit(*piece));
            }
            i = if is_met { i + 1 } else { node.beyond as usize };
        }
    }
}

/// A whole line, prepared to be asked which boxes it meets. It is that of a [`Line`], of the size of the boxes.
pub(super) struct LineOfBoxes {
    origin: DVec3,
    /// Of the direction, at most [`STEEPEST`] along an axis that the line is perpendicular to.
    inverse: DVec3,
}

/// Products with it are beyond any way along the line, and products of zero are zero.
const STEEPEST: f64 = 1e30;

impl LineOfBoxes {
    pub(super) fn new(ray: &Ray) -> Self {
        let inverse = |d: f64| smaller(larger(1.0 / d, -STEEPEST), STEEPEST);
        Self {
            origin: ray.origin,
            inverse: DVec3::new(inverse(ray.dir.x), inverse(ray.dir.y), inverse(ray.dir.z)),
        }
    }

    /// Whether it meets a box. Of what is rounded here the boxes' margin is many times as much.
    #[inline]
    pub(super) fn meets(&self, b: &Bounds3) -> bool {
        let (low, high) = (
            (b.min - self.origin) * self.inverse,
            (b.max - self.origin) * self.inverse,
        );
        let [x, y, z] = [[low.x, high.x], [low.y, high.y], [low.z, high.z]];
        let [x, y, z] = [x, y, z].map(|[a, b]| [smaller(a, b), larger(a, b)]);
        larger(larger(x[0], y[0]), z[0]) <= smaller(smaller(x[1], y[1]), z[1])
    }
}

/// Whether the line in x and z through `o` along `d` meets a box of any height: its middle is no farther from the line
/// than its corners reach.
#[inline]
pub(super) fn flat_line_meets(o: DVec2, d: DVec2, b: &Bounds3) -> bool {
    let (low, high) = (DVec2::new(b.min.x, b.min.z) - o, DVec2::new(b.max.x, b.max.z) - o);
    let reach = d.x.abs() * (high.y - low.y) + d.y.abs() * (high.x - low.x);
    d.perp_dot(low + high).abs() <= reach
}

/// Whether a box holds a point.
pub(super) fn holds(b: &Bounds3, p: DVec3) -> bool {
    b.min.cmple(p).all() && p.cmple(b.max).all()
}

/// The place and size of a shape: its numbers are kept, and lines are looked at, in coordinates in which it is
/// around the origin and about 1 in size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    center: DVec3,
    scale: f64,
}

impl Frame {
    /// The frame around `center` in which `scale` is 1.
    pub(super) const fn new(center: DVec3, scale: f64) -> Self {
        Self { center, scale }
    }

    /// The frame in which these bounds are around the origin, their longest edge 2.
    pub(super) fn around(bounds: &Bounds3) -> Self {
        Self::new(bounds.center(), 0.5 * bounds.size().max_element())
    }

    /// The center.
    pub(super) const fn center(&self) -> DVec3 {
        self.center
    }

    /// The size of 1.
    pub(super) const fn scale(&self) -> f64 {
        self.scale
    }

    /// A point of the shape's own space in this frame.
    #[inline]
    pub(super) fn of(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.scale
    }

    /// The ray's line in this frame; `None` where it is none: a number that is not finite, or no direction.
    #[inline]
    pub(super) fn line(&self, ray: &Ray) -> Option<Line> {
        let (dir, speed) = unit(ray.dir)?;
        let speed = speed / self.scale;
        let from = self.of(ray.origin);
        let shift = -from.dot(dir);
        let origin = from + dir * shift;
        // Nothing of the shape is farther from the nearest point than this.
        let farthest = (shift.abs() + 8.0) / speed;
        (origin.is_finite() && farthest.is_finite()).then_some(Line {
            ray: Ray::new(origin, dir),
            shift,
            speed,
        })
    }
}

/// The pieces of a shape in a frame of their own.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Framed<T> {
    frame: Frame,
    pieces: Vec<T>,
    tree: Tree,
    bounds: Bounds3,
}

impl<T> Framed<T> {
    /// Pieces that lie within `bounds`, each taken into the frame around those by `place`; `around` is a box around one that
    /// is there.
    pub(super) fn new(
        bounds: Bounds3,
        pieces: impl IntoIterator<Item = T>,
        place: impl Fn(&Frame, T) -> T,
        around: impl Fn(&T) -> Bounds3,
    ) -> Self {
        let frame = Frame::around(&bounds);
        let pieces: Vec<T> = pieces.into_iter().map(|piece| place(&frame, piece)).collect();
        let boxes: Vec<Bounds3> = pieces.iter().map(around).collect();
        Self {
            frame,
            tree: Tree::new(&boxes),
            pieces,
            bounds,
        }
    }

    /// The frame.
    pub(super) const fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The pieces, in the frame.
    pub(super) fn pieces(&self) -> &[T] {
        &self.pieces
    }

    /// The box around all, in the shape's own space.
    pub(super) const fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Calls `visit` with every piece whose box may be met and its number, as [`Tree::each`].
    pub(super) fn each(&self, meets: impl Fn(&Bounds3) -> bool, mut visit: impl FnMut(u32, &T)) {
        self.tree.each(meets, |i| {
            if let Some(piece) = self.pieces.get(i as usize) {
                visit(i, piece);
            }
        });
    }
}

/// A vector's direction and length, without squares that leave the range of numbers.
fn unit(v: DVec3) -> Option<(DVec3, f64)> {
    let largest = v.abs().max_element();
    if !(v.is_finite() && largest > 0.0) {
        return None;
    }
    let length = v.length();
    if (1e-150..1e150).contains(&length) {
        return Some((v / length, length));
    }
    let v = v / largest;
    let length = v.length();
    Some((v / length, largest * length)).filter(|(v, length)| v.is_finite() && *length > 0.0)
}

/// A line in a shape's frame, with a direction of length 1, from the point nearest to the frame's origin. What is
/// computed from it is as exact for a far ray as for a near one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Where it is nearest to the origin, and its direction.
    pub(super) ray: Ray,
    shift: f64,
    speed: f64,
}

impl Line {
    /// The `t` of the ray it was made from, `way` after the nearest point.
    #[inline]
    pub(super) fn t(&self, way: f64) -> f64 {
        (way + self.shift) / self.speed
    }

    /// The ways between which the line is in the box of these half edges around the origin.
    #[inline]
    pub(super) fn within(&self, half: DVec3) -> Option<(f64, f64)> {
        let (o, d) = (self.ray.origin.to_array(), self.ray.dir.to_array());
        let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
        for ((o, d), half) in o.into_iter().zip(d).zip(half.to_array()) {
            if d == 0.0 {
                if !(o.abs() <= half) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-half - o) / d, (half - o) / d);
            lo = larger(lo, smaller(a, b));
            hi = smaller(hi, larger(a, b));
        }
        (lo <= hi && lo.is_finite() && hi.is_finite()).then_some((lo, hi))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::suite::Rng, *};

    #[test]
    fn every_piece_that_a_line_meets_is_visited_once() {
        let mut rng = Rng::new(41);
        for n in [1, 2, 3, 7, 200] {
            let bounds: Vec<Bounds3> = (0..n)
                .map(|_| {
                    let (a, b) = (rng.in_cube() * 3.0, rng.in_cube() * 0.2);
                    Bounds3::around([a, a + b])
                })
                .collect();
            let tree = Tree::new(&bounds);
            for _ in 0..500 {
                let mut dir = rng.direction();
                if rng.unit() < 0.5 {
                    dir[n % 3] = 0.0;
                }
                let line = LineOfBoxes::new(&Ray::new(rng.in_cube() * 3.0, dir));
                let mut visited = Vec::new();
                tree.each(|b| line.meets(b), |i| visited.push(i));
                visited.sort_unstable();
                assert!(visited.is_sorted_by(|a, b| a < b), "twice: {visited:?}");
                for (i, b) in bounds.iter().enumerate() {
                    assert!(!line.meets(b) || visited.contains(&(i as u32)));
                }
                assert!(visited.len() <= 20, "most of 200 are passed by");
            }
        }
    }
}
