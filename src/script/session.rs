//! What one run of a script works on.

use std::{cell::RefCell, collections::BTreeMap, sync::Arc, time::Duration};

use rhai::{ImmutableString, Module, Position};

use super::{
    Picture, RunOptions,
    api::{Queries, Stream},
    clock::Clock,
    language::Language,
    link::Remote,
    timed::{Timed, Timer},
    value::{Outcome, ScriptError},
};
use crate::{
    diag::{Diagnostic, ErrorKind, SourceLoc},
    host::{Host, resolve},
    import::{AssetCache, Assets},
    limits::Limits,
    parameters::Declared,
    render::Spent,
    scene::{Builder, Region},
};

/// A source file of the run.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// As messages name it.
    pub(crate) name: String,
    /// As the host knows it; empty for the script itself, whose folder is the host's root.
    pub(crate) host_path: String,
    /// Its text.
    pub(crate) text: Arc<str>,
}

/// Looks for one of the calls that stand in the same place of a script.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    /// The place.
    pub(super) loc: SourceLoc,
    /// The call with this number, from 1, ends the run. Where there is none, whatever such a call makes has the call's
    /// number in place of a line.
    pub(super) last: Option<u32>,
    /// Calls so far.
    pub(super) count: u32,
}

/// Lines of a text, a bit for each.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines(Vec<u64>);

impl Lines {
    /// None of the lines of `text`.
    fn of(text: &str) -> Self {
        Self(vec![0; text.lines().count() / 64 + 1])
    }

    #[inline]
    fn insert(&mut self, line: usize) {
        if let Some(bits) = self.0.get_mut(line / 64) {
            *bits |= 1 << (line % 64);
        }
    }

    /// Whether the line, counted from 1, is among them.
    pub(super) fn contains(&self, line: usize) -> bool {
        self.0
            .get(line / 64)
            .is_some_and(|bits| bits >> (line % 64) & 1 == 1)
    }
}

/// Everything scene functions change.
pub(crate) struct State {
    pub(crate) builder: Builder,
    pub(crate) limits: Limits,
    /// What its modules may call, too.
    pub(super) language: Language,
    pub(crate) host: Remote,
    pub(crate) random: Stream,
    /// Where the first call of a scene function stands: the edition may only be chosen there.
    pub(crate) first: Option<SourceLoc>,
    /// The next call is looked at more closely: it is the first, or calls are watched.
    look_closer: bool,
    /// Lines of the script from which scene functions were called.
    pub(super) ran: Lines,
    /// Calls that are watched.
    watch: Option<Watch>,
    /// The run ended at the call that was looked for.
    pub(super) found_call: bool,
    /// Settings the caller has decided; the script's own calls do not change them.
    pub(crate) size: Option<(u32, u32)>,
    pub(crate) samples: Option<u32>,
    pub(crate) seed: Option<u64>,
    pub(crate) region: Option<Region>,
    /// Pictures are one pixel, which is as good as any other to a run of which only the scene counts.
    pub(crate) dry: bool,
    /// Values that the caller gives to parameters of the script.
    pub(crate) given: BTreeMap<String, String>,
    /// Parameters that the script declared, in order.
    pub(crate) parameters: Vec<Declared>,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) warnings: Vec<Diagnostic>,
    /// Source files, the script first.
    pub(crate) sources: Vec<Source>,
    /// Index into `sources` of the file of the current call, and its number in the scene.
    current: usize,
    current_file: u16,
    /// The engine's own name of that file, by which it is known without a look at its letters.
    current_name: ImmutableString,
    /// Modules by host path, run once each.
    pub(crate) modules: BTreeMap<String, Arc<Module>>,
    /// Host paths of the modules being loaded, outermost first.
    pub(crate) loading: Vec<String>,
    /// Meshes and textures by host path, and the count of files.
    pub(crate) assets: AssetCache,
    pub(super) printed: usize,
    /// What ended the run.
    pub(crate) ended: Option<Box<ScriptError>>,
    /// The call that did, where the script came to its end before anybody looked.
    pub(crate) ended_at: Position,
    /// Worlds that the script asks where its things are.
    pub(super) queries: Queries,
    /// Since the run began.
    clock: Clock,
    /// The script's time in what it asks for.
    pub(crate) timer: Timer,
    /// Time spent rendering, which does not count as the script's.
    pub(crate) rendering: Duration,
    /// What its pictures took of the limits on renders.
    pub(crate) spent: Spent,
}

impl State {
    /// The state at the start of a script.
    pub(super) fn new(
        main: Source,
        limits: &Limits,
        options: &RunOptions,
        host: Remote,
        watch: Option<Watch>,
    ) -> Self {
        let mut builder = Builder::with_limits(limits.clone());
        let current_file = builder.file(&main.name);
        Self {
            builder,
            limits: limits.clone(),
            language: Language::new(),
            host,
            random: Stream::new(options.seed.unwrap_or(0)),
            first: None,
            ran: Lines::of(&main.text),
            look_closer: true,
            watch,
            found_call: false,
            size: options.size,
            samples: options.samples,
            seed: options.seed,
            region: options.region,
            dry: options.dry,
            given: options.parameters.clone(),
            parameters: Vec::new(),
            pictures: Vec::new(),
            warnings: Vec::new(),
            sources: vec![main],
            current: 0,
            current_file,
            current_name: ImmutableString::new(),
            modules: BTreeMap::new(),
            loading: Vec::new(),
            assets: AssetCache::keeping(options.assets.clone()),
            printed: 0,
            ended: None,
            ended_at: Position::NONE,
            queries: Queries::default(),
            clock: Clock::start(),
            timer: Timer::new(),
            rendering: Duration::ZERO,
            spent: Spent::default(),
        }
    }

