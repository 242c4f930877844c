//! Leaves against the rays of a packet: one triangle, sphere or box at a time, a register of rays at once.
//!
//! As the rays start at one point, what depends on the point alone is found once for each triangle: with
//! s = o - a the edge functions are u = d (e2 x s) and v = d (s x e1), the determinant is d (e2 x e1), and
//! the distance's numerator e2 (s x e1) does not depend on the ray at all. The errors are those of the single
//! ray's test (`accel/blocks.rs`) with the products taken in another order: a triple product of factors that
//! were rounded to f32 is off by at most 20 * 2^-24 of M D L for u and v, 2^-21 of D L^2 for the determinant,
//! 18 * 2^-24 of M L^2 for the numerator, and the bounds below are the same.

use super::{PACKET, RayPacket, Row, wide::Wide};
use crate::accel::{
    Spot,
    blocks::{BLOCK, Spheres, Triangles},
    cuboids::{self, Cuboids},
    four::F4,
};

/// Errors of the f32 tests of a packet; see `accel/blocks.rs`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slack {
    /// Largest coordinate.
    pub(super) size: f32,
    edge: f32,
    t: f32,
    det: f32,
}

impl Slack {
    pub(super) const NONE: Self = Self {
        size: 0.0,
        edge: 0.0,
        t: 0.0,
        det: 0.0,
    };

    /// For coordinates up to `m` and directions with |dx| + |dy| + |dz| up to `d`.
    pub(super) fn new(m: f32, d: f32) -> Self {
        const fn power(n: i32) -> f32 {
            1.0 / (1u32 << n) as f32
        }
        Self {
            size: m,
            edge: power(17) * m * d,
            t: power(18) * m,
            det: power(20) * d,
        }
    }
}

/// Triangles of a block as the packet's origin sees them.
pub(super) struct Seen {
    normal: [[f32; BLOCK]; 3],
    u: [[f32; BLOCK]; 3],
    v: [[f32; BLOCK]; 3],
    t: [f32; BLOCK],
    slack: [f32; BLOCK],
    slack_t: [f32; BLOCK],
    slack_det: [f32; BLOCK],
}

impl Seen {
    #[inline(always)]
    pub(super) fn new(block: &Triangles, packet: &RayPacket) -> Self {
        let (e1, e2, corner) = (vector(&block.edge1), vector(&block.edge2), vector(&block.corner));
        let s = [
            F4::splat(packet.origin[0]).sub(corner[0]),
            F4::splat(packet.origin[1]).sub(corner[1]),
            F4::splat(packet.origin[2]).sub(corner[2]),
        ];
        let v = cross(s, e1);
        let extent = Triangles::sizes(e1, e2);
        let extent2 = extent.mul(extent);
        Self {
            normal: arrays(cross(e2, e1)),
            u: arrays(cross(e2, s)),
            v: arrays(v),
            t: dot(e2, v).to_array(),
            slack: F4::splat(packet.slack.edge).mul(extent).to_array(),
            slack_t: F4::splat(packet.slack.t).mul(extent2).to_array(),
            slack_det: F4::splat(packet.slack.det).mul(extent2).to_array(),
        }
    }
}

/// What some rays of a packet may meet.
pub(super) struct Met {
    /// Rays that f64 must look at.
    pub(super) possible: u64,
    /// Rays among them that certainly hit, after `t_least` and before their bound.
    pub(super) certain: u64,
}

