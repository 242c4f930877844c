//! A picture in tiles over all threads. Each pixel depends on its place alone, so their order does not matter.

#![allow(
    clippy::indexing_slicing,
    reason = "tiles are cut from the size of the picture"
)]

use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use rayon::prelude::*;

use super::{
    Progress, RenderOptions, Tile,
    adaptive::{First, Pixels, neighbors},
    film::Image,
    integrator::{Counts, Stack},
    interrupt::Interrupt,
    sampler::mix,
    shots::Shots,
    square::{Room, Square},
    world::{PACKET, World},
};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::Host,
    scene::Settings,
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
pub(super) fn trace<'w>(
    world: &World<'w>,
    s: &Settings,
    options: &RenderOptions,
    host: &dyn Host,
    interrupt: &Interrupt<'_>,
) -> Result<(Image, Counts), Error> {
    let region = s.region();
    let size = (region.width, region.height);
    let shots = Shots::into_world(world, s);
    let (pixels, counts) = match s.adaptive {
        Some(adaptive) => {
            let pixels = Pixels {
                world,
                shots: &shots,
                adaptive,
                interrupt,
            };
            trace_adaptive(&pixels, size, options, host)?
        }
        None => {
            let told = Told::new(host, region.pixels(), (0, 1));
            let work = |area: &Area, pixels: &mut [[f64; 3]], room: &mut Room<'w>, own: &mut Counts| {
                for square in squares((area.columns, area.rows), shots.count()) {
                    if interrupt.poll() {
                        return false;
                    }
                    let counted = own.total();
                    Square {
                        world,
                        shots: &shots,
                        interrupt,
                        at: (area.x + square.left, area.y + square.top),
                        size: (square.columns, square.rows),
                    }
                    .trace(room, own, |(x, y), mean| {
                        let (x, y) = (square.left + x, square.top + y);
                        pixels[(y * area.columns + x) as usize] = mean.to_array();
                    });
                    if options.rays.is_some() {
                        interrupt.count(own.total() - counted);
                    }
                }
                true
            };
            over_tiles(
                size,
                options,
                interrupt,
                || Room::new(world),
                work,
                |area, pixels, rays| {
                    told.tile(area, pixels, rays);
                },
            )?
        }
    };
    Ok((Image::new(size.0, size.1, s.encoding, pixels), counts))
}

/// The first samples of all pixels, then those of the pixels that their neighbors ask for.
fn trace_adaptive(
    pixels: &Pixels<'_>,
    size: (u32, u32),
    options: &RenderOptions,
    host: &dyn Host,
) -> Result<(Vec<[f64; 3]>, Counts), Error> {
    let total = u64::from(size.0) * u64::from(size.1);
    let interrupt = pixels.interrupt;
    // Most of the work is in the first round, as far as anybody can know.
    let told = Told::new(host, total, (0, 9));
    let counted = |own: &Counts, before: u64| {
        if options.rays.is_some() {
            interrupt.count(own.total() - before);
        }
        !interrupt.poll()
    };
    let first = |area: &Area, found: &mut [First], stack: &mut Stack, own: &mut Counts| {
        found.iter_mut().zip(0..).all(|(found, i)| {
            let before = own.total();
            *found = pixels.first(area.place(i), stack, own);
            counted(own, before)
        })
    };
    let (grid, mut counts) = over_tiles(
        size,
        options,
        interrupt,
        Stack::default,
        first,
        |area, _, rays| {
            told.progress(area, rays);
        },
    )?;
    let told = told.after((9, 10));
    let second = |area: &Area, values: &mut [[f64; 3]], stack: &mut Stack, own: &mut Counts| {
        values.iter_mut().zip(0..).all(|(value, i)| {
            let (place, before) = (area.place(i), own.total());
            let known = |(x, y): (u32, u32)| {
                let is_inside = x < size.0 && y < size.1;
                is_inside.then(|| grid[y as usize * size.0 as usize + x as usize])
            };
            let mut found = known(place).unwrap_or_default();
            if !found.is_done() {
                let around: Vec<First> = neighbors(place, &pixels.whole())
                    .map(|other| known(other).unwrap_or_else(|| pixels.glance(other, stack, own)))
                    .collect();
                found = pixels.second(place, found, &around, stack, own);
            }
            *value = found.value.to_array();
            counted(own, before)
        })
    };
    let (values, more) = over_tiles(
        size,
        options,
        interrupt,
        Stack::default,
        second,
        |area, values, rays| {
            told.tile(area, values, rays);
        },
    )?;
    counts.add(&more);
    Ok((values, counts))
}

/// What the host is told while a picture is traced.
struct Told<'h> {
    host: &'h dyn Host,
    progress: Mutex<(u64, Progress)>,
    /// The part of the whole work that this is: from so many parts on to so many, of the latter or of ten.
    part: (u64, u64),
}

