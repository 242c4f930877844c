//! The tree against all primitives one by one where numbers are unkind: everything on one lattice, so that
//! surfaces coincide, triangles vanish and rays run along faces and edges; and everything far too large, far too
//! small, or both in one scene.

use std::process::Command;

use super::*;

/// Points that many things share.
fn lattice() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3((-4..=4i32).prop_map(|i| 0.5 * f64::from(i))).prop_map(DVec3::from)
}

/// What a scene is made of.
#[derive(Clone, Copy, Debug)]
struct Kind {
    /// Things are this much larger, smaller and farther away than others of the scene.
    spread: f64,
    /// Shapes other than triangles and spheres are among them: those find their hits in a space of their own,
    /// where a ray that starts 1e8 sizes away has lost the figures that tell a hit from a miss.
    shapes: bool,
}

fn kind() -> impl Strategy<Value = Kind> {
    let kind = |spread, shapes| Kind { spread, shapes };
    prop::sample::select(vec![kind(100.0, true), kind(1e5, false)])
}

/// Sizes of things in one scene.
fn size(spread: f64) -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(1.0), 1 => Just(1.0 / spread), 1 => Just(spread)]
}

fn lattice_thing(kind: Kind) -> impl Strategy<Value = Thing> {
    let half = (1..=4i32).prop_map(|i| 0.5 * f64::from(i));
    prop_oneof![
        half.clone().prop_map(Thing::Sphere),
        // Of 9^9 many are flat, and some are a line or a point.
        prop::array::uniform3(lattice()).prop_map(Thing::Triangle),
        lattice().prop_map(|p| Thing::Triangle([p, p, p + DVec3::X])),
        (lattice(), lattice(), 1e-12..1e-3f64).prop_map(|(p, q, thin)| Thing::Triangle([
            p,
            q,
            p + (q - p) * 0.5 + DVec3::splat(thin)
        ])),
        (0..7usize, half.clone(), half).prop_map(move |(i, a, b)| if kind.shapes {
            Thing::Shape(i, a, b)
        } else {
            Thing::Sphere(a)
        }),
        any::<u64>().prop_map(Thing::Mesh),
        (0..4usize).prop_map(Thing::Instance),
    ]
}

fn on_lattice(kind: Kind) -> impl Strategy<Value = Placed> {
    let axis = prop_oneof![Just(DVec3::X), Just(DVec3::Y), Just(DVec3::Z)];
    let quarter = (0..4i32).prop_map(|i| 90.0 * f64::from(i));
    let scale = prop_oneof![
        4 => Just(DVec3::ONE),
        1 => Just(DVec3::new(-1.0, 1.0, 1.0)),
        1 => Just(DVec3::new(2.0, 0.5, -1.0)),
        1 => size(kind.spread).prop_map(DVec3::splat),
        1 => Just(DVec3::new(1.0, 1e-2, 1.0)),
    ];
    (
        lattice_thing(kind),
        lattice(),
        size(kind.spread),
        axis,
        quarter,
        scale,
    )
        .prop_map(|(thing, translation, far, axis, degrees, scale)| Placed {
            thing,
            translation: translation * far,
            axis,
            degrees,
            scale,
        })
}

/// Things one to three times in the same place.
fn things(kind: Kind, most: usize) -> impl Strategy<Value = Vec<Placed>> {
    let anywhere = placed().prop_map(move |p| match p.thing {
        Thing::Shape(..) if !kind.shapes => Placed {
            thing: Thing::Sphere(0.7),
            ..p
        },
        _ => p,
    });
    let one = prop_oneof![3 => on_lattice(kind), 1 => anywhere];
    prop::collection::vec((one, 1..=3usize), 1..most).prop_map(|things| {
        things
            .into_iter()
            .flat_map(|(thing, times)| vec![thing; times])
            .collect()
    })
}

fn scales() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => Just(1.0),
        4 => prop::sample::select(vec![1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9]),
    ]
}

