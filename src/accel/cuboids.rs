//! Leaves: four boxes that stand anyhow, in f32, tested at once to find the ones that may be hit.
//!
//! A lane keeps the way into its box's own space, in which the box reaches from -1 to 1 along each axis i:
//! q = m p + c. A ray's o and d become o' = m o + c and d' = m d, and it is inside where |o' + t d'| <= 1 along all
//! three (Kay and Kajiya, "Ray tracing complex scenes", 1986). As with triangles (`blocks.rs`), what is dropped is
//! certainly missed, and what is certain is certainly hit. Let u = 2^-24, M the largest coordinate of the level's
//! boxes and of the ray's start, and S = |mx| + |my| + |mz| of an axis. A point of the box is at most M from 0, and so
//! is its center: |c| <= S M, |t dj| <= 2 M where the ray is in the box, and, as two opposite faces are 2 apart,
//! 1 <= S M. To first order (Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 3):
//!
//! - o': 2 by the roundings of m and o, 4 by products and sums, of S M; 4 of c: 10 u S M.
//! - t d': 2 by the roundings of m and d, 3 by products and sums, of 2 S M: 10 u S M.
//! - The distances to the faces are (-E - o') / d' and (E - o') / d'. The numerator is at most 3.1 S M; the sum, the
//!   inverse and the product are off by 3 units of that, which is the same as moving the faces by 10 u S M.
//! - E itself and the roundings of f64: 2 u S M.
//!
//! They sum up to 32, which 44 covers together with terms of u^2: the faces are moved by 44 u S M outwards for what
//! is possible, inwards for what is certain. For the latter that the point is near the box is not known but follows.
//! Let K be the largest sum of |l| S along a row of l, the inverse of m: a displacement by e S within the box's space
//! is one by at most K e in the level's. Boxes of K up to 2^16 are taken, so that a point that f32 sees inside is at
//! most 1.1 M from 0, and one that f64 sees inside is in the box but for 2^-34 M. All others are always possible.
//!
//! Underflow: with M < 2^40 and the largest |dj| above 2^-40, t < 2^81. A d' below 2^-126 is taken for that, which
//! moves no point by more than 2^-45; products that underflow lose 2^-149 each. Both are small beside 44 u S M.

use super::{
    blocks::{BLOCK, Candidates, NONE, Range},
    boxes::round_up,
    four::F4,
    ray::{RayCuboid, power},
};
use crate::math::{DAffine3, DVec3};

/// Least and largest S of an axis.
const SIZES: [f64; 2] = [1.0 / (1u64 << 60) as f64, (1u64 << 60) as f64];
/// Largest K.
const SPREAD: f64 = (1 << 16) as f64;

/// How far the faces of boxes are moved, to be multiplied by their S, where no coordinate of the level's boxes and of the
/// ray's start is larger than `m`. Infinite, which makes every box possible, where that is beyond the proof.
#[inline(always)]
pub(super) fn slack(m: f32) -> f32 {
    if m < power(40) {
        44.0 * power(-24) * m
    } else {
        f32::INFINITY
    }
}

/// Four boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Cuboids {
    /// m, by axis of the box's space, then by axis of the level's.
    pub(super) rows: [[[f32; BLOCK]; 3]; 3],
    /// c.
    pub(super) offset: [[f32; BLOCK]; 3],
    /// S. Infinite where nothing is known of the box.
    pub(super) size: [[f32; BLOCK]; 3],
    /// Numbers of the boxes; [`NONE`] in empty lanes.
    pub ids: [u32; BLOCK],
}

impl Cuboids {
    /// A block of no boxes.
    pub const EMPTY: Self = Self {
        rows: [[[0.0; BLOCK]; 3]; 3],
        offset: [[0.0; BLOCK]; 3],
        size: [[f32::NEG_INFINITY; BLOCK]; 3],
        ids: [NONE; BLOCK],
    };

    /// Puts a box into a lane: the points of the level that `object_from_level` takes into the box around 0 of these
    /// half edges.
    pub fn set(&mut self, lane: usize, id: u32, object_from_level: &DAffine3, half: DVec3) {
        self.ids[lane] = id;
        let m = object_from_level.matrix3.transpose();
        let rows = [m.x_axis / half.x, m.y_axis / half.y, m.z_axis / half.z];
        let offset = object_from_level.translation / half;
        let size = rows.map(|row| row.x.abs() + row.y.abs() + row.z.abs());
        let inverse = object_from_level.matrix3.inverse();
        let columns = [
            inverse.x_axis * half.x,
            inverse.y_axis * half.y,
            inverse.z_axis * half.z,
        ];
        let spread = columns[0].abs() * size[0] + columns[1].abs() * size[1] + columns[2].abs() * size[2];
        let known = size.iter().all(|size| (SIZES[0]..=SIZES[1]).contains(size))
            && spread.max_element() <= SPREAD
            && spread.is_finite()
            && offset.is_finite();
        for (i, row) in rows.into_iter().enumerate() {
            let (row, offset, size) = if known {
                (row, offset[i], round_up(size[i]))
            } else {
                (DVec3::ZERO, 0.0, f32::INFINITY)
            };
            for (entries, x) in self.rows[i].iter_mut().zip(row.to_array()) {
                entries[lane] = x as f32;
            }
            self.offset[i][lane] = offset as f32;
            self.size[i][lane] = size;
        }
    }

