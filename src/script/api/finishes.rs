//! What surfaces do beyond the shading equation: Fresnel, metals, roughness, coats, colored and dispersing glass, relief.

use rhai::{Dynamic, Map};

use super::{
    amount as amount_param, glasses,
    materials::{scene_term, term_value},
    number, patterns, string, term,
};
use crate::{
    color::Color,
    scene::{Absorption, Bump, ClearCoat, Conductor, Finish, NormalMap, Term, TextureId},
    script::{
        call::{Call, number_of, texture_of},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::{Outcome, ScriptError},
    },
};

/// Their keys in `material(#{ })`.
pub(super) const KEYS: [&str; 10] = [
    "absorption",
    "bump",
    "clearCoat",
    "conductor",
    "dispersion",
    "fresnel",
    "multiscatter",
    "normalMap",
    "orenNayar",
    "roughness",
];

macro_rules! studio {
    ($rest:literal) => {
        concat!(
            "background(\"#cfe3f5\");\nsamples(16);\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#3a7\", 1)); plane(); }\n",
            $rest
        )
    };
}

/// A bright sky over a floor: rough things show it smoothly, where they show a lamp's highlight on one another as sparks.
macro_rules! gloss {
    ($rest:literal) => {
        concat!(
            "samples(25);\nsampler(\"sobol\");\nsky(#{ zenith: [1, 1, 1], horizon: [0.5, 0.6, 0.75], n: 0 });\ndirectional([2, 4, 3], [0.2, 0.2, 0.2]);\ngroup { translate(0, -1, 0); ambient(checker(\"#999\", \"#254\", 1)); diffuse(checker(\"#ddd\", \"#586\", 1)); plane(); }\nambient(0, 0, 0);\ndiffuse(0, 0, 0);\n",
            $rest
        )
    };
}

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Materials, "fresnel", fresnel)
        .takes(&[&[Param::new("on", Kind::Any, "none", "true or false")]])
        .doc("Mirror and transparency share the light by Fresnel's equations for ior(n): water and glass mirror little straight on and all at grazing angles. Kr and Kt then say how much of each share is kept; where neither Kr nor Ks is given, Kr is white. What is not mirrored goes on to Kd and Kt, and highlights are as strong as the mirror. Default: false.")
        .usage("fresnel(true)")
        .example(studio!("ambient(0, 0, 0);\nfresnel(true);\ngroup { transmission(1, 1, 1); sphere(-1.1, 0.1, 0, 1); }\ndiffuse(0.6, 0.05, 0.05);   // a billiard ball\nsphere(1.1, 0.1, 0, 1);"))
        .also(&["dielectric", "schlick"]),
    Entry::scene(Group::Materials, "conductor", conductor)
        .takes(&[
            &[string("metal", "aluminium, copper, gold or silver, as they were measured")],
            &[
                Param::new("eta", Kind::Term, "none", "index of refraction in red, green and blue"),
                Param::new("k", Kind::Term, "none", "absorption coefficient in red, green and blue"),
            ],
        ])
        .doc("The mirror of a metal: its color by Fresnel's equations for conductors, paler at grazing angles. Where neither Kr nor Ks is given, Kr is white.")
        .usage("conductor(\"gold\")")
        .example(gloss!("let metals = [\"gold\", \"copper\", \"silver\"];\nfor i in 0..3 {\n  conductor(metals[i]);\n  roughness(0.15 * i);\n  sphere(i * 1.9 - 1.9, -0.1, 0, 0.9);\n}"))
        .also(&["metal", "metallic", "gold", "silver", "copper", "aluminium"]),
    Entry::scene(Group::Materials, "roughness", roughness)
        .takes(&[
            &[number("r", "none", "0 smooth to 1; 0.1 satin, 0.3 brushed, 0.6 frosted")],
            &[term("texture", "the mean of its channels is the roughness")],
        ])
        .doc("Blurs what the mirror sees and what is seen through, as a surface of tiny mirrors (GGX) does, and shows lamps in it as highlights of the same shape with weight Kr, in place of Ks and shininess. One ray is followed for each sample, so samples(n) and sampler(\"sobol\") decide about the noise. No ray meets a lamp: where rough things see its highlight on one another there are sparks, which a bright part of an environment in its place does not give. Default: 0.")
        .usage("roughness(0.3)")
        .example(gloss!("reflection(0.9, 0.9, 0.9);\nfor i in 0..3 {\n  roughness(0.1 + 0.2 * i);\n  sphere(i * 1.9 - 1.9, -0.1, 0, 0.9);\n}"))
        .also(&["microfacet", "ggx", "frosted", "blurry", "glossy"]),
    Entry::scene(Group::Materials, "multiscatter", multiscatter)
        .takes(&[&[Param::new("on", Kind::Any, "none", "true or false")]])
        .doc("Gives back the light that the tiny mirrors of a rough, opaque surface throw at each other, which roughness(r) alone takes for lost: up to 60 % of it where r is 1. Rough metals get brighter, and their colors stronger. Glass stays as it is. Default: false.")
        .usage("multiscatter(true)")
        .example("samples(32);\nsampler(\"sobol\");\nsky(#{ zenith: [1.1, 1.1, 1.1], horizon: [0.4, 0.5, 0.65], ground: [0.4, 0.35, 0.3], n: 0 });\nambient(0, 0, 0);\ndiffuse(0, 0, 0);\nconductor(\"copper\");\nfor i in 0..3 {\n  roughness(0.4 + 0.2 * i);\n  multiscatter(false);   // above\n  sphere(i * 1.7 - 1.7, 0.8, 0, 0.65);\n  multiscatter(true);\n  sphere(i * 1.7 - 1.7, -0.8, 0, 0.65);\n}")
        .also(&["multipleScattering", "energyCompensation", "kullaConty", "MULTI_GGX"]),
    Entry::scene(Group::Materials, "orenNayar", oren_nayar)
        .takes(&[&[amount_param("sigma", "degrees", "spread of the slopes, 0 to 90; clay 20, the moon 40")]])
        .doc("Makes Kd that of a rough matt surface, which is flatter than Lambert's: clay, cloth, the moon. Default: 0, Lambert.")
        .usage("orenNayar(30)")
        .example("background(\"#223\");\nambient(0, 0, 0);\ndirectional([0, 0.3, 1], [1, 1, 1]);\ndiffuse(0.8, 0.7, 0.6);\nsphere(-1.2, 0, 0, 1);\norenNayar(40);\nsphere(1.2, 0, 0, 1);")
        .also(&["matte", "clay", "brilliance"]),
    Entry::scene(Group::Materials, "clearCoat", clear_coat)
        .takes(&[&[
            amount_param("strength", "none", "0 none to 1"),
            amount_param("roughness", "none", "0 to 1").or("0.1"),
        ]])
        .doc("A layer of clear varnish (index 1.5) on top: a mirror of its own by Fresnel's equations, with highlights, over whatever the surface is below. Default: 0.")
        .usage("clearCoat(1, 0.05)")
        .example(studio!("diffuse(0.55, 0.02, 0.05);\nsphere(-1.1, 0, 0, 1);\nclearCoat(1, 0.05);\nsphere(1.1, 0, 0, 1);"))
        .also(&["coat", "varnish", "lacquer", "carPaint"]),
    Entry::scene(Group::Materials, "absorption", absorption)
        .takes(&[&[
            term("color", "the share of light that is left after the distance; above 0, at most 1"),
            amount_param("distance", "world units", "greater than 0"),
        ]])
        .doc("What the inside takes from light on its way (Beer's law): thick glass is darker than thin. White for none. A pattern runs through the inside, as veins do; a picture laid by texture coordinates colors the light where it comes in.")
        .usage("absorption(\"#5c9\", 1)")
        .example(studio!("ambient(0, 0, 0);\nfresnel(true);\ntransmission(1, 1, 1);\nabsorption(\"#3b8\", 0.8);\nfor i in 0..3 {\n  let r = 0.3 + 0.3 * i;\n  sphere(i * 1.5 - 1.7, r - 1, 0, r);\n}"))
        .also(&["beer", "fade_distance", "attenuationColor", "volumeAbsorption"]),
    Entry::scene(Group::Materials, "dispersion", dispersion)
        .takes(&[
            &[amount_param("abbe", "none", "Abbe number, 1 or greater: window glass 60, flint glass 30, diamond 55; 10 for show")],
            &[string("glass", "BAK4, BK7, F2, FK51A, LASF9, SF10, SF11 (Schott's), diamond, sapphire, silica or water, as they were measured")],
            &[
                number("a", "none", "A of Cauchy's formula A + B / w^2 + C / w^4, w being the wavelength in micrometers: near 1.5"),
                number("b", "square micrometers", "its B: 0.004 for crown glass, 0.01 for flint"),
                number("c", "micrometers^4", "its C").or("0"),
            ],
            &[Param::new("sellmeier", Kind::Array, "square micrometers", "one to four pairs [B, C] of Sellmeier's formula, as catalogs of glass list them")],
        ])
        .doc("Bends colors apart as glass with this Abbe number does, ior(n) being that of yellow light. A named glass, Cauchy's and Sellmeier's formula say their index, too, as if by ior(n); a later ior(n) moves the indices of all colors by as much as that of yellow. Each sample that goes through has one wavelength, so this needs many samples.")
        .usage("dispersion(\"SF10\")")
        .example("background(\"#e8edf2\");\nsamples(32);\nsampler(\"sobol\");\nmaxDepth(8);\nambient(0, 0, 0);\ncamera([0, 0, 6], [0, 0, 0], [0, 1, 0], 40);\nfor y in [-2, 0.5] {   // black bars behind the ball\n  group { translate(0, y, -6); scale(12, 0.5, 0.1); box(); }\n}\ntransmission(1, 1, 1);\nior(1.6);\ndispersion(8);\nsphere(0, 0, 0, 1.3);")
        .also(&["abbe", "rainbow", "chromatic", "cauchy", "sellmeier", "dispersion_samples"]),
    Entry::scene(Group::Materials, "bump", bump)
        .takes(&[&[
            term("texture", "its brightness is the height"),
            amount_param("height", "object units", "how high white is above black; 0 for none"),
        ]])
        .doc("Relief: light falls as if the surface were raised where the texture is bright. Its outline stays as it is.")
        .usage("bump(granite(#{ scale: 0.2 }), 0.03)")
        .example(studio!("diffuse(0.8, 0.5, 0.3);\nspecular(0.2, 0.2, 0.2);\nreflection(0, 0, 0);\nshininess(40);\nbump(pattern(\"fbm\", #{ colors: [\"#000\", \"#fff\"], scale: 0.4 }), 0.15);\nsphere(-1.1, 0, 0, 1);\nbump(brick(#{ scale: 0.8, colors: [\"#000\", \"#fff\"] }), 0.01);\nsphere(1.1, 0, 0, 1);"))
        .also(&["bumpMap", "bump_map", "displacement", "wrinkles"]),
    Entry::scene(Group::Materials, "normalMap", normal_map)
        .takes(&[&[
            Param::new("image", Kind::Image, "none", "red is to the right, green up, blue out of the surface, as in OpenGL and glTF; half is none"),
            amount_param("strength", "none", "1 as it is, 0 flat").or("1"),
        ]])
        .doc("Relief by a picture of normals, over the shape's texture coordinates.")
        .usage("normalMap(image(#{ width: 1, height: 1, pixels: [0.5, 0.5, 1] }), 0.5)")
        .example(studio!("let dents = [];\nfor y in 0..32 { for x in 0..32 {\n  dents.push([0.5 + 0.3 * sin(x * PI / 4), 0.5 + 0.3 * sin(y * PI / 4), 0.9]);\n} }\ndiffuse(0.3, 0.5, 0.8);\nspecular(0.4, 0.4, 0.4);\nreflection(0, 0, 0);\nshininess(40);\nnormalMap(image(#{ width: 32, height: 32, pixels: dents }));\nsphere(0, 0.2, 0, 1.1);"))
        .also(&["normal_map", "tangentSpace"]),
];

