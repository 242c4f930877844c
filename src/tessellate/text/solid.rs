//! A region of a glyph as a prism: front, back and walls.

use super::outline::{Node, Region};
use crate::{
    math::{DVec2, DVec3},
    shape::triangulate,
};

/// Cosine of the angle below which edges that meet are one smooth wall: 25 degrees.
const SMOOTH: f64 = 0.906_307_787_036_649_9;

/// A prism in units of the font: front triangles over its points, and what its walls need.
#[derive(Clone, Debug, Default)]
pub(super) struct Prism {
    /// The points of all outlines.
    pub(super) points: Vec<DVec2>,
    /// Front faces, counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Walls: from a point to the next, with the normals at both.
    pub(super) walls: Vec<[(u32, DVec2); 2]>,
}

impl Prism {
    /// Adds a region.
    pub(super) fn add(&mut self, region: &Region) {
        let first = self.points.len();
        let outlines = || std::iter::once(&region.outer).chain(&region.holes);
        self.points.extend(outlines().flatten().map(|node| node.point));
        let mut start = first;
        for outline in outlines() {
            self.walls(outline, start);
            start += outline.len();
        }
        let ring = bridged(region);
        let points: Vec<DVec2> = outlines().flatten().map(|node| node.point).collect();
        let corner = |i: &usize| points.get(*i).copied().unwrap_or_default().extend(0.0);
        let corners: Vec<DVec3> = ring.iter().map(corner).collect();
        let id = |i: usize| (first + ring.get(i).copied().unwrap_or(0)) as u32;
        let triangles = triangulate(&corners).into_iter().map(|t| t.map(id));
        self.triangles.extend(triangles);
    }

    fn walls(&mut self, outline: &[Node], start: usize) {
        let count = outline.len();
        // What lies inside is to the left, so outwards is to the right.
        let outwards = |along: DVec2| DVec2::new(along.y, -along.x);
        let normals: Vec<(DVec2, DVec2)> = outline
            .iter()
            .map(|node| {
                if node.coming.dot(node.going) > SMOOTH {
                    let between = outwards(node.coming + node.going).normalize();
                    (between, between)
                } else {
                    (outwards(node.coming), outwards(node.going))
                }
            })
            .collect();
        let next = (1..count).chain([0]);
        let pairs = normals.iter().zip(normals.iter().cycle().skip(1));
        for ((i, j), ((_, leaving), (arriving, _))) in (0..count).zip(next).zip(pairs) {
            let id = |i: usize| (start + i) as u32;
            self.walls.push([(id(i), *leaving), (id(j), *arriving)]);
        }
    }
}

/// The points of a region as one ring, the holes joined to it by bridges (Eberly, "Triangulation by ear clipping", 1998):
/// from the rightmost point of a hole to a point that can be seen from there, holes from right to left.
fn bridged(region: &Region) -> Vec<usize> {
    let mut points: Vec<DVec2> = region.outer.iter().map(|node| node.point).collect();
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut holes: Vec<(usize, usize, DVec2)> = Vec::new();
    for hole in &region.holes {
        let start = points.len();
        points.extend(hole.iter().map(|node| node.point));
        let rightmost = (0..hole.len()).zip(hole).max_by(|(_, a), (_, b)| {
            let key = |node: &Node| (node.point.x, node.point.y);
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        if let Some((at, node)) = rightmost {
            holes.push((start, at, node.point));
        }
    }
    let lengths: Vec<usize> = region.holes.iter().map(Vec::len).collect();
    let mut order: Vec<usize> = (0..holes.len()).collect();
    let x = |i: usize| holes.get(i).map_or(0.0, |(_, _, p)| p.x);
    order.sort_by(|a, b| x(*b).total_cmp(&x(*a)).then(a.cmp(b)));
    for i in order {
        let (Some((start, at, from)), Some(count)) = (holes.get(i), lengths.get(i)) else {
            continue;
        };
        let to = visible(&points, &ring, *from);
        // To the hole, around it, and back again.
        let around = (0..=*count).map(|k| start + (at + k) % count);
        let back = ring.get(to).copied();
        let inserted: Vec<usize> = around.chain(back).collect();
        ring.splice(to + 1..to + 1, inserted);
    }
    ring
}

/// The place in `ring` of a point that can be seen from `from`, which lies inside.
fn visible(points: &[DVec2], ring: &[usize], from: DVec2) -> usize {
    let point = |i: usize| {
        let id = ring.get(i % ring.len().max(1)).copied().unwrap_or(0);
        points.get(id).copied().unwrap_or_default()
    };
    // The nearest edge to the right, and where it is met.
    let mut nearest: Option<(f64, usize)> = None;
    for i in 0..ring.len() {
        let (a, b) = (point(i), point(i + 1));
        if !(a.y <= from.y && b.y >= from.y && a.y < b.y) {
            // The ring runs counter-clockwise: what lies to the right of a point inside runs upwards.
            continue;
        }
        let x = a.x + (b.x - a.x) * ((from.y - a.y) / (b.y - a.y));
        if x >= from.x && nearest.is_none_or(|(best, _)| x < best) {
            nearest = Some((x, i));
        }
    }
    let Some((x, edge)) = nearest else {
        return 0;
    };
    let met = DVec2::new(x, from.y);
    let (a, b) = (point(edge), point(edge + 1));
    let next = (edge + 1) % ring.len().max(1);
    if met == a {
        return edge;
    }
    if met == b {
        return next;
    }
    let (mut best, end) = if a.x > b.x { (edge, a) } else { (next, b) };
    // Points inside of the triangle would stand in the way; the one nearest in direction does not.
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let mut corners = [from, met, end];
    if side(corners[0], corners[1], corners[2]) < 0.0 {
        corners.swap(1, 2);
    }
    let [c0, c1, c2] = corners;
    let slope = |p: DVec2| ((p.y - from.y) / (p.x - from.x)).abs();
    let mut flattest = slope(end);
    let mut distance = (end - from).length_squared();
    for i in 0..ring.len() {
        let p = point(i);
        if p == end || p.x <= from.x {
            continue;
        }
        let inside = side(c0, c1, p) >= 0.0 && side(c1, c2, p) >= 0.0 && side(c2, c0, p) >= 0.0;
        if !inside {
            continue;
        }
        let (s, d) = (slope(p), (p - from).length_squared());
        if s < flattest || (s == flattest && d < distance) {
            // A point that stands for several places of the ring: the one whose angle holds the way.
            if sees(point(i + ring.len() - 1), p, point(i + 1), from) {
                (best, flattest, distance) = (i, s, d);
            }
        }
    }
    if best == edge || best == next {
        // The end of the edge may stand in the ring more than once, by a bridge: any of its places lies at the edge.
        return best;
    }
    best
}

/// Whether a place of the ring, between its neighbors, has `to` in its inner angle.
fn sees(before: DVec2, at: DVec2, after: DVec2, to: DVec2) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let left_of_coming = side(before, at, to) > 0.0;
    let left_of_going = side(at, after, to) > 0.0;
    if side(before, at, after) >= 0.0 {
        left_of_coming && left_of_going
    } else {
        left_of_coming || left_of_going
    }
}
