//! Boxes and loads between planes across all three axes, and what a division by each of the planes costs.

use super::{Aabb, Kinds, Load, Primitive};
use crate::accel::{four::F4, lanes::Lanes};

/// A box in eight lanes: its smallest corner, and its largest with the sign turned, so that one minimum makes it grow
/// and one maximum cuts it.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Box8([f32; 8]);

impl Box8 {
    pub(super) const EMPTY: Self = Self([f32::INFINITY; 8]);

    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self, lanes: L) -> L::F8 {
        lanes.load(&self.0)
    }

    /// All of space before `end` along an axis where the sign is 1, and behind it where the sign is -1.
    pub(super) fn half_space(axis: usize, end: f32, sign: f32) -> Self {
        let mut lanes = [f32::NEG_INFINITY; 8];
        let lane = if sign > 0.0 { axis + 4 } else { axis };
        lanes[lane & 7] = -sign * end;
        Self(lanes)
    }

    /// Grows to contain another box. NaN is left out.
    #[inline(always)]
    pub(super) fn grow<L: Lanes>(&mut self, lanes: L, other: L::F8) {
        self.0 = lanes.store(lanes.min(other, self.load(lanes)));
    }
}

/// The box of a primitive.
#[inline(always)]
pub(super) fn eight<L: Lanes>(lanes: L, bounds: &Aabb) -> L::F8 {
    lanes.join([bounds.min, bounds.max.flip(F4::splat(-0.0))])
}

#[inline(always)]
fn aabb<L: Lanes>(lanes: L, bounds: L::F8) -> Aabb {
    let [min, turned] = lanes.halves(bounds);
    Aabb {
        min,
        max: turned.flip(F4::splat(-0.0)),
    }
}

/// Half the surface areas of three boxes, as [`Aabb::half_area`] has them to the bit.
#[inline(always)]
fn half_areas<L: Lanes>(lanes: L, boxes: [L::F8; 3]) -> F4 {
    // Both factors of each product have the wrong sign.
    let [x, y, z] = F4::transpose(boxes.map(|bounds| {
        let [min, turned] = lanes.halves(bounds);
        min.add(turned)
    }));
    let area = x.mul(y).add(y.mul(z)).add(z.mul(x));
    area.min(F4::splat(f32::MAX))
}

/// Loads of the bins of one number along the three axes; the fourth is nothing.
pub(super) type Loads = [Load; 4];

#[inline(always)]
fn cost_of(loads: Loads) -> F4 {
    F4::from_whole(loads.map(|load| load.blocks() as i32))
}

#[inline(always)]
fn sum(a: Loads, b: Loads) -> Loads {
    std::array::from_fn(|k| a[k].plus(b[k]))
}

/// A plane before a bin along an axis.
#[derive(Clone, Copy)]
pub(super) struct Best {
    pub(super) axis: usize,
    pub(super) bin: usize,
    /// Area, and what memory counts for, times load; left plus right.
    pub(super) cost: f32,
}

/// The plane of least cost over boxes of bins, what begins in each bin and what ends there. `forbidden` has all bits
/// set where a plane before a bin is not to be taken; `memory` is what each block costs more.
#[inline(always)]
pub(super) fn best<const N: usize, L: Lanes>(
    lanes: L,
    boxes: &[[Box8; N]; 3],
    begin: &[Loads; N],
    end: &[Loads; N],
    memory: f32,
    forbidden: impl Fn(usize) -> F4,
) -> Option<Best> {
    let (nothing, zero) = (Box8::EMPTY.load(lanes), F4::splat(0.0));
    let memory = F4::splat(memory);
    let mut right = [zero; N];
    let (mut around, mut load) = ([nothing; 3], [Load::default(); 4]);
    for i in (1..N).rev() {
        for k in 0..3 {
            around[k] = lanes.min(boxes[k][i].load(lanes), around[k]);
        }
        load = sum(load, end[i]);
        let blocks = cost_of(load);
        // A NaN where there is nothing, which stays one and is never the least.
        right[i] = half_areas(lanes, around)
            .add(memory)
            .mul(blocks)
            .or(zero.not_less(blocks))
            .or(forbidden(i));
    }
    (around, load) = ([nothing; 3], [Load::default(); 4]);
    let (mut least, mut at) = (F4::splat(f32::INFINITY), zero);
    for i in 1..N {
        for k in 0..3 {
            around[k] = lanes.min(boxes[k][i - 1].load(lanes), around[k]);
        }
        load = sum(load, begin[i - 1]);
        let blocks = cost_of(load);
        let cost = half_areas(lanes, around)
            .add(memory)
            .mul(blocks)
            .or(zero.not_less(blocks))
            .add(right[i]);
        at = at.max(F4::splat(i as f32).and(cost.below(least)));
        least = cost.min(least);
    }
    let (least, at) = (least.to_array(), at.truncate());
    let mut best: Option<Best> = None;
    for axis in 0..3 {
        let (bin, cost) = (at[axis] as usize, least[axis]);
        if bin > 0 && best.is_none_or(|best| cost < best.cost) {
            best = Some(Best { axis, bin, cost });
        }
    }
    best
}

