//! What could be written next.

use std::{collections::BTreeMap, fs, ops::Range};

use serde_json::{Value, json};

use super::{
    documents::{Document, Documents},
    hover::{exported, module_of, name_of, of_entry, of_property, of_symbol},
    wire::add,
};
use crate::{
    cli::help::forms::written,
    script::{
        CONSTANTS, Entry, Kind, PROPERTIES, Param,
        analysis::{Analysis, KEYWORDS, SymbolKind, TokenKind, assigned, builtins},
        entries, entry,
    },
};

/// Most files of a folder that are offered.
const MOST_FILES: usize = 500;

/// As the protocol numbers the kinds of items.
const METHOD: u8 = 2;
const FUNCTION: u8 = 3;
const VARIABLE: u8 = 6;
const MODULE: u8 = 9;
const PROPERTY: u8 = 10;
const KEYWORD: u8 = 14;
const FILE: u8 = 17;
const REFERENCE: u8 = 18;
const FOLDER: u8 = 19;
const CONSTANT: u8 = 21;

/// Something that could be written.
struct Item {
    label: String,
    kind: u8,
    detail: String,
    doc: String,
    /// What is written, with places to fill in; the label where it is empty.
    snippet: String,
    /// Items of the lowest rank come first.
    rank: u8,
}

impl Item {
    fn new(label: impl Into<String>, kind: u8, rank: u8) -> Self {
        Self {
            label: label.into(),
            kind,
            detail: String::new(),
            doc: String::new(),
            snippet: String::new(),
            rank,
        }
    }

    fn detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    fn doc(mut self, doc: impl Into<String>) -> Self {
        self.doc = doc.into();
        self
    }

    fn snippet(mut self, snippet: impl Into<String>) -> Self {
        self.snippet = snippet.into();
        self
    }
}

/// What could be written at `offset`. `snippets` says whether the client fills in places.
pub(super) fn complete(
    documents: &Documents,
    document: &Document,
    offset: usize,
    snippets: bool,
) -> Vec<Value> {
    let text = document.analysis();
    if text.in_comment(offset) {
        return Vec::new();
    }
    let touched = text.token_at(offset).filter(|i| {
        let span = text.tokens().get(*i).map_or(0..0, |t| t.span.clone());
        span.start < offset && offset <= span.end
    });
    let kind = touched.and_then(|i| text.tokens().get(i)).map(|t| t.kind);
    if let (Some(token), Some(inside)) = (touched, touched.and_then(|i| text.string_span(i)))
        && inside.start <= offset
        && offset <= inside.end
    {
        // Of a string without an end, nobody knows how far it is to go.
        let is_open = text.tokens().get(token).is_some_and(|t| t.open);
        let inside = inside.start..if is_open { offset } else { inside.end };
        let items = in_string(document, token, offset);
        return items
            .into_iter()
            .map(|item| shown(document, &item, &inside, None))
            .collect();
    }
    let (start, at) = match (kind, touched) {
        (Some(TokenKind::Number | TokenKind::Text), _) => return Vec::new(),
        (Some(TokenKind::Word), Some(token)) => {
            (text.tokens().get(token).map_or(offset, |t| t.span.start), token)
        }
        _ => (offset, text.tokens_before(offset)),
    };
    let items = match text.word_near(at, -1) {
        "::" => members(documents, document, at),
        "." | "?." => properties(),
        "fn" | "let" | "const" | "as" | "for" => Vec::new(),
        before => match text.map_at(start) {
            Some((open, taken)) if matches!(before, "#{" | ",") => keys(text, open, &taken),
            _ => everything(text, start),
        },
    };
    // Brackets that are there already are not written again.
    let rest = document.text.get(offset..).unwrap_or_default();
    let has_brackets = rest
        .trim_start_matches(|c: char| c.is_alphanumeric() || c == '_')
        .starts_with('(');
    let with_places = (snippets && !has_brackets).then_some(());
    items
        .iter()
        .map(|item| shown(document, item, &(start..offset), with_places))
        .collect()
}

/// What is said of an item when it is looked at.
pub(super) fn resolve(mut item: Value) -> Value {
    let name = item.pointer("/data/function").and_then(Value::as_str);
    if let Some(entry) = name.and_then(entry) {
        let text = json!({ "kind": "markdown", "value": of_entry(entry) });
        add(&mut item, "documentation", text);
    }
    item
}

