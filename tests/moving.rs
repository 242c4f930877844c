//! What moves, seen from outside: how much of the time a thing is in front of a pixel, by a closed form.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use rtscript::{
    Builder, DVec3, Image, Limits, NoHost, RenderOptions, Scene, Term,
    math::{self, Ray},
    render,
    render::{LayerKind, World},
    scene::{
        Adaptive, AnimatedTransform, Camera, CsgOp, Filter, FilterKind, Motion, Projection, Sampling,
        Shutter, Stereo, StereoLayout,
    },
    script::{RunOptions, Script},
    shape::{Cuboid, Plane, Shape},
};

const WIDTH: u32 = 48;
/// Edge of a pixel of [`flat`] in world units.
const PIXEL: f64 = 0.1;

/// White things in the dark, seen from +z by parallel rays; the origin is in the middle of the picture.
fn flat(height: u32, samples: u32) -> Builder {
    let mut b = Builder::new();
    b.size(WIDTH, height).unwrap();
    b.samples(samples).unwrap();
    let projection = Projection::Orthographic {
        height: f64::from(height) * PIXEL,
    };
    b.camera(Camera::with_projection(DVec3::Z * 50.0, DVec3::ZERO, DVec3::Y, projection).unwrap());
    let m = b.material_mut();
    (m.ambient, m.emission) = (Term::color(DVec3::ZERO), Term::color(DVec3::ONE));
    b
}

fn moving(b: &mut Builder, motion: AnimatedTransform, make: impl FnOnce(&mut Builder)) {
    let mark = b.begin_moving(motion).unwrap();
    make(b);
    b.end_moving(mark, true).unwrap();
}

fn along(translate: DVec3) -> AnimatedTransform {
    AnimatedTransform {
        translate,
        ..AnimatedTransform::default()
    }
}

fn about(axis: DVec3, degrees: f64) -> AnimatedTransform {
    AnimatedTransform {
        axis,
        degrees,
        ..AnimatedTransform::default()
    }
}

fn cuboid(b: &mut Builder, size: DVec3) {
    b.shape(Shape::Cuboid(Cuboid::new(size).unwrap())).unwrap();
}

fn picture(scene: &Scene) -> Image {
    image(scene, &RenderOptions::default())
}

fn image(scene: &Scene, options: &RenderOptions) -> Image {
    render::render(scene, options, &NoHost).unwrap().value.image
}

/// The mean over pixel (`x`, `y`) of a picture of [`flat`] with so many rows, of a function of the place.
fn mean(rows: u32, (x, y): (u32, u32), value: impl Fn(f64, f64) -> f64) -> f64 {
    const N: u32 = 32;
    let place = |pixel: u32, i: u32, count: u32| {
        (f64::from(pixel) + (f64::from(i) + 0.5) / f64::from(N) - f64::from(count) / 2.0) * PIXEL
    };
    let sum: f64 = (0..N * N)
        .map(|i| value(place(x, i % N, WIDTH), -place(y, i / N, rows)))
        .sum();
    sum / f64::from(N * N)
}

/// Compares red with the closed form, pixel by pixel.
fn compare(image: &Image, most: f64, value: impl Fn(f64, f64) -> f64) {
    let (mut sum, mut wanted) = (0.0, 0.0);
    for (x, y) in (0..image.height()).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let expected = mean(image.height(), (x, y), &value);
        let found = image.pixel(x, y).unwrap().x;
        assert!(
            (found - expected).abs() < most,
            "pixel {x},{y}: {found} and not {expected}"
        );
        (sum, wanted) = (sum + found, wanted + expected);
    }
    assert!(
        wanted > 10.0 && (sum / wanted - 1.0).abs() < 0.01,
        "{sum} {wanted}"
    );
}

/// The share of the time from 0 to 1 in which `from + speed t` lies within `half` of `x`.
fn share(x: f64, from: f64, speed: f64, half: f64) -> f64 {
    let (a, b) = ((x - half - from) / speed, (x + half - from) / speed);
    (a.max(b).min(1.0) - a.min(b).max(0.0)).max(0.0)
}

