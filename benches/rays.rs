//! Rays per processor second through a compiled world, for a mesh and rays from files: what `versus/run.py` puts
//! beside other tracers.
//!
//! usage: `cargo bench --bench rays -- MESH.rtsm RAYDIR [--reps N]`; one line of comma-separated values for the
//! build (seconds, bytes per triangle, triangles) and for each set of rays (million rays per processor second,
//! median; hits; rays). The formats are those that `versus/meshes.py` and `versus/embree.cpp` write.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    clippy::indexing_slicing
)]

mod common;

use std::{fs, sync::Arc};

use common::{arguments, median, one_thread, timed};
use rtscript::{Builder, DVec3, Limits, Scene, math::Ray, render::World, scene::Mesh};

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks_exact(4)
        .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
        .collect()
}

/// Bytes before the vertices: four letters, two counts, sixteen numbers for camera and light.
const HEAD: usize = 76;

fn read_mesh(path: &str) -> Mesh {
    let bytes = fs::read(path).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let (vertices, triangles) = (word(4) as usize, word(8) as usize);
    let faces_at = HEAD + vertices * 12;
    let positions = numbers(&bytes[HEAD..faces_at])
        .chunks_exact(3)
        .map(|p| DVec3::new(p[0], p[1], p[2]))
        .collect();
    let faces = (0..triangles)
        .map(|i| [0, 1, 2].map(|k| word(faces_at + 12 * i + 4 * k)))
        .collect();
    let name = path.rsplit('/').next().unwrap().trim_end_matches(".rtsm");
    Mesh::new(name, positions, faces).unwrap()
}

/// Rays with how far they reach.
fn read_rays(path: &str) -> Vec<(Ray, f64)> {
    numbers(&fs::read(path).unwrap())
        .chunks_exact(8)
        .map(|c| {
            let (origin, dir) = (DVec3::new(c[0], c[1], c[2]), DVec3::new(c[4], c[5], c[6]));
            // The files start rays at a least distance; here the start itself is moved there.
            (Ray::new(origin + dir * c[3], dir), c[7] - c[3])
        })
        .collect()
}

/// The same rays in an order without any neighbors: the worst case for caches.
fn shuffle(rays: &mut [(Ray, f64)]) {
    let hash = |x: u32| {
        let x = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((x >> ((x >> 28) + 4)) ^ x).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    for i in (2..=rays.len()).rev() {
        rays.swap(i - 1, hash(i as u32) as usize % i);
    }
}

fn build(scene: &Scene, triangles: usize, reps: usize) -> World<'_> {
    let pool = one_thread();
    let mut times = Vec::new();
    let mut world = None;
    for _ in 0..reps {
        drop(world.take());
        let (took, built) = timed(|| pool.install(|| World::compile(scene)).unwrap());
        times.push(took);
        world = Some(built);
    }
    let world = world.unwrap();
    println!(
        "build,{:.6},{:.1},{triangles}",
        median(times),
        world.bytes() as f64 / triangles as f64
    );
    world
}

fn main() {
    let (args, reps) = arguments(3);
    let [mesh_path, ray_dir] = &args[..] else {
        println!("usage: cargo bench --bench rays -- MESH.rtsm RAYDIR [--reps N]");
        return;
    };
    let mesh = Arc::new(read_mesh(mesh_path));
    let mut b = Builder::with_limits(Limits::default());
    b.mesh(&mesh).unwrap();
    let scene = b.finish().value;
    let world = build(&scene, mesh.triangles.len(), reps);
    for (file, set, any) in [
        ("primary", "primary", false),
        ("ao", "ao", false),
        ("ao", "ao-any", true),
        ("ao", "ao-shuffled", false),
        ("shadow", "shadow", true),
    ] {
        let mut rays = read_rays(&format!("{ray_dir}/{}.{file}.rays", mesh.name));
        if set == "ao-shuffled" {
            shuffle(&mut rays);
        }
        let shoot = || {
            let hit = |(ray, t_max): &&(Ray, f64)| {
                if any {
                    world.is_occluded(ray, *t_max)
                } else {
                    world.nearest_t(ray, *t_max).is_some()
                }
            };
            rays.iter().filter(hit).count()
        };
        let hits = shoot();
        let times = (0..reps).map(|_| timed(shoot).0).collect();
        println!(
            "{set},{:.3},{hits},{}",
            rays.len() as f64 / median(times) * 1e-6,
            rays.len()
        );
    }
}
