//! The matrix stack and blocks.

use rhai::{Array, Dynamic};

use super::{number, string, vec3};
use crate::{
    math::DVec3,
    script::{
        call::{Call, kind_of, number_of},
        lists::{tuple, tuples_with},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Transform, "pushTransform", push)
        .doc("Saves the current matrix, until the popTransform() that belongs to it. The material is not saved; group { } saves both.")
        .usage("pushTransform()")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\npushTransform();\ntranslate(-1.2, 0, 0);\nrotate(1, 1, 0, 35);\nbox(1.2, 1.2, 1.2);\npopTransform();\ndiffuse(0.15, 0.35, 0.8);\nsphere(1.2, 0, 0, 0.8);")
        .also(&["pushMatrix", "save", "push"]),
    Entry::scene(Group::Transform, "popTransform", pop)
        .doc("Restores the matrix that the last pushTransform() saved.")
        .usage("popTransform()")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nfor i in 0..5 {\n  pushTransform();\n  translate(i - 2, 0, 0);\n  scale(0.4, 0.4 + i * 0.3, 0.4);\n  cylinder(1, 1);\n  popTransform();\n}")
        .also(&["popMatrix", "restore"]),
    Entry::scene(Group::Transform, "translate", translate)
        .takes(&[&[vec3("v", "object units", "how far along x, y and z")]])
        .doc("Moves what is made from now on. Multiplies the current matrix on the right, as in OpenGL: the call nearest the shape acts first.")
        .usage("translate(1, 0, 0)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.7, 0.7, 0.7);\nsphere(0, 0, 0, 0.5);\ntranslate(1.5, 0.8, 0);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0, 0, 0.5);")
        .also(&["move", "translateX", "translateY", "translateZ"]),
    Entry::scene(Group::Transform, "rotate", rotate)
        .takes(&[&[
            vec3("axis", "none", "the axis, of any length but 0"),
            number("degrees", "degrees", "right-handed: about Y, from Z to X"),
        ]])
        .doc("Turns what is made from now on about an axis through the origin, by the right-hand rule.")
        .usage("rotate(0, 1, 0, 45)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.9, 0.6, 0.1);\nfor i in 0..12 {\n  group {\n    rotate(0, 0, 1, i * 30);\n    translate(0, 1.3, 0);\n    box(0.25, 0.8, 0.25);\n  }\n}")
        .also(&["rotateX", "rotateY", "rotateZ", "turn"]),
    Entry::scene(Group::Transform, "scale", scale)
        .takes(&[
            &[vec3("v", "none", "factors along x, y and z; none may be 0")],
            &[number("s", "none", "one factor for all axes")],
        ])
        .doc("Stretches what is made from now on, away from the origin. A negative factor mirrors.")
        .usage("scale(2, 1, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nscale(2, 1, 1);\nsphere(0, 0, 0, 1);"),
    Entry::scene(Group::Transform, "multMatrix", mult_matrix)
        .takes(&[&[Param::new(
            "matrix",
            Kind::Array,
            "none",
            "16 numbers row by row; the last row must be 0, 0, 0, 1",
        )]])
        .doc("Multiplies the current matrix by a matrix of your own. It acts on column vectors: the last column moves.")
        .usage("multMatrix([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.15, 0.5, 0.4);\nrotate(0, 1, 0, -30);\nmultMatrix([1, 0.5, 0, 0,   // x leans over as y grows\n            0, 1, 0, 0,\n            0, 0, 1, 0,\n            0, 0, 0, 1]);\nbox(1.5, 2, 1);")
        .also(&["applyMatrix", "transform"]),
    Entry::scene(Group::Transform, "loadMatrix", load_matrix)
        .takes(&[&[Param::new(
            "matrix",
            Kind::Array,
            "none",
            "16 numbers row by row, the last row 0, 0, 0, 1, or the first 12 of them",
        )]])
        .doc("Sets the current matrix, to the bit, whatever it was. Inside define that is the place in the definition's own space.")
        .usage("loadMatrix([1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ntranslate(-1.5, 1, 0);\ndiffuse(0.7, 0.7, 0.7);\nsphere(0, 0, 0, 0.5);\nloadMatrix([1, 0.5, 0, 0.8,   // not where the ball is\n            0, 1, 0, -0.3,\n            0, 0, 1, 0]);\ndiffuse(0.15, 0.5, 0.4);\nbox(1, 1.4, 1);")
        .also(&["setMatrix", "setTransform"]),
    Entry::scene(Group::Transform, "loadIdentity", load_identity)
        .doc("Sets the current matrix to the identity. Inside define that is the definition's own space.")
        .usage("loadIdentity()")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ntranslate(-1.5, 1, 0);\ndiffuse(0.7, 0.7, 0.7);\nsphere(0, 0, 0, 0.5);\nloadIdentity();          // back in the middle\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0, 0, 0.8);")
        .also(&["resetMatrix", "identity"]),
    Entry::syntax(Group::Transform, "group")
        .takes(&[&[Param::new("block", Kind::Block, "none", "statements, in the scope they stand in")]])
        .doc("Saves matrix and material, runs the block, and restores both however the block is left: at its end, by break, continue, return or an error.")
        .usage("group { translate(1, 0, 0); sphere(0, 0, 0, 1); }")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\ngroup {\n  translate(-1.2, 0, 0);\n  diffuse(0.15, 0.35, 0.8);\n  sphere(0, 0, 0, 0.9);\n}\nsphere(1.2, 0, 0, 0.9);   // neither moved nor blue")
        .also(&["scope", "layer"]),
    Entry::syntax(Group::Transform, "define")
        .takes(&[&[
            string("name", "what instance(name) will call it"),
            Param::new("block", Kind::Block, "none", "statements that build the group in its own object space"),
        ]])
        .doc("Builds a group of shapes once, in an object space of its own. It is seen where instance(name) places it.")
        .usage("define \"car\" { sphere(0, 0, 0, 1); }")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"snowman\" {\n  diffuse(0.9, 0.9, 0.95);\n  sphere(0, 0.5, 0, 0.5);\n  sphere(0, 1.2, 0, 0.33);\n  diffuse(0.9, 0.4, 0.1);\n  sphere(0, 1.2, 0.35, 0.08);\n}\nfor i in -1..2 {\n  group { translate(i * 1.5, -0.8, 0); instance(\"snowman\"); }\n}"),
    Entry::scene(Group::Transform, "instance", instance)
        .takes(&[&[string("name", "as given to define")]])
        .doc("Places a defined group under the current matrix, any number of times, also inside another define, up to 32 levels deep. Geometry and acceleration structure are shared.")
        .usage("instance(\"car\")")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"tree\" {\n  diffuse(0.15, 0.5, 0.2);\n  cone(0.4, 1.2);\n}\nfor x in -3..4 {\n  group { translate(x * 0.75, -0.2 * abs(x), 0); instance(\"tree\"); }\n}")
        .also(&["use", "place", "copy"]),
    Entry::scene(Group::Transform, "instances", instances)
        .takes(&[&[
            string("name", "as given to define"),
            Param::new(
                "matrices",
                Kind::List,
                "none",
                "matrices of 16 numbers row by row as multMatrix takes them, or of the first 12; or the 16 numbers of each in one flat list or blob",
            ),
        ]])
        .doc("Places a defined group many times, each as multMatrix(matrix) and instance(name) would between a push and a pop. A blob holds floats as write_le writes them, 8 bytes each.")
        .usage("instances(\"car\", [[1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"ball\" { diffuse(0.15, 0.35, 0.8); sphere(0, 0, 0, 0.4); }\nlet matrices = [];\nfor x in -2..3 {\n  matrices.push([1, 0, 0, x,\n                 0, 1 + x * x / 2.0, 0, 0,\n                 0, 0, 1, 0]);\n}\ninstances(\"ball\", matrices);")
        .also(&["scatter", "copies"]),
];

