use super::{super::suite::Rng, *};

#[test]
fn what_is_seen_as_a_line_is_met_where_it_is() {
    // Its corners lie on a line that the ray's line meets behind the ray's origin, where x is 0.
    let corners = [
        &DVec3::new(0.0, 3.0, 0.5),
        &DVec3::new(0.0, 3.5, 0.0),
        &DVec3::new(0.0, 0.5, 3.0),
    ];
    let ray = Ray {
        origin: DVec3::new(0.06000000000000005, 2.1, 1.5),
        dir: DVec3::new(0.5144957554255265, 0.8574929257125441, 0.0),
    };
    let found = TriangleRay::new(&ray).intersect(corners);
    let away = |hit: TriangleHit| (ray.origin + ray.dir * hit.t - DVec3::new(0.0, 2.0, 1.5)).length();
    assert!(found.is_none_or(|hit| away(hit) < 1e-12), "{found:?}");
}

#[test]
fn slivers_are_met_at_the_ray_or_not_at_all() {
    let mut rng = Rng::new(11);
    let mut met = 0;
    for _ in 0..20_000 {
        let [a, b] = [rng.in_cube(), rng.in_cube()];
        let along = |s: f64| a + (b - a) * s;
        let near = rng.in_cube() * [0.0, 1e-17, 1e-13][(rng.unit() * 3.0) as usize];
        let corners = [a, along(rng.unit()) + near, b];
        let aim = along(rng.unit());
        let origin = rng.in_cube() * 4.0;
        let dir = (aim - origin).normalize();
        let ray = TriangleRay::new(&Ray { origin, dir });
        let [a, b, c] = &corners;
        if let Some(hit) = ray.intersect([a, b, c]) {
            met += 1;
            let away = (origin + dir * hit.t - aim).length();
            assert!(away < 1e-4, "{corners:?} {origin} {dir} {hit:?} {away}");
        }
    }
    assert!(met > 100, "{met}");
}

/// A closed convex mesh around the origin.
struct Solid {
    points: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
}

impl Solid {
    fn icosphere(rounds: usize) -> Self {
        let g = 0.5 * (1.0 + 5f64.sqrt());
        let mut points = Vec::new();
        for (x, y) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
            points.extend([
                DVec3::new(0.0, x, y),
                DVec3::new(x, y, 0.0),
                DVec3::new(y, 0.0, x),
            ]);
        }
        let mut triangles = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    let near = |i: usize, j: usize| points[i].distance(points[j]) < 2.1;
                    if near(a, b) && near(b, c) && near(c, a) {
                        triangles.push([a, b, c]);
                    }
                }
            }
        }
        for _ in 0..rounds {
            let mut midpoint = |a: usize, b: usize| {
                let p = (points[a] + points[b]) * 0.5;
                points.iter().position(|q| *q == p).unwrap_or_else(|| {
                    points.push(p);
                    points.len() - 1
                })
            };
            triangles = triangles
                .iter()
                .flat_map(|&[a, b, c]| {
                    let [d, e, f] = [midpoint(a, b), midpoint(b, c), midpoint(c, a)];
                    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
                })
                .collect();
        }
        for p in &mut points {
            *p = p.normalize();
        }
        Self { points, triangles }
    }

    /// A cube whose faces are grids of `n` by `n` squares in two triangles each.
    fn cube(n: usize) -> Self {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let first = points.len();
                for i in 0..=n {
                    for j in 0..=n {
                        let (u, v) = (i as f64 / n as f64 * 2.0 - 1.0, j as f64 / n as f64 * 2.0 - 1.0);
                        let mut p = DVec3::splat(side);
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        points.push(p);
                    }
                }
                for i in 0..n {
                    for j in 0..n {
                        let a = first + i * (n + 1) + j;
                        let (b, c, d) = (a + n + 1, a + n + 2, a + 1);
                        triangles.extend([[a, b, c], [a, c, d]]);
                    }
                }
            }
        }
        Self { points, triangles }
    }

    /// A tetrahedron around the origin, not too flat.
    fn tetrahedron(rng: &mut Rng) -> Self {
        loop {
            let points: Vec<DVec3> = (0..4).map(|_| rng.in_cube()).collect();
            let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
            let depth = triangles.iter().map(|&[a, b, c]: &[usize; 3]| {
                let n = (points[b] - points[a]).cross(points[c] - points[a]).normalize();
                let other = points[6 - a - b - c];
                let (own, others) = (n.dot(points[a]), n.dot(points[a] - other));
                own / others.signum()
            });
            if depth.fold(f64::INFINITY, f64::min) > 1e-3 {
                return Self { points, triangles };
            }
        }
    }

    fn hits(&self, place: impl Fn(DVec3) -> DVec3, ray: &Ray) -> Vec<f64> {
        let test = TriangleRay::new(ray);
        let corners = |t: &[usize; 3]| t.map(|i| place(self.points[i]));
        self.triangles
            .iter()
            .filter_map(|t| {
                let [a, b, c] = corners(t);
                test.intersect([&a, &b, &c]).map(|hit| hit.t)
            })
            .collect()
    }
}

