//! Radiance pictures (`.hdr`, `.pic`): light without an upper end (Ward, "Real pixels", Graphics Gems II, 1991).

use crate::{
    diag::{Diagnostic, ErrorKind},
    limits::Limits,
    scene::{ImageTexture, SceneError, Texels},
};

/// Bytes of the header, at most.
const HEADER: usize = 1 << 16;

/// True where the bytes begin as such a picture does.
pub(super) fn is_hdr(bytes: &[u8]) -> bool {
    bytes.starts_with(b"#?")
}

/// Decodes a picture of shared exponents, whether its lines are packed or not. The exposure that programs have noted is
/// taken back.
///
/// # Errors
/// Where it is damaged or of another kind (XYZE, or with its columns first), or passes the limits `texture_side` or
/// `decode_bytes`.
pub(super) fn decode(name: &str, bytes: &[u8], limits: &Limits) -> Result<ImageTexture, Diagnostic> {
    let damaged = |why: &str| {
        let message = format!("'{name}' is no Radiance picture that can be read: {why}");
        Diagnostic::error(ErrorKind::Input, message)
    };
    let (header, rest) = header(bytes).map_err(damaged)?;
    let Header {
        width,
        height,
        exposure,
        upside_down,
        mirrored,
    } = header;
    let side = width.max(height);
    if side > limits.texture_side {
        let what = format!("'{name}' has {width} x {height} texels, which is too large");
        return Err(limit(&what, "texture_side", u64::from(limits.texture_side)));
    }
    let texels = u64::from(width) * u64::from(height);
    if texels * size_of::<[f64; 3]>() as u64 > limits.decode_bytes {
        let what = format!("'{name}' has {width} x {height} texels, which takes too much memory");
        return Err(limit(&what, "decode_bytes", limits.decode_bytes));
    }
    // A packed line of w texels takes at least 8 bytes for each 127 of them, an old one 4 bytes for each 2^24.
    if texels / 32 > rest.len() as u64 * 1024 {
        return Err(damaged("it ends too early"));
    }
    let mut lines = Lines { bytes: rest };
    let mut pixels: Vec<[f64; 3]> = Vec::new();
    let mut line = vec![[0u8; 4]; width as usize];
    for _ in 0..height {
        lines.read(&mut line).map_err(damaged)?;
        let start = pixels.len();
        pixels.extend(line.iter().map(|pixel| light(*pixel, exposure)));
        if mirrored && let Some(read) = pixels.get_mut(start..) {
            read.reverse();
        }
    }
    if upside_down {
        let rows: Vec<_> = pixels.chunks(width as usize).rev().flatten().copied().collect();
        pixels = rows;
    }
    Ok(ImageTexture {
        name: name.to_owned(),
        width,
        height,
        texels: Texels::Linear(pixels),
    })
}

fn limit(what: &str, name: &'static str, value: u64) -> Diagnostic {
    SceneError::limit(what, name, value).into()
}

/// The middle of the interval that a mantissa stands for, as Radiance's own `colr_color` has it.
fn light([r, g, b, e]: [u8; 4], exposure: f64) -> [f64; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    // 2^(e - 136), exactly: no power of two here is too small for its own exponent.
    let scale = f64::from_bits(u64::from(1023 - 136 + u32::from(e)) << 52);
    [r, g, b].map(|m| (f64::from(m) + 0.5) * scale / exposure)
}

struct Header {
    width: u32,
    height: u32,
    exposure: f64,
    upside_down: bool,
    mirrored: bool,
}

