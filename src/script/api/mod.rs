//! The functions of the language, one file per group, each a list of entries of the one table.

mod arrays;
mod assets;
mod camera;
mod colors;
mod csg;
mod curves;
mod edition;
mod environment;
mod finishes;
mod functions;
mod glasses;
mod heights;
mod lamps;
mod lights;
mod materials;
mod maths;
pub(super) mod moving;
mod noise;
mod numbers;
mod ordering;
mod output;
pub(super) mod params;
mod patterns;
mod queries;
mod random;
mod sdf;
mod sequences;
mod shapes;
mod solids;
mod splines;
mod splitting;
mod strings;
mod subdivide;
mod surfaces;
mod text;
mod texts;
mod transform;
mod turning;
mod vector;
mod views;

pub(super) use queries::Queries;
pub(super) use random::Stream;
#[cfg(test)]
pub(super) use {random::StreamValue, splines::CurveValue};

use rhai::Module;

use super::table::{Entry, Kind, Param};

/// Every list, in the order of the reference.
pub(super) const ALL: [&[Entry]; 32] = [
    edition::ENTRIES,
    camera::ENTRIES,
    views::ENTRIES,
    transform::ENTRIES,
    turning::ENTRIES,
    moving::ENTRIES,
    shapes::ENTRIES,
    csg::ENTRIES,
    sdf::ENTRIES,
    solids::ENTRIES,
    materials::ENTRIES,
    colors::ENTRIES,
    finishes::ENTRIES,
    patterns::ENTRIES,
    assets::ENTRIES,
    heights::ENTRIES,
    text::ENTRIES,
    surfaces::ENTRIES,
    subdivide::ENTRIES,
    curves::ENTRIES,
    lights::ENTRIES,
    queries::ENTRIES,
    lamps::ENTRIES,
    environment::ENTRIES,
    output::ENTRIES,
    params::ENTRIES,
    vector::ENTRIES,
    maths::ENTRIES,
    splines::ENTRIES,
    sequences::ENTRIES,
    random::ENTRIES,
    noise::ENTRIES,
];

/// What is no function of the table: operators, properties and conversions of our types, and replacements of
/// functions of Rhai's that are not portable or not safe.
pub(super) fn extend(module: &mut Module) {
    vector::extend(module);
    output::extend(module);
    materials::extend(module);
    random::extend(module);
    splines::extend(module);
    arrays::extend(module);
    ordering::extend(module);
    splitting::extend(module);
    numbers::extend(module);
    strings::extend(module);
    texts::extend(module);
    functions::extend(module);
    sdf::extend(module);
}

const fn number(name: &'static str, unit: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Number, unit, doc)
}

const fn int(name: &'static str, unit: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Int, unit, doc)
}

const fn vec3(name: &'static str, unit: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Vec3, unit, doc)
}

const fn color(name: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Color, "linear RGB", doc)
}

const fn term(name: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Term, "linear RGB", doc)
}

/// A number that a texture may make vary.
const fn amount(name: &'static str, unit: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::NumberOrTexture, unit, doc)
}

const fn string(name: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::String, "none", doc)
}

const fn map(name: &'static str, doc: &'static str) -> Param {
    Param::new(name, Kind::Map, "none", doc)
}
