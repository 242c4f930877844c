//! Tests of pictures: what to keep of one as text, how two differ, and how to render a scene file in a test.
//!
//! A snapshot of a picture says enough to see what changed without looking: its size, the hash of its pixels, its
//! mean color, a coarse grid of its brightness, and the scene it was made from. Two snapshots are equal exactly
//! where the pixels and the scenes are.
//!
//! ```
//! use rtscript::{Builder, NoHost, RenderOptions, render, testing::snapshot_text};
//! let mut b = Builder::new();
//! b.size(16, 16)?;
//! let scene = b.finish().value;
//! let image = render(&scene, &RenderOptions::default(), &NoHost)?.value.image;
//! assert!(snapshot_text(&scene, &image).starts_with("size 16 x 16\nhash "));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::{DirHost, Host, HostError},
    limits::Limits,
    math,
    render::{Image, render},
    scene::{Encoding, Scene},
    script::{Picture, RunOptions},
    source,
};

/// Entries of each list of a scene that a snapshot shows in full.
const SHOWN: usize = 20;
/// Cells of the luma grid along each edge.
const GRID: usize = 8;
/// Pixels between the panels of [`diff_picture`].
const GAP: usize = 4;

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

fn picture_text(image: &Image) -> String {
    let (width, height, bytes) = (image.width() as usize, image.height() as usize, image.rgb8());
    let mut sums = [0u64; 3];
    for pixel in bytes.as_chunks::<3>().0 {
        for (sum, byte) in sums.iter_mut().zip(pixel) {
            *sum += u64::from(*byte);
        }
    }
    let white = (width * height * 255).max(1) as f64;
    let [r, g, b] = sums.map(|sum| sum as f64 / white);
    let mut text = format!(
        "size {width} x {height}\nhash {}\nmean {r:.6} {g:.6} {b:.6}\nluma",
        image.hash()
    );
    for row in 0..GRID {
        text.push_str("\n ");
        for column in 0..GRID {
            let luma = cell_luma(&bytes, width, cell(row, height), cell(column, width));
            // Writing into a String does not fail.
            let _ = write!(text, " {luma:02x}");
        }
    }
    text.push('\n');
    text
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

/// How two pictures differ in 8 bits. Where one has pixels that the other has not, they differ by 255.
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

/// Expected, difference and actual side by side. The difference is brightened until its largest is white.
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
        (Some(a), Some(b)) => [0, 1, 2].map(|i: usize| a[i].abs_diff(b[i])),
        (None, None) => [0; 3],
        _ => [255; 3],
    }
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
pub fn load_picture(path: &Path) -> io::Result<Image> {
    let decoded = image::load_from_memory(&fs::read(path)?)
        .map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e.to_string()))?
        .to_rgb8();
    Ok(from_rgb8(decoded.width(), decoded.height(), decoded.as_raw()))
}

/// Every scene file below `root`: scripts (`.rhai`) and course scenes (`.test`), sorted by path.
///
/// # Errors
/// Where a folder cannot be read.
pub fn find_scenes(root: &Path) -> io::Result<Vec<PathBuf>> {
    let mut scenes = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rhai" || e == "test") {
                scenes.push(path);
            }
        }
    }
    scenes.sort();
    Ok(scenes)
}

/// What a scene file came to.
#[derive(Debug)]
pub struct RenderedFile {
    /// The scene as it stood at the end.
    pub scene: Scene,
    /// The last picture that the script rendered, or the one picture of its scene.
    pub image: Image,
    /// What the script rendered before it.
    pub earlier: Vec<Picture>,
    /// Warnings of the script and the render.
    pub warnings: Vec<Diagnostic>,
    /// What the script printed, a line end after each text.
    pub printed: String,
}

impl RenderedFile {
    /// [`snapshot_text`] of the last picture, and where there are any: the pictures before it, warnings, what was
    /// printed.
    #[must_use]
    pub fn snapshot(&self) -> String {
        let mut text = picture_text(&self.image);
        for picture in &self.earlier {
            let (name, image) = (picture.name.as_deref().unwrap_or("unnamed"), &picture.image);
            let size = format!("{} x {}", image.width(), image.height());
            let _ = writeln!(text, "before it {name:?} {size} hash {}", image.hash());
        }
        for warning in &self.warnings {
            let _ = writeln!(text, "{warning}");
        }
        for line in self.printed.lines() {
            let _ = writeln!(text, "printed {line:?}");
        }
        text.push('\n');
        text.push_str(&self.scene.dump_short(SHOWN));
        text
    }
}

/// Renders a scene file under the default [`Limits`], its assets read below its own folder. Pictures that the
/// script names are kept in the result and not written. Messages and the dump call the file by its name alone, so
/// that they do not depend on where the repository is.
///
/// # Errors
/// Whatever is wrong with the scene.
pub fn render_file(path: &Path, options: &RunOptions) -> Result<RenderedFile, Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let limits = Limits::default();
    let bytes = fs::read(path)
        .map_err(|e| Diagnostic::error(ErrorKind::Input, format!("cannot read '{name}': {e}")))?;
    let text = source::text(&name, bytes, &limits)?;
    let host = TestHost {
        assets: DirHost::new(path.parent().unwrap_or(Path::new("."))),
        printed: Mutex::default(),
    };
    let run = source::load(&name, &text, &host, &limits, options)?;
    let (mut earlier, mut warnings) = (run.value.pictures, run.warnings);
    let image = match earlier.pop() {
        Some(last) => last.image,
        None => {
            let rendered = render(&run.value.scene, &options.render, &host)?;
            warnings.extend(rendered.warnings);
            rendered.value.image
        }
    };
    Ok(RenderedFile {
        scene: run.value.scene,
        image,
        earlier,
        warnings,
        printed: host.printed.into_inner().unwrap_or_else(PoisonError::into_inner),
    })
}

/// Reads below one folder, keeps what is printed, takes every picture and drops it.
struct TestHost {
    assets: DirHost,
    printed: Mutex<String>,
}

impl Host for TestHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.assets.read(path, max_bytes)
    }

    fn print(&self, text: &str) {
        let mut printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
        printed.push_str(text);
        printed.push('\n');
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Builder;

    fn gray(width: u32, height: u32, byte: u8) -> Image {
        from_rgb8(width, height, &vec![byte; (width * height * 3) as usize])
    }

    #[test]
    fn bytes_survive_being_an_image() {
        let bytes: Vec<u8> = (0..=255).flat_map(|b| [b, 255 - b, b / 2]).collect();
        assert_eq!(from_rgb8(16, 16, &bytes).rgb8(), bytes);
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

    #[test]
    fn a_snapshot_holds_picture_and_scene() {
        let mut b = Builder::new();
        b.size(8, 8).unwrap();
        let text = snapshot_text(&b.finish().value, &gray(8, 8, 0));
        assert!(text.starts_with("size 8 x 8\nhash "));
        assert!(text.contains("\n\nsize 8 8\nsamples 1"), "{text}");
    }
}
