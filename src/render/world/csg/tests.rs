//! Solids put together at random against the question whether a point is inside of them, asked of each part by itself.

use std::sync::Arc;

use crate::{
    Builder, DVec3, NoHost, RenderOptions, Scene,
    math::{self, Bounds3, DAffine3, DVec2, Ray, max_abs},
    render::{
        render,
        world::{Probe, World},
    },
    scene::{Camera, CsgOp, Mesh, Term, Texture},
    shape::{
        CrossingSink, Crossings, Cuboid, CustomShape, Cylinder, Disk, Plane, Shape, Sphere, Surface, Torus,
        suite::{CUBE_FACES, Rng, cube_corner},
    },
};

#[derive(Clone, Copy, Debug)]
enum Leaf {
    Sphere(f64),
    Cuboid(DVec3),
    /// As a mesh.
    Mesh(DVec3),
    Cylinder(f64, f64),
    Torus(f64, f64),
    Plane,
}

#[derive(Debug)]
enum Tree {
    Leaf(Leaf, DAffine3),
    Op(CsgOp, Vec<Tree>),
    /// An instance of a group.
    Group(Vec<Tree>, DAffine3),
}

/// A box as a mesh whose faces are divided by diagonals.
fn box_mesh(size: DVec3) -> Mesh {
    let triangles = CUBE_FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let corners = (0..8).map(|i| cube_corner(i) * 0.5 * size);
    Mesh::new("box", corners.collect(), triangles.collect()).unwrap()
}

impl Leaf {
    fn contains(&self, p: DVec3) -> bool {
        match *self {
            Self::Sphere(r) => p.length() < r,
            Self::Cuboid(size) | Self::Mesh(size) => max_abs(p / size) < 0.5,
            Self::Cylinder(r, h) => p.y.abs() < h * 0.5 && p.x * p.x + p.z * p.z < r * r,
            Self::Torus(major, minor) => {
                let around = (p.x * p.x + p.z * p.z).sqrt() - major;
                around * around + p.y * p.y < minor * minor
            }
            Self::Plane => p.y < 0.0,
        }
    }

    fn put(&self, b: &mut Builder) {
        match *self {
            Self::Sphere(r) => b.sphere(DVec3::ZERO, r),
            Self::Cuboid(size) => b.shape(Shape::Cuboid(Cuboid::new(size).unwrap())),
            Self::Mesh(size) => b.mesh(&Arc::new(box_mesh(size))),
            Self::Cylinder(r, h) => b.shape(Shape::Cylinder(Cylinder::new(r, h).unwrap())),
            Self::Torus(r, s) => b.shape(Shape::Torus(Torus::new(r, s).unwrap())),
            Self::Plane => b.shape(Shape::Plane(Plane)),
        }
        .unwrap();
    }
}

