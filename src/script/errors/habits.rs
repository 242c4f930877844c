//! What is written in other languages, and how it is written here: JavaScript and p5.js, OpenSCAD, POV-Ray, Python.

use rhai::Position;

use crate::script::{
    names::{line_after, line_before, word_at},
    table::{Group, entry},
};

/// Words that other languages begin a statement or a value with, and what is written here.
const WORDS: &[(&[&str], &str)] = &[
    (
        &["function", "def", "func", "module", "proc", "sub"],
        "a function is written fn ball(r) { sphere(0, 0, 0, r); }, and one without a name |r| sphere(0, 0, 0, r)",
    ),
    (
        &[
            "var", "int", "float", "double", "auto", "local", "number", "string", "bool", "mut",
        ],
        "a variable of any kind is declared with let: let r = 2;",
    ),
    (
        &["null", "undefined", "None", "nil", "nullptr", "undef"],
        "nothing is written ()",
    ),
    (
        &["True", "False", "TRUE", "FALSE"],
        "the two are written true and false",
    ),
    (
        &["Math", "math"],
        "functions of numbers stand alone: sin(x), sqrt(x), random(); and so does PI",
    ),
    (
        &["console", "echo", "printf", "println"],
        "print(x) prints, and print(`radius ${r}`) a text with values",
    ),
    (
        &["include", "use", "require"],
        "a file of functions is read by import \"parts\" as parts; and asked by parts::wheel()",
    ),
    (&["elif", "elseif", "elsif"], "it is written } else if x > 0 {"),
    (
        &["end", "endif", "endfor", "fi", "done"],
        "blocks stand in braces: if x > 0 { ... }",
    ),
    (&["new"], "values are made by calls: vec3(1, 2, 3)"),
    (&["and"], "and is written &&"),
    (&["or"], "or is written ||"),
    (&["not"], "not is written !"),
    (&["mod"], "the rest of a division is written %"),
];

/// How a word of another language is written here.
pub(in crate::script) fn word(name: &str) -> Option<&'static str> {
    let of = WORDS.iter().find(|(words, _)| words.contains(&name));
    of.map(|(_, here)| *here)
}

/// What a character that no script has was to be: quotes and signs of a word processor or of another keyboard.
pub(super) fn character(what: &str) -> Option<&'static str> {
    Some(match what {
        "\u{201c}" | "\u{201d}" | "\u{201e}" | "\u{ab}" | "\u{bb}" => {
            "a string stands in straight quotes: \"...\""
        }
        "\u{2018}" | "\u{2019}" => "a string stands in straight quotes: \"...\"",
        "\u{2212}" | "\u{2013}" | "\u{2014}" => "minus is written -",
        "\u{d7}" | "\u{b7}" => "times is written *",
        "\u{f7}" => "divided by is written /",
        "\u{ff1b}" => "write the ; of a Latin keyboard",
        "\u{ff0c}" => "write the , of a Latin keyboard",
        "\u{ff08}" | "\u{ff09}" => "write the ( and ) of a Latin keyboard",
        "<" => "a vector is written [x, y, z]",
        _ => return None,
    })
}

/// What a name is that nothing is known of, by what stands around it: the name of an argument or of a key.
pub(in crate::script) fn named(name: &str, pos: Position, text: &str) -> Option<String> {
    let after = line_after(text, pos).strip_prefix(name)?.trim_start();
    let assigns = after.starts_with('=') && !after.starts_with("==") && !after.starts_with("=>");
    let before = line_before(text, pos).trim_end();
    if after.starts_with(':') && !after.starts_with("::") && before.ends_with('{') {
        return Some(format!("a map is written #{{ {name}: 1 }}"));
    }
    if after.starts_with("=>") {
        return Some(format!(
            "a function without a name is written |{name}| {name} + 1"
        ));
    }
    if before.ends_with("function(") {
        return word("function").map(str::to_owned);
    }
    let is_argument = before.ends_with(['(', ',']) && (assigns || after.starts_with(':'));
    let (head, _) = before.rsplit_once('(').filter(|_| is_argument)?;
    let called = head.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next();
    Some(match called.and_then(entry) {
        Some(entry) => format!("arguments have no names, only an order: {}", entry.usage),
        None => "arguments have no names, only an order".to_owned(),
    })
}

/// What to do where a statement should have ended and something else stands.
pub(super) fn instead_of_an_end(pos: Position, text: &str) -> String {
    let (before, after) = (line_before(text, pos).trim_end(), line_after(text, pos));
    if let Some(here) = word(word_at(text, pos)) {
        return here.to_owned();
    }
    if after.starts_with(')') {
        return "no '(' before it is left to be closed".to_owned();
    }
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    if let Some(rest) = after.strip_prefix(',')
        && digit(before.chars().next_back())
        && digit(rest.chars().next())
    {
        return "a fraction is written with a point: 1.5".to_owned();
    }
    // `translate([1, 0, 0]) sphere(...)`: in OpenSCAD a transformation acts on what follows it.
    let statement = before.rsplit([';', '{', '}']).next().unwrap_or("").trim_start();
    let called = statement.split('(').next().and_then(entry);
    if let Some(entry) = called.filter(|e| matches!(e.group, Group::Transform) && before.ends_with(')')) {
        return format!(
            "{0}(...) is a statement that acts on all that follows; a group keeps it to some: group {{ {0}(...); sphere(0, 0, 0, 1); }}",
            entry.name
        );
    }
    "is a ';' missing before this, or are the brackets of a call?".to_owned()
}

/// Why a list of parameters was expected to go on or to end.
pub(super) fn in_parameters(pos: Position, text: &str) -> Option<&'static str> {
    let after = line_after(text, pos);
    after
        .starts_with([':', '='])
        .then_some("parameters are names alone, without kinds and without defaults: fn ball(x, r) { ... }")
}
