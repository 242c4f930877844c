//! Smooth noise that is the same everywhere.

use rhai::Dynamic;

use super::{number, vec3};
use crate::{
    math::DVec3,
    noise,
    script::{
        call::Call,
        table::{Entry, Group},
        value::Outcome,
    },
};

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
        .also(&["perlin", "simplex", "snoise"]),
];

fn noise_at(call: &mut Call<'_, '_>) -> Outcome {
    let p = match call.len() {
        2 => DVec3::new(call.number("x")?, call.number("y")?, 0.0),
        1 if call.peek().is_some_and(|d| d.is_int() || d.is_float()) => {
            DVec3::new(call.number("x")?, 0.0, 0.0)
        }
        _ => call.vec3("v")?,
    };
    call.end()?;
    if p.abs().max_element() > noise::REACH {
        return Err(call.error("beyond 1e9 there is no noise, for want of digits"));
    }
    Ok(Dynamic::from(noise::perlin(p)))
}
