//! A scene written out flat is the same scene: for every scene of the package, the text that [`Run::write_source`]
//! gives builds a scene of the same hash, written out again it is the same text, and it renders to the same pixels.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use rtscript::{
    DirHost, Limits,
    script::{Run, RunOptions},
    source,
    testing::{find_scenes, render_text},
};

/// Scenes with handles that nothing uses, of calls that failed and were caught: the same picture by another hash.
const LEFT_OVERS: [&str; 1] = ["tests/scenes/transform/instances/all-or-none.rhai"];

/// Scenes whose pictures are compared, too: one of so many.
const RENDERED: usize = 12;

fn folders() -> [PathBuf; 4] {
    ["tests/scenes", "tests/editions", "scripts", "cse167"].map(|name| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        root.join(name)
    })
}

/// Scenes that build, errors and modules aside.
fn scenes() -> Vec<PathBuf> {
    let mut scenes = Vec::new();
    for folder in folders().iter().filter(|folder| folder.is_dir()) {
        scenes.extend(find_scenes(folder).unwrap());
    }
    let left_out = |path: &PathBuf| path.iter().any(|part| part == "errors" || part == "lib");
    scenes.retain(|path| !left_out(path));
    scenes
}

fn flat(run: &Run) -> String {
    let mut text = String::new();
    run.write_source(false, &mut text).unwrap();
    text
}

/// Small, so that what a script renders on its way costs little.
fn options() -> RunOptions {
    let mut options = RunOptions::default();
    options.size = Some((16, 12));
    options.render.threads = 1;
    options
}

/// What is wrong with the round trip of a scene; `None` where it does not build.
fn fault(path: &Path, with_pixels: bool) -> Option<Result<(), String>> {
    let (limits, host) = (Limits::default(), DirHost::new(path.parent().unwrap()));
    let has_left_overs = LEFT_OVERS.iter().any(|name| path.ends_with(name));
    let name = path.file_name().unwrap().to_str().unwrap();
    let text = source::text(name, fs::read(path).ok()?, &limits).ok()?;
    let run = source::load(name, &text, &host, &limits, &options()).ok()?.value;
    let expanded = flat(&run);
    Some(
        source::load("flat.rhai", &expanded, &host, &limits, &RunOptions::default()).map_or_else(
            |error| Err(format!("its text fails: {error}")),
            |again| {
                let again = again.value;
                if run.scene.hash() != again.scene.hash() && !has_left_overs {
                    let (was, is) = (run.scene.dump(), again.scene.dump());
                    let pair = was
                        .lines()
                        .zip(is.lines())
                        .find(|(was, is)| was.split(" at ").next() != is.split(" at ").next());
                    return Err(format!("another scene, first in {pair:?}"));
                }
                if flat(&again) != expanded {
                    return Err("another text the second time".to_owned());
                }
                if with_pixels || has_left_overs {
                    let picture = |name, text: &str| {
                        let rendered = render_text(name, text, &host, &limits, &options());
                        rendered
                            .map(|r| (r.earlier.is_empty(), r.image.hash()))
                            .map_err(|e| e.to_string())
                    };
                    let (before, after) = (picture(name, &text)?, picture("flat.rhai", &expanded)?);
                    // What a script renders on its way is not the scene at its end.
                    if before.0 && before.1 != after.1 {
                        return Err("other pixels".to_owned());
                    }
                }
                Ok(())
            },
        ),
    )
}

#[test]
fn every_scene_comes_back_from_its_text() {
    let scenes = scenes();
    let (next, faults, built) = (AtomicUsize::new(0), Mutex::new(Vec::new()), AtomicUsize::new(0));
    let workers = thread::available_parallelism().map_or(1, usize::from).min(8);
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(path) = scenes.get(i) else { return };
                    let Some(result) = fault(path, i % RENDERED == 0) else {
                        continue;
                    };
                    built.fetch_add(1, Ordering::Relaxed);
                    if let Err(message) = result {
                        faults
                            .lock()
                            .unwrap()
                            .push(format!("{}: {message}", path.display()));
                    }
                }
            });
        }
    });
    let mut faults = faults.into_inner().unwrap();
    faults.sort();
    assert!(built.into_inner() > 400, "most scenes build");
    assert!(
        faults.is_empty(),
        "{} scenes:\n{}",
        faults.len(),
        faults.join("\n")
    );
}
