//! The table as JSON, for editors and other programs.

use serde_json::{Value, json};

use super::{example::Examples, forms::forms, markdown};
use crate::{
    diag::{Code, Error},
    script::{CONSTANTS, Entry, Group, Kind, PROPERTIES, Param, entries},
};

/// Everything: functions, properties, constants, and what the kinds of parameters are.
///
/// # Errors
/// Whatever is wrong with an example.
pub(super) fn api(examples: &Examples) -> Result<String, Error> {
    let functions: Vec<Value> = entries()
        .map(|entry| function(examples, entry))
        .collect::<Result<_, _>>()?;
    let properties: Vec<Value> = PROPERTIES
        .iter()
        .map(|p| {
            json!({ "of": p.of, "name": p.name, "type": p.kind.name(), "writable": p.can_be_set, "doc": p.doc })
        })
        .collect();
    let constants: Vec<Value> = CONSTANTS
        .iter()
        .map(|c| json!({ "name": c.name, "value": c.value, "doc": c.doc }))
        .collect();
    let kinds: Vec<Value> = Kind::ALL
        .into_iter()
        .map(|k| json!({ "name": k.name(), "three_numbers": k.spreads(), "doc": k.doc() }))
        .collect();
    let groups: Vec<Value> = Group::ALL
        .into_iter()
        .map(|g| json!({ "name": g.title(), "doc": g.doc() }))
        .collect();
    let messages: Vec<Value> = Code::ALL
        .iter()
        .map(|code| json!({ "code": code.name(), "severity": code.severity().name(), "doc": code.explanation() }))
        .collect();
    let api = json!({
        "groups": groups,
        "functions": functions,
        "properties": properties,
        "constants": constants,
        "types": kinds,
        "messages": messages,
    });
    Ok(format!("{api:#}\n"))
}

fn function(examples: &Examples, entry: &Entry) -> Result<Value, Error> {
    let example = examples.of(entry)?;
    Ok(json!({
        "name": entry.name,
        "group": entry.group.title(),
        "signatures": forms(entry),
        "forms": entry.forms.iter().map(|form| form.iter().map(parameter).collect()).collect::<Vec<Vec<Value>>>(),
        "returns": entry.returns,
        "doc": entry.doc,
        "usage": entry.usage,
        "example": entry.example,
        "prints": example.printed,
        "picture": example.picture.as_ref().map(|_| markdown::picture_of(entry)),
        "also_called": entry.also,
    }))
}

fn parameter(p: &Param) -> Value {
    let unit = (p.unit != "none").then_some(p.unit);
    json!({ "name": p.name, "type": p.kind.name(), "unit": unit, "default": p.default, "doc": p.doc })
}
