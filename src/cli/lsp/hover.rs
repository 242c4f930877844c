//! What is said of the word under the pointer.

use std::ops::Range;

use super::documents::{Document, Documents};
use crate::{
    cli::help::forms::{forms, parameters},
    script::{
        CONSTANTS, Entry, PROPERTIES, Param,
        analysis::{Analysis, Symbol, SymbolKind, unquoted},
        entry,
    },
};

/// Longest piece of a script that is shown.
const LONGEST: usize = 240;

/// What the word at `offset` means, as Markdown, and its bytes.
pub(super) fn hover(
    documents: &Documents,
    document: &Document,
    offset: usize,
) -> Option<(Range<usize>, String)> {
    let text = document.analysis();
    if text.in_comment(offset) {
        return None;
    }
    let token = text.token_at(offset)?;
    let span = text.tokens().get(token)?.span.clone();
    let word = text.word(token);
    if let Some(symbol) = text.resolve(token).and_then(|i| text.symbols().get(i)) {
        return Some((span, of_symbol(text, symbol)));
    }
    if let Some(said) = of_module(documents, document, token) {
        return Some((span, said));
    }
    if matches!(text.word_near(token, -1), "." | "?.") && text.word_near(token, 1) != "(" {
        return Some((span, of_property(word)?));
    }
    if let Some((_, entry)) = text.map_at(offset).and_then(|_| key(text, token)) {
        return Some((span, of_entry(entry)));
    }
    if let Some(entry) = entry(word) {
        return Some((span, of_entry(entry)));
    }
    let constant = CONSTANTS.iter().find(|c| c.name == word)?;
    Some((
        span,
        format!(
            "{}\n\n{}",
            code(&format!("{} = {}", word, constant.value)),
            constant.doc
        ),
    ))
}

/// A function of the language.
pub(super) fn of_entry(entry: &Entry) -> String {
    let mut text = format!("{}\n\n{}\n", code(&forms(entry).join("\n")), entry.doc);
    for p in parameters(entry) {
        text += &format!("\n- `{}` ({}): {}", p.name, kind(p), p.doc);
        if let Some(default) = p.default {
            text += &format!("; `{default}` where it is left out");
        }
    }
    text += &format!("\n\nFor example\n{}", code(entry.usage));
    text
}

/// What a parameter takes, with its unit.
pub(super) fn kind(p: &Param) -> String {
    match p.unit {
        "none" => p.kind.name().to_owned(),
        unit => format!("{}, {unit}", p.kind.name()),
    }
}

/// A key of a map of options that is the name of a function of the language: what the key means is what that does.
fn key(text: &Analysis, token: usize) -> Option<(usize, &'static Entry)> {
    let is_key = text.word_near(token, 1) == ":" && matches!(text.word_near(token, -1), "#{" | ",");
    let found = entry(text.word(token)).filter(|_| is_key)?;
    Some((token, found))
}

/// A declaration of the script.
pub(super) fn of_symbol(text: &Analysis, symbol: &Symbol) -> String {
    let name = text.text().get(symbol.name.clone()).unwrap_or_default();
    let written = text.text().get(symbol.whole.clone()).unwrap_or_default();
    match symbol.kind {
        SymbolKind::Function => {
            let private = if symbol.private { "private " } else { "" };
            let head = code(&format!("{private}fn {name}({})", symbol.params.join(", ")));
            if symbol.doc.is_empty() {
                head
            } else {
                format!("{head}\n\n{}", symbol.doc)
            }
        }
        SymbolKind::Parameter => code(&format!("{name}  // a parameter")),
        SymbolKind::Loop | SymbolKind::Variable | SymbolKind::Constant => {
            let head = code(first_line(written));
            match option_doc(text, symbol) {
                Some(doc) => format!("{head}\n\n{doc}"),
                None => head,
            }
        }
        SymbolKind::Module | SymbolKind::Define => code(first_line(written)),
    }
}

/// The `doc` of a `param(...)` that a variable is declared with.
fn option_doc(text: &Analysis, symbol: &Symbol) -> Option<String> {
    let from = text.tokens_before(symbol.name.end);
    let to = text.tokens_before(symbol.whole.end);
    let mut inside = from..to;
    inside.clone().find(|i| text.word(*i) == "param")?;
    let key = inside.find(|i| text.word(*i) == "doc" && text.word(i + 1) == ":")?;
    text.string(key + 2).map(str::to_owned)
}

fn first_line(text: &str) -> &str {
    let line = text.lines().next().unwrap_or_default().trim_end();
    let end = line.char_indices().nth(LONGEST).map_or(line.len(), |(i, _)| i);
    line.get(..end).unwrap_or(line)
}

