//! Pictures whose values are known: the renderer against formulas and against equal scenes built otherwise.

#![allow(clippy::unwrap_used)]

use rtscript::{
    Builder, DVec3, Image, Limits, NoHost, RenderOptions, Scene, Term, render,
    scene::{Attenuation, Camera},
    shape::{Cuboid, Plane, Shape},
};

fn color(v: f64) -> Term {
    Term::color(DVec3::splat(v))
}

/// A builder without the default ambient term, looking down -Z from `eye_z`.
fn dark(width: u32, height: u32, eye_z: f64) -> Builder {
    let mut b = Builder::new();
    b.size(width, height).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 0.0, eye_z), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
    b.material_mut().ambient = Term::BLACK;
    b
}

fn picture(scene: &Scene) -> Image {
    render(scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image
}

fn center(image: &Image) -> DVec3 {
    image.pixel(image.width() / 2, image.height() / 2).unwrap()
}

/// A square of two triangles in z = 0, facing +Z.
fn square(b: &mut Builder, half: f64) {
    let [p, q, r, s] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| DVec3::new(x * half, y * half, 0.0));
    b.triangle([p, q, r], None).unwrap();
    b.triangle([p, r, s], None).unwrap();
}

/// Two mirrors that face each other, the camera between them: each shows light of its own and a quarter of the other.
fn between_mirrors(depth: u32, least: Option<f64>) -> f64 {
    let mut b = dark(1, 1, 0.5);
    b.max_depth(depth).unwrap();
    if let Some(least) = least {
        b.min_weight(least).unwrap();
    }
    let m = b.material_mut();
    (m.emission, m.reflection) = (color(1.0), Some(color(0.25)));
    (m.diffuse, m.specular) = (Term::BLACK, Term::BLACK);
    for z in [-1.0, 1.0] {
        b.push_transform().unwrap();
        b.translate(DVec3::new(0.0, 0.0, z)).unwrap();
        square(&mut b, 5.0);
        b.pop_transform().unwrap();
    }
    center(&picture(&b.finish().value)).x
}

#[test]
fn a_mirrors_light_is_followed_while_its_weight_is_the_least_or_more() {
    // The sum of the first n terms of a geometric series of quarters, exact in binary.
    let series = |n: u32| {
        (0..n)
            .fold((0.0, 1.0), |(sum, term), _| (sum + term, term * 0.25))
            .0
    };
    let bounces_to = |least| between_mirrors(20, least);
    // 0.25^3 is 1/64 itself, which is followed.
    assert_eq!(bounces_to(Some(1.0 / 64.0)), series(4));
    assert_eq!(bounces_to(Some(1.0 / 63.0)), series(3));
    assert_eq!(bounces_to(Some(1.0)), 1.0);
    assert_eq!(bounces_to(None), series(11), "by default to 2^-20");
    assert_eq!(bounces_to(Some(1e-300)), series(21), "as deep as maxDepth");
    assert_eq!(between_mirrors(2, Some(1e-300)), series(3));
}

#[test]
fn a_spheres_silhouette_is_the_cone_of_its_tangents() {
    let mut b = dark(401, 401, 5.0);
    b.material_mut().emission = color(1.0);
    b.sphere(DVec3::ZERO, 1.0).unwrap();
    let image = picture(&b.finish().value);
    // Tangent rays meet the view axis at asin(r / d).
    let tan_edge = (1.0f64 / 5.0) / (1.0f64 - 1.0 / 25.0).sqrt();
    let (sin, cos) = rtscript::math::sin_cos_degrees(20.0);
    let per_pixel = 2.0 * (sin / cos) / 401.0;
    for y in 0..401u32 {
        for x in 0..401u32 {
            let dx = (f64::from(x) + 0.5 - 200.5) * per_pixel;
            let dy = (f64::from(y) + 0.5 - 200.5) * per_pixel;
            let inside = (dx * dx + dy * dy).sqrt() - tan_edge;
            if inside.abs() > 1e-12 {
                let seen = image.pixel(x, y).unwrap().x == 1.0;
                assert_eq!(seen, inside < 0.0, "pixel {x}, {y}");
            }
        }
    }
}

