//! Smooth noise that is the same everywhere.

use rhai::{Dynamic, Map};

use super::{int, number, vec3};
use crate::{
    math::DVec3,
    noise::{self, Octaves},
    script::{
        call::Call,
        table::{Entry, Group, Param},
        value::Outcome,
    },
};

const V: Param = vec3("v", "none", "a point in space");
const OCTAVES: Param = int("octaves", "none", "how many, each of half the size; from 1 to 16").or("5");
const LACUNARITY: Param = number(
    "lacunarity",
    "none",
    "how much finer each octave is than the one before",
)
.or("2");
const GAIN: Param = number(
    "gain",
    "none",
    "how much weaker each octave is than the one before",
)
.or("0.5");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Random, "noise", noise_at)
        .takes(&[
            &[number("x", "none", "along a line")],
            &[
                number("x", "none", "in a plane"),
                number("y", "none", "in a plane"),
            ],
            &[vec3("v", "none", "in space")],
        ])
        .returns("float")
        .doc("Smooth noise between -1 and 1, 0 at whole numbers: hills of about one unit in size. It does not depend on the seed; add an offset to see another part of it.")
        .usage("noise(0.3, 1.7)")
        .example("background(\"#cfe3f5\");\nlight([3, 8, 4], [1, 1, 1]);\ndiffuse(0.3, 0.6, 0.3);\ncamera([0, 5, 8], [0, -0.3, 0], [0, 1, 0], 40);\nfor x in -12..13 {\n  for z in -12..13 {\n    sphere(x * 0.25, noise(x * 0.25, z * 0.25) * 1.2, z * 0.25, 0.16);\n  }\n}")
        .also(&["perlin", "snoise", "f_noise3d"]),
    Entry::pure(Group::Random, "simplex", simplex)
        .takes(&[&[V]])
        .returns("float")
        .doc("Simplex noise between -1 and 1: as noise(v), with less of a grid about it.")
        .usage("simplex([0.3, 1.7, 0])")
        .example("background(\"#cfe3f5\");\nlight([3, 8, 4], [1, 1, 1]);\ndiffuse(0.6, 0.5, 0.3);\ncamera([0, 5, 8], [0, -0.3, 0], [0, 1, 0], 40);\nfor x in -12..13 {\n  for z in -12..13 {\n    sphere(x * 0.25, simplex([x * 0.2, 0, z * 0.2]), z * 0.25, 0.16);\n  }\n}"),
    Entry::pure(Group::Random, "fbm", |call| octaves(call, noise::fbm))
        .takes(&[&[V, OCTAVES, LACUNARITY, GAIN]])
        .returns("float")
        .doc("Fractal noise between -1 and 1: octaves of noise(v), each finer and weaker than the one before, added up. Mountains, clouds, coastlines.")
        .usage("fbm([1.5, 0, 2.5], 6)")
        .example("background(\"#cfe3f5\");\ndirectional([3, 4, 1], [1, 1, 1]);\nambient(0.05, 0.05, 0.05);\ncamera([0, 4, 7], [0, -0.4, 0], [0, 1, 0], 40);\nfor x in -22..23 {\n  for z in -22..23 {\n    let h = fbm([x * 0.08, 0.5, z * 0.08], 6) * 2.2;\n    if h > 0.4 { diffuse(0.9, 0.9, 0.95); } else { diffuse(0.3, 0.45, 0.25); }\n    group { translate(x * 0.13, h / 2 - 1, z * 0.13); box(0.13, h + 2, 0.13); }\n  }\n}")
        .also(&["fractal", "fractalNoise", "octaves", "brownian"]),
    Entry::pure(Group::Random, "turbulence", |call| octaves(call, noise::turbulence))
        .takes(&[&[V, OCTAVES, LACUNARITY, GAIN]])
        .returns("float")
        .doc("Fractal noise of absolute values, between 0 and 1, with creases: veins, ridges, flames.")
        .usage("turbulence([1.5, 0, 2.5], 4)")
        .example("background(\"#cfe3f5\");\ndirectional([3, 4, 1], [1, 1, 1]);\nambient(0.05, 0.05, 0.05);\ncamera([0, 4, 7], [0, -0.4, 0], [0, 1, 0], 40);\nfor x in -22..23 {\n  for z in -22..23 {\n    let h = 1.6 - turbulence([x * 0.08, 0.5, z * 0.08], 4) * 4;\n    diffuse(0.5 + 0.2 * h, 0.45, 0.4);\n    group { translate(x * 0.13, h / 2 - 1, z * 0.13); box(0.13, h + 2, 0.13); }\n  }\n}")
        .also(&["ridged"]),
    Entry::pure(Group::Random, "worley", worley)
        .takes(&[&[V, number("jitter", "none", "0 for points on a lattice, 1 for points without order").or("1")]])
        .returns("map")
        .doc("Cells around scattered points, one point to each unit cube: #{ nearest, second, cell }, the distances to the two nearest points and a number from 0 to 1 that belongs to the cell.")
        .usage("worley([1.5, 0, 2.5]).nearest")
        .example("background(\"#cfe3f5\");\ndirectional([3, 4, 1], [1, 1, 1]);\nambient(0.05, 0.05, 0.05);\ncamera([0, 6, 6], [0, -0.4, 0], [0, 1, 0], 40);\nfor x in -22..23 {\n  for z in -22..23 {\n    let w = worley([x * 0.13, 0, z * 0.13]);\n    diffuse(hsv(360 * w.cell, 0.5, 0.9));\n    let h = min(w.second - w.nearest, 0.3);\n    group { translate(x * 0.13, h, z * 0.13); box(0.13, 1, 0.13); }\n  }\n}")
        .also(&["voronoi", "cellular", "crackle"]),
];

