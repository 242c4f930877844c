//! Pictures as textures.

use std::{io::Cursor, panic};

use image::{DynamicImage, GenericImageView, ImageFormat, ImageReader, error::ImageError};

use super::hdr;
use crate::{
    diag::{Diagnostic, ErrorKind},
    limits::Limits,
    scene::{ImageTexture, SceneError, Texels},
};

/// Decodes a PNG, JPEG or Radiance picture; which of them it is, its bytes say and not its name.
///
/// 16 bits are reduced to 8 and transparency is dropped. Both decoders work in whole numbers, so the texels
/// are the same on every machine.
///
/// # Errors
/// Where it is neither format, is damaged, has no pixels, or passes the limits `texture_side` or
/// `decode_bytes`.
pub(super) fn decode(name: &str, bytes: &[u8], limits: &Limits) -> Result<ImageTexture, Diagnostic> {
    if hdr::is_hdr(bytes) {
        return hdr::decode(name, bytes, limits);
    }
    let picture = decoded(name, bytes, limits, DynamicImage::into_rgb8)?;
    let (width, height) = picture.dimensions();
    let texels = picture.into_raw().as_chunks::<3>().0.to_vec();
    Ok(ImageTexture {
        name: name.to_owned(),
        width,
        height,
        texels: Texels::Srgb8(texels),
    })
}

/// The width of a picture and, row by row from the top, how solid its texels are, three times each: 255 where the picture does
/// not say.
///
/// # Errors
/// As [`decode`]; a Radiance picture is refused.
pub(super) fn alpha(name: &str, bytes: &[u8], limits: &Limits) -> Result<(u32, Vec<[u8; 3]>), Diagnostic> {
    let picture = decoded(name, bytes, limits, DynamicImage::into_rgba8)?;
    let (texels, _) = picture.as_raw().as_chunks::<4>();
    Ok((picture.width(), texels.iter().map(|[.., a]| [*a; 3]).collect()))
}

/// Width, height and, row by row from the top, how bright the numbers are that a picture stores: 0 for black, 1 for white.
/// 16 bits are kept. Colors count with the weights of Rec. 709.
///
/// # Errors
/// As [`decode`].
pub(super) fn levels(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(usize, usize, Vec<f64>), Diagnostic> {
    let picture = decoded(name, bytes, limits, DynamicImage::into_luma16)?;
    let (width, height) = picture.dimensions();
    // Numbers take eight times the bytes, and each is to be a corner.
    if u64::from(width) * u64::from(height) > limits.primitives as u64 {
        let what = format!("'{name}' has {width} x {height} pixels, too many for as many corners");
        return Err(SceneError::limit(&what, "primitives", limits.primitives).into());
    }
    let levels = picture
        .into_raw()
        .iter()
        .map(|level| f64::from(*level) / 65535.0)
        .collect();
    Ok((width as usize, height as usize, levels))
}

/// A picture as `convert` makes it, which has pixels.
fn decoded<P: GenericImageView>(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
    convert: impl Fn(DynamicImage) -> P + panic::RefUnwindSafe,
) -> Result<P, Diagnostic> {
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        _ if bytes.is_empty() => {
            return Err(input(format!(
                "'{name}' is empty; expected a PNG or JPEG picture"
            )));
        }
        _ => {
            return Err(input(format!("'{name}' is not a PNG or JPEG picture"))
                .hint("convert the picture to PNG or JPEG"));
        }
    };
    if format == ImageFormat::Jpeg && is_cut_off(bytes) {
        return Err(damaged(name, format, "it ends too early"));
    }
    if format == ImageFormat::Png
        && let Some(length) = palette_length(bytes)
        && length % 3 != 0
    {
        let why = format!("its palette has {length} bytes, which is no multiple of 3");
        return Err(damaged(name, format, &why));
    }
    // Decoders are where a malformed file is most likely to find a hole.
    let decoded = panic::catch_unwind(|| decode_as(format, bytes, limits).map(&convert));
    let picture = match decoded {
        Ok(Ok(picture)) => picture,
        Ok(Err(ImageError::Limits(_))) => return Err(too_large(name, format, bytes, limits)),
        Ok(Err(error)) => {
            let cause = std::error::Error::source(&error).and_then(|inner| inner.source());
            let why = cause.map_or_else(|| error.to_string(), ToString::to_string);
            return Err(damaged(name, format, &in_our_words(&why)));
        }
        Err(_) => return Err(damaged(name, format, "its decoder gave up")),
    };
    let (width, height) = picture.dimensions();
    if width == 0 || height == 0 {
        return Err(damaged(name, format, "it has no pixels"));
    }
    Ok(picture)
}

