//! Which files a picture is made from, and whether one of them changed.
//!
//! Files are looked at again and again, not announced by the system: a look at a few files takes microseconds, finds
//! changes on network drives, where nothing is announced, and does not care whether an editor writes a file, replaces it
//! or moves it away and back. Where looking is slow, it is done less often.

use std::{
    collections::BTreeMap,
    fs::{self, Metadata},
    hash::{DefaultHasher, Hash, Hasher},
    io::Read,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant, SystemTime},
};

/// Time between two looks at the files.
const INTERVAL: Duration = Duration::from_millis(3);
/// A look takes at most one part in so many of the time.
const SHARE: u32 = 25;
/// A file that stays the same for so long is taken to be whole.
const SETTLED: Duration = Duration::from_millis(10);
/// A file that is empty or gone gets so long to come back: editors cut a file off before they fill it, or move it away
/// before they put the new one there.
const COMES_BACK: Duration = Duration::from_millis(300);
/// The coarsest clock of a file system ticks every two seconds (FAT). After that a second change cannot hide behind the
/// time of the first.
const TICK: Duration = Duration::from_millis(2500);

/// What a look at a file tells without reading it; a file that is not there has none.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    bytes: u64,
    modified: Option<SystemTime>,
    /// Which file it is and when anything about it changed, where the system tells.
    identity: [i64; 4],
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok()?;
        Some(Self {
            bytes: metadata.len(),
            modified: metadata.modified().ok(),
            identity: identity(&metadata),
        })
    }
}

#[cfg(unix)]
fn identity(metadata: &Metadata) -> [i64; 4] {
    use std::os::unix::fs::MetadataExt;
    let numbers = [metadata.dev(), metadata.ino()].map(u64::cast_signed);
    [numbers[0], numbers[1], metadata.ctime(), metadata.ctime_nsec()]
}

#[cfg(not(unix))]
fn identity(_metadata: &Metadata) -> [i64; 4] {
    [0; 4]
}

#[derive(Debug)]
struct File {
    stamp: Option<Stamp>,
    /// Of the bytes that were read; `None` where it was not read.
    content: Option<u64>,
    asked: Instant,
    /// Its bytes were compared once [`TICK`] had passed.
    is_sure: bool,
    /// They were others, though nothing else tells.
    is_another: bool,
    /// The run that asked for it last.
    run: u64,
}

impl File {
    /// A file as it is now, which nobody has read.
    fn now(path: &Path) -> Self {
        Self {
            stamp: Stamp::of(path),
            content: None,
            asked: Instant::now(),
            is_sure: false,
            is_another: false,
            run: 0,
        }
    }
}

/// The files of the runs so far.
#[derive(Debug, Default)]
pub(super) struct Files {
    files: BTreeMap<PathBuf, File>,
    run: u64,
    /// When the next look is due.
    next: Option<Instant>,
    /// A change was seen that no run knows of.
    changed: bool,
}

impl Files {
    /// A run begins, which will see all changes up to now, also of files that it has not asked for yet.
    pub(super) fn begin(&mut self) {
        self.run += 1;
        self.changed = false;
        for (path, file) in &mut self.files {
            let run = file.run;
            *file = File {
                run,
                ..File::now(path)
            };
        }
    }

    /// A file is about to be read, whether it is there or not.
    pub(super) fn asked(&mut self, path: &Path) {
        let file = File {
            run: self.run,
            ..File::now(path)
        };
        if let Some(known) = self.files.get_mut(path) {
            // Read twice in a run, it must be the same for both.
            if known.run == self.run {
                return;
            }
            *known = file;
        } else {
            self.files.insert(path.to_owned(), file);
        }
    }

    /// A file was read.
    pub(super) fn read(&mut self, path: &Path, bytes: &[u8]) {
        if let Some(file) = self.files.get_mut(path) {
            file.content = Some(content(bytes));
        }
    }

    /// The run went well: only its files count any more. Those of a run that failed are not all.
    pub(super) fn complete(&mut self) {
        let run = self.run;
        self.files.retain(|_, file| file.run == run);
    }

    /// The files, in the order of their names.
    pub(super) fn names(&self) -> impl Iterator<Item = &Path> {
        self.files.keys().map(PathBuf::as_path)
    }

    /// Whether a file changed since the run began, looked at only when it is time.
    pub(super) fn is_changed(&mut self) -> bool {
        let now = Instant::now();
        if self.changed || self.next.is_some_and(|next| now < next) {
            return self.changed;
        }
        self.changed = self.files.iter_mut().any(|(path, file)| {
            if Stamp::of(path) != file.stamp {
                return true;
            }
            let is_due = !file.is_sure && now - file.asked > TICK;
            file.is_sure |= is_due;
            file.is_another |= is_due && file.content.is_some() && read(path) != file.content;
            file.is_another
        });
        let took = now.elapsed();
        self.next = Some(now + took + INTERVAL.max(took * SHARE));
        self.changed
    }

