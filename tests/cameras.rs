//! Cameras, samples and parts of pictures, seen from outside: what the pixels of one picture have to do with those of
//! another.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use rtscript::{
    Builder, DVec3, Image, NoHost, RenderOptions, Scene, Term, render,
    scene::{
        Adaptive, Camera, Crop, Filter, FilterKind, Lens, Motion, Projection, Region, Sampling, Shutter,
        Stereo, StereoLayout,
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
const KINDS: [(&str, Change); 11] = [
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
    ("moving", |b| {
        b.camera_motion(Some(Motion {
            eye: DVec3::new(0.5, 1.0, 5.0),
            at: DVec3::X,
            up: DVec3::Y,
        }))
        .unwrap();
    }),
    ("moving net", |b| {
        b.sampling(Sampling::Sobol);
        b.camera_motion(Some(Motion {
            eye: DVec3::new(0.5, 1.0, 5.0),
            at: DVec3::X,
            up: DVec3::new(0.5, 1.0, 0.0),
        }))
        .unwrap();
        b.lens(Some(Lens::new(0.1))).unwrap();
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
fn a_moment_of_a_motion_is_a_camera_that_stands_still() {
    let to = Motion {
        eye: DVec3::new(2.0, 1.0, 6.0),
        at: DVec3::new(1.0, 0.5, 0.0),
        up: DVec3::new(0.5, 1.0, 0.0),
    };
    let still = picture(&scene(|b| {
        let (eye, at) = (DVec3::new(0.5, 1.0, 6.0), DVec3::new(0.25, 0.125, 0.0));
        let up = DVec3::new(0.125, 1.0, 0.0);
        b.camera(Camera::new(eye, at, up, 45.0).unwrap());
    }));
    let moment = |open, close| {
        picture(&scene(|b| {
            b.camera_motion(Some(to)).unwrap();
            b.shutter(Shutter { open, close }).unwrap();
        }))
    };
    assert_eq!(moment(0.25, 0.25), still);
    assert_ne!(moment(0.25, 0.5), still);
}

#[test]
fn a_motion_spreads_a_point_evenly_over_its_way() {
    // A thin upright bar that glows, and a camera that moves by ten pixels of its picture.
    let blurred = |sampling| {
        let mut b = Builder::new();
        b.size(40, 1).unwrap();
        b.samples(256).unwrap();
        b.sampling(sampling);
        let across = |x: f64| {
            let projection = Projection::Orthographic { height: 1.0 };
            let (eye, at) = (DVec3::new(x, 0.0, 5.0), DVec3::new(x, 0.0, 0.0));
            Camera::with_projection(eye, at, DVec3::Y, projection).unwrap()
        };
        b.camera(across(0.0));
        let Camera { eye, at, up, .. } = across(10.0);
        b.camera_motion(Some(Motion { eye, at, up })).unwrap();
        b.material_mut().emission = Term::color(DVec3::ONE);
        b.material_mut().ambient = Term::color(DVec3::ZERO);
        let corners = [(4.0, -5.0), (6.0, -5.0), (5.0, 5000.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        b.triangle(corners, None).unwrap();
        picture(&b.finish().value)
    };
    for (sampling, most) in [(Sampling::Stratified, 0.03), (Sampling::Sobol, 0.03)] {
        let row: Vec<f64> = blurred(sampling).pixels().iter().map(|p| p[0]).collect();
        // Two pixels wide, seen from 20 + 4 - 10 to 20 + 6: a trapezoid of height 2 / 10.
        for (x, got) in row.iter().enumerate() {
            // How long each place of the pixel sees the bar, over the pixel, by small steps.
            let steps = (0..1000).map(|i| {
                let (share, place) = (f64::from(i % 40) / 40.0 + 0.0125, f64::from(i / 40) / 25.0 + 0.02);
                let world = x as f64 + place - 20.0 + 10.0 * share;
                f64::from(u8::from((world - 5.0).abs() < 0.999))
            });
            let wanted = steps.sum::<f64>() / 1000.0;
            assert!(
                (got - wanted).abs() < most,
                "{sampling:?} pixel {x}: {got} {wanted}"
            );
        }
    }
}

#[test]
fn motions_without_a_view_are_refused() {
    let plain = Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, 45.0).unwrap();
    let to = |eye: DVec3, up| {
        plain.with_motion(Some(Motion {
            eye,
            at: DVec3::ZERO,
            up,
        }))
    };
    assert!(to(DVec3::X, DVec3::Y).is_ok());
    let through = to(DVec3::new(0.0, 0.0, -5.0), DVec3::Y).unwrap_err().message;
    assert_eq!(
        through,
        "the camera's eye and the point it looks at are the same, when 0.5 of its motion is done"
    );
    assert!(to(DVec3::X, DVec3::NEG_Y).is_err(), "up turns over");
    for (open, close) in [(-0.1, 1.0), (0.5, 0.4), (0.0, 1.1), (f64::NAN, 1.0)] {
        assert!(plain.with_shutter(Shutter { open, close }).is_err());
    }
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
