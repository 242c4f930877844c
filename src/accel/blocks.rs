//! Leaves: four triangles or four spheres in f32, tested at once to find the ones that may be hit.
//!
//! What is found here is decided in f64 elsewhere; what is dropped here is certainly missed. Every test allows
//! for the rounding of its inputs and of its own steps. With u = 2^-24 (half a unit in the last place of f32),
//! M the largest coordinate of the level and of the ray's start, D = |dx| + |dy| + |dz|, and L the larger of
//! |e1| and |e2| in that norm, the bounds follow step by step from |fl(a op b) - a op b| <= u |a op b|
//! (Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 3), fused operations or not:
//!
//! - The start, a corner: u M each. Their difference s, at most 2 M: 4 u M.
//! - p = d x e2, with the roundings of d, e2, the products and their difference: 4 u (|di ej| + |dj ei|), which
//!   sums up to 4 u D L. The edge function s.p: 4 u M D L by s, 8 by p, 6 by its products and sums: 18 u M D L.
//! - q = s x e1: 10 u M (|ei| + |ej|). The edge function d.q: 10 by q, 2 by d, 6 by its products and sums:
//!   18 u M D L. Their sum: 36 and 4 of its own.
//! - The determinant e1.p: 8 u D L^2. The numerator of the distance e2.q: 10 by q, 8 by the rest: 18 u M L^2.
//!
//! Terms of u^2, and what f64 may differ from the exact value, are covered by taking a tenth more and better:
//! [`RayBlock`] has 22 for 20 and for 18, 10 for 8.

use super::{
    corners::Corners,
    four::F4,
    lanes::Lanes,
    ray::{RayBlock, RaySphere},
};
use crate::math::DVec3;

/// Number of lanes in a block.
pub const BLOCK: usize = 4;
/// In place of an id: the lane is empty.
pub const NONE: u32 = u32::MAX;

/// The range of t that is asked for, widened or narrowed to f32.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// No hit before this counts, at most 0: what is certainly before it is dropped.
    pub possible: f32,
    /// No hit after this counts, at least as far as the exact bound.
    pub bound: f32,
    /// Every hit between these counts.
    pub certain: [f32; 2],
}

/// Which lanes of a block a ray may hit.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    /// Lanes that f64 must look at: all others are missed.
    pub possible: u32,
    /// Lanes among them that are certainly hit within the range asked for.
    pub certain: u32,
    /// t in f64 lies between these in certain lanes; without meaning in others.
    pub t: [[f32; BLOCK]; 2],
}

impl Candidates {
    pub(super) const NONE: Self = Self {
        possible: 0,
        certain: 0,
        t: [[0.0; BLOCK]; 2],
    };
}

/// Four triangles: one corner and two edges; three lines of a cache.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Triangles {
    pub(super) corner: [[f32; BLOCK]; 3],
    pub(super) edge1: [[f32; BLOCK]; 3],
    pub(super) edge2: [[f32; BLOCK]; 3],
    /// Triangle indices; [`NONE`] in empty lanes, which alone has the top bit.
    pub ids: [u32; BLOCK],
    /// Where the corners of each are kept in full: here because a look into the list of triangles, or of vertices, is one
    /// that no cache foresees.
    pub corners: [Corners; BLOCK],
}

impl Triangles {
    /// A block of no triangles.
    pub const EMPTY: Self = Self {
        corner: [[0.0; BLOCK]; 3],
        edge1: [[0.0; BLOCK]; 3],
        edge2: [[0.0; BLOCK]; 3],
        ids: [NONE; BLOCK],
        corners: [Corners::ELSEWHERE; BLOCK],
    };

    /// Puts a triangle into a lane, whose corners have these numbers where they are kept in full.
    pub fn set(&mut self, lane: usize, id: u32, corners: [DVec3; 3], numbers: [u32; 3]) {
        let [a, b, c] = corners;
        let (e1, e2) = (b - a, c - a);
        for k in 0..3 {
            self.corner[k][lane] = a[k] as f32;
            self.edge1[k][lane] = e1[k] as f32;
            self.edge2[k][lane] = e2[k] as f32;
        }
        self.ids[lane] = id;
        let bits = |corners: [[f64; 3]; 3]| corners.map(|corner| corner.map(f64::to_bits));
        let are_here = bits(self.exact(lane, [0, 1, 2])) == bits(corners.map(|corner| corner.to_array()));
        self.corners[lane] = if are_here {
            Corners::HERE
        } else {
            Corners::new(numbers)
        };
    }

