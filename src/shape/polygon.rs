//! The planar polygon.
//!
//! Pose: where its points are, in object units. Not solid. Front and normal: the side from which the points run
//! counter-clockwise. Concave polygons are right, and so is one with holes that bridges to each hole along the same
//! edge there and back. uv over the rectangle around the polygon in its plane, with v up as far as the plane rises
//! and u to the right as seen from the front; in a level plane u runs along +X.

use std::fmt;

use super::{Crossings, Solidity, Surface, triangle::TriangleRay};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray, max_abs},
    scene::SceneError,
};

/// A planar polygon of any number of points.
#[derive(Clone, PartialEq)]
pub struct Polygon {
    points: Vec<DVec3>,
    /// A point of the plane, in the middle of the points.
    anchor: DVec3,
    /// Unit normal of the plane.
    normal: DVec3,
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

/// How far a point may be off the plane, as a part of the polygon's extent: what literals of four digits leave.
const FLATNESS: f64 = 1e-4;

/// Pairs of edges compared at most in search of a crossing, so that no input takes longer than a blink. Beyond it
/// the even-odd rule decides what is inside.
const EDGE_PAIRS: usize = 1 << 24;

impl Polygon {
    /// A polygon through `points` in object units, counter-clockwise as seen from its front. A point that repeats
    /// the one before it, or the first at the end, is dropped.
    ///
    /// # Errors
    /// Where a number is not finite or beyond 1e15, fewer than 3 points differ, the area is 0, a point is off the
    /// plane by more than 1e-4 of the polygon's extent, or two edges cross.
    pub fn new(points: Vec<DVec3>) -> Result<Self, SceneError> {
        if let Some(i) = points
            .iter()
            .position(|p| !(p.is_finite() && max_abs(*p) <= 1e15))
        {
            return Err(SceneError::new(format!(
                "points[{i}] of the polygon must be finite numbers within 1e15, not {}",
                points[i]
            )));
        }
        let given = points.len();
        // Messages name points as they were given.
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
        let points: Vec<DVec3> = kept.iter().map(|p| p.1).collect();
        let name = |i: usize| kept.get(i).map_or(0, |p| p.0);

        let around = Bounds3::around(points.iter().copied());
        let extent = max_abs(around.size());
        // Relative to the first point, so that a polygon in x = 0.1 lies in x = 0.1 to the last bit.
        let start = points[0];
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
                "the polygon is not flat: points[{}] is off its plane by {:.3e}, more than {FLATNESS} of its extent of {extent}",
                name(off.0),
                off.1 * extent
            ))
            .hint("split it into triangles: tri(a, b, c), or mesh(#{ positions: ..., indices: ... })"));
        }
        if let Some((i, j)) = crossing_edges(&flattened(&local, normal)) {
            let next = |i: usize| name((i + 1) % kept.len());
            return Err(SceneError::new(format!(
                "the polygon crosses itself: the edge from points[{}] to points[{}] cuts the edge from points[{}] to points[{}]",
                name(i),
                next(i),
                name(j),
                next(j)
            )));
        }

        // A hit lies in the plane, the box around the points need not hold all of it.
        let slack = DVec3::splat(2.0 * off.1 * extent);
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
            bounds: Bounds3::new(around.min - slack, around.max + slack),
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

    /// Inside or outside is decided where the ray sees the polygon's points (see [`TriangleRay`]), not where it
    /// meets the plane: two polygons that share an edge, even at an angle, then compute the same numbers for it.
    /// Crossing-number rule with half-open edges (Haines, "Point in Polygon Strategies", Graphics Gems IV, 1994);
    /// an edge shared by two polygons changes both counts or none, so never both miss.
    pub(super) fn crossings(&self, ray: &Ray, out: &mut Crossings) {
        let view = TriangleRay::new(ray);
        let Some(last) = self.points.last() else {
            return;
        };
        let [mut ax, mut ay, z] = view.sheared(*last);
        let (mut inside, mut z_min, mut z_max) = (false, z, z);
        for p in &self.points {
            let [bx, by, z] = view.sheared(*p);
            z_min = z_min.min(z);
            z_max = z_max.max(z);
            let upwards = by > 0.0;
            if (ay > 0.0) != upwards {
                // The edge crosses the x axis at this value over |by - ay|.
                let cross = ax * by - ay * bx;
                inside ^= if upwards { cross > 0.0 } else { cross < 0.0 };
            }
            (ax, ay) = (bx, by);
        }
        if !inside {
            return;
        }
        let t = self.normal.dot(self.anchor - ray.origin) / self.normal.dot(ray.dir);
        if t.is_nan() {
            return;
        }
        // Almost in the plane, t is a quotient of rounding errors; the ray passes the polygon where it passes its
        // points.
        let (t0, t1) = (view.t_at(z_min), view.t_at(z_max));
        let t = t.max(t0.min(t1)).min(t0.max(t1));
        if t.is_finite() {
            out.push(t, 0);
        }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u8) -> Surface {
        let q = p - self.anchor;
        let uv = (DVec2::new(self.axes[0].dot(q), self.axes[1].dot(q)) - self.uv_min) / self.uv_size;
        Surface {
            normal: self.normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
        }
    }
}

