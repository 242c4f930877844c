//! Pictures to files: encoding by the name's ending, and writing that leaves the whole new file or the old one.
//!
//! No encoder writes a time stamp or anything else the picture does not hold. A picture's identity is
//! [`Image::hash`], never the bytes of a file, which may change with the encoder's version.

mod exr;
mod file;
mod float;

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder};

pub use self::file::{check_writable, write_atomically};
#[cfg(feature = "cli")]
pub(crate) use self::file::{remove_unfinished, write_atomically_with, write_new};
use crate::{
    diag::ErrorKind,
    host::HostError,
    recipe::Recipe,
    render::{Image, Layer},
};

/// Quality of JPEG files, of 100: no visible blocks, a third of the size of a PNG.
const JPEG_QUALITY: u8 = 95;

/// A kind of picture file.
///
/// ```
/// use rtscript::output::Format;
/// assert_eq!(Format::from_path("a.PNG".as_ref())?, Format::Png);
/// assert!(Format::from_path("a.gif".as_ref()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lossless, compressed: `.png`.
    Png,
    /// Lossy: `.jpg`, `.jpeg`.
    Jpeg,
    /// Lossless, not compressed (binary portable pixmap, `P6`): `.ppm`.
    Ppm,
    /// OpenEXR: linear light in 16 or 32 bits, with the picture's layers as channels: `.exr`.
    Exr,
    /// Radiance: linear light in 8 bits with a shared exponent: `.hdr`.
    Hdr,
    /// Linear light in 32 bits (portable float map): `.pfm`.
    Pfm,
}

impl Format {
    /// Every ending that is known, with its format.
    pub const ENDINGS: [(&'static str, Self); 7] = [
        ("png", Self::Png),
        ("jpg", Self::Jpeg),
        ("jpeg", Self::Jpeg),
        ("ppm", Self::Ppm),
        ("exr", Self::Exr),
        ("hdr", Self::Hdr),
        ("pfm", Self::Pfm),
    ];

    /// The format that the ending of `path` asks for, upper or lower case.
    ///
    /// # Errors
    /// `Output` where the ending is missing or unknown; the message lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, HostError> {
        let ending = path.extension().map(|e| e.to_string_lossy().into_owned());
        let known = |ending: &String| {
            let mut endings = Self::ENDINGS.iter();
            endings.find(|(name, _)| ending.eq_ignore_ascii_case(name))
        };
        if let Some((_, format)) = ending.as_ref().and_then(known) {
            return Ok(*format);
        }
        let list: Vec<String> = Self::ENDINGS.iter().map(|(name, _)| format!(".{name}")).collect();
        let what = match ending {
            Some(ending) => format!("the ending '.{ending}' is not a picture format"),
            None => "the name has no ending that says the picture format".to_owned(),
        };
        Err(refused(path, format!("{what}; known are {}", list.join(", "))))
    }
}

/// Encodes a picture into a writer.
///
/// # Errors
/// What the writer reports.
///
/// ```
/// use rtscript::{Image, output::{Format, encode, encode_into}, testing::from_rgb8};
/// let image: Image = from_rgb8(1, 1, &[255, 0, 0]);
/// let mut out = Vec::new();
/// encode_into(&image, Format::Ppm, &mut out)?;
/// assert_eq!(out, encode(&image, Format::Ppm)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encode_into(image: &Image, format: Format, out: &mut impl Write) -> io::Result<()> {
    let (width, height) = (image.width(), image.height());
    let file = image.file_options();
    match format {
        Format::Png => encode_png(image, None, &mut *out)?,
        Format::Jpeg => JpegEncoder::new_with_quality(&mut *out, file.quality.unwrap_or(JPEG_QUALITY))
            .write_image(&image.rgb8(), width, height, ExtendedColorType::Rgb8)
            .map_err(into_io)?,
        Format::Ppm if file.bits == Some(16) => {
            write!(out, "P6\n{width} {height}\n65535\n")?;
            out.write_all(&rgb16_bytes(image))?;
        }
        Format::Ppm => {
            write!(out, "P6\n{width} {height}\n255\n")?;
            out.write_all(&image.rgb8())?;
        }
        Format::Exr => exr::write((width, height), channels(image), out)?,
        Format::Hdr => float::write_hdr(image, out)?,
        Format::Pfm => {
            let values: Vec<f32> = image.pixels().as_flattened().iter().map(|v| *v as f32).collect();
            float::write_pfm((width, height), 3, &values, out)?;
        }
    }
    out.flush()
}

