//! Outlines of glyphs: curves cut into edges within an error bound, and which contour is a hole of which.

use ttf_parser::OutlineBuilder;

use crate::math::DVec2;

/// A point of a contour, with the directions in which the outline comes and goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) point: DVec2,
    pub(super) coming: DVec2,
    pub(super) going: DVec2,
}

/// A closed outline, no point the same as the next.
pub(super) type Contour = Vec<Node>;

/// Points of a glyph at most.
const MOST_POINTS: usize = 1 << 14;
/// Contours of a glyph at most.
const MOST_CONTOURS: usize = 256;
/// Edges of a curve at most.
const MOST_EDGES: f64 = 64.0;

/// Draws outlines.
pub(super) struct Pen {
    tolerance: f64,
    contours: Vec<Contour>,
    open: Contour,
    at: DVec2,
    points: usize,
}

impl Pen {
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            contours: Vec::new(),
            open: Contour::new(),
            at: DVec2::ZERO,
            points: 0,
        }
    }

    /// The contours; `None` where there is too much of them.
    pub(super) fn finish(mut self) -> Option<Vec<Contour>> {
        self.end();
        (self.points <= MOST_POINTS && self.contours.len() <= MOST_CONTOURS).then_some(self.contours)
    }

    /// An edge from where the pen is, with the directions at its ends.
    fn edge(&mut self, to: DVec2, leaving: DVec2, arriving: DVec2) {
        self.points += 1;
        if to == self.at || self.points > MOST_POINTS {
            return;
        }
        let along = (to - self.at).normalize_or_zero();
        let leaving = leaving.try_normalize().unwrap_or(along);
        let arriving = arriving.try_normalize().unwrap_or(along);
        if let Some(last) = self.open.last_mut() {
            last.going = leaving;
        }
        self.open.push(Node {
            point: to,
            coming: arriving,
            going: arriving,
        });
        self.at = to;
    }

    fn curve(&mut self, control: [DVec2; 4], edges: f64) {
        let edges = if edges.is_finite() {
            edges.ceil().clamp(1.0, MOST_EDGES)
        } else {
            1.0
        };
        let [a, b, c, d] = control;
        let at = |t: f64| {
            let s = 1.0 - t;
            let (ab, bc, cd) = (a * s + b * t, b * s + c * t, c * s + d * t);
            let (abc, bcd) = (ab * s + bc * t, bc * s + cd * t);
            (abc * s + bcd * t, bcd - abc)
        };
        // A control point may stand on the end.
        let start = [b, c, d]
            .into_iter()
            .find(|p| *p != a)
            .map_or(DVec2::ZERO, |p| p - a);
        let end = [c, b, a]
            .into_iter()
            .find(|p| *p != d)
            .map_or(DVec2::ZERO, |p| d - p);
        let mut leaving = start;
        let mut i = 1.0;
        while i < edges {
            let (point, tangent) = at(i / edges);
            self.edge(point, leaving, tangent);
            leaving = tangent;
            i += 1.0;
        }
        self.edge(d, leaving, end);
    }

    fn end(&mut self) {
        let mut contour = std::mem::take(&mut self.open);
        // The point where the pen was put down is the first and, with an edge that leads back to it, the last.
        if let (Some(first), Some(last)) = (contour.first().copied(), contour.last_mut()) {
            if first.point == last.point {
                last.going = first.going;
            } else {
                let along = (first.point - last.point).normalize_or_zero();
                last.going = along;
                contour.push(Node {
                    coming: along,
                    ..first
                });
            }
            contour.remove(0);
        }
        if contour.len() > 2 && area(&contour) != 0.0 {
            self.contours.push(contour);
        }
    }
}

