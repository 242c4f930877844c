//! Colors that mean something, as they are to stand in the 8 bits of a picture.

use crate::color::Color;

/// A color for a number, far from those of most others: the hue goes around the circle by the number.
pub(in crate::render) fn distinct(key: u64) -> Color {
    let part = |shift: u32| (key >> shift & 0xffff) as f64 / 65_536.0;
    let (hue, saturation, value) = (6.0 * part(0), 0.45 + 0.45 * part(16), 0.55 + 0.45 * part(32));
    // From hue, saturation and value (Smith, "Color gamut transform pairs", 1978).
    let channel = |offset: f64| {
        let k = (offset + hue) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    };
    Color::new(channel(5.0), channel(3.0), channel(1.0))
}

/// Black, violet, red, orange, yellow, white: brighter all the way, for a share from 0 to 1.
pub(super) fn heat(share: f64) -> Color {
    const STOPS: [[f64; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [0.27, 0.05, 0.42],
        [0.72, 0.15, 0.27],
        [0.94, 0.44, 0.13],
        [0.98, 0.80, 0.25],
        [1.0, 1.0, 1.0],
    ];
    let along = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let stop = |i: usize| {
        STOPS
            .get(i)
            .or(STOPS.last())
            .map_or(Color::ZERO, |stop| Color::from_array(*stop))
    };
    let (from, rest) = (along as usize, along.fract());
    stop(from) * (1.0 - rest) + stop(from + 1) * rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::luminance;

    #[test]
    fn heat_grows_brighter() {
        let all: Vec<f64> = (0..=50).map(|i| luminance(heat(f64::from(i) / 50.0))).collect();
        assert!(all.windows(2).all(|w| w[0] < w[1]));
        assert_eq!((heat(0.0), heat(1.0)), (Color::ZERO, Color::ONE));
    }

    #[test]
    fn hues_are_hues() {
        // Saturation and value at their most.
        let of = |hue: u64| distinct(hue | 0xffff << 16 | 0xffff << 32);
        let red = of(0);
        assert!(red.x > 0.99 && red.y < 0.11 && red.z < 0.11, "{red}");
        let green = of(65_536 / 3);
        assert!(green.y > 0.99 && green.x < 0.11 && green.z < 0.11, "{green}");
    }
}
