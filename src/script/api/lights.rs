//! Lights, placed under the current matrix.

use super::{color, int, number, vec3};
use crate::{
    scene::Attenuation,
    script::{
        call::Call,
        session::State,
        table::{DONE, Entry, Group, Param},
        value::Outcome,
    },
};

const POINT: &[Param] = &[
    vec3("position", "object units", "where it is"),
    color("color", "its light; components may exceed 1"),
];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lights, "light", point)
        .takes(&[POINT])
        .doc("A point light under the current matrix. Without attenuation() it does not fade with distance.")
        .usage("light([5, 5, 5], [1, 1, 1])")
        .example("light([3, 4, 5], [1, 1, 1]);\ndiffuse(0.8, 0.3, 0.2);\nsphere(0, 0, 0, 1);")
        .also(&["pointLight", "lamp", "spotLight"]),
    Entry::scene(Group::Lights, "point", point)
        .takes(&[POINT])
        .doc("The same as light(position, color), under the name the CSE167 course gives it.")
        .usage("point([5, 5, 5], [1, 1, 1])")
        .example("point([3, 4, 5], [1, 1, 1]);\ndiffuse(0.8, 0.3, 0.2);\nsphere(0, 0, 0, 1);"),
    Entry::scene(Group::Lights, "directional", directional)
        .takes(&[&[
            vec3("direction", "none", "points towards the light, of any length but 0"),
            color("color", "its light"),
        ]])
        .doc("Parallel light from far away, never attenuated.")
        .usage("directional([1, 1, 1], [1, 1, 1])")
        .example("directional([1, 2, 2], [0.9, 0.9, 0.8]);\ndiffuse(0.8, 0.3, 0.2);\nsphere(0, 0, 0, 1);")
        .also(&["directionalLight", "sun", "distantLight"]),
    Entry::scene(Group::Lights, "attenuation", attenuation)
        .takes(&[&[
            number("constant", "none", "term of d^0"),
            number("linear", "per world unit", "term of d^1"),
            number("quadratic", "per square world unit", "term of d^2"),
        ]])
        .doc("Fall-off of the point and area lights made from now on: 1 / (constant + linear d + quadratic d^2). Default: 1, 0, 0, no fall-off.")
        .usage("attenuation(1, 0, 0.1)")
        .example("attenuation(0, 0, 0.05);\nlight([3, 4, 5], [2, 2, 2]);\ndiffuse(0.8, 0.3, 0.2);\nsphere(0, 0, 0, 1);")
        .also(&["falloff"]),
    Entry::scene(Group::Lights, "areaLight", area_light)
        .takes(&[&[
            vec3("corner", "object units", "one corner of the parallelogram"),
            vec3("edge1", "object units", "from the corner to one neighbour"),
            vec3("edge2", "object units", "from the corner to the other neighbour"),
            color("color", "its light in all"),
            int("n", "points per edge", "n x n jittered points, 1 to 256"),
        ]])
        .doc("A shining parallelogram that casts soft shadows, as a grid of jittered points. It is not seen itself.")
        .usage("areaLight([-1, 4, -1], [2, 0, 0], [0, 0, 2], [1, 1, 1], 4)")
        .example("areaLight([-1, 4, 1], [2, 0, 0], [0, 0, 2], [1, 1, 1], 3);\ndiffuse(0.8, 0.8, 0.8);\nsphere(0, 0, 0, 1);\nsphere(0, -101, 0, 100);")
        .also(&["rectLight", "quadLight", "softLight"]),
];

fn point(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (position, color) = (call.vec3("position")?, call.color("color")?);
    call.end()?;
    state.builder.point(position, color)?;
    DONE
}

fn directional(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (direction, color) = (call.vec3("direction")?, call.color("color")?);
    call.end()?;
    state.builder.directional(direction, color)?;
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
    call.end()?;
    state.builder.area_light(corner, edge1, edge2, color, n)?;
    DONE
}
