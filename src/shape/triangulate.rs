//! Polygons cut into triangles, for the faces of meshes.

use super::polygon::{flattened, newell, orient};
use crate::math::{Bounds3, DVec2, DVec3, max_abs};

/// Points tried against ears at most; a face that needs more is finished as a fan, so that no file can hang its
/// reader.
const TESTS: usize = 1 << 26;

/// Cuts the polygon `points` into `points.len() - 2` triangles, given as indices in the polygon's orientation.
///
/// Convex polygons become fans around the first point. Concave ones lose one ear after the other (Meisters,
/// "Polygons have ears", 1975), taken from the plane in which the polygon looks largest, so nearly planar faces and
/// holes joined by bridges are right. Where there is no ear left to cut, because the polygon crosses itself or its
/// numbers are not finite, the rest becomes a fan: something is drawn, and no point is lost. Fewer than 3 points
/// give nothing.
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
    /// Points that are not strictly convex: only they can lie in an ear. Holds cut-off ones until it is swept.
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
        // Ears without area come last: their corners are on a line, and cut early they would leave points on the
        // edges of others.
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
