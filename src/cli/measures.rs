//! How much two pictures differ, in numbers.

use serde_json::{Value, json};

use crate::{
    render::Image,
    testing::{Comparison, Region, changed_pixels, compare, flip},
};

/// What was measured of two pictures.
#[derive(Clone, Debug)]
pub(super) struct Measures {
    pub(super) comparison: Comparison,
    /// Mean FLIP error over all pixels, 0 (equal to the eye) to 1; `None` where the sizes differ.
    pub(super) flip: Option<f64>,
    /// The smallest rectangle around all pixels that differ; `None` where none does.
    pub(super) region: Option<Region>,
}

impl Measures {
    pub(super) fn of(before: &Image, after: &Image) -> Self {
        Self {
            comparison: compare(before, after),
            flip: flip(before, after).map(|map| map.mean()),
            region: Region::around(&changed_pixels(before, after)),
        }
    }

    /// `1234 of 64000 pixels differ (1.9 %), by 45 at most, PSNR 38.1 dB, FLIP 0.0213, in 40 x 30 at (12, 7)`.
    pub(super) fn text(&self) -> String {
        let c = &self.comparison;
        let percent = 100.0 * c.differing as f64 / c.pixels.max(1) as f64;
        let mut text = format!(
            "{} of {} pixels differ ({percent:.2} %), by {} at most, PSNR {:.1} dB",
            c.differing, c.pixels, c.max, c.psnr
        );
        if let Some(flip) = self.flip {
            text += &format!(", FLIP {flip:.4}");
        }
        if let Some(region) = self.region {
            text += &format!(", in {region}");
        }
        text
    }

    /// The same for programs.
    pub(super) fn json(&self) -> Value {
        let c = &self.comparison;
        json!({
            "pixels": c.pixels,
            "differing": c.differing,
            "largest_difference": c.max,
            // Equal pictures have none: JSON has no infinity.
            "psnr": c.psnr.is_finite().then_some(c.psnr),
            "flip": self.flip,
            "region": self.region.map(|r| json!([r.left, r.top, r.width, r.height])),
        })
    }
}

/// A whole number with commas between thousands.
pub(super) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