#[test]
fn diffuse_light_falls_off_as_the_equation_says() {
    for (c, l, q) in [
        (1.0, 0.0, 0.0),
        (0.5, 0.25, 0.0),
        (0.0, 0.0, 1.0),
        (1.0, 0.5, 0.25),
    ] {
        for d in [0.5, 1.0, 3.0] {
            let mut b = dark(1, 1, 10.0);
            b.material_mut().diffuse = color(0.8);
            b.attenuation(Attenuation {
                constant: c,
                linear: l,
                quadratic: q,
            })
            .unwrap();
            // 60 degrees off the normal: N.L = 1/2.
            let (sin, cos) = rtscript::math::sin_cos_degrees(60.0);
            b.point(DVec3::new(d * sin, 0.0, d * cos), DVec3::splat(2.0))
                .unwrap();
            square(&mut b, 4.0);
            let value = center(&picture(&b.finish().value)).x;
            let wanted = 0.8 * 2.0 * 0.5 / (c + l * d + q * d * d);
            assert!(
                (value - wanted).abs() < 1e-12 * wanted,
                "{c} {l} {q} at {d}: {value}, not {wanted}"
            );
        }
    }
}

#[test]
fn the_highlight_is_the_half_angles_cosine_to_the_shininess() {
    for shininess in [0.0, 1.0, 7.0, 12.5, 100.0] {
        let mut b = dark(1, 1, 10.0);
        b.material_mut().specular = color(0.5);
        b.material_mut().shininess = shininess;
        b.max_depth(0).unwrap();
        let (sin, cos) = rtscript::math::sin_cos_degrees(40.0);
        b.directional(DVec3::new(sin, 0.0, cos), DVec3::ONE).unwrap();
        square(&mut b, 4.0);
        let value = center(&picture(&b.finish().value)).x;
        // The eye is on the normal, so the half vector stands at 20 degrees.
        let (_, half) = rtscript::math::sin_cos_degrees(20.0);
        let wanted = 0.5 * rtscript::math::pow(half, shininess);
        assert!(
            (value - wanted).abs() < 1e-12,
            "{shininess}: {value}, not {wanted}"
        );
    }
}

#[test]
fn a_shadow_falls_where_something_stands_between_and_only_there() {
    let lit = |blocker: Option<f64>| {
        let mut b = dark(1, 1, 10.0);
        b.material_mut().diffuse = color(1.0);
        b.point(DVec3::new(3.0, 0.0, 3.0), DVec3::ONE).unwrap();
        square(&mut b, 6.0);
        if let Some(along) = blocker {
            b.sphere(DVec3::new(along, 0.0, along), 0.3).unwrap();
        }
        center(&picture(&b.finish().value)).x
    };
    let free = lit(None);
    assert!(free > 0.5);
    assert_eq!(lit(Some(1.5)), 0.0, "between");
    assert_eq!(lit(Some(4.0)), free, "behind the light");
}

#[test]
fn transparent_things_let_their_share_of_light_through_per_channel() {
    let mut b = dark(1, 1, 10.0);
    b.material_mut().diffuse = color(1.0);
    b.directional(DVec3::new(1.0, 0.0, 1.0), DVec3::ONE).unwrap();
    square(&mut b, 6.0);
    b.material_mut().transmission = Term::color(DVec3::new(0.5, 1.0, 0.0));
    b.sphere(DVec3::new(2.0, 0.0, 2.0), 0.5).unwrap();
    let value = center(&picture(&b.finish().value));
    let full = value.y;
    assert!((full - 0.5f64.sqrt()).abs() < 1e-12, "{value}");
    assert!(
        (value.x - 0.25 * full).abs() < 1e-15 && value.z == 0.0,
        "two surfaces: Kt squared; {value}"
    );
}

