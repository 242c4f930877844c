//! The outside world of a scene that is watched.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use super::{Session, files::Files};
use crate::{
    cli::{
        host::{CliHost, below_current_folder},
        report::shortened,
    },
    diag::ErrorKind,
    host::{Host, HostError},
    output::{self, Format},
    render::{Image, Progress},
};

/// Lines that a script prints of which the screen can show some.
const MOST_LINES: usize = 200;
/// Time between two drawings of how far a render is.
const INTERVAL: Duration = Duration::from_millis(100);

/// A [`CliHost`] that notes which files are asked for, stops when one of them changes, and keeps pictures that the script
/// names until the run has ended well.
pub(super) struct WatchHost<'s> {
    pub(super) session: &'s Session,
    pub(super) inner: CliHost,
    pub(super) start: Instant,
    /// Lines that the script printed, where they are shown on the screen.
    pub(super) printed: Mutex<Vec<String>>,
    /// Files to write, with what is to be in them.
    pub(super) pictures: Mutex<Vec<(PathBuf, Vec<u8>)>>,
    /// A file changed, or a key was typed that ends the run.
    pub(super) is_outdated: AtomicBool,
    drawn: Mutex<Instant>,
}

impl<'s> WatchHost<'s> {
    pub(super) fn new(session: &'s Session, inner: CliHost) -> Self {
        Self {
            session,
            inner,
            start: Instant::now(),
            printed: Mutex::default(),
            pictures: Mutex::default(),
            is_outdated: AtomicBool::new(false),
            drawn: Mutex::new(Instant::now()),
        }
    }

    fn files(&self) -> MutexGuard<'_, Files> {
        self.session.files()
    }

    fn pictures(&self) -> MutexGuard<'_, Vec<(PathBuf, Vec<u8>)>> {
        self.pictures.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Host for WatchHost<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let full = self.inner.path_of(path);
        let is_it = |(picture, _): &(PathBuf, Vec<u8>)| is_same_file(picture, &full);
        if self.pictures().iter().any(is_it) {
            self.write_pictures()?;
        }
        self.files().asked(&full);
        let bytes = self.inner.read(path, max_bytes)?;
        self.files().read(&full, &bytes);
        Ok(bytes)
    }

    fn print(&self, text: &str) {
        if self.session.screen.is_none() {
            return self.inner.print(text);
        }
        let mut printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
        if printed.len() < MOST_LINES {
            printed.push(shortened(text));
        }
    }

    fn should_stop(&self) -> bool {
        if self.inner.should_stop() || self.is_outdated.load(Ordering::Relaxed) {
            return true;
        }
        // One thread's look is enough.
        let Ok(mut files) = self.session.files.try_lock() else {
            return false;
        };
        if files.is_changed() || self.session.is_asked() {
            self.is_outdated.store(true, Ordering::Relaxed);
        }
        self.is_outdated.load(Ordering::Relaxed)
    }

    fn progress(&self, progress: &Progress) {
        let Some(screen) = &self.session.screen else {
            return self.inner.progress(progress);
        };
        let Ok(mut drawn) = self.drawn.try_lock() else {
            return;
        };
        if drawn.elapsed() >= INTERVAL && progress.done < progress.total {
            *drawn = Instant::now();
            let percent = 100 * progress.done / progress.total.max(1);
            screen.status(
                self.session
                    .status(&format!("rendering {percent}%"), None, self.start.elapsed()),
            );
        }
    }

    fn coarse(&self, image: &Image) {
        if let Some(screen) = &self.session.screen {
            screen.picture(
                image,
                self.session.status("coarse", Some(image), self.start.elapsed()),
            );
        }
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        let path = below_current_folder(name)?;
        output::check_target(&path, &self.inner.inputs())?;
        let cannot = |e: std::io::Error| {
            HostError::new(
                ErrorKind::Output,
                format!("cannot write '{name}': {}", output::reason(&e)),
            )
        };
        let bytes = match (Format::from_path(&path)?, self.inner.recipe_of(image)) {
            (Format::Png, Some(recipe)) => output::encode_png_with(image, &recipe),
            (format, _) => output::encode(image, format),
        };
        let bytes = bytes.map_err(cannot)?;
        if let Some(screen) = &self.session.screen {
            screen.picture(
                image,
                self.session
                    .status(&shortened(name), Some(image), self.start.elapsed()),
            );
        }
        let mut pictures = self.pictures();
        pictures.retain(|(other, _)| *other != path);
        pictures.push((path, bytes));
        Ok(())
    }
}

impl WatchHost<'_> {
    /// Writes the pictures that the script named and that wait for it.
    ///
    /// # Errors
    /// Where one cannot be written.
    pub(super) fn write_pictures(&self) -> Result<(), HostError> {
        for (path, bytes) in self.pictures().drain(..) {
            output::write_atomically(&path, &bytes)?;
        }
        Ok(())
    }

    /// What the script printed.
    pub(super) fn take_printed(&self) -> Vec<String> {
        std::mem::take(&mut *self.printed.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Whether two paths lead to one place, where a file may or may not be.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        Some((
            fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?,
            path.file_name()?.to_owned(),
        ))
    };
    place(a).is_some_and(|a| place(b) == Some(a))
}
