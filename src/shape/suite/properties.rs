//! Properties of crossings and surfaces under random rays.

use std::collections::BTreeSet;

use super::{
    super::{Crossings, Shape},
    Rng, all_crossings, extent, for_all, is_curved,
    reference::{distance, edge_distance},
    samples,
};
use crate::math::{DVec2, DVec3, Ray, max_abs};

#[test]
fn every_shape_takes_part() {
    let tested: BTreeSet<_> = samples(1.0).iter().map(Shape::name).collect();
    assert_eq!(tested, Shape::NAMES.iter().copied().collect());
}

#[test]
fn crossings_are_sorted_finite_and_even_for_solids() {
    let mut met = 0;
    for_all(2000, |shape, _, _, found, label| {
        assert!(found.is_sorted_by(|a, b| a.t <= b.t), "{label}");
        assert!(found.iter().all(|c| c.t.is_finite()), "{label}");
        assert!(!shape.is_solid() || found.len() % 2 == 0, "{label}");
        met += found.len();
    });
    assert!(met > 100_000, "most rays should meet their shape: {met}");
}

#[test]
fn crossings_lie_on_the_surface_and_in_the_bounds() {
    for_all(2000, |shape, s, ray, found, label| {
        // The point itself is only known to the rounding of the origin it is computed from.
        let (size, center) = extent(shape, s);
        let slack = 2e-15 * (size + max_abs(center) + max_abs(ray.origin));
        for c in found {
            let p = ray.at(c.t);
            let d = distance(shape, p).abs();
            // A curve's point is rounded once more for each of its coordinates and its frame.
            let slack = if is_curved(shape) { 5.0 * slack } else { slack };
            // What has no end is met anywhere.
            let slack = slack
                + if shape.bounds().is_none() {
                    2e-15 * max_abs(p)
                } else {
                    0.0
                };
            assert!(d <= slack, "off by {d:e}, {} slack: {label}", d / slack);
            if let Some(b) = shape.bounds() {
                let outside = (b.min - p).max(p - b.max).max_element();
                assert!(outside <= slack, "outside by {outside:e}: {label}");
            }
        }
    });
}

#[test]
fn surfaces_have_a_normal_and_uv_in_the_unit_square() {
    for_all(500, |shape, _, ray, found, label| {
        for c in found {
            let surface = shape.surface(ray.at(c.t), c.part);
            let n = surface.normal;
            assert!(n.is_finite() && n.length() > 0.0, "{surface:?}: {label}");
            let uv = surface.uv;
            let unit = uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
            assert!(
                unit || matches!(shape, Shape::Plane(_)) && uv.is_finite(),
                "{surface:?}: {label}"
            );
        }
    });
}

#[test]
fn normals_of_solids_point_outwards() {
    let mut checked = 0;
    for_all(1000, |shape, s, ray, found, label| {
        if !shape.is_solid() {
            return;
        }
        for (i, c) in found.iter().enumerate() {
            if edge_distance(shape, ray.at(c.t)) < 1e-9 * extent(shape, s).0 {
                continue;
            }
            let n = shape.surface(ray.at(c.t), c.part).normal.normalize();
            let facing = n.dot(ray.dir.normalize());
            let leaves = i % 2 == 1;
            if facing.abs() > 1e-4 {
                assert_eq!(facing > 0.0, leaves, "{facing}: {label}");
                checked += 1;
            }
        }
    });
    assert!(checked > 40_000, "{checked}");
}

#[test]
fn normals_agree_with_finite_differences() {
    let mut checked = 0;
    for_all(500, |shape, s, ray, found, label| {
        let d = ray.dir.normalize();
        // A step well below the smallest radius of the samples and well above the rounding of the origin.
        let step = 1e-6 * extent(shape, s).0;
        if max_abs(ray.origin) > 100.0 * extent(shape, s).0 {
            return;
        }
        let (e1, e2) = d.any_orthonormal_pair();
        for c in found {
            let p = ray.at(c.t);
            let n = shape.surface(p, c.part).normal.normalize();
            let beside = |e: DVec3| {
                let moved = Ray::new(ray.origin + e * step, ray.dir);
                all_crossings(shape, &moved)
                    .into_iter()
                    .map(|c| (moved.at(c.t), c.part))
                    .filter(|(q, part)| *part == c.part && q.distance(p) < 10.0 * step)
                    .map(|(q, _)| q - p)
                    .next()
            };
            let (Some(a), Some(b)) = (beside(e1), beside(e2)) else {
                continue;
            };
            // The tip of a cone and the center of a closed torus have no tangent plane.
            let pointed = matches!(shape, Shape::Cone(_) | Shape::Torus(_))
                && DVec2::new(p.x, p.z).length() < 1e4 * step;
            let at_an_edge = edge_distance(shape, p) < 1e2 * step;
            if n.dot(d).abs() > 0.3 && !pointed && !at_an_edge {
                let measured = a.cross(b).normalize();
                let off = measured.cross(n).length();
                assert!(off < 2e-2, "{measured} is not {n}, off by {off}: {label}");
                checked += 1;
            }
        }
    });
    assert!(checked > 10_000, "{checked}");
}

