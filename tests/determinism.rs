//! One hash everywhere: every scene of the corpus gives the pixels of its snapshot, whatever the number of threads, the
//! size of the tiles and their order, in packets and ray by ray, twice in a row, in this build. `.ci/run` runs this in
//! debug and compares the release binary's pixels with the same snapshots, so that both agree with each other.
//! `.ci/portability` does it for each set of instructions (`RTSCRIPT_SIMD`), other builds, processors and browsers.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{fs, path::Path};

use rtscript::{
    RenderOptions,
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

/// Ways to render that must not show in a picture.
fn ways() -> Vec<RenderOptions> {
    let way = |threads, tile, shuffle, single_rays| {
        let mut options = RenderOptions::default();
        options.threads = threads;
        options.tile = tile;
        options.shuffle = shuffle;
        options.single_rays = single_rays;
        options
    };
    vec![
        way(1, 0, None, false),
        way(1, 0, None, true),
        way(2, 0, None, false),
        way(3, 0, None, false),
        way(8, 0, None, false),
        way(8, 0, None, false),
        way(64, 4, None, false),
        way(1, 1, None, false),
        way(2, 5, None, true),
        way(3, 1024, None, false),
        way(8, 3, Some(1), false),
        way(8, 8, Some(2), true),
    ]
}

/// The ways that one scene is rendered in: all of them where arithmetic is optimized, else three that change from scene
/// to scene, so that the corpus as a whole goes through all.
fn ways_of(scene: usize, ways: &[RenderOptions]) -> impl Iterator<Item = &RenderOptions> {
    let stride = if cfg!(debug_assertions) { 4 } else { 1 };
    ways.iter().skip(scene % stride).step_by(stride)
}

#[test]
fn every_scene_gives_its_hash_in_every_way() {
    let scenes = find_scenes(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes")).unwrap();
    let ways = ways();
    let (mut compared, mut wrong) = (0, Vec::new());
    for (i, scene) in scenes.iter().enumerate() {
        let Some(expected) = recorded_hash(scene) else {
            continue;
        };
        for way in ways_of(i, &ways) {
            let mut options = RunOptions::default();
            options.render = way.clone();
            let hash = render_file(scene, &options).unwrap().image.hash();
            if hash != expected {
                wrong.push(format!("{} with {way:?}: {hash}", scene.display()));
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
    assert!(compared >= 3 * 300, "only {compared} pictures were compared");
}