#[test]
fn a_mirror_shows_the_mirrored_scene() {
    let things = |b: &mut Builder, sign: f64| {
        for (i, x) in [-1.2, 0.1, 1.3].into_iter().enumerate() {
            b.material_mut().emission =
                Term::color(DVec3::new(0.2 + 0.3 * i as f64, 0.9 - 0.2 * i as f64, 0.4));
            b.sphere(DVec3::new(x, 0.4 - 0.3 * x, sign * (2.0 + 0.5 * x)), 0.6)
                .unwrap();
        }
    };
    // Seen in a mirror at z = 0 by a camera that looks at it from +Z past the things.
    let mut mirror = dark(120, 90, 1.0);
    mirror.camera(Camera::new(DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO, DVec3::Y, 80.0).unwrap());
    mirror.material_mut().reflection = Some(color(1.0));
    square(&mut mirror, 50.0);
    mirror.material_mut().reflection = None;
    things(&mut mirror, 1.0);
    // The same things behind where the mirror was.
    let mut direct = dark(120, 90, 1.0);
    direct.camera(Camera::new(DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO, DVec3::Y, 80.0).unwrap());
    things(&mut direct, -1.0);
    let (mirrored, direct) = (picture(&mirror.finish().value), picture(&direct.finish().value));
    let differing = mirrored
        .pixels()
        .iter()
        .zip(direct.pixels())
        .filter(|(a, b)| a.iter().zip(b.iter()).any(|(a, b)| (a - b).abs() > 1e-9))
        .count();
    assert!(direct.pixels().iter().filter(|p| p[0] > 0.0).count() > 500);
    assert!(differing <= 3, "{differing} pixels differ");
}

#[test]
fn a_glass_ball_bends_light_by_snells_law() {
    // A ray that enters a sphere at height h leaves it turned by 2 (i - r), sin i = h = n sin r.
    let (n, h) = (1.5, 0.6);
    let mut b = Builder::new();
    b.size(1, 1).unwrap();
    b.camera(Camera::new(DVec3::new(h, 0.0, 10.0), DVec3::new(h, 0.0, 0.0), DVec3::Y, 1.0).unwrap());
    b.material_mut().ambient = Term::BLACK;
    b.material_mut().transmission = color(1.0);
    b.material_mut().ior = n;
    b.sphere(DVec3::ZERO, 1.0).unwrap();
    // Directions in the plane y = 0 by their angles against -Z: i - r inside, twice that behind.
    let (i, r) = (rtscript::math::asin(h), rtscript::math::asin(h / n));
    let turned = 2.0 * (i - r);
    let dir = DVec3::new(-rtscript::math::sin(turned), 0.0, -rtscript::math::cos(turned));
    // A tiny target far along the ray that leaves.
    let exit = {
        let inside = DVec3::new(-rtscript::math::sin(i - r), 0.0, -rtscript::math::cos(i - r));
        let entry = DVec3::new(h, 0.0, rtscript::math::cos(i));
        entry + inside * (2.0 * rtscript::math::cos(r))
    };
    b.material_mut().transmission = Term::BLACK;
    b.material_mut().emission = color(1.0);
    b.sphere(exit + dir * 50.0, 1e-6).unwrap();
    assert_eq!(center(&picture(&b.finish().value)).x, 1.0);
}

