//! What a file holds, and what of it can be folded.

use serde_json::{Value, json};

use super::{documents::Document, hover::name_of};
use crate::script::analysis::SymbolKind;

/// Functions, definitions, modules, and the variables outside functions.
pub(super) fn symbols(document: &Document) -> Vec<Value> {
    let text = document.analysis();
    let shown = text.symbols().iter().filter_map(|s| {
        // As the protocol numbers them.
        let kind = match s.kind {
            SymbolKind::Function => 12,
            SymbolKind::Constant if s.function.is_none() => 14,
            SymbolKind::Variable if s.function.is_none() => 13,
            SymbolKind::Module => 2,
            SymbolKind::Define => 19,
            _ => return None,
        };
        let detail = match s.kind {
            SymbolKind::Function => format!("({})", s.params.join(", ")),
            _ => String::new(),
        };
        let name = name_of(text, s);
        Some(json!({
            "name": if name.is_empty() { "(no name)" } else { name },
            "detail": detail,
            "kind": kind,
            "range": document.span(&s.whole),
            "selectionRange": document.span(&s.name),
        }))
    });
    shown.collect()
}

/// Blocks and brackets over several lines, and comments.
pub(super) fn folds(document: &Document) -> Vec<Value> {
    let text = document.analysis();
    let line = |offset| {
        let place = document.lines.place(&document.text, offset, document.encoding);
        place.get("line").and_then(Value::as_u64).unwrap_or(0)
    };
    let mut folds: Vec<Value> = text
        .blocks()
        .map(|b| (line(b.start), line(b.end)))
        .filter(|(first, last)| first + 1 < *last)
        .map(|(first, last)| json!({ "startLine": first, "endLine": last - 1 }))
        .collect();
    // Comments one below the other are one.
    let mut run: Option<(u64, u64)> = None;
    let ends = text
        .comments()
        .iter()
        .map(|c| (line(c.span.start), line(c.span.end)));
    for (first, last) in ends.chain([(u64::MAX, u64::MAX)]) {
        run = match run {
            Some((start, end)) if first <= end.saturating_add(1) => Some((start, last)),
            other => {
                if let Some((start, end)) = other.filter(|(start, end)| start < end) {
                    folds.push(json!({ "startLine": start, "endLine": end, "kind": "comment" }));
                }
                Some((first, last))
            }
        };
    }
    folds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::lsp::text::Encoding;

    #[test]
    fn a_file_has_an_outline_and_folds() {
        let text = "// a\n// b\nlet v = 1;\nfn f(x) {\n  let w = 2;\n  w\n}\ndefine \"car\" {\n  box();\n}";
        let document = Document::new("file:///a.rhai", 1, text, Encoding::Utf16);
        let names: Vec<Value> = symbols(&document).iter().map(|s| s["name"].clone()).collect();
        assert_eq!(names, ["v", "f", "car"]);
        let folds: Vec<(u64, u64)> = folds(&document)
            .iter()
            .map(|f| (f["startLine"].as_u64().unwrap(), f["endLine"].as_u64().unwrap()))
            .collect();
        assert_eq!(folds, [(3, 5), (7, 8), (0, 1)]);
    }
}
