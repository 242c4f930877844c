//! Matrices by what they are to achieve.

use super::vec3;
use crate::{
    math::DVec3,
    script::{
        call::Call,
        session::State,
        table::{DONE, Entry, Group, Param},
        value::Outcome,
    },
};

const FROM: Param = vec3(
    "from",
    "object units",
    "where the origin goes; without it, it stays",
);
const AT: Param = vec3("at", "object units", "the point that +z looks at");
const UP: Param = vec3(
    "up",
    "none",
    "where +y points, as far as it can; [0, 1, 0] without it",
);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Transform, "lookAt", look_at)
        .takes(&[&[AT], &[AT, UP], &[FROM, AT, UP]])
        .doc("Turns what is made from now on so that its +z looks at a point. With three vectors it moves there first, as camera(from, at, up, fovy) stands.")
        .usage("lookAt([0, 1, 5])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"eye\" {\n  diffuse(0.9, 0.9, 0.9); sphere(0, 0, 0, 0.3);\n  diffuse(0.1, 0.2, 0.5); sphere(0, 0, 0.2, 0.16);\n}\ndiffuse(0.8, 0.25, 0.15);\nlet bug = vec3(0.6, 0.5, 1.5);\nsphere(bug, 0.12);\nfor x in -2..3 {\n  for y in -1..2 {\n    group { translate(x, y, 0); lookAt(bug - vec3(x, y, 0)); instance(\"eye\"); }\n  }\n}")
        .also(&["look_at", "face", "pointAt", "trackTo", "orient"]),
    Entry::scene(Group::Transform, "alignTo", align_to)
        .takes(&[&[vec3("direction", "none", "where +y is to point, of any length but 0")]])
        .doc("Turns what is made from now on, on the shortest way, so that its y axis points along a direction: a tree along a normal, a cone along a path.")
        .usage("alignTo([1, 1, 0])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.6, 0.2);\nsphere(0, 0, 0, 1);\ndiffuse(0.3, 0.4, 0.25);\nfor i in 0..150 {\n  let d = randomUnit();\n  group { translate(d * 1.15); alignTo(d); cone(0.06, 0.4); }\n}")
        .also(&["align", "Reorient", "Point_At", "rotateTo"]),
    Entry::scene(Group::Transform, "between", between)
        .takes(&[&[
            vec3("a", "object units", "where y = -0.5 goes"),
            vec3("b", "object units", "where y = 0.5 goes"),
        ]])
        .doc("Moves, turns and stretches what is made from now on along y so that a shape of height 1 reaches from one point to another: between(a, b); cylinder(0.1, 1); is a rod of radius 0.1.")
        .usage("between([0, 0, 0], [1, 2, 0])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet corners = [];\nfor i in 0..8 {\n  corners.push(vec3(i % 2, i / 2 % 2, i / 4) * 2 - vec3(1, 1, 1));\n}\nrotate(1, 1, 0, 30);\ndiffuse(0.8, 0.25, 0.15);\nfor c in corners { sphere(c, 0.16); }\ndiffuse(0.6, 0.6, 0.6);\nfor a in 0..8 {\n  for b in a + 1..8 {\n    if distance(corners[a], corners[b]) > 2.01 { continue; }\n    group { between(corners[a], corners[b]); cylinder(0.06, 1); }\n  }\n}")
        .also(&["rod", "stick", "strut", "edge", "beam"]),
];

fn look_at(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let first = call.vec3("at")?;
    let second = if call.rest() > 0 {
        Some(call.vec3("up")?)
    } else {
        None
    };
    let third = if call.rest() > 0 {
        Some(call.vec3("up")?)
    } else {
        None
    };
    call.end()?;
    let (from, at, up) = match (second, third) {
        (Some(at), Some(up)) => (first, at, up),
        (up, _) => (DVec3::ZERO, first, up.unwrap_or(DVec3::Y)),
    };
    state.builder.look_at(from, at, up)?;
    DONE
}

fn align_to(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let direction = call.vec3("direction")?;
    call.end()?;
    state.builder.align_to(direction)?;
    DONE
}

fn between(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (a, b) = (call.vec3("a")?, call.vec3("b")?);
    call.end()?;
    state.builder.between(a, b)?;
    DONE
}
