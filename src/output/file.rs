//! Files that hold all of what was written or what they held before, whenever the process ends.

use std::{
    collections::BTreeSet,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use super::{reason, refused};
use crate::host::HostError;

/// A temporary file that nobody has written to for so long belongs to a process that was killed.
const ABANDONED: Duration = Duration::from_secs(3600);

/// The temporary files of this process. One that is ended by a signal runs no destructors, and removes them by this
/// list; nothing else looks at it.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every temporary file and keeps others from being made: the last thing before the process is ended.
#[cfg(feature = "cli")]
pub(crate) fn remove_unfinished() {
    let files = unfinished();
    for path in files.iter() {
        let _ = fs::remove_file(path);
    }
    // Never given back: who wants to make or rename one now waits for the end.
    std::mem::forget(files);
}

/// Writes a file so that `path` holds either all of `bytes` or what it held before, whatever happens in between:
/// into a temporary file beside it, to the disk, then renamed. A link at `path` is replaced, not followed; the
/// permissions of a file that was there stay. Two that write one path at once do not disturb each other: the one
/// that ends last has written it.
///
/// A process that is killed may leave its temporary file `.NAME.PID.tmp`; [`check_writable`] removes it later.
///
/// # Errors
/// `Output`, naming the path and the system's reason.
///
/// ```
/// use rtscript::output::write_atomically;
/// let path = std::env::temp_dir().join(format!("rtscript-list-{}.txt", std::process::id()));
/// write_atomically(&path, b"all of it or nothing")?;
/// assert_eq!(std::fs::read(&path)?, b"all of it or nothing");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), HostError> {
    write_with(path, |file| file.write_all(bytes), Temporary::replace)
}

/// As [`write_atomically`], all of what `write` writes.
#[cfg(feature = "cli")]
pub(crate) fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> io::Result<()>,
) -> Result<(), HostError> {
    write_with(path, write, Temporary::replace)
}

/// As [`write_atomically`], but only where there is nothing yet; whether that was so.
#[cfg(feature = "cli")]
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<bool, HostError> {
    let mut is_new = true;
    write_with(
        path,
        |file| file.write_all(bytes),
        |temporary, target| match temporary.appear(target) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                is_new = false;
                Ok(())
            }
            done => done,
        },
    )?;
    Ok(is_new)
}

fn write_with(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> io::Result<()>,
    place: impl FnOnce(&mut Temporary, &Path) -> io::Result<()>,
) -> Result<(), HostError> {
    let write = || -> io::Result<()> {
        let (mut temporary, mut file) = Temporary::beside(path)?;
        write(&mut file)?;
        if let Ok(there) = fs::symlink_metadata(path)
            && there.is_file()
        {
            // What has no permissions, such as a memory card, does not need them.
            let _ = file.set_permissions(there.permissions());
        }
        file.sync_all()?;
        drop(file);
        place(&mut temporary, path)?;
        sync_folder(&folder_of(path));
        Ok(())
    };
    write().map_err(|e| refused(path, reason(&e)))
}

/// Whether a file can be written to `path`: its folder exists and takes new files, and what is there already is
/// neither a folder, nor a device or pipe, nor one of `inputs`. Temporary files of `path` that nobody has written to
/// for an hour are removed: killed processes left them.
///
/// # Errors
/// `Output`, naming the path and what stands in the way.
///
/// ```
/// use rtscript::output::check_writable;
/// assert!(check_writable("list.txt".as_ref(), &[]).is_ok());
/// assert!(check_writable("no/such/folder/list.txt".as_ref(), &[]).is_err());
/// ```
pub fn check_writable(path: &Path, inputs: &[PathBuf]) -> Result<(), HostError> {
    let folder = folder_of(path);
    match fs::metadata(&folder) {
        Ok(m) if m.is_dir() => {}
        Ok(_) => return Err(refused(path, format!("'{}' is not a folder", folder.display()))),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(refused(
                path,
                format!("there is no folder '{}'", folder.display()),
            ));
        }
        Err(e) => return Err(refused(path, reason(&e))),
    }
    match fs::metadata(path) {
        Ok(m) if m.is_dir() => return Err(refused(path, "it is a folder")),
        Ok(m) if !m.is_file() => return Err(refused(path, "it is not a regular file")),
        _ => {}
    }
    if let Ok(real) = fs::canonicalize(path) {
        let is_input = |input: &PathBuf| fs::canonicalize(input).is_ok_and(|input| input == real);
        if inputs.iter().any(is_input) {
            return Err(refused(path, "it is one of the files the picture is made from"));
        }
    }
    // Only trying tells: permissions, read-only mounts, full tables of files.
    let (temporary, file) = Temporary::beside(path).map_err(|e| refused(path, reason(&e)))?;
    remove_abandoned(path, &file);
    drop((file, temporary));
    Ok(())
}