impl<'h> Told<'h> {
    fn new(host: &'h dyn Host, total: u64, part: (u64, u64)) -> Self {
        let progress = Progress {
            done: 0,
            total,
            rays: 0,
        };
        Self {
            host,
            progress: Mutex::new((0, progress)),
            part,
        }
    }

    /// The same with the next part.
    fn after(self, part: (u64, u64)) -> Self {
        let progress = self
            .progress
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .1;
        Self {
            host: self.host,
            progress: Mutex::new((0, progress)),
            part,
        }
    }

    /// A tile is finished. Told under the lock, so that the host hears of more each time, and last of all pixels.
    fn tile(&self, area: &Area, pixels: &[[f64; 3]], rays: u64) {
        if let Ok(mut progress) = self.progress.lock() {
            self.host.tile(&Tile {
                x: area.x,
                y: area.y,
                width: area.columns,
                height: area.rows,
                pixels,
            });
            self.advance(&mut progress, area, rays);
        }
    }

    /// A tile is done with, not finished.
    fn progress(&self, area: &Area, rays: u64) {
        if let Ok(mut progress) = self.progress.lock() {
            self.advance(&mut progress, area, rays);
        }
    }

    fn advance(&self, (pixels, progress): &mut (u64, Progress), area: &Area, rays: u64) {
        let ((from, to), total) = (self.part, progress.total);
        *pixels += u64::from(area.columns * area.rows);
        let of = if to == 1 { 1 } else { 10 };
        progress.done = total * from / of + *pixels * (to - from) / of;
        if *pixels == total && to == of {
            progress.done = total;
        }
        progress.rays += rays;
        self.host.progress(progress);
    }
}

/// A tile.
struct Area {
    x: u32,
    y: u32,
    columns: u32,
    rows: u32,
}

impl Area {
    /// Where a pixel of it lies, counted row by row.
    fn place(&self, i: u32) -> (u32, u32) {
        (self.x + i % self.columns, self.y + i / self.columns)
    }
}

/// Has all tiles worked on, on all threads. `work` fills in the pixels of a tile and says whether it was not stopped; it
/// has what `keep` makes for each thread. `told` hears of each that is done, with the rays that it took.
fn over_tiles<T: Copy + Default + Send, K>(
    (width, height): (u32, u32),
    options: &RenderOptions,
    interrupt: &Interrupt<'_>,
    keep: impl Fn() -> K + Sync,
    work: impl Fn(&Area, &mut [T], &mut K, &mut Counts) -> bool + Sync,
    told: impl Fn(&Area, &[T], u64) + Sync,
) -> Result<(Vec<T>, Counts), Error> {
    let total = width as usize * height as usize;
    let finished = Mutex::new((vec![T::default(); total], Counts::default()));
    let edge = match options.tile {
        0 => TILE,
        edge => edge.min(MOST_TILE),
    };
    let mut tiles = from_the_middle(width.div_ceil(edge), height.div_ceil(edge));
    if let Some(seed) = options.shuffle {
        shuffle(&mut tiles, seed);
    }
    let next = AtomicUsize::new(0);

    // Each thread takes the next tile when it is done with one, so at the end none waits for more than a tile.
    (0..rayon::current_num_threads()).into_par_iter().for_each(|_| {
        let (mut own, mut kept) = (Counts::default(), keep());
        let mut tile = vec![T::default(); (edge.min(width) * edge.min(height)) as usize];
        while let Some(&(column, row)) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (x, y) = (column * edge, row * edge);
            let area = Area {
                x,
                y,
                columns: edge.min(width - x),
                rows: edge.min(height - y),
            };
            if let Some(seed) = options.shuffle {
                give_way(seed, (column, row));
            }
            let before = own.total();
            let pixels = &mut tile[..(area.columns * area.rows) as usize];
            if !work(&area, pixels, &mut kept, &mut own) {
                break;
            }
            if let Some(seed) = options.shuffle {
                give_way(!seed, (column, row));
            }
            if let Ok(mut finished) = finished.lock() {
                for (line, y) in pixels.chunks(area.columns as usize).zip(y as usize..) {
                    let start = y * width as usize + x as usize;
                    finished.0[start..start + line.len()].copy_from_slice(line);
                }
            }
            told(&area, pixels, own.total() - before);
        }
        if let Ok(mut finished) = finished.lock() {
            finished.1.add(&own);
        }
    });
    if interrupt.is_stopped() {
        return Err(interrupt.reason().into());
    }
    finished
        .into_inner()
        .map_err(|_| Diagnostic::error(ErrorKind::Internal, "a thread of the render failed").into())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, DVec3, NoHost, Term, host::HostError, render};

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
