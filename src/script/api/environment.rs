//! Light from all around, and what is in the air.

use std::sync::Arc;

use rhai::{Dynamic, Map};

use super::{
    assets::picture,
    color, int,
    lamps::{number_or, options},
    map, number, vec3,
};
use crate::{
    color::Color,
    render::daylight::sunlight,
    scene::{Environment, Fog, Haze, Occlusion, Sky, Sun, Texture},
    script::{
        call::{Call, TermValue, number_of, texture_of},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
};

const ENVIRONMENT_OPTIONS: [&str; 3] = ["n", "rotation", "strength"];
const SKY_OPTIONS: [&str; 6] = ["ground", "horizon", "n", "rotation", "strength", "zenith"];
const DAYLIGHT_OPTIONS: [&str; 5] = ["ground", "n", "rotation", "strength", "sun"];
const FOG_OPTIONS: [&str; 2] = ["base", "height"];
const HAZE_OPTIONS: [&str; 4] = ["albedo", "density", "forward", "n"];

/// Half the sun's diameter in the sky, in degrees.
const SUN_ANGLE: f64 = 0.2666;

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lights, "environment", environment)
        .takes(&[&[
            Param::new("look", Kind::Any, "none", "a picture of all directions (equirectangular), as the name of a Radiance (.hdr), PNG or JPEG file or as an image, or a color"),
            map("options", "strength: a number or color it is multiplied by, 1 unless given; rotation: degrees around Y, counter-clockwise seen from above; n: n x n directions that each point asks for light, 4 unless given, 0 for a picture that does not shine")
                .keys(&ENVIRONMENT_OPTIONS)
                .or("#{}"),
        ]])
        .doc("Light from all around, in place of the background: rays that leave the scene see it, and surfaces are lit by it, with soft shadows; half of the directions are taken where it is bright. What a surface mirrors it sees as it sees other things, so of Ks only what Kr leaves shows the environment as highlights. The middle of the picture is -Z, its right half +X, its top +Y. White from everywhere gives white on a white surface in the open.")
        .usage("environment([0.8, 0.9, 1], #{ n: 4 })")
        .example("samples(4);\nsampler(\"sobol\");\ncamera([0, 2, 6], [0, 0.8, 0], [0, 1, 0], 36);\nlet room = image(#{ width: 4, height: 3, pixels: [[0.9, 0.9, 1], [0.9, 0.9, 1], [4, 3, 2], [0.9, 0.9, 1], [0.4, 0.5, 0.8], [0.4, 0.5, 0.8], [3, 2, 1], [0.4, 0.5, 0.8], [0.2, 0.15, 0.1], [0.2, 0.15, 0.1], [0.2, 0.15, 0.1], [0.2, 0.15, 0.1]] });\nenvironment(room, #{ strength: 0.5, rotation: 40, n: 3 });\nambient(0, 0, 0);\ndiffuse(0.8, 0.8, 0.75);\nplane();\ndiffuse(0.8, 0.3, 0.2);\nsphere(-0.9, 0.8, 0, 0.8);\ndiffuse(0, 0, 0); specular(0.9, 0.9, 0.9); shininess(400);\nsphere(0.9, 0.8, 0, 0.8);")
        .also(&["environmentMap", "envmap", "hdri", "ibl", "skybox", "dome light", "sky_sphere", "imageLight", "world"]),
    Entry::scene(Group::Lights, "sky", sky)
        .takes(&[&[map("look", "zenith, horizon, ground: colors straight up, above the horizon and below it, unless given [0.25, 0.45, 0.9], [0.85, 0.9, 1] and [0.3, 0.28, 0.25]; strength, rotation and n as for environment")
            .keys(&SKY_OPTIONS)
            .or("#{}")]])
        .doc("An environment that goes from the horizon's color up to the zenith's, evenly by the sine of the height, and is of the ground's color below.")
        .usage("sky(#{ zenith: [0.2, 0.4, 0.9], horizon: [1, 1, 1] })")
        .example("samples(4);\nsampler(\"sobol\");\ncamera([0, 2, 6], [0, 0.8, 0], [0, 1, 0], 36);\nsky(#{ zenith: [0.15, 0.3, 0.8], horizon: [1, 0.75, 0.5], ground: [0.2, 0.2, 0.2], n: 3 });\nambient(0, 0, 0);\ndiffuse(0.8, 0.8, 0.75);\nplane();\ndiffuse(0.8, 0.8, 0.8);\nsphere(-0.9, 0.8, 0, 0.8);\ndiffuse(0, 0, 0); specular(0.9, 0.9, 0.9); shininess(400);\nsphere(0.9, 0.8, 0, 0.8);")
        .also(&["skydome", "gradientSky", "hemisphereLight", "HemisphereLight", "skyLight"]),
    Entry::scene(Group::Lights, "daylight", daylight)
        .takes(&[&[
            vec3("direction", "none", "points to the sun, not below the horizon; Y is up"),
            number("turbidity", "none", "haziness of the air, 1.7 to 10: 2 is very clear, 6 hazy").or("3"),
            map("options", "sun: whether the sun itself shines, too, true unless given; ground: the color below the horizon; strength, rotation (of the sky without the sun) and n as for environment")
                .keys(&DAYLIGHT_OPTIONS)
                .or("#{}"),
        ]])
        .doc("A clear sky by Preetham, Shirley and Smits (1999) as the environment, and its sun as a directional light with soft shadows, in the colors that the air leaves of it. A white floor under a high sun has about 1; the sun's disk itself is not seen.")
        .usage("daylight([1, 1, 0.5], 3)")
        .example("samples(4);\nsampler(\"sobol\");\ncamera([0, 2, 6], [0, 0.8, 0], [0, 1, 0], 36);\ndaylight([-1, 0.35, 0.4], 4, #{ n: 2 });\nambient(0, 0, 0);\ndiffuse(0.7, 0.7, 0.65);\nplane();\ndiffuse(0.8, 0.8, 0.8);\nsphere(-0.9, 0.8, 0, 0.8);\ndiffuse(0.05, 0.05, 0.05); specular(0.8, 0.8, 0.8); shininess(400);\nsphere(0.9, 0.8, 0, 0.8);")
        .also(&["sunSky", "sunsky", "preetham", "nishita", "hosek", "skyTexture", "sun and sky"]),
    Entry::scene(Group::Lights, "ambientOcclusion", ambient_occlusion)
        .takes(&[&[
            number("distance", "world units", "how far away what is in the way still counts, greater than 0"),
            int("n", "rays per edge", "n x n rays from each point, 1 to 256").or("4"),
        ]])
        .doc("Darkens the ambient color in corners and under things: to the share of the half sphere above a point, weighted by the cosine, in which nothing is nearer than the distance. Without this call the ambient color is the same everywhere. The last call counts.")
        .usage("ambientOcclusion(1, 4)")
        .example("camera([0, 2.5, 6], [0, 0.6, 0], [0, 1, 0], 36);\nbackground(\"#cfe3f5\");\nambientOcclusion(1.2, 5);\nambient(0.75, 0.75, 0.75);\nplane();\ngroup { translate(0, 1, -1); box(5, 2, 0.2); }\nfor x in -1..2 { sphere(x * 1.2, 0.55, 0, 0.55); }")
        .also(&["ao", "ssao", "occlusion", "cavity"]),
    Entry::scene(Group::Lights, "fog", fog)
        .takes(&[&[
            color("color", "what everything fades to"),
            number("distance", "world units", "where 1 / e, some 37 %, is still seen, greater than 0"),
            map("options", "height: world units upwards until the fog is 1 / e as dense; base: the y where the distance counts, 0 unless given").keys(&FOG_OPTIONS).or("#{}"),
        ]])
        .doc("Fog of a color of its own, whatever lights there are: of what lies at distance d there is seen exp(-d / distance). It takes no light from lamps and shows no beams; haze does. Inside of transparent things there is none. The last call counts.")
        .usage("fog([0.7, 0.75, 0.8], 20)")
        .example("camera([0, 1.6, 6], [0, 1, 0], [0, 1, 0], 40);\nbackground(\"#b8c4cc\");\nfog(\"#b8c4cc\", 14);\nambient(0.1, 0.1, 0.1);\ndirectional([2, 4, 3], [0.8, 0.8, 0.8]);\ndiffuse(0.5, 0.55, 0.4);\nplane();\ndiffuse(0.6, 0.3, 0.2);\nfor z in 0..9 { for s in [-1, 1] { group { translate(s * 1.4, 1, 3 - z * 3); cylinder(0.25, 2); } } }")
        .also(&["mist", "groundFog", "depthCue", "atmosphere"]),
    Entry::scene(Group::Lights, "haze", haze)
        .takes(&[&[map("air", "density: what is lost of light for each world unit, for short ways; albedo: the share of it that is scattered, 1 unless given; forward: mean cosine of the angle it is scattered by, -0.99 to 0.99, 0 unless given; n: places along each ray that are asked for light, 8 unless given")
            .keys(&HAZE_OPTIONS)]])
        .doc("Air in which light is seen: beams of spots, halos of lamps, shafts between shadows. It leaves exp(-density d) of all light after d world units, and scatters what it takes once (Henyey and Greenstein); light from infinitely far away arrives everywhere as it is. Inside of transparent things there is none. The last call counts.")
        .usage("haze(#{ density: 0.1, n: 8 })")
        .example("camera([0, 2, 8], [0, 1.7, 0], [0, 1, 0], 36);\nhaze(#{ density: 0.07, n: 24 });\nambient(0.01, 0.01, 0.01);\ndiffuse(0.7, 0.7, 0.7);\nplane();\nspot([-2.5, 4, 0], [-0.5, 0, 0], [5, 1.6, 1], 14, #{ penumbra: 5 });\nspot([2.5, 4, 0], [0.5, 0, 0], [1, 2, 5], 14, #{ penumbra: 5 });\ndiffuse(0.9, 0.9, 0.9);\nsphere(0, 0.8, 0, 0.6);")
        .also(&["volumetric", "god rays", "light shafts", "scatteringMedia", "participating media", "godrays", "media", "volume"]),
];

