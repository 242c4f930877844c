//! Assertions for the tests of a crate that makes pictures, on top of [insta]. Feature `insta`.
//!
//! [insta]: https://insta.rs
//!
//! ```toml
//! [dev-dependencies]
//! rtscript = { version = "0.1", default-features = false, features = ["insta"] }
//! ```
//!
//! ```
//! # let mut settings = rtscript::testing::assert::insta::Settings::clone_current();
//! # settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/snapshots"));
//! # settings.set_prepend_module_to_snapshot(false);
//! # let _guard = settings.bind_to_scope();
//! use rtscript::{Builder, DVec3, testing::assert_render_snapshot};
//!
//! let mut b = Builder::new();
//! b.size(32, 24)?;
//! b.directional(DVec3::ONE, DVec3::ONE)?;
//! b.sphere(DVec3::ZERO, 1.0)?;
//! assert_render_snapshot!("ball", b.finish());
//! # Ok::<(), rtscript::scene::SceneError>(())
//! ```
//!
//! What may stand there is [`Snapshotted`]: a scene, a picture with or without its scene, what a script left behind,
//! the path of a scene file, an error. Named values may follow:
//!
//! - `tolerance: Tolerance { max_difference: 1, ..Tolerance::ANY }`, how much the picture may differ from the
//!   reference picture; without it, not at all;
//! - `description: "A ball under one light."`, kept with the snapshot. A scene file has the comment on its first line.
//!
//! # Files
//!
//! For a test `assert_render_snapshot!("ball", ...)` in `tests/pictures.rs`
//!
//! | file | what it is |
//! |---|---|
//! | `tests/snapshots/pictures__ball.snap` | the text that decides: the hash of the pixels, and enough to see what changed |
//! | `tests/snapshots/pictures__ball.png` | the picture it was taken of, to be looked at and compared with |
//! | `tests/snapshots/pictures__ball.snap.new` | a new text that waits for a review; not to be committed |
//! | `target/render-diffs/tests-snapshots-pictures__ball.png` | expected, difference and actual side by side |
//!
//! [insta's settings](https://docs.rs/insta/latest/insta/struct.Settings.html) for the folder, the module's name and
//! the suffix count here, too. [`glob_render_snapshots!`] puts `ball.snap` and `ball.png` beside `ball.rhai`.
//!
//! # Accepting
//!
//! A test whose picture or scene is not the one on record fails, with the number of pixels that differ, the largest
//! difference, the signal-to-noise ratio, and the `file://` address of the picture with all three, which most terminals
//! open by a click. The same lines stand in the pending snapshot, so that `cargo insta review` shows them. Accept it
//! there, or by `INSTA_UPDATE=always cargo test`.
//!
//! The picture follows the text: where the text is the one on record and the picture beside it is missing or another,
//! the next run of the test writes it, and takes the lines about the difference out of the snapshot that was accepted.
//! With `INSTA_UPDATE=no`, and where `CI` is set, nothing is written, and such a test fails.

mod glob;
mod record;
mod surroundings;

#[doc(hidden)]
pub use insta;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
};

use super::{Comparison, Snapshotted, Taken, Tolerance, compare, diff_picture, load_picture};
use crate::{output, render::Image};
use record::{Nearness, Record};

/// Asserts that a picture and its scene are the ones on record under a name:
/// `assert_render_snapshot!("name", scene)`, then `tolerance: ...` and `description: ...` as wanted.
///
/// See [`testing::assert`](crate::testing::assert) for what may be given, where the files lie and how to accept a
/// change.
#[macro_export]
macro_rules! assert_render_snapshot {
    ($name:expr, $subject:expr $(, $key:ident: $value:expr)* $(,)?) => {{
        #[allow(unused_mut)]
        let mut options = $crate::testing::assert::SnapshotOptions::default();
        $(options.$key = ($value).into();)*
        let checked = $crate::snapshot_site!().check(::std::convert::AsRef::as_ref(&$name), &$subject, &options);
        if let ::std::result::Result::Err(message) = checked {
            ::std::panic!("{message}");
        }
    }};
}

