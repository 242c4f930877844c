//! Files of pictures and their layers, read back.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{fs, sync::Mutex};

use rtscript::{
    Builder, DVec3, Host, Image, Limits, NoHost, RenderOptions, RunOptions, Scene, Term,
    host::HostError,
    output::{Format, encode, save},
    render::{FileOptions, LayerKind},
    source,
};

/// A red sphere of radius 1 before the default camera at distance 5, above the middle line of a square picture.
fn scene() -> Scene {
    let mut b = Builder::new();
    b.size(15, 15).unwrap();
    b.directional(DVec3::Z, DVec3::ONE).unwrap();
    b.material_mut().diffuse = Term::color(DVec3::new(0.75, 0.25, 0.125));
    b.sphere(DVec3::ZERO, 1.0).unwrap();
    b.finish().value
}

fn picture(layers: &[LayerKind]) -> Image {
    let mut options = RenderOptions::default();
    options.layers = layers.to_vec();
    rtscript::render(&scene(), &options, &NoHost).unwrap().value.image
}

fn every_layer() -> Vec<LayerKind> {
    LayerKind::NAMES.iter().map(|(_, kind)| *kind).collect()
}

#[test]
fn layers_hold_what_the_middle_of_a_pixel_meets() {
    let image = picture(&every_layer());
    assert_eq!(image.pixels(), picture(&[]).pixels(), "the picture is the same");
    let at = |kind: LayerKind, x: usize, y: usize| {
        let layer = image.layers().iter().find(|layer| layer.kind == kind).unwrap();
        let n = kind.channels().len();
        let first = (y * 15 + x) * n;
        layer.values[first..first + n].to_vec()
    };
    assert_eq!(at(LayerKind::Depth, 7, 7), [4.0]);
    assert_eq!(at(LayerKind::Depth, 0, 0), [f32::INFINITY]);
    assert_eq!(at(LayerKind::Normal, 7, 7), [0.0, 0.0, 1.0]);
    assert!(at(LayerKind::Normal, 5, 7)[0] < -0.3, "to the left");
    assert_eq!(at(LayerKind::Albedo, 7, 7), [0.75, 0.25, 0.125]);
    assert_eq!(at(LayerKind::Albedo, 0, 0), [0.0; 3]);
    assert!(at(LayerKind::Uv, 7, 5)[1] > at(LayerKind::Uv, 7, 9)[1]);
    assert_eq!(at(LayerKind::Object, 7, 7), at(LayerKind::Object, 6, 6));
    let id = at(LayerKind::Object, 7, 7)[0];
    assert!((1.0..16_777_216.0).contains(&id) && id.fract() == 0.0);
    assert_eq!(at(LayerKind::Object, 0, 0), [0.0]);
}

#[test]
fn files_of_16_bits_read_back() {
    let deep = FileOptions {
        bits: Some(16),
        quality: None,
    };
    let image = picture(&[]).with_file_options(deep);
    let png = image::load_from_memory(&encode(&image, Format::Png).unwrap()).unwrap();
    assert_eq!(png.color(), image::ColorType::Rgb16);
    assert_eq!(png.into_rgb16().into_raw(), image.rgb16());
    let ppm = encode(&image, Format::Ppm).unwrap();
    let (head, data) = ppm.split_at(b"P6\n15 15\n65535\n".len());
    assert_eq!(head, b"P6\n15 15\n65535\n");
    let numbers: Vec<u16> = data.chunks(2).map(|v| u16::from_be_bytes([v[0], v[1]])).collect();
    assert_eq!(numbers, image.rgb16());
    // The steps of 16 bits are within those of 8.
    let near = image.rgb16().into_iter().zip(image.rgb8());
    assert!(
        near.into_iter()
            .all(|(deep, flat)| deep.abs_diff(u16::from(flat) * 257) <= 129)
    );
}

