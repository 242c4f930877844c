//! A picture in tiles over all threads. Each pixel depends on its place alone, so their order does not matter.

#![allow(
    clippy::indexing_slicing,
    reason = "a buffer has room for the packet it is made for, and tiles are cut from the size of the picture"
)]

use std::{
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use rayon::prelude::*;

use super::{
    Progress, RenderOptions, Tile,
    film::Image,
    integrator::{self, Counts, Stack},
    interrupt::Interrupt,
    sampler::{Sampler, mix, stratified},
    world::{PACKET, Probe, World},
};
use crate::{
    color::Color,
    diag::{Diagnostic, Error, ErrorKind},
    host::Host,
    scene::{CameraFrame, Settings},
};

/// Edge of a tile in pixels unless the options say otherwise: small enough that no thread idles at the end.
const TILE: u32 = 16;
/// Largest edge of a tile that the options may ask for.
const MOST_TILE: u32 = 1024;

/// Traces every pixel of a picture of this size and with so many samples, whatever the scene's own settings say of
/// those.
///
/// # Errors
/// Where the host asked to stop or a limit of `options` is passed.
pub(super) fn trace(
    world: &World<'_>,
    s: &Settings,
    options: &RenderOptions,
    host: &dyn Host,
    interrupt: &Interrupt<'_>,
) -> Result<(Image, Counts), Error> {
    let total = u64::from(s.width) * u64::from(s.height);
    let frame = world.scene.camera.frame(s.width, s.height);
    let progress = Mutex::new(Progress {
        done: 0,
        total,
        rays: 0,
    });
    let finished = Mutex::new((vec![[0.0; 3]; total as usize], Counts::default()));
    let edge = match options.tile {
        0 => TILE,
        edge => edge.min(MOST_TILE),
    };
    let mut tiles = from_the_middle(s.width.div_ceil(edge), s.height.div_ceil(edge));
    if let Some(seed) = options.shuffle {
        shuffle(&mut tiles, seed);
    }
    let next = AtomicUsize::new(0);

    // Each thread takes the next tile when it is done with one, so at the end none waits for more than a tile.
    (0..rayon::current_num_threads()).into_par_iter().for_each(|_| {
        let (mut own, mut stack) = (Counts::default(), Stack::default());
        let mut tile = vec![[0.0; 3]; (edge.min(s.width) * edge.min(s.height)) as usize];
        'tiles: while let Some(&(column, row)) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (x0, y0) = (column * edge, row * edge);
            let (columns, rows) = (edge.min(s.width - x0), edge.min(s.height - y0));
            if let Some(seed) = options.shuffle {
                give_way(seed, (column, row));
            }
            let before = own.total();
            for square in squares((columns, rows), s.samples) {
                if interrupt.poll() {
                    break 'tiles;
                }
                let counted = own.total();
                Square {
                    world,
                    settings: s,
                    frame: &frame,
                    interrupt,
                    at: (x0 + square.left, y0 + square.top),
                    size: (square.columns, square.rows),
                }
                .trace(&mut stack, &mut own, |i, mean| {
                    let (x, y) = (square.left + i % square.columns, square.top + i / square.columns);
                    tile[(y * columns + x) as usize] = mean.to_array();
                });
                if options.rays.is_some() {
                    interrupt.count(own.total() - counted);
                }
            }
            if let Some(seed) = options.shuffle {
                give_way(!seed, (column, row));
            }
            if let Ok(mut finished) = finished.lock() {
                let lines = tile.chunks(columns as usize).take(rows as usize);
                for (line, y) in lines.zip(y0 as usize..) {
                    let start = y * s.width as usize + x0 as usize;
                    finished.0[start..start + line.len()].copy_from_slice(line);
                }
            }
            // Told under the lock, so that the host hears of more each time, and last of all pixels.
            if let Ok(mut progress) = progress.lock() {
                progress.done += u64::from(rows * columns);
                progress.rays += own.total() - before;
                host.tile(&Tile {
                    x: x0,
                    y: y0,
                    width: columns,
                    height: rows,
                    pixels: tile.get(..(rows * columns) as usize).unwrap_or_default(),
                });
                host.progress(&progress);
            }
        }
        if let Ok(mut finished) = finished.lock() {
            finished.1.add(&own);
        }
    });
    if interrupt.is_stopped() {
        return Err(interrupt.reason().into());
    }
    let (pixels, counts) = finished
        .into_inner()
        .map_err(|_| Diagnostic::error(ErrorKind::Internal, "a thread of the render failed"))?;
    Ok((Image::new(s.width, s.height, s.encoding, pixels), counts))
}

