//! Pixels of a tile whose camera rays are traced together.

#![allow(
    clippy::indexing_slicing,
    reason = "a buffer has room for the packet it is made for"
)]

use super::{
    integrator::{self, Counts, Sight, Stack},
    interrupt::Interrupt,
    lighting::Ahead,
    shots::{Mean, Shot, Shots},
    world::{Hit, Moments, PACKET, Probe, World},
};
use crate::color::Color;

/// Samples of one pixel between two looks at the interrupt.
const SAMPLES_PER_POLL: u32 = 16;

/// Pixels whose camera rays are traced together.
pub(super) struct Square<'a, 'w> {
    pub(super) world: &'a World<'w>,
    pub(super) shots: &'a Shots<'a>,
    pub(super) interrupt: &'a Interrupt<'a>,
    /// The pixel in its upper left corner.
    pub(super) at: (u32, u32),
    /// Columns and rows.
    pub(super) size: (u32, u32),
}

/// What a thread keeps from one square to the next, so that none of them allocates or clears memory.
pub(super) struct Room<'w> {
    probes: Vec<Probe>,
    met: Met<'w>,
    stack: Stack,
}

impl<'w> Room<'w> {
    pub(super) fn new(world: &World<'w>) -> Self {
        Self {
            probes: Vec::with_capacity(PACKET),
            met: Met::new(world),
            stack: Stack::default(),
        }
    }
}

/// One of a square's camera rays.
struct Which {
    /// The pixel's number in the square.
    pixel: usize,
    /// Its place in the picture.
    place: (u32, u32),
    /// The ray's number there.
    index: u32,
}

/// What camera rays meet that are traced together.
struct Met<'w> {
    hits: [Option<Hit>; PACKET],
    /// Where it is of use to know all points before the first is shaded.
    ahead: Option<Ahead<'w>>,
}

impl<'w> Met<'w> {
    fn new(world: &World<'w>) -> Self {
        Self {
            hits: [None; PACKET],
            ahead: Ahead::is_of_use(world).then(Ahead::default),
        }
    }

    /// Traces up to [`PACKET`] rays.
    fn trace(&mut self, world: &World<'w>, probes: &[Probe], interrupt: &Interrupt<'_>, counts: &mut Counts) {
        let hits = &mut self.hits[..probes.len()];
        world.nearest_many(probes, f64::INFINITY, hits);
        if let Some(ahead) = &mut self.ahead {
            ahead.look(world, probes, hits, interrupt, &mut counts.luck);
        }
    }

    /// Ray `i` of those, which is this one.
    #[inline(always)]
    fn first<'a>(&'a self, i: usize, probe: &'a Probe) -> Sight<'w, 'a> {
        Sight {
            probe,
            hit: self.hits[i],
            ahead: self.ahead.as_ref().and_then(|ahead| ahead.of(i)),
        }
    }
}

/// The pixels of a square in the order in which their rays are traced: of a whole one in patches of 4 x 2, as many as a
/// register has rays, since these meet fewer boxes than a line of 8; of others row by row.
pub(super) struct Patches {
    /// Columns and rows.
    pub(super) size: (u32, u32),
    places: [(u8, u8); PACKET],
}

impl Patches {
    /// Of a square of so many columns and rows, [`PACKET`] pixels at the most.
    pub(super) fn new((columns, rows): (u32, u32)) -> Self {
        let is_whole = columns == 8 && rows.is_multiple_of(2);
        let mut places = [(0, 0); PACKET];
        for (place, i) in places.iter_mut().zip(0..columns * rows) {
            let (x, y) = if is_whole {
                // The bits of i from the lowest: two of x, one of y, one of x, the others of y.
                (i & 3 | i >> 1 & 4, i >> 2 & 1 | i >> 4 << 1)
            } else {
                (i % columns, i / columns)
            };
            *place = (x as u8, y as u8);
        }
        Self {
            size: (columns, rows),
            places,
        }
    }

    /// The column and row of each pixel.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let places = self.places.iter().take((self.size.0 * self.size.1) as usize);
        places.map(|&(x, y)| (x.into(), y.into()))
    }
}

