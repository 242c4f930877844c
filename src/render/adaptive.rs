//! Samples where they are needed. Whether a pixel needs more depends on its own samples and the first of its neighbors
//! alone, so neither tiles nor threads nor the part that is rendered change it.

use super::{
    integrator::{self, Counts, Sight, Stack},
    interrupt::Interrupt,
    shots::{Mean, Shots},
    world::{Moments, World},
};
use crate::{
    color::Color,
    scene::{Adaptive, Region},
};

/// What a screen shows between a pixel and its neighbor before either is looked at again, in units of the error.
const CONTRAST: f64 = 8.0;

/// Traces pixels of a picture one by one.
pub(super) struct Pixels<'a> {
    pub(super) world: &'a World<'a>,
    pub(super) shots: &'a Shots<'a>,
    pub(super) adaptive: Adaptive,
    pub(super) interrupt: &'a Interrupt<'a>,
}

/// How a pixel looks after some samples.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    samples: u32,
    sum: Color,
    squares: Color,
}

impl Look {
    /// Adds a sample as a screen would show it.
    fn add(&mut self, light: Color) {
        let shown = Color::from_array(light.to_array().map(|v| {
            let v = if v > 0.0 { v.min(1.0) } else { 0.0 };
            v.sqrt()
        }));
        self.samples += 1;
        self.sum += shown;
        self.squares += shown * shown;
    }

    fn mean(&self) -> Color {
        self.sum / f64::from(self.samples)
    }

    /// Standard error of the mean, of the channel that has the largest.
    fn error(&self) -> f64 {
        let n = f64::from(self.samples);
        let spread = (self.squares - self.sum * self.sum / n) / (n - 1.0);
        (spread.max_element().max(0.0) / n).sqrt()
    }
}

/// A pixel after its first samples, and more where it needs them by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct First {
    /// How it looked after the first samples.
    look: [f32; 3],
    /// Nothing more can be asked of it.
    is_done: bool,
    /// Samples that it has.
    pub(super) samples: u32,
    /// Its value so far.
    pub(super) value: Color,
}

impl First {
    /// Whether its neighbors need not be asked.
    pub(super) fn is_done(&self) -> bool {
        self.is_done
    }
}

impl Pixels<'_> {
    /// The first samples of a pixel, and all that it needs where those are uneven.
    pub(super) fn first(&self, pixel: (u32, u32), stack: &mut Stack, counts: &mut Counts) -> First {
        let (mut mean, mut look) = (Mean::default(), Look::default());
        self.add(pixel, self.first_count(), &mut mean, &mut look, stack, counts);
        let first = look.mean();
        let is_done = self.is_uneven(&look);
        if is_done {
            self.finish(pixel, &mut mean, &mut look, stack, counts);
        }
        First {
            look: first.to_array().map(|v| v as f32),
            is_done: is_done || look.samples == self.shots.samples(),
            samples: look.samples,
            value: mean.value(),
        }
    }

    /// How a pixel looks after its first samples, where nothing else is asked of it.
    pub(super) fn glance(&self, pixel: (u32, u32), stack: &mut Stack, counts: &mut Counts) -> First {
        let (mut mean, mut look) = (Mean::default(), Look::default());
        self.add(pixel, self.first_count(), &mut mean, &mut look, stack, counts);
        First {
            look: look.mean().to_array().map(|v| v as f32),
            is_done: true,
            samples: look.samples,
            value: mean.value(),
        }
    }

    /// The samples and the value of a pixel whose first samples are even, once its neighbors are known.
    pub(super) fn second(
        &self,
        pixel: (u32, u32),
        first: First,
        neighbors: &[First],
        stack: &mut Stack,
        counts: &mut Counts,
    ) -> First {
        let differs = |other: &First| {
            let mut channels = other.look.iter().zip(first.look);
            channels.any(|(a, b)| f64::from(*a - b).abs() > CONTRAST * self.adaptive.error)
        };
        if first.is_done || !neighbors.iter().any(differs) {
            return first;
        }
        let (mut mean, mut look) = (Mean::default(), Look::default());
        let twice = self.first_count().saturating_mul(2).min(self.shots.samples());
        self.add(pixel, twice, &mut mean, &mut look, stack, counts);
        self.finish(pixel, &mut mean, &mut look, stack, counts);
        First {
            samples: look.samples,
            value: mean.value(),
            ..first
        }
    }

    /// All of one pixel, with what it takes of its neighbors.
    pub(super) fn alone(&self, pixel: (u32, u32)) -> First {
        let (mut stack, mut counts) = (Stack::default(), Counts::default());
        let first = self.first(pixel, &mut stack, &mut counts);
        let around: Vec<First> = neighbors(pixel, &self.whole())
            .map(|other| self.glance(other, &mut stack, &mut counts))
            .collect();
        self.second(pixel, first, &around, &mut stack, &mut counts)
    }

    /// The whole picture, in the places of pixels.
    pub(super) fn whole(&self) -> Region {
        self.shots.whole()
    }

    fn first_count(&self) -> u32 {
        self.adaptive.min.min(self.shots.samples())
    }

    fn is_uneven(&self, look: &Look) -> bool {
        // An error of 0 is never reached.
        look.samples > 1 && (look.error() > self.adaptive.error || self.adaptive.error == 0.0)
    }

    /// Twice as many samples, again and again.
    fn finish(
        &self,
        pixel: (u32, u32),
        mean: &mut Mean,
        look: &mut Look,
        stack: &mut Stack,
        counts: &mut Counts,
    ) {
        let all = self.shots.samples();
        while look.samples < all && self.is_uneven(look) && !self.interrupt.poll() {
            let more = look.samples.saturating_mul(2).min(all);
            self.add(pixel, more, mean, look, stack, counts);
        }
    }

    /// Traces samples until there are `up_to`.
    fn add(
        &self,
        pixel: (u32, u32),
        up_to: u32,
        mean: &mut Mean,
        look: &mut Look,
        stack: &mut Stack,
        counts: &mut Counts,
    ) {
        let eyes = self.shots.eyes();
        let mut moments = Moments::new(self.world);
        while look.samples < up_to && !self.interrupt.is_stopped() {
            let mut seen = Color::ZERO;
            for eye in 0..eyes {
                let shot = self.shots.shot(pixel, look.samples * eyes + eye);
                let light = shot.probe.map_or(Color::ZERO, |probe| {
                    let world = moments.at(&shot);
                    integrator::radiance(
                        world,
                        Sight::new(world, &probe),
                        shot.sampler,
                        self.interrupt,
                        stack,
                        counts,
                        &mut (),
                    )
                });
                mean.add(light, shot.weight);
                seen += light * shot.weight.abs();
            }
            look.add(seen);
        }
    }
}

/// The up to eight pixels around one.
pub(super) fn neighbors((x, y): (u32, u32), whole: &Region) -> impl Iterator<Item = (u32, u32)> + use<> {
    let whole = *whole;
    (0..9).filter(|i| *i != 4).filter_map(move |i| {
        let place = (
            x.wrapping_add(i % 3).wrapping_sub(1),
            y.wrapping_add(i / 3).wrapping_sub(1),
        );
        let inside = |at: u32, low: u32, count: u32| at.wrapping_sub(low) < count;
        let is_there = inside(place.0, whole.x, whole.width) && inside(place.1, whole.y, whole.height);
        is_there.then_some(place)
    })
}
