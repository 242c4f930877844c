//! Leaves: four triangles or four spheres in f32, tested at once to find the ones that may be hit.
//!
//! What is found here is decided in f64 elsewhere; what is dropped here is certainly missed. Every test allows
//! for the rounding of its inputs and of its own steps. With u = 2^-24 (half a unit in the last place of f32),
//! M the largest coordinate of the level and of the ray's start, D = |dx| + |dy| + |dz|, and L the larger of
//! |e1| and |e2| in that norm, the bounds below follow step by step from |fl(a op b) - a op b| <= u |a op b|
//! (Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 3) and are then rounded up to powers
//! of two.

use super::four::F4;
use crate::math::{DVec3, Ray};

/// Number of lanes in a block.
pub const BLOCK: usize = 4;
/// In place of an id: the lane is empty.
pub const NONE: u32 = u32::MAX;

/// A ray prepared for the f32 tests of a level's blocks.
#[derive(Clone, Copy, Debug)]
pub struct RayBlock {
    origin: [F4; 3],
    dir: [F4; 3],
    /// Error of edge functions: 2^-17 M D, to be multiplied by L.
    slack_edge: F4,
    /// Error of the distance's numerator: 2^-18 M, to be multiplied by L^2.
    slack_t: F4,
    /// Error of the determinant: 2^-20 D, to be multiplied by L^2.
    slack_det: F4,
    /// 1 / |d|^2 and 1 / |d|, for spheres; the error of the distance between a sphere's center and the ray is
    /// 2^-18 M too.
    inverse_dd: F4,
    inverse_length: F4,
}

impl RayBlock {
    /// Prepares a ray of a level whose coordinates are at most `extent` in size.
    #[inline]
    #[must_use]
    pub fn new(ray: &Ray, extent: f64) -> Self {
        let [ox, oy, oz] = ray.origin.to_array().map(|x| x as f32);
        let [dx, dy, dz] = ray.dir.to_array().map(|x| x as f32);
        // The bounds leave room for the roundings of this much.
        let m = (extent as f32).max(ox.abs()).max(oy.abs()).max(oz.abs());
        let d = dx.abs() + dy.abs() + dz.abs();
        let inverse_dd = 1.0 / (dx * dx + dy * dy + dz * dz);
        // A direction whose square leaves the range of f32 leaves every question to f64.
        let m = if inverse_dd.is_normal() { m } else { f32::INFINITY };
        const fn power(n: i32) -> f32 {
            1.0 / (1u32 << n) as f32
        }
        Self {
            origin: [ox, oy, oz].map(F4::splat),
            dir: [dx, dy, dz].map(F4::splat),
            slack_edge: F4::splat(power(17) * m * d),
            slack_t: F4::splat(power(18) * m),
            slack_det: F4::splat(power(20) * d),
            inverse_dd: F4::splat(inverse_dd),
            inverse_length: F4::splat(inverse_dd.sqrt()),
        }
    }
}

/// Which lanes of a block a ray may hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidates {
    /// Lanes that f64 must look at: all others are missed.
    pub possible: u32,
    /// Lanes among them that are certainly hit within the range asked for.
    pub certain: u32,
}

/// Four triangles: one corner, two edges, and the size of the edges.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Triangles {
    corner: [[f32; BLOCK]; 3],
    edge1: [[f32; BLOCK]; 3],
    edge2: [[f32; BLOCK]; 3],
    extent: [f32; BLOCK],
    /// Triangle indices; [`NONE`] in empty lanes.
    pub ids: [u32; BLOCK],
}

impl Triangles {
    /// A block of no triangles. The negative size of the edges makes every test drop the lane.
    pub const EMPTY: Self = Self {
        corner: [[0.0; BLOCK]; 3],
        edge1: [[0.0; BLOCK]; 3],
        edge2: [[0.0; BLOCK]; 3],
        extent: [-1.0; BLOCK],
        ids: [NONE; BLOCK],
    };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, id: u32, [a, b, c]: [DVec3; 3]) {
        let (e1, e2) = (b - a, c - a);
        for k in 0..3 {
            self.corner[k][lane] = a[k] as f32;
            self.edge1[k][lane] = e1[k] as f32;
            self.edge2[k][lane] = e2[k] as f32;
        }
        let size = |e: DVec3| e.x.abs() + e.y.abs() + e.z.abs();
        self.extent[lane] = super::boxes::round_up(size(e1).max(size(e2)) * (1.0 + 1e-6));
        self.ids[lane] = id;
    }

    /// The ray-triangle test of Moeller and Trumbore ("Fast, minimum storage ray/triangle intersection", 1997)
    /// with the errors of f32 allowed for. `t_least` and `t_most` bound the certain hits, `t_bound` the possible
    /// ones.
    #[inline(always)]
    #[must_use]
    pub fn candidates(&self, ray: &RayBlock, t_least: f32, t_most: f32, t_bound: f32) -> Candidates {
        let vector = |a: &[[f32; BLOCK]; 3]| a.map(F4::from_array);
        let (e1, e2, corner) = (vector(&self.edge1), vector(&self.edge2), vector(&self.corner));
        let d = ray.dir;
        let p = cross(d, e2);
        let det = dot(e1, p);
        let sign = det.sign();
        let det = det.flip(sign);
        let s = [0, 1, 2].map(|k| ray.origin[k].sub(corner[k]));
        let u = dot(s, p).flip(sign);
        let q = cross(s, e1);
        let v = dot(d, q).flip(sign);
        let t = dot(e2, q).flip(sign);
        let extent = F4::from_array(self.extent);
        let extent2 = extent.mul(extent);
        let zero = F4::splat(0.0);
        let slack = ray.slack_edge.mul(extent);
        let slack_w = slack.add(slack);
        let slack_t = ray.slack_t.mul(extent2);
        let slack_det = ray.slack_det.mul(extent2);
        let uv = u.add(v);
        // Written as what is dropped, so that a NaN from overflow is kept.
        let bound = F4::splat(t_bound);
        let outside = u.add(slack).below(zero)
            | v.add(slack).below(zero)
            | det.add(slack_w).below(uv)
            | t.add(slack_t).below(zero)
            | bound.mul(det.add(slack_det)).below(t.sub(slack_t));
        // Seen edge-on, the determinant's sign is not known, nor then anything else.
        let edge_on = !slack.below(det) & 15;
        let possible = (!outside | edge_on) & 15;
        let certain = if possible == 0 {
            0
        } else {
            !edge_on
                & slack.below(u)
                & slack.below(v)
                & uv.below(det.sub(slack_w))
                & F4::splat(t_least).mul(det.add(slack_det)).below(t.sub(slack_t))
                & t.add(slack_t).below(F4::splat(t_most).mul(det.sub(slack_det)))
        };
        Candidates { possible, certain }
    }
}

