//! Sixel graphics (DEC, VT330/VT340 programmer reference manual, chapter 14): six rows of pixels at a time, one color
//! after the other.

use std::fmt::Write as _;

use super::picture::Pixels;

/// Colors of a picture; terminals have at least so many registers.
const MOST: usize = 256;
/// Bits of each channel by which colors are told apart.
const BITS: u32 = 5;

/// The escape sequence that shows the pixels where the cursor stands.
pub(super) fn encode(pixels: &Pixels) -> String {
    let palette = Palette::of(pixels);
    let (width, height) = (pixels.width as usize, pixels.height as usize);
    // Square pixels; what is not set stays as it is.
    let mut text = format!("\x1bP0;1;0q\"1;1;{width};{height}");
    for (i, color) in palette.colors.iter().enumerate() {
        let [r, g, b] = color.map(|c| (u32::from(c) * 100 + 127) / 255);
        // Writing into a String does not fail.
        let _ = write!(text, "#{i};2;{r};{g};{b}");
    }
    let indices: Vec<u8> = (0..)
        .zip(&pixels.rgb)
        .map(|(i, color)| palette.index(dithered(*color, i % width.max(1), i / width.max(1))))
        .collect();
    for (i, band) in indices.chunks(6 * width.max(1)).enumerate() {
        // Not after the last: it might scroll the screen.
        if i > 0 {
            text.push('-');
        }
        write_band(&mut text, band, width);
    }
    text.push_str("\x1b\\");
    text
}

/// Six rows: for each color that stands in them the columns from its first to its last.
fn write_band(text: &mut String, band: &[u8], width: usize) {
    // The sixels of each color and the columns it reaches from and to.
    let mut colors: Vec<Option<(Vec<u8>, usize, usize)>> = vec![None; MOST];
    for (row, line) in band.chunks(width.max(1)).enumerate() {
        for (x, index) in line.iter().enumerate() {
            if let Some(color) = colors.get_mut(usize::from(*index)) {
                let (sixels, first, last) = color.get_or_insert_with(|| (vec![0; width], x, x));
                (*first, *last) = ((*first).min(x), (*last).max(x));
                if let Some(sixel) = sixels.get_mut(x) {
                    *sixel |= 1 << row;
                }
            }
        }
    }
    let mut is_first = true;
    for (index, color) in colors.iter().enumerate() {
        let Some((sixels, first, last)) = color else {
            continue;
        };
        if !is_first {
            text.push('$');
        }
        is_first = false;
        let _ = write!(text, "#{index}");
        write_run(text, 0, *first);
        let mut rest = sixels.get(*first..=*last).unwrap_or_default();
        while let Some(sixel) = rest.first() {
            let count = rest.iter().take_while(|other| *other == sixel).count();
            write_run(text, *sixel, count);
            rest = rest.get(count..).unwrap_or_default();
        }
    }
}

/// The same sixel so many times.
fn write_run(text: &mut String, sixel: u8, count: usize) {
    let letter = char::from(b'?' + sixel);
    if count > 3 {
        let _ = write!(text, "!{count}{letter}");
    } else {
        text.extend(std::iter::repeat_n(letter, count));
    }
}