    /// The corners of a triangle whose corners are [`Corners::HERE`], with their axes in this order. Vertices mostly come
    /// from files with numbers of f32, and the difference of two that are near to each other is one again.
    #[inline(always)]
    #[must_use]
    pub fn exact(&self, lane: usize, axes: [usize; 3]) -> [[f64; 3]; 3] {
        let lane = lane & (BLOCK - 1);
        let [x, y, z] = axes;
        let of = |a: &[[f32; BLOCK]; 3]| [a[x][lane], a[y][lane], a[z][lane]].map(f64::from);
        let (a, e1, e2) = (of(&self.corner), of(&self.edge1), of(&self.edge2));
        [
            a,
            [a[0] + e1[0], a[1] + e1[1], a[2] + e1[2]],
            [a[0] + e2[0], a[1] + e2[1], a[2] + e2[2]],
        ]
    }

    /// L of each triangle, no less: the factor is for the roundings of the edges and of the sums.
    #[inline(always)]
    pub(super) fn sizes(e1: [F4; 3], e2: [F4; 3]) -> F4 {
        let size = |[x, y, z]: [F4; 3]| x.abs().add(y.abs()).add(z.abs());
        size(e1).max(size(e2)).mul(F4::splat(1.0 + 1e-6))
    }

    /// The ray-triangle test of Moeller and Trumbore ("Fast, minimum storage ray/triangle intersection", 1997)
    /// with the errors of f32 allowed for.
    #[inline(always)]
    #[must_use]
    pub fn candidates<L: Lanes>(&self, lanes: L, ray: &RayBlock, range: Range) -> Candidates {
        let vector = |a: &[[f32; BLOCK]; 3]| a.map(F4::from_array);
        let (e1, e2, corner) = (vector(&self.edge1), vector(&self.edge2), vector(&self.corner));
        let d = [0, 1, 2].map(|k| F4::splat(ray.dir[k]));
        let p = cross(lanes, d, e2);
        let det = dot(lanes, e1, p);
        let sign = det.sign();
        let det = det.flip(sign);
        let s = [0, 1, 2].map(|k| F4::splat(ray.origin[k]).sub(corner[k]));
        let u = dot(lanes, s, p).flip(sign);
        let q = cross(lanes, s, e1);
        let v = dot(lanes, d, q).flip(sign);
        let extent = Self::sizes(e1, e2);
        let (least_slack, unit) = (F4::splat(ray.slack_least), F4::splat(ray.slack));
        let along = extent.mul(F4::splat(ray.long));
        let slack = lanes.mul_add4(unit, along, least_slack);
        let slack_det = lanes.mul_add4(F4::splat(RayBlock::SLACK_DET), extent.mul(along), least_slack);
        let slack_w = slack.add(slack).add(slack_det);
        let uv = u.add(v);
        let least = u.min(v);
        // Written as what is dropped, so that a NaN from overflow is kept. Seen edge-on, the determinant's sign
        // is not known, nor then anything else.
        let aside = least
            .add(slack)
            .below(F4::splat(0.0))
            .or(det.add(slack_w).below(uv));
        let sure = slack_det.below(det);
        let empty = F4::from_array(self.ids.map(f32::from_bits));
        let near = !aside.and(sure).or(empty).bits() & 15;
        if near == 0 {
            return Candidates::NONE;
        }
        let t = dot(lanes, e2, q).flip(sign);
        let slack_t = lanes.mul_add4(unit, extent.mul(extent), least_slack);
        let (det_least, det_most) = (det.sub(slack_det), det.add(slack_det));
        let (t_least, t_most) = (t.sub(slack_t), t.add(slack_t));
        let before = t_most.below(F4::splat(range.possible).mul(det_most));
        let after = F4::splat(range.bound).mul(det_most).below(t_least);
        let possible = near & !before.or(after).and(sure).bits();
        if possible == 0 {
            return Candidates::NONE;
        }
        let inside = slack.below(least).and(uv.below(det.sub(slack_w)));
        let within = F4::splat(range.certain[0])
            .mul(det_most)
            .below(t_least)
            .and(t_most.below(F4::splat(range.certain[1]).mul(det_least)));
        Candidates {
            possible,
            certain: sure.and(inside).and(within).bits() & possible,
            t: [
                t_least
                    .div(det_most)
                    .mul(F4::splat(1.0 - 4.0 * f32::EPSILON))
                    .to_array(),
                t_most
                    .div(det_least)
                    .mul(F4::splat(1.0 + 4.0 * f32::EPSILON))
                    .to_array(),
            ],
        }
    }
}

