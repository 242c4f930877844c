//! The watertight ray-triangle test.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, in f64: corners are moved
//! to the ray's origin and sheared so that the ray runs along one axis; three edge functions then decide. Two
//! triangles that share an edge evaluate the same products with opposite signs, so no ray slips between them.
//! There is no fused multiply-add in it, so the signs are those on every machine.
//!
//! Why no fallback is needed where an edge function is 0: each is a difference of two products, and rounding
//! is monotone, so its sign is never wrong, only 0 where the exact value is nearly 0. As 0 counts as inside,
//! that can only make both neighbours claim the ray, never neither. Where it is 0, the ray must also pass
//! within the ranges of the corners' x and y: a triangle seen from its edge would otherwise claim rays all along
//! the line of that edge, far outside any box around it.
//!
//! What holds at which scale: with coordinates relative to the ray's origin up to 1e150 nothing overflows.
//! Products below 1e-308 vanish, which again only makes more of them 0: an edge claims too much, and a
//! triangle whose three edge functions all vanish counts as degenerate and misses. With edges of 1e-150 and
//! more that takes a triangle thinner than the rounding of its own corners. The direction may have any
//! length from 1e-300 to 1e300.

#[cfg(test)]
mod tests;

use crate::math::{DVec3, Ray};

/// What the test needs of a ray, made once per ray.
///
/// ```
/// use rtscript::{DVec3, math::Ray, shape::triangle::{TriangleHit, TriangleRay}};
/// let ray = TriangleRay::new(&Ray { origin: DVec3::new(0.2, 0.2, 1.0), dir: DVec3::NEG_Z });
/// let hit: Option<TriangleHit> = ray.intersect([&DVec3::ZERO, &DVec3::X, &DVec3::Y]);
/// assert!(hit.is_some_and(|hit| (hit.t - 1.0).abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    /// The axes in cyclic order, last the one along which the direction is longest: it takes the place of z, its
    /// successors those of x and y.
    axes: [usize; 3],
    /// The origin with its axes in that order.
    origin: [f64; 3],
    /// Shears x and y so that the ray runs along z.
    shear: [f64; 2],
    /// t per unit of z.
    t_per_z: f64,
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
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.dir;
        let axes = Self::axes(d);
        let [dx, dy, dz] = ordered(axes, &d);
        // Under an infinite direction every t would be 0; NaN makes it miss, as it does without a direction.
        let dz = if d.is_finite() { dz } else { f64::NAN };
        Self {
            axes,
            origin: ordered(axes, &ray.origin),
            shear: [dx / dz, dy / dz],
            t_per_z: 1.0 / dz,
        }
    }

    /// The axes in the order in which this ray's test takes them.
    #[inline(always)]
    pub(crate) fn order(&self) -> [usize; 3] {
        self.axes
    }

    /// The axes in the order in which the test takes them: across, across, along the direction `d`, which is the
    /// first of those along which it is longest.
    #[inline(always)]
    pub(crate) fn axes(d: DVec3) -> [usize; 3] {
        let [x, y, z] = d.abs().to_array();
        if x >= y && x >= z {
            [1, 2, 0]
        } else if y >= z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        }
    }

    /// A point as the ray sees it: x and y across the ray, which runs along z through x = y = 0. It depends
    /// on the ray and the point only, so surfaces that share a point agree about it.
    #[inline]
    #[must_use]
    pub(super) fn sheared(&self, p: DVec3) -> [f64; 3] {
        self.shear(ordered(self.axes, &p))
    }

    #[inline(always)]
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

    /// Where the line meets the triangle, seen from either side; t is not limited. A degenerate triangle and
    /// one seen exactly from its edge are not met.
    #[inline(always)]
    #[must_use]
    pub fn intersect(&self, [a, b, c]: [&DVec3; 3]) -> Option<TriangleHit> {
        self.intersect_ordered([
            ordered(self.axes, a),
            ordered(self.axes, b),
            ordered(self.axes, c),
        ])
    }

    /// As [`TriangleRay::intersect`], with the corners' axes [in order](TriangleRay::order).
    #[inline(always)]
    pub(crate) fn intersect_ordered(&self, [a, b, c]: [[f64; 3]; 3]) -> Option<TriangleHit> {
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
        let on_edge = (wa == 0.0) | (wb == 0.0) | (wc == 0.0);
        if on_edge && !(spans(ax, bx, cx) & spans(ay, by, cy)) {
            return None;
        }
        // Weights first, t from them: their product with z would leave the range of f64 long before they do.
        let per_det = 1.0 / det;
        let (mut wa, mut u, mut v) = (wa * per_det, wb * per_det, wc * per_det);
        if is_sliver(det, [cx * by, ax * cy, bx * ay]) {
            [wa, u, v] = along_the_longest_edge([(ax, ay), (bx, by), (cx, cy)]);
        }
        let t = (wa * az + u * bz + v * cz) * self.t_per_z;
        t.is_finite().then_some(TriangleHit { t, u, v })
    }
}

