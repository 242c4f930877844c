//! The planar polygon.

use std::fmt;

use super::{
    CrossingSink, Solidity, Surface,
    planar::{crossing_edges, flattened, newell},
    triangle::TriangleRay,
};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray, max_abs},
    scene::SceneError,
};

/// A planar polygon of any number of points, where its points are.
///
/// Parameters: the points in object units. Not solid. Front and normal: the side from which the points run
/// counter-clockwise. Concave polygons are right, and so is one with holes that bridges to each hole along
/// the same edge there and back.
///
/// uv: the picture fills the rectangle around the polygon in its plane, v up as far as the plane rises, u to
/// the right as seen from the front; in a level plane, u runs along +X.
///
/// ```
/// use rtscript::{DVec3, shape::Polygon};
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// assert_eq!(Polygon::new(corners.clone())?.points(), corners);
/// // Two corners make none.
/// assert!(Polygon::new(corners[..2].to_vec()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Polygon {
    points: Vec<DVec3>,
    /// A point of the plane, in the middle of the points.
    anchor: DVec3,
    /// Unit normal of the plane.
    normal: DVec3,
    /// All points are in the plane up to rounding.
    exact: bool,
    bounds: Bounds3,
    /// Unit vectors of u and v in the plane.
    axes: [DVec3; 2],
    uv_min: DVec2,
    uv_size: DVec2,
}

/// Its points; all else follows from them.
impl fmt::Debug for Polygon {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Polygon").field("points", &self.points).finish()
    }
}

impl Solidity for Polygon {
    const SOLID: bool = false;
}

/// How far a point may be off the plane, as a part of the polygon's extent: what literals of four digits
/// leave.
const FLATNESS: f64 = 1e-4;

/// The same for points that are in the plane but for the rounding of their computation.
const EXACT: f64 = 1e-12;

/// Square of the sine of the angle to the plane from which on the plane decides where a ray meets it.
const STEEP: f64 = 1e-6;

impl Polygon {
    /// A polygon through `points` in object units, counter-clockwise as seen from its front. A point that
    /// repeats the one before it, or the first at the end, is dropped.
    ///
    /// # Errors
    /// Where a number is not finite or beyond 1e15, fewer than 3 points differ, the area is 0, a point is
    /// off the plane by more than 1e-4 of the polygon's extent, or two edges cross.
    pub fn new(points: Vec<DVec3>) -> Result<Self, SceneError> {
        let wrong = |p: &DVec3| !(p.is_finite() && max_abs(*p) <= 1e15);
        if let Some((i, p)) = points.iter().enumerate().find(|(_, p)| wrong(p)) {
            return Err(SceneError::new(format!(
                "points[{i}] of the polygon must be finite numbers within 1e15, not {p}"
            )));
        }
        let kept = distinct(points)?;
        let points: Vec<DVec3> = kept.iter().map(|p| p.1).collect();
        // Where there are no points, there is none to be named.
        let name = |i: usize| kept.get(i % kept.len().max(1)).map_or(i, |(index, _)| *index);

        let around = Bounds3::around(points.iter().copied());
        let extent = max_abs(around.size());
        // Relative to the first point, so that a polygon in x = 0.1 lies in x = 0.1 to the last bit.
        let start = points.first().copied().unwrap_or_default();
        let local: Vec<DVec3> = points.iter().map(|p| (*p - start) / extent).collect();
        let area = newell(&local);
        if !(area.length() > 1e-12) {
            return Err(SceneError::new(
                "the polygon's area is 0: its points lie on a line, or it crosses itself like a bow tie",
            ));
        }
        let normal = area.normalize();
        let middle = local.iter().sum::<DVec3>() / local.len() as f64;
        let off = local
            .iter()
            .map(|p| normal.dot(*p - middle).abs())
            .enumerate()
            .fold((0, 0.0), |worst, p| if p.1 > worst.1 { p } else { worst });
        if off.1 > FLATNESS {
            return Err(SceneError::new(format!(
                "the polygon is not flat: points[{}] is off its plane by {}, \
                 more than {FLATNESS} of its extent of {extent}",
                name(off.0),
                four_digits(off.1 * extent)
            ))
            .hint("split it into triangles: tri(a, b, c), or mesh(#{ positions: ..., indices: ... })"));
        }
        if let Some((i, j)) = crossing_edges(&flattened(&local, normal)) {
            return Err(SceneError::new(format!(
                "the polygon crosses itself: the edge from points[{}] to points[{}] \
                 cuts the edge from points[{}] to points[{}]",
                name(i),
                name(i + 1),
                name(j),
                name(j + 1)
            )));
        }

        let axes = plane_axes(normal);
        let anchor = start + middle * extent;
        let flat = |p: DVec3| DVec2::new(axes[0].dot(p - anchor), axes[1].dot(p - anchor));
        let (uv_min, uv_max) = points.iter().fold(
            (DVec2::splat(f64::INFINITY), DVec2::splat(f64::NEG_INFINITY)),
            |(min, max), p| (min.min(flat(*p)), max.max(flat(*p))),
        );
        Ok(Self {
            anchor,
            normal,
            exact: off.1 <= EXACT,
            bounds: around,
            axes,
            uv_min,
            uv_size: uv_max - uv_min,
            points,
        })
    }

