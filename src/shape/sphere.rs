//! The sphere.

use super::{CrossingSink, Solidity, Surface, positive, span::Span, u_around_y};
use crate::{
    math::{self, Bounds3, DAffine3, DVec2, DVec3, PI, Ray, max_abs},
    scene::SceneError,
};

/// A sphere.
///
/// Parameters: center and radius in object units. Solid. Normals outwards.
///
/// uv: u runs once around Y from -Z over -X to +Z at 0.5 and on over +X, v from the south pole (0) to the
/// north (1).
///
/// ```
/// use rtscript::{DVec3, shape::Sphere};
/// assert_eq!(Sphere::new(DVec3::ZERO, 1.5).map(|s| s.radius()), Ok(1.5));
/// assert!(Sphere::new(DVec3::ZERO, 0.0).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Solidity for Sphere {
    const SOLID: bool = true;
}

impl Sphere {
    /// A sphere of `radius` object units around `center`.
    ///
    /// # Errors
    /// Where the radius is not greater than 0, or a number is not finite or beyond 1e15.
    #[inline]
    pub fn new(center: DVec3, radius: f64) -> Result<Self, SceneError> {
        positive("the sphere's radius", radius)?;
        if !(center.is_finite() && max_abs(center) <= 1e15) {
            return Err(SceneError::new(
                "the sphere's center must be finite numbers within 1e15",
            ));
        }
        Ok(Self { center, radius })
    }

    /// The center.
    #[must_use]
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        let r = DVec3::splat(self.radius);
        Some(Bounds3::new(self.center - r, self.center + r))
    }

    /// Roots of |o + t d - c|^2 = r^2 without cancellation: the discriminant from the distance between center
    /// and line (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019,
    /// chapter 7), the roots in the form that never subtracts near-equal numbers (Press et al., Numerical
    /// Recipes, 5.6).
    #[inline]
    pub(crate) fn roots(center: DVec3, radius: f64, ray: &Ray) -> Option<(f64, f64)> {
        let f = ray.origin - center;
        let a = ray.dir.dot(ray.dir);
        let b = -f.dot(ray.dir);
        let nearest = f + ray.dir * (b / a);
        let discriminant = radius * radius - nearest.dot(nearest);
        if !(discriminant >= 0.0) {
            return None;
        }
        let q = b + (a * discriminant).sqrt().copysign(b);
        let c = f.dot(f) - radius * radius;
        // q is 0 where the line touches the sphere at the ray's very origin: both roots are there.
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        Some(if t0 <= t1 { (t0, t1) } else { (t1, t0) })
    }

    /// True only where no root is more than `least`, which is more than 0: the ray leaves the sphere, from outside or from
    /// its surface. Then q in [`Sphere::roots`] is at most -b, so one root is at most |c| / b, the other negative. Found
    /// without a root or a division.
    #[inline(always)]
    pub(crate) fn is_left(center: DVec3, radius: f64, ray: &Ray, least: f64) -> bool {
        let f = ray.origin - center;
        let b = f.dot(ray.dir);
        let c = f.dot(f) - radius * radius;
        // Half of it, for the rounding of all these.
        c.abs() < 0.5 * least * b
    }

    /// Along each axis the center plus or minus the radius times the length of the matrix's row (Quilez, "Bounding box
    /// of an ellipse", 2015, from the support function).
    pub(super) fn bounds_under(&self, to_from_object: &DAffine3) -> Bounds3 {
        let rows = to_from_object.matrix3.transpose();
        let center = to_from_object.transform_point3(self.center);
        let half = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length()) * self.radius;
        Bounds3::new(center - half, center + half)
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        if let Some(span) =
            Self::roots(self.center, self.radius, ray).and_then(|(t0, t1)| Span::new(t0, t1, 0))
        {
            span.push(out);
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        p - self.center
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let normal = self.normal(p);
        let n = normal / self.radius;
        let v = math::asin(n.y.clamp(-1.0, 1.0)) / PI + 0.5;
        Surface {
            normal,
            uv: DVec2::new(u_around_y(n.x, n.z), v),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    fn crossings(origin: [f64; 3], dir: [f64; 3]) -> Vec<f64> {
        let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let mut out = Crossings::default();
        sphere.crossings(&Ray::new(origin.into(), dir.into()), &mut out);
        out.as_slice().iter().map(|c| c.t).collect()
    }

    #[test]
    fn what_is_left_is_not_met_again() {
        let mut left = 0;
        let cases = (0..4000).map(|i| {
            let x = f64::from(i);
            let turned = |k: f64| math::sin(k * x + k);
            let radius = math::pow(10.0, 6.0 * turned(0.7));
            let center =
                DVec3::new(turned(1.3), turned(2.1), turned(3.7)) * math::pow(10.0, 3.0 * turned(5.1));
            let out = DVec3::new(turned(4.3), turned(6.1), turned(7.7)).normalize();
            let dir = DVec3::new(turned(8.3), turned(9.1), turned(2.7)).normalize();
            (
                center,
                radius,
                Ray::new(center + out * radius, dir),
                math::max_abs(center) + radius,
            )
        });
        for (center, radius, ray, scale) in cases {
            let least = 1e-7 * scale;
            if Sphere::is_left(center, radius, &ray, least) {
                left += 1;
                if let Some((t0, t1)) = Sphere::roots(center, radius, &ray) {
                    assert!(t0 <= least && t1 <= least, "{center} {radius} {ray:?}: {t0} {t1}");
                }
            } else if let Some((_, t1)) = Sphere::roots(center, radius, &ray) {
                assert!(t1 > 0.0 || (ray.origin - center).dot(ray.dir) < 0.1 * radius);
            }
        }
        assert!((1900..2100).contains(&left), "{left}");
    }

    #[test]
    fn every_case_of_roots() {
        assert_eq!(
            crossings([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
            [2.0, 4.0],
            "outside"
        );
        assert_eq!(
            crossings([1.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
            [3.0, 3.0],
            "tangent"
        );
        assert_eq!(
            crossings([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
            [-1.0, 1.0],
            "inside"
        );
        assert_eq!(
            crossings([0.0, 0.0, -3.0], [0.0, 0.0, -1.0]),
            [-4.0, -2.0],
            "behind"
        );
        assert!(crossings([2.0, 0.0, 3.0], [0.0, 0.0, -1.0]).is_empty(), "beside");
        assert_eq!(
            crossings([0.0, 0.0, 3.0], [0.0, 0.0, -2.0]),
            [1.0, 2.0],
            "t counts multiples of the direction"
        );
    }

    #[test]
    fn a_far_sphere_is_hit_precisely() {
        let sphere = Sphere::new(DVec3::new(0.0, 0.0, -1e6), 1e-3).unwrap();
        let mut out = Crossings::default();
        sphere.crossings(&Ray::new(DVec3::ZERO, DVec3::NEG_Z), &mut out);
        let t = out.as_slice()[0].t;
        assert!((t - (1e6 - 1e-3)).abs() < 1e-9, "{t}");
    }

    #[test]
    fn uv_of_the_poles_and_the_seam() {
        let sphere = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        assert_eq!(sphere.surface(DVec3::new(0.0, 2.0, 0.0), 0).uv.y, 1.0);
        assert_eq!(sphere.surface(DVec3::new(0.0, -2.0, 0.0), 0).uv.y, 0.0);
        assert_eq!(
            sphere.surface(DVec3::new(0.0, 0.0, 2.0), 0).uv,
            DVec2::new(0.5, 0.5)
        );
    }
}
