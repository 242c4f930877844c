//! What the whole picture has one of, besides the camera.

mod crop;
mod sampling;

pub use crop::{Crop, Region};
pub use sampling::{Adaptive, Filter, FilterKind, Sampling};

use super::{Edition, Surroundings};
use crate::color::Color;

/// How linear light becomes 8 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Clamp, sRGB curve, times 255, round: what screens expect.
    #[default]
    Srgb,
    /// Clamp, times 255, truncate: what the CSE167 course expects.
    Raw,
}

/// Settings of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The edition that the scene asks for; `None` where it asks for none, and takes the newest.
    pub edition: Option<Edition>,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// Rays per pixel: 1 is one ray through the center, more are jittered in strata.
    pub samples: u32,
    /// Secondary bounces: the camera ray plus this many reflected or refracted rays in a row, at most 64.
    pub max_depth: u32,
    /// Reflected and refracted rays are followed that count for at least this much in the pixel's sample, in one of the
    /// three channels: above 0 and at most 1.
    pub min_weight: f64,
    /// Scene-linear light of a ray that leaves the scene.
    pub background: Color,
    /// Linear to 8 bits.
    pub encoding: Encoding,
    /// Seeds every random choice.
    pub seed: u64,
    /// Environment, ambient occlusion, fog and haze.
    pub surroundings: Surroundings,
    /// How samples are spread.
    pub sampling: Sampling,
    /// What the surroundings of a pixel count for in it.
    pub filter: Filter,
    /// Where set, pixels have no more samples than they need, and [`Settings::samples`] at the most.
    pub adaptive: Option<Adaptive>,
    /// The part of the picture that is rendered; `None` is all of it.
    pub crop: Option<Crop>,
}

impl Settings {
    /// Largest [`Settings::max_depth`].
    pub const MAX_DEPTH: u32 = 64;
    /// [`Settings::min_weight`] where nothing else is said, 2^-20: with up to 2^depth rays this is what ends them between
    /// two surfaces of glass, and far below a step of an 8-bit picture.
    pub const MIN_WEIGHT: f64 = 1.0 / (1 << 20) as f64;

    /// The edition by which the scene is built and rendered.
    #[must_use]
    pub fn edition(&self) -> Edition {
        self.edition.unwrap_or(Edition::LATEST)
    }

    /// The part of the picture that is rendered, in pixels: all of it, but for [`Settings::crop`].
    #[must_use]
    pub fn region(&self) -> Region {
        let whole = Region {
            x: 0,
            y: 0,
            width: self.width,
            height: self.height,
        };
        self.crop.map_or(whole, |crop| crop.region(&whole))
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            edition: None,
            width: 640,
            height: 480,
            samples: 1,
            max_depth: 5,
            min_weight: Self::MIN_WEIGHT,
            background: Color::ZERO,
            encoding: Encoding::Srgb,
            seed: 0,
            surroundings: Surroundings::default(),
            sampling: Sampling::default(),
            filter: Filter::default(),
            adaptive: None,
            crop: None,
        }
    }
}
