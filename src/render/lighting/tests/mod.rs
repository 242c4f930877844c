//! Lights against what can be worked out with pen and paper.

mod around;
mod faint;

use std::sync::Arc;

use crate::{
    Builder, NoHost,
    color::Color,
    math::{self, DVec3, PI},
    render::{RenderOptions, render},
    scene::{
        Attenuation, Camera, Falloff, ImageTexture, LightMesh, Links, Projector, Sun, SurfaceLight, Term,
        Texels, Texture,
    },
    shape::{Cuboid, Plane, Shape},
};

/// The light that a white floor sends up from the origin.
fn floor(light: impl FnOnce(&mut Builder)) -> Color {
    floor_at(DVec3::ZERO, light)
}

/// The light that a white floor sends up from the point `at` of it.
fn floor_at(at: DVec3, light: impl FnOnce(&mut Builder)) -> Color {
    let mut b = Builder::new();
    b.size(1, 1).unwrap();
    b.camera(Camera::new(at + DVec3::Y * 50.0, at, DVec3::Z, 1.0).unwrap());
    b.material_mut().ambient = Term::BLACK;
    b.material_mut().diffuse = Term::color(Color::ONE);
    b.shape(Shape::Plane(Plane)).unwrap();
    light(&mut b);
    only_pixel(b)
}

/// The picture of one pixel.
fn only_pixel(b: Builder) -> Color {
    let scene = b.finish().value;
    let image = render(&scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image;
    image.pixel(0, 0).unwrap()
}

#[track_caller]
fn near(found: Color, expected: Color, share: f64) {
    let off = (found - expected).abs().max_element();
    assert!(
        off <= share * expected.abs().max_element(),
        "{found} is not {expected}"
    );
}

const WHITE: Color = Color::ONE;

#[test]
fn a_disk_lights_what_is_below_its_center_as_its_form_factor_says() {
    for (radius, height) in [(0.2, 1.0), (1.0, 1.0), (3.0, 0.5)] {
        let found = floor(|b| {
            let center = DVec3::Y * height;
            let disk = SurfaceLight::disk(center, DVec3::NEG_Y, radius, 64, Falloff::Physical).unwrap();
            b.surface_light(disk, Color::new(3.0, 2.0, 1.0)).unwrap();
        });
        let expected = 1.0 / (radius * radius + height * height);
        near(found, Color::new(3.0, 2.0, 1.0) * expected, 0.004);
    }
}

#[test]
fn a_sphere_lights_as_a_point_in_its_center_does() {
    for (center, radius) in [
        (DVec3::Y * 2.0, 1.9),
        (DVec3::new(1.0, 2.0, -0.5), 1.0),
        (DVec3::new(3.0, 1.0, 0.0), 1e-3),
    ] {
        let sphere = |radius| SurfaceLight::sphere(center, radius, 48, Falloff::Physical).unwrap();
        let found = floor(|b| b.surface_light(sphere(radius), WHITE).unwrap());
        let d2 = center.length_squared();
        let expected = WHITE * (center.y / (d2 * d2.sqrt()));
        near(found, expected, 0.002);
        let scaled = floor(|b| {
            b.scale(DVec3::splat(radius)).unwrap();
            let unit = SurfaceLight::sphere(center / radius, 1.0, 48, Falloff::Physical).unwrap();
            b.surface_light(unit, WHITE).unwrap();
        });
        near(scaled, expected, 0.002);
    }
}

/// An ellipsoid is seen as the ellipse that its outline is: from far away one of half axes a and b, whose solid angle
/// is pi a b / d^2.
#[test]
fn an_ellipsoid_far_away_lights_by_its_outline() {
    let (a, b, c, far) = (2.0, 1.0, 0.5, 1e4);
    let found = floor(|scene| {
        scene.translate(DVec3::Y * far).unwrap();
        scene.scale(DVec3::new(a, c, b)).unwrap();
        let unit = SurfaceLight::sphere(DVec3::ZERO, 1.0, 64, Falloff::Physical).unwrap();
        scene.surface_light(unit, WHITE * far * far).unwrap();
    });
    let r2 = math::cbrt(a * b * c) * math::cbrt(a * b * c);
    near(found, WHITE * (a * b / r2), 1e-3);
}

#[test]
fn inside_of_a_sphere_light_it_is_as_bright_everywhere() {
    let sphere = SurfaceLight::sphere(DVec3::Y * 0.3, 2.0, 96, Falloff::Physical).unwrap();
    // Half of the directions lie above the floor.
    near(
        floor(|b| b.surface_light(sphere, WHITE).unwrap()),
        WHITE / 4.0,
        0.004,
    );
}

/// Form factor from a point to a parallel rectangle a x b above it, one corner straight above (Howell, "A catalog of
/// radiation heat transfer configuration factors", B-3).
fn corner_factor(a: f64, b: f64, height: f64) -> f64 {
    let (a, b) = (a / height, b / height);
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * math::atan(b / ra) + b / rb * math::atan(a / rb)) / (2.0 * PI)
}