/// Twice the area of a polygon as a vector along its normal, counter-clockwise being the front (Newell's method;
/// Sutherland, Sproull and Schumacker, 1974). Best with the first point at the origin.
pub(super) fn newell(points: &[DVec3]) -> DVec3 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.cross(*b)).sum()
}

/// The points without the coordinate in which the plane faces most, mirrored where needed so that they run
/// counter-clockwise.
pub(super) fn flattened(points: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let n = normal.abs();
    let (pick, facing): (fn(&DVec3) -> DVec2, f64) = if n.x >= n.y && n.x >= n.z {
        (|p| DVec2::new(p.y, p.z), normal.x)
    } else if n.y >= n.z {
        (|p| DVec2::new(p.z, p.x), normal.y)
    } else {
        (|p| DVec2::new(p.x, p.y), normal.z)
    };
    let mirror = |p: DVec2| if facing < 0.0 { DVec2::new(p.y, p.x) } else { p };
    points.iter().map(|p| mirror(pick(p))).collect()
}

/// Twice the signed area of the triangle `a`, `b`, `c`.
pub(super) fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
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

/// Two edges that properly cross, each named by its first point. Edges that touch or overlap do not count: bridges
/// to holes do so. Coordinates are expected within [-1, 1]. Sorted by their left ends, edges are compared with those
/// that begin before they end.
fn crossing_edges(points: &[DVec2]) -> Option<(usize, usize)> {
    let n = points.len();
    let edge = |i: usize| (points[i], points[(i + 1) % n]);
    let mut order: Vec<usize> = (0..n).collect();
    let left = |i: usize| edge(i).0.x.min(edge(i).1.x);
    order.sort_by(|&i, &j| left(i).total_cmp(&left(j)).then(i.cmp(&j)));
    // Further from 0 than rounding takes an orientation of points in the unit square.
    let opposite = |x: f64, y: f64| (x > 1e-14 && y < -1e-14) || (x < -1e-14 && y > 1e-14);
    let mut pairs = 0;
    for (k, &i) in order.iter().enumerate() {
        let (a, b) = edge(i);
        for &j in order.iter().skip(k + 1).take_while(|&&j| left(j) <= a.x.max(b.x)) {
            pairs += 1;
            if pairs > EDGE_PAIRS {
                return None;
            }
            let (c, d) = edge(j);
            if opposite(orient(a, b, c), orient(a, b, d)) && opposite(orient(c, d, a), orient(c, d, b)) {
                return Some((i.min(j), i.max(j)));
            }
        }
    }
    None
}
