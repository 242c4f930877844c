//! The finished picture.

use crate::{
    color::{Color, srgb_from_linear},
    scene::Encoding,
};

/// A picture in scene-linear light, rows from the top, with the way it becomes 8 bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    encoding: Encoding,
    pixels: Vec<[f64; 3]>,
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
        }
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
        self.pixels
            .iter()
            .flatten()
            .map(|&v| quantize(v, self.encoding))
            .collect()
    }

    /// 128 bits of BLAKE3 over the picture as a binary PPM file would hold it (`P6`, size, 8-bit RGB), as 32
    /// hexadecimal digits. Never of an encoded file, whose bytes depend on the encoder.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(format!("P6\n{} {}\n255\n", self.width, self.height).as_bytes());
        hasher.update(&self.rgb8());
        hasher.finalize().to_hex()[..32].to_owned()
    }
}

/// One channel of linear light to 8 bits. NaN becomes 0.
#[must_use]
pub fn quantize(v: f64, encoding: Encoding) -> u8 {
    let v = if v > 0.0 { v.min(1.0) } else { 0.0 };
    match encoding {
        Encoding::Srgb => (srgb_from_linear(v) * 255.0 + 0.5) as u8,
        Encoding::Raw => (v * 255.0) as u8,
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
    fn the_hash_tells_shapes_apart() {
        let image = |w, h| Image::new(w, h, Encoding::Srgb, vec![[0.5; 3]; 6]).hash();
        assert_eq!(image(2, 3).len(), 32);
        assert_ne!(image(2, 3), image(3, 2));
    }
}
