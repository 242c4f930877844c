//! The material state and textures.

use std::sync::Arc;

use rhai::{Dynamic, FuncRegistration, Map, Module};

use super::{amount, color, finishes, map, number, term};
use crate::{
    color::{Color, linear_from_srgb},
    math::DVec3,
    scene::{Material, Term, Texture},
    script::{
        call::{Call, TermValue, texture_of},
        session::State,
        table::{DONE, Entry, Group},
        value::{ImageValue, Outcome, ScriptError, TextureValue},
    },
};

const KEYS: [&str; 18] = [
    "absorption",
    "ambient",
    "bump",
    "clearCoat",
    "conductor",
    "diffuse",
    "dispersion",
    "emission",
    "fresnel",
    "ior",
    "multiscatter",
    "normalMap",
    "orenNayar",
    "reflection",
    "roughness",
    "shininess",
    "specular",
    "transmission",
];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Materials, "ambient", ambient)
        .takes(&[&[term("color", "Ka: added to what the lights give")]])
        .doc("Ka: the color of a surface where no light arrives. Default: 0.2, 0.2, 0.2.")
        .usage("ambient(0.1, 0.1, 0.1)")
        .example("background(\"#cfe3f5\");\nlight([3, 5, 4], [0.7, 0.7, 0.7]);\ndiffuse(0.8, 0.3, 0.2);\nfor i in -1..2 {\n  let a = 0.15 * (i + 1);   // 0, 0.15, 0.3\n  ambient(a, a, a);\n  sphere(i * 1.7, 0, 0, 0.8);\n}"),
    Entry::scene(Group::Materials, "emission", emission)
        .takes(&[&[term("color", "Ke: added to what the lights give; components may exceed 1")]])
        .doc("Ke: the color of what glows by itself. It lights nothing else. Default: black.")
        .usage("emission(1, 0.9, 0.5)")
        .example("background(\"#1a2030\");\nlight([3, 3, 5], [0.3, 0.3, 0.4]);\ndiffuse(0.6, 0.6, 0.7);\nsphere(-1.2, 0, 0, 0.9);\nemission(1, 0.8, 0.3);\nsphere(1.2, 0, 0, 0.9);")
        .also(&["emissive", "emit", "glow"]),
    Entry::scene(Group::Materials, "diffuse", diffuse)
        .takes(&[&[term("color", "Kd: the share of the light that goes in all directions")]])
        .doc("Kd: the color under light, by Lambert's cosine. Default: black.")
        .usage("diffuse(0.8, 0.2, 0.1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nsphere(-1.2, 0, 0, 1);\ndiffuse(checker(\"#fff\", \"#246\", 0.5));\nsphere(1.2, 0, 0, 1);")
        .also(&["color", "fill", "albedo", "colour"]),
    Entry::scene(Group::Materials, "specular", specular)
        .takes(&[&[term("color", "Ks: how bright the highlight is")]])
        .doc("Ks: the highlight and, unless reflection(color) says otherwise, the mirror. Default: black.")
        .usage("specular(0.5, 0.5, 0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.7, 0.1, 0.1);\nshininess(60);\nsphere(-1.2, 0, 0, 1);\nspecular(0.4, 0.4, 0.4);\nsphere(1.2, 0, 0, 1);"),
    Entry::scene(Group::Materials, "shininess", shininess)
        .takes(&[&[amount("s", "none", "0 or greater; 10 is dull, 100 polished, 1000 a mirror's")]])
        .doc("The exponent of the half-angle highlight: the larger, the smaller the highlight. A texture makes it vary: shininess(checker([20, 20, 20], [500, 500, 500], 0.3)). Default: 1.")
        .usage("shininess(50)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.1, 0.2, 0.6);\nspecular(0.7, 0.7, 0.7);\nreflection(0, 0, 0);\nfor i in -1..2 {\n  shininess(40 * 5 ** i);   // 8, 40, 200\n  sphere(i * 1.7, 0, 0, 0.8);\n}")
        .also(&["exponent", "gloss"]),
    Entry::scene(Group::Materials, "reflection", reflection)
        .takes(&[&[term("color", "Kr: the share of what the mirror sees; black for none")]])
        .doc("Kr: the mirror's weight where it is to differ from Ks. Default: Ks.")
        .usage("reflection(0, 0, 0)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); plane(); }\ndiffuse(0.6, 0.1, 0.1);\nspecular(0.5, 0.5, 0.5);\nshininess(80);\nsphere(-1.1, 0, 0, 1);         // a mirror as strong as its highlight\nreflection(0.05, 0.05, 0.05);\nsphere(1.1, 0, 0, 1);          // hardly a mirror")
        .also(&["mirror", "reflective"]),
    Entry::scene(Group::Materials, "transmission", transmission)
        .takes(&[&[term("color", "Kt: the share of what is seen through; white for clear glass")]])
        .doc("Kt: what is seen through the surface, bent by ior(n). Default: black, opaque.")
        .usage("transmission(0.9, 0.9, 0.9)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); plane(); }\nambient(0, 0, 0);\nspecular(0.15, 0.15, 0.15);\nshininess(200);\ntransmission(0.85, 0.9, 0.85);\nior(1.5);\nsphere(0, 0.2, 0, 1.1);")
        .also(&["transparency", "refraction", "opacity", "alpha", "glass"]),
    Entry::scene(Group::Materials, "ior", ior)
        .takes(&[&[amount("n", "none", "greater than 0; water 1.33, glass 1.5, diamond 2.42")]])
        .doc("The index of refraction inside the shape, against 1 outside. A texture makes it vary over the surface. Default: 1.5.")
        .usage("ior(1.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); plane(); }\nambient(0, 0, 0);\ntransmission(0.9, 0.9, 0.9);\nior(1.1);\nsphere(-1.7, 0, 0, 0.8);\nior(1.33);   // water\nsphere(0, 0, 0, 0.8);\nior(2.42);   // diamond\nsphere(1.7, 0, 0, 0.8);")
        .also(&["refractiveIndex", "indexOfRefraction", "eta"]),
    Entry::scene(Group::Materials, "material", material)
        .takes(&[
            &[],
            &[map("options", "any of ambient, diffuse, emission, ior, reflection, shininess, specular, transmission; fresnel, conductor (a name or #{ eta, k }), roughness, multiscatter, orenNayar, clearCoat (#{ strength, roughness }), absorption (#{ color, distance }), dispersion (an Abbe number, a glass, #{ cauchy } or #{ sellmeier }), bump (#{ texture, height }), normalMap (#{ image, strength })").keys(&KEYS)],
        ])
        .returns("map")
        .doc("Sets several terms at once and returns the whole state as a map. material(m) puts such a map back. A reflection of () follows Ks again, and () takes a bump, a roughness and the like away. Whatever is a color or a number may have a texture.")
        .usage("material(#{ diffuse: [0.8, 0.2, 0.1], shininess: 50 })")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet red = material(#{ diffuse: [0.8, 0.1, 0.1], shininess: 50 });\ndiffuse(0.15, 0.35, 0.8);\nsphere(-1.2, 0, 0, 1);\nmaterial(red);\nsphere(1.2, 0, 0, 1);")
        .also(&["setMaterial", "finish"]),
    Entry::pure(Group::Materials, "hsv", hsv)
        .takes(&[&[
            number("hue", "degrees", "0 red, 120 green, 240 blue, and so on around"),
            number("saturation", "none", "0 gray to 1 full"),
            number("value", "none", "0 black to 1 full"),
        ]])
        .returns("vec3")
        .doc("A color by hue, saturation and value, as color pickers show it, in linear RGB.")
        .usage("hsv(30, 0.8, 1)")
        .example("background(\"#222\");\nlight([0, 0, 8], [1, 1, 1]);\nambient(0, 0, 0);\nfor i in 0..12 {\n  diffuse(hsv(i * 30, 0.8, 1));\n  group { rotate(0, 0, 1, i * 30); sphere(1.5, 0, 0, 0.35); }\n}")
        .also(&["hsb", "hue"]),
    Entry::pure(Group::Materials, "checker", checker)
        .takes(&[&[
            color("colorA", "the cube that starts at the origin"),
            color("colorB", "its neighbours"),
            number("size", "object units", "edge of a cube, greater than 0"),
        ]])
        .returns("texture")
        .doc("A texture of two colors in cubes of the shape's own space. It stands wherever a color of a material may.")
        .usage("checker(\"#fff\", \"#333\", 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(checker(\"#fff\", \"#246\", 0.5));\nsphere(0, 0.2, 0, 1.2);\ngroup { translate(0, -1, 0); diffuse(checker(\"#eee\", \"#c55\", 1)); plane(); }")
        .also(&["checkerboard", "checkers"]),
    Entry::pure(Group::Materials, "vertexColors", vertex_colors)
        .takes(&[&[]])
        .returns("texture")
        .doc("The colors of a mesh's vertices, mixed between the corners of each triangle: those of mesh(#{ colors }) and subdivide(#{ colors }), of a PLY file, or COLOR_0 of a glTF file. It stands wherever a color of a material may. White on all other shapes, and on triangles of which a corner has no color.")
        .usage("diffuse(vertexColors())")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ncamera([3.2, 2.6, 4.6], [0, -0.1, 0], [0, 1, 0], 34);\nlet corners = [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]];\ndiffuse(vertexColors());\nmesh(#{                          // the cube of all colors\n  positions: corners,\n  colors: corners.map(|p| [0.5 + 0.5 * p[0], 0.5 + 0.5 * p[1], 0.5 + 0.5 * p[2]]),\n  indices: [0, 1, 2, 0, 2, 3,  1, 5, 6, 1, 6, 2,  5, 4, 7, 5, 7, 6,  4, 0, 3, 4, 3, 7,  3, 2, 6, 3, 6, 7,  4, 5, 1, 4, 1, 0],\n});")
        .also(&["vertexColor", "colorAttribute", "perVertexColor", "COLOR_0", "Cd", "fill"]),
];