fn rows(m: &DAffine3) -> [f64; 16] {
    let (a, t) = (m.matrix3, m.translation);
    let row = |i: usize| [a.row(i).x, a.row(i).y, a.row(i).z, t[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
        .concat()
        .try_into()
        .unwrap()
}

impl Tree {
    fn contains(&self, p: DVec3) -> bool {
        let within = |m: &DAffine3| m.inverse().transform_point3(p);
        match self {
            Self::Leaf(leaf, m) => leaf.contains(within(m)),
            Self::Group(parts, m) => {
                let p = within(m);
                parts.iter().any(|part| part.contains(p))
            }
            Self::Op(CsgOp::Union, parts) => parts.iter().any(|part| part.contains(p)),
            Self::Op(CsgOp::Intersection, parts) => parts.iter().all(|part| part.contains(p)),
            Self::Op(CsgOp::Difference, parts) => {
                parts[0].contains(p) && !parts[1..].iter().any(|part| part.contains(p))
            }
        }
    }

    /// Something of its own color for each part, glass where asked for.
    fn put(&self, b: &mut Builder, made: &mut u32, glass: bool) {
        match self {
            Self::Leaf(leaf, m) => {
                *made += 1;
                let shade = f64::from(*made % 7 + 1) / 9.0;
                b.material_mut().diffuse = Term::color(DVec3::new(shade, 0.5, 1.0 - shade));
                if glass && !made.is_multiple_of(4) {
                    b.material_mut().transmission = Term::color(DVec3::new(0.9, shade, 0.8));
                }
                b.push_transform().unwrap();
                b.mult_matrix(&rows(m)).unwrap();
                leaf.put(b);
                b.pop_transform().unwrap();
            }
            Self::Op(op, parts) => {
                let mark = b.begin_csg(*op).unwrap();
                parts.iter().for_each(|part| part.put(b, made, glass));
                b.end_csg(mark, true).unwrap();
            }
            Self::Group(parts, m) => {
                *made += 1;
                let name = format!("g{made}");
                let mark = b.begin_define(&name).unwrap();
                parts.iter().for_each(|part| part.put(b, made, glass));
                b.end_define(mark, true);
                b.push_transform().unwrap();
                b.mult_matrix(&rows(m)).unwrap();
                b.instance(&name).unwrap();
                b.pop_transform().unwrap();
            }
        }
    }

    fn scene(&self, glass: bool) -> Scene {
        let mut b = Builder::new();
        let whole = b.begin_csg(CsgOp::Union).unwrap();
        self.put(&mut b, &mut 0, glass);
        b.end_csg(whole, true).unwrap();
        b.finish().value
    }
}

/// Anywhere, turned and stretched; or along the axes by steps, so that faces coincide.
fn placing(rng: &mut Rng, on_grid: bool) -> DAffine3 {
    if on_grid {
        let steps = DVec3::new(rng.below(5) as f64, rng.below(5) as f64, rng.below(5) as f64);
        return DAffine3::from_translation(steps * 0.5 - 1.0);
    }
    let turn = math::rotation(rng.direction(), rng.within(0.0, 360.0));
    let stretch = DVec3::new(rng.within(0.4, 1.6), rng.within(0.4, 1.6), rng.within(-1.6, -0.4));
    let m = DAffine3::from_mat3_translation(turn, rng.in_cube() * 1.2);
    if rng.below(2) == 0 {
        m
    } else {
        m * DAffine3::from_scale(stretch)
    }
}

fn leaf(rng: &mut Rng, on_grid: bool) -> Leaf {
    if on_grid {
        let size = |rng: &mut Rng| 0.5 * (1 + rng.below(4)) as f64;
        let size = DVec3::new(size(rng), size(rng), size(rng));
        return match rng.below(5) {
            0 => Leaf::Mesh(size),
            1 => Leaf::Cylinder(size.x * 0.5, size.y),
            _ => Leaf::Cuboid(size),
        };
    }
    match rng.below(7) {
        0 | 1 => Leaf::Sphere(rng.within(0.3, 1.5)),
        2 => Leaf::Cuboid(DVec3::new(
            rng.within(0.3, 2.5),
            rng.within(0.3, 2.5),
            rng.within(0.3, 2.5),
        )),
        3 => Leaf::Mesh(DVec3::new(
            rng.within(0.3, 2.5),
            rng.within(0.3, 2.5),
            rng.within(0.3, 2.5),
        )),
        4 => Leaf::Cylinder(rng.within(0.2, 1.0), rng.within(0.3, 3.0)),
        5 => Leaf::Torus(rng.within(0.7, 1.2), rng.within(0.1, 0.6)),
        _ => Leaf::Plane,
    }
}

fn tree(rng: &mut Rng, depth: usize, on_grid: bool) -> Tree {
    let kind = rng.below(5);
    if depth == 0 || kind == 0 {
        return Tree::Leaf(leaf(rng, on_grid), placing(rng, on_grid));
    }
    let parts = (0..1 + rng.below(4))
        .map(|_| tree(rng, depth - 1, on_grid))
        .collect();
    match kind {
        1 => Tree::Group(parts, placing(rng, on_grid)),
        2 => Tree::Op(CsgOp::Union, parts),
        3 => Tree::Op(CsgOp::Intersection, parts),
        _ => Tree::Op(CsgOp::Difference, parts),
    }
}

/// The crossings of a ray, from surface to surface, and whether each enters.
fn crossings(world: &World<'_>, ray: &Ray) -> Vec<(f64, bool)> {
    let mut found = Vec::new();
    let (mut probe, mut passed) = (Probe::from_space(*ray), 0.0);
    while let Some(hit) = world.nearest(&probe, f64::INFINITY) {
        let at = world.surface(&hit, &probe.ray).unwrap();
        passed += hit.t;
        found.push((passed, at.from_front));
        assert!(found.len() < 1000, "no end");
        probe = Probe::from_surface(Ray::new(at.position, ray.dir), hit.number, at.scale);
    }
    found
}

/// The middle of every span is inside and looks back at fronts, that of every gap is outside.
fn check(tree: &Tree, world: &World<'_>, ray: &Ray) -> usize {
    let found = crossings(world, ray);
    let mut from = 0.0;
    let mut inside = tree.contains(ray.origin);
    for (i, &(t, enters)) in found.iter().enumerate() {
        assert_eq!(
            enters, !inside,
            "crossing {i} of {found:?} of {ray:?} in {tree:?}"
        );
        if t - from > 1e-6 {
            // Not quite: just there two faces may be joined.
            let middle = ray.at(from + (t - from) * 0.4142);
            assert_eq!(
                tree.contains(middle),
                inside,
                "before {i} of {found:?}, {ray:?}, {tree:?}"
            );
        }
        (from, inside) = (t, !inside);
    }
    for beyond in [1e-3, 1.0371, 50.0] {
        let p = ray.at(from + beyond);
        assert_eq!(
            tree.contains(p),
            inside,
            "{beyond} beyond {found:?}, {ray:?}, {tree:?}"
        );
    }
    found.len()
}

#[test]
fn spans_are_where_the_points_inside_are() {
    let mut rng = Rng::new(1);
    let mut met = 0;
    for _ in 0..400 {
        let tree = tree(&mut rng, 3, false);
        let scene = tree.scene(false);
        let world = World::compile(&scene).unwrap();
        for _ in 0..40 {
            let ray = Ray::new(rng.in_cube() * 5.0, rng.direction());
            met += check(&tree, &world, &ray);
        }
    }
    assert!(met > 2_000, "{met}");
}

#[test]
fn faces_that_coincide_leave_neither_films_nor_walls() {
    let mut rng = Rng::new(77);
    let mut met = 0;
    for _ in 0..400 {
        let tree = tree(&mut rng, 3, true);
        let scene = tree.scene(false);
        let world = World::compile(&scene).unwrap();
        for i in 0..40 {
            // Along the axes between the steps, where faces are met head on, and anywhere.
            let axis = [DVec3::X, DVec3::Y, DVec3::Z][i % 3];
            let dir = if i % 2 == 0 { axis } else { rng.direction() };
            let ray = Ray::new((rng.in_cube() * 1.5) - dir * 7.0, dir);
            met += check(&tree, &world, &ray);
            let found = crossings(&world, &ray);
            let thin = found.windows(2).find(|pair| pair[1].0 - pair[0].0 < 1e-9);
            assert_eq!(thin, None, "{found:?} {ray:?} {tree:?}");
        }
    }
    assert!(met > 2_000, "{met}");
}

#[test]
fn a_mesh_counts_once_through_its_edges_and_corners() {
    let cube = Tree::Op(
        CsgOp::Intersection,
        vec![
            Tree::Leaf(Leaf::Mesh(DVec3::splat(2.0)), DAffine3::IDENTITY),
            Tree::Leaf(Leaf::Sphere(9.0), DAffine3::IDENTITY),
        ],
    );
    let scene = cube.scene(false);
    let world = World::compile(&scene).unwrap();
    let mut met = 0;
    for i in 0..9i32.pow(4) {
        let step = |k: u32| f64::from(i / 9i32.pow(k) % 9 - 4) * 0.25;
        let (from, to) = (
            DVec3::new(step(0), step(1), -3.0),
            DVec3::new(step(2), step(3), 1.0),
        );
        let found = crossings(&world, &Ray::new(from, (to - from).normalize()));
        assert!(found.len().is_multiple_of(2), "{from} {to} {found:?}");
        // Through the middle of the face that is met last, so the cube is certainly entered.
        if step(2).abs() < 1.0 && step(3).abs() < 1.0 {
            assert_eq!(found.len(), 2, "{from} {to} {found:?}");
        }
        met += found.len();
    }
    assert!(met > 9_000, "{met}");
}

#[test]
fn a_mesh_that_is_placed_several_times_is_a_part_as_any_other() {
    let put = |b: &mut Builder, shared: bool| {
        let mesh = Arc::new(box_mesh(DVec3::splat(1.0)));
        let cuboid = || Shape::Cuboid(Cuboid::new(DVec3::splat(1.0)).unwrap());
        let mark = b.begin_csg(CsgOp::Difference).unwrap();
        for at in [
            DVec3::ZERO,
            DVec3::new(0.3, 0.4, 0.2),
            DVec3::new(-0.3, -0.7, 0.1),
        ] {
            b.push_transform().unwrap();
            b.translate(at).unwrap();
            b.rotate(DVec3::ONE, 20.0).unwrap();
            match shared {
                true => b.mesh(&mesh).unwrap(),
                false => b.shape(cuboid()).unwrap(),
            }
            b.pop_transform().unwrap();
        }
        b.end_csg(mark, true).unwrap();
    };
    let scenes = [true, false].map(|shared| {
        let mut b = Builder::new();
        put(&mut b, shared);
        b.finish().value
    });
    let [meshes, cuboids] = scenes.each_ref().map(|scene| World::compile(scene).unwrap());
    let (mut rng, mut met) = (Rng::new(9), 0);
    for _ in 0..3_000 {
        let dir = rng.direction();
        let ray = Ray::new((rng.in_cube() * 0.6) - dir * 3.0, dir);
        let [a, b] = [&meshes, &cuboids].map(|world| crossings(world, &ray));
        assert_eq!(a.len(), b.len(), "{a:?} {b:?} {ray:?}");
        for (a, b) in a.iter().zip(&b) {
            assert!((a.0 - b.0).abs() < 1e-9 && a.1 == b.1, "{a:?} {b:?} {ray:?}");
            met += 1;
        }
    }
    assert!(met > 3_000, "{met}");
}

#[test]
fn solids_nest_as_deep_as_groups_do() {
    let nested = |depth: usize| {
        let mut b = Builder::new();
        let marks: Vec<_> = (0..depth).map(|_| b.begin_csg(CsgOp::Union).unwrap()).collect();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        for mark in marks.into_iter().rev() {
            b.end_csg(mark, true).unwrap();
        }
        b.finish().value
    };
    let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    let deep = nested(32);
    assert_eq!(
        World::compile(&deep).unwrap().nearest_t(&ray, 9.0),
        Some((4.0, 0))
    );
    let error = World::compile(&nested(33)).unwrap_err().to_string();
    assert!(error.contains("more than 32 levels deep"), "{error}");
}

#[test]
fn light_through_glass_is_what_comes_from_surface_to_surface() {
    let mut rng = Rng::new(5);
    let mut tinted = 0;
    for _ in 0..300 {
        let tree = tree(&mut rng, 3, false);
        let scene = tree.scene(true);
        let world = World::compile(&scene).unwrap();
        for _ in 0..20 {
            let ray = Ray::new(rng.in_cube() * 5.0, rng.direction());
            let probe = Probe::from_space(ray);
            for t_max in [1.0, 4.0, f64::INFINITY] {
                let long = world.share_by_steps(probe, t_max);
                assert_eq!(world.share_through(&probe, t_max, None), long, "{ray:?} {tree:?}");
                tinted += usize::from(long != DVec3::ONE && long != DVec3::ZERO);
            }
        }
    }
    assert!(tinted > 1_000, "{tinted}");
}

/// The volume within [-2, 2]^3, by the chords of a grid of lines.
fn volume(build: impl Fn(&mut Builder)) -> f64 {
    const N: i32 = 200;
    let mut b = Builder::new();
    build(&mut b);
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    let step = 4.0 / f64::from(N);
    let mut sum = 0.0;
    for i in 0..N * N {
        let place = |k: i32| (f64::from(k) + 0.5) * step - 2.0;
        // Askew, so that nothing lines up with the grid.
        let ray = Ray::new(
            DVec3::new(place(i % N) + 1e-4, place(i / N) + 2e-4, 5.0),
            DVec3::NEG_Z,
        );
        let found = crossings(&world, &ray);
        sum += found.chunks(2).map(|pair| pair[1].0 - pair[0].0).sum::<f64>();
    }
    sum * step * step
}

#[test]
fn volumes_are_those_of_the_closed_forms() {
    let pi = math::PI;
    let both = |op: CsgOp, first: Shape, second: Shape, turn: f64, apart: f64| {
        volume(|b| {
            let mark = b.begin_csg(op).unwrap();
            b.shape(first.clone()).unwrap();
            b.translate(DVec3::new(apart, 0.0, 0.0)).unwrap();
            b.rotate(DVec3::Z, turn).unwrap();
            b.shape(second.clone()).unwrap();
            b.end_csg(mark, true).unwrap();
        })
    };
    let sphere = || Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let pipe = |radius| Shape::Cylinder(Cylinder::new(radius, 3.0).unwrap());
    let cube = || Shape::Cuboid(Cuboid::new(DVec3::splat(2.0)).unwrap());
    let lens = pi * (4.0 + 1.2) * (2.0 - 1.2) * (2.0 - 1.2) / 12.0;
    let ball = 4.0 / 3.0 * pi;
    for (found, expected) in [
        (both(CsgOp::Intersection, sphere(), sphere(), 0.0, 1.2), lens),
        (both(CsgOp::Union, sphere(), sphere(), 0.0, 0.8), {
            2.0 * ball - pi * (4.0 + 0.8) * 1.2 * 1.2 / 12.0
        }),
        (both(CsgOp::Difference, sphere(), sphere(), 0.0, 1.2), ball - lens),
        // Steinmetz' solid of two cylinders.
        (
            both(CsgOp::Intersection, pipe(1.0), pipe(1.0), 90.0, 0.0),
            16.0 / 3.0,
        ),
        (
            both(CsgOp::Difference, cube(), pipe(0.5), 0.0, 0.0),
            8.0 - pi * 0.25 * 2.0,
        ),
        // All that lies below.
        (
            both(CsgOp::Intersection, sphere(), Shape::Plane(Plane), 30.0, 0.0),
            ball / 2.0,
        ),
        (
            both(CsgOp::Difference, sphere(), Shape::Plane(Plane), 30.0, 0.0),
            ball / 2.0,
        ),
    ] {
        assert!((found - expected).abs() < 6e-3, "{found}, not {expected}");
    }
}

/// A checkered floor with glass on it.
fn picture(glass: impl Fn(&mut Builder)) -> String {
    let mut b = Builder::new();
    b.size(48, 36).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 2.0, 6.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
    b.directional(DVec3::new(0.5, 1.0, 0.4), DVec3::ONE).unwrap();
    b.area_light(DVec3::new(-3.0, 4.0, 1.0), DVec3::X, DVec3::Z, DVec3::ONE, 2)
        .unwrap();
    let checker = Texture::Checker {
        even: DVec3::splat(0.8),
        odd: DVec3::splat(0.2),
        size: 0.7,
    };
    let checker = b.texture(&Arc::new(checker));
    b.push_transform().unwrap();
    b.translate(DVec3::new(0.0, -1.6, 0.0)).unwrap();
    b.material_mut().diffuse = Term {
        color: DVec3::ONE,
        texture: Some(checker),
    };
    b.shape(Shape::Plane(Plane)).unwrap();
    b.pop_transform().unwrap();
    b.material_mut().diffuse = Term::color(DVec3::splat(0.1));
    b.material_mut().transmission = Term::color(DVec3::new(0.9, 0.8, 0.7));
    b.material_mut().reflection = Some(Term::color(DVec3::splat(0.1)));
    b.material_mut().ior = 1.5;
    glass(&mut b);
    let scene = b.finish().value;
    render(&scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image
        .hash()
}

/// A ball with a hollow: the inner surface looks inwards.
#[derive(Debug)]
struct Hollow;

impl CustomShape for Hollow {
    fn name(&self) -> &'static str {
        "hollow"
    }

    fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(DVec3::splat(-1.5), DVec3::splat(1.5)))
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink) {
        for (part, radius) in [(0, 1.5), (1, 1.1)] {
            let mut own = Crossings::default();
            Shape::Sphere(Sphere::new(DVec3::ZERO, radius).unwrap()).crossings(ray, &mut own);
            own.as_slice()
                .iter()
                .for_each(|crossing| out.push(crossing.t, part));
        }
    }

    fn surface(&self, p: DVec3, part: u32) -> Surface {
        let normal = if part == 0 { p } else { -p };
        Surface {
            normal,
            uv: DVec2::ZERO,
        }
    }
}