/// Moves a color by up to half a step of [`BITS`], by its place: ordered dithering (Bayer, 1973), which does not swim
/// when a picture is drawn again.
fn dithered(color: [u8; 3], x: usize, y: usize) -> [u8; 3] {
    const BAYER: [[i16; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    let step = 256i16 >> BITS;
    let row = BAYER.get(y % 4);
    let moved = (row
        .and_then(|row| row.get(x % 4))
        .map_or(0, |threshold| threshold * 2 - 15))
        * step
        / 32;
    color.map(|c| (i16::from(c) + moved).clamp(0, 255) as u8)
}

/// The colors of a picture, chosen by median cut (Heckbert, 1982).
struct Palette {
    colors: Vec<[u8; 3]>,
    /// The color for each of the colors told apart.
    of_key: Vec<u8>,
}

fn add(sum: &mut [u64; 3], color: [u64; 3]) {
    for (sum, channel) in sum.iter_mut().zip(color) {
        *sum += channel;
    }
}

/// Colors told apart, with how many pixels have them.
type Counted = (u16, u32);

impl Palette {
    fn of(pixels: &Pixels) -> Self {
        let mut counts = vec![0u32; 1 << (3 * BITS)];
        // The colors themselves, added up: what is told apart is coarser.
        let mut sums = vec![[0u64; 3]; 1 << (3 * BITS)];
        for (i, color) in (0..).zip(&pixels.rgb) {
            let width = pixels.width.max(1) as usize;
            let key = usize::from(key(dithered(*color, i % width, i / width)));
            if let (Some(count), Some(sum)) = (counts.get_mut(key), sums.get_mut(key)) {
                *count += 1;
                add(sum, color.map(u64::from));
            }
        }
        let used = (0..).zip(counts).filter(|(_, count)| *count > 0);
        let mut boxes: Vec<Vec<Counted>> = vec![used.collect()];
        while boxes.len() < MOST {
            // The box that has most to gain: many pixels over a long edge.
            let gain = |colors: &Vec<Counted>| {
                let weight: u64 = colors.iter().map(|(_, count)| u64::from(*count)).sum();
                u64::from(longest(colors).1) * weight
            };
            let found = (0..boxes.len()).max_by_key(|i| boxes.get(*i).map_or(0, gain));
            let Some(worst) = found
                .and_then(|i| boxes.get_mut(i))
                .filter(|colors| gain(colors) > 0)
            else {
                break;
            };
            let upper = halve(worst);
            boxes.push(upper);
        }
        let mut of_key = vec![0; 1 << (3 * BITS)];
        let mut colors = Vec::new();
        for (index, members) in (0..=u8::MAX).zip(&boxes) {
            let (mut total, mut weight) = ([0u64; 3], 0);
            for (key, count) in members {
                let sum = sums.get(usize::from(*key)).copied().unwrap_or_default();
                add(&mut total, sum);
                weight += u64::from(*count);
                if let Some(place) = of_key.get_mut(usize::from(*key)) {
                    *place = index;
                }
            }
            colors.push(total.map(|sum| (sum / weight.max(1)) as u8));
        }
        Self { colors, of_key }
    }

    fn index(&self, color: [u8; 3]) -> u8 {
        self.of_key.get(usize::from(key(color))).copied().unwrap_or(0)
    }
}

/// The upper bits of a color.
fn key(color: [u8; 3]) -> u16 {
    color
        .iter()
        .fold(0, |key, c| key << BITS | u16::from(*c) >> (8 - BITS))
}

fn channel(key: u16, i: usize) -> u16 {
    key >> (BITS * (2 - i as u32)) & ((1 << BITS) - 1)
}

/// The channel in which colors differ most, and by how much.
fn longest(colors: &[Counted]) -> (usize, u16) {
    let extent = |i: usize| {
        let channels = || colors.iter().map(|(key, _)| channel(*key, i));
        channels().max().unwrap_or(0) - channels().min().unwrap_or(0)
    };
    let extents = [0, 1, 2].map(|i| (i, extent(i)));
    extents
        .into_iter()
        .max_by_key(|(_, extent)| *extent)
        .unwrap_or((0, 0))
}

/// Takes the upper half of the pixels out, along the longest edge; both halves keep a color at least.
fn halve(colors: &mut Vec<Counted>) -> Vec<Counted> {
    let (axis, _) = longest(colors);
    colors.sort_unstable_by_key(|(key, _)| (channel(*key, axis), *key));
    let half: u64 = colors.iter().map(|(_, count)| u64::from(*count)).sum::<u64>() / 2;
    let mut before = 0;
    let middle = colors.iter().position(|(_, count)| {
        before += u64::from(*count);
        before > half
    });
    let middle = middle
        .unwrap_or(1)
        .clamp(1, colors.len().saturating_sub(1).max(1));
    colors.split_off(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a terminal makes of it, and how many colors it was given.
    fn decode(text: &str) -> (Vec<Vec<Option<[u8; 3]>>>, usize) {
        let body = text
            .strip_prefix("\x1bP0;1;0q\"")
            .unwrap()
            .strip_suffix("\x1b\\")
            .unwrap();
        let (mut colors, mut rows) = (vec![None; MOST], Vec::<Vec<Option<[u8; 3]>>>::new());
        let (mut x, mut top, mut current, mut repeat) = (0, 0, 0, 1);
        let mut rest = body;
        let mut first = true;
        while let Some(c) = rest.chars().next() {
            let numbers_end = |text: &str| {
                text.find(|c: char| !c.is_ascii_digit() && c != ';')
                    .unwrap_or(text.len())
            };
            let skip = usize::from(!first || !c.is_ascii_digit());
            let (numbers, after) = rest[skip..].split_at(numbers_end(&rest[skip..]));
            let numbers: Vec<usize> = numbers.split(';').filter_map(|n| n.parse().ok()).collect();
            match c {
                _ if first => {
                    assert_eq!(numbers[..2], [1, 1]);
                    rows = vec![vec![None; numbers[2]]; numbers[3]];
                    (first, rest) = (false, after);
                }
                '#' => {
                    current = numbers[0];
                    if let [_, 2, r, g, b] = numbers[..] {
                        colors[current] = Some([r, g, b].map(|c| (c * 255 / 100) as u8));
                    }
                    rest = after;
                }
                '!' => (repeat, rest) = (numbers[0], after),
                '$' => (x, rest) = (0, &rest[1..]),
                '-' => (x, top, rest) = (0, top + 6, &rest[1..]),
                '?'..='~' => {
                    for _ in 0..repeat {
                        for row in (0..6).filter(|row| (c as u8 - b'?') >> row & 1 == 1) {
                            assert_eq!(rows[top + row][x], None, "set twice");
                            rows[top + row][x] = colors[current];
                        }
                        x += 1;
                    }
                    (repeat, rest) = (1, &rest[1..]);
                }
                c => panic!("{c:?}"),
            }
        }
        (rows, colors.iter().flatten().count())
    }

    fn check(width: u32, height: u32, apart: i32, color: impl Fn(u32, u32) -> [u8; 3]) -> usize {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rgb: Vec<[u8; 3]> = places.map(|(x, y)| color(x, y)).collect();
        let (rows, colors) = decode(&encode(&Pixels {
            width,
            height,
            rgb: rgb.clone(),
        }));
        let shown: Vec<[u8; 3]> = rows.into_iter().flatten().map(Option::unwrap).collect();
        assert_eq!(shown.len(), rgb.len());
        for (shown, wanted) in shown.iter().zip(&rgb) {
            let far = (0..3)
                .map(|i| (i32::from(shown[i]) - i32::from(wanted[i])).abs())
                .max();
            assert!(far <= Some(apart), "{shown:?} for {wanted:?}");
        }
        colors
    }

    #[test]
    fn few_colors_come_back() {
        let flag = |x: u32, y: u32| {
            [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]][((x / 5 + y / 4) % 4) as usize]
        };
        assert_eq!(check(23, 20, 1, flag), 4);
        assert_eq!(check(1, 1, 2, |_, _| [100, 50, 200]), 1);
        assert_eq!(check(7, 13, 0, |_, _| [0; 3]), 1);
    }

    #[test]
    fn many_colors_come_back_nearly() {
        let colors = check(120, 100, 40, |x, y| {
            [(x * 2) as u8, (y * 2) as u8, ((x + y) / 2) as u8]
        });
        assert_eq!(colors, MOST);
        check(256, 8, 10, |x, _| [x as u8; 3]);
    }
}
