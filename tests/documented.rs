//! Every public type, trait, function and method has an example that runs: one of its own, or that of another which uses
//! it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// Modules that the documentation hides.
const HIDDEN: [&str; 4] = ["accel", "cli", "source", "main"];

/// A public item of a module: its name, where it stands, and whether its own documentation shows it at work.
struct Item {
    name: String,
    place: String,
    has_example: bool,
}

fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !HIDDEN.contains(&stem.as_str()) && stem != "tests" {
            files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") && !HIDDEN.contains(&stem.as_str()) {
            out.push(path);
        }
    }
}

/// The code of the blocks that run, of documentation given line by line; `None` is a line of something else.
fn code_of_blocks<'a>(lines: impl Iterator<Item = Option<&'a str>>) -> String {
    let mut code = String::new();
    let mut open: Option<bool> = None;
    for line in lines {
        let Some(line) = line else {
            open = None;
            continue;
        };
        if let Some(kind) = line.trim().strip_prefix("```") {
            let runs = ["", "no_run", "should_panic", "rust", "rust,no_run"].contains(&kind);
            open = match open {
                Some(_) => None,
                None => Some(runs),
            };
        } else if open == Some(true) {
            code.push_str(line);
            code.push('\n');
        }
    }
    code
}

/// The code of the examples in the comments of a source file.
fn code_of_examples(text: &str) -> String {
    code_of_blocks(text.lines().map(|line| {
        let line = line.trim_start();
        line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))
    }))
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(code: &str) -> BTreeSet<&str> {
    code.split(|c: char| !is_of_word(c)).collect()
}

/// What code calls: `.name` and `Type::name`, and what it implements, `fn name`; of a path the last two names.
fn calls(code: &str) -> BTreeSet<String> {
    let mut calls = BTreeSet::new();
    let mut before = ["", ""];
    // Type arguments stand between a type and what is called of it.
    let code = code.replace("::<", "<");
    let mut rest = code.as_str();
    let mut between = "";
    while let Some(start) = rest.find(is_of_word) {
        if !rest[..start].trim().is_empty() {
            between = &rest[..start];
        }
        let word = rest[start..].split(|c| !is_of_word(c)).next().unwrap_or_default();
        if between.ends_with('.') || before[1] == "fn" || between.ends_with("::") {
            calls.insert(word.to_owned());
        }
        if between == "::" {
            calls.insert(format!("{}::{word}", before[1]));
        } else if between.ends_with(">::") {
            calls.insert(format!("{}::{word}", before[0]));
        }
        before = [before[1], word];
        between = "";
        rest = &rest[start + word.len()..];
    }
    calls
}

/// A line of `docs/public-api.txt` that is a method of the crate's own: its type, its name, and whether it takes `self`.
fn method(line: &str) -> Option<(&str, &str, bool)> {
    let rest = line.strip_prefix("pub ")?;
    let rest = ["const fn ", "unsafe fn ", "fn "]
        .iter()
        .find_map(|kind| rest.strip_prefix(kind))?;
    let (path, arguments) = rest.split_once('(')?;
    // `Piece<N>::through`, `pieces<const N: usize>`.
    let (owner, name) = path.rsplit_once("::")?;
    let owner = owner.split('<').next()?.rsplit("::").next()?;
    let name = name.split('<').next()?;
    let first = arguments.split([',', ')']).next()?;
    let takes_self = first
        .split([' ', '&'])
        .any(|word| word == "self" || word == "self:");
    owner
        .starts_with(char::is_uppercase)
        .then_some((owner, name, takes_self))
}

/// The methods of the list that the crate's types and traits have of their own: not those of traits that they implement.
fn methods(list: &str) -> BTreeSet<(&str, &str, bool)> {
    let mut of_a_trait = false;
    let mut methods = BTreeSet::new();
    for line in list.lines() {
        if line.starts_with("impl") {
            of_a_trait = line.contains(" for ");
        } else if ["mod", "struct", "enum", "trait", "union"]
            .iter()
            .any(|kind| line.starts_with(&format!("pub {kind} ")))
        {
            of_a_trait = false;
        } else if !of_a_trait {
            methods.extend(method(line));
        }
    }
    methods
}

