//! Short ways against long ones: light through glass, touching surfaces, and what stands before an area light.

use proptest::prelude::*;

use super::{
    World,
    query::{Blocker, Probe},
    tests::{placed, scene, vector},
};
use crate::{
    DVec3, Scene,
    math::Ray,
    scene::{Material, MaterialId, Term},
};

/// Gives the objects two colors of glass and an opaque material in turn.
fn glaze(mut scene: Scene) -> Scene {
    let glass = |x, y, z| Material {
        transmission: Term::color(DVec3::new(x, y, z)),
        ..Material::default()
    };
    scene.materials = vec![glass(0.9, 0.7, 0.3), glass(0.2, 0.95, 0.6), Material::default()];
    for group in &mut scene.groups {
        for (object, i) in group.objects.iter_mut().zip(0..) {
            object.material = MaterialId(i % 3);
        }
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn one_search_finds_what_comes_through_step_by_step(
        groups in prop::collection::vec(prop::collection::vec(placed(), 1..6), 0..3),
        root in prop::collection::vec(placed(), 1..12),
        rays in prop::collection::vec((vector(8.0), vector(1.0), prop_oneof![Just(f64::INFINITY), 0.1..20.0f64]), 40),
        scale in prop_oneof![Just(1.0), Just(1e-6), Just(1e6)],
    ) {
        let scene = glaze(scene(&groups, &root, scale));
        let world = World::compile(&scene).unwrap();
        for (origin, dir, reach) in rays {
            prop_assume!(dir.length() > 1e-3);
            let ray = Ray::new(origin * scale, dir.normalize());
            let mut probe = Probe::from_space(ray);
            for _ in 0..4 {
                let t_max = reach * scale;
                let long = if world.blocker(&probe, t_max) == Blocker::Opaque {
                    DVec3::ZERO
                } else {
                    world.share_by_steps(probe, t_max)
                };
                prop_assert_eq!(world.share_through(&probe, t_max, None), long);
                let Some(hit) = world.nearest(&probe, f64::INFINITY) else { break };
                let at = world.surface(&hit, &probe.ray).unwrap();
                probe = Probe::from_surface(Ray::new(at.position, ray.dir), hit.number, at.scale);
            }
        }
    }

    #[test]
    fn what_is_looked_at_first_does_not_matter(
        groups in prop::collection::vec(prop::collection::vec(placed(), 1..6), 0..3),
        root in prop::collection::vec(placed(), 1..12),
        rays in prop::collection::vec((vector(8.0), vector(1.0), prop_oneof![Just(f64::INFINITY), 0.1..20.0f64]), 20),
        lasts in prop::collection::vec(0..24u64, 20),
        glass in any::<bool>(),
    ) {
        let plain = scene(&groups, &root, 1.0);
        let scene = if glass { glaze(plain) } else { plain };
        let world = World::compile(&scene).unwrap();
        let mut kept = 0;
        for ((origin, dir, reach), last) in rays.into_iter().zip(lasts) {
            prop_assume!(dir.length() > 1e-3);
            let ray = Ray::new(origin, dir.normalize());
            let mut probes = vec![Probe::from_space(ray)];
            if let Some(hit) = world.nearest(&probes[0], f64::INFINITY) {
                let at = world.surface(&hit, &ray).unwrap();
                probes.push(Probe::from_surface(Ray::new(at.position, ray.dir), hit.number, at.scale));
            }
            for probe in probes {
                let share = world.share_through(&probe, reach, None);
                prop_assert_eq!(world.share_after(&probe, reach, &mut kept), share);
                for mut other in [last, u64::MAX, probe.start] {
                    prop_assert_eq!(world.share_after(&probe, reach, &mut other), share);
                }
            }
        }
    }

    #[test]
    fn few_obstacles_are_all_that_rays_to_an_area_meet(
        root in prop::collection::vec(placed(), 1..12),
        views in prop::collection::vec((vector(8.0), vector(1.0), vector(6.0), vector(2.0), vector(2.0)), 20),
        scale in prop_oneof![Just(1.0), Just(1e-6), Just(1e6)],
    ) {
        let scene = glaze(scene(&[], &root, scale));
        let world = World::compile(&scene).unwrap();
        for (origin, dir, corner, edge1, edge2) in views {
            prop_assume!(dir.length() > 1e-3);
            let (corner, edge1, edge2) = (corner * scale, edge1 * scale, edge2 * scale);
            let probe = Probe::from_space(Ray::new(origin * scale, dir.normalize()));
            let Some(hit) = world.nearest(&probe, f64::INFINITY) else { continue };
            let at = world.surface(&hit, &probe.ray).unwrap();
            let corners = [corner, corner + edge1, corner + edge1 + edge2, corner + edge2];
            let Some(few) = world.obstacles(&at, hit.number, corners, 64) else { continue };
            for i in 0..36 {
                let (a, b) = (f64::from(i % 6) / 5.0, f64::from(i / 6) / 5.0);
                let offset = corner + edge1 * a + edge2 * b - at.position;
                let ray = Ray::new(at.position, offset / offset.length());
                let probe = Probe::from_surface(ray, hit.number, at.scale);
                let rest = offset.length() * (1.0 - 1e-7);
                let all = world.share_through(&probe, rest, None);
                prop_assert_eq!(world.share_through(&probe, rest, Some(&few)), all, "{} of {:?}", i, few);
            }
        }
    }

    #[test]
    fn what_touches_glass_is_found(
        root in prop::collection::vec(placed(), 1..8),
        rays in prop::collection::vec((vector(6.0), vector(1.0)), 20),
    ) {
        // Everything twice in its place: once of glass, once opaque.
        let twice: Vec<_> = root.iter().flat_map(|item| [item.clone(), item.clone()]).collect();
        let mut scene = scene(&[], &twice, 1.0);
        scene.materials = vec![Material::default(), Material {
            transmission: Term::color(DVec3::ONE),
            ..Material::default()
        }];
        let root = &mut scene.groups[0];
        for (object, i) in root.objects.iter_mut().zip(0..) {
            object.material = MaterialId((i + 1) % 2);
        }
        let world = World::compile(&scene).unwrap();
        for (origin, dir) in rays {
            prop_assume!(dir.length() > 1e-3);
            let probe = Probe::from_space(Ray::new(origin, dir.normalize()));
            let Some(hit) = world.nearest(&probe, f64::INFINITY) else { continue };
            let at = world.surface(&hit, &probe.ray).unwrap();
            let (around, reach) = Probe::around_surface(Ray::new(at.position, probe.ray.dir), hit.number, at.scale);
            let nearest = world.nearest(&around, reach);
            let opaque = nearest.filter(|hit| world.material(hit.number).is_some_and(|m| m.transmission.is_black()));
            let found = world.touching(&hit, &probe.ray, &at).map(|(hit, _)| hit.number);
            prop_assert!(opaque.is_none() || found == opaque.map(|hit| hit.number));
        }
    }
}
