//! What moves, at each of its times, against the same things standing there.

use std::sync::Arc;

use proptest::prelude::*;

use super::{Thing, placed, vector};
use crate::{
    Builder, DVec3, Scene,
    color::Color,
    math::Ray,
    render::world::{
        World,
        query::{Blocker, Probe},
    },
    scene::{AnimatedTransform, CsgOp, Shutter, Term, Texture},
    shape::{Cuboid, Plane, Shape},
};

/// How far is looked: where a plane is met after a long way is known less well.
const FAR: f64 = 50.0;

#[derive(Clone, Debug)]
struct Moved {
    placed: super::Placed,
    motion: AnimatedTransform,
    /// What stands there, and how it is nested.
    kind: usize,
}

prop_compose! {
    fn motion()(
        translate in prop_oneof![Just(DVec3::ZERO), vector(2.0)],
        axis in vector(1.0).prop_filter("an axis has a length", |axis| axis.length() > 1e-3),
        degrees in prop_oneof![Just(0.0), -400.0..400.0f64],
        scale in prop_oneof![Just(DVec3::ONE), prop::array::uniform3(0.3..3.0f64).prop_map(DVec3::from)],
    ) -> AnimatedTransform {
        AnimatedTransform { translate, axis, degrees, scale }
    }
}

fn moved() -> impl Strategy<Value = Moved> {
    (placed(), motion(), 0..6usize).prop_map(|(placed, motion, kind)| Moved { placed, motion, kind })
}

/// A block that moves, or stands where it is at a time.
fn block(b: &mut Builder, motion: &AnimatedTransform, time: Option<f64>, make: impl FnOnce(&mut Builder)) {
    match time {
        None => {
            let mark = b.begin_moving(*motion).unwrap();
            make(b);
            b.end_moving(mark, true).unwrap();
        }
        Some(time) => {
            let mark = b.begin_group().unwrap();
            b.multiply(motion.at(time)).unwrap();
            make(b);
            b.end_group(mark);
        }
    }
}

fn cuboid(b: &mut Builder, size: f64) {
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::splat(size)).unwrap()))
        .unwrap();
}