/// The channels of an EXR: the picture's, then those of its layers, which are always of 32 bits.
fn channels(image: &Image) -> Vec<exr::Channel> {
    let number = match image.file_options().bits {
        Some(16) => exr::Number::Half,
        _ => exr::Number::Float,
    };
    let color = ["R", "G", "B"]
        .into_iter()
        .enumerate()
        .map(|(i, name)| exr::Channel {
            name: name.to_owned(),
            number,
            values: image
                .pixels()
                .iter()
                .filter_map(|p| Some(*p.get(i)? as f32))
                .collect(),
        });
    let layers = image.layers().iter().flat_map(|layer| {
        let names = layer.kind.channels();
        names.iter().enumerate().map(move |(i, name)| exr::Channel {
            name: format!("{}.{name}", layer.kind.name()),
            number: exr::Number::Float,
            values: layer
                .values
                .iter()
                .skip(i)
                .step_by(names.len())
                .copied()
                .collect(),
        })
    });
    color.chain(layers).collect()
}

/// 16 bits a channel, most significant byte first.
fn rgb16_bytes(image: &Image) -> Vec<u8> {
    image.rgb16().into_iter().flat_map(u16::to_be_bytes).collect()
}

/// Encodes a PNG that carries its recipe as a text chunk.
///
/// # Errors
/// What the writer reports.
///
/// ```
/// use rtscript::{output::encode_png_with, parameters::Parameters, recipe::Recipe, testing::from_rgb8};
/// let image = from_rgb8(1, 1, &[255, 0, 0]);
/// let recipe = Recipe::new("a.rhai", "sphere(0, 0, 0, 1);", &Parameters::default()).of_picture(image.hash());
/// let png = encode_png_with(&image, &recipe)?;
/// assert_eq!(Recipe::of_png(&png), Some(recipe));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encode_png_with(image: &Image, recipe: &Recipe) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(image, Some(recipe), &mut bytes)?;
    Ok(bytes)
}

fn encode_png(image: &Image, recipe: Option<&Recipe>, out: impl Write) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    let is_deep = image.file_options().bits == Some(16);
    encoder.set_depth(match is_deep {
        true => png::BitDepth::Sixteen,
        false => png::BitDepth::Eight,
    });
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    if let Some(recipe) = recipe {
        writer.write_text_chunk(&recipe.chunk())?;
    }
    match is_deep {
        true => writer.write_image_data(&rgb16_bytes(image))?,
        false => writer.write_image_data(&image.rgb8())?,
    }
    Ok(writer.finish()?)
}

/// Encodes a picture into bytes.
///
/// # Errors
/// What the encoder reports, such as a size the format cannot hold.
///
/// ```
/// use rtscript::{output::{Format, encode}, testing::from_rgb8};
/// let image = from_rgb8(2, 1, &[255, 0, 0, 0, 0, 255]);
/// assert_eq!(encode(&image, Format::Ppm)?, b"P6\n2 1\n255\n\xff\0\0\0\0\xff");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encode(image: &Image, format: Format) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_into(image, format, &mut bytes)?;
    Ok(bytes)
}

/// Writes a picture to a file in the format its ending asks for, whole or not at all. Layers are channels of an EXR; else
/// they get files of their own beside it, `NAME.LAYER.ENDING`: pictures to look at, or numbers as PFM where the format is
/// one of numbers.
///
/// # Errors
/// `Output`, naming the path, where the ending is unknown or the file cannot be written.
///
/// ```
/// use rtscript::{output::save, testing::{from_rgb8, load_picture}};
/// let path = std::env::temp_dir().join(format!("rtscript-save-{}.png", std::process::id()));
/// save(&path, &from_rgb8(1, 1, &[255, 0, 0]))?;
/// assert_eq!(load_picture(&path)?.rgb8(), [255, 0, 0]);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn save(path: &Path, image: &Image) -> Result<(), HostError> {
    let format = Format::from_path(path)?;
    image
        .file_options()
        .check(&path.to_string_lossy())
        .map_err(|why| refused(path, why))?;
    let bytes = encode(image, format).map_err(|e| refused(path, reason(&e)))?;
    write_atomically(path, &bytes)?;
    save_layers(path, image, format)
}

/// Writes the layers beside the picture where its format does not hold them.
fn save_layers(path: &Path, image: &Image, format: Format) -> Result<(), HostError> {
    if format == Format::Exr {
        return Ok(());
    }
    for layer in image.layers() {
        let (width, height) = (image.width(), image.height());
        let is_number = matches!(format, Format::Hdr | Format::Pfm);
        let ending = match path.extension() {
            Some(ending) if !is_number => ending.to_string_lossy().into_owned(),
            _ => "pfm".to_owned(),
        };
        let path = path.with_extension(format!("{}.{ending}", layer.kind.name()));
        let bytes = if is_number {
            layer_pfm(layer, (width, height))
        } else {
            encode(&layer.picture(width, height), format)
        };
        write_atomically(&path, &bytes.map_err(|e| refused(&path, reason(&e)))?)?;
    }
    Ok(())
}

