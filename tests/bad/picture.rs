//! Broken pictures, made by a few words: a whole file, then what is done to it, separated by commas.
//!
//! | words | meaning |
//! |---|---|
//! | `png`, `gray`, `palette`, `deep`, `jpeg` | a good picture of 8 x 8 pixels |
//! | `text WORD`, `bytes HEX` | these bytes |
//! | `keep N`, `cut N` | the first N bytes; all but the last N |
//! | `set AT HEX` | other bytes from there on |
//! | `insert AT HEX` | bytes put in there |
//! | `header W H DEPTH COLOR COMPRESSION FILTER INTERLACE` | another IHDR with the right checksum |
//! | `drop CHUNK`, `twice CHUNK`, `last CHUNK` | a chunk left out, given twice, put after all others |
//! | `chunk CHUNK HEX` | other contents of a chunk with the right checksum |
//! | `add CHUNK HEX` | a chunk after the header |
//! | `marker HEX HEX` | every JPEG marker ff HEX made another |

use std::io::Cursor;

use image::{ExtendedColorType, ImageEncoder, RgbImage, codecs::png::PngEncoder};

/// The bytes that the words describe.
pub(crate) fn made(words: &str) -> Vec<u8> {
    let mut steps = words.trim().split(',').map(str::trim);
    let mut bytes = first(steps.next().unwrap());
    for step in steps {
        let words: Vec<&str> = step.split_whitespace().collect();
        let number = |i: usize| words[i].parse::<usize>().unwrap();
        match words[0] {
            "keep" => bytes.truncate(number(1)),
            "cut" => bytes.truncate(bytes.len() - number(1)),
            "set" => {
                let new = hex(words[2]);
                bytes[number(1)..number(1) + new.len()].copy_from_slice(&new);
            }
            "insert" => {
                bytes.splice(number(1)..number(1), hex(words[2]));
            }
            "marker" => {
                let (old, new) = (hex(words[1])[0], hex(words[2])[0]);
                for i in 1..bytes.len() {
                    if bytes[i - 1] == 0xff && bytes[i] == old {
                        bytes[i] = new;
                    }
                }
            }
            _ => bytes = with_chunks(&bytes, &words),
        }
    }
    bytes
}

fn first(words: &str) -> Vec<u8> {
    let (kind, rest) = words.split_once(' ').unwrap_or((words, ""));
    let encoded = |bytes: &[u8], kind: ExtendedColorType| {
        let mut out = Vec::new();
        PngEncoder::new(&mut out).write_image(bytes, 8, 8, kind).unwrap();
        out
    };
    let ramp: Vec<u8> = (0..=255)
        .cycle()
        .take(8 * 8 * 6)
        .map(|b: u8| b.wrapping_mul(37))
        .collect();
    match kind {
        "png" => encoded(&ramp[..192], ExtendedColorType::Rgb8),
        "gray" => encoded(&ramp[..64], ExtendedColorType::L8),
        "deep" => encoded(&ramp, ExtendedColorType::Rgb16),
        "palette" => {
            let gray = encoded(&[0; 64], ExtendedColorType::L8);
            let indexed = with_chunks(&gray, &["header", "8", "8", "8", "3", "0", "0", "0"]);
            with_chunks(&indexed, &["add", "PLTE", "ff000000ff00"])
        }
        "jpeg" => {
            let image = RgbImage::from_fn(8, 8, |x, y| image::Rgb([(x * 30) as u8, (y * 30) as u8, 128]));
            let mut bytes = Cursor::new(Vec::new());
            image.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
            bytes.into_inner()
        }
        "text" => rest.as_bytes().to_vec(),
        "bytes" => hex(rest),
        "" => Vec::new(),
        _ => panic!("what is {kind:?}?"),
    }
}

type Chunk = ([u8; 4], Vec<u8>);

fn with_chunks(png: &[u8], words: &[&str]) -> Vec<u8> {
    let mut chunks: Vec<Chunk> = Vec::new();
    let mut rest = &png[8..];
    while rest.len() >= 12 {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        chunks.push((rest[4..8].try_into().unwrap(), rest[8..8 + length].to_vec()));
        rest = &rest[12 + length..];
    }
    let name = |word: &str| -> [u8; 4] { word.as_bytes().try_into().unwrap() };
    match words[0] {
        "header" => {
            let number = |i: usize| words[i].parse::<u32>().unwrap();
            let mut header = [number(1), number(2)].map(u32::to_be_bytes).concat();
            header.extend((3..8).map(|i| number(i) as u8));
            chunks[0].1 = header;
        }
        "drop" => chunks.retain(|(kind, _)| *kind != name(words[1])),
        "twice" => {
            let i = chunks
                .iter()
                .position(|(kind, _)| *kind == name(words[1]))
                .unwrap();
            chunks.insert(i, chunks[i].clone());
        }
        "last" => {
            let i = chunks
                .iter()
                .position(|(kind, _)| *kind == name(words[1]))
                .unwrap();
            let chunk = chunks.remove(i);
            chunks.push(chunk);
        }
        "chunk" => {
            let i = chunks
                .iter()
                .position(|(kind, _)| *kind == name(words[1]))
                .unwrap();
            chunks[i].1 = hex(words.get(2).copied().unwrap_or(""));
        }
        "add" => chunks.insert(1, (name(words[1]), hex(words.get(2).copied().unwrap_or("")))),
        step => panic!("what is {step:?}?"),
    }
    let mut bytes = png[..8].to_vec();
    for (kind, content) in chunks {
        let named = [&kind[..], &content].concat();
        bytes.extend((content.len() as u32).to_be_bytes());
        bytes.extend(&named);
        bytes.extend(crc32(&named).to_be_bytes());
    }
    bytes
}

fn hex(digits: &str) -> Vec<u8> {
    let digit = |c: u8| char::from(c).to_digit(16).unwrap() as u8;
    let pairs = digits.as_bytes().chunks(2);
    pairs.map(|pair| digit(pair[0]) << 4 | digit(pair[1])).collect()
}

/// The checksum of a PNG chunk (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(c & 1))
        })
    })
}
