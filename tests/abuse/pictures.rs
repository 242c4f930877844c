//! Pictures that mean harm, each made here and read by a script.

use std::fs;

use crate::{empty_folder, settle_files};

/// Bytes whose bits are filled from the lowest on, as deflate has them.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    used: u32,
}

impl Bits {
    fn put(&mut self, value: u32, count: u32) {
        for i in 0..count {
            if self.used == 0 {
                self.bytes.push(0);
            }
            *self.bytes.last_mut().unwrap() |= ((value >> i & 1) as u8) << self.used;
            self.used = (self.used + 1) % 8;
        }
    }
}

/// A zlib stream (RFC 1950, 1951) of so many zeros, and up to 257 more, at two bits for 258 of them.
fn zeros(count: usize) -> Vec<u8> {
    let mut bits = Bits::default();
    // One block, the last, with a code of its own for 286 literals and lengths and for 1 distance.
    bits.put(0b101, 3);
    bits.put(29, 5);
    bits.put(0, 5);
    // The code of the code: 18 has one bit, 1 and 2 have two. Read from the first bit: 0, 10 and 11.
    bits.put(14, 4);
    for length in [0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2] {
        bits.put(length, 3);
    }
    let (one, two) = (0b01, 0b11);
    let none = |bits: &mut Bits, run: u32| {
        bits.put(0, 1);
        bits.put(run - 11, 7);
    };
    // The literal 0 and the end have two bits, the length 258 has one, and so has the distance.
    bits.put(two, 2);
    none(&mut bits, 138);
    none(&mut bits, 117);
    bits.put(two, 2);
    none(&mut bits, 28);
    bits.put(one, 2);
    bits.put(one, 2);
    // Literal 0, then copies of it.
    bits.put(0b01, 2);
    let copies = count.saturating_sub(1).div_ceil(258);
    (0..copies).for_each(|_| bits.put(0, 2));
    bits.put(0b11, 2);
    let length = 1 + copies * 258;
    let sum = ((length % 65_521) as u32) << 16 | 1;
    [&[0x78, 0xda][..], &bits.bytes, &sum.to_be_bytes()].concat()
}

fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let named = [kind, content].concat();
    // ISO 3309, on the content of chunks: half a megabyte at most.
    let crc = !named.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(c & 1))
        })
    });
    let length = (content.len() as u32).to_be_bytes();
    [&length[..], &named, &crc.to_be_bytes()].concat()
}

/// The kinds of a PNG header: its last bytes but the compression and the filter.
const RGB: [u8; 3] = [8, 2, 0];
const RGB_INTERLACED: [u8; 3] = [8, 2, 1];
const RGB_16: [u8; 3] = [16, 2, 0];
const PALETTE: [u8; 3] = [8, 3, 0];

/// A PNG picture with chunks before its data, which is of so many zeros.
fn png(width: u32, height: u32, [depth, color, interlace]: [u8; 3], before: &[u8], data: usize) -> Vec<u8> {
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    let header = [&size[..], &[depth, color, 0, 0, interlace]].concat();
    [
        b"\x89PNG\r\n\x1a\n",
        &chunk(b"IHDR", &header)[..],
        before,
        &chunk(b"IDAT", &zeros(data)),
        &chunk(b"IEND", b""),
    ]
    .concat()
}

/// A JPEG picture of that size in so many components, of which 8 x 8 pixels are there.
fn jpeg(width: u16, height: u16, components: u8) -> Vec<u8> {
    let segment = |kind: u8, content: &[u8]| {
        let length = (content.len() as u16 + 2).to_be_bytes();
        [&[0xff, kind], &length[..], content].concat()
    };
    let (width, height) = (width.to_be_bytes(), height.to_be_bytes());
    let mut frame = [&[8], &height[..], &width, &[components]].concat();
    let mut scan = vec![components];
    for id in 1..=components {
        frame.extend([id, 0x11, 0]);
        scan.extend([id, 0]);
    }
    scan.extend([0, 63, 0]);
    // Codes of one value, 0, with one bit: no difference, and the end of the block.
    let code = |class: u8| [&[class, 1], &[0; 15][..], &[0]].concat();
    [
        &[0xff, 0xd8][..],
        &segment(0xdb, &[&[0][..], &[1; 64]].concat()),
        &segment(0xc0, &frame),
        &segment(0xc4, &code(0x00)),
        &segment(0xc4, &code(0x10)),
        &segment(0xda, &scan),
        &[0, 0xff, 0xd9],
    ]
    .concat()
}

/// The bytes of an 8 x 8 picture of RGB, filters of rows included.
const ROWS: usize = 8 * 25;

