//! Reflectances and relief through the whole renderer, against formulas.

#![allow(clippy::unwrap_used)]

use rtscript::{DVec3, Image, Limits, MemoryHost, NoHost, RunOptions, math, render::World, testing};

fn render(text: &str) -> testing::RenderedFile {
    let host = MemoryHost::new();
    let rendered = testing::render_text(
        "test.rhai",
        text,
        &host,
        &Limits::default(),
        &RunOptions::default(),
    );
    rendered.map_err(|e| format!("{e}\n{text}")).unwrap()
}

fn mean(image: &Image) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for y in 0..image.height() {
        for x in 0..image.width() {
            sum += image.pixel(x, y).unwrap();
        }
    }
    sum / f64::from(image.width() * image.height())
}

/// The inside of a ball's outline before a white background, no lamp: what a surface makes of white light from all sides.
fn furnace(material: &str, samples: u32) -> DVec3 {
    let scene = format!(
        "size(12, 12); samples({samples}); maxDepth(40); background(1, 1, 1); ambient(0, 0, 0);\n\
         camera([0, 0, 8], [0, 0, 0], [0, 1, 0], 9);\n{material}\nsphere(0, 0, 0, 1);"
    );
    mean(&render(&scene).image)
}

#[test]
fn white_light_from_all_sides_stays_white_where_nothing_is_lost() {
    for material in [
        "transmission(1, 1, 1); fresnel(true);",
        "transmission(1, 1, 1); fresnel(true); ior(2.4);",
        "reflection(1, 1, 1); clearCoat(1, 0);",
        "reflection(1, 1, 1); bump(marble(#{ scale: 0.3 }), 0.05);",
    ] {
        let found = furnace(material, 4);
        assert!(
            (found - DVec3::ONE).abs().max_element() < 2e-3,
            "{material} {found}"
        );
    }
    // Colored samples are white together.
    let found = furnace("transmission(1, 1, 1); fresnel(true); dispersion(20);", 200);
    assert!((found - DVec3::ONE).abs().max_element() < 0.03, "{found}");
}

#[test]
fn no_surface_gives_back_more_than_it_gets() {
    for (material, least) in [
        ("fresnel(true);", 0.04),
        ("conductor(\"gold\");", 0.3),
        ("conductor(\"silver\"); roughness(0.3);", 0.8),
        ("reflection(1, 1, 1); roughness(0.2);", 0.97),
        ("reflection(1, 1, 1); roughness(1);", 0.3),
        ("transmission(1, 1, 1); fresnel(true); roughness(0.3);", 0.8),
        (
            "transmission(1, 1, 1); fresnel(true); roughness(0.8); ior(1.3);",
            0.4,
        ),
        (
            "transmission(1, 1, 1); fresnel(true); absorption(\"#8f8\", 1);",
            0.2,
        ),
        ("conductor(\"copper\"); clearCoat(0.7, 0.4); roughness(0.5);", 0.3),
    ] {
        let found = furnace(material, 16);
        assert!(
            found.max_element() < 1.001 && found.max_element() > least,
            "{material} {found}"
        );
    }
}

/// A horizontal mirror seen from `degrees` above the horizon's opposite, before white: its share.
fn mirrored_at(degrees: f64, material: &str) -> DVec3 {
    let (sin, cos) = math::sin_cos_degrees(degrees);
    let scene = format!(
        "size(1, 1); background(1, 1, 1); ambient(0, 0, 0);\n\
         camera([{}, {}, 0], [0, 0, 0], [0, 0, 1], 0.01);\n{material}\nplane();",
        sin * 5.0,
        cos * 5.0
    );
    render(&scene).image.pixel(0, 0).unwrap()
}