fn decode_as(format: ImageFormat, bytes: &[u8], limits: &Limits) -> Result<DynamicImage, ImageError> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut bounds = image::Limits::default();
    bounds.max_image_width = Some(limits.texture_side);
    bounds.max_image_height = Some(limits.texture_side);
    bounds.max_alloc = Some(limits.decode_bytes);
    reader.limits(bounds);
    reader.decode()
}

/// True where no end-of-image marker follows the last scan: the decoder would fill the rest with gray.
fn is_cut_off(jpeg: &[u8]) -> bool {
    let last = |marker: u8| jpeg.windows(2).rposition(|pair| pair == [0xff, marker]);
    let (scan, end) = (last(0xda), last(0xd9));
    scan.is_some() && end < scan
}

/// The bytes that the palette before the picture's data says it has. The decoder takes three at a time and panics at the
/// end of one that is no multiple of 3.
fn palette_length(png: &[u8]) -> Option<u32> {
    const SIGNATURE: usize = 8;
    // Length and kind before the data, a checksum after it.
    const AROUND: usize = 12;
    let mut rest = png.get(SIGNATURE..)?;
    loop {
        let (length, after) = rest.split_first_chunk()?;
        let length = u32::from_be_bytes(*length);
        match after.first_chunk()? {
            b"PLTE" => return Some(length),
            b"IDAT" => return None,
            _ => rest = rest.get(AROUND.checked_add(usize::try_from(length).ok()?)?..)?,
        }
    }
}

/// Which of the two limits it was, told by the picture's size.
fn too_large(name: &str, format: ImageFormat, bytes: &[u8], limits: &Limits) -> Diagnostic {
    let size = panic::catch_unwind(|| ImageReader::with_format(Cursor::new(bytes), format).into_dimensions());
    let (what, side) = match size {
        Ok(Ok((width, height))) => (
            format!("'{name}' has {width} x {height} texels"),
            width.max(height),
        ),
        _ => (format!("'{name}' takes too much memory to decode"), 0),
    };
    if side > limits.texture_side {
        SceneError::limit(&what, "texture_side", limits.texture_side).into()
    } else {
        SceneError::limit(&what, "decode_bytes", limits.decode_bytes).into()
    }
}

fn damaged(name: &str, format: ImageFormat, why: &str) -> Diagnostic {
    let format = if format == ImageFormat::Png { "PNG" } else { "JPEG" };
    let why: String = why.chars().filter(|c| !c.is_control()).take(120).collect();
    input(format!("'{name}' is a damaged {format} picture: {why}"))
        .hint("fetch it anew, or save it again with another program")
}

/// What a decoder says, without that it is an error of the format, without the insides of its types, and written as our
/// messages are.
fn in_our_words(why: &str) -> String {
    let why = match why.split_once(": ") {
        Some((start, rest)) if start.starts_with("Format error decoding") => rest,
        _ => why,
    };
    let why = why.trim_matches('"');
    if why.contains("Not enough bytes") {
        return "unexpected end of file".to_owned();
    }
    // What only those know who know the format, or the decoder.
    if why.contains("CRC error") {
        return "a checksum is wrong".to_owned();
    }
    if why.contains("deflate stream") {
        return "its packed data is wrong".to_owned();
    }
    if why.contains("color/depth combination") {
        return "its kind of color cannot have that many bits".to_owned();
    }
    if why.contains("can only parse 8-bit images") {
        return "it has more than 8 bits for each color".to_owned();
    }
    let why = why.replace(". Reason:", ": ").replace("stream. ", "stream: ");
    let mut rest = why.as_str();
    let mut words = String::new();
    while let Some((before, chunk)) = rest.split_once("ChunkType { type: ") {
        // A kind that is no letters is written with braces and commas of its own.
        let (kind, after) = chunk.split_once(", critical").unwrap_or((chunk, ""));
        let after = after.split_once(" }").map_or("", |(_, after)| after);
        words += before;
        words += kind;
        rest = after;
    }
    words += rest;
    let words = words.trim_end_matches('.').to_owned();
    let mut chars = words.chars();
    match (chars.next(), chars.as_str()) {
        // "IDAT" and "CRC" stay.
        (Some(first), rest) if rest.starts_with(char::is_lowercase) => {
            format!("{}{rest}", first.to_lowercase())
        }
        _ => words,
    }
}

fn input(message: String) -> Diagnostic {
    Diagnostic::error(ErrorKind::Input, message)
}
