//! Dry runs of open documents, beside the thread that answers the client.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use super::documents::{Document, Texts, normal};
use crate::{
    cli::guard,
    diag::{Diagnostic, Error, ErrorKind},
    host::{self, Host, HostError},
    limits::Limits,
    render::{Image, inspect},
    script::RunOptions,
    source,
};

/// How long after an edit a check begins: in the middle of a word there is nothing to say.
const DELAY: Duration = Duration::from_millis(120);

/// How long a check may take.
const LONGEST: Duration = Duration::from_secs(10);

/// Checks at the same time, so that a script without an end does not keep the others waiting.
const WORKERS: usize = 2;

/// A document to be checked.
#[derive(Debug)]
pub(super) struct Job {
    uri: String,
    version: i64,
    name: String,
    folder: Option<PathBuf>,
    text: Arc<str>,
    /// Open files, which scripts see as they are in the editor.
    texts: Texts,
    due: Instant,
    stop: Arc<AtomicBool>,
}

impl Job {
    pub(super) fn new(document: &Document, texts: Texts) -> Self {
        Self {
            uri: document.uri.clone(),
            version: document.version,
            name: document.name(),
            folder: document.folder().map(ToOwned::to_owned),
            text: Arc::clone(&document.text),
            texts,
            due: Instant::now() + DELAY,
            stop: Arc::default(),
        }
    }
}

/// What a check found.
#[derive(Debug)]
pub(super) struct Checked {
    pub(super) uri: String,
    pub(super) version: i64,
    pub(super) found: Vec<Diagnostic>,
    /// It was ended before the script was.
    pub(super) unfinished: bool,
    /// Files that were read.
    pub(super) reads: BTreeSet<PathBuf>,
}

/// The threads that check.
#[derive(Debug)]
pub(super) struct Checker {
    queue: Arc<Queue>,
}

#[derive(Debug, Default)]
struct Queue {
    jobs: Mutex<Jobs>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Jobs {
    waiting: BTreeMap<String, Job>,
    running: BTreeMap<String, Arc<AtomicBool>>,
    closed: bool,
}

impl Checker {
    /// Starts the threads; what they find goes to `done`.
    pub(super) fn start(done: impl Fn(Checked) + Clone + Send + 'static) -> Self {
        let queue: Arc<Queue> = Arc::default();
        for _ in 0..WORKERS {
            let (queue, done) = (Arc::clone(&queue), done.clone());
            let thread = thread::Builder::new().name("rtscript check".to_owned());
            // Without a thread there are no diagnostics, and everything else works.
            let _ = thread.spawn(move || {
                while let Some(job) = queue.next() {
                    let checked = check(&job);
                    queue.lock().running.remove(&job.uri);
                    queue.changed.notify_all();
                    if let Some(checked) = checked {
                        done(checked);
                    }
                }
            });
        }
        Self { queue }
    }

    /// Without threads: nothing is ever checked.
    #[cfg(fuzzing)]
    pub(super) fn idle() -> Self {
        Self {
            queue: Arc::default(),
        }
    }

    /// Checks a document soon. A check of the same document that is running or waiting is given up.
    pub(super) fn schedule(&self, job: Job) {
        self.forget(&job.uri);
        self.queue.lock().waiting.insert(job.uri.clone(), job);
        self.queue.changed.notify_all();
    }

