//! Solids put together at random against the question whether a point is inside of them, asked of each part by itself.

mod known;

use std::sync::Arc;

use crate::{
    Builder, DVec3, Scene,
    math::{self, DAffine3, Ray, max_abs},
    render::world::{Probe, World},
    scene::{CsgOp, Mesh, Term},
    shape::{
        Cuboid, Cylinder, Plane, Shape, Torus,
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