#[test]
fn the_edge_of_a_moving_box_is_a_ramp() {
    let mut b = flat(3, 256);
    b.translate(DVec3::X * -1.6).unwrap();
    moving(&mut b, along(DVec3::X * 2.5), |b| {
        cuboid(b, DVec3::new(1.0, 9.0, 1.0))
    });
    let image = picture(&b.finish().value);
    compare(&image, 0.03, |x, _| share(x, -1.6, 2.5, 0.5));
    // As steep as the box is fast: one pixel for a time of 0.04.
    let step = image.pixel(13, 1).unwrap().x - image.pixel(12, 1).unwrap().x;
    assert!((step - PIXEL / 2.5).abs() < 0.03, "{step}");
}

#[test]
fn a_moving_ball_is_seen_as_long_as_it_is_there() {
    let mut b = flat(12, 256);
    moving(&mut b, along(DVec3::X * -3.0), |b| {
        b.sphere(DVec3::X * 1.5, 0.5).unwrap();
    });
    compare(&picture(&b.finish().value), 0.06, |x, y| {
        let half = (0.25 - y * y).max(0.0).sqrt();
        share(x, 1.5, -3.0, half)
    });
}

#[test]
fn a_turning_bar_goes_along_arcs() {
    let mut b = flat(34, 100);
    // A whole turn: at each radius the share of the circle that the bar covers.
    moving(&mut b, about(DVec3::Z * 7.0, 360.0), |b| {
        cuboid(b, DVec3::new(3.2, 0.5, 0.2))
    });
    compare(&picture(&b.finish().value), 0.1, |x, y| {
        let radius = (x * x + y * y).sqrt();
        // From where the corners are on, the end of the bar cuts the arc off.
        let ends = if radius > 1.6 {
            math::acos(1.6 / radius)
        } else {
            0.0
        };
        let half = math::asin((0.25 / radius).min(1.0));
        ((half - ends).max(0.0) * 2.0) / std::f64::consts::PI
    });
}

#[test]
fn what_grows_grows_evenly() {
    let mut b = flat(3, 256);
    let grown = AnimatedTransform {
        scale: DVec3::new(4.0, 1.0, 1.0),
        ..AnimatedTransform::default()
    };
    moving(&mut b, grown, |b| cuboid(b, DVec3::new(1.0, 9.0, 1.0)));
    compare(&picture(&b.finish().value), 0.03, |x, _| {
        (1.0 - (x.abs() / 0.5 - 1.0) / 3.0).clamp(0.0, 1.0)
    });
}

#[test]
fn the_shutter_takes_a_part_of_the_motion() {
    let mut b = flat(3, 256);
    b.shutter(Shutter {
        open: 0.25,
        close: 0.75,
    })
    .unwrap();
    moving(&mut b, along(DVec3::X * 4.0), |b| {
        b.translate(DVec3::X * -2.0).unwrap();
        cuboid(b, DVec3::new(1.0, 9.0, 1.0));
    });
    compare(&picture(&b.finish().value), 0.03, |x, _| share(x, -1.0, 2.0, 0.5));
}

#[test]
fn a_shadow_moves_as_what_casts_it() {
    let mut b = flat(3, 256);
    b.directional(DVec3::new(0.0, 1.0, 1.0), DVec3::ONE * 2f64.sqrt())
        .unwrap();
    let m = b.material_mut();
    (m.emission, m.diffuse) = (Term::color(DVec3::ZERO), Term::color(DVec3::ONE));
    // What casts it is far above what is seen.
    moving(&mut b, along(DVec3::X * 2.5), |b| {
        b.translate(DVec3::new(-1.6, 20.0, 20.0)).unwrap();
        cuboid(b, DVec3::new(1.0, 9.0, 1.0));
    });
    b.rotate(DVec3::X, 90.0).unwrap();
    b.shape(Shape::Plane(Plane)).unwrap();
    compare(&picture(&b.finish().value), 0.03, |x, _| {
        1.0 - share(x, -1.6, 2.5, 0.5)
    });
}