/// A number for all three channels or a color.
fn strength(call: &Call<'_, '_>, options: &Map) -> Outcome<Color> {
    match options.get("strength") {
        None => Ok(Color::ONE),
        Some(given) => match number_of(given) {
            Some(_) => Ok(Color::splat(call.number_from("strength", given)?)),
            None => plain_color(call, "strength", given),
        },
    }
}

fn plain_color(call: &Call<'_, '_>, key: &str, given: &Dynamic) -> Outcome<Color> {
    match call.term_from(key, given)? {
        TermValue { color, texture: None } => Ok(color),
        _ => Err(call.wrong_kind(key, "a color", given)),
    }
}

fn color_or(call: &Call<'_, '_>, options: &Map, key: &str, default: Color) -> Outcome<Color> {
    let given = options.get(key);
    given.map_or(Ok(default), |given| plain_color(call, key, given))
}

/// A whole number of an option.
fn count_or(call: &Call<'_, '_>, options: &Map, key: &str, default: u32) -> Outcome<u32> {
    let given = options.get(key);
    given.map_or(Ok(default), |given| call.count_from(key, given, 0))
}

/// Takes an environment of this look, with the options that all have.
fn surround(call: &Call<'_, '_>, state: &mut State, sky: Sky, tint: Color, options: &Map) -> Outcome {
    let strength = strength(call, options)? * tint;
    let rotation = number_or(call, options, "rotation", 0.0)?;
    let n = count_or(call, options, "n", Environment::POINTS)?;
    let environment = Environment::new(sky, strength, rotation, n)?;
    state.builder.environment(Some(environment))?;
    DONE
}

