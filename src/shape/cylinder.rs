//! The closed cylinder.

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

/// A closed cylinder centered at the origin, axis Y.
///
/// Parameters: radius and full height in object units. Solid. Normals outwards. Parts: 0 the side, 1 the cap
/// at -height/2, 2 the cap at +height/2.
///
/// uv: on the side, u once around Y as on the sphere, from -Z over -X to +Z at 0.5 and on over +X, and v from
/// the lower rim (0) to the upper (1); each cap shows the disk cut out of the picture, unmirrored from
/// outside, +X to the right.
///
/// ```
/// use rtscript::shape::{Cylinder, Shape};
/// let can = Shape::Cylinder(Cylinder::new(0.5, 2.0)?);
/// assert_eq!(can.bounds().map(|b| b.size().to_array()), Some([1.0, 2.0, 1.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    radius: f64,
    height: f64,
}

impl Solidity for Cylinder {
    const SOLID: bool = true;
}

const SIDE: u32 = 0;
const BOTTOM: u32 = 1;
const TOP: u32 = 2;

upright!(Cylinder, "The radius.", "The full height.");

impl Cylinder {
    /// A cylinder of `radius` and full `height` in object units.
    ///
    /// # Errors
    /// Where one of them is not greater than 0 or beyond 1e15.
    pub fn new(radius: f64, height: f64) -> Result<Self, SceneError> {
        upright::check("cylinder", radius, height)?;
        Ok(Self { radius, height })
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let span = Span::slab(ray.origin.y, ray.dir.y, self.height * 0.5, BOTTOM, TOP)
            .and_then(|caps| caps.clip(self.inside_side(ray)?));
        if let Some(span) = span {
            span.push(out);
        }
    }

    /// Where the line is inside the endless cylinder: the sphere's roots, one dimension down. The distance
    /// between line and axis comes from the cross product, so a far origin costs no more than its own
    /// rounding.
    #[inline]
    fn inside_side(&self, ray: &Ray) -> Option<Span> {
        let (o, d, r) = (ray.origin, ray.dir, self.radius);
        // A line that leaves the axis by less than 1e-30 of the radius over the height is parallel to it: the
        // squares below would vanish before they tell more.
        if (d.x.abs() + d.z.abs()) * self.height <= 1e-30 * r * d.y.abs() {
            // Between the caps it is everywhere as far from the axis as halfway, which its start may be far from where
            // the cylinder is that flat.
            let halfway = if d.y == 0.0 { 0.0 } else { -o.y / d.y };
            let (x, z) = (o.x + d.x * halfway, o.z + d.z * halfway);
            return Span::line_if(x * x + z * z <= r * r);
        }
        let a = d.x * d.x + d.z * d.z;
        let b = -(o.x * d.x + o.z * d.z);
        let cross = o.x * d.z - o.z * d.x;
        let discriminant = r * r * a - cross * cross;
        if !(discriminant >= 0.0) {
            return None;
        }
        let q = b + discriminant.sqrt().copysign(b);
        let c = o.x * o.x + o.z * o.z - r * r;
        // q is 0 where the line touches the side at the ray's very origin: both roots are there.
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        if t0 <= t1 {
            Span::new(t0, t1, SIDE)
        } else {
            Span::new(t1, t0, SIDE)
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3, part: u32) -> DVec3 {
        match part {
            SIDE => DVec3::new(p.x, 0.0, p.z),
            BOTTOM => DVec3::NEG_Y,
            _ => DVec3::Y,
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        Surface {
            normal: self.normal(p, part),
            uv: match part {
                SIDE => DVec2::new(u_around_y(p.x, p.z), (p.y / self.height + 0.5).clamp(0.0, 1.0)),
                BOTTOM => cap_uv(p.x, p.z, self.radius),
                _ => cap_uv(p.x, -p.z, self.radius),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    fn crossings(origin: [f64; 3], dir: [f64; 3]) -> Vec<(f64, u32)> {
        let mut out = Crossings::default();
        Cylinder::new(1.0, 2.0)
            .unwrap()
            .crossings(&Ray::new(origin.into(), dir.into()), &mut out);
        out.as_slice().iter().map(|c| (c.t, c.part)).collect()
    }

    #[test]
    fn side_caps_and_both() {
        assert_eq!(
            crossings([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
            [(2.0, SIDE), (4.0, SIDE)],
            "across"
        );
        assert_eq!(
            crossings([0.5, 3.0, 0.5], [0.0, -1.0, 0.0]),
            [(2.0, TOP), (4.0, BOTTOM)],
            "along the axis"
        );
        assert_eq!(
            crossings([-1.5, 2.0, 0.0], [1.0, -1.0, 0.0]),
            [(1.0, TOP), (2.5, SIDE)],
            "in through the top, out through the side"
        );
        assert!(crossings([0.0, 1.1, 3.0], [0.0, 0.0, -1.0]).is_empty(), "above");
        assert!(crossings([2.0, 0.0, 3.0], [0.0, 0.0, -1.0]).is_empty(), "beside");
    }

    #[test]
    fn rims_are_crossed_an_even_number_of_times() {
        assert_eq!(
            crossings([1.0, 5.0, 0.0], [0.0, -1.0, 0.0]).len(),
            2,
            "in the side"
        );
        assert_eq!(crossings([0.0, 1.0, 5.0], [0.0, 0.0, -1.0]).len(), 2, "in a cap");
        assert_eq!(
            crossings([1.0, 1.0, 5.0], [0.0, 0.0, -1.0]).len(),
            2,
            "touching a rim"
        );
    }

    #[test]
    fn nearly_parallel_lines_are_judged_by_where_they_pass() {
        for tilt in [0.0, 1e-300, 1e-160, 1e-40, 1e-20, 1e-12] {
            let inside = crossings([0.5, 3.0, 0.5], [tilt, -1.0, -tilt]);
            assert_eq!(inside, [(2.0, TOP), (4.0, BOTTOM)], "{tilt}");
            assert!(
                crossings([0.8, 3.0, 0.8], [tilt, -1.0, -tilt]).is_empty(),
                "{tilt}"
            );
        }
    }
}