/// A point at which there is noise.
fn point(call: &mut Call<'_, '_>) -> Outcome<DVec3> {
    let p = call.vec3("v")?;
    within_reach(call, p)
}

fn within_reach(call: &Call<'_, '_>, p: DVec3) -> Outcome<DVec3> {
    if p.abs().max_element() > noise::REACH {
        return Err(call.error("beyond 1e9 there is no noise, for want of digits"));
    }
    Ok(p)
}

fn simplex(call: &mut Call<'_, '_>) -> Outcome {
    let p = point(call)?;
    call.end()?;
    Ok(Dynamic::from(noise::simplex(p)))
}

fn octaves(call: &mut Call<'_, '_>, sum: fn(DVec3, Octaves) -> f64) -> Outcome {
    let p = point(call)?;
    let mut octaves = Octaves::new(5);
    if call.rest() > 0 {
        octaves.count = call.count("octaves", 1)?;
        if octaves.count > noise::MAX_OCTAVES {
            let most = noise::MAX_OCTAVES;
            return Err(call.error(format!("octaves must be at most {most}, not {}", octaves.count)));
        }
    }
    for (name, value) in [
        ("lacunarity", &mut octaves.lacunarity),
        ("gain", &mut octaves.gain),
    ] {
        if call.rest() > 0 {
            *value = call.number(name)?;
            if !(*value > 0.0 && *value <= 16.0) {
                let given = *value;
                return Err(call.error(format!(
                    "{name} must be greater than 0 and at most 16, not {given}"
                )));
            }
        }
    }
    call.end()?;
    Ok(Dynamic::from(sum(p, octaves)))
}

fn worley(call: &mut Call<'_, '_>) -> Outcome {
    let p = point(call)?;
    let jitter = match call.rest() {
        0 => 1.0,
        _ => call.number("jitter")?,
    };
    call.end()?;
    if !(0.0..=1.0).contains(&jitter) {
        return Err(call.error(format!("jitter must lie between 0 and 1, not {jitter}")));
    }
    let found = noise::worley(p, jitter);
    let values = [
        ("nearest", found.nearest),
        ("second", found.second),
        ("cell", found.cell),
    ];
    let map: Map = values.map(|(key, x)| (key.into(), Dynamic::from(x))).into();
    Ok(Dynamic::from(map))
}

fn noise_at(call: &mut Call<'_, '_>) -> Outcome {
    let p = match call.len() {
        2 => DVec3::new(call.number("x")?, call.number("y")?, 0.0),
        1 if call.peek().is_some_and(|d| d.is_int() || d.is_float()) => {
            DVec3::new(call.number("x")?, 0.0, 0.0)
        }
        _ => call.vec3("v")?,
    };
    call.end()?;
    Ok(Dynamic::from(noise::perlin(within_reach(call, p)?)))
}
