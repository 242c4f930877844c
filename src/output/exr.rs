//! OpenEXR files: scanlines, zlib over blocks of 16 lines, one part, any channels ("OpenEXR file layout", Academy Software
//! Foundation).

use std::io::{self, Write};

use flate2::{Compression, write::ZlibEncoder};

/// Lines that are compressed together.
const LINES: usize = 16;
/// The compression that `LINES` belong to.
const ZIP: u8 = 3;

/// How the numbers of a channel are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    /// 16 bits.
    Half,
    /// 32 bits.
    Float,
}

/// A channel: its name, how it is stored, its values in rows from the top.
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) number: Number,
    pub(super) values: Vec<f32>,
}

/// Writes a file of these channels, each of `width * height` values.
///
/// # Errors
/// What the writer reports; where a size does not fit the format.
pub(super) fn write(
    (width, height): (u32, u32),
    mut channels: Vec<Channel>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let too_large = || io::Error::other("the picture is too large for OpenEXR");
    let (right, bottom) = (i32::try_from(width - 1), i32::try_from(height - 1));
    let (Ok(right), Ok(bottom)) = (right, bottom) else {
        return Err(too_large());
    };
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    let mut file: Vec<u8> = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        file.extend([name.as_bytes(), &[0], kind.as_bytes(), &[0]].concat());
        file.extend((value.len() as u32).to_le_bytes());
        file.extend(value);
    };
    let mut list = Vec::new();
    for channel in &channels {
        list.extend(channel.name.as_bytes());
        list.push(0);
        let kind: u32 = match channel.number {
            Number::Half => 1,
            Number::Float => 2,
        };
        list.extend(kind.to_le_bytes());
        // Not perceptually linear, three reserved bytes, every column and row.
        list.extend([0; 4]);
        list.extend(1u32.to_le_bytes());
        list.extend(1u32.to_le_bytes());
    }
    list.push(0);
    let window: Vec<u8> = [0, 0, right, bottom]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    // CIE x and y of red, green, blue and white: Rec. 709.
    let primaries: [f32; 8] = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    let primaries: Vec<u8> = primaries.iter().flat_map(|v| v.to_le_bytes()).collect();
    attribute("channels", "chlist", &list);
    attribute("chromaticities", "chromaticities", &primaries);
    attribute("compression", "compression", &[ZIP]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    file.push(0);

    let (width, height) = (width as usize, height as usize);
    let mut blocks = Vec::new();
    for first in (0..height).step_by(LINES) {
        let mut bytes = Vec::new();
        for y in first..height.min(first + LINES) {
            for channel in &channels {
                let line = channel.values.iter().skip(y * width).take(width);
                match channel.number {
                    Number::Half => line.for_each(|v| bytes.extend(half(*v).to_le_bytes())),
                    Number::Float => line.for_each(|v| bytes.extend(v.to_le_bytes())),
                }
            }
        }
        let packed = compressed(&bytes)?;
        // Where it does not get smaller, it is stored as it is.
        blocks.push(if packed.len() < bytes.len() { packed } else { bytes });
    }
    let mut offset = file.len() as u64 + 8 * blocks.len() as u64;
    for block in &blocks {
        file.extend(offset.to_le_bytes());
        offset += 8 + block.len() as u64;
    }
    out.write_all(&file)?;
    for (block, i) in blocks.iter().zip(0..) {
        let y = i32::try_from(i * LINES).map_err(|_| too_large())?;
        let length = i32::try_from(block.len()).map_err(|_| too_large())?;
        out.write_all(&y.to_le_bytes())?;
        out.write_all(&length.to_le_bytes())?;
        out.write_all(block)?;
    }
    Ok(())
}

/// Even bytes before odd ones, each as its difference from the one before, then zlib.
fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let even = bytes.iter().step_by(2);
    let odd = bytes.iter().skip(1).step_by(2);
    let mut last = None;
    let differences: Vec<u8> = even
        .chain(odd)
        .map(|byte| {
            let difference = match last {
                None => *byte,
                Some(last) => byte.wrapping_sub(last).wrapping_add(128),
            };
            last = Some(*byte);
            difference
        })
        .collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&differences)?;
    encoder.finish()
}

