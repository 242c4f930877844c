//! Size, samples, which rays are followed, background, encoding, seed and the camera.

use super::{color, int, number, string, vec3};
use crate::{
    diag::{Code, nearest_names},
    math::{DVec3, brief},
    scene::{Camera, Encoding},
    script::{
        call::{Call, quoted},
        session::State,
        table::{DONE, Entry, Group},
        value::Outcome,
    },
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Camera, "size", size)
        .takes(&[&[
            int("width", "pixels", "across, at least 1"),
            int("height", "pixels", "down, at least 1"),
        ]])
        .doc("The picture's size in pixels. Default: 640 x 480. Where the command is given --size, that counts instead.")
        .usage("size(640, 480)")
        .example("size(240, 80);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nfor x in -3..4 { sphere(x * 1.7, 0, 0, 0.75); }")
        .also(&["resolution", "imageSize", "canvas", "createCanvas"]),
    Entry::scene(Group::Camera, "samples", samples)
        .takes(&[&[int("n", "rays per pixel", "1 is one ray through the center; more are jittered in strata")]])
        .doc("Rays per pixel: more of them make edges and soft shadows smooth, and take as much longer. Default: 1. Where the command is given --samples, that counts instead.")
        .usage("samples(16)")
        .example("samples(16);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ncamera([0, 1, 5], [0, 0.5, 0], [0, 1, 0], 45);\ndiffuse(checker(\"#fff\", \"#a33\", 1));\nplane();")
        .also(&["spp", "antialias", "aa"]),
    Entry::scene(Group::Camera, "maxDepth", max_depth)
        .takes(&[&[int("n", "bounces", "0 to 64")]])
        .doc("How many reflected or refracted rays in a row are followed after the camera ray; what lies behind the last is left out. Default: 5.")
        .usage("maxDepth(5)")
        .example("maxDepth(2);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.05, 0.05, 0.05);\nspecular(0.8, 0.8, 0.8);\nshininess(200);\nsphere(-1, 0, 0, 0.95);\nsphere(1, 0, 0, 0.95);\ndiffuse(0.9, 0.4, 0.1);\nspecular(0, 0, 0);\nsphere(0, -0.9, 1, 0.4);")
        .also(&["depth", "bounces", "maxBounces"]),
    Entry::scene(Group::Camera, "minWeight", min_weight)
        .takes(&[&[number("weight", "share of a pixel", "above 0, at most 1")]])
        .doc("Reflected and refracted rays are followed that count for at least this much in their pixel, in one of the three channels. Default: 2^-20, which no picture shows. 1.0 / 255, POV-Ray's adc_bailout, renders glass several times faster, and may change pixels by a few steps of 255.")
        .usage("minWeight(1.0 / 255)")
        .example("minWeight(1.0 / 255);\nmaxDepth(12);\nsamples(9);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ncamera([0, 5, 6.5], [0, 0, 0], [0, 1, 0], 30);\ndiffuse(checker(\"#f3efe6\", \"#2a6f97\", 1));\ngroup { translate(0, -1, 0); plane(); }\ndiffuse(0, 0, 0);\nspecular(0.6, 0.6, 0.6);\nshininess(200);\nreflection(0.08, 0.08, 0.08);\ntransmission(0.9, 0.9, 0.9);\nior(1.5);\nfor x in -1..2 { sphere(x * 1.9, 0, 0, 0.9); }")
        .also(&["adcBailout", "adc_bailout", "bailout", "cutoff"]),
    Entry::scene(Group::Camera, "background", background)
        .takes(&[&[color("color", "what a ray sees that leaves the scene")]])
        .doc("The color behind everything. Default: black.")
        .usage("background(0.5, 0.7, 1)")
        .example("background(\"#87ceeb\");\ndirectional([2, 4, 3], [0.8, 0.8, 0.8]);\ndiffuse(0.9, 0.9, 0.9);\nsphere(0, 0, 0, 1.3);")
        .also(&["backgroundColor", "clearColor"]),
    Entry::scene(Group::Camera, "encoding", encoding)
        .takes(&[&[string("name", "\"srgb\": the sRGB curve, rounded; \"raw\": clamped, times 255, truncated, as the CSE167 course wants it")]])
        .doc("How linear light becomes 8 bits. Default: \"srgb\".")
        .usage("encoding(\"srgb\")")
        .example("encoding(\"raw\");   // steps of equal light: dark until late\nambient(0, 0, 0);\nfor i in 0..6 {\n  let light = i / 5.0;\n  emission(light, light, light);\n  sphere(i * 0.9 - 2.25, 0, 0, 0.4);\n}")
        .also(&["gamma", "colorspace"]),
    Entry::scene(Group::Camera, "seed", seed)
        .takes(&[&[int("n", "none", "any whole number")]])
        .doc("Seeds every random choice of the renderer, and starts random() anew. Default: 0. Where the command is given --seed, that counts instead.")
        .usage("seed(42)")
        .example("seed(7);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..25 {\n  diffuse(hsv(random(360), 0.7, 0.9));\n  sphere(random(-2, 2), random(-1.5, 1.5), 0, 0.3);\n}")
        .also(&["randomSeed", "srand"]),
    Entry::scene(Group::Camera, "camera", camera)
        .takes(&[&[
            vec3("from", "world units", "where the camera stands"),
            vec3("at", "world units", "the point in the middle of the picture"),
            vec3("up", "none", "a direction that points up in the picture"),
            number("fovy", "degrees", "vertical field of view, between 0 and 180"),
        ]])
        .doc("Where the camera stands, what it looks at and how much it sees, as gluLookAt and gluPerspective have it. The last call counts. Default: from [0, 0, 5] at [0, 0, 0], up [0, 1, 0], 45 degrees. The current matrix does not move it.")
        .usage("camera([0, 1, 5], [0, 0, 0], [0, 1, 0], 45)")
        .example("camera([3, 2.5, 4], [0, 0, 0], [0, 1, 0], 35);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nbox(1.5, 1, 1);\ngroup { translate(0, -0.5, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); plane(); }")
        .also(&["gluLookAt", "perspective", "view"]),
];

