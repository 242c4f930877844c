//! What a check found, for the client.

use std::{ops::Range, path::Path};

use serde_json::{Value, json};

use super::{check::Checked, documents::Document, text::word_at, uri, wire};
use crate::{
    diag::{Code, Diagnostic, Severity},
    script::analysis::is_word,
};

/// Most diagnostics of one document.
const MOST: usize = 200;

/// A diagnostic as it was sent, with what could be written instead.
#[derive(Debug)]
pub(super) struct Published {
    pub(super) range: Range<usize>,
    pub(super) shown: Value,
    /// Names that were perhaps meant.
    pub(super) instead: Vec<String>,
}

/// What is said about a document.
pub(super) fn published(document: &Document, checked: &Checked) -> Vec<Published> {
    // What looks wrong about the scene as a whole says nothing of a file that only defines functions.
    let is_module = document.analysis().is_library();
    let found = checked.found.iter().filter(|d| {
        let concerns_whole = d.severity == Severity::Warning && d.line == 0;
        !(is_module && concerns_whole)
    });
    let mut all: Vec<Published> = found.take(MOST).map(|d| one(document, d)).collect();
    if checked.unfinished {
        let range = word_at(&document.text, 0, 0);
        let shown = json!({
            "range": document.span(&range),
            "severity": 3,
            "source": "rtscript",
            "message": "the script takes long: only its first 10 s were looked at (rtscript check runs it to its end)",
        });
        all.push(Published {
            range,
            shown,
            instead: Vec::new(),
        });
    }
    all
}

fn one(document: &Document, d: &Diagnostic) -> Published {
    let name = document.name();
    let places: Vec<Place<'_>> = d.notes.iter().filter_map(|note| place(note)).collect();
    let elsewhere = d.file.as_deref().filter(|file| *file != name);
    let (line, column) = match elsewhere {
        None => (d.line, d.column),
        // The outermost of the calls or imports in this file that lead there.
        Some(_) => places
            .iter()
            .rfind(|p| p.file == name)
            .map_or((0, 0), |p| (p.line, p.column)),
    };
    let range = word_at(&document.text, line, column);
    let mut message = match elsewhere {
        Some(file) => format!("{}: {}", short(file, d.line), d.message),
        None => d.message.clone(),
    };
    for note in d.notes.iter().filter(|note| place(note).is_none()) {
        message += &format!("\nnote: {note}");
    }
    for hint in &d.hints {
        message += &format!("\nhelp: {hint}");
    }
    let there = elsewhere.map(|file| Place {
        what: &d.message,
        file,
        line: d.line,
        column: d.column,
    });
    let related: Vec<Value> = there
        .into_iter()
        .chain(places)
        .map(|p| related(document, &p))
        .collect();
    let mut shown = json!({
        "range": document.span(&range),
        "severity": match d.severity { Severity::Error => 1, Severity::Warning => 2 },
        "source": "rtscript",
        "code": d.code.name(),
        "message": message,
    });
    // What an editor shows faded.
    if d.code == Code::UnreachedLine {
        wire::add(&mut shown, "tags", json!([1]));
    }
    if !related.is_empty() {
        wire::add(&mut shown, "relatedInformation", Value::Array(related));
    }
    let instead = match elsewhere {
        None if document
            .text
            .get(range.clone())
            .is_some_and(|w| w.chars().all(is_word)) =>
        {
            d.hints.iter().flat_map(|hint| meant(hint)).collect()
        }
        _ => Vec::new(),
    };
    Published {
        range,
        shown,
        instead,
    }
}

/// The file's name and the line.
fn short(file: &str, line: u32) -> String {
    let name = file.rsplit('/').next().unwrap_or(file);
    match line {
        0 => name.to_owned(),
        line => format!("{name}:{line}"),
    }
}

/// A note that has a place: "called from tower() at scene.rhai:3:4".
struct Place<'a> {
    what: &'a str,
    file: &'a str,
    line: u32,
    column: u32,
}

fn place(note: &str) -> Option<Place<'_>> {
    let (what, place) = note.rsplit_once(" at ")?;
    let (rest, column) = place.rsplit_once(':')?;
    let (file, line) = rest.rsplit_once(':')?;
    Some(Place {
        what,
        file,
        line: line.parse().ok()?,
        column: column.parse().ok()?,
    })
}

fn related(document: &Document, place: &Place<'_>) -> Value {
    let here = place.file == document.name();
    let (uri, range) = if here {
        (
            document.uri.clone(),
            document.span(&word_at(&document.text, place.line, place.column)),
        )
    } else {
        // Counted in characters, as the message does: the file is not looked at for that.
        let at = json!({ "line": place.line.saturating_sub(1), "character": place.column.saturating_sub(1) });
        (
            uri::of_path(Path::new(place.file)),
            json!({ "start": at, "end": at }),
        )
    };
    json!({ "location": { "uri": uri, "range": range }, "message": place.what })
}