impl TriangleRay {
    /// As [`TriangleRay::intersect`], where it matters how often a closed mesh is crossed: a line through an edge that
    /// two triangles share crosses one of them where it changes sides, both or neither where it does not. Where the line
    /// meets an edge or a corner to the bit, it is taken as moved across by an infinitely small step, the same for all
    /// triangles (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990).
    #[must_use]
    pub(crate) fn cross(&self, [a, b, c]: [&DVec3; 3]) -> Option<TriangleHit> {
        let [ax, ay, az] = self.sheared(*a);
        let [bx, by, bz] = self.sheared(*b);
        let [cx, cy, cz] = self.sheared(*c);
        let wa = cx * by - cy * bx;
        let wb = ax * cy - ay * cx;
        let wc = bx * ay - by * ax;
        let side = |w: f64, (px, py): (f64, f64), (qx, qy): (f64, f64)| {
            // With the line moved by (e, e^2), e -> 0, an edge function of 0 becomes e (py - qy) + e^2 (qx - px).
            let next = if py == qy { qx - px } else { py - qy };
            if w == 0.0 { next > 0.0 } else { w > 0.0 }
        };
        let (a, b, c) = ((ax, ay), (bx, by), (cx, cy));
        let [sa, sb, sc] = [side(wa, c, b), side(wb, a, c), side(wc, b, a)];
        let det = wa + wb + wc;
        if sa != sb || sb != sc || det == 0.0 {
            return None;
        }
        let per_det = 1.0 / det;
        let (mut wa, mut u, mut v) = (wa * per_det, wb * per_det, wc * per_det);
        if is_sliver(det, [c.0 * b.1, a.0 * c.1, b.0 * a.1]) {
            [wa, u, v] = along_the_longest_edge([a, b, c]);
        }
        let t = (wa * az + u * bz + v * cz) * self.t_per_z;
        t.is_finite().then_some(TriangleHit { t, u, v })
    }
}

/// Where the area that the ray sees of a triangle is this small a share of the products that it is the difference of,
/// the edge functions still have their signs, but how they compare is rounding.
const SLIVER: f64 = 1e-10;

/// Whether the ray sees a triangle as a line: its area is nothing beside the products, one of each edge function.
#[inline(always)]
pub(super) fn is_sliver(det: f64, products: [f64; 3]) -> bool {
    let [a, b, c] = products.map(f64::abs);
    det.abs() <= SLIVER * (a + b + c)
}

/// The weights of the corners of a triangle that the ray sees as a line: those of the point of its longest edge that is next
/// to the ray. Any other split would be a hit away from the ray, where a tree that looks at the triangle's box finds none.
#[cold]
#[inline(never)]
pub(super) fn along_the_longest_edge([a, b, c]: [(f64, f64); 3]) -> [f64; 3] {
    let along = |p: (f64, f64), q: (f64, f64)| {
        let (x, y) = (q.0 - p.0, q.1 - p.1);
        let length_squared = x * x + y * y;
        let share = (-(p.0 * x + p.1 * y) / length_squared).clamp(0.0, 1.0);
        (length_squared, share)
    };
    let [(ab, on_ab), (bc, on_bc), (ca, on_ca)] = [along(a, b), along(b, c), along(c, a)];
    if ab >= bc && ab >= ca {
        [1.0 - on_ab, on_ab, 0.0]
    } else if bc >= ca {
        [0.0, 1.0 - on_bc, on_bc]
    } else {
        [on_ca, 0.0, 1.0 - on_ca]
    }
}

/// Whether 0 lies in the range of three numbers.
#[inline(always)]
pub(super) fn spans(a: f64, b: f64, c: f64) -> bool {
    ((a <= 0.0) | (b <= 0.0) | (c <= 0.0)) & ((a >= 0.0) | (b >= 0.0) | (c >= 0.0))
}

/// The components in another order.
#[inline(always)]
#[allow(clippy::indexing_slicing, reason = "the order is one of 0, 1 and 2")]
pub(crate) fn ordered([kx, ky, kz]: [usize; 3], v: &DVec3) -> [f64; 3] {
    let v: &[f64; 3] = v.as_ref();
    [v[kx], v[ky], v[kz]]
}
