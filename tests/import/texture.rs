//! Pictures as textures, good ones and bad ones.

use std::sync::Arc;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rtscript::{
    Limits, MemoryHost,
    diag::ErrorKind,
    import::{AssetCache, Assets},
    scene::{ImageTexture, Texels, Texture},
};

use crate::pictures::{jpeg, png};

fn try_decode(name: &str, bytes: &[u8], limits: &Limits) -> Result<ImageTexture, (ErrorKind, String)> {
    let host = MemoryHost::new().with(name, bytes);
    let mut cache = AssetCache::default();
    let texture = Assets::new(&host, limits, &mut cache).texture(name);
    match &*texture.map_err(|error| (error.kind, error.to_string()))? {
        Texture::Image(image) => Ok(image.clone()),
        other => panic!("{other:?}"),
    }
}

fn decode(name: &str, bytes: &[u8]) -> ImageTexture {
    try_decode(name, bytes, &Limits::default()).unwrap_or_else(|(_, e)| panic!("{e}"))
}

fn texels(image: &ImageTexture) -> &[[u8; 3]] {
    match &image.texels {
        Texels::Srgb8(texels) => texels,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_bytes_say_what_a_picture_is() {
    let pixels = [
        [1, 2, 3],
        [4, 5, 6],
        [7, 8, 9],
        [250, 251, 252],
        [0, 0, 0],
        [255, 255, 255],
    ];
    let image = decode("a.jpg", &png(3, 2, &pixels));
    assert_eq!((image.width, image.height, image.name.as_str()), (3, 2, "a.jpg"));
    assert_eq!(texels(&image), pixels);
    let image = decode("a.png", &jpeg(20, 10));
    assert_eq!((image.width, image.height), (20, 10));
    let [r, g, b] = texels(&image)[5 * 20 + 10];
    assert!(
        r.abs_diff(80) < 8 && g.abs_diff(40) < 8 && b.abs_diff(128) < 8,
        "{r} {g} {b}"
    );
}

/// The decoders may use other instructions on other machines, but must give these bytes on each.
#[test]
fn the_texels_of_a_jpeg_are_the_same_everywhere() {
    let image = decode("a.jpg", include_bytes!("chroma-420.jpg"));
    let sum = |channel: usize| -> u64 {
        let weighted = (1u64..).zip(texels(&image));
        weighted
            .map(|(i, texel)| i % 1009 * u64::from(texel[channel]))
            .sum()
    };
    assert_eq!([sum(0), sum(1), sum(2)], [92_272_707, 103_306_949, 87_424_718]);
}

#[test]
fn every_kind_of_png_becomes_rgb() {
    let encode = |bytes: &[u8], kind: ExtendedColorType| {
        let mut out = Vec::new();
        PngEncoder::new(&mut out).write_image(bytes, 1, 1, kind).unwrap();
        texels(&decode("a.png", &out))[0]
    };
    assert_eq!(encode(&[77], ExtendedColorType::L8), [77; 3]);
    assert_eq!(encode(&[77, 0], ExtendedColorType::La8), [77; 3]);
    assert_eq!(encode(&[1, 2, 3, 0], ExtendedColorType::Rgba8), [1, 2, 3]);
    let wide: Vec<u8> = [0u16, 0x8080, 0xffff]
        .into_iter()
        .flat_map(u16::to_ne_bytes)
        .collect();
    assert_eq!(encode(&wide, ExtendedColorType::Rgb16), [0, 128, 255]);
}

#[test]
fn one_file_is_decoded_once() {
    let host = MemoryHost::new().with("a.png", png(1, 1, &[[1; 3]]));
    let (limits, mut cache) = (Limits::default(), AssetCache::default());
    let mut assets = Assets::new(&host, &limits, &mut cache);
    let (a, b) = (
        assets.texture("a.png").unwrap(),
        assets.texture("./a.png").unwrap(),
    );
    assert!(Arc::ptr_eq(&a, &b));
    assert_eq!(cache.files(), 1);
    assert!(cache.bytes() > 60);
}

#[test]
fn bad_pictures_say_what_is_wrong() {
    let good = png(64, 64, &[[10, 200, 30]; 64 * 64]);
    let mut flipped = good.clone();
    flipped[20] ^= 0x55;
    let mut gif = b"GIF89a".to_vec();
    gif.resize(40, 0);
    let photo = jpeg(64, 64);
    let no_picture = "is not a PNG or JPEG picture\n  help: convert the picture to PNG or JPEG";
    let cases: &[(&[u8], &str)] = &[
        (b"", "is empty; expected a PNG or JPEG picture"),
        (b"hello", no_picture),
        (&gif, no_picture),
        (&good[..8], "is a damaged PNG picture: "),
        (&good[..30], "is a damaged PNG picture: "),
        (&good[..good.len() - 30], "is a damaged PNG picture: "),
        (&flipped, "is a damaged PNG picture: "),
        (&photo[..3], "is a damaged JPEG picture: "),
        (&photo[..200], "is a damaged JPEG picture: "),
        (
            &photo[..photo.len() - 40],
            "is a damaged JPEG picture: it ends too early",
        ),
    ];
    for (bytes, wanted) in cases {
        let (kind, message) = try_decode("a.png", bytes, &Limits::default()).unwrap_err();
        assert_eq!(kind, ErrorKind::Input, "{message}");
        let start = format!("error: 'a.png' {wanted}");
        assert!(
            message.starts_with(&start),
            "{message:?} should begin with {start:?}"
        );
        assert!(message.lines().next().unwrap().len() < 200, "{message}");
    }
}

#[test]
fn pictures_stay_within_the_limits() {
    let bytes = png(100, 3, &[[1; 3]; 300]);
    let mut limits = Limits::default();
    limits.texture_side = 99;
    assert_eq!(
        try_decode("a.png", &bytes, &limits).unwrap_err(),
        (
            ErrorKind::Limit,
            "error: 'a.png' has 100 x 3 texels: the limit 'texture_side' is 99".to_owned()
        )
    );
    limits.texture_side = 100;
    assert!(try_decode("a.png", &bytes, &limits).is_ok());
    limits.decode_bytes = 500;
    let (kind, message) = try_decode("a.png", &bytes, &limits).unwrap_err();
    assert_eq!(kind, ErrorKind::Limit);
    assert!(message.ends_with("the limit 'decode_bytes' is 500"), "{message}");
    // A header that promises 60,000 x 60,000 pixels.
    let mut bomb = bytes.clone();
    bomb[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    let crc = crc32(&bomb[12..29]);
    bomb[29..33].copy_from_slice(&crc.to_be_bytes());
    let (kind, message) = try_decode("a.png", &bomb, &Limits::default()).unwrap_err();
    assert_eq!(
        (kind, message.as_str()),
        (
            ErrorKind::Limit,
            "error: 'a.png' has 60000 x 60000 texels: the limit 'texture_side' is 16384"
        )
    );
}

/// The checksum of a PNG chunk (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(c & 1))
        })
    })
}

#[test]
fn no_change_of_a_picture_is_a_fault_of_ours() {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize
    };
    for good in [png(17, 9, &[[3, 2, 1]; 153]), jpeg(33, 18)] {
        for _ in 0..300 {
            let mut bytes = good.clone();
            for _ in 0..1 + random() % 4 {
                let at = random() % bytes.len();
                bytes[at] = random() as u8;
            }
            bytes.truncate(bytes.len() - random() % 8);
            if let Err((kind, message)) = try_decode("a.png", &bytes, &Limits::untrusted()) {
                assert!(matches!(kind, ErrorKind::Input | ErrorKind::Limit), "{message}");
            }
        }
    }
}