/// Four spheres.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Spheres {
    pub(super) center: [[f32; BLOCK]; 3],
    pub(super) radius: [f32; BLOCK],
    /// Sphere indices; [`NONE`] in empty lanes.
    pub ids: [u32; BLOCK],
}

impl Spheres {
    /// A block of no spheres.
    pub const EMPTY: Self = Self {
        center: [[0.0; BLOCK]; 3],
        radius: [f32::NEG_INFINITY; BLOCK],
        ids: [NONE; BLOCK],
    };

    /// Puts a sphere into a lane.
    pub fn set(&mut self, lane: usize, id: u32, center: DVec3, radius: f64) {
        for k in 0..3 {
            self.center[k][lane] = center[k] as f32;
        }
        self.radius[lane] = super::boxes::round_up(radius * (1.0 + 1e-6));
        self.ids[lane] = id;
    }

    /// Lanes whose sphere comes within reach of the ray, and lanes that are hit for certain: the distance from
    /// center to line is taken from a vector, not from a difference of squares, which would lose small spheres
    /// far away. For certain the first crossing lies between the sphere's near end and the point nearest to its
    /// center, the second between that and the far end.
    #[inline(always)]
    #[must_use]
    pub fn candidates<L: Lanes>(
        &self,
        lanes: L,
        ray: &RayBlock,
        about: &RaySphere,
        range: Range,
    ) -> [u32; 2] {
        let d = [0, 1, 2].map(|k| F4::splat(ray.dir[k]));
        let f = [0, 1, 2].map(|k| F4::from_array(self.center[k]).sub(F4::splat(ray.origin[k])));
        let t = dot(lanes, f, d).mul(F4::splat(about.inverse_dd));
        let l = [
            lanes.mul_sub4(d[0], t, f[0]),
            lanes.mul_sub4(d[1], t, f[1]),
            lanes.mul_sub4(d[2], t, f[2]),
        ];
        let aside2 = dot(lanes, l, l);
        let radius = F4::from_array(self.radius);
        let slack = F4::splat(about.slack);
        let reach = radius.add(slack);
        let around = reach.mul(F4::splat(about.inverse_length));
        let (near, far) = (t.sub(around), t.add(around));
        let bound = F4::splat(range.bound);
        let outside = reach
            .mul(reach)
            .below(aside2)
            .or(far.below(F4::splat(range.possible)))
            .or(bound.below(near))
            // An empty lane's negative radius has the top bit.
            .or(radius);
        let possible = !outside.bits() & 15;
        if possible == 0 {
            return [0; 2];
        }
        let core = radius.mul(F4::splat(1.0 - 4e-6)).sub(slack);
        let inside = aside2.below(core.mul(core)).and(F4::splat(0.0).below(core));
        let give = slack.mul(F4::splat(about.inverse_length));
        let [least, most] = range.certain.map(F4::splat);
        let first = least.below(near).and(t.add(give).below(most));
        let second = least.below(t.sub(give)).and(far.below(most));
        [possible, inside.and(first.or(second)).bits() & possible]
    }
}

#[inline(always)]
fn dot<L: Lanes>(lanes: L, a: [F4; 3], b: [F4; 3]) -> F4 {
    lanes.mul_add4(a[0], b[0], lanes.mul_add4(a[1], b[1], a[2].mul(b[2])))
}

