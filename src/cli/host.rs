//! The command's outside world: files below the script's folder, the terminal, signals, pictures below the
//! current folder.

use std::{
    fs,
    io::Write,
    path::{Component, Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use super::{input::Input, progress::ProgressLine, report::Reporter, signals::Signals};
use crate::{
    diag::{Diagnostic, ErrorKind},
    host::{DirHost, Host, HostError},
    output,
    recipe::Recipe,
    render::{Image, Progress},
};

/// The host of one scene.
#[derive(Debug)]
pub(super) struct CliHost {
    assets: DirHost,
    signals: Arc<Signals>,
    progress: ProgressLine,
    /// Standard output carries the picture, so what the script prints goes to standard error.
    stdout_is_taken: bool,
    reporter: Reporter,
    /// The scene's name and text, for excerpts.
    script: (String, String),
    seen: Mutex<Seen>,
}

/// What went through the host.
#[derive(Debug, Default)]
struct Seen {
    /// The scene and every file read for it: a picture must not overwrite them.
    inputs: Vec<PathBuf>,
    reading: Duration,
    writing: Duration,
    /// What the picture is made from so far; `None` where it shall not carry it.
    recipe: Option<Recipe>,
    /// Warnings that were shown.
    warned: Vec<Diagnostic>,
}

impl CliHost {
    /// A host for a scene, whose pictures carry the recipe if there is one.
    pub(super) fn new(
        scene: &Input,
        signals: Arc<Signals>,
        progress: ProgressLine,
        stdout_is_taken: bool,
        recipe: Option<Recipe>,
        (reporter, text): (Reporter, &str),
    ) -> Self {
        Self {
            assets: DirHost::new(scene.folder()),
            signals,
            progress,
            stdout_is_taken,
            reporter,
            script: (scene.name().to_owned(), text.to_owned()),
            seen: Mutex::new(Seen {
                inputs: scene.path().map(Path::to_owned).into_iter().collect(),
                recipe,
                ..Seen::default()
            }),
        }
    }

    /// The files the picture is made from, so far.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.seen().inputs.clone()
    }

    /// Time spent reading assets and writing pictures that the script named.
    pub(super) fn times(&self) -> (Duration, Duration) {
        let seen = self.seen();
        (seen.reading, seen.writing)
    }

    /// What a picture is to carry.
    pub(super) fn recipe_of(&self, image: &Image) -> Option<Recipe> {
        let recipe = self.seen().recipe.clone()?;
        Some(recipe.of_picture(image.hash()))
    }

    /// A file below the folder of the scene, as it is found from the current folder.
    pub(super) fn path_of(&self, asset: &str) -> PathBuf {
        self.assets.root().join(asset)
    }

    /// Takes the progress line off the terminal.
    pub(super) fn clear_progress(&self) {
        self.progress.clear();
    }

    /// Shows each of these that was not shown yet: a script may render many pictures, and all look wrong in the same way.
    pub(super) fn show(&self, warnings: &[Diagnostic]) {
        for warning in warnings {
            let mut seen = self.seen();
            if !seen.warned.contains(warning) {
                seen.warned.push(warning.clone());
                drop(seen);
                let (name, text) = &self.script;
                let is_here = warning.source_line.is_none() && warning.file.as_deref() == Some(name);
                self.progress.clear();
                self.reporter.warnings(&[if is_here {
                    warning.clone().with_source(text)
                } else {
                    warning.clone()
                }]);
            }
        }
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Host for CliHost {
    fn warn(&self, warning: &Diagnostic) {
        self.show(std::slice::from_ref(warning));
    }

    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let start = Instant::now();
        let bytes = self.assets.read(path, max_bytes);
        let mut seen = self.seen();
        seen.reading += start.elapsed();
        if let Ok(bytes) = &bytes {
            seen.inputs.push(self.assets.root().join(path));
            if let (Some(recipe), true, Ok(text)) =
                (&mut seen.recipe, path.ends_with(".rhai"), str::from_utf8(bytes))
            {
                recipe.add(path, text);
            }
        }
        bytes
    }

    fn print(&self, text: &str) {
        self.progress.clear();
        // A reader that went away does not end the render.
        let _ = if self.stdout_is_taken {
            writeln!(std::io::stderr().lock(), "{text}")
        } else {
            writeln!(std::io::stdout().lock(), "{text}")
        };
    }

    fn should_stop(&self) -> bool {
        self.signals.caught().is_some()
    }

    fn progress(&self, progress: &Progress) {
        self.progress.update(progress);
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.progress.clear();
        let start = Instant::now();
        let path = below_current_folder(name)?;
        output::check_target(&path, &self.inputs())?;
        match self.recipe_of(image) {
            Some(recipe) => output::save_with(&path, image, &recipe)?,
            None => output::save(&path, image)?,
        }
        self.seen().writing += start.elapsed();
        Ok(())
    }
}

/// The host of a scene of which only the outcome counts: reads below a folder, stops by a signal, takes every picture
/// and prints nothing.
#[derive(Debug)]
pub(super) struct SilentHost {
    assets: DirHost,
    signals: Arc<Signals>,
}

impl SilentHost {
    /// A host for a scene whose assets are read below `root`.
    pub(super) fn new(root: &Path, signals: Arc<Signals>) -> Self {
        Self {
            assets: DirHost::new(root),
            signals,
        }
    }
}

impl Host for SilentHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.assets.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        self.signals.caught().is_some()
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}

/// Scripts from a recipe, everything else from another host.
pub(super) struct RecipeHost<'a> {
    pub(super) recipe: &'a Recipe,
    pub(super) others: SilentHost,
}

impl Host for RecipeHost<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        match self.recipe.files.iter().find(|(name, _)| name == path) {
            Some((_, text)) => Ok(text.clone().into_bytes()),
            None => self.others.read(path, max_bytes),
        }
    }

    fn should_stop(&self) -> bool {
        self.others.should_stop()
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.others.write_image(name, image)
    }
}

/// The path of a picture that a script names: relative, without `..`, and not through a link that leads out of
/// the current folder.
pub(super) fn below_current_folder(name: &str) -> Result<PathBuf, HostError> {
    let denied = |why: &str| {
        Err(HostError::new(
            ErrorKind::Denied,
            format!("'{name}' {why}; a script writes below the current folder only"),
        ))
    };
    let path = Path::new(name);
    for component in path.components() {
        match component {
            Component::Normal(_) | Component::CurDir => {}
            Component::ParentDir => return denied("goes through '..'"),
            Component::RootDir | Component::Prefix(_) => return denied("is an absolute path"),
        }
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder
        && let (Ok(folder), Ok(current)) = (fs::canonicalize(folder), fs::canonicalize("."))
        && !folder.starts_with(current)
    {
        return denied("leads outside through a link");
    }
    Ok(path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stay_below_the_current_folder() {
        for good in ["a.png", "./a.png", "sub/folder/a.png"] {
            assert_eq!(below_current_folder(good), Ok(PathBuf::from(good)));
        }
        for bad in ["/tmp/a.png", "../a.png", "sub/../../a.png", "sub/.."] {
            assert_eq!(
                below_current_folder(bad).unwrap_err().kind,
                ErrorKind::Denied,
                "{bad}"
            );
        }
    }
}
