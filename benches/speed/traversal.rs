//! Rays through a compiled world.

use std::fmt;

use divan::{Bencher, black_box, counter::ItemsCount};
use rtscript::{Scene, math::Ray, render::World};

use crate::common::scenes;

#[derive(Clone, Copy)]
enum Subject {
    Mesh,
    Spheres,
    Instances,
}

#[derive(Clone, Copy)]
enum Rays {
    Camera,
    Scattered,
}

/// What is shot at, and with what.
#[derive(Clone, Copy)]
struct Case(Subject, Rays);

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            Subject::Mesh => "130,000 triangles, ",
            Subject::Spheres => "100,000 spheres, ",
            Subject::Instances => "10,000 instances, ",
        })?;
        f.write_str(match self.1 {
            Rays::Camera => "camera rays",
            Rays::Scattered => "scattered rays",
        })
    }
}

const CASES: [Case; 6] = [
    Case(Subject::Mesh, Rays::Camera),
    Case(Subject::Mesh, Rays::Scattered),
    Case(Subject::Spheres, Rays::Camera),
    Case(Subject::Spheres, Rays::Scattered),
    Case(Subject::Instances, Rays::Camera),
    Case(Subject::Instances, Rays::Scattered),
];

impl Case {
    fn scene(self) -> Scene {
        match self.0 {
            Subject::Mesh => scenes::triangles(130_000),
            Subject::Spheres => scenes::spheres(100_000),
            Subject::Instances => scenes::instances(10_000),
        }
    }

    fn rays(self) -> Vec<Ray> {
        match self.1 {
            Rays::Camera => scenes::camera_rays(256),
            Rays::Scattered => scenes::scattered_rays(256 * 256),
        }
    }

    fn measure(self, bencher: Bencher<'_, '_>, meets: impl Fn(&World<'_>, &Ray) -> bool) {
        let (scene, rays) = (self.scene(), self.rays());
        let world = World::compile(&scene).unwrap();
        bencher
            .counter(ItemsCount::new(rays.len()))
            .bench_local(|| rays.iter().filter(|ray| meets(&world, black_box(ray))).count());
    }
}

#[divan::bench(args = CASES, sample_count = 20)]
fn closest(bencher: Bencher<'_, '_>, case: Case) {
    case.measure(bencher, |world, ray| {
        world.nearest_t(ray, f64::INFINITY).is_some()
    });
}

#[divan::bench(args = CASES, sample_count = 20)]
fn any(bencher: Bencher<'_, '_>, case: Case) {
    case.measure(bencher, |world, ray| world.is_occluded(ray, f64::INFINITY));
}
