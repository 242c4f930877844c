//! Spatial splits: a plane that cuts triangles in two, so that each half has a smaller box and stands on its own
//! side (Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009). A triangle may then
//! stand in several leaves, which changes no result: a hit is the least (t, number), however often it is found.
//!
//! Candidates are judged by clipping boxes; only the plane that is chosen clips triangles.

use super::{Aabb, Context, Load, PIECE, Primitive};
use crate::{
    accel::boxes::{round_down, round_up},
    math::{Bounds3, DVec3, max_abs},
};

const BINS: usize = 16;
/// Above so many items the axes are looked at in parallel.
const PARALLEL: usize = 1 << 14;

/// A plane across an axis.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) at: f32,
    pub(super) cost: f32,
}

impl Plane {
    /// The plane of least cost that adds no more than `room` items; `None` where none would leave both sides with
    /// fewer items than there are.
    pub(super) fn best(
        items: &[Primitive],
        bounds: &Aabb,
        room: usize,
        context: &Context<'_>,
    ) -> Option<Self> {
        let along = |axis: usize| Self::best_along(axis, items, bounds, room, context);
        let found: [Option<Self>; 3] = if items.len() > PARALLEL {
            let (x, (y, z)) = rayon::join(|| along(0), || rayon::join(|| along(1), || along(2)));
            [x, y, z]
        } else {
            [along(0), along(1), along(2)]
        };
        found
            .into_iter()
            .flatten()
            .reduce(|best, plane| if plane.cost < best.cost { plane } else { best })
    }

    fn best_along(
        axis: usize,
        items: &[Primitive],
        bounds: &Aabb,
        room: usize,
        context: &Context<'_>,
    ) -> Option<Self> {
        let (low, high) = (bounds.min.to_array()[axis], bounds.max.to_array()[axis]);
        let (size, scale) = (high - low, BINS as f32 * 0.9999 / (high - low));
        if !(size > 0.0 && scale.is_finite()) {
            return None;
        }
        let plane = |i: usize| low + size * (i as f32 / BINS as f32);
        let bin = |x: f32| (((x - low) * scale) as usize).min(BINS - 1);
        let mut boxes = [Aabb::empty(); BINS];
        let (mut enter, mut leave) = ([Load::default(); BINS], [Load::default(); BINS]);
        for (n, item) in items.iter().enumerate() {
            if n % PIECE == PIECE - 1 && (context.stop)() {
                return None;
            }
            let (mut first, mut last) = (bin(item.min[axis]), bin(item.max[axis]));
            if !context.can_be_cut(item) {
                first = bin(0.5 * (item.min[axis] + item.max[axis]));
                last = first;
            }
            let load = Load::of(item, context.kinds);
            enter[first].add(load);
            leave[last].add(load);
            let mut rest = *item;
            for (bin, i) in boxes[first..last.max(first)].iter_mut().zip(first + 1..) {
                let mut part = rest;
                part.max[axis] = plane(i);
                rest.min[axis] = plane(i);
                bin.grow(&part.aabb());
            }
            boxes[last].grow(&rest.aabb());
        }
        let mut right = [(f32::INFINITY, Load::default()); BINS];
        let (mut around, mut load) = (Aabb::empty(), Load::default());
        for i in (1..BINS).rev() {
            around.grow(&boxes[i]);
            load.add(leave[i]);
            right[i] = (around.half_area() * load.cost(), load);
        }
        (around, load) = (Aabb::empty(), Load::default());
        let mut best: Option<Self> = None;
        for (i, (right_cost, right_load)) in right.into_iter().enumerate().skip(1) {
            around.grow(&boxes[i - 1]);
            load.add(enter[i - 1]);
            let (left, right) = (load.items(), right_load.items());
            let divides = (1..items.len()).contains(&left) && (1..items.len()).contains(&right);
            let cost = around.half_area() * load.cost() + right_cost;
            if divides && left + right <= items.len() + room && best.is_none_or(|best| cost < best.cost) {
                best = Some(Self {
                    axis,
                    at: plane(i),
                    cost,
                });
            }
        }
        best
    }

    /// Cuts the triangles among the first `count` items that lie on both sides; their other halves go behind, as
    /// long as there is room. How many items there are then.
    pub(super) fn cut(&self, items: &mut [Primitive], count: usize, context: &Context<'_>) -> usize {
        let mut end = count;
        for i in 0..count {
            if i % PIECE == PIECE - 1 && (context.stop)() {
                break;
            }
            let item = items[i];
            let across = item.min[self.axis] < self.at && self.at < item.max[self.axis];
            if end < items.len() && across && context.can_be_cut(&item) {
                let [left, right] = self.halves(&item, (context.corners)(item.index()));
                if left.is_empty() || right.is_empty() {
                    continue;
                }
                (items[i], items[end]) = (left, right);
                end += 1;
            }
        }
        end
    }

    /// The parts of a triangle on either side, each with a box around it that is as far out as [`Box32::around`]
    /// would have it. The plane itself is moved by as much for both: where f64 arithmetic hits a triangle that is
    /// nearly parallel to the plane, the point may be on the plane's one side and the triangle on the other.
    ///
    /// [`Box32::around`]: crate::accel::Box32::around
    fn halves(&self, item: &Primitive, corners: [DVec3; 3]) -> [Primitive; 2] {
        let slack = 4e-15 * corners.map(max_abs).into_iter().fold(0.0, f64::max);
        let at = f64::from(self.at);
        let before = |side: usize, x: f64| {
            if side == 0 {
                x <= at + slack
            } else {
                x >= at - slack
            }
        };
        [0, 1].map(|side| {
            let end = if side == 0 { at + slack } else { at - slack };
            let mut around = Bounds3::EMPTY;
            let mut grow = |p: DVec3| around = around.union(&Bounds3::new(p, p));
            for k in 0..3 {
                let (p, q) = (corners[k], corners[(k + 1) % 3]);
                let (inside_p, inside_q) = (before(side, p[self.axis]), before(side, q[self.axis]));
                if inside_p {
                    grow(p);
                }
                if inside_p != inside_q {
                    let share = ((end - p[self.axis]) / (q[self.axis] - p[self.axis])).clamp(0.0, 1.0);
                    grow(p + (q - p) * share);
                }
            }
            let mut part = *item;
            for k in 0..3 {
                // Inside the part that was cut off before.
                part.min[k] = part.min[k].max(round_down(around.min[k] - slack));
                part.max[k] = part.max[k].min(round_up(around.max[k] + slack));
            }
            let share = part.aabb().half_area() / item.aabb().half_area();
            if share < 1.0 {
                part.max[3] *= share;
            }
            part
        })
    }
}