#[test]
fn glass_bends_light_as_the_same_solid_of_one_piece_does() {
    let ball = picture(|b| b.sphere(DVec3::ZERO, 1.5).unwrap());
    let united = picture(|b| {
        let mark = b.begin_csg(CsgOp::Union).unwrap();
        b.sphere(DVec3::ZERO, 1.5).unwrap();
        b.sphere(DVec3::new(0.2, 0.1, 0.0), 0.7).unwrap();
        b.end_csg(mark, true).unwrap();
    });
    assert_eq!(ball, united, "nothing is left of what is inside");
    let cut = |b: &mut Builder| {
        let mark = b.begin_csg(CsgOp::Difference).unwrap();
        b.sphere(DVec3::ZERO, 1.5).unwrap();
        b.sphere(DVec3::ZERO, 1.1).unwrap();
        b.end_csg(mark, true).unwrap();
    };
    let hollow = picture(|b| b.shape(Shape::custom(Hollow)).unwrap());
    assert_eq!(hollow, picture(cut));
    assert_ne!(hollow, ball);
    let placed = picture(|b| {
        let mark = b.begin_define("hollow").unwrap();
        cut(b);
        b.end_define(mark, true);
        b.instance("hollow").unwrap();
    });
    assert_eq!(hollow, placed, "as an instance");
}

