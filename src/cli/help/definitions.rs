//! `.d.rhai` definitions, in the form in which Rhai writes them for its language server.

use std::fmt::Write as _;

use crate::script::{CONSTANTS, Entry, Kind, PROPERTIES, Param, entries};

const HEAD: &str = "\
module static;

// What rtscript adds to Rhai. Made by `rtscript help --definitions`.
// `group { }` and `define \"name\" { }` are blocks of their own and no functions:
// an editor needs no definition for them.
";

/// All functions, properties and constants.
pub(super) fn definitions() -> String {
    let mut text = HEAD.to_owned();
    for c in CONSTANTS {
        add(&mut text, c.doc, &[format!("const {}: float;", c.name)]);
    }
    for p in PROPERTIES {
        let kind = type_name(p.kind);
        let mut lines = vec![format!("fn get {}(value: {}) -> {kind};", p.name, p.of)];
        if p.can_be_set {
            lines.push(format!("fn set {}(value: {}, to: {kind}) -> ();", p.name, p.of));
        }
        add(&mut text, p.doc, &lines);
    }
    for entry in entries().filter(|e| !is_block(e)) {
        for form in entry.forms {
            let spread = form.iter().any(|p| p.kind.spreads());
            add(&mut text, entry.doc, &functions(entry, form, spread));
        }
    }
    text
}

fn is_block(entry: &Entry) -> bool {
    entry
        .forms
        .iter()
        .copied()
        .flatten()
        .any(|p| p.kind == Kind::Block)
}

/// The text over each line, as a documentation comment.
fn add(text: &mut String, doc: &str, lines: &[String]) {
    for line in lines {
        // Writing into a String does not fail.
        let _ = write!(text, "\n/// {doc}\n{line}\n");
    }
}

/// A form, with and without what may be left out, with vectors as such and spelled out.
fn functions(entry: &Entry, form: &[Param], spread: bool) -> Vec<String> {
    let mut lines = Vec::new();
    let shortest = form.iter().take_while(|p| p.default.is_none()).count();
    for count in shortest..=form.len() {
        let params = form.get(..count).unwrap_or(form);
        lines.push(function(entry, params, false));
        if spread {
            lines.push(function(entry, params, true));
        }
    }
    lines
}

fn function(entry: &Entry, params: &[Param], spread: bool) -> String {
    let list: Vec<String> = params
        .iter()
        .map(|p| match p.kind {
            Kind::Vec3 if spread => components(p, ["x", "y", "z"]),
            Kind::Color | Kind::Term if spread => components(p, ["r", "g", "b"]),
            kind => format!("{}: {}", p.name, type_name(kind)),
        })
        .collect();
    let returns = match entry.returns {
        "nothing" => "()",
        "int" | "float" | "vec3" | "image" | "texture" | "sdf" => entry.returns,
        "map" => "Map",
        _ => "?",
    };
    format!("fn {}({}) -> {returns};", entry.name, list.join(", "))
}

fn components(p: &Param, names: [&str; 3]) -> String {
    names.map(|n| format!("{}_{n}: float", p.name)).join(", ")
}

/// A type of Rhai's, or `?` where several are taken.
fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Number => "float",
        Kind::Int => "int",
        Kind::Vec3 => "vec3",
        Kind::String => "String",
        Kind::Array => "Array",
        Kind::Map => "Map",
        Kind::Image => "image",
        Kind::Stream => "random stream",
        Kind::Curve => "curve",
        Kind::Function => "Fn",
        Kind::Sdf => "sdf",
        Kind::Color
        | Kind::Term
        | Kind::NumberOrVec3
        | Kind::NumberOrTexture
        | Kind::List
        | Kind::Field
        | Kind::Block
        | Kind::Any => "?",
    }
}