/// Roughness of varnish, and strength of a map of normals, where they are not said.
const USUAL_COAT: Term = Term::number(0.1);
const USUAL_STRENGTH: Term = Term::number(1.0);

/// Changes the finish of the current material.
fn change(state: &mut State, change: impl FnOnce(&mut Finish)) -> Outcome {
    state
        .builder
        .material_mut()
        .change_finish(change)
        .map_err(Box::<ScriptError>::from)?;
    DONE
}

fn fresnel(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let on = switch(call, "on", given)?;
    change(state, |f| f.fresnel = on)
}

fn multiscatter(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let on = switch(call, "on", given)?;
    change(state, |f| f.multiscatter = on)
}

fn switch(call: &Call<'_, '_>, name: &str, given: &Dynamic) -> Outcome<bool> {
    given
        .as_bool()
        .map_err(|_| call.wrong_kind(name, "true or false", given))
}

fn conductor(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let metal = match call.peek() {
        Some(d) if d.is_string() => {
            let name = call.string("metal")?;
            metal(call, &name)?
        }
        _ => {
            let (eta, k) = (call.term("eta")?, call.term("k")?);
            Conductor {
                eta: scene_term(state, &eta),
                k: scene_term(state, &k),
            }
        }
    };
    call.end()?;
    change(state, |f| f.conductor = Some(metal))
}