/// Removes what killed processes left of `target`. Files are told by their name, and by their age, because the
/// process may be another machine's or another container's, where its number says nothing. So may the file system be;
/// its clock is taken from a file that was made just now.
fn remove_abandoned(target: &Path, just_made: &fs::File) {
    let Ok(now) = just_made.metadata().and_then(|m| m.modified()) else {
        return;
    };
    let start = format!(".{}.", short_name(target));
    for entry in fs::read_dir(folder_of(target)).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let number = name
            .to_str()
            .and_then(|name| name.strip_prefix(&start)?.strip_suffix(".tmp"));
        let is_ours =
            number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit() || b == b'-'));
        if !is_ours {
            continue;
        }
        let written = entry.metadata().and_then(|m| m.modified());
        if written.is_ok_and(|written| now.duration_since(written).is_ok_and(|age| age > ABANDONED)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// Names may be 255 bytes long: the temporary one must not be longer than that either.
fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().chars().take(48).collect()
}

/// A file `.NAME.PID.tmp` that is removed again unless it was renamed to its final name.
struct Temporary {
    path: Option<PathBuf>,
}

impl Temporary {
    /// Creates the file in the folder of `target`, never following or reusing what is there.
    fn beside(target: &Path) -> io::Result<(Self, fs::File)> {
        if target.file_name().is_none() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        let (name, pid) = (short_name(target), std::process::id());
        let mut attempt = 0u32;
        loop {
            let suffix = if attempt == 0 {
                String::new()
            } else {
                format!("-{attempt}")
            };
            let path = folder_of(target).join(format!(".{name}.{pid}{suffix}.tmp"));
            let mut files = unfinished();
            match fs::OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    files.insert(path.clone());
                    return Ok((Self { path: Some(path) }, file));
                }
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => attempt += 1,
                Err(e) => return Err(e),
            }
        }
    }

    /// Gives it its final name, in place of what has that name.
    fn replace(&mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.path {
            let mut files = unfinished();
            fs::rename(path, target)?;
            files.remove(path);
        }
        self.path = None;
        Ok(())
    }

    /// Gives it its final name, which nothing has.
    #[cfg(feature = "cli")]
    fn appear(&mut self, target: &Path) -> io::Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        match fs::hard_link(path, target) {
            Ok(()) => Ok(()),
            // File systems without links: here another could come in between, which only costs it its file.
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists && fs::symlink_metadata(target).is_err() => {
                self.replace(target)
            }
            Err(_) => Err(io::ErrorKind::AlreadyExists.into()),
        }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            let mut files = unfinished();
            // Nothing more can be done about a file that cannot be removed; the error that led here is reported.
            let _ = fs::remove_file(path);
            files.remove(path);
        }
    }
}