fn environment(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let options = options(call, &ENVIRONMENT_OPTIONS)?;
    call.end()?;
    let is_code = |text: &str| text.starts_with('#');
    let file = given
        .clone()
        .into_immutable_string()
        .ok()
        .filter(|text| !is_code(text));
    let (texture, tint) = match (file, texture_of(given)) {
        (Some(file), _) => {
            let picture = picture(call, state, &file)?;
            (Some(Arc::clone(picture.texture())), Color::ONE)
        }
        (None, Some(TermValue { color, texture })) => (texture, color),
        (None, None) => (None, Color::ONE),
    };
    let sky = match texture {
        Some(texture) if matches!(*texture, Texture::Image(_)) => Sky::Image(state.builder.texture(&texture)),
        Some(_) => return Err(call.wrong_kind("look", "a picture or a color", given)),
        None => {
            let color = plain_color(call, "look", given)?;
            Sky::Gradient {
                zenith: color,
                horizon: color,
                ground: color,
            }
        }
    };
    surround(call, state, sky, tint, &options)
}

fn sky(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let options = options(call, &SKY_OPTIONS)?;
    call.end()?;
    let look = Sky::Gradient {
        zenith: color_or(call, &options, "zenith", Color::new(0.25, 0.45, 0.9))?,
        horizon: color_or(call, &options, "horizon", Color::new(0.85, 0.9, 1.0))?,
        ground: color_or(call, &options, "ground", Color::new(0.3, 0.28, 0.25))?,
    };
    surround(call, state, look, Color::ONE, &options)
}