/// Along an axis, from one lattice point to another, next to an axis, or anywhere; of any length but 0.
fn direction() -> impl Strategy<Value = DVec3> {
    let along = prop::sample::select(vec![
        DVec3::X,
        DVec3::NEG_X,
        DVec3::new(0.0, -1.0, -0.0),
        DVec3::new(-0.0, 1.0, 0.0),
        DVec3::Z,
        DVec3::new(-0.0, -0.0, -1.0),
    ]);
    let diagonal = (lattice(), lattice()).prop_map(|(a, b)| a - b);
    let beside = (
        along.clone(),
        vector(1.0),
        prop::sample::select(vec![1e-300, 1e-20, 1e-9]),
    )
        .prop_map(|(along, off, tiny)| along + off * tiny);
    let length = prop_oneof![4 => Just(1.0), 1 => Just(1e-6), 1 => Just(1e6)];
    (prop_oneof![along, diagonal, beside, vector(1.0)], length)
        .prop_map(|(dir, length)| dir * length)
        .prop_filter("a direction has a length", |dir| *dir != DVec3::ZERO)
}

fn rays(kind: Kind) -> impl Strategy<Value = Vec<(DVec3, DVec3)>> {
    let origin =
        (prop_oneof![2 => lattice(), 1 => vector(3.0)], size(kind.spread)).prop_map(|(p, far)| p * far);
    prop::collection::vec((origin, direction()), 24)
}

/// All of a hit, so that two can be compared to the last bit.
fn bits(hit: Option<super::super::Hit>) -> Option<(u64, u64, u64, u64, u32)> {
    hit.map(|h| (h.t.to_bits(), h.number, h.u.to_bits(), h.v.to_bits(), h.part))
}

