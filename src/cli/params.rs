//! `rtscript params`: what a script lets its caller decide.

use std::sync::Arc;

use serde_json::json;

use super::{args::ParamsArgs, check::dry_run, input::Input, signals::Signals, without_place, write_stdout};
use crate::{diag::Error, parameters::Declared};

/// Runs the script, its own pictures one pixel large, and lists the parameters that it declared.
///
/// # Errors
/// Whatever keeps the script from running to its end.
pub(super) fn params(args: &ParamsArgs, signals: &Arc<Signals>) -> Result<(), Error> {
    let input = Input::new(&args.file);
    let run = dry_run(&input, args.define.parameters(), signals)?;
    let declared = &run.value.parameters;
    let text = if args.json {
        let list: Vec<_> = declared.iter().map(as_json).collect();
        format!("{:#}\n", json!(list))
    } else {
        table(declared)
    };
    write_stdout(text.as_bytes()).map_err(without_place)
}

/// A line for each: name, what it takes, default, what it means.
fn table(declared: &[Declared]) -> String {
    let rows: Vec<[String; 4]> = declared
        .iter()
        .map(|p| [p.name.clone(), p.expected(), p.default.clone(), p.doc.clone()])
        .collect();
    let mut widths = [0; 3];
    for row in &rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    let mut text = String::new();
    for [name, expected, default, doc] in &rows {
        let [a, b, c] = widths;
        let line = format!("{name:a$}  {expected:b$}  {default:c$}  {doc}");
        text += line.trim_end();
        text.push('\n');
    }
    text
}

fn as_json(p: &Declared) -> serde_json::Value {
    json!({
        "name": p.name,
        "type": p.kind.name(),
        "default": p.default,
        "value": p.value,
        "min": p.min,
        "max": p.max,
        "choices": p.choices,
        "doc": p.doc,
        "line": p.loc.line,
    })
}
