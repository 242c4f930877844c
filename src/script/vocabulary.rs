//! Properties and constants of the language, for the reference beside the table of functions, and the files that its
//! examples name.

use super::table::Kind;

/// A property of a value: `value.name`.
///
/// ```
/// use rtscript::script::{CONSTANTS, Constant, PROPERTIES, Property};
/// let names: Vec<&str> = PROPERTIES.iter().map(|property: &Property| property.name).collect();
/// assert!(names.contains(&"x"));
/// assert!(CONSTANTS.iter().any(|constant: &Constant| constant.name == "PI"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Property {
    /// The type that has it.
    pub of: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it gives.
    pub kind: Kind,
    /// True where it can be assigned to.
    pub can_be_set: bool,
    /// What it means.
    pub doc: &'static str,
}

/// Every property of the types that scenes add to the language.
pub const PROPERTIES: &[Property] = &[
    component("x"),
    component("y"),
    component("z"),
    Property {
        of: "image",
        name: "width",
        kind: Kind::Int,
        can_be_set: false,
        doc: "Pixels across.",
    },
    Property {
        of: "image",
        name: "height",
        kind: Kind::Int,
        can_be_set: false,
        doc: "Pixels down.",
    },
    Property {
        of: "error",
        name: "message",
        kind: Kind::String,
        can_be_set: false,
        doc: "What a function had to say against its arguments, where catch (e) caught it.",
    },
];

const fn component(name: &'static str) -> Property {
    Property {
        of: "vec3",
        name,
        kind: Kind::Number,
        can_be_set: true,
        doc: "A component of the vector.",
    }
}

/// A number that every script knows, inside its functions too.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it is.
    pub doc: &'static str,
}

/// Every constant of the language.
pub const CONSTANTS: &[Constant] = &[
    Constant {
        name: "PI",
        value: std::f64::consts::PI,
        doc: "Half a turn in radians.",
    },
    Constant {
        name: "TAU",
        value: std::f64::consts::TAU,
        doc: "A whole turn in radians.",
    },
    Constant {
        name: "E",
        value: std::f64::consts::E,
        doc: "The base of natural logarithms.",
    },
];

/// The files that the examples of the table name, each with its bytes: a script that is to run an example needs them.
pub const EXAMPLE_FILES: &[(&str, &[u8])] = &[
    ("tetrahedron.obj", include_bytes!("examples/tetrahedron.obj")),
    ("wood.png", include_bytes!("examples/wood.png")),
];
