//! Environments, ambient occlusion, fog and haze.

use super::*;
use crate::{
    render::{environment::Surround, sampler::Sampler},
    scene::{Environment, Fog, Haze, Occlusion, Scene, Sky, Spot},
};

fn gradient(zenith: Color, horizon: Color, ground: Color) -> Environment {
    let sky = Sky::Gradient {
        zenith,
        horizon,
        ground,
    };
    Environment::new(sky, WHITE, 0.0, 32).unwrap()
}

/// What a ray of the camera from the origin along `dir` sees.
fn seen(dir: DVec3, build: impl FnOnce(&mut Builder)) -> Color {
    let mut b = Builder::new();
    b.size(1, 1).unwrap();
    b.max_depth(0).unwrap();
    let up = if dir.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    b.camera(Camera::new(DVec3::ZERO, dir, up, 1.0).unwrap());
    build(&mut b);
    only_pixel(b)
}

#[test]
fn white_all_around_a_white_surface_is_white() {
    let white = gradient(WHITE, WHITE, WHITE);
    near(floor(|b| b.environment(Some(white)).unwrap()), WHITE, 0.004);
    let faint = Environment::new(*white.sky(), Color::new(0.5, 0.25, 0.0), 30.0, 32).unwrap();
    near(
        floor(|b| b.environment(Some(faint)).unwrap()),
        Color::new(0.5, 0.25, 0.0),
        0.004,
    );
    let unlit = Environment::new(*white.sky(), WHITE, 0.0, 0).unwrap();
    assert_eq!(floor(|b| b.environment(Some(unlit)).unwrap()), Color::ZERO);
    assert_eq!(seen(DVec3::X, |b| b.environment(Some(unlit)).unwrap()), WHITE);
}

/// The integral of h + (z - h) cos over the half sphere, by the cosine, over pi.
#[test]
fn a_gradient_sky_lights_a_floor_by_its_mean() {
    let (zenith, horizon) = (Color::new(0.2, 0.5, 2.0), Color::new(1.0, 0.5, 0.1));
    let sky = gradient(zenith, horizon, WHITE * 0.5);
    let expected = horizon + (zenith - horizon) * (2.0 / 3.0);
    near(floor(|b| b.environment(Some(sky)).unwrap()), expected, 0.008);
    let dir = DVec3::new(0.48, 0.6, -0.64);
    let half_way = seen(dir, |b| b.environment(Some(sky)).unwrap());
    near(half_way, horizon + (zenith - horizon) * 0.6, 1e-12);
    assert_eq!(
        seen(DVec3::new(1.0, -1e-9, 0.0), |b| b.environment(Some(sky)).unwrap()),
        WHITE * 0.5
    );
}

/// A picture with bright, dim and black texels.
fn map(b: &mut Builder, rotation: f64) -> Environment {
    let texels = (0..8 * 4).map(|i| {
        let x = f64::from(i * 37 % 11);
        if i % 3 == 0 {
            [0.0; 3]
        } else {
            [x * x * 0.05, 0.1 * x, if i == 13 { 40.0 } else { 0.02 }]
        }
    });
    let image = Arc::new(Texture::Image(ImageTexture {
        name: String::new(),
        width: 8,
        height: 4,
        texels: Texels::Linear(texels.collect()),
    }));
    let id = b.texture(&image);
    Environment::new(Sky::Image(id), WHITE, rotation, 64).unwrap()
}

fn mapped(rotation: f64) -> Scene {
    let mut b = Builder::new();
    let environment = map(&mut b, rotation);
    b.environment(Some(environment)).unwrap();
    b.finish().value
}

/// Column, row and their number, in a picture of 8 x 4, of an unturned direction.
fn texel_of(dir: DVec3) -> usize {
    let u = 0.5 + math::atan2(dir.x, -dir.z) / (2.0 * PI);
    let v = math::acos(dir.y.clamp(-1.0, 1.0)) / PI;
    (v * 4.0).min(3.0) as usize * 8 + (u * 8.0).min(7.0) as usize
}

