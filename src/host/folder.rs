//! Files below one folder, reached from a descriptor of that folder.
//!
//! The folder is opened once. A path is followed from there one part at a time, by the kernel where it can do that in
//! one call (`openat2` with `RESOLVE_BENEATH` on Linux), and a link that leads out of the folder ends the way, whatever
//! is renamed or linked meanwhile. What is opened is looked at before a byte is read: a regular file, or nothing.

use std::{
    fmt,
    io::{self, Read},
    path::{Component, Path, PathBuf},
    sync::{Arc, OnceLock},
};

use super::{Host, HostError, too_large};
use crate::diag::ErrorKind;

/// Reads regular files below one folder, links followed only as long as they stay below it.
///
/// The folder is opened with the first read, and stays the same one however it is renamed. Devices, pipes and sockets are
/// refused, and nothing waits for their other end. On targets without descriptors of folders (wasm32) paths are checked
/// by their text, and what is beyond the sandbox of the module is that sandbox's affair.
///
/// ```
/// use rtscript::{DirHost, Host, diag::ErrorKind};
/// let host = DirHost::new("src");
/// assert!(host.read("lib.rs", 1 << 20).is_ok());
/// assert_eq!(host.read("../Cargo.toml", 1 << 20).unwrap_err().kind, ErrorKind::Denied);
/// ```
#[derive(Clone)]
pub struct DirHost {
    root: PathBuf,
    folder: Arc<OnceLock<system::Folder>>,
}

impl fmt::Debug for DirHost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DirHost")
            .field("root", &self.root)
            .finish_non_exhaustive()
    }
}

impl DirHost {
    /// A host that reads below `root`, usually the folder of the script. An empty path is the current folder.
    #[must_use]
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self {
            root: root.into(),
            folder: Arc::default(),
        }
    }

    /// The folder that may be read.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    fn folder(&self) -> io::Result<&system::Folder> {
        if let Some(folder) = self.folder.get() {
            return Ok(folder);
        }
        let root = match self.root.as_os_str().is_empty() {
            true => Path::new("."),
            false => &self.root,
        };
        let folder = system::Folder::open(root)?;
        Ok(self.folder.get_or_init(|| folder))
    }
}

impl Host for DirHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let relative = Path::new(path);
        stays_below(relative).map_err(|why| denied(path, why))?;
        let cannot = |error: &io::Error| why_not(path, error);
        let folder = self.folder().map_err(|e| cannot(&e))?;
        let Some((file, bytes)) = folder.open_file(relative).map_err(|e| cannot(&e))? else {
            return Err(denied(path, "is not a regular file"));
        };
        if bytes > max_bytes {
            return Err(too_large(path, max_bytes));
        }
        let mut content = Vec::new();
        file.take(max_bytes.saturating_add(1))
            .read_to_end(&mut content)
            .map_err(|e| cannot(&e))?;
        // It may have grown meanwhile.
        if content.len() as u64 > max_bytes {
            return Err(too_large(path, max_bytes));
        }
        Ok(content)
    }
}

/// Reads the regular file `path` below `root`; [`DirHost`] for one file.
///
/// # Errors
/// As [`Host::read`].
///
/// ```
/// use rtscript::host::read_below;
/// let folder = std::path::Path::new("src");
/// assert!(read_below(folder, "lib.rs", 1 << 20).is_ok());
/// assert!(read_below(folder, "../Cargo.toml", 1 << 20).is_err());
/// ```
pub fn read_below(root: &Path, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
    DirHost::new(root).read(path, max_bytes)
}

/// Whether the path leads nowhere above its start, as its text has it. Links are the system's affair; this is for the
/// words of the error.
fn stays_below(path: &Path) -> Result<(), &'static str> {
    let mut depth = 0u32;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => {
                depth = depth
                    .checked_sub(1)
                    .ok_or("is outside the script's folder; only files below it can be read")?;
            }
            Component::RootDir | Component::Prefix(_) => {
                return Err("is an absolute path; only files below the script's folder can be read");
            }
        }
    }
    Ok(())
}

#[cold]
fn denied(path: &str, why: &str) -> HostError {
    HostError::new(ErrorKind::Denied, format!("'{path}' {why}"))
}

#[cold]
fn why_not(path: &str, error: &io::Error) -> HostError {
    if system::is_escape(error) {
        return denied(
            path,
            "leads outside the script's folder; only files below it can be read",
        );
    }
    let reason = match error.kind() {
        io::ErrorKind::NotFound => "no such file".to_owned(),
        _ => error.to_string(),
    };
    HostError::new(ErrorKind::Input, format!("cannot read '{path}': {reason}"))
}

#[cfg(not(target_family = "wasm"))]
mod system {
    use std::{io, path::Path};

    use cap_std::{
        ambient_authority,
        fs::{Dir, File, OpenOptions},
    };

    /// A folder that stays open.
    pub(super) struct Folder(Dir);

    impl Folder {
        pub(super) fn open(path: &Path) -> io::Result<Self> {
            Dir::open_ambient_dir(path, ambient_authority()).map(Self)
        }

        /// A regular file and its length; `None` where it is something else.
        pub(super) fn open_file(&self, path: &Path) -> io::Result<Option<(File, u64)>> {
            // Looked at twice: before, since opening alone sets some devices going, and on what was opened, since that
            // may be another one by then.
            if !self.0.metadata(path)?.is_file() {
                return Ok(None);
            }
            let file = self.0.open_with(path, &without_waiting())?;
            let metadata = file.metadata()?;
            Ok(metadata.is_file().then_some((file, metadata.len())))
        }
    }

    #[cfg(unix)]
    fn without_waiting() -> OpenOptions {
        use cap_std::fs::OpenOptionsExt;
        use rustix::fs::OFlags;

        let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
        let mut options = OpenOptions::new();
        options.read(true).custom_flags(flags.bits().cast_signed());
        options
    }

    #[cfg(not(unix))]
    fn without_waiting() -> OpenOptions {
        let mut options = OpenOptions::new();
        options.read(true);
        options
    }

    /// Whether a path led out of the folder. The crate says so with an error of its own, of this kind; a file without the
    /// right to read it has the system's number.
    pub(super) fn is_escape(error: &io::Error) -> bool {
        error.kind() == io::ErrorKind::PermissionDenied && error.raw_os_error().is_none()
    }
}

#[cfg(target_family = "wasm")]
mod system {
    use std::{
        fs::File,
        io,
        path::{Path, PathBuf},
    };

    /// A folder, by its path.
    pub(super) struct Folder(PathBuf);

    impl Folder {
        #[expect(clippy::unnecessary_wraps, reason = "as on systems with descriptors")]
        pub(super) fn open(path: &Path) -> io::Result<Self> {
            Ok(Self(path.to_owned()))
        }

        /// A regular file and its length; `None` where it is something else.
        pub(super) fn open_file(&self, path: &Path) -> io::Result<Option<(File, u64)>> {
            let file = File::open(self.0.join(path))?;
            let metadata = file.metadata()?;
            Ok(metadata.is_file().then_some((file, metadata.len())))
        }
    }

    /// No system call tells here.
    pub(super) fn is_escape(_: &io::Error) -> bool {
        false
    }
}
