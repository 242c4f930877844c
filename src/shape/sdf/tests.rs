//! Intervals against samples, crossings against dense looks at the sign, known solids against their exact crossings.

use super::{interval::Interval, scalar::Slope, *};
use crate::shape::{Crossing, Cuboid, Cylinder, Shape, Sphere, Torus, suite::Rng};

/// Any expression of the coordinates, of all operations that there are.
fn expression(rng: &mut Rng, depth: usize) -> Field {
    if depth == 0 {
        let [x, y, z] = Field::point();
        return match rng.below(4) {
            0 => x,
            1 => y,
            2 => z,
            _ => Field::constant(rng.within(-2.0, 2.0)),
        };
    }
    let mut next = || expression(rng, depth - 1);
    let (a, b) = (next(), next());
    match rng.below(16) {
        0 | 1 => a + b,
        2 => a - b,
        3 | 4 => a * b,
        5 => a / (b.square() + 0.5),
        6 => a.min(&b),
        7 => a.max(&b),
        8 => a.abs(),
        9 => a.sqrt(),
        10 => a.sin(),
        11 => a.cos(),
        12 => a.square() - b,
        13 => a.pow(1.7) - a.hypot(&b),
        14 => Field::noise(&[a, b, Field::point()[0].clone()]),
        _ => a.wrap(0.8, 2.0) + b,
    }
}

/// A solid of several, moved, blended, bent.
fn solid(rng: &mut Rng, depth: usize) -> Sdf {
    if depth == 0 {
        let mut size = || rng.within(0.2, 0.9);
        let made = match (size() * 100.0) as u32 % 7 {
            0 => Sdf::sphere(size()),
            1 => Sdf::cuboid(DVec3::new(size(), size(), size()) * 2.0),
            2 => Sdf::torus(size() + 0.3, size() * 0.5),
            3 => Sdf::cylinder(size(), size() * 2.0),
            4 => Sdf::capsule(DVec3::ZERO, DVec3::new(size(), size(), size()), size()),
            5 => Sdf::cone(size(), size() * 2.0),
            _ => Sdf::ellipsoid(DVec3::new(size(), size(), size())),
        };
        return made.unwrap().moved(rng.in_cube());
    }
    let a = solid(rng, depth - 1);
    let b = solid(rng, depth - 1);
    let k = rng.within(0.05, 0.6);
    match rng.below(14) {
        0 => a.union(&b),
        1 => a.intersection(&b),
        2 | 3 => a.difference(&b),
        4 => a.smooth_union(&b, k).unwrap(),
        5 => a.smooth_difference(&b, k).unwrap(),
        6 => a
            .turned(rng.direction(), rng.within(0.0, 360.0))
            .unwrap()
            .union(&b),
        7 => a.twisted(rng.within(-60.0, 60.0)).unwrap(),
        8 => a.hollowed(k * 0.3).unwrap().difference(&b),
        9 => a.rounded(k * 0.3).unwrap(),
        10 => a.scaled(0.5 + k).unwrap().mirrored(0),
        11 => a.displaced(0.1, 0.4).unwrap(),
        12 => a.bent(rng.within(-40.0, 40.0)).unwrap(),
        _ => a
            .scaled(0.4)
            .unwrap()
            .repeated(DVec3::new(1.5, 0.0, 1.5), Some(1))
            .unwrap(),
    }
}

