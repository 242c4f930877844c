//! What is made from the table of functions is as the table says: the reference and its pictures, the JSON and the
//! definitions for editors. `RTSCRIPT_ACCEPT=1 cargo test --test reference_docs` makes them anew.

#![allow(clippy::unwrap_used)]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use rtscript::testing::load_picture;

/// Files that are compared byte by byte.
const TEXTS: [&str; 3] = ["reference.md", "api.json", "rtscript.d.rhai"];
/// The folder of the pictures, which are compared by their pixels.
const IMAGES: &str = "images/reference";
/// Bytes that all pictures together may take in the repository.
const MOST_BYTES: u64 = 2_500_000;

fn names(folder: &Path) -> BTreeSet<String> {
    let files = fs::read_dir(folder).into_iter().flatten();
    files
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .collect()
}

#[test]
fn the_reference_is_as_the_table() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    if std::env::var_os("RTSCRIPT_ACCEPT").is_some() {
        let _ = fs::remove_dir_all(docs.join(IMAGES));
        write(&docs);
    }
    let fresh = std::env::temp_dir().join(format!("rtscript-reference-{}", std::process::id()));
    write(&fresh);
    let mut stale = Vec::new();
    for name in TEXTS {
        let on_record = fs::read_to_string(docs.join(name)).unwrap_or_default();
        if on_record.replace("\r\n", "\n") != fs::read_to_string(fresh.join(name)).unwrap() {
            stale.push(name.to_owned());
        }
    }
    let (expected, made) = (docs.join(IMAGES), fresh.join(IMAGES));
    for name in names(&expected).union(&names(&made)) {
        let hash = |folder: &PathBuf| load_picture(&folder.join(name)).ok().map(|image| image.hash());
        if hash(&expected).is_none() || hash(&expected) != hash(&made) {
            stale.push(format!("{IMAGES}/{name}"));
        }
    }
    fs::remove_dir_all(fresh).unwrap();
    assert!(
        stale.is_empty(),
        "docs/ is stale: {}\nRTSCRIPT_ACCEPT=1 cargo test --test reference_docs makes it anew; look at the difference",
        stale.join(", ")
    );
    the_pictures_show_something_and_are_small();
}

fn the_pictures_show_something_and_are_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(IMAGES);
    let mut bytes = 0;
    for name in names(&folder) {
        let path = folder.join(&name);
        bytes += fs::metadata(&path).unwrap().len();
        let image = load_picture(&path).unwrap();
        let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
        for rgb in image.rgb8().as_chunks::<3>().0 {
            *counts.entry(*rgb).or_default() += 1;
        }
        let most = counts.values().max().unwrap();
        let pixels = image.pixels().len();
        assert!(
            *most < pixels * 97 / 100,
            "{name}: {most} of {pixels} pixels have one color"
        );
        let bright = image.rgb8().iter().filter(|b| **b > 60).count();
        assert!(bright > pixels / 8, "{name} is dark");
    }
    assert!(bytes < MOST_BYTES, "{bytes}");
}

fn write(folder: &Path) {
    let ran = Command::new(env!("CARGO_BIN_EXE_rtscript"))
        .args(["help", "--write"])
        .arg(folder)
        .output()
        .unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
}
