//! One test for each scene under `tests/scenes`, found when the tests run; `tests/README.md` tells how to add one.
//!
//! Beside `<case>.rhai` (or `.test`) lie `<case>.snap`, the snapshot that decides, and `<case>.png`, the picture it
//! was taken of, which is there to be looked at and compared with. Scenes under `errors/` must fail, and their
//! snapshot is the message.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    env, fs,
    panic::{self, AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

use libtest_mimic::{Arguments, Failed, Trial};
use rtscript::{
    Error, Image, output,
    script::RunOptions,
    testing::{RenderedFile, compare, diff_picture, find_scenes, load_picture, render_file},
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

fn is_accepting() -> bool {
    env::var("INSTA_UPDATE").is_ok_and(|how| how == "always" || how == "force")
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
    match (render_file(scene, &RunOptions::default()), must_fail) {
        (Ok(rendered), false) => check_picture(scene, &rendered),
        (Err(error), true) => check_snapshot(scene, &error_text(&error), "").map_err(Failed::from),
        (Ok(_), true) => Err("a scene under errors/ must fail, but this one rendered".into()),
        (Err(error), false) => Err(error.to_string().into()),
    }
}

fn check_picture(scene: &Path, rendered: &RenderedFile) -> Result<(), Failed> {
    let image = &rendered.image;
    if image.width() * image.height() > MOST_PIXELS {
        let size = format!("{} x {}", image.width(), image.height());
        return Err(format!("{size} is more than 160 x 120 pixels; a scene here shows one thing").into());
    }
    let intent = intent(scene)?;
    let reference = scene.with_extension("png");
    let expected = load_picture(&reference);
    if let Err(message) = check_snapshot(scene, &rendered.snapshot(), &intent) {
        let shown = show_difference(scene, expected.ok().as_ref(), image)?;
        return Err(format!("{message}\n{shown}").into());
    }
    let is_current = expected.is_ok_and(|expected| {
        (expected.width(), expected.height()) == (image.width(), image.height())
            && compare(&expected, image).differing == 0
    });
    if is_current {
        return Ok(());
    }
    if is_accepting() {
        return output::save(&reference, image).map_err(|e| e.message.into());
    }
    Err(format!(
        "{} is not the picture of its snapshot; RTSCRIPT_ACCEPT=1 cargo test --test scenes writes it",
        reference.display()
    )
    .into())
}

/// Compares with `<case>.snap` by insta, so that `cargo insta review` works.
fn check_snapshot(scene: &Path, text: &str, intent: &str) -> Result<(), String> {
    let case = scene
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(scene.parent().unwrap_or(Path::new(".")));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    if !intent.is_empty() {
        settings.set_description(intent);
    }
    let assert = || settings.bind(|| insta::assert_snapshot!(case, text));
    catch_unwind(AssertUnwindSafe(assert)).map_err(|_| {
        "the snapshot differs; RTSCRIPT_ACCEPT=1 cargo test --test scenes accepts the new one".to_owned()
    })
}

/// Writes expected | difference | actual, or the actual picture alone where none is expected yet.
fn show_difference(scene: &Path, expected: Option<&Image>, actual: &Image) -> Result<String, Failed> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/scene-diffs");
    fs::create_dir_all(&folder)?;
    let path = folder.join(name_of(scene).replace('/', "-") + ".png");
    let (picture, what) = match expected {
        Some(expected) => {
            let c = compare(expected, actual);
            let numbers = format!(
                "{} of {} pixels differ, by {} at most, PSNR {:.1} dB",
                c.differing, c.pixels, c.max, c.psnr
            );
            (
                diff_picture(expected, actual),
                format!("{numbers}\nexpected | difference | actual"),
            )
        }
        None => (actual.clone(), "the picture".to_owned()),
    };
    output::save(&path, &picture).map_err(|e| Failed::from(e.message))?;
    Ok(format!("{what}: {}", path.display()))
}

/// What the scene is for: the comment on its first line.
fn intent(scene: &Path) -> Result<String, Failed> {
    let text = fs::read_to_string(scene)?;
    let first = text.lines().next().unwrap_or_default();
    let comment = first.strip_prefix("//").or_else(|| first.strip_prefix('#'));
    match comment.map(str::trim) {
        Some(intent) if !intent.is_empty() => Ok(intent.to_owned()),
        _ => Err("the first line must be a comment that says what the scene shows".into()),
    }
}

/// The error as a person would read it, with the line it points at.
fn error_text(error: &Error) -> String {
    let mut lines = Vec::new();
    for diagnostic in error.warnings.iter().chain([&*error.diagnostic]) {
        lines.push(diagnostic.to_string());
        let excerpt = diagnostic.source_line.as_ref();
        lines.extend(excerpt.map(|line| format!("  line: {}", line.trim())));
    }
    lines.push(format!("kind: {:?}", error.kind()));
    lines.join("\n")
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
