//! No ray leaks through an edge, a rim, a joint or a tip.

use rayon::prelude::*;

use super::{super::Shape, Rng, Subject, reference::distance, samples, shared::Case, subject::Alone};
use crate::math::{self, DVec2, DVec3, Ray};

/// See [`Subject::edge_point`].
pub(super) fn of_shape(shape: &Shape, rng: &mut Rng) -> DVec3 {
    let center = shape.bounds().map_or(DVec3::ZERO, |b| b.center());
    let half = shape.bounds().map_or(DVec3::ONE, |b| b.size() * 0.5);
    let around = |r: f64, y: f64, rng: &mut Rng| {
        let (s, c) = if rng.chance(0.3) {
            math::sin_cos_degrees(90.0 * rng.below(4) as f64)
        } else {
            math::sin_cos_degrees(rng.within(0.0, 360.0))
        };
        DVec3::new(r * c, y, r * s)
    };
    let sign = |rng: &mut Rng| if rng.chance(0.5) { 1.0 } else { -1.0 };
    match shape {
        Shape::Cylinder(c) => around(c.radius(), 0.5 * c.height() * sign(rng), rng),
        Shape::Cone(c) if rng.chance(0.5) => DVec3::Y * (0.5 * c.height()),
        Shape::Cone(c) => around(c.radius(), -0.5 * c.height(), rng),
        Shape::Capsule(c) => around(c.radius(), (0.5 * c.height() - c.radius()) * sign(rng), rng),
        Shape::RoundedBox(c) => {
            let mut p = c.size() * 0.5 - c.radius();
            p[rng.below(3)] += c.radius();
            p * DVec3::new(sign(rng), sign(rng), sign(rng))
        }
        Shape::Prism(c) => {
            let outline = &c.outlines()[rng.below(c.outlines().len())];
            let [x, z] = outline[rng.below(outline.len())];
            let y = if rng.chance(0.3) {
                0.5 * sign(rng)
            } else {
                rng.within(-0.5, 0.5)
            };
            DVec3::new(x, y * c.height(), z)
        }
        Shape::Lathe(c) => {
            let [r, y] = c.points()[rng.below(c.points().len())];
            around(r, y, rng)
        }
        Shape::SphereSweep(c) => {
            let [x, y, z, r] = c.points()[rng.below(c.points().len())];
            DVec3::new(x, y, z) + rng.direction() * r
        }
        Shape::Superellipsoid(_) => {
            let mut d = rng.direction();
            d[rng.below(3)] = 0.0;
            let d = d.normalize();
            // Half the unit cube, along the direction to the surface.
            let (mut lo, mut hi) = (0.0, 2.0);
            for _ in 0..60 {
                let middle = 0.5 * (lo + hi);
                if distance(shape, d * middle) < 0.0 {
                    lo = middle;
                } else {
                    hi = middle;
                }
            }
            d * lo
        }
        Shape::Torus(t) => around(t.major() + t.minor() * sign(rng), 0.0, rng),
        // Edges and corners of the box around it.
        _ => {
            let mut p = DVec3::new(sign(rng), sign(rng), sign(rng));
            if rng.chance(0.8) {
                p[rng.below(3)] = rng.within(-1.0, 1.0);
            }
            center + half * p
        }
    }
}

/// Points well inside: the deepest of those half way between crossings, which thin things have, too.
pub(crate) fn inner_points(subject: &dyn Subject, rng: &mut Rng) -> Vec<DVec3> {
    let mut deep = Vec::new();
    while deep.len() < 200 {
        let Case { ray, found, .. } = Case::random(subject, rng);
        if let [a, b, ..] = found[..] {
            let p = ray.at(0.5 * (a.t + b.t));
            deep.push((subject.depth(p), p));
        }
    }
    deep.sort_by(|a, b| b.0.total_cmp(&a.0));
    deep.truncate(20);
    assert!(deep[19].0 > 0.0, "{}", subject.label());
    deep.into_iter().map(|(_, p)| p).collect()
}