/// The header and what follows it.
fn header(bytes: &[u8]) -> Result<(Header, &[u8]), &'static str> {
    let mut rest = bytes;
    let mut exposure = 1.0;
    let mut is_first = true;
    loop {
        let line = take_line(&mut rest, bytes.len())?;
        if line.is_empty() && !is_first {
            break;
        }
        is_first = false;
        if let Some(format) = line.strip_prefix("FORMAT=")
            && format.trim() != "32-bit_rle_rgbe"
        {
            return Err("its FORMAT is not 32-bit_rle_rgbe");
        }
        if let Some(given) = line.strip_prefix("EXPOSURE=") {
            let factor: f64 = given.trim().parse().map_err(|_| "its EXPOSURE is no number")?;
            exposure *= factor;
            if !(1e-30..=1e30).contains(&exposure) {
                return Err("its EXPOSURE is not between 1e-30 and 1e30");
            }
        }
    }
    let size = take_line(&mut rest, bytes.len())?;
    let words: Vec<&str> = size.split_ascii_whitespace().collect();
    let [y, height, x, width] = words.as_slice() else {
        return Err("its size is not written as -Y height +X width");
    };
    let upside_down = match *y {
        "-Y" => false,
        "+Y" => true,
        _ => return Err("its size is not written as -Y height +X width"),
    };
    let mirrored = match *x {
        "+X" => false,
        "-X" => true,
        _ => return Err("its size is not written as -Y height +X width"),
    };
    let side = |text: &str| text.parse::<u32>().ok().filter(|n| (1..=1 << 20).contains(n));
    let (Some(width), Some(height)) = (side(width), side(height)) else {
        return Err("its size is no pair of numbers above 0");
    };
    let header = Header {
        width,
        height,
        exposure,
        upside_down,
        mirrored,
    };
    Ok((header, rest))
}

fn take_line<'a>(rest: &mut &'a [u8], total: usize) -> Result<&'a str, &'static str> {
    let end = rest
        .iter()
        .position(|b| *b == b'\n')
        .ok_or("its header has no end")?;
    let (line, after) = rest.split_at_checked(end).ok_or("its header has no end")?;
    *rest = after.get(1..).unwrap_or_default();
    if total - rest.len() > HEADER {
        return Err("its header has no end");
    }
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    std::str::from_utf8(line).map_err(|_| "its header is not text")
}

/// The lines of pixels that are still to be read.
struct Lines<'a> {
    bytes: &'a [u8],
}

