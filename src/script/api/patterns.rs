//! Patterns, layers and pictures laid on shapes.

use std::sync::Arc;

use rhai::{Array, Dynamic, Map};

use super::{map, string, term};
use crate::{
    color::Color,
    math::DVec3,
    scene::{
        ColorMap, Interpolation, Laying, MappedImage, Mapping, Paint, Pattern, PatternKind, Placement,
        Texture, TextureFilter, Wave, Wrap,
    },
    script::{
        call::{Call, TermValue, kind_of, number_of, quoted},
        session::State,
        table::{Entry, Group},
        value::{Outcome, TextureValue},
    },
};

/// Keys of every pattern.
const KEYS: [&str; 20] = [
    "colors",
    "detail",
    "frequency",
    "from",
    "gain",
    "interpolate",
    "jitter",
    "lacunarity",
    "mortar",
    "octaves",
    "phase",
    "rotate",
    "scale",
    "size",
    "to",
    "translate",
    "turbulence",
    "variation",
    "wave",
    "width",
];

/// Keys of a placement.
const PLACES: [&str; 5] = ["octaves", "rotate", "scale", "translate", "turbulence"];

/// Keys of a picture laid on a shape.
pub(super) const LAYING: [&str; 9] = [
    "blend",
    "filter",
    "mapping",
    "octaves",
    "rotate",
    "scale",
    "translate",
    "turbulence",
    "wrap",
];

const OPTIONS: &str = "colors: a list of colors or textures at equal distances, or of [place, color] with places from 0 to 1; \
    interpolate: \"linear\", \"oklab\" or \"none\"; scale, rotate (degrees about x, y, z) and translate: where it lies in the \
    shape's space; turbulence and octaves: how it is stirred; wave (\"clamp\", \"ramp\", \"triangle\", \"sine\"), frequency and \
    phase: how often the colors come; detail, lacunarity, gain: of noise in octaves; jitter: of cells; width: of dots and lines; \
    size, mortar, variation: of bricks; from, to: of a linear gradient";

macro_rules! named {
    ($name:literal, $run:ident, $doc:literal, $usage:literal, $example:expr, $also:expr) => {
        Entry::pure(Group::Materials, $name, $run)
            .takes(&[&[], &[map("options", OPTIONS).keys(&KEYS)]])
            .returns("texture")
            .doc($doc)
            .usage($usage)
            .example($example)
            .also($also)
    };
}

