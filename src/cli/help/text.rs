//! The reference in the terminal.

use std::fmt::Write as _;

use super::{
    example::Example,
    forms::{forms, parameters},
    group_name,
};
use crate::{
    diag::Code,
    script::{CONSTANTS, Entry, Group, PROPERTIES, entries},
};

/// Columns that texts are wrapped at.
const WIDTH: usize = 100;
/// Starts and ends bold text on a terminal.
const BOLD: [&str; 2] = ["\x1b[1m", "\x1b[0m"];

fn bold(text: &str) -> String {
    let [on, off] = BOLD;
    format!("{on}{text}{off}")
}

/// All functions by group, each with the first sentence of its text.
pub(super) fn contents() -> String {
    let mut text = String::new();
    for group in Group::ALL {
        text += &list(group);
        text.push('\n');
    }
    let constants: Vec<&str> = CONSTANTS.iter().map(|c| c.name).collect();
    let _ = writeln!(text, "{}\n  {}\n", bold("Constants"), constants.join(" "));
    let _ = writeln!(
        text,
        "rtscript help NAME       a function with its example, such as rtscript help sphere\n\
         rtscript help COMMAND    as rtscript COMMAND --help\n\
         rtscript help CODE       what the word in brackets after error or warning means\n\
         rtscript help --json     all of it for programs; --definitions for editors"
    );
    text
}

/// The functions of one group, and what they have in common.
pub(super) fn group(group: Group) -> String {
    format!("{}\n{}\n", list(group), wrapped(group.doc(), 0))
}

fn list(group: Group) -> String {
    let of = || entries().filter(move |e| e.group == group);
    let width = of().map(|e| e.name.len()).max().unwrap_or(0);
    let mut text = format!("{}\n", bold(group.title()));
    for entry in of() {
        let _ = writeln!(text, "  {:width$}  {}", entry.name, first_sentence(entry.doc));
    }
    text
}

/// Up to the first full stop that ends a sentence; of one that is too long for a line, what comes before a colon or a
/// semicolon.
fn first_sentence(doc: &str) -> String {
    let end = doc.find(". ").map_or(doc.len(), |i| i + 1);
    let sentence = doc.get(..end).unwrap_or(doc).trim_end_matches('.');
    if sentence.chars().count() <= WIDTH - 16 {
        return sentence.to_owned();
    }
    let shorter = sentence.split([';', ':']).next().unwrap_or(sentence);
    let shorter = if shorter.len() < 12 { sentence } else { shorter };
    if shorter.chars().count() <= WIDTH - 16 {
        return shorter.to_owned();
    }
    let line = wrapped(shorter, 20);
    let first = line.lines().next().unwrap_or_default();
    format!("{} ...", first.trim_end_matches([',', ' ']))
}

/// Everything about a function; `asked` is the name it was asked for by.
pub(super) fn function(entry: &Entry, example: &Example, asked: &str) -> String {
    let mut text = String::new();
    if entry.also.contains(&asked) {
        let _ = writeln!(text, "{asked} is called {} here.\n", entry.name);
    }
    for form in forms(entry) {
        let _ = writeln!(text, "{}", bold(&form));
    }
    let _ = writeln!(text, "\n{}", wrapped(entry.doc, 0));
    let parameters = parameters(entry);
    if !parameters.is_empty() {
        text.push('\n');
    }
    let kind = |p: &crate::script::Param| match p.unit {
        "none" => p.kind.name().to_owned(),
        unit => format!("{}, {unit}", p.kind.name()),
    };
    let name_width = parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
    let kind_width = parameters.iter().map(|p| kind(p).len()).max().unwrap_or(0);
    for p in parameters {
        let mut doc = p.doc.to_owned();
        if let Some(default) = p.default {
            let _ = write!(doc, "; {default} where it is left out");
        }
        let indent = name_width + kind_width + 6;
        let _ = writeln!(
            text,
            "  {:name_width$}  {:kind_width$}  {}",
            p.name,
            kind(p),
            wrapped(&doc, indent)
        );
    }
    let _ = writeln!(text, "\n{}", bold("Example"));
    for line in entry.example.lines() {
        let _ = writeln!(text, "  {line}");
    }
    if !example.printed.is_empty() {
        let _ = writeln!(text, "\n{}", bold("It prints"));
        for line in example.printed.lines() {
            let _ = writeln!(text, "  {line}");
        }
    }
    let _ = writeln!(
        text,
        "\nIn the group {}: rtscript help {}",
        entry.group.title(),
        group_name(entry.group)
    );
    text
}

/// A constant's or a property's line.
pub(super) fn word(name: &str) -> Option<String> {
    if let Some(c) = CONSTANTS.iter().find(|c| c.name == name) {
        return Some(format!("{} = {}\n\n{}\n", bold(c.name), c.value, c.doc));
    }
    let name = name.strip_prefix('.').unwrap_or(name);
    let p = PROPERTIES
        .iter()
        .find(|p| p.name == name || name.strip_prefix(p.of) == Some(&format!(".{}", p.name)))?;
    let can_be_set = if p.can_be_set {
        " It can be assigned to."
    } else {
        ""
    };
    let title = bold(&format!(".{}", p.name));
    Some(format!(
        "{title} of {}: {}\n\n{}{can_be_set}\n",
        p.of,
        p.kind.name(),
        p.doc
    ))
}

/// What a class of errors or warnings means.
pub(super) fn code(code: Code) -> String {
    let title = format!("{}[{}]", code.severity().name(), code.name());
    format!("{}\n\n{}\n", bold(&title), wrapped(code.explanation(), 0))
}

/// The text in lines of at most [`WIDTH`] columns, all but the first indented.
fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut column = indent;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if column > indent && column + 1 + length > WIDTH {
            let _ = write!(lines, "\n{:indent$}", "");
            column = indent;
        } else if column > indent {
            lines.push(' ');
            column += 1;
        }
        lines += word;
        column += length;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_wrapped_and_indented() {
        let text = wrapped(&"word ".repeat(40), 10);
        assert!(text.lines().count() > 1);
        assert!(text.lines().all(|l| l.len() <= WIDTH), "{text}");
        assert!(
            text.lines().skip(1).all(|l| l.starts_with("          word")),
            "{text}"
        );
    }

    #[test]
    fn a_list_shows_one_sentence() {
        assert_eq!(first_sentence("A sphere. Under scale it is more."), "A sphere");
        assert_eq!(first_sentence("Of 0.5 or 1."), "Of 0.5 or 1");
    }
}
