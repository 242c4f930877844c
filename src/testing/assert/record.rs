//! What is on record under a name: the snapshot and the picture that it was taken of.

use std::{
    fs,
    path::{Path, PathBuf},
};

use insta::internals::Content;

use super::{Comparison, Tolerance, picture_at, surroundings};
use crate::{output, render::Image};

/// The first line of a snapshot's header that tells about a difference under review, and what such lines begin with.
const NOTE: [&str; 2] = ["info:", "  "];
/// The address of a picture of this machine, which only such a note holds.
const ADDRESS: &str = ": \"file://";

/// Lines of a snapshot that tell of its picture and may differ within a tolerance: hash, mean, and nine of luma. The
/// size comes before them.
const HEAD: std::ops::Range<usize> = 1..12;

/// `<stem>.snap` and `<stem>.png`.
pub(super) struct Record {
    pub(super) snapshot: PathBuf,
    pub(super) picture: PathBuf,
    /// Header and text of the snapshot, if there is one.
    accepted: Option<(String, String)>,
}

impl Record {
    pub(super) fn new(folder: &Path, stem: &str) -> Self {
        let snapshot = folder.join(format!("{stem}.snap"));
        let accepted = fs::read_to_string(&snapshot).ok();
        Self {
            picture: folder.join(format!("{stem}.png")),
            accepted: accepted.as_deref().and_then(parts),
            snapshot,
        }
    }

    /// The text on record.
    fn text(&self) -> Option<&str> {
        self.accepted.as_ref().map(|(_, text)| text.as_str())
    }

    /// Whether `text` is what is on record, as insta compares: without blank lines around it.
    pub(super) fn is(&self, text: &str) -> bool {
        self.text().is_some_and(|accepted| bare(accepted) == bare(text))
    }

    /// Whether the text on record was taken of `picture`.
    pub(super) fn is_of(&self, picture: &Image) -> bool {
        let hash = |text: &str| {
            text.lines()
                .find_map(|line| line.strip_prefix("hash ").map(str::to_owned))
        };
        self.text().and_then(hash) == Some(picture.hash())
    }

    /// The picture beside the snapshot.
    pub(super) fn reference(&self) -> Option<Image> {
        picture_at(&self.picture)
    }

    /// Puts in order what a review leaves behind: the picture of the accepted text in place of the one before, and the
    /// note about their difference out of the snapshot.
    pub(super) fn settle(&self, image: Option<&Image>) -> Result<(), String> {
        let noted = self.accepted.as_ref().and_then(|(header, text)| {
            let header = without_note(header)?;
            Some(format!("---\n{header}---\n{text}"))
        });
        let stale = image.filter(|image| {
            let reference = self.reference();
            reference.is_none_or(|r| {
                (r.width(), r.height(), r.hash()) != (image.width(), image.height(), image.hash())
            })
        });
        if noted.is_none() && stale.is_none() {
            return Ok(());
        }
        if !surroundings::may_write() {
            let (snapshot, picture) = (self.snapshot.display(), self.picture.display());
            return Err(match noted {
                Some(_) => {
                    format!("{snapshot} still tells how it differed; run the test once where it may write")
                }
                None => format!(
                    "{picture} is not the picture of its snapshot; run the test once where it may write it"
                ),
            });
        }
        if let Some(text) = noted {
            output::write_atomically(&self.snapshot, text.as_bytes()).map_err(|e| e.message)?;
        }
        stale.map_or(Ok(()), |image| {
            output::save(&self.picture, image).map_err(|e| e.message)
        })
    }

    /// How near `text` and a picture that compares so with the reference are to what is on record.
    pub(super) fn nearness(&self, text: &str, tolerance: &Tolerance, comparison: &Comparison) -> Nearness {
        let is_current = self.reference().is_some_and(|reference| self.is_of(&reference));
        let Some(accepted) = self.text().filter(|_| is_current && tolerance.allows(comparison)) else {
            return Nearness::Far;
        };
        let rest = |text: &str| {
            let lines = bare(text).lines().enumerate();
            let lines = lines
                .filter(|(i, _)| !HEAD.contains(i))
                .map(|(_, line)| line.to_owned());
            let counts = |line: &String| !tolerance.scene_may_differ || !line.is_empty();
            lines.take_while(counts).collect::<Vec<String>>()
        };
        if rest(accepted) == rest(text) {
            Nearness::Near(accepted.to_owned())
        } else {
            Nearness::InPixelsAlone
        }
    }
}

/// How near something is to what is on record.
pub(super) enum Nearness {
    /// Within the tolerance, which the text on record then stands for.
    Near(String),
    /// The picture is within the tolerance, the rest of the text is not.
    InPixelsAlone,
    /// Beyond the tolerance, or there is no reference to measure by.
    Far,
}

/// How a picture differs, for the header of a snapshot that waits for a review.
pub(super) fn note(shown: &[(&'static str, String)]) -> Content {
    let text = |text: &str| Content::String(text.to_owned());
    Content::Map(
        shown
            .iter()
            .map(|(what, value)| (text(what), text(value)))
            .collect(),
    )
}

/// Header and text of a snapshot file, line ends made the same.
fn parts(file: &str) -> Option<(String, String)> {
    let mut lines = file.lines();
    lines.next().filter(|line| line.trim_end() == "---")?;
    let line_of = |line: &str| format!("{line}\n");
    let header: String = lines
        .by_ref()
        .take_while(|line| line.trim_end() != "---")
        .map(line_of)
        .collect();
    Some((header, lines.map(line_of).collect()))
}

/// The header without the note about a difference; `None` where there is none in it.
fn without_note(header: &str) -> Option<String> {
    let lines: Vec<&str> = header.lines().collect();
    let start = lines.iter().position(|line| *line == NOTE[0])?;
    let noted = lines
        .iter()
        .skip(start + 1)
        .take_while(|line| line.starts_with(NOTE[1]));
    let noted: Vec<&&str> = noted.collect();
    if !noted.iter().any(|line| line.contains(ADDRESS)) {
        return None;
    }
    let (before, after) = (
        lines.iter().take(start),
        lines.iter().skip(start + 1 + noted.len()),
    );
    Some(before.chain(after).map(|line| format!("{line}\n")).collect())
}

/// A text as insta compares it.
fn bare(text: &str) -> &str {
    text.trim_end().trim_start_matches(['\r', '\n'])
}
