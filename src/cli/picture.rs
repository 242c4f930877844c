//! A picture in the terminal.

use std::{
    env,
    fmt::Write as _,
    io::{self, IsTerminal},
};

use super::{args::TerminalPictures, sixel};
use crate::{
    output::{self, Format},
    render::Image,
};

/// Columns that a picture of half blocks takes where the terminal does not tell its width.
const COLUMNS: u32 = 80;
/// Bytes of base64 in one escape sequence; the protocol allows 4096.
const CHUNK: usize = 4096;

/// Colors that a terminal has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colors {
    /// Red, green and blue of 8 bits each.
    True,
    /// The 256 of xterm: a cube of 216 and 24 grays beside the first 16.
    Xterm256,
}

/// What makes the terminal show the picture, ending with a line end; `None` where it shall or can show none.
pub(super) fn for_terminal(image: &Image, how: TerminalPictures) -> Option<String> {
    let how = match how {
        TerminalPictures::Auto if !io::stdout().is_terminal() => TerminalPictures::None,
        TerminalPictures::Auto => ability(),
        chosen => chosen,
    };
    match how {
        TerminalPictures::Kitty => kitty(image, "").map(|text| text + "\n"),
        TerminalPictures::Sixel => Some(sixel::encode(&Pixels::of(image)) + "\n"),
        TerminalPictures::Blocks => {
            let across = image.width().min(columns());
            let down = u64::from(image.height()) * u64::from(across);
            let down = down.div_ceil(u64::from(image.width())).max(1) as u32;
            Some(half_blocks(&Pixels::of(image).resized(across, down), colors()))
        }
        TerminalPictures::Auto | TerminalPictures::None => None,
    }
}

/// What the environment says of the terminal. Asking the terminal itself could leave its answer in the input, unless
/// somebody reads that.
pub(super) fn ability() -> TerminalPictures {
    if says("TERM", &["kitty", "ghostty"]) || says("TERM_PROGRAM", &["WezTerm", "ghostty"]) {
        TerminalPictures::Kitty
    } else if says("TERM", &["dumb"]) || env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty()) {
        TerminalPictures::None
    } else {
        TerminalPictures::Blocks
    }
}

/// What the environment says of the terminal's colors. Terminals that have all of them say so in `COLORTERM`, or know
/// what to do with more than they have, as tmux does.
pub(super) fn colors() -> Colors {
    let lacks = says("TERM", &["256color"])
        && !says("COLORTERM", &["truecolor", "24bit"])
        && env::var_os("TMUX").is_none();
    if lacks { Colors::Xterm256 } else { Colors::True }
}

fn says(name: &str, values: &[&str]) -> bool {
    env::var(name).is_ok_and(|value| values.iter().any(|v| value.contains(v)))
}

fn columns() -> u32 {
    let told = env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    told.unwrap_or(COLUMNS).clamp(8, 400)
}

/// Colors of 8 bits, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgb: Vec<[u8; 3]>,
}

impl Pixels {
    pub(super) fn of(image: &Image) -> Self {
        Self {
            width: image.width(),
            height: image.height(),
            rgb: image.rgb8().as_chunks::<3>().0.to_vec(),
        }
    }

    /// The color at a place; black outside.
    pub(super) fn at(&self, x: u32, y: u32) -> [u8; 3] {
        let index = y as usize * self.width as usize + x as usize;
        self.rgb.get(index).copied().unwrap_or_default()
    }

    /// The same picture in another size: smaller by taking means, larger by repeating.
    pub(super) fn resized(&self, width: u32, height: u32) -> Self {
        let span = |i: u32, cells: u32, pixels: u32| {
            let at = |i: u32| (u64::from(i) * u64::from(pixels) / u64::from(cells.max(1))) as u32;
            at(i)..at(i + 1).max(at(i) + 1)
        };
        let mut rgb = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height {
            for column in 0..width {
                let (mut sums, mut count) = ([0u32; 3], 0);
                for y in span(row, height, self.height) {
                    for x in span(column, width, self.width) {
                        let color = self.at(x, y);
                        for (sum, channel) in sums.iter_mut().zip(color) {
                            *sum += u32::from(channel);
                        }
                        count += 1;
                    }
                }
                rgb.push(sums.map(|sum| (sum / count.max(1)) as u8));
            }
        }
        Self { width, height, rgb }
    }
}

/// Kitty's graphics protocol: the PNG in base64, in chunks. `placing` is what the first of them says besides, each key
/// ending with a comma.
pub(super) fn kitty(image: &Image, placing: &str) -> Option<String> {
    let png = output::encode(image, Format::Png).ok()?;
    let encoded = base64(&png);
    let mut text = String::new();
    let mut rest = encoded.as_str();
    let first = format!("a=T,f=100,{placing}");
    let mut control = first.as_str();
    while !rest.is_empty() {
        let (chunk, after) = rest.split_at(rest.len().min(CHUNK));
        // Writing into a String does not fail.
        let _ = write!(
            text,
            "\x1b_G{control}m={};{chunk}\x1b\\",
            u8::from(!after.is_empty())
        );
        (rest, control) = (after, "");
    }
    Some(text)
}

