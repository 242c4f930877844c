//! The reference as a page of Markdown.

use std::fmt::Write as _;

use super::{
    example::Examples,
    forms::{forms, parameters},
};
use crate::{
    diag::{Code, Error, Severity},
    script::{CONSTANTS, Entry, Group, Kind, PROPERTIES, entries},
};

/// Where the pictures are, from the page.
pub(super) const IMAGES: &str = "images/reference";

const INTRODUCTION: &str = "\
# Reference

Every function of the scene language. This page is made from the table that the program itself goes by
(`rtscript help --write docs`), and a test fails where they differ. In the terminal, `rtscript help` lists the functions
and `rtscript help sphere` tells of one.

A script is [Rhai](https://rhai.rs/book): `let`, `if`, `for i in 0..10`, `fn name(a, b) { }`, arrays, maps, modules, text
with `print`. What Rhai has is there; what follows is added to it. The world is right-handed, Y up; angles are in degrees,
but in `sin` and its like. `object units` are those of the space that the current matrix leads from, `world units` those
of the world.

Pictures are 160 x 120 pixels with 4 rays per pixel, unless the example says otherwise.
";

/// The file of an entry's picture, from the page.
pub(super) fn picture_of(entry: &Entry) -> String {
    format!("{IMAGES}/{}.png", entry.name)
}

/// The whole page.
///
/// # Errors
/// Whatever is wrong with an example.
pub(super) fn reference(examples: &Examples) -> Result<String, Error> {
    let mut page = INTRODUCTION.to_owned();
    page += "\n## What parameters take\n\n| type | what may be written for it |\n|---|---|\n";
    for kind in Kind::ALL {
        line(
            &mut page,
            &format!("| {} | {} |", cell(kind.name()), cell(kind.doc())),
        );
    }
    page += "\n## Contents\n\n";
    for group in Group::ALL {
        let names: Vec<String> = of(group)
            .map(|e| format!("[{0}](#{1})", e.name, e.name.to_lowercase()))
            .collect();
        line(
            &mut page,
            &format!(
                "- [{}](#{}): {}",
                group.title(),
                anchor(group.title()),
                names.join(" ")
            ),
        );
    }
    page += "- [Properties](#properties) and [constants](#constants)\n- [Errors and warnings](#errors-and-warnings)\n";
    for group in Group::ALL {
        line(&mut page, &format!("\n## {}\n\n{}", group.title(), group.doc()));
        for entry in of(group) {
            function(&mut page, examples, entry)?;
        }
    }
    page += "\n## Properties\n\n| of | property | type | |\n|---|---|---|---|\n";
    for p in PROPERTIES {
        let set = if p.can_be_set {
            " It can be assigned to."
        } else {
            ""
        };
        line(
            &mut page,
            &format!(
                "| {} | `.{}` | {} | {}{set} |",
                p.of,
                p.name,
                cell(p.kind.name()),
                cell(p.doc)
            ),
        );
    }
    page += "\n## Constants\n\n| name | value | |\n|---|---|---|\n";
    for c in CONSTANTS {
        line(
            &mut page,
            &format!("| `{}` | {} | {} |", c.name, c.value, cell(c.doc)),
        );
    }
    messages(&mut page);
    Ok(page)
}

/// The classes of errors and warnings.
fn messages(page: &mut String) {
    *page += "\n## Errors and warnings\n\nThe word in brackets after `error` or `warning` is the class of the message. `--message-format json` has it \
              as `code`, and\n`rtscript help no-light` tells of it in the terminal. Words of messages may change, classes stay.\n";
    for (severity, heading) in [(Severity::Error, "error"), (Severity::Warning, "warning")] {
        line(page, &format!("\n| {heading} | what it means |\n|---|---|"));
        for code in Code::ALL.iter().filter(|code| code.severity() == severity) {
            line(
                page,
                &format!("| `{}` | {} |", code.name(), cell(code.explanation())),
            );
        }
    }
}

fn of(group: Group) -> impl Iterator<Item = &'static Entry> {
    entries().filter(move |e| e.group == group)
}

fn function(page: &mut String, examples: &Examples, entry: &Entry) -> Result<(), Error> {
    let example = examples.of(entry)?;
    let forms = forms(entry).join("\n");
    line(
        page,
        &format!("\n### {}\n\n```text\n{forms}\n```\n\n{}", entry.name, entry.doc),
    );
    let parameters = parameters(entry);
    if !parameters.is_empty() {
        *page += "\n| parameter | type | unit | |\n|---|---|---|---|\n";
    }
    for p in parameters {
        let unit = if p.unit == "none" { "" } else { p.unit };
        let default = p.default.map(|d| format!(" Default: `{d}`.")).unwrap_or_default();
        line(
            page,
            &format!(
                "| `{}` | {} | {unit} | {}{default} |",
                p.name,
                cell(p.kind.name()),
                cell(p.doc)
            ),
        );
    }
    line(page, &format!("\n```rhai\n{}\n```", entry.example));
    if !example.printed.is_empty() {
        line(page, &format!("\n```text\n{}\n```", example.printed.trim_end()));
    }
    if example.picture.is_some() {
        line(page, &format!("\n![{}]({})", entry.name, picture_of(entry)));
    }
    Ok(())
}

fn line(page: &mut String, text: &str) {
    // Writing into a String does not fail.
    let _ = writeln!(page, "{text}");
}

/// Text in a cell of a table, where a bar would end it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// As GitHub makes an anchor from a heading.
fn anchor(title: &str) -> String {
    title.to_lowercase().replace(' ', "-")
}
