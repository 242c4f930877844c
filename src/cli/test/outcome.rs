//! What the test of a scene found: everything that the terminal, JUnit, JSON and HTML tell.

use std::{path::PathBuf, time::Duration};

use crate::{
    cli::measures::Measures,
    diag::Error,
    recipe::Recipe,
    render::Image,
    testing::{LineShare, Snapshot},
};

/// One scene and what its test found.
#[derive(Debug)]
pub(super) struct Case {
    /// The scene's path as it was found, with `/` between folders.
    pub(super) name: String,
    /// Where it is.
    pub(super) path: PathBuf,
    /// Time to run and render it, and to look into a change.
    pub(super) took: Duration,
    pub(super) outcome: Outcome,
    /// It was put on record as it is.
    pub(super) accepted: bool,
}

impl Case {
    /// Whether it waits to be put on record as it is.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.outcome, Outcome::Changed(_) | Outcome::New(_)) && !self.accepted
    }

    /// What changed, tolerated or not.
    pub(super) fn change(&self) -> Option<&Change> {
        match &self.outcome {
            Outcome::Changed(change) | Outcome::Tolerated(change) => Some(change),
            Outcome::Passed | Outcome::New(_) | Outcome::Failed(_) => None,
        }
    }
}

/// How many scenes came to what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Totals {
    pub(super) passed: usize,
    pub(super) tolerated: usize,
    pub(super) accepted: usize,
    pub(super) changed: usize,
    pub(super) new: usize,
    pub(super) failed: usize,
}

impl Totals {
    /// Counts cases.
    pub(super) fn of(cases: &[Case]) -> Self {
        let mut totals = Self::default();
        for case in cases {
            *match &case.outcome {
                _ if case.accepted => &mut totals.accepted,
                Outcome::Passed => &mut totals.passed,
                Outcome::Tolerated(_) => &mut totals.tolerated,
                Outcome::Changed(_) => &mut totals.changed,
                Outcome::New(_) => &mut totals.new,
                Outcome::Failed(_) => &mut totals.failed,
            } += 1;
        }
        totals
    }

    pub(super) fn all_passed(&self) -> bool {
        self.changed + self.new + self.failed == 0
    }

    pub(super) fn scenes(&self) -> usize {
        self.passed + self.tolerated + self.accepted + self.changed + self.new + self.failed
    }

    /// `12 scenes: 9 passed, 2 changed, 1 failed`.
    pub(super) fn text(&self) -> String {
        let counts = [
            (self.passed, "passed"),
            (self.tolerated, "within the tolerance"),
            (self.accepted, "accepted"),
            (self.changed, "changed"),
            (self.new, "new"),
            (self.failed, "failed"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let counts: Vec<String> = counts.map(|(count, what)| format!("{count} {what}")).collect();
        let scenes = match self.scenes() {
            1 => "1 scene".to_owned(),
            n => format!("{n} scenes"),
        };
        format!("{scenes}: {}", counts.join(", "))
    }
}

/// What the test of one scene found.
#[derive(Debug)]
pub(super) enum Outcome {
    /// The picture and everything else in the snapshot is as it was.
    Passed,
    /// The picture differs, but not more than was allowed.
    Tolerated(Box<Change>),
    /// Something differs.
    Changed(Box<Change>),
    /// There is no snapshot yet.
    New(Box<Fresh>),
    /// The scene cannot be rendered, or its snapshot cannot be read.
    Failed(Box<Error>),
}

/// A scene without a snapshot.
#[derive(Debug)]
pub(super) struct Fresh {
    pub(super) snapshot: Snapshot,
    pub(super) image: Image,
    /// What its reference picture is to carry.
    pub(super) recipe: Recipe,
}

/// A scene that is not as its snapshot says.
#[derive(Debug)]
pub(super) struct Change {
    /// The snapshot on record.
    pub(super) expected: Snapshot,
    /// What a snapshot taken now would say.
    pub(super) actual: Snapshot,
    pub(super) actual_image: Image,
    /// What the new reference picture is to carry.
    pub(super) recipe: Recipe,
    /// The reference picture and how the two differ; `None` where no reference picture was kept.
    pub(super) reference: Option<Reference>,
    /// The calls whose shapes the changed pixels show, most pixels first.
    pub(super) lines: Vec<LineShare>,
    /// What changed in the scene: lines of its dump, those that are gone with `-` before them, those that are new
    /// with `+`; where the reference picture carries the scripts.
    pub(super) scene: Vec<String>,
    /// Scripts that changed since the snapshot, where the reference picture carries them.
    pub(super) sources: Vec<SourceChange>,
}

impl Change {
    /// Whether nothing but pixels differs.
    pub(super) fn only_the_picture(&self) -> bool {
        let mut as_expected = self.actual.clone();
        as_expected.hash.clone_from(&self.expected.hash);
        self.expected.guards(&as_expected)
    }
}

/// The picture that a snapshot was taken of, beside the one of now.
#[derive(Debug)]
pub(super) struct Reference {
    pub(super) image: Image,
    pub(super) measures: Measures,
}

/// One script then and now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SourceChange {
    pub(super) name: String,
    /// Empty where the script was not there.
    pub(super) before: String,
    pub(super) after: String,
}
