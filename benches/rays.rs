//! Rays per CPU second through a compiled world, on the meshes and ray files of the yardstick harness.
//!
//! usage: `cargo bench --bench rays -- MESH.rtsm RAYDIR [--reps N]`; prints one line of comma-separated values
//! for each set of rays: label, mesh, set, million rays per CPU second (median), hits.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::indexing_slicing)]

use std::{fs, sync::Arc};

use rtscript::{Builder, DVec3, Limits, math::Ray, render::World, scene::Mesh};

fn cpu_seconds() -> f64 {
    let mut t = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: writes into `t` only.
    #[allow(unsafe_code)]
    unsafe {
        libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut t)
    };
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks_exact(4)
        .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
        .collect()
}

struct Shot {
    ray: Ray,
    t_max: f64,
}

fn main() {
    let args: Vec<String> = std::env::args().filter(|a| a != "--bench").collect();
    let [_, mesh_path, ray_dir, rest @ ..] = &args[..] else {
        println!("usage: rays MESH.rtsm RAYDIR [--reps N]");
        return;
    };
    let reps: usize = rest
        .iter()
        .position(|a| a == "--reps")
        .map_or(3, |i| rest[i + 1].parse().unwrap());
    let bytes = fs::read(mesh_path).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let (vertices, triangles) = (word(4), word(8));
    let faces_at = 76 + vertices * 12;
    let positions = numbers(&bytes[76..faces_at])
        .chunks_exact(3)
        .map(|p| DVec3::new(p[0], p[1], p[2]))
        .collect();
    let faces = (0..triangles)
        .map(|i| [0, 1, 2].map(|k| word(faces_at + 12 * i + 4 * k) as u32))
        .collect();
    let name = mesh_path.rsplit('/').next().unwrap().trim_end_matches(".rtsm");
    let mesh = Arc::new(Mesh::new(name, positions, faces).unwrap());
    let mut b = Builder::with_limits(Limits::default());
    b.mesh(&mesh).unwrap();
    let scene = b.finish().value;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let start = cpu_seconds();
    let world = pool.install(|| World::compile(&scene)).unwrap();
    let built = cpu_seconds() - start;
    println!(
        "rtscript,{name},build,{:.1} ms,{:.2} Mtri/s,{:.1} B/tri",
        built * 1e3,
        triangles as f64 / built * 1e-6,
        world.bytes() as f64 / triangles as f64
    );
    for (file, set, any) in [
        ("primary", "primary", false),
        ("ao", "ao", false),
        ("ao", "ao-any", true),
        ("ao", "ao-shuffled", false),
        ("shadow", "shadow", true),
    ] {
        if rest.iter().any(|a| a == "--set") && !rest.iter().any(|a| a == set) {
            continue;
        }
        let raw = numbers(&fs::read(format!("{ray_dir}/{name}.{file}.rays")).unwrap());
        let mut shots: Vec<Shot> = raw
            .chunks_exact(8)
            .map(|c| {
                let (origin, dir) = (DVec3::new(c[0], c[1], c[2]), DVec3::new(c[4], c[5], c[6]));
                // The harness starts rays at t_min; here the start itself is moved there.
                Shot {
                    ray: Ray::new(origin + dir * c[3], dir),
                    t_max: c[7] - c[3],
                }
            })
            .collect();
        if set == "ao-shuffled" {
            let hash = |x: u32| {
                let x = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                let word = ((x >> ((x >> 28) + 4)) ^ x).wrapping_mul(277_803_737);
                (word >> 22) ^ word
            };
            for i in (2..=shots.len()).rev() {
                shots.swap(i - 1, hash(i as u32) as usize % i);
            }
        }
        let mut rates = Vec::new();
        let mut hits = 0;
        for rep in 0..=reps {
            let start = cpu_seconds();
            hits = shots
                .iter()
                .filter(|s| {
                    if any {
                        world.is_occluded(&s.ray, s.t_max)
                    } else {
                        world.nearest_t(&s.ray, s.t_max).is_some()
                    }
                })
                .count();
            if rep > 0 {
                rates.push(shots.len() as f64 / (cpu_seconds() - start) * 1e-6);
            }
        }
        rates.sort_by(f64::total_cmp);
        println!("rtscript,{name},{set},{:.2},{hits}", rates[rates.len() / 2]);
    }
}