#[inline(always)]
fn cross<L: Lanes>(lanes: L, a: [F4; 3], b: [F4; 3]) -> [F4; 3] {
    [
        lanes.mul_sub4(a[1], b[2], a[2].mul(b[1])),
        lanes.mul_sub4(a[2], b[0], a[0].mul(b[2])),
        lanes.mul_sub4(a[0], b[1], a[1].mul(b[0])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Sphere, triangle::TriangleRay};
    use crate::{
        accel::{cases, lanes::Portable, ray::Ray32},
        math::{Ray, max_abs},
    };

    const EVERYWHERE: Range = Range {
        possible: 0.0,
        bound: f32::INFINITY,
        certain: [0.0, f32::MAX],
    };

    fn random() -> impl FnMut() -> f64 {
        let mut next = crate::accel::random(5);
        move || 2.0 * next() - 1.0
    }

    /// Rays at triangles of every size, most of them close to an edge, at scales from 1e-18 to 1e18.
    #[test]
    fn what_f64_hits_is_never_dropped_and_what_is_certain_is_hit() {
        let mut next = random();
        let (mut hits, mut certain, mut dropped) = (0, 0, 0);
        for round in 0..cases(200_000) {
            let scale = [1.0, 1e-6, 1e6, 1e-18, 1e18, 1e12][round % 6];
            let size = [1.0, 1e-3, 1e-6][round / 6 % 3];
            let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
            let a = vector(scale);
            let corners = [a, a + vector(scale * size), a + vector(scale * size)];
            let origin = vector(3.0 * scale);
            let weights = vector(1.0).abs();
            let weights = weights / (weights.x + weights.y + weights.z);
            let aim = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            // At the inside, straight at an edge, a little beside it, far beside it.
            let aim = match round / 18 % 4 {
                0 => aim,
                3 => aim + vector(3.0 * scale * size),
                1 => corners[0] + (corners[1] - corners[0]) * weights.x,
                _ => corners[0] + (corners[1] - corners[0]) * weights.x + vector(1e-7 * scale * size),
            };
            let ray = Ray::new(origin, (aim - origin) * (1.0 + weights.y));
            let mut block = Triangles::EMPTY;
            block.set(2, 7, corners, [0, 1, 2]);
            let extent = corners.iter().map(|c| max_abs(*c)).fold(0.0, f64::max);
            let prepared = RayBlock::new(&Ray32::new(&ray), extent as f32);
            let found = block.candidates(Portable, &prepared, EVERYWHERE);
            let hit = TriangleRay::new(&ray)
                .intersect(corners.each_ref())
                .filter(|h| h.t > 0.0);
            if hit.is_some() {
                hits += 1;
                assert_ne!(found.possible & 4, 0, "round {round}: {ray:?} {corners:?}");
            }
            if found.certain & 4 != 0 {
                certain += 1;
                assert!(hit.is_some(), "round {round}: {ray:?} {corners:?}");
            }
            assert_eq!(found.possible & !4, 0, "an empty lane is always dropped");
            dropped += usize::from(found.possible & 4 == 0);
        }
        assert!(
            hits > cases(60_000) && certain > cases(10_000) && dropped > cases(15_000),
            "{hits} {certain} {dropped}"
        );
    }

    #[test]
    fn no_sphere_that_f64_hits_is_dropped_and_what_is_certain_is_hit() {
        let mut next = random();
        let (mut hits, mut certain, mut dropped) = (0, 0, 0);
        for round in 0..cases(100_000) {
            let scale = [1.0, 1e-6, 1e6, 1e12, 1e-12, 1e-16, 1e-19, 1e-22][round % 8];
            let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
            let center = vector(scale);
            let origin = vector(3.0 * scale);
            let radius = scale * [0.5, 1e-3, 1e-7][round / 8 % 3];
            // Half of them graze.
            let towards = center - origin;
            let side = towards.cross(vector(1.0)).normalize();
            let aim = center
                + side
                    * radius
                    * if round / 24 % 2 == 0 {
                        1.0
                    } else {
                        1.3 * vector(1.0).x.abs()
                    };
            let ray = Ray::new(origin, (aim - origin) / scale);
            let mut block = Spheres::EMPTY;
            block.set(1, 3, center, radius);
            let prepared = RayBlock::new(&Ray32::new(&ray), (max_abs(center) + radius) as f32);
            let [possible, sure] =
                block.candidates(Portable, &prepared, &RaySphere::new(&prepared), EVERYWHERE);
            assert_eq!(possible & !2, 0, "an empty lane is never possible");
            if Sphere::roots(center, radius, &ray).is_some_and(|(_, t1)| t1 > 0.0) {
                hits += 1;
                assert_ne!(possible, 0, "round {round}: {ray:?} {center} {radius}");
            } else {
                assert_eq!(sure, 0, "round {round}: {ray:?} {center} {radius}");
            }
            certain += usize::from(sure != 0);
            dropped += usize::from(possible == 0);
        }
        assert!(
            hits > cases(20_000) && certain > cases(10_000) && dropped > cases(3_000),
            "{hits} {certain} {dropped}"
        );
    }
}