    /// Which boxes a ray may hit, and which it enters for certain. The first value of t is a lower bound of every
    /// crossing, in all lanes that are possible; the second an upper bound of the entry in those that are certain.
    #[inline]
    #[must_use]
    pub fn candidates(&self, ray: &RayCuboid, range: Range) -> Candidates {
        let origin = [0, 1, 2].map(|k| F4::splat(ray.origin[k]));
        let dir = [0, 1, 2].map(|k| F4::splat(ray.dir[k]));
        let (one, slack) = (F4::splat(1.0), F4::splat(ray.slack));
        let smallest = F4::splat(f32::MIN_POSITIVE);
        let mut near = F4::splat(f32::NEG_INFINITY);
        let mut far = F4::splat(range.bound);
        let mut near_inside = near;
        let mut far_inside = F4::splat(f32::INFINITY);
        for i in 0..3 {
            let row = self.rows[i].each_ref().map(|x| F4::from_array(*x));
            let o = dot(row, origin).add(F4::from_array(self.offset[i]));
            let d = dot(row, dir);
            let sign = d.sign();
            let o = o.flip(sign);
            let inverse = one.div(d.flip(sign).max(smallest));
            let margin = slack.mul(F4::from_array(self.size[i]));
            let (outer, inner) = (one.add(margin), one.sub(margin));
            let zero = F4::splat(0.0);
            let o = zero.sub(o);
            // A NaN is the first operand: it leaves the other as it was.
            near = o.sub(outer).mul(inverse).max(near);
            far = o.add(outer).mul(inverse).min(far);
            near_inside = o.sub(inner).mul(inverse).max(near_inside);
            far_inside = o.add(inner).mul(inverse).min(far_inside);
        }
        let outside = far
            .below(near)
            .or(far.below(F4::splat(range.possible)))
            // An empty lane's negative size has the top bit.
            .or(F4::from_array(self.size[0]));
        let possible = !outside.bits() & 15;
        if possible == 0 {
            return Candidates::NONE;
        }
        let certain = near_inside
            .below(far_inside)
            .and(F4::splat(range.certain[0]).below(near))
            .and(near_inside.below(F4::splat(range.certain[1])));
        Candidates {
            possible,
            certain: certain.bits() & possible,
            t: [near.to_array(), near_inside.to_array()],
        }
    }
}