/// Blocks of glass that stand exactly on the ground: no ray finds its way between the two. Seen from above, every
/// ray through them ends on the ground.
#[test]
fn blocks_of_glass_on_the_ground_show_the_ground() {
    for scale in [1.0, 1e-3, 1e4] {
        let mut b = Builder::new();
        b.size(160, 120).unwrap();
        b.scale(DVec3::splat(scale)).unwrap();
        let eye = DVec3::new(0.0, 2.5, 6.0) * scale;
        b.camera(Camera::new(eye, DVec3::new(0.0, 0.4, 0.0) * scale, DVec3::Y, 30.0).unwrap());
        b.background(DVec3::Z).unwrap();
        b.max_depth(8).unwrap();
        b.material_mut().ambient = Term::color(DVec3::new(0.5, 0.5, 0.0));
        b.shape(Shape::Plane(Plane)).unwrap();
        b.material_mut().ambient = Term::BLACK;
        b.material_mut().transmission = color(0.9);
        for x in [-1.0, 1.0] {
            b.push_transform().unwrap();
            b.translate(DVec3::new(x, 0.5, 0.0)).unwrap();
            b.shape(Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap())).unwrap();
            b.pop_transform().unwrap();
        }
        let image = picture(&b.finish().value);
        let through = |p: &&[f64; 3]| p[0] > 0.1 && p[0] < 0.5;
        assert!(
            image.pixels().iter().filter(through).count() > 1000,
            "the glass is seen"
        );
        let leaks = image.pixels().iter().filter(|p| p[2] > 0.0).count();
        assert_eq!(leaks, 0, "at scale {scale}");
    }
}

#[test]
fn beyond_the_critical_angle_all_light_is_reflected() {
    // Inside a glass half-space looking up at 60 degrees: only the mirror image of what is below is seen.
    let mut b = Builder::new();
    b.size(1, 1).unwrap();
    let (sin, cos) = rtscript::math::sin_cos_degrees(60.0);
    b.camera(
        Camera::new(
            DVec3::new(-5.0 * sin, 0.0, -5.0 * cos),
            DVec3::ZERO,
            DVec3::Y,
            1.0,
        )
        .unwrap(),
    );
    b.background(DVec3::new(0.0, 0.0, 1.0)).unwrap();
    b.material_mut().ambient = Term::BLACK;
    b.material_mut().transmission = color(0.75);
    square(&mut b, 10.0);
    b.material_mut().transmission = Term::BLACK;
    b.material_mut().emission = Term::color(DVec3::X);
    b.sphere(DVec3::new(5.0 * sin, 0.0, -5.0 * cos), 0.5).unwrap();
    assert_eq!(center(&picture(&b.finish().value)), DVec3::new(0.75, 0.0, 0.0));
}

#[test]
fn inside_a_white_furnace_everything_is_one() {
    // A mirror that reflects half and glows half, inside a sphere that does the same: 1/2 + 1/4 + ... = 1.
    let mut b = dark(16, 16, 0.5);
    b.max_depth(64).unwrap();
    b.material_mut().emission = color(0.5);
    b.material_mut().reflection = Some(color(0.5));
    b.sphere(DVec3::ZERO, 3.0).unwrap();
    b.sphere(DVec3::new(0.3, 0.2, -1.0), 0.5).unwrap();
    for p in picture(&b.finish().value).pixels() {
        assert!(p.iter().all(|v| (v - 1.0).abs() < 3e-6), "{p:?}");
    }
}

#[test]
fn the_depth_counts_secondary_rays() {
    // Between two parallel mirrors that glow, each bounce adds one term.
    for depth in 0..=8u32 {
        let mut b = dark(1, 1, 1.0);
        b.max_depth(depth).unwrap();
        b.material_mut().emission = color(1.0);
        b.material_mut().reflection = Some(color(1.0));
        square(&mut b, 9.0);
        b.translate(DVec3::new(0.0, 0.0, 2.0)).unwrap();
        square(&mut b, 9.0);
        assert_eq!(center(&picture(&b.finish().value)).x, f64::from(depth + 1));
    }
}

#[test]
fn an_area_light_gives_its_total() {
    // Far away, n x n points are as one.
    for n in [1, 2, 5] {
        let mut b = dark(1, 1, 10.0);
        b.material_mut().diffuse = color(1.0);
        b.area_light(
            DVec3::new(-0.5, -0.5, 1e4),
            DVec3::X,
            DVec3::Y,
            DVec3::splat(0.7),
            n,
        )
        .unwrap();
        square(&mut b, 4.0);
        assert!((center(&picture(&b.finish().value)).x - 0.7).abs() < 1e-6);
    }
}

