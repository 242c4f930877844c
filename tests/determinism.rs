//! One hash everywhere: every scene of the corpus gives the pixels of its snapshot, with any number of threads, in
//! packets and ray by ray, twice in a row, in this build. `.ci/run` runs this in debug, in release, and in release with
//! each set of instructions (`RTSCRIPT_SIMD`), so that all agree with the same snapshots and therefore with each other.

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
fn every_scene_gives_its_hash_with_any_number_of_threads_in_packets_and_alone() {
    let scenes = find_scenes(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes")).unwrap();
    let mut compared = 0;
    let mut wrong = Vec::new();
    for scene in &scenes {
        let Some(expected) = recorded_hash(scene) else {
            continue;
        };
        for (threads, single_rays) in [(1, false), (1, true), (2, false), (7, false), (7, false)] {
            let mut options = RunOptions::default();
            options.render.threads = threads;
            options.render.single_rays = single_rays;
            let hash = render_file(scene, &options).unwrap().image.hash();
            if hash != expected {
                let scene = scene.display();
                wrong.push(format!(
                    "{scene} with {threads} threads, single rays {single_rays}: {hash}"
                ));
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