    /// The points, without repeated ones.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The unit normal.
    #[must_use]
    pub const fn normal(&self) -> DVec3 {
        self.normal
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.bounds)
    }

    /// Inside or outside is decided where the ray sees the polygon's points (see [`TriangleRay`]), not where
    /// it meets the plane: two polygons that share an edge, even at an angle, then compute the same numbers
    /// for it. Crossing-number rule with half-open edges (Haines, "Point in Polygon Strategies", Graphics
    /// Gems IV, 1994); an edge shared by two polygons changes both counts or none, so never both miss.
    ///
    /// The plane gives t to the rounding of the hit's own distance, which on a large floor matters. Where
    /// the ray almost lies in the plane, or the points do not quite, t comes from the two edges between
    /// which it passes: to the rounding of their distance, but never off the polygon.
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let view = TriangleRay::new(ray);
        let Some(last) = self.points.last() else {
            return;
        };
        // The nearest edges to the left and to the right of the ray on the line y = 0: their x there and
        // their z.
        let (mut left, mut right) = ((f64::NEG_INFINITY, 0.0), (f64::INFINITY, 0.0));
        let mut inside = false;
        let [mut ax, mut ay, mut az] = view.sheared(*last);
        for p in &self.points {
            let [bx, by, bz] = view.sheared(*p);
            let upwards = by > 0.0;
            if (ay > 0.0) != upwards {
                let cross = ax * by - ay * bx;
                let x = cross / (by - ay);
                let z = az + (bz - az) * (ay / (ay - by));
                if if upwards { cross > 0.0 } else { cross < 0.0 } {
                    inside = !inside;
                    if x < right.0 {
                        right = (x, z);
                    }
                } else if x > left.0 {
                    left = (x, z);
                }
            }
            (ax, ay, az) = (bx, by, bz);
        }
        if !inside {
            return;
        }
        let rises = self.normal.dot(ray.dir);
        let t = if self.exact && rises * rises > STEEP * ray.dir.length_squared() {
            self.normal.dot(self.anchor - ray.origin) / rises
        } else {
            let along = left.0 / (left.0 - right.0);
            view.t_at(left.1 + (right.1 - left.1) * along)
        };
        if t.is_finite() {
            out.push(t, 0);
        }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let q = p - self.anchor;
        let uv = (DVec2::new(self.axes[0].dot(q), self.axes[1].dot(q)) - self.uv_min) / self.uv_size;
        Surface {
            normal: self.normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
        }
    }
}

/// The points without those that repeat the one before, each with its number among all, by which messages
/// name it.
fn distinct(points: Vec<DVec3>) -> Result<Vec<(usize, DVec3)>, SceneError> {
    let given = points.len();
    let mut kept: Vec<(usize, DVec3)> = points.into_iter().enumerate().collect();
    kept.dedup_by(|b, a| a.1 == b.1);
    while kept.len() > 1 && kept.first().map(|p| p.1) == kept.last().map(|p| p.1) {
        kept.pop();
    }
    if kept.len() < 3 {
        return Err(SceneError::new(format!(
            "a polygon needs at least 3 different points, not {} of {given}",
            kept.len()
        ))
        .hint("polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) is a triangle"));
    }
    Ok(kept)
}

/// Horizontal and rising unit vectors in the plane with a unit normal, right-handed with it.
fn plane_axes(normal: DVec3) -> [DVec3; 2] {
    let level = DVec3::Y.cross(normal);
    let right = if level.length() > 1e-6 {
        level.normalize()
    } else {
        (DVec3::X - normal * normal.x).normalize()
    };
    [right, normal.cross(right)]
}

/// A number to four digits, without an exponent where it is of a size to be read.
fn four_digits(x: f64) -> String {
    match x {
        x if (1e-3..1e4).contains(&x) => format!("{x:.4}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        x => format!("{x:.3e}"),
    }
}

#[cfg(test)]
mod tests;