/// Asserts that every scene file that a pattern finds gives the picture on record beside it:
/// `glob_render_snapshots!("scenes/**/*.rhai")`, then `tolerance: ...` as wanted.
///
/// The pattern starts in the folder of the crate's `Cargo.toml`. `*` and `?` stand for letters of one name, `**` for
/// any number of folders. For `scenes/ball.rhai` the snapshot is `scenes/ball.snap` and its picture
/// `scenes/ball.png`. All files are looked at before the test fails, which it also does where there is none.
///
/// ```no_run
/// # use rtscript::testing::{Tolerance, glob_render_snapshots};
/// glob_render_snapshots!("scenes/**/*.rhai");
/// glob_render_snapshots!("scenes/**/*.test", tolerance: Tolerance { psnr: 50.0, ..Tolerance::ANY });
/// ```
#[macro_export]
macro_rules! glob_render_snapshots {
    ($pattern:expr $(, $key:ident: $value:expr)* $(,)?) => {{
        #[allow(unused_mut)]
        let mut options = $crate::testing::assert::SnapshotOptions::default();
        $(options.$key = ($value).into();)*
        if let ::std::result::Result::Err(message) = $crate::snapshot_site!().check_glob($pattern, &options) {
            ::std::panic!("{message}");
        }
    }};
}

/// The [`Site`](crate::testing::assert::Site) of the line it stands on, for test runners of one's own.
#[macro_export]
macro_rules! snapshot_site {
    () => {
        $crate::testing::assert::Site {
            manifest_folder: ::std::env!("CARGO_MANIFEST_DIR"),
            file: ::std::file!(),
            module: ::std::module_path!(),
            assert: |name: &str, text: &str| $crate::testing::assert::insta::assert_snapshot!(name, text),
        }
    };
}

#[doc(inline)]
pub use crate::{assert_render_snapshot, glob_render_snapshots, snapshot_site};

/// What an assertion may say beside name and subject.
///
/// ```
/// use rtscript::testing::{Tolerance, assert::SnapshotOptions};
/// let mut options = SnapshotOptions::default();
/// options.tolerance = Tolerance { max_difference: 2, ..Tolerance::EXACT };
/// ```
#[derive(Clone, Debug, Default)]
pub struct SnapshotOptions {
    /// How much the picture may differ from its reference.
    pub tolerance: Tolerance,
    /// What it is there to show; empty for what the subject says about itself.
    pub description: String,
}

/// Where an assertion stands; [`snapshot_site!`] makes one. What it checks it answers for instead of panicking, so a
/// test runner of one's own can make a test of each scene.
///
/// ```
/// use rtscript::testing::assert::{Site, snapshot_site};
/// // Where a test stands, as the assertions find it out.
/// let site: Site = snapshot_site!();
/// assert!(site.file.ends_with(".rs"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// The folder of the crate's `Cargo.toml`.
    pub manifest_folder: &'static str,
    /// The source file, as the compiler names it.
    pub file: &'static str,
    /// The module, as the compiler names it.
    pub module: &'static str,
    /// Insta's assertion of a name and a text, made there: insta takes its settings from the crate it stands in.
    pub assert: fn(&str, &str),
}

impl Site {
    /// Compares `subject` with the snapshot called `name`, which lies where insta puts one of that name.
    ///
    /// # Errors
    /// What is wrong, as text for a person: it cannot be rendered, or it is not what is on record.
    pub fn check(
        &self,
        name: &str,
        subject: &dyn Snapshotted,
        options: &SnapshotOptions,
    ) -> Result<(), String> {
        let taken = self.take(subject)?;
        let settings = insta::Settings::clone_current();
        let mut stem = name.replace(['/', '\\'], "__");
        if let Some(suffix) = settings.snapshot_suffix() {
            stem = format!("{stem}@{suffix}");
        }
        if settings.prepend_module_to_snapshot() {
            stem = format!("{}__{stem}", self.module.replace("::", "__"));
        }
        let folder = self.source_folder().join(settings.snapshot_path());
        self.check_at(&folder, &stem, &taken, options)
    }