/// The name that a line makes public, if it does. What stands deeper is a method, a field or a variant.
fn public_name(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("pub ")?;
    let kinds = [
        "const fn ",
        "unsafe fn ",
        "fn ",
        "struct ",
        "enum ",
        "trait ",
        "type ",
    ];
    let name = kinds.iter().find_map(|kind| rest.strip_prefix(kind))?;
    name.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

fn items(path: &Path, text: &str) -> Vec<Item> {
    let lines: Vec<&str> = text.lines().collect();
    let mut items = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        let Some(name) = public_name(line) else { continue };
        let documented = lines[..i]
            .iter()
            .rev()
            .take_while(|line| line.starts_with("///") || line.starts_with("#[") || **line == ")]");
        items.push(Item {
            name: name.to_owned(),
            place: format!("{}:{}", path.display(), i + 1),
            has_example: documented.clone().any(|line| line.trim_end() == "/// ```"),
        });
    }
    items
}

fn sources() -> Vec<(PathBuf, String)> {
    let mut paths = Vec::new();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut paths);
    let read = |path: PathBuf| (path.clone(), fs::read_to_string(path).unwrap());
    paths.into_iter().map(read).collect()
}

#[test]
fn every_public_item_has_an_example() {
    let texts = sources();
    let code: String = texts.iter().map(|(_, text)| code_of_examples(text)).collect();
    let shown = words(&code);
    let all: Vec<Item> = texts.iter().flat_map(|(path, text)| items(path, text)).collect();
    assert!(all.len() > 200, "found only {} public items", all.len());
    let without: Vec<String> = all
        .iter()
        .filter(|item| !item.has_example && !shown.contains(item.name.as_str()))
        .map(|item| format!("{} {}", item.place, item.name))
        .collect();
    assert!(
        without.is_empty(),
        "no example runs that uses these:\n{}",
        without.join("\n")
    );
}

#[test]
fn every_public_method_is_called_in_an_example() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut code: String = sources().iter().map(|(_, text)| code_of_examples(text)).collect();
    for page in ["README.md", "docs/embedding.md"] {
        let text = fs::read_to_string(root.join(page)).unwrap();
        code += &code_of_blocks(text.lines().map(Some));
    }
    for entry in fs::read_dir(root.join("examples")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "rs") {
            code += &fs::read_to_string(path).unwrap();
        }
    }
    let called = calls(&code);
    let list = fs::read_to_string(root.join("docs/public-api.txt")).unwrap();
    let all = methods(&list);
    assert!(all.len() > 500, "found only {} public methods", all.len());
    let is_shown = |&&(owner, name, takes_self): &&(&str, &str, bool)| {
        called.contains(&format!("{owner}::{name}")) || (takes_self && called.contains(name))
    };
    let without: Vec<String> = all
        .iter()
        .filter(|method| !is_shown(method))
        .map(|(owner, name, _)| format!("{owner}::{name}"))
        .collect();
    assert!(
        without.is_empty(),
        "no example runs that calls these:\n{}",
        without.join("\n")
    );
}

#[test]
fn code_is_that_of_examples_that_run() {
    let text = "/// Alpha.\n///\n/// ```\n/// beta();\n/// ```\n/// gamma\npub fn f() {}\n/// ```text\n/// delta\n/// ```\n";
    assert_eq!(code_of_examples(text), " beta();\n");
    let items = items(Path::new("a.rs"), text);
    assert!(matches!(&items[..], [item] if item.name == "f" && item.has_example));
}

#[test]
fn calls_are_those_of_methods() {
    let code =
        "let a = Ball::<2>::round(x).grown(b); fn stop(&self) {} list.map(Ring::wide)\n    .len(); small;";
    let found = calls(code);
    for call in ["Ball::round", "grown", "stop", "Ring::wide", "map", "len"] {
        assert!(found.contains(call), "{call} is not among {found:?}");
    }
    assert!(
        !["a", "b", "x", "list", "small"]
            .iter()
            .any(|word| found.contains(*word))
    );
    let list = "pub struct rtscript::a::Ball\nimpl rtscript::a::Ball\npub const fn rtscript::a::Ball::round(f64) -> Self\n\
                pub fn rtscript::a::Ball<N>::grown<T>(&'a mut self, T)\nimpl core::fmt::Debug for rtscript::a::Ball\n\
                pub fn rtscript::a::Ball::fmt(&self)\npub mod rtscript::b\npub fn rtscript::b::f(rtscript::a::Ball)\n";
    let own = BTreeSet::from([("Ball", "round", false), ("Ball", "grown", true)]);
    assert_eq!(methods(list), own);
}