#[test]
fn the_cut_is_of_what_cuts() {
    let mut b = Builder::new();
    let mark = b.begin_csg(CsgOp::Difference).unwrap();
    b.material_mut().ior = 1.1;
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::splat(2.0)).unwrap()))
        .unwrap();
    b.material_mut().ior = 1.2;
    b.sphere(DVec3::Y, 0.5).unwrap();
    b.end_csg(mark, true).unwrap();
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    for (x, ior, y) in [(0.9, 1.1, 1.0), (0.0, 1.2, 0.5)] {
        let ray = Ray::new(DVec3::new(x, 3.0, 0.0), DVec3::NEG_Y);
        let hit = world.nearest(&Probe::from_space(ray), 9.0).unwrap();
        let at = world.surface(&hit, &ray).unwrap();
        assert_eq!((at.material.ior, at.position.y), (ior, y));
        assert_eq!((at.from_front, at.shading_normal), (true, DVec3::Y));
        assert_eq!(world.objects_of(hit.number).len(), 2, "the solid, then its part");
    }
}

#[test]
fn many_holes_are_one_solid() {
    let mut b = Builder::new();
    let mark = b.begin_csg(CsgOp::Difference).unwrap();
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::new(30.0, 1.0, 30.0)).unwrap()))
        .unwrap();
    for i in 0..500 {
        b.push_transform().unwrap();
        b.translate(DVec3::new(
            f64::from(i % 25) - 12.0,
            0.0,
            f64::from(i / 25) - 10.0,
        ))
        .unwrap();
        b.shape(Shape::Cylinder(Cylinder::new(0.3, 2.0).unwrap()))
            .unwrap();
        b.pop_transform().unwrap();
    }
    b.end_csg(mark, true).unwrap();
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    // Along a row: in and out at each hole, beyond what is kept without memory.
    let ray = Ray::new(DVec3::new(-20.0, 0.1, 0.0), DVec3::X);
    assert_eq!(crossings(&world, &ray).len(), 2 + 2 * 25);
    let down = |x: f64| world.is_occluded(&Ray::new(DVec3::new(x, 5.0, 0.0), DVec3::NEG_Y), 9.0);
    assert!(!down(0.0) && down(0.5));
}

