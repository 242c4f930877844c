//! Rays and parameters beyond reason.

use super::{
    super::{Capsule, Cone, Cuboid, Cylinder, Disk, Polygon, RoundedBox, Shape, Sphere, Torus},
    Rng, Subject, all_crossings, samples,
    subject::Alone,
};
use crate::math::{DVec3, Ray};

#[test]
fn rays_that_are_none_meet_nothing() {
    for shape in samples(1.0) {
        let inside = Alone {
            shape: &shape,
            s: 1.0,
        }
        .extent()
        .1;
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for i in 0..3 {
                for dir in [DVec3::new(0.3, -0.5, 0.7), DVec3::X, DVec3::Y, DVec3::Z] {
                    let mut origin = inside + DVec3::new(0.1, 0.2, 0.3);
                    let mut bad_dir = dir;
                    bad_dir[i] = bad;
                    let found = all_crossings(&shape, &Ray::new(origin, bad_dir));
                    assert!(found.is_empty(), "direction {bad_dir} on {shape:?}: {found:?}");
                    origin[i] = bad;
                    let found = all_crossings(&shape, &Ray::new(origin, dir));
                    assert!(found.is_empty(), "origin {origin} on {shape:?}: {found:?}");
                }
            }
        }
        for origin in [inside, DVec3::ZERO, DVec3::ONE, DVec3::splat(1e6)] {
            let found = all_crossings(&shape, &Ray::new(origin, DVec3::ZERO));
            assert!(
                found.is_empty(),
                "{origin} without direction on {shape:?}: {found:?}"
            );
        }
    }
}

/// What a ray hits lies in the box around the shape, but for rounding: a tree of boxes would find other hits or not, by
/// chance.
fn assert_hits_lie_in_the_box(shape: &Shape, ray: &Ray) {
    let Some(bounds) = shape.bounds() else { return };
    for c in all_crossings(shape, ray) {
        let p = ray.at(c.t);
        let slack = (ray.origin.abs() + (ray.dir * c.t).abs() + bounds.min.abs() + bounds.max.abs()) * 1e-9;
        let outside = (bounds.min - slack - p).max(p - bounds.max - slack).max_element();
        assert!(outside <= 0.0, "{ray:?} meets {shape:?} at {p}");
    }
}

#[test]
fn shapes_of_absurd_proportions_are_hit_in_their_boxes() {
    let mut rng = Rng::new(11);
    let lengths = [1e-300, 1e-150, 1e-20, 1.0, 1e15].into_iter();
    for (a, b) in lengths.flat_map(|length| [(3.0, length), (length, 3.0)]) {
        let shapes = [
            Cone::new(a, b).ok().map(Shape::Cone),
            Cylinder::new(a, b).ok().map(Shape::Cylinder),
            Disk::new(a).ok().map(Shape::Disk),
            Torus::new(a, b).ok().map(Shape::Torus),
            Capsule::new(a, b).ok().map(Shape::Capsule),
            Cuboid::new(DVec3::new(a, b, a)).ok().map(Shape::Cuboid),
            Cuboid::new(DVec3::new(b, b, a)).ok().map(Shape::Cuboid),
            RoundedBox::new(DVec3::new(a, b, a), 0.1 * a.min(b))
                .ok()
                .map(Shape::RoundedBox),
            Sphere::new(DVec3::ZERO, b).ok().map(Shape::Sphere),
        ];
        for shape in shapes.into_iter().flatten() {
            let size = shape.bounds().map_or(DVec3::ONE, |bounds| bounds.size());
            for _ in 0..2000 {
                let origin = rng.in_cube() * rng.magnitude(-3.0, 3.0);
                let aim = match rng.chance(0.5) {
                    true => rng.in_cube() * size * 0.6 - origin,
                    false => rng.direction(),
                };
                assert_hits_lie_in_the_box(&shape, &Ray::new(origin, aim * rng.magnitude(-20.0, 20.0)));
            }
        }
    }
}