/// The names of "did you mean a or b?".
fn meant(hint: &str) -> Vec<String> {
    let names = hint
        .strip_prefix("did you mean ")
        .and_then(|h| h.strip_suffix('?'));
    let names = names.into_iter().flat_map(|names| names.split(" or "));
    names
        .filter(|name| !name.is_empty() && name.chars().all(is_word))
        .map(str::to_owned)
        .collect()
}

/// The diagnostics of a document, for the client.
pub(super) fn message(uri: &str, version: Option<i64>, all: &[Published]) -> Value {
    let shown: Vec<&Value> = all.iter().map(|p| &p.shown).collect();
    let mut params = json!({ "uri": uri, "diagnostics": shown });
    if let Some(version) = version {
        wire::add(&mut params, "version", json!(version));
    }
    wire::notification("textDocument/publishDiagnostics", params)
}

/// Quick fixes for what touches a range.
pub(super) fn actions(document: &Document, all: &[Published], range: &Range<usize>) -> Vec<Value> {
    let touched = all
        .iter()
        .filter(|p| p.range.start <= range.end && range.start <= p.range.end);
    touched
        .flat_map(|p| p.instead.iter().map(move |name| (p, name)))
        .map(|(p, name)| {
            let edit = json!({ "range": document.span(&p.range), "newText": name });
            let mut changes = serde_json::Map::new();
            changes.insert(document.uri.clone(), json!([edit]));
            json!({
                "title": format!("change to {name}"),
                "kind": "quickfix",
                "diagnostics": [p.shown],
                "isPreferred": p.instead.len() == 1,
                "edit": { "changes": changes },
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::{cli::lsp::text::Encoding, diag::ErrorKind};

    fn of(text: &str, found: Vec<Diagnostic>) -> (Document, Vec<Published>) {
        let document = Document::new("file:///x/a.rhai", 3, text, Encoding::Utf16);
        let checked = Checked {
            uri: document.uri.clone(),
            version: 3,
            found,
            unfinished: false,
            reads: BTreeSet::new(),
        };
        let all = published(&document, &checked);
        (document, all)
    }

    #[test]
    fn the_word_is_marked_and_can_be_changed() {
        let d = Diagnostic::error(ErrorKind::Script, "unknown function spere")
            .at("/x/a.rhai", 2, 3)
            .hint("did you mean sphere?");
        let (document, all) = of("é;\n  spere(1);", vec![d]);
        assert_eq!(&document.text[all[0].range.clone()], "spere");
        assert_eq!(all[0].shown["range"]["end"], json!({ "line": 1, "character": 7 }));
        assert_eq!(
            all[0].shown["message"],
            "unknown function spere\nhelp: did you mean sphere?"
        );
        let actions = actions(&document, &all, &(8..8));
        assert_eq!(
            actions[0]["edit"]["changes"]["file:///x/a.rhai"][0]["newText"],
            "sphere"
        );
        assert!(super::actions(&document, &all, &(0..0)).is_empty());
    }

    #[test]
    fn an_error_in_a_module_is_shown_where_it_is_called() {
        let d = Diagnostic::error(ErrorKind::Script, "no")
            .at("/x/b.rhai", 7, 2)
            .note("called at /x/a.rhai:1:5")
            .note("a fact");
        let (document, all) = of("b::tower();", vec![d]);
        let shown = &all[0].shown;
        assert_eq!(&document.text[all[0].range.clone()], "ower");
        assert_eq!(shown["message"], "b.rhai:7: no\nnote: a fact");
        assert_eq!(
            shown["relatedInformation"][0]["location"]["uri"],
            "file:///x/b.rhai"
        );
        assert_eq!(
            shown["relatedInformation"][0]["location"]["range"]["start"]["line"],
            6
        );
        assert_eq!(shown["relatedInformation"][1]["message"], "called");
    }

    #[test]
    fn only_names_are_offered() {
        assert_eq!(meant("did you mean a or b_2?"), ["a", "b_2"]);
        assert!(meant("did you mean the function box(1)?").is_empty());
        assert!(meant("write x += 1").is_empty());
    }

    #[test]
    fn an_empty_scene_is_no_fault_of_a_module() {
        let warning = || vec![Diagnostic::warning(Code::EmptyScene, "the scene is empty")];
        assert!(of("fn f() { }", warning()).1.is_empty());
        assert_eq!(of("let a = 1; print(a);", warning()).1.len(), 1);
    }
}
