//! The box (a word Rust keeps for itself).

use super::{CrossingSink, Solidity, Surface, positive, span::Span};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray},
    scene::SceneError,
};

/// A box around the origin, edges along the axes.
///
/// Parameters: its full edge lengths along X, Y and Z in object units. Solid. Normals outwards, unit length.
/// Parts: the faces -X, +X, -Y, +Y, -Z, +Z, counted from 0.
///
/// uv: each face shows the whole picture, upright and unmirrored to one who looks at it from outside with Y
/// up; on top and bottom, +X is to the right.
///
/// ```
/// use rtscript::{DVec3, shape::{Cuboid, Shape}};
/// let plank = Cuboid::new(DVec3::new(4.0, 0.1, 1.0))?;
/// assert_eq!(plank.size(), DVec3::new(4.0, 0.1, 1.0));
/// let bounds = Shape::Cuboid(plank).bounds().map(|b| b.size());
/// assert_eq!(bounds, Some(DVec3::new(4.0, 0.1, 1.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    half: DVec3,
}

impl Solidity for Cuboid {
    const SOLID: bool = true;
}

impl Cuboid {
    /// A box of the full edge lengths `size` (width, height, depth) in object units.
    ///
    /// # Errors
    /// Where an edge is not greater than 0 or beyond 1e15.
    pub fn new(size: DVec3) -> Result<Self, SceneError> {
        positive("the box's width", size.x)?;
        positive("the box's height", size.y)?;
        positive("the box's depth", size.z)?;
        Ok(Self { half: size * 0.5 })
    }

    /// Width, height and depth.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.half * 2.0
    }

    /// Half of [`Cuboid::size`]: the box reaches from minus this to this.
    pub(crate) fn half(&self) -> DVec3 {
        self.half
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(-self.half, self.half))
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let (o, d, half) = (ray.origin, ray.dir, self.half);
        let span = Span::slab(o.x, d.x, half.x, 0, 1)
            .and_then(|span| span.clip(Span::slab(o.y, d.y, half.y, 2, 3)?))
            .and_then(|span| span.clip(Span::slab(o.z, d.z, half.z, 4, 5)?));
        if let Some(span) = span {
            span.push(out);
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let q = p / (self.half * 2.0);
        let (normal, right, up) = match part {
            0 => (DVec3::NEG_X, q.z, q.y),
            1 => (DVec3::X, -q.z, q.y),
            2 => (DVec3::NEG_Y, q.x, q.z),
            3 => (DVec3::Y, q.x, -q.z),
            4 => (DVec3::NEG_Z, -q.x, q.y),
            _ => (DVec3::Z, q.x, q.y),
        };
        let uv = DVec2::new(right, up) + 0.5;
        Surface {
            normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    fn crossings(origin: [f64; 3], dir: [f64; 3]) -> Vec<(f64, u32)> {
        let mut out = Crossings::default();
        Cuboid::new(DVec3::splat(2.0))
            .unwrap()
            .crossings(&Ray::new(origin.into(), dir.into()), &mut out);
        out.as_slice().iter().map(|c| (c.t, c.part)).collect()
    }

    #[test]
    fn every_face_from_every_side() {
        for axis in 0..3 {
            let mut dir = [0.0; 3];
            dir[axis] = 2.0;
            let faces = [2 * axis as u32, 2 * axis as u32 + 1];
            assert_eq!(crossings([0.0; 3], dir), [(-0.5, faces[0]), (0.5, faces[1])]);
            dir[axis] = -2.0;
            assert_eq!(crossings([0.0; 3], dir), [(-0.5, faces[1]), (0.5, faces[0])]);
        }
    }

    #[test]
    fn rays_in_faces_and_along_edges_cross_twice() {
        assert_eq!(
            crossings([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            [(2.0, 0), (4.0, 1)],
            "in the plane of a face"
        );
        assert_eq!(
            crossings([-3.0, 1.0, -1.0], [1.0, 0.0, 0.0]),
            [(2.0, 0), (4.0, 1)],
            "along an edge"
        );
        assert_eq!(
            crossings([-2.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
            [(1.0, 0), (1.0, 3)],
            "touching an edge"
        );
        assert_eq!(
            crossings([-3.0, -3.0, -3.0], [1.0, 1.0, 1.0]),
            [(2.0, 0), (4.0, 1)],
            "from corner to corner"
        );
        assert!(crossings([-3.0, 1.0000001, 0.0], [1.0, 0.0, 0.0]).is_empty());
    }

    #[test]
    fn pictures_on_the_faces_are_upright_and_unmirrored() {
        let cuboid = Cuboid::new(DVec3::new(2.0, 4.0, 6.0)).unwrap();
        for part in 0..6 {
            let center = cuboid.surface(DVec3::ZERO, part);
            let n = center.normal;
            let up = if n.y == 0.0 { DVec3::Y } else { -DVec3::Z * n.y };
            let right = up.cross(n);
            let uv = cuboid.surface((n + right + up) * cuboid.half, part).uv;
            assert_eq!(uv, DVec2::ONE, "face {part}");
            let uv = cuboid.surface((n - right + up) * cuboid.half, part).uv;
            assert_eq!(uv, DVec2::Y, "face {part}");
        }
    }
}
