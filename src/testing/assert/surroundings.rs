//! What an assertion asks the test's process: where to put a picture, and whether it may write at all. No picture
//! depends on it.

use std::{
    env,
    path::{Path, PathBuf},
};

/// Whether insta is told to write every snapshot without a review.
pub(super) fn accepts() -> bool {
    matches!(update().as_deref(), Some("always" | "force" | "1"))
}

/// Whether a picture may be written beside its snapshot, by insta's own rule for the snapshot.
pub(super) fn may_write() -> bool {
    match update().as_deref() {
        None | Some("" | "auto") => !is_ci(),
        Some(how) => how != "no",
    }
}

fn update() -> Option<String> {
    env::var("INSTA_UPDATE").ok()
}

fn is_ci() -> bool {
    env::var("CI").is_ok_and(|ci| !matches!(ci.as_str(), "" | "0" | "false"))
        || env::var_os("TF_BUILD").is_some()
}

/// Where to show how the picture of a snapshot differs: in the folder that cargo builds in, or beside the snapshot
/// where there is none.
pub(super) fn difference_path(manifest_folder: &Path, snapshot: &Path) -> PathBuf {
    let executable = env::current_exe().unwrap_or_default();
    let from_executable = executable.ancestors().skip(1).map(Path::to_owned);
    // A doctest runs from a folder of its own.
    let from_manifest = manifest_folder.ancestors().map(|folder| folder.join("target"));
    let is_target = |folder: &PathBuf| folder.join("CACHEDIR.TAG").is_file();
    let Some(target) = from_executable.chain(from_manifest).find(is_target) else {
        return snapshot.with_extension("diff.png");
    };
    let relative = snapshot.strip_prefix(manifest_folder).unwrap_or(snapshot);
    let parts = relative.with_extension("png");
    let parts = parts.components().filter_map(|part| match part {
        std::path::Component::Normal(part) => Some(part.to_string_lossy()),
        _ => None,
    });
    let name: Vec<_> = parts.collect();
    target.join("render-diffs").join(name.join("-"))
}

/// A file's address, as a terminal or a browser opens it.
pub(super) fn address(path: &Path) -> String {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let path = path.to_string_lossy().replace('\\', "/");
    // Windows calls a path that was looked up "//?/C:/...".
    let path = path.trim_start_matches("//?/");
    let mut address = String::from(if path.starts_with('/') {
        "file://"
    } else {
        "file:///"
    });
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~:@+".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address.push_str(&format!("%{byte:02X}"));
        }
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_one_word() {
        assert_eq!(
            address(Path::new("/no such folder/50%/é.png")),
            "file:///no%20such%20folder/50%25/%C3%A9.png"
        );
        assert_eq!(address(Path::new("C:\\a b\\c.png")), "file:///C:/a%20b/c.png");
    }

    #[test]
    fn differences_are_told_apart_by_their_snapshots() {
        let path = difference_path(Path::new("/crate"), Path::new("/crate/tests/snapshots/a.snap"));
        assert!(
            path.ends_with("render-diffs/tests-snapshots-a.png"),
            "{}",
            path.display()
        );
        let path = difference_path(Path::new("/crate"), Path::new("/elsewhere/a@b.snap"));
        assert!(
            path.ends_with("render-diffs/elsewhere-a@b.png"),
            "{}",
            path.display()
        );
    }
}
