//! Cameras, samples and parts of pictures, seen from outside: what the pixels of one picture have to do with those of
//! another.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use rtscript::{
    Builder, DVec3, Image, NoHost, RenderOptions, Scene, Term, render,
    scene::{
        Adaptive, Camera, Crop, Filter, FilterKind, Lens, Projection, Region, Sampling, Stereo, StereoLayout,
    },
};

/// Spheres before a plane, under a light with soft shadows.
fn scene(change: impl FnOnce(&mut Builder)) -> Scene {
    scene_under(true, change)
}

fn scene_under(soft: bool, change: impl FnOnce(&mut Builder)) -> Scene {
    let mut b = Builder::new();
    b.size(33, 26).unwrap();
    b.samples(8).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, DVec3::Y, 45.0).unwrap());
    b.background(DVec3::new(0.2, 0.4, 0.6)).unwrap();
    let corner = DVec3::new(-1.0, 4.0, 1.0);
    match soft {
        true => b
            .area_light(corner, DVec3::X * 2.0, DVec3::Z * 2.0, DVec3::ONE, 1)
            .unwrap(),
        false => b.point(corner, DVec3::ONE).unwrap(),
    }
    b.material_mut().diffuse = Term::color(DVec3::new(0.8, 0.6, 0.4));
    b.sphere(DVec3::new(-0.7, 0.0, 0.0), 1.0).unwrap();
    b.sphere(DVec3::new(1.0, -0.3, -1.5), 0.7).unwrap();
    let corners = [(-9.0, 9.0), (9.0, 9.0), (0.0, -20.0)].map(|(x, z)| DVec3::new(x, -1.0, z));
    b.triangle(corners, None).unwrap();
    change(&mut b);
    b.finish().value
}