fn shown(document: &Document, item: &Item, replaced: &Range<usize>, with_places: Option<()>) -> Value {
    let has_places = with_places.is_some() && !item.snippet.is_empty();
    let new = if has_places { &item.snippet } else { &item.label };
    let mut value = json!({
        "label": item.label,
        "kind": item.kind,
        "sortText": format!("{}{}", item.rank, item.label),
        "insertTextFormat": if has_places { 2 } else { 1 },
        "textEdit": { "range": document.span(replaced), "newText": new },
    });
    if !item.detail.is_empty() {
        add(&mut value, "detail", json!(item.detail));
    }
    if !item.doc.is_empty() {
        let text = json!({ "kind": "markdown", "value": item.doc });
        add(&mut value, "documentation", text);
    } else if item.kind == FUNCTION && entry(&item.label).is_some() {
        add(&mut value, "data", json!({ "function": item.label }));
    }
    value
}

/// Everything that can begin an expression or a statement.
fn everything(text: &Analysis, offset: usize) -> Vec<Item> {
    let mut own: BTreeMap<String, Item> = BTreeMap::new();
    for symbol in text.visible(offset) {
        let name = name_of(text, symbol);
        let item = match symbol.kind {
            SymbolKind::Function => called(name, &symbol.params, FUNCTION, 1).doc(of_symbol(text, symbol)),
            SymbolKind::Constant => Item::new(name, CONSTANT, 0).doc(of_symbol(text, symbol)),
            SymbolKind::Module => Item::new(name, MODULE, 0).doc(of_symbol(text, symbol)),
            SymbolKind::Define => continue,
            _ => Item::new(name, VARIABLE, 0).doc(of_symbol(text, symbol)),
        };
        own.insert(name.to_owned(), item);
    }
    let table = entries().filter(|e| !own.contains_key(e.name) && !is_method(e));
    let mut items: Vec<Item> = table.map(of_table).collect();
    items.extend(CONSTANTS.iter().map(|c| {
        Item::new(c.name, CONSTANT, 2)
            .detail(c.value.to_string())
            .doc(c.doc)
    }));
    let blocks = |word: &&&str| entry(word).is_none();
    items.extend(
        KEYWORDS
            .iter()
            .filter(blocks)
            .map(|word| Item::new(*word, KEYWORD, 3)),
    );
    let others = builtins()
        .iter()
        .filter(|name| entry(name).is_none() && !own.contains_key(*name));
    items.extend(others.map(|name| {
        Item::new(name, FUNCTION, 4)
            .detail("of Rhai")
            .snippet(format!("{name}($1)"))
    }));
    items.extend(own.into_values());
    items
}

/// Whether a function is written after a point.
fn is_method(entry: &Entry) -> bool {
    entry.usage.contains(&format!(".{}(", entry.name))
}

fn of_table(entry: &'static Entry) -> Item {
    let form = entry.forms.first().copied().unwrap_or_default();
    Item::new(entry.name, FUNCTION, 2)
        .detail(format!("{}{}", entry.name, written(form)))
        .snippet(snippet(entry.name, form))
}

/// A call with places for what cannot be left out; a block with a place inside.
fn snippet(name: &str, form: &[Param]) -> String {
    let needed: Vec<&Param> = form.iter().filter(|p| p.default.is_none()).collect();
    let places = needed
        .iter()
        .filter(|p| p.kind != Kind::Block)
        .enumerate()
        .map(|(i, p)| match p.kind {
            Kind::String => format!("\"${{{}:{}}}\"", i + 1, p.name),
            Kind::Map => format!("#{{ ${{{}}} \\}}", i + 1),
            _ => format!("${{{}:{}}}", i + 1, p.name),
        });
    let places: Vec<String> = places.collect();
    if needed.iter().any(|p| p.kind == Kind::Block) {
        let before: Vec<String> = [name.to_owned()].into_iter().chain(places).collect();
        return format!("{} {{\n\t$0\n\\}}", before.join(" "));
    }
    format!("{name}({})", places.join(", "))
}

/// A function of a script.
fn called(name: &str, params: &[String], kind: u8, rank: u8) -> Item {
    let places: Vec<String> = params
        .iter()
        .enumerate()
        .map(|(i, p)| format!("${{{}:{p}}}", i + 1))
        .collect();
    Item::new(name, kind, rank)
        .detail(format!("{name}({})", params.join(", ")))
        .snippet(format!("{name}({})", places.join(", ")))
}

/// What a module shows, or after `global::` the constants of the file.
fn members(documents: &Documents, document: &Document, token: usize) -> Vec<Item> {
    let text = document.analysis();
    if text.word_near(token, -2) == "global" {
        let constants = text.symbols().iter();
        return constants
            .filter(|s| s.kind == SymbolKind::Constant && s.function.is_none())
            .map(|s| Item::new(name_of(text, s), CONSTANT, 0).doc(of_symbol(text, s)))
            .collect();
    }
    let shown = |module: &Document| {
        let there = module.analysis();
        let items = exported(there).map(|s| match s.kind {
            SymbolKind::Function => {
                called(name_of(there, s), &s.params, FUNCTION, 0).doc(of_symbol(there, s))
            }
            _ => Item::new(name_of(there, s), CONSTANT, 0).doc(of_symbol(there, s)),
        });
        items.collect()
    };
    module_of(text, token)
        .and_then(|file| documents.module(document, &file, shown))
        .unwrap_or_default()
}