impl<'w> Square<'_, 'w> {
    /// Calls `visit` with each pixel's column and row in the square, and the mean of its samples, summed in order.
    pub(super) fn trace(
        &self,
        room: &mut Room<'w>,
        counts: &mut Counts,
        mut visit: impl FnMut((u32, u32), Color),
    ) {
        let patches = Patches::new(self.size);
        if !self.shots.is_plain {
            return self.trace_any(&patches, room, counts, &mut visit);
        }
        let Room { probes, met, stack } = room;
        let samples = self.shots.count();
        let pixels = self.size.0 * self.size.1;
        let nothing = integrator::nothing(self.world);
        let mut sums = [Color::ZERO; PACKET];
        let at_once = (PACKET as u32 / pixels.max(1)).max(1);
        for first in (0..samples).step_by(at_once as usize) {
            let indices = first..samples.min(first + at_once);
            probes.clear();
            self.shots.plain(self.at, &patches, indices.clone(), probes);
            met.trace(self.world, probes, self.interrupt, counts);
            let mut rays = probes.iter().enumerate();
            for (place, sum) in patches.iter().zip(&mut sums) {
                for (index, (i, probe)) in indices.clone().zip(&mut rays) {
                    if index % SAMPLES_PER_POLL == SAMPLES_PER_POLL - 1 && self.interrupt.poll() {
                        return;
                    }
                    if let (None, Some(color)) = (&met.hits[i], nothing) {
                        counts.camera += 1;
                        *sum += color;
                        continue;
                    }
                    *sum += integrator::radiance(
                        self.world,
                        met.first(i, probe),
                        self.shots.plain_sampler(self.in_picture(place), index),
                        self.interrupt,
                        stack,
                        counts,
                        &mut (),
                    );
                }
            }
        }
        for (place, sum) in patches.iter().zip(sums) {
            // A quotient by 1 is the number itself.
            let mean = if samples == 1 {
                sum
            } else {
                sum / f64::from(samples)
            };
            visit(place, mean);
        }
    }

    /// The place in the picture of a pixel in this column and row of the square.
    #[inline(always)]
    fn in_picture(&self, (x, y): (u32, u32)) -> (u32, u32) {
        (self.at.0 + x, self.at.1 + y)
    }

    /// As [`Square::trace`], for cameras and samples of every kind.
    #[cold]
    #[inline(never)]
    fn trace_any(
        &self,
        patches: &Patches,
        room: &mut Room<'w>,
        counts: &mut Counts,
        visit: &mut dyn FnMut((u32, u32), Color),
    ) {
        let mut means = [Mean::default(); PACKET];
        let count = self.shots.count();
        let all = (patches.iter().enumerate()).flat_map(|(pixel, place)| {
            let place = self.in_picture(place);
            (0..count).map(move |index| Which { pixel, place, index })
        });
        let is_done = self.rays(all, room, counts, &mut |pixel, light, weight| {
            means[pixel].add(light, weight);
        });
        if is_done {
            for (place, mean) in patches.iter().zip(&means) {
                visit(place, mean.value());
            }
        }
    }

    /// As [`Square::rays`], where each ray sees another moment of the world.
    #[cold]
    #[inline(never)]
    fn rays_in_time(
        &self,
        which: impl Iterator<Item = Which>,
        stack: &mut Stack,
        counts: &mut Counts,
        seen: &mut dyn FnMut(usize, Color, Color),
    ) -> bool {
        let mut moments = Moments::new(self.world);
        for (Which { pixel, place, index }, n) in which.zip(1..) {
            if n % SAMPLES_PER_POLL == 0 && self.interrupt.poll() {
                return false;
            }
            let shot = self.shots.shot(place, index);
            let world = moments.at(&shot);
            let light = shot.probe.map_or(Color::ZERO, |probe| {
                let first = Sight::new(world, &probe);
                integrator::radiance(world, first, shot.sampler, self.interrupt, stack, counts, &mut ())
            });
            seen(pixel, light, shot.weight);
        }
        true
    }

    /// Traces rays and calls `seen` with each one's pixel, the light and what it counts for, in this order. False where it
    /// was stopped.
    fn rays(
        &self,
        mut which: impl Iterator<Item = Which>,
        Room { probes, met, stack }: &mut Room<'w>,
        counts: &mut Counts,
        seen: &mut dyn FnMut(usize, Color, Color),
    ) -> bool {
        if self.world.moves() {
            return self.rays_in_time(which, stack, counts, seen);
        }
        let mut since_poll = 0;
        let mut shots: Vec<(usize, Shot)> = Vec::with_capacity(PACKET);
        loop {
            shots.clear();
            probes.clear();
            for Which { pixel, place, index } in which.by_ref().take(PACKET) {
                let shot = self.shots.shot(place, index);
                probes.extend(shot.probe);
                shots.push((pixel, shot));
            }
            if shots.is_empty() {
                return true;
            }
            met.trace(self.world, probes, self.interrupt, counts);
            let mut traced = 0;
            for (pixel, shot) in &shots {
                since_poll += 1;
                if since_poll % SAMPLES_PER_POLL == 0 && self.interrupt.poll() {
                    return false;
                }
                let light = shot.probe.map_or(Color::ZERO, |probe| {
                    let first = met.first(traced, &probe);
                    traced += 1;
                    integrator::radiance(
                        self.world,
                        first,
                        shot.sampler,
                        self.interrupt,
                        stack,
                        counts,
                        &mut (),
                    )
                });
                seen(*pixel, light, shot.weight);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_have_every_pixel_once_and_eight_of_a_whole_square_lie_together() {
        for size in [(8, 8), (8, 6), (4, 4), (8, 3), (5, 3), (1, 7), (6, 1), (1, 1)] {
            let mut found: Vec<_> = Patches::new(size).iter().collect();
            if size == (8, 8) {
                for patch in found.chunks(8) {
                    let (x, y) = patch[0];
                    assert!(
                        patch
                            .iter()
                            .all(|p| (x..x + 4).contains(&p.0) && (y..y + 2).contains(&p.1))
                    );
                }
            }
            let all: Vec<_> = (0..size.1)
                .flat_map(|y| (0..size.0).map(move |x| (x, y)))
                .collect();
            found.sort_unstable_by_key(|&(x, y)| (y, x));
            assert_eq!(found, all, "{size:?}");
        }
    }
}
