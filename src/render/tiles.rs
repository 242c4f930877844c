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
    world::{PACKET, Probe, World},
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
                    let tile = Tile {
                        world,
                        frame: &frame,
                        interrupt: &interrupt,
                        at: (x0, y0),
                        size: (columns, rows),
                    }
                    .trace(&mut own);
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

/// Part of the picture.
struct Tile<'a> {
    world: &'a World<'a>,
    frame: &'a CameraFrame,
    interrupt: &'a Interrupt<'a>,
    /// The pixel in its upper left corner.
    at: (u32, u32),
    /// Columns and rows.
    size: (u32, u32),
}

impl Tile<'_> {
    /// All pixels, row by row. They are traced in squares whose camera rays fill a packet: the smaller the square, the
    /// closer the rays.
    fn trace(&self, counts: &mut Counts) -> Vec<[f64; 3]> {
        let (columns, rows) = self.size;
        let edge = [8, 4, 2, 1]
            .into_iter()
            .find(|edge| edge * edge * self.world.scene.settings.samples as usize <= PACKET)
            .unwrap_or(1);
        let mut pixels = vec![[0.0; 3]; (columns * rows) as usize];
        for top in (0..rows).step_by(edge) {
            for left in (0..columns).step_by(edge) {
                let width = (edge as u32).min(columns - left);
                let square: Vec<(u32, u32)> = (0..width * (edge as u32).min(rows - top))
                    .map(|i| (left + i % width, top + i / width))
                    .collect();
                for (&(x, y), mean) in square.iter().zip(self.square(&square, counts)) {
                    pixels[(y * columns + x) as usize] = mean.to_array();
                }
            }
        }
        pixels
    }

    /// The mean of each pixel's samples, summed in order.
    fn square(&self, pixels: &[(u32, u32)], counts: &mut Counts) -> [Color; PACKET] {
        let s = &self.world.scene.settings;
        let mut sums = [Color::ZERO; PACKET];
        let at_once = (PACKET / pixels.len().max(1)) as u32;
        for first in (0..s.samples).step_by(at_once.max(1) as usize) {
            let indices = first..s.samples.min(first + at_once);
            let shots: Vec<(Probe, Sampler)> = pixels
                .iter()
                .flat_map(|&pixel| indices.clone().map(move |index| self.shot(pixel, index)))
                .collect();
            let probes: Vec<Probe> = shots.iter().map(|(probe, _)| *probe).collect();
            let mut hits = [None; PACKET];
            let hits = &mut hits[..probes.len()];
            self.world.nearest_many(&probes, f64::INFINITY, hits);
            let mut shots = shots.iter().zip(hits);
            for sum in &mut sums[..pixels.len()] {
                for (index, ((probe, sampler), hit)) in indices.clone().zip(&mut shots) {
                    let polls = index % SAMPLES_PER_POLL == SAMPLES_PER_POLL - 1;
                    if polls && self.interrupt.poll() {
                        return sums;
                    }
                    *sum += integrator::radiance(self.world, *probe, *hit, *sampler, self.interrupt, counts);
                }
            }
        }
        sums.map(|sum| sum / f64::from(s.samples))
    }

    /// The camera ray of a pixel's sample.
    fn shot(&self, (x, y): (u32, u32), index: u32) -> (Probe, Sampler) {
        let s = &self.world.scene.settings;
        let (x, y) = (self.at.0 + x, self.at.1 + y);
        let sampler = Sampler::new(s.seed, x, y, index);
        let (dx, dy) = stratified(index, s.samples, |dimension| sampler.get(dimension));
        let ray = self.frame.ray(f64::from(x) + dx, f64::from(y) + dy);
        (Probe::from_space(ray), sampler)
    }
}