fn metal(call: &Call<'_, '_>, name: &str) -> Outcome<Conductor> {
    if let Some((_, metal)) = Conductor::METALS.iter().find(|(known, _)| *known == name) {
        return Ok(*metal);
    }
    let names: Vec<&str> = Conductor::METALS.iter().map(|(name, _)| *name).collect();
    Err(patterns::choice_error(call, "metal", name, &names))
}

fn roughness(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    if call.rest() > 0 {
        return Err(call.wrong_count());
    }
    let term = rough_term(call, state, "r", given)?;
    change(state, |f| f.roughness = Some(term).filter(is_any))
}

/// A number or a texture, as the next argument.
pub(super) fn amount(call: &mut Call<'_, '_>, state: &mut State, name: &str) -> Outcome<Term> {
    let given = call.any()?;
    amount_from(call, state, name, given)
}

/// A number or a texture, from a single value.
pub(super) fn amount_from(call: &Call<'_, '_>, state: &mut State, name: &str, d: &Dynamic) -> Outcome<Term> {
    match texture_of(d) {
        Some(value) => Ok(scene_term(state, &value)),
        None if number_of(d).is_some() => call.number_from(name, d).map(Term::number),
        None => Err(call.wrong_kind(name, "a number or a texture", d)),
    }
}

