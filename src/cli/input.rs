//! The scene file as typed: its name, its folder, its bytes.

use std::{
    fs,
    io::{self, Read},
    path::{Path, PathBuf},
};

use clap::CommandFactory;

use super::{args::Cli, signals::Signals};
use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind, nearest_names},
    limits::Limits,
    output, source,
};

/// A scene file, or standard input.
#[derive(Clone, Debug)]
pub(super) struct Input {
    /// `None` is standard input.
    path: Option<PathBuf>,
    name: String,
}

impl Input {
    /// The file `path`; `-` is standard input.
    pub(super) fn new(path: &Path) -> Self {
        if path == Path::new("-") {
            return Self {
                path: None,
                name: "<stdin>".to_owned(),
            };
        }
        Self {
            path: Some(path.to_owned()),
            name: path.display().to_string(),
        }
    }

    /// Where it is; `None` for standard input.
    pub(super) fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    pub(super) fn is_stdin(&self) -> bool {
        self.path.is_none()
    }

    /// What messages call it: the path as typed, or `<stdin>`.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Its name without folders, as a recipe calls it: `stdin.rhai` for standard input.
    pub(super) fn short_name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or("stdin.rhai".to_owned(), |name| {
            name.to_string_lossy().into_owned()
        })
    }

    /// The folder its assets are read below.
    pub(super) fn folder(&self) -> &Path {
        self.path
            .as_deref()
            .and_then(Path::parent)
            .filter(|folder| !folder.as_os_str().is_empty())
            .unwrap_or(Path::new("."))
    }

    /// The name of its picture where none is given: `scene.png` for `folder/scene.rhai`, `out.png` for standard
    /// input. A picture of something else than light says of what: `scene-depth.png`.
    pub(super) fn picture_name(&self, shown: Option<&str>) -> PathBuf {
        let stem = self.path.as_deref().and_then(Path::file_stem);
        let mut name = stem.unwrap_or("out".as_ref()).to_owned();
        for part in shown.into_iter().flat_map(|shown| ["-", shown]) {
            name.push(part);
        }
        name.push(".png");
        PathBuf::from(name)
    }

    /// Its text, read while a signal ends the process: reading a terminal or a pipe may wait for ever. Afterwards
    /// signals are looked at.
    ///
    /// # Errors
    /// As [`Input::read`].
    pub(super) fn read_armed(&self, limits: &Limits, signals: &Signals) -> Result<String, Error> {
        signals.arm(false);
        let text = self.read(limits)?;
        signals.arm(true);
        Ok(text)
    }

    /// Its text.
    ///
    /// # Errors
    /// `Input` where it cannot be read, or as [`source::text`].
    pub(super) fn read(&self, limits: &Limits) -> Result<String, Error> {
        source::text(&self.name, self.bytes(limits)?, limits)
    }

    /// Its bytes, or as many as are enough to see that there are too many.
    ///
    /// # Errors
    /// `Input` where it cannot be read.
    pub(super) fn bytes(&self, limits: &Limits) -> Result<Vec<u8>, Error> {
        let most = limits.source_bytes as u64 + 1;
        let mut bytes = Vec::new();
        let read = match &self.path {
            None => io::stdin().lock().take(most).read_to_end(&mut bytes),
            Some(path) => fs::File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)),
        };
        match read {
            Ok(_) => Ok(bytes),
            Err(error) => Err(self.unreadable(&error).into()),
        }
    }

    fn unreadable(&self, error: &io::Error) -> Diagnostic {
        let why = why_unreadable(error);
        let diagnostic = Diagnostic::error(ErrorKind::Input, format!("cannot read '{}': {why}", self.name))
            .class(Code::UnreadableFile);
        let commands = Cli::command();
        let names = commands.get_subcommands().map(clap::Command::get_name);
        let near = nearest_names(&self.name, names);
        if let (io::ErrorKind::NotFound, Some(command)) = (error.kind(), near.first()) {
            return diagnostic.hint(format!("did you mean the command '{command}'?"));
        }
        match self.name.as_str() {
            "text" | "json" => diagnostic.hint(format!(
                "the statistics' format is given as --stats={}",
                self.name
            )),
            _ => diagnostic,
        }
    }
}

/// Why a file cannot be read.
pub(super) fn why_unreadable(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => output::reason(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_named_after_their_scene() {
        let name = |path: &str| Input::new(Path::new(path)).picture_name(None);
        assert_eq!(name("a/scene.rhai"), Path::new("scene.png"));
        assert_eq!(name("scene1.v2.test"), Path::new("scene1.v2.png"));
        assert_eq!(name("noending"), Path::new("noending.png"));
        assert_eq!(name("-"), Path::new("out.png"));
    }

    #[test]
    fn assets_are_beside_the_scene() {
        let folder = |path: &str| Input::new(Path::new(path)).folder().to_owned();
        assert_eq!(folder("a/b/scene.rhai"), Path::new("a/b"));
        assert_eq!(folder("scene.rhai"), Path::new("."));
        assert_eq!(folder("-"), Path::new("."));
    }
}
