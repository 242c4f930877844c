//! The pixels that the window shows.

use rtscript::{
    Image,
    render::{Tile, quantize},
    scene::Encoding,
};

/// What stands where nothing has been drawn yet: 0xRRGGBB.
const EMPTY: u32 = 0x20_20_20;

/// A picture that grows tile by tile, row by row from the top, each pixel as 0xRRGGBB.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Canvas {
    width: usize,
    height: usize,
    encoding: Encoding,
    pixels: Vec<u32>,
}

impl Canvas {
    /// Makes ready for a picture of this size. What was there stays until it is drawn over, if it has that size.
    pub fn begin(&mut self, width: u32, height: u32, encoding: Encoding) {
        let size = (width as usize, height as usize);
        if size != self.size() {
            (self.width, self.height) = size;
            self.pixels = vec![EMPTY; self.width * self.height];
        }
        self.encoding = encoding;
    }

    /// Width and height in pixels; 0 before the first picture.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The pixels.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// Puts a finished tile to its place. What lies outside is left out.
    pub fn tile(&mut self, tile: &Tile<'_>) {
        let rows = tile.pixels.chunks_exact(tile.width as usize);
        for (y, row) in (tile.y as usize..self.height).zip(rows) {
            let place = &mut self.pixels[y * self.width..][..self.width];
            for (pixel, color) in place.iter_mut().skip(tile.x as usize).zip(row) {
                let [r, g, b] = color.map(|light| quantize(light, self.encoding));
                *pixel = u32::from_be_bytes([0, r, g, b]);
            }
        }
    }

    /// Shows a picture in place of the whole, however coarse.
    pub fn fill(&mut self, image: &Image) {
        let bytes = image.rgb8();
        let (width, height) = (image.width() as usize, image.height() as usize);
        for (y, row) in self.pixels.chunks_exact_mut(self.width.max(1)).enumerate() {
            let from = y * height / self.height * width;
            for (x, pixel) in row.iter_mut().enumerate() {
                let at = 3 * (from + x * width / self.width);
                if let Some(&[r, g, b]) = bytes.get(at..at + 3) {
                    *pixel = u32::from_be_bytes([0, r, g, b]);
                }
            }
        }
    }
}