/// A term of the scene from a term of the script.
pub(super) fn scene_term(state: &mut State, value: &TermValue) -> Term {
    Term {
        color: value.color,
        texture: value.texture.as_ref().map(|t| state.builder.texture(t)),
    }
}

macro_rules! terms {
    ($($name:ident => |$m:ident, $t:ident| $set:expr;)*) => {
        $(fn $name(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
            let value = call.term("color")?;
            call.end()?;
            let $t = scene_term(state, &value);
            let $m = state.builder.material_mut();
            $set;
            DONE
        })*
    };
}

terms! {
    ambient => |m, t| m.ambient = t;
    emission => |m, t| m.emission = t;
    diffuse => |m, t| m.diffuse = t;
    specular => |m, t| m.specular = t;
    reflection => |m, t| m.reflection = Some(t);
    transmission => |m, t| m.transmission = t;
}

fn shininess(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let s = finishes::amount(call, state, "s")?;
    call.end()?;
    set_shininess(call, "s", state.builder.material_mut(), s)?;
    DONE
}

fn ior(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let n = finishes::amount(call, state, "n")?;
    call.end()?;
    set_ior(call, "n", state.builder.material_mut(), n)?;
    DONE
}

fn set_shininess(call: &Call<'_, '_>, name: &str, m: &mut Material, s: Term) -> Outcome<()> {
    m.set_shininess(s).map_err(|_| {
        let s = Term::number_of(s.color);
        call.error(format!("{name} must be 0 or greater, not {s}"))
    })
}