/// Where twice the centers fall into `N` bins along each axis.
#[derive(Clone, Copy)]
pub(super) struct Binning<const N: usize> {
    pub(super) min: F4,
    pub(super) scale: F4,
}

impl<const N: usize> Binning<N> {
    #[inline(always)]
    pub(super) fn new(centers: &Aabb) -> Self {
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
pub(super) struct Bins<const N: usize> {
    boxes: [[Box8; N]; 3],
    loads: [Loads; N],
}

impl<const N: usize> Bins<N> {
    #[inline(always)]
    pub(super) fn of<L: Lanes>(lanes: L, items: &[Primitive], kinds: Kinds, binning: &Binning<N>) -> Self {
        let mut bins = Self {
            boxes: [[Box8::EMPTY; N]; 3],
            loads: [[Load::default(); 4]; N],
        };
        // Neighbors often fall into one bin, and the second would have to wait for the first.
        let (front, back) = items.split_at(items.len() / 2);
        for (a, b) in front.iter().zip(back) {
            bins.put(lanes, a, kinds, binning);
            bins.put(lanes, b, kinds, binning);
        }
        if let Some(last) = back.get(front.len()) {
            bins.put(lanes, last, kinds, binning);
        }
        bins
    }

    #[inline(always)]
    fn put<L: Lanes>(&mut self, lanes: L, item: &Primitive, kinds: Kinds, binning: &Binning<N>) {
        let load = Load::of(item, kinds);
        let bounds = item.aabb();
        let [x, y, z, _] = binning.bins(&bounds);
        let bounds = eight(lanes, &bounds);
        for (axis, bin) in [x, y, z].into_iter().enumerate() {
            self.boxes[axis][bin].grow(lanes, bounds);
            self.loads[bin][axis].add(load);
        }
    }

    pub(super) fn merge<L: Lanes>(mut self, lanes: L, other: &Self) -> Self {
        for k in 0..3 {
            for i in 0..N {
                self.boxes[k][i].grow(lanes, other.boxes[k][i].load(lanes));
            }
        }
        for i in 0..N {
            self.loads[i] = sum(self.loads[i], other.loads[i]);
        }
        self
    }

    /// The plane of least cost, where each block costs `memory` more, and the boxes around both parts.
    #[inline(always)]
    pub(super) fn best<L: Lanes>(
        &self,
        lanes: L,
        scales: [f32; 4],
        memory: f32,
    ) -> Option<(Best, [Aabb; 2])> {
        // Along an axis on which all centers coincide nothing can be divided.
        let flat = F4::from_array(scales.map(|scale| if scale == 0.0 { f32::NAN } else { 0.0 }));
        let best = best(lanes, &self.boxes, &self.loads, &self.loads, memory, |_| flat)?;
        let around = |boxes: &[Box8]| {
            let around = boxes.iter().fold(Box8::EMPTY.load(lanes), |around, bin| {
                lanes.min(bin.load(lanes), around)
            });
            aabb(lanes, around)
        };
        let boxes = &self.boxes[best.axis];
        Some((best, [around(&boxes[..best.bin]), around(&boxes[best.bin..])]))
    }
}
