//! What to keep of a picture as text.

use std::fmt;

use crate::{render::Image, scene::Scene};

/// Entries of each list of a scene that a snapshot shows in full.
pub(super) const SHOWN: usize = 20;
/// Cells of the luma grid along each edge.
pub(super) const GRID: usize = 8;

/// A picture and its scene as text: size, hash, mean color (of the 8-bit values, 1 is white), an 8 x 8 grid of mean
/// luma (of the 8-bit values, two hexadecimal digits a cell, rows from the top), and the scene's dump, long lists
/// cut short.
#[must_use]
pub fn snapshot_text(scene: &Scene, image: &Image) -> String {
    let mut text = picture_text(image);
    text.push('\n');
    text.push_str(&scene.dump_short(SHOWN));
    text
}

pub(super) fn picture_text(image: &Image) -> String {
    let look = Look::of(image);
    format!(
        "size {} x {}\nhash {}\n{look}",
        image.width(),
        image.height(),
        image.hash()
    )
}

/// What a picture looks like, coarsely.
///
/// ```
/// use rtscript::testing::{Look, from_rgb8};
/// let look = Look::of(&from_rgb8(8, 8, &[255; 192]));
/// assert_eq!(look.luma[0][0], 255);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// Mean of each channel of the 8-bit values; 1 is white.
    pub mean: [f64; 3],
    /// Mean luma (weights of Rec. 709) of the 8-bit values in 8 x 8 cells, rows from the top.
    pub luma: [[u8; GRID]; GRID],
}

impl Look {
    /// What `image` looks like.
    #[must_use]
    pub fn of(image: &Image) -> Self {
        let (width, height, bytes) = (image.width() as usize, image.height() as usize, image.rgb8());
        let mut sums = [0u64; 3];
        for pixel in bytes.as_chunks::<3>().0 {
            for (sum, byte) in sums.iter_mut().zip(pixel) {
                *sum += u64::from(*byte);
            }
        }
        let white = (width * height * 255).max(1) as f64;
        let mut luma = [[0; GRID]; GRID];
        for (row, cells) in luma.iter_mut().enumerate() {
            for (column, luma) in cells.iter_mut().enumerate() {
                *luma = cell_luma(&bytes, width, cell(row, height), cell(column, width)) as u8;
            }
        }
        Self {
            mean: sums.map(|sum| sum as f64 / white),
            luma,
        }
    }
}

/// `mean R G B`, then `luma` and a line for each row of cells.
impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.mean;
        write!(f, "mean {r:.6} {g:.6} {b:.6}\nluma")?;
        for row in self.luma {
            write!(f, "\n ")?;
            for cell in row {
                write!(f, " {cell:02x}")?;
            }
        }
        writeln!(f)
    }
}

/// The pixels of one grid cell along an edge of `pixels`, at least one where there is any.
fn cell(index: usize, pixels: usize) -> std::ops::Range<usize> {
    let start = (index * pixels / GRID).min(pixels.saturating_sub(1));
    start..((index + 1) * pixels / GRID).clamp(start + 1, pixels.max(start + 1))
}

/// Mean luma of a part of an 8-bit picture (weights of Rec. 709, in whole numbers so that it is exact).
fn cell_luma(
    bytes: &[u8],
    width: usize,
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
) -> u64 {
    let (mut sum, mut count) = (0u64, 0u64);
    for y in rows {
        for x in columns.clone() {
            if let Some([r, g, b]) = bytes.as_chunks::<3>().0.get(y * width + x) {
                sum += 2126 * u64::from(*r) + 7152 * u64::from(*g) + 722 * u64::from(*b);
                count += 10_000;
            }
        }
    }
    (sum + count / 2) / count.max(1)
}

#[cfg(test)]
mod tests {
    use super::{super::from_rgb8, *};
    use crate::scene::Builder;

    fn gray(width: u32, height: u32, byte: u8) -> Image {
        from_rgb8(width, height, &vec![byte; (width * height * 3) as usize])
    }

    #[test]
    fn the_grid_shows_where_it_is_bright() {
        let mut bytes = vec![0; 160 * 80 * 3];
        for y in 70..80 {
            bytes[(y * 160 + 20) * 3..(y * 160 + 40) * 3].fill(255);
        }
        let text = picture_text(&from_rgb8(160, 80, &bytes));
        let rows: Vec<&str> = text.lines().skip(4).collect();
        assert_eq!(rows[7], "  00 ff 00 00 00 00 00 00");
        assert!(rows[..7].iter().all(|row| *row == "  00 00 00 00 00 00 00 00"));
        assert!(text.contains("mean 0.015625 0.015625 0.015625"), "{text}");
    }

    #[test]
    fn tiny_pictures_have_a_grid_too() {
        let text = picture_text(&gray(1, 3, 7));
        assert_eq!(
            text.matches("07").count() - text.lines().nth(1).unwrap().matches("07").count(),
            64
        );
    }

    #[test]
    fn a_snapshot_holds_picture_and_scene() {
        let mut b = Builder::new();
        b.size(8, 8).unwrap();
        let text = snapshot_text(&b.finish().value, &gray(8, 8, 0));
        assert!(text.starts_with("size 8 x 8\nhash "));
        assert!(text.contains("\n\nsize 8 8\nsamples 1"), "{text}");
    }
}