#[test]
fn mirrors_are_as_strong_as_fresnel_says() {
    // Glass of index 1.5 by Fresnel's equations, as tables have it.
    for (degrees, expected) in [(0.0, 0.04), (45.0, 0.050_240), (60.0, 0.089_186), (80.0, 0.387_7)] {
        let found = mirrored_at(degrees + 1e-9, "fresnel(true);").x;
        assert!((found - expected).abs() < 1e-3, "{degrees}: {found}");
    }
    // Gold straight on: ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
    let gold = mirrored_at(1e-9, "conductor(\"gold\");");
    let expected = DVec3::new(0.9658, 0.8021, 0.3241);
    assert!((gold - expected).abs().max_element() < 2e-3, "{gold}");
}

#[test]
fn glass_takes_light_by_beers_law() {
    let slab = |inside: &str| {
        format!(
            "size(1, 1); background(1, 1, 1); ambient(0, 0, 0); camera([0, 0, 9], [0, 0, 0], [0, 1, 0], 0.01);\n\
             group {{ transmission(1, 1, 1); ior(1); absorption([0.5, 0.25, 1], 1); box(4, 4, 2); }}\n{inside}"
        )
    };
    let seen = |scene: &str| render(scene).image.pixel(0, 0).unwrap();
    let through = seen(&slab(""));
    assert!(
        (through - DVec3::new(0.25, 0.0625, 1.0)).abs().max_element() < 1e-9,
        "{through}"
    );
    // What stands inside is seen through as much as lies before it, and lit through as much as lies above it.
    let glowing = seen(&slab("emission(1, 1, 1); sphere(0, 0, 0, 0.5);"));
    let before = DVec3::new(0.5f64.sqrt(), 0.5, 1.0);
    assert!((glowing - before).abs().max_element() < 1e-6, "{glowing}");
    let lit = seen(&slab(
        "directional([0, 0, 1], [1, 1, 1]); diffuse(1, 1, 1); sphere(0, 0, 0, 0.5);",
    ));
    assert!((lit - before * before).abs().max_element() < 1e-6, "{lit}");
    // The shadow of a slab on a wall behind it.
    let wall = "size(1, 1); ambient(0, 0, 0); camera([3, 0, 0], [0, 0, -3], [0, 1, 0], 0.01); directional([0, 0, 1], [1, 1, 1]);\n\
        group { transmission(1, 1, 1); ior(1); absorption([0.5, 0.25, 1], 1); box(1, 1, 2); }\n\
        group { diffuse(1, 1, 1); translate(0, 0, -3); rotate(1, 0, 0, 90); plane(); }";
    let shadow = seen(wall);
    assert!(
        (shadow - DVec3::new(0.25, 0.0625, 1.0)).abs().max_element() < 1e-9,
        "{shadow}"
    );
}

#[test]
fn relief_leans_the_normal_as_its_slope_does() {
    // Heights that rise along x by a slope of 0.5, under light from the side.
    let brightness = |relief: &str, place: &str| {
        let scene = format!(
            "size(1, 1); ambient(0, 0, 0); camera([0.3, 5, 0.2], [0.3, 0, 0.2], [0, 0, 1], 0.01);\n\
             directional([-1, 1, 0], [1, 1, 1]); diffuse(1, 1, 1); {relief}\n{place}"
        );
        render(&scene).image.pixel(0, 0).unwrap().x
    };
    let slope =
        "bump(gradient(#{ colors: [[0, [0, 0, 0]], [1, [1, 1, 1]]], from: [-2, 0, 0], to: [2, 0, 0] }), 2);";
    // The normal of y = x / 2 is (-1, 2, 0) / sqrt 5.
    let expected = 3.0 / (5.0f64.sqrt() * 2.0f64.sqrt());
    for place in [
        "plane();",
        "group { scale(3, 3, 3); plane(); }",
        "define \"p\" { plane(); } group { rotate(0, 1, 0, 0); instance(\"p\"); }",
        "mesh(#{ positions: [[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]], indices: [0, 2, 1, 0, 3, 2], uvs: [[0, 0], [1, 0], [1, 1], [0, 1]] });",
    ] {
        let found = brightness(slope, place);
        assert!(
            (found - expected).abs() < 1e-6,
            "{place}: {found} and not {expected}"
        );
    }
    // Level relief is none.
    let flat = brightness("", "plane();");
    assert!((brightness("bump([0.7, 0.7, 0.7], 3);", "plane();") - flat).abs() < 1e-12);
    let level = "normalMap(image(#{ width: 1, height: 1, pixels: [0.5, 0.5, 1] }));";
    let mesh = "mesh(#{ positions: [[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]], indices: [0, 2, 1, 0, 3, 2], uvs: [[0, 0], [1, 0], [1, 1], [0, 1]] });";
    assert!((brightness(level, mesh) - flat).abs() < 1e-12);
    // A normal that leans to the left, where u runs along x: by 45 degrees into the light.
    let leaning = "normalMap(image(#{ width: 1, height: 1, pixels: [0, 0.5, 1] }));";
    let found = brightness(leaning, mesh);
    assert!((found - 1.0).abs() < 1e-6, "{found}");
}

