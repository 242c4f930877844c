//! The finished picture.

#![allow(
    clippy::indexing_slicing,
    reason = "the table has an entry for every interval from 0 to 1, which the value is clamped to"
)]

use std::sync::OnceLock;

use super::Layer;
use crate::{
    color::{Color, linear_from_srgb, srgb_from_linear},
    scene::Encoding,
};

/// A picture in scene-linear light, rows from the top, with the way it becomes 8 bits.
///
/// ```
/// use rtscript::{Image, scene::Encoding};
/// // Light, row by row from the top, and how its bytes are to be made.
/// let image = Image::new(2, 1, Encoding::Srgb, vec![[1.0, 0.0, 0.0], [0.0; 3]]);
/// assert_eq!(image.rgb8(), [255, 0, 0, 0, 0, 0]);
/// assert_eq!(image.hash().len(), 32);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    encoding: Encoding,
    pixels: Vec<[f64; 3]>,
    layers: Vec<Layer>,
    file: FileOptions,
    hash: KnownHash,
}

/// A picture's hash, once somebody has asked for it. It follows from the rest, so that any two are equal.
#[derive(Clone, Debug, Default)]
struct KnownHash(OnceLock<String>);

impl PartialEq for KnownHash {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// How a picture is written to a file, where that is left to choose.
///
/// ```
/// use rtscript::render::FileOptions;
/// let mut deep = FileOptions::default();
/// deep.bits = Some(16);
/// assert!(deep.check("a.png").is_ok());
/// assert!(deep.check("a.jpg").is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FileOptions {
    /// Bits of a channel: 8 or 16 of PNG and PPM, 16 or 32 of EXR; `None` is 8 and 32.
    pub bits: Option<u8>,
    /// Quality of a JPEG, from 1 to 100; `None` is 95.
    pub quality: Option<u8>,
}

impl FileOptions {
    /// Whether a file of this name can have them, where the ending is known.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self, name: &str) -> Result<(), String> {
        let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        let (known, said): (&[u8], _) = match ending.as_str() {
            "png" | "ppm" => (&[8, 16], "8 or 16"),
            "exr" => (&[16, 32], "16 or 32"),
            "jpg" | "jpeg" => (&[8], "8"),
            "hdr" | "pfm" => (&[32], "32"),
            _ => return Ok(()),
        };
        if let Some(bits) = self.bits.filter(|bits| !known.contains(bits)) {
            return Err(format!("a .{ending} has {said} bits, not {bits}"));
        }
        match self.quality {
            Some(_) if !ending.starts_with('j') => Err(format!(
                "a .{ending} has no quality: it loses nothing to choose from"
            )),
            Some(quality) if !(1..=100).contains(&quality) => {
                Err(format!("the quality must lie between 1 and 100, not {quality}"))
            }
            _ => Ok(()),
        }
    }
}

impl Image {
    /// A picture of `width * height` linear pixels, rows from the top. Missing pixels are black.
    #[must_use]
    pub fn new(width: u32, height: u32, encoding: Encoding, mut pixels: Vec<[f64; 3]>) -> Self {
        pixels.resize(width as usize * height as usize, [0.0; 3]);
        Self {
            width,
            height,
            encoding,
            pixels,
            layers: Vec::new(),
            file: FileOptions::default(),
            hash: KnownHash::default(),
        }
    }

    /// The same picture with these layers beside it, each of as many pixels.
    ///
    /// ```
    /// use rtscript::{Image, render::{Layer, LayerKind}, scene::Encoding};
    /// let depth = Layer { kind: LayerKind::Depth, values: vec![2.0, 5.0] };
    /// let image = Image::new(2, 1, Encoding::Srgb, vec![[0.0; 3]; 2]).with_layers(vec![depth]);
    /// assert_eq!(image.layers()[0].values, [2.0, 5.0]);
    /// ```
    #[must_use]
    pub fn with_layers(mut self, layers: Vec<Layer>) -> Self {
        self.layers = layers;
        self
    }

    /// The same picture, to be written like this.
    #[must_use]
    pub const fn with_file_options(mut self, file: FileOptions) -> Self {
        self.file = file;
        self
    }

    /// What else it holds of each pixel: what [`RenderOptions::layers`](super::RenderOptions::layers) asked for.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// How it is to be written to files.
    #[must_use]
    pub const fn file_options(&self) -> FileOptions {
        self.file
    }

