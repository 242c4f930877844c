//! Several pictures on one sheet, each with a line of text below.

use font8x8::legacy::BASIC_LEGACY;

use crate::{render::Image, testing::from_rgb8};

/// Edge of a letter in pixels.
const LETTER: u32 = 8;
/// Pixels around each picture.
const MARGIN: u32 = 8;
/// Pixels between a picture and its text.
const GAP: u32 = 4;
const PAPER: [u8; 3] = [24, 24, 27];
const INK: [u8; 3] = [228, 228, 231];

/// The pictures, row by row, `columns` in a row. Cells are as large as the largest picture; text that is wider than
/// its cell ends in dots.
pub(super) fn sheet(pictures: &[(Image, String)], columns: u32) -> Image {
    let columns = columns.max(1);
    let rows = (pictures.len() as u32).div_ceil(columns).max(1);
    let widest = pictures.iter().map(|(image, _)| image.width()).max().unwrap_or(1);
    let tallest = pictures
        .iter()
        .map(|(image, _)| image.height())
        .max()
        .unwrap_or(1);
    let (cell_width, cell_height) = (widest + 2 * MARGIN, tallest + 2 * MARGIN + GAP + LETTER);
    let mut paper = Paper::new(columns * cell_width, rows * cell_height);
    for (i, (image, text)) in (0..).zip(pictures) {
        let (left, top) = (
            i % columns * cell_width + MARGIN,
            i / columns * cell_height + MARGIN,
        );
        paper.place(image, left, top);
        paper.write(&shortened(text, widest / LETTER), left, top + tallest + GAP);
    }
    from_rgb8(paper.width, paper.height, &paper.bytes)
}

/// At most `most` letters, the last of them dots where some are left out.
fn shortened(text: &str, most: u32) -> String {
    let most = most as usize;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(2)).collect();
    format!("{kept}..").chars().take(most).collect()
}

struct Paper {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Paper {
    fn new(width: u32, height: u32) -> Self {
        let bytes = PAPER.repeat(width as usize * height as usize);
        Self { width, height, bytes }
    }

    fn set(&mut self, x: u32, y: u32, color: [u8; 3]) {
        let index = (y as usize * self.width as usize + x as usize) * 3;
        if let (true, Some(pixel)) = (x < self.width, self.bytes.get_mut(index..index + 3)) {
            pixel.copy_from_slice(&color);
        }
    }

    fn place(&mut self, image: &Image, left: u32, top: u32) {
        let bytes = image.rgb8();
        for (i, color) in (0..).zip(bytes.as_chunks::<3>().0) {
            self.set(left + i % image.width(), top + i / image.width(), *color);
        }
    }

    /// Letters of ASCII; any other becomes a question mark.
    fn write(&mut self, text: &str, left: u32, top: u32) {
        for (i, c) in (0..).zip(text.chars()) {
            let known = BASIC_LEGACY.get(c as usize).or(BASIC_LEGACY.get('?' as usize));
            for (row, bits) in (0..).zip(known.into_iter().flatten()) {
                for column in (0..LETTER).filter(|column| bits >> column & 1 == 1) {
                    self.set(left + i * LETTER + column, top + row, INK);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows_with_text_below() {
        let picture = |level: u8| (from_rgb8(20, 10, &[level; 600]), "a=".to_owned());
        let sheet = sheet(&[picture(100), picture(150), picture(200)], 2);
        assert_eq!((sheet.width(), sheet.height()), (2 * 36, 2 * 38));
        let bytes = sheet.rgb8();
        let at = |x: usize, y: usize| bytes[(y * 72 + x) * 3];
        assert_eq!((at(8, 8), at(27, 17), at(44, 8), at(8, 46)), (100, 100, 150, 200));
        assert_eq!((at(7, 8), at(28, 17), at(44, 46)), (PAPER[0], PAPER[0], PAPER[0]));
        let ink = (22..30)
            .flat_map(|y| (8..24).map(move |x| (x, y)))
            .filter(|&(x, y)| at(x, y) == INK[0]);
        let ink = ink.count();
        assert!((15..60).contains(&ink), "{ink} of 128 pixels");
    }

    #[test]
    fn text_that_is_too_long_ends_in_dots() {
        assert_eq!(shortened("radius=0.5", 10), "radius=0.5");
        assert_eq!(shortened("radius=0.55", 10), "radius=0..");
        assert_eq!(shortened("radius", 1), ".");
        assert_eq!(shortened("radius", 0), "");
        assert_eq!(sheet(&[], 3).width(), 3 * 17);
    }
}