#[test]
fn rectangles_and_meshes_light_as_their_form_factor_says() {
    let (corner, edge1, edge2) = (DVec3::Y * 1.5, DVec3::X * 2.0, DVec3::Z * 3.0);
    let expected = WHITE * (PI * corner_factor(2.0, 3.0, 1.5) / 6.0);
    let rectangle = || SurfaceLight::rectangle(corner, [edge1, edge2], 64, Falloff::Physical).unwrap();
    near(
        floor(|b| b.surface_light(rectangle(), WHITE).unwrap()),
        expected,
        0.004,
    );
    let [p, q, r, s] = [corner, corner + edge1, corner + edge1 + edge2, corner + edge2];
    let mesh = Arc::new(LightMesh::new(vec![[p, q, s], [q, q, q], [q, r, s]]).unwrap());
    let mesh = || SurfaceLight::mesh(Arc::clone(&mesh), 64, Falloff::Physical).unwrap();
    near(
        floor(|b| b.surface_light(mesh(), WHITE).unwrap()),
        expected,
        0.004,
    );
    // Mirrored and moved back, it is the same light.
    let mirrored = floor(|b| {
        b.translate(DVec3::X * 2.0).unwrap();
        b.scale(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
        b.surface_light(mesh(), WHITE).unwrap();
    });
    near(mirrored, expected, 0.004);
    // From the back comes nothing.
    let turned = || SurfaceLight::rectangle(corner, [edge2, edge1], 8, Falloff::Physical).unwrap();
    assert_eq!(floor(|b| b.surface_light(turned(), WHITE).unwrap()), Color::ZERO);
}

/// The same sum as `areaLight` has, over the same points.
#[test]
fn a_rectangle_that_is_attenuated_is_an_area_light() {
    let fade = Attenuation {
        constant: 0.5,
        linear: 0.1,
        quadratic: 0.2,
    };
    let (corner, edge1, edge2) = (DVec3::new(-1.0, 2.0, 0.5), DVec3::X * 2.0, DVec3::Z);
    let area = floor(|b| {
        b.attenuation(fade).unwrap();
        b.area_light(corner, edge1, edge2, WHITE, 8).unwrap();
    });
    let rectangle = SurfaceLight::rectangle(corner, [edge1, edge2], 8, Falloff::Attenuation(fade)).unwrap();
    near(floor(|b| b.surface_light(rectangle, WHITE).unwrap()), area, 1e-12);
}

#[test]
fn a_sun_of_some_size_has_the_mean_cosine_of_its_disk() {
    for angle in [0.27, 10.0, 60.0] {
        let sun = Sun::new(DVec3::Y * 3.0, angle, 32).unwrap();
        let found = floor(|b| b.sun(sun, WHITE).unwrap());
        let mean = 0.5 * (1.0 + math::cos(f64::to_radians(angle)));
        near(found, WHITE * mean, 0.002);
    }
}

#[test]
fn a_projector_puts_each_texel_where_it_belongs() {
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
    let image = Arc::new(Texture::Image(ImageTexture {
        name: String::new(),
        width: 4,
        height: 1,
        texels: Texels::Linear(colors.to_vec()),
    }));
    // 90 degrees from top to bottom, 2 above the floor: the picture is 4 high and 16 wide there.
    let at = |x: f64, z: f64| {
        floor_at(DVec3::new(x, 0.0, z), |b| {
            let id = b.texture(&image);
            let places = [DVec3::Y * 2.0, DVec3::ZERO, DVec3::NEG_Z];
            let projector = Projector::new(places, 90.0, id, Attenuation::default()).unwrap();
            b.projector(projector, WHITE).unwrap();
        })
    };
    for (i, color) in colors.into_iter().enumerate() {
        let x = -6.0 + 4.0 * i as f64;
        let cosine = 2.0 / (4.0 + x * x + 1.0).sqrt();
        near(at(x, 1.0), Color::from_array(color) * cosine, 1e-12);
    }
    assert_eq!(at(-6.0, 2.01), Color::ZERO);
    assert_eq!(at(8.01, 0.0), Color::ZERO);
}

/// A light of a group adds to its shapes what it adds to all without links, and nothing to others.
#[test]
fn linked_lights_reach_their_groups_alone() {
    let lit = |links: &dyn Fn(&Builder) -> Links| {
        let mut b = Builder::new();
        b.size(2, 1).unwrap();
        b.camera(Camera::new(DVec3::Y * 10.0, DVec3::ZERO, DVec3::NEG_Z, 20.0).unwrap());
        b.material_mut().ambient = Term::BLACK;
        b.material_mut().diffuse = Term::color(Color::ONE);
        for (name, x) in [("left", -5.0), ("right", 5.0)] {
            let mark = b.begin_define(name).unwrap();
            b.translate(DVec3::new(x, -5.0, 0.0)).unwrap();
            b.shape(Shape::Cuboid(Cuboid::new(DVec3::splat(10.0)).unwrap()))
                .unwrap();
            b.end_define(mark, true);
            b.instance(name).unwrap();
        }
        let links = links(&b);
        b.light_linking(links).unwrap();
        b.directional(DVec3::Y, Color::ONE).unwrap();
        let scene = b.finish().value;
        let image = render(&scene, &RenderOptions::default(), &NoHost)
            .unwrap()
            .value
            .image;
        [image.pixel(0, 0).unwrap().x, image.pixel(1, 0).unwrap().x]
    };
    let ids = |b: &Builder, names: &[&str]| {
        names
            .iter()
            .map(|n| b.group_called(n).unwrap())
            .collect::<Vec<_>>()
    };
    assert_eq!(lit(&|_| Links::default()), [1.0, 1.0]);
    assert_eq!(
        lit(&|b| Links::new(Some(ids(b, &["left"])), Vec::new()).unwrap()),
        [1.0, 0.0]
    );
    assert_eq!(lit(&|b| Links::new(None, ids(b, &["left"])).unwrap()), [0.0, 1.0]);
    assert_eq!(
        lit(&|b| Links::new(Some(ids(b, &["left", "right"])), ids(b, &["right"])).unwrap()),
        [1.0, 0.0]
    );
    assert_eq!(
        lit(&|_| Links::new(Some(Vec::new()), Vec::new()).unwrap()),
        [0.0, 0.0]
    );
}

/// The lamp that shows where a light is does not stand in its way, and nobody is warned of it.
#[test]
fn a_ball_may_stand_where_a_ball_of_light_is() {
    let center = DVec3::new(1.0, 2.0, -0.5);
    let shine = |b: &mut Builder| {
        let light = SurfaceLight::sphere(center, 1.0, 16, Falloff::Physical).unwrap();
        b.surface_light(light, WHITE).unwrap();
    };
    let alone = floor(shine);
    let shown = floor(|b| {
        shine(b);
        b.sphere(center, 1.0).unwrap();
    });
    assert_eq!(alone, shown);
    let mut b = Builder::new();
    shine(&mut b);
    b.sphere(center, 1.0).unwrap();
    b.camera(Camera::new(DVec3::Z * 9.0, center, DVec3::Y, 40.0).unwrap());
    let warnings = crate::render::inspect(&b.finish().value, &NoHost).unwrap();
    let is_inside = |d: &crate::diag::Diagnostic| d.code == crate::diag::Code::LightInside;
    assert!(!warnings.iter().any(is_inside), "{warnings:?}");
}