fn daylight(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let sun = call.vec3("direction")?;
    let turbidity = match call.peek() {
        Some(next) if number_of(next).is_some() => call.number("turbidity")?,
        _ => 3.0,
    };
    let options = options(call, &DAYLIGHT_OPTIONS)?;
    call.end()?;
    let shines = match options.get("sun") {
        None => true,
        Some(given) => given
            .as_bool()
            .map_err(|_| call.wrong_kind("sun", "true or false", given))?,
    };
    let ground = color_or(call, &options, "ground", Color::new(0.2, 0.19, 0.18))?;
    let look = Sky::Daylight {
        sun,
        turbidity,
        ground,
    };
    let made = surround(call, state, look, Color::ONE, &options);
    if made.is_ok() && shines {
        let light = Sun::new(sun, SUN_ANGLE, Environment::POINTS)?;
        let color = sunlight(sun, turbidity) * strength(call, &options)?;
        // The sky is not turned by the current matrix, so neither is its sun.
        state.builder.push_transform()?;
        state.builder.load_identity();
        let shone = state.builder.sun(light, color);
        state.builder.pop_transform()?;
        shone?;
    }
    made
}

fn ambient_occlusion(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let distance = call.number("distance")?;
    let n = if call.rest() > 0 { call.count("n", 1)? } else { 4 };
    call.end()?;
    let occlusion = Occlusion::new(distance, n)?;
    state.builder.ambient_occlusion(Some(occlusion));
    DONE
}

fn fog(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (color, distance) = (call.color("color")?, call.number("distance")?);
    let options = options(call, &FOG_OPTIONS)?;
    call.end()?;
    let base = number_or(call, &options, "base", 0.0)?;
    let height = options.get("height");
    let height = height
        .map(|given| call.number_from("height", given))
        .transpose()?;
    if height.is_none() && options.contains_key("base") {
        return Err(call
            .error("base is for fog with a height")
            .hint("for example fog([0.7, 0.75, 0.8], 20, #{ base: 0, height: 3 })"));
    }
    state.builder.fog(Some(Fog::new(color, distance, base, height)?));
    DONE
}

fn haze(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let options = options(call, &HAZE_OPTIONS)?;
    call.end()?;
    let Some(density) = options.get("density") else {
        return Err(call
            .error("the map needs density")
            .hint(format!("for example {}", call.entry.usage)));
    };
    let density = call.number_from("density", density)?;
    let albedo = match options.get("albedo") {
        Some(given) if number_of(given).is_some() => Color::splat(call.number_from("albedo", given)?),
        _ => color_or(call, &options, "albedo", Color::ONE)?,
    };
    let forward = number_or(call, &options, "forward", 0.0)?;
    let n = count_or(call, &options, "n", 8)?;
    state.builder.haze(Some(Haze::new(density, albedo, forward, n)?));
    DONE
}
