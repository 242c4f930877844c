//! `rtscript sweep`: one script with many values of its parameters.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    args::SweepArgs, host::SilentHost, input::Input, report::Reporter, sheet::sheet, signals::Signals, stats,
    without_place,
};
use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    limits::Limits,
    output,
    parameters::Parameters,
    recipe::Recipe,
    render::Image,
    script::RunOptions,
    testing::render_text,
};

/// Most pictures of one sweep.
const MOST: usize = 10_000;

/// Renders the script once for each combination of values, the last parameter changing fastest, and writes each
/// picture, or with `--grid` all of them on one sheet.
///
/// # Errors
/// `Input` where there are too many combinations; whatever keeps one from being rendered or written, with its values.
pub(super) fn sweep(args: &SweepArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    let input = Input::new(&args.file);
    let stem = input.picture_name(None);
    let stem = stem
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let count = args
        .define
        .iter()
        .try_fold(1usize, |n, (_, values)| n.checked_mul(values.len()));
    let Some(count) = count.filter(|count| *count <= MOST) else {
        let message =
            format!("a sweep makes at most {MOST} pictures, and these are more combinations of values");
        return Err(Diagnostic::error(ErrorKind::Input, message)
            .hint("give fewer values")
            .into());
    };
    let target = Target::new(args, &stem, &input)?;
    let text = input.read_armed(&Limits::default(), signals)?;

    let mut pictures = Vec::new();
    for number in 0..count {
        let (parameters, label) = combination(args, number)?;
        let host = SilentHost::new(input.folder(), Arc::clone(signals));
        let mut options = RunOptions::from(&parameters);
        options.render.threads = args.threads.count();
        let rendered = render_text(input.name(), &text, &host, &Limits::default(), &options);
        let rendered = rendered.map_err(|mut e| {
            e.diagnostic.notes.push(format!("with {label}"));
            e
        })?;
        if let Target::Files(folder) = &target {
            let mut recipe = Recipe::new(&input.short_name(), &text, &parameters);
            for (name, text) in rendered.sources.iter().skip(1) {
                recipe.add(name, text);
            }
            let path = folder.join(format!("{stem} {label}.png"));
            let recipe = recipe.of_picture(rendered.image.hash());
            output::save_with(&path, &rendered.image, &recipe).map_err(without_place)?;
            reporter.line(&format!("{}  {}", path.display(), recipe.hash));
        } else {
            pictures.push((rendered.image, label));
        }
    }
    if let Target::Grid(path) = &target {
        let image = sheet(&pictures, columns(args, &pictures));
        output::save(path, &image).map_err(without_place)?;
        let size = format!("{}x{}", image.width(), image.height());
        reporter.line(&format!(
            "{}  {size}  {}",
            path.display(),
            stats::pictures(pictures.len())
        ));
    }
    Ok(())
}

/// Where pictures go.
enum Target {
    /// Each into this folder.
    Files(PathBuf),
    /// All into this file.
    Grid(PathBuf),
}

impl Target {
    fn new(args: &SweepArgs, stem: &str, input: &Input) -> Result<Self, Error> {
        if !args.grid {
            let folder = args.output.clone().unwrap_or_else(|| PathBuf::from("."));
            if !folder.is_dir() {
                let message = format!("'{}' is no folder that exists", folder.display());
                return Err(Diagnostic::error(ErrorKind::Output, message)
                    .hint("-o names the folder for the pictures, or with --grid the file for all of them")
                    .into());
            }
            return Ok(Self::Files(folder));
        }
        let path = args
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from(format!("{stem}-sweep.png")));
        let own: Vec<PathBuf> = input.path().map(Path::to_owned).into_iter().collect();
        output::check_target(&path, &own).map_err(without_place)?;
        Ok(Self::Grid(path))
    }
}

/// The values of one combination: as parameters, and those that change as text.
fn combination(args: &SweepArgs, number: usize) -> Result<(Parameters, String), Error> {
    let mut parameters = Parameters::default();
    (parameters.size, parameters.samples) = (args.size, args.samples);
    let mut rest = number;
    let mut labels = Vec::new();
    for (name, values) in args.define.iter().rev() {
        let Some(value) = values.get(rest % values.len().max(1)) else {
            continue;
        };
        rest /= values.len();
        parameters.set(name, value).map_err(|message| {
            Diagnostic::error(ErrorKind::Input, format!("-D {name}={value}: {message}"))
        })?;
        if values.len() > 1 {
            labels.push(format!("{name}={value}"));
        }
    }
    labels.reverse();
    Ok((parameters, labels.join(" ")))
}

/// Pictures in a row: as many as the last parameter that changes has values, where others change, too; otherwise what
/// makes the sheet about square.
fn columns(args: &SweepArgs, pictures: &[(Image, String)]) -> u32 {
    let changing: Vec<usize> = args
        .define
        .iter()
        .map(|(_, values)| values.len())
        .filter(|n| *n > 1)
        .collect();
    if let [_, .., last] = changing[..] {
        return last as u32;
    }
    let (width, height) = pictures
        .first()
        .map_or((1, 1), |(image, _)| (image.width(), image.height()));
    let rooms = |columns: &u32| {
        let rows = (pictures.len() as u32).div_ceil(*columns);
        (u64::from(columns * width)).max(u64::from(rows * height))
    };
    (1..=pictures.len().max(1) as u32).min_by_key(rooms).unwrap_or(1)
}