#[test]
fn intervals_hold_every_value_and_every_slope() {
    let mut rng = Rng::new(11);
    let (mut bounded, mut less) = (0, 0);
    for round in 0..1_000 {
        let field = expression(&mut rng, 1 + round % 4);
        let size = rng.magnitude(-3.0, 0.5);
        let (center, dir) = (rng.in_cube() * 2.0, rng.direction());
        let t = Interval::new(-size, size);
        let at = |o: f64, d: f64| Slope {
            v: Interval::point(o).add(Interval::point(d).mul(t)),
            d: [Interval::point(d)],
        };
        let point = [at(center.x, dir.x), at(center.y, dir.y), at(center.z, dir.z)];
        let tape = Tape::new(&field);
        let mut results = Vec::new();
        let bounds = tape.run(point, &mut results);
        let Slope { v: values, d: [rise] } = bounds;
        let pruned = tape.within(&results);
        bounded += usize::from(values.width() < 100.0);
        less += usize::from(pruned.is_some());
        let mut before: Option<f64> = None;
        for i in 0..=64 {
            let t = size * (f64::from(i) / 32.0 - 1.0);
            let p = center + dir * t;
            let value = field.at(p);
            let again = tape.run(p.to_array(), &mut Vec::new());
            assert_eq!(value.to_bits(), again.to_bits(), "{value} {again}: {field:?}");
            if let Some(pruned) = &pruned {
                let again = pruned.run(p.to_array(), &mut Vec::new());
                assert_eq!(
                    value.to_bits(),
                    again.to_bits(),
                    "{value} {again}: {field:?} as {pruned:?}"
                );
            }
            assert!(
                value.is_nan() || values.contains(value),
                "{value} is beyond {values:?}: {field:?} at {center} + {dir} {t}"
            );
            // Of a continuous field the mean slope is one that there is; with the rounding of both values.
            if let Some(before) = before.filter(|_| rise.width().is_finite()) {
                let mean = (value - before) / (size / 32.0);
                let slack = 1e-9 * (1.0 + rise.lo.abs().max(rise.hi.abs()) + value.abs() / size);
                let widened = Interval::new(rise.lo - slack, rise.hi + slack);
                assert!(
                    mean.is_nan() || widened.contains(mean),
                    "{mean} is beyond {bounds:?}: {field:?}"
                );
            }
            before = Some(value);
        }
    }
    assert!(bounded > 500 && less > 100, "{bounded} {less}");
}

fn prepared(shape: &Isosurface) -> Isosurface {
    let prepared = shape.prepared(1 << 13, &|| false);
    assert!(prepared.cells.is_some());
    prepared
}

fn crossings(shape: &Isosurface, ray: &Ray) -> Vec<Crossing> {
    let mut found = Vec::new();
    shape.crossings(ray, &mut found);
    found
}

#[test]
fn no_change_of_sign_is_missed() {
    let mut rng = Rng::new(12);
    let (mut met, mut lines) = (0, 0);
    for round in 0..60 {
        let sdf = solid(&mut rng, round % 4);
        let plain = sdf.isosurface().unwrap();
        let shape = prepared(&plain);
        let bounds = shape.within();
        for _ in 0..12 {
            let mut within = || rng.within(0.0, 1.0);
            let inner = bounds.min + bounds.size() * DVec3::new(within(), within(), within());
            let dir = rng.direction();
            let ray = Ray::new(inner - dir * 20.0, dir * rng.magnitude(-1.0, 1.0));
            let found = crossings(&shape, &ray);
            assert_eq!(found, crossings(&plain, &ray), "{ray:?} {sdf:?}");
            lines += 1;
            met += found.len();
            assert!(found.len().is_multiple_of(2), "{found:?}");
            assert!(found.is_sorted_by(|a, b| a.t <= b.t), "{found:?}");
            let speed = ray.dir.length();
            for i in 0..1_000 {
                let t = (10.0 + f64::from(i) / 50.0) / speed;
                let p = ray.at(t);
                let is_in_box = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
                let is_inside = is_in_box && sdf.field().at(p) < 0.0;
                let before = found.iter().filter(|crossing| crossing.t < t).count();
                let near = found.iter().any(|crossing| (crossing.t - t).abs() * speed < 1e-9);
                assert!(
                    near || (before % 2 == 1) == is_inside,
                    "{t} {found:?} {ray:?} {sdf:?}"
                );
            }
        }
    }
    assert!(met > lines / 2, "{met} of {lines}");
}

