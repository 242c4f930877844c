//! One hash everywhere: every scene of the corpus gives the pixels of its snapshot, with any number of threads,
//! twice in a row, in this build. `.ci/run` runs this in debug, in release, and in release with plain instructions
//! only (`RTSCRIPT_SIMD=portable`), so that all agree with the same snapshots and therefore with each other.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{fs, path::Path};

use rtscript::{
    script::RunOptions,
    testing::{find_scenes, render_file},
};

/// The hash on record for a scene; `None` for one that must fail.
fn recorded_hash(scene: &Path) -> Option<String> {
    let snapshot = fs::read_to_string(scene.with_extension("snap")).expect("every scene has a snapshot");
    snapshot
        .lines()
        .find_map(|line| line.strip_prefix("hash "))
        .map(str::to_owned)
}

#[test]
fn every_scene_gives_its_hash_with_any_number_of_threads_and_again() {
    let scenes = find_scenes(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes")).unwrap();
    let mut compared = 0;
    let mut wrong = Vec::new();
    for scene in &scenes {
        let Some(expected) = recorded_hash(scene) else {
            continue;
        };
        for threads in [1, 2, 7, 7] {
            let mut options = RunOptions::default();
            options.render.threads = threads;
            let hash = render_file(scene, &options).unwrap().image.hash();
            if hash != expected {
                wrong.push(format!("{} with {threads} threads: {hash}", scene.display()));
            }
            compared += 1;
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {compared} hashes differ:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(compared > 0, "there are no scenes");
}
