//! Polygons cut into triangles, for the faces of meshes.

#![allow(
    clippy::indexing_slicing,
    reason = "indices are those of corners, which are counted once and taken modulo their number"
)]

use super::planar::{flattened, newell, orient};
use crate::math::{Bounds3, DVec2, DVec3, max_abs};

/// Points looked at in search of ears at most; a face that needs more is finished as a fan, so that no file can hang
/// its reader.
const TESTS: usize = 1 << 26;

/// Cuts the polygon `points` into `points.len() - 2` triangles, given as indices in the polygon's
/// orientation.
///
/// Convex polygons become fans around the first point. Concave ones lose one ear after the other (Meisters,
/// "Polygons have ears", 1975), taken from the plane in which the polygon looks largest, so nearly planar
/// faces and holes joined by bridges are right. Where there is no ear left to cut, because the polygon
/// crosses itself or its numbers are not finite, the rest becomes a fan: something is drawn, and no point is
/// lost. Fewer than 3 points give nothing.
///
/// ```
/// use rtscript::{DVec3, shape::triangulate};
/// let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
/// assert_eq!(triangulate(&square).len(), 2);
/// ```
#[must_use]
pub fn triangulate(points: &[DVec3]) -> Vec<[usize; 3]> {
    let n = points.len();
    let fan = || (2..n).map(|i| [0, i - 1, i]).collect();
    let Some(first) = points.first().filter(|_| n > 3) else {
        return fan();
    };
    let extent = max_abs(Bounds3::around(points.iter().copied()).size());
    let local: Vec<DVec3> = points.iter().map(|p| (*p - *first) / extent).collect();
    let normal = newell(&local);
    if !(normal.is_finite() && normal != DVec3::ZERO) {
        return fan();
    }
    let flat = flattened(&local, normal);
    if flat.windows(2).skip(1).all(|w| orient(flat[0], w[0], w[1]) > 0.0) {
        return fan();
    }
    Clipper::new(&flat).run()
}

/// A ring of the points not cut off yet.
struct Clipper<'a> {
    points: &'a [DVec2],
    next: Vec<usize>,
    prev: Vec<usize>,
    /// Points that are not strictly convex: only they can lie in an ear. Holds cut-off ones until it is
    /// swept.
    reflex: Vec<usize>,
    is_reflex: Vec<bool>,
    left: usize,
    tests: usize,
}