/// The things as they move, or as they stand at a time.
fn scene(things: &[Moved], shutter: Shutter, time: Option<f64>) -> Scene {
    let mut b = Builder::new();
    b.shutter(shutter).unwrap();
    // Textures ask where a point is in the space of its shape.
    let checker = b.texture(&Arc::new(Texture::Checker {
        even: Color::ONE,
        odd: Color::ZERO,
        size: 0.1,
    }));
    b.material_mut().diffuse.texture = Some(checker);
    for (i, Moved { placed, motion, kind }) in things.iter().enumerate() {
        let glass = if i % 2 == 0 { 0.5 } else { 0.0 };
        b.material_mut().transmission = Term::color(Color::splat(glass));
        let mark = b.begin_group().unwrap();
        b.translate(placed.translation).unwrap();
        b.rotate(placed.axis, placed.degrees).unwrap();
        b.scale(placed.scale).unwrap();
        match kind {
            0 => block(&mut b, motion, time, |b| match &placed.thing {
                Thing::Instance(_) => b.shape(Shape::Plane(Plane)).unwrap(),
                _ => super::put(b, std::slice::from_ref(placed), 0, false),
            }),
            1 => block(&mut b, motion, time, |b| {
                b.sphere(DVec3::X, 0.4).unwrap();
                block(b, motion, time, |b| cuboid(b, 0.6));
            }),
            2 => {
                let csg = b.begin_csg(CsgOp::Difference).unwrap();
                b.sphere(DVec3::ZERO, 0.8).unwrap();
                block(&mut b, motion, time, |b| cuboid(b, 0.9));
                b.end_csg(csg, true).unwrap();
            }
            3 => block(&mut b, motion, time, |b| {
                let csg = b.begin_csg(CsgOp::Union).unwrap();
                b.sphere(DVec3::ZERO, 0.5).unwrap();
                cuboid(b, 0.85);
                b.end_csg(csg, true).unwrap();
            }),
            4 => {
                let name = format!("g{i}");
                let mark = b.begin_define(&name).unwrap();
                block(&mut b, motion, time, |b| cuboid(b, 0.7));
                b.sphere(DVec3::Y, 0.3).unwrap();
                b.end_define(mark, true);
                b.instance(&name).unwrap();
                b.translate(DVec3::Z * 2.0).unwrap();
                block(&mut b, motion, time, |b| b.instance(&name).unwrap());
            }
            _ => super::put(&mut b, std::slice::from_ref(placed), 0, false),
        }
        b.end_group(mark);
    }
    b.finish().value
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn a_moment_is_what_stands_there_then(
        things in prop::collection::vec(moved(), 1..8),
        (open, close) in prop_oneof![Just((0.0, 1.0)), Just((0.25, 0.5)), Just((0.6, 0.6))],
        share in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64],
        rays in prop::collection::vec((vector(8.0), vector(1.0)), 12),
    ) {
        let shutter = Shutter { open, close };
        let moving = scene(&things, shutter, None);
        let still = scene(&things, shutter, Some(shutter.time(share)));
        let whole = World::compile(&moving).unwrap();
        let (moving, still) = (whole.at_time(share), World::compile(&still).unwrap());
        prop_assert!(!still.moves());
        for (origin, dir) in rays {
            prop_assume!(dir.length() > 1e-3);
            let mut probes = [Probe::from_space(Ray::new(origin, dir.normalize())); 2];
            for _ in 0..4 {
                let [a, b] = [(&moving, &probes[0]), (&still, &probes[1])];
                let (hit, other) = (a.0.nearest(a.1, FAR), b.0.nearest(b.1, FAR));
                let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-7;
                let (Some(hit), Some(other)) = (hit, other) else {
                    prop_assert_eq!(hit.is_some(), other.is_some());
                    prop_assert_eq!(a.0.blocker(a.1, FAR), Blocker::None);
                    break;
                };
                prop_assert!(a.0.leaves_touched(a.1, hit.t) > 0);
                prop_assert!((hit.t - other.t).abs() < 1e-8, "{} {}", hit.t, other.t);
                let (p, q) = (a.0.surface(&hit, &a.1.ray).unwrap(), b.0.surface(&other, &b.1.ray).unwrap());
                prop_assert!(close(p.position, q.position) && close(p.shading_normal, q.shading_normal), "{:?} {:?}", p, q);
                prop_assert!(close(p.object_position(), q.object_position()));
                // Triangles of a random mesh may lie in one another, turned either way.
                let mesh = things.iter().any(|moved| matches!(moved.placed.thing, Thing::Mesh(_)));
                prop_assert!(mesh || p.from_front == q.from_front);
                prop_assert_eq!(&p.material.transmission, &q.material.transmission);
                if let Some(bounds) = moving.bounds() {
                    let (low, high) = (p.position - bounds.min, bounds.max - p.position);
                    prop_assert!(low.min(high).min_element() > -1e-9, "{} {:?}", p.position, bounds);
                }
                prop_assert_eq!(a.0.blocker(a.1, FAR), b.0.blocker(b.1, FAR));
                let share = a.0.share_through(a.1, FAR, None);
                prop_assert_eq!(share, b.0.share_through(b.1, FAR, None));
                prop_assert_eq!(share, a.0.share_by_steps(*a.1, FAR));
                let on = |at: &crate::render::world::SurfacePoint<'_>, number, dir| {
                    Probe::from_surface(Ray::new(at.position, dir), number, at.scale)
                };
                probes = [on(&p, hit.number, a.1.ray.dir), on(&q, other.number, b.1.ray.dir)];
            }
        }
    }

    #[test]
    fn the_tree_finds_what_brute_force_finds_at_all_times(
        things in prop::collection::vec(moved(), 1..12),
        rays in prop::collection::vec((vector(8.0), vector(1.0)), 20),
        share in 0.0..=1.0f64,
    ) {
        let things: Vec<Moved> = things.into_iter().filter(|moved| ![2, 3].contains(&moved.kind)).collect();
        let scene = scene(&things, Shutter::default(), None);
        let world = World::compile(&scene).unwrap().at_time(share);
        for (origin, dir) in rays {
            prop_assume!(dir.length() > 1e-3);
            let probe = Probe::from_space(Ray::new(origin, dir.normalize()));
            let (fast, slow) = (world.nearest(&probe, f64::INFINITY), world.nearest_brute(&probe, f64::INFINITY));
            prop_assert_eq!(fast.map(|h| (h.t.to_bits(), h.number)), slow.map(|h| (h.t.to_bits(), h.number)));
        }
    }
}

#[test]
fn a_world_begins_in_the_middle_and_moves_only_where_something_does() {
    let along = AnimatedTransform {
        translate: DVec3::X * 4.0,
        ..AnimatedTransform::default()
    };
    let hit = |world: &World<'_>, x: f64| {
        let down = Ray::new(DVec3::new(x, 5.0, 0.0), DVec3::NEG_Y);
        world.is_occluded(&down, 9.0)
    };
    for (motion, open, close, moves) in [
        (along, 0.0, 1.0, true),
        (along, 0.5, 0.5, false),
        (AnimatedTransform::default(), 0.0, 1.0, false),
    ] {
        let mut b = Builder::new();
        b.shutter(Shutter { open, close }).unwrap();
        let mark = b.begin_moving(motion).unwrap();
        b.sphere(DVec3::ZERO, 0.5).unwrap();
        b.end_moving(mark, true).unwrap();
        let scene = b.finish().value;
        let world = World::compile(&scene).unwrap();
        assert_eq!(world.moves(), moves);
        assert!(hit(&world, motion.translate.x / 2.0));
        let bounds = world.bounds().unwrap();
        let (from, to) = (motion.translate.x * open - 0.5, motion.translate.x * close + 0.5);
        assert!((bounds.min.x - from).abs() < 1e-6 && (bounds.max.x - to).abs() < 1e-6);
    }
}
