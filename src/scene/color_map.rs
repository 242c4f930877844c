//! Colors along a line from 0 to 1.

use std::sync::Arc;

use super::{SceneError, Texture, texture::TexturePoint};
use crate::{
    color::{self, Color},
    math::DVec3,
};

/// A color, or a color times a texture: what a [`ColorMap`] leads to.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    /// Scene-linear factor.
    pub color: Color,
    /// Looked up and multiplied by `color`.
    pub texture: Option<Arc<Texture>>,
}

impl Paint {
    /// The same color everywhere.
    #[must_use]
    pub const fn color(color: Color) -> Self {
        Self { color, texture: None }
    }

    /// A texture as it is.
    #[must_use]
    pub const fn texture(texture: Arc<Texture>) -> Self {
        Self {
            color: Color::ONE,
            texture: Some(texture),
        }
    }

    pub(super) fn at(&self, point: &TexturePoint) -> Color {
        match &self.texture {
            None => self.color,
            Some(texture) => self.color * texture.lookup(point),
        }
    }
}

/// How a [`ColorMap`] goes from one entry to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// In scene-linear RGB, as light mixes.
    Linear,
    /// In Oklab (Ottosson, "A perceptual color space for image processing", 2020), as the eye takes for even.
    Oklab,
    /// Not at all: an entry counts up to the next.
    None,
}

impl Interpolation {
    /// All of them with their names in scripts.
    pub const ALL: [(&'static str, Self); 3] = [
        ("linear", Self::Linear),
        ("oklab", Self::Oklab),
        ("none", Self::None),
    ];
}

/// Colors or textures at places from 0 to 1.
///
/// ```
/// use rtscript::{DVec3, scene::{ColorMap, Interpolation, Paint}};
/// let [black, red, white] = [DVec3::ZERO, DVec3::X, DVec3::ONE].map(Paint::color);
/// let fire = ColorMap::new(vec![(0.0, black.clone()), (0.7, red), (1.0, white.clone())], Interpolation::Oklab)?;
/// assert_eq!(fire.entries().len(), 3);
/// assert_eq!(ColorMap::even(vec![black, white], Interpolation::Linear)?.interpolation(), Interpolation::Linear);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ColorMap {
    /// Places in ascending order, each with what is there. Before the first counts the first, after the last the last.
    entries: Vec<(f64, Paint)>,
    /// Between them.
    interpolation: Interpolation,
}

impl ColorMap {
    /// The most entries of a map.
    pub const MAX_ENTRIES: usize = 256;

    /// A map with these entries.
    ///
    /// # Errors
    /// Where there is none or more than [`ColorMap::MAX_ENTRIES`], a place lies outside of [0, 1] or before the one
    /// before it.
    pub fn new(entries: Vec<(f64, Paint)>, interpolation: Interpolation) -> Result<Self, SceneError> {
        if entries.is_empty() || entries.len() > Self::MAX_ENTRIES {
            return Err(SceneError::new(format!(
                "colors must have 1 to {} entries, not {}",
                Self::MAX_ENTRIES,
                entries.len()
            )));
        }
        let mut before = 0.0;
        for (place, paint) in &entries {
            if !(0.0..=1.0).contains(place) {
                return Err(SceneError::new(format!(
                    "a place in colors must lie between 0 and 1, not {place}"
                )));
            }
            if *place < before {
                return Err(SceneError::new(format!(
                    "the places in colors must ascend, but {place} comes after {before}"
                )));
            }
            if !paint.color.is_finite() {
                return Err(SceneError::new("colors must be of finite numbers"));
            }
            before = *place;
        }
        Ok(Self {
            entries,
            interpolation,
        })
    }

    /// A map of entries at equal distances: from 0 to 1, or where nothing lies between them, each as wide as the others.
    ///
    /// # Errors
    /// As [`ColorMap::new`].
    pub fn even(paints: Vec<Paint>, interpolation: Interpolation) -> Result<Self, SceneError> {
        let steps = match interpolation {
            Interpolation::None => paints.len(),
            _ => paints.len().saturating_sub(1),
        };
        let steps = steps.max(1) as f64;
        let placed = paints.into_iter().enumerate();
        let entries = placed.map(|(i, paint)| (i as f64 / steps, paint)).collect();
        Self::new(entries, interpolation)
    }

    /// A map that is known to be right: its places ascend within [0, 1].
    pub(super) fn known(entries: &[(f64, u32)], interpolation: Interpolation) -> Self {
        let rgb = |code: u32| {
            let channel = |shift: u32| color::linear_from_srgb(f64::from(code >> shift & 255) / 255.0);
            Color::new(channel(16), channel(8), channel(0))
        };
        Self {
            entries: entries
                .iter()
                .map(|(place, code)| (*place, Paint::color(rgb(*code))))
                .collect(),
            interpolation,
        }
    }

