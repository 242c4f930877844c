//! What one run of a script works on.

use std::{
    cell::Cell,
    collections::BTreeMap,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use rhai::{Dynamic, Module, Position};

use super::{
    Picture, RunOptions,
    api::Stream,
    link::Remote,
    value::{Outcome, ScriptError},
};
use crate::{
    diag::{Diagnostic, ErrorKind, SourceLoc},
    host::{Host, resolve},
    import::{AssetCache, Assets},
    limits::Limits,
    scene::Builder,
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

/// Everything scene functions change.
pub(crate) struct State {
    pub(crate) builder: Builder,
    pub(crate) limits: Limits,
    pub(crate) host: Remote,
    pub(crate) random: Stream,
    /// Settings the caller has decided; the script's own calls do not change them.
    pub(crate) size: Option<(u32, u32)>,
    pub(crate) samples: Option<u32>,
    pub(crate) seed: Option<u64>,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) warnings: Vec<Diagnostic>,
    /// Source files, the script first.
    pub(crate) sources: Vec<Source>,
    /// Index into `sources` of the file of the current call, and its number in the scene.
    current: usize,
    current_file: u16,
    /// Modules by host path, run once each.
    pub(crate) modules: BTreeMap<String, Arc<Module>>,
    /// Host paths of the modules being loaded, outermost first.
    pub(crate) loading: Vec<String>,
    /// Meshes and textures by host path, and the count of files.
    pub(crate) assets: AssetCache,
    printed: usize,
    /// What ended the run.
    pub(crate) ended: Option<Box<ScriptError>>,
    /// Time spent rendering, which does not count as the script's.
    pub(crate) rendering: Arc<AtomicU64>,
}

impl State {
    /// The state at the start of a script.
    pub(super) fn new(main: Source, limits: &Limits, options: &RunOptions, host: Remote) -> Self {
        let mut builder = Builder::with_limits(limits.clone());
        let current_file = builder.file(&main.name);
        Self {
            builder,
            limits: limits.clone(),
            host,
            random: Stream::new(options.seed.unwrap_or(0)),
            size: options.size,
            samples: options.samples,
            seed: options.seed,
            pictures: Vec::new(),
            warnings: Vec::new(),
            sources: vec![main],
            current: 0,
            current_file,
            modules: BTreeMap::new(),
            loading: Vec::new(),
            assets: AssetCache::default(),
            printed: 0,
            ended: None,
            rendering: Arc::default(),
        }
    }

    /// Notes where the script calls from.
    #[inline]
    pub(super) fn at(&mut self, source: Option<&str>, pos: Position) {
        if let Some(name) = source
            && self.sources.get(self.current).is_none_or(|s| s.name != name)
            && let Some(i) = self.sources.iter().position(|s| s.name == name)
        {
            self.current = i;
            self.current_file = self.builder.file(name);
        }
        self.builder.set_loc(SourceLoc {
            line: pos.line().unwrap_or(0) as u32,
            column: pos.position().unwrap_or(0) as u16,
            file: self.current_file,
        });
    }

    /// The host's path of a file that the current source names.
    pub(crate) fn host_path(&self, path: &str) -> String {
        let named_in = self
            .sources
            .get(self.current)
            .map_or("", |s| s.host_path.as_str());
        resolve(named_in, path)
    }

    /// The text file at `host_path`, at most `max_bytes` long, counted as every file is.
    pub(crate) fn read(&mut self, host_path: &str, max_bytes: u64) -> Outcome<Vec<u8>> {
        let mut limits = self.limits.clone();
        limits.file_bytes = limits.file_bytes.min(max_bytes);
        let bytes = Assets::new(&self.host, &limits, &mut self.assets).read(host_path);
        bytes.map_err(ScriptError::from_file)
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

/// A run's state behind a handle that Rhai can carry in its tag.
#[derive(Clone)]
pub(crate) struct Session(Arc<Mutex<State>>);

impl Session {
    pub(super) fn new(state: State) -> Self {
        Self(Arc::new(Mutex::new(state)))
    }

    /// The state. Only the script's own thread ever takes it, and never twice.
    #[inline]
    pub(crate) fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn print(&self, text: &str) {
        self.state().print(text);
    }

    /// A watch that tells the engine when to end the run: too many steps, the deadline, the host's wish, a
    /// used-up budget. What ends a run once ends it for good, also where Rhai passes over an error, as it does
    /// in the comparisons of a sort.
    ///
    /// Steps are counted here: Rhai forgets those of closures that its own functions call.
    pub(super) fn watch(&self) -> impl Fn(u64) -> Option<Dynamic> + Send + Sync + 'static {
        let session = self.clone();
        let state = self.state();
        let limits = state.limits.clone();
        let host = state.host.clone();
        let rendering = Arc::clone(&state.rendering);
        drop(state);
        let clock = Clock::start();
        STEPS.set(0);
        move |_| {
            let steps = STEPS.get().saturating_add(1);
            STEPS.set(steps);
            if !steps.is_multiple_of(CHECK_EVERY) && steps <= limits.operations {
                return None;
            }
            let mut state = session.state();
            if state.ended.is_none() {
                let rendering = Duration::from_nanos(rendering.load(Ordering::Relaxed));
                let spent = clock.elapsed().saturating_sub(rendering);
                state.ended = if steps > limits.operations {
                    let value = limits.operations;
                    Some(limit("the script takes too many steps", "operations", value))
                } else if host.should_stop() {
                    Some(ScriptError::of_kind(ErrorKind::Cancelled, "the run was stopped"))
                } else if spent > limits.script_time {
                    let value = format!("{:?}", limits.script_time);
                    Some(limit("the script runs too long", "script_time", value))
                } else if state.printed > limits.print_bytes {
                    let value = limits.print_bytes;
                    Some(limit("the script prints too much", "print_bytes", value))
                } else {
                    None
                };
            }
            let ended = state.ended.clone()?;
            // From now on every step looks here.
            STEPS.set(u64::MAX);
            Some(Dynamic::from(*ended))
        }
    }
}

thread_local! {
    /// Steps of the script that runs on this thread.
    static STEPS: Cell<u64> = const { Cell::new(0) };
}

/// Operations between two looks at the clock: some 50 microseconds.
const CHECK_EVERY: u64 = 512;

/// A clock where the platform has one; it stands still where it has none (wasm32-unknown-unknown).
pub(super) struct Clock {
    #[cfg(not(target_family = "wasm"))]
    start: std::time::Instant,
}

impl Clock {
    pub(super) fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            start: std::time::Instant::now(),
        }
    }

    pub(super) fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.start.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}
