//! The torus.

use super::{CrossingSink, Solidity, Surface, positive, roots::root_between, u_around_y};
use crate::{
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// A torus centered at the origin, around Y.
///
/// Parameters in object units: the major radius, of the circle in y = 0 that the tube follows, and the minor
/// radius, of the tube. The minor one must not exceed the major one, or the surface would cut through itself.
/// Solid. Normals outwards from the tube.
///
/// uv: u once around Y as on the sphere, from -Z over -X to +Z at 0.5 and on over +X; v once around the tube,
/// 0 at the innermost circle, 0.25 at the bottom, 0.5 at the outermost circle, 0.75 at the top.
///
/// ```
/// use rtscript::shape::{Shape, Torus};
/// let ring = Torus::new(2.0, 0.5)?;
/// assert_eq!((ring.major(), ring.minor()), (2.0, 0.5));
/// assert_eq!(Shape::Torus(ring).bounds().map(|b| b.size().to_array()), Some([5.0, 1.0, 5.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    major: f64,
    minor: f64,
}

impl Solidity for Torus {
    const SOLID: bool = true;
}

/// How much wider than the torus the searched interval is, so that it ends outside in spite of rounding.
const MARGIN: f64 = 1e-6;

impl Torus {
    /// A torus with a tube of radius `minor` along a circle of radius `major`, in object units.
    ///
    /// # Errors
    /// Where a radius is not greater than 0 or beyond 1e15, or `minor` is greater than `major`.
    pub fn new(major: f64, minor: f64) -> Result<Self, SceneError> {
        positive("the torus's major radius", major)?;
        positive("the torus's minor radius", minor)?;
        if minor > major {
            return Err(SceneError::new(format!(
                "the torus's minor radius must be at most its major radius of {major}, not {minor}"
            ))
            .hint("torus(major, minor): first the radius of the ring, then that of its tube"));
        }
        Ok(Self { major, minor })
    }

    /// The radius of the ring.
    #[must_use]
    pub const fn major(&self) -> f64 {
        self.major
    }

    /// The radius of the tube.
    #[must_use]
    pub const fn minor(&self) -> f64 {
        self.minor
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        let outer = self.major + self.minor;
        let corner = DVec3::new(outer, self.minor, outer);
        Some(Bounds3::new(-corner, corner))
    }

    /// Up to four roots of a quartic F, isolated instead of solved: between neighbouring zeros of F' (a
    /// cubic, isolated by the zeros of F'' in turn) F is monotone, so the signs of F there tell where its
    /// roots are and that their number is even. Everything is measured in outer radii and from the line's
    /// point nearest to the center, which takes the cubic terms out and keeps all coefficients near 1.
    ///
    /// F = (|p|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2) has the sign of (rho - R)^2 + y^2 - r^2 with rho the
    /// distance to the axis, F's factor (rho + R)^2 + y^2 - r^2 being positive; the signs and the roots are
    /// taken from that form, which stays exact where the tube is thin.
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let outer = self.major + self.minor;
        let (major, minor) = (self.major / outer, self.minor / outer);
        let length = ray.dir.length();
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let d = ray.dir / length;
        let far = ray.origin / outer;
        let shift = -far.dot(d);
        let o = far + d * shift;

        let distance2 = o.dot(o);
        let reach2 = (1.0 + MARGIN) - distance2;
        if !(reach2 > 0.0) {
            return;
        }
        let reach = reach2.sqrt();
        let Some((lo, hi)) = within_height(o.y, d.y, minor * (1.0 + MARGIN), reach) else {
            return;
        };

        let around = 2.0 * major * major;
        let p = distance2 + major * major - minor * minor - around * (d.x * d.x + d.z * d.z);
        let q = around * o.y * d.y;
        let turns = cubic_roots(p, q, lo, hi);

        let value = |x: f64| {
            let at = o + d * x;
            let rho = (at.x * at.x + at.z * at.z).sqrt();
            let from_ring = rho - major;
            let slope = 2.0 * (from_ring * (at.x * d.x + at.z * d.z) / rho + at.y * d.y);
            (from_ring * from_ring + at.y * at.y - minor * minor, slope)
        };
        let (mut before, mut was_inside) = (lo, false);
        for x in turns.into_iter().flatten().chain([hi]) {
            // A turn on the surface counts as inside: the line touches there, and crosses twice.
            let is_inside = x < hi && value(x).0 <= 0.0;
            if is_inside != was_inside {
                let root = root_between(value, before, x, !was_inside);
                out.push((shift + root) * (outer / length), 0);
                if out.is_served() {
                    return;
                }
            }
            (before, was_inside) = (x, is_inside);
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let (rho, from_ring) = self.ring_distances(p);
        let radial = if rho > 0.0 {
            DVec3::new(p.x / rho, 0.0, p.z / rho)
        } else {
            DVec3::ZERO
        };
        let normal = radial * from_ring + DVec3::Y * p.y;
        // Zero only where the tube closes the hole and touches itself in the center.
        if normal == DVec3::ZERO { DVec3::Y } else { normal }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let (_, from_ring) = self.ring_distances(p);
        Surface {
            normal: self.normal(p),
            uv: DVec2::new(
                u_around_y(p.x, p.z),
                math::atan2(p.y, from_ring) / (2.0 * PI) + 0.5,
            ),
        }
    }

