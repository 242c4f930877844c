//! What a script may rely on to stay as it is.

use super::int;
use crate::{
    diag::SourceLoc,
    scene::Edition,
    script::{
        call::{Call, quoted},
        session::State,
        table::{DONE, Entry, Group},
        value::{Outcome, ScriptError},
    },
};

pub(super) const ENTRIES: &[Entry] = &[Entry::scene(Group::Camera, "edition", edition)
    .takes(&[&[int("year", "none", "of the edition; 2026 is the only one yet")]])
    .doc("Keeps the picture as it is in every later version: its defaults, formulas, sampling patterns, random numbers and encoding stay those of the edition. The first call of a script, if it is called. Default: the newest edition.")
    .usage("edition(2026)")
    .example("edition(2026);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0, 0, 1.3);")
    .also(&["version", "language"])];

fn edition(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let year = call.int("year")?;
    call.end()?;
    let edition = Edition::from_year(year)?;
    let (here, chosen) = (state.builder.loc(), state.builder.settings().edition);
    if here.file != MAIN && chosen.is_none() {
        return Err(call
            .error(format!(
                "a module cannot choose it, and its script has not chosen {edition}"
            ))
            .hint(format!(
                "make edition({edition}); the first call of the script, before the import"
            )));
    }
    if let (None, Some(first)) = (chosen, state.first.filter(|first| *first != here)) {
        return Err(
            late(call, state, first).hint(format!("make edition({edition}); the first line of the script"))
        );
    }
    state.builder.edition(edition)?;
    DONE
}

/// The script itself, among the files of a run.
const MAIN: u16 = 0;

/// The error for a call that another one comes before.
#[cold]
fn late(call: &Call<'_, '_>, state: &State, first: SourceLoc) -> Box<ScriptError> {
    let line = (first.line as usize).checked_sub(1);
    let text = state.sources.first().filter(|_| first.file == MAIN);
    let text = text
        .zip(line)
        .and_then(|(source, line)| source.text.lines().nth(line));
    call.error(match text {
        Some(text) => {
            let (line, text) = (first.line, quoted(text.trim()));
            format!("it must come before every other call, but line {line} comes before it: {text}")
        }
        None => "it must come before every other call, but an imported file makes one before it".to_owned(),
    })
}
