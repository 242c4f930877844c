//! Shapes.

use super::{number, vec3};
use crate::script::{
    call::Call,
    session::State,
    table::{DONE, Entry, Group},
    value::Outcome,
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Shapes, "sphere", sphere)
        .takes(&[&[
            vec3("center", "object units", "the center"),
            number("radius", "object units", "greater than 0"),
        ]])
        .doc("A sphere. Under scale(x, y, z) it is an ellipsoid.")
        .usage("sphere(0, 0, 0, 1)")
        .example("light([5, 5, 5], [1, 1, 1]);\ndiffuse(0.8, 0.2, 0.1);\nsphere(0, 0, 0, 1);")
        .also(&["ball", "ellipsoid", "orb"]),
    Entry::scene(Group::Shapes, "tri", tri)
        .takes(&[
            &[
                vec3("a", "object units", "first corner"),
                vec3("b", "object units", "second corner"),
                vec3("c", "object units", "third corner"),
            ],
            &[
                vec3("a", "object units", "first corner"),
                vec3("b", "object units", "second corner"),
                vec3("c", "object units", "third corner"),
                vec3("na", "none", "normal at a, of any length but 0"),
                vec3("nb", "none", "normal at b"),
                vec3("nc", "none", "normal at c"),
            ],
        ])
        .doc("A triangle; counter-clockwise is the front. With normals at its corners it is shaded smoothly.")
        .usage("tri([0, 0, 0], [1, 0, 0], [0, 1, 0])")
        .example("light([1, 2, 5], [1, 1, 1]);\ndiffuse(0.2, 0.5, 0.9);\ntri([-1, -1, 0], [1, -1, 0], [0, 1, 0]);\ntri([1, -1, 0], [2, -1, 0], [2, 1, -1], [0, 0, 1], [1, 0, 1], [1, 1, 1]);")
        .also(&["triangle", "face"]),
];

fn sphere(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let center = call.vec3("center")?;
    let radius = call.number("radius")?;
    call.end()?;
    state.builder.sphere(center, radius)?;
    DONE
}

fn tri(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let positions = [call.vec3("a")?, call.vec3("b")?, call.vec3("c")?];
    let normals = if call.rest() > 0 {
        Some([call.vec3("na")?, call.vec3("nb")?, call.vec3("nc")?])
    } else {
        None
    };
    call.end()?;
    state.builder.triangle(positions, normals)?;
    DONE
}