#[test]
fn directions_are_chosen_as_bright_as_the_picture_is() {
    let scene = mapped(0.0);
    let surround = Surround::new(&scene).unwrap();
    // Mean light of each texel's part of the sphere, cells of the table being even by the height.
    let mut expected = [0.0; 32];
    let steps = 32;
    for (texel, place) in expected.iter_mut().enumerate() {
        let (column, row) = ((texel % 8) as f64, (texel / 8) as f64);
        let mut mean = Color::ZERO;
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
            let (phi, theta) = (
                2.0 * PI * ((column + at(i)) / 8.0 - 0.5),
                PI * (row + at(j)) / 4.0,
            );
            let side = math::sin(theta);
            let dir = DVec3::new(side * math::sin(phi), math::cos(theta), -side * math::cos(phi));
            mean += surround.radiance(dir);
        }
        let solid = math::cos(PI * row / 4.0) - math::cos(PI * (row + 1.0) / 4.0);
        *place = mean.max_element() * solid;
    }
    let total: f64 = expected.iter().sum();
    let count = 40_000;
    let sampler = Sampler::new(3, 0, 0, 0);
    let mut found = [0.0; 32];
    for i in 0..count {
        let (dir, density) = surround
            .direction((sampler.get(2 * i), sampler.get(2 * i + 1)))
            .unwrap();
        assert!((dir.length() - 1.0).abs() < 1e-12 && density > 0.0);
        assert!((surround.density(dir) - density).abs() < 1e-9 * density);
        found[texel_of(dir)] += 1.0;
    }
    let mut chi2 = 0.0;
    for (found, expected) in found.into_iter().zip(expected) {
        let expected = expected / total * count as f64;
        chi2 += (found - expected) * (found - expected) / expected;
    }
    // Exceeded by chance once in a thousand.
    assert!(chi2 < 61.1, "chi^2 of 31 degrees of freedom is {chi2}");
}

#[test]
fn a_picture_lights_a_floor_as_its_integral_says_however_it_is_turned() {
    for rotation in [0.0, 75.0] {
        let scene = mapped(rotation);
        let surround = Surround::new(&scene).unwrap();
        let steps = 600;
        let mut expected = Color::ZERO;
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
            // Even by the cosine: cos^2 of the height is even.
            let (phi, y) = (2.0 * PI * at(i), at(j).sqrt());
            let side = (1.0 - y * y).sqrt();
            expected += surround.radiance(DVec3::new(side * math::cos(phi), y, side * math::sin(phi)));
        }
        expected /= f64::from(steps * steps);
        let found = floor(|b| {
            let environment = map(b, rotation);
            b.environment(Some(environment)).unwrap();
        });
        near(found, expected, 0.01);
    }
    // Turned by a quarter, what was ahead is at the left.
    let (straight, turned) = (mapped(0.0), mapped(90.0));
    let ahead = Surround::new(&straight).unwrap().radiance(DVec3::NEG_Z);
    near(
        Surround::new(&turned).unwrap().radiance(DVec3::NEG_X),
        ahead,
        1e-9,
    );
}

#[test]
fn daylight_has_the_luminance_of_its_formula_at_the_zenith() {
    let sun = DVec3::new(1.0, 1.0, 0.0);
    let daylight = |n| {
        let sky = Sky::Daylight {
            sun,
            turbidity: 3.0,
            ground: Color::ZERO,
        };
        Environment::new(sky, WHITE, 0.0, n).unwrap()
    };
    let luminance = |color: Color| color.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let zenith = seen(DVec3::Y, |b| b.environment(Some(daylight(0))).unwrap());
    // (4.0453 T - 4.971) tan((4/9 - T/120) (pi - 2 theta)) - 0.2155 T + 2.4192 thousand candela, of which 20 are 1.
    assert!((luminance(zenith) * 20.0 - 7.326).abs() < 0.08, "{zenith}");
    assert!(zenith.z > zenith.x, "the sky is blue: {zenith}");
    let light = crate::render::daylight::sunlight(sun, 3.0);
    assert!(light.x > light.z, "the sun is yellow: {light}");
    let lit = floor(|b| {
        b.environment(Some(daylight(16))).unwrap();
        b.directional(DVec3::Y, crate::render::daylight::sunlight(DVec3::Y, 2.0))
            .unwrap();
    });
    assert!((1.0..2.5).contains(&luminance(lit)), "{lit}");
}

#[test]
fn a_wall_takes_from_the_ambient_light_what_its_form_factor_says() {
    let open = |x: f64, height: f64, distance: f64| {
        floor(|b| {
            b.ambient_occlusion(Some(Occlusion::new(distance, 128).unwrap()));
            // The floor again, now with an ambient color.
            b.material_mut().ambient = Term::color(Color::new(1.0, 0.5, 0.0));
            b.translate(DVec3::Y * 1e-3).unwrap();
            b.shape(Shape::Plane(Plane)).unwrap();
            b.translate(DVec3::X * (x + 0.5)).unwrap();
            let size = DVec3::new(1.0, 2.0 * height, 1e5);
            b.shape(Shape::Cuboid(Cuboid::new(size).unwrap())).unwrap();
        })
    };
    for (x, height) in [(0.5f64, 1.0f64), (1.0, 1.0), (1.0, 4.0)] {
        let factor = 0.5 * (1.0 - x / math::hypot(x, height));
        near(
            open(x, height, 1e5),
            Color::new(1.0, 0.5, 0.0) * (1.0 - factor),
            0.003,
        );
    }
    // Of a wall without end there counts what is nearer than the distance: a segment of the disk.
    let c: f64 = 0.4;
    let factor = (math::acos(c) - c * (1.0 - c * c).sqrt()) / PI;
    near(
        open(0.8, 1e4, 2.0),
        Color::new(1.0, 0.5, 0.0) * (1.0 - factor),
        0.003,
    );
    assert_eq!(open(3.0, 1.0, 2.0), Color::new(1.0, 0.5, 0.0));
}

