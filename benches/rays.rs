//! Rays per processor second through a compiled world, for a mesh and rays from files: what `versus/run.py` puts
//! beside other tracers.
//!
//! usage: `cargo bench --bench rays -- MESH.rtsm RAYDIR [--reps N] [--uncut] [--build-only | --packets]`; one line of
//! comma-separated values for the build (seconds, bytes per triangle, triangles) and for each set of rays (million
//! rays per processor second, median; hits; rays). With `--uncut` the tree cuts no triangle in two; with `--packets` camera
//! rays, which the files have in squares of 8 x 8 pixels, and shadow rays to the samples of an area light are traced one by one and in packets.
//! The formats are those that `versus/meshes.py` and `versus/embree.cpp` write.

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

fn hash(x: u32) -> u32 {
    let x = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((x >> ((x >> 28) + 4)) ^ x).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The same rays in an order without any neighbors: the worst case for caches.
fn shuffle(rays: &mut [(Ray, f64)]) {
    for i in (2..=rays.len()).rev() {
        rays.swap(i - 1, hash(i as u32) as usize % i);
    }
}

fn build(scene: &Scene, triangles: usize, uncut: bool, reps: usize) -> World<'_> {
    let pool = one_thread();
    let compile = || {
        if uncut {
            World::compile_uncut(scene)
        } else {
            World::compile(scene)
        }
    };
    let mut times = Vec::new();
    let mut world = None;
    for _ in 0..reps {
        drop(world.take());
        let (took, built) = timed(|| pool.install(compile).unwrap());
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

/// From every 64th point that the camera sees, 8 x 8 jittered samples of a square light around the point light of
/// the shadow rays; its edge is a tenth of the distance to the first point it lights.
fn area_light(world: &World<'_>, primary: &[(Ray, f64)], shadow: &[(Ray, f64)]) -> Vec<(Ray, f64)> {
    let Some((to_light, reach)) = shadow.first() else {
        return Vec::new();
    };
    let light = to_light.at(*reach);
    let edge = 0.1 * (light - to_light.origin).length();
    let mut area = Vec::new();
    for (i, (ray, _)) in primary.iter().enumerate().step_by(64) {
        let Some((t, _)) = world.nearest_t(ray, f64::INFINITY) else {
            continue;
        };
        let start = ray.at(t * (1.0 - 1e-6));
        for cell in 0..64 {
            let jitter = |salt: u32| f64::from(hash(hash(i as u32 * 64 + cell) ^ salt)) / 4_294_967_296.0;
            let (u, v) = (f64::from(cell % 8) + jitter(1), f64::from(cell / 8) + jitter(2));
            let sample = light + DVec3::new(u / 8.0 - 0.5, 0.0, v / 8.0 - 0.5) * edge;
            let distance = (sample - start).length();
            let towards = Ray::new(start, (sample - start) / distance);
            area.push((towards, distance * (1.0 - 1e-7)));
        }
    }
    area
}

/// What is asked about rays.
#[derive(Clone, Copy, PartialEq)]
enum Question {
    Nearest,
    Any,
    NearestInPackets,
    AnyInPackets,
}

/// Rays that are traced together, and how far each reaches.
type Chunk = (Vec<Ray>, Vec<f64>);

fn hits(world: &World<'_>, rays: &[Chunk], question: Question) -> usize {
    let of_chunk = |(rays, t_max): &Chunk| {
        let each = rays.iter().zip(t_max);
        match question {
            Question::Nearest => each
                .filter(|(ray, t_max)| world.nearest_t(ray, **t_max).is_some())
                .count(),
            Question::Any => each
                .filter(|(ray, t_max)| world.is_occluded(ray, **t_max))
                .count(),
            Question::NearestInPackets => world.nearest_t_many(rays, f64::INFINITY).iter().flatten().count(),
            Question::AnyInPackets => world.are_occluded(rays, t_max).iter().filter(|hit| **hit).count(),
        }
    };
    rays.iter().map(of_chunk).sum()
}

/// Rays in the order in which they are, a thousand to a chunk.
fn chunks(rays: &[(Ray, f64)]) -> Vec<Chunk> {
    rays.chunks(1024)
        .map(|chunk| chunk.iter().copied().unzip())
        .collect()
}

fn main() {
    let (mut args, reps) = arguments(3);
    let mut has = |option: &str| {
        let before = args.len();
        args.retain(|arg| arg != option);
        args.len() < before
    };
    let (uncut, build_only, packets) = (has("--uncut"), has("--build-only"), has("--packets"));
    let [mesh_path, ray_dir] = &args[..] else {
        println!(
            "usage: cargo bench --bench rays -- MESH.rtsm RAYDIR [--reps N] [--uncut] [--build-only | --packets]"
        );
        return;
    };
    let mesh = Arc::new(read_mesh(mesh_path));
    let mut b = Builder::with_limits(Limits::default());
    b.mesh(&mesh).unwrap();
    let scene = b.finish().value;
    let world = build(&scene, mesh.triangles.len(), uncut, reps);
    if build_only {
        return;
    }
    let read = |set: &str| read_rays(&format!("{ray_dir}/{}.{set}.rays", mesh.name));
    let (primary, ao, shadow) = (read("primary"), read("ao"), read("shadow"));
    let sets = if packets {
        let area = chunks(&area_light(&world, &primary, &shadow));
        let primary = chunks(&primary);
        vec![
            ("primary", primary.clone(), Question::Nearest),
            ("primary-packet", primary, Question::NearestInPackets),
            ("area", area.clone(), Question::Any),
            ("area-packet", area, Question::AnyInPackets),
        ]
    } else {
        let mut shuffled = ao.clone();
        shuffle(&mut shuffled);
        let [primary, ao, shuffled, shadow] = [primary, ao, shuffled, shadow].map(|rays| chunks(&rays));
        vec![
            ("primary", primary, Question::Nearest),
            ("ao", ao.clone(), Question::Nearest),
            ("ao-any", ao, Question::Any),
            ("ao-shuffled", shuffled, Question::Nearest),
            ("shadow", shadow, Question::Any),
        ]
    };
    for (set, rays, question) in sets {
        let count: usize = rays.iter().map(|(rays, _)| rays.len()).sum();
        let shoot = || hits(&world, &rays, question);
        let met = shoot();
        let times = (0..reps).map(|_| timed(shoot).0).collect();
        println!("{set},{:.3},{met},{count}", count as f64 / median(times) * 1e-6);
    }
}
