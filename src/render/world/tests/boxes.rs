//! Boxes by the hundred: on a grid, so that they touch, thin ones, and such that stand anyhow.

use super::*;

/// The kind of arrangement, and one of three sizes.
fn many(round: usize, next: &mut impl FnMut() -> f64) -> Scene {
    let scale = [1.0, 1e-6, 1e6][round % 3];
    let mut b = Builder::new();
    b.scale(DVec3::splat(scale)).unwrap();
    for i in 0..300usize {
        let mut vector = || DVec3::new(next(), next(), next());
        b.push_transform().unwrap();
        b.material_mut().transmission = Term::color(if i % 5 == 0 {
            Color::splat(0.5)
        } else {
            Color::ZERO
        });
        let mut size = vector().abs() + 0.01;
        if (round / 3).is_multiple_of(2) {
            let at = [i % 7, i / 7 % 7, i / 49].map(|k| k as f64 - 3.0);
            b.translate(DVec3::from(at)).unwrap();
            size = DVec3::ONE;
        } else {
            b.translate(vector() * 3.0).unwrap();
            b.rotate(vector(), 180.0 * vector().x).unwrap();
            size.x *= [1.0, 1.0, 1e-4, 1e-9][i % 4];
        }
        b.shape(Shape::Cuboid(Cuboid::new(size).unwrap())).unwrap();
        if i % 50 == 7 {
            b.sphere(DVec3::ZERO, 0.7).unwrap();
        }
        b.pop_transform().unwrap();
    }
    b.finish().value
}

#[test]
fn boxes_in_blocks_are_found_from_everywhere() {
    let mut state = 0u64;
    let mut next = move || {
        state += 1;
        (crate::render::sampler::mix(state) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let (mut hits, mut transparent) = (0, 0);
    for round in 0..12 {
        let scene = many(round, &mut next);
        let world = World::compile(&scene).unwrap();
        let standing: usize = world.levels[0]
            .cuboid_blocks
            .iter()
            .map(|block| block.ids.iter().filter(|id| **id != crate::accel::NONE).count())
            .sum();
        assert_eq!(standing, 300);
        let scale = [1.0, 1e-6, 1e6][round % 3];
        let mut vector = |k: f64| DVec3::new(next(), next(), next()) * k;
        for i in 0..60 {
            // Anywhere, or on the grid and along it: in the planes of faces and along edges.
            let (origin, dir) = if i % 3 == 0 {
                (
                    (vector(4.0) * 2.0).round() / 2.0,
                    [DVec3::X, DVec3::NEG_Y, DVec3::new(0.0, 1.0, 1.0)][i / 3 % 3],
                )
            } else {
                (vector(6.0), vector(1.0).normalize())
            };
            let mut probes = fan(
                origin * scale,
                dir,
                DVec3::new(0.3, 0.9, -0.4),
                [0.01, 0.2][i % 2],
                30,
            );
            for _ in 0..3 {
                let mut found = vec![None; probes.len()];
                world.nearest_many(&probes, f64::INFINITY, &mut found);
                for (probe, hit) in probes.iter().zip(&found) {
                    let slow = world.nearest_brute(probe, f64::INFINITY);
                    assert_eq!(bits(*hit), bits(slow), "round {round}: {:?}", probe.ray);
                    assert_eq!(
                        bits(world.nearest(probe, f64::INFINITY)),
                        bits(slow),
                        "round {round}: {:?}",
                        probe.ray
                    );
                    hits += u32::from(slow.is_some());
                }
                let reach: Vec<f64> = found
                    .iter()
                    .zip(0..)
                    .map(|(hit, i)| {
                        hit.map_or(f64::INFINITY, |h| h.t * [1.0 - 1e-9, 1.0, 1.0 + 1e-9, 9.0][i % 4])
                    })
                    .collect();
                let mut blockers = vec![Blocker::None; probes.len()];
                world.blockers(&probes, &reach, &mut blockers);
                for ((probe, reach), found) in probes.iter().zip(&reach).zip(&blockers) {
                    assert_eq!(*found, world.blocker(probe, *reach));
                    assert_eq!(
                        *found != Blocker::None,
                        world.nearest_brute(probe, *reach).is_some()
                    );
                    transparent += u32::from(*found == Blocker::Transparent);
                }
                for (probe, hit) in probes.iter_mut().zip(&found) {
                    if let Some((hit, surface)) =
                        hit.and_then(|hit| Some((hit, world.surface(&hit, &probe.ray)?)))
                    {
                        let ray = Ray::new(surface.position, probe.ray.dir);
                        *probe = Probe::from_surface(ray, hit.number, surface.scale);
                    }
                }
            }
        }
    }
    assert!(hits > 20_000 && transparent > 300, "{hits} {transparent}");
}