/// As [`amount_from`]; colors will do, too.
fn rough_term(call: &Call<'_, '_>, state: &mut State, name: &str, d: &Dynamic) -> Outcome<Term> {
    if number_of(d).is_some() {
        return call.number_from(name, d).map(Term::number);
    }
    Ok(scene_term(state, &call.term_from(name, d)?))
}

/// What `material()` returns of such a term.
pub(super) fn amount_value(state: &State, term: Term) -> Dynamic {
    match term.texture {
        None => Dynamic::from(Term::number_of(term.color)),
        Some(_) => term_value(state, &term),
    }
}

/// False where it is 0 everywhere.
fn is_any(term: &Term) -> bool {
    term.texture.is_some() || term.color != Color::ZERO
}

fn oren_nayar(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let sigma = amount(call, state, "sigma")?;
    call.end()?;
    change(state, |f| f.oren_nayar = Some(sigma).filter(is_any))
}

fn clear_coat(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let strength = amount(call, state, "strength")?;
    let roughness = if call.rest() > 0 {
        amount(call, state, "roughness")?
    } else {
        USUAL_COAT
    };
    call.end()?;
    let coat = ClearCoat { strength, roughness };
    change(state, |f| {
        f.clear_coat = Some(coat).filter(|coat| is_any(&coat.strength))
    })
}

