//! Every public type, trait and function has an example that runs: one of its own, or that of another which uses it.

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

/// The words of the examples in a file.
fn words_of_examples(text: &str) -> BTreeSet<String> {
    let mut words = BTreeSet::new();
    let mut open: Option<bool> = None;
    for line in text.lines() {
        let line = line.trim_start();
        let Some(line) = line.strip_prefix("///").or_else(|| line.strip_prefix("//!")) else {
            open = None;
            continue;
        };
        if let Some(kind) = line.trim().strip_prefix("```") {
            open = match open {
                Some(_) => None,
                None => Some(kind.is_empty() || ["no_run", "should_panic"].contains(&kind)),
            };
        } else if open == Some(true) {
            words.extend(
                line.split(|c: char| !c.is_alphanumeric() && c != '_')
                    .map(str::to_owned),
            );
        }
    }
    words
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

#[test]
fn every_public_item_has_an_example() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    files(&root, &mut paths);
    let texts: Vec<(PathBuf, String)> = paths
        .into_iter()
        .map(|path| (path.clone(), fs::read_to_string(path).unwrap()))
        .collect();
    let shown: BTreeSet<String> = texts
        .iter()
        .flat_map(|(_, text)| words_of_examples(text))
        .collect();
    let all: Vec<Item> = texts.iter().flat_map(|(path, text)| items(path, text)).collect();
    assert!(all.len() > 200, "found only {} public items", all.len());
    let without: Vec<String> = all
        .iter()
        .filter(|item| !item.has_example && !shown.contains(&item.name))
        .map(|item| format!("{} {}", item.place, item.name))
        .collect();
    assert!(
        without.is_empty(),
        "no example runs that uses these:\n{}",
        without.join("\n")
    );
}

#[test]
fn words_are_those_of_examples_that_run() {
    let text = "/// Alpha.\n///\n/// ```\n/// beta();\n/// ```\n/// gamma\npub fn f() {}\n/// ```text\n/// delta\n/// ```\n";
    let words = words_of_examples(text);
    assert!(words.contains("beta"));
    assert!(!["Alpha", "gamma", "delta"].iter().any(|w| words.contains(*w)));
    let items = items(Path::new("a.rs"), text);
    assert!(matches!(&items[..], [item] if item.name == "f" && item.has_example));
}