impl Lines<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], &'static str> {
        let (first, rest) = self.bytes.split_first_chunk::<N>().ok_or("it ends too early")?;
        self.bytes = rest;
        Ok(*first)
    }

    fn read(&mut self, line: &mut [[u8; 4]]) -> Result<(), &'static str> {
        let width = line.len();
        let is_packed = (8..0x8000).contains(&width) && self.bytes.starts_with(&[2, 2]);
        if !is_packed || self.bytes.get(2).is_none_or(|b| *b >= 128) {
            return self.read_old(line);
        }
        let [_, _, high, low] = self.take::<4>()?;
        if usize::from(high) << 8 | usize::from(low) != width {
            return Err("a line has another length than the picture");
        }
        for channel in 0..4 {
            let mut at = 0;
            while at < width {
                let [count] = self.take::<1>()?;
                let (len, is_run) = match count {
                    0 => return Err("a run of bytes has no length"),
                    1..=128 => (usize::from(count), false),
                    _ => (usize::from(count - 128), true),
                };
                let places = line
                    .get_mut(at..at + len)
                    .ok_or("a run of bytes goes beyond its line")?;
                if is_run {
                    let [value] = self.take::<1>()?;
                    places
                        .iter_mut()
                        .filter_map(|p| p.get_mut(channel))
                        .for_each(|p| *p = value);
                } else {
                    let (values, rest) = self.bytes.split_at_checked(len).ok_or("it ends too early")?;
                    self.bytes = rest;
                    let places = places.iter_mut().filter_map(|p| p.get_mut(channel));
                    places.zip(values).for_each(|(p, value)| *p = *value);
                }
                at += len;
            }
        }
        Ok(())
    }

    /// Pixels one by one; 1, 1, 1, n repeats the last one n times, and several such in a row have a larger n.
    fn read_old(&mut self, line: &mut [[u8; 4]]) -> Result<(), &'static str> {
        let (mut at, mut shift) = (0, 0);
        let mut last = None;
        while at < line.len() {
            let pixel = self.take::<4>()?;
            if let [1, 1, 1, n] = pixel {
                let again = last.ok_or("its first pixel repeats one that there is not")?;
                if shift > 16 {
                    return Err("a pixel is repeated more often than a line is long");
                }
                let len = usize::from(n) << shift;
                let places = line
                    .get_mut(at..at + len)
                    .ok_or("a run of pixels goes beyond its line")?;
                places.fill(again);
                at += len;
                shift += 8;
            } else {
                if let Some(place) = line.get_mut(at) {
                    *place = pixel;
                }
                last = Some(pixel);
                at += 1;
                shift = 0;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn file(size: &str, pixels: &[u8]) -> Vec<u8> {
        let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
        bytes.extend_from_slice(pixels);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
        let decoded = decode("a.hdr", bytes, &Limits::default()).map_err(|e| e.message)?;
        match decoded.texels {
            Texels::Linear(texels) => Ok(texels),
            Texels::Srgb8(_) => Err("bytes".to_owned()),
        }
    }

    #[test]
    fn flat_pixels_are_read_in_every_direction() {
        let pixels = [128, 64, 0, 129, 255, 0, 0, 136, 0, 0, 0, 0, 1, 2, 3, 128];
        let at = |size: &str| read(&file(size, &pixels)).unwrap();
        let straight = at("-Y 2 +X 2");
        assert_eq!(straight[0], [1.00390625, 0.50390625, 0.00390625]);
        assert_eq!(straight[1], [255.5, 0.5, 0.5]);
        assert_eq!(straight[2], [0.0; 3]);
        let [a, b, c, d] = straight[..] else { panic!() };
        assert_eq!(at("+Y 2 +X 2"), [c, d, a, b]);
        assert_eq!(at("-Y 2 -X 2"), [b, a, d, c]);
    }

    #[test]
    fn packed_lines_and_old_runs_are_read() {
        let mut packed = vec![2, 2, 0, 8];
        packed.extend([136, 10, 3, 1, 2, 3, 133, 9, 136, 0, 136, 128]);
        let texels = read(&file("-Y 1 +X 8", &packed)).unwrap();
        assert_eq!(texels[0][0], 10.5 / 256.0);
        let greens = texels.iter().map(|t| t[1] * 256.0 - 0.5);
        assert_eq!(
            greens.collect::<Vec<_>>(),
            [1.0, 2.0, 3.0, 9.0, 9.0, 9.0, 9.0, 9.0]
        );
        let old = [9, 9, 9, 128, 1, 1, 1, 2, 5, 5, 5, 128];
        let texels = read(&file("-Y 1 +X 4", &old)).unwrap();
        assert_eq!(texels[0], texels[2]);
        assert_ne!(texels[2], texels[3]);
    }

    #[test]
    fn the_exposure_is_taken_back() {
        let mut bytes = b"#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\n\n-Y 1 +X 1\n".to_vec();
        bytes.extend([127, 127, 127, 136]);
        assert_eq!(read(&bytes).unwrap(), [[127.5 / 8.0; 3]]);
    }

    #[test]
    fn damage_is_named() {
        let pixels = [0; 16];
        for (bytes, part) in [
            (b"#?RADIANCE".to_vec(), "its header has no end"),
            (
                b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n".to_vec(),
                "its FORMAT is not",
            ),
            (
                b"#?RADIANCE\nEXPOSURE=0\n\n".to_vec(),
                "its EXPOSURE is not between",
            ),
            (file("+X 2 -Y 2", &pixels), "is not written as -Y height +X width"),
            (file("-Y 0 +X 2", &pixels), "no pair of numbers above 0"),
            (file("-Y 3 +X 2", &pixels), "it ends too early"),
            (file("-Y 1 +X 2", &[1, 1, 1, 1]), "its first pixel repeats"),
            (
                file("-Y 1 +X 2", &[7, 7, 7, 7, 1, 1, 1, 9]),
                "goes beyond its line",
            ),
            (file("-Y 1 +X 8", &[2, 2, 0, 9]), "another length"),
            (file("-Y 1 +X 8", &[2, 2, 0, 8, 137, 1]), "goes beyond its line"),
            (file("-Y 1 +X 8", &[2, 2, 0, 8, 0]), "no length"),
            (file("-Y 1000000 +X 1000000", &pixels), "too large"),
        ] {
            let message = read(&bytes).unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_do_harm(
            size in "[-+]Y [0-9]{1,3} [-+]X [0-9]{1,3}",
            pixels in prop::collection::vec(prop_oneof![0..4u8, any::<u8>()], 0..600),
        ) {
            if let Ok(texels) = read(&file(&size, &pixels)) {
                prop_assert!(texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
            }
        }
    }
}