/// A glowing wall at z = -4, seen from the origin.
fn wall(b: &mut Builder) {
    b.material_mut().ambient = Term::BLACK;
    b.material_mut().emission = Term::color(Color::new(1.0, 0.5, 0.25));
    b.translate(DVec3::NEG_Z * 4.5).unwrap();
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap())).unwrap();
}

#[test]
fn fog_and_haze_weaken_by_the_law_of_beer() {
    let left = math::exp(-4.0 / 3.0);
    let (glow, gray) = (Color::new(1.0, 0.5, 0.25), WHITE * 0.6);
    let through = |air: &dyn Fn(&mut Builder)| {
        seen(DVec3::NEG_Z, |b| {
            air(b);
            wall(b);
        })
    };
    let fog = Fog::new(gray, 3.0, 0.0, None).unwrap();
    near(
        through(&|b| b.fog(Some(fog))),
        glow * left + gray * (1.0 - left),
        1e-12,
    );
    let haze = Haze::new(1.0 / 3.0, WHITE, 0.0, 4).unwrap();
    near(through(&|b| b.haze(Some(haze))), glow * left, 1e-12);
    assert_eq!(seen(DVec3::X, |b| b.fog(Some(fog))), gray);
}

/// All that is taken of parallel light is scattered, a quarter of pi of it to each side.
#[test]
fn haze_in_parallel_light_is_a_quarter_of_it() {
    for n in [1, 7] {
        let found = seen(DVec3::X, |b| {
            b.haze(Some(Haze::new(0.3, Color::new(1.0, 0.5, 0.0), 0.0, n).unwrap()));
            b.directional(DVec3::Y, WHITE).unwrap();
        });
        near(found, Color::new(0.25, 0.125, 0.0), 1e-12);
    }
}

#[test]
fn the_halo_of_a_lamp_is_its_integral() {
    let fades = Attenuation {
        constant: 0.0,
        linear: 0.0,
        quadratic: 1.0,
    };
    let even = Attenuation::default();
    for (attenuation, forward) in [(fades, 0.0), (fades, 0.6), (even, 0.0), (even, -0.4)] {
        let (density, lamp) = (0.4, DVec3::new(2.0, 0.5, 0.0));
        let found = seen(DVec3::X, |b| {
            b.haze(Some(Haze::new(density, WHITE, forward, 512).unwrap()));
            b.attenuation(attenuation).unwrap();
            b.point(lamp, WHITE).unwrap();
        });
        let (steps, end) = (40_000, 60.0);
        let sum: f64 = (0..steps)
            .map(|i| {
                let s = (f64::from(i) + 0.5) / f64::from(steps) * end;
                let offset = lamp - DVec3::X * s;
                let d = offset.length();
                let below = 1.0 + forward * forward - 2.0 * forward * offset.x / d;
                let phase = 0.25 * (1.0 - forward * forward) / (below * below.sqrt());
                density * math::exp(-density * (s + d)) * attenuation.at(d) * phase * end / f64::from(steps)
            })
            .sum();
        near(found, WHITE * sum, 0.003);
    }
}

/// A surface in haze has what is left of the light after its way.
#[test]
fn haze_takes_from_the_light_of_lamps() {
    let lit = |haze: bool| {
        floor(|b| {
            if haze {
                // No albedo: nothing comes from the air itself.
                b.haze(Some(Haze::new(0.01, Color::ZERO, 0.0, 1).unwrap()));
            }
            b.point(DVec3::Y * 3.0, WHITE).unwrap();
        })
    };
    // The camera stands 50 above.
    near(lit(true), lit(false) * math::exp(-0.53), 1e-12);
}

#[test]
fn the_beam_of_a_spot_is_its_integral() {
    let (density, lamp) = (0.3, DVec3::new(2.0, 1.0, 0.3));
    let attenuation = Attenuation {
        constant: 0.2,
        linear: 0.0,
        quadratic: 0.5,
    };
    let target = DVec3::new(2.5, -1.0, 0.0);
    let spot = Spot::new(lamp, target, (25.0, 10.0), 0.0, attenuation).unwrap();
    let found = seen(DVec3::X, |b| {
        b.haze(Some(Haze::new(density, WHITE, 0.0, 64).unwrap()));
        b.spot(spot.clone(), WHITE).unwrap();
    });
    let (steps, end) = (40_000, 20.0);
    let sum: f64 = (0..steps)
        .map(|i| {
            let s = (f64::from(i) + 0.5) / f64::from(steps) * end;
            let out = DVec3::X * s - lamp;
            let d = out.length();
            let sent = attenuation.at(d) * spot.share(out);
            density * math::exp(-density * (s + d)) * sent * 0.25 * end / f64::from(steps)
        })
        .sum();
    near(found, WHITE * sum, 0.003);
}
