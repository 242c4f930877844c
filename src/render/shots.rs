//! Which ray each sample of a pixel sends into the scene, and what it counts for.

use std::ops::Range;

use super::{
    filter::Places,
    sampler::{LENS, Sampler, TIME, permuted, stratified},
    square::Patches,
    world::{PACKET, Probe, World},
};
use crate::{
    color::Color,
    math::DVec3,
    scene::{Camera, CameraFrame, Eye, Region, Sampling, Settings, Shutter},
};

/// The camera rays of a picture.
#[derive(Debug)]
pub(super) struct Shots<'s> {
    settings: &'s Settings,
    frame: CameraFrame,
    /// The first column and row of the part that is rendered.
    corner: (u32, u32),
    filter: Option<Places>,
    /// Things move while the shutter is open.
    world_moves: bool,
    shutter: Shutter,
    /// A pinhole, with strata of the pixel itself for samples, all of them; and nothing moves.
    pub(super) is_plain: bool,
}

/// A camera ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// The ray; `None` where the camera sees nothing, which is black.
    pub(super) probe: Option<Probe>,
    /// The random numbers of its path.
    pub(super) sampler: Sampler,
    /// What it counts for in each channel.
    pub(super) weight: Color,
    /// When it is, from 0 to 1, where anything moves.
    pub(super) time: f64,
}

impl<'s> Shots<'s> {
    /// As [`Shots::new`], into a world that may move.
    pub(super) fn into_world(world: &World<'_>, settings: &'s Settings) -> Self {
        let shots = Self::new(&world.scene.camera, settings);
        Self {
            world_moves: world.moves(),
            is_plain: shots.is_plain && !world.moves(),
            ..shots
        }
    }

    /// The rays for a picture of the size and with the samples that `settings` says.
    pub(super) fn new(camera: &Camera, settings: &'s Settings) -> Self {
        let region = settings.region();
        Self {
            settings,
            frame: camera.frame(settings.width, settings.height),
            corner: (region.x, region.y),
            filter: Places::new(&settings.filter),
            world_moves: false,
            shutter: camera.shutter,
            is_plain: camera.is_plain()
                && settings.sampling == Sampling::Stratified
                && settings.filter.is_pixel()
                && settings.adaptive.is_none(),
        }
    }

    /// Rays of a pixel, where it has all its samples.
    pub(super) fn count(&self) -> u32 {
        self.samples().saturating_mul(self.eyes())
    }

    /// Samples of a pixel, at the most.
    pub(super) fn samples(&self) -> u32 {
        self.settings.samples
    }

    /// Whether each sample sees another moment, of the world or by the camera.
    pub(super) fn moves(&self) -> bool {
        self.world_moves || self.frame.moves()
    }

    /// Rays of a sample.
    pub(super) fn eyes(&self) -> u32 {
        self.frame.eyes().len() as u32
    }

    /// The whole picture, counted from the first pixel of the part that is rendered, which may come after others:
    /// numbers wrap around.
    pub(super) fn whole(&self) -> Region {
        Region {
            x: self.corner.0.wrapping_neg(),
            y: self.corner.1.wrapping_neg(),
            width: self.settings.width,
            height: self.settings.height,
        }
    }

    /// The rays of the samples `indices` of each pixel in turn where [`Shots::is_plain`]; of a square of pixels at this
    /// place of the part that is rendered, in the order of its [`Patches`].
    #[inline(always)]
    pub(super) fn plain(
        &self,
        (x, y): (u32, u32),
        patches: &Patches,
        indices: Range<u32>,
        probes: &mut Vec<Probe>,
    ) {
        if self.settings.samples > 1 {
            for (i, j) in patches.iter() {
                let one = |index| self.plain_one((x + i, y + j), index);
                probes.extend(indices.clone().map(one));
            }
            return;
        }
        // Through the centers of pixels, so that a column has one place across and a row one down.
        let (mut across, mut up) = ([DVec3::ZERO; PACKET], [DVec3::ZERO; PACKET]);
        for (across, i) in across.iter_mut().zip(0..patches.size.0) {
            *across = self.frame.across(f64::from(self.corner.0 + x + i) + 0.5);
        }
        for (up, j) in up.iter_mut().zip(0..patches.size.1) {
            *up = self.frame.up(f64::from(self.corner.1 + y + j) + 0.5);
        }
        probes.extend(patches.iter().map(|(i, j)| {
            let at = |from: &[DVec3; PACKET], i: u32| from.get(i as usize).copied().unwrap_or_default();
            Probe::from_space(self.frame.pinhole(at(&across, i), at(&up, j)))
        }));
    }