#[test]
fn a_mirror_and_a_window_show_the_motion() {
    for window in [false, true] {
        let mut b = flat(3, 256);
        let white = b.material().clone();
        let m = b.material_mut();
        m.emission = Term::color(DVec3::ZERO);
        // A mirror at 45 degrees looks up; a window lets everything through.
        if window {
            (m.transmission, m.ior) = (Term::color(DVec3::ONE), 1.0);
        } else {
            m.reflection = Some(Term::color(DVec3::ONE));
        }
        b.push_transform().unwrap();
        b.rotate(DVec3::X, 45.0).unwrap();
        b.shape(Shape::Plane(Plane)).unwrap();
        b.pop_transform().unwrap();
        b.set_material(white);
        let behind = if window { DVec3::NEG_Z } else { DVec3::Y } * 8.0;
        moving(&mut b, along(DVec3::X * 2.5), |b| {
            b.translate(behind - DVec3::X * 1.6).unwrap();
            cuboid(b, DVec3::new(1.0, 9.0, 9.0));
        });
        compare(&picture(&b.finish().value), 0.03, |x, _| share(x, -1.6, 2.5, 0.5));
    }
}

#[test]
fn a_cut_moves_through_what_it_is_cut_from() {
    let mut b = flat(3, 256);
    let csg = b.begin_csg(CsgOp::Difference).unwrap();
    cuboid(&mut b, DVec3::new(4.0, 9.0, 1.0));
    moving(&mut b, along(DVec3::X * 2.5), |b| {
        b.translate(DVec3::X * -1.6).unwrap();
        cuboid(b, DVec3::new(1.0, 10.0, 2.0));
    });
    b.end_csg(csg, true).unwrap();
    compare(&picture(&b.finish().value), 0.03, |x, _| {
        (1.0 - share(x, -1.6, 2.5, 0.5)) * f64::from(u8::from(x.abs() < 2.0))
    });
}

#[test]
fn what_goes_along_with_the_camera_is_sharp() {
    let scene = |moves: bool| {
        let mut b = flat(12, 16);
        let by = if moves {
            DVec3::new(3.0, 1.0, 0.5)
        } else {
            DVec3::ZERO
        };
        let Camera { eye, at, up, .. } = b.finish().value.camera;
        b = flat(12, 16);
        b.camera_motion(Some(Motion {
            eye: eye + by,
            at: at + by,
            up,
        }))
        .unwrap();
        moving(&mut b, along(by), |b| b.sphere(DVec3::ZERO, 0.5).unwrap());
        b.finish().value
    };
    let (moves, still) = (picture(&scene(true)), picture(&scene(false)));
    for (a, b) in moves.pixels().iter().zip(still.pixels()) {
        assert!((a[0] - b[0]).abs() < 1e-9);
    }
    assert!(still.pixels().iter().any(|p| p[0] > 0.1 && p[0] < 0.9));
}

type Change = fn(&mut Builder);

/// Each way in which a pixel comes by its samples.
const KINDS: [(&str, Change); 6] = [
    ("plain", |_| {}),
    ("one sample", |b| b.samples(1).unwrap()),
    ("net", |b| b.sampling(Sampling::Sobol)),
    ("filter", |b| b.filter(Filter::new(FilterKind::Gaussian)).unwrap()),
    ("adaptive", |b| {
        b.adaptive(Some(Adaptive { error: 0.02, min: 4 })).unwrap();
    }),
    ("anaglyph", |b| {
        b.stereo(Some(Stereo {
            separation: 0.2,
            layout: StereoLayout::Anaglyph,
            convergence: None,
        }))
        .unwrap();
    }),
];

/// A ball that flies over a mirror before a light that has an area.
fn everything(change: Change) -> Scene {
    let mut b = Builder::new();
    b.size(17, 13).unwrap();
    b.samples(9).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 1.0, 5.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
    b.area_light(
        DVec3::new(-1.0, 3.0, 0.0),
        DVec3::X * 2.0,
        DVec3::Z * 2.0,
        DVec3::ONE,
        2,
    )
    .unwrap();
    b.material_mut().diffuse = Term::color(DVec3::new(0.8, 0.6, 0.4));
    moving(&mut b, along(DVec3::new(1.0, 0.3, 0.0)), |b| {
        b.sphere(DVec3::X * -0.5, 0.6).unwrap();
        moving(b, about(DVec3::Y, 90.0), |b| b.sphere(DVec3::X, 0.3).unwrap());
    });
    b.material_mut().specular = Term::color(DVec3::splat(0.5));
    b.translate(DVec3::Y * -0.7).unwrap();
    b.shape(Shape::Plane(Plane)).unwrap();
    change(&mut b);
    b.finish().value
}