/// `module::name`, from the module's file.
fn of_module(documents: &Documents, document: &Document, token: usize) -> Option<String> {
    let text = document.analysis();
    let file = module_of(text, token)?;
    let name = text.word(token);
    documents.module(document, &file, |module| {
        let there = module.analysis();
        let symbol = exported(there).find(|s| name_of(there, s) == name)?;
        Some(of_symbol(there, symbol))
    })?
}

/// The file of the module whose member a token names, as the import gives it.
pub(super) fn module_of(text: &Analysis, token: usize) -> Option<String> {
    if text.word_near(token, -1) != "::" {
        return None;
    }
    let alias = text.resolve(token.checked_sub(2)?)?;
    text.symbols().get(alias)?.file.clone()
}

/// What a module shows to those who import it.
pub(super) fn exported(text: &Analysis) -> impl Iterator<Item = &Symbol> {
    text.symbols().iter().filter(|s| match s.kind {
        SymbolKind::Function => !s.private,
        SymbolKind::Variable | SymbolKind::Constant => {
            let first = text.tokens_before(s.whole.start);
            s.function.is_none() && text.word_near(first, -1) == "export"
        }
        _ => false,
    })
}

/// A symbol's name, without the quotes of a define.
pub(super) fn name_of<'a>(text: &'a Analysis, symbol: &Symbol) -> &'a str {
    text.text().get(symbol.name.clone()).map_or("", unquoted)
}

/// A property, of every type that has it.
pub(super) fn of_property(name: &str) -> Option<String> {
    let all: Vec<String> = PROPERTIES
        .iter()
        .filter(|p| p.name == name)
        .map(|p| {
            let set = if p.can_be_set {
                " It can be assigned to."
            } else {
                ""
            };
            format!(
                "{}\n\n{}{set}",
                code(&format!("{}.{}: {}", p.of, p.name, p.kind.name())),
                p.doc
            )
        })
        .collect();
    (!all.is_empty()).then(|| all.join("\n\n"))
}

/// A piece of a script in a document of Markdown. It is inside a fence, so that nothing in it is Markdown.
pub(super) fn code(text: &str) -> String {
    format!("```rtscript\n{}\n```", text.replace("```", "'''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> Option<String> {
        let at = text.find('^').unwrap();
        let mut documents = Documents::default();
        documents.open("file:///x/a.rhai", 1, &text.replacen('^', "", 1));
        documents.open(
            "file:///x/m.rhai",
            1,
            "/// How high.\nfn tower(h) { }\nexport const TALL = 3;\nprivate fn no() { }",
        );
        let document = documents.get("file:///x/a.rhai").unwrap();
        hover(&documents, document, at).map(|(_, said)| said)
    }

    #[test]
    fn the_table_is_quoted() {
        let sphere = said("sph^ere(1);").unwrap();
        for text in [
            "sphere(center, radius)",
            "- `radius` (number, object units)",
            "For example",
        ] {
            assert!(sphere.contains(text), "{text}: {sphere}");
        }
        assert!(said("let a = P^I;").unwrap().contains("3.14159"));
        assert!(said("v.^x = 1;").unwrap().contains("vec3.x: number"));
        assert!(
            said("material(#{ diff^use: 1 })")
                .unwrap()
                .starts_with("```rtscript\ndiffuse(")
        );
    }

    #[test]
    fn own_names_come_first() {
        assert_eq!(
            said("/// A tower.\nfn tower(h) { }\ntow^er(2);").unwrap(),
            "```rtscript\nfn tower(h)\n```\n\nA tower."
        );
        assert_eq!(
            said("let a = 3; // c\na^;").unwrap(),
            "```rtscript\nlet a = 3\n```"
        );
        assert_eq!(
            said("let r = param(\"r\", 1, #{ doc: \"how far\" });\nsphere(r^);")
                .unwrap()
                .lines()
                .last(),
            Some("how far")
        );
    }

    #[test]
    fn modules_are_looked_into() {
        let with = |rest: &str| said(&format!("import \"m\" as m; {rest}"));
        assert_eq!(
            with("m::tow^er(1)").unwrap(),
            "```rtscript\nfn tower(h)\n```\n\nHow high."
        );
        assert!(with("m::TA^LL").unwrap().contains("const TALL = 3"));
        assert_eq!(with("m::n^o()"), None);
    }

    #[test]
    fn comments_texts_and_keywords_say_nothing() {
        for nothing in ["// sph^ere", "\"sph^ere\"", "le^t a = 1;", "unknown^"] {
            assert_eq!(said(nothing), None, "{nothing}");
        }
    }
}
