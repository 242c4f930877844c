use super::{
    super::{
        Crossings,
        suite::{CUBE_FACES, Rng, cube_corner},
    },
    *,
};

fn count(polygon: &Polygon, ray: &Ray) -> usize {
    let mut out = Crossings::default();
    polygon.crossings(ray, &mut out);
    out.as_slice().len()
}

fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
    points.iter().map(|p| DVec2::from(*p).extend(0.0)).collect()
}

fn message(points: &[[f64; 2]]) -> String {
    Polygon::new(flat(points)).unwrap_err().message
}

const DART: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0]];

#[test]
fn concave_corners_are_outside() {
    let dart = Polygon::new(flat(&DART)).unwrap();
    let down = |x: f64, y: f64| count(&dart, &Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z));
    assert_eq!([down(0.9, 0.9), down(2.0, 0.9), down(0.9, 2.0)], [1, 1, 1]);
    assert_eq!([down(1.1, 1.1), down(2.0, 2.0), down(-0.1, 0.0)], [0, 0, 0]);
    assert_eq!(dart.normal(), DVec3::Z);
    assert_eq!(
        Polygon::new(flat(&DART).into_iter().rev().collect())
            .unwrap()
            .normal(),
        DVec3::NEG_Z
    );
}

/// A rectangle cut in two along a jagged line: every ray through it meets exactly one of the halves,
/// also one aimed at the cut's points and edges.
#[test]
fn neighbours_share_their_edge_without_a_gap_or_an_overlap() {
    let mut rng = Rng::new(51);
    for _ in 0..300 {
        let cut: Vec<DVec2> = (0..=10)
            .map(|i| DVec2::new(f64::from(i), rng.within(2.0, 8.0)))
            .collect();
        let below = [DVec2::new(0.0, 0.0), DVec2::new(10.0, 0.0)]
            .into_iter()
            .chain(cut.iter().rev().copied());
        let above = cut
            .iter()
            .copied()
            .chain([DVec2::new(10.0, 10.0), DVec2::new(0.0, 10.0)]);
        let (turn, scale, at) = (rng.rotation(), rng.magnitude(-6.0, 6.0), rng.in_cube());
        // Folded along the cut's first axis or level: the halves need not lie in one plane.
        let fold = if rng.chance(0.5) {
            rng.within(-1.0, 1.0)
        } else {
            0.0
        };
        let straight = if fold == 0.0 { 1.0 } else { 0.0 };
        let place = |p: DVec2| {
            let y = if straight == 0.0 && (p.y > 0.0 && p.y < 10.0) {
                5.0
            } else {
                p.y
            };
            (turn * DVec3::new(p.x, y, fold * (y - 5.0).abs()) + at) * scale
        };
        let halves = [
            Polygon::new(below.map(place).collect()).unwrap(),
            Polygon::new(above.map(place).collect()).unwrap(),
        ];
        for _ in 0..100 {
            let i = 1 + rng.below(9);
            let along = [0.0, 0.5, rng.unit()][rng.below(3)];
            let aim = place(cut[i]).lerp(place(cut[i + usize::from(i < 9)]), along);
            let d = turn * (DVec3::Z + rng.in_cube() * 0.3);
            let origin = aim - d * scale * rng.within(-100.0, 100.0);
            let ray = Ray::new(origin, (aim - origin) * rng.magnitude(-6.0, 6.0));
            let met = halves.iter().map(|half| count(half, &ray)).sum::<usize>();
            assert_eq!(met, 1, "{ray:?} at {halves:?}");
        }
    }
}

/// Of a closed solid of polygons every line meets an even number, from inside one on each side.
#[test]
fn a_solid_of_polygons_is_tight() {
    let mut rng = Rng::new(52);
    for _ in 0..200 {
        let (turn, scale) = (rng.rotation(), rng.magnitude(-6.0, 6.0));
        let place = |p: DVec3| turn * p * scale;
        let solid =
            CUBE_FACES.map(|face| Polygon::new(face.map(|i| place(cube_corner(i))).to_vec()).unwrap());
        for _ in 0..200 {
            let mut corner = || cube_corner(rng.below(8) as u32);
            let (a, b) = (corner(), corner());
            let aim = place(a.lerp(b, [0.0, 0.5, rng.unit()][rng.below(3)]));
            let inner = place(rng.in_cube() * 0.5);
            let ray = Ray::new(inner, (aim - inner) * rng.magnitude(-6.0, 6.0));
            let mut all = Vec::new();
            for face in &solid {
                let mut out = Crossings::default();
                face.crossings(&ray, &mut out);
                all.extend(out.as_slice().iter().map(|c| c.t));
            }
            assert_eq!(all.len(), 2, "{all:?} {ray:?}");
            assert!(all[0] * all[1] < 0.0, "{all:?} {ray:?}");
        }
    }
}

