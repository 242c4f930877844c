//! The tree against all primitives one by one, on random scenes.

mod boxes;
mod extremes;
mod lights;
mod moving;
mod stops;

use proptest::prelude::*;

use super::{
    super::interrupt::Interrupt,
    World,
    query::{Blocker, Hit, Probe},
};
use crate::{
    Builder, DVec3, NoHost, Scene,
    color::Color,
    math::{Ray, max_abs},
    scene::{Mesh, Term},
    shape::{Cone, Cuboid, Cylinder, Disk, Plane, Polygon, Shape, Torus},
};

#[derive(Clone, Debug)]
enum Thing {
    Sphere(f64),
    Triangle([DVec3; 3]),
    Shape(usize, f64, f64),
    Mesh(u64),
    Instance(usize),
}

#[derive(Clone, Debug)]
pub(super) struct Placed {
    thing: Thing,
    translation: DVec3,
    axis: DVec3,
    degrees: f64,
    scale: DVec3,
}

pub(super) fn vector(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from)
}

fn thing() -> impl Strategy<Value = Thing> {
    prop_oneof![
        (0.05..1.5f64).prop_map(Thing::Sphere),
        // Slivers and specks among them.
        (
            prop::array::uniform3(vector(1.0)),
            prop_oneof![Just(1.0), Just(1e-6)]
        )
            .prop_map(|([a, b, c], thin)| Thing::Triangle([a, b, b + (c - b) * thin])),
        (0..7usize, 0.1..1.0f64, 0.1..1.0f64).prop_map(|(kind, a, b)| Thing::Shape(kind, a, b)),
        any::<u64>().prop_map(Thing::Mesh),
        (0..4usize).prop_map(Thing::Instance),
    ]
}

pub(super) fn placed() -> impl Strategy<Value = Placed> {
    let axis = vector(1.0).prop_filter("an axis has a length", |axis| axis.length() > 1e-3);
    let scale =
        prop::array::uniform3(prop_oneof![0.2..2.0f64, -2.0..-0.2f64, Just(1.0)]).prop_map(DVec3::from);
    let scale = prop_oneof![scale, (0.2..2.0f64).prop_map(DVec3::splat)];
    (thing(), vector(4.0), axis, 0.0..360.0f64, scale).prop_map(
        |(thing, translation, axis, degrees, scale)| Placed {
            thing,
            translation,
            axis,
            degrees,
            scale,
        },
    )
}

fn shape(kind: usize, a: f64, b: f64) -> Shape {
    match kind {
        0 => Shape::Cuboid(Cuboid::new(DVec3::new(a, b, 0.5)).unwrap()),
        1 => Shape::Cylinder(Cylinder::new(a, b).unwrap()),
        2 => Shape::Cone(Cone::new(a, b).unwrap()),
        3 => Shape::Disk(Disk::new(a).unwrap()),
        4 => Shape::Torus(Torus::new(a.max(b), a.min(b) * 0.7).unwrap()),
        5 => Shape::Plane(Plane),
        _ => {
            let corners = [(0.0, 0.0), (a, 0.0), (a, b), (a * 0.4, b * 0.3), (0.0, b)];
            let points = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
            Shape::Polygon(Polygon::new(points).unwrap().into())
        }
    }
}

fn mesh(seed: u64) -> Mesh {
    let number = |i: u64| {
        (crate::render::sampler::mix(seed ^ crate::render::sampler::mix(i)) >> 11) as f64
            / (1u64 << 53) as f64
    };
    let positions = (0..12)
        .map(|i| DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)))
        .collect();
    let triangles = (0..20)
        .map(|i| [0, 1, 2].map(|k| (number(100 + 3 * i + k) * 12.0) as u32))
        .collect();
    Mesh::new("random", positions, triangles).unwrap()
}

/// With `glass` every third thing lets light through.
fn put(b: &mut Builder, items: &[Placed], groups: usize, glass: bool) {
    let shared = std::sync::Arc::new(mesh(7));
    for (i, item) in items.iter().enumerate() {
        if glass {
            let kt = if i % 3 == 0 {
                Color::splat(0.5)
            } else {
                Color::ZERO
            };
            b.material_mut().transmission = Term::color(kt);
        }
        b.push_transform().unwrap();
        b.translate(item.translation).unwrap();
        b.rotate(item.axis, item.degrees).unwrap();
        b.scale(item.scale).unwrap();
        match &item.thing {
            Thing::Sphere(r) => b.sphere(DVec3::splat(0.1), *r).unwrap(),
            Thing::Triangle(corners) => b.triangle(*corners, None).unwrap(),
            Thing::Shape(kind, p, q) => b.shape(shape(*kind, *p, *q)).unwrap(),
            Thing::Mesh(seed) if seed % 2 == 0 => b.mesh(&shared).unwrap(),
            Thing::Mesh(seed) => b.mesh(&std::sync::Arc::new(mesh(*seed))).unwrap(),
            Thing::Instance(i) if groups > 0 => b.instance(&format!("g{}", i % groups)).unwrap(),
            Thing::Instance(_) => {}
        }
        b.pop_transform().unwrap();
    }
}