    /// Compares the scene file at `path`, which starts in the crate's folder where it is relative, with the snapshot
    /// beside it.
    ///
    /// # Errors
    /// As [`Site::check`].
    pub fn check_file(&self, path: &Path, options: &SnapshotOptions) -> Result<(), String> {
        let taken = self.take(path)?;
        self.check_beside(path, &taken, options)
    }

    /// Compares what was taken of the file at `path` with the snapshot beside it.
    ///
    /// # Errors
    /// As [`Site::check`].
    pub fn check_beside(&self, path: &Path, taken: &Taken, options: &SnapshotOptions) -> Result<(), String> {
        let path = Path::new(self.manifest_folder).join(path);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        self.check_at(path.parent().unwrap_or(Path::new(".")), &stem, taken, options)
    }

    /// Checks every scene file that a pattern finds, as [`glob_render_snapshots!`] does.
    ///
    /// # Errors
    /// As [`Site::check`], for all files at once; also where the pattern finds none, or two that share a snapshot.
    ///
    /// ```
    /// use std::path::Path;
    /// use rtscript::testing::{Snapshotted, assert::{Site, SnapshotOptions, snapshot_site}};
    /// // A test runner of one's own: each failure is a text to report.
    /// let site: Site = snapshot_site!();
    /// let options = SnapshotOptions::default();
    /// let scene = Path::new("tests/scenes/shapes/sphere/default.rhai");
    /// site.check_file(scene, &options)?;
    /// site.check_glob("tests/scenes/shapes/sphere/*.rhai", &options)?;
    /// // The same of what was rendered before: with options of one's own, say.
    /// let taken = scene.take(Path::new(site.manifest_folder)).map_err(|e| e.to_string())?;
    /// site.check_beside(scene, &taken, &options)?;
    /// // A pattern that finds nothing is a mistake.
    /// assert!(site.check_glob("tests/scenes/*.ball", &options).is_err());
    /// # Ok::<(), String>(())
    /// ```
    pub fn check_glob(&self, pattern: &str, options: &SnapshotOptions) -> Result<(), String> {
        let folder = Path::new(self.manifest_folder);
        let found = glob::find(folder, pattern).map_err(|e| format!("cannot look for \"{pattern}\": {e}"))?;
        if found.is_empty() {
            return Err(format!("\"{pattern}\" finds no file below {}", folder.display()));
        }
        let mut failures = Vec::new();
        let mut snapshots = std::collections::BTreeSet::new();
        for path in &found {
            let checked = if snapshots.insert(path.with_extension("snap")) {
                self.check_file(path, options)
            } else {
                Err("another scene has the same snapshot".to_owned())
            };
            if let Err(message) = checked {
                let name = path.strip_prefix(folder).unwrap_or(path).display();
                failures.push(format!("{name}: {message}"));
            }
        }
        if failures.is_empty() {
            return Ok(());
        }
        let (failed, all) = (failures.len(), found.len());
        Err(format!("{failed} of {all} scenes:\n{}", failures.join("\n")))
    }

    fn take(&self, subject: &(impl Snapshotted + ?Sized)) -> Result<Taken, String> {
        let taken = subject.take(Path::new(self.manifest_folder));
        taken.map_err(|e| Taken::error(&e).text().trim_end().to_owned())
    }

    /// The folder of the source file. The compiler names it from the folder in which the build began, which holds
    /// the crate, or is it.
    fn source_folder(&self) -> PathBuf {
        let manifest = Path::new(self.manifest_folder);
        let from = |folder: &Path| folder.join(self.file);
        let found = manifest.ancestors().map(from).find(|path| path.is_file());
        let file = found.unwrap_or_else(|| from(manifest));
        file.parent().unwrap_or(manifest).to_owned()
    }

