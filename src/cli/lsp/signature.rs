//! The forms of the function whose arguments are being written.

use serde_json::{Value, json};

use super::{
    documents::{Document, Documents},
    hover::{exported, kind, module_of, name_of},
};
use crate::{
    cli::help::forms::written,
    script::{
        Entry, Param,
        analysis::{Analysis, Call, Symbol, assigned},
        entry,
    },
};

/// Signature help for the call at `offset`.
pub(super) fn signature(documents: &Documents, document: &Document, offset: usize) -> Option<Value> {
    let text = document.analysis();
    if text.in_comment(offset) {
        return None;
    }
    let call = text.call_at(offset)?;
    let active = call.active(offset);
    let name = text.word(call.name);
    if call.module.is_some() {
        let file = module_of(text, call.name)?;
        return documents.module(document, &file, |module| {
            let there = module.analysis();
            let all = exported(there).filter(|s| name_of(there, s) == name);
            own(name, &all.collect::<Vec<_>>(), active)
        })?;
    }
    let functions: Vec<&Symbol> = text.functions_named(name).collect();
    match entry(name) {
        _ if !functions.is_empty() => own(name, &functions, active),
        Some(entry) => Some(of_entry(text, entry, &call, active)),
        None => None,
    }
}

fn of_entry(text: &Analysis, entry: &Entry, call: &Call, active: usize) -> Value {
    // What stands before the point is the first argument.
    let before = usize::from(matches!(text.word_near(call.name, -1), "." | "?."));
    // The first form that what is written so far fits.
    let fitting = entry.forms.iter().enumerate().find_map(|(i, form)| {
        let params = assigned(text, form.get(before..)?, &call.args, false)?;
        let next = match params.get(active) {
            Some(param) => before + *param,
            None if active == 0 => before,
            None => return None,
        };
        Some((i, next))
    });
    let signatures: Vec<Value> = entry
        .forms
        .iter()
        .map(|form| {
            json!({
                "label": format!("{}{}", entry.name, written(form)),
                "documentation": { "kind": "markdown", "value": entry.doc },
                "parameters": form.iter().map(parameter).collect::<Vec<_>>(),
            })
        })
        .collect();
    let (form, param) = fitting.unwrap_or((0, before + active));
    json!({ "signatures": signatures, "activeSignature": form, "activeParameter": param })
}

fn parameter(p: &Param) -> Value {
    let label = match p.default {
        Some(default) => format!("{} = {default}", p.name),
        None => p.name.to_owned(),
    };
    let three = if p.kind.spreads() {
        "; or three numbers in its place"
    } else {
        ""
    };
    json!({ "label": label, "documentation": format!("{}: {}{three}", kind(p), p.doc) })
}

/// The script's own functions of that name, that with the fewest parameters enough first chosen.
fn own(name: &str, functions: &[&Symbol], active: usize) -> Option<Value> {
    let chosen = functions
        .iter()
        .position(|f| f.params.len() > active)
        .unwrap_or(0);
    let signatures: Vec<Value> = functions
        .iter()
        .map(|f| {
            json!({
                "label": format!("{name}({})", f.params.join(", ")),
                "documentation": { "kind": "markdown", "value": f.doc },
                "parameters": f.params.iter().map(|p| json!({ "label": p })).collect::<Vec<_>>(),
            })
        })
        .collect();
    (!signatures.is_empty())
        .then(|| json!({ "signatures": signatures, "activeSignature": chosen, "activeParameter": active }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(text: &str) -> Option<(String, String)> {
        let at = text.find('^').unwrap();
        let mut documents = Documents::default();
        documents.open("file:///x/a.rhai", 1, &text.replacen('^', "", 1));
        documents.open("file:///x/m.rhai", 1, "fn tower(height, width) { }");
        let found = signature(&documents, documents.get("file:///x/a.rhai").unwrap(), at)?;
        let chosen = &found["signatures"][found["activeSignature"].as_u64().unwrap() as usize];
        let param = &chosen["parameters"][found["activeParameter"].as_u64().unwrap() as usize];
        Some((
            chosen["label"].as_str().unwrap().to_owned(),
            param["label"].as_str().unwrap_or("").to_owned(),
        ))
    }

    #[test]
    fn the_parameter_is_that_of_the_argument() {
        for (text, wanted) in [
            ("sphere(^", "center"),
            ("sphere([0, 0, 0], ^", "radius"),
            ("sphere(0, 0, 0^", "center"),
            ("sphere(0, 0, 0, ^", "radius"),
            ("sphere(0, 0, 0, 1^);", "radius"),
            ("light([1, 2, 3], ^", "color"),
            ("param(\"r\", 1, #{ min: ^", "options"),
            ("picture.pixel(^", "x"),
            ("picture.pixel(3, ^", "y"),
        ] {
            assert_eq!(help(text).unwrap().1, wanted, "{text}");
        }
        assert_eq!(help("sphere(1)^"), None);
        assert_eq!(help("sphere( // ^"), None);
    }

    #[test]
    fn the_form_is_that_which_fits() {
        assert_eq!(help("mesh(\"a.obj\", ^").unwrap().0, "mesh(file, options)");
        assert_eq!(help("mesh(#{ ^").unwrap().0, "mesh(data)");
    }

    #[test]
    fn own_functions_and_those_of_modules_have_signatures() {
        let text = "fn f(a) { } fn f(a, b) { } f(1, ^";
        assert_eq!(help(text).unwrap(), ("f(a, b)".to_owned(), "b".to_owned()));
        let text = "import \"m\" as m; m::tower(1, ^";
        assert_eq!(help(text).unwrap().1, "width");
    }
}
