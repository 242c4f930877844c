//! `rtscript watch`: renders a scene whenever it or a file that it reads changes.

mod files;
mod host;
mod screen;
mod terminal;

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU8, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use self::{files::Files, host::WatchHost, screen::Screen, terminal::Terminal};
use super::{
    args::WatchArgs,
    guard,
    host::CliHost,
    input::Input,
    job::Target,
    progress::ProgressLine,
    report::{self, Reporter, shortened},
    signals::Signals,
    stats, stopped_by, without_place,
};
use crate::{
    diag::{Diagnostic, Error, ErrorKind, Report},
    import::KeptAssets,
    limits::Limits,
    parameters::Parameters,
    recipe::Recipe,
    render::{Image, KeptTrees, render},
    script::{Picture, RunOptions},
    source,
};

/// Time between two looks at what may happen.
const INTERVAL: Duration = Duration::from_millis(4);
/// An error is told when no file changed for so long: what is wrong with a half-written file is no error.
const CALM: Duration = Duration::from_millis(150);

/// Watches until a signal comes or `q` is typed, and returns the exit code.
///
/// # Errors
/// Before the first render: where there is no such scene, or its picture cannot be written.
pub(super) fn watch(args: &WatchArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<u8, Error> {
    let input = Input::new(&args.file);
    let Some(path) = input.path().map(Path::to_owned) else {
        let what = "standard input cannot be watched: it is read only once";
        return Err(Diagnostic::error(ErrorKind::Input, what).into());
    };
    check_kind(&input, &path)?;
    let target = match &args.output {
        Some(output) => Target::Given(output.clone()),
        None => Target::Default(input.picture_name(None)),
    };
    if matches!(target, Target::Given(_)) {
        target.check(std::slice::from_ref(&path)).map_err(without_place)?;
    }
    // A name that leads nowhere now is a slip; once it led somewhere, the file may come back.
    if !path.exists() {
        input.bytes(&Limits::default())?;
    }
    signals.arm(true);
    let parameters = args.overrides.parameters();
    let mut options = RunOptions::from(&parameters);
    options.render.threads = args.threads.count();
    options.render.trees = Some(KeptTrees::new());
    options.assets = Some(KeptAssets::new());
    let screen = Terminal::take(args.pictures).map(Screen::new);
    let shows = screen.is_some();
    if let Some(screen) = &screen {
        options.render.coarse = true;
        signals.before_the_end(Some(screen.terminal().rescue()));
    }
    let session = Session {
        input,
        path,
        target,
        parameters,
        with_recipe: !args.no_recipe,
        options,
        reporter,
        signals: Arc::clone(signals),
        screen,
        files: Mutex::default(),
        asked: AtomicU8::new(NOTHING),
        good: Mutex::default(),
    };
    let code = session.watch();
    signals.before_the_end(None);
    let last = session.good().take();
    // The screen goes before the line that stays.
    drop(session);
    if let Some(good) = last.filter(|_| shows) {
        good.lines.iter().for_each(|line| reporter.line(line));
    }
    Ok(code)
}

/// Refuses what can be read only once, or never ends.
fn check_kind(input: &Input, path: &Path) -> Result<(), Error> {
    if path.exists() && !path.is_file() {
        let what = format!("cannot watch '{}': it is not a regular file", input.name());
        return Err(Diagnostic::error(ErrorKind::Input, what).into());
    }
    Ok(())
}

/// Nobody asked for anything; for another render; for the end.
const NOTHING: u8 = 0;
const AGAIN: u8 = 1;
const QUIT: u8 = 2;

/// A scene that is watched.
struct Session {
    input: Input,
    path: PathBuf,
    target: Target,
    parameters: Parameters,
    with_recipe: bool,
    options: RunOptions,
    reporter: Reporter,
    signals: Arc<Signals>,
    /// `None` where there is no terminal to draw in.
    screen: Option<Screen>,
    files: Mutex<Files>,
    /// What was asked for by a key: [`NOTHING`], [`AGAIN`] or [`QUIT`].
    asked: AtomicU8,
    good: Mutex<Option<Good>>,
}

/// The last run that went well.
struct Good {
    image: Image,
    /// What was written.
    lines: Vec<String>,
}

/// How a run ended.
#[derive(PartialEq)]
enum Ended {
    /// Its outcome is shown.
    Shown,
    /// It was cut short, and the next one can begin.
    Cut,
}

impl Session {
    fn watch(&self) -> u8 {
        let mut watched = String::new();
        loop {
            let ended = self.run();
            let files = self.watched();
            if self.screen.is_none() && ended == Ended::Shown && files != watched {
                self.reporter.line(&format!("watching {files}"));
                watched = files;
            }
            if let Some(code) = self.wait(&ended) {
                return code;
            }
        }
    }

    /// Waits until there is reason to render again, or to end with a code.
    fn wait(&self, ended: &Ended) -> Option<u8> {
        loop {
            if let Some(signal) = self.signals.caught() {
                return Some(stopped_by(signal));
            }
            if self.is_asked() {
                return (self.asked.swap(NOTHING, Ordering::Relaxed) == QUIT).then_some(0);
            }
            let is_cut = *ended == Ended::Cut;
            if is_cut || self.files().is_changed() {
                let is_another = self.files().settle(|| self.signals.caught().is_some());
                if is_cut || is_another {
                    return None;
                }
            }
            if let Some(screen) = &self.screen {
                screen.refresh();
            }
            thread::sleep(INTERVAL);
        }
    }

    /// Whether a key asks for something.
    fn is_asked(&self) -> bool {
        if let Some(screen) = &self.screen {
            for key in screen.terminal().typed() {
                match key {
                    b'q' | b'Q' => self.asked.store(QUIT, Ordering::Relaxed),
                    b' ' => _ = self.asked.fetch_max(AGAIN, Ordering::Relaxed),
                    _ => {}
                }
            }
        }
        self.asked.load(Ordering::Relaxed) != NOTHING
    }

    /// Renders once, and shows what came of it.
    fn run(&self) -> Ended {
        self.files().begin();
        let start = Instant::now();
        let (mut printed, mut host) = (Vec::new(), None);
        let made = guard::guarded(|| {
            let text = self.read()?;
            let host = host.insert(self.host(&text));
            self.make(host, &text)
        });
        if let Some(host) = host {
            host.inner.clear_progress();
            printed = host.take_printed();
        }
        match made {
            Ok(made) => {
                self.files().complete();
                self.show(made, printed, start.elapsed());
            }
            Err(_) if self.signals.caught().is_some() || self.is_asked() => return Ended::Cut,
            Err(error) if error.kind() == ErrorKind::Cancelled => return Ended::Cut,
            Err(error) => {
                while self.files().quiet_for() < CALM {
                    if self.files().is_changed() || self.signals.caught().is_some() {
                        return Ended::Cut;
                    }
                    thread::sleep(INTERVAL);
                }
                self.show_error(&error, printed, start.elapsed());
            }
        }
        Ended::Shown
    }

    /// The text of the scene.
    fn read(&self) -> Result<String, Error> {
        let limits = Limits::default();
        self.files().asked(&self.path);
        check_kind(&self.input, &self.path)?;
        let bytes = self.input.bytes(&limits)?;
        self.files().read(&self.path, &bytes);
        source::text(self.input.name(), bytes, &limits)
    }

    fn host(&self, text: &str) -> WatchHost<'_> {
        let recipe = || Recipe::new(&self.input.short_name(), text, &self.parameters);
        let inner = CliHost::new(
            &self.input,
            Arc::clone(&self.signals),
            ProgressLine::new(self.screen.is_none() && self.reporter.is_for_people()),
            false,
            self.with_recipe.then(recipe),
            (self.reporter, text),
        );
        WatchHost::new(self, inner)
    }

    /// Runs the scene, renders it, writes its pictures: as `rtscript render` does, but for pictures that the script
    /// names, which are written when all has gone well.
    fn make(&self, host: &WatchHost<'_>, text: &str) -> Result<Made, Error> {
        let Report { value: run, warnings } =
            source::load(self.input.name(), text, host, &Limits::default(), &self.options)?;
        let mut made = Made {
            pictures: run.pictures,
            warnings,
            written: None,
        };
        let named = made.pictures.iter().any(|picture| picture.name.is_some());
        let check = || self.target.check(&host.inner.inputs()).map_err(without_place);
        if made.pictures.is_empty() {
            check()?;
            let rendered = render(&run.scene, &self.options.render, host)?;
            made.warnings.extend(rendered.warnings);
            made.pictures.push(Picture {
                name: None,
                image: rendered.value.image,
                stats: rendered.value.stats,
            });
        }
        let Some(last) = made.pictures.last() else {
            return Ok(made);
        };
        if let Some(screen) = &self.screen {
            screen.picture(
                &last.image,
                self.status("", Some(&last.image), host.start.elapsed()),
            );
        }
        if !(named && matches!(self.target, Target::Default(_))) {
            check()?;
            let recipe = host.inner.recipe_of(&last.image);
            self.target
                .write(&last.image, recipe.as_ref())
                .map_err(without_place)?;
            made.written = Some(self.target.name());
        }
        host.write_pictures().map_err(without_place)?;
        Ok(made)
    }

    /// Shows what a run has made.
    fn show(&self, made: Made, printed: Vec<String>, took: Duration) {
        let Made {
            mut pictures,
            warnings,
            written,
        } = made;
        let named = pictures
            .iter()
            .filter_map(|picture| Some((picture.name.clone()?, picture)));
        let written = written.zip(pictures.last());
        let lines = named.chain(written).map(|(path, picture)| {
            let time = match pictures.len() {
                1 => took,
                _ => picture.stats.compile + picture.stats.trace,
            };
            stats::picture_line(&path, &picture.image, time, &picture.stats)
        });
        let lines: Vec<String> = lines.collect();
        let Some(last) = pictures.pop() else { return };
        match &self.screen {
            Some(screen) => {
                let messages = warnings.iter().map(report::colored).chain(printed).collect();
                screen.say(self.status("", Some(&last.image), took), messages, false);
            }
            None => {
                self.reporter.warnings(&warnings);
                lines.iter().for_each(|line| self.reporter.line(line));
            }
        }
        *self.good() = Some(Good {
            image: last.image,
            lines,
        });
    }

    /// Shows what is wrong, with the last good picture.
    fn show_error(&self, error: &Error, printed: Vec<String>, took: Duration) {
        let Some(screen) = &self.screen else {
            return self.reporter.error(error);
        };
        let status = self.status("error: this is the last good picture", None, took);
        if let Some(good) = &*self.good() {
            screen.picture(&good.image, status.clone());
        }
        let messages = std::iter::once(&*error.diagnostic)
            .chain(&error.warnings)
            .map(report::colored);
        screen.say(status, messages.chain(printed).collect(), true);
    }

    /// `scene.rhai  coarse  80x60  35 ms  watching scene.rhai, ball.obj`
    fn status(&self, stage: &str, image: Option<&Image>, took: Duration) -> String {
        let mut text = shortened(self.input.name());
        if !stage.is_empty() {
            let _ = write!(text, "  {stage}");
        }
        if let Some(image) = image {
            let _ = write!(text, "  {}x{}", image.width(), image.height());
        }
        let _ = write!(text, "  {}  watching {}", stats::time(took), self.watched());
        text
    }

    /// The files that are watched, or some of them and how many more.
    fn watched(&self) -> String {
        const NAMED: usize = 5;
        let files = self.files();
        let others = || files.names().filter(|path| *path != self.path);
        let names = others().take(NAMED).map(|path| {
            let path = path.strip_prefix(".").unwrap_or(path);
            shortened(&path.display().to_string())
        });
        let names = std::iter::once(shortened(self.input.name())).chain(names);
        let mut text = names.collect::<Vec<_>>().join(", ");
        if let more @ 1.. = others().count().saturating_sub(NAMED) {
            let _ = write!(text, " and {more} more");
        }
        text
    }

    fn files(&self) -> MutexGuard<'_, Files> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn good(&self) -> MutexGuard<'_, Option<Good>> {
        self.good.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a run has made.
struct Made {
    pictures: Vec<Picture>,
    warnings: Vec<Diagnostic>,
    /// The file that the last picture was written to.
    written: Option<String>,
}