fn solids(rng: &mut Rng) -> Vec<(Solid, usize)> {
    let mut solids = vec![
        (Solid::icosphere(0), 20_000),
        (Solid::icosphere(2), 20_000),
        (Solid::cube(1), 20_000),
        (Solid::cube(5), 20_000),
    ];
    solids.extend((0..400).map(|_| (Solid::tetrahedron(rng), 100)));
    solids
}

/// A corner, the middle of an edge, any point of an edge, or of a face, of a random triangle.
fn target(solid: &Solid, rng: &mut Rng) -> DVec3 {
    let [a, b, c] = solid.triangles[rng.below(solid.triangles.len())].map(|i| solid.points[i]);
    match rng.below(4) {
        0 => a,
        1 => (a + b) * 0.5,
        2 => a + (b - a) * rng.unit(),
        _ => a + (b - a) * rng.unit() * 0.5 + (c - a) * rng.unit() * 0.5,
    }
}

#[test]
fn no_ray_into_a_closed_mesh_slips_through_an_edge_or_a_corner() {
    let mut rng = Rng::new(31);
    for (solid, rays) in solids(&mut rng) {
        for i in 0..rays {
            let scale = rng.magnitude(-6.0, 6.0);
            let at = if rng.chance(0.5) {
                DVec3::ZERO
            } else {
                rng.in_cube() * 10.0 * scale
            };
            let turn = if rng.chance(0.5) {
                crate::math::DMat3::IDENTITY
            } else {
                rng.rotation()
            };
            let place = |p: DVec3| turn * p * scale + at;
            let aim = place(target(&solid, &mut rng));
            // Through the aim to a point well inside.
            let inner = place(rng.in_cube() * 1e-4);
            let origin = aim + (aim - inner) * rng.magnitude(-2.0, 2.0);
            let ray = Ray::new(origin, (aim - origin) * rng.magnitude(-6.0, 6.0));
            let t_aim = (aim - origin).dot(ray.dir) / ray.dir.length_squared();
            let t_inner = (inner - origin).dot(ray.dir) / ray.dir.length_squared();
            let near = 1e-9 * (t_inner - t_aim) + 1e-12 * t_aim;
            let found = solid.hits(place, &ray);
            let entered = found.iter().any(|t| (t - t_aim).abs() < near);
            assert!(entered, "ray {i} enters unseen at {t_aim}: {found:?}: {ray:?}");
            let left = found.iter().any(|&t| t > t_inner);
            assert!(left, "ray {i} leaves unseen: {found:?}: {ray:?}");

            let from_inside = Ray::new(inner, (aim - inner) * rng.magnitude(-6.0, 6.0));
            let found = solid.hits(place, &from_inside);
            assert!(
                found.iter().any(|&t| t > 0.0),
                "ray {i} gets out: {from_inside:?}"
            );
            assert!(
                found.iter().any(|&t| t < 0.0),
                "ray {i} came from nowhere: {from_inside:?}"
            );
        }
    }
}

#[test]
fn the_same_holds_at_the_ends_of_what_numbers_can_be() {
    let mut rng = Rng::new(32);
    let solid = Solid::icosphere(1);
    for scale in [1e-150, 1e-120, 1e120, 1e150] {
        for i in 0..10_000 {
            let place = |p: DVec3| p * scale;
            let inner = place(rng.in_cube() * 1e-2);
            let aim = place(target(&solid, &mut rng));
            let ray = Ray::new(inner, (aim - inner).normalize() * rng.magnitude(-150.0, 150.0));
            let found = solid.hits(place, &ray);
            assert!(
                found.iter().any(|&t| t > 0.0),
                "ray {i} at {scale:e} gets out: {ray:?}"
            );
            for t in found {
                let radius = ray.at(t).length() / scale;
                assert!(
                    (0.7..1.01).contains(&radius),
                    "ray {i} at {scale:e} ends at {radius}"
                );
            }
        }
    }
}