fn made() -> Vec<(&'static str, Vec<u8>)> {
    let good = png(8, 8, RGB, &[], ROWS);
    let noise: Vec<u8> = (0..5_000u32)
        .map(|i| (i.wrapping_mul(2_654_435_769) >> 24) as u8)
        .collect();
    let palette = |length: usize| png(8, 8, PALETTE, &chunk(b"PLTE", &vec![9; length]), 8 * 9);
    let compressed = |kind: &[u8; 4], name: &[u8]| {
        let content = [name, &zeros(512 << 20)].concat();
        png(8, 8, RGB, &chunk(kind, &content), ROWS)
    };
    let photo = jpeg(8, 8, 3);
    let padded = |start: &[u8]| [start, &[0; 100]].concat();
    vec![
        ("png-60000", png(60_000, 60_000, RGB, &[], ROWS)),
        ("png-2-to-31", png(1 << 31, 1 << 31, RGB, &[], ROWS)),
        (
            "png-2-to-31-less-1",
            png((1 << 31) - 1, (1 << 31) - 1, RGB_16, &[], ROWS),
        ),
        ("png-strip", png((1 << 31) - 1, 1, RGB, &[], ROWS)),
        ("png-0", png(0, 8, RGB, &[], ROWS)),
        ("png-11000", png(11_000, 11_000, RGB, &[], 11_000 * 33_001)),
        (
            "png-11000-deep",
            png(11_000, 11_000, RGB_16, &[], 11_000 * 66_001),
        ),
        ("png-11000-of-nothing", png(11_000, 11_000, RGB, &[], ROWS)),
        ("png-2048", png(2_048, 2_048, RGB, &[], 2_048 * (3 * 2_048 + 1))),
        ("png-data-512-mb", png(8, 8, RGB, &[], 512 << 20)),
        ("png-profile-512-mb", compressed(b"iCCP", b"p\0\0")),
        ("png-text-512-mb", compressed(b"zTXt", b"t\0\0")),
        ("png-text-itxt-512-mb", compressed(b"iTXt", b"t\0\x01\0\0\0")),
        ("png-palette-of-4-bytes", palette(4)),
        ("png-palette-of-767-bytes", palette(767)),
        ("png-palette-of-768-bytes", palette(768)),
        ("png-palette-too-short", palette(3)),
        ("png-palette-missing", png(8, 8, PALETTE, &[], 8 * 9)),
        (
            "png-palette-of-rgb-of-4",
            png(8, 8, RGB, &chunk(b"PLTE", &[9; 4]), ROWS),
        ),
        ("png-transparent-256", {
            let chunks = [chunk(b"PLTE", &[9; 3]), chunk(b"tRNS", &[9; 256])].concat();
            png(8, 8, PALETTE, &chunks, 8 * 9)
        }),
        ("png-16-bit", png(8, 8, RGB_16, &[], 8 * 49)),
        ("png-interlaced", png(8, 8, RGB_INTERLACED, &[], 207)),
        (
            "png-interlaced-60000",
            png(60_000, 60_000, RGB_INTERLACED, &[], 207),
        ),
        ("png-cut-in-half", good[..good.len() / 2].to_vec()),
        ("png-cut-in-its-header", good[..20].to_vec()),
        ("png-noise", [&good[..8], &noise].concat()),
        (
            "png-noise-as-data",
            [&good[..33], &chunk(b"IDAT", &noise)].concat(),
        ),
        (
            "png-chunks-100k",
            png(8, 8, RGB, &chunk(b"tEXt", b"a\0b").repeat(100_000), ROWS),
        ),
        ("nothing", Vec::new()),
        ("noise", noise.clone()),
        ("text", b"size(10, 10);".to_vec()),
        ("gif", padded(b"GIF89a\xff\xff\xff\xff")),
        ("bmp", padded(b"BM")),
        ("webp", padded(b"RIFF\x64\0\0\0WEBPVP8 ")),
        ("tiff", padded(b"II*\0\x08\0\0\0")),
        ("exr", padded(b"\x76\x2f\x31\x01")),
        ("hdr", padded(b"#?RADIANCE\n")),
        ("svg", b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>".to_vec()),
        ("jpeg-by-another-name", photo.clone()),
        ("jpeg-gray", jpeg(8, 8, 1)),
        ("jpeg-cmyk", jpeg(8, 8, 4)),
        ("jpeg-of-9-components", jpeg(8, 8, 9)),
        ("jpeg-65535", jpeg(65_535, 65_535, 3)),
        ("jpeg-10000-of-nothing", jpeg(10_000, 10_000, 3)),
        ("jpeg-0", jpeg(0, 8, 3)),
        ("jpeg-cut", photo[..photo.len() - 3].to_vec()),
        (
            "jpeg-noise",
            [&photo[..photo.len() - 3], &noise, &[0xff, 0xd9]].concat(),
        ),
    ]
}

#[test]
fn every_picture_ends_with_what_stopped_it() {
    let folder = empty_folder("pictures");
    let mut scripts = Vec::new();
    for (name, bytes) in made() {
        fs::write(folder.join(format!("{name}.png")), bytes).unwrap();
        scripts.push((
            name.to_owned(),
            format!("image(\"{name}.png\");\nsize(16, 16);\n"),
        ));
    }
    // As many of the largest as strangers may have, and one more.
    let large = fs::read(folder.join("png-2048.png")).unwrap();
    for i in 0..33 {
        fs::write(folder.join(format!("t{i}.png")), &large).unwrap();
    }
    let textures = |count: usize| {
        format!("for i in 0..{count} {{ diffuse(image(`t${{i}}.png`)); sphere(i, 0, 0, 1); }}\n")
    };
    scripts.push(("textures-32".to_owned(), textures(32)));
    scripts.push(("textures-33".to_owned(), textures(33)));
    // Two pictures as large as they may be, with all shapes, and values of the script nearly as many as it may have.
    let all = format!(
        "size(1414, 1414); maxDepth(1);\n{}let a = [];\nfor i in 0..5000 {{ a.push(`${{i}}`.sub_string(0)); }}\n\
         for i in 0..190000 {{ sphere(i % 500, i / 500, -400, 0.4); }}\nlet p = render();\nlet q = render();\n",
        textures(32)
    );
    scripts.push(("everything-at-once".to_owned(), all));
    settle_files("pictures.txt", &folder, &scripts);
}