    /// Gives up the check of a document.
    pub(super) fn forget(&self, uri: &str) {
        let mut jobs = self.queue.lock();
        jobs.waiting.remove(uri);
        if let Some(stop) = jobs.running.get(uri) {
            stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for Checker {
    fn drop(&mut self) {
        let mut jobs = self.queue.lock();
        jobs.closed = true;
        jobs.waiting.clear();
        jobs.running
            .values()
            .for_each(|stop| stop.store(true, Ordering::Relaxed));
        drop(jobs);
        self.queue.changed.notify_all();
    }
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, Jobs> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a job that is due; `None` at the end.
    fn next(&self) -> Option<Job> {
        let mut jobs = self.lock();
        while !jobs.closed {
            let free = jobs
                .waiting
                .values()
                .filter(|job| !jobs.running.contains_key(&job.uri));
            let first = free
                .min_by_key(|job| job.due)
                .map(|job| (job.uri.clone(), job.due));
            let wait = match first {
                Some((uri, due)) => {
                    let wait = due.saturating_duration_since(Instant::now());
                    if wait.is_zero()
                        && let Some(job) = jobs.waiting.remove(&uri)
                    {
                        jobs.running.insert(uri, Arc::clone(&job.stop));
                        return Some(job);
                    }
                    wait
                }
                None => Duration::from_secs(3600),
            };
            let waited = self.changed.wait_timeout(jobs, wait);
            jobs = waited.map_or_else(|e| e.into_inner().0, |(jobs, _)| jobs);
        }
        None
    }
}

/// Checks a document; `None` where it was given up.
fn check(job: &Job) -> Option<Checked> {
    let host = OpenHost {
        job,
        deadline: Instant::now() + LONGEST,
        reads: Mutex::default(),
    };
    let (found, unfinished) = diagnose(&job.name, &job.text, &host);
    let reads = host.reads.into_inner().unwrap_or_else(PoisonError::into_inner);
    (!job.stop.load(Ordering::Relaxed)).then(|| Checked {
        uri: job.uri.clone(),
        version: job.version,
        found,
        unfinished,
        reads,
    })
}

/// Everything that is wrong with a scene or looks wrong, and whether its run was ended by the time.
fn diagnose(name: &str, text: &str, host: &OpenHost<'_>) -> (Vec<Diagnostic>, bool) {
    let limits = Limits {
        script_time: LONGEST,
        ..Limits::default()
    };
    let options = RunOptions {
        dry: true,
        lint: true,
        ..RunOptions::default()
    };
    let looked = guard::guarded(|| {
        let run = source::load(name, text, host, &limits, &options)?;
        let mut found = run.warnings;
        found.extend(inspect(&run.value.scene, host)?);
        Ok(found)
    });
    match looked {
        Ok(found) => (found, false),
        Err(error) if host.is_late() && ends_by_time(&error) => (error.warnings, true),
        Err(error) => {
            let errors: Vec<Diagnostic> = error.all().cloned().collect();
            let mut found = error.warnings;
            found.extend(errors);
            (found, false)
        }
    }
}

fn ends_by_time(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::Cancelled | ErrorKind::Limit)
}

/// The files of a document as the editor has them, the others as they are on disk. Takes every picture, prints nothing.
#[derive(Debug)]
struct OpenHost<'a> {
    job: &'a Job,
    deadline: Instant,
    reads: Mutex<BTreeSet<PathBuf>>,
}

impl OpenHost<'_> {
    fn is_late(&self) -> bool {
        // The script's own clock starts a little later, and is not looked at at every moment.
        Instant::now() + LONGEST / 10 >= self.deadline
    }
}

impl Host for OpenHost<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let Some(folder) = &self.job.folder else {
            let what = format!(
                "cannot read '{path}': the script is not saved, so that there is no folder to look in"
            );
            return Err(HostError::new(ErrorKind::Input, what));
        };
        let place = normal(&folder.join(path));
        self.reads
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(place.clone());
        match self.job.texts.get(&place) {
            Some(text) if place.starts_with(folder) && text.len() as u64 <= max_bytes => {
                Ok(text.as_bytes().to_vec())
            }
            _ => host::read_below(folder, path, max_bytes),
        }
    }

    fn should_stop(&self) -> bool {
        self.job.stop.load(Ordering::Relaxed) || Instant::now() >= self.deadline
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;
    use crate::cli::lsp::{documents::Documents, text::Encoding};

    /// Longer than any machine takes.
    const DEADLINE: Duration = Duration::from_secs(300);

    fn started() -> (Checker, mpsc::Receiver<Checked>) {
        let (sender, receiver) = mpsc::channel();
        let checker = Checker::start(move |checked| {
            let _ = sender.send(checked);
        });
        (checker, receiver)
    }

    #[test]
    fn an_edit_ends_the_check_of_what_it_replaces() {
        let (checker, found) = started();
        let endless = Document::new("file:///x/a.rhai", 1, "loop { }", Encoding::Utf16);
        checker.schedule(Job::new(&endless, Texts::default()));
        while checker.queue.lock().running.is_empty() {
            thread::sleep(Duration::from_millis(1));
        }
        let other = Document::new("file:///x/b.rhai", 7, "spere(1);", Encoding::Utf16);
        checker.schedule(Job::new(&other, Texts::default()));
        let checked = found.recv_timeout(DEADLINE).unwrap();
        assert_eq!((checked.uri.as_str(), checked.version), ("file:///x/b.rhai", 7));
        assert!(checked.found[0].message.contains("spere"), "{checked:?}");
        let fixed = Document::new(
            "file:///x/a.rhai",
            2,
            "light([1, 1, 1], [1, 1, 1]); sphere(1);",
            Encoding::Utf16,
        );
        checker.schedule(Job::new(&fixed, Texts::default()));
        let checked = found.recv_timeout(DEADLINE).unwrap();
        assert_eq!((checked.version, checked.unfinished), (2, false));
    }

    #[test]
    fn modules_are_read_as_they_are_open() {
        let mut documents = Documents::default();
        documents.open("file:///none/a.rhai", 1, "import \"b\" as b; b::f();");
        documents.open("file:///none/b.rhai", 1, "fn f() { spere(1); }");
        let (checker, found) = started();
        let document = documents.get("file:///none/a.rhai").unwrap();
        checker.schedule(Job::new(document, documents.texts()));
        let checked = found.recv_timeout(DEADLINE).unwrap();
        assert_eq!(checked.reads, [PathBuf::from("/none/b.rhai")].into());
        assert_eq!(checked.found[0].file.as_deref(), Some("/none/b.rhai"));
    }
}
