//! How two pictures differ.

use std::{fmt, fs, io, path::Path};

use crate::{math, render::Image, scene::Encoding};

/// Pixels between the panels of [`diff_picture`].
const GAP: usize = 4;

/// How two pictures differ in 8 bits. Where one has pixels that the other has not, they differ by 255.
///
/// ```
/// use rtscript::testing::{Comparison, compare, from_rgb8};
/// let [black, gray] = [0, 8].map(|v| from_rgb8(1, 1, &[v; 3]));
/// let Comparison { differing, max, .. } = compare(&black, &gray);
/// assert_eq!((differing, max), (1, 8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Pixels of the smallest picture that covers both.
    pub pixels: u64,
    /// Pixels that differ in any channel.
    pub differing: u64,
    /// Largest difference of a channel.
    pub max: u8,
    /// Peak signal-to-noise ratio in decibels over all channels; infinite where the pictures are equal.
    pub psnr: f64,
}

/// Compares two pictures as they would be written in 8 bits.
#[must_use]
pub fn compare(expected: &Image, actual: &Image) -> Comparison {
    let (expected, actual) = (Bytes::new(expected), Bytes::new(actual));
    let (width, height) = expected.covering(&actual);
    let (mut differing, mut max, mut squares) = (0, 0, 0u64);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let channels = difference(expected.at(x, y), actual.at(x, y));
        differing += u64::from(channels != [0; 3]);
        max = channels.into_iter().fold(max, u8::max);
        squares += channels.map(|d| u64::from(d) * u64::from(d)).iter().sum::<u64>();
    }
    let pixels = (width * height) as u64;
    let mean_square = squares as f64 / (3 * pixels).max(1) as f64;
    Comparison {
        pixels,
        differing,
        max,
        psnr: if squares == 0 {
            f64::INFINITY
        } else {
            10.0 * math::log10(255.0 * 255.0 / mean_square)
        },
    }
}

/// A rectangle of pixels.
///
/// ```
/// use rtscript::testing::Region;
/// let region = Region::around(&[(3, 4), (5, 4)]).expect("two pixels");
/// assert_eq!((region.left, region.top, region.width, region.height), (3, 4, 3, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Its first column.
    pub left: u32,
    /// Its first row, from the top.
    pub top: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

impl Region {
    /// The smallest rectangle around all of these pixels, (column, row) each; `None` where there are none.
    #[must_use]
    pub fn around(pixels: &[(u32, u32)]) -> Option<Self> {
        let edges =
            |of: fn(&(u32, u32)) -> u32| Some((pixels.iter().map(of).min()?, pixels.iter().map(of).max()?));
        let ((left, right), (top, bottom)) = (edges(|p| p.0)?, edges(|p| p.1)?);
        Some(Self {
            left,
            top,
            width: right - left + 1,
            height: bottom - top + 1,
        })
    }
}

impl fmt::Display for Region {
    /// `40 x 30 at (12, 7)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            left,
            top,
            width,
            height,
        } = self;
        write!(f, "{width} x {height} at ({left}, {top})")
    }
}

/// Columns and rows of the pixels that differ in 8 bits, row by row from the top.
///
/// ```
/// use rtscript::testing::{changed_pixels, from_rgb8};
/// let [before, after] = [[0, 0, 0, 9, 9, 9], [0, 0, 0, 9, 9, 8]].map(|bytes| from_rgb8(2, 1, &bytes));
/// assert_eq!(changed_pixels(&before, &after), [(1, 0)]);
/// ```
#[must_use]
pub fn changed_pixels(expected: &Image, actual: &Image) -> Vec<(u32, u32)> {
    let (expected, actual) = (Bytes::new(expected), Bytes::new(actual));
    let (width, height) = expected.covering(&actual);
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .filter(|&(x, y)| expected.at(x, y) != actual.at(x, y))
        .map(|(x, y)| (x as u32, y as u32))
        .collect()
}

/// Expected, difference and actual side by side. The difference is brightened until its largest is white.
///
/// ```
/// use rtscript::testing::{diff_picture, from_rgb8};
/// let [black, white] = [0, 255].map(|v| from_rgb8(1, 1, &[v; 3]));
/// assert!(diff_picture(&black, &white).width() >= 1);
/// ```
#[must_use]
pub fn diff_picture(expected: &Image, actual: &Image) -> Image {
    let max = u32::from(compare(expected, actual).max.max(1));
    let (expected, actual) = (Bytes::new(expected), Bytes::new(actual));
    let (width, height) = expected.covering(&actual);
    let panel = width + GAP;
    let mut bytes = Vec::new();
    for y in 0..height {
        for x in 0..3 * width + 2 * GAP {
            let (e, a) = (expected.at(x % panel, y), actual.at(x % panel, y));
            bytes.extend(match (x / panel, x % panel < width) {
                (0, true) => e.unwrap_or_default(),
                (1, true) => difference(e, a).map(|d| (u32::from(d) * 255 / max) as u8),
                (_, true) => a.unwrap_or_default(),
                (_, false) => [128; 3],
            });
        }
    }
    from_rgb8((3 * width + 2 * GAP) as u32, height as u32, &bytes)
}

