//! `rtscript diff`: two scenes, and what is different between them.

mod lines;
mod rows;

use std::sync::Arc;

use serde_json::json;

use self::{lines::Lines, rows::Rows};
use super::{
    args::DiffArgs, measures::Measures, report::Reporter, signals::Signals, subject::Subject, without_place,
    write_stdout,
};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    output,
    scene::compare,
    script::Run,
    testing::diff_picture,
};

/// Compares two scenes and says whether anything is different.
///
/// # Errors
/// Whatever keeps one of them from being built or rendered; `Output` where the picture cannot be written.
pub(super) fn diff(
    args: &DiffArgs,
    json: bool,
    signals: &Arc<Signals>,
    reporter: Reporter,
) -> Result<bool, Error> {
    if args.before == args.after && args.before.as_os_str() == "-" {
        let message = "standard input can be read only once, but both scenes are -";
        return Err(Diagnostic::error(ErrorKind::Input, message).into());
    }
    if let Some(path) = &args.output {
        let inputs = [args.before.clone(), args.after.clone()];
        output::check_target(path, &inputs).map_err(without_place)?;
    }
    let read = |file| -> Result<(Subject, Run), Error> {
        let mut subject = Subject::read(file, None, &args.overrides, signals)?;
        subject.set_threads(args.threads.count());
        let report = subject.load()?;
        reporter.warnings(&report.warnings);
        Ok((subject, report.value))
    };
    let (old, mut before) = read(&args.before)?;
    let (new, mut after) = read(&args.after)?;
    let measures = match &args.output {
        Some(path) => {
            let (a, b) = (old.picture(&mut before)?, new.picture(&mut after)?);
            output::save(path, &diff_picture(&a, &b)).map_err(without_place)?;
            Some(Measures::of(&a, &b))
        }
        None => None,
    };
    let settings = compare::settings(&before.scene, &after.scene);
    let mut rows = Rows::new(&before.scene, &after.scene);
    let is_same = before.scene.hash() == after.scene.hash();
    if !is_same {
        let lines = Lines::of((&old, &before.scene), (&new, &after.scene));
        compare::compare(
            &before.scene,
            &after.scene,
            &|is_new, loc| lines.place(is_new, loc),
            &mut |change| rows.add(change),
        );
    }
    let differs = !(settings.is_empty() && rows.is_empty());
    let pixels_differ = measures.as_ref().is_some_and(|m| m.comparison.differing > 0);
    let text = if json {
        let settings = settings
            .iter()
            .map(|(name, from, to)| json!({ "name": name, "from": from, "to": to }));
        let all = json!({
            "rtscript": env!("CARGO_PKG_VERSION"),
            "before": old.name,
            "after": new.name,
            "equal": !differs,
            "same_order": is_same,
            "settings": settings.collect::<Vec<_>>(),
            "changes": rows.json(),
            "pixels": measures.as_ref().map(Measures::json),
        });
        format!("{all:#}\n")
    } else {
        let mut text = String::new();
        for (name, from, to) in &settings {
            text += &format!("~ {name} {from} -> {to}\n");
        }
        text += &rows.text();
        text += &match (differs, is_same) {
            (true, _) => rows.totals(settings.len()),
            (false, true) => "the scenes are equal".to_owned(),
            (false, false) => {
                "the scenes hold the same things, made in another order or numbered anew".to_owned()
            }
        };
        text.push('\n');
        if let Some(measures) = &measures {
            text += &match pixels_differ {
                true => measures.text(),
                false => "the pixels are equal".to_owned(),
            };
            text.push('\n');
        }
        // Names of files and of groups come from scenes, and shall not steer a terminal.
        text.replace(|c: char| c.is_control() && c != '\n', "\u{fffd}")
    };
    write_stdout(text.as_bytes()).map_err(without_place)?;
    Ok(differs || pixels_differ)
}
