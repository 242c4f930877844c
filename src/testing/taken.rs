//! What a snapshot is taken of, and what is taken.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use super::{
    files::{RenderedFile, intent, render_file},
    snapshot::{SHOWN, picture_text},
};
use crate::{
    diag::{Diagnostic, Error, Report},
    host::NoHost,
    render::{Image, RenderOptions, Rendered, render},
    scene::{Scene, SceneError},
    script::{Picture, Run, RunOptions},
};

/// Everything that a snapshot keeps, before it is compared with one.
///
/// ```
/// use rtscript::{Builder, testing::Snapshotted};
/// let mut b = Builder::new();
/// b.size(16, 16)?;
/// let taken = b.finish().take(".".as_ref())?;
/// assert!(taken.text().starts_with("size 16 x 16\nhash "));
/// assert!(taken.text().contains("warning: the scene is empty"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Taken {
    image: Option<Image>,
    head: String,
    notes: String,
    scene: Option<String>,
    description: Option<String>,
    input_file: Option<PathBuf>,
}

impl Taken {
    /// A picture.
    #[must_use]
    pub fn picture(image: Image) -> Self {
        Self {
            head: picture_text(&image),
            image: Some(image),
            notes: String::new(),
            scene: None,
            description: None,
            input_file: None,
        }
    }

    /// Why there is none: the warnings and the error as a person would read them, each with the line that it points
    /// at, and the kind of the error.
    #[must_use]
    pub fn error(error: &Error) -> Self {
        let mut head = String::new();
        for diagnostic in error.warnings.iter().chain([&*error.diagnostic]) {
            // Writing into a String does not fail.
            let _ = writeln!(head, "{diagnostic}");
            if let Some(line) = &diagnostic.source_line {
                let _ = writeln!(head, "  line: {}", line.trim());
            }
        }
        let _ = writeln!(head, "kind: {:?}", error.kind());
        Self {
            image: None,
            head,
            notes: String::new(),
            scene: None,
            description: None,
            input_file: None,
        }
    }

    /// The scene that the picture shows.
    #[must_use]
    pub fn with_scene(mut self, scene: &Scene) -> Self {
        self.scene = Some(scene.dump_short(SHOWN));
        self
    }

    /// A line of text between picture and scene: a warning, something printed.
    #[must_use]
    pub fn with_note(mut self, note: impl std::fmt::Display) -> Self {
        let _ = writeln!(self.notes, "{note}");
        self
    }

    pub(super) fn with_warnings(self, warnings: &[Diagnostic]) -> Self {
        warnings.iter().fold(self, Self::with_note)
    }

    /// A picture that this one came after, in one line.
    pub(super) fn with_earlier(self, picture: &Picture) -> Self {
        let (name, image) = (picture.name.as_deref().unwrap_or("unnamed"), &picture.image);
        let size = format!("{} x {}", image.width(), image.height());
        self.with_note(format_args!("before it {name:?} {size} hash {}", image.hash()))
    }

    /// What it is there to show, in a sentence; it is kept with the snapshot and not compared.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, Limits, NoHost, RenderOptions, Script, render, testing::Taken};
    /// let mut b = Builder::new();
    /// b.size(8, 8)?;
    /// b.directional(DVec3::Z, DVec3::ONE)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// let image = render(&scene, &RenderOptions::default(), &NoHost)?.value.image;
    /// // What a format of one's own keeps of a file that it read: picture, scene, and what was said about it.
    /// let taken = Taken::picture(image)
    ///     .with_scene(&scene)
    ///     .with_note("3 lines were skipped")
    ///     .with_description("a ball in plain light")
    ///     .with_input_file("balls/plain.ball");
    /// assert!(taken.text().contains("3 lines were skipped\n"), "{}", taken.text());
    /// assert_eq!(taken.description(), Some("a ball in plain light"));
    /// assert!(taken.input_file().is_some_and(|path| path.ends_with("plain.ball")));
    /// // And where there is no picture, the message.
    /// let error = Script::compile("a.rhai", "sphere(", &Limits::default()).expect_err("it is not complete");
    /// assert!(Taken::error(&error).text().contains("a.rhai:1"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_description(mut self, description: impl Into<String>) -> Self {
        self.description = Some(description.into());
        self
    }

    /// The file that it comes from; it is kept with the snapshot and not compared.
    #[must_use]
    pub fn with_input_file(mut self, path: impl Into<PathBuf>) -> Self {
        self.input_file = Some(path.into());
        self
    }

    /// The picture; `None` where there is only an error.
    #[must_use]
    pub fn image(&self) -> Option<&Image> {
        self.image.as_ref()
    }

    /// What it is there to show.
    #[must_use]
    pub fn description(&self) -> Option<&str> {
        self.description.as_deref()
    }

    /// The file that it comes from.
    #[must_use]
    pub fn input_file(&self) -> Option<&Path> {
        self.input_file.as_deref()
    }

    /// What is compared: as [`snapshot_text`](super::snapshot_text), the notes between picture and scene.
    #[must_use]
    pub fn text(&self) -> String {
        let scene = self.scene.as_ref().map(|scene| format!("\n{scene}"));
        format!("{}{}{}", self.head, self.notes, scene.unwrap_or_default())
    }
}

/// What a snapshot can be taken of: a scene, a picture with or without its scene, what a script left behind, a scene
/// file by its path, an error.
pub trait Snapshotted {
    /// Renders it where it is no picture yet. A relative path starts in `folder`.
    ///
    /// # Errors
    /// Where there is no picture to be had of it.
    fn take(&self, folder: &Path) -> Result<Taken, Error>;
}

