//! The split of least cost by binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding
//! Volume Hierarchies", 2007), and the division by it.

use rayon::prelude::*;

use super::{Aabb, Context, Kinds, Load, PIECE, Primitive, Summary, spatial::Plane};
use crate::accel::four::F4;

/// Where twice the centers fall into `N` bins along each axis.
#[derive(Clone, Copy)]
struct Binning<const N: usize> {
    min: F4,
    scale: F4,
}

impl<const N: usize> Binning<N> {
    fn new(centers: &Aabb) -> Self {
        let scale = centers.max.sub(centers.min).to_array().map(|extent| {
            let scale = N as f32 * 0.9999 / extent;
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self {
            min: centers.min,
            scale: F4::from_array(scale),
        }
    }

    /// What is not a number lands in the last bin.
    #[inline(always)]
    fn bins(&self, bounds: &Aabb) -> [usize; 4] {
        let place = bounds.center().sub(self.min).mul(self.scale);
        let last = F4::splat((N - 1) as f32);
        let bins = place.min(last).max(F4::splat(0.0)).truncate();
        bins.map(|bin| bin as usize & (N - 1))
    }
}

/// Box and load of each bin along each axis.
struct Bins<const N: usize> {
    boxes: [[Aabb; N]; 3],
    loads: [[Load; N]; 3],
}

impl<const N: usize> Bins<N> {
    #[inline(always)]
    fn of(items: &[Primitive], kinds: Kinds, binning: &Binning<N>) -> Self {
        let mut bins = Self {
            boxes: [[Aabb::empty(); N]; 3],
            loads: [[Load::default(); N]; 3],
        };
        for item in items {
            let load = Load::of(item, kinds);
            let bounds = item.aabb();
            let places = binning.bins(&bounds);
            let [x, y, z, _] = places;
            for (axis, bin) in [x, y, z].into_iter().enumerate() {
                bins.boxes[axis][bin].grow(&bounds);
                bins.loads[axis][bin].add(load);
            }
        }
        bins
    }

    fn merge(mut self, other: Self) -> Self {
        for k in 0..3 {
            for i in 0..N {
                self.boxes[k][i].grow(&other.boxes[k][i]);
                self.loads[k][i].add(other.loads[k][i]);
            }
        }
        self
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
    /// The split of least cost (area times load, left plus right) over all three axes; `None` where all centers
    /// coincide. Few items need few bins.
    pub(super) fn best(items: &[Primitive], context: &Context<'_>, centers: &Aabb) -> Option<Self> {
        match items.len() {
            0..12 => Self::best_of_bins::<4>(items, context, centers),
            12..64 => Self::best_of_bins::<8>(items, context, centers),
            _ => Self::best_of_bins::<16>(items, context, centers),
        }
    }

    fn best_of_bins<const N: usize>(
        items: &[Primitive],
        context: &Context<'_>,
        centers: &Aabb,
    ) -> Option<Self> {
        let (kinds, binning) = (context.kinds, Binning::<N>::new(centers));
        let bins = if items.len() > 2 * PIECE {
            items
                .par_chunks(PIECE)
                .filter(|_| !(context.stop)())
                .map(|piece| Bins::of(piece, kinds, &binning))
                .reduce_with(Bins::merge)?
        } else {
            Bins::of(items, kinds, &binning)
        };
        let scales = binning.scale.to_array();
        let (mut best, mut axis, mut plane) = (f32::INFINITY, 3, 0);
        for (k, (boxes, loads)) in bins.boxes.iter().zip(&bins.loads).enumerate() {
            if scales[k] == 0.0 {
                continue;
            }
            let mut right_cost = [f32::INFINITY; N];
            let (mut bounds, mut load) = (Aabb::empty(), Load::default());
            for i in (1..N).rev() {
                bounds.grow(&boxes[i]);
                load.add(loads[i]);
                if !load.is_empty() {
                    right_cost[i] = bounds.half_area() * load.cost();
                }
            }
            (bounds, load) = (Aabb::empty(), Load::default());
            for i in 1..N {
                bounds.grow(&boxes[i - 1]);
                load.add(loads[i - 1]);
                let cost = bounds.half_area() * load.cost() + right_cost[i];
                if cost < best && !load.is_empty() {
                    (best, axis, plane) = (cost, k, i);
                }
            }
        }
        let boxes = bins.boxes.get(axis)?;
        let around = |boxes: &[Aabb]| {
            boxes.iter().fold(Aabb::empty(), |mut around, bin| {
                around.grow(bin);
                around
            })
        };
        Some(Self {
            axis,
            plane: plane as f32,
            min: binning.min.to_array()[axis],
            scale: scales[axis],
            cost: best,
            bounds: [around(&boxes[..plane]), around(&boxes[plane..])],
        })
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
            self.divide_here(items)
        };
        let [left, right] = [0, 1].map(|side| Summary {
            bounds: self.bounds[side],
            centers: centers[side],
        });
        (middle, [left, right])
    }

    fn divide_here(&self, items: &mut [Primitive]) -> (usize, [Aabb; 2]) {
        let mut middle = 0;
        let mut centers = [Aabb::empty(); 2];
        let (axis, plane) = (self.axis % 3, F4::splat(self.plane));
        // Which side an item takes is as good as random: no branch may depend on it. Items from `middle` to `i` go
        // right; the next to go left changes places with the first of them.
        for i in 0..items.len() {
            let item = &items[i];
            let place = F4::splat((item.min[axis] + item.max[axis] - self.min) * self.scale);
            let center = item.aabb().center();
            items.swap(middle, i);
            middle += (place.below(plane).bits() & 1) as usize;
            // NaN is left out of a box.
            centers[0].grow_point(center.or(place.not_less(plane)));
            centers[1].grow_point(center.or(place.below(plane)));
        }
        (middle, centers)
    }

    /// Divides each piece by itself, then swaps what stands on the wrong side of the middle.
    fn divide_in_pieces(&self, items: &mut [Primitive], context: &Context<'_>) -> (usize, [Aabb; 2]) {
        let pieces: Vec<(usize, [Aabb; 2])> = items
            .par_chunks_mut(PIECE)
            .filter(|_| !(context.stop)())
            .map(|piece| self.divide_here(piece))
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
