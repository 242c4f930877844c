//! The watertight ray-triangle test.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, in f64: corners are moved
//! to the ray's origin and sheared so that the ray runs along one axis; three edge functions then decide. Two
//! triangles that share an edge evaluate the same products with opposite signs, so no ray slips between them.
//! There is no fused multiply-add in it, so the signs are those on every machine.
//!
//! Why no fallback is needed where an edge function is 0: each is a difference of two products, and rounding is
//! monotone, so its sign is never wrong, only 0 where the exact value is nearly 0. As 0 counts as inside, that can
//! only make both neighbours claim the ray, never neither.
//!
//! What holds at which scale: with coordinates relative to the ray's origin up to 1e150 nothing overflows. Products
//! below 1e-308 vanish, which again only makes more of them 0: an edge claims too much, and a triangle whose three
//! edge functions all vanish counts as degenerate and misses. With edges of 1e-150 and more that takes a triangle
//! thinner than the rounding of its own corners. The direction may have any length from 1e-300 to 1e300.

use crate::math::{DVec3, Ray, max_abs};

/// What the test needs of a ray, made once per ray.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    /// The axis along which the direction is longest; it takes the place of z, its successors those of x and y.
    kz: Axis,
    /// The origin with its axes in that order.
    origin: [f64; 3],
    /// Shears x and y so that the ray runs along z.
    shear: [f64; 2],
    /// t per unit of z.
    t_per_z: f64,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
}

/// Where the line meets a triangle `a`, `b`, `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter, of any sign.
    pub t: f64,
    /// Barycentric weight of `b`, in [0, 1] up to rounding.
    pub u: f64,
    /// Barycentric weight of `c`, in [0, 1] up to rounding; the weight of `a` is `1 - u - v`.
    pub v: f64,
}

impl TriangleRay {
    /// Prepares a ray. One without direction, or with numbers that are not finite, meets nothing.
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.dir;
        let longest = max_abs(d);
        let kz = if d.x.abs() == longest {
            Axis::X
        } else if d.y.abs() == longest {
            Axis::Y
        } else {
            Axis::Z
        };
        let [dx, dy, dz] = kz.last(d);
        // Under an infinite direction every t would be 0; NaN makes it miss, as it does without a direction.
        let dz = if d.is_finite() { dz } else { f64::NAN };
        Self {
            kz,
            origin: kz.last(ray.origin),
            shear: [dx / dz, dy / dz],
            t_per_z: 1.0 / dz,
        }
    }

    /// A point as the ray sees it: x and y across the ray, which runs along z through x = y = 0. It depends on
    /// the ray and the point only, so surfaces that share a point agree about it.
    #[inline]
    #[must_use]
    pub(super) fn sheared(&self, p: DVec3) -> [f64; 3] {
        self.shear(self.kz.last(p))
    }

    #[inline]
    fn shear(&self, [px, py, pz]: [f64; 3]) -> [f64; 3] {
        let [ox, oy, oz] = self.origin;
        let z = pz - oz;
        [(px - ox) - self.shear[0] * z, (py - oy) - self.shear[1] * z, z]
    }

    /// t of the z of [`TriangleRay::sheared`].
    #[inline]
    #[must_use]
    pub(super) fn t_at(&self, z: f64) -> f64 {
        z * self.t_per_z
    }

    /// Where the line meets the triangle, seen from either side; t is not limited. A degenerate triangle and one
    /// seen exactly from its edge are not met.
    #[inline]
    #[must_use]
    pub fn intersect(&self, a: DVec3, b: DVec3, c: DVec3) -> Option<TriangleHit> {
        // One choice for all three corners, which the rays of one leaf share.
        let [a, b, c] = match self.kz {
            Axis::X => [a, b, c].map(|p| Axis::X.last(p)),
            Axis::Y => [a, b, c].map(|p| Axis::Y.last(p)),
            Axis::Z => [a, b, c].map(|p| Axis::Z.last(p)),
        };
        let [ax, ay, az] = self.shear(a);
        let [bx, by, bz] = self.shear(b);
        let [cx, cy, cz] = self.shear(c);
        // Twice the areas opposite a, b and c, in one order of factors for each edge.
        let wa = cx * by - cy * bx;
        let wb = ax * cy - ay * cx;
        let wc = bx * ay - by * ax;
        // Written so that NaN is outside, and without short circuits: the outcome cannot be predicted.
        let front = (wa >= 0.0) & (wb >= 0.0) & (wc >= 0.0);
        let back = (wa <= 0.0) & (wb <= 0.0) & (wc <= 0.0);
        let det = wa + wb + wc;
        if !(front | back) | (det == 0.0) {
            return None;
        }
        // Weights first, t from them: their product with z would leave the range of f64 long before they do.
        let per_det = 1.0 / det;
        let (wa, u, v) = (wa * per_det, wb * per_det, wc * per_det);
        let t = (wa * az + u * bz + v * cz) * self.t_per_z;
        t.is_finite().then_some(TriangleHit { t, u, v })
    }
}

impl Axis {
    /// The components in cyclic order with this axis last.
    #[inline]
    fn last(self, v: DVec3) -> [f64; 3] {
        match self {
            Self::X => [v.y, v.z, v.x],
            Self::Y => [v.z, v.x, v.y],
            Self::Z => [v.x, v.y, v.z],
        }
    }
}
