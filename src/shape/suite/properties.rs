//! Properties of crossings and surfaces under random rays.

use std::collections::BTreeSet;

use super::{
    super::{Crossings, Shape},
    Rng, for_all,
    reference::{distance, edge_distance},
    samples, shared,
};
use crate::math::{DVec2, DVec3, max_abs};

#[test]
fn every_shape_takes_part() {
    let tested: BTreeSet<_> = samples(1.0).iter().map(Shape::name).collect();
    assert_eq!(tested, Shape::NAMES.iter().copied().collect());
}

#[test]
fn crossings_are_sorted_finite_and_even_for_solids() {
    let mut met = 0;
    for_all(2000, |_, case| met += shared::are_ordered_and_closed(case));
    assert!(met > 100_000, "most rays should meet their shape: {met}");
}

#[test]
fn crossings_lie_on_the_surface_and_in_the_bounds() {
    for_all(2000, |shape, case| {
        shared::are_within_bounds(case);
        for c in &case.found {
            let p = case.ray.at(c.t);
            let d = distance(shape, p).abs();
            // What has no end is met anywhere.
            let endless = if shape.bounds().is_none() {
                2e-15 * max_abs(p)
            } else {
                0.0
            };
            let slack = shared::slack(case) + endless;
            assert!(d <= slack, "off by {d:e}, {} slack: {case}", d / slack);
        }
    });
}

#[test]
fn surfaces_have_a_normal_and_uv_in_the_unit_square() {
    for_all(500, |shape, case| {
        for c in &case.found {
            let surface = shape.surface(case.ray.at(c.t), c.patch.1);
            let n = surface.normal;
            assert!(n.is_finite() && n.length() > 0.0, "{surface:?}: {case}");
            assert_eq!(n, c.normal, "asked for alone: {case}");
            let uv = surface.uv;
            let unit = uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
            assert!(
                unit || matches!(shape, Shape::Plane(_)) && uv.is_finite(),
                "{surface:?}: {case}"
            );
        }
    });
}

#[test]
fn normals_of_solids_point_outwards() {
    let mut checked = 0;
    for_all(1000, |_, case| checked += shared::normals_point_outwards(case));
    assert!(checked > 40_000, "{checked}");
}

#[test]
fn normals_agree_with_finite_differences() {
    let mut checked = 0;
    for_all(500, |_, case| {
        checked += shared::normals_agree_with_finite_differences(case);
    });
    assert!(checked > 10_000, "{checked}");
}

#[test]
fn a_ray_that_starts_on_the_surface_meets_the_rest() {
    let mut checked = 0;
    for_all(500, |_, case| checked += shared::starts_are_left_out(case));
    assert!(checked > 20_000, "{checked}");
}

#[test]
fn the_first_crossing_beyond_a_place_is_found_without_those_after_it() {
    let mut rng = Rng::new(12);
    let mut spared = 0;
    for_all(1000, |shape, case| {
        let (mut all, span) = (
            Crossings::default(),
            case.found.last().map_or(1.0, |met| met.t.abs()),
        );
        shape.crossings(&case.ray, &mut all);
        let places = all
            .as_slice()
            .iter()
            .map(|c| c.t)
            .chain([f64::NEG_INFINITY, 0.0, span * rng.unit()]);
        for place in places.collect::<Vec<_>>() {
            let mut some = Crossings::until_beyond(place);
            shape.crossings(&case.ray, &mut some);
            let first = |crossings: &Crossings| crossings.first_within(place, f64::INFINITY);
            assert_eq!(first(&some), first(&all), "beyond {place}: {case}");
            spared += all.as_slice().len() - some.as_slice().len();
        }
    });
    assert!(spared > 1000, "{spared}");
}

#[test]
fn a_point_is_inside_where_an_odd_number_of_crossings_lies_before_it() {
    let mut rng = Rng::new(11);
    let (mut inside, mut outside) = (0, 0);
    for_all(1000, |_, case| {
        let [within, beside] = shared::sides_change_at_crossings(case, 8, &mut rng);
        inside += within;
        outside += beside;
    });
    assert!(inside > 50_000 && outside > 200_000, "{inside} {outside}");
}

#[test]
fn flat_shapes_are_met_where_the_ray_passes_their_plane_inside_them() {
    let (mut met, mut missed) = (0, 0);
    for_all(2000, |shape, case| {
        let (point, normal) = match shape {
            Shape::Disk(_) | Shape::Plane(_) => (DVec3::ZERO, DVec3::Y),
            Shape::Polygon(polygon) => (polygon.points()[0], polygon.normal()),
            _ => return,
        };
        let ray = &case.ray;
        let t = normal.dot(point - ray.origin) / normal.dot(ray.dir);
        let size = case.subject.extent().0;
        if normal.dot(ray.dir.normalize()).abs() < 1e-3 || max_abs(ray.origin) > 1e3 * size {
            return;
        }
        let p = ray.at(t);
        if edge_distance(shape, p) < 1e-9 * size {
            return;
        }
        let there = distance(shape, p) < 1e-9 * size;
        assert_eq!(case.found.len(), usize::from(there), "{t}: {case}");
        if there { met += 1 } else { missed += 1 }
    });
    assert!(met > 20_000 && missed > 10_000, "{met} {missed}");
}