    fn plain_one(&self, pixel: (u32, u32), index: u32) -> Probe {
        let sampler = self.plain_sampler(pixel, index);
        let (dx, dy) = stratified(index, self.settings.samples, |dimension| sampler.get(dimension));
        let (x, y) = (
            f64::from(self.corner.0 + pixel.0),
            f64::from(self.corner.1 + pixel.1),
        );
        let (across, up) = (self.frame.across(x + dx), self.frame.up(y + dy));
        Probe::from_space(self.frame.pinhole(across, up))
    }

    /// The random numbers of a pixel's sample where [`Shots::is_plain`].
    #[inline(always)]
    pub(super) fn plain_sampler(&self, (x, y): (u32, u32), index: u32) -> Sampler {
        Sampler::new(self.settings.seed, self.corner.0 + x, self.corner.1 + y, index)
    }

    /// The ray with this number of a pixel, below [`Shots::count`].
    pub(super) fn shot(&self, pixel: (u32, u32), index: u32) -> Shot {
        if self.is_plain {
            return Shot {
                probe: Some(self.plain_one(pixel, index)),
                sampler: self.plain_sampler(pixel, index),
                weight: Color::ONE,
                time: 0.0,
            };
        }
        self.any(pixel, index)
    }

    fn any(&self, (x, y): (u32, u32), number: u32) -> Shot {
        let s = self.settings;
        let (x, y) = (self.corner.0.wrapping_add(x), self.corner.1.wrapping_add(y));
        let eyes = self.frame.eyes();
        let (mut index, eye) = (
            number / eyes.len() as u32,
            eyes.get(number as usize % eyes.len())
                .copied()
                .unwrap_or_default(),
        );
        // The same for all samples of the pixel.
        let key = Sampler::new(s.seed, x, y, u32::MAX);
        let (sampler, place, aperture);
        match s.sampling {
            Sampling::Stratified => {
                if s.adaptive.is_some() {
                    // The first strata are in one corner of the pixel; some of them must do for all of it.
                    index = permuted(index, s.samples, key.bits(0));
                }
                sampler = Sampler::new(s.seed, x, y, index);
                place = stratified(index, s.samples, |dimension| sampler.get(dimension));
                aperture = self.frame.has_lens().then(|| {
                    // Samples that lie beside each other in the pixel need not do so in the lens.
                    let stratum = permuted(index, s.samples, key.bits(LENS));
                    in_stratum(stratum, s.samples, |axis| sampler.get(LENS + axis))
                });
            }
            Sampling::Sobol => {
                sampler = Sampler::in_net(s.seed, x, y, index);
                place = match s.samples {
                    1 => (0.5, 0.5),
                    _ => (sampler.get(0), sampler.get(1)),
                };
                aperture = self
                    .frame
                    .has_lens()
                    .then(|| (sampler.get(LENS), sampler.get(LENS + 1)));
            }
        }
        let ((dx, dy), sign) = match &self.filter {
            None => (place, 1.0),
            Some(filter) => {
                let ((dx, a), (dy, b)) = (filter.place(place.0), filter.place(place.1));
                ((dx + 0.5, dy + 0.5), a * b)
            }
        };
        let place = [f64::from(x) + dx, f64::from(y) + dy];
        let (mut moved, mut share) = (None, 0.0);
        if self.moves() {
            share = match s.sampling {
                Sampling::Stratified => {
                    let stratum = permuted(index, s.samples, key.bits(TIME));
                    (f64::from(stratum) + sampler.get(TIME)) / f64::from(s.samples)
                }
                Sampling::Sobol => sampler.get(TIME),
            };
            moved = self.frame.moves().then(|| self.frame.at_time(share));
        }
        let frame = moved.as_ref().unwrap_or(&self.frame);
        let ray = frame.shot(place, eye, aperture.map(|(u, v)| [u, v]));
        Shot {
            probe: ray.map(Probe::from_space),
            sampler,
            weight: sign
                * match eye {
                    Eye::Middle => Color::ONE,
                    Eye::Left => Color::X,
                    Eye::Right => Color::new(0.0, 1.0, 1.0),
                },
            time: self.shutter.time(share),
        }
    }
}

/// As [`stratified`], with a random place for a single sample as well.
fn in_stratum(index: u32, count: u32, random: impl Fn(u64) -> f64) -> (f64, f64) {
    match count {
        0 | 1 => (random(0), random(1)),
        _ => stratified(index, count, random),
    }
}

/// The mean of a pixel's samples, each with its weight, summed in their order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    sum: Color,
    weights: Color,
    /// The same with all weights taken to be positive.
    unsigned: Color,
    sizes: Color,
}