#[test]
fn what_has_no_inside_is_refused() {
    let mut b = Builder::new();
    let mark = b.begin_define("flat").unwrap();
    b.shape(Shape::Disk(Disk::new(1.0).unwrap())).unwrap();
    b.end_define(mark, true);
    let mark = b.begin_csg(CsgOp::Union).unwrap();
    let mut open = box_mesh(DVec3::ONE);
    open.triangles.pop();
    for (made, said) in [
        (
            b.shape(Shape::Disk(Disk::new(1.0).unwrap())),
            "a disk has no inside",
        ),
        (
            b.triangle([DVec3::ZERO, DVec3::X, DVec3::Y], None),
            "a tri has no inside",
        ),
        (b.mesh(&Arc::new(open)), "the mesh \"box\" is not closed"),
        (
            b.instance("flat"),
            "\"flat\" holds something without an inside, the disk",
        ),
        (b.point(DVec3::ONE, DVec3::ONE), "a light is no part of a solid"),
    ] {
        let error = made.unwrap_err();
        assert!(error.message.starts_with(said), "{}", error.message);
    }
    b.end_csg(mark, true).unwrap();
    let report = b.finish();
    assert!(report.value.root().objects.is_empty());
    assert!(report.warnings.iter().any(|w| w.message == "the union is empty"));
}