#[test]
fn bounds_hold_all_that_is_inside() {
    let mut rng = Rng::new(13);
    let mut inside = 0;
    for round in 0..100 {
        let sdf = solid(&mut rng, round % 4);
        let bounds = sdf.bounds().unwrap();
        for _ in 0..2_000 {
            let p = rng.in_cube() * 2.5;
            if sdf.field().at(p) < 0.0 {
                inside += 1;
                let is_within = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
                assert!(is_within, "{p} is inside, but not within {bounds:?}: {sdf:?}");
            }
        }
    }
    assert!(inside > 1_000, "{inside}");
}

#[test]
fn known_solids_are_crossed_where_their_formulas_say() {
    let mut rng = Rng::new(14);
    let pairs: Vec<(Sdf, Shape)> = vec![
        (
            Sdf::sphere(0.7).unwrap(),
            Shape::Sphere(Sphere::new(DVec3::ZERO, 0.7).unwrap()),
        ),
        (
            Sdf::cuboid(DVec3::new(1.0, 0.4, 1.7)).unwrap(),
            Shape::Cuboid(Cuboid::new(DVec3::new(1.0, 0.4, 1.7)).unwrap()),
        ),
        (
            Sdf::torus(1.0, 0.3).unwrap(),
            Shape::Torus(Torus::new(1.0, 0.3).unwrap()),
        ),
        (
            Sdf::cylinder(0.5, 1.2).unwrap(),
            Shape::Cylinder(Cylinder::new(0.5, 1.2).unwrap()),
        ),
    ];
    let mut met = 0;
    for (sdf, shape) in pairs {
        let plain = sdf.isosurface().unwrap();
        let prepared = prepared(&plain);
        for round in 0..1_000 {
            let surface = if round % 2 == 0 { &plain } else { &prepared };
            let (target, dir) = (rng.in_cube(), rng.direction());
            let ray = Ray::new(target - dir * 5.0, dir);
            let mut expected = Vec::new();
            shape.crossings(&ray, &mut expected);
            expected.sort_by(|a, b| a.t.total_cmp(&b.t));
            // Grazing lines meet by rounding.
            if expected.windows(2).any(|pair| pair[1].t - pair[0].t < 1e-4) {
                continue;
            }
            let found = crossings(surface, &ray);
            assert_eq!(
                found.len(),
                expected.len(),
                "{found:?} {expected:?} {ray:?} {shape:?}"
            );
            for (found, expected) in found.iter().zip(&expected) {
                assert!(
                    (found.t - expected.t).abs() < 1e-9,
                    "{found:?} {expected:?} {shape:?}"
                );
                let normals = [
                    surface.surface(ray.at(found.t), found.part).normal.normalize(),
                    shape.normal(ray.at(expected.t), expected.part).normalize(),
                ];
                assert!(normals[0].dot(normals[1]) > 1.0 - 1e-6, "{normals:?} {shape:?}");
                met += 1;
            }
        }
    }
    assert!(met > 2_000, "{met}");
}

#[test]
fn a_thin_wall_is_met_by_every_ray() {
    let wall = Sdf::sphere(1.0).unwrap().hollowed(1e-4).unwrap();
    let plain = wall.isosurface().unwrap();
    let prepared = prepared(&plain);
    let mut rng = Rng::new(15);
    for round in 0..2_000 {
        let surface = if round % 2 == 0 { &plain } else { &prepared };
        // Well inside of the ball, so that the wall is met twice from either side.
        let (inner, dir) = (rng.direction() * rng.within(0.0, 0.95), rng.direction());
        let ray = Ray::new(inner - dir * rng.within(2.0, 2_000.0), dir);
        let found = crossings(surface, &ray);
        assert_eq!(found.len(), 4, "{found:?} {ray:?}");
    }
}

