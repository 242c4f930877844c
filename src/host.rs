//! The outside world as one trait: reading an asset, printing, being asked to stop, handing over a picture.
//!
//! The library opens no path by itself. [`DirHost`] is the host of the command: it reads regular files below
//! one folder and nothing else.

mod folder;

pub use folder::{DirHost, read_below};

use std::{collections::BTreeMap, fmt};

use crate::{
    diag::{Code, Diagnostic, ErrorKind},
    render::{Image, Progress, Tile},
};

/// Why a host did not do as asked.
///
/// ```
/// use rtscript::{Host, MemoryHost, diag::ErrorKind, host::HostError};
/// struct Shelf(MemoryHost);
/// impl Host for Shelf {
///     fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
///         if path.ends_with(".rhai") {
///             return Err(HostError::new(ErrorKind::Denied, "scripts are not for reading"));
///         }
///         self.0.read(path, max_bytes)
///     }
/// }
/// let shelf = Shelf(MemoryHost::new().with("a.rhai", "sphere(0, 0, 0, 1);").with("a.txt", "words"));
/// assert_eq!(shelf.read("a.rhai", 100).unwrap_err().kind, ErrorKind::Denied);
/// assert_eq!(shelf.read("a.txt", 100)?, b"words");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostError {
    /// [`ErrorKind::Input`], [`ErrorKind::Denied`], [`ErrorKind::Limit`] or [`ErrorKind::Output`].
    pub kind: ErrorKind,
    /// What went wrong, for people.
    pub message: String,
}

impl HostError {
    /// An error of the given kind.
    #[must_use]
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
        }
    }

    /// As a diagnostic without a place. What a host cannot give is a file that cannot be read.
    pub(crate) fn diagnostic(self) -> Diagnostic {
        let diagnostic = Diagnostic::error(self.kind, self.message);
        match self.kind {
            ErrorKind::Input => diagnostic.class(Code::UnreadableFile),
            _ => diagnostic,
        }
    }
}

impl fmt::Display for HostError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for HostError {}

/// Everything a script can reach outside itself.
///
/// ```
/// use std::sync::Mutex;
/// use rtscript::{Builder, Host, Image, NoHost, RenderOptions, diag::{Code, Diagnostic}, host::HostError, render};
///
/// /// Keeps what it is told for someone who looks on.
/// #[derive(Default)]
/// struct Onlooker {
///     warnings: Mutex<Vec<Code>>,
///     coarse: Mutex<Vec<(u32, u32)>>,
/// }
///
/// impl Host for Onlooker {
///     fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
///         NoHost.read(path, max_bytes)
///     }
///
///     fn warn(&self, warning: &Diagnostic) {
///         self.warnings.lock().expect("no one panics").push(warning.code);
///     }
///
///     fn coarse(&self, image: &Image) {
///         self.coarse.lock().expect("no one panics").push((image.width(), image.height()));
///     }
/// }
///
/// let mut b = Builder::new();
/// b.size(128, 128)?;
/// let host = Onlooker::default();
/// let mut options = RenderOptions::default();
/// options.coarse = true;
/// render(&b.finish().value, &options, &host)?;
/// // A pixel for every eight along each edge, before the picture itself.
/// assert_eq!(*host.coarse.lock().expect("no one panics"), [(16, 16)]);
/// assert!(host.warnings.lock().expect("no one panics").is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Host: Send + Sync {
    /// The bytes of the asset `path`, a relative path with `/` as written in the script, already resolved
    /// against the file that names it. At most `max_bytes`.
    ///
    /// # Errors
    /// `Denied` outside what the host allows, `Input` where there is no such file, `Limit` past `max_bytes`.
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError>;

    /// Receives a line that the script printed.
    fn print(&self, text: &str) {
        let _ = text;
    }

    /// Is told of what looks wrong with a scene before the renderer traces its first ray, so that it can be shown at once;
    /// the report of the render holds the same.
    fn warn(&self, warning: &Diagnostic) {
        let _ = warning;
    }

    /// Asked often while a script runs and while a picture is traced; true ends the run with `ErrorKind::Cancelled`.
    fn should_stop(&self) -> bool {
        false
    }

    /// Told now and then how far the render is, from any of its threads but from one at a time: of more pixels each
    /// time, and last of all of them. Threads that have something to tell wait for it.
    fn progress(&self, progress: &Progress) {
        let _ = progress;
    }

    /// Receives each tile of a picture as it is finished, before [`Host::progress`] is told of it and as that: from any
    /// thread, one at a time. Tiles do not overlap and together are the picture, in no order to rely on.
    fn tile(&self, tile: &Tile<'_>) {
        let _ = tile;
    }

    /// Receives a smaller picture with fewer samples of what is being rendered, where
    /// [`RenderOptions::coarse`](crate::RenderOptions::coarse) asks for it.
    fn coarse(&self, image: &Image) {
        let _ = image;
    }

    /// Receives a picture that the script rendered under a name of its own: `render("name.png")`.
    ///
    /// # Errors
    /// `Output` where it cannot be kept, `Denied` where the host does not take pictures.
    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        let _ = image;
        Err(HostError::new(
            ErrorKind::Denied,
            format!("this host takes no pictures named by the script ('{name}')"),
        ))
    }
}

