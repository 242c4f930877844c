//! What editors are given is as the table of functions: the grammar knows every name, the snippets are scripts.
//! `RTSCRIPT_ACCEPT=1 cargo test --test editors` writes the names into the grammar.

#![allow(clippy::unwrap_used)]

use std::{fs, path::PathBuf};

use rtscript::{
    Limits, NoHost, RunOptions, Script,
    script::{CONSTANTS, Entry, Kind, entries},
};
use serde_json::Value;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("editors/vscode")
}

fn parsed(name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder().join(name)).unwrap()).unwrap()
}

/// Blocks are keywords, not functions.
fn is_block(entry: &Entry) -> bool {
    entry
        .forms
        .iter()
        .copied()
        .flatten()
        .any(|p| p.kind == Kind::Block)
}

/// The names of a pattern `\\b(?:a|b)\\b`, and their place in the file's text.
fn names<'a>(text: &'a str, scope: &str) -> (std::ops::Range<usize>, &'a str) {
    let from = text.find(&format!("\"{scope}\"")).unwrap();
    let start = from + text[from..].find("(?:").unwrap() + 3;
    let end = start + text[start..].find(')').unwrap();
    (start..end, &text[start..end])
}

#[test]
fn the_grammar_knows_every_name() {
    let path = folder().join("syntaxes/rtscript.tmLanguage.json");
    let mut text = fs::read_to_string(&path).unwrap();
    let functions: Vec<&str> = entries().filter(|e| !is_block(e)).map(|e| e.name).collect();
    let constants: Vec<&str> = CONSTANTS.iter().map(|c| c.name).collect();
    let wanted = [
        ("support.function.rtscript", functions.join("|")),
        ("support.constant.rtscript", constants.join("|")),
    ];
    for (scope, wanted) in &wanted {
        let (range, found) = names(&text, scope);
        if found != wanted && std::env::var_os("RTSCRIPT_ACCEPT").is_some() {
            text.replace_range(range, wanted);
            fs::write(&path, &text).unwrap();
        }
        let (_, found) = names(&text, scope);
        assert_eq!(
            found, wanted,
            "the grammar is stale: RTSCRIPT_ACCEPT=1 cargo test --test editors makes it anew"
        );
    }
    // Still what an editor can read.
    assert_eq!(
        parsed("syntaxes/rtscript.tmLanguage.json")["scopeName"],
        "source.rtscript"
    );
}

#[test]
fn the_files_that_the_extension_names_are_there() {
    let package = parsed("package.json");
    let contributes = &package["contributes"];
    let languages = contributes["languages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| &l["configuration"]);
    let grammars = contributes["grammars"]
        .as_array()
        .unwrap()
        .iter()
        .map(|g| &g["path"]);
    let snippets = contributes["snippets"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| &s["path"]);
    for path in languages.chain(grammars).chain(snippets) {
        parsed(path.as_str().unwrap());
    }
    assert_eq!(package["version"], env!("CARGO_PKG_VERSION"));
    let lock = fs::read_to_string(folder().join("package-lock.json")).unwrap();
    assert!(!lock.contains("\"resolved\""), "the lock file names a registry");
}

/// A snippet as it is before anything is filled in: `${1:name}` is `name`.
fn filled(body: &Value) -> String {
    let lines: Vec<&str> = match body {
        Value::Array(lines) => lines.iter().map(|line| line.as_str().unwrap()).collect(),
        line => vec![line.as_str().unwrap()],
    };
    let mut text = lines.join("\n").replace("$0", "");
    while let Some(start) = text.find("${") {
        let end = start + text[start..].find('}').unwrap();
        let name = text[start..end].split_once(':').unwrap().1.to_owned();
        text.replace_range(start..=end, &name);
    }
    text
}

#[test]
fn every_snippet_is_a_script() {
    for (name, snippet) in parsed("snippets.json").as_object().unwrap() {
        let text = filled(&snippet["body"]);
        let before = if name == "If" {
            "let condition = true; "
        } else {
            ""
        };
        let script = Script::compile("snippet.rhai", &format!("{before}{text}"), &Limits::default());
        let script = script.unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
        if name == "Scene" {
            let run = script.run(&NoHost, &RunOptions::default()).unwrap();
            assert!(run.warnings.is_empty(), "{:?}", run.warnings);
        }
    }
}

/// The blocks of code of `editors/README.md` that configure an editor: which editor, and what is written.
fn configurations() -> Vec<(String, String)> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("editors/README.md");
    let page = fs::read_to_string(path).unwrap();
    let blocks = page.split("<!-- editor: ").skip(1);
    blocks
        .map(|block| {
            let (name, rest) = block.split_once(" -->\n```").unwrap();
            let (_, body) = rest.split_once('\n').unwrap();
            (name.to_owned(), body.split("```").next().unwrap().to_owned())
        })
        .collect()
}

#[test]
fn every_configuration_starts_the_server() {
    let all = configurations();
    assert!(all.len() > 4, "{all:?}");
    for (editor, text) in &all {
        assert!(text.contains("rtscript") && text.contains("lsp"), "{editor}");
        let count = |c| text.matches(c).count();
        for (open, close) in [('(', ')'), ('[', ']'), ('{', '}')] {
            assert_eq!(count(open), count(close), "{editor}: {open}");
        }
        if editor == "zed" {
            serde_json::from_str::<Value>(text).unwrap();
        }
    }
}
