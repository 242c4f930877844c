//! Surfaces under a sky that is seen and shines: whatever the number of directions that are asked for light, a surface answers each
//! light once, in a mirrored ray or of itself.

#![allow(clippy::unwrap_used)]

use rtscript::{DVec3, Image, Limits, MemoryHost, NoHost, RunOptions, render::World, testing};

/// The inside of a ball's outline, `n` x `n` directions of a sky that is 1 everywhere being asked for light.
fn ball(material: &str, n: u32, samples: u32) -> Image {
    rendered(material, n, samples).image
}

fn rendered(material: &str, n: u32, samples: u32) -> testing::RenderedFile {
    let scene = format!(
        "size(8, 8); samples({samples}); maxDepth(20); ambient(0, 0, 0); diffuse(0, 0, 0);\n\
         environment([1, 1, 1], #{{ n: {n} }}); camera([0, 0, 8], [0, 0, 0], [0, 1, 0], 9);\n\
         {material}\nsphere(0, 0, 0, 1);"
    );
    let (host, limits, options) = (MemoryHost::new(), Limits::default(), RunOptions::default());
    let rendered = testing::render_text("test.rhai", &scene, &host, &limits, &options);
    rendered.map_err(|e| format!("{e}\n{scene}")).unwrap()
}

fn pixels(image: &Image) -> Vec<DVec3> {
    let all = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    all.map(|(x, y)| image.pixel(x, y).unwrap()).collect()
}

/// What the surface makes of white light from everywhere, on average, and the error of that in standard deviations.
fn mean(image: &Image) -> (DVec3, f64) {
    let all = pixels(image);
    let n = all.len() as f64;
    let mean = all.iter().sum::<DVec3>() / n;
    let squares: f64 = all.iter().map(|p| (*p - mean).length_squared()).sum();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}

#[test]
fn what_mirrored_rays_see_is_answered_by_them_alone() {
    for material in [
        "reflection(0.7, 0.8, 0.9);",
        "specular(0.7, 0.8, 0.9); shininess(20);",
        "specular(0.3, 0.3, 0.3); reflection(0.6, 0.6, 0.6);",
        "reflection(1, 1, 1); roughness(0.1);",
        "reflection(1, 1, 1); roughness(0.3);",
        "reflection(1, 1, 1); roughness(1); multiscatter(true);",
        "conductor(\"gold\");",
        "conductor(\"gold\"); roughness(0.4);",
        "conductor(\"copper\"); roughness(0.3); clearCoat(0.5, 0.2);",
        "clearCoat(1, 0);",
        "clearCoat(1, 0.3);",
        "fresnel(true);",
        "fresnel(true); specular(1, 1, 1); shininess(10);",
        "fresnel(true); roughness(0.3);",
        "transmission(1, 1, 1); fresnel(true);",
        "transmission(1, 1, 1); fresnel(true); roughness(0.3);",
        "reflection(1, 1, 1); roughness(0.5); bump(granite(#{ scale: 0.2 }), 0.02);",
    ] {
        let [seen, few, many] = [0, 2, 8].map(|n| pixels(&ball(material, n, 4)));
        assert_eq!(seen, few, "{material}");
        assert_eq!(seen, many, "{material}");
        let (sum, error) = mean(&ball(material, 2, 4));
        assert!(sum.max_element() <= 1.0 + 3.0 * error + 1e-9, "{material} {sum}");
        // A mirror of a sky that is 1 has no spark in it. (What is given back of many reflections is spread over few.)
        let brightest = seen.iter().copied().fold(DVec3::ZERO, DVec3::max);
        let is_single = !material.contains("multiscatter");
        assert!(
            !is_single || brightest.max_element() <= 1.0 + 1e-9,
            "{material} {brightest}"
        );
    }
}