fn picture(scene: &Scene) -> Image {
    render(scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image
}

type Change = fn(&mut Builder);

/// One of each kind of camera and of samples.
const KINDS: [(&str, Change); 9] = [
    ("plain", |_| {}),
    ("fisheye", |b| {
        let projection = Projection::Fisheye {
            angle: 150.0,
            full_frame: false,
        };
        let camera = Camera::with_projection(DVec3::new(0.0, 1.0, 3.0), DVec3::ZERO, DVec3::Y, projection);
        b.camera(camera.unwrap());
    }),
    ("orthographic", |b| {
        let projection = Projection::Orthographic { height: 5.0 };
        let camera = Camera::with_projection(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, DVec3::Y, projection);
        b.camera(camera.unwrap());
    }),
    ("lens", |b| b.lens(Some(Lens::new(0.2))).unwrap()),
    ("anaglyph", |b| {
        b.stereo(Some(Stereo {
            separation: 0.2,
            layout: StereoLayout::Anaglyph,
            convergence: None,
        }))
        .unwrap();
    }),
    ("sobol", |b| b.sampling(Sampling::Sobol)),
    ("mitchell", |b| {
        b.filter(Filter::new(FilterKind::Mitchell)).unwrap()
    }),
    ("adaptive", |b| {
        b.samples(32).unwrap();
        b.adaptive(Some(Adaptive { error: 0.03, min: 4 })).unwrap();
    }),
    ("all", |b| {
        b.sampling(Sampling::Sobol);
        b.filter(Filter::new(FilterKind::Mitchell)).unwrap();
        b.samples(32).unwrap();
        b.adaptive(Some(Adaptive { error: 0.03, min: 4 })).unwrap();
        b.lens(Some(Lens::new(0.1))).unwrap();
    }),
];

#[test]
fn a_part_of_a_picture_has_its_very_pixels() {
    for (name, change) in KINDS {
        let whole = picture(&scene(change));
        for (x, y, width, height) in [(0, 0, 9, 26), (7, 5, 13, 9), (32, 25, 1, 1)] {
            let part = picture(&scene(|b| {
                change(b);
                let region = Region { x, y, width, height };
                b.crop(Some(Crop::Pixels(region))).unwrap();
            }));
            assert_eq!((part.width(), part.height()), (width, height));
            for (column, row) in (0..width).flat_map(|i| (0..height).map(move |j| (i, j))) {
                assert_eq!(
                    part.pixel(column, row),
                    whole.pixel(x + column, y + row),
                    "{name} {column} {row}"
                );
            }
        }
    }
}

#[test]
fn neither_tiles_nor_threads_nor_packets_change_a_picture() {
    for (name, change) in KINDS {
        let scene = scene(change);
        let picture = picture(&scene);
        for (threads, tile, shuffle, single_rays) in [(1, 3, None, true), (3, 5, Some(7), false)] {
            let mut options = RenderOptions::default();
            (options.threads, options.tile) = (threads, tile);
            (options.shuffle, options.single_rays) = (shuffle, single_rays);
            let other = render(&scene, &options, &NoHost).unwrap().value.image;
            assert_eq!(other, picture, "{name}");
        }
    }
}

#[test]
fn an_explanation_adds_up_to_the_pixel() {
    for (name, change) in KINDS {
        let scene = scene(change);
        let picture = picture(&scene);
        let world = rtscript::render::World::compile(&scene).unwrap();
        for (x, y) in [(0, 0), (10, 12), (16, 13), (22, 16), (32, 25)] {
            let explained = world.explain(x, y, &NoHost).unwrap();
            assert_eq!(Some(explained.value), picture.pixel(x, y), "{name} {x} {y}");
        }
    }
}

#[test]
fn without_an_error_allowed_all_samples_are_taken() {
    for sampling in [Sampling::Stratified, Sampling::Sobol] {
        let fixed = scene(|b| b.sampling(sampling));
        let adaptive = scene(|b| {
            b.sampling(sampling);
            b.adaptive(Some(Adaptive { error: 0.0, min: 3 })).unwrap();
        });
        let [fixed, adaptive] =
            [fixed, adaptive].map(|scene| render(&scene, &RenderOptions::default(), &NoHost).unwrap().value);
        assert_eq!(fixed.stats.camera_rays, adaptive.stats.camera_rays);
        let pairs = fixed.image.pixels().iter().zip(adaptive.image.pixels());
        for (a, b) in pairs {
            // Strata are summed in another order.
            let apart = (DVec3::from_array(*a) - DVec3::from_array(*b)).abs();
            assert!(apart.max_element() < 1e-14, "{a:?} {b:?}");
        }
        if sampling == Sampling::Sobol {
            assert_eq!(fixed.image, adaptive.image);
        }
    }
}

#[test]
fn samples_go_where_the_error_is() {
    let many = |error| {
        scene(|b| {
            b.samples(256).unwrap();
            b.sampling(Sampling::Sobol);
            b.adaptive(Some(Adaptive { error, min: 8 })).unwrap();
        })
    };
    let reference = picture(&scene(|b| {
        b.samples(1024).unwrap();
        b.sampling(Sampling::Sobol);
    }));
    let mut before = 0;
    for error in [0.1, 0.03, 0.01] {
        let rendered = render(&many(error), &RenderOptions::default(), &NoHost)
            .unwrap()
            .value;
        let rays = rendered.stats.camera_rays;
        assert!(rays > before && rays < 33 * 26 * 200, "{rays}");
        before = rays;
        // As a screen shows it; an error is a standard error, so some pixels are farther off than that.
        let shown =
            |image: &Image, i: usize| DVec3::from_array(image.pixels()[i].map(|v| v.clamp(0.0, 1.0).sqrt()));
        let far = (0..33 * 26).filter(|i| {
            (shown(&rendered.image, *i) - shown(&reference, *i))
                .abs()
                .max_element()
                > 3.0 * error
        });
        assert!(far.count() < 9, "{error}");
    }
}

#[test]
fn an_anaglyph_is_two_pictures_in_one() {
    let layout = |layout, width| {
        // Random numbers are those of a pixel, and the right eye's half has other pixels.
        picture(&scene_under(false, |b| {
            b.size(width, 26).unwrap();
            b.stereo(Some(Stereo {
                separation: 0.3,
                layout,
                convergence: Some(5.0),
            }))
            .unwrap();
            b.samples(1).unwrap();
        }))
    };
    let both = layout(StereoLayout::SideBySide, 64);
    let one = layout(StereoLayout::Anaglyph, 32);
    let mut differ = 0;
    for (x, y) in (0..32).flat_map(|x| (0..26).map(move |y| (x, y))) {
        let (left, right) = (both.pixel(x, y).unwrap(), both.pixel(x + 32, y).unwrap());
        let mixed = one.pixel(x, y).unwrap();
        assert_eq!(mixed, DVec3::new(left.x, right.y, right.z));
        differ += u32::from(left != right);
    }
    assert!(differ > 100, "{differ}");
}

#[test]
fn scenes_that_look_different_have_different_hashes() {
    let mut hashes: Vec<String> = KINDS.iter().map(|(_, change)| scene(change).hash()).collect();
    hashes.push(
        scene(|b| {
            b.crop(Some(Crop::Fractions {
                left: 0.0,
                top: 0.0,
                right: 0.5,
                bottom: 1.0,
            }))
            .unwrap();
        })
        .hash(),
    );
    let count = hashes.len();
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), count);
}