/// A scene whose groups place one another, everything times `scale`.
pub(super) fn scene(groups: &[Vec<Placed>], root: &[Placed], scale: f64) -> Scene {
    scene_of(groups, root, scale, false)
}

fn scene_of(groups: &[Vec<Placed>], root: &[Placed], scale: f64, glass: bool) -> Scene {
    let mut b = Builder::new();
    for (i, items) in groups.iter().enumerate() {
        let mark = b.begin_define(&format!("g{i}")).unwrap();
        put(&mut b, items, i, glass);
        b.end_define(mark, true);
    }
    b.scale(DVec3::splat(scale)).unwrap();
    put(&mut b, root, groups.len(), glass);
    b.finish().value
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn the_tree_finds_what_brute_force_finds(
        groups in prop::collection::vec(prop::collection::vec(placed(), 1..8), 0..4),
        root in prop::collection::vec(placed(), 1..30),
        rays in prop::collection::vec((vector(8.0), vector(1.0)), 20),
        scale in prop_oneof![Just(1.0), Just(1e-6), Just(1e6)],
    ) {
        let scene = scene(&groups, &root, scale);
        let world = World::compile(&scene).unwrap();
        for (origin, dir) in rays {
            prop_assume!(dir.length() > 1e-3);
            let mut probe = Probe::from_space(Ray::new(origin * scale, dir.normalize()));
            // On along the line from hit to hit, so that starts on surfaces are tried too.
            for _ in 0..6 {
                let (fast, slow) = (world.nearest(&probe, f64::INFINITY), world.nearest_brute(&probe, f64::INFINITY));
                prop_assert_eq!(fast.map(|h| (h.t.to_bits(), h.number)), slow.map(|h| (h.t.to_bits(), h.number)));
                let any = world.blocker(&probe, f64::INFINITY);
                prop_assert_eq!(any != Blocker::None, slow.is_some());
                let Some(hit) = slow else { break };
                prop_assert!(world.blocker(&probe, hit.t * (1.0 - 1e-9)) == Blocker::None, "nothing stands before the nearest");
                prop_assert!(world.blocker(&probe, hit.t * (1.0 + 1e-9)) != Blocker::None);
                let surface = world.surface(&hit, &probe.ray).unwrap();
                prop_assert!((surface.shading_normal.length() - 1.0).abs() < 1e-12);
                prop_assert!(max_abs(surface.position) <= surface.scale);
                probe = Probe::from_surface(Ray::new(surface.position, probe.ray.dir), hit.number, surface.scale);
            }
        }
    }
}

