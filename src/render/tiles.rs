//! A picture in tiles over all threads. Each pixel depends on its place alone, so their order does not matter.

use std::sync::{
    Mutex,
    atomic::{AtomicU64, Ordering},
};

use rayon::prelude::*;

use super::{
    Progress,
    film::Image,
    integrator::{self, Counts},
    interrupt::Interrupt,
    sampler::{Sampler, stratified},
    world::World,
};
use crate::{color::Color, host::Host, scene::CameraFrame};

/// Edge of a tile in pixels: small enough that no thread idles at the end.
const TILE: u32 = 16;

/// Traces every pixel. `None` where the host asked to stop.
pub(super) fn trace(world: &World<'_>, host: &dyn Host) -> Option<(Image, Counts)> {
    let s = &world.scene.settings;
    let total = u64::from(s.width) * u64::from(s.height);
    let frame = world.scene.camera.frame(s.width, s.height);
    let (done, rays, interrupt) = (AtomicU64::new(0), AtomicU64::new(0), Interrupt::new(host));
    let counts = Mutex::new(Counts::default());

    let mut pixels = vec![[0.0; 3]; total as usize];
    let band = TILE as usize * s.width as usize;
    // Rows of tiles own their part of the picture; tiles within a row are joined afterwards, which costs a copy
    // and keeps this free of shared mutable pixels.
    pixels
        .par_chunks_mut(band.max(1))
        .enumerate()
        .for_each(|(row, pixels)| {
            let y0 = row as u32 * TILE;
            let rows = (pixels.len() / s.width as usize) as u32;
            let tiles: Vec<(u32, Vec<[f64; 3]>)> = (0..s.width.div_ceil(TILE))
                .into_par_iter()
                .filter_map(|column| {
                    if interrupt.poll() {
                        return None;
                    }
                    let (x0, columns) = (column * TILE, TILE.min(s.width - column * TILE));
                    let mut own = Counts::default();
                    let tile: Vec<[f64; 3]> = (0..rows * columns)
                        .map(|i| {
                            let at = (x0 + i % columns, y0 + i / columns);
                            pixel(world, &frame, at, &interrupt, &mut own).to_array()
                        })
                        .collect();
                    let finished = u64::from(rows * columns);
                    let progress = Progress {
                        done: done.fetch_add(finished, Ordering::Relaxed) + finished,
                        total,
                        rays: rays.fetch_add(own.total(), Ordering::Relaxed) + own.total(),
                    };
                    host.progress(&progress);
                    if let Ok(mut counts) = counts.lock() {
                        counts.add(&own);
                    }
                    Some((x0, tile))
                })
                .collect();
            for (x0, tile) in tiles {
                let columns = TILE.min(s.width - x0) as usize;
                for (y, line) in tile.chunks(columns).enumerate() {
                    let start = y * s.width as usize + x0 as usize;
                    pixels[start..start + columns].copy_from_slice(line);
                }
            }
        });
    if interrupt.is_stopped() {
        return None;
    }
    let counts = counts.into_inner().unwrap_or_default();
    Some((Image::new(s.width, s.height, s.encoding, pixels), counts))
}

/// Samples of one pixel between two looks at the interrupt.
const SAMPLES_PER_POLL: u32 = 16;

/// The mean of a pixel's samples, summed in order.
fn pixel(
    world: &World<'_>,
    frame: &CameraFrame,
    (x, y): (u32, u32),
    interrupt: &Interrupt<'_>,
    counts: &mut Counts,
) -> Color {
    let s = &world.scene.settings;
    let mut sum = Color::ZERO;
    for index in 0..s.samples {
        if index % SAMPLES_PER_POLL == SAMPLES_PER_POLL - 1 && interrupt.poll() {
            break;
        }
        let sampler = Sampler::new(s.seed, x, y, index);
        let (dx, dy) = stratified(index, s.samples, |dimension| sampler.get(dimension));
        let ray = frame.ray(f64::from(x) + dx, f64::from(y) + dy);
        sum += integrator::radiance(world, ray, sampler, interrupt, counts);
    }
    sum / f64::from(s.samples)
}