fn vector(x: f32, y: f32) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y))
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.end();
        self.at = vector(x, y);
        self.open.push(Node {
            point: self.at,
            coming: DVec2::ZERO,
            going: DVec2::ZERO,
        });
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = vector(x, y);
        self.edge(to, to - self.at, to - self.at);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (a, b, c) = (self.at, vector(x1, y1), vector(x, y));
        // n chords of a parabola are off by |a - 2b + c| / (4 n^2).
        let edges = ((a - b * 2.0 + c).length() / (4.0 * self.tolerance)).sqrt();
        self.curve([a, (a + b * 2.0) / 3.0, (b * 2.0 + c) / 3.0, c], edges);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let [a, b, c, d] = [self.at, vector(x1, y1), vector(x2, y2), vector(x, y)];
        // The second derivative is at most 6 times the larger of these, and chords are off by 1 / (8 n^2) of it.
        let bend = (a - b * 2.0 + c).length().max((b - c * 2.0 + d).length());
        self.curve([a, b, c, d], (0.75 * bend / self.tolerance).sqrt());
    }

    fn close(&mut self) {
        self.end();
    }
}

/// The area around which a contour runs, positive where it runs counter-clockwise.
pub(super) fn area(contour: &[Node]) -> f64 {
    let next = contour.iter().cycle().skip(1);
    let sum: f64 = contour
        .iter()
        .zip(next)
        .map(|(a, b)| a.point.perp_dot(b.point))
        .sum();
    sum / 2.0
}

/// How often `contour` runs around `p`, counter-clockwise.
fn winding(contour: &[Node], p: DVec2) -> i32 {
    let next = contour.iter().cycle().skip(1);
    let edges = contour.iter().zip(next).map(|(a, b)| (a.point, b.point));
    edges
        .map(|(a, b)| {
            let side = (b - a).perp_dot(p - a);
            if a.y <= p.y && b.y > p.y && side > 0.0 {
                1
            } else if a.y > p.y && b.y <= p.y && side < 0.0 {
                -1
            } else {
                0
            }
        })
        .sum()
}

fn cross(a: &[Node], b: &[Node]) -> bool {
    let bounds = |contour: &[Node]| {
        let points = contour.iter().map(|node| node.point);
        points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        })
    };
    let ((la, ha), (lb, hb)) = (bounds(a), bounds(b));
    if la.x > hb.x || lb.x > ha.x || la.y > hb.y || lb.y > ha.y {
        return false;
    }
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let edges = |contour: &[Node]| -> Vec<(DVec2, DVec2)> {
        let next = contour.iter().cycle().skip(1);
        contour
            .iter()
            .zip(next)
            .map(|(a, b)| (a.point, b.point))
            .collect()
    };
    // Only the edges in the common part of the boxes can.
    let (low, high) = (la.max(lb), ha.min(hb));
    let near = |edge: &(DVec2, DVec2)| {
        let (l, h) = (edge.0.min(edge.1), edge.0.max(edge.1));
        l.x <= high.x && h.x >= low.x && l.y <= high.y && h.y >= low.y
    };
    let of_b: Vec<_> = edges(b).into_iter().filter(near).collect();
    edges(a).into_iter().filter(near).any(|(p, q)| {
        of_b.iter()
            .any(|(r, s)| side(p, q, *r) * side(p, q, *s) < 0.0 && side(*r, *s, p) * side(*r, *s, q) < 0.0)
    })
}

/// A region of a glyph: an outline that runs counter-clockwise, and its holes, which run clockwise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    pub(super) outer: Contour,
    pub(super) holes: Vec<Contour>,
}

fn reversed(mut contour: Contour) -> Contour {
    contour.reverse();
    for node in &mut contour {
        (node.coming, node.going) = (-node.going, -node.coming);
    }
    contour
}