#[test]
fn pictures_are_the_same_however_they_are_made() {
    for (name, change) in KINDS {
        let scene = everything(change);
        let expected = picture(&scene);
        let still = {
            let mut still = scene.clone();
            still.camera.shutter = Shutter {
                open: 0.3,
                close: 0.3,
            };
            picture(&still)
        };
        assert_ne!(expected, still, "{name}");
        let mut other = RenderOptions::default();
        (other.threads, other.tile, other.shuffle) = (3, 3, Some(7));
        assert_eq!(expected, image(&scene, &other), "{name}");
        other.single_rays = true;
        assert_eq!(expected, image(&scene, &other), "{name}");
        let world = World::compile(&scene).unwrap();
        for (x, y) in [(3, 3), (8, 6), (6, 9), (16, 12)] {
            let why = world.explain(x, y, &NoHost).unwrap();
            assert_eq!(Some(why.value), expected.pixel(x, y), "{name} {x} {y}");
            for sample in &why.samples {
                assert_eq!(sample.sum(), sample.value, "{name} {x} {y}");
            }
        }
    }
}

#[test]
fn layers_show_the_middle() {
    let mut b = flat(3, 1);
    moving(&mut b, along(DVec3::X * 2.0), |b| {
        b.translate(DVec3::X * -1.0).unwrap();
        cuboid(b, DVec3::new(0.52, 9.0, 1.0));
    });
    let mut options = RenderOptions::default();
    options.layers = vec![LayerKind::Depth];
    let image = image(&b.finish().value, &options);
    let row = &image.layers()[0].values[WIDTH as usize..2 * WIDTH as usize];
    for (x, depth) in row.iter().enumerate() {
        let place = (x as f64 + 0.5 - f64::from(WIDTH) / 2.0) * PIXEL;
        let expected = if place.abs() < 0.26 { 49.5 } else { f32::INFINITY };
        assert_eq!(*depth, expected, "{x}");
    }
}

#[test]
fn a_wheel_that_rolls_stands_still_where_it_touches_the_ground() {
    let (radius, degrees) = (0.5, 90.0);
    let way = radius * f64::to_radians(degrees);
    let mut b = Builder::new();
    let roll = AnimatedTransform {
        translate: DVec3::X * way,
        ..about(DVec3::Z, -degrees)
    };
    moving(&mut b, roll, |b| b.sphere(DVec3::NEG_Y * radius, 1e-3).unwrap());
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    for i in 0..=20 {
        let time = f64::from(i) / 20.0;
        // A cycloid: x = r (a - sin a), y = -r cos a.
        let angle = f64::to_radians(degrees) * time;
        let at = DVec3::new(
            radius * (angle - math::sin(angle)),
            -radius * math::cos(angle),
            0.0,
        );
        let hit = world
            .at_time(time)
            .raycast(&Ray::new(at + DVec3::Z * 5.0, DVec3::NEG_Z), 9.0);
        assert!((hit.unwrap().t - 4.999).abs() < 1e-9, "{time}");
        if i > 5 {
            let start = Ray::new(DVec3::new(0.0, -radius, 5.0), DVec3::NEG_Z);
            assert_eq!(world.at_time(time).raycast(&start, 9.0), None);
        }
    }
}

#[test]
fn questions_of_a_script_see_the_beginning() {
    let source = r#"
        shutter(0.5, 1);
        define "far" { moving #{ translate: [9, 0, 0] } { sphere(0, 0, 0, 1); } }
        moving #{ translate: [0, 9, 0], scale: 3 } { sphere(0, 0, 0, 1); }
        let down = [0, -1, 0];
        if raycast([0, 5, 0], down).distance != 4 { throw "raycast"; }
        if raycast("far", [0, 5, 0], down).distance != 4 { throw "raycast far"; }
        if !inside("far", [0.5, 0, 0]) { throw "inside"; }
        if bounds("far").max != vec3(1, 1, 1) { throw `bounds ${bounds("far")}`; }
    "#;
    let script = Script::compile("questions.rhai", source, &Limits::default()).unwrap();
    script.run(&NoHost, &RunOptions::default()).unwrap();
}
