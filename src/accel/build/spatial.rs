//! Spatial splits: a plane that cuts triangles in two, so that each half has a smaller box and stands on its own
//! side (Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009). A triangle may then
//! stand in several leaves, which changes no result: a hit is the least (t, number), however often it is found.
//!
//! Candidates are judged by clipping boxes; only the plane that is chosen clips triangles.

use rayon::prelude::*;

use super::{
    Aabb, Context, Kinds, Load, PIECE, Primitive,
    bins::{Best, Box8, Loads, best, eight},
};
use crate::{
    accel::{
        boxes::{round_down, round_up},
        four::F4,
        lanes::{Lanes, Task},
    },
    math::{Bounds3, DVec3, max_abs},
};

const BINS: usize = 16;

/// As many slabs of equal thickness along each axis.
struct Slabs {
    low: [f32; 4],
    size: [f32; 4],
    scale: [f32; 4],
    /// What is before the end of each slab, and what is not before its begin.
    before: [[Box8; BINS]; 3],
    behind: [[Box8; BINS]; 3],
}

impl Slabs {
    fn new(bounds: &Aabb) -> Self {
        let size = bounds.max.sub(bounds.min).to_array();
        let mut slabs = Self {
            low: bounds.min.to_array(),
            size,
            scale: size.map(|size| BINS as f32 * 0.9999 / size),
            before: [[Box8::EMPTY; BINS]; 3],
            behind: [[Box8::EMPTY; BINS]; 3],
        };
        for axis in 0..3 {
            for i in 0..BINS {
                slabs.before[axis][i] = Box8::half_space(axis, slabs.plane(axis, i + 1), 1.0);
                slabs.behind[axis][i] = Box8::half_space(axis, slabs.plane(axis, i), -1.0);
            }
        }
        slabs
    }

    fn plane(&self, axis: usize, i: usize) -> f32 {
        self.low[axis] + self.size[axis] * (i as f32 / BINS as f32)
    }

    /// Whether there is anything to divide along an axis.
    fn divide(&self, axis: usize) -> bool {
        self.size[axis] > 0.0 && self.scale[axis].is_finite()
    }

    /// The slabs that a point is in.
    #[inline(always)]
    fn bins(&self, p: F4) -> [usize; 4] {
        let place = p.sub(F4::from_array(self.low)).mul(F4::from_array(self.scale));
        let last = F4::splat((BINS - 1) as f32);
        let bins = place.max(F4::splat(0.0)).min(last).truncate();
        bins.map(|bin| bin as usize & (BINS - 1))
    }
}

/// What is in each slab along each axis.
struct Parts {
    boxes: [[Box8; BINS]; 3],
    /// Loads of what begins in each slab and of what ends there.
    loads: [[Loads; BINS]; 2],
    /// The same in numbers of items.
    items: [[[u32; 4]; BINS]; 2],
}

/// Puts what items have in each slab there.
struct Fill<'a> {
    items: &'a [Primitive],
    kinds: Kinds,
    slabs: &'a Slabs,
}

impl Task for Fill<'_> {
    type Output = Parts;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Parts {
        let Self { items, kinds, slabs } = self;
        let mut parts = Parts {
            boxes: [[Box8::EMPTY; BINS]; 3],
            loads: [[[Load::default(); 4]; BINS]; 2],
            items: [[[0; 4]; BINS]; 2],
        };
        for item in items {
            let bounds = item.aabb();
            let (mut first, mut last) = (slabs.bins(bounds.min), slabs.bins(bounds.max));
            if !kinds.can_be_cut(item) {
                first = slabs.bins(bounds.center().mul(F4::splat(0.5)));
                last = first;
            }
            let load = Load::of(item, kinds);
            let bounds = eight(lanes, &bounds);
            for axis in 0..3 {
                let (first, last) = (first[axis], last[axis]);
                parts.loads[0][first][axis].add(load);
                parts.loads[1][last][axis].add(load);
                parts.items[0][first][axis] += 1;
                parts.items[1][last][axis] += 1;
                let boxes = &mut parts.boxes[axis];
                if first >= last {
                    boxes[last].grow(lanes, bounds);
                    continue;
                }
                let (before, behind) = (&slabs.before[axis], &slabs.behind[axis]);
                boxes[first].grow(lanes, lanes.max(bounds, before[first].load(lanes)));
                for i in first + 1..last {
                    let part = lanes.max(bounds, behind[i].load(lanes));
                    boxes[i].grow(lanes, lanes.max(part, before[i].load(lanes)));
                }
                boxes[last].grow(lanes, lanes.max(bounds, behind[last].load(lanes)));
            }
        }
        parts
    }
}

