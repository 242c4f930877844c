//! Points in a plane: what polygons and the cutting of polygons share.

use crate::math::{DVec2, DVec3};

/// Pairs of edges compared at most in search of a crossing, so that no input takes longer than a blink.
/// Beyond it the even-odd rule decides what is inside.
const EDGE_PAIRS: usize = 1 << 24;

/// Twice the area of a polygon as a vector along its normal, counter-clockwise being the front (Newell's
/// method; Sutherland, Sproull and Schumacker, 1974). Best with the first point at the origin.
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

/// Two edges that properly cross, each named by its first point. Edges that touch or overlap do not count:
/// bridges to holes do so. Coordinates are expected within [-1, 1]. Sorted by their left ends, edges are
/// compared with those that begin before they end.
#[allow(
    clippy::indexing_slicing,
    reason = "indices count the points, modulo their number"
)]
pub(super) fn crossing_edges(points: &[DVec2]) -> Option<(usize, usize)> {
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
