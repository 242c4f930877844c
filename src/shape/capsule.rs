//! The capsule.

use super::{
    CrossingSink, Solidity, Surface,
    rounded::{cross_around, normal_around},
    u_around_y,
    upright::{self, upright},
};
use crate::{
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// A cylinder around Y with a half sphere at either end, centered at the origin.
///
/// Parameters in object units: the radius and the whole height, at least twice the radius. Solid. Normals outwards.
///
/// uv: u once around Y as on the sphere; v along the outline from the lower tip (0) to the upper one (1), by its
/// length.
///
/// ```
/// use rtscript::shape::{Capsule, Shape};
/// let pill = Shape::Capsule(Capsule::new(0.5, 2.0)?);
/// assert!(pill.is_solid());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    radius: f64,
    height: f64,
}

impl Solidity for Capsule {
    const SOLID: bool = true;
}

upright!(Capsule, "The radius.", "The whole height.");

impl Capsule {
    /// A capsule of `radius` and whole `height` in object units.
    ///
    /// # Errors
    /// Where a length is not greater than 0 or beyond 1e15, or the height is less than twice the radius.
    pub fn new(radius: f64, height: f64) -> Result<Self, SceneError> {
        upright::check("capsule", radius, height)?;
        if height < 2.0 * radius {
            return Err(SceneError::new(format!(
                "the capsule's height must be at least twice its radius, {}, not {height}",
                2.0 * radius
            ))
            .hint("the height is that of the whole, both round ends included"));
        }
        Ok(Self { radius, height })
    }

    /// Half of the cylinder's height: a capsule is all within the radius of a part of the axis.
    fn inner(&self) -> DVec3 {
        DVec3::new(0.0, (0.5 * self.height - self.radius).max(0.0), 0.0)
    }

    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        cross_around(self.inner(), self.radius, ray, out);
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        normal_around(self.inner(), p)
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let normal = self.normal(p);
        let straight = self.inner().y;
        let cap = 0.5 * PI * self.radius;
        let rise = math::atan2(normal.y, math::hypot(normal.x, normal.z)) * self.radius;
        let along = p.y.clamp(-straight, straight) + rise;
        let v = along / (2.0 * (straight + cap)) + 0.5;
        Surface {
            normal,
            uv: DVec2::new(u_around_y(p.x, p.z), v.clamp(0.0, 1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    #[test]
    fn ends_are_round_and_the_middle_is_straight() {
        let capsule = Capsule::new(1.0, 4.0).unwrap();
        let crossings = |o: [f64; 3], d: [f64; 3]| {
            let mut out = Crossings::default();
            capsule.crossings(&Ray::new(o.into(), d.into()), &mut out);
            out.as_slice().iter().map(|c| c.t).collect::<Vec<_>>()
        };
        assert_eq!(crossings([0.0, 5.0, 0.0], [0.0, -1.0, 0.0]), [3.0, 7.0]);
        assert_eq!(crossings([0.0, 0.5, 3.0], [0.0, 0.0, -2.0]), [1.0, 2.0]);
        assert!(crossings([0.8, 1.7, 3.0], [0.0, 0.0, -1.0]).is_empty());
        let through_an_end = crossings([0.6, 1.0, 3.0], [0.0, 0.0, -1.0]);
        assert!((through_an_end[0] - 2.2).abs() < 1e-15, "{through_an_end:?}");
        assert!(Capsule::new(1.0, 1.9).is_err());
        let uv = |x: f64, y: f64| capsule.surface(DVec3::new(x, y, 0.0), 0).uv.y;
        assert_eq!([uv(0.0, -2.0), uv(1.0, 0.0), uv(0.0, 2.0)], [0.0, 0.5, 1.0]);
    }
}
