//! Ways to say a color.

use rhai::Dynamic;

use super::{color as color_param, number, vec3};
use crate::{
    color,
    math::{self, DVec3, PI},
    script::{
        call::Call,
        table::{Entry, Group},
        value::Outcome,
    },
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Materials, "hsl", hsl)
        .takes(&[&[
            number("hue", "degrees", "0 red, 120 green, 240 blue, and so on around"),
            number("saturation", "none", "0 gray to 1 full"),
            number("lightness", "none", "0 black, 0.5 full color, 1 white"),
        ]])
        .returns("vec3")
        .doc("A color by hue, saturation and lightness, as in style sheets of web pages.")
        .usage("hsl(200, 0.8, 0.5)")
        .example("background(\"#222\");\nlight([0, 0, 8], [1, 1, 1]);\nambient(0, 0, 0);\nfor i in 0..12 {\n  for j in 1..5 {\n    diffuse(hsl(i * 30, 0.8, j / 5.0));\n    group { rotate(0, 0, 1, i * 30); sphere(j * 0.42, 0, 0, 0.1 + j * 0.03); }\n  }\n}")
        .also(&["hsla", "hls"]),
    Entry::pure(Group::Materials, "oklch", oklch)
        .takes(&[&[
            number("lightness", "none", "0 black to 1 white"),
            number("chroma", "none", "0 gray to about 0.3, the strongest there is"),
            number("hue", "degrees", "20 red, 140 green, 260 blue, and so on around"),
        ]])
        .returns("vec3")
        .doc("A color by lightness, chroma and hue as the eye judges them: colors of one lightness look equally bright. What no screen can show is made as strong as one can.")
        .usage("oklch(0.7, 0.15, 250)")
        .example("background(\"#222\");\nlight([0, 0, 8], [1, 1, 1]);\nambient(0, 0, 0);\nfor i in 0..24 {\n  diffuse(oklch(0.75, 0.13, i * 15));\n  group { rotate(0, 0, 1, i * 15); sphere(1.5, 0, 0, 0.2); }\n}")
        .also(&["oklab", "lch", "lab", "perceptual"]),
    Entry::pure(Group::Materials, "mixOklab", mix_oklab)
        .takes(&[&[
            color_param("a", "the color at 0"),
            color_param("b", "the color at 1"),
            number("t", "none", "how far from a to b"),
        ]])
        .returns("vec3")
        .doc("A color between two, in steps that look even; mix(a, b, t) mixes light instead.")
        .usage("mixOklab(\"#0057ff\", \"#ffdd00\", 0.5)")
        .example("background(\"#222\");\nlight([0, 0, 8], [1, 1, 1]);\nambient(0, 0, 0);\nfor i in 0..11 {\n  diffuse(mixOklab(\"#0057ff\", \"#ffdd00\", i / 10.0));\n  sphere(i * 0.4 - 2, 0.5, 0, 0.25);\n  diffuse(mix([0, 0.09, 1], [1, 0.72, 0], i / 10.0));   // light, for comparison\n  sphere(i * 0.4 - 2, -0.5, 0, 0.25);\n}")
        .also(&["lerpColor", "blend", "gradientColor"]),
    Entry::pure(Group::Materials, "cosinePalette", cosine_palette)
        .takes(&[&[
            number("t", "none", "along the palette, 1 once around"),
            vec3("base", "linear RGB", "the middle of each channel"),
            vec3("amplitude", "linear RGB", "how far each channel goes from it"),
            vec3("frequency", "none", "how often each channel goes around while t goes from 0 to 1"),
            vec3("phase", "none", "where in its round each channel begins, from 0 to 1"),
        ]])
        .returns("vec3")
        .doc("A color of an endless palette, base + amplitude cos(2 PI (frequency t + phase)) for each channel, not below 0 (Inigo Quilez).")
        .usage("cosinePalette(0.3, [0.5, 0.5, 0.5], [0.5, 0.5, 0.5], [1, 1, 1], [0, 0.33, 0.67])")
        .example("background(\"#222\");\nlight([0, 0, 8], [1, 1, 1]);\nambient(0, 0, 0);\nfor i in 0..200 {\n  let r = 0.12 * sqrt(i);\n  let c = cosinePalette(i / 200.0, [0.5, 0.5, 0.5], [0.5, 0.5, 0.5],\n                        [1, 1, 0.5], [0.8, 0.9, 0.3]);\n  diffuse(c);\n  let a = radians(i * 137.5);\n  sphere(r * cos(a), r * sin(a), 0, 0.11);\n}")
        .also(&["palette", "iqPalette"]),
    Entry::pure(Group::Materials, "luminance", luminance)
        .takes(&[&[color_param("c", "a color")]])
        .returns("float")
        .doc("How bright a color is: 0.2126 r + 0.7152 g + 0.0722 b of its linear channels (Rec. 709).")
        .usage("luminance(\"#ff8000\")")
        .example("print(luminance(\"#ff8000\"));")
        .also(&["brightness", "gray", "grey", "lightness"]),
];

