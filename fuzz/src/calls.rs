//! Sequences of calls of the language's functions with values at the edges, as script text: every function of the table
//! with any number of arguments, as a call or a method, in blocks, loops, functions and `try`.

use std::fmt::Write as _;

use rtscript::script::{CONSTANTS, PROPERTIES, entries};

use crate::{bytes::Bytes, script};

/// What stands for an argument.
const VALUES: &[&str] = &[
    "0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "-0.0",
    "0.1",
    "45",
    "90",
    "180",
    "1e-300",
    "1e300",
    "1e15",
    "1e16",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775807",
    "(0.0/0.0)",
    "(1.0/0.0)",
    "true",
    "()",
    "\"\"",
    "\"#ff8000\"",
    "\"#ff\"",
    "\"g0\"",
    "\"g1\"",
    "\"tetrahedron.obj\"",
    "\"wood.png\"",
    "\"../a.obj\"",
    "\"lib\"",
    "\"a.png\"",
    "'x'",
    "[]",
    "[0, 0, 0]",
    "[1, 2, 3]",
    "[0.2, 0.4, 0.6]",
    "[1, 2]",
    "[1, 2, 3, 4]",
    "[1, \"a\", 3]",
    "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    "[[0, 0, 0, 0.5], [1, 0, 0, 0.25]]",
    "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]",
    "vec3(1, 2, 3)",
    "vec3(0, 0, 0)",
    "vec3(0.5, 0.5, 0.5)",
    "#{}",
    "#{diffuse: [1, 0, 0]}",
    "#{shininess: -1}",
    "#{positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], indices: [0, 1, 2]}",
    "#{positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], indices: [0, 1, 9]}",
    "|x| x",
    "|x, y| x + y",
    "(0..4)",
    "[3, 1, 2]",
    "blob(16, 7)",
    "v0",
    "v1",
    "v2",
    "v3",
];

const OPERATORS: &[&str] = &["+", "-", "*", "/", "%", "**", "==", "<", "&&", "??", "in", "<<"];

/// Deepest nesting of blocks.
const DEPTH: u32 = 4;

pub fn run(data: &[u8]) {
    script::run_text(&text(data), false);
}

/// The script that these bytes stand for.
#[must_use]
pub fn text(data: &[u8]) -> String {
    let mut bytes = Bytes::new(data);
    let mut out = "let v0 = 1; let v1 = [1, 2, 3]; let v2 = vec3(1, 0, 0); let v3 = #{};\n".to_owned();
    let mut names: Vec<&str> = Vec::new();
    for entry in entries() {
        names.push(entry.name);
        names.extend(entry.also);
    }
    while !bytes.is_empty() && out.len() < 8 << 10 {
        statement(&mut bytes, &names, 0, &mut out);
    }
    out
}

fn statement(bytes: &mut Bytes<'_>, names: &[&str], depth: u32, out: &mut String) {
    let kind = if depth < DEPTH { bytes.below(24) } else { 0 };
    // Writing into a String does not fail.
    let _ = match kind {
        14 => write!(out, "v{} = ", bytes.below(4)),
        15 => writeln!(out, "group {{"),
        16 => writeln!(out, "define \"g{}\" {{", bytes.below(2)),
        17 => writeln!(out, "for i in 0..{} {{", bytes.below(4)),
        18 => writeln!(out, "if {} {{", value(bytes)),
        19 => writeln!(out, "try {{"),
        20 => writeln!(out, "instance(\"g{}\");", bytes.below(2)),
        21 => {
            let (variable, property) = (bytes.below(4), property(bytes));
            writeln!(out, "v{variable}.{property} = {};", value(bytes))
        }
        22 => {
            let (variable, left, operator) = (bytes.below(4), value(bytes), bytes.one_of(OPERATORS));
            writeln!(out, "v{variable} = {left} {operator} {};", value(bytes))
        }
        23 => {
            let (to, from) = (bytes.below(4), bytes.below(4));
            writeln!(out, "v{to} = v{from}.{};", property(bytes))
        }
        _ => Ok(()),
    };
    match kind {
        15..=19 => {
            for _ in 0..bytes.below(4) {
                statement(bytes, names, depth + 1, out);
            }
            out.push_str(match kind {
                19 => "} catch (e) { print(e); }\n",
                18 => "} else { sphere(); }\n",
                _ => "}\n",
            });
        }
        20..=23 => {}
        _ => {
            call(bytes, names, out);
            out.push_str(";\n");
        }
    }
}

fn call(bytes: &mut Bytes<'_>, names: &[&str], out: &mut String) {
    let choice = usize::from(bytes.byte()) << 8 | usize::from(bytes.byte());
    let name = names[choice % names.len()];
    if bytes.byte() > 200 {
        let _ = write!(out, "v{}.", bytes.below(4));
    }
    let _ = write!(out, "{name}(");
    for i in 0..bytes.below(7) {
        let comma = if i > 0 { ", " } else { "" };
        let _ = write!(out, "{comma}{}", value(bytes));
    }
    out.push(')');
}

fn value(bytes: &mut Bytes<'_>) -> String {
    match bytes.byte() {
        b if usize::from(b) < 3 * VALUES.len() => VALUES[usize::from(b) % VALUES.len()].to_owned(),
        b if b < 200 => CONSTANTS[usize::from(b) % CONSTANTS.len()].name.to_owned(),
        b if b < 240 => format!("{:?}", bytes.number()),
        _ => format!("[{}, {}, {}]", bytes.byte(), bytes.byte(), bytes.byte()),
    }
}

fn property(bytes: &mut Bytes<'_>) -> &'static str {
    PROPERTIES[bytes.below(PROPERTIES.len())].name
}