fn push(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    call.end()?;
    state.builder.push_transform()?;
    DONE
}

fn pop(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    call.end()?;
    state.builder.pop_transform()?;
    DONE
}

fn translate(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let by = call.vec3("v")?;
    call.end()?;
    state.builder.translate(by)?;
    DONE
}

fn rotate(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let axis = call.vec3("axis")?;
    let degrees = call.number("degrees")?;
    call.end()?;
    state.builder.rotate(axis, degrees)?;
    DONE
}

fn scale(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let by = if call.len() == 1 && call.peek().and_then(number_of).is_some() {
        DVec3::splat(call.number("s")?)
    } else {
        call.vec3("v")?
    };
    call.end()?;
    state.builder.scale(by)?;
    DONE
}

const ROW_BY_ROW: &str = "row by row, in one list: [1, 0, 0, x,  0, 1, 0, y,  0, 0, 1, z,  0, 0, 0, 1]";

fn mult_matrix(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let Some(array) = given.read_lock::<Array>() else {
        return Err(call.wrong_kind("matrix", "an array of 16 numbers", given));
    };
    if array.len() != 16 {
        return Err(call
            .error(format!(
                "matrix must be an array of 16 numbers, not of {}",
                array.len()
            ))
            .hint(ROW_BY_ROW));
    }
    let mut rows = [0.0; 16];
    for (i, (to, from)) in rows.iter_mut().zip(array.iter()).enumerate() {
        *to = number_of(from)
            .ok_or_else(|| call.error(format!("matrix[{i}] must be a number, not {}", kind_of(from))))?;
    }
    state.builder.mult_matrix(&rows)?;
    DONE
}

fn load_matrix(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let rows = rows(call, &|| "matrix".to_owned(), given)?;
    state.builder.load_matrix(&rows)?;
    DONE
}

/// A matrix of 16 numbers row by row, or of the first 12.
fn rows(call: &Call<'_, '_>, name: &dyn Fn() -> String, d: &Dynamic) -> Outcome<[f64; 16]> {
    let twelve = d.read_lock::<Array>().is_some_and(|rows| rows.len() == 12);
    if !twelve {
        return tuple(call, name, d).map_err(|e| e.hint(ROW_BY_ROW));
    }
    let rows: [f64; 12] = tuple(call, name, d)?;
    let mut all = [0.0; 16];
    for (to, x) in all.iter_mut().zip(rows.into_iter().chain([0.0, 0.0, 0.0, 1.0])) {
        *to = x;
    }
    Ok(all)
}

fn load_identity(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    call.end()?;
    state.builder.load_identity();
    DONE
}

fn instance(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    call.end()?;
    state.builder.instance(&name)?;
    DONE
}

fn instances(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    let given = call.any()?;
    call.end()?;
    let matrices = tuples_with::<16>(call, "matrices", given, |name, d| rows(call, name, d))?;
    state.builder.instances(&name, &matrices)?;
    DONE
}