impl RayPacket {
    /// Which of the `active` rays may hit a triangle. Without `ANY` what is certain lowers the bounds, and where it is
    /// nearer than what was certain before it takes its place and is not returned; `lowest` receives lower bounds of
    /// t for the others.
    #[inline(always)]
    pub(super) fn triangle<W: Wide, const ANY: bool>(
        &mut self,
        w: W,
        seen: &Seen,
        (lane, spot): (usize, Spot),
        active: u64,
        lowest: &mut Row,
    ) -> Met {
        let lane = lane & (BLOCK - 1);
        let normal = w.broadcast3(&seen.normal, lane);
        let (to_u, to_v) = (w.broadcast3(&seen.u, lane), w.broadcast3(&seen.v, lane));
        let t = w.splat(seen.t[lane]);
        let slack = w.splat(seen.slack[lane]);
        let slack_t = w.splat(seen.slack_t[lane]);
        let slack_det = w.splat(seen.slack_det[lane]);
        let zero = w.splat(0.0);
        let least_slack = w.sub(zero, slack);
        let least_t = w.splat(self.t_least);
        let certain_share = w.splat(self.certain_share);
        let (shrink, grow) = (w.splat(1.0 - 1e-6), w.splat(1.0 + 1e-6));
        let infinity = w.splat(f32::INFINITY);
        let spot = w.splat(spot.to_f32());
        let mut met = Met {
            possible: 0,
            certain: 0,
        };
        let all = u64::MAX >> (PACKET - W::LANES);
        for group in 0..PACKET / W::LANES {
            let shift = group * W::LANES;
            let here = active >> shift & all;
            if here == 0 {
                continue;
            }
            let d = w.load3(&self.dir, group);
            let det = w.dot(d, normal);
            let sign = w.sign(det);
            let det = w.flip(det, sign);
            let (u, v) = (w.flip(w.dot(d, to_u), sign), w.flip(w.dot(d, to_v), sign));
            let t = w.flip(t, sign);
            let rest = w.sub(w.sub(det, u), v);
            // Twice the slack is due to the third, which is the sum of the others' errors.
            let inside = w.min(w.add(slack, rest), w.min(u, v));
            let bound = w.load(&self.bound, group);
            let (t_low, t_high) = (w.sub(t, slack_t), w.add(slack_t, t));
            let det_high = w.add(slack_det, det);
            // Written as what is dropped, so that a NaN from overflow is kept.
            let outside = w.bits(w.below(inside, least_slack))
                | w.bits(w.below(t_high, zero))
                | w.bits(w.below(w.mul(bound, det_high), t_low));
            // Seen edge-on, the determinant's sign is not known, nor then anything else.
            let face_on = w.below(slack, det);
            let possible = (!outside | !w.bits(face_on)) & here;
            if possible == 0 {
                continue;
            }
            let low = w.mul(w.div(t_low, det_high), shrink);
            let high = w.mul(w.div(t_high, w.sub(det, slack_det)), grow);
            let inside = w.min(w.sub(rest, slack), w.min(u, v));
            let before = if ANY { w.mul(bound, certain_share) } else { bound };
            let certain = w.and(
                w.and(face_on, w.below(slack, inside)),
                w.and(w.below(least_t, low), w.below(high, before)),
            );
            if ANY {
                met.possible |= possible << shift;
                met.certain |= (w.bits(certain) & here) << shift;
                continue;
            }
            w.store(
                w.min(w.select(certain, high, infinity), bound),
                &mut self.bound,
                group,
            );
            let before = w.load(&self.nearest_low, group);
            let wins = w.and(certain, w.below(high, before));
            w.store(w.select(wins, low, before), &mut self.nearest_low, group);
            let before = w.load(&self.nearest_spot, group);
            w.store(w.select(wins, spot, before), &mut self.nearest_spot, group);
            let others = possible & !w.bits(wins);
            if others != 0 {
                met.possible |= others << shift;
                // Edge-on the distance means nothing.
                w.store(w.select(face_on, low, zero), lowest, group);
            }
        }
        met
    }

    /// Which of the `active` rays come within reach of a block's sphere before their bound, and with `ANY` which hit it for
    /// certain: where the first crossing lies is known as in `accel/blocks.rs`.
    #[inline(always)]
    pub(super) fn sphere<W: Wide, const ANY: bool>(
        &self,
        w: W,
        block: &Spheres,
        lane: usize,
        active: u64,
    ) -> Met {
        let lane = lane & (BLOCK - 1);
        let mut f = [0.0; 3];
        for (k, f) in f.iter_mut().enumerate() {
            *f = block.center[k][lane] - self.origin[k];
        }
        let f = w.splat3(f);
        let radius = block.radius[lane];
        let reach = radius + self.slack.t;
        let mut met = Met {
            possible: 0,
            certain: 0,
        };
        if !(reach >= 0.0) {
            return met;
        }
        // As much larger than what is allowed for above as it is for single rays.
        let slack = 1.1 * self.slack.t;
        let core = (radius * (1.0 - 4e-6) - slack).max(0.0);
        let (core2, half_slack) = (w.splat(core * core), w.splat(slack * (0.5 + 1e-6)));
        let (least_t, certain_share) = (w.splat(self.t_least), w.splat(self.certain_share));
        let (reach2, half_reach) = (w.splat(reach * reach), w.splat(reach * (0.5 + 1e-6)));
        let zero = w.splat(0.0);
        let all = u64::MAX >> (PACKET - W::LANES);
        for group in 0..PACKET / W::LANES {
            let shift = group * W::LANES;
            let here = active >> shift & all;
            if here == 0 {
                continue;
            }
            let d = w.load3(&self.dir, group);
            let inverse_dd = w.div(w.splat(1.0), w.dot(d, d));
            let t = w.mul(w.dot(f, d), inverse_dd);
            let l = [
                w.sub(f[0], w.mul(d[0], t)),
                w.sub(f[1], w.mul(d[1], t)),
                w.sub(f[2], w.mul(d[2], t)),
            ];
            // 1 / |d| is at most the mean of 1 and 1 / |d|^2, and nearly that where d is nearly a unit vector.
            let around = w.mul_add(half_reach, inverse_dd, half_reach);
            let (aside2, near) = (w.dot(l, l), w.sub(t, around));
            let bound = w.load(&self.bound, group);
            let outside = w.bits(w.below(reach2, aside2))
                | w.bits(w.below(w.add(around, t), zero))
                | w.bits(w.below(bound, near));
            let possible = !outside & here;
            met.possible |= possible << shift;
            if ANY && possible != 0 {
                let give = w.mul_add(half_slack, inverse_dd, half_slack);
                let before = w.mul(bound, certain_share);
                let certain = w.and(
                    w.below(aside2, core2),
                    w.and(w.below(least_t, near), w.below(w.add(t, give), before)),
                );
                met.certain |= (w.bits(certain) & possible) << shift;
            }
        }
        met
    }
}