/// As rays are where what is placed was made flat or thin by a matrix.
#[test]
fn rays_stretched_along_an_axis_hit_in_the_box() {
    let mut rng = Rng::new(12);
    for shape in samples(1.0) {
        for i in 0..3000 {
            let mut ray = Ray::new(rng.in_cube() * 3.0, rng.direction());
            let stretch = [1e-150, 1e-20, 1e-9, 1e9, 1e20, 1e150][i % 6];
            let axis = rng.below(3);
            ray.origin[axis] *= stretch;
            ray.dir[axis] *= stretch;
            assert_hits_lie_in_the_box(&shape, &ray);
        }
    }
}

#[test]
fn rays_of_absurd_size_keep_order_and_evenness() {
    let mut rng = Rng::new(5);
    for s in [1e-15, 1.0, 1e14] {
        for shape in samples(s) {
            for _ in 0..2000 {
                let ray = Ray::new(
                    rng.in_cube() * rng.magnitude(-320.0, 308.0),
                    rng.direction() * rng.magnitude(-320.0, 308.0),
                );
                let found = all_crossings(&shape, &ray);
                assert!(
                    found.iter().all(|c| c.t.is_finite()),
                    "{ray:?} on {shape:?}: {found:?}"
                );
                assert!(
                    !shape.is_solid() || found.len().is_multiple_of(2),
                    "{ray:?} on {shape:?}: {found:?}"
                );
                // What overflows on the way to the point has no texture.
                for c in found.iter().filter(|c| ray.at(c.t).is_finite()) {
                    let surface = shape.surface(ray.at(c.t), c.part);
                    assert!(surface.uv.is_finite(), "{ray:?} on {shape:?}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn constructors_refuse_what_is_no_length_and_name_it() {
    let good = 1.0;
    for bad in [
        0.0,
        -0.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1.1e15,
    ] {
        let cases = [
            ("sphere's radius", Sphere::new(DVec3::ZERO, bad).err()),
            ("box's width", Cuboid::new(DVec3::new(bad, good, good)).err()),
            ("box's height", Cuboid::new(DVec3::new(good, bad, good)).err()),
            ("box's depth", Cuboid::new(DVec3::new(good, good, bad)).err()),
            ("cylinder's radius", Cylinder::new(bad, good).err()),
            ("cylinder's height", Cylinder::new(good, bad).err()),
            ("cone's radius", Cone::new(bad, good).err()),
            ("cone's height", Cone::new(good, bad).err()),
            ("disk's radius", Disk::new(bad).err()),
            ("capsule's radius", Capsule::new(bad, good).err()),
            ("capsule's height", Capsule::new(good, bad).err()),
            (
                "rounded box's height",
                RoundedBox::new(DVec3::new(good, bad, good), 0.1).err(),
            ),
            ("rounded box's radius", RoundedBox::new(DVec3::ONE, bad).err()),
            ("torus's major radius", Torus::new(bad, good).err()),
            ("torus's minor radius", Torus::new(good, bad).err()),
        ];
        for (name, error) in cases {
            let message = error.unwrap_or_else(|| panic!("{name} of {bad} passed")).message;
            assert!(message.contains(name), "{message}");
            assert!(message.contains(&bad.to_string()), "{message}");
        }
        if bad.abs() > 1e15 || bad.is_nan() {
            let message = Sphere::new(DVec3::new(0.0, bad, 0.0), 1.0).unwrap_err().message;
            assert!(message.contains("sphere's center"), "{message}");
            let corner = DVec3::new(0.0, bad, 0.0);
            let message = Polygon::new(vec![DVec3::X, corner, DVec3::Z])
                .unwrap_err()
                .message;
            assert!(message.contains("points[1]"), "{message}");
        }
    }
    assert!(Torus::new(1.0, 1.0).is_ok());
    let message = Torus::new(1.0, 1.5).unwrap_err().message;
    assert!(
        message.contains("minor radius") && message.contains("1.5"),
        "{message}"
    );
}