/// Four spheres.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Spheres {
    center: [[f32; BLOCK]; 3],
    radius: [f32; BLOCK],
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

    /// Lanes whose sphere comes within reach of the ray before `t_bound`: the distance from center to line is
    /// taken from a vector, not from a difference of squares, which would lose small spheres far away.
    #[inline(always)]
    #[must_use]
    pub fn possible(&self, ray: &RayBlock, t_bound: f32) -> u32 {
        let f = [0, 1, 2].map(|k| F4::from_array(self.center[k]).sub(ray.origin[k]));
        let t = dot(f, ray.dir).mul(ray.inverse_dd);
        let l = [0, 1, 2].map(|k| f[k].sub(ray.dir[k].mul(t)));
        let reach = F4::from_array(self.radius).add(ray.slack_t);
        let around = reach.mul(ray.inverse_length);
        let outside = reach.mul(reach).below(dot(l, l))
            | t.add(around).below(F4::splat(0.0))
            | F4::splat(t_bound).below(t.sub(around))
            | reach.below(F4::splat(0.0));
        !outside & 15
    }
}

#[inline(always)]
fn dot(a: [F4; 3], b: [F4; 3]) -> F4 {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

#[inline(always)]
fn cross(a: [F4; 3], b: [F4; 3]) -> [F4; 3] {
    [
        a[1].mul(b[2]).sub(a[2].mul(b[1])),
        a[2].mul(b[0]).sub(a[0].mul(b[2])),
        a[0].mul(b[1]).sub(a[1].mul(b[0])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::max_abs;
    use crate::shape::{Sphere, triangle::TriangleRay};

    fn random() -> impl FnMut() -> f64 {
        let mut state = 5u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Rays at triangles of every size, most of them close to an edge, at scales from 1e-18 to 1e18.
    #[test]
    fn what_f64_hits_is_never_dropped_and_what_is_certain_is_hit() {
        let mut next = random();
        let (mut hits, mut certain, mut dropped) = (0, 0, 0);
        for round in 0..200_000 {
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
            block.set(2, 7, corners);
            let extent = corners.iter().map(|c| max_abs(*c)).fold(0.0, f64::max);
            let prepared = RayBlock::new(&ray, extent);
            let found = block.candidates(&prepared, 0.0, f32::MAX, f32::INFINITY);
            let hit = TriangleRay::new(&ray)
                .intersect(corners[0], corners[1], corners[2])
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
            dropped += u32::from(found.possible & 4 == 0);
        }
        assert!(
            hits > 60_000 && certain > 10_000 && dropped > 20_000,
            "{hits} {certain} {dropped}"
        );
    }

    #[test]
    fn no_sphere_that_f64_hits_is_dropped() {
        let mut next = random();
        let (mut hits, mut dropped) = (0, 0);
        for round in 0..100_000 {
            let scale = [1.0, 1e-6, 1e6, 1e12][round % 4];
            let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
            let center = vector(scale);
            let origin = vector(3.0 * scale);
            let radius = scale * [0.5, 1e-3, 1e-7][round / 4 % 3];
            // Half of them graze.
            let towards = center - origin;
            let side = towards.cross(vector(1.0)).normalize();
            let aim = center
                + side
                    * radius
                    * if round % 2 == 0 {
                        1.0
                    } else {
                        1.3 * vector(1.0).x.abs()
                    };
            let ray = Ray::new(origin, (aim - origin) / scale);
            let mut block = Spheres::EMPTY;
            block.set(1, 3, center, radius);
            let prepared = RayBlock::new(&ray, max_abs(center) + radius);
            let possible = block.possible(&prepared, f32::INFINITY);
            assert_eq!(possible & !2, 0, "an empty lane is never possible");
            if Sphere::roots(center, radius, &ray).is_some_and(|(_, t1)| t1 > 0.0) {
                hits += 1;
                assert_ne!(possible, 0, "round {round}: {ray:?} {center} {radius}");
            }
            dropped += u32::from(possible == 0);
        }
        assert!(hits > 20_000 && dropped > 5_000, "{hits} {dropped}");
    }
}