#[test]
fn a_prism_shows_the_colors_in_order() {
    // A wedge of 20 degrees with its base to the right; the eye looks along -z at a bright bar behind it.
    let (sin, cos) = math::sin_cos_degrees(10.0);
    let (x, z) = (3.0, 6.0 * sin / cos);
    let image = render(&format!(
        "size(256, 4); samples(64); ambient(0, 0, 0); camera([0, 0, 10], [0, 0, 0], [0, 1, 0], 1.2);\n\
         group {{ emission(1, 1, 1); translate(0, 0, -10); box(0.1, 8, 0.1); }}\n\
         transmission(1, 1, 1); ior(1.5); dispersion(10);\n\
         mesh(#{{ positions: [[-{x}, -4, 0], [{x}, -4, -{z}], [{x}, 4, -{z}], [-{x}, 4, 0], [{x}, -4, {z}], [{x}, 4, {z}]],\n\
         indices: [0, 2, 1, 0, 3, 2, 0, 4, 5, 0, 5, 3] }});"
    ))
    .image;
    let mut place = [0.0; 3];
    for (channel, place) in place.iter_mut().enumerate() {
        let (mut sum, mut whole) = (0.0, 0.0);
        for x in 0..image.width() {
            let light = image.pixel(x, 2).unwrap()[channel];
            sum += light * f64::from(x);
            whole += light;
        }
        assert!(whole > 0.0, "channel {channel} is black");
        *place = sum / whole;
    }
    let [red, green, blue] = place;
    assert!((red - green) * (green - blue) > 0.0, "{place:?}");
    assert!((red - blue).abs() > 1.2, "{place:?}");
}

#[test]
fn an_explanation_adds_up_to_the_pixel() {
    let scene = "size(24, 18); samples(3); maxDepth(4); background(0.3, 0.4, 0.5);\n\
        light([3, 5, 4], [1, 1, 1]); areaLight([-2, 4, 0], [1, 0, 0], [0, 0, 1], [0.5, 0.5, 0.5], 3);\n\
        group { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); orenNayar(30); plane(); }\n\
        group { transmission(1, 1, 1); fresnel(true); absorption(\"#8cf\", 0.5); dispersion(20); roughness(0.1); sphere(-1, 0, 0, 1); }\n\
        group { conductor(\"gold\"); roughness(0.3); clearCoat(0.8, 0.05); bump(granite(), 0.02); sphere(1.2, 0, 0, 0.9); }\n\
        group { emission(1, 0.2, 0.1); sphere(-1, 0, 0, 0.3); }";
    let rendered = render(scene);
    let world = World::compile(&rendered.scene).unwrap();
    for y in 0..18 {
        for x in 0..24 {
            let explained = world.explain(x, y, &NoHost).unwrap();
            let pixel = rendered.image.pixel(x, y).unwrap();
            assert_eq!(explained.value, pixel, "{x}, {y}");
            let samples = explained.samples.iter();
            let sum = samples.fold(DVec3::ZERO, |sum, sample| sum + sample.sum() / 3.0);
            assert!(
                (sum - pixel).abs().max_element() <= 1e-12 * pixel.max_element().max(1.0),
                "{x}, {y}: {sum} and {pixel}"
            );
        }
    }
}
