//! The endless plane.

use super::{CrossingSink, Solidity, Surface};
use crate::math::{Bounds3, DVec2, DVec3, Ray};

/// The endless plane y = 0.
///
/// No parameters. Not solid, no bounds. Front and normal +Y.
///
/// uv: (x, -z), one repetition of the picture per object unit, unmirrored from above with +X to the right and
/// -Z up, as on a disk or a box's top.
///
/// ```
/// use rtscript::shape::{Plane, Shape};
/// // It has no end, so no box holds it.
/// assert!(Shape::Plane(Plane).bounds().is_none());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane;

impl Solidity for Plane {
    const SOLID: bool = false;
}

/// Where the line crosses y = 0; `None` where it runs in or along that plane, or is not finite.
#[inline]
pub(super) fn t_at_y0(ray: &Ray) -> Option<f64> {
    let t = -ray.origin.y / ray.dir.y;
    (t.is_finite() && ray.dir.is_finite() && ray.origin.is_finite()).then_some(t)
}

impl Plane {
    pub(super) fn bounds(&self) -> Option<Bounds3> {
        None
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        if let Some(t) = t_at_y0(ray) {
            out.push(t, 0);
        }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        Surface {
            normal: DVec3::Y,
            uv: DVec2::new(p.x, -p.z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    #[test]
    fn crossed_once_from_either_side_and_never_along_it() {
        let crossings = |o: [f64; 3], d: [f64; 3]| {
            let mut out = Crossings::default();
            Plane.crossings(&Ray::new(o.into(), d.into()), &mut out);
            out.as_slice().iter().map(|c| c.t).collect::<Vec<_>>()
        };
        assert_eq!(crossings([1e9, 4.0, 0.0], [1.0, -2.0, 0.0]), [2.0]);
        assert_eq!(crossings([1e9, -4.0, 0.0], [1.0, -2.0, 0.0]), [-2.0]);
        assert!(crossings([0.0, 4.0, 0.0], [1.0, 0.0, 0.0]).is_empty(), "above");
        assert!(crossings([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]).is_empty(), "in it");
    }
}