fn absorption(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let value = call.term("color")?;
    let color = scene_term(state, &value);
    let distance = amount(call, state, "distance")?;
    call.end()?;
    let absorption = Absorption { color, distance };
    change(state, |f| {
        f.absorption = Some(absorption).filter(|absorption| absorption.color != Term::color(Color::ONE));
    })
}

fn dispersion(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let dispersion = glasses::arguments(call, state)?;
    call.end()?;
    let material = state.builder.material_mut();
    material
        .set_dispersion(dispersion)
        .map_err(Box::<ScriptError>::from)?;
    DONE
}

fn bump(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let value = call.term("texture")?;
    let texture = scene_term(state, &value);
    let height = amount(call, state, "height")?;
    call.end()?;
    change(state, |f| {
        f.bump = Some(Bump { texture, height }).filter(|bump| is_any(&bump.height))
    })
}

fn normal_map(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let texture = map_of(call, state, "image", given)?;
    let strength = if call.rest() > 0 {
        amount(call, state, "strength")?
    } else {
        USUAL_STRENGTH
    };
    call.end()?;
    let map = NormalMap { texture, strength };
    change(state, |f| {
        f.normal_map = Some(map).filter(|map| is_any(&map.strength))
    })
}

fn map_of(call: &Call<'_, '_>, state: &mut State, name: &str, given: &Dynamic) -> Outcome<TextureId> {
    let Some(texture) = texture_of(given).and_then(|value| value.texture) else {
        return Err(call.wrong_kind(name, "an image or a texture", given));
    };
    Ok(state.builder.texture(&texture))
}

