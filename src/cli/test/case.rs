//! The test of one scene.

use std::{fs, io, path::Path, sync::Arc, time::Instant};

use super::{
    difference::{scene_changes, source_changes},
    find::{picture_of, snapshot_of},
    outcome::{Case, Change, Fresh, Outcome, Reference},
};
use crate::{
    cli::{
        guard,
        host::{RecipeHost, SilentHost},
        input::Input,
        measures::Measures,
        signals::Signals,
        without_place,
    },
    diag::{Diagnostic, Error, ErrorKind},
    limits::Limits,
    output,
    parameters::Parameters,
    recipe::Recipe,
    render::Image,
    script::RunOptions,
    source,
    testing::{
        RenderedFile, Snapshot, changed_lines, changed_pixels, load_picture, name_alone, read_scene,
        render_text,
    },
};

/// Longest edge of a new snapshot's picture in pixels, unless `--size` says otherwise.
const LONGEST_EDGE: u32 = 320;

/// How scenes are tested.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    /// Largest mean FLIP error that passes.
    pub(super) tolerance: f64,
    /// What to put on record instead of what is there.
    pub(super) overrides: Parameters,
    /// Threads for one scene.
    pub(super) threads: usize,
    pub(super) signals: Arc<Signals>,
}

/// Runs, renders and compares one scene.
pub(super) fn test(scene: &Path, settings: &Settings) -> Case {
    let start = Instant::now();
    let outcome = guard::guarded(|| Test { scene, settings }.outcome());
    Case {
        name: Input::new(scene).name().replace('\\', "/"),
        path: scene.to_owned(),
        took: start.elapsed(),
        outcome: outcome.unwrap_or_else(|error| Outcome::Failed(Box::new(error))),
        accepted: false,
    }
}

struct Test<'a> {
    scene: &'a Path,
    settings: &'a Settings,
}

impl Test<'_> {
    fn outcome(&self) -> Result<Outcome, Error> {
        let expected = read_snapshot(self.scene)?;
        let text = read_scene(self.scene)?;
        let parameters = self.parameters(expected.as_ref(), &text)?;
        let rendered = self.render(&text, &parameters)?;
        let actual = Snapshot::of(&rendered, &parameters);
        let Some(expected) = expected else {
            return Ok(Outcome::New(Box::new(Fresh {
                recipe: recipe(&actual, &rendered),
                snapshot: actual,
                image: rendered.image,
            })));
        };
        if expected.guards(&actual) {
            return Ok(Outcome::Passed);
        }
        let pictures_differ = expected.hash != actual.hash;
        let change = self.change(expected, actual, rendered)?;
        let flip = change
            .reference
            .as_ref()
            .and_then(|reference| reference.measures.flip);
        let is_tolerated = pictures_differ
            && change.only_the_picture()
            && flip.is_some_and(|flip| flip <= self.settings.tolerance && self.settings.tolerance > 0.0);
        let change = Box::new(change);
        Ok(if is_tolerated {
            Outcome::Tolerated(change)
        } else {
            Outcome::Changed(change)
        })
    }

    /// What the scene is rendered with: what is on record, or for a new one what makes a small picture.
    fn parameters(&self, expected: Option<&Snapshot>, text: &str) -> Result<Parameters, Error> {
        let mut parameters =
            expected.map_or_else(Parameters::default, |expected| expected.parameters.clone());
        parameters = self.settings.overrides.clone().or(&parameters);
        if expected.is_none() && parameters.size.is_none() {
            let (name, options) = (name_alone(self.scene), self.options(&parameters));
            let run = source::load(&name, text, &self.host(), &Limits::default(), &options)?;
            let own = &run.value.scene.settings;
            parameters.size = smaller(own.width, own.height);
        }
        Ok(parameters)
    }

    fn host(&self) -> SilentHost {
        let input = Input::new(self.scene);
        SilentHost::new(input.folder(), Arc::clone(&self.settings.signals))
    }

    fn options(&self, parameters: &Parameters) -> RunOptions {
        let mut options = RunOptions::from(parameters);
        options.render.threads = self.settings.threads;
        options
    }

    fn render(&self, text: &str, parameters: &Parameters) -> Result<RenderedFile, Error> {
        let options = self.options(parameters);
        render_text(
            &name_alone(self.scene),
            text,
            &self.host(),
            &Limits::default(),
            &options,
        )
    }

    /// Looks into what is different.
    fn change(&self, expected: Snapshot, actual: Snapshot, rendered: RenderedFile) -> Result<Change, Error> {
        let reference = self.reference();
        let before = reference
            .as_ref()
            .and_then(|(_, recipe)| self.before(recipe.as_ref()?, &rendered, &expected));
        let reference = reference.map(|(image, _)| image);
        let pixels = match &reference {
            Some(reference) => changed_pixels(reference, &rendered.image),
            None => Vec::new(),
        };
        let lines = changed_lines(&rendered, before.as_ref(), &pixels)?;
        let scene = before
            .as_ref()
            .map(|before| scene_changes(&before.scene, &rendered.scene));
        let sources = before
            .as_ref()
            .map(|before| source_changes(&before.sources, &rendered.sources));
        Ok(Change {
            recipe: recipe(&actual, &rendered),
            expected,
            actual,
            reference: reference.map(|image| Reference {
                measures: Measures::of(&image, &rendered.image),
                image,
            }),
            actual_image: rendered.image,
            lines,
            scene: scene.unwrap_or_default(),
            sources: sources.unwrap_or_default(),
        })
    }

    /// The picture that the snapshot was taken of and what it carries, where one was kept.
    fn reference(&self) -> Option<(Image, Option<Recipe>)> {
        let path = picture_of(self.scene);
        let bytes = fs::read(&path).ok()?;
        let image = load_picture(&path).ok()?;
        Some((image, Recipe::of_png(&bytes)))
    }

    /// The scene as its scripts were when the snapshot was taken. Its pictures and models are those of now.
    fn before(&self, recipe: &Recipe, now: &RenderedFile, expected: &Snapshot) -> Option<RenderedFile> {
        let (_, text) = recipe.files.first()?;
        if recipe.hash != expected.hash || recipe.files == self::recipe(expected, now).files {
            return None;
        }
        let host = RecipeHost {
            recipe,
            others: self.host(),
        };
        let options = self.options(&expected.parameters);
        render_text(&name_alone(self.scene), text, &host, &Limits::default(), &options).ok()
    }
}

