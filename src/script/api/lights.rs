//! Lights, placed under the current matrix.

use super::{
    color, int,
    lamps::{SURFACE_OPTIONS, falloff, options},
    map, number, vec3,
};
use crate::{
    scene::{Attenuation, Sun, SurfaceLight},
    script::{
        call::Call,
        session::State,
        table::{DONE, Entry, Group, Param},
        value::Outcome,
    },
};

const DIRECTIONAL_OPTIONS: [&str; 2] = ["angle", "n"];

const POINT: &[Param] = &[
    vec3("position", "object units", "where it is"),
    color("color", "its light; components may exceed 1"),
];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lights, "light", point)
        .takes(&[POINT])
        .doc("A point light under the current matrix. Without attenuation() it does not fade with distance.")
        .usage("light([5, 5, 5], [1, 1, 1])")
        .example("background(\"#cfe3f5\");\ncamera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.08, 0.08, 0.1);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nlight([3, 4, 2], [0.8, 0.8, 0.8]);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 1, 0, 1);")
        .also(&["pointLight", "lamp", "light_source"]),
    Entry::scene(Group::Lights, "point", point)
        .takes(&[POINT])
        .doc("The same as light(position, color), under the name the CSE167 course gives it.")
        .usage("point([5, 5, 5], [1, 1, 1])")
        .example("background(\"#cfe3f5\");\ncamera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.08, 0.08, 0.1);\ndiffuse(0.8, 0.8, 0.75);\nplane();\npoint([-3, 4, 2], [0.8, 0.8, 0.8]);\ndiffuse(0.15, 0.35, 0.8);\nsphere(0, 1, 0, 1);"),
    Entry::scene(Group::Lights, "directional", directional)
        .takes(&[&[
            vec3("direction", "none", "points towards the light, of any length but 0"),
            color("color", "its light"),
            map("options", "angle: degrees from the middle to the edge of a light that is a disk in the sky, above 0 and at most 90, for soft shadows (the sun's is 0.27); n: n x n jittered points of it, 4 unless given")
                .keys(&DIRECTIONAL_OPTIONS)
                .or("#{}"),
        ]])
        .doc("Parallel light from far away, never attenuated. With an angle it casts soft shadows.")
        .usage("directional([1, 1, 1], [1, 1, 1])")
        .example("background(\"#cfe3f5\");\ncamera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.08, 0.08, 0.1);\ndiffuse(0.8, 0.8, 0.75);\nplane();\ndirectional([2, 1.5, 1], [0.9, 0.8, 0.6]);   // low in the east\ndiffuse(0.8, 0.25, 0.15);\nfor x in -1..2 { sphere(x * 1.7, 0.6, 0, 0.6); }")
        .also(&["directionalLight", "sun", "distantLight"]),
    Entry::scene(Group::Lights, "attenuation", attenuation)
        .takes(&[&[
            number("constant", "none", "term of d^0"),
            number("linear", "per world unit", "term of d^1"),
            number("quadratic", "per square world unit", "term of d^2"),
        ]])
        .doc("Fall-off of the point and area lights made from now on: 1 / (constant + linear d + quadratic d^2). Default: 1, 0, 0, no fall-off.")
        .usage("attenuation(1, 0, 0.1)")
        .example("background(\"#cfe3f5\");\ncamera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.08, 0.08, 0.1);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nattenuation(0, 0, 0.4);\nlight([-2, 1.5, 1], [1.5, 1.4, 1.2]);\ndiffuse(0.8, 0.25, 0.15);\nfor x in -2..3 { sphere(x * 1.1, 0.5, 0, 0.5); }")
        .also(&["falloff"]),
    Entry::scene(Group::Lights, "areaLight", area_light)
        .takes(&[&[
            vec3("corner", "object units", "one corner of the parallelogram"),
            vec3("edge1", "object units", "from the corner to one neighbour"),
            vec3("edge2", "object units", "from the corner to the other neighbour"),
            color("color", "its light in all"),
            int("n", "points per edge", "n x n jittered points, 1 to 256"),
            map("options", "falloff: \"attenuation\" or \"physical\", as for diskLight; the front is where edge1, edge2 turn counter-clockwise")
                .keys(&SURFACE_OPTIONS)
                .or("#{}"),
        ]])
        .doc("A shining parallelogram that casts soft shadows, as a grid of jittered points. It is not seen itself.")
        .usage("areaLight([-1, 4, -1], [2, 0, 0], [0, 0, 2], [1, 1, 1], 4)")
        .example("background(\"#cfe3f5\");\ncamera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.08, 0.08, 0.1);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nareaLight([-1, 4, 1], [2, 0, 0], [0, 0, 2], [0.9, 0.85, 0.8], 4);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0.9, 0, 0.9);")
        .also(&["rectLight", "rectangleLight", "quadLight"]),
];

fn point(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (position, color) = (call.vec3("position")?, call.color("color")?);
    call.end()?;
    state.builder.point(position, color)?;
    DONE
}

fn directional(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (direction, color) = (call.vec3("direction")?, call.color("color")?);
    let options = options(call, &DIRECTIONAL_OPTIONS)?;
    call.end()?;
    if options.is_empty() {
        state.builder.directional(direction, color)?;
        return DONE;
    }
    let Some(angle) = options.get("angle") else {
        return Err(call
            .error("n is for a light with an angle")
            .hint("for example directional([1, 1, 1], [1, 1, 1], #{ angle: 2, n: 4 })"));
    };
    let n = options.get("n").map_or(Ok(4), |n| call.count_from("n", n, 1))?;
    let sun = Sun::new(direction, call.number_from("angle", angle)?, n)?;
    state.builder.sun(sun, color)?;
    DONE
}

fn attenuation(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let attenuation = Attenuation {
        constant: call.number("constant")?,
        linear: call.number("linear")?,
        quadratic: call.number("quadratic")?,
    };
    call.end()?;
    state.builder.attenuation(attenuation)?;
    DONE
}

fn area_light(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (corner, edge1, edge2) = (call.vec3("corner")?, call.vec3("edge1")?, call.vec3("edge2")?);
    let color = call.color("color")?;
    let n = call.count("n", 1)?;
    let options = options(call, &SURFACE_OPTIONS)?;
    call.end()?;
    if !options.is_empty() {
        let falloff = falloff(call, &options, state)?;
        let light = SurfaceLight::rectangle(corner, [edge1, edge2], n, falloff)?;
        state.builder.surface_light(light, color)?;
        return DONE;
    }
    state.builder.area_light(corner, edge1, edge2, color, n)?;
    DONE
}
