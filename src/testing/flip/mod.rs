//! How much two pictures differ to the eye: LDR-FLIP.
//!
//! Pontus Andersson, Jim Nilsson, Tomas Akenine-Möller, Magnus Oskarsson, Kalle Åström, Mark D. Fairchild: "FLIP: A
//! Difference Evaluator for Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive
//! Techniques 3(2), 2020 (High Performance Graphics). Section numbers below are that paper's.
//!
//! The filters are applied as products of a filter across and one down, which they are, in f64 and in a fixed
//! order; powers and roots come from [`crate::math`]. So the map has the same bits on every machine.

#![allow(
    clippy::indexing_slicing,
    reason = "both pictures are known to be of one size, and the window lies within it"
)]

mod eye;
mod magma;

use std::ops::Range;

use self::{
    eye::{Filters, Side, hunt_lab, hyab},
    magma::MAGMA,
};
use super::from_rgb8;
use crate::{
    math::{self, DVec3, PI},
    render::Image,
};

/// Pixels per degree of the field of view: a screen 0.7 m and 3840 pixels wide, seen from 0.7 m, which is the
/// paper's choice (about 67).
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Exponent of the color difference, `q_c` (section 4.1).
const COLOR_EXPONENT: f64 = 0.7;
/// Part of the largest color difference, `p_c`, that is mapped to `p_t` of the error (section 4.1).
const KNEE: f64 = 0.4;
/// Error at the knee, `p_t` (section 4.1).
const KNEE_ERROR: f64 = 0.95;
/// How much two pictures differ to the eye, pixel by pixel.
///
/// ```
/// use rtscript::testing::{FlipMap, flip, from_rgb8};
/// let [black, white] = [0, 255].map(|v| from_rgb8(4, 4, &[v; 48]));
/// let map: FlipMap = flip(&black, &white).expect("of one size");
/// assert!(map.mean() > 0.9 && map.max() <= 1.0 && map.at(0, 0).is_some());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    width: usize,
    height: usize,
    errors: Vec<f64>,
}

impl FlipMap {
    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width as u32
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height as u32
    }

    /// The error in column `x`, row `y` from the top: 0 (equal to the eye) to 1; `None` outside.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<f64> {
        let (x, y) = (x as usize, y as usize);
        if x >= self.width {
            return None;
        }
        self.errors.get(y * self.width + x).copied()
    }

    /// The mean error over all pixels, 0 to 1.
    #[must_use]
    pub fn mean(&self) -> f64 {
        // Row by row, so that rounding does not grow with the picture.
        let rows = self.errors.chunks(self.width);
        rows.map(|row| row.iter().sum::<f64>()).sum::<f64>() / self.errors.len() as f64
    }

    /// The largest error, 0 to 1.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }

    /// The map as a picture in the color map magma: black is 0, light yellow is 1.
    ///
    /// ```
    /// use rtscript::testing::{flip, from_rgb8};
    /// let [black, white] = [0, 255].map(|v| from_rgb8(2, 1, &[v; 6]));
    /// // No difference is black, the greatest nearly white.
    /// let dark = flip(&black, &black).expect("of one size").heat_picture().rgb8();
    /// let light = flip(&black, &white).expect("of one size").heat_picture().rgb8();
    /// assert!(dark[..3].iter().all(|v| *v < 10) && light[0] > 200, "{dark:?} {light:?}");
    /// ```
    #[must_use]
    pub fn heat_picture(&self) -> Image {
        let color = |error: &f64| {
            let [_, rgb @ ..] = MAGMA[(error * 255.0 + 0.5) as usize & 255].to_be_bytes();
            rgb
        };
        let bytes: Vec<u8> = self.errors.iter().flat_map(color).collect();
        from_rgb8(self.width(), self.height(), &bytes)
    }
}

