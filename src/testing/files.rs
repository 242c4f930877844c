//! Scene files, found and rendered as a test renders them.

use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use super::snapshot::{SHOWN, picture_text};
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
}

impl RenderedFile {
    /// [`snapshot_text`] of the last picture, and where there are any: the pictures before it, warnings, what was
    /// printed.
    #[must_use]
    pub fn snapshot(&self) -> String {
        let mut text = picture_text(&self.image);
        for picture in &self.earlier {
            let (name, image) = (picture.name.as_deref().unwrap_or("unnamed"), &picture.image);
            let size = format!("{} x {}", image.width(), image.height());
            let _ = writeln!(text, "before it {name:?} {size} hash {}", image.hash());
        }
        for warning in &self.warnings {
            let _ = writeln!(text, "{warning}");
        }
        for line in self.printed.lines() {
            let _ = writeln!(text, "printed {line:?}");
        }
        text.push('\n');
        text.push_str(&self.scene.dump_short(SHOWN));
        text
    }
}

/// Renders a scene file under the default [`Limits`], its assets read below its own folder. Pictures that the
/// script names are kept in the result and not written. Messages and the dump call the file by its name alone, so
/// that they do not depend on where the repository is.
///
/// # Errors
/// Whatever is wrong with the scene.
pub fn render_file(path: &Path, options: &RunOptions) -> Result<RenderedFile, Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let limits = Limits::default();
    let bytes = fs::read(path)
        .map_err(|e| Diagnostic::error(ErrorKind::Input, format!("cannot read '{name}': {e}")))?;
    let text = source::text(&name, bytes, &limits)?;
    let host = TestHost {
        assets: DirHost::new(path.parent().unwrap_or(Path::new("."))),
        printed: Mutex::default(),
    };
    let run = source::load(&name, &text, &host, &limits, options)?;
    let (mut earlier, mut warnings) = (run.value.pictures, run.warnings);
    let image = match earlier.pop() {
        Some(last) => last.image,
        None => {
            let rendered = render(&run.value.scene, &options.render, &host)?;
            warnings.extend(rendered.warnings);
            rendered.value.image
        }
    };
    Ok(RenderedFile {
        scene: run.value.scene,
        image,
        earlier,
        warnings,
        printed: host.printed.into_inner().unwrap_or_else(PoisonError::into_inner),
    })
}

/// Reads below one folder, keeps what is printed, takes every picture and drops it.
struct TestHost {
    assets: DirHost,
    printed: Mutex<String>,
}

impl Host for TestHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.assets.read(path, max_bytes)
    }

    fn print(&self, text: &str) {
        let mut printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
        printed.push_str(text);
        printed.push('\n');
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}