fn size(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (width, height) = (call.count("width", 1)?, call.count("height", 1)?);
    call.end()?;
    let before = (state.builder.settings().width, state.builder.settings().height);
    state.builder.size(width, height)?;
    if state.size.is_some() {
        state.builder.size(before.0, before.1)?;
    }
    DONE
}

fn samples(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let n = call.count("n", 1)?;
    call.end()?;
    let before = state.builder.settings().samples;
    state.builder.samples(n)?;
    if state.samples.is_some() {
        state.builder.samples(before)?;
    }
    DONE
}

fn max_depth(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let n = call.count("n", 0)?;
    call.end()?;
    state.builder.max_depth(n)?;
    DONE
}

fn min_weight(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let weight = call.number("weight")?;
    call.end()?;
    state.builder.min_weight(weight)?;
    DONE
}

fn background(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let color = call.color("color")?;
    call.end()?;
    state.builder.background(color)?;
    DONE
}

fn encoding(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    call.end()?;
    let encoding = match name.as_str() {
        "srgb" => Encoding::Srgb,
        "raw" => Encoding::Raw,
        other => {
            let error = call.error(format!("name must be \"srgb\" or \"raw\", not {}", quoted(other)));
            return Err(match nearest_names(other, ["srgb", "raw"]).first() {
                Some(near) => error.hint(format!("did you mean \"{near}\"?")),
                None => error,
            });
        }
    };
    state.builder.encoding(encoding);
    DONE
}

fn seed(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let n = call.int("n")?.cast_unsigned();
    call.end()?;
    if state.seed.is_none() {
        state.builder.seed(n);
        state.random = super::Stream::new(n);
    }
    DONE
}

fn camera(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (eye, at, up) = (call.vec3("from")?, call.vec3("at")?, call.vec3("up")?);
    let fovy = call.number("fovy")?;
    call.end()?;
    const ORDER: &str = "the order is camera(from, at, up, fovy): are the second and the third exchanged?";
    // Directions that people take for up, where the other is no direction at all.
    let is_up = [DVec3::Y, DVec3::Z].contains(&at);
    let may_be_up = |v: DVec3| v.to_array().iter().all(|x| [-1.0, 0.0, 1.0].contains(x)) && v != DVec3::ZERO;
    let are_exchanged = is_up && !may_be_up(up) && !(0.9..1.1).contains(&up.length());
    let camera = Camera::new(eye, at, up, fovy).map_err(|e| if are_exchanged { e.hint(ORDER) } else { e })?;
    if are_exchanged {
        let (at, up) = (brief(at), brief(up));
        let message = format!(
            "the camera looks at {at}, as if that were up, and its up is {up}, as if that were a point"
        );
        state.builder.warn(Code::ExchangedArguments, message, Some(ORDER));
    }
    state.builder.view(camera)?;
    DONE
}
