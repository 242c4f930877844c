use super::{super::suite, *};
use crate::Limits;

fn made(curve: &Curve) -> Mesh {
    curve.mesh(&Allowance::of(&Limits::default())).unwrap()
}

fn random_points(rng: &mut suite::Rng, count: usize) -> Vec<DVec3> {
    (0..count)
        .map(|i| DVec3::new(i as f64 * 2.0, 1.5 * rng.unit(), 1.5 * rng.unit()))
        .collect()
}

#[test]
fn tubes_of_every_kind_are_closed() {
    let mut rng = suite::Rng::new(11);
    for kind in [CurveKind::CatmullRom, CurveKind::Bezier, CurveKind::Linear] {
        for ends in [CurveEnd::Round, CurveEnd::Flat] {
            for is_closed in [false, true] {
                for sides in [3, 4, 13] {
                    let count = if is_closed { 9 } else { 7 };
                    let mut curve = Curve::new(random_points(&mut rng, count), 0.2);
                    if is_closed {
                        for (i, p) in curve.points.iter_mut().enumerate() {
                            let (sin, cos) = math::sin_cos_degrees(40.0 * i as f64);
                            *p = DVec3::new(4.0 * cos, p.y, 4.0 * sin);
                        }
                    }
                    curve.radii.iter_mut().for_each(|r| *r += 0.2 * rng.unit());
                    (curve.kind, curve.ends, curve.is_closed, curve.sides) = (kind, ends, is_closed, sides);
                    let mesh = made(&curve);
                    suite::check_closed(&mesh);
                    suite::check_normals(&mesh, if sides > 4 { 0.2 } else { 0.0 });
                    assert_eq!(
                        mesh.normals.as_ref().unwrap().values.len(),
                        mesh.uvs.as_ref().unwrap().values.len()
                    );
                }
            }
        }
    }
}

#[test]
fn a_straight_tube_is_a_cylinder_and_a_ring_a_torus() {
    let mut rod = Curve::new(vec![DVec3::ZERO, DVec3::X * 5.0], 0.5);
    rod.sides = 64;
    rod.ends = CurveEnd::Flat;
    let share = |volume: f64, exact: f64| 1.0 - volume / exact;
    let less = share(suite::volume(&made(&rod)), math::PI * 0.25 * 5.0);
    assert!(less > 0.0 && less < 0.002, "{less}");
    rod.ends = CurveEnd::Round;
    let less = share(suite::volume(&made(&rod)), math::PI * (0.25 * 5.0 + 0.5 / 3.0));
    assert!(less > 0.0 && less < 0.005, "{less}");
    let corners = (0..16).map(|i| {
        let (sin, cos) = math::sin_cos_degrees(22.5 * f64::from(i));
        DVec3::new(3.0 * cos, 0.0, 3.0 * sin)
    });
    let mut ring = Curve::new(corners.collect(), 0.5);
    (ring.is_closed, ring.sides, ring.tolerance) = (true, 64, Some(0.0005));
    let less = share(
        suite::volume(&made(&ring)),
        2.0 * math::PI * math::PI * 3.0 * 0.25,
    );
    assert!(less.abs() < 0.01, "{less}");
}

#[test]
fn the_middle_is_within_the_tolerance() {
    let mut rng = suite::Rng::new(12);
    for bound in [0.1, 0.01, 0.001] {
        let mut curve = Curve::new(random_points(&mut rng, 6), 0.3);
        (curve.tolerance, curve.sides) = (Some(bound), 8);
        let mesh = made(&curve);
        // The middle of each ring, found again from its corners.
        let rings: Vec<DVec3> = mesh
            .positions
            .chunks(8)
            .map(|ring| ring.iter().sum::<DVec3>() / 8.0)
            .collect();
        let ends: Vec<(DVec3, DVec3)> = rings.windows(2).map(|w| (w[0], w[1])).collect();
        for piece in curve.pieces() {
            for i in 0..=200 {
                let p = piece.at(f64::from(i) / 200.0).point;
                let off = ends.iter().map(|(a, b)| {
                    let t = ((p - *a).dot(*b - *a) / (*b - *a).length_squared()).clamp(0.0, 1.0);
                    (*a + (*b - *a) * t - p).length()
                });
                let off = off.fold(f64::INFINITY, f64::min);
                assert!(off <= bound * 1.01, "{off} for {bound}");
            }
        }
    }
}

#[test]
fn what_is_no_curve_is_refused() {
    let message = |curve: &Curve| {
        curve
            .mesh(&Allowance::of(&Limits::default()))
            .unwrap_err()
            .message
    };
    let mut curve = Curve::new(vec![DVec3::X], 1.0);
    assert_eq!(
        message(&curve),
        "a curve of this kind takes 2 points or more, not 1"
    );
    curve = Curve::new(vec![DVec3::X, DVec3::X, DVec3::Y], 1.0);
    assert_eq!(message(&curve), "points 0 and 1 are the same");
    curve.points[0] = DVec3::Z;
    curve.radii[2] = 0.0;
    assert_eq!(message(&curve), "radius 2 must be greater than 0, not 0");
    curve.radii.pop();
    assert_eq!(
        message(&curve),
        "there are 2 radii for 3 points; expected one for each"
    );
    curve.kind = CurveKind::Bezier;
    assert_eq!(
        message(&curve),
        "a curve of this kind takes 4, 7, 10 ... points, not 3"
    );
}
