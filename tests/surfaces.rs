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

/// Every term that is a number or a color, as a constant and as a texture that is that constant everywhere, with another value.
const TERMS: [[&str; 3]; 15] = [
    ["shininess(30);", "shininess(TEX(30));", "shininess(5);"],
    [
        "fresnel(true); ior(1.3);",
        "fresnel(true); ior(TEX(1.3));",
        "fresnel(true); ior(2.2);",
    ],
    [
        "transmission(0.7, 0.7, 0.7); ior(1.3);",
        "transmission(0.7, 0.7, 0.7); ior(TEX(1.3));",
        "transmission(0.7, 0.7, 0.7); ior(1.1);",
    ],
    [
        "conductor([0.2, 0.9, 1.1], [4, 2.5, 2]);",
        "conductor(checker([0.2, 0.9, 1.1], [0.2, 0.9, 1.1], 1), TEX(1) * vec3(4, 2.5, 2));",
        "conductor([0.2, 0.9, 0.1], [4, 2.5, 2]);",
    ],
    ["orenNayar(40);", "orenNayar(TEX(40));", "orenNayar(10);"],
    [
        "clearCoat(0.8, 0.3);",
        "clearCoat(TEX(0.8), TEX(0.3));",
        "clearCoat(0.8, 0.6);",
    ],
    ["clearCoat(0.8);", "clearCoat(TEX(0.8));", "clearCoat(0.3);"],
    [
        "transmission(1, 1, 1); absorption([0.5, 0.2, 0.9], 2);",
        "transmission(1, 1, 1); absorption(checker([0.5, 0.2, 0.9], [0.5, 0.2, 0.9], 1), TEX(2));",
        "transmission(1, 1, 1); absorption([0.5, 0.2, 0.9], 1);",
    ],
    [
        "transmission(1, 1, 1); dispersion(20);",
        "transmission(1, 1, 1); dispersion(TEX(20));",
        "transmission(1, 1, 1); dispersion(5);",
    ],
    [
        "bump(marble(), 0.1);",
        "bump(marble(), TEX(0.1));",
        "bump(marble(), 0.3);",
    ],
    [
        "normalMap(DENTS, 0.7);",
        "normalMap(DENTS, TEX(0.7));",
        "normalMap(DENTS, 0.2);",
    ],
    [
        "reflection(0.5, 0.5, 0.5); roughness(0.3);",
        "reflection(0.5, 0.5, 0.5); roughness(TEX(0.3));",
        "reflection(0.5, 0.5, 0.5); roughness(0.8);",
    ],
    [
        "emission(0.1, 0.2, 0.3);",
        "emission(TEX(1) * vec3(0.1, 0.2, 0.3));",
        "emission(0.2, 0.2, 0.3);",
    ],
    [
        "reflection(0.3, 0.3, 0.3);",
        "reflection(TEX(0.3));",
        "reflection(0.1, 0.3, 0.3);",
    ],
    [
        "transmission(0.3, 0.3, 0.3);",
        "transmission(TEX(0.3));",
        "transmission(0.1, 0.3, 0.3);",
    ],
];

/// A ball of a material between lights, above a checkered floor.
fn ball(material: &str) -> Image {
    let mut material = material.replace(
        "DENTS",
        "image(#{ width: 2, height: 1, pixels: [0.3, 0.5, 1, 0.6, 0.6, 1] })",
    );
    while let Some((before, (value, after))) = material
        .split_once("TEX(")
        .and_then(|(before, rest)| Some((before, rest.split_once(')')?)))
    {
        material =
            format!("{before}checker([{value}, {value}, {value}], [{value}, {value}, {value}], 0.3){after}");
    }
    render(&format!(
        "size(16, 12); samples(2); background(0.3, 0.4, 0.5); ambient(0, 0, 0); camera([0, 1, 5], [0, 0, 0], [0, 1, 0], 30);\n\
         directional([2, 4, 3], [0.9, 0.9, 0.9]); light([-3, 2, 4], [0.4, 0.4, 0.4]);\n\
         group {{ translate(0, -1, 0); diffuse(checker(\"#fff\", \"#a63\", 1)); plane(); }}\n\
         diffuse(0.4, 0.3, 0.2); specular(0.3, 0.3, 0.3); {material}\nsphere(0, 0, 0, 1);"
    ))
    .image
}

fn greatest_difference(a: &Image, b: &Image) -> f64 {
    let pixels = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
    let differences = pixels.map(|(x, y)| a.pixel(x, y).unwrap() - b.pixel(x, y).unwrap());
    differences.map(|d| d.abs().max_element()).fold(0.0, f64::max)
}