/// A layer as a portable float map of one or three channels.
fn layer_pfm(layer: &Layer, size: (u32, u32)) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match layer.kind.channels().len() {
        2 => {
            let pairs = layer.values.chunks(2);
            let values: Vec<f32> = pairs.flat_map(|uv| uv.iter().copied().chain([0.0])).collect();
            float::write_pfm(size, 3, &values, &mut bytes)?;
        }
        channels => float::write_pfm(size, channels, &layer.values, &mut bytes)?,
    }
    Ok(bytes)
}

/// As [`save`], with the recipe in the file where its format has a place for it: PNG of 8 bits, whose pixels are those that
/// [`Image::hash`] is of.
///
/// # Errors
/// As [`save`].
///
/// ```
/// use rtscript::{output::save_with, parameters::Parameters, recipe::Recipe, testing::from_rgb8};
/// let path = std::env::temp_dir().join(format!("rtscript-save-with-{}.png", std::process::id()));
/// let image = from_rgb8(1, 1, &[255, 0, 0]);
/// save_with(&path, &image, &Recipe::new("a.rhai", "sphere(0, 0, 0, 1);", &Parameters::default()))?;
/// assert!(Recipe::of_png(&std::fs::read(&path)?).is_some());
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn save_with(path: &Path, image: &Image, recipe: &Recipe) -> Result<(), HostError> {
    if Format::from_path(path)? != Format::Png || image.file_options().bits == Some(16) {
        return save(path, image);
    }
    let bytes = encode_png_with(image, recipe).map_err(|e| refused(path, reason(&e)))?;
    write_atomically(path, &bytes)?;
    save_layers(path, image, Format::Png)
}

/// Whether a picture can be written to `path`, asked before the render is paid for: the ending is known, and
/// [`check_writable`].
///
/// # Errors
/// `Output`, naming the path and what stands in the way.
///
/// ```
/// use rtscript::output::check_target;
/// let inputs = ["scene.png".into()];
/// assert!(check_target("picture.png".as_ref(), &inputs).is_ok());
/// // It has an unknown ending, or has nowhere to go.
/// for wrong in ["picture.gif", "no/such/folder/picture.png"] {
///     assert!(check_target(wrong.as_ref(), &inputs).is_err());
/// }
/// ```
pub fn check_target(path: &Path, inputs: &[PathBuf]) -> Result<(), HostError> {
    Format::from_path(path)?;
    check_writable(path, inputs)
}

/// The system's reason in words, without its number.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    match text.find(" (os error") {
        Some(end) => text[..end].to_lowercase(),
        None => text,
    }
}

fn refused(path: &Path, why: impl std::fmt::Display) -> HostError {
    HostError::new(
        ErrorKind::Output,
        format!("cannot write '{}': {why}", path.display()),
    )
}

fn into_io(error: image::ImageError) -> io::Error {
    match error {
        image::ImageError::IoError(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Encoding;

    fn gradient() -> Image {
        let pixels = (0..35).map(|i| [f64::from(i) / 34.0, 0.5, 1.5 - f64::from(i) / 20.0]);
        Image::new(7, 5, Encoding::Srgb, pixels.collect())
    }

    #[test]
    fn lossless_files_hold_the_very_pixels() {
        let image = gradient();
        let png = image::load_from_memory(&encode(&image, Format::Png).unwrap()).unwrap();
        assert_eq!(png.to_rgb8().into_raw(), image.rgb8());
        let ppm = encode(&image, Format::Ppm).unwrap();
        assert!(ppm.starts_with(b"P6\n7 5\n255\n"));
        assert!(ppm.ends_with(&image.rgb8()));
    }

    #[test]
    fn jpeg_is_near() {
        let image = Image::new(16, 16, Encoding::Srgb, vec![[0.2, 0.4, 0.6]; 256]);
        let jpeg = image::load_from_memory(&encode(&image, Format::Jpeg).unwrap())
            .unwrap()
            .to_rgb8()
            .into_raw();
        assert_eq!(jpeg.len(), 768);
        assert!(jpeg.iter().zip(image.rgb8()).all(|(a, b)| a.abs_diff(b) <= 3));
    }

    #[test]
    fn the_ending_says_the_format() {
        assert_eq!(Format::from_path(Path::new("a/b.PNG")), Ok(Format::Png));
        assert_eq!(Format::from_path(Path::new("b.jpeg")), Ok(Format::Jpeg));
        let message = |name: &str| Format::from_path(Path::new(name)).unwrap_err().message;
        assert_eq!(
            message("b.xyz"),
            "cannot write 'b.xyz': the ending '.xyz' is not a picture format; known are .png, .jpg, .jpeg, .ppm, .exr, .hdr, .pfm"
        );
        assert!(message("png").contains("no ending"));
    }
}
