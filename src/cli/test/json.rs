//! The report that programs read.

use serde_json::{Value, json};

use super::{
    outcome::{Case, Change, Outcome, Totals},
    text::details,
};
use crate::testing::Snapshot;

/// One object: the version, the totals, and every case with its outcome, hashes, measures and script lines.
pub(super) fn json(cases: &[Case], totals: &Totals) -> String {
    let report = json!({
        "rtscript": env!("CARGO_PKG_VERSION"),
        "passed": totals.passed,
        "tolerated": totals.tolerated,
        "accepted": totals.accepted,
        "changed": totals.changed,
        "new": totals.new,
        "failed": totals.failed,
        "cases": cases.iter().map(of_case).collect::<Vec<_>>(),
    });
    format!("{report:#}\n")
}

fn of_case(case: &Case) -> Value {
    let mut value = match &case.outcome {
        Outcome::Passed => json!({ "outcome": "passed" }),
        Outcome::Tolerated(change) => of_change("tolerated", change),
        Outcome::Changed(change) => of_change("changed", change),
        Outcome::New(fresh) => json!({ "outcome": "new", "actual": of_snapshot(&fresh.snapshot) }),
        Outcome::Failed(error) => json!({
            "outcome": "failed",
            "message": error.diagnostic.message,
            "file": error.diagnostic.file.as_deref(),
            "line": error.diagnostic.line,
            "column": error.diagnostic.column,
            "hints": error.diagnostic.hints,
        }),
    };
    if let Some(members) = value.as_object_mut() {
        members.insert("name".to_owned(), json!(case.name));
        members.insert("seconds".to_owned(), json!(case.took.as_secs_f64()));
        members.insert("accepted".to_owned(), json!(case.accepted));
    }
    value
}

fn of_change(outcome: &str, change: &Change) -> Value {
    let lines = change.lines.iter().map(|line| {
        json!({
            "file": line.file, "line": line.line, "column": line.column, "text": line.text,
            "pixels": line.now, "pixels_before": line.before,
        })
    });
    let measures = change
        .reference
        .as_ref()
        .map(|reference| reference.measures.json());
    json!({
        "outcome": outcome,
        "expected": of_snapshot(&change.expected),
        "actual": of_snapshot(&change.actual),
        "difference": measures,
        "lines": lines.collect::<Vec<_>>(),
        "scene": change.scene,
        "scripts": change.sources.iter().map(|source| &source.name).collect::<Vec<_>>(),
        "details": details(change),
    })
}

fn of_snapshot(snapshot: &Snapshot) -> Value {
    json!({
        "hash": snapshot.hash,
        "scene": snapshot.scene,
        "width": snapshot.width,
        "height": snapshot.height,
        "samples": snapshot.samples,
        "parameters": snapshot.parameters.to_string(),
        "version": snapshot.version,
    })
}
