//! A scene that is asked about rather than rendered: a scene file, or a PNG that carries its recipe.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use super::{args::Overrides, host::SilentHost, input::Input, rerun, signals::Signals};
use crate::{
    diag::{Error, Report, SourceLoc},
    host::{Host, HostError},
    limits::Limits,
    recipe::Recipe,
    render::{Image, render},
    scene::{Geometry, Object, Scene},
    script::{CallSite, Run, RunOptions, Script},
    source::{self, SourceKind},
};

/// A scene that is asked about.
pub(super) struct Subject {
    /// As messages name it.
    pub(super) name: String,
    text: String,
    options: RunOptions,
    host: SubjectHost,
}

impl Subject {
    /// Reads a scene file, or the recipe of a PNG; `overrides` count more than the recipe's parameters. Assets are read
    /// below `assets`, where that is given, otherwise beside the file.
    ///
    /// # Errors
    /// `Input` where the file cannot be read or carries no recipe.
    pub(super) fn read(
        file: &Path,
        assets: Option<&Path>,
        overrides: &Overrides,
        signals: &Arc<Signals>,
    ) -> Result<Self, Error> {
        signals.arm(false);
        let input = Input::new(file);
        let mut parameters = overrides.parameters();
        let is_png = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let (name, text, recipe) = if is_png {
            let (recipe, _) = rerun::read(file)?;
            parameters = parameters.or(&recipe.parameters);
            let Some((name, text)) = recipe.files.first().cloned() else {
                return Err(rerun::no_recipe(file));
            };
            (name, text, recipe)
        } else {
            let text = input.read(&Limits::default())?;
            (input.name().to_owned(), text, Recipe::default())
        };
        signals.arm(true);
        let folder: PathBuf = assets.unwrap_or(input.folder()).to_owned();
        Ok(Self {
            name,
            text,
            options: RunOptions::from(&parameters),
            host: SubjectHost {
                recipe,
                others: SilentHost::new(&folder, Arc::clone(signals)),
                modules: Mutex::default(),
            },
        })
    }

    /// Runs the scene up to its end; nothing is written or printed.
    ///
    /// # Errors
    /// Whatever keeps it from running.
    pub(super) fn load(&self) -> Result<Report<Run>, Error> {
        source::load(
            &self.name,
            &self.text,
            &self.host,
            &Limits::default(),
            &self.options,
        )
    }

    /// Decides how many threads render.
    pub(super) fn set_threads(&mut self, threads: usize) {
        self.options.render.threads = threads;
    }

    /// The picture of a scene that it left behind, or the last one that its script rendered.
    ///
    /// # Errors
    /// Whatever keeps it from being rendered.
    pub(super) fn picture(&self, run: &mut Run) -> Result<Image, Error> {
        if let Some(last) = run.pictures.pop() {
            return Ok(last.image);
        }
        render(&run.scene, &self.options.render, &self.host).map(|report| report.value.image)
    }

    /// The text of a file as messages name it, where it was read.
    pub(super) fn text_of(&self, file: &str) -> Option<String> {
        if file == self.name {
            return Some(self.text.clone());
        }
        let modules = self.host.modules.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |name: &str| file == name || file.ends_with(&format!("/{name}"));
        let module = modules.iter().find(|(name, _)| is_it(name));
        module.map(|(_, text)| text.clone())
    }

    /// Its outside world.
    pub(super) fn host(&self) -> &dyn Host {
        &self.host
    }

    /// The calls that made an object of the scene it left behind, innermost first; empty where they are unknown, as in
    /// a scene of the course.
    ///
    /// # Errors
    /// As [`Subject::load`].
    pub(super) fn call_stack(&self, scene: &Scene, object: &Object) -> Result<Vec<CallSite>, Error> {
        let place = scene.groups.iter().zip(0..).find_map(|(group, id)| {
            let index = group.objects.iter().position(|o| std::ptr::eq(o, object))?;
            Some((crate::scene::GroupId(id), index))
        });
        let (Some(place), SourceKind::Script) = (place, SourceKind::from_name(&self.name)) else {
            return Ok(Vec::new());
        };
        let script = Script::compile(&self.name, &self.text, &Limits::default())?;
        script.call_stack(&self.host, &self.options, scene, place)
    }

    /// Line `line` (from 1) of a file as messages name it, without indentation; empty where it is unknown.
    pub(super) fn line(&self, file: &str, line: u32) -> String {
        let nth = |text: &str| {
            let line = text.lines().nth((line as usize).checked_sub(1)?)?.trim();
            Some(line.chars().take(LONGEST_LINE).collect::<String>())
        };
        if file == self.name {
            return nth(&self.text).unwrap_or_default();
        }
        self.text_of(file).and_then(|text| nth(&text)).unwrap_or_default()
    }
}

/// Longest line of a script that is shown, in characters.
const LONGEST_LINE: usize = 100;

/// Scripts from a recipe if there is one, the rest from the disk; keeps the modules that were read.
struct SubjectHost {
    recipe: Recipe,
    others: SilentHost,
    modules: Mutex<Vec<(String, String)>>,
}

impl Host for SubjectHost {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let bytes = match self.recipe.files.iter().find(|(name, _)| name == path) {
            Some((_, text)) => text.clone().into_bytes(),
            None => self.others.read(path, max_bytes)?,
        };
        if path.ends_with(".rhai")
            && let Ok(text) = str::from_utf8(&bytes)
        {
            let mut modules = self.modules.lock().unwrap_or_else(PoisonError::into_inner);
            modules.push((path.to_owned(), text.to_owned()));
        }
        Ok(bytes)
    }

    fn should_stop(&self) -> bool {
        self.others.should_stop()
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.others.write_image(name, image)
    }
}

/// `scene.rhai:12:5`, as far as it is known.
pub(super) fn place(scene: &Scene, loc: SourceLoc) -> String {
    let file = scene.files.get(usize::from(loc.file)).map_or("", String::as_str);
    site(file, loc.line, u32::from(loc.column))
}

/// As [`place`].
pub(super) fn site(file: &str, line: u32, column: u32) -> String {
    match (line, column) {
        (0, _) => file.to_owned(),
        (line, 0) => format!("{file}:{line}"),
        (line, column) => format!("{file}:{line}:{column}"),
    }
}

/// What a script calls an object: `sphere`, `instance "car"`.
pub(super) fn name_of(scene: &Scene, object: &Object) -> String {
    match &object.geometry {
        Geometry::Instance(id) => {
            let name = scene.groups.get(id.index()).map_or("", |group| &group.name);
            format!("instance {name:?}")
        }
        other => other.name().to_owned(),
    }
}