#[test]
fn lights_and_shapes_follow_the_matrix() {
    let mut placed = dark(40, 30, 6.0);
    placed.material_mut().diffuse = color(1.0);
    placed.rotate(DVec3::new(1.0, 2.0, 0.5), 33.0).unwrap();
    placed.translate(DVec3::new(0.2, -0.1, 0.3)).unwrap();
    placed.point(DVec3::new(3.0, 3.0, 3.0), DVec3::ONE).unwrap();
    placed.directional(DVec3::Y, DVec3::splat(0.3)).unwrap();
    placed.sphere(DVec3::new(0.5, 0.0, 0.0), 1.0).unwrap();
    let m = placed.current_transform();
    let mut direct = dark(40, 30, 6.0);
    direct.material_mut().diffuse = color(1.0);
    direct
        .point(m.transform_point3(DVec3::splat(3.0)), DVec3::ONE)
        .unwrap();
    direct
        .directional(m.transform_vector3(DVec3::Y), DVec3::splat(0.3))
        .unwrap();
    direct
        .sphere(m.transform_point3(DVec3::new(0.5, 0.0, 0.0)), 1.0)
        .unwrap();
    let (placed, direct) = (picture(&placed.finish().value), picture(&direct.finish().value));
    for (a, b) in placed.pixels().iter().zip(direct.pixels()) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

#[test]
fn an_instance_looks_as_what_it_repeats() {
    let stand = |b: &mut Builder| {
        b.translate(DVec3::new(0.3, 0.2, -1.0)).unwrap();
        b.rotate(DVec3::Z, 30.0).unwrap();
        b.scale(DVec3::new(1.5, 0.7, 1.0)).unwrap();
    };
    let body = |b: &mut Builder| {
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.push_transform().unwrap();
        b.translate(DVec3::new(0.9, 0.9, 0.0)).unwrap();
        b.scale(DVec3::new(0.3, 0.5, 0.4)).unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        square(b, 2.0);
        b.pop_transform().unwrap();
        b.point(DVec3::new(1.0, 4.0, 5.0), DVec3::splat(0.8)).unwrap();
    };
    let mut flat = dark(80, 60, 6.0);
    flat.material_mut().diffuse = Term::color(DVec3::new(0.9, 0.5, 0.3));
    flat.push_transform().unwrap();
    stand(&mut flat);
    body(&mut flat);
    let mut instanced = dark(80, 60, 6.0);
    instanced.material_mut().diffuse = Term::color(DVec3::new(0.9, 0.5, 0.3));
    let outer = instanced.begin_define("outer").unwrap();
    let inner = instanced.begin_define("inner").unwrap();
    body(&mut instanced);
    instanced.end_define(inner, true);
    instanced.rotate(DVec3::Z, 10.0).unwrap();
    instanced.instance("inner").unwrap();
    instanced.end_define(outer, true);
    stand(&mut instanced);
    instanced.rotate(DVec3::Z, -10.0).unwrap();
    instanced.instance("outer").unwrap();
    let (flat, instanced) = (picture(&flat.finish().value), picture(&instanced.finish().value));
    let differing = flat
        .pixels()
        .iter()
        .zip(instanced.pixels())
        .filter(|(a, b)| a.iter().zip(b.iter()).any(|(a, b)| (a - b).abs() > 1e-6))
        .count();
    assert!(flat.pixels().iter().filter(|p| p[0] > 0.0).count() > 500);
    assert!(differing <= 2, "{differing} pixels differ");
}

#[test]
fn push_and_pop_are_neutral() {
    let mut b = Builder::with_limits(Limits::default());
    b.rotate(DVec3::ONE, 20.0).unwrap();
    let before = b.current_transform();
    for _ in 0..3 {
        b.push_transform().unwrap();
        b.scale(DVec3::splat(2.0)).unwrap();
    }
    for _ in 0..3 {
        b.pop_transform().unwrap();
    }
    assert_eq!(b.current_transform(), before);
    assert!(b.pop_transform().is_err());
}