#[test]
fn float_maps_hold_linear_light() {
    let image = picture(&[]);
    let pfm = encode(&image, Format::Pfm).unwrap();
    let data = &pfm[b"PF\n15 15\n-1.0\n".len()..];
    let read: Vec<f32> = data
        .chunks(4)
        .map(|v| f32::from_le_bytes(v.try_into().unwrap()))
        .collect();
    for (y, line) in read.chunks(45).enumerate() {
        let from = &image.pixels()[(14 - y) * 15..][..15];
        let wanted: Vec<f32> = from.as_flattened().iter().map(|v| *v as f32).collect();
        assert_eq!(line, wanted);
    }
}

#[test]
fn layers_lie_beside_the_picture() {
    let folder = std::env::temp_dir().join(format!("rtscript-layers-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let image = picture(&[LayerKind::Depth, LayerKind::Uv]);
    let names = |ending: &str| {
        save(&folder.join(format!("a.{ending}")), &image).unwrap();
        let mut names: Vec<String> = fs::read_dir(&folder)
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        let sizes: Vec<(u32, u32)> = names
            .iter()
            .filter(|name| name.ends_with("png"))
            .map(|name| image::image_dimensions(folder.join(name)).unwrap())
            .collect();
        assert!(sizes.iter().all(|size| *size == (15, 15)));
        for name in &names {
            fs::remove_file(folder.join(name)).unwrap();
        }
        names
    };
    assert_eq!(names("png"), ["a.depth.png", "a.png", "a.uv.png"]);
    assert_eq!(names("hdr"), ["a.depth.pfm", "a.hdr", "a.uv.pfm"]);
    assert_eq!(names("exr"), ["a.exr"]);
    let wrong = save(
        &folder.join("a.jpg"),
        &image.clone().with_file_options(FileOptions {
            bits: Some(16),
            quality: None,
        }),
    );
    assert!(wrong.unwrap_err().message.ends_with("a .jpg has 8 bits, not 16"));
    fs::remove_dir(&folder).unwrap();
}

/// Takes pictures that scripts name.
#[derive(Default)]
struct Album(Mutex<Vec<(String, Image)>>);

impl Host for Album {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        NoHost.read(path, max_bytes)
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.0.lock().unwrap().push((name.to_owned(), image.clone()));
        Ok(())
    }
}

#[test]
fn scripts_ask_for_bits_and_layers() {
    let run = |call: &str, album: &Album| {
        let text = format!("size(15, 15);\nsphere(0, 0, 0, 1);\n{call}\n");
        source::load("a.rhai", &text, album, &Limits::default(), &RunOptions::default())
            .map(drop)
            .map_err(|e| e.diagnostic.message)
    };
    let album = Album::default();
    run(
        "render(\"a.exr\", #{ bits: 16, layers: [\"depth\", \"line\", \"depth\"] });",
        &album,
    )
    .unwrap();
    let taken = album.0.into_inner().unwrap();
    let [(name, image)] = taken.as_slice() else {
        panic!("{} pictures", taken.len())
    };
    assert_eq!(name, "a.exr");
    assert_eq!(image.file_options().bits, Some(16));
    let kinds: Vec<LayerKind> = image.layers().iter().map(|layer| layer.kind).collect();
    assert_eq!(kinds, [LayerKind::Depth, LayerKind::Line]);
    assert_eq!(image.layers()[1].values[7 * 15 + 7], 2.0, "made in line 2");
    let album = Album::default();
    for (call, message) in [
        (
            "render(\"a.jpg\", #{ bits: 16 });",
            "render: a .jpg has 8 bits, not 16",
        ),
        (
            "render(\"a.png\", #{ quality: 50 });",
            "render: a .png has no quality: it loses nothing to choose from",
        ),
        (
            "render(\"a.exr\", #{ layers: [\"deep\"] });",
            "render: a layer must be \"depth\" or \"normal\" or \"albedo\" or \"uv\" or \"object\" or \"line\", not \"deep\"",
        ),
    ] {
        assert_eq!(run(call, &album).unwrap_err(), message);
    }
    assert!(album.0.into_inner().unwrap().is_empty());
}