macro_rules! on_two {
    ($first:literal, $second:literal) => {
        concat!(
            "background(\"#cfe3f5\");\nambient(0.06, 0.06, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(",
            $first,
            ");\nsphere(-1.2, 0, 0, 1);\ndiffuse(",
            $second,
            ");\ngroup { translate(1.2, 0, 0); rotate(0, 1, 0, 30); scale(1.5, 1.5, 1.5); box(); }"
        )
    };
}

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Materials, "pattern", pattern)
        .takes(&[
            &[string("kind", "angular, brick, cells, checker, cracks, dots, fbm, granite, grid, hexagon, linear, marble, noise, onion, radial, ripples, simplex, spherical, stripes, turbulence, wood or worley")],
            &[
                string("kind", "as above"),
                map("options", OPTIONS).keys(&KEYS),
            ],
        ])
        .returns("texture")
        .doc("A texture from a pattern in the shape's own space: a number from 0 to 1 at each point, looked up in colors. It stands wherever a color of a material may, and among the colors of another pattern.")
        .usage("pattern(\"hexagon\", #{ colors: [\"#fff\", \"#c80\", \"#222\"], scale: 0.2 })")
        .example("background(\"#cfe3f5\");\nambient(0.06, 0.06, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet kinds = [\"hexagon\", \"dots\", \"onion\", \"worley\", \"cracks\", \"cells\", \"simplex\", \"ripples\"];\nfor i in 0..8 {\n  diffuse(pattern(kinds[i], #{ scale: 0.25 }));\n  sphere((i % 4 - 1.5) * 1.1, 0.6 - 1.2 * (i / 4), 0, 0.5);\n}")
        .also(&["pigment", "voronoi", "crackle", "bozo", "leopard", "proceduralTexture", "colorRamp"]),
    named!("marble", marble, "Marble: bands along the x axis, up and down, stirred by turbulence 0.7.",
        "marble(#{ colors: [\"#fff\", \"#888\", \"#222\"], scale: 0.3, turbulence: 0.6 })",
        on_two!("marble()", "marble(#{ colors: [\"#123\", \"#2a6f6a\", \"#e8d8a0\"], scale: 0.3, rotate: [0, 0, 60] })"),
        &["veins", "agate"]),
    named!("wood", wood, "Wood: rings about the y axis, a little stirred; rotate lays the trunk down.",
        "wood(#{ scale: 0.15, rotate: [90, 0, 0] })",
        on_two!("wood()", "wood(#{ scale: 0.15, rotate: [80, 0, 10], turbulence: 0.15 })"),
        &["timber", "rings"]),
    named!("granite", granite, "Granite: creased noise in fine octaves.",
        "granite(#{ scale: 0.2 })",
        on_two!("granite()", "granite(#{ colors: [\"#300\", \"#a54\", \"#fca\"], scale: 0.2 })"),
        &["stone", "rock"]),
    named!("clouds", clouds, "Clouds: octaves of smooth noise from blue to white.",
        "clouds(#{ scale: 0.5, octaves: 5 })",
        on_two!("clouds(#{ scale: 0.6 })", "clouds(#{ colors: [[0.35, \"#520\"], [0.5, \"#f80\"], [0.65, \"#ff8\"]], scale: 0.3 })"),
        &["perlinNoise", "smoke"]),
    named!("brick", brick, "Bricks of size along x, y and z with mortar between them, each row moved by half a brick. The first color is the mortar's, the last a brick's; variation makes bricks differ along the colors between.",
        "brick(#{ size: [0.4, 0.15, 0.2], mortar: 0.02, variation: 0.5 })",
        on_two!("brick(#{ scale: 0.6, variation: 1 })", "brick(#{ scale: 0.5, colors: [\"#ddd\", \"#357\"] })"),
        &["bricks", "wall", "masonry"]),
    named!("stripes", stripes, "Stripes across the x axis: all colors once within each unit of scale, without a transition.",
        "stripes(#{ colors: [\"#fff\", \"#c22\", \"#228\"], scale: 0.4 })",
        on_two!("stripes()", "stripes(#{ colors: [\"#fff\", \"#c22\", \"#228\"], scale: 0.4, rotate: [0, 0, 45] })"),
        &["bands", "candy"]),
    named!("gradient", gradient, "Colors from one point to another, by default from the bottom of a unit sphere to its top. pattern(\"radial\"), pattern(\"spherical\") and pattern(\"angular\") are the others.",
        "gradient(#{ colors: [\"#036\", \"#fc8\"], from: [0, -1, 0], to: [0, 1, 0] })",
        on_two!("gradient(#{ colors: [\"#036\", \"#f63\", \"#ff9\"] })", "gradient(#{ colors: [\"#0f0\", \"#f0f\"], from: [-0.5, 0, 0], to: [0.5, 0, 0], interpolate: \"oklab\" })"),
        &["linearGradient", "ramp"]),
    Entry::pure(Group::Materials, "mixed", mixed)
        .takes(&[&[
            term("a", "shows where the mask is black"),
            term("b", "shows where the mask is white"),
            term("mask", "the share of b, in each channel of its own"),
        ]])
        .returns("texture")
        .doc("A texture of two textures or colors and a mask that says where which of them shows: layers, rust on paint, moss on stone.")
        .usage("mixed(brick(), \"#3a5\", clouds())")
        .example("background(\"#cfe3f5\");\nambient(0.06, 0.06, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet moss = pattern(\"fbm\", #{ colors: [[0.45, \"#000\"], [0.55, \"#fff\"]], scale: 0.4 });\ndiffuse(mixed(brick(#{ scale: 0.6 }), \"#4a7a2a\", moss));\nsphere(-1.2, 0, 0, 1);\ndiffuse(mixed(\"#eee\", wood(), checker(\"#000\", \"#fff\", 0.5)));\nsphere(1.2, 0, 0, 1);")
        .also(&["layer", "mask", "overlay", "mixTextures"]),
    Entry::pure(Group::Materials, "placed", placed)
        .takes(&[&[
            term("texture", "any texture"),
            map("options", "scale: a number or three; rotate: degrees about x, y and z; translate; turbulence and octaves: how it is stirred").keys(&PLACES),
        ]])
        .returns("texture")
        .doc("A texture scaled, then turned, then moved in the shape's space, and stirred by turbulence. Of a picture, texture coordinates take the place of x and y.")
        .usage("placed(checker(\"#fff\", \"#000\", 1), #{ scale: 0.3, rotate: [0, 45, 0], turbulence: 0.2 })")
        .example("background(\"#cfe3f5\");\nambient(0.06, 0.06, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet squares = checker(\"#fff\", \"#246\", 0.4);\ndiffuse(placed(squares, #{ rotate: [30, 45, 0] }));\nsphere(-1.2, 0, 0, 1);\ndiffuse(placed(squares, #{ turbulence: 0.5, octaves: 3 }));\nsphere(1.2, 0, 0, 1);")
        .also(&["warp", "distort", "textureTransform"]),
];

