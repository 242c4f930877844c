//! Which files a picture was made from, and whether they are still as they were.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

/// Files count as changed when they have stayed as they are for so long: editors write in several steps.
const CALM: Duration = Duration::from_millis(60);

/// Length and time of a file; `None` where there is none.
type Stamp = Option<(u64, Option<SystemTime>)>;

fn stamp(path: &Path) -> Stamp {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()))
}

/// The files of one picture, as they were when they were asked for first. Those that were not there count, too: they may
/// come.
#[derive(Debug, Default)]
pub struct Watched {
    files: BTreeMap<PathBuf, Stamp>,
    /// How they were at the last look, if not as they were asked for, and since when.
    others: Option<(Vec<Stamp>, Instant)>,
}

impl Watched {
    /// Notes that a file is about to be read.
    pub fn asked(&mut self, path: PathBuf) {
        self.files.entry(path).or_insert_with_key(|path| stamp(path));
    }

    /// Whether a file is another than it was, and has been left alone for a moment.
    pub fn is_changed(&mut self) -> bool {
        let now: Vec<Stamp> = self.files.keys().map(|path| stamp(path)).collect();
        if now.iter().eq(self.files.values()) {
            self.others = None;
            return false;
        }
        match &self.others {
            Some((others, since)) if *others == now => since.elapsed() >= CALM,
            _ => {
                self.others = Some((now, Instant::now()));
                false
            }
        }
    }
}
