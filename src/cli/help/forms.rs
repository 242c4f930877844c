//! The forms of a function as they are written.

use crate::script::{Entry, Kind, Param};

/// One line for each form: `rotate(axis, degrees)`, `log(x, base = 10) -> float`, `define name { ... }`.
pub(in crate::cli) fn forms(entry: &Entry) -> Vec<String> {
    let returns = match entry.returns {
        "nothing" => String::new(),
        what => format!(" -> {what}"),
    };
    entry
        .forms
        .iter()
        .map(|params| format!("{}{}{returns}", entry.name, written(params)))
        .collect()
}

pub(in crate::cli) fn written(params: &[Param]) -> String {
    let is_block = |p: &Param| p.kind == Kind::Block;
    if params.iter().any(is_block) {
        let before = params.iter().filter(|p| !is_block(p));
        let names: Vec<&str> = before.map(|p| p.name).chain(["{ ... }"]).collect();
        return format!(" {}", names.join(" "));
    }
    let names: Vec<String> = params
        .iter()
        .map(|p| match p.default {
            Some(default) => format!("{} = {default}", p.name),
            None => p.name.to_owned(),
        })
        .collect();
    format!("({})", names.join(", "))
}

/// The parameters of all forms, each once.
pub(in crate::cli) fn parameters(entry: &Entry) -> Vec<&'static Param> {
    let mut all: Vec<&Param> = Vec::new();
    for param in entry.forms.iter().copied().flatten() {
        let same = |p: &&Param| p.name == param.name && p.kind == param.kind && p.doc == param.doc;
        if !all.iter().any(same) {
            all.push(param);
        }
    }
    all
}