/// Sets what `material(#{ })` names; `()` is none.
pub(super) fn set(
    call: &Call<'_, '_>,
    state: &mut State,
    f: &mut Finish,
    key: &str,
    value: &Dynamic,
) -> Outcome<()> {
    let none = value.is_unit();
    let options = |known: &[&str]| -> Outcome<Map> {
        let Some(map) = value.read_lock::<Map>() else {
            return Err(call.wrong_kind(key, "a map #{ } or ()", value));
        };
        call.known_keys(&map, known)?;
        Ok(map.clone())
    };
    let missing = |name: &str| call.error(format!("{key} needs {name}"));
    let amount = |state: &mut State, map: &Map, name: &str, default: Option<Term>| -> Outcome<Term> {
        match (map.get(name), default) {
            (Some(d), _) => amount_from(call, state, name, d),
            (None, Some(default)) => Ok(default),
            (None, None) => Err(missing(name)),
        }
    };
    let term = |state: &mut State, map: &Map, name: &str| -> Outcome<Term> {
        let value = call.term_from(name, map.get(name).ok_or_else(|| missing(name))?)?;
        Ok(scene_term(state, &value))
    };
    match key {
        "fresnel" => f.fresnel = switch(call, key, value)?,
        "multiscatter" => f.multiscatter = switch(call, key, value)?,
        "orenNayar" if none => f.oren_nayar = None,
        "orenNayar" => f.oren_nayar = Some(amount_from(call, state, key, value)?).filter(is_any),
        "absorption" if none => f.absorption = None,
        "bump" if none => f.bump = None,
        "clearCoat" if none => f.clear_coat = None,
        "conductor" if none => f.conductor = None,
        "dispersion" if none => f.dispersion = None,
        "normalMap" if none => f.normal_map = None,
        "roughness" if none => f.roughness = None,
        "dispersion" => f.dispersion = Some(glasses::value(call, state, key, value)?),
        "roughness" => f.roughness = Some(rough_term(call, state, key, value)?).filter(is_any),
        "conductor" if value.is_string() => {
            let name = value.clone().into_immutable_string().unwrap_or_default();
            f.conductor = Some(metal(call, &name)?);
        }
        "conductor" => {
            let map = options(&["eta", "k"])?;
            f.conductor = Some(Conductor {
                eta: term(state, &map, "eta")?,
                k: term(state, &map, "k")?,
            });
        }
        "absorption" => {
            let map = options(&["color", "distance"])?;
            f.absorption = Some(Absorption {
                color: term(state, &map, "color")?,
                distance: amount(state, &map, "distance", None)?,
            });
        }
        "clearCoat" => {
            let map = options(&["roughness", "strength"])?;
            f.clear_coat = Some(ClearCoat {
                strength: amount(state, &map, "strength", None)?,
                roughness: amount(state, &map, "roughness", Some(USUAL_COAT))?,
            });
        }
        "bump" => {
            let map = options(&["height", "texture"])?;
            f.bump = Some(Bump {
                texture: term(state, &map, "texture")?,
                height: amount(state, &map, "height", None)?,
            });
        }
        _ => {
            let map = options(&["image", "strength"])?;
            let image = map.get("image").ok_or_else(|| missing("image"))?;
            let texture = map_of(call, state, "image", image)?;
            let strength = amount(state, &map, "strength", Some(USUAL_STRENGTH))?;
            f.normal_map = Some(NormalMap { texture, strength }).filter(|map| is_any(&map.strength));
        }
    }
    Ok(())
}

/// What `material()` returns of it.
pub(super) fn as_map(state: &State, f: &Finish) -> [(&'static str, Dynamic); 10] {
    let map = |entries: &[(&str, Dynamic)]| {
        let entries = entries.iter().map(|(key, value)| ((*key).into(), value.clone()));
        Dynamic::from_map(entries.collect())
    };
    let of = |value: Option<Dynamic>| value.unwrap_or(Dynamic::UNIT);
    [
        (
            "absorption",
            of(f.absorption.map(|a| {
                map(&[
                    ("color", term_value(state, &a.color)),
                    ("distance", amount_value(state, a.distance)),
                ])
            })),
        ),
        (
            "bump",
            of(f.bump.map(|b| {
                map(&[
                    ("height", amount_value(state, b.height)),
                    ("texture", term_value(state, &b.texture)),
                ])
            })),
        ),
        (
            "clearCoat",
            of(f.clear_coat.map(|c| {
                map(&[
                    ("roughness", amount_value(state, c.roughness)),
                    ("strength", amount_value(state, c.strength)),
                ])
            })),
        ),
        (
            "conductor",
            of(f.conductor
                .map(|c| map(&[("eta", term_value(state, &c.eta)), ("k", term_value(state, &c.k))]))),
        ),
        (
            "dispersion",
            of(f.dispersion
                .map(|dispersion| glasses::as_value(state, &dispersion))),
        ),
        ("fresnel", Dynamic::from(f.fresnel)),
        ("multiscatter", Dynamic::from(f.multiscatter)),
        (
            "normalMap",
            of(f.normal_map.map(|m| {
                let image = term_value(state, &Term::texture(m.texture));
                map(&[("image", image), ("strength", amount_value(state, m.strength))])
            })),
        ),
        (
            "orenNayar",
            f.oren_nayar
                .map_or(Dynamic::from(0.0), |sigma| amount_value(state, sigma)),
        ),
        (
            "roughness",
            of(f.roughness.map(|roughness| amount_value(state, roughness))),
        ),
    ]
}
