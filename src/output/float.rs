//! Files of numbers that are not held between 0 and 1: Radiance HDR and portable float maps.

use std::io::{self, Write};

use crate::render::Image;

/// A Radiance picture: 8 bits for each channel and 8 for the exponent that they share (Ward, "Real pixels", in Graphics
/// Gems II, 1991). What is below 0 becomes 0.
///
/// # Errors
/// What the writer reports.
pub(super) fn write_hdr(image: &Image, out: &mut dyn Write) -> io::Result<()> {
    let (width, height) = (image.width(), image.height());
    write!(
        out,
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nPRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.329\n\n-Y {height} +X {width}\n"
    )?;
    for line in image.pixels().chunks(width as usize) {
        let pixels: Vec<[u8; 4]> = line.iter().map(|p| rgbe(*p)).collect();
        // Other widths have no packed lines.
        match u16::try_from(width) {
            Ok(width) if (8..0x8000).contains(&width) => {
                let [high, low] = width.to_be_bytes();
                out.write_all(&[2, 2, high, low])?;
                for channel in 0..4 {
                    let bytes: Vec<u8> = pixels.iter().filter_map(|p| p.get(channel).copied()).collect();
                    write_runs(&bytes, out)?;
                }
            }
            _ => out.write_all(pixels.as_flattened())?,
        }
    }
    Ok(())
}

/// Red, green and blue in units of 2^(e - 136).
fn rgbe(pixel: [f64; 3]) -> [u8; 4] {
    // 255 * 2^119 is the largest there is.
    let pixel = pixel.map(|v| if v > 0.0 { v.min(1.69e38) } else { 0.0 });
    let most = pixel.iter().copied().fold(0.0, f64::max);
    if most < 1e-38 {
        return [0; 4];
    }
    // most = m 2^exponent with m in [1/2, 1).
    let exponent = (most.to_bits() >> 52) as i32 - 1022;
    let scale = f64::from_bits(((8 - exponent + 1023) as u64) << 52);
    let [r, g, b] = pixel.map(|v| (v * scale) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// Runs of equal bytes, and pieces of others.
fn write_runs(bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    /// Shorter runs cost as much as they save.
    const SHORTEST: usize = 4;
    let mut rest = bytes;
    let run = |bytes: &[u8]| {
        let first = bytes.first();
        bytes.iter().take(127).take_while(|b| Some(*b) == first).count()
    };
    while let Some(first) = rest.first() {
        let count = run(rest);
        if count >= SHORTEST {
            out.write_all(&[128 + count as u8, *first])?;
            rest = rest.get(count..).unwrap_or_default();
            continue;
        }
        let mut length = 0;
        while length < rest.len().min(128) && run(rest.get(length..).unwrap_or_default()) < SHORTEST {
            length += 1;
        }
        let (piece, after) = rest.split_at(length);
        out.write_all(&[length as u8])?;
        out.write_all(piece)?;
        rest = after;
    }
    Ok(())
}

/// A portable float map of one or three channels: 32 bits a number, least byte first, rows from below.
///
/// # Errors
/// What the writer reports.
pub(super) fn write_pfm(
    (width, height): (u32, u32),
    channels: usize,
    values: &[f32],
    out: &mut dyn Write,
) -> io::Result<()> {
    let kind = if channels == 1 { "Pf" } else { "PF" };
    write!(out, "{kind}\n{width} {height}\n-1.0\n")?;
    for line in values.chunks((width as usize * channels).max(1)).rev() {
        let bytes: Vec<u8> = line.iter().flat_map(|v| v.to_le_bytes()).collect();
        out.write_all(&bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Encoding;

    #[test]
    fn shared_exponents_are_within_a_256th() {
        assert_eq!(rgbe([1.0, 0.5, 0.0]), [128, 64, 0, 129]);
        assert_eq!(rgbe([0.0; 3]), [0; 4]);
        assert_eq!(rgbe([f64::NAN, -1.0, 0.0]), [0; 4]);
        for (i, scale) in (0..400).zip([1e-30, 0.3, 1.0, 7.0, 1e5, 1e30].into_iter().cycle()) {
            let pixel = [0.1, 0.5, 0.9].map(|v| v * scale * (1.0 + f64::from(i) / 97.0));
            let [r, g, b, e] = rgbe(pixel);
            let most = pixel[2];
            for (v, byte) in pixel.iter().zip([r, g, b]) {
                let read = f64::from(byte) * f64::from_bits(((1023 + i32::from(e) - 136) as u64) << 52);
                assert!(read <= *v && v - read <= most / 128.0, "{v} {read}");
            }
        }
        assert_eq!(rgbe([f64::INFINITY, 0.0, 0.0])[3], 255);
    }

    fn unpacked(mut bytes: &[u8], count: usize) -> (Vec<u8>, &[u8]) {
        let mut all = Vec::new();
        while all.len() < count {
            let (length, after) = bytes.split_first().unwrap();
            if *length > 128 {
                all.extend(vec![after[0]; usize::from(*length) - 128]);
                bytes = &after[1..];
            } else {
                all.extend(&after[..usize::from(*length)]);
                bytes = &after[usize::from(*length)..];
            }
        }
        (all, bytes)
    }

    #[test]
    fn packed_lines_unpack() {
        let mut state = 1u32;
        for length in [8, 127, 128, 129, 300] {
            for most in [1, 2, 200] {
                let mut last = 0;
                let bytes: Vec<u8> = (0..length)
                    .map(|_| {
                        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        if state >> 24 < most {
                            last = (state >> 8) as u8;
                        }
                        last
                    })
                    .collect();
                let mut packed = Vec::new();
                write_runs(&bytes, &mut packed).unwrap();
                assert_eq!(unpacked(&packed, bytes.len()), (bytes, &[][..]));
            }
        }
    }

    #[test]
    fn float_maps_begin_below() {
        let mut file = Vec::new();
        write_pfm((2, 2), 1, &[1.0, 2.0, 3.0, 4.0], &mut file).unwrap();
        let (head, data) = file.split_at(file.len() - 16);
        assert_eq!(head, b"Pf\n2 2\n-1.0\n");
        let values: Vec<f32> = data
            .chunks(4)
            .map(|v| f32::from_le_bytes(v.try_into().unwrap()))
            .collect();
        assert_eq!(values, [3.0, 4.0, 1.0, 2.0]);
        let image = Image::new(9, 1, Encoding::Srgb, vec![[0.25, 0.5, 1.0]; 9]);
        let mut file = Vec::new();
        write_hdr(&image, &mut file).unwrap();
        let start = file.windows(4).position(|w| w == b"+X 9").unwrap() + 5;
        let (head, data) = file[start..].split_at(4);
        assert_eq!(head, [2, 2, 0, 9]);
        assert_eq!(
            unpacked(data, 36).0,
            [[32; 9], [64; 9], [128; 9], [129; 9]].as_flattened()
        );
    }
}
