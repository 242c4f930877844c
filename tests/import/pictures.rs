//! Picture files made on the spot.

use std::io::Cursor;

use image::{ExtendedColorType, ImageEncoder, RgbImage, codecs::png::PngEncoder};

/// A PNG file of RGB pixels, rows from the top.
pub(crate) fn png(width: u32, height: u32, pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels.as_flattened(), width, height, ExtendedColorType::Rgb8)
        .unwrap();
    bytes
}

/// A JPEG file with a gradient.
pub(crate) fn jpeg(width: u32, height: u32) -> Vec<u8> {
    let image = RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([(x * 8) as u8, (y * 8) as u8, 128])
    });
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
    bytes.into_inner()
}
