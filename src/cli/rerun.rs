//! `rtscript rerun` and `rtscript verify`: pictures that carry what they were made from.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    args::{RerunArgs, VerifyArgs},
    host::{RecipeHost, SilentHost},
    input::Input,
    input::why_unreadable,
    report::Reporter,
    signals::Signals,
    without_place, write_stdout,
};
use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind},
    limits::Limits,
    output,
    parameters::Parameters,
    recipe::Recipe,
    render::Image,
    script::RunOptions,
    testing::{from_rgb8, render_text},
};

/// Most bytes of a picture file that are read.
const MOST_BYTES: u64 = 1 << 30;

/// Renders the recipe of a picture again, with what the arguments decide otherwise, and writes the new picture.
///
/// # Errors
/// `Input` where there is no recipe; whatever keeps it from being rendered; `Output`.
pub(super) fn rerun(args: &RerunArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    let (recipe, _) = read(&args.file)?;
    if args.print {
        return write_stdout(recipe.to_text().as_bytes()).map_err(without_place);
    }
    let target = args.output.clone().unwrap_or_else(|| {
        let stem = args.file.file_stem().unwrap_or("out".as_ref()).to_string_lossy();
        PathBuf::from(format!("{stem}-rerun.png"))
    });
    output::check_target(&target, std::slice::from_ref(&args.file)).map_err(without_place)?;
    let parameters = args.overrides.parameters().or(&recipe.parameters);
    let again = Again {
        recipe: &recipe,
        assets: args.assets.as_deref(),
        file: &args.file,
        threads: args.threads.count(),
    };
    let (image, warnings) = again.render(&parameters, signals)?;
    reporter.warnings(&warnings);
    let recipe = Recipe {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        parameters,
        ..recipe.of_picture(image.hash())
    };
    output::save_with(&target, &image, &recipe).map_err(without_place)?;
    let (width, height) = (image.width(), image.height());
    reporter.line(&format!(
        "{}  {width}x{height}  {}",
        target.display(),
        recipe.hash
    ));
    Ok(())
}

/// Says of each picture whether its pixels are those of its recipe, and whether the recipe gives them again.
///
/// # Errors
/// `Script` where they are not; as [`rerun`] otherwise.
pub(super) fn verify(args: &VerifyArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    for file in &args.files {
        let shown = file.display();
        let (recipe, bytes) = read(file)?;
        let differs = |what: String, hint: &str| -> Error {
            Diagnostic::error(ErrorKind::Script, what).hint(hint).into()
        };
        let pixels = decode(file, &bytes)?.hash();
        if pixels != recipe.hash {
            return Err(differs(
                format!(
                    "'{shown}' was changed after it was rendered: its pixels have the hash {pixels}, its recipe says {}",
                    recipe.hash
                ),
                "rtscript rerun renders it as it was",
            ));
        }
        let again = Again {
            recipe: &recipe,
            assets: args.assets.as_deref(),
            file,
            threads: args.threads.count(),
        };
        let (image, _) = again.render(&recipe.parameters, signals)?;
        let hash = image.hash();
        if hash != recipe.hash {
            let (then, now) = (&recipe.version, env!("CARGO_PKG_VERSION"));
            return Err(differs(
                format!(
                    "rendering '{shown}' again gives the hash {hash}, not {}",
                    recipe.hash
                ),
                &format!(
                    "it was made by rtscript {then}, and this is {now}; a picture or a model that it reads may also \
                     have changed"
                ),
            ));
        }
        reporter.line(&format!("{shown}: verified, {hash}"));
    }
    Ok(())
}

/// A recipe, rendered again.
struct Again<'a> {
    recipe: &'a Recipe,
    assets: Option<&'a Path>,
    file: &'a Path,
    threads: usize,
}

impl Again<'_> {
    /// The picture that has the recipe's hash if there is one, otherwise the last; and the warnings.
    fn render(
        &self,
        parameters: &Parameters,
        signals: &Arc<Signals>,
    ) -> Result<(Image, Vec<Diagnostic>), Error> {
        let Some((name, text)) = self.recipe.files.first() else {
            return Err(no_recipe(self.file));
        };
        let input = Input::new(self.file);
        let folder = self.assets.unwrap_or(input.folder());
        signals.arm(true);
        let host = RecipeHost {
            recipe: self.recipe,
            others: SilentHost::new(folder, Arc::clone(signals)),
        };
        let mut options = RunOptions::from(parameters);
        options.render.threads = self.threads;
        let rendered = render_text(name, text, &host, &Limits::default(), &options)?;
        let earlier = rendered.earlier.into_iter().map(|picture| picture.image);
        let same = earlier.into_iter().find(|image| image.hash() == self.recipe.hash);
        Ok((same.unwrap_or(rendered.image), rendered.warnings))
    }
}

/// The recipe of a picture file, and the file's bytes.
pub(super) fn read(path: &Path) -> Result<(Recipe, Vec<u8>), Error> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut bytes))
        .map_err(|e| {
            let (path, why) = (path.display(), why_unreadable(&e));
            Diagnostic::error(ErrorKind::Input, format!("cannot read '{path}': {why}"))
                .class(Code::UnreadableFile)
        })?;
    match Recipe::of_png(&bytes) {
        Some(recipe) => Ok((recipe, bytes)),
        None => Err(no_recipe(path)),
    }
}

fn decode(path: &Path, bytes: &[u8]) -> Result<Image, Error> {
    let decoded = image::load_from_memory(bytes).map_err(|e| {
        Diagnostic::error(
            ErrorKind::Input,
            format!("'{}' is no picture: {e}", path.display()),
        )
    })?;
    let pixels = decoded.to_rgb8();
    Ok(from_rgb8(pixels.width(), pixels.height(), pixels.as_raw()))
}

pub(super) fn no_recipe(path: &Path) -> Error {
    Diagnostic::error(
        ErrorKind::Input,
        format!("'{}' carries no recipe", path.display()),
    )
    .hint("rtscript writes one into every PNG unless --no-recipe is given; programs that edit pictures leave it out")
    .into()
}