/// LDR-FLIP between two pictures as they would be written in 8 bits, read as sRGB, seen at about 67 pixels per
/// degree (0.7 m away from a screen 0.7 m and 3840 pixels wide). `None` where the sizes differ or there is no pixel.
///
/// ```
/// use rtscript::testing::{flip, from_rgb8};
/// let [small, large] = [1, 2].map(|n| from_rgb8(n, n, &vec![0; 3 * (n * n) as usize]));
/// assert!(flip(&small, &small).is_some_and(|map| map.mean() == 0.0));
/// assert!(flip(&small, &large).is_none());
/// ```
#[must_use]
pub fn flip(expected: &Image, actual: &Image) -> Option<FlipMap> {
    let (width, height) = (expected.width() as usize, expected.height() as usize);
    if (width, height) != (actual.width() as usize, actual.height() as usize) || width * height == 0 {
        return None;
    }
    let (expected, actual) = (expected.rgb8(), actual.rgb8());
    let mut errors = vec![0.0; width * height];
    let filters = Filters::new(PIXELS_PER_DEGREE);
    if let Some(window) = window(&expected, &actual, width, height, 2 * filters.radius()) {
        let side = |bytes: &[u8]| Side::new(bytes, width, &window, &filters);
        let (expected, actual) = (side(&expected), side(&actual));
        let scale = Scale::new();
        for (i, y) in window.rows.clone().enumerate() {
            let row = &mut errors[y * width..][window.columns.clone()];
            for (j, error) in row.iter_mut().enumerate() {
                *error = scale.error(&expected, &actual, i * window.columns.len() + j);
            }
        }
    }
    Some(FlipMap {
        width,
        height,
        errors,
    })
}

/// The part of a picture that is looked at.
struct Window {
    columns: Range<usize>,
    rows: Range<usize>,
}

/// The rectangle around all pixels that differ, wider by `margin` where the picture goes on; `None` where none does.
///
/// With a margin of twice the filters' radius the map is that of the whole pictures: a pixel farther than one radius
/// from any change has no error, and the others see only pixels of the window, or beyond the picture's edge.
fn window(expected: &[u8], actual: &[u8], width: usize, height: usize, margin: usize) -> Option<Window> {
    let (mut columns, mut rows) = (width..0, height..0);
    for (y, (e, a)) in expected
        .chunks(3 * width)
        .zip(actual.chunks(3 * width))
        .enumerate()
    {
        if e == a {
            continue;
        }
        let mut changed = (0..width).filter(|x| e[3 * x..3 * x + 3] != a[3 * x..3 * x + 3]);
        if let Some(first) = changed.next() {
            let last = changed.next_back().unwrap_or(first);
            columns = columns.start.min(first)..columns.end.max(last + 1);
            rows = rows.start.min(y)..y + 1;
        }
    }
    let wider =
        |range: Range<usize>, end: usize| range.start.saturating_sub(margin)..(range.end + margin).min(end);
    (!rows.is_empty()).then(|| Window {
        columns: wider(columns, width),
        rows: wider(rows, height),
    })
}

/// From differences to an error in 0 to 1.
struct Scale {
    /// The largest color difference there is, that of green and blue, to the power of [`COLOR_EXPONENT`].
    max: f64,
}

impl Scale {
    fn new() -> Self {
        Self {
            max: math::pow(hyab(hunt_lab(DVec3::Y), hunt_lab(DVec3::Z)), COLOR_EXPONENT),
        }
    }

    /// The error of pixel `i` of the window.
    fn error(&self, expected: &Side, actual: &Side, i: usize) -> f64 {
        let distance = hyab(expected.seen[i], actual.seen[i]);
        // A feature makes a difference of color count for more; where there is none, it adds nothing.
        if distance == 0.0 {
            return 0.0;
        }
        let color = math::pow(distance, COLOR_EXPONENT);
        let knee = KNEE * self.max;
        let color = if color < knee {
            color * KNEE_ERROR / knee
        } else {
            KNEE_ERROR + (color - knee) / (self.max - knee) * (1.0 - KNEE_ERROR)
        };
        let [edge, point] = [0, 1].map(|k: usize| (expected.features[i][k] - actual.features[i][k]).abs());
        // The exponent of the feature difference, `q_f`, is 1/2 (section 4.2).
        let feature = (edge.max(point) * std::f64::consts::FRAC_1_SQRT_2).sqrt();
        math::pow(color, 1.0 - feature).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, rgb: impl Fn(u32, u32) -> [u32; 3]) -> Image {
        let at = |i: u32| rgb(i % width, i / width).map(|c| c as u8);
        let bytes: Vec<u8> = (0..width * height).flat_map(at).collect();
        from_rgb8(width, height, &bytes)
    }

    fn ramp(x: u32, y: u32) -> [u32; 3] {
        [x * 5 % 256, y * 7 % 256, (x + y) * 3 % 256]
    }

    fn noise(x: u32, y: u32) -> [u32; 3] {
        [0, 1, 2].map(|c| (x * 73 + y * 151 + c * 199 + x * y * 7) % 256)
    }