/// What can stand after a point: of which type the value is, nobody knows.
fn properties() -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    for p in PROPERTIES {
        if !items.iter().any(|item| item.label == p.name) {
            let doc = of_property(p.name).unwrap_or_default();
            items.push(
                Item::new(p.name, PROPERTY, 0)
                    .detail(format!("of {}", p.of))
                    .doc(doc),
            );
        }
    }
    let methods = entries().filter(|e| is_method(e));
    items.extend(methods.map(|e| {
        // What stands before the point is the first argument.
        let form = e.forms.first().copied().unwrap_or_default();
        let form = form
            .get(1..)
            .filter(|_| form.first().is_some_and(|p| p.kind == Kind::Image))
            .unwrap_or(form);
        Item::new(e.name, METHOD, 1)
            .doc(of_entry(e))
            .snippet(snippet(e.name, form))
    }));
    let others = builtins().iter().filter(|name| entry(name).is_none());
    items.extend(others.map(|name| {
        Item::new(name, METHOD, 2)
            .detail("of Rhai")
            .snippet(format!("{name}($1)"))
    }));
    items
}

/// Keys of the map of options that a bracket opens, but for those that are there.
fn keys(text: &Analysis, open: usize, taken: &[&str]) -> Vec<Item> {
    let Some(start) = text.tokens().get(open).map(|t| t.span.start) else {
        return Vec::new();
    };
    let Some((entry, call)) = text
        .call_at(start)
        .and_then(|c| Some((entry(text.word(c.name))?, c)))
    else {
        return Vec::new();
    };
    let Some(arg) = call.args.iter().position(|arg| arg.start == open) else {
        return Vec::new();
    };
    let fitting = entry.forms.iter().filter_map(|form| {
        let params = assigned(text, form, &call.args, false)?;
        form.get(*params.get(arg)?)
    });
    let param = fitting.into_iter().find(|p| p.kind == Kind::Map);
    let all = param
        .map_or(&[][..], |p| p.keys)
        .iter()
        .filter(|key| !taken.contains(key));
    all.map(|key| {
        let doc = crate::script::entry(key).map(of_entry);
        Item::new(*key, PROPERTY, 0)
            .doc(doc.or(param.map(|p| p.doc.to_owned())).unwrap_or_default())
            .snippet(format!("{key}: $1"))
    })
    .collect()
}

/// What can stand in a string: names of files and of definitions.
fn in_string(document: &Document, token: usize, offset: usize) -> Vec<Item> {
    let text = document.analysis();
    let endings: &[&str] = match (text.word_near(token, -1), text.word_near(token, -2)) {
        ("import", _) => &["rhai"],
        ("(", "mesh") => &["obj"],
        ("(", "image") => &["png", "jpg", "jpeg"],
        ("(", "instance" | "instances") => {
            let defines = text.symbols().iter().filter(|s| s.kind == SymbolKind::Define);
            return defines
                .map(|s| Item::new(name_of(text, s), REFERENCE, 0))
                .collect();
        }
        _ => return Vec::new(),
    };
    let start = text.string_span(token).map_or(offset, |s| s.start);
    files(
        document,
        document.text.get(start..offset).unwrap_or_default(),
        endings,
    )
}

/// Files and folders beside the script whose path begins as what is written so far, up to its last `/`.
fn files(document: &Document, begun: &str, endings: &[&str]) -> Vec<Item> {
    let Some(folder) = document.folder() else {
        return Vec::new();
    };
    let within = begun.rfind('/').and_then(|end| begun.get(..=end)).unwrap_or("");
    if within.starts_with('/') || within.split('/').any(|part| part == "..") {
        return Vec::new();
    }
    let entries = fs::read_dir(folder.join(within)).into_iter().flatten().flatten();
    let mut items: Vec<Item> = entries
        .take(MOST_FILES * 4)
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            if name.starts_with('.') || document.path.as_deref() == Some(entry.path().as_path()) {
                return None;
            }
            if entry.file_type().ok()?.is_dir() {
                return Some(Item::new(format!("{within}{name}/"), FOLDER, 1));
            }
            let (stem, ending) = name.rsplit_once('.')?;
            let fits = endings.contains(&ending.to_ascii_lowercase().as_str());
            let shown = if ending == "rhai" { stem } else { &name };
            fits.then(|| Item::new(format!("{within}{shown}"), FILE, 0))
        })
        .collect();
    items.sort_by(|a, b| (a.rank, &a.label).cmp(&(b.rank, &b.label)));
    items.truncate(MOST_FILES);
    items
}

#[cfg(test)]
mod tests;