#[test]
fn every_term_takes_a_texture() {
    for [constant, textured, other] in TERMS {
        let expected = ball(constant);
        let found = greatest_difference(&expected, &ball(textured));
        // The light on a way in parts is a product that rounds otherwise.
        assert!(found < 1e-9, "{textured}: {found}");
        let apart = greatest_difference(&expected, &ball(other));
        assert!(apart > 1e-3, "{other} looks like {constant}: {apart}");
    }
}

#[test]
fn terms_take_the_values_of_their_textures() {
    // Each pixel is as if the value at its place were everywhere. What is seen through other parts of the surface is left out.
    for (term, a, b) in [
        ("shininess(TEX)", "5", "60"),
        ("orenNayar(TEX)", "0", "50"),
        ("clearCoat(TEX)", "0", "1"),
        ("clearCoat(1, TEX)", "0", "0.7"),
        ("fresnel(true); ior(TEX)", "1.1", "2"),
        ("conductor(TEX, TEX)", "0.3", "2"),
        ("conductor(TEX, TEX); roughness(TEX)", "0.2", "0.9"),
    ] {
        let of = |value: &str| {
            ball(&format!(
                "{};",
                term.replace(
                    "TEX",
                    &format!("checker([{value}, {value}, {value}], [{value}, {value}, {value}], 1)")
                )
            ))
        };
        let (at_a, at_b) = (of(a), of(b));
        let mixed = ball(&format!(
            "{};",
            term.replace("TEX", &format!("checker([{a}, {a}, {a}], [{b}, {b}, {b}], 9)"))
        ));
        let mut seen = [0; 2];
        for y in 0..12 {
            for x in 0..16 {
                let pixel = |image: &Image| image.pixel(x, y).unwrap();
                if pixel(&at_a) == pixel(&at_b) {
                    continue;
                }
                seen[0] += usize::from(pixel(&mixed) == pixel(&at_a));
                seen[1] += usize::from(pixel(&mixed) == pixel(&at_b));
            }
        }
        assert!(seen.into_iter().all(|n| n > 4), "{term}: {seen:?}");
    }
}

#[test]
fn what_varies_inside_is_followed_along_the_way() {
    // Half of the way of one color, half of another; the boundary is that of two of the parts that are looked at.
    let [near, far] = [DVec3::new(0.5, 0.25, 1.0), DVec3::new(0.9, 0.81, 0.6)];
    let inside = "checker([0.5, 0.25, 1], [0.9, 0.81, 0.6], 8)";
    let slab = |place: &str, more: &str| {
        let scene = format!(
            "size(1, 1); background(1, 1, 1); ambient(0, 0, 0); camera([1, 1, 9], [1, 1, 0], [0, 1, 0], 0.01);\n\
             define \"slab\" {{ transmission(1, 1, 1); ior(1); absorption({inside}, 1); box(4, 4, 2); }}\n{place}\n{more}"
        );
        render(&scene).image.pixel(0, 0).unwrap()
    };
    let is = |found: DVec3, expected: DVec3| {
        assert!(
            (found - expected).abs().max_element() < 1e-9,
            "{found} and not {expected}"
        );
    };
    is(slab("instance(\"slab\");", ""), near * far);
    // Twice as deep, its halves too.
    let twice = near * near * far * far;
    is(slab("group { scale(1, 1, 2); instance(\"slab\"); }", ""), twice);
    // Behind the middle, a ray from the eye sees the half before it, and light of a lamp comes through as much.
    let root = |c: DVec3, x: f64| DVec3::new(math::pow(c.x, x), math::pow(c.y, x), math::pow(c.z, x));
    is(
        slab(
            "instance(\"slab\");",
            "emission(1, 1, 1); translate(1, 1, 0); box(0.5, 0.5, 1);",
        ),
        root(near, 0.5),
    );
    is(
        slab(
            "instance(\"slab\");",
            "directional([0, 0, 1], [1, 1, 1]); diffuse(1, 1, 1); translate(1, 1, -0.25); box(0.5, 0.5, 0.5);",
        ),
        near * near,
    );
    // The shadow of the whole on a wall.
    let wall = format!(
        "size(1, 1); ambient(0, 0, 0); camera([5, 0, 0], [0, 0, -3], [0, 1, 0], 0.01); directional([0, 0, 1], [1, 1, 1]);\n\
         group {{ translate(-1, -1, 0); transmission(1, 1, 1); ior(1); absorption({inside}, 1); box(4, 4, 2); }}\n\
         group {{ diffuse(1, 1, 1); translate(0, 0, -3); rotate(1, 0, 0, 90); plane(); }}"
    );
    is(render(&wall).image.pixel(0, 0).unwrap(), near * far);
}