    /// The picture in 16 bits per channel, `width * height * 3` numbers RGB, rows from the top, by its encoding.
    ///
    /// ```
    /// use rtscript::{Image, render::FileOptions, scene::Encoding};
    /// // A quarter of white without a curve, which this encoding rounds downwards.
    /// let image = Image::new(1, 1, Encoding::Raw, vec![[0.25; 3]]);
    /// assert_eq!((image.rgb16(), image.rgb8()), (vec![16383; 3], vec![63; 3]));
    /// assert_eq!(image.encoding(), Encoding::Raw);
    /// assert_eq!(image.pixel(0, 0).map(|c| c.x), Some(0.25));
    /// // Outside there is nothing.
    /// assert_eq!(image.pixel(1, 0), None);
    /// // It is to be written with other options than the usual ones, without a pixel changed.
    /// let mut options = FileOptions::default();
    /// options.bits = Some(16);
    /// let deep = image.clone().with_file_options(options);
    /// assert_eq!(deep.file_options(), options);
    /// assert_eq!(deep.hash(), image.hash());
    /// ```
    #[must_use]
    pub fn rgb16(&self) -> Vec<u16> {
        let channels = self.pixels.as_flattened().iter();
        channels
            .map(|&v| {
                let v = if v > 0.0 { v.min(1.0) } else { 0.0 };
                match self.encoding {
                    Encoding::Srgb => (srgb_from_linear(v) * 65535.0 + 0.5) as u16,
                    Encoding::Raw => (v * 65535.0) as u16,
                }
            })
            .collect()
    }

    /// Pixels across.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// How it becomes 8 bits.
    #[must_use]
    pub const fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Scene-linear pixels, rows from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[f64; 3]] {
        &self.pixels
    }

    /// Scene-linear color of the pixel in column `x`, row `y` from the top; `None` outside.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<Color> {
        if x >= self.width || y >= self.height {
            return None;
        }
        self.pixels
            .get(y as usize * self.width as usize + x as usize)
            .map(|p| Color::from_array(*p))
    }

    /// The picture in 8 bits per channel: `width * height * 3` bytes RGB, rows from the top.
    #[must_use]
    pub fn rgb8(&self) -> Vec<u8> {
        match self.encoding {
            Encoding::Srgb => {
                let levels = SrgbLevels::get();
                let mut bytes = Vec::with_capacity(self.pixels.len() * 3);
                // Much of many pictures is one color.
                let mut last = ([0.0; 3], [0; 3]);
                for pixel in &self.pixels {
                    if *pixel != last.0 {
                        last = (*pixel, pixel.map(|v| levels.quantize(v)));
                    }
                    bytes.extend(last.1);
                }
                bytes
            }
            Encoding::Raw => {
                let channels = self.pixels.as_flattened().iter();
                channels.map(|&v| quantize(v, Encoding::Raw)).collect()
            }
        }
    }

    /// Whether every pixel is black in 8 bits.
    pub(crate) fn is_black(&self) -> bool {
        let mut channels = self.pixels.as_flattened().iter();
        match self.encoding {
            Encoding::Srgb => {
                let levels = SrgbLevels::get();
                channels.all(|&v| levels.quantize(v) == 0)
            }
            Encoding::Raw => channels.all(|&v| quantize(v, Encoding::Raw) == 0),
        }
    }

    /// 128 bits of BLAKE3 over the picture as a binary PPM file would hold it (`P6`, size, 8-bit RGB), as 32
    /// hexadecimal digits. Never of an encoded file, whose bytes depend on the encoder.
    #[must_use]
    pub fn hash(&self) -> String {
        let of_pixels = || {
            let mut hasher = blake3::Hasher::new();
            hasher.update(format!("P6\n{} {}\n255\n", self.width, self.height).as_bytes());
            hasher.update(&self.rgb8());
            hasher.finalize().to_hex()[..32].to_owned()
        };
        self.hash.0.get_or_init(of_pixels).clone()
    }
}

/// One channel of linear light to 8 bits. NaN becomes 0.
///
/// ```
/// use rtscript::{render::quantize, scene::Encoding};
/// assert_eq!(quantize(1.7, Encoding::Raw), 255);
/// assert!(quantize(0.5, Encoding::Srgb) > quantize(0.5, Encoding::Raw));
/// ```
#[must_use]
pub fn quantize(v: f64, encoding: Encoding) -> u8 {
    let v = if v > 0.0 { v.min(1.0) } else { 0.0 };
    match encoding {
        Encoding::Srgb => (srgb_from_linear(v) * 255.0 + 0.5) as u8,
        Encoding::Raw => (v * 255.0) as u8,
    }
}

/// [`quantize`] to sRGB without a power for each channel: where each level begins.
struct SrgbLevels {
    /// Linear light at which each level begins, and last what no light reaches.
    begins: [f64; 257],
    /// The level at the start of each interval of linear light: equally wide ones between any two powers of 2, so
    /// narrow that at most one level begins within.
    first: [u8; Self::INTERVALS + 1],
}