/// What is wrong with the first of so many lines that leaks, each from a point inside through an edge: a way from outside to the inner point crosses
/// the surface an odd number of times, and so does the way on.
pub(crate) fn leaks(subject: &dyn Subject, inner: &[DVec3], rays: usize, rng: &mut Rng) -> Option<String> {
    for number in 0..rays {
        let (from, to) = (inner[rng.below(inner.len())], subject.edge_point(rng));
        // Often in a plane of the axes, or along one.
        let mut d = to - from;
        if rng.chance(0.1) {
            d[rng.below(3)] = 0.0;
        }
        if d.length() < 1e-9 {
            continue;
        }
        let before = rng.magnitude(-2.0, 2.0) * if rng.chance(0.5) { 1.0 } else { -1.0 };
        let ray = Ray::new(from - d * before, d * rng.magnitude(-3.0, 3.0));
        let at_inner = (from - ray.origin).dot(ray.dir) / ray.dir.length_squared();
        let found = subject.crossings(&ray);
        let (passed, all) = (found.iter().filter(|c| c.t < at_inner).count(), found.len());
        let label = || format!("{from} on {}, {ray:?}: {found:?}", subject.label());
        if passed % 2 == 0 || !all.is_multiple_of(2) {
            return Some(format!("line {number}: {passed} of {all} before {}", label()));
        }
        if !subject.holds(&Ray::new(from, ray.dir)) {
            return Some(format!("line {number}: nothing ahead of {}", label()));
        }
    }
    None
}

/// Many lines through each solid, on all threads.
fn nothing_leaks(rays: usize) {
    let mut rng = Rng::new(51);
    let shapes = samples(1.0);
    let solids: Vec<Alone<'_>> = shapes
        .iter()
        .map(|shape| Alone { shape, s: 1.0 })
        .filter(|solid| solid.is_solid() && solid.bounds().is_some())
        .collect();
    let inner: Vec<Vec<DVec3>> = solids.iter().map(|solid| inner_points(solid, &mut rng)).collect();
    let lines = rays.min(10_000);
    let batches: Vec<(usize, usize)> = (0..rays / lines)
        .flat_map(|batch| (0..solids.len()).map(move |solid| (solid, batch)))
        .collect();
    let found: Vec<String> = batches
        .into_par_iter()
        .filter_map(|(solid, batch)| {
            let mut rng = Rng::new((batch * solids.len() + solid) as u64);
            leaks(&solids[solid], &inner[solid], lines, &mut rng)
        })
        .collect();
    assert!(found.is_empty(), "{} leak, first {}", found.len(), found[0]);
    assert!(solids.len() > 40, "{}", solids.len());
}

#[test]
fn no_line_leaks_through_an_edge() {
    nothing_leaks(400);
}

#[test]
#[ignore = "a million lines through each solid take minutes in a release build"]
fn no_line_of_a_million_leaks_through_an_edge() {
    nothing_leaks(1_000_000);
}

#[test]
fn edge_points_are_on_the_surface() {
    let mut rng = Rng::new(52);
    for shape in samples(1.0) {
        let on_surface = match &shape {
            // The others' are corners of curves, or of the box around them.
            Shape::Cylinder(_)
            | Shape::Cone(_)
            | Shape::Capsule(_)
            | Shape::RoundedBox(_)
            | Shape::Torus(_) => true,
            Shape::Lathe(_) | Shape::Superellipsoid(_) => true,
            _ => false,
        };
        for _ in 0..if on_surface { 50 } else { 0 } {
            let p = of_shape(&shape, &mut rng);
            let is_control =
                matches!(&shape, Shape::Lathe(c) if DVec2::new(p.x, p.z).length() == 0.0 && c.is_closed());
            assert!(is_control || distance(&shape, p).abs() < 1e-9, "{p} on {shape:?}");
        }
    }
}