    /// Waits until the files stay as they are, and says whether any of them is another than the run saw; `stop` ends the
    /// wait.
    pub(super) fn settle(&mut self, stop: impl Fn() -> bool) -> bool {
        let stamps =
            |files: &Self| -> Vec<Option<Stamp>> { files.files.keys().map(|path| Stamp::of(path)).collect() };
        let start = Instant::now();
        let (mut last, mut since) = (stamps(self), start);
        loop {
            thread::sleep(INTERVAL / 2);
            let now = stamps(self);
            if now != last {
                (last, since) = (now, Instant::now());
                continue;
            }
            let is_half_done = self.files.values().zip(&last).any(|(file, now)| {
                let bytes = |stamp: &Option<Stamp>| stamp.as_ref().map_or(0, |stamp| stamp.bytes);
                bytes(&file.stamp) > 0 && bytes(now) == 0
            });
            let waits = if is_half_done { COMES_BACK } else { SETTLED };
            if since.elapsed() >= waits || stop() {
                break;
            }
        }
        let mut is_another = false;
        for ((path, file), stamp) in self.files.iter_mut().zip(last) {
            if file.stamp == stamp {
                is_another |= file.is_another;
            } else if file.content.is_none() || read(path) != file.content {
                is_another = true;
            } else {
                file.stamp = stamp;
            }
        }
        self.changed = false;
        is_another
    }

    /// How long nothing changed, as far as is known: since the youngest file was written, or asked for.
    pub(super) fn quiet_for(&self) -> Duration {
        let now = SystemTime::now();
        let ages = self.files.values().map(|file| {
            let modified = file.stamp.as_ref().and_then(|stamp| stamp.modified);
            // A clock that is ahead of ours says nothing.
            let age = modified.and_then(|modified| now.duration_since(modified).ok());
            age.unwrap_or_else(|| file.asked.elapsed())
        });
        ages.min().unwrap_or(Duration::MAX)
    }
}

/// What is in a file; `None` where it cannot be read.
fn read(path: &Path) -> Option<u64> {
    let mut bytes = Vec::new();
    let metadata = fs::metadata(path).ok().filter(Metadata::is_file)?;
    let file = fs::File::open(path).ok()?;
    file.take(metadata.len() + 1).read_to_end(&mut bytes).ok()?;
    Some(content(&bytes))
}

/// A number for what is in a file. Only whether to render again hangs on it.
fn content(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("rtscript-watch-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn file(&self, name: &str, content: &str) -> PathBuf {
            let path = self.0.join(name);
            fs::write(&path, content).unwrap();
            path
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).unwrap();
        }
    }

    fn read_all(files: &mut Files, paths: &[&PathBuf]) {
        files.begin();
        for path in paths {
            files.asked(path);
            if let Ok(bytes) = fs::read(path) {
                files.read(path, &bytes);
            }
        }
    }

    /// Looks at once, however short ago the last look was.
    fn is_changed(files: &mut Files) -> bool {
        files.next = None;
        files.is_changed()
    }

    #[test]
    fn only_another_content_counts_in_the_end() {
        let folder = Folder::new("content");
        let (a, b) = (folder.file("a", "one"), folder.0.join("b"));
        let mut files = Files::default();
        read_all(&mut files, &[&a, &b]);
        assert!(!is_changed(&mut files));
        // The same again, as another file.
        folder.file("new", "one");
        fs::rename(folder.0.join("new"), &a).unwrap();
        assert!(is_changed(&mut files));
        assert!(!files.settle(|| false));
        assert!(!is_changed(&mut files));
        // A file that was missing.
        folder.file("b", "");
        assert!(is_changed(&mut files));
        assert!(files.settle(|| false));
        read_all(&mut files, &[&a, &b]);
        assert!(!is_changed(&mut files));
        fs::remove_file(&a).unwrap();
        assert!(is_changed(&mut files));
        assert!(files.settle(|| false));
    }

    #[test]
    fn a_run_is_not_cut_by_a_change_that_led_to_it() {
        let folder = Folder::new("begin");
        let (a, b) = (folder.file("a", "one"), folder.0.join("b"));
        let mut files = Files::default();
        read_all(&mut files, &[&a, &b]);
        folder.file("b", "at last");
        assert!(is_changed(&mut files));
        files.begin();
        // Before the run has come to the file, and after.
        assert!(!is_changed(&mut files));
        files.asked(&b);
        assert!(!is_changed(&mut files));
        folder.file("b", "again");
        assert!(is_changed(&mut files));
    }

    #[test]
    fn a_change_that_no_clock_tells_is_found_by_reading() {
        let folder = Folder::new("tick");
        let a = folder.file("a", "one");
        let mut files = Files::default();
        read_all(&mut files, &[&a]);
        // The same length and the same time, as on a file system with a coarse clock.
        folder.file("a", "two");
        let file = files.files.get_mut(&a).unwrap();
        file.stamp = Stamp::of(&a);
        assert!(!is_changed(&mut files));
        let file = files.files.get_mut(&a).unwrap();
        file.asked = file.asked.checked_sub(2 * TICK).unwrap();
        assert!(is_changed(&mut files));
        assert!(files.settle(|| false));
    }

    #[test]
    fn files_of_a_run_that_failed_are_watched_besides() {
        let folder = Folder::new("runs");
        let paths = ["a", "b"].map(|name| folder.file(name, name));
        let mut files = Files::default();
        read_all(&mut files, &[&paths[0], &paths[1]]);
        files.complete();
        read_all(&mut files, &[&paths[0]]);
        assert_eq!(files.names().count(), 2);
        folder.file("b", "c");
        assert!(is_changed(&mut files));
        read_all(&mut files, &[&paths[0]]);
        files.complete();
        assert_eq!(files.names().collect::<Vec<_>>(), [paths[0].as_path()]);
    }
}