impl Mean {
    /// Adds a sample.
    pub(crate) fn add(&mut self, light: Color, weight: Color) {
        let size = weight.abs();
        self.sum += weight * light;
        self.weights += weight;
        self.unsigned += size * light;
        self.sizes += size;
    }

    /// The mean: of one color, that color. Where a few samples happen to lie where the filter is below 0, and all but
    /// cancel the others, their signs are left out.
    pub(crate) fn value(&self) -> Color {
        self.of(self)
    }

    /// What some of the samples add to the mean of all.
    pub(crate) fn of(&self, some: &Self) -> Color {
        if self.weights.cmplt(self.sizes * 0.5).any() {
            return some.unsigned / self.sizes;
        }
        some.sum / self.weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Adaptive, Crop, Filter, FilterKind};

    #[test]
    fn every_filter_keeps_a_color() {
        let color = Color::new(0.25, 0.5, 3.0);
        for (_, kind) in FilterKind::NAMES {
            for samples in [1, 2, 3, 16, 64] {
                for sampling in [Sampling::Stratified, Sampling::Sobol] {
                    let settings = Settings {
                        samples,
                        sampling,
                        filter: Filter::new(kind),
                        ..Settings::default()
                    };
                    let shots = Shots::new(&Camera::default(), &settings);
                    for x in 0..50 {
                        let mut mean = Mean::default();
                        for index in 0..samples {
                            mean.add(color, shots.shot((x, 7), index).weight);
                        }
                        assert!((mean.value() - color).abs().max_element() < 1e-14, "{kind:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_filter_of_a_pixel_is_what_there_always_was() {
        let settings = Settings {
            samples: 7,
            ..Settings::default()
        };
        let shots = Shots::new(&Camera::default(), &settings);
        let wide = Settings {
            filter: Filter {
                radius: 0.75,
                ..Filter::default()
            },
            ..settings.clone()
        };
        let wide = Shots::new(&Camera::default(), &wide);
        assert!(shots.is_plain && !wide.is_plain);
        let any = |pixel, index| shots.any(pixel, index).probe.unwrap().ray;
        for index in 0..7 {
            assert_eq!(shots.plain_one((5, 9), index).ray, any((5, 9), index));
            assert_ne!(wide.shot((5, 9), index).probe.unwrap().ray, any((5, 9), index));
        }
    }

    #[test]
    fn rays_of_a_square_are_those_of_its_pixels() {
        for samples in [1, 3] {
            let settings = Settings {
                samples,
                crop: Some(Crop::Pixels(Region {
                    x: 7,
                    y: 5,
                    width: 40,
                    height: 30,
                })),
                ..Settings::default()
            };
            let shots = Shots::new(&Camera::default(), &settings);
            let mut probes = Vec::new();
            let patches = Patches::new((5, 3));
            shots.plain((2, 8), &patches, 0..samples, &mut probes);
            let places = patches.iter().map(|(i, j)| (2 + i, 8 + j));
            let one_by_one = places.flat_map(|place| (0..samples).map(move |index| (place, index)));
            let one_by_one = one_by_one.map(|(place, index)| shots.any(place, index).probe.unwrap().ray);
            assert!(probes.iter().map(|probe| probe.ray).eq(one_by_one));
        }
    }

    #[test]
    fn adaptive_samples_are_those_of_the_pixel_in_another_order() {
        let rays = |sampling, adaptive| {
            let settings = Settings {
                samples: 16,
                sampling,
                adaptive,
                ..Settings::default()
            };
            let shots = Shots::new(&Camera::default(), &settings);
            let dir = |index| shots.shot((40, 30), index).probe.unwrap().ray.dir;
            (0..16).map(|index| dir(index).to_array()).collect::<Vec<_>>()
        };
        let adaptive = Some(Adaptive { error: 0.1, min: 4 });
        for sampling in [Sampling::Stratified, Sampling::Sobol] {
            let (mut fixed, mut other) = (rays(sampling, None), rays(sampling, adaptive));
            // The first four lie all over the pixel.
            let middle = DVec3::from_array(
                fixed
                    .iter()
                    .fold([0.0; 3], |sum, d| [0, 1, 2].map(|i| sum[i] + d[i] / 16.0)),
            );
            assert_eq!(fixed == other, sampling == Sampling::Sobol);
            if sampling == Sampling::Sobol {
                let left = other[..4].iter().filter(|d| d[0] < middle.x).count();
                assert_eq!(left, 2);
            }
            fixed.sort_by(|a, b| a.partial_cmp(b).unwrap());
            other.sort_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(fixed, other);
        }
    }
}