#[test]
fn formulas_of_dispersion_agree_where_they_say_the_same() {
    let prism = |glass: &str| ball(&format!("transmission(1, 1, 1); {glass}"));
    // Cauchy's two terms are what an Abbe number stands for.
    let [d, f, c] = [0.587_56f64, 0.486_13, 0.656_27].map(|line| 1.0 / (line * line));
    let b = (1.7 - 1.0) / (20.0 * (f - c));
    let a = 1.7 - b * d;
    let abbe = prism("ior(1.7); dispersion(20);");
    let same = greatest_difference(&abbe, &prism(&format!("dispersion({a}, {b});")));
    assert!(same < 1e-9, "{same}");
    let other = greatest_difference(&abbe, &prism(&format!("dispersion({a}, {b}, 0.004);")));
    assert!(other > 1e-3, "{other}");
    // A glass of no dispersion is one of its index.
    let still = greatest_difference(
        &prism("dispersion(1.6, 0);"),
        &prism("ior(1.6); dispersion(1000000);"),
    );
    assert!(still < 1e-4, "{still}");
    // A glass by its name is one with its index and nearly one with its Abbe number: Cauchy's two terms are not its own.
    let flint = prism("dispersion(\"F2\");");
    let near = greatest_difference(&flint, &prism("ior(1.62004); dispersion(36.37);"));
    let far = greatest_difference(&flint, &prism("ior(1.62004); dispersion(80);"));
    assert!(near < 0.3 * far, "{near} and {far}");
}

#[test]
fn rough_metals_give_back_what_goes_between_their_mirrors() {
    for roughness in [0.1, 0.3, 0.5, 0.7, 0.85, 1.0] {
        let material = format!("reflection(1, 1, 1); roughness({roughness}); multiscatter(true);");
        let found = furnace(&material, 300).x;
        assert!((0.99..1.01).contains(&found), "{roughness}: {found}");
    }
    // A conductor of all but perfect mirrors: (1 - 0.001)^2 + k^2 over (1 + 0.001)^2 + k^2.
    let conductor = "conductor([0.001, 0.001, 0.001], [50, 50, 50]); roughness(0.8); multiscatter(true);";
    let found = furnace(conductor, 300).x;
    assert!((0.99..1.01).contains(&found), "{found}");
    let lost = furnace("reflection(1, 1, 1); roughness(1);", 64).x;
    assert!(lost < 0.5, "{lost}");
    // Each bounce between mirrors of gold takes blue away.
    let gold = |more: &str| furnace(&format!("conductor(\"gold\"); roughness(0.9); {more}"), 64);
    let (single, all) = (gold(""), gold("multiscatter(true);"));
    assert!(all.x > 1.3 * single.x && all.z > single.z, "{single} and {all}");
    assert!(all.z / all.x < single.z / single.x, "{single} and {all}");
    // Highlights of lamps grow as the mirror does.
    let lit = |more: &str| {
        let scene = format!(
            "size(1, 1); ambient(0, 0, 0); camera([0, 5, 0], [0, 0, 0], [0, 0, 1], 0.01); directional([0.3, 1, 0], [1, 1, 1]);\n\
             reflection(1, 1, 1); roughness(0.8); {more}\nplane();"
        );
        render(&scene).image.pixel(0, 0).unwrap().x
    };
    let growth = lit("multiscatter(true);") / lit("");
    assert!((1.6..2.0).contains(&growth), "{growth}");
    // What is smooth or lets light through has none to give back.
    for material in [
        "reflection(1, 1, 1);",
        "transmission(1, 1, 1); fresnel(true); roughness(0.5);",
    ] {
        let same = greatest_difference(&ball(material), &ball(&format!("multiscatter(true); {material}")));
        assert!(same < 1e-9, "{material}: {same}");
    }
}