    /// Its entries.
    #[must_use]
    pub fn entries(&self) -> &[(f64, Paint)] {
        &self.entries
    }

    /// What lies between them.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The color at place `t`.
    pub(super) fn at(&self, t: f64, point: &TexturePoint) -> Color {
        let next = self.entries.partition_point(|(place, _)| *place <= t);
        let Some((end, after)) = self.entries.get(next) else {
            return self
                .entries
                .last()
                .map_or(Color::ZERO, |(_, last)| last.at(point));
        };
        let before = next.checked_sub(1).and_then(|i| self.entries.get(i));
        let Some((start, before)) = before else {
            return after.at(point);
        };
        if self.interpolation == Interpolation::None || t == *start {
            return before.at(point);
        }
        let share = (t - start) / (end - start);
        let (before, after) = (before.at(point), after.at(point));
        match self.interpolation {
            Interpolation::Oklab => {
                let (a, b) = (oklab(before), oklab(after));
                from_oklab(a * (1.0 - share) + b * share)
            }
            _ => before * (1.0 - share) + after * share,
        }
    }
}

/// Scene-linear RGB as L, a, b (Ottosson, 2020).
fn oklab(c: Color) -> DVec3 {
    let cone = |r: f64, g: f64, b: f64| crate::math::cbrt(r * c.x + g * c.y + b * c.z);
    let l = cone(0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9);
    let m = cone(0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6);
    let s = cone(0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5);
    DVec3::new(
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    )
}

/// The color of L, a, b; what lies outside of the gamut is cut off at black.
fn from_oklab(lab: DVec3) -> Color {
    let cube = |a: f64, b: f64| {
        let x = lab.x + a * lab.y + b * lab.z;
        x * x * x
    };
    let l = cube(0.396_337_777_4, 0.215_803_757_3);
    let m = cube(-0.105_561_345_8, -0.063_854_172_8);
    let s = cube(-0.089_484_177_5, -1.291_485_548_0);
    let rgb = Color::new(
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    );
    rgb.max(Color::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point() -> TexturePoint {
        TexturePoint::default()
    }

    #[test]
    fn maps_go_from_entry_to_entry() {
        let paints = vec![
            Paint::color(Color::ZERO),
            Paint::color(Color::ONE),
            Paint::color(Color::X),
        ];
        let map = ColorMap::even(paints.clone(), Interpolation::Linear).unwrap();
        let at = |t| map.at(t, &point());
        assert_eq!(
            [at(0.0), at(0.25), at(0.5), at(1.0)],
            [Color::ZERO, Color::splat(0.5), Color::ONE, Color::X]
        );
        assert_eq!((at(-1.0), at(2.0)), (Color::ZERO, Color::X));
        let steps = ColorMap::even(paints, Interpolation::None).unwrap();
        assert_eq!(steps.at(0.33, &point()), Color::ZERO);
        assert_eq!(steps.at(0.34, &point()), Color::ONE);
        assert_eq!(steps.at(0.999, &point()), Color::X);
    }

    #[test]
    fn oklab_and_back_is_the_same_color() {
        for c in [
            Color::ONE,
            Color::new(0.2, 0.5, 0.9),
            Color::Y,
            Color::new(3.0, 0.1, 0.0),
        ] {
            assert!((from_oklab(oklab(c)) - c).abs().max_element() < 1e-6, "{c}");
        }
        // White has full lightness and no color.
        assert!((oklab(Color::ONE) - DVec3::X).abs().max_element() < 1e-6);
        // Ottosson's own table: XYZ 0, 1, 0 aside, red in linear sRGB.
        assert!(
            (oklab(Color::X) - DVec3::new(0.627_955, 0.224_863, 0.125_846))
                .abs()
                .max_element()
                < 1e-5
        );
    }

    #[test]
    fn maps_that_are_none_are_refused() {
        let entry = |place| (place, Paint::color(Color::ONE));
        let refused = |entries| ColorMap::new(entries, Interpolation::Linear).unwrap_err().message;
        assert!(refused(vec![]).contains("1 to 256"));
        assert!(refused(vec![entry(0.5), entry(0.4)]).contains("ascend"));
        assert!(refused(vec![entry(1.5)]).contains("between 0 and 1"));
        assert!(refused(vec![entry(f64::NAN)]).contains("between 0 and 1"));
    }
}