#[test]
fn what_no_ray_is_followed_for_does_not_depend_on_how_many_directions_are_asked() {
    for (material, most) in [
        ("diffuse(0.9, 0.6, 0.3);", 0.9),
        ("diffuse(1, 1, 1); orenNayar(30);", 1.0),
        (
            "diffuse(0.4, 0.4, 0.4); specular(0.5, 0.5, 0.5); shininess(20);",
            0.9,
        ),
        (
            "diffuse(0.4, 0.4, 0.4); specular(0.5, 0.5, 0.5); shininess(20); reflection(0, 0, 0);",
            0.9,
        ),
        (
            "diffuse(0.4, 0.4, 0.4); specular(0.5, 0.5, 0.5); shininess(20); reflection(0.2, 0.2, 0.2);",
            0.9,
        ),
        ("diffuse(1, 1, 1); fresnel(true);", 1.0),
        ("diffuse(1, 1, 1); fresnel(true); roughness(0.3);", 1.0),
        ("diffuse(0.8, 0.1, 0.1); clearCoat(1, 0.2);", 0.9),
        ("diffuse(0.8, 0.1, 0.1); orenNayar(40); clearCoat(1, 0);", 0.9),
    ] {
        let ((few, error), (many, other)) = (mean(&ball(material, 2, 24)), mean(&ball(material, 8, 3)));
        let difference = (few - many).abs().max_element();
        assert!(
            difference < 4.0 * (error + other) + 1e-3,
            "{material} {few} with 2 x 2 directions, {many} with 8 x 8"
        );
        assert!(many.max_element() < most + 0.02, "{material} {many}");
    }
}

#[test]
fn a_highlight_without_a_mirror_shows_the_sky_and_one_with_it_what_is_left() {
    let bright = |mirror: f64| {
        let material =
            format!("specular(0.5, 0.5, 0.5); shininess(20); reflection({mirror}, {mirror}, {mirror});");
        let [seen, lit] = [0, 4].map(|n| mean(&ball(&material, n, 8)).0.x);
        assert!((seen - mirror).abs() < 1e-9, "{mirror}: {seen}");
        lit - seen
    };
    let (alone, beside, whole) = (bright(0.0), bright(0.25), bright(0.5));
    assert!(
        alone > 0.1 && (beside - 0.5 * alone).abs() < 1e-9,
        "{alone} {beside}"
    );
    assert_eq!(whole, 0.0);
}

#[test]
fn an_explanation_has_the_sky_where_it_is_asked() {
    for (material, terms) in [
        ("reflection(1, 1, 1); roughness(0.3);", 0),
        ("specular(1, 1, 1);", 0),
        ("diffuse(1, 1, 1); clearCoat(1, 0.3);", 1),
        ("specular(1, 1, 1); reflection(0.5, 0.5, 0.5);", 1),
    ] {
        let rendered = rendered(material, 2, 1);
        let world = World::compile(&rendered.scene).unwrap();
        let explained = world.explain(4, 4, &NoHost).unwrap();
        let hit = explained.samples[0].rays[0].hit.as_ref().unwrap();
        assert_eq!(hit.lights.len(), terms, "{material}");
        assert_eq!(explained.value, rendered.image.pixel(4, 4).unwrap(), "{material}");
        assert_eq!(explained.samples[0].sum(), explained.value, "{material}");
    }
}

#[test]
fn lamps_that_no_ray_meets_keep_their_highlights() {
    let lit = |lamp: &str| {
        let material = format!("{lamp}; reflection(1, 1, 1); roughness(0.4);");
        let seen = pixels(&ball(&material, 2, 1));
        let dark = pixels(&ball("reflection(1, 1, 1); roughness(0.4);", 2, 1));
        seen.iter()
            .zip(&dark)
            .map(|(a, b)| (*a - *b).x)
            .fold(0.0, f64::max)
    };
    for lamp in [
        "light([0, 0, 9], [1, 1, 1])",
        "directional([0, 0, 1], [1, 1, 1])",
        "sphereLight([0, 0, 9], 0.5, [1, 1, 1], 2)",
        "areaLight([-1, -1, 9], [2, 0, 0], [0, 2, 0], [1, 1, 1], 2)",
    ] {
        assert!(lit(lamp) > 1.0, "{lamp}: {}", lit(lamp));
    }
}