fn set_ior(call: &Call<'_, '_>, name: &str, m: &mut Material, n: Term) -> Outcome<()> {
    m.set_ior(n).map_err(|_| {
        let n = Term::number_of(n.color);
        call.error(format!("{name} must be greater than 0, not {n}"))
            .hint("water has 1.33, glass 1.5, diamond 2.42")
    })
}

fn material(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    if call.rest() > 0 {
        let given = call.any()?;
        call.end()?;
        let Some(map) = given.read_lock::<Map>() else {
            return Err(call.wrong_kind("options", "a map #{ }", given));
        };
        call.known_keys(&map, &KEYS)?;
        let mut m = state.builder.material().clone();
        let mut finish = m.finish.as_deref().cloned().unwrap_or_default();
        let (mut s, mut n) = (None, None);
        for (key, value) in map.iter() {
            match key.as_str() {
                "shininess" => s = Some(finishes::amount_from(call, state, key, value)?),
                "ior" => n = Some(finishes::amount_from(call, state, key, value)?),
                known if finishes::KEYS.contains(&known) => {
                    finishes::set(call, state, &mut finish, key, value)?;
                }
                _ => set(call, state, &mut m, key, value)?,
            }
        }
        m.change_finish(|f| *f = finish)
            .map_err(Box::<ScriptError>::from)?;
        if let Some(s) = s {
            set_shininess(call, "shininess", &mut m, s)?;
        }
        let own = m.finish.as_ref().and_then(|finish| finish.dispersion?.index_d());
        let own = own.filter(|_| map.contains_key("dispersion")).map(Term::number);
        if let Some(n) = n.or(own) {
            set_ior(call, "ior", &mut m, n)?;
        }
        state.builder.set_material(m);
    }
    Ok(Dynamic::from_map(as_map(state)))
}

