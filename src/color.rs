//! Colors: scene-linear RGB with Rec. 709 primaries, and the sRGB transfer curve of pictures and color codes.

use crate::math::{self, DVec3};

/// A color in scene-linear RGB; components may exceed 1.
pub type Color = DVec3;

/// sRGB electrical value in [0, 1] to scene-linear light (IEC 61966-2-1).
///
/// ```
/// use rtscript::color::{linear_from_srgb, srgb_from_linear};
/// assert!((linear_from_srgb(0.5) - 0.214).abs() < 1e-3);
/// assert!((srgb_from_linear(linear_from_srgb(0.3)) - 0.3).abs() < 1e-12);
/// ```
#[must_use]
pub fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        math::pow((v + 0.055) / 1.055, 2.4)
    }
}

/// Scene-linear light in [0, 1] to the sRGB electrical value (IEC 61966-2-1).
///
/// ```
/// use rtscript::color::srgb_from_linear;
/// // Half of the light is brighter than half of the code values.
/// assert!((srgb_from_linear(0.5) - 0.735).abs() < 1e-3);
/// ```
#[must_use]
pub fn srgb_from_linear(v: f64) -> f64 {
    if v <= 0.003_130_8 {
        v * 12.92
    } else {
        1.055 * math::pow(v, 1.0 / 2.4) - 0.055
    }
}

/// Parses `"#rrggbb"` or `"#rgb"` (sRGB) into scene-linear RGB; `None` where the text is no such code.
///
/// ```
/// use rtscript::{DVec3, color::from_hex};
/// assert_eq!(from_hex("#f00"), Some(DVec3::X));
/// assert_eq!(from_hex("#ffffff"), Some(DVec3::ONE));
/// assert_eq!(from_hex("red"), None);
/// ```
#[must_use]
pub fn from_hex(text: &str) -> Option<Color> {
    let digits = text.strip_prefix('#')?;
    if !digits.is_ascii() {
        return None;
    }
    let component = |i: usize| -> Option<f64> {
        let byte = match digits.len() {
            6 => u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok()?,
            3 => u8::from_str_radix(digits.get(i..=i)?, 16).ok()? * 17,
            _ => return None,
        };
        Some(linear_from_srgb(f64::from(byte) / 255.0))
    };
    if digits.bytes().any(|b| !b.is_ascii_hexdigit()) {
        return None;
    }
    Some(Color::new(component(0)?, component(1)?, component(2)?))
}

/// Lightness, green to red and blue to yellow of a linear color in Oklab (Ottosson, "A perceptual color space for image
/// processing", 2020): equal steps look alike. White is [1, 0, 0].
///
/// ```
/// use rtscript::{DVec3, color::{Color, linear_from_oklab, oklab_from_linear}};
/// let red: Color = DVec3::X;
/// let half_as_light = oklab_from_linear(red) * DVec3::new(0.5, 1.0, 1.0);
/// assert!(linear_from_oklab(half_as_light).x < red.x);
/// ```
#[must_use]
pub fn oklab_from_linear(c: Color) -> DVec3 {
    let l = 0.412_221_470_8 * c.x + 0.536_332_536_3 * c.y + 0.051_445_992_9 * c.z;
    let m = 0.211_903_498_2 * c.x + 0.680_699_545_1 * c.y + 0.107_396_956_6 * c.z;
    let s = 0.088_302_461_9 * c.x + 0.281_718_837_6 * c.y + 0.629_978_700_5 * c.z;
    let [l, m, s] = [l, m, s].map(math::cbrt);
    DVec3::new(
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    )
}

