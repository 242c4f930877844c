//! Lights with a shape of their own: cones.

use rhai::Map;

use super::{color, map, number, vec3};
use crate::{
    scene::Spot,
    script::{
        call::Call,
        session::State,
        table::{DONE, Entry, Group},
        value::Outcome,
    },
};

const SPOT_OPTIONS: [&str; 2] = ["penumbra", "tightness"];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lights, "spot", spot)
        .takes(&[&[
            vec3("position", "object units", "where it is"),
            vec3("target", "object units", "the point that it shines at"),
            color("color", "its light, on the axis"),
            number("angle", "degrees", "from the axis to the edge of the cone, above 0 and at most 180"),
            map("options", "penumbra: degrees of the soft edge, within the cone, 0 unless given; tightness: the power of the cosine that gathers light in the middle, 0 unless given")
                .keys(&SPOT_OPTIONS)
                .or("#{}"),
        ]])
        .doc("A light that shines into a cone. Its edge goes from full light at angle - penumbra to none at angle as 3x^2 - 2x^3 of the cosine; the rest is that of light(position, color), attenuation() too.")
        .usage("spot([2, 5, 2], [0, 0, 0], [1, 1, 1], 25, #{ penumbra: 8 })")
        .example("camera([0, 3, 7], [0, 0.8, 0], [0, 1, 0], 36);\nambient(0.03, 0.03, 0.04);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nspot([-3, 5, 2], [-0.9, 0, 0], [1, 0.25, 0.2], 16, #{ penumbra: 8 });\nspot([3, 5, 2], [0.9, 0, 0], [0.2, 0.45, 1], 16, #{ penumbra: 8 });\nspot([0, 6, 3], [0, 0, 0], [0.3, 0.9, 0.3], 12);\ndiffuse(0.9, 0.9, 0.9);\nsphere(0, 0.7, 0, 0.7);")
        .also(&["spotLight", "spotlight", "cone light", "penumbra", "flashlight", "cylinder light"]),
];

/// The map of options that may be left out.
pub(super) fn options(call: &mut Call<'_, '_>, known: &[&str]) -> Outcome<Map> {
    if call.rest() == 0 {
        return Ok(Map::new());
    }
    let given = call.any()?;
    let Some(options) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map", given));
    };
    call.known_keys(&options, known)?;
    Ok(options.clone())
}

/// The number of an option, or what it is where it is left out.
pub(super) fn number_or(call: &Call<'_, '_>, options: &Map, key: &str, default: f64) -> Outcome<f64> {
    let given = options.get(key);
    given.map_or(Ok(default), |given| call.number_from(key, given))
}

fn spot(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (position, target) = (call.vec3("position")?, call.vec3("target")?);
    let (color, angle) = (call.color("color")?, call.number("angle")?);
    let options = options(call, &SPOT_OPTIONS)?;
    call.end()?;
    let option = |key| number_or(call, &options, key, 0.0);
    let (penumbra, tightness) = (option("penumbra")?, option("tightness")?);
    let attenuation = state.builder.current_attenuation();
    let spot = Spot::new(position, target, (angle, penumbra), tightness, attenuation)?;
    state.builder.spot(spot, color)?;
    DONE
}