/// The texture that a script gets.
pub(super) fn texture_value(texture: Texture) -> Dynamic {
    Dynamic::from(TextureValue {
        texture: Arc::new(texture),
        tint: Color::ONE,
    })
}

fn paint(value: TermValue) -> Paint {
    Paint {
        color: value.color,
        texture: value.texture,
    }
}

/// The options map, where one is given.
pub(super) fn options<'c>(call: &mut Call<'c, '_>, known: &[&str]) -> Outcome<Map> {
    if call.rest() == 0 {
        return Ok(Map::new());
    }
    let given = call.any()?;
    call.end()?;
    let Some(map) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map #{ }", given));
    };
    call.known_keys(&map, known)?;
    Ok(map.clone())
}

fn pattern(call: &mut Call<'_, '_>) -> Outcome {
    let name = call.string("kind")?;
    let Some((_, kind)) = PatternKind::ALL.iter().find(|(known, _)| *known == name.as_str()) else {
        let names: Vec<&str> = PatternKind::ALL.iter().map(|(name, _)| *name).collect();
        return Err(choice_error(call, "kind", &name, &names));
    };
    make(call, *kind)
}

macro_rules! kinds {
    ($($name:ident = $kind:ident;)*) => {
        $(fn $name(call: &mut Call<'_, '_>) -> Outcome {
            make(call, PatternKind::$kind)
        })*
    };
}

kinds! {
    marble = Marble;
    wood = Wood;
    granite = Granite;
    clouds = Fbm;
    brick = Brick;
    stripes = Stripes;
    gradient = Linear;
}

fn make(call: &mut Call<'_, '_>, kind: PatternKind) -> Outcome {
    let map = options(call, &KEYS)?;
    let mut p = Pattern::new(kind);
    // The colors come after the way they are gone through.
    let mut way = p.colors.interpolation();
    for (key, value) in &map {
        match key.as_str() {
            "interpolate" => way = choice(call, key, value, &Interpolation::ALL)?,
            "wave" => p.wave = choice(call, key, value, &Wave::ALL)?,
            "frequency" => p.frequency = call.number_from(key, value)?,
            "phase" => p.phase = call.number_from(key, value)?,
            "detail" => p.detail.count = call.count_from(key, value, 1)?,
            "lacunarity" => p.detail.lacunarity = call.number_from(key, value)?,
            "gain" => p.detail.gain = call.number_from(key, value)?,
            "jitter" => p.jitter = call.number_from(key, value)?,
            "width" => p.width = call.number_from(key, value)?,
            "size" => p.size = call.vec3_from(key, value)?,
            "mortar" => p.mortar = call.number_from(key, value)?,
            "variation" => p.variation = call.number_from(key, value)?,
            "from" => p.from = call.vec3_from(key, value)?,
            "to" => p.to = call.vec3_from(key, value)?,
            "colors" => {}
            _ => place(call, &mut p.placement, key, value)?,
        }
    }
    // Of noise that is not stirred, octaves can only mean the noise.
    let is_noise = matches!(
        kind,
        PatternKind::Fbm | PatternKind::Turbulence | PatternKind::Granite
    );
    if is_noise
        && !map.contains_key("turbulence")
        && !map.contains_key("detail")
        && map.contains_key("octaves")
    {
        p.detail.count = p.placement.octaves;
        p.placement.octaves = Placement::default().octaves;
    }
    p.colors = match map.get("colors") {
        Some(given) => colors(call, given, way)?,
        None => ColorMap::new(p.colors.entries().to_vec(), way)?,
    };
    Ok(texture_value(Texture::pattern(p)?))
}

/// Sets a part of a placement.
fn place(call: &Call<'_, '_>, placement: &mut Placement, key: &str, value: &Dynamic) -> Outcome<()> {
    match key {
        "scale" => {
            placement.scale = match number_of(value) {
                Some(_) => DVec3::splat(call.number_from(key, value)?),
                None => call.vec3_from(key, value)?,
            }
        }
        "rotate" => placement.rotate = call.vec3_from(key, value)?,
        "translate" => placement.translate = call.vec3_from(key, value)?,
        "turbulence" => placement.turbulence = call.number_from(key, value)?,
        _ => placement.octaves = call.count_from(key, value, 1)?,
    }
    Ok(())
}

