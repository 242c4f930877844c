//! Scene files, found and rendered as a test renders them.

use std::{
    fs,
    io::{self, Read},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::taken::Taken;
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::{DirHost, Host, HostError},
    limits::Limits,
    render::{Image, render},
    scene::Scene,
    script::{Picture, RunOptions},
    source,
};

/// Every scene file below `root`: scripts (`.rhai`) and course scenes (`.test`), sorted by path.
///
/// # Errors
/// Where a folder cannot be read.
///
/// ```
/// use rtscript::testing::find_scenes;
/// let scenes = find_scenes("scripts".as_ref())?;
/// assert!(scenes.iter().any(|path| path.ends_with("sphereflake.rhai")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_scenes(root: &Path) -> io::Result<Vec<PathBuf>> {
    let mut scenes = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rhai" || e == "test") {
                scenes.push(path);
            }
        }
    }
    scenes.sort();
    Ok(scenes)
}

/// What a scene file came to.
#[derive(Debug)]
pub struct RenderedFile {
    /// The scene as it stood at the end.
    pub scene: Scene,
    /// The last picture that the script rendered, or the one picture of its scene.
    pub image: Image,
    /// What the script rendered before it.
    pub earlier: Vec<Picture>,
    /// Warnings of the script and the render.
    pub warnings: Vec<Diagnostic>,
    /// What the script printed, a line end after each text.
    pub printed: String,
    /// Names and texts of the scene's scripts: the scene file itself, then its modules by their paths from its
    /// folder, each as often as it was read.
    pub sources: Vec<(String, String)>,
}

impl RenderedFile {
    /// [`snapshot_text`](super::snapshot_text) of the last picture, and where there are any: the pictures before it, warnings, what was
    /// printed.
    #[must_use]
    pub fn snapshot(&self) -> String {
        self.taken().text()
    }

    /// What a snapshot of it keeps.
    pub(super) fn taken(&self) -> Taken {
        let mut taken = Taken::picture(self.image.clone()).with_scene(&self.scene);
        for picture in &self.earlier {
            taken = taken.with_earlier(picture);
        }
        taken = taken.with_warnings(&self.warnings);
        for line in self.printed.lines() {
            taken = taken.with_note(format_args!("printed {line:?}"));
        }
        taken
    }
}

/// What a scene is for: the comment on the first line of its text, if there is one.
///
/// ```
/// use rtscript::testing::intent;
/// assert_eq!(intent("// A ball on a table.\nsphere(0, 0, 0, 1);"), Some("A ball on a table."));
/// assert_eq!(intent("sphere(0, 0, 0, 1);"), None);
/// ```
#[must_use]
pub fn intent(text: &str) -> Option<&str> {
    let first = text.lines().next()?;
    let comment = first.strip_prefix("//").or_else(|| first.strip_prefix('#'))?;
    Some(comment.trim()).filter(|intent| !intent.is_empty())
}

/// Renders a scene file under the default [`Limits`], its assets read below its own folder. Pictures that the
/// script names are kept in the result and not written. Messages and the dump call the file by its name alone, so
/// that they do not depend on where the repository is.
///
/// # Errors
/// Whatever is wrong with the scene.
///
/// ```
/// use rtscript::{RunOptions, testing::render_file};
/// let mut options = RunOptions::default();
/// options.size = Some((8, 6));
/// let made = render_file("scripts/sunflower.rhai".as_ref(), &options)?;
/// assert_eq!(made.image.height(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render_file(path: &Path, options: &RunOptions) -> Result<RenderedFile, Error> {
    let text = read_scene(path)?;
    let assets = DirHost::new(path.parent().unwrap_or(Path::new(".")));
    render_text(&name_alone(path), &text, &assets, &Limits::default(), options)
}

/// What messages call a scene file in a test.
pub(crate) fn name_alone(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The text of a scene file.
///
/// # Errors
/// `Input` where it cannot be read, or as [`source::text`].
pub(crate) fn read_scene(path: &Path) -> Result<String, Error> {
    let name = name_alone(path);
    let limits = Limits::default();
    let mut bytes = Vec::new();
    fs::File::open(path)
        .and_then(|file| file.take(limits.source_bytes as u64 + 1).read_to_end(&mut bytes))
        .map_err(|e| Diagnostic::error(ErrorKind::Input, format!("cannot read '{name}': {e}")))?;
    source::text(&name, bytes, &limits)
}

/// As [`render_file`], from a text, under any limits, and with any host for assets, progress and the wish to stop.
///
/// # Errors
/// Whatever is wrong with the scene.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, testing::{RenderedFile, render_text}};
/// let text = "size(8, 6); sphere(0, 0, 0, 1);";
/// let made: RenderedFile = render_text("a.rhai", text, &NoHost, &Limits::default(), &RunOptions::default())?;
/// assert_eq!(made.image.width(), 8);
/// println!("{}", made.snapshot());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render_text(
    name: &str,
    text: &str,
    assets: &dyn Host,
    limits: &Limits,
    options: &RunOptions,
) -> Result<RenderedFile, Error> {
    let host = TestHost {
        assets,
        seen: Mutex::default(),
    };
    let run = source::load(name, text, &host, limits, options)?;
    let (mut earlier, mut warnings) = (run.value.pictures, run.warnings);
    let image = match earlier.pop() {
        Some(last) => last.image,
        None => {
            let rendered = render(&run.value.scene, &options.render, &host)?;
            warnings.extend(rendered.warnings);
            rendered.value.image
        }
    };
    let seen = host.seen.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut sources = vec![(name.to_owned(), text.to_owned())];
    sources.extend(seen.modules);
    Ok(RenderedFile {
        scene: run.value.scene,
        image,
        earlier,
        warnings,
        printed: seen.printed,
        sources,
    })
}

/// Keeps what is printed and which modules are read, takes every picture and drops it.
struct TestHost<'a> {
    assets: &'a dyn Host,
    seen: Mutex<Seen>,
}

#[derive(Default)]
struct Seen {
    printed: String,
    modules: Vec<(String, String)>,
}

impl TestHost<'_> {
    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Host for TestHost<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let bytes = self.assets.read(path, max_bytes)?;
        if path.ends_with(".rhai")
            && let Ok(text) = str::from_utf8(&bytes)
        {
            self.seen().modules.push((path.to_owned(), text.to_owned()));
        }
        Ok(bytes)
    }

    fn print(&self, text: &str) {
        let mut seen = self.seen();
        seen.printed.push_str(text);
        seen.printed.push('\n');
    }

    fn should_stop(&self) -> bool {
        self.assets.should_stop()
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}
