//! Frozen scenes: what `edition(year)` promises. Every scene under `tests/editions/<year>/` gives the size and the hash
//! that `hashes.txt` beside them has on record.
//!
//! Nothing here accepts another picture. Where a hash differs, the change needs a new edition, and the old code stays
//! for this one: `docs/editions.md` tells how.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use rtscript::{
    scene::Edition,
    script::{Group, RunOptions, entries},
    testing::{find_scenes, render_file},
};

/// Modules lie in folders of this name and are no scenes.
const MODULES: &str = "lib";

fn folder(edition: Edition) -> PathBuf {
    let name = format!("tests/editions/{edition}");
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Scenes of an edition, as `hashes.txt` names them, with their files.
fn scenes(edition: Edition) -> BTreeMap<String, PathBuf> {
    let root = folder(edition);
    let found = find_scenes(&root).unwrap().into_iter();
    let named = found.map(|path| {
        let parts = path.strip_prefix(&root).unwrap().iter();
        let parts: Vec<_> = parts.map(|part| part.to_string_lossy()).collect();
        (parts.join("/"), path.clone())
    });
    named
        .filter(|(name, _)| !name.split('/').any(|part| part == MODULES))
        .collect()
}

/// "72x54 hash" by scene, and the scenes that stand there twice.
fn recorded(edition: Edition) -> (BTreeMap<String, String>, Vec<String>) {
    let text = fs::read_to_string(folder(edition).join("hashes.txt")).unwrap();
    let (mut recorded, mut twice) = (BTreeMap::new(), Vec::new());
    for line in text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
    {
        let (scene, picture) = line.split_once(' ').expect(line);
        if recorded.insert(scene.to_owned(), picture.to_owned()).is_some() {
            twice.push(scene.to_owned());
        }
    }
    (recorded, twice)
}

/// The size and the hash of a scene's picture, which must have asked for the edition where it can.
fn picture(path: &Path, edition: Edition) -> Result<String, String> {
    let rendered = render_file(path, &RunOptions::default()).map_err(|e| e.to_string())?;
    let is_script = path.extension().is_some_and(|e| e == "rhai");
    if is_script && rendered.scene.settings.edition != Some(edition) {
        return Err(format!("the first call is not edition({edition})"));
    }
    let image = rendered.image;
    Ok(format!("{}x{} {}", image.width(), image.height(), image.hash()))
}

#[test]
fn every_frozen_scene_gives_its_hash() {
    for edition in Edition::ALL.iter().copied() {
        let (mut recorded, mut wrong) = recorded(edition);
        for name in &mut wrong {
            name.push_str(" is on record twice");
        }
        for (name, path) in scenes(edition) {
            // A scene of the course has the newest edition, so it says something of the newest alone.
            let measured = name.ends_with(".rhai") || edition == Edition::LATEST;
            let expected = recorded.remove(&name);
            let found = if measured {
                picture(&path, edition)
            } else {
                expected.clone().ok_or_else(|| "is not on record".to_owned())
            };
            match (found, expected) {
                (Ok(found), Some(expected)) if found == expected => {}
                (Ok(found), Some(expected)) => wrong.push(format!("{name}: {found} and not {expected}")),
                (Ok(found), None) => wrong.push(format!("a new scene needs the line\n{name} {found}")),
                (Err(message), _) => wrong.push(format!("{name}: {message}")),
            }
        }
        wrong.extend(
            recorded
                .keys()
                .map(|name| format!("{name} is on record, but there is no such scene")),
        );
        assert!(wrong.is_empty(), "edition {edition}:\n{}", wrong.join("\n"));
    }
}

#[test]
fn every_call_stands_in_a_frozen_scene() {
    let mut words = BTreeSet::new();
    for path in scenes(Edition::LATEST).values() {
        let text = fs::read_to_string(path).unwrap();
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        words.extend(text.split(|c| !is_word(c)).map(str::to_owned));
    }
    let missing: Vec<&str> = entries()
        .filter(|entry| !words.contains(entry.name))
        .map(|entry| entry.name)
        .collect();
    assert!(missing.is_empty(), "no scene calls {}", missing.join(", "));
    assert!(entries().any(|entry| entry.group == Group::Shapes));
}

#[test]
fn another_picture_is_noticed() {
    let scenes = scenes(Edition::E2026);
    let (recorded, _) = recorded(Edition::E2026);
    let (name, other) = ("image/encoding/ramp-raw.rhai", "image/encoding/ramp-srgb.rhai");
    let found = picture(&scenes[name], Edition::E2026).unwrap();
    assert_eq!(found, recorded[name]);
    assert_ne!(found, recorded[other]);
}