fn set(call: &Call<'_, '_>, state: &mut State, m: &mut Material, key: &str, value: &Dynamic) -> Outcome<()> {
    match key {
        "reflection" if value.is_unit() => m.reflection = None,
        _ => {
            let t = scene_term(state, &call.term_from(key, value)?);
            match key {
                "ambient" => m.ambient = t,
                "diffuse" => m.diffuse = t,
                "emission" => m.emission = t,
                "reflection" => m.reflection = Some(t),
                "specular" => m.specular = t,
                _ => m.transmission = t,
            }
        }
    }
    Ok(())
}

fn as_map(state: &State) -> Map {
    let m = state.builder.material();
    let term = |t: &Term| term_value(state, t);
    let finish = m.finish.as_deref().cloned().unwrap_or_default();
    let entries = [
        ("ambient", term(&m.ambient)),
        ("diffuse", term(&m.diffuse)),
        ("emission", term(&m.emission)),
        (
            "ior",
            finishes::amount_value(state, finish.ior.unwrap_or(m.ior.into())),
        ),
        ("reflection", m.reflection.as_ref().map_or(Dynamic::UNIT, term)),
        (
            "shininess",
            finishes::amount_value(state, finish.shininess.unwrap_or(m.shininess.into())),
        ),
        ("specular", term(&m.specular)),
        ("transmission", term(&m.transmission)),
    ];
    entries
        .into_iter()
        .chain(finishes::as_map(state, &finish))
        .map(|(key, value)| (key.into(), value))
        .collect()
}

/// A term of the script from a term of the scene.
pub(super) fn term_value(state: &State, t: &Term) -> Dynamic {
    match t.texture.and_then(|id| state.builder.texture_at(id)) {
        None => Dynamic::from(t.color),
        Some(texture) => match ImageValue::of(texture) {
            Some(image) if t.color == Color::ONE => Dynamic::from(image),
            _ => Dynamic::from(TextureValue {
                texture: Arc::clone(texture),
                tint: t.color,
            }),
        },
    }
}

/// The hexcone of Smith ("Color gamut transform pairs", SIGGRAPH 1978), whose RGB is that of a screen.
fn hsv(call: &mut Call<'_, '_>) -> Outcome {
    let hue = call.number("hue")?;
    let (saturation, value) = (call.number("saturation")?, call.number("value")?);
    call.end()?;
    for (name, x) in [("saturation", saturation), ("value", value)] {
        if !(0.0..=1.0).contains(&x) {
            return Err(call.error(format!("{name} must lie between 0 and 1, not {x}")));
        }
    }
    let sixth = (hue / 60.0).rem_euclid(6.0);
    let channel = |offset: f64| {
        let k = (offset + sixth) % 6.0;
        linear_from_srgb(value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0))
    };
    Ok(Dynamic::from(DVec3::new(
        channel(5.0),
        channel(3.0),
        channel(1.0),
    )))
}

fn checker(call: &mut Call<'_, '_>) -> Outcome {
    let (even, odd) = (call.color("colorA")?, call.color("colorB")?);
    let size = call.number("size")?;
    call.end()?;
    if !(size > 0.0) {
        return Err(call.error(format!("size must be greater than 0, not {size}")));
    }
    Ok(Dynamic::from(TextureValue {
        texture: Arc::new(Texture::Checker { even, odd, size }),
        tint: Color::ONE,
    }))
}

fn vertex_colors(call: &mut Call<'_, '_>) -> Outcome {
    call.end()?;
    Ok(Dynamic::from(TextureValue {
        texture: Texture::vertex_colors(),
        tint: Color::ONE,
    }))
}

/// A texture times a number or a color.
pub(super) fn extend(module: &mut Module) {
    module.set_custom_type::<TextureValue>("texture");
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |t: &mut TextureValue| t.to_string());
    }
    tint::<TextureValue>(module);
    tint::<ImageValue>(module);
}

fn tint<T: Clone + Send + Sync + 'static>(module: &mut Module) {
    fn tinted<T: Clone + Send + Sync + 'static>(value: T, by: Color) -> Dynamic {
        let value = Dynamic::from(value);
        texture_of(&value).map_or(Dynamic::UNIT, |t| match t.texture {
            Some(texture) => Dynamic::from(TextureValue {
                texture,
                tint: t.color * by,
            }),
            None => Dynamic::UNIT,
        })
    }
    macro_rules! times {
        ($($number:ty => |$n:ident| $color:expr;)*) => {
            $(
                FuncRegistration::new("*").set_into_module(module, |t: T, $n: $number| tinted(t, $color));
                FuncRegistration::new("*").set_into_module(module, |$n: $number, t: T| tinted(t, $color));
            )*
        };
    }
    times! {
        f64 => |n| Color::splat(n);
        i64 => |n| Color::splat(n as f64);
        DVec3 => |n| n;
    }
}
