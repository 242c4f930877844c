//! One test for each scene under `tests/scenes`, found when the tests run; `tests/README.md` tells how to add one.
//!
//! Beside `<case>.rhai` (or `.test`) lie `<case>.snap`, the snapshot that decides, and `<case>.png`, the picture it
//! was taken of, which is there to be looked at and compared with. Scenes under `errors/` must fail, and their
//! snapshot is the message.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use std::{
    env, fs, panic,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

use libtest_mimic::{Arguments, Failed, Trial};
use rtscript::{
    script::RunOptions,
    testing::{
        RenderedFile, Snapshotted, Taken,
        assert::{SnapshotOptions, snapshot_site},
        find_scenes, intent, render_file,
    },
};

/// A scene shows one thing, and a repository holds many of them.
const MOST_PIXELS: u32 = 160 * 120;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    if env::var_os("RTSCRIPT_ACCEPT").is_some() && env::var_os("INSTA_UPDATE").is_none() {
        return accept();
    }
    silence_insta();
    let root = root();
    let scenes = find_scenes(&root).expect("tests/scenes can be listed");
    assert!(!scenes.is_empty(), "there are no scenes under {}", root.display());
    let mut trials: Vec<Trial> = scenes
        .iter()
        .map(|scene| {
            let scene = scene.clone();
            Trial::test(name_of(&scene), move || check(&scene))
        })
        .collect();
    trials.push(Trial::test("every-snapshot-has-its-scene", move || {
        orphans(&root, &scenes)
    }));
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// Insta has printed the difference when it panics; the trace of its own code says nothing more.
fn silence_insta() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if !info.location().is_some_and(|at| at.file().contains("insta")) {
            usual(info);
        }
    }));
}

/// Runs the tests again with insta told to write every snapshot. Insta reads that from its environment alone.
fn accept() -> ExitCode {
    let status = Command::new(env::current_exe().expect("the test knows its own file"))
        .args(env::args_os().skip(1))
        .env("INSTA_UPDATE", "always")
        .status()
        .expect("the test starts again");
    ExitCode::from(
        status
            .code()
            .and_then(|code| u8::try_from(code).ok())
            .unwrap_or(1),
    )
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes")
}

/// `area/subject/case`.
fn name_of(scene: &Path) -> String {
    let relative = scene.strip_prefix(root()).unwrap_or(scene).with_extension("");
    let parts: Vec<_> = relative.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

fn check(scene: &Path) -> Result<(), Failed> {
    let must_fail = name_of(scene).starts_with("errors/");
    let taken = match (render_file(scene, &RunOptions::default()), must_fail) {
        (Ok(rendered), false) => taken_of(scene, &rendered)?,
        (Err(error), true) => Taken::error(&error),
        (Ok(_), true) => return Err("a scene under errors/ must fail, but this one rendered".into()),
        (Err(error), false) => return Err(error.to_string().into()),
    };
    let checked = snapshot_site!().check_beside(scene, &taken, &SnapshotOptions::default());
    checked.map_err(Failed::from)
}

/// What the snapshot keeps, where the scene is small and says what it is for.
fn taken_of(scene: &Path, rendered: &RenderedFile) -> Result<Taken, Failed> {
    let image = &rendered.image;
    if image.width() * image.height() > MOST_PIXELS {
        let size = format!("{} x {}", image.width(), image.height());
        return Err(format!("{size} is more than 160 x 120 pixels; a scene here shows one thing").into());
    }
    let text = fs::read_to_string(scene)?;
    let intent = intent(&text).ok_or("the first line must be a comment that says what the scene shows")?;
    let taken = rendered.take(&root()).map_err(|e| e.to_string())?;
    Ok(taken.with_description(intent))
}

/// A snapshot or two scenes of one name would never be looked at.
fn orphans(root: &Path, scenes: &[PathBuf]) -> Result<(), Failed> {
    let mut wanted: Vec<PathBuf> = scenes.iter().map(|scene| scene.with_extension("snap")).collect();
    wanted.sort();
    if let Some(twice) = wanted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("two scenes share {}", twice[0].display()).into());
    }
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "snap") && !wanted.contains(&path) {
                return Err(format!("{} belongs to no scene", path.display()).into());
            }
        }
    }
    Ok(())
}