#[test]
fn a_ray_that_starts_on_the_surface_meets_the_rest() {
    let mut checked = 0;
    for_all(500, |shape, s, ray, found, label| {
        let per_t = ray.dir.length();
        let size = extent(shape, s).0;
        let near = 1e-6 * size / per_t;
        let apart = found.windows(2).all(|w| w[1].t - w[0].t > 1e3 * near);
        let steep = found.iter().all(|c| {
            let n = shape.surface(ray.at(c.t), c.part).normal.normalize();
            n.dot(ray.dir / per_t).abs() > 1e-2
        });
        // Along an edge or through a rim, the start's rounding decides which side of it the line is.
        let clear = found
            .iter()
            .all(|c| edge_distance(shape, ray.at(c.t)) > 1e-6 * size);
        if !(apart && steep && clear) || max_abs(ray.origin) > 1e3 * size {
            return;
        }
        for (i, start) in found.iter().enumerate() {
            let onwards = Ray::new(ray.at(start.t), ray.dir);
            let mut rest = Crossings::default();
            shape.crossings(&onwards, &mut rest);
            rest.drop_start(near);
            let others: Vec<_> = found
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != i)
                .map(|(_, c)| c)
                .collect();
            assert_eq!(rest.as_slice().len(), others.len(), "{rest:?} from {i}: {label}");
            for (a, b) in rest.as_slice().iter().zip(others) {
                assert!((a.t + start.t - b.t).abs() < near, "{rest:?} from {i}: {label}");
                assert_eq!(a.part, b.part, "{rest:?} from {i}: {label}");
            }
            checked += 1;
        }
    });
    assert!(checked > 20_000, "{checked}");
}

/// No crossing is missing and none is made up: walking along the line, the reference changes sides exactly
/// where crossings are.
#[test]
fn a_point_is_inside_where_an_odd_number_of_crossings_lies_before_it() {
    let mut rng = Rng::new(11);
    let (mut inside, mut outside) = (0, 0);
    for_all(1000, |shape, s, ray, found, label| {
        let (size, center) = extent(shape, s);
        let nearest = (center - ray.origin).dot(ray.dir) / ray.dir.length_squared();
        for _ in 0..if shape.is_solid() { 8 } else { 0 } {
            let t = nearest + rng.within(-2.0, 2.0) * size / ray.dir.length();
            let depth = distance(shape, ray.at(t));
            if depth.abs() < 1e-12 * (size + max_abs(center) + max_abs(ray.origin)) {
                continue;
            }
            let before = found.iter().filter(|c| c.t < t).count();
            assert_eq!(before % 2 == 1, depth < 0.0, "{depth:e} at {t}: {label}");
            if depth < 0.0 { inside += 1 } else { outside += 1 }
        }
    });
    assert!(inside > 50_000 && outside > 200_000, "{inside} {outside}");
}

#[test]
fn flat_shapes_are_met_where_the_ray_passes_their_plane_inside_them() {
    let (mut met, mut missed) = (0, 0);
    for_all(2000, |shape, s, ray, found, label| {
        let (point, normal) = match shape {
            Shape::Disk(_) | Shape::Plane(_) => (DVec3::ZERO, DVec3::Y),
            Shape::Polygon(polygon) => (polygon.points()[0], polygon.normal()),
            _ => return,
        };
        let t = normal.dot(point - ray.origin) / normal.dot(ray.dir);
        let size = extent(shape, s).0;
        if normal.dot(ray.dir.normalize()).abs() < 1e-3 || max_abs(ray.origin) > 1e3 * size {
            return;
        }
        let p = ray.at(t);
        if edge_distance(shape, p) < 1e-9 * size {
            return;
        }
        let there = distance(shape, p) < 1e-9 * size;
        assert_eq!(found.len(), usize::from(there), "{t}: {label}");
        if there { met += 1 } else { missed += 1 }
    });
    assert!(met > 20_000 && missed > 10_000, "{met} {missed}");
}