impl<T: Snapshotted + ?Sized> Snapshotted for &T {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        (**self).take(folder)
    }
}

/// Renders it.
impl Snapshotted for Scene {
    fn take(&self, _: &Path) -> Result<Taken, Error> {
        let rendered = render(self, &RenderOptions::default(), &NoHost)?;
        let taken = Taken::picture(rendered.value.image).with_scene(self);
        Ok(taken.with_warnings(&rendered.warnings))
    }
}

/// Without a scene.
impl Snapshotted for Image {
    fn take(&self, _: &Path) -> Result<Taken, Error> {
        Ok(Taken::picture(self.clone()))
    }
}

/// Without a scene: `(&scene, &rendered.image)` has one.
impl Snapshotted for Rendered {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        self.image.take(folder)
    }
}

/// A scene and its picture, which is not rendered again.
impl Snapshotted for (&Scene, &Image) {
    fn take(&self, _: &Path) -> Result<Taken, Error> {
        Ok(Taken::picture(self.1.clone()).with_scene(self.0))
    }
}

/// With its warnings as notes.
impl<T: Snapshotted> Snapshotted for Report<T> {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        Ok(self.value.take(folder)?.with_warnings(&self.warnings))
    }
}

/// The last picture that the script rendered, or its scene, rendered now.
impl Snapshotted for Run {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        let Some((last, earlier)) = self.pictures.split_last() else {
            return self.scene.take(folder);
        };
        let taken = Taken::picture(last.image.clone()).with_scene(&self.scene);
        Ok(earlier.iter().fold(taken, Taken::with_earlier))
    }
}

impl Snapshotted for RenderedFile {
    fn take(&self, _: &Path) -> Result<Taken, Error> {
        Ok(self.taken())
    }
}

/// The scene file at this path, as [`render_file`] renders it. A comment on its first line is the description.
impl Snapshotted for Path {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        let path = folder.join(self);
        let taken = render_file(&path, &RunOptions::default())?.take(folder)?;
        let text = fs::read(&path).unwrap_or_default();
        Ok(match intent(&String::from_utf8_lossy(&text)) {
            Some(intent) => taken.with_description(intent),
            None => taken,
        }
        .with_input_file(path))
    }
}

/// The scene file at this path.
impl Snapshotted for PathBuf {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        self.as_path().take(folder)
    }
}

/// The scene file at this path.
impl Snapshotted for str {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        Path::new(self).take(folder)
    }
}

/// The scene file at this path.
impl Snapshotted for String {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        Path::new(self).take(folder)
    }
}

/// The message, for what must fail.
impl Snapshotted for Error {
    fn take(&self, _: &Path) -> Result<Taken, Error> {
        Ok(Taken::error(self))
    }
}

/// The message, for what the builder must refuse.
impl Snapshotted for SceneError {
    fn take(&self, folder: &Path) -> Result<Taken, Error> {
        Error::from(Diagnostic::from(self.clone())).take(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::snapshot_text, *};
    use crate::{Builder, Limits, Script, math::DVec3};

    fn here() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR"))
    }

    fn text(subject: impl Snapshotted) -> String {
        subject.take(here()).unwrap().text()
    }

    fn run(source: &str) -> Report<Run> {
        let script = Script::compile("a.rhai", source, &Limits::default()).unwrap();
        script.run(&NoHost, &RunOptions::default()).unwrap()
    }

    #[test]
    fn a_scene_and_its_picture_are_the_same_however_they_are_given() {
        let mut b = Builder::new();
        b.size(16, 12).unwrap();
        b.directional(DVec3::ONE, DVec3::ONE).unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        let report = b.finish();
        let scene = &report.value;
        let rendered = render(scene, &RenderOptions::default(), &NoHost).unwrap();
        let expected = snapshot_text(scene, &rendered.value.image);
        assert_eq!(text(scene), expected);
        assert_eq!(text(&report), expected);
        assert_eq!(text((scene, &rendered.value.image)), expected);
        let (picture, _) = expected.split_once("\n\n").unwrap();
        assert_eq!(text(&rendered).trim_end(), picture);
        assert_eq!(text(&rendered.value.image).trim_end(), picture);
    }

    #[test]
    fn what_happened_on_the_way_is_noted() {
        let run = run("size(8, 6); render(); pushTransform(); sphere(0, 0, 0, 1); render();");
        let text = text(&run);
        assert!(text.contains("\nbefore it \"unnamed\" 8 x 6 hash "), "{text}");
        assert!(text.contains("warning: pushTransform is never popped"), "{text}");
        let notes = text.find("before it").unwrap();
        assert!(text.find("luma").unwrap() < notes && notes < text.find("\n\nsize 8 6").unwrap());
    }

    #[test]
    fn a_scene_file_says_what_it_is_for() {
        let taken = "tests/scenes/shapes/torus/default.rhai".take(here()).unwrap();
        assert!(taken.description().unwrap().starts_with("A ring that fits"));
        assert!(taken.input_file().unwrap().ends_with("torus/default.rhai"));
        assert!("tests/scenes/none.rhai".take(here()).is_err());
    }

    #[test]
    fn an_error_is_its_message_and_line() {
        let script = Script::compile("a.rhai", "size(8, 6);\n sphere(0);", &Limits::default()).unwrap();
        let error = script.run(&NoHost, &RunOptions::default()).unwrap_err();
        let text = text(&error);
        assert!(text.starts_with("a.rhai:2:2: error: sphere takes "), "{text}");
        assert!(text.ends_with("\n  line: sphere(0);\nkind: Script\n"), "{text}");
        assert!(error.take(here()).unwrap().image().is_none());
    }
}