#[test]
fn a_ray_almost_in_the_plane_hits_within_the_outline_or_not_at_all() {
    let mut rng = Rng::new(53);
    let mut met = 0;
    for _ in 0..20_000 {
        let turn = rng.rotation();
        let angle = rng.within(0.0, 6.3);
        let (s, c) = (crate::math::sin(angle), crate::math::cos(angle));
        let bent = if rng.chance(0.5) { 1e-5 } else { 0.0 };
        let bend = |p: &DVec3| turn * (*p + DVec3::Z * if p.y > 2.0 { bent } else { 0.0 });
        let polygon = Polygon::new(flat(&DART).iter().map(bend).collect()).unwrap();
        let lift = if rng.chance(0.3) {
            0.0
        } else {
            rng.magnitude(-18.0, -12.0)
        };
        let d = turn * DVec3::new(c, s, lift);
        let origin = turn * DVec3::new(rng.unit(), rng.unit(), 0.0) - d * rng.within(5.0, 20.0);
        let mut out = Crossings::default();
        polygon.crossings(&Ray::new(origin, d), &mut out);
        for hit in out.as_slice() {
            let p = turn.transpose() * (origin + d * hit.t);
            assert!(p.z.abs() < 1e-10 + bent, "{p}");
            assert!(
                p.x > -1e-9 && p.y > -1e-9 && p.x < 4.0 + 1e-9 && p.y < 4.0 + 1e-9,
                "{p}"
            );
            met += 1;
        }
    }
    assert!(met > 100, "{met}");
}

#[test]
fn uv_spans_the_outline_upright_from_the_front() {
    let wall = [[1.0, 2.0], [5.0, 2.0], [5.0, 4.0], [1.0, 4.0]];
    let uvs = |points: &[DVec3]| {
        let polygon = Polygon::new(points.to_vec()).unwrap();
        points
            .iter()
            .map(|p| (polygon.surface(*p, 0).uv * 1e9).round() / 1e9)
            .collect::<Vec<_>>()
    };
    let upright = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    assert_eq!(uvs(&flat(&wall)), upright, "facing +Z");
    for degrees in [30.0, 90.0, 180.0, 300.0] {
        let turn = crate::math::rotation(DVec3::Y, degrees);
        assert_eq!(
            uvs(&flat(&wall).iter().map(|p| turn * *p).collect::<Vec<_>>()),
            upright,
            "{degrees}"
        );
    }
    for degrees in [-89.0, -90.0, 45.0] {
        let turn = crate::math::rotation(DVec3::X, degrees);
        assert_eq!(
            uvs(&flat(&wall).iter().map(|p| turn * *p).collect::<Vec<_>>()),
            upright,
            "{degrees}"
        );
    }
}

#[test]
fn repeated_points_are_dropped() {
    let square = [
        [0.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [0.0, 0.0],
    ];
    assert_eq!(Polygon::new(flat(&square)).unwrap().points().len(), 4);
}

#[test]
fn what_is_no_polygon_is_refused_with_the_point_that_is_wrong() {
    assert!(message(&[]).contains("at least 3 different points, not 0"));
    let twice = message(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
    assert!(twice.contains("not 2 of 4"), "{twice}");
    assert!(message(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]).contains("area is 0"));
    assert!(message(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).contains("area is 0"));
    // Names count the points as given, the repeated one too.
    let crossed = message(&[[0.0, 0.0], [0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 1.0]]);
    assert!(
        crossed.contains("from points[0] to points[2] cuts the edge from points[3] to points[4]"),
        "{crossed}"
    );
    let mut bent = flat(&[
        [0.0, 0.0],
        [5.0, 0.0],
        [10.0, 0.0],
        [10.0, 10.0],
        [5.0, 10.0],
        [0.0, 10.0],
    ]);
    bent[4].z = 0.5;
    let error = Polygon::new(bent.clone()).unwrap_err();
    assert!(
        error.message.contains("not flat: points[4] is off its plane by"),
        "{}",
        error.message
    );
    assert!(error.hint.is_some());
    bent[4].z = 5e-4;
    assert!(Polygon::new(bent).is_ok(), "within what typed digits leave");
}

#[test]
fn touching_edges_do_not_cross() {
    let keyhole = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
    assert!(Polygon::new(flat(&keyhole)).is_ok(), "a corner on an edge");
    let spike = [
        [0.0, 0.0],
        [4.0, 0.0],
        [9.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
    ];
    assert!(Polygon::new(flat(&spike)).is_ok(), "there and back again");
}

#[test]
fn a_polygon_of_many_points_is_accepted_and_its_one_crossing_found() {
    let n = 20_000;
    let mut rng = Rng::new(54);
    let mut ring: Vec<[f64; 2]> = (0..n)
        .map(|i| {
            let phi = f64::from(i) / f64::from(n) * 2.0 * crate::math::PI;
            let r = rng.within(1.0, 1.0001);
            [r * crate::math::cos(phi), r * crate::math::sin(phi)]
        })
        .collect();
    assert!(Polygon::new(flat(&ring)).is_ok());
    ring.swap(7_000, 7_050);
    assert!(message(&ring).contains("crosses itself"));
}