impl<'a> Clipper<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let n = points.len();
        let mut clipper = Self {
            points,
            next: (0..n).map(|i| (i + 1) % n).collect(),
            prev: (0..n).map(|i| (i + n - 1) % n).collect(),
            reflex: Vec::new(),
            is_reflex: vec![false; n],
            left: n,
            tests: 0,
        };
        clipper.reflex = (0..n).filter(|&i| !(clipper.turn(i) > 0.0)).collect();
        for &i in &clipper.reflex {
            clipper.is_reflex[i] = true;
        }
        clipper
    }

    fn run(mut self) -> Vec<[usize; 3]> {
        let mut triangles = Vec::with_capacity(self.left - 2);
        let (mut i, mut tried) = (0, 0);
        // Ears without area come last: their corners are on a line, and cut early they would leave points on
        // the edges of others.
        let mut flat_ears = false;
        while self.left > 3 && self.tests < TESTS {
            if self.is_ear(i, flat_ears) {
                triangles.push([self.prev[i], i, self.next[i]]);
                // Past the neighbour, so that ears are cut all around instead of as one long fan.
                i = self.cut(i);
                (tried, flat_ears) = (0, false);
                continue;
            }
            i = self.next[i];
            tried += 1;
            if tried > self.left {
                if flat_ears {
                    break;
                }
                (tried, flat_ears) = (0, true);
            }
        }
        let (mut b, first) = (self.next[i], i);
        for _ in 2..self.left {
            let c = self.next[b];
            triangles.push([first, b, c]);
            b = c;
        }
        triangles
    }

    /// Positive where the ring turns left at `i`.
    fn turn(&self, i: usize) -> f64 {
        orient(
            self.points[self.prev[i]],
            self.points[i],
            self.points[self.next[i]],
        )
    }

    fn is_ear(&mut self, i: usize, flat: bool) -> bool {
        // Walking along points that are no ears counts too: a million of them in a row would else be walked
        // for every ear.
        self.tests += 1;
        if flat {
            return self.turn(i) == 0.0;
        }
        if self.is_reflex[i] {
            return false;
        }
        let [a, b, c] = [self.prev[i], i, self.next[i]].map(|j| self.points[j]);
        self.tests += self.reflex.len();
        // A corner may stand for several points where a bridge leads to a hole; those do not block it.
        !self.reflex.iter().any(|&j| {
            let p = self.points[j];
            self.is_reflex[j]
                && orient(a, b, p) >= 0.0
                && orient(b, c, p) >= 0.0
                && orient(c, a, p) >= 0.0
                && p != a
                && p != b
                && p != c
        })
    }

    /// Takes `i` out of the ring and returns where to go on.
    fn cut(&mut self, i: usize) -> usize {
        let (a, c) = (self.prev[i], self.next[i]);
        self.next[a] = c;
        self.prev[c] = a;
        self.left -= 1;
        self.is_reflex[i] = false;
        let mut swept = false;
        for j in [a, c] {
            // Cutting an ear never makes a neighbour reflex that was not, but rounding might.
            let reflex = !(self.turn(j) > 0.0);
            if reflex && !self.is_reflex[j] && !self.reflex.contains(&j) {
                self.reflex.push(j);
            }
            swept |= self.is_reflex[j] && !reflex;
            self.is_reflex[j] = reflex;
        }
        if swept {
            let is_reflex = &self.is_reflex;
            self.reflex.retain(|&j| is_reflex[j]);
        }
        self.next[c]
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{
        super::suite::{Rng, outlines},
        *,
    };
    use crate::math::{self, PI};

    /// Checks what holds for every answer: the number of triangles, and that they are joined edge to edge
    /// with the polygon's own edges left over, in its orientation. Returns the triangles.
    fn checked(points: &[DVec3]) -> Vec<[usize; 3]> {
        let n = points.len();
        let triangles = triangulate(points);
        assert_eq!(triangles.len(), n.saturating_sub(2));
        let mut open: BTreeSet<(usize, usize)> = BTreeSet::new();
        for &[a, b, c] in &triangles {
            for (i, j) in [(a, b), (b, c), (c, a)] {
                assert!(i < n && j < n && i != j);
                assert!(
                    open.remove(&(j, i)) || open.insert((i, j)),
                    "{i} {j} twice: {triangles:?}"
                );
            }
        }
        let edges: BTreeSet<_> = (0..n).map(|i| (i, (i + 1) % n)).collect();
        if n > 2 {
            assert_eq!(open, edges);
        }
        triangles
    }

    /// Checks that the triangles do not overlap: none is turned over, and together they have the polygon's
    /// area.
    fn checked_area(points: &[DVec3]) {
        let local: Vec<DVec3> = points.iter().map(|p| *p - points[0]).collect();
        let area = newell(&local);
        let mut sum = 0.0;
        for t in checked(points) {
            let [a, b, c] = t.map(|i| points[i]);
            let part = (b - a).cross(c - a).dot(area.normalize());
            assert!(part >= -1e-12 * area.length(), "{t:?} is turned over by {part}");
            sum += part;
        }
        assert!(
            (sum - area.length()).abs() < 1e-12 * area.length(),
            "{sum} of {area}"
        );
    }

    fn in_every_pose(outline: &[DVec2], rng: &mut Rng) {
        let mut points: Vec<DVec3> = outline.iter().map(|p| p.extend(0.0)).collect();
        checked_area(&points);
        let (turn, scale, at) = (rng.rotation(), rng.magnitude(-6.0, 6.0), rng.in_cube());
        for p in &mut points {
            *p = (turn * *p + at) * scale;
        }
        checked_area(&points);
        points.reverse();
        checked_area(&points);
        let start = rng.below(points.len());
        points.rotate_left(start);
        checked_area(&points);
    }

    #[test]
    fn concave_outlines_and_holes_on_bridges() {
        let mut rng = Rng::new(41);
        for outline in outlines() {
            for _ in 0..50 {
                in_every_pose(&outline, &mut rng);
            }
        }
    }

    #[test]
    fn random_stars_combs_and_spirals() {
        let mut rng = Rng::new(42);
        for _ in 0..500 {
            let n = 4 + rng.below(40);
            let star: Vec<DVec2> = (0..n)
                .map(|i| {
                    let phi = 2.0 * PI * i as f64 / n as f64;
                    DVec2::new(math::cos(phi), math::sin(phi)) * rng.within(0.05, 1.0)
                })
                .collect();
            in_every_pose(&star, &mut rng);
            let comb =
                (0..n).map(|i| DVec2::new(i as f64, if i % 2 == 0 { 0.0 } else { rng.within(1.0, 9.0) }));
            let comb: Vec<DVec2> = comb
                .chain([DVec2::new(n as f64, -1.0), DVec2::new(-1.0, -1.0)])
                .collect();
            in_every_pose(&comb, &mut rng);
            let arm = |i: usize, r: f64| {
                let phi = 0.4 * i as f64;
                DVec2::new(math::cos(phi), math::sin(phi)) * (r + phi)
            };
            let spiral: Vec<DVec2> = (0..n)
                .map(|i| arm(i, 3.0))
                .chain((0..n).rev().map(|i| arm(i, 1.0)))
                .collect();
            in_every_pose(&spiral, &mut rng);
        }
    }

    #[test]
    fn a_quad_is_cut_along_the_diagonal_that_is_inside() {
        let quad = |points: [[f64; 2]; 4]| triangulate(&points.map(|p| DVec2::from(p).extend(0.0)));
        assert_eq!(
            quad([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
            [[0, 1, 2], [0, 2, 3]]
        );
        let dart = quad([[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]);
        assert_eq!(dart, [[0, 1, 2], [0, 2, 3]], "from the reflex corner's opposite");
        let dart = quad([[2.0, 0.0], [0.5, 0.5], [0.0, 2.0], [0.0, 0.0]]);
        assert!(dart.iter().all(|t| t.contains(&1) && t.contains(&3)), "{dart:?}");
    }

    #[test]
    fn points_along_an_edge_leave_no_gap() {
        // A fan from point 0 would cut off a triangle without area and leave point 1 on the edge of another.
        let square = [
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 2.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        let points: Vec<DVec3> = square.iter().map(|p| DVec2::from(*p).extend(0.0)).collect();
        for [a, b, c] in checked(&points) {
            let area = (points[b] - points[a]).cross(points[c] - points[a]).z;
            assert!(area > 0.0, "{a} {b} {c}");
        }
    }

    #[test]
    fn what_is_no_polygon_still_ends() {
        let mut rng = Rng::new(43);
        for n in 0..12 {
            checked(&vec![DVec3::ONE; n]);
            checked(&(0..n).map(|i| DVec3::X * i as f64).collect::<Vec<_>>());
            for bad in [f64::NAN, f64::INFINITY, 1e308, 1e-320] {
                for i in 0..n {
                    let mut points: Vec<DVec3> = (0..n).map(|_| rng.in_cube()).collect();
                    checked(&points);
                    points[i] *= bad;
                    checked(&points);
                    points[n / 2] = points[i];
                    checked(&points);
                    let tiny: Vec<DVec3> = points.iter().map(|p| *p * bad).collect();
                    checked(&tiny);
                }
            }
        }
        let bow_tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        checked(&bow_tie.map(|p| DVec2::from(p).extend(0.0)));
    }

    #[test]
    fn a_face_of_many_points_is_finished() {
        let n = 20_000;
        let comb = (0..n).map(|i| DVec3::new(i as f64, if i % 2 == 0 { 0.0 } else { 1.0 }, 0.0));
        let comb: Vec<DVec3> = comb
            .chain([DVec3::new(n as f64, -1.0, 0.0), DVec3::new(-1.0, -1.0, 0.0)])
            .collect();
        checked(&comb);
        let mut rng = Rng::new(44);
        let tangle: Vec<DVec3> = (0..n).map(|_| rng.in_cube()).collect();
        checked(&tangle);
    }
}
