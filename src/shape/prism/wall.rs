//! One piece of an outline.

use super::super::roots::{Bernstein, nearest};
use crate::{
    math::{Bounds3, DVec2, DVec3},
    spline::Piece,
};

/// A wall over one piece of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    pub(super) course: Course,
    /// u of its beginning and of its end.
    pub(super) u: [f64; 2],
}

/// The way of a wall in x and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// From the first to the second at even speed.
    Straight([DVec2; 2]),
    /// A cubic Bezier curve.
    Curved([DVec2; 4]),
}

impl Course {
    /// The course of a piece, straight where it was made as a line.
    pub(super) fn new(piece: &Piece<2>) -> Self {
        let [a, .., b] = piece.0;
        if *piece == Piece::line(a, b) {
            Self::Straight([a.into(), b.into()])
        } else {
            Self::Curved(piece.0.map(DVec2::from))
        }
    }

    /// The course with each of its points moved.
    pub(super) fn map(self, place: impl Fn(DVec2) -> DVec2) -> Self {
        match self {
            Self::Straight(ends) => Self::Straight(ends.map(place)),
            Self::Curved(points) => Self::Curved(points.map(place)),
        }
    }

    /// A box around it, at y = 0.
    pub(super) fn bounds(&self) -> Bounds3 {
        let points: &[DVec2] = match self {
            Self::Straight(ends) => ends,
            Self::Curved(points) => points,
        };
        Bounds3::around(points.iter().map(|p| DVec3::new(p.x, 0.0, p.y)))
    }

    /// Tells `found` every place where the line through `o` along the unit vector `d` crosses it: how far along the line,
    /// and whether the course goes from the line's left to its right.
    ///
    /// On which side of the line an end is, is the sign of the same sum for either of the two courses that meet there: both
    /// see the same, so a closed outline is crossed an even number of times.
    #[inline]
    pub(super) fn cross(&self, o: DVec2, d: DVec2, found: &mut impl FnMut(f64, bool)) {
        match self {
            Self::Straight([a, b]) => {
                let (a, b) = (*a - o, *b - o);
                let (left_a, left_b) = (d.perp_dot(a), d.perp_dot(b));
                let falls = left_b < 0.0;
                if (left_a < 0.0) != falls {
                    // One of the two is below 0 and the other is not: the difference is not 0.
                    let u = left_a / (left_a - left_b);
                    found(d.dot(a) * (1.0 - u) + d.dot(b) * u, falls);
                }
            }
            Self::Curved(points) => {
                let off = points.map(|p| p - o);
                Bernstein(off.map(|p| d.perp_dot(p))).sign_changes(&mut |u, falls| {
                    found(Bernstein(off.map(|p| d.dot(p))).at(u).0, falls);
                });
            }
        }
    }

    /// Where in [0, 1] it is nearest to `p`, and its direction there.
    pub(super) fn nearest(&self, p: DVec2) -> (f64, DVec2) {
        match self {
            Self::Straight([a, b]) => {
                let way = *b - *a;
                let square = way.length_squared();
                let at = if square > 0.0 {
                    (p - *a).dot(way) / square
                } else {
                    0.0
                };
                (at.clamp(0.0, 1.0), way)
            }
            Self::Curved(points) => {
                let piece = Piece(points.map(|p| p.to_array()));
                let at = nearest(&piece, p.to_array(), [1.0, 1.0]);
                (at, piece.tangent(at).into())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::super::suite::Rng, *};

    fn crossings(course: &Course, o: DVec2, d: DVec2) -> Vec<(f64, bool)> {
        let mut all = Vec::new();
        course.cross(o, d, &mut |along, falls| all.push((along, falls)));
        all
    }

    fn flat(p: DVec3) -> DVec2 {
        DVec2::new(p.x, p.z)
    }

    #[test]
    fn what_is_straight_is_crossed_where_its_curve_is() {
        let mut rng = Rng::new(91);
        let mut met = 0;
        for _ in 0..20_000 {
            let [a, b, o] = [0; 3].map(|_| flat(rng.in_cube()));
            let d = flat(rng.direction()).normalize();
            let straight = Course::new(&Piece::line(a.to_array(), b.to_array()));
            assert!(matches!(straight, Course::Straight(_)));
            let curve = Course::Curved(Piece::line(a.to_array(), b.to_array()).0.map(DVec2::from));
            let (found, other) = (crossings(&straight, o, d), crossings(&curve, o, d));
            assert_eq!(found.len(), other.len());
            for (x, y) in found.iter().zip(&other) {
                let facing = d.perp_dot(b - a).abs() / (b - a).length();
                assert!((x.0 - y.0).abs() * facing < 2e-15, "{x:?} {y:?}");
                assert_eq!(x.1, y.1);
                let p = o + d * x.0;
                let (at, way) = straight.nearest(p);
                let (nearest, tangent) = curve.nearest(p);
                assert!((at - nearest).abs() * (b - a).length() < 1e-7, "{at} {nearest}");
                assert!(way.distance(tangent) < 1e-14);
                met += 1;
            }
        }
        assert!(met > 3000, "{met}");
    }

    /// Corners on a grid, and lines along it or through its points: every sum that decides is 0 now and then.
    #[test]
    fn closed_outlines_are_crossed_an_even_number_of_times() {
        let mut rng = Rng::new(92);
        let mut on = 0;
        for _ in 0..20_000 {
            let mut grid = || DVec2::new(rng.below(4) as f64, rng.below(4) as f64) * 0.1;
            let corners = [0; 7].map(|_| grid());
            let (o, to) = (grid(), grid());
            let d = (to - o).try_normalize().unwrap_or(DVec2::X);
            let mut count = 0;
            for (i, a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % 7];
                count += crossings(&Course::Straight([*a, b]), o, d).len();
                on += usize::from(d.perp_dot(*a - o) == 0.0);
            }
            assert_eq!(count % 2, 0, "{corners:?}, {o} along {d}");
        }
        assert!(on > 20_000, "{on}");
    }

    #[test]
    fn a_wall_of_no_length_is_not_crossed_and_has_a_nearest_point() {
        let a = DVec2::new(0.3, -0.2);
        let point = Course::Straight([a, a]);
        assert!(crossings(&point, a, DVec2::X).is_empty());
        assert_eq!(point.nearest(DVec2::ONE), (0.0, DVec2::ZERO));
    }
}
