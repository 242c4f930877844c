//! What a test tells on the terminal.

use std::{fmt::Write as _, io::Write as _, time::Duration};

use super::{
    is_stdout,
    outcome::{Case, Change, Outcome, Totals},
};
use crate::{
    cli::{args::TestArgs, report::Reporter, stats},
    testing::LineShare,
};

const GREEN: &str = "\x1b[32m";
const YELLOW: &str = "\x1b[33m";
const RED: &str = "\x1b[31m";
const DIM: &str = "\x1b[2m";
const PLAIN: &str = "\x1b[0m";

/// Script lines and scene lines shown of one change.
const SHOWN: usize = 5;

/// Writes to standard output, or to standard error where standard output carries a report.
#[derive(Debug)]
pub(super) struct Terminal {
    quiet: bool,
    to_stderr: bool,
    reporter: Reporter,
}

impl Terminal {
    pub(super) fn new(args: &TestArgs, reporter: Reporter) -> Self {
        let files = [&args.html, &args.junit, &args.json];
        Self {
            quiet: args.quiet,
            to_stderr: files.into_iter().flatten().any(|path| is_stdout(path)),
            reporter,
        }
    }

    /// Writes a line.
    pub(super) fn line(&self, text: &str) {
        // Where nobody reads, nobody is left to tell.
        let _ = if self.to_stderr {
            writeln!(anstream::stderr().lock(), "{text}")
        } else {
            writeln!(anstream::stdout().lock(), "{text}")
        };
    }

    /// Writes without a line end, to where pictures and questions go.
    pub(super) fn write(&self, text: &str) {
        let _ = if self.to_stderr {
            let mut out = std::io::stderr().lock();
            out.write_all(text.as_bytes()).and_then(|()| out.flush())
        } else {
            let mut out = std::io::stdout().lock();
            out.write_all(text.as_bytes()).and_then(|()| out.flush())
        };
    }

    /// Tells what became of one scene.
    pub(super) fn case(&self, case: &Case) {
        let (color, word) = match &case.outcome {
            _ if case.accepted => (GREEN, "accepted"),
            Outcome::Passed => (GREEN, "ok"),
            Outcome::Tolerated(_) => (GREEN, "similar"),
            Outcome::Changed(_) => (RED, "CHANGED"),
            Outcome::New(_) => (YELLOW, "NEW"),
            Outcome::Failed(_) => (RED, "FAILED"),
        };
        let is_good = case.accepted || matches!(case.outcome, Outcome::Passed | Outcome::Tolerated(_));
        if self.quiet && is_good {
            return;
        }
        let (name, took) = (&case.name, stats::time(case.took));
        self.line(&format!("{color}{word:<9}{PLAIN} {name}  {DIM}{took}{PLAIN}"));
        if let Outcome::Failed(error) = &case.outcome {
            self.reporter.error(error);
        }
        if let Some(change) = case.change() {
            for line in details(change) {
                self.line(&format!("          {line}"));
            }
        }
        if let (Outcome::New(fresh), false) = (&case.outcome, case.accepted) {
            let size = format!("{} x {}", fresh.snapshot.width, fresh.snapshot.height);
            self.line(&format!(
                "          no snapshot yet; now {size}, hash {}",
                fresh.snapshot.hash
            ));
        }
    }

    /// The last lines.
    pub(super) fn totals(&self, totals: &Totals, took: Duration, args: &TestArgs) {
        let color = if totals.all_passed() { GREEN } else { RED };
        self.line(&format!(
            "{color}{}{PLAIN} in {}",
            totals.text(),
            stats::time(took)
        ));
        if totals.changed + totals.new > 0 && !(args.review || self.quiet) {
            self.line("to look at each and decide: rtscript test --review; to accept all: --accept; for a browser: --html report.html");
        }
    }
}

/// What differs, a line each.
pub(super) fn details(change: &Change) -> Vec<String> {
    let (old, new) = (&change.expected, &change.actual);
    let mut lines = Vec::new();
    if (old.width, old.height) != (new.width, new.height) {
        lines.push(format!(
            "size {} x {} -> {} x {}",
            old.width, old.height, new.width, new.height
        ));
    }
    match &change.reference {
        Some(reference) if old.hash != new.hash => lines.push(reference.measures.text()),
        None if old.hash != new.hash => {
            lines.push("the pixels differ; there is no reference picture to compare with".to_owned())
        }
        _ => {}
    }
    if old.hash != new.hash {
        lines.push(format!("hash {} -> {}", old.hash, new.hash));
    }
    let shown = change.lines.iter().take(SHOWN);
    lines.extend(shown.map(|line| format!("shows {}", share(line))));
    lines.extend(more(change.lines.len(), "lines"));
    lines.extend(
        change
            .scene
            .iter()
            .take(2 * SHOWN)
            .map(|line| format!("scene {line}")),
    );
    lines.extend(more(
        change.scene.len().saturating_sub(SHOWN),
        "differences of the scene",
    ));
    for (what, old, new) in [
        ("warning", &old.warnings, &new.warnings),
        ("printed", &old.printed, &new.printed),
    ] {
        let gone = old
            .iter()
            .filter(|text| !new.contains(text))
            .map(|text| ("-", text));
        let come = new
            .iter()
            .filter(|text| !old.contains(text))
            .map(|text| ("+", text));
        let differing: Vec<_> = gone.chain(come).collect();
        if differing.is_empty() && old != new {
            lines.push(format!("{what} in another order or another number of times"));
        }
        lines.extend(
            differing
                .into_iter()
                .take(SHOWN)
                .map(|(sign, text)| format!("{what} {sign} {text:?}")),
        );
    }
    if old.earlier != new.earlier {
        let pictures = |count| if count == 1 { "picture" } else { "pictures" };
        let (a, b) = (old.earlier.len(), new.earlier.len());
        lines.push(format!(
            "before it {a} {} -> {b} {}, not the same",
            pictures(a),
            pictures(b)
        ));
    }
    lines
}

/// How many are not shown.
fn more(count: usize, what: &str) -> Option<String> {
    (count > SHOWN).then(|| format!("and {} more {what}", count - SHOWN))
}

/// `a.rhai:12  sphere(0, 1, 0, 1);  900 pixels, 850 before`.
fn share(line: &LineShare) -> String {
    let mut text = String::new();
    if line.line > 0 {
        // Writing into a String does not fail.
        let _ = write!(text, "{}:{}  ", line.file, line.line);
    }
    let source: String = line.text.chars().take(60).collect();
    let _ = match line.now {
        0 => write!(text, "{source}  in none of them"),
        now => write!(text, "{source}  in {now} of them"),
    };
    if line.before > 0 {
        let _ = write!(text, ", before in {}", line.before);
    }
    text
}
