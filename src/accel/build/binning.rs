//! The split of least cost by binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding
//! Volume Hierarchies", 2007), and the division by it.

use rayon::prelude::*;

use super::{
    Aabb, Context, Kinds, PIECE, Primitive, Summary,
    bins::{Binning, Bins},
    spatial::Plane,
};
use crate::accel::{
    four::F4,
    lanes::{Lanes, Task},
};

/// Puts items into bins.
struct Fill<'a, const N: usize> {
    items: &'a [Primitive],
    kinds: Kinds,
    binning: Binning<N>,
}

impl<const N: usize> Task for Fill<'_, N> {
    type Output = Bins<N>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Bins<N> {
        Bins::of(lanes, self.items, self.kinds, &self.binning)
    }
}

/// Finds the split of least cost of what is in bins; with what a block costs for its memory.
struct Choose<'a, const N: usize>(Binning<N>, &'a Bins<N>, f32);

impl<const N: usize> Task for Choose<'_, N> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Split> {
        let Self(binning, bins, memory) = self;
        let scales = binning.scale.to_array();
        let (best, bounds) = bins.best(lanes, scales, memory)?;
        Some(Split {
            axis: best.axis,
            plane: best.bin as f32,
            min: binning.min.to_array()[best.axis],
            scale: scales[best.axis],
            cost: best.cost,
            bounds,
        })
    }
}

/// Both, without the way through memory that a task's end is.
struct FillAndChoose<'a, const N: usize>(Fill<'a, N>, f32);

impl<const N: usize> Task for FillAndChoose<'_, N> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Split> {
        let binning = self.0.binning;
        Choose(binning, &self.0.run(lanes), self.1).run(lanes)
    }
}

/// Bins of more items.
struct Merge<const N: usize>(Bins<N>, Bins<N>);

impl<const N: usize> Task for Merge<N> {
    type Output = Bins<N>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Bins<N> {
        self.0.merge(lanes, &self.1)
    }
}

/// Moves the items that go left to the front; their number, and boxes around twice the centers of both parts.
struct Halve<'a>(&'a Split, &'a mut [Primitive]);

impl Task for Halve<'_> {
    type Output = (usize, [Aabb; 2]);

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> (usize, [Aabb; 2]) {
        let Self(split, items) = self;
        let mut middle = 0;
        let mut centers = [Aabb::empty(); 2];
        let (axis, plane) = (split.axis % 3, F4::splat(split.plane));
        // Which side an item takes is as good as random: no branch may depend on it. Items from `middle` to `i` go
        // right; the next to go left changes places with the first of them.
        for i in 0..items.len() {
            let place = (items[i].min(axis) + items[i].max(axis) - split.min) * split.scale;
            let place = F4::splat(place);
            let (front, item) = (items[middle].lanes(lanes), items[i].lanes(lanes));
            items[i] = Primitive::from_lanes(lanes, front);
            items[middle] = Primitive::from_lanes(lanes, item);
            let [min, max] = lanes.halves(item);
            let center = min.add(max);
            middle += (place.below(plane).bits() & 1) as usize;
            // NaN is left out of a box.
            centers[0].grow_point(center.or(place.not_less(plane)));
            centers[1].grow_point(center.or(place.below(plane)));
        }
        (middle, centers)
    }
}

/// Items whose center, in bins, is below `plane` along `axis` go left.
#[derive(Clone, Copy)]
pub(super) struct Split {
    axis: usize,
    plane: f32,
    min: f32,
    scale: f32,
    pub(super) cost: f32,
    /// Boxes around the parts.
    pub(super) bounds: [Aabb; 2],
}

impl Split {
    /// The split of least cost (area and memory times load, left plus right) over all three axes; `None` where all centers
    /// coincide. Few items need few bins.
    pub(super) fn best(items: &[Primitive], context: &Context<'_>, centers: &Aabb) -> Option<Self> {
        match items.len() {
            0..8 => Self::best_of_bins::<4>(items, context, centers),
            8..64 => Self::best_of_bins::<8>(items, context, centers),
            _ => Self::best_of_bins::<16>(items, context, centers),
        }
    }

    fn best_of_bins<const N: usize>(
        items: &[Primitive],
        context: &Context<'_>,
        centers: &Aabb,
    ) -> Option<Self> {
        let (kinds, simd) = (context.kinds, context.simd);
        let fill = |items| Fill::<N> {
            items,
            kinds,
            binning: Binning::new(centers),
        };
        if items.len() <= 2 * PIECE {
            return simd.run(FillAndChoose(fill(items), context.memory));
        }
        let bins = items
            .par_chunks(PIECE)
            .filter(|_| !(context.stop)())
            .map(|piece| simd.run(fill(piece)))
            .reduce_with(|a, b| simd.run(Merge(a, b)))?;
        simd.run(Choose(fill(items).binning, &bins, context.memory))
    }

    /// The division by a plane.
    pub(super) fn across(plane: &Plane) -> Self {
        Self {
            axis: plane.axis,
            plane: 2.0 * plane.at,
            min: 0.0,
            scale: 1.0,
            cost: plane.cost,
            bounds: [Aabb::empty(); 2],
        }
    }

    /// Moves the items that go left to the front; their number, and the summaries of both parts.
    pub(super) fn divide(&self, items: &mut [Primitive], context: &Context<'_>) -> (usize, [Summary; 2]) {
        let (middle, centers) = if items.len() > 2 * PIECE {
            self.divide_in_pieces(items, context)
        } else {
            context.simd.run(Halve(self, items))
        };
        let [left, right] = [0, 1].map(|side| Summary {
            bounds: self.bounds[side],
            centers: centers[side],
        });
        (middle, [left, right])
    }

    /// Divides each piece by itself, then swaps what stands on the wrong side of the middle.
    fn divide_in_pieces(&self, items: &mut [Primitive], context: &Context<'_>) -> (usize, [Aabb; 2]) {
        let pieces: Vec<(usize, [Aabb; 2])> = items
            .par_chunks_mut(PIECE)
            .filter(|_| !(context.stop)())
            .map(|piece| context.simd.run(Halve(self, piece)))
            .collect();
        if (context.stop)() {
            return (items.len() / 2, [Aabb::empty(); 2]);
        }
        let middle = pieces.iter().map(|(left, _)| left).sum();
        let mut centers = [Aabb::empty(); 2];
        // Those that go right but stand left of the middle, and those that go left but stand right of it.
        let (mut to_right, mut to_left) = (Vec::new(), Vec::new());
        let mut first = 0;
        for (left, around) in pieces {
            let end = (first + PIECE).min(items.len());
            for side in 0..2 {
                centers[side].grow(&around[side]);
            }
            to_right.push(first + left..end.min(middle));
            to_left.push(first.max(middle)..first + left);
            first = end;
        }
        let pairs = to_right.into_iter().flatten().zip(to_left.into_iter().flatten());
        for (a, b) in pairs {
            items.swap(a, b);
        }
        (middle, centers)
    }
}