/// Columns and rows of all tiles in rings around the middle, where a picture has its subject; along a ring from
/// neighbor to neighbor, which finds in the caches what the last one left there.
fn from_the_middle(columns: u32, rows: u32) -> Vec<(u32, u32)> {
    let mut tiles: Vec<(u32, u32)> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .collect();
    tiles.sort_unstable_by_key(|&(column, row)| {
        // In half tiles from the middle.
        let x = 2 * i64::from(column) + 1 - i64::from(columns);
        let y = 2 * i64::from(row) + 1 - i64::from(rows);
        let ring = x.abs().max(y.abs());
        let along = if y == -ring {
            x
        } else if x == ring {
            2 * ring + y
        } else if y == ring {
            4 * ring - x
        } else {
            6 * ring - y
        };
        (ring, along)
    });
    tiles
}

/// Brings the tiles into an order drawn from `seed`.
fn shuffle(tiles: &mut [(u32, u32)], seed: u64) {
    tiles.sort_by_cached_key(|&(column, row)| (draw(seed, column, row), column, row));
}

/// Lets other threads go first, up to 15 times over.
fn give_way(seed: u64, (column, row): (u32, u32)) {
    for _ in 0..draw(seed, row, column) % 16 {
        thread::yield_now();
    }
}

fn draw(seed: u64, a: u32, b: u32) -> u64 {
    mix(mix(seed ^ u64::from(a)) ^ u64::from(b))
}

/// Samples of one pixel between two looks at the interrupt.
const SAMPLES_PER_POLL: u32 = 16;

/// Part of a tile.
struct Part {
    left: u32,
    top: u32,
    columns: u32,
    rows: u32,
}

/// A tile in squares whose camera rays fill a packet: the smaller the square, the closer the rays.
fn squares((columns, rows): (u32, u32), samples: u32) -> impl Iterator<Item = Part> {
    let edge = [8, 4, 2]
        .into_iter()
        .find(|edge| samples <= PACKET as u32 / (edge * edge))
        .unwrap_or(1);
    let tops = (0..rows).step_by(edge as usize);
    tops.flat_map(move |top| {
        let lefts = (0..columns).step_by(edge as usize);
        lefts.map(move |left| Part {
            left,
            top,
            columns: edge.min(columns - left),
            rows: edge.min(rows - top),
        })
    })
}

/// Pixels whose camera rays are traced together.
struct Square<'a> {
    world: &'a World<'a>,
    settings: &'a Settings,
    frame: &'a CameraFrame,
    interrupt: &'a Interrupt<'a>,
    /// The pixel in its upper left corner.
    at: (u32, u32),
    /// Columns and rows.
    size: (u32, u32),
}

impl Square<'_> {
    /// Calls `visit` with each pixel's place, counted row by row, and the mean of its samples, summed in order.
    fn trace(&self, stack: &mut Stack, counts: &mut Counts, mut visit: impl FnMut(u32, Color)) {
        let samples = self.settings.samples;
        let pixels = self.size.0 * self.size.1;
        let mut sums = [Color::ZERO; PACKET];
        let at_once = (PACKET as u32 / pixels.max(1)).max(1);
        for first in (0..samples).step_by(at_once as usize) {
            let indices = first..samples.min(first + at_once);
            let count = (indices.end - indices.start) as usize;
            let shot = |i: usize| self.shot((i / count) as u32, first + (i % count) as u32);
            let (probe, sampler) = shot(0);
            let (mut probes, mut samplers) = ([probe; PACKET], [sampler; PACKET]);
            let len = PACKET.min(pixels as usize * count);
            for i in 1..len {
                (probes[i], samplers[i]) = shot(i);
            }
            let mut hits = [None; PACKET];
            let hits = &mut hits[..len];
            self.world.nearest_many(&probes[..len], f64::INFINITY, hits);
            for (((probe, sampler), hit), i) in probes.iter().zip(&samplers).zip(hits).zip(0..) {
                let index = first + (i % count) as u32;
                if index % SAMPLES_PER_POLL == SAMPLES_PER_POLL - 1 && self.interrupt.poll() {
                    return;
                }
                let seen = (*probe, *hit);
                let light =
                    integrator::radiance(self.world, seen, *sampler, self.interrupt, stack, counts, &mut ());
                sums[i / count] += light;
            }
        }
        for (sum, i) in sums.into_iter().zip(0..pixels) {
            visit(i, sum / f64::from(samples));
        }
    }

    /// The camera ray of a pixel's sample.
    fn shot(&self, pixel: u32, index: u32) -> (Probe, Sampler) {
        let place = (self.at.0 + pixel % self.size.0, self.at.1 + pixel / self.size.0);
        shot(self.settings, self.frame, place, index)
    }
}

