//! Shapes that are another shape: where one is crossed, so is the other.

use std::sync::Arc;

use super::{
    super::{
        Blob, BlobPart, Capsule, Cone, Cuboid, Cylinder, Lathe, Prism, Quadric, RoundedBox, Shape, Sphere,
        SphereSweep, Superellipsoid, Torus,
    },
    Rng, all_crossings,
};
use crate::{
    math::{Bounds3, DVec3, Ray},
    spline::Spline,
};

fn pairs() -> Vec<(Shape, Shape)> {
    let sphere = |r: f64| Shape::Sphere(Sphere::new(DVec3::ZERO, r).unwrap());
    let lathe = |points: &[[f64; 2]], closed: bool| {
        Shape::Lathe(Arc::new(
            Lathe::new(points.to_vec(), Spline::Linear, closed).unwrap(),
        ))
    };
    let prism = |points: &[[f64; 2]], height: f64| {
        Shape::Prism(Arc::new(
            Prism::new(vec![points.to_vec()], Spline::Linear, height).unwrap(),
        ))
    };
    let sweep = |points: &[[f64; 4]]| {
        Shape::SphereSweep(Arc::new(
            SphereSweep::new(points.to_vec(), Spline::Linear).unwrap(),
        ))
    };
    let quadric = |c: [f64; 10], clip: Option<[f64; 3]>| {
        let clip = clip.map(|half| Bounds3::new(-DVec3::from(half), half.into()));
        Shape::Quadric(Arc::new(Quadric::new(c, clip).unwrap()))
    };
    let blob =
        |threshold: f64, part: BlobPart| Shape::Blob(Arc::new(Blob::new(threshold, vec![part]).unwrap()));
    // (1 - d^2)^2 = 0.25 where d^2 = 0.5.
    let density = 0.5f64.sqrt();
    let capsule = |r: f64, h: f64| Shape::Capsule(Capsule::new(r, h).unwrap());
    let cylinder = |r: f64, h: f64| Shape::Cylinder(Cylinder::new(r, h).unwrap());
    vec![
        (
            Shape::Superellipsoid(Superellipsoid::new(1.0, 1.0).unwrap()),
            sphere(0.5),
        ),
        (
            Shape::RoundedBox(RoundedBox::new(DVec3::splat(2.0), 1.0).unwrap()),
            sphere(1.0),
        ),
        (
            Shape::RoundedBox(RoundedBox::new(DVec3::new(1.0, 3.0, 1.0), 0.5).unwrap()),
            capsule(0.5, 3.0),
        ),
        (
            quadric([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.25], None),
            sphere(0.5),
        ),
        (
            quadric(
                [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.25],
                Some([2.0, 1.0, 2.0]),
            ),
            cylinder(0.5, 2.0),
        ),
        // The radius at y is (1 - y) / 4 for a cone of height 2.
        (
            quadric(
                [16.0, -1.0, 16.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, -1.0],
                Some([1.0, 1.0, 1.0]),
            ),
            Shape::Cone(Cone::new(0.5, 2.0).unwrap()),
        ),
        (
            prism(&[[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]], 3.0),
            Shape::Cuboid(Cuboid::new(DVec3::new(2.0, 3.0, 1.0)).unwrap()),
        ),
        (
            lathe(&[[0.0, -1.0], [0.5, -1.0], [0.5, 1.0], [0.0, 1.0]], false),
            cylinder(0.5, 2.0),
        ),
        (
            lathe(&[[0.0, 1.0], [0.5, -1.0], [0.0, -1.0]], true),
            Shape::Cone(Cone::new(0.5, 2.0).unwrap()),
        ),
        (
            sweep(&[[0.0, -1.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]]),
            capsule(0.5, 3.0),
        ),
        (
            sweep(&[[0.0, -1.0, 0.0, 0.5], [0.0, -0.2, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]]),
            capsule(0.5, 3.0),
        ),
        (sweep(&[[0.0, 0.0, 0.0, 0.5], [0.1, 0.2, 0.0, 0.1]]), sphere(0.5)),
        (blob(0.25, BlobPart::ball(DVec3::ZERO, 1.0, 1.0)), sphere(density)),
        (
            blob(0.25, BlobPart::rod(DVec3::NEG_Y, DVec3::Y, 1.0, 1.0)),
            capsule(density, 2.0 + 2.0 * density),
        ),
    ]
}

#[test]
fn a_shape_that_is_another_is_crossed_where_the_other_is() {
    let mut rng = Rng::new(61);
    let mut compared = 0;
    for (shape, other) in pairs() {
        for _ in 0..2000 {
            let mut dir = rng.direction();
            if rng.chance(0.1) {
                dir[rng.below(3)] = 0.0;
            }
            let ray = Ray::new(
                rng.in_cube() - dir * rng.within(0.0, 5.0),
                dir * rng.magnitude(-3.0, 3.0),
            );
            let (found, expected) = (all_crossings(&shape, &ray), all_crossings(&other, &ray));
            let near = 1e-9 / ray.dir.length();
            let touches = |w: &[crate::shape::Crossing]| w.windows(2).any(|w| w[1].t - w[0].t < 1e4 * near);
            if touches(&found) || touches(&expected) {
                continue;
            }
            assert_eq!(found.len(), expected.len(), "{ray:?} on {shape:?} and {other:?}");
            for (a, b) in found.iter().zip(&expected) {
                assert!(
                    (a.t - b.t).abs() < near,
                    "{found:?}, {expected:?}: {ray:?} on {shape:?}"
                );
                let (p, q) = (
                    shape.surface(ray.at(a.t), a.part),
                    other.surface(ray.at(b.t), b.part),
                );
                let off = p.normal.normalize().distance(q.normal.normalize());
                assert!(off < 1e-4, "{} for {}: {ray:?} on {shape:?}", p.normal, q.normal);
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}

/// A torus by many small straight pieces differs by what the chords cut off.
#[test]
fn shapes_of_many_pieces_come_near_what_they_imitate() {
    let n = 1000;
    let circle = |i: usize| crate::math::sin_cos_degrees(360.0 * i as f64 / n as f64);
    let profile: Vec<[f64; 2]> = (0..n)
        .map(circle)
        .map(|(s, c)| [2.0 + 0.5 * c, 0.5 * s])
        .collect();
    let path: Vec<[f64; 4]> = (0..=n)
        .map(circle)
        .map(|(s, c)| [2.0 * c, 0.0, 2.0 * s, 0.5])
        .collect();
    let shapes = [
        Shape::Lathe(Arc::new(Lathe::new(profile, Spline::Linear, true).unwrap())),
        Shape::SphereSweep(Arc::new(SphereSweep::new(path, Spline::Linear).unwrap())),
    ];
    let torus = Shape::Torus(Torus::new(2.0, 0.5).unwrap());
    let mut rng = Rng::new(62);
    let mut compared = 0;
    for _ in 0..1000 {
        let dir = rng.direction();
        let ray = Ray::new(rng.in_cube() * DVec3::new(2.5, 0.5, 2.5) - dir * 3.0, dir);
        let expected = all_crossings(&torus, &ray);
        if expected.windows(2).any(|w| w[1].t - w[0].t < 0.1) {
            continue;
        }
        for shape in &shapes {
            let found = all_crossings(shape, &ray);
            assert_eq!(found.len(), expected.len(), "{ray:?} on {}", shape.name());
            for (a, b) in found.iter().zip(&expected) {
                assert!(
                    (a.t - b.t).abs() < 1e-3,
                    "{} for {}: {ray:?} on {}",
                    a.t,
                    b.t,
                    shape.name()
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}