/// Large triangles through one another, slivers, and such as lie nearly in the planes that cut them: the trees stand
/// for some of them several times, and still find what brute force finds.
#[test]
fn triangles_that_were_cut_are_found_from_everywhere() {
    let mut state = 0u64;
    let mut next = move || {
        state += 1;
        (crate::render::sampler::mix(state) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut cut = 0;
    for round in 0..60 {
        let scale = [1.0, 1e-6, 1e6][round % 3];
        let offset = [0.0, 3.0, 1000.0][round / 3 % 3];
        let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
        let triangles: Vec<[DVec3; 3]> = (0..60 + 4 * round)
            .map(|i| {
                let (a, b, c) = (vector(1.0), vector(1.0), vector(1.0));
                let corners = match i % 16 {
                    0 | 1 => [a, b, c],
                    // A sliver.
                    2 => [a, b, b + (c - b) * [1e-3, 1e-9, 1e-14][i / 16 % 3]],
                    // Nearly at right angles to an axis.
                    3 => [a, b, c].map(|p| DVec3::new(p.x, a.y + p.y * [0.0, 1e-15, 1e-7][i / 16 % 3], p.z)),
                    // Small, as most are, so that there is something to tell apart and cuts are worth their memory.
                    _ => [a, a + b * 0.03, a + c * 0.03],
                };
                corners.map(|p| (p + offset) * scale)
            })
            .collect();
        let mut b = Builder::new();
        for corners in &triangles {
            b.triangle(*corners, None).unwrap();
        }
        let scene = b.finish().value;
        let world = World::compile_with(&scene, 3.0, None, &Interrupt::new(&NoHost)).unwrap();
        let blocks = &world.levels[0].triangle_blocks;
        let standing = blocks
            .iter()
            .flat_map(|block| block.ids)
            .filter(|id| *id != crate::accel::NONE);
        cut += standing.count() - triangles.len();
        for corners in triangles.iter().cycle().take(600) {
            let weights = vector(1.0).abs();
            let weights = weights / (weights.x + weights.y + weights.z);
            let aim = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            let from = (vector(3.0) + offset) * scale;
            // From nearby, from far away, and along an axis.
            let dirs = [aim - from, (aim - from) * 100.0, DVec3::Y, DVec3::NEG_X];
            for dir in dirs.map(DVec3::normalize) {
                let distance = (aim - from).length() * if dir == dirs[1].normalize() { 100.0 } else { 1.0 };
                let probe = Probe::from_space(Ray::new(aim - dir * distance, dir));
                let [fast, slow] = [
                    world.nearest(&probe, f64::INFINITY),
                    world.nearest_brute(&probe, f64::INFINITY),
                ]
                .map(|hit| hit.map(|hit| (hit.t.to_bits(), hit.number)));
                assert_eq!(fast, slow, "round {round}: {:?}", probe.ray);
                assert_eq!(
                    world.blocker(&probe, f64::INFINITY) != Blocker::None,
                    slow.is_some()
                );
            }
        }
    }
    assert!(cut > 2000, "{cut}");
}

/// A ball of radius 0.5 on the X axis.
fn sphere(x: f64) -> Placed {
    Placed {
        thing: Thing::Sphere(0.5),
        translation: DVec3::new(x, 0.0, 0.0),
        axis: DVec3::Y,
        degrees: 0.0,
        scale: DVec3::ONE,
    }
}

#[test]
fn numbers_lead_back_to_primitives_through_nested_instances() {
    let at = |x: f64, group: usize| Placed {
        thing: Thing::Instance(group),
        ..sphere(x)
    };
    let groups = [
        vec![sphere(0.0), sphere(2.0)],
        vec![at(0.0, 0), at(10.0, 0), sphere(5.0)],
    ];
    let scene = scene(&groups, &[at(0.0, 1), at(100.0, 1), sphere(50.0)], 1.0);
    let world = World::compile(&scene).unwrap();
    let mut numbers = Vec::new();
    for x in [0.0, 2.0, 5.0, 10.0, 12.0, 50.0, 100.0, 102.0, 105.0, 110.0, 112.0] {
        let probe = Probe::from_space(Ray::new(DVec3::new(x + 0.1, 0.1, 9.0), DVec3::NEG_Z));
        let hit = world.nearest(&probe, f64::INFINITY).unwrap();
        let surface = world.surface(&hit, &probe.ray).unwrap();
        assert!((surface.position.x - x - 0.1).abs() < 1e-12);
        numbers.push(hit.number);
    }
    numbers.sort_unstable();
    assert!(numbers.into_iter().eq(0..11), "all different, none left out");
}

/// Closed meshes at many scales: rays straight at vertices and edges never slip through.
#[test]
fn closed_meshes_do_not_leak() {
    for exponent in [-6, -3, 0, 3, 6] {
        let scale = crate::math::pow(10.0, f64::from(exponent));
        let (rings, sectors) = (24u32, 48u32);
        let point = |ring: u32, sector: u32| {
            let (sin_a, cos_a) = crate::math::sin_cos_degrees(180.0 * f64::from(ring) / f64::from(rings));
            let (sin_b, cos_b) =
                crate::math::sin_cos_degrees(360.0 * f64::from(sector % sectors) / f64::from(sectors));
            DVec3::new(0.3 + sin_a * cos_b, cos_a - 0.2, 0.1 + sin_a * sin_b) * scale
        };
        let mut b = Builder::new();
        let mut aims = Vec::new();
        for ring in 0..rings {
            for sector in 0..sectors {
                let [p, q, r, s] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| point(ring + i, sector + j));
                b.triangle([p, q, r], None).unwrap();
                b.triangle([p, r, s], None).unwrap();
                aims.extend([p, (p + q) * 0.5, p + (r - p) * 0.3, p + (s - p) * 0.77]);
            }
        }
        let scene = b.finish().value;
        let world = World::compile(&scene).unwrap();
        let inside = DVec3::new(0.35, -0.1, 0.05) * scale;
        for aims in aims.chunks(24) {
            let probes: Vec<Probe> = aims
                .iter()
                .map(|aim| Probe::from_space(Ray::new(inside, (*aim - inside).normalize())))
                .collect();
            let (mut hits, mut found) = (vec![None; aims.len()], vec![Blocker::None; aims.len()]);
            world.nearest_many(&probes, f64::INFINITY, &mut hits);
            world.blockers(&probes, &vec![f64::INFINITY; aims.len()], &mut found);
            assert!(hits.iter().all(Option::is_some), "out of a packet at {scale}");
            assert!(found.iter().all(|found| *found == Blocker::Opaque));
        }
        for (i, aim) in aims.into_iter().enumerate() {
            let ray = Ray::new(inside, (aim - inside).normalize());
            assert!(
                world.nearest(&Probe::from_space(ray), f64::INFINITY).is_some(),
                "out at {aim}, aim {i}"
            );
            assert_eq!(
                world.blocker(&Probe::from_space(ray), f64::INFINITY),
                Blocker::Opaque
            );
        }
    }
}

/// A group without shapes has an empty box, which once hid what stood beside it in the tree.
#[test]
fn an_instance_of_nothing_hides_nothing() {
    let nothing = Placed {
        thing: Thing::Instance(0),
        ..sphere(1.0)
    };
    let root: Vec<Placed> = (0..20)
        .map(|i| {
            if i % 3 == 0 {
                nothing.clone()
            } else {
                sphere(f64::from(i))
            }
        })
        .collect();
    let scene = scene(&[vec![nothing.clone()]], &root, 1.0);
    let world = World::compile(&scene).unwrap();
    for i in (0..20).filter(|i| i % 3 != 0) {
        let probe = Probe::from_space(Ray::new(DVec3::new(f64::from(i) + 0.1, 0.1, 9.0), DVec3::NEG_Z));
        assert!(world.nearest(&probe, f64::INFINITY).is_some(), "sphere {i}");
    }
}

/// Rays from one point: `n` in a row, each a little or a lot aside from the one before.
fn fan(origin: DVec3, dir: DVec3, across: DVec3, spread: f64, n: usize) -> Vec<Probe> {
    let (right, up) = (dir.cross(across), dir.cross(across).cross(dir));
    (0..n)
        .map(|i| {
            let (x, y) = ((i % 8) as f64 - 3.5, (i / 8) as f64 - 3.5);
            let dir = dir + (right * x + up * y) * (spread / 8.0);
            Probe::from_space(Ray::new(origin, dir / dir.length()))
        })
        .collect()
}

/// What identifies a hit to the last bit.
fn bits(hit: Option<Hit>) -> Option<(u64, u64, u64, u64, u32)> {
    hit.map(|h| (h.t.to_bits(), h.number, h.u.to_bits(), h.v.to_bits(), h.part))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn packets_find_what_single_rays_and_brute_force_find(
        groups in prop::collection::vec(prop::collection::vec(placed(), 1..8), 0..4),
        root in prop::collection::vec(placed(), 1..30),
        fans in prop::collection::vec(
            (vector(8.0), vector(1.0), vector(1.0), prop_oneof![Just(0.01), Just(0.1), Just(0.6), Just(3.0)], 1..100usize),
            6,
        ),
        glass in any::<bool>(),
        scale in prop_oneof![Just(1.0), Just(1e-5), Just(1e6)],
    ) {
        let scene = scene_of(&groups, &root, scale, glass);
        let world = World::compile(&scene).unwrap();
        for (origin, dir, across, spread, n) in fans {
            prop_assume!(dir.length() > 1e-3 && dir.normalize().cross(across).length() > 1e-3);
            let mut probes = fan(origin * scale, dir.normalize(), across, spread, n);
            for bounce in 0..3 {
                let mut hits = vec![None; probes.len()];
                world.nearest_many(&probes, f64::INFINITY, &mut hits);
                for (probe, hit) in probes.iter().zip(&hits) {
                    prop_assert_eq!(bits(*hit), bits(world.nearest(probe, f64::INFINITY)));
                    prop_assert_eq!(bits(*hit), bits(world.nearest_brute(probe, f64::INFINITY)));
                }
                let reach: Vec<f64> = hits
                    .iter()
                    .zip(0..)
                    .map(|(hit, i)| hit.map_or(f64::INFINITY, |h| h.t * [1.0 - 1e-9, 1.0, 1.0 + 1e-9, 9.0][i % 4]))
                    .collect();
                let mut found = vec![Blocker::None; probes.len()];
                world.blockers(&probes, &reach, &mut found);
                for ((probe, reach), found) in probes.iter().zip(&reach).zip(&found) {
                    prop_assert_eq!(*found, world.blocker(probe, *reach));
                }
                // On from one surface point in the same fan of directions, then from each ray's own.
                let Some((hit, from)) = hits.iter().zip(&probes).find_map(|(hit, probe)| Some(((*hit)?, probe))) else {
                    break;
                };
                let common = world.surface(&hit, &from.ray).unwrap();
                for (probe, own) in probes.iter_mut().zip(&hits) {
                    let own = own.filter(|_| bounce == 1);
                    let surface = own.and_then(|hit| world.surface(&hit, &probe.ray));
                    let (at, number) = surface.map_or((common.position, hit.number), |s| (s.position, own.unwrap().number));
                    *probe = Probe::from_surface(Ray::new(at, probe.ray.dir), number, common.scale);
                }
            }
        }
    }
}