#[test]
fn barycentric_weights_and_t_name_the_same_point() {
    let mut rng = Rng::new(33);
    let mut met = 0;
    for _ in 0..100_000 {
        let scale = rng.magnitude(-6.0, 6.0);
        let [a, b, c] = [0; 3].map(|_| rng.in_cube() * scale);
        let (wb, wc) = (rng.within(-0.2, 1.2), rng.within(-0.2, 1.2));
        let p = a + (b - a) * wb + (c - a) * wc;
        let n = (b - a).cross(c - a) / (scale * scale);
        let d = rng.direction();
        if n.length() < 0.05 || n.normalize().dot(d).abs() < 0.05 {
            continue;
        }
        let ray = Ray::new(
            p - d * scale * rng.within(-10.0, 10.0),
            d * rng.magnitude(-6.0, 6.0),
        );
        let hit = TriangleRay::new(&ray).intersect([&a, &b, &c]);
        let clear = wb.min(wc).min(1.0 - wb - wc);
        if clear.abs() > 1e-10 {
            assert_eq!(hit.is_some(), clear > 0.0, "{wb} {wc} {ray:?} {a} {b} {c}");
        }
        let Some(hit) = hit else { continue };
        met += 1;
        assert!(
            (hit.u - wb).abs() < 1e-11 && (hit.v - wc).abs() < 1e-11,
            "{hit:?}, not {wb} {wc}"
        );
        let by_weights = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
        let off = by_weights.distance(ray.at(hit.t));
        assert!(off < 1e-12 * scale, "{off:e} apart at scale {scale:e}");
    }
    assert!(met > 15_000, "{met}");
}

#[test]
fn both_sides_and_both_directions_count_and_edges_belong_to_it() {
    let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let hit =
        |o: [f64; 3], d: [f64; 3]| TriangleRay::new(&Ray::new(o.into(), d.into())).intersect([&a, &b, &c]);
    let expected = Some(TriangleHit {
        t: 2.0,
        u: 0.25,
        v: 0.5,
    });
    assert_eq!(hit([0.25, 0.5, 4.0], [0.0, 0.0, -2.0]), expected);
    assert_eq!(hit([0.25, 0.5, -4.0], [0.0, 0.0, 2.0]), expected);
    let behind = Some(TriangleHit {
        t: -2.0,
        u: 0.25,
        v: 0.5,
    });
    assert_eq!(hit([0.25, 0.5, 4.0], [0.0, 0.0, 2.0]), behind);
    for corner in [a, b, c, (a + b) * 0.5, (b + c) * 0.5] {
        let o = corner + DVec3::Z;
        assert!(hit(o.to_array(), [0.0, 0.0, -1.0]).is_some(), "{corner}");
    }
    assert!(hit([0.51, 0.5, 4.0], [0.0, 0.0, -2.0]).is_none());
    assert!(hit([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]).is_none(), "in its plane");
}

#[test]
fn degenerate_triangles_and_rays_that_are_none_miss() {
    let ray = Ray::new(DVec3::new(0.0, 0.0, 1.0), DVec3::NEG_Z);
    let test = TriangleRay::new(&ray);
    assert!(test.intersect([&DVec3::ZERO; 3]).is_none(), "a point");
    assert!(
        test.intersect([&-DVec3::X, &DVec3::ZERO, &DVec3::X]).is_none(),
        "a line"
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let [a, b, c] = [-DVec3::X - DVec3::Y, DVec3::X, DVec3::Y];
        assert!(test.intersect([&a, &b, &c]).is_some());
        for i in 0..3 {
            let spoil = |mut v: DVec3| {
                v[i] = bad;
                v
            };
            assert!(test.intersect([&spoil(a), &b, &c]).is_none(), "{bad} in a corner");
            let ray = Ray::new(spoil(ray.origin), ray.dir);
            assert!(
                TriangleRay::new(&ray).intersect([&a, &b, &c]).is_none(),
                "{bad} in the origin"
            );
            let ray = Ray::new(DVec3::Z, spoil(DVec3::NEG_Z));
            assert!(
                TriangleRay::new(&ray).intersect([&a, &b, &c]).is_none(),
                "{bad} in the direction"
            );
        }
        let still = Ray::new(DVec3::ZERO, DVec3::ZERO);
        assert!(TriangleRay::new(&still).intersect([&a, &b, &c]).is_none());
    }
}

#[test]
fn a_triangle_seen_from_its_edge_ends_at_its_corners() {
    let thin = 0.0008151194408677121;
    let points = [
        DVec3::new(0.0, 0.5, 0.0),
        DVec3::new(0.0, -1.5, -2.0),
        DVec3::new(thin, -0.5 + thin, -1.0 + thin),
    ];
    let scale = 1e-12;
    let [a, b, c] = points.map(|p| p * scale);
    let ray = Ray::new(DVec3::new(-0.5, 2.0, 1.5) * scale, DVec3::X);
    assert_eq!(TriangleRay::new(&ray).intersect([&a, &b, &c]), None);
}