/// The parts of more items.
struct Merge(Parts, Parts);

impl Task for Merge {
    type Output = Parts;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Parts {
        let Self(mut parts, other) = self;
        for (bin, other) in parts
            .boxes
            .as_flattened_mut()
            .iter_mut()
            .zip(other.boxes.as_flattened())
        {
            bin.grow(lanes, other.load(lanes));
        }
        for side in 0..2 {
            for i in 0..BINS {
                for k in 0..3 {
                    parts.loads[side][i][k].add(other.loads[side][i][k]);
                    parts.items[side][i][k] += other.items[side][i][k];
                }
            }
        }
        parts
    }
}

/// Finds the plane of least cost.
struct Choose<'a> {
    slabs: &'a Slabs,
    parts: &'a Parts,
    items: u32,
    room: u32,
    memory: f32,
}

impl Task for Choose<'_> {
    type Output = Option<Best>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Best> {
        let Self {
            slabs,
            parts,
            items,
            room,
            memory,
        } = self;
        let mut forbidden = [[f32::NAN; 4]; BINS];
        let (mut left, mut right) = ([0; 4], [items; 4]);
        for (i, forbidden) in forbidden.iter_mut().enumerate().skip(1) {
            for (axis, forbidden) in forbidden.iter_mut().enumerate().take(3) {
                left[axis] += parts.items[0][i - 1][axis];
                right[axis] -= parts.items[1][i - 1][axis];
                let divides = (1..items).contains(&left[axis]) && (1..items).contains(&right[axis]);
                if divides && left[axis] + right[axis] <= items + room && slabs.divide(axis) {
                    *forbidden = 0.0;
                }
            }
        }
        let forbidden = |i: usize| F4::from_array(forbidden[i]);
        best(
            lanes,
            &parts.boxes,
            &parts.loads[0],
            &parts.loads[1],
            memory,
            forbidden,
        )
    }
}

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
        let (kinds, simd) = (context.kinds, context.simd);
        let slabs = Slabs::new(bounds);
        let fill = |items| Fill {
            items,
            kinds,
            slabs: &slabs,
        };
        let parts = if items.len() <= 2 * PIECE {
            simd.run(fill(items))
        } else {
            items
                .par_chunks(PIECE)
                .filter(|_| !(context.stop)())
                .map(|piece| simd.run(fill(piece)))
                .reduce_with(|a, b| simd.run(Merge(a, b)))?
        };
        let best = simd.run(Choose {
            slabs: &slabs,
            parts: &parts,
            items: items.len() as u32,
            room: room as u32,
            memory: context.memory,
        })?;
        Some(Self {
            axis: best.axis,
            at: slabs.plane(best.axis, best.bin),
            cost: best.cost,
        })
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
            let across = item.min(self.axis) < self.at && self.at < item.max(self.axis);
            if end < items.len() && across && context.kinds.can_be_cut(&item) {
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
                part.0[k] = part.min(k).max(round_down(around.min[k] - slack));
                part.0[k + 4] = part.max(k).min(round_up(around.max[k] + slack));
            }
            let share = part.aabb().half_area() / item.aabb().half_area();
            if share < 1.0 {
                part.0[7] *= share;
            }
            part
        })
    }
}
