//! From a name to where it is declared, to all its uses, and to another name.

use std::ops::Range;

use serde_json::{Value, json};

use super::{
    documents::{Document, Documents, module_file},
    hover::{exported, module_of, name_of},
    wire::{Failure, REQUEST_FAILED},
};
use crate::script::analysis::{KEYWORDS, Symbol, SymbolKind, is_word};

fn location(document: &Document, range: &Range<usize>) -> Value {
    json!({ "uri": document.uri, "range": document.span(range) })
}

/// Where what is at `offset` is declared: a name of this file or of a module; the file that a string names.
pub(super) fn definition(documents: &Documents, document: &Document, offset: usize) -> Option<Value> {
    let text = document.analysis();
    let token = text.token_at(offset).filter(|_| !text.in_comment(offset))?;
    if let Some(symbol) = text.resolve(token).and_then(|i| text.symbols().get(i)) {
        return Some(location(document, &symbol.name));
    }
    if let Some(file) = module_of(text, token) {
        return documents.module(document, &file, |module| {
            let there = module.analysis();
            let symbol = exported(there).find(|s| name_of(there, s) == text.word(token))?;
            Some(location(module, &symbol.name))
        })?;
    }
    let named = text.string(token)?;
    let file = match (text.word_near(token, -1), text.word_near(token, -2)) {
        ("import", _) => module_file(named),
        ("(", "mesh" | "image") => named.to_owned(),
        _ => return None,
    };
    if file.ends_with(".rhai") {
        return documents.beside(document, &file, |there| location(there, &(0..0)));
    }
    let path = super::documents::normal(&document.folder()?.join(&file));
    let start = json!({ "line": 0, "character": 0 });
    path.starts_with(document.folder()?).then_some(())?;
    path.is_file()
        .then(|| json!({ "uri": super::uri::of_path(&path), "range": { "start": start, "end": start } }))
}

/// Every place in the file where the name at `offset` stands.
pub(super) fn references(document: &Document, offset: usize) -> Vec<Range<usize>> {
    let text = document.analysis();
    let symbol = text.token_at(offset).and_then(|token| text.resolve(token));
    symbol.map(|symbol| text.references(symbol)).unwrap_or_default()
}

/// The name at `offset`, where it can be changed: it is known in this file alone.
pub(super) fn renameable(document: &Document, offset: usize) -> Option<Range<usize>> {
    let text = document.analysis();
    let token = text.token_at(offset).filter(|_| !text.in_comment(offset))?;
    let symbol = text.symbols().get(text.resolve(token)?)?;
    let is_shown = exported(text).any(|s| s.name == symbol.name) && text.is_library();
    if is_shown {
        return None;
    }
    text.string_span(token)
        .or_else(|| Some(text.tokens().get(token)?.span.clone()))
}

/// The edits that give the name at `offset` another.
pub(super) fn rename(document: &Document, offset: usize, name: &str) -> Result<Value, Failure> {
    let refused = |what: &str| Failure::new(REQUEST_FAILED, what);
    let text = document.analysis();
    renameable(document, offset)
        .ok_or_else(|| refused("only names that this file alone knows can be changed here"))?;
    let symbol = text.token_at(offset).and_then(|token| text.resolve(token));
    let symbol = symbol.and_then(|i| text.symbols().get(i));
    let is_define = symbol.is_some_and(|s| s.kind == SymbolKind::Define);
    let is_name = name.chars().all(is_word) && name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let fits = if is_define {
        !name.is_empty() && !name.contains(['"', '\\', '\n', '\r', '`'])
    } else {
        is_name && name.is_ascii() && !KEYWORDS.contains(&name)
    };
    if !fits {
        return Err(refused(
            "a name has letters, digits and _, begins with no digit, and is no keyword",
        ));
    }
    let taken = |s: &&Symbol| name_of(text, s) == name;
    if let Some(other) = text.symbols().iter().find(taken) {
        let line = text
            .text()
            .get(..other.name.start)
            .map_or(0, |before| before.matches('\n').count() + 1);
        return Err(refused(&format!("{name} is declared already, in line {line}")));
    }
    let edits: Vec<Value> = references(document, offset)
        .iter()
        .map(|range| json!({ "range": document.span(range), "newText": name }))
        .collect();
    let mut changes = serde_json::Map::new();
    changes.insert(document.uri.clone(), Value::Array(edits));
    Ok(json!({ "changes": changes }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn documents(text: &str) -> (Documents, usize) {
        let at = text.find('^').unwrap();
        let mut documents = Documents::default();
        documents.open("file:///x/a.rhai", 1, &text.replacen('^', "", 1));
        documents.open("file:///x/m.rhai", 1, "// first\nfn tower(h) { }");
        (documents, at)
    }

    fn target(text: &str) -> Option<String> {
        let (documents, at) = documents(text);
        let found = definition(&documents, documents.get("file:///x/a.rhai").unwrap(), at)?;
        let start = &found["range"]["start"];
        let uri = found["uri"]
            .as_str()
            .unwrap()
            .rsplit('/')
            .next()
            .unwrap()
            .to_owned();
        Some(format!("{uri}:{}:{}", start["line"], start["character"]))
    }

    #[test]
    fn names_and_files_lead_to_their_place() {
        for (text, wanted) in [
            ("let a = 1;\na^;", Some("a.rhai:0:4")),
            ("import \"m\" as m;\nm::tow^er(1);", Some("m.rhai:1:3")),
            ("import \"m\" as m;\nm^::tower(1);", Some("a.rhai:0:14")),
            ("import \"^m\" as m;", Some("m.rhai:0:0")),
            ("import \"../^m\" as m;", None),
            ("define \"car\" { }\ninstance(\"c^ar\");", Some("a.rhai:0:7")),
            ("mesh(\"no^ne.obj\");", None),
            ("sph^ere(1);", None),
            ("// a^\nlet a = 1;", None),
        ] {
            assert_eq!(target(text).as_deref(), wanted, "{text}");
        }
    }

    #[test]
    fn a_name_is_changed_everywhere_or_not_at_all() {
        let rename = |text: &str, name: &str| {
            let (documents, at) = documents(text);
            rename(documents.get("file:///x/a.rhai").unwrap(), at, name)
                .map(|edit| edit["changes"]["file:///x/a.rhai"].as_array().unwrap().len())
                .map_err(|e| e.message)
        };
        assert_eq!(rename("let a^ = 1; a + a;", "b"), Ok(3));
        assert_eq!(rename("fn f^(x) { }\nf(1);", "g"), Ok(2));
        assert_eq!(rename("define \"car^\" { } instance(\"car\");", "old bus"), Ok(2));
        assert!(
            rename("let a^ = 1; let b = a;", "b")
                .unwrap_err()
                .contains("line 1")
        );
        for bad in ["1b", "", "let", "a b", "é"] {
            assert!(rename("let a^ = 1;", bad).is_err(), "{bad}");
        }
        assert!(rename("sph^ere(1);", "ball").is_err());
        // Others may import it.
        assert!(rename("fn f^() { }", "g").is_err());
    }
}
