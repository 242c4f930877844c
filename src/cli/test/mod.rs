//! `rtscript test`: scenes against their snapshots.

mod case;
mod difference;
mod find;
mod html;
mod json;
mod junit;
mod outcome;
mod review;
mod text;

use std::{
    collections::BTreeMap,
    num::NonZero,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
        mpsc,
    },
    thread,
    time::Instant,
};

use self::{
    case::Settings,
    outcome::{Case, Totals},
};
use super::{args::TestArgs, report::Reporter, signals::Signals, without_place, write_stdout};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    output,
    testing::diff_picture,
};

/// Tests the scenes that the arguments name; whether all passed or were accepted.
///
/// # Errors
/// `Input` where a path is missing or there is nothing to test, `Output` where a report or a snapshot cannot be
/// written, `Cancelled` where a signal came.
pub(super) fn run(args: &TestArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<bool, Error> {
    let start = Instant::now();
    let files = [&args.html, &args.junit, &args.json];
    for path in files.into_iter().flatten().filter(|path| !is_stdout(path)) {
        output::check_writable(path, &[]).map_err(without_place)?;
    }
    let scenes = scenes(args)?;
    signals.arm(true);
    let jobs = jobs(args, scenes.len());
    let settings = Settings {
        tolerance: args.tolerance,
        overrides: args.overrides.parameters(),
        threads: (processors() / jobs).max(1),
        signals: Arc::clone(signals),
    };
    let terminal = text::Terminal::new(args, reporter);
    let mut cases = Vec::new();
    test_all(&scenes, jobs, &settings, |mut case| {
        if args.accept && case.is_open() {
            case::accept(&mut case, !args.no_pictures)?;
        }
        terminal.case(&case);
        if let Some(folder) = &args.diffs {
            write_difference(folder, &case)?;
        }
        cases.push(case);
        Ok(())
    })?;
    if signals.caught().is_some() {
        return Err(
            Diagnostic::error(ErrorKind::Cancelled, "stopped by a signal before the last scene").into(),
        );
    }
    if args.review {
        review::review(args, &terminal, &mut cases)?;
    }
    let totals = Totals::of(&cases);
    write_reports(args, &cases, &totals)?;
    terminal.totals(&totals, start.elapsed(), args);
    Ok(totals.all_passed())
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// The scenes to test.
fn scenes(args: &TestArgs) -> Result<Vec<PathBuf>, Error> {
    let mut scenes = find::scenes(&args.paths)?;
    let found = scenes.len();
    let filters = &args.filter;
    scenes.retain(|scene| {
        let name = scene.to_string_lossy();
        filters.is_empty() || filters.iter().any(|filter| name.contains(filter.as_str()))
    });
    if !scenes.is_empty() {
        return Ok(scenes);
    }
    let (message, hint) = if found > 0 {
        let message = format!("none of the {found} scenes has {} in its path", quoted(filters));
        (message, "leave --filter out to test all of them")
    } else if args.paths.is_empty() {
        let message =
            "there is nothing to test here: no scene has a snapshot, and there is no folder 'tests'";
        (
            message.to_owned(),
            "rtscript test --accept scene.rhai puts a picture on record",
        )
    } else {
        let message = "there are no scenes in what was given".to_owned();
        (message, "a scene is a file that ends with .rhai or .test")
    };
    Err(Diagnostic::error(ErrorKind::Input, message).hint(hint).into())
}

fn quoted(texts: &[String]) -> String {
    let quoted: Vec<String> = texts.iter().map(|text| format!("'{text}'")).collect();
    quoted.join(" or ")
}

fn processors() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Scenes to work on at once: no more than there are.
fn jobs(args: &TestArgs, scenes: usize) -> usize {
    args.jobs.map_or_else(processors, usize::from).min(scenes).max(1)
}

/// Tests all scenes, `jobs` at once, and hands each to `receive` in the order they stand in. Small pictures in
/// parallel are faster than one after the other with all threads. Ends early where a signal came or `receive` fails.
fn test_all(
    scenes: &[PathBuf],
    jobs: usize,
    settings: &Settings,
    mut receive: impl FnMut(Case) -> Result<(), Error>,
) -> Result<(), Error> {
    let (next, (sender, finished)) = (AtomicUsize::new(0), mpsc::channel());
    thread::scope(|scope| {
        for _ in 0..jobs {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                while settings.signals.caught().is_none() {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(scene) = scenes.get(index) else { return };
                    if sender.send((index, case::test(scene, settings))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let (mut waiting, mut turn) = (BTreeMap::new(), 0);
        for (index, case) in finished {
            waiting.insert(index, case);
            while let Some(case) = waiting.remove(&turn) {
                turn += 1;
                if settings.signals.caught().is_none() {
                    receive(case)?;
                }
            }
        }
        Ok(())
    })
}

/// Expected, difference and actual as one picture, named after the scene.
fn write_difference(folder: &Path, case: &Case) -> Result<(), Error> {
    let Some(change) = case.change() else {
        return Ok(());
    };
    let Some(reference) = &change.reference else {
        return Ok(());
    };
    std::fs::create_dir_all(folder).map_err(|e| {
        Diagnostic::error(
            ErrorKind::Output,
            format!(
                "cannot make the folder '{}': {}",
                folder.display(),
                output::reason(&e)
            ),
        )
    })?;
    let name: String = case
        .name
        .chars()
        .map(|c| if matches!(c, '/' | ':') { '-' } else { c })
        .collect();
    let picture = diff_picture(&reference.image, &change.actual_image);
    output::save(&folder.join(name + ".png"), &picture).map_err(without_place)
}

fn write_reports(args: &TestArgs, cases: &[Case], totals: &Totals) -> Result<(), Error> {
    type Report = fn(&[Case], &Totals) -> String;
    let html: (_, Report) = (&args.html, html::html);
    let junit: (_, Report) = (&args.junit, junit::junit);
    let json: (_, Report) = (&args.json, json::json);
    for (path, report) in [html, junit, json] {
        let Some(path) = path else { continue };
        let text = report(cases, totals);
        if is_stdout(path) {
            write_stdout(text.as_bytes())
        } else {
            output::write_atomically(path, text.as_bytes())
        }
        .map_err(without_place)?;
    }
    Ok(())
}