/// The nearest number of 16 bits, ties to even; what is too large is infinite.
fn half(v: f32) -> u16 {
    let bits = v.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    let size = bits & 0x7fff_ffff;
    if size > 0x7f80_0000 {
        return sign | 0x7e00;
    }
    if size >= 0x477f_f000 {
        return sign | 0x7c00;
    }
    if size < 0x3880_0000 {
        // Below the normal numbers steps are 2^-24. The sum rounds to them.
        let sum = f32::from_bits(size) + 0.5;
        return sign | (sum.to_bits() - 0x3f00_0000) as u16;
    }
    let rounded = size + 0xfff + (size >> 13 & 1);
    sign | ((rounded - 0x3800_0000) >> 13) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 to this power.
    fn power(exponent: i32) -> f64 {
        f64::from_bits(((1023 + exponent) as u64) << 52)
    }

    fn whole(half: u16) -> f64 {
        let sign = if half & 0x8000 == 0 { 1.0 } else { -1.0 };
        let (exponent, fraction) = (i32::from(half >> 10 & 31), f64::from(half & 1023));
        sign * match exponent {
            0 => fraction * power(-24),
            31 if fraction == 0.0 => f64::INFINITY,
            31 => f64::NAN,
            _ => (1.0 + fraction / 1024.0) * power(exponent - 15),
        }
    }

    #[test]
    fn halves_are_the_nearest() {
        for bits in (0..=0x7c00).chain(0x8000..=0xfc00) {
            let v = whole(bits);
            assert_eq!(half(v as f32), bits, "{v}");
            if bits & 0x7fff < 0x7bff {
                // Just off the middle between this and the next.
                let next = whole(bits + 1);
                let middle = ((v + next) * 0.5) as f32;
                let (below, above) = (middle.next_down(), middle.next_up());
                let (low, high) = if v < next { (below, above) } else { (above, below) };
                assert_eq!((half(low), half(high)), (bits, bits + 1));
                assert_eq!(half(middle), bits + (bits & 1));
            }
        }
        assert_eq!(half(1e9), 0x7c00);
        assert!(whole(half(f32::NAN)).is_nan());
    }

    /// The values of a file's channels, read by what the layout says.
    fn read(file: &[u8], size: (usize, usize), numbers: &[Number]) -> Vec<Vec<f32>> {
        let int = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let text = |at: usize| {
            let end = file[at..].iter().position(|b| *b == 0).unwrap();
            (std::str::from_utf8(&file[at..at + end]).unwrap(), at + end + 1)
        };
        let mut at = 8;
        while file[at] != 0 {
            let (_, kind) = text(at);
            let (_, length) = text(kind);
            at = length + 4 + int(length);
        }
        let table = at + 1;
        let mut channels = vec![Vec::new(); numbers.len()];
        for block in 0..size.1.div_ceil(LINES) {
            let at = int(table + 8 * block);
            assert_eq!(int(at), block * LINES);
            let packed = &file[at + 8..at + 8 + int(at + 4)];
            let lines = (size.1 - block * LINES).min(LINES);
            let width = |n: &Number| if *n == Number::Half { 2 } else { 4 };
            let bytes = lines * size.0 * numbers.iter().map(width).sum::<usize>();
            let raw = if packed.len() == bytes {
                packed.to_vec()
            } else {
                let mut differences = Vec::new();
                let mut decoder = flate2::write::ZlibDecoder::new(&mut differences);
                decoder.write_all(packed).unwrap();
                decoder.finish().unwrap();
                for i in 1..differences.len() {
                    differences[i] = differences[i - 1].wrapping_add(differences[i]).wrapping_sub(128);
                }
                let half = differences.len().div_ceil(2);
                (0..differences.len())
                    .map(|i| differences[i / 2 + (i % 2) * half])
                    .collect()
            };
            let mut rest = raw.as_slice();
            for _ in 0..lines {
                for (values, number) in channels.iter_mut().zip(numbers) {
                    for _ in 0..size.0 {
                        let (v, after) = rest.split_at(width(number));
                        values.push(match number {
                            Number::Half => whole(u16::from_le_bytes(v.try_into().unwrap())) as f32,
                            Number::Float => f32::from_le_bytes(v.try_into().unwrap()),
                        });
                        rest = after;
                    }
                }
            }
            assert!(rest.is_empty());
        }
        channels
    }

    #[test]
    fn files_hold_their_channels_in_order_of_names() {
        for (width, height) in [(7, 5), (40, 37), (1, 16)] {
            let values = |k: usize| (0..width * height).map(|i| (i * k % 64) as f32 * 0.25).collect();
            let channel = |name: &str, number, k| Channel {
                name: name.to_owned(),
                number,
                values: values(k),
            };
            let channels = vec![
                channel("R", Number::Half, 1),
                channel("depth.Z", Number::Float, 3),
                channel("G", Number::Float, 7),
            ];
            let mut file = Vec::new();
            write((width as u32, height as u32), channels, &mut file).unwrap();
            let read = read(
                &file,
                (width, height),
                &[Number::Float, Number::Half, Number::Float],
            );
            assert_eq!(read, [values(7), values(1), values(3)]);
        }
    }
}
