//! Shapes under transforms.

use std::sync::Arc;

use super::{
    super::{Cone, Crossing, Cuboid, Cylinder, Disk, Plane, Polygon, Shape, Sphere, Torus},
    Rng, all_crossings, extent, outlines, random_ray,
    reference::edge_distance,
};
use crate::math::{self, DAffine3, DMat3, DVec3, max_abs};

/// Same t, however the shape came to its size and place: by its parameters, or by a matrix under which the
/// ray is seen from a simpler one.
#[test]
fn a_transformed_ray_meets_the_shape_where_the_ray_meets_the_transformed_shape() {
    let mut rng = Rng::new(3);
    let mut checked = 0;
    for _ in 0..20_000 {
        let mut length = || rng.magnitude(-3.0, 3.0);
        let (w, h, d) = (length(), length(), length());
        let at = rng.in_cube() * w;
        let outline = &outlines()[rng.below(3)];
        let points: Vec<DVec3> = outline.iter().map(|p| p.extend(0.0)).collect();
        let any = DAffine3::from_mat3_translation(
            rng.rotation()
                * DMat3::from_diagonal(DVec3::new(w, w * rng.within(0.1, 3.0), w))
                * rng.rotation(),
            at,
        );
        let about_y = DAffine3::from_mat3(math::rotation(DVec3::Y, rng.within(0.0, 360.0)));
        let scaled = |by: DVec3| DAffine3::from_scale(by);
        let moved: Vec<DVec3> = points.iter().map(|p| any.transform_point3(*p)).collect();
        let cases = [
            (
                Shape::Sphere(Sphere::new(at, w).unwrap()),
                Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
                DAffine3::from_translation(at) * scaled(DVec3::splat(w)),
            ),
            (
                Shape::Cuboid(Cuboid::new(DVec3::new(w, h, d)).unwrap()),
                Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap()),
                scaled(DVec3::new(w, h, d)),
            ),
            (
                Shape::Cylinder(Cylinder::new(w, h).unwrap()),
                Shape::Cylinder(Cylinder::new(0.5, 1.0).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Cone(Cone::new(w, h).unwrap()),
                Shape::Cone(Cone::new(0.5, 1.0).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Disk(Disk::new(w).unwrap()),
                Shape::Disk(Disk::new(0.5).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Torus(Torus::new(w, 0.3 * w).unwrap()),
                Shape::Torus(Torus::new(1.0, 0.3).unwrap()),
                about_y * scaled(DVec3::splat(w)),
            ),
            (
                Shape::Plane(Plane),
                Shape::Plane(Plane),
                about_y * scaled(DVec3::new(w, h, d)),
            ),
            (
                Shape::Polygon(Arc::new(Polygon::new(moved).unwrap())),
                Shape::Polygon(Arc::new(Polygon::new(points).unwrap())),
                any,
            ),
        ];
        for (shape, simple, world_from_simple) in cases {
            let ray = random_ray(&shape, w, &mut rng);
            let near = 1e-7 * extent(&shape, w).0 / ray.dir.length();
            let found = all_crossings(&shape, &ray);
            let seen = all_crossings(&simple, &ray.transformed(&world_from_simple.inverse()));
            let grazing = |found: &[Crossing], shape: &Shape| {
                found.windows(2).any(|w| w[1].t - w[0].t < 1e3 * near)
                    || found
                        .iter()
                        .any(|c| edge_distance(shape, ray.at(c.t)) < 1e-6 * extent(shape, w).0)
            };
            if found.len() != seen.len() {
                // Only where the ray all but touches may rounding decide.
                let seen_there = seen.iter().any(|c| {
                    let p = ray.at(c.t);
                    edge_distance(&shape, p) < 1e-6 * extent(&shape, w).0
                });
                assert!(
                    grazing(&found, &shape)
                        || seen_there
                        || seen.windows(2).any(|w| w[1].t - w[0].t < 1e3 * near),
                    "{found:?} but {seen:?}: {ray:?} on {shape:?}"
                );
                continue;
            }
            if grazing(&found, &shape) || max_abs(ray.origin) > 1e3 * extent(&shape, w).0 {
                continue;
            }
            for (a, b) in found.iter().zip(&seen) {
                assert!(
                    (a.t - b.t).abs() < near,
                    "{found:?} but {seen:?}: {ray:?} on {shape:?}"
                );
                assert_eq!(a.part, b.part, "{ray:?} on {shape:?}");
                checked += 1;
            }
        }
    }
    assert!(checked > 50_000, "{checked}");
}