/// The difference of two pixels; a missing one differs from any by 255.
fn difference(a: Option<[u8; 3]>, b: Option<[u8; 3]>) -> [u8; 3] {
    match (a, b) {
        (Some(a), Some(b)) => channels_apart(a, b),
        (None, None) => [0; 3],
        _ => [255; 3],
    }
}

/// How far each channel of two pixels is apart.
pub(crate) fn channels_apart(mut a: [u8; 3], b: [u8; 3]) -> [u8; 3] {
    for (a, b) in a.iter_mut().zip(b) {
        *a = a.abs_diff(b);
    }
    a
}

/// A picture in 8 bits.
struct Bytes {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Bytes {
    fn new(image: &Image) -> Self {
        Self {
            width: image.width() as usize,
            height: image.height() as usize,
            rgb: image.rgb8(),
        }
    }

    /// Size of the smallest picture that covers both.
    fn covering(&self, other: &Self) -> (usize, usize) {
        (self.width.max(other.width), self.height.max(other.height))
    }

    fn at(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        if x >= self.width {
            return None;
        }
        self.rgb.as_chunks::<3>().0.get(y * self.width + x).copied()
    }
}

/// A picture that has exactly these 8-bit values. Its linear values are the middles of the steps of the `raw`
/// encoding, so they are for comparing, not for light.
///
/// ```
/// use rtscript::testing::from_rgb8;
/// assert_eq!(from_rgb8(1, 1, &[1, 2, 3]).rgb8(), [1, 2, 3]);
/// ```
#[must_use]
pub fn from_rgb8(width: u32, height: u32, bytes: &[u8]) -> Image {
    let pixels = bytes.as_chunks::<3>().0.iter();
    let pixels = pixels.map(|rgb| rgb.map(|b| (f64::from(b) + 0.5) / 255.0));
    Image::new(width, height, Encoding::Raw, pixels.collect())
}

/// Reads a picture file, for comparing (see [`from_rgb8`]).
///
/// # Errors
/// Where it cannot be read or is no picture.
///
/// ```
/// use rtscript::testing::load_picture;
/// assert!(load_picture("no such file.png".as_ref()).is_err());
/// ```
pub fn load_picture(path: &Path) -> io::Result<Image> {
    let decoded = image::load_from_memory(&fs::read(path)?)
        .map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e.to_string()))?
        .to_rgb8();
    Ok(from_rgb8(decoded.width(), decoded.height(), decoded.as_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(width: u32, height: u32, byte: u8) -> Image {
        from_rgb8(width, height, &vec![byte; (width * height * 3) as usize])
    }

    #[test]
    fn bytes_survive_being_an_image() {
        let bytes: Vec<u8> = (0..=255).flat_map(|b| [b, 255 - b, b / 2]).collect();
        assert_eq!(from_rgb8(16, 16, &bytes).rgb8(), bytes);
    }

    #[test]
    fn comparing_counts_pixels_channels_and_noise() {
        let (a, mut bytes) = (gray(10, 10, 100), vec![100; 300]);
        assert_eq!(compare(&a, &a).psnr, f64::INFINITY);
        (bytes[0], bytes[1], bytes[299]) = (110, 99, 102);
        let c = compare(&a, &from_rgb8(10, 10, &bytes));
        assert_eq!((c.pixels, c.differing, c.max), (100, 2, 10));
        assert!((c.psnr - 10.0 * math::log10(255.0 * 255.0 * 300.0 / 105.0)).abs() < 1e-12);
        let c = compare(&a, &gray(10, 11, 100));
        assert_eq!((c.pixels, c.differing, c.max), (110, 10, 255));
    }

    #[test]
    fn the_region_is_around_what_changed() {
        let (a, mut bytes) = (gray(10, 8, 100), vec![100; 240]);
        assert_eq!(Region::around(&changed_pixels(&a, &a)), None);
        (bytes[(3 * 10 + 4) * 3], bytes[(5 * 10 + 2) * 3 + 2]) = (0, 0);
        let changed = changed_pixels(&a, &from_rgb8(10, 8, &bytes));
        assert_eq!(changed, [(4, 3), (2, 5)]);
        let region = Region::around(&changed).unwrap();
        assert_eq!(region.to_string(), "3 x 3 at (2, 3)");
        let taller = changed_pixels(&a, &gray(10, 9, 100));
        assert_eq!(Region::around(&taller).unwrap().to_string(), "10 x 1 at (0, 8)");
    }

    #[test]
    fn the_diff_picture_shows_all_three() {
        let diff = diff_picture(&gray(2, 2, 100), &gray(2, 2, 103));
        assert_eq!((diff.width(), diff.height()), (14, 2));
        let reds: Vec<u8> = diff.rgb8().chunks(3).take(14).map(|rgb| rgb[0]).collect();
        assert_eq!(
            reds,
            [
                100, 100, 128, 128, 128, 128, 255, 255, 128, 128, 128, 128, 103, 103
            ]
        );
    }
}
