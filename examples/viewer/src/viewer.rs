//! Renders of one script, one after the other: started, shown as they grow, ended when something changes.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rtscript::{
    DirHost, Error, Host, Image, Limits, Report, RunOptions, Script,
    diag::{Diagnostic, ErrorKind},
    host::HostError,
    import::KeptAssets,
    output, render,
    render::{KeptTrees, Tile},
};

use crate::{canvas::Canvas, watched::Watched};

/// Bytes of the longest script.
const SCRIPT_BYTES: u64 = 16 << 20;

/// What there is to tell of a render.
#[derive(Debug)]
pub enum Event {
    /// A line that the script printed.
    Printed(String),
    /// Something looks wrong.
    Warning(Diagnostic),
    /// The picture is complete.
    Finished {
        /// From the start of the script to the last pixel.
        took: Duration,
    },
    /// There is no picture, for a reason in words. The last one that there was stays.
    Failed(String),
}

/// What the thread that renders and the one with the window have in common.
#[derive(Default)]
struct Shared {
    canvas: Mutex<Canvas>,
    watched: Mutex<Watched>,
    finished: Mutex<Option<Image>>,
}

/// A thread that panicked has left whole values: none of them is changed in more than one step.
fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A script, its picture, and the render that is under way.
pub struct Viewer {
    path: PathBuf,
    options: RunOptions,
    shared: Arc<Shared>,
    events: (Sender<Event>, Receiver<Event>),
    render: Option<Underway>,
}

/// A render that may still be going on.
struct Underway {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Viewer {
    /// Begins to render the script at `path`.
    ///
    /// # Errors
    /// Where there is no such file: what is not there from the beginning is a slip.
    pub fn open(path: &Path) -> io::Result<Self> {
        if !path.metadata()?.is_file() {
            return Err(io::Error::other("it is not a regular file"));
        }
        let mut options = RunOptions::default();
        // What a change leaves as it was is not read, and not compiled, again.
        options.assets = Some(KeptAssets::new());
        options.render.trees = Some(KeptTrees::new());
        options.render.coarse = true;
        let mut viewer = Self {
            path: path.to_owned(),
            options,
            shared: Arc::default(),
            events: mpsc::channel(),
            render: None,
        };
        viewer.start();
        Ok(viewer)
    }

    /// To be called some ten times a second: renders again if a file has changed, and answers what there is to tell.
    pub fn tick(&mut self) -> Vec<Event> {
        let is_changed = lock(&self.shared.watched).is_changed();
        if is_changed {
            self.cancel();
            self.start();
        }
        self.events.1.try_iter().collect()
    }

    /// What is to be seen now.
    pub fn canvas(&self) -> MutexGuard<'_, Canvas> {
        lock(&self.shared.canvas)
    }

    /// Writes the picture, in the format that the name ends with.
    ///
    /// # Errors
    /// Where it is not complete, or cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let finished = lock(&self.shared.finished);
        let image = finished.as_ref().ok_or("the picture is not complete yet")?;
        output::save(path, image).map_err(|e| e.message)
    }

    fn start(&mut self) {
        *lock(&self.shared.watched) = Watched::default();
        *lock(&self.shared.finished) = None;
        let stop = Arc::new(AtomicBool::new(false));
        let folder = match self.path.parent() {
            Some(folder) if folder != Path::new("") => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let host = Onlooker {
            files: DirHost::new(&folder),
            folder,
            stop: Arc::clone(&stop),
            is_traced: AtomicBool::new(false),
            shared: Arc::clone(&self.shared),
            events: self.events.0.clone(),
        };
        let name = self
            .path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let options = self.options.clone();
        let thread = thread::spawn(move || host.make(&name, &options));
        self.render = Some(Underway { stop, thread });
    }

    /// Ends the render that is under way, within milliseconds, and forgets what it had to tell.
    fn cancel(&mut self) {
        if let Some(Underway { stop, thread }) = self.render.take() {
            stop.store(true, Ordering::Relaxed);
            // A panic has been told on the way.
            let _ = thread.join();
            self.events.1.try_iter().for_each(drop);
        }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// The host of one render.
struct Onlooker {
    files: DirHost,
    folder: PathBuf,
    stop: Arc<AtomicBool>,
    /// The scene's own picture is traced now, and not one that the script asked for while it ran.
    is_traced: AtomicBool,
    shared: Arc<Shared>,
    events: Sender<Event>,
}

impl Onlooker {
    fn tell(&self, event: Event) {
        // Nobody listens any more where the window was closed.
        let _ = self.events.send(event);
    }

    fn make(&self, name: &str, options: &RunOptions) {
        let start = Instant::now();
        match self.image(name, options) {
            Ok(image) => {
                let mut canvas = lock(&self.shared.canvas);
                canvas.begin(image.width(), image.height(), image.encoding());
                canvas.fill(&image);
                drop(canvas);
                *lock(&self.shared.finished) = Some(image);
                self.tell(Event::Finished {
                    took: start.elapsed(),
                });
            }
            Err(error) if error.kind() == ErrorKind::Cancelled => {}
            Err(error) => {
                error
                    .warnings
                    .iter()
                    .cloned()
                    .map(Event::Warning)
                    .for_each(|e| self.tell(e));
                self.tell(Event::Failed(error.to_string()));
            }
        }
    }

    fn image(&self, name: &str, options: &RunOptions) -> Result<Image, Error> {
        let unread = |e: HostError| Diagnostic::error(e.kind, e.message);
        let text = String::from_utf8(self.read(name, SCRIPT_BYTES).map_err(unread)?)
            .map_err(|_| Diagnostic::error(ErrorKind::Input, format!("'{name}' is not text in UTF-8")))?;
        let script = Script::compile(name, &text, &Limits::default())?;
        let Report {
            value: mut run,
            warnings,
        } = script.run(self, options)?;
        warnings
            .into_iter()
            .map(Event::Warning)
            .for_each(|e| self.tell(e));
        // A script that renders by itself has its pictures already: the last one is shown.
        if let Some(picture) = run.pictures.pop() {
            return Ok(picture.image);
        }
        let (region, encoding) = (run.scene.settings.region(), run.scene.settings.encoding);
        lock(&self.shared.canvas).begin(region.width, region.height, encoding);
        self.is_traced.store(true, Ordering::Relaxed);
        // What looks wrong was told by `warn` before the first ray.
        Ok(render(&run.scene, &options.render, self)?.value.image)
    }
}

impl Host for Onlooker {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        // Before it is read, so that a change meanwhile is one.
        lock(&self.shared.watched).asked(self.folder.join(path));
        self.files.read(path, max_bytes)
    }

    fn print(&self, text: &str) {
        self.tell(Event::Printed(text.to_owned()));
    }

    fn warn(&self, warning: &Diagnostic) {
        self.tell(Event::Warning(warning.clone()));
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn tile(&self, tile: &Tile<'_>) {
        if self.is_traced.load(Ordering::Relaxed) {
            lock(&self.shared.canvas).tile(tile);
        }
    }

    fn coarse(&self, image: &Image) {
        if self.is_traced.load(Ordering::Relaxed) {
            lock(&self.shared.canvas).fill(image);
        }
    }

    fn write_image(&self, name: &str, _image: &Image) -> Result<(), HostError> {
        // Shown at the end; nothing is written that nobody asked for.
        self.tell(Event::Printed(format!(
            "{name} is not written: S saves the picture that is shown"
        )));
        Ok(())
    }
}