/// The size of a new snapshot's picture: `None` where the scene's own is small enough.
fn smaller(width: u32, height: u32) -> Option<(u32, u32)> {
    let longer = width.max(height);
    let scaled = |edge: u32| {
        let edge = u64::from(edge) * u64::from(LONGEST_EDGE) / u64::from(longer.max(1));
        u32::try_from(edge).unwrap_or(LONGEST_EDGE).max(1)
    };
    (longer > LONGEST_EDGE).then(|| (scaled(width), scaled(height)))
}

fn read_snapshot(scene: &Path) -> Result<Option<Snapshot>, Error> {
    let path = snapshot_of(scene);
    let shown = path.display().to_string();
    let broken = |line: u32, why: String| {
        let diagnostic = Diagnostic::error(ErrorKind::Input, format!("the snapshot cannot be read: {why}"));
        let hint = "rtscript test --accept writes it anew; first look with version control at who changed it";
        Error::from(diagnostic.at(&shown, line, 0).hint(hint))
    };
    match fs::read_to_string(&path) {
        Ok(text) => match Snapshot::parse(&text) {
            Ok(snapshot) => Ok(Some(snapshot)),
            Err((line, why)) => Err(broken(line, why)),
        },
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(broken(0, output::reason(&e))),
    }
}

/// What the reference picture is to carry.
fn recipe(snapshot: &Snapshot, rendered: &RenderedFile) -> Recipe {
    let mut recipe = Recipe {
        files: Vec::new(),
        ..Recipe::new("", "", &snapshot.parameters)
    };
    for (name, text) in &rendered.sources {
        recipe.add(name, text);
    }
    recipe.of_picture(snapshot.hash.clone())
}

/// Puts a scene on record as it is now.
///
/// # Errors
/// `Output` where a file cannot be written.
pub(super) fn accept(case: &mut Case, with_picture: bool) -> Result<(), Error> {
    let (snapshot, image, recipe) = match &case.outcome {
        Outcome::Changed(change) => (&change.actual, &change.actual_image, &change.recipe),
        Outcome::New(fresh) => (&fresh.snapshot, &fresh.image, &fresh.recipe),
        Outcome::Passed | Outcome::Tolerated(_) | Outcome::Failed(_) => return Ok(()),
    };
    let picture = picture_of(&case.path);
    if with_picture {
        let bytes = output::encode_png_with(image, recipe).map_err(|e| {
            Diagnostic::error(
                ErrorKind::Output,
                format!("cannot write '{}': {}", picture.display(), output::reason(&e)),
            )
        })?;
        output::write_atomically(&picture, &bytes).map_err(without_place)?;
    } else if picture.exists() {
        // The picture of another snapshot would be compared with.
        fs::remove_file(&picture).map_err(|e| {
            Diagnostic::error(
                ErrorKind::Output,
                format!("cannot remove '{}': {}", picture.display(), output::reason(&e)),
            )
        })?;
    }
    output::write_atomically(&snapshot_of(&case.path), snapshot.to_string().as_bytes())
        .map_err(without_place)?;
    case.accepted = true;
    Ok(())
}