/// The camera ray of a sample of the pixel in this column and row.
pub(super) fn shot(s: &Settings, frame: &CameraFrame, (x, y): (u32, u32), index: u32) -> (Probe, Sampler) {
    let sampler = Sampler::new(s.seed, x, y, index);
    let (dx, dy) = stratified(index, s.samples, |dimension| sampler.get(dimension));
    let ray = frame.ray(f64::from(x) + dx, f64::from(y) + dy);
    (Probe::from_space(ray), sampler)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, DVec3, HostError, NoHost, Term, render};

    #[test]
    fn tiles_come_once_each_from_the_middle_on() {
        for (columns, rows) in [(1, 1), (5, 5), (8, 3), (1, 7), (40, 30)] {
            let tiles = from_the_middle(columns, rows);
            let mut sorted = tiles.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), (columns * rows) as usize);
            let (x, y) = tiles[0];
            assert!((2 * x + 1).abs_diff(columns) <= 1 && (2 * y + 1).abs_diff(rows) <= 1);
        }
        let ring = &from_the_middle(5, 5)[1..9];
        assert!(
            ring.windows(2)
                .all(|w| w[0].0.abs_diff(w[1].0) + w[0].1.abs_diff(w[1].1) == 1)
        );
    }

    #[test]
    fn shuffled_tiles_come_once_each_in_another_order_for_each_number() {
        let tiles = from_the_middle(9, 7);
        let orders = [1, 2].map(|seed| {
            let mut shuffled = tiles.clone();
            shuffle(&mut shuffled, seed);
            shuffled
        });
        assert_ne!(orders[0], orders[1]);
        for mut order in orders {
            assert_ne!(order, tiles);
            order.sort_unstable();
            let mut sorted = tiles.clone();
            sorted.sort_unstable();
            assert_eq!(order, sorted);
        }
    }

    #[test]
    fn the_host_hears_of_more_each_time_and_last_of_all() {
        #[derive(Default)]
        struct Listener(Mutex<(Vec<u64>, Vec<[f64; 3]>)>);
        impl Host for Listener {
            fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
                NoHost.read(path, max_bytes)
            }

            fn progress(&self, progress: &Progress) {
                // Long enough for the other threads to finish tiles meanwhile.
                thread::yield_now();
                self.0.lock().unwrap().0.push(progress.done);
            }

            fn tile(&self, tile: &Tile<'_>) {
                let picture = &mut self.0.lock().unwrap().1;
                picture.resize(64 * 48, [-1.0; 3]);
                for (y, row) in (tile.y as usize..).zip(tile.pixels.chunks(tile.width as usize)) {
                    let first = y * 64 + tile.x as usize;
                    picture[first..first + row.len()].copy_from_slice(row);
                }
            }
        }
        let mut b = Builder::new();
        b.size(64, 48).unwrap();
        b.material_mut().ambient = Term::color(DVec3::new(0.5, 0.25, 1.0));
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        let options = RenderOptions {
            threads: 7,
            tile: 5,
            ..RenderOptions::default()
        };
        let host = Listener::default();
        let image = render(&b.finish().value, &options, &host).unwrap().value.image;
        let (heard, picture) = host.0.into_inner().unwrap();
        assert_eq!(heard.len(), 13 * 10);
        assert!(heard.is_sorted_by(|a, b| a < b) && heard.last() == Some(&(64 * 48)));
        assert_eq!(picture, image.pixels());
    }
}
