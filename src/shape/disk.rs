//! The disk.

use super::{CrossingSink, Solidity, Surface, cap_uv, plane::t_at_y0, positive};
use crate::{
    math::{Bounds3, DVec3, Ray},
    scene::SceneError,
};

/// A disk in y = 0 around the origin.
///
/// Parameter: radius in object units. Not solid. Front and normal +Y.
///
/// uv: the disk cut out of the picture, unmirrored from above, +X to the right and -Z up.
///
/// ```
/// use rtscript::shape::{Disk, Shape};
/// let lid = Shape::Disk(Disk::new(0.5)?);
/// assert!(!lid.is_solid());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    radius: f64,
}

impl Solidity for Disk {
    const SOLID: bool = false;
}

impl Disk {
    /// A disk of `radius` object units.
    ///
    /// # Errors
    /// Where the radius is not greater than 0 or beyond 1e15.
    pub fn new(radius: f64) -> Result<Self, SceneError> {
        positive("the disk's radius", radius)?;
        Ok(Self { radius })
    }

    /// The radius.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        let corner = DVec3::new(self.radius, 0.0, self.radius);
        Some(Bounds3::new(-corner, corner))
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        if let Some(t) = t_at_y0(ray) {
            let p = ray.at(t);
            if p.x * p.x + p.z * p.z <= self.radius * self.radius {
                out.push(t, 0);
            }
        }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        Surface {
            normal: DVec3::Y,
            uv: cap_uv(p.x, -p.z, self.radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};
    use crate::math::DVec2;

    #[test]
    fn the_rim_belongs_to_it_and_a_ray_in_its_plane_misses() {
        let disk = Disk::new(2.0).unwrap();
        let count = |o: [f64; 3], d: [f64; 3]| {
            let mut out = Crossings::default();
            disk.crossings(&Ray::new(o.into(), d.into()), &mut out);
            out.as_slice().len()
        };
        assert_eq!(count([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), 1);
        assert_eq!(count([0.0, -1.0, 0.0], [0.0, -1.0, 0.0]), 1, "behind the origin");
        assert_eq!(count([2.0, 1.0, 0.0], [0.0, -1.0, 0.0]), 1, "the rim");
        assert_eq!(count([2.1, 1.0, 0.0], [0.0, -1.0, 0.0]), 0);
        assert_eq!(count([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 0, "in its plane");
    }

    #[test]
    fn uv_as_seen_from_above() {
        let disk = Disk::new(2.0).unwrap();
        assert_eq!(
            disk.surface(DVec3::new(2.0, 0.0, 0.0), 0).uv,
            DVec2::new(1.0, 0.5)
        );
        assert_eq!(
            disk.surface(DVec3::new(0.0, 0.0, -2.0), 0).uv,
            DVec2::new(0.5, 1.0)
        );
    }
}