    /// What is left of the time that the script may run.
    pub(crate) fn time_left(&self) -> Duration {
        let spent = self.clock.elapsed().saturating_sub(self.rendering);
        self.limits.script_time.saturating_sub(spent)
    }

    /// The host, until the script's time is over.
    pub(crate) fn timed_host(&self) -> Timed {
        self.timer.set(self.time_left());
        self.timer.host(&self.host)
    }

    /// The error where nothing is left of it.
    #[cold]
    pub(crate) fn too_long(&self) -> Box<ScriptError> {
        let value = format!("{:?}", self.limits.script_time);
        limit("the script runs too long", "script_time", value)
    }

    /// The error of what [`State::timed_host`] stopped.
    #[cold]
    pub(crate) fn stopped(&self) -> Box<ScriptError> {
        if self.host.should_stop() {
            return ScriptError::of_kind(ErrorKind::Cancelled, "the run was stopped");
        }
        self.too_long()
    }

    /// Notes a call of a scene function and where it stands.
    ///
    /// # Errors
    /// Where the run is watched and was to go no further than here.
    #[inline]
    pub(super) fn called(&mut self, source: Option<&ImmutableString>, pos: Position) -> Outcome<()> {
        self.at(source, pos);
        if self.current == 0 {
            self.ran.insert(pos.line().unwrap_or(0));
        }
        if self.look_closer {
            return self.look_closer();
        }
        Ok(())
    }

    #[cold]
    fn look_closer(&mut self) -> Outcome<()> {
        let loc = self.builder.loc();
        self.first.get_or_insert(loc);
        let Some(watch) = &mut self.watch else {
            self.look_closer = false;
            return Ok(());
        };
        if loc != watch.loc {
            return Ok(());
        }
        watch.count += 1;
        if watch.last == Some(watch.count) {
            let here = ScriptError::new("the call that was looked for");
            self.ended = Some(here.clone());
            self.found_call = true;
            return Err(here);
        }
        self.builder.set_loc(SourceLoc {
            line: watch.count,
            column: 0,
            file: u16::MAX,
        });
        Ok(())
    }

    /// Notes where the script calls from.
    #[inline]
    pub(super) fn at(&mut self, source: Option<&ImmutableString>, pos: Position) {
        if let Some(name) = source
            && !name.ptr_eq(&self.current_name)
        {
            self.change_source(name);
        }
        self.builder.set_loc(SourceLoc {
            line: pos.line().unwrap_or(0) as u32,
            column: pos.position().unwrap_or(0) as u16,
            file: self.current_file,
        });
    }

    #[cold]
    fn change_source(&mut self, name: &ImmutableString) {
        if let Some(i) = self.sources.iter().position(|s| s.name == **name) {
            self.current = i;
            self.current_file = self.builder.file(name);
            self.current_name = name.clone();
        }
    }

    /// The host's path of a file that the current source names.
    pub(crate) fn host_path(&self, path: &str) -> String {
        let named_in = self
            .sources
            .get(self.current)
            .map_or("", |s| s.host_path.as_str());
        resolve(named_in, path)
    }

    /// The script file at `host_path`, counted as every file is.
    pub(crate) fn read_script(&mut self, host_path: &str) -> Outcome<Vec<u8>> {
        let most = self.limits.source_bytes as u64;
        let mut limits = self.limits.clone();
        limits.file_bytes = limits.file_bytes.min(most);
        let bytes = Assets::new(&self.host, &limits, &mut self.assets).read(host_path);
        bytes.map_err(|error| {
            if error.kind == ErrorKind::Limit
                && error.message.contains("'file_bytes'")
                && most < self.limits.file_bytes
            {
                return limit(&format!("'{host_path}' is too large"), "source_bytes", most);
            }
            ScriptError::from_file(error)
        })
    }

    /// Prints a line, as long as the budget lasts.
    fn print(&mut self, text: &str) {
        self.printed = self.printed.saturating_add(text.len() + 1);
        if self.printed <= self.limits.print_bytes {
            self.host.print(text);
        }
    }
}

/// An error that names a limit and its value.
#[cold]
pub(crate) fn limit(what: &str, name: &str, value: impl std::fmt::Display) -> Box<ScriptError> {
    ScriptError::of_kind(ErrorKind::Limit, format!("{what}: the limit '{name}' is {value}"))
}

thread_local! {
    /// The run of this thread. A thread runs one script at a time, so its state is shared with nobody: a scene
    /// function takes it without a lock.
    static RUN: RefCell<Option<Box<State>>> = const { RefCell::new(None) };
}

/// Runs `f` on the state of the script that this thread runs; `None` where it runs none, or where `f` would be
/// inside another `f`.
#[inline]
pub(crate) fn with_state<T>(f: impl FnOnce(&mut State) -> T) -> Option<T> {
    RUN.with(|run| run.try_borrow_mut().ok()?.as_deref_mut().map(f))
}

/// The run of the current thread, which ends with this value.
pub(super) struct Running(());

impl Running {
    /// Makes `state` that of the script that the current thread is about to run; `None` where it runs one, whose
    /// host calls from within.
    pub(super) fn begin(state: State) -> Option<Self> {
        RUN.with(|run| {
            let mut run = run.try_borrow_mut().ok()?;
            if run.is_some() {
                return None;
            }
            *run = Some(Box::new(state));
            Some(Self(()))
        })
    }

    /// Ends the run and hands over what it leaves.
    pub(super) fn end(self) -> Option<Box<State>> {
        RUN.with(|run| run.try_borrow_mut().ok()?.take())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let left = RUN.with(|run| run.try_borrow_mut().ok()?.take());
        drop(left);
    }
}

/// Prints a line for the script.
pub(super) fn print(text: &str) {
    with_state(|state| state.print(text));
}