/// The linear color of an Oklab one, which may lie outside of what a screen shows: then components are negative or
/// above 1.
///
/// ```
/// use rtscript::{DVec3, color::linear_from_oklab};
/// // Lightness 1 without a hue is white.
/// assert!((linear_from_oklab(DVec3::X) - DVec3::ONE).length() < 1e-3);
/// ```
#[must_use]
pub fn linear_from_oklab(lab: DVec3) -> Color {
    let l = lab.x + 0.396_337_777_4 * lab.y + 0.215_803_757_3 * lab.z;
    let m = lab.x - 0.105_561_345_8 * lab.y - 0.063_854_172_8 * lab.z;
    let s = lab.x - 0.089_484_177_5 * lab.y - 1.291_485_548_0 * lab.z;
    let [l, m, s] = [l, m, s].map(|x| x * x * x);
    Color::new(
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    )
}

/// The linear color of a lightness in [0, 1], a chroma (0 is gray, 0.3 about the strongest there is) and a hue in degrees of
/// Oklab. What no screen shows gets as much chroma as one does.
///
/// ```
/// use rtscript::color::linear_from_oklch;
/// let [red, green] = [20.0, 140.0].map(|hue| linear_from_oklch(0.6, 0.15, hue));
/// assert!(red.x > red.y && green.y > green.x);
/// ```
#[must_use]
pub fn linear_from_oklch(lightness: f64, chroma: f64, hue: f64) -> Color {
    let (sin, cos) = math::sin_cos_degrees(hue);
    let at = |chroma: f64| linear_from_oklab(DVec3::new(lightness, chroma * cos, chroma * sin));
    let is_shown = |c: Color| c.min_element() >= 0.0 && c.max_element() <= 1.0;
    if is_shown(at(chroma)) {
        return at(chroma);
    }
    let (mut shown, mut beyond) = (0.0, chroma);
    for _ in 0..50 {
        let middle = 0.5 * (shown + beyond);
        if is_shown(at(middle)) {
            shown = middle;
        } else {
            beyond = middle;
        }
    }
    at(shown).clamp(Color::ZERO, Color::ONE)
}

/// Relative luminance of a linear color (Rec. 709).
///
/// ```
/// use rtscript::{DVec3, color::luminance};
/// assert!((luminance(DVec3::ONE) - 1.0).abs() < 1e-9);
/// assert!(luminance(DVec3::Y) > luminance(DVec3::X));
/// ```
#[must_use]
pub fn luminance(c: Color) -> f64 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_codes() {
        assert_eq!(from_hex("#ffffff"), Some(Color::ONE));
        assert_eq!(from_hex("#f00"), Some(Color::X));
        for bad in ["ffffff", "#ff", "#gg0000", "#+f+f+f", "#ééé", ""] {
            assert_eq!(from_hex(bad), None, "{bad}");
        }
    }

    #[test]
    fn oklab_has_its_published_values_and_an_inverse() {
        // Of XYZ (0.950, 1.000, 1.089), (1, 0, 0) and so on are given; of linear RGB, white and red are well known.
        assert!((oklab_from_linear(Color::ONE) - DVec3::X).length() < 1e-6);
        let red = oklab_from_linear(Color::X);
        assert!(
            (red - DVec3::new(0.627_955, 0.224_863, 0.125_846)).length() < 1e-5,
            "{red}"
        );
        for c in [
            Color::ONE,
            Color::Y,
            Color::new(0.2, 0.5, 0.05),
            Color::splat(3.0),
        ] {
            assert!(
                (linear_from_oklab(oklab_from_linear(c)) - c).length() < 1e-5,
                "{c}"
            );
        }
        let strong = linear_from_oklch(0.7, 0.9, 150.0);
        assert!(strong.min_element() >= 0.0 && strong.max_element() <= 1.0);
        assert!(
            strong.min_element() < 1e-9 || strong.max_element() > 1.0 - 1e-9,
            "on the edge"
        );
        let hue = |c: Color| {
            let lab = oklab_from_linear(c);
            math::atan2(lab.z, lab.y).to_degrees()
        };
        assert!((hue(strong) - 150.0).abs() < 1e-3);
    }

    #[test]
    fn curve_and_inverse_agree_on_every_byte() {
        for b in 0..=255u8 {
            let v = f64::from(b) / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-7);
        }
    }
}
