//! Shapes by their definitions, in no code of their own, to measure them against.

use super::super::{Plane, Polygon, Shape};
use crate::math::{self, DVec2, DVec3, PI};

/// Distance between a point and a shape's surface, negative inside a solid.
pub(super) fn distance(shape: &Shape, p: DVec3) -> f64 {
    let profile = DVec2::new(DVec2::new(p.x, p.z).length(), p.y);
    // The shapes around Y by their profile to the right of the axis.
    let to_profile = |corners: &[DVec2], inside: bool| {
        let d = corners
            .windows(2)
            .map(|w| {
                let along =
                    ((profile - w[0]).dot(w[1] - w[0]) / (w[1] - w[0]).length_squared()).clamp(0.0, 1.0);
                profile.distance(w[0] + (w[1] - w[0]) * along)
            })
            .fold(f64::INFINITY, f64::min);
        if inside { -d } else { d }
    };
    match shape {
        Shape::Sphere(s) => p.distance(s.center()) - s.radius(),
        Shape::Cuboid(c) => {
            let q = p.abs() - c.size() * 0.5;
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
        }
        Shape::Cylinder(c) => {
            let (r, h) = (c.radius(), c.height() * 0.5);
            let corners = [(0.0, -h), (r, -h), (r, h), (0.0, h)].map(DVec2::from);
            to_profile(&corners, profile.x < r && p.y.abs() < h)
        }
        Shape::Cone(c) => {
            let (r, h) = (c.radius(), c.height() * 0.5);
            let corners = [(0.0, -h), (r, -h), (0.0, h)].map(DVec2::from);
            let inside = p.y > -h && p.y < h && profile.x / r < (h - p.y) / (2.0 * h);
            to_profile(&corners, inside)
        }
        Shape::Disk(d) => to_profile(&[DVec2::ZERO, DVec2::new(d.radius(), 0.0)], false),
        Shape::Torus(t) => profile.distance(DVec2::new(t.major(), 0.0)) - t.minor(),
        Shape::Plane(Plane) => p.y.abs(),
        Shape::Polygon(polygon) => distance_to_polygon(polygon, p),
        // Those among the samples are balls, whose fields are their distances.
        Shape::Isosurface(surface) => surface.field().at(p),
        _ => super::curved::distance(shape, p),
    }
}

/// Inside by the winding angle, elsewhere the distance to the nearest edge.
fn distance_to_polygon(polygon: &Polygon, p: DVec3) -> f64 {
    let (points, n) = (polygon.points(), polygon.normal());
    let height = n.dot(p - points[0]);
    let foot = p - n * height;
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    let turn: f64 = edges
        .map(|(a, b)| {
            let (a, b) = (*a - foot, *b - foot);
            math::atan2(n.dot(a.cross(b)), a.dot(b))
        })
        .sum();
    if turn.abs() > PI {
        return height.abs();
    }
    distance_to_edges(points, p)
}

fn distance_to_edges(points: &[DVec3], p: DVec3) -> f64 {
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    edges
        .map(|(a, b)| {
            let along = ((p - *a).dot(*b - *a) / (*b - *a).length_squared()).clamp(0.0, 1.0);
            p.distance(*a + (*b - *a) * along)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Distance to the nearest edge or rim where parts or sides meet, and how far a surface with a tip is from its axis, which
/// tells how bent it is there; infinite where there is none.
pub(super) fn edge_distance(shape: &Shape, p: DVec3) -> f64 {
    let from_axis = DVec2::new(p.x, p.z).length();
    let ring = |r: f64, y: f64| DVec2::new(DVec2::new(p.x, p.z).length() - r, p.y - y).length();
    match shape {
        Shape::Cuboid(c) => {
            let mut q = (p.abs() - c.size() * 0.5).abs().to_array();
            q.sort_by(f64::total_cmp);
            q[1]
        }
        Shape::Cylinder(c) => ring(c.radius(), c.height() * 0.5).min(ring(c.radius(), -c.height() * 0.5)),
        Shape::Cone(c) => ring(c.radius(), -c.height() * 0.5).min(from_axis),
        Shape::Disk(d) => ring(d.radius(), 0.0),
        Shape::Torus(t) if t.major() == t.minor() => from_axis,
        Shape::Polygon(polygon) => distance_to_edges(polygon.points(), p),
        Shape::Sphere(_) | Shape::Torus(_) | Shape::Plane(_) | Shape::Isosurface(_) => f64::INFINITY,
        _ => super::curved::edge_distance(shape, p),
    }
}