impl SrgbLevels {
    /// Powers of 2 below 1 that are divided; what is darker than the least is of level 0.
    const OCTAVES: usize = 13;
    /// Bits of a number's fraction that tell in which interval it lies.
    const BITS: u32 = 7;
    const INTERVALS: usize = Self::OCTAVES << Self::BITS;
    const LEAST: f64 = 1.0 / (1 << Self::OCTAVES) as f64;

    /// Nearer than this to the beginning of a level, the formula decides. The beginnings are known to 1e-15, and
    /// what the formula rounds moves them by less than 1e-13.
    const MARGIN: f64 = 1e-9;

    /// The same for all pictures.
    fn get() -> &'static Self {
        static LEVELS: OnceLock<SrgbLevels> = OnceLock::new();
        LEVELS.get_or_init(Self::new)
    }

    fn new() -> Self {
        let mut begins = [f64::INFINITY; 257];
        // Level 0 has no beginning for light to be near to.
        begins[0] = -1.0;
        for (level, begin) in begins.iter_mut().enumerate().take(256).skip(1) {
            *begin = linear_from_srgb((level as f64 - 0.5) / 255.0);
        }
        let mut first = [0; Self::INTERVALS + 1];
        let mut level = 0u8;
        for (first, i) in first.iter_mut().zip(0..) {
            let start =
                f64::from_bits(Self::LEAST.to_bits() + (i << (f64::MANTISSA_DIGITS - 1 - Self::BITS)));
            while begins[usize::from(level) + 1] <= start {
                level += 1;
            }
            *first = level;
        }
        Self { begins, first }
    }

    /// The same as [`quantize`], always.
    #[inline]
    fn quantize(&self, v: f64) -> u8 {
        // NaN becomes 0.
        let v = if v > 0.0 { v } else { 0.0 };
        let v = if v < 1.0 { v } else { 1.0 };
        let from = if v > Self::LEAST { v } else { Self::LEAST };
        let interval = (from.to_bits() - Self::LEAST.to_bits()) >> (f64::MANTISSA_DIGITS - 1 - Self::BITS);
        let mut level = usize::from(self.first[interval as usize]);
        level += usize::from(v >= self.begins[level + 1]);
        if v - self.begins[level] < Self::MARGIN || self.begins[level + 1] - v < Self::MARGIN {
            return quantize(v, Encoding::Srgb);
        }
        level as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_truncates_and_srgb_rounds() {
        assert_eq!(quantize(0.999, Encoding::Raw), 254);
        assert_eq!(quantize(0.5, Encoding::Raw), 127);
        assert_eq!(quantize(0.5, Encoding::Srgb), 188);
        for encoding in [Encoding::Raw, Encoding::Srgb] {
            assert_eq!(
                [f64::NAN, -1.0, 2.0, f64::INFINITY].map(|v| quantize(v, encoding)),
                [0, 0, 255, 255]
            );
        }
    }

    #[test]
    fn levels_are_what_the_formula_says() {
        let levels = SrgbLevels::get();
        let same = |v: f64| assert_eq!(levels.quantize(v), quantize(v, Encoding::Srgb), "{v:e}");
        for v in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            2.0,
            5e-324,
            0.003_130_8,
            SrgbLevels::LEAST,
            1.0 - f64::EPSILON / 2.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ] {
            same(v);
        }
        // One step from the level at the start of an interval must do.
        assert!(levels.first.is_sorted_by(|a, b| a <= b && b - a <= 1));
        for begin in levels.begins.into_iter().take(256).skip(1) {
            for ulps in -2000..2000i64 {
                same(f64::from_bits(begin.to_bits().wrapping_add_signed(ulps)));
            }
            for apart in [1e-12, 0.9e-9, 1.1e-9, 1e-8, 1e-6] {
                same(begin + apart);
                same(begin - apart);
            }
        }
        for i in 0..=100_000 {
            same(f64::from(i) / 100_000.0);
        }
        // A table that is off by one level must not pass.
        assert_eq!(levels.quantize(levels.begins[100] + 1e-6), 100);
        assert_eq!(levels.quantize(levels.begins[100] - 1e-6), 99);
    }

    #[test]
    fn the_hash_tells_shapes_apart() {
        let image = |w, h| Image::new(w, h, Encoding::Srgb, vec![[0.5; 3]; 6]).hash();
        assert_eq!(image(2, 3).len(), 32);
        assert_ne!(image(2, 3), image(3, 2));
    }
}