/// Compares every question the world answers with its answer without the tree, along the line from hit to hit.
fn check(world: &World<'_>, origin: DVec3, dir: DVec3) -> Result<(), TestCaseError> {
    let mut probe = Probe::from_space(Ray::new(origin, dir));
    for _ in 0..5 {
        let found = world.nearest_brute(&probe, f64::INFINITY);
        prop_assert_eq!(
            bits(world.nearest(&probe, f64::INFINITY)),
            bits(found),
            "{:?}",
            probe
        );
        prop_assert_eq!(
            world.blocker(&probe, f64::INFINITY) != Blocker::None,
            found.is_some(),
            "{:?}",
            probe
        );
        let Some(hit) = found else { break };
        // To the very number: what lies at t_max counts, what lies one step behind does not.
        for t_max in [
            hit.t,
            hit.t.next_down(),
            hit.t.next_up(),
            hit.t * 0.5,
            hit.t * 2.0,
        ] {
            let found = world.nearest_brute(&probe, t_max);
            prop_assert_eq!(
                bits(world.nearest(&probe, t_max)),
                bits(found),
                "{:?} to {}",
                probe,
                t_max
            );
            prop_assert_eq!(
                world.blocker(&probe, t_max) != Blocker::None,
                found.is_some(),
                "{:?} to {}",
                probe,
                t_max
            );
        }
        let Some(surface) = world.surface(&hit, &probe.ray) else {
            break;
        };
        probe = Probe::from_surface(
            Ray::new(surface.position, dir.normalize()),
            hit.number,
            surface.scale,
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn the_tree_finds_what_brute_force_finds_at_any_scale(
        (groups, root, rays) in kind().prop_flat_map(|kind| (
            prop::collection::vec(things(kind, 5), 0..4),
            things(kind, 20),
            rays(kind),
        )),
        scale in scales(),
    ) {
        let scene = scene(&groups, &root, scale);
        let world = World::compile(&scene).unwrap();
        for (origin, dir) in rays {
            check(&world, origin * scale, dir)?;
        }
    }

    /// Something opaque ends a search for a shadow, whatever transparent things stand about.
    #[test]
    fn an_opaque_blocker_is_told_from_a_transparent_one(
        (root, rays) in kind().prop_flat_map(|kind| (
            prop::collection::vec((things(kind, 3), any::<bool>()), 1..12),
            rays(kind),
        )),
        scale in scales(),
    ) {
        let build = |with_transparent: bool| {
            let mut b = Builder::new();
            b.scale(DVec3::splat(scale)).unwrap();
            for (things, transparent) in &root {
                if *transparent && !with_transparent {
                    continue;
                }
                b.material_mut().transmission = Term::color(DVec3::splat(f64::from(u8::from(*transparent))));
                // A mesh in two materials may let light through until its surface is looked at.
                let things: Vec<Placed> =
                    things.iter().filter(|p| !matches!(p.thing, Thing::Mesh(_))).cloned().collect();
                put(&mut b, &things, 0, false);
            }
            b.finish().value
        };
        let (all, opaque) = (build(true), build(false));
        let (all, opaque) = (World::compile(&all).unwrap(), World::compile(&opaque).unwrap());
        for (origin, dir) in rays {
            let probe = Probe::from_space(Ray::new(origin * scale, dir));
            let nearest = all.nearest_brute(&probe, f64::INFINITY);
            for t_max in [f64::INFINITY, nearest.map_or(1.0, |hit| hit.t * 1.5)] {
                let expected = match (opaque.nearest_brute(&probe, t_max), all.nearest_brute(&probe, t_max)) {
                    (Some(_), _) => Blocker::Opaque,
                    (None, Some(_)) => Blocker::Transparent,
                    (None, None) => Blocker::None,
                };
                prop_assert_eq!(all.blocker(&probe, t_max), expected, "{:?} to {}", probe, t_max);
            }
        }
    }
}

/// The instructions are chosen once in a process, so the other choices need processes of their own.
#[test]
fn other_instructions_pass_the_same_tests() {
    const CHOICE: &str = "RTSCRIPT_SIMD";
    const OTHERS: &[&str] = &["portable", "sse2", "avx512"];
    if std::env::var_os(CHOICE).is_some() {
        return;
    }
    for choice in OTHERS {
        let run = Command::new(std::env::current_exe().unwrap())
            .env(CHOICE, choice)
            .env("RUST_BACKTRACE", "0")
            .args(["render::world::tests::", "--skip", "other_instructions"])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&run.stdout);
        let wrong: Vec<&str> = told.lines().filter(|line| !line.ends_with("... ok")).collect();
        assert!(run.status.success(), "{CHOICE}={choice}: {}", wrong.join("\n"));
        assert!(told.contains("extremes::the_tree_finds"));
    }
}

/// The numbers of its last vertices are too large to stand in blocks.
#[test]
fn a_mesh_of_very_many_vertices_is_hit_at_its_first_and_last_triangle() {
    let count = (1 << 21) + 2;
    let corner = |x: f64, k: u32| DVec3::new(x + f64::from(k % 2), f64::from(k / 2), 0.0);
    let mut positions: Vec<DVec3> = (0..3).map(|k| corner(0.0, k)).collect();
    positions.resize(count as usize - 3, DVec3::ZERO);
    positions.extend((0..3).map(|k| corner(5.0, k)));
    let triangles = vec![[0, 1, 2], [0, 2, count - 1], [count - 3, count - 2, count - 1]];
    let mut b = Builder::new();
    let mesh = Mesh::new("many", positions, triangles).unwrap();
    b.mesh(&std::sync::Arc::new(mesh)).unwrap();
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    for (x, number) in [(0.25, Some(0)), (5.25, Some(2)), (9.0, None)] {
        let probe = Probe::from_space(Ray::new(DVec3::new(x, 0.25, 3.0), DVec3::NEG_Z));
        let hit = world.nearest(&probe, f64::INFINITY);
        assert_eq!(hit.map(|hit| hit.number), number);
        assert_eq!(bits(hit), bits(world.nearest_brute(&probe, f64::INFINITY)));
        let expected = if number.is_some() {
            Blocker::Opaque
        } else {
            Blocker::None
        };
        assert_eq!(world.blocker(&probe, f64::INFINITY), expected);
    }
}
