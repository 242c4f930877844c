//! `rtscript expand`: a scene as a flat script.

use std::{
    fmt, fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    args::ExpandArgs, host::SilentHost, input::Input, report::Reporter, signals::Signals, without_place,
};
use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind, Report},
    host::Host,
    limits::Limits,
    output,
    script::{Run, RunOptions},
    source,
};

/// Writes the scene that a script leaves behind as a script of one line for each entity.
///
/// A text that is not too long is read back, and a warning says if it is not the same scene.
///
/// # Errors
/// Whatever keeps the scene from being built; `Output` where the text cannot be written.
pub(super) fn expand(args: &ExpandArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    let input = Input::new(&args.file);
    let target = args.output.as_deref().filter(|path| *path != Path::new("-"));
    if let Some(path) = target {
        let inputs: Vec<PathBuf> = input.path().map(Path::to_owned).into_iter().collect();
        output::check_writable(path, &inputs).map_err(without_place)?;
    }
    let limits = Limits::default();
    let text = input.read_armed(&limits, signals)?;
    let host = SilentHost::new(input.folder(), Arc::clone(signals));
    let options = RunOptions::from(&args.overrides.parameters());
    let Report { value: run, warnings } = source::load(input.name(), &text, &host, &limits, &options)?;
    reporter.warnings(&warnings);
    if run.pictures.len() > 1 {
        let count = run.pictures.len();
        let message = format!("the scene renders {count} pictures; this is how it stands at its end");
        reporter.warnings(&[Diagnostic::warning(Code::InexactText, message).at(input.name(), 0, 0)]);
    }
    let mut kept = Kept::default();
    let places = !args.no_places;
    match target {
        Some(path) => to_file(path, &run, places, &mut kept)?,
        None => {
            let out = Sink::new(BufWriter::new(io::stdout().lock()), &mut kept);
            if let Err(e) = out.write(&run, places)
                && e.kind() != io::ErrorKind::BrokenPipe
            {
                let message = format!("cannot write to standard output: {}", output::reason(&e));
                return Err(Diagnostic::error(ErrorKind::Output, message).into());
            }
        }
    }
    reporter.warnings(&doubts(&run, &kept, &host, &limits));
    if let Some(path) = target
        && !run.files().is_empty()
        && !same_folder(path, input.folder())
    {
        let message = "the text names files relative to the scene's folder, and does not lie there";
        let folder = input.folder().display();
        let hint = format!("put it into '{folder}' to render it");
        reporter.warnings(&[Diagnostic::warning(Code::InexactText, message).hint(hint)]);
    }
    Ok(())
}

/// What keeps the text from being rendered to the same picture.
fn doubts(run: &Run, kept: &Kept, host: &dyn Host, limits: &Limits) -> Vec<Diagnostic> {
    let (bytes, limit) = (kept.bytes, limits.source_bytes);
    if bytes > limit {
        let message =
            format!("the text has {bytes} bytes, and a script at most {limit}: the limit 'source_bytes'");
        let hint = "it can be read, searched and compared, but not rendered";
        return vec![Diagnostic::warning(Code::InexactText, message).hint(hint)];
    }
    let Some(text) = kept.text() else {
        return Vec::new();
    };
    match source::load("expanded.rhai", text, host, limits, &RunOptions::default()) {
        Ok(again) if again.value.scene.hash() == run.scene.hash() => Vec::new(),
        Ok(_) => vec![Diagnostic::warning(
            Code::InexactText,
            "the text gives a scene of another hash: calls of the script failed and left something behind, zeros changed \
             their sign, or a file has changed",
        )],
        Err(error) => vec![
            Diagnostic::warning(
                Code::InexactText,
                format!("the text cannot be rendered: {}", error.diagnostic.message),
            )
            .hint("it can be read, searched and compared"),
        ],
    }
}

fn same_folder(file: &Path, folder: &Path) -> bool {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    let whole = |path: &Path| fs::canonicalize(path).ok();
    whole(parent.unwrap_or(Path::new("."))) == whole(folder)
}

fn to_file(path: &Path, run: &Run, places: bool, kept: &mut Kept) -> Result<(), Error> {
    output::write_atomically_with(path, |file| {
        Sink::new(BufWriter::new(file), kept).write(run, places)
    })
    .map_err(without_place)
}

/// Bytes of a text up to which it is read back.
const READ_BACK: usize = 16 << 20;

/// The beginning of what is written.
#[derive(Default)]
struct Kept {
    text: String,
    /// Bytes written in all.
    bytes: usize,
}

impl Kept {
    fn add(&mut self, text: &str) {
        self.bytes += text.len();
        if self.bytes <= READ_BACK {
            self.text.push_str(text);
        } else {
            self.text = String::new();
        }
    }

    /// All that was written, where it is not too much.
    fn text(&self) -> Option<&str> {
        (self.bytes <= READ_BACK).then_some(&self.text)
    }
}

/// Text on its way to a file, which remembers why it could not be written.
struct Sink<'a, W> {
    out: W,
    kept: &'a mut Kept,
    error: Option<io::Error>,
}

impl<'a, W: Write> Sink<'a, W> {
    fn new(out: W, kept: &'a mut Kept) -> Self {
        Self {
            out,
            kept,
            error: None,
        }
    }

    fn write(mut self, run: &Run, places: bool) -> io::Result<()> {
        // What keeps it from being written is in `error`.
        let _ = run.write_source(places, &mut self);
        match self.error {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}

impl<W: Write> fmt::Write for Sink<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.kept.add(text);
        self.out.write_all(text.as_bytes()).map_err(|e| {
            self.error = Some(e);
            fmt::Error
        })
    }
}
