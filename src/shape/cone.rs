//! The closed cone.

use super::{
    CrossingSink, Solidity, Surface, cap_uv,
    span::Span,
    u_around_y,
    upright::{self, upright},
};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray},
    scene::SceneError,
};

/// A closed cone centered at the origin, axis Y: apex at y = +height/2, base at y = -height/2.
///
/// Parameters: radius of the base and full height in object units. Solid. Normals outwards; at the very
/// apex, +Y. Parts: 0 the side, 1 the base.
///
/// uv: on the side, u once around Y as on the sphere, from -Z over -X to +Z at 0.5 and on over +X, and v from
/// the base (0) to the apex (1); the base shows the disk cut out of the picture, unmirrored from below, +X to
/// the right.
///
/// ```
/// use rtscript::shape::{Cone, Shape};
/// let hat = Shape::Cone(Cone::new(0.5, 2.0)?);
/// assert_eq!(hat.bounds().map(|b| b.size().to_array()), Some([1.0, 2.0, 1.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    radius: f64,
    height: f64,
}

impl Solidity for Cone {
    const SOLID: bool = true;
}

const SIDE: u32 = 0;
const BASE: u32 = 1;

upright!(Cone, "The radius of the base.", "The full height.");

impl Cone {
    /// A cone with a base of `radius` and full `height` in object units.
    ///
    /// # Errors
    /// Where one of them is not greater than 0 or beyond 1e15.
    pub fn new(radius: f64, height: f64) -> Result<Self, SceneError> {
        upright::check("cone", radius, height)?;
        Ok(Self { radius, height })
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        // The slab's upper end is the apex, a point of the side.
        let span = Span::slab(ray.origin.y, ray.dir.y, self.height * 0.5, BASE, SIDE)
            .and_then(|slab| slab.clip(self.inside_side(ray)?))
            .filter(|span| span.ends().iter().all(|end| self.is_around(ray, end.t)));
        if let Some(span) = span {
            span.push(out);
        }
    }

    /// Whether the ray is no farther from the axis than the base reaches, but for rounding. Of a cone that is flatter
    /// than numbers can tell the side's equation says anything.
    #[inline]
    fn is_around(&self, ray: &Ray, t: f64) -> bool {
        let reach = |o: f64, d: f64| ((o + d * t).abs(), 1e-13 * (o.abs() + (d * t).abs()));
        let ((x, slack_x), (z, slack_z)) = (reach(ray.origin.x, ray.dir.x), reach(ray.origin.z, ray.dir.z));
        let most = self.radius * (1.0 + 1e-9) + slack_x + slack_z;
        x * x + z * z <= most * most
    }