/// Two pixels in each character: an upper half block in the color of the one on the color of the other. Ends with a
/// line end.
pub(super) fn half_blocks(pixels: &Pixels, colors: Colors) -> String {
    let mut text = String::new();
    for row in (0..pixels.height).step_by(2) {
        let mut last = (None, None);
        for column in 0..pixels.width {
            let upper = Some(pixels.at(column, row));
            if upper != last.0 {
                paint(&mut text, 38, upper, colors);
            }
            let lower = (row + 1 < pixels.height).then(|| pixels.at(column, row + 1));
            if lower != last.1 {
                paint(&mut text, 48, lower, colors);
            }
            last = (upper, lower);
            text.push('▀');
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Chooses the color of what is written (38) or of what is behind it (48).
fn paint(text: &mut String, ground: u8, color: Option<[u8; 3]>, colors: Colors) {
    let Some([r, g, b]) = color else { return };
    // Writing into a String does not fail.
    let _ = match colors {
        Colors::True => write!(text, "\x1b[{ground};2;{r};{g};{b}m"),
        Colors::Xterm256 => write!(text, "\x1b[{ground};5;{}m", xterm256([r, g, b])),
    };
}

/// The nearest of xterm's colors, of the cube and the grays.
fn xterm256(color: [u8; 3]) -> u8 {
    const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];
    let nearest = |c: u8| {
        let levels = (0u8..).zip(LEVELS);
        levels
            .min_by_key(|(_, level)| level.abs_diff(c))
            .unwrap_or_default()
    };
    let cube = color.map(nearest);
    let mean = color.iter().map(|c| u32::from(*c)).sum::<u32>() / 3;
    let gray = (mean.saturating_sub(3) / 10).min(23) as u8;
    let distance = |other: [u8; 3]| -> u32 {
        color
            .iter()
            .zip(other)
            .map(|(a, b)| u32::from(a.abs_diff(b)).pow(2))
            .sum()
    };
    if distance([8 + 10 * gray; 3]) < distance(cube.map(|(_, level)| level)) {
        return 232 + gray;
    }
    let [red, green, blue] = cube.map(|(index, _)| index);
    16 + 36 * red + 6 * green + blue
}

/// Base64 with padding (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| chunk.get(i).copied().map_or(0, u32::from);
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = (bits >> (18 - 6 * i) & 63) as u8;
            text.push(if i <= chunk.len() {
                base64_digit(digit)
            } else {
                '='
            });
        }
    }
    text
}

/// The digit of a value up to 63.
fn base64_digit(value: u8) -> char {
    char::from(match value {
        0..=25 => b'A' + value,
        26..=51 => b'a' + (value - 26),
        52..=61 => b'0' + (value - 52),
        62 => b'+',
        _ => b'/',
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::from_rgb8;

    #[test]
    fn base64_of_the_standard() {
        let examples = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(
            examples,
            ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]
        );
    }

    #[test]
    fn half_blocks_hold_two_rows_each() {
        let bytes: Vec<u8> = (0..4 * 3 * 3).collect();
        let pixels = Pixels::of(&from_rgb8(4, 3, &bytes));
        let text = half_blocks(&pixels, Colors::True);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(
            lines[0].starts_with("\x1b[38;2;0;1;2m\x1b[48;2;12;13;14m▀"),
            "{:?}",
            lines[0]
        );
        assert!(lines[1].starts_with("\x1b[38;2;24;25;26m▀"), "{:?}", lines[1]);
        let narrow = half_blocks(&pixels.resized(2, 2), Colors::True);
        assert_eq!(narrow.matches('▀').count(), 2);
        assert!(narrow.starts_with("\x1b[38;2;1;2;3m"), "{narrow:?}");
    }

    #[test]
    fn a_picture_grows_by_repeating_and_colors_are_said_once() {
        let pixels = Pixels::of(&from_rgb8(2, 1, &[9, 9, 9, 200, 0, 0]));
        let large = pixels.resized(4, 4);
        assert_eq!(large.rgb[4..8], [[9; 3], [9; 3], [200, 0, 0], [200, 0, 0]]);
        let line = "\x1b[38;2;9;9;9m\x1b[48;2;9;9;9m▀▀\x1b[38;2;200;0;0m\x1b[48;2;200;0;0m▀▀\x1b[0m\n";
        assert_eq!(half_blocks(&large, Colors::True), line.repeat(2));
    }

    #[test]
    fn the_nearest_of_256_colors() {
        let nearest = [
            [0, 0, 0],
            [255, 255, 255],
            [255, 0, 0],
            [95, 135, 175],
            [128, 128, 128],
            [9, 8, 7],
        ];
        assert_eq!(nearest.map(xterm256), [16, 231, 196, 67, 244, 232]);
        let pixels = Pixels::of(&from_rgb8(1, 1, &[255, 0, 0]));
        assert_eq!(half_blocks(&pixels, Colors::Xterm256), "\x1b[38;5;196m▀\x1b[0m\n");
    }

    #[test]
    fn kitty_gets_its_png_in_chunks() {
        let noise: Vec<u8> = (0..60_000u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
            .collect();
        let text = kitty(&from_rgb8(200, 100, &noise), "c=9,").unwrap();
        assert!(text.starts_with("\x1b_Ga=T,f=100,c=9,m=1;iVBORw0KGgo"));
        assert!(text.ends_with("\x1b\\"));
        assert_eq!(text.matches("m=0;").count(), 1);
    }
}