#[test]
fn gradients_are_the_slopes() {
    let mut rng = Rng::new(16);
    for round in 0..500 {
        let sdf = solid(&mut rng, round % 3);
        let p = rng.in_cube() * 1.5;
        let step = 1e-6;
        let field = |d: DVec3| sdf.field().at(p + d * step);
        let slope = |d: DVec3| (field(d) - field(-d)) / (2.0 * step);
        let sides = [DVec3::X, DVec3::Y, DVec3::Z];
        let ahead = sides.map(|d| (field(d) - field(DVec3::ZERO)) / step);
        let behind = sides.map(|d| (field(DVec3::ZERO) - field(-d)) / step);
        // Not where two parts meet.
        if ahead.iter().zip(behind).any(|(a, b)| (a - b).abs() > 1e-3) {
            continue;
        }
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut at = p
            .to_array()
            .into_iter()
            .zip(axes)
            .map(|(v, d)| scalar::Gradient { v, d });
        let at = [at.next().unwrap(), at.next().unwrap(), at.next().unwrap()];
        let found = sdf.field().run(at, &mut Vec::new()).d;
        let expected = DVec3::from(sides.map(slope));
        assert!(found.distance(expected) < 1e-3, "{found} {expected} {sdf:?}");
    }
}

#[test]
fn programs_are_read_back_to_the_bit() {
    let mut rng = Rng::new(17);
    for round in 0..300 {
        let field = expression(&mut rng, round % 5);
        let again = Field::from_program(&field.program()).unwrap();
        assert_eq!(field, again);
    }
    for text in [
        "",
        "p3",
        "add 0 1",
        "p0; add 0 1",
        "p0; neg",
        "p0; neg 0 0",
        "p0; sin -1",
        "1 2",
    ] {
        assert!(Field::from_program(text).is_err(), "{text}");
    }
}

#[test]
fn what_is_too_long_or_endless_is_refused() {
    let endless = Sdf::plane().union(&Sdf::sphere(1.0).unwrap());
    let message = endless.isosurface().unwrap_err().message;
    assert!(message.contains("needs bounds"), "{message}");
    assert!(
        endless
            .intersection(&Sdf::sphere(2.0).unwrap())
            .isosurface()
            .is_ok()
    );
    let mut long = Sdf::sphere(1.0).unwrap();
    for i in 1..600 {
        let ball = Sdf::sphere(1.0).unwrap().moved(DVec3::splat(f64::from(i)));
        long = long.union(&ball);
    }
    let message = long.isosurface().unwrap_err().message;
    assert!(message.contains("4096"), "{message}");
    let same = Sdf::sphere(1.0).unwrap();
    assert_eq!(
        same.union(&same).field().len(),
        same.field().len() + 1,
        "what is alike is there once"
    );
}

#[test]
fn what_is_known_beforehand_changes_no_bit() {
    let mut rng = Rng::new(18);
    let (mut met, mut cells) = (0, 0);
    for round in 0..60 {
        let plain = match round % 3 {
            0 => {
                let bounds = Bounds3::new(DVec3::splat(-1.5), DVec3::new(1.5, 1.0, 2.0));
                let field = expression(&mut rng, 1 + round % 4);
                Isosurface::new(field - rng.within(0.1, 0.5), bounds).unwrap()
            }
            _ => solid(&mut rng, round % 5).isosurface().unwrap(),
        };
        let surface = prepared(&plain);
        cells += surface.cells.as_ref().map_or(0, |cells| cells.count());
        let bounds = plain.within();
        for _ in 0..200 {
            let mut within = || rng.within(0.0, 1.0);
            let inner = bounds.min + bounds.size() * DVec3::new(within(), within(), within());
            let dir = match rng.below(8) {
                0 => [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X][rng.below(4)],
                _ => rng.direction(),
            };
            let far = rng.magnitude(-1.0, 2.0);
            let ray = Ray::new(inner - dir * far, dir * rng.magnitude(-2.0, 2.0));
            let (expected, found) = (crossings(&plain, &ray), crossings(&surface, &ray));
            assert_eq!(expected, found, "{ray:?} {:?}", plain.field());
            for Crossing { t, part } in found {
                met += 1;
                let normals = [&plain, &surface].map(|shape| shape.surface(ray.at(t), part).normal);
                assert_eq!(normals[0], normals[1], "{ray:?} {:?}", plain.field());
            }
        }
    }
    assert!(met > 2_000 && cells > 2_000, "{met} {cells}");
}