/// Makes a rename survive a power cut. Only unix has a call for it; there, a folder that cannot be opened or does
/// not know the call has the file all the same.
fn sync_folder(folder: &Path) {
    if cfg!(unix)
        && let Ok(folder) = fs::File::open(folder)
    {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{diag::ErrorKind, output::check_target};

    /// A folder of the test's own, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("rtscript-output-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = fs::read_dir(&self.0)
                .unwrap()
                .map(|e| e.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).unwrap();
        }
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_stays() {
        let folder = Folder::new("replace");
        let path = folder.0.join("a.ppm");
        write_atomically(&path, b"old").unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(folder.names(), ["a.ppm"]);
    }

    #[test]
    fn a_write_that_fails_leaves_the_old_file_and_no_temporary_one() {
        let folder = Folder::new("fail");
        let path = folder.0.join("taken.png");
        fs::create_dir_all(path.join("inside")).unwrap();
        let error = write_atomically(&path, b"new").unwrap_err();
        assert_eq!(error.kind, ErrorKind::Output);
        assert_eq!(folder.names(), ["taken.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_replaced_not_followed() {
        let folder = Folder::new("link");
        let (real, link) = (folder.0.join("real.ppm"), folder.0.join("link.ppm"));
        fs::write(&real, "keep").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"keep");
        assert_eq!(fs::read(&link).unwrap(), b"new");
    }

    #[test]
    fn targets_are_refused_before_the_render() {
        let folder = Folder::new("check");
        let at = |name: &str| folder.0.join(name);
        fs::create_dir(at("folder.png")).unwrap();
        fs::write(at("input.png"), "").unwrap();
        let why = |name: &str| check_target(&at(name), &[at("input.png")]).unwrap_err().message;
        assert!(why("folder.png").ends_with("it is a folder"));
        assert!(why("missing/a.png").contains("there is no folder"));
        assert!(why("input.png/a.png").contains("is not a folder"));
        assert!(why("input.png").contains("made from"));
        assert!(why("a.gif").contains("known are"));
        assert_eq!(check_target(&at("new.png"), &[at("input.png")]), Ok(()));
        let long = "n".repeat(251) + ".png";
        assert_eq!(check_target(&at(&long), &[]), Ok(()));
        assert_eq!(folder.names(), ["folder.png", "input.png"]);
    }

    #[test]
    fn what_the_killed_left_goes_after_an_hour() {
        let folder = Folder::new("abandoned");
        let target = folder.0.join("a.png");
        for name in [
            ".a.png.17.tmp",
            ".a.png.17-2.tmp",
            ".a.png.x.tmp",
            ".b.png.17.tmp",
            "a.png",
        ] {
            let file = fs::File::create(folder.0.join(name)).unwrap();
            let now = file.metadata().unwrap().modified().unwrap();
            file.set_modified(now - 2 * ABANDONED).unwrap();
        }
        fs::write(folder.0.join(".a.png.18.tmp"), "being written").unwrap();
        check_writable(&target, &[]).unwrap();
        assert_eq!(
            folder.names(),
            [".a.png.18.tmp", ".a.png.x.tmp", ".b.png.17.tmp", "a.png"]
        );
    }

    #[cfg(unix)]
    #[test]
    fn permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = Folder::new("permissions");
        let path = folder.0.join("a.png");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[cfg(feature = "cli")]
    #[test]
    fn what_is_there_is_no_new_file() {
        let folder = Folder::new("new");
        let path = folder.0.join("a.rhai");
        assert_eq!(write_new(&path, b"first"), Ok(true));
        assert_eq!(write_new(&path, b"second"), Ok(false));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(folder.names(), ["a.rhai"]);
    }

    #[test]
    fn writers_of_one_file_do_not_disturb_each_other() {
        let folder = Folder::new("writers");
        let path = folder.0.join("a.png");
        let texts: Vec<Vec<u8>> = (b'a'..b'i').map(|letter| vec![letter; 100_000]).collect();
        std::thread::scope(|scope| {
            for text in &texts {
                scope.spawn(|| (0..10).for_each(|_| write_atomically(&path, text).unwrap()));
            }
        });
        assert!(texts.contains(&fs::read(&path).unwrap()));
        assert_eq!(folder.names(), ["a.png"]);
    }
}
