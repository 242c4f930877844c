//! Compiling that is stopped at any of the moments at which it asks.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use super::super::{super::interrupt::Interrupt, World};
use crate::{
    Builder, DVec3, Host, NoHost, RenderOptions, Scene,
    diag::ErrorKind,
    host::HostError,
    math, render,
    render::KeptTrees,
    scene::{Mesh, Term},
    shape::{Cuboid, Shape},
};

/// Asks to stop when it has been asked so often.
struct Patience {
    questions: AtomicU64,
    end: u64,
}

impl Patience {
    fn until(end: u64) -> Self {
        Self {
            questions: AtomicU64::new(0),
            end,
        }
    }
}

impl Host for Patience {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        NoHost.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        self.questions.fetch_add(1, Ordering::Relaxed) >= self.end
    }
}

/// A surface large enough to be built in pieces, walls that are worth cutting, spheres and boxes.
fn scene() -> Scene {
    const N: u32 = 300;
    let mut b = Builder::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let (x, z) = (f64::from(i) * 0.1, f64::from(j) * 0.1);
        positions.push(DVec3::new(x, math::sin_cos_degrees(40.0 * (x + z)).0, z));
        if i > 0 && j > 0 {
            let k = i * N + j;
            triangles.extend([[k, k - 1, k - N - 1], [k, k - N - 1, k - N]]);
        }
    }
    let mesh = Arc::new(Mesh::new("hills", positions, triangles).unwrap());
    b.mesh(&mesh).unwrap();
    b.translate(DVec3::new(0.0, 3.0, 0.0)).unwrap();
    b.mesh(&mesh).unwrap();
    for i in 0..3000 {
        let x = f64::from(i);
        b.sphere(DVec3::new(x * 0.01, 2.0, 0.0), 0.1).unwrap();
        b.translate(DVec3::new(0.01, 0.0, 0.0)).unwrap();
        b.shape(Shape::Cuboid(Cuboid::new(DVec3::new(0.1, 2.0, 9.0)).unwrap()))
            .unwrap();
        b.triangle(
            [
                DVec3::ZERO,
                DVec3::new(0.0, 9.0, 20.0),
                DVec3::new(4.0, 0.0, 20.0),
            ],
            None,
        )
        .unwrap();
    }
    b.finish().value
}

#[test]
fn compiling_ends_soon_after_the_host_asks_to_stop() {
    let scene = scene();
    let whole = Patience::until(u64::MAX);
    World::compile_for(&scene, &whole).unwrap();
    let questions = whole.questions.into_inner();
    assert!(questions > 500, "asked only {questions} times");
    for end in (0..questions / 2).step_by(questions as usize / 40) {
        let host = Patience::until(end);
        let error = World::compile_for(&scene, &host).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled);
        // Each thread may ask once more, and each step on the way out.
        let more = host.questions.into_inner() - end;
        assert!(more < 64, "asked {more} times more after {end}");
    }
}

#[test]
fn trees_that_were_lent_come_back_from_a_compilation_that_was_stopped() {
    let scene = scene();
    let trees = KeptTrees::new();
    trees.take_back(World::compile_keeping(&scene, Some(&trees), &Interrupt::new(&NoHost)).unwrap());
    let built = trees.counts().0;
    // All trees of the first levels are there; the question after them is the last.
    let host = Patience::until(8);
    World::compile_keeping(&scene, Some(&trees), &Interrupt::new(&host)).unwrap_err();
    World::compile_keeping(&scene, Some(&trees), &Interrupt::new(&NoHost)).unwrap();
    assert_eq!(trees.counts().0, built);
}

#[test]
fn instances_that_multiply_without_end_can_be_stopped() {
    let mut b = Builder::new();
    b.size(16, 16).unwrap();
    b.directional(DVec3::Z, DVec3::ONE).unwrap();
    b.material_mut().transmission = Term::color(DVec3::splat(0.5));
    for level in 0..31 {
        let mark = b.begin_define(&format!("level {level}")).unwrap();
        if level == 0 {
            b.shape(Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap())).unwrap();
        } else {
            // In one place, so that no box leaves any of them out.
            (0..4).for_each(|_| b.instance(&format!("level {}", level - 1)).unwrap());
        }
        b.end_define(mark, true);
    }
    b.instance("level 30").unwrap();
    let options = RenderOptions {
        render_time: Some(Duration::from_millis(30)),
        ..RenderOptions::default()
    };
    let error = render(&b.finish().value, &options, &NoHost).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Limit);
}