    /// Where the line is inside the endless cone below the apex, or inside the mirror cone above it: within
    /// the slab of the solid only the former can be.
    ///
    /// In coordinates that make it the unit cone, `w` downwards from the apex, the inside is x^2 + z^2 <= w^2
    /// (Eberly, "Intersection of a Line and a Cone", Geometric Tools, 2000, tells the cases).
    #[inline]
    fn inside_side(&self, ray: &Ray) -> Option<Span> {
        let (r, h) = (self.radius, self.height);
        let d = DVec3::new(ray.dir.x / r, -ray.dir.y / h, ray.dir.z / r);
        let far = DVec3::new(ray.origin.x / r, 0.5 - ray.origin.y / h, ray.origin.z / r);
        // From the line's point nearest to the apex, so that no origin is too far for the roots.
        let shift = -far.dot(d) / d.dot(d);
        let o = far + d * shift;

        let a = d.x * d.x + d.z * d.z - d.y * d.y;
        let b = o.y * d.y - o.x * d.x - o.z * d.z;
        let c = o.x * o.x + o.z * o.z - o.y * o.y;
        let discriminant = b * b - a * c;
        if a >= 0.0 && !(discriminant >= 0.0) {
            return None;
        }
        let q = b + discriminant.max(0.0).sqrt().copysign(b);
        // q is 0 where both roots are at the shifted origin: the line passes through the apex or touches.
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        let (t0, t1) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
        if a > 0.0 {
            return Span::new(t0 + shift, t1 + shift, SIDE);
        }
        if a == 0.0 {
            // Parallel to a line of the side: a single root, the inside behind or before it.
            return match b.partial_cmp(&0.0)? {
                std::cmp::Ordering::Greater => Span::new(c / (2.0 * b) + shift, f64::INFINITY, SIDE),
                std::cmp::Ordering::Less => Span::new(f64::NEG_INFINITY, c / (2.0 * b) + shift, SIDE),
                std::cmp::Ordering::Equal => Span::line_if(c <= 0.0),
            };
        }
        // Steeper than the side: the line is inside one cone up to t0 and inside the other from t1 on, and
        // the lower cone is where the line goes down.
        if d.y > 0.0 {
            Span::new(t1 + shift, f64::INFINITY, SIDE)
        } else {
            Span::new(f64::NEG_INFINITY, t0 + shift, SIDE)
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3, part: u32) -> DVec3 {
        if part != SIDE {
            return DVec3::NEG_Y;
        }
        // From the distance to the axis, not from the height: at the apex rounding may lift p above it.
        let rho = (p.x * p.x + p.z * p.z).sqrt();
        if rho > 0.0 {
            DVec3::new(p.x / rho * self.height, self.radius, p.z / rho * self.height)
        } else {
            DVec3::Y
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        Surface {
            normal: self.normal(p, part),
            uv: if part == SIDE {
                DVec2::new(u_around_y(p.x, p.z), (p.y / self.height + 0.5).clamp(0.0, 1.0))
            } else {
                cap_uv(p.x, p.z, self.radius)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    fn crossings(origin: [f64; 3], dir: [f64; 3]) -> Vec<(f64, u32)> {
        let mut out = Crossings::default();
        Cone::new(1.0, 2.0)
            .unwrap()
            .crossings(&Ray::new(origin.into(), dir.into()), &mut out);
        out.as_slice().iter().map(|c| (c.t, c.part)).collect()
    }

    #[test]
    fn side_base_and_both() {
        assert_eq!(
            crossings([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
            [(2.5, SIDE), (3.5, SIDE)],
            "across"
        );
        assert_eq!(
            crossings([0.5, 3.0, 0.0], [0.0, -1.0, 0.0]),
            [(3.0, SIDE), (4.0, BASE)],
            "downwards"
        );
        assert_eq!(
            crossings([0.5, -3.0, 0.0], [0.0, 1.0, 0.0]),
            [(2.0, BASE), (3.0, SIDE)],
            "upwards"
        );
    }

    #[test]
    fn there_is_no_mirror_cone() {
        assert!(
            crossings([0.0, 1.5, 3.0], [0.0, 0.0, -1.0]).is_empty(),
            "above the apex"
        );
        assert!(crossings([0.5, 3.0, 0.0], [1.0, -0.1, 0.0]).is_empty());
        assert_eq!(crossings([0.25, 9.0, 0.0], [0.0, -1.0, 0.0]).len(), 2);
        assert!(crossings([0.0, -1.5, 3.0], [0.0, 0.0, -1.0]).is_empty(), "below");
    }

    #[test]
    fn lines_through_the_apex_cross_twice_or_never() {
        assert_eq!(
            crossings([0.0, 3.0, 0.0], [0.0, -1.0, 0.0]),
            [(2.0, SIDE), (4.0, BASE)],
            "down the axis"
        );
        let along = crossings([0.0, 1.0, 0.0], [1.0, -2.0, 0.0]);
        assert_eq!(along.len(), 2, "down the side");
        assert!(
            (along[0].0).abs() < 1e-15 && (along[1].0 - 1.0).abs() < 1e-15,
            "{along:?}"
        );
        let touching = crossings([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        assert!(touching.len().is_multiple_of(2), "{touching:?}");
        for i in 0..1000 {
            let x = f64::from(i) / 1000.0 - 0.5;
            let found = crossings([x * 7.0, 8.0, 0.3], [-x * 7.0, -7.0, -0.3]);
            assert_eq!(found.len() % 2, 0, "{i}: {found:?}");
        }
    }

    #[test]
    fn parallel_to_a_line_of_the_side() {
        // x = w/2 - 1/4 beside the line x = w/2 of the side, on the inside: one crossing with each part.
        let found = crossings([0.25, 1.0, 0.0], [0.5, -1.0, 0.0]);
        assert!(found.is_empty() || found.len() == 2);
        let found = crossings([-0.25, 1.0, 0.0], [0.5, -1.0, 0.0]);
        assert_eq!(found, [(0.25, SIDE), (2.0, BASE)]);
    }
}
