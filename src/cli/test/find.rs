//! Which scenes are tested.

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind},
    output::reason,
};

/// Ending of a snapshot's name.
const ENDING: &str = "rtsnap";
/// Folders that hold no scenes.
const PASSED_OVER: [&str; 4] = ["lib", "modules", "target", "node_modules"];
/// The folder whose scenes are tests by standing there.
const TESTS: &str = "tests";

/// Where the snapshot of a scene is.
pub(super) fn snapshot_of(scene: &Path) -> PathBuf {
    scene.with_extension(ENDING)
}

/// Where its reference picture is.
pub(super) fn picture_of(scene: &Path) -> PathBuf {
    scene.with_extension(format!("{ENDING}.png"))
}

/// The scenes that `paths` name, sorted, each once; without paths, those below the current folder that have a
/// snapshot or stand in a folder called `tests`.
///
/// # Errors
/// `Input` where a path is missing or a folder cannot be listed; where two scenes would share a snapshot.
pub(super) fn scenes(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut found = BTreeSet::new();
    if paths.is_empty() {
        search(Path::new("."), false, &mut found)?;
    }
    for path in paths {
        match fs::metadata(path) {
            Ok(m) if m.is_dir() => search(path, true, &mut found)?,
            Ok(_) => {
                found.insert(path.clone());
            }
            Err(e) => return Err(unreadable(path, &e)),
        }
    }
    let mut last: Option<&PathBuf> = None;
    for scene in &found {
        if let Some(other) = last.filter(|other| snapshot_of(other) == snapshot_of(scene)) {
            let (a, b, snapshot) = (other.display(), scene.display(), snapshot_of(scene));
            return Err(Diagnostic::error(
                ErrorKind::Input,
                format!(
                    "'{a}' and '{b}' would share the snapshot '{}'",
                    snapshot.display()
                ),
            )
            .hint("rename one of them")
            .into());
        }
        last = Some(scene);
    }
    Ok(found.into_iter().collect())
}

/// Adds the scenes below a folder; without `all`, those with a snapshot.
fn search(folder: &Path, all: bool, found: &mut BTreeSet<PathBuf>) -> Result<(), Error> {
    let entries = fs::read_dir(folder).map_err(|e| unreadable(folder, &e))?;
    for entry in entries {
        let entry = entry.map_err(|e| unreadable(folder, &e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(['.', '_']) {
            continue;
        }
        // The current folder is where nobody wrote one.
        let path = if folder == Path::new(".") {
            PathBuf::from(entry.file_name())
        } else {
            entry.path()
        };
        // Links to folders are not followed: they may lead in a circle.
        let kind = entry.file_type().map_err(|e| unreadable(&path, &e))?;
        if kind.is_dir() {
            if !PASSED_OVER.contains(&name.as_str()) {
                search(&path, all || name == TESTS, found)?;
            }
        } else if is_scene(&path) && (all || snapshot_of(&path).exists()) && path.is_file() {
            found.insert(path);
        }
    }
    Ok(())
}

fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "rhai" || e == "test")
}

fn unreadable(path: &Path, error: &io::Error) -> Error {
    let path = path.display();
    let message = match error.kind() {
        io::ErrorKind::NotFound => format!("there is no '{path}'"),
        _ => format!("cannot read '{path}': {}", reason(error)),
    };
    Diagnostic::error(ErrorKind::Input, message)
        .class(Code::UnreadableFile)
        .hint("name scenes (.rhai, .test) or folders that hold them")
        .into()
}
