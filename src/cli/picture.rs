//! A picture in the terminal.

use std::{
    env,
    fmt::Write as _,
    io::{self, IsTerminal},
};

use super::args::TerminalPictures;
use crate::{
    output::{self, Format},
    render::Image,
};

/// Columns that a picture of half blocks takes where the terminal does not tell its width.
const COLUMNS: u32 = 80;
/// Bytes of base64 in one escape sequence; the protocol allows 4096.
const CHUNK: usize = 4096;

/// What makes the terminal show the picture, ending with a line end; `None` where it shall or can show none.
pub(super) fn for_terminal(image: &Image, how: TerminalPictures) -> Option<String> {
    let how = match how {
        TerminalPictures::Auto if !io::stdout().is_terminal() => TerminalPictures::None,
        TerminalPictures::Auto => ability(),
        chosen => chosen,
    };
    match how {
        TerminalPictures::Kitty => kitty(image),
        TerminalPictures::Blocks => Some(half_blocks(image, columns())),
        TerminalPictures::Auto | TerminalPictures::None => None,
    }
}

/// What the environment says of the terminal. Asking the terminal itself could leave its answer in the input.
fn ability() -> TerminalPictures {
    let says = |name: &str, values: &[&str]| {
        env::var(name).is_ok_and(|value| values.iter().any(|v| value.contains(v)))
    };
    if says("TERM", &["kitty", "ghostty"]) || says("TERM_PROGRAM", &["WezTerm", "ghostty"]) {
        TerminalPictures::Kitty
    } else if says("TERM", &["dumb"]) || env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty()) {
        TerminalPictures::None
    } else {
        TerminalPictures::Blocks
    }
}

fn columns() -> u32 {
    let told = env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    told.unwrap_or(COLUMNS).clamp(8, 400)
}

/// Kitty's graphics protocol: the PNG in base64, in chunks.
fn kitty(image: &Image) -> Option<String> {
    let png = output::encode(image, Format::Png).ok()?;
    let encoded = base64(&png);
    let mut text = String::new();
    let mut rest = encoded.as_str();
    let mut control = "a=T,f=100,";
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
    text.push('\n');
    Some(text)
}

/// Two pixels in each character: an upper half block in the color of the one on the color of the other. Larger
/// pictures are made smaller by taking means.
fn half_blocks(image: &Image, columns: u32) -> String {
    let (width, height) = (image.width(), image.height());
    let across = width.min(columns);
    let down = (u64::from(height) * u64::from(across))
        .div_ceil(u64::from(width))
        .max(1) as u32;
    let bytes = image.rgb8();
    let mean = |column: u32, row: u32| {
        let span = |i: u32, cells: u32, pixels: u32| {
            let at = |i: u32| (u64::from(i) * u64::from(pixels) / u64::from(cells)) as usize;
            at(i)..at(i + 1).max(at(i) + 1)
        };
        let (mut sums, mut count) = ([0u32; 3], 0);
        for y in span(row, down, height) {
            for x in span(column, across, width) {
                if let Some(rgb) = bytes.as_chunks::<3>().0.get(y * width as usize + x) {
                    sums = [0, 1, 2].map(|i: usize| sums[i] + u32::from(rgb[i]));
                    count += 1;
                }
            }
        }
        sums.map(|sum| sum / count.max(1))
    };
    let mut text = String::new();
    for row in (0..down).step_by(2) {
        for column in 0..across {
            let [r, g, b] = mean(column, row);
            let _ = write!(text, "\x1b[38;2;{r};{g};{b}m");
            if row + 1 < down {
                let [r, g, b] = mean(column, row + 1);
                let _ = write!(text, "\x1b[48;2;{r};{g};{b}m");
            }
            text.push('▀');
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Base64 with padding (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| chunk.get(i).copied().map_or(0, u32::from);
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= chunk.len() { digit as char } else { '=' });
        }
    }
    text
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
        let text = half_blocks(&from_rgb8(4, 3, &bytes), 80);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(
            lines[0].starts_with("\x1b[38;2;0;1;2m\x1b[48;2;12;13;14m▀"),
            "{:?}",
            lines[0]
        );
        assert!(lines[1].starts_with("\x1b[38;2;24;25;26m▀"), "{:?}", lines[1]);
        let narrow = half_blocks(&from_rgb8(4, 3, &bytes), 2);
        assert_eq!(narrow.matches('▀').count(), 2);
        assert!(narrow.starts_with("\x1b[38;2;1;2;3m"), "{narrow:?}");
    }

    #[test]
    fn kitty_gets_its_png_in_chunks() {
        let noise: Vec<u8> = (0..60_000u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
            .collect();
        let text = kitty(&from_rgb8(200, 100, &noise)).unwrap();
        assert!(text.starts_with("\x1b_Ga=T,f=100,m=1;iVBORw0KGgo"));
        assert!(text.ends_with("\x1b\\\n"));
        assert_eq!(text.matches("m=0;").count(), 1);
    }
}