/// A word that stands for something.
pub(super) fn choice<T: Copy>(
    call: &Call<'_, '_>,
    name: &str,
    value: &Dynamic,
    all: &[(&str, T)],
) -> Outcome<T> {
    let Ok(word) = value.clone().into_immutable_string() else {
        return Err(call.wrong_kind(name, "a string", value));
    };
    if let Some((_, found)) = all.iter().find(|(known, _)| *known == word.as_str()) {
        return Ok(*found);
    }
    let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
    Err(choice_error(call, name, &word, &names))
}

#[cold]
pub(super) fn choice_error(
    call: &Call<'_, '_>,
    name: &str,
    given: &str,
    all: &[&str],
) -> Box<crate::script::value::ScriptError> {
    let error = call.error(format!(
        "{name} must be one of {}, not {}",
        all.join(", "),
        quoted(given)
    ));
    match crate::diag::nearest_names(given, all.iter().copied()).first() {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None => error,
    }
}

/// A list of colors, or of pairs of a place and a color.
fn colors(call: &Call<'_, '_>, given: &Dynamic, way: Interpolation) -> Outcome<ColorMap> {
    let Some(list) = given.read_lock::<Array>() else {
        return Err(call
            .error(format!("colors must be a list, not {}", kind_of(given)))
            .hint("for example colors: [\"#fff\", \"#888\"] or colors: [[0, \"#fff\"], [0.3, \"#888\"], [1, \"#222\"]]"));
    };
    let (mut placed, mut even) = (Vec::new(), Vec::new());
    for (i, entry) in list.iter().take(ColorMap::MAX_ENTRIES + 1).enumerate() {
        let pair = entry.read_lock::<Array>().filter(|pair| pair.len() == 2);
        let name = format!("colors[{i}]");
        match pair.as_deref().map(Vec::as_slice) {
            Some([at, color]) => {
                let at = call.number_from(&format!("{name}[0]"), at)?;
                placed.push((at, paint(call.term_from(&format!("{name}[1]"), color)?)));
            }
            _ => even.push(paint(call.term_from(&name, entry)?)),
        }
    }
    if !placed.is_empty() && !even.is_empty() {
        return Err(call
            .error("colors must have a place each, or none of them")
            .hint("for example colors: [[0, \"#fff\"], [0.3, \"#888\"], [1, \"#222\"]]"));
    }
    Ok(if placed.is_empty() {
        ColorMap::even(even, way)?
    } else {
        ColorMap::new(placed, way)?
    })
}

fn mixed(call: &mut Call<'_, '_>) -> Outcome {
    let a = paint(call.term("a")?);
    let b = paint(call.term("b")?);
    let mask = paint(call.term("mask")?);
    call.end()?;
    Ok(texture_value(Texture::mix(a, b, mask)?))
}

fn placed(call: &mut Call<'_, '_>) -> Outcome {
    let texture = paint(call.term("texture")?);
    let map = options(call, &PLACES)?;
    let mut placement = Placement::default();
    for (key, value) in &map {
        place(call, &mut placement, key, value)?;
    }
    Ok(texture_value(Texture::placed(texture, placement)?))
}

/// A picture laid on a shape as options say.
pub(super) fn laid(call: &Call<'_, '_>, state: &mut State, image: Arc<Texture>, options: &Map) -> Outcome {
    call.known_keys(options, &LAYING)?;
    let mut laying = Laying::default();
    for (key, value) in options {
        match key.as_str() {
            "mapping" => laying.mapping = choice(call, key, value, &Mapping::ALL)?,
            "filter" => laying.filter = choice(call, key, value, &TextureFilter::ALL)?,
            "wrap" => laying.wrap = choice(call, key, value, &Wrap::ALL)?,
            "blend" => laying.blend = call.number_from(key, value)?,
            _ => place(call, &mut laying.placement, key, value)?,
        }
    }
    let of = Arc::clone(&image);
    if let (TextureFilter::Mip, Texture::Image(picture)) = (laying.filter, &*of) {
        state.assets.count_copies(&of, picture, &state.limits)?;
    }
    let mapped = MappedImage::with_copies(image, laying, |image| state.assets.pyramid(&of, image))?;
    Ok(texture_value(Texture::Mapped(Box::new(mapped))))
}
