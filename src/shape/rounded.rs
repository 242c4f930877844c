//! The box with rounded edges.

use super::{CrossingSink, Cuboid, Solidity, Surface, pieces::Frame, positive, roots::root_between};
use crate::{
    math::{Bounds3, DVec3, Ray, larger, smaller},
    scene::SceneError,
};

/// A box centered at the origin whose edges and corners are rounded: all within `radius` of a smaller box.
///
/// Parameters in object units: the whole size, and the radius of the edges, at most half of the shortest edge. Solid.
/// Normals outwards.
///
/// uv: as on a box, every point of a rounded edge going to the face it is nearest to.
///
/// ```
/// use rtscript::{DVec3, shape::RoundedBox};
/// // Twice the radius must fit into each side.
/// assert_eq!(RoundedBox::new(DVec3::ONE, 0.2).map(|b| b.radius()), Ok(0.2));
/// assert!(RoundedBox::new(DVec3::ONE, 0.7).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedBox {
    size: DVec3,
    radius: f64,
}

impl Solidity for RoundedBox {
    const SOLID: bool = true;
}

impl RoundedBox {
    /// A box of these whole edge lengths, rounded by `radius`, in object units.
    ///
    /// # Errors
    /// Where a length is not greater than 0 or beyond 1e15, or the radius is more than half of an edge.
    pub fn new(size: DVec3, radius: f64) -> Result<Self, SceneError> {
        positive("the rounded box's width", size.x)?;
        positive("the rounded box's height", size.y)?;
        positive("the rounded box's depth", size.z)?;
        positive("the rounded box's radius", radius)?;
        let most = 0.5 * size.min_element();
        if radius > most {
            return Err(SceneError::new(format!(
                "the rounded box's radius must be at most half of its shortest edge, {most}, not {radius}"
            )));
        }
        Ok(Self { size, radius })
    }

    /// The whole edge lengths.
    #[must_use]
    pub const fn size(&self) -> DVec3 {
        self.size
    }

    /// The radius of the edges.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(self.size * -0.5, self.size * 0.5))
    }

    fn inner(&self) -> DVec3 {
        (self.size * 0.5 - self.radius).max(DVec3::ZERO)
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
        let across = normal.abs();
        // Where faces are equally near, the first of the three has the point.
        let face = if across.x >= across.y && across.x >= across.z {
            u32::from(normal.x > 0.0)
        } else if across.y >= across.z {
            2 + u32::from(normal.y > 0.0)
        } else {
            4 + u32::from(normal.z > 0.0)
        };
        let uv = Cuboid::new(self.size).map_or(crate::math::DVec2::ZERO, |c| c.surface(p, face).uv);
        Surface { normal, uv }
    }
}

/// From the nearest point of the box of these half edges to `p`, outside of it.
pub(super) fn normal_around(half: DVec3, p: DVec3) -> DVec3 {
    let normal = p - p.clamp(-half, half);
    // Only for a point that is not on the surface.
    if normal == DVec3::ZERO { DVec3::Y } else { normal }
}

/// How much wider the searched interval is than the shape, so that it ends outside in spite of rounding.
const MARGIN: f64 = 1e-9;

/// Both crossings of a line with all within `radius` of the box of these half edges, or none.
///
/// Along the line, the square of the distance to the box is convex and made of up to seven parabolas. Its slope at
/// their ends tells where it is least; where that is within the radius, there is one crossing on either side.
pub(super) fn cross_around(half: DVec3, radius: f64, ray: &Ray, out: &mut impl CrossingSink) {
    let scale = half.max_element() + radius;
    let Some(line) = Frame::new(DVec3::ZERO, scale).line(ray) else {
        return;
    };
    let (half, radius) = (half / scale, radius / scale);
    let (o, d) = (line.ray.origin, line.ray.dir);
    let Some((lo, hi)) = line.within((half + radius) * (1.0 + MARGIN)) else {
        return;
    };
    let value = |way: f64| {
        let p = o + d * way;
        let within = |x: f64, half: f64| smaller(larger(x, -half), half);
        let off = p - DVec3::new(within(p.x, half.x), within(p.y, half.y), within(p.z, half.z));
        (off.dot(off) - radius * radius, 2.0 * off.dot(d))
    };
    let mut ends = [hi; 7];
    let planes = o.to_array().into_iter().zip(d.to_array()).zip(half.to_array());
    let ways = planes.flat_map(|((o, d), half)| [(-half - o) / d, (half - o) / d]);
    for (end, way) in ends.iter_mut().zip(ways) {
        // A line along a face never meets its plane, whatever 0 / 0 is.
        *end = if way > lo && way < hi { way } else { hi };
    }
    ends.sort_by(f64::total_cmp);
    let mut least = (lo, value(lo).1);
    for way in ends {
        if least.1 >= 0.0 {
            break;
        }
        let slope = value(way).1;
        if slope >= 0.0 {
            // The slope is straight between neighbours.
            least = (least.0 + (way - least.0) * (least.1 / (least.1 - slope)), 0.0);
            break;
        }
        least = (way, slope);
    }
    let (bottom, _) = least;
    if value(bottom).0 <= 0.0 {
        out.push(line.t(root_between(value, lo, bottom, true)), 0);
        if !out.is_served() {
            out.push(line.t(root_between(value, bottom, hi, false)), 0);
        }
    }
}
