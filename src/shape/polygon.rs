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
                "the polygon is not flat: points[{}] is off its plane by {:.3e}, \
                 more than {FLATNESS} of its extent of {extent}",
                name(off.0),
                off.1 * extent
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

#[cfg(test)]
mod tests {
    use super::{
        super::{Crossings, suite::Rng},
        *,
    };

    fn count(polygon: &Polygon, ray: &Ray) -> usize {
        let mut out = Crossings::default();
        polygon.crossings(ray, &mut out);
        out.as_slice().len()
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec2::from(*p).extend(0.0)).collect()
    }

    fn message(points: &[[f64; 2]]) -> String {
        Polygon::new(flat(points)).unwrap_err().message
    }

    const DART: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0]];

    #[test]
    fn concave_corners_are_outside() {
        let dart = Polygon::new(flat(&DART)).unwrap();
        let down = |x: f64, y: f64| count(&dart, &Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z));
        assert_eq!([down(0.9, 0.9), down(2.0, 0.9), down(0.9, 2.0)], [1, 1, 1]);
        assert_eq!([down(1.1, 1.1), down(2.0, 2.0), down(-0.1, 0.0)], [0, 0, 0]);
        assert_eq!(dart.normal(), DVec3::Z);
        assert_eq!(
            Polygon::new(flat(&DART).into_iter().rev().collect())
                .unwrap()
                .normal(),
            DVec3::NEG_Z
        );
    }

    /// A rectangle cut in two along a jagged line: every ray through it meets exactly one of the halves,
    /// also one aimed at the cut's points and edges.
    #[test]
    fn neighbours_share_their_edge_without_a_gap_or_an_overlap() {
        let mut rng = Rng::new(51);
        for _ in 0..300 {
            let cut: Vec<DVec2> = (0..=10)
                .map(|i| DVec2::new(f64::from(i), rng.within(2.0, 8.0)))
                .collect();
            let below = [DVec2::new(0.0, 0.0), DVec2::new(10.0, 0.0)]
                .into_iter()
                .chain(cut.iter().rev().copied());
            let above = cut
                .iter()
                .copied()
                .chain([DVec2::new(10.0, 10.0), DVec2::new(0.0, 10.0)]);
            let (turn, scale, at) = (rng.rotation(), rng.magnitude(-6.0, 6.0), rng.in_cube());
            // Folded along the cut's first axis or level: the halves need not lie in one plane.
            let fold = if rng.chance(0.5) {
                rng.within(-1.0, 1.0)
            } else {
                0.0
            };
            let straight = if fold == 0.0 { 1.0 } else { 0.0 };
            let place = |p: DVec2| {
                let y = if straight == 0.0 && (p.y > 0.0 && p.y < 10.0) {
                    5.0
                } else {
                    p.y
                };
                (turn * DVec3::new(p.x, y, fold * (y - 5.0).abs()) + at) * scale
            };
            let halves = [
                Polygon::new(below.map(place).collect()).unwrap(),
                Polygon::new(above.map(place).collect()).unwrap(),
            ];
            for _ in 0..100 {
                let i = 1 + rng.below(9);
                let along = [0.0, 0.5, rng.unit()][rng.below(3)];
                let aim = place(cut[i]).lerp(place(cut[i + usize::from(i < 9)]), along);
                let d = turn * (DVec3::Z + rng.in_cube() * 0.3);
                let origin = aim - d * scale * rng.within(-100.0, 100.0);
                let ray = Ray::new(origin, (aim - origin) * rng.magnitude(-6.0, 6.0));
                let met = halves.iter().map(|half| count(half, &ray)).sum::<usize>();
                assert_eq!(met, 1, "{ray:?} at {halves:?}");
            }
        }
    }

    /// Of a closed solid of polygons every line meets an even number, from inside one on each side.
    #[test]
    fn a_solid_of_polygons_is_tight() {
        let mut rng = Rng::new(52);
        let corner = |i: usize| DVec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 1.0 } else { -1.0 }));
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        for _ in 0..200 {
            let (turn, scale) = (rng.rotation(), rng.magnitude(-6.0, 6.0));
            let place = |p: DVec3| turn * p * scale;
            let solid = faces.map(|face| Polygon::new(face.map(|i| place(corner(i))).to_vec()).unwrap());
            for _ in 0..200 {
                let (a, b) = (corner(rng.below(8)), corner(rng.below(8)));
                let aim = place(a.lerp(b, [0.0, 0.5, rng.unit()][rng.below(3)]));
                let inner = place(rng.in_cube() * 0.5);
                let ray = Ray::new(inner, (aim - inner) * rng.magnitude(-6.0, 6.0));
                let mut all = Vec::new();
                for face in &solid {
                    let mut out = Crossings::default();
                    face.crossings(&ray, &mut out);
                    all.extend(out.as_slice().iter().map(|c| c.t));
                }
                assert_eq!(all.len(), 2, "{all:?} {ray:?}");
                assert!(all[0] * all[1] < 0.0, "{all:?} {ray:?}");
            }
        }
    }

    #[test]
    fn a_ray_almost_in_the_plane_hits_within_the_outline_or_not_at_all() {
        let mut rng = Rng::new(53);
        let mut met = 0;
        for _ in 0..20_000 {
            let turn = rng.rotation();
            let angle = rng.within(0.0, 6.3);
            let (s, c) = (crate::math::sin(angle), crate::math::cos(angle));
            let bent = if rng.chance(0.5) { 1e-5 } else { 0.0 };
            let bend = |p: &DVec3| turn * (*p + DVec3::Z * if p.y > 2.0 { bent } else { 0.0 });
            let polygon = Polygon::new(flat(&DART).iter().map(bend).collect()).unwrap();
            let lift = if rng.chance(0.3) {
                0.0
            } else {
                rng.magnitude(-18.0, -12.0)
            };
            let d = turn * DVec3::new(c, s, lift);
            let origin = turn * DVec3::new(rng.unit(), rng.unit(), 0.0) - d * rng.within(5.0, 20.0);
            let mut out = Crossings::default();
            polygon.crossings(&Ray::new(origin, d), &mut out);
            for hit in out.as_slice() {
                let p = turn.transpose() * (origin + d * hit.t);
                assert!(p.z.abs() < 1e-10 + bent, "{p}");
                assert!(
                    p.x > -1e-9 && p.y > -1e-9 && p.x < 4.0 + 1e-9 && p.y < 4.0 + 1e-9,
                    "{p}"
                );
                met += 1;
            }
        }
        assert!(met > 100, "{met}");
    }

    #[test]
    fn uv_spans_the_outline_upright_from_the_front() {
        let wall = [[1.0, 2.0], [5.0, 2.0], [5.0, 4.0], [1.0, 4.0]];
        let uvs = |points: &[DVec3]| {
            let polygon = Polygon::new(points.to_vec()).unwrap();
            points
                .iter()
                .map(|p| (polygon.surface(*p, 0).uv * 1e9).round() / 1e9)
                .collect::<Vec<_>>()
        };
        let upright = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(uvs(&flat(&wall)), upright, "facing +Z");
        for degrees in [30.0, 90.0, 180.0, 300.0] {
            let turn = crate::math::rotation(DVec3::Y, degrees);
            assert_eq!(
                uvs(&flat(&wall).iter().map(|p| turn * *p).collect::<Vec<_>>()),
                upright,
                "{degrees}"
            );
        }
        for degrees in [-89.0, -90.0, 45.0] {
            let turn = crate::math::rotation(DVec3::X, degrees);
            assert_eq!(
                uvs(&flat(&wall).iter().map(|p| turn * *p).collect::<Vec<_>>()),
                upright,
                "{degrees}"
            );
        }
    }

    #[test]
    fn repeated_points_are_dropped() {
        let square = [
            [0.0, 0.0],
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.0, 0.0],
        ];
        assert_eq!(Polygon::new(flat(&square)).unwrap().points().len(), 4);
    }

    #[test]
    fn what_is_no_polygon_is_refused_with_the_point_that_is_wrong() {
        assert!(message(&[]).contains("at least 3 different points, not 0"));
        let twice = message(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
        assert!(twice.contains("not 2 of 4"), "{twice}");
        assert!(message(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]).contains("area is 0"));
        assert!(message(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).contains("area is 0"));
        // Names count the points as given, the repeated one too.
        let crossed = message(&[[0.0, 0.0], [0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 1.0]]);
        assert!(
            crossed.contains("from points[0] to points[2] cuts the edge from points[3] to points[4]"),
            "{crossed}"
        );
        let mut bent = flat(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [10.0, 0.0],
            [10.0, 10.0],
            [5.0, 10.0],
            [0.0, 10.0],
        ]);
        bent[4].z = 0.5;
        let error = Polygon::new(bent.clone()).unwrap_err();
        assert!(
            error.message.contains("not flat: points[4] is off its plane by"),
            "{}",
            error.message
        );
        assert!(error.hint.is_some());
        bent[4].z = 5e-4;
        assert!(Polygon::new(bent).is_ok(), "within what typed digits leave");
    }

    #[test]
    fn touching_edges_do_not_cross() {
        let keyhole = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        assert!(Polygon::new(flat(&keyhole)).is_ok(), "a corner on an edge");
        let spike = [
            [0.0, 0.0],
            [4.0, 0.0],
            [9.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
        ];
        assert!(Polygon::new(flat(&spike)).is_ok(), "there and back again");
    }

    #[test]
    fn a_polygon_of_many_points_is_accepted_and_its_one_crossing_found() {
        let n = 20_000;
        let mut rng = Rng::new(54);
        let mut ring: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let phi = f64::from(i) / f64::from(n) * 2.0 * crate::math::PI;
                let r = rng.within(1.0, 1.0001);
                [r * crate::math::cos(phi), r * crate::math::sin(phi)]
            })
            .collect();
        assert!(Polygon::new(flat(&ring)).is_ok());
        ring.swap(7_000, 7_050);
        assert!(message(&ring).contains("crosses itself"));
    }
}