#[inline(always)]
fn dot(a: [F4; 3], b: [F4; 3]) -> F4 {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::{cases, ray::Ray32},
        math::{Ray, max_abs, rotation},
        shape::{Crossings, Cuboid, Shape},
    };

    const EVERYWHERE: Range = Range {
        possible: 0.0,
        bound: f32::INFINITY,
        certain: [0.0, f32::MAX],
    };

    /// Boxes that stand anyhow, from thin to thick and from 1e-12 to 1e9, some of them all but flattened, and rays at
    /// their insides, faces, edges and corners and along these.
    #[test]
    fn what_f64_hits_is_never_dropped_and_what_is_certain_is_hit() {
        let mut next = crate::accel::random(11);
        let (mut hits, mut certain, mut dropped, mut inside) = (0, 0, 0, 0);
        for round in 0..cases(200_000) {
            let scale = [1.0, 1e-6, 1e6, 1e-12, 1e9][round % 5];
            let mut number = || 2.0 * next() - 1.0;
            let mut vector = || DVec3::new(number(), number(), number());
            let thin = [1.0, 1.0, 1e-3, 1e-7][round / 5 % 4];
            let size = (vector().abs() + 0.01) * DVec3::new(1.0, thin, 1.0) * [1.0, 1e-3][round / 3 % 2];
            let cuboid = Cuboid::new(size).unwrap();
            let turned = match round / 20 % 5 {
                0 => DAffine3::IDENTITY,
                1 => DAffine3::from_scale(vector() + 0.1),
                // Sheared, and in one of several rounds to all but a plane.
                2 => {
                    let (x, y) = (vector(), vector());
                    let flat = [1.0, 1e-4, 1e-9, 1e-15][round / 100 % 4];
                    DAffine3::from_cols(x, y, x + y + vector() * flat, DVec3::ZERO)
                }
                _ => DAffine3::from_mat3(rotation(vector().normalize(), 360.0 * vector().x)),
            };
            let mut placing = turned;
            placing.translation = vector() * 2.0;
            let placing = DAffine3::from_scale(DVec3::splat(scale)) * placing;
            let object_from_level = placing.inverse();
            // Two points of the box or of its surface: the ray goes through one, and maybe through both.
            let mut on_box = |kind: usize| {
                let p = vector();
                let sign = p.signum();
                0.5 * size
                    * match kind {
                        0 => p,
                        1 => DVec3::new(sign.x, p.y, p.z),
                        2 => DVec3::new(sign.x, sign.y, p.z),
                        3 => DVec3::new(1.0, 1.0, p.z),
                        4 => DVec3::new(p.x, 1.0, p.z),
                        5 => DVec3::new(p.x, 1.0 + 1e-7 * p.y, p.z),
                        _ => sign,
                    }
            };
            let kind = round / 7 % 7;
            let (aim, other) = (on_box(kind), on_box(if round % 2 == 0 { kind } else { 0 }));
            let (aim, other) = (placing.transform_point3(aim), placing.transform_point3(other));
            let origin = match round / 11 % 4 {
                0 => other,
                1 => aim + (aim - other) * (3.0 * scale / (aim - other).length()),
                _ => vector() * 3.0 * scale,
            };
            let aim = if round / 13 % 5 == 0 {
                aim + vector() * scale * max_abs(size)
            } else {
                aim
            };
            let dir = (aim - origin) * [1.0, 1e-3 / scale, 7.0][round % 3];
            let ray = Ray::new(origin, dir);
            let bounds = cuboid_bounds(size, &object_from_level);
            let extent = max_abs(bounds[0]).max(max_abs(bounds[1])) as f32 * (1.0 + f32::EPSILON);
            let mut block = Cuboids::EMPTY;
            block.set(2, 7, &object_from_level, cuboid.half());
            let prepared = RayCuboid::new(&Ray32::new(&ray), extent);
            let found = block.candidates(&prepared, EVERYWHERE);
            assert_eq!(found.possible & !4, 0, "an empty lane is always dropped");
            let mut crossings = Crossings::default();
            Shape::Cuboid(cuboid).crossings(&ray.transformed(&object_from_level), &mut crossings);
            let first = crossings.first_within(0.0, f64::INFINITY).map(|c| c.t);
            let case = || format!("round {round}: {ray:?} {size} {object_from_level:?} {first:?} {found:?}");
            if let Some(t) = first {
                hits += 1;
                assert_ne!(found.possible, 0, "{}", case());
                assert!(f64::from(found.t[0][2]) <= t, "{}", case());
                inside += usize::from(crossings.as_slice()[0].t < 0.0);
            }
            if found.certain != 0 {
                certain += 1;
                assert!(first.is_some_and(|t| t <= f64::from(found.t[1][2])), "{}", case());
            }
            dropped += usize::from(found.possible == 0);
        }
        assert!(
            hits > cases(90_000)
                && certain > cases(20_000)
                && dropped > cases(20_000)
                && inside > cases(10_000),
            "{hits} {certain} {dropped} {inside}"
        );
    }

    /// As the tree has them.
    fn cuboid_bounds(size: DVec3, object_from_level: &DAffine3) -> [DVec3; 2] {
        let bounds = crate::math::Bounds3::new(-0.5 * size, 0.5 * size);
        let bounds = bounds.transformed(&object_from_level.inverse());
        [bounds.min, bounds.max]
    }

    #[test]
    fn what_is_out_of_range_is_left_to_f64() {
        let mut block = Cuboids::EMPTY;
        block.set(0, 0, &DAffine3::from_scale(DVec3::splat(1e30)), DVec3::ONE);
        block.set(
            1,
            1,
            &DAffine3::from_scale(DVec3::new(1.0, f64::NAN, 1.0)),
            DVec3::ONE,
        );
        block.set(2, 2, &DAffine3::IDENTITY, DVec3::ONE);
        let possible = |origin: DVec3, dir: DVec3, range| {
            let ray = RayCuboid::new(&Ray32::new(&Ray::new(origin, dir)), 4.0);
            let found = block.candidates(&ray, range);
            (found.possible, found.certain)
        };
        let above = DVec3::new(0.5, 4.0, 0.5);
        assert_eq!(possible(above, DVec3::NEG_Y, EVERYWHERE), (7, 4));
        assert_eq!(possible(above, DVec3::Y, EVERYWHERE), (3, 0), "behind");
        assert_eq!(possible(above, DVec3::X, EVERYWHERE), (3, 0), "beside");
        let short = |bound| Range {
            bound,
            certain: [0.0, bound],
            ..EVERYWHERE
        };
        assert_eq!(
            possible(above, DVec3::NEG_Y, short(2.9)),
            (3, 0),
            "beyond the bound"
        );
        assert_eq!(possible(above, DVec3::NEG_Y, short(3.1)), (7, 4));
        assert_eq!(
            possible(above, DVec3::NEG_Y * 1e-20, EVERYWHERE),
            (7, 0),
            "a direction too short"
        );
        assert_eq!(
            possible(above * 1e20, DVec3::NEG_Y, EVERYWHERE),
            (7, 0),
            "too far away"
        );
    }
}