#[test]
fn pictures_on_floors_stay_sharp_where_pixels_are_told_what_they_cover() {
    // A floor seen aslant, under lines that run away from the eye; the truth is what many samples see.
    let floor = |filter: &str, samples: u32, place: &str, uv: &str| {
        render(&format!(
            "size(32, 24); samples({samples}); ambient(1, 1, 1); camera([0.2, 1, 6], [0, 0, 0], [0, 1, 0], 40);\n\
             let pixels = []; for y in 0..32 {{ for x in 0..32 {{ let bright = if x % 8 < 4 {{ 1 }} else {{ 0.1 }}; pixels.push(bright); pixels.push(bright); pixels.push(y / 31.0); }} }}\n\
             let lines = image(image(#{{ width: 32, height: 32, pixels: pixels }}), #{{ filter: \"{filter}\", {uv} }});\n\
             ambient(lines); {place}"
        ))
        .image
    };
    let distance = |a: &Image, b: &Image| {
        let pixels = (0..24).flat_map(|y| (0..32).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                (a.pixel(x, y).unwrap() - b.pixel(x, y).unwrap())
                    .abs()
                    .max_element()
            })
            .sum::<f64>()
    };
    let square = "mesh(#{ positions: [[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]], indices: [0, 2, 1, 0, 3, 2], uvs: [[0, 0], [1, 0], [1, 1], [0, 1]] });";
    let plane = "plane();";
    let instance = "define \"floor\" { rotate(1, 0, 0, 90); scale(3, 3, 3); translate(0, 0, 0.0001); box(6, 6, 0.0001); } translate(0, -0.0001, 0); instance(\"floor\");";
    for (place, uv) in [
        (square, "scale: [0.25, 0.25, 1]"),
        (plane, "mapping: \"box\", scale: [4.5, 4.5, 4.5]"),
        (instance, "mapping: \"planar\", scale: [1.5, 1.5, 1.5]"),
    ] {
        let truth = floor("bilinear", 64, place, uv);
        let [bilinear, mip, anisotropic] =
            ["bilinear", "mip", "anisotropic"].map(|filter| distance(&truth, &floor(filter, 1, place, uv)));
        assert!(
            anisotropic < 0.6 * mip && anisotropic < 0.6 * bilinear,
            "{place}: {anisotropic}, {mip}, {bilinear}"
        );
    }
}

/// The middle of a pixel in a picture whose edges are those of the square from -1 to 1.
fn place(pixel: u32, pixels: u32) -> f64 {
    2.0 * (f64::from(pixel) + 0.5) / f64::from(pixels) - 1.0
}

#[test]
fn colors_of_vertices_are_linear_over_a_triangle() {
    const N: u32 = 16;
    let head = format!("size({N}, {N}); ambient(0, 0, 0); orthographic([0, 0, 5], [0, 0, 0], [0, 1, 0], 2);");
    // Red grows to the right and blue upwards, so that both halves of the square say the same.
    let square = "#{ positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], indices: [0, 1, 2, 0, 2, 3],
        uvs: [[0, 0], [0, 0], [0, 0], [0, 0]], colors: [[0, 0.5, 0], [1, 0.5, 0], [1, 0.5, 1], [0, 0.5, 1]] }";
    for (scene, tint) in [
        (format!("emission(vertexColors()); mesh({square});"), 1.0),
        (format!("emission(vertexColors() * 0.5); mesh({square});"), 0.5),
        // Wherever the square comes from, its colors go with it.
        (
            format!("emission(vertexColors()); define \"s\" {{ scale(0.5); mesh({square}); }} scale(2); instance(\"s\");"),
            1.0,
        ),
        (
            "emission(vertexColors()); subdivide(#{ positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
                 faces: [[0, 1, 2, 3]], creases: [[0, 1, 9], [1, 2, 9], [2, 3, 9], [3, 0, 9]],
                 colors: [[0, 0.5, 0], [1, 0.5, 0], [1, 0.5, 1], [0, 0.5, 1]] }, 0);"
                .to_owned(),
            1.0,
        ),
    ] {
        let image = render(&format!("{head} {scene}")).image;
        for y in 0..N {
            for x in 0..N {
                let found = image.pixel(x, y).unwrap();
                let (right, up) = (0.5 + 0.5 * place(x, N), 0.5 - 0.5 * place(y, N));
                let expected = DVec3::new(right, 0.5, up) * tint;
                assert!(
                    (found - expected).abs().max_element() < 1e-6,
                    "{found} for {expected} at {x} {y}: {scene}"
                );
            }
        }
    }
    // What has no colors is white, and so is a triangle that lacks one.
    let lacking = square.replace("uvs:", "colorIndices: [0, 1, 2, 0, -1, 3], uvs:");
    let image = render(&format!("{head} emission(vertexColors()); mesh({lacking});")).image;
    assert_eq!(image.pixel(1, 3).unwrap(), DVec3::ONE);
    assert!(image.pixel(14, 12).unwrap().x < 1.0);
    let image = render(&format!("{head} emission(vertexColors()); sphere(0, 0, 0, 3);")).image;
    assert_eq!(image.pixel(8, 8).unwrap(), DVec3::ONE);
}