    /// Mean, and errors at pixels, of a pair of pictures, as the authors' own program has them (flip-evaluator 1.7,
    /// which reckons in f32).
    fn assert_flip(expected: &Image, actual: &Image, mean: f64, errors: &[(u32, u32, f64)]) {
        let map = flip(expected, actual).unwrap();
        assert!((map.mean() - mean).abs() < 5e-6, "{} is not {mean}", map.mean());
        for &(x, y, error) in errors {
            let found = map.at(x, y).unwrap();
            assert!((found - error).abs() < 2e-5, "({x}, {y}): {found} is not {error}");
        }
    }

    #[test]
    fn a_spot_of_another_color() {
        let spot = |x: u32, y: u32| {
            let inside = x.abs_diff(20).pow(2) + y.abs_diff(14).pow(2) < 36;
            if inside { [200, 40, 40] } else { ramp(x, y) }
        };
        assert_flip(
            &picture(48, 32, ramp),
            &picture(48, 32, spot),
            0.074_250_318,
            &[
                (20, 14, 0.720_068_7),
                (26, 14, 0.316_304_74),
                (12, 9, 0.087_441_65),
                (47, 31, 0.0),
            ],
        );
    }

    #[test]
    fn noise_moved_by_a_pixel() {
        assert_flip(
            &picture(40, 30, noise),
            &picture(40, 30, |x, y| noise(x + 1, y)),
            0.238_904_476,
            &[
                (0, 0, 0.832_272_3),
                (17, 11, 0.372_899_95),
                (39, 29, 0.954_072_06),
            ],
        );
    }

    #[test]
    fn stripes_turned_gray() {
        assert_flip(
            &picture(64, 20, |x, _| [x / 3 % 2 * 255; 3]),
            &picture(64, 20, |_, _| [128; 3]),
            0.611_008_704,
            &[
                (0, 0, 0.947_144_15),
                (31, 10, 0.461_342_96),
                (63, 19, 0.870_124_7),
            ],
        );
    }

    #[test]
    fn one_pixel_near_an_edge() {
        let dot = |x, y| {
            if (x, y) == (97, 3) {
                [255, 255, 0]
            } else {
                ramp(x, y)
            }
        };
        assert_flip(
            &picture(100, 60, ramp),
            &picture(100, 60, dot),
            0.001_832_038,
            &[
                (97, 3, 0.537_581_62),
                (99, 0, 0.100_647_96),
                (90, 5, 0.020_000_63),
                (97, 25, 0.0),
            ],
        );
    }

    #[test]
    fn green_and_blue_are_as_far_apart_as_colors_are() {
        let plain = |rgb| picture(5, 3, move |_, _| rgb);
        let map = flip(&plain([0, 255, 0]), &plain([0, 0, 255])).unwrap();
        assert!((map.mean() - 1.0).abs() < 1e-12 && map.max() <= 1.0);
    }

    #[test]
    fn equal_pictures_have_no_error_and_unequal_sizes_no_map() {
        let map = flip(&picture(9, 7, noise), &picture(9, 7, noise)).unwrap();
        assert_eq!((map.mean(), map.max(), map.at(8, 6)), (0.0, 0.0, Some(0.0)));
        assert_eq!((map.at(9, 0), map.at(0, 7)), (None, None));
        assert_eq!(flip(&picture(9, 7, noise), &picture(7, 9, noise)), None);
        let none = from_rgb8(0, 0, &[]);
        assert_eq!(flip(&none, &none), None);
    }

    #[test]
    fn the_map_has_the_same_bits_everywhere() {
        let map = flip(&picture(40, 30, noise), &picture(40, 30, |x, y| noise(x + 1, y))).unwrap();
        let bytes: Vec<u8> = map.errors.iter().flat_map(|e| e.to_le_bytes()).collect();
        assert_eq!(
            &blake3::hash(&bytes).to_hex()[..32],
            "e4e6735929ead11c114ba3db6e76c85f"
        );
    }

    #[test]
    fn the_heat_picture_goes_from_black_to_light_yellow() {
        let map = FlipMap {
            width: 3,
            height: 1,
            errors: vec![0.0, 0.5, 1.0],
        };
        assert_eq!(
            map.heat_picture().rgb8(),
            [0, 0, 4, 0xb7, 0x37, 0x79, 0xfc, 0xfd, 0xbf]
        );
    }
}