    /// Distance of a point to the axis, and how far that is outside the ring.
    #[inline]
    fn ring_distances(&self, p: DVec3) -> (f64, f64) {
        let rho = (p.x * p.x + p.z * p.z).sqrt();
        (rho, rho - self.major)
    }
}

/// The part of `[-reach, reach]` where `|y + x dy| <= height`; `None` where there is none.
fn within_height(y: f64, dy: f64, height: f64, reach: f64) -> Option<(f64, f64)> {
    if dy == 0.0 {
        return (y.abs() <= height).then_some((-reach, reach));
    }
    let (a, b) = ((-height - y) / dy, (height - y) / dy);
    let (lo, hi) = (a.min(b).max(-reach), a.max(b).min(reach));
    (lo < hi).then_some((lo, hi))
}

/// The zeros of x^3 + p x + q in (`lo`, `hi`) where it changes its sign, in order.
fn cubic_roots(p: f64, q: f64, lo: f64, hi: f64) -> [Option<f64>; 3] {
    let value = |x: f64| (x * (x * x + p) + q, 3.0 * x * x + p);
    let bend = (-p / 3.0).max(0.0).sqrt();
    let mut roots = [None; 3];
    let mut before = lo;
    for (root, x) in roots
        .iter_mut()
        .zip([(-bend).clamp(lo, hi), bend.clamp(lo, hi), hi])
    {
        let (y0, y1) = (value(before).0, value(x).0);
        if (y0 < 0.0) != (y1 < 0.0) {
            *root = Some(root_between(value, before, x, y0 >= 0.0));
        }
        before = x;
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Crossings, suite::Rng},
        *,
    };

    fn crossings(torus: &Torus, origin: [f64; 3], dir: [f64; 3]) -> Vec<f64> {
        let mut out = Crossings::default();
        torus.crossings(&Ray::new(origin.into(), dir.into()), &mut out);
        out.as_slice().iter().map(|c| c.t).collect()
    }

    #[test]
    fn known_crossings() {
        // Its outer radius is a power of two: nothing rounds, so even a tangent is met for certain. Where it
        // touches is only known to the root of the rounding.
        let torus = Torus::new(3.0, 1.0).unwrap();
        let close = |found: Vec<f64>, expected: &[f64], what: &str| {
            assert_eq!(found.len(), expected.len(), "{what}: {found:?}");
            for (a, b) in found.iter().zip(expected) {
                assert!(
                    (a - b).abs() < if what.starts_with("touching") { 1e-7 } else { 1e-14 },
                    "{what}: {found:?}"
                );
            }
        };
        let x = [1.0, 0.0, 0.0];
        let through = |o: [f64; 3], d: [f64; 3]| crossings(&torus, o, d);
        close(through([-5.0, 0.0, 0.0], x), &[1.0, 3.0, 7.0, 9.0], "both sides");
        close(through([5.0, 0.0, 0.0], x), &[-9.0, -7.0, -3.0, -1.0], "behind");
        close(
            through([0.0, 0.0, 0.0], x),
            &[-4.0, -2.0, 2.0, 4.0],
            "from the hole",
        );
        close(
            through([3.0, 4.0, 0.0], [0.0, -2.0, 0.0]),
            &[1.5, 2.5],
            "from above",
        );
        close(
            through([0.0, 4.0, 0.0], [0.0, -1.0, 0.0]),
            &[],
            "through the hole",
        );
        close(through([-5.0, 1.1, 0.0], x), &[], "above");
        close(
            through([-5.0, 1.0, 0.0], x),
            &[2.0, 2.0, 8.0, 8.0],
            "touching on top",
        );
        close(
            through([4.0, 3.0, 0.0], [0.0, -1.0, 0.0]),
            &[3.0, 3.0],
            "touching outside",
        );
        close(
            through([2.0, 3.0, 0.0], [0.0, -1.0, 0.0]),
            &[3.0, 3.0],
            "touching inside",
        );
    }

    /// Number of crossings, without algebra. The distance f from the ring changes along the line by no more
    /// than the way gone, and its slope by no more than 1/f + 1/rho per way gone, rho being the distance
    /// from the axis. By that an interval is known to hold no crossing, or to be crossed in one direction
    /// only so that its ends tell; any other is halved, down to a millionth of the tube.
    fn reference(major: f64, minor: f64, ray: &Ray) -> usize {
        let d = ray.dir / ray.dir.length();
        let nearest = -ray.origin.dot(d);
        let at = |s: f64| {
            let p = ray.origin + d * (nearest + s);
            let rho = (p.x * p.x + p.z * p.z).sqrt();
            let f = ((rho - major) * (rho - major) + p.y * p.y).sqrt();
            let slope = ((rho - major) * (p.x * d.x + p.z * d.z) / rho + p.y * d.y) / f;
            (f, slope, rho)
        };
        let reach = 2.0 * (major + minor);
        let (mut count, mut inside) = (0, false);
        let mut todo = vec![(-reach, reach)];
        while let Some((a, b)) = todo.pop() {
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let (f, slope, rho) = at(middle);
            let depth = f - minor;
            let bend = if half < 0.5 * f.min(rho) {
                2.0 / f + 2.0 / rho
            } else {
                f64::INFINITY
            };
            let beside = depth.abs() > half.min(half * (slope.abs() + 0.5 * bend * half));
            let one_way = slope.abs() > bend * half;
            if !beside && !one_way && half > 1e-6 * minor {
                todo.extend([(middle, b), (a, middle)]);
            } else if (at(b).0 < minor) != inside {
                inside = !inside;
                count += 1;
            }
        }
        count
    }

    fn agrees_with_the_reference(torus: &Torus, ray: &Ray) -> usize {
        let mut out = Crossings::default();
        torus.crossings(ray, &mut out);
        let found = out.as_slice().len();
        // Closer to touching than the rounding of the ray's own numbers, either answer is right.
        let blur = 2e-15 * (torus.major + math::max_abs(ray.origin)) + 1e-12 * torus.minor;
        let expected = [-blur, 0.0, blur].map(|b| reference(torus.major, torus.minor + b, ray));
        assert!(
            expected.contains(&found),
            "{found} crossings, not {expected:?}: {ray:?} on {torus:?}"
        );
        found
    }

    fn random_torus(rng: &mut Rng) -> Torus {
        let major = rng.magnitude(-6.0, 6.0);
        let ratio = if rng.chance(0.1) {
            1.0
        } else {
            rng.magnitude(-3.0, 0.0)
        };
        Torus::new(major, major * ratio).unwrap()
    }

    #[test]
    fn random_rays_cross_as_often_as_the_reference_says() {
        let mut rng = Rng::new(21);
        let mut seen = [0; 5];
        for _ in 0..20_000 {
            let torus = random_torus(&mut rng);
            let outer = torus.major + torus.minor;
            // Through two points near the tube, so that most rays meet it.
            let mut near = || {
                let u = rng.direction() * DVec3::new(1.0, 0.0, 1.0);
                u.normalize() * torus.major + rng.in_cube() * torus.minor * 1.2
            };
            let (a, b) = (near(), near());
            let d = (b - a).normalize();
            let origin = a - d * outer * rng.within(-3.0, 10.0);
            let ray = Ray::new(origin, d * rng.magnitude(-6.0, 6.0));
            seen[agrees_with_the_reference(&torus, &ray)] += 1;
        }
        assert_eq!([seen[1], seen[3]], [0, 0]);
        assert!(seen[0] > 500 && seen[2] > 2_000 && seen[4] > 2_000, "{seen:?}");
    }

    /// Lines beside or through a tangent of the surface by a tenth down to a billionth of the tube.
    #[test]
    fn grazing_rays_cross_as_often_as_the_reference_says() {
        let mut rng = Rng::new(22);
        let mut seen = [0; 5];
        for _ in 0..20_000 {
            let torus = random_torus(&mut rng);
            let outer = torus.major + torus.minor;
            let (u, v) = (rng.within(0.0, 2.0 * PI), rng.within(0.0, 2.0 * PI));
            let out = DVec3::new(math::cos(u), 0.0, math::sin(u));
            let normal = out * math::cos(v) + DVec3::Y * math::sin(v);
            let along_tube = out.cross(DVec3::Y);
            let around_tube = normal.cross(along_tube);
            // Often along a principal direction, where three or all four crossings may come together.
            let turn = [rng.within(0.0, PI), 0.0, 0.5 * PI][rng.below(3)];
            let d = along_tube * math::cos(turn) + around_tube * math::sin(turn);
            let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
            let beside = torus.minor * (1.0 + side * rng.magnitude(-9.0, -1.0));
            let p = out * torus.major + normal * beside;
            let ray = Ray::new(
                p - d * outer * rng.within(-3.0, 10.0),
                d * rng.magnitude(-6.0, 6.0),
            );
            seen[agrees_with_the_reference(&torus, &ray)] += 1;
        }
        assert_eq!([seen[1], seen[3]], [0, 0]);
        assert!(seen[0] > 2_000 && seen[2] > 2_000 && seen[4] > 500, "{seen:?}");
    }
}