impl RayPacket {
    /// How far the faces of boxes are moved, to be multiplied by their S; see `accel/cuboids.rs`.
    #[inline(always)]
    pub(super) fn cuboid_slack(&self, extent: f32) -> f32 {
        cuboids::slack(self.origin.iter().fold(extent, |m, x| m.max(x.abs())))
    }

    /// Which of the `active` rays may hit a block's box before their bound. As a single ray's test, with the start
    /// taken into the box's space once.
    #[inline(always)]
    pub(super) fn cuboid<W: Wide>(&self, w: W, block: &Cuboids, lane: usize, slack: f32, active: u64) -> u64 {
        let lane = lane & (BLOCK - 1);
        let zero = w.splat(0.0);
        let (mut rows, mut least, mut most) = ([[zero; 3]; 3], [zero; 3], [zero; 3]);
        for i in 0..3 {
            let row = [
                block.rows[i][0][lane],
                block.rows[i][1][lane],
                block.rows[i][2][lane],
            ];
            let [x, y, z] = self.origin;
            let o = row[0] * x + (row[1] * y + (row[2] * z + block.offset[i][lane]));
            let outer = 1.0 + slack * block.size[i][lane];
            rows[i] = w.splat3(row);
            least[i] = w.splat(-outer - o);
            most[i] = w.splat(outer - o);
        }
        let (one, smallest) = (w.splat(1.0), w.splat(f32::MIN_POSITIVE));
        let mut possible = 0;
        let all = u64::MAX >> (PACKET - W::LANES);
        for group in 0..PACKET / W::LANES {
            let shift = group * W::LANES;
            let here = active >> shift & all;
            if here == 0 {
                continue;
            }
            let d = w.load3(&self.dir, group);
            let (mut near, mut far) = (zero, w.load(&self.bound, group));
            for i in 0..3 {
                let along = w.dot(rows[i], d);
                let sign = w.sign(along);
                let inverse = w.flip(w.div(one, w.max(w.flip(along, sign), smallest)), sign);
                let (a, b) = (w.mul(least[i], inverse), w.mul(most[i], inverse));
                // A NaN is in both or neither, and as the first operand leaves the other as it was.
                near = w.max(w.min(a, b), near);
                far = w.min(w.max(a, b), far);
            }
            possible |= (!w.bits(w.below(far, near)) & here) << shift;
        }
        possible
    }
}

#[inline(always)]
fn vector(a: &[[f32; BLOCK]; 3]) -> [F4; 3] {
    [F4::from_array(a[0]), F4::from_array(a[1]), F4::from_array(a[2])]
}