/// The regions that contours enclose by the rule of the winding number: what is inside of others that run the same way
/// adds nothing. Contours that cross each other are solids of their own, one through the other.
pub(super) fn regions(contours: Vec<Contour>) -> Vec<Region> {
    let outside: Vec<i32> = contours
        .iter()
        .enumerate()
        .map(|(i, contour)| {
            let Some(p) = contour.first().map(|node| node.point) else {
                return 0;
            };
            let others = contours.iter().enumerate().filter(|(j, _)| *j != i);
            others
                .filter_map(|(_, other)| match winding(other, p) {
                    0 => None,
                    n => (!cross(contour, other)).then_some(n),
                })
                .sum()
        })
        .collect();
    let mut regions: Vec<Region> = Vec::new();
    let mut holes = Vec::new();
    for (contour, outside) in contours.into_iter().zip(outside) {
        let own = if area(&contour) > 0.0 { 1 } else { -1 };
        if outside == 0 {
            let outer = if own > 0 { contour } else { reversed(contour) };
            regions.push(Region {
                outer,
                holes: Vec::new(),
            });
        } else if outside + own == 0 {
            holes.push(if own < 0 { contour } else { reversed(contour) });
        }
    }
    for hole in holes {
        let Some(p) = hole.first().map(|node| node.point) else {
            continue;
        };
        let around = regions.iter_mut().filter(|region| winding(&region.outer, p) != 0);
        let smallest = around.min_by(|a, b| area(&a.outer).total_cmp(&area(&b.outer)));
        if let Some(region) = smallest {
            region.holes.push(hole);
        }
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f32, high: f32, counter_clockwise: bool) -> Contour {
        let mut corners = vec![(low, low), (high, low), (high, high), (low, high)];
        if !counter_clockwise {
            corners.reverse();
        }
        let mut pen = Pen::new(0.1);
        for (i, (x, y)) in corners.into_iter().enumerate() {
            if i == 0 {
                pen.move_to(x, y)
            } else {
                pen.line_to(x, y)
            }
        }
        pen.close();
        pen.finish().unwrap().remove(0)
    }

    #[test]
    fn nesting_follows_the_winding_number() {
        for flipped in [false, true] {
            let way = |ccw: bool| ccw != flipped;
            let rings = vec![
                square(0.0, 9.0, way(true)),
                square(1.0, 8.0, way(false)),
                square(2.0, 7.0, way(true)),
                // Inside of what is filled already.
                square(3.0, 6.0, way(true)),
                square(20.0, 21.0, way(true)),
            ];
            let regions = regions(rings);
            let shape: Vec<_> = regions.iter().map(|r| (area(&r.outer), r.holes.len())).collect();
            assert_eq!(shape, [(81.0, 1), (25.0, 0), (1.0, 0)]);
            assert_eq!(area(&regions[0].holes[0]), -49.0);
        }
        let crossing = vec![square(0.0, 4.0, true), square(2.0, 6.0, true)];
        assert_eq!(regions(crossing).len(), 2);
    }

    #[test]
    fn curves_are_cut_to_the_error_bound() {
        for tolerance in [0.01, 0.1, 1.0] {
            let mut pen = Pen::new(tolerance);
            pen.move_to(0.0, 0.0);
            pen.quad_to(100.0, 0.0, 100.0, 100.0);
            pen.line_to(0.0, 100.0);
            pen.close();
            let contour = pen.finish().unwrap().remove(0);
            // The curve itself, seen from the contour: x = 200 s - 100 s^2, y = 100 s^2.
            let off = |s: f64| {
                let p = DVec2::new(200.0 * s - 100.0 * s * s, 100.0 * s * s);
                let next = contour.iter().cycle().skip(1);
                let edges = contour.iter().zip(next).map(|(a, b)| (a.point, b.point));
                edges
                    .map(|(a, b)| {
                        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                        (a + (b - a) * t - p).length()
                    })
                    .fold(f64::INFINITY, f64::min)
            };
            let worst = (0..=1000).map(|i| off(f64::from(i) / 1000.0)).fold(0.0, f64::max);
            assert!(worst <= tolerance * 1.0001 && worst > tolerance / 10.0, "{worst}");
            let first = contour.iter().find(|node| node.point == DVec2::ZERO).unwrap();
            assert_eq!((first.coming, first.going), (DVec2::NEG_Y, DVec2::X));
        }
    }
}