/// The double hexcone of style sheets (CSS Color 4, section 7), whose RGB is that of a screen.
fn hsl(call: &mut Call<'_, '_>) -> Outcome {
    let hue = call.number("hue")?;
    let (saturation, lightness) = (call.number("saturation")?, call.number("lightness")?);
    call.end()?;
    within_unit(call, "saturation", saturation)?;
    within_unit(call, "lightness", lightness)?;
    let twelfth = (hue / 30.0).rem_euclid(12.0);
    let a = saturation * lightness.min(1.0 - lightness);
    let channel = |n: f64| {
        let k = (n + twelfth) % 12.0;
        color::linear_from_srgb(lightness - a * (k - 3.0).min(9.0 - k).clamp(-1.0, 1.0))
    };
    Ok(Dynamic::from(DVec3::new(
        channel(0.0),
        channel(8.0),
        channel(4.0),
    )))
}

fn oklch(call: &mut Call<'_, '_>) -> Outcome {
    let (lightness, chroma) = (call.number("lightness")?, call.number("chroma")?);
    let hue = call.number("hue")?;
    call.end()?;
    within_unit(call, "lightness", lightness)?;
    within_unit(call, "chroma", chroma)?;
    Ok(Dynamic::from(color::linear_from_oklch(lightness, chroma, hue)))
}

fn within_unit(call: &Call<'_, '_>, name: &str, x: f64) -> Outcome<()> {
    if (0.0..=1.0).contains(&x) {
        return Ok(());
    }
    Err(call.error(format!("{name} must lie between 0 and 1, not {x}")))
}

fn mix_oklab(call: &mut Call<'_, '_>) -> Outcome {
    let (a, b, t) = (call.color("a")?, call.color("b")?, call.number("t")?);
    call.end()?;
    let [a, b] = [a, b].map(color::oklab_from_linear);
    let mixed = color::linear_from_oklab(a * (1.0 - t) + b * t);
    Ok(Dynamic::from(mixed.max(DVec3::ZERO)))
}

fn cosine_palette(call: &mut Call<'_, '_>) -> Outcome {
    let t = call.number("t")?;
    let (base, amplitude) = (call.vec3("base")?, call.vec3("amplitude")?);
    let (frequency, phase) = (call.vec3("frequency")?, call.vec3("phase")?);
    call.end()?;
    let turns = frequency * t + phase;
    let wave = (turns - turns.floor()).map(|turn| math::cos(2.0 * PI * turn));
    Ok(Dynamic::from((base + amplitude * wave).max(DVec3::ZERO)))
}

fn luminance(call: &mut Call<'_, '_>) -> Outcome {
    let c = call.color("c")?;
    call.end()?;
    Ok(Dynamic::from(color::luminance(c)))
}