    /// Compares what was taken with `<stem>.snap` and `<stem>.png` in `folder`.
    fn check_at(
        &self,
        folder: &Path,
        stem: &str,
        taken: &Taken,
        options: &SnapshotOptions,
    ) -> Result<(), String> {
        let record = Record::new(folder, stem);
        let text = taken.text();
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(folder);
        settings.set_prepend_module_to_snapshot(false);
        settings.remove_snapshot_suffix();
        settings.set_omit_expression(true);
        let own = Some(options.description.as_str()).filter(|own| !own.is_empty());
        if let Some(description) = own.or(taken.description()) {
            settings.set_description(description);
        }
        if let Some(path) = taken.input_file() {
            settings.set_input_file(path);
        }
        // Insta sees every text, also those that need no comparing: it removes what is pending no longer and knows
        // then which snapshots are in use.
        let assert = |settings: &insta::Settings, text: &str| {
            catch_unwind(AssertUnwindSafe(|| settings.bind(|| (self.assert)(stem, text)))).is_ok()
        };
        if record.is(&text) {
            record.settle(taken.image())?;
            return equal(assert(&settings, &text));
        }
        let reference = record.reference();
        let comparison = taken.image().zip(reference.as_ref());
        let comparison = comparison.map(|(actual, expected)| compare(expected, actual));
        let nearness = comparison.map_or(Nearness::Far, |c| record.nearness(&text, &options.tolerance, &c));
        if let Nearness::Near(accepted) = &nearness {
            return equal(assert(&settings, accepted));
        }
        let shown = if surroundings::accepts() {
            Vec::new()
        } else {
            self.show(&record, reference.as_ref(), taken.image())?
        };
        if !shown.is_empty() {
            settings.set_raw_info(&record::note(&shown));
        }
        let passed = assert(&settings, &text);
        if Record::new(folder, stem).is(&text) {
            return Record::new(folder, stem).settle(taken.image());
        }
        // Insta lets a changed snapshot pass where `cargo insta` asks for it, which reviews it later.
        if passed {
            return Ok(());
        }
        let mut message = format!("the picture {stem:?} is not the one on record");
        if taken.image().is_none() {
            message = format!("the message {stem:?} is not the one on record");
        }
        if options.tolerance != Tolerance::EXACT && matches!(nearness, Nearness::InPixelsAlone) {
            message
                .push_str("\n  its pixels are within the tolerance, the text of its scene is not the same");
        }
        for (what, value) in &shown {
            message.push_str(&format!("\n  {what}: {value}"));
        }
        message.push_str("\n  cargo insta review, or INSTA_UPDATE=always cargo test, accepts it");
        Err(message)
    }

    /// Writes expected | difference | actual, or the actual picture alone where none is expected yet; says what the
    /// difference is and where it can be seen.
    fn show(
        &self,
        record: &Record,
        expected: Option<&Image>,
        actual: Option<&Image>,
    ) -> Result<Vec<(&'static str, String)>, String> {
        let Some(actual) = actual else {
            return Ok(Vec::new());
        };
        let path = surroundings::difference_path(self.manifest_folder.as_ref(), &record.snapshot);
        let (mut shown, picture, what) = match expected {
            Some(expected) => {
                let numbers = numbers(&compare(expected, actual));
                let picture = diff_picture(expected, actual);
                (
                    vec![("difference", numbers)],
                    picture,
                    "expected | difference | actual",
                )
            }
            None => (Vec::new(), actual.clone(), "picture"),
        };
        if expected.is_some_and(|expected| !record.is_of(expected)) {
            let reference = record.picture.display();
            shown.push(("warning", format!("{reference} is not the picture on record")));
        }
        if let Some(folder) = path.parent() {
            let made = std::fs::create_dir_all(folder);
            made.map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
        }
        output::save(&path, &picture).map_err(|e| e.message)?;
        shown.push((what, surroundings::address(&path)));
        Ok(shown)
    }
}

/// What insta makes of a text that is the one on record.
fn equal(passed: bool) -> Result<(), String> {
    let refused = "the picture is the one on record, but insta wants its description to be the same, too";
    if passed { Ok(()) } else { Err(refused.to_owned()) }
}

/// How two pictures differ, in words.
fn numbers(c: &Comparison) -> String {
    if c.differing == 0 {
        return "no pixel; the scene is written differently".to_owned();
    }
    format!(
        "{} of {} pixels, by {} at most, PSNR {:.1} dB",
        c.differing, c.pixels, c.max, c.psnr
    )
}

/// The picture at `path`, if there is one that can be read.
fn picture_at(path: &Path) -> Option<Image> {
    load_picture(path).ok()
}
