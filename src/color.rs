//! Colors: scene-linear RGB with Rec. 709 primaries, and the sRGB transfer curve of pictures and color codes.

use crate::math::{self, DVec3};

/// A color in scene-linear RGB; components may exceed 1.
pub type Color = DVec3;

/// sRGB electrical value in [0, 1] to scene-linear light (IEC 61966-2-1).
#[must_use]
pub fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        math::pow((v + 0.055) / 1.055, 2.4)
    }
}

/// Scene-linear light in [0, 1] to the sRGB electrical value (IEC 61966-2-1).
#[must_use]
pub fn srgb_from_linear(v: f64) -> f64 {
    if v <= 0.003_130_8 {
        v * 12.92
    } else {
        1.055 * math::pow(v, 1.0 / 2.4) - 0.055
    }
}

/// Parses `"#rrggbb"` or `"#rgb"` (sRGB) into scene-linear RGB; `None` where the text is no such code.
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

/// Relative luminance of a linear color (Rec. 709).
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
    fn curve_and_inverse_agree_on_every_byte() {
        for b in 0..=255u8 {
            let v = f64::from(b) / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-7);
        }
    }
}
