//! Shadow rays of many points towards one light, followed backwards from there in a packet: as one by one.

use std::cell::Cell;

use proptest::prelude::*;

use super::{fan, placed, scene_of, vector};
use crate::{
    Builder, DVec3,
    math::Ray,
    render::world::{
        World,
        query::{Blocker, Probe},
    },
};

/// Shadow rays from where the probes hit something to a light.
#[derive(Default)]
struct Ways {
    probes: Vec<Probe>,
    distances: Vec<f64>,
    reach: Vec<f64>,
}

impl Ways {
    fn new(world: &World<'_>, eyes: &[Probe], light: DVec3) -> Self {
        let mut ways = Self::default();
        for eye in eyes {
            let Some(hit) = world.nearest(eye, f64::INFINITY) else {
                continue;
            };
            let at = world.surface(&hit, &eye.ray).unwrap();
            let offset = light - at.position;
            let distance = offset.length();
            let ray = Ray::new(at.position, offset / distance);
            ways.probes.push(Probe::from_surface(ray, hit.number, at.scale));
            ways.distances.push(distance);
            ways.reach.push(distance * (1.0 - 1e-7));
        }
        ways
    }

    /// What stands in the ways, as a packet finds it; `None` where they do not go together.
    fn together(&self, world: &World<'_>, light: DVec3) -> Option<Vec<Blocker>> {
        let mut found = vec![Blocker::Transparent; self.probes.len()];
        let ways = [&self.distances[..], &self.reach[..]];
        let went = world.blockers_before(light, &self.probes, ways, &mut found);
        went.then_some(found)
    }

    fn one_by_one(&self, world: &World<'_>) -> Vec<Blocker> {
        let each = self.probes.iter().zip(&self.reach);
        each.map(|(probe, reach)| world.blocker(probe, *reach)).collect()
    }
}

#[test]
fn what_stands_before_a_light_is_what_each_point_finds() {
    let together = Cell::new(0);
    let blocked = Cell::new([0; 3]);
    let scenes = (
        prop::collection::vec(prop::collection::vec(placed(), 1..8), 0..4),
        prop::collection::vec(placed(), 1..30),
        any::<bool>(),
        prop_oneof![Just(1.0), Just(1e-5), Just(1e5)],
    );
    let looks = prop::collection::vec(
        (
            vector(8.0),
            vector(1.0),
            vector(1.0),
            prop_oneof![Just(0.01), Just(0.1), Just(0.6)],
            // Within the scene, around it, and far away.
            (
                vector(1.0),
                prop_oneof![Just(2.0), Just(8.0), Just(60.0), Just(1e4)],
            ),
        ),
        8,
    );
    let config = ProptestConfig {
        cases: 600,
        ..ProptestConfig::default()
    };
    proptest!(config, |((groups, root, glass, scale) in scenes, looks in looks)| {
        let scene = scene_of(&groups, &root, scale, glass);
        let world = World::compile(&scene).unwrap();
        for (origin, dir, across, spread, (light, away)) in looks {
            prop_assume!(dir.length() > 1e-3 && dir.normalize().cross(across).length() > 1e-3);
            let eyes = fan(origin * scale, dir.normalize(), across, spread, 64);
            let light = light * (away * scale);
            let ways = Ways::new(&world, &eyes, light);
            if let Some(found) = ways.together(&world, light) {
                let expected = ways.one_by_one(&world);
                prop_assert_eq!(&found, &expected);
                together.set(together.get() + 1);
                let mut count = blocked.get();
                for found in found {
                    count[found as usize] += 1;
                }
                blocked.set(count);
            }
        }
    });
    // Most of what is looked at is nothing, and many points lie behind what they lie on.
    assert!(together.get() > 300, "{}", together.get());
    assert!(blocked.get().iter().all(|n| *n > 500), "{:?}", blocked.get());
}

/// The points of a finely divided floor, the light behind it, before it, in it and beside: whoever lies on an edge or a
/// corner of triangles finds the same as alone.
#[test]
fn points_on_edges_of_their_own_mesh_find_the_same() {
    for scale in [1.0, 1e-6, 1e6] {
        let mut b = Builder::new();
        for (i, k) in (0..16).flat_map(|i| (0..16).map(move |k| (i, k))) {
            let point = |i: i32, k: i32| {
                DVec3::new(
                    f64::from(i) / 8.0 - 1.0,
                    0.01 * f64::from(i * k % 3),
                    f64::from(k) / 8.0 - 1.0,
                ) * scale
            };
            let [p, q, r, s] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(di, dk)| point(i + di, k + dk));
            b.triangle([p, q, r], None).unwrap();
            b.triangle([p, r, s], None).unwrap();
        }
        b.sphere(DVec3::new(0.2, 0.5, 0.1) * scale, 0.2 * scale).unwrap();
        let scene = b.finish().value;
        let world = World::compile(&scene).unwrap();
        let (mut together, mut lit, mut dark) = (0, 0, 0);
        for n in 0..200 {
            let (x, z) = (f64::from(n % 20) / 10.0 - 1.0, f64::from(n / 20) / 5.0 - 1.0);
            // On corners and edges of the triangles and inside of them.
            let eyes: Vec<Probe> = (0..64)
                .map(|i| {
                    let aim = DVec3::new(
                        f64::from(n % 8 + i % 8) / 16.0 - 0.5,
                        0.0,
                        f64::from(n / 8 % 8 + i / 8) / 16.0 - 0.5,
                    );
                    let from = DVec3::new(aim.x, 3.0, aim.z);
                    Probe::from_space(Ray::new(from * scale, DVec3::NEG_Y))
                })
                .collect();
            let light = DVec3::new(x, [4.0, 1.0, 0.02, -1.0][n as usize % 4], z) * scale;
            let ways = Ways::new(&world, &eyes, light);
            if let Some(found) = ways.together(&world, light) {
                assert_eq!(found, ways.one_by_one(&world), "scale {scale}, light {light}");
                together += 1;
                lit += found.iter().filter(|found| **found == Blocker::None).count();
                dark += found.iter().filter(|found| **found == Blocker::Opaque).count();
            }
        }
        assert!(
            together > 40 && lit > 1000 && dark > 500,
            "{scale}: {together} {lit} {dark}"
        );
    }
}