#[inline(always)]
fn arrays(a: [F4; 3]) -> [[f32; BLOCK]; 3] {
    [a[0].to_array(), a[1].to_array(), a[2].to_array()]
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
    use super::{
        super::{Search, wide::Plain},
        *,
    };
    use crate::{
        accel::{NONE, cases},
        math::{DVec3, Ray, max_abs},
        shape::{Sphere, triangle::TriangleRay},
    };

    fn random() -> impl FnMut() -> f64 {
        let mut next = crate::accel::random(9);
        move || 2.0 * next() - 1.0
    }

    /// A packet of rays that ask for everything; `None` where they do not go together.
    fn packet(rays: &[Ray], extent: f64) -> Option<RayPacket> {
        let mut packet = RayPacket::EMPTY;
        let search = Search {
            extent,
            t_min: 0.0,
            skip: NONE,
            ends: None,
        };
        let bounds = vec![f32::INFINITY; rays.len()];
        let filled = packet.fill(Plain, rays, &bounds, &search);
        packet.nearest_low = [f32::INFINITY; PACKET];
        filled.then_some(packet)
    }

    /// Packets at triangles of every size, most rays close to an edge, at scales from 1e-5 to 1e8.
    #[test]
    fn what_f64_hits_is_never_dropped_and_what_is_certain_lies_between_the_bounds() {
        let mut next = random();
        let (mut hits, mut certain, mut dropped) = (0, 0, 0);
        for round in 0..cases(60_000) {
            let scale = [1.0, 1e-3, 1e-5, 1e3, 1e8][round % 5];
            let size = [0.3, 1e-2, 1e-4, 1e-6][round / 5 % 4];
            let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
            let a = vector(scale);
            let corners = [a, a + vector(scale * size), a + vector(scale * size)];
            let origin = vector(3.0 * scale);
            let rays: Vec<Ray> = (0..11)
                .map(|i| {
                    let weights = vector(1.0).abs();
                    let weights = weights / (weights.x + weights.y + weights.z);
                    let inside = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
                    let edge = corners[0] + (corners[1] - corners[0]) * weights.x;
                    let aim = match i % 4 {
                        0 => inside,
                        1 => edge,
                        2 => edge + vector(1e-7 * scale),
                        _ => inside + vector(scale * size),
                    };
                    Ray::new(
                        origin,
                        (aim - origin) / (aim - origin).length() * (0.5 + weights.y),
                    )
                })
                .collect();
            let extent = corners.iter().map(|c| max_abs(*c)).fold(0.0, f64::max);
            let Some(mut packet) = packet(&rays, extent) else {
                continue;
            };
            let mut block = Triangles::EMPTY;
            block.set(2, 7, corners, [0, 1, 2]);
            let seen = Seen::new(&block, &packet);
            let mut lowest = [0.0; PACKET];
            let all = (1 << rays.len()) - 1;
            let met = packet.triangle::<_, true>(Plain, &seen, (2, Spot::new(0, 2)), all, &mut lowest);
            packet.triangle::<_, false>(Plain, &seen, (2, Spot::new(0, 2)), all, &mut lowest);
            for (i, ray) in rays.iter().enumerate() {
                let hit = TriangleRay::new(ray)
                    .intersect(corners.each_ref())
                    .filter(|h| h.t > 0.0);
                let (possible, sure) = (met.possible >> i & 1 == 1, met.certain >> i & 1 == 1);
                assert!(possible || hit.is_none(), "round {round}: {ray:?} {corners:?}");
                assert!(!sure || hit.is_some(), "round {round}: {ray:?} {corners:?}");
                if let Some(hit) = hit.filter(|_| sure) {
                    let between = f64::from(packet.nearest_low[i])..f64::from(packet.bound[i]);
                    assert!(between.contains(&hit.t), "round {round}: {} {between:?}", hit.t);
                }
                hits += usize::from(hit.is_some());
                certain += usize::from(sure);
                dropped += usize::from(!possible);
            }
        }
        assert!(
            hits > cases(100_000) && certain > cases(30_000) && dropped > cases(30_000),
            "{hits} {certain} {dropped}"
        );
    }

    #[test]
    fn no_sphere_that_f64_hits_is_dropped() {
        let mut next = random();
        let (mut hits, mut certain, mut dropped) = (0, 0, 0);
        for round in 0..cases(40_000) {
            let scale = [1.0, 1e-4, 1e6][round % 3];
            let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
            let (center, origin) = (vector(scale), vector(3.0 * scale));
            let radius = scale * [0.2, 1e-3, 1e-7][round / 3 % 3];
            let rays: Vec<Ray> = (0..9)
                .map(|i| {
                    let side = (center - origin).cross(vector(1.0)).normalize();
                    let aim = center + side * radius * if i % 2 == 0 { 1.0 } else { 1.3 * vector(1.0).x };
                    Ray::new(
                        origin,
                        (aim - origin) / (aim - origin).length() * (1.5 + vector(1.0).x),
                    )
                })
                .collect();
            let Some(packet) = packet(&rays, max_abs(center) + radius) else {
                continue;
            };
            let mut block = Spheres::EMPTY;
            block.set(1, 3, center, radius);
            let of_none = packet.sphere::<_, true>(Plain, &block, 0, u64::MAX);
            assert_eq!(of_none.possible | of_none.certain, 0, "an empty lane");
            let met = packet.sphere::<_, true>(Plain, &block, 1, (1 << rays.len()) - 1);
            for (i, ray) in rays.iter().enumerate() {
                let roots = Sphere::roots(center, radius, ray);
                let hit = roots.is_some_and(|(_, t1)| t1 > 0.0);
                let (possible, sure) = (met.possible >> i & 1 == 1, met.certain >> i & 1 == 1);
                assert!(possible || !hit, "round {round}: {ray:?} {center} {radius}");
                let first = roots.map_or(f64::NAN, |(t0, _)| t0);
                assert!(!sure || first > 0.0, "round {round}: {ray:?} {center} {radius}");
                hits += usize::from(hit);
                certain += usize::from(sure);
                dropped += usize::from(!possible);
            }
        }
        assert!(
            hits > cases(50_000) && certain > cases(30_000) && dropped > cases(5_000),
            "{hits} {certain} {dropped}"
        );
    }
}