/// A host without a world: nothing can be read, nothing is printed.
///
/// ```
/// use rtscript::{Host, NoHost};
/// assert!(NoHost.read("a.png", 100).is_err());
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHost;

impl Host for NoHost {
    fn read(&self, path: &str, _max_bytes: u64) -> Result<Vec<u8>, HostError> {
        Err(HostError::new(
            ErrorKind::Denied,
            format!("this host has no files ('{path}')"),
        ))
    }
}

/// Files in memory, for tests and for programs that carry their assets with them.
///
/// ```
/// use rtscript::{Host, MemoryHost};
/// let host = MemoryHost::new().with("models/a.obj", "v 0 0 0");
/// assert_eq!(host.read("models/../models/a.obj", 100)?, b"v 0 0 0");
/// assert!(host.read("../a.obj", 100).is_err());
/// # Ok::<(), rtscript::host::HostError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MemoryHost {
    files: BTreeMap<String, Vec<u8>>,
}

impl MemoryHost {
    /// A host without files.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same host with one file more; `path` is relative, with `/` and without `.` and `..`.
    #[must_use]
    pub fn with(mut self, path: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.insert(path, bytes);
        self
    }

    /// Adds a file, or replaces the one of that path.
    pub fn insert(&mut self, path: &str, bytes: impl Into<Vec<u8>>) {
        self.files.insert(path.to_owned(), bytes.into());
    }
}

impl Host for MemoryHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let denied = |why: &str| HostError::new(ErrorKind::Denied, format!("'{path}' {why}"));
        if path.starts_with('/') {
            return Err(denied(
                "is an absolute path; only files below the script's folder can be read",
            ));
        }
        let mut parts: Vec<&str> = Vec::new();
        for part in path.split('/') {
            match part {
                "" | "." => {}
                ".." => {
                    parts.pop().ok_or_else(|| {
                        denied("is outside the script's folder; only files below it can be read")
                    })?;
                }
                part => parts.push(part),
            }
        }
        let bytes = self
            .files
            .get(&parts.join("/"))
            .ok_or_else(|| HostError::new(ErrorKind::Input, format!("cannot read '{path}': no such file")))?;
        if bytes.len() as u64 > max_bytes {
            return Err(too_large(path, max_bytes));
        }
        Ok(bytes.clone())
    }
}

#[cold]
fn too_large(path: &str, max_bytes: u64) -> HostError {
    HostError::new(
        ErrorKind::Limit,
        format!("'{path}' is larger than the {max_bytes} bytes that one file may have"),
    )
}

/// The path of an asset that the file `named_in` names as `path`: relative to that file's folder, as a
/// relative path with `/`.
///
/// ```
/// use rtscript::host::resolve;
/// assert_eq!(resolve("models/car.obj", "car.mtl"), "models/car.mtl");
/// ```
#[must_use]
pub fn resolve(named_in: &str, path: &str) -> String {
    let path = path.replace('\\', "/");
    match named_in.rfind('/') {
        Some(end) if !path.starts_with('/') => format!("{}/{path}", &named_in[..end]),
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assets_resolve_from_the_file_that_names_them() {
        assert_eq!(resolve("models/cow.obj", "cow.mtl"), "models/cow.mtl");
        assert_eq!(resolve("scene.rhai", "a/b.png"), "a/b.png");
        assert_eq!(resolve("models/cow.mtl", "tex\\cow.png"), "models/tex/cow.png");
    }

    #[test]
    fn memory_has_no_outside_either() {
        let host = MemoryHost::new().with("a/b.txt", "yes");
        assert_eq!(host.read("a/b.txt", 3).unwrap(), b"yes");
        assert_eq!(host.read("./a//../a/b.txt", 3).unwrap(), b"yes");
        for bad in ["../a/b.txt", "a/../../a/b.txt", "/a/b.txt"] {
            assert_eq!(host.read(bad, 3).unwrap_err().kind, ErrorKind::Denied, "{bad}");
        }
        assert_eq!(host.read("a", 3).unwrap_err().kind, ErrorKind::Input);
        assert_eq!(host.read("a/b.txt", 2).unwrap_err().kind, ErrorKind::Limit);
    }
}
