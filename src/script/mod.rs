//! Scene scripts: Rhai with the scene's functions, one table for all of them.
//!
//! [`Script::compile`] reads a script, [`Script::run`] runs it and hands over the scene it built and the
//! pictures it rendered. A script reaches nothing but the [`Host`] it is given, stays within its [`Limits`],
//! and depends on no clock, no thread and no machine.

#[cfg(feature = "cli")]
pub(crate) mod analysis;
mod api;
mod call;
mod caller;
mod cells;
mod clock;
mod engine;
mod errors;
mod given;
mod kinds;
mod language;
mod link;
mod lint;
mod lists;
mod modules;
mod names;
mod options;
mod power;
mod recover;
mod run;
mod session;
mod steps;
mod table;
mod timed;
mod value;
#[cfg(test)]
mod visible_tests;
mod vocabulary;

pub use language::{Language, build};
/// The version of Rhai whose engine [`Language::engine_mut`] hands out.
pub use rhai;
pub use run::{CallSite, Picture, Run, RunOptions};
pub use table::{Entry, Group, Kind, Param, entries, entry};
pub use vocabulary::{CONSTANTS, Constant, EXAMPLE_FILES, PROPERTIES, Property};

use std::{
    any::Any,
    borrow::Cow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    thread,
};

use rhai::{AST, EvalAltResult, Position, Scope};

use crate::{
    diag::{Diagnostic, Error, ErrorKind, Report},
    host::Host,
    limits::Limits,
    scene::{Crop, GroupId, Scene},
};
use link::{Caller, Flags, Remote, StopOnDrop};
use session::{Running, Source, State, Watch};
use value::ScriptError;

/// Bytes of stack for each level of arrays and maps in one another. Printing and comparing them take most: 2 KB, measured.
const STACK_PER_LEVEL: usize = 4 << 10;

/// Stack of a script's thread: address space, of which only what is used becomes memory. Rhai walks its syntax tree by
/// recursion, and values that are nested, of which it counts the elements in all: that bounds their depth. Where it does
/// so too generously, time does: each level is measured with all those below it, so half a million levels take longer
/// than the default limit on time.
fn stack_bytes(limits: &Limits) -> usize {
    let most = if cfg!(target_pointer_width = "64") {
        1 << 30
    } else {
        256 << 20
    };
    let levels = limits.array_len.saturating_add(limits.map_len);
    levels.saturating_mul(STACK_PER_LEVEL).clamp(64 << 20, most)
}

/// Whether there are threads: none in the browser's sandbox (wasm32-unknown-unknown).
const HAS_THREADS: bool = !cfg!(target_family = "wasm");

/// A script that has been read and can be run any number of times.
///
/// ```
/// use rtscript::{DVec3, Limits, NoHost, RunOptions, Script};
/// let script = Script::compile("a.rhai", r#"sphere(0, 0, 0, param("radius", 1.0));"#, &Limits::default())?;
/// for radius in ["0.5", "2"] {
///     let mut options = RunOptions::default();
///     options.parameters.insert("radius".to_owned(), radius.to_owned());
///     assert_eq!(script.run(&NoHost, &options)?.value.scene.root().objects.len(), 1);
/// }
/// # let _ = DVec3::ZERO;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Script {
    source: Source,
    ast: Arc<AST>,
    limits: Limits,
    language: Language,
}

impl Script {
    /// Reads a script. `name` is the file as its reader knows it, for messages; the files that the script
    /// names are looked up relative to the host's root.
    ///
    /// The first script of a process sets the seed of Rhai's hashes (`rhai::config::hashing`), unless the program has:
    /// nothing that can be seen depends on which it is.
    ///
    /// # Errors
    /// `Script` where it is malformed, with line and column; `Limit` where it is too large.
    pub fn compile(name: &str, source: &str, limits: &Limits) -> Result<Self, Error> {
        Self::compile_in(&Language::new(), name, source, limits)
    }

    /// As [`Script::compile`], with functions of the program's own.
    ///
    /// # Errors
    /// As [`Script::compile`].
    pub fn compile_in(language: &Language, name: &str, source: &str, limits: &Limits) -> Result<Self, Error> {
        let limits = &for_the_stack(limits);
        let too_large = source.len() > limits.source_bytes;
        let source = normal(source);
        let source = Source {
            name: name.to_owned(),
            host_path: String::new(),
            text: source.into(),
        };
        if too_large {
            let message = format!(
                "the script of {} bytes is too large: the limit 'source_bytes' is {}",
                source.text.len(),
                limits.source_bytes
            );
            return Err(Diagnostic::error(ErrorKind::Limit, message).at(name, 0, 0).into());
        }
        let compiled = on_deep_stack(limits, || engine::compile(&source.text, limits, language))
            .map_err(|what| internal(name, &what))?
            .map_err(|e| internal(name, &e.message))?;
        match compiled {
            Ok(mut ast) => {
                ast.set_source(name);
                Ok(Self {
                    source,
                    ast: Arc::new(ast),
                    limits: limits.clone(),
                    language: language.clone(),
                })
            }
            Err(e) => {
                let context = errors::Context {
                    sources: std::slice::from_ref(&source),
                    limits,
                    language,
                    ast: None,
                };
                let mut error = Error::from(errors::of_parse(&e, name, &context));
                let more = on_deep_stack(limits, || recover::further_errors(&e, &source, limits, language));
                error.more = more.map_err(|what| internal(name, &what))?;
                Err(error)
            }
        }
    }

    /// The name the script was read under.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// Runs the script on a thread of its own; without threads (wasm32-unknown-unknown), on this one. Everything it
    /// asks of `host` is done on the calling thread, and so is rendering, in the rayon pool the call is made in.
    ///
    /// A run that the host wants to stop comes back within 20 ms. Where the script's thread needs longer to see it, or to free
    /// what it has made, it is left to itself, and ends and frees that behind the call; a function of the program that it was in
    /// goes on to its end. After every other run all is freed when the call returns.
    ///
    /// # Errors
    /// Whatever ends the script early, with its place and the calls that led there: [`Error::kind`] tells the
    /// script's own fault from a limit, a missing file, a refusal of the host or its wish to stop, which has no place where the
    /// script's thread was left to itself.
    pub fn run(&self, host: &dyn Host, options: &RunOptions) -> Result<Report<Run>, Error> {
        self.run_watched(host, options, None)
    }

    /// The calls that made an object of the scene that a run with this host and these options left behind, `index`
    /// being its place in the group: innermost first, the call of the scene function, then that of the function which
    /// it stands in, and so on. Runs the script twice more, to find which of the calls in its place the object's is,
    /// and to stop there. Empty where there is no such object, and where the script catches what stops it.
    ///
    /// # Errors
    /// As [`Script::run`].
    pub fn call_stack(
        &self,
        host: &dyn Host,
        options: &RunOptions,
        scene: &Scene,
        (group, index): (GroupId, usize),
    ) -> Result<Vec<CallSite>, Error> {
        let object = |scene: &Scene| {
            let objects = scene.groups.get(group.index()).map(|group| &group.objects);
            objects
                .and_then(|objects| objects.get(index))
                .map(|object| object.loc)
        };
        let Some(loc) = object(scene) else {
            return Ok(Vec::new());
        };
        let watch = |last| Watch { loc, last, count: 0 };
        let numbered = self.run_watched(host, options, Some(watch(None)))?;
        let Some(number) = object(&numbered.value.scene).filter(|loc| loc.file == u16::MAX) else {
            return Ok(Vec::new());
        };
        let stopped = self.run_watched(host, options, Some(watch(Some(number.line))))?;
        Ok(stopped.value.calls)
    }

    fn run_watched(
        &self,
        host: &dyn Host,
        options: &RunOptions,
        watch: Option<Watch>,
    ) -> Result<Report<Run>, Error> {
        let caller = Caller {
            host,
            render: &options.render,
        };
        if HAS_THREADS {
            self.run_on_deep_stack(&caller, options, watch)
        } else {
            self.run_here(&caller, options, watch)
        }
    }

    fn run_here(
        &self,
        caller: &Caller<'_>,
        options: &RunOptions,
        watch: Option<Watch>,
    ) -> Result<Report<Run>, Error> {
        let guarded = || caller.call(|remote| self.evaluate(remote, options, watch));
        catch_unwind(AssertUnwindSafe(guarded))
            .unwrap_or_else(|panic| Err(internal(self.name(), &panic_text(&*panic))))
    }

    fn run_on_deep_stack(
        &self,
        caller: &Caller<'_>,
        options: &RunOptions,
        watch: Option<Watch>,
    ) -> Result<Report<Run>, Error> {
        let flags: Arc<Flags> = Arc::default();
        let (remote, incoming) = Remote::pair(Arc::clone(&flags));
        let _guard = StopOnDrop(Arc::clone(&flags));
        let (script, options) = (self.clone(), options.clone());
        let thread = thread::Builder::new()
            .name("rtscript script".to_owned())
            .stack_size(stack_bytes(&self.limits))
            .spawn(move || {
                // The caller hears of the end when nothing is left of the run.
                let last = remote.clone();
                let run = || script.evaluate(remote, &options, watch);
                let result = catch_unwind(AssertUnwindSafe(run));
                drop((script, options));
                drop(last);
                result
            })
            .map_err(|e| internal(self.name(), &format!("cannot start the script's thread: {e}")))?;
        if !caller.serve(&incoming, &flags) {
            let stopped = Diagnostic::error(ErrorKind::Cancelled, "the run was stopped");
            return Err(stopped.at(self.name(), 0, 0).into());
        }
        match thread.join() {
            Ok(Ok(result)) => result,
            Ok(Err(panic)) | Err(panic) => Err(internal(self.name(), &panic_text(&*panic))),
        }
    }

    /// Runs the script on the current thread.
    fn evaluate(
        &self,
        remote: Remote,
        options: &RunOptions,
        watch: Option<Watch>,
    ) -> Result<Report<Run>, Error> {
        let flags = remote.flags();
        let mut state = State::new(self.source.clone(), &self.limits, options, remote, watch);
        state.language = self.language.clone();
        if let Err(e) = preset(&mut state) {
            let mut d = Diagnostic::error(e.kind, e.message).class(e.code);
            d.hints = e.hints;
            return Err(d.into());
        }
        let running = Running::begin(state).ok_or_else(|| {
            let what = "a script runs on this thread already, and without threads there is one at a time";
            Error::from(Diagnostic::error(ErrorKind::Denied, what).at(self.name(), 0, 0))
        })?;
        let _held = cells::Held::new();
        let engine = engine::runner(&self.limits, &self.language, &self.ast, flags)
            .map_err(|e| internal(self.name(), &e.message))?;
        let mut scope = Scope::new();
        let result = engine.run_ast_with_scope(&mut scope, &self.ast);
        // Values of the script go before its thread does: only here is the stack deep enough for any of them.
        drop((scope, engine));
        let Some(mut state) = running.end() else {
            return Err(internal(self.name(), "a run without a state"));
        };
        let result = match (result, state.ended.take()) {
            (Ok(()), Some(e)) => Err(e.raise(state.ended_at)),
            (Ok(()), None) => match api::params::unknown(&state) {
                Some(e) => Err(e.raise(Position::NONE)),
                None => Ok(()),
            },
            (result, _) => result,
        };
        if state.found_call {
            let calls = result.err().map(|e| errors::call_stack(&e, self.name()));
            let mut found = self.finish(*state, Ok(()), options)?;
            found.value.calls = calls.unwrap_or_default();
            return Ok(found);
        }
        self.finish(*state, result, options)
    }

    fn finish(
        &self,
        state: State,
        result: Result<(), Box<EvalAltResult>>,
        options: &RunOptions,
    ) -> Result<Report<Run>, Error> {
        let State {
            sources,
            mut builder,
            mut warnings,
            pictures,
            parameters,
            ran,
            assets,
            ..
        } = state;
        warnings.extend(builder.take_warnings());
        let context = errors::Context {
            sources: &sources,
            limits: &self.limits,
            language: &self.language,
            ast: Some(&self.ast),
        };
        let mut finished = match result {
            Ok(()) => Ok(builder.finish()),
            // What looks wrong about a scene that was never finished says nothing.
            Err(e) => {
                builder.discard();
                Err(errors::of_run(&e, &context))
            }
        };
        if let Ok(report) = &mut finished {
            warnings.append(&mut report.warnings);
            if options.lint {
                let wrong = lint::unknown_calls(&self.ast, self.name(), &context);
                warnings.extend(wrong.into_iter().map(Diagnostic::as_warning));
                warnings.extend(lint::unreached(&self.ast, &ran, self.name(), &context));
            }
        }
        for warning in &mut warnings {
            let source = sources.iter().find(|s| Some(&*s.name) == warning.file.as_deref());
            if let Some(source) = source {
                *warning = warning.clone().with_source(&source.text);
            }
        }
        match finished {
            Err(diagnostic) => Err(Error {
                more: match diagnostic.kind {
                    ErrorKind::Script => lint::others(&self.ast, &diagnostic, self.name(), &context),
                    _ => Vec::new(),
                },
                diagnostic: Box::new(diagnostic),
                warnings,
            }),
            Ok(report) => Ok(Report {
                value: Run {
                    files: assets.files_of(&report.value),
                    scene: report.value,
                    pictures,
                    parameters,
                    calls: Vec::new(),
                },
                warnings,
            }),
        }
    }
}

/// The text without the byte order mark that some editors put first, and with LF for a CR that stands alone: Rhai ends
/// a line there in some places and not in others.
fn normal(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if !text.contains('\r') {
        return text.into();
    }
    let mut chars = text.chars().peekable();
    let mut normal = String::with_capacity(text.len());
    while let Some(c) = chars.next() {
        let alone = c == '\r' && chars.peek() != Some(&'\n');
        normal.push(if alone { '\n' } else { c });
    }
    normal.into()
}

/// Puts the caller's decisions in place.
fn preset(state: &mut State) -> Result<(), Box<ScriptError>> {
    if let Some((width, height)) = state.size {
        state.builder.size(width, height)?;
    }
    if let Some(n) = state.samples {
        state.builder.samples(n)?;
    }
    if let Some(seed) = state.seed {
        state.builder.seed(seed);
    }
    if let Some(region) = state.region {
        state.builder.crop(Some(Crop::Pixels(region)))?;
    }
    Ok(())
}

/// The limits that count. Where the stack is whatever the embedder left, the default depths are what Node's
/// stack of 984 KiB is known to hold.
fn for_the_stack(limits: &Limits) -> Limits {
    let mut limits = limits.clone();
    if !HAS_THREADS {
        let most = Limits::default();
        limits.call_levels = limits.call_levels.min(most.call_levels);
        limits.expression_depth = limits.expression_depth.min(most.expression_depth);
    }
    limits
}

/// Runs `f` on a thread with a deep stack; without threads (wasm32-unknown-unknown), on this one.
fn on_deep_stack<T: Send>(limits: &Limits, f: impl FnOnce() -> T + Send) -> Result<T, String> {
    let guarded = || catch_unwind(AssertUnwindSafe(f));
    let result = if !HAS_THREADS {
        guarded()
    } else {
        thread::scope(|scope| {
            let spawned = thread::Builder::new()
                .name("rtscript reader".to_owned())
                .stack_size(stack_bytes(limits))
                .spawn_scoped(scope, guarded)
                .map_err(|e| format!("cannot start the script's thread: {e}"))?;
            Ok::<_, String>(match spawned.join() {
                Ok(result) => result,
                Err(panic) => Err(panic),
            })
        })?
    };
    result.map_err(|panic| panic_text(&*panic))
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("a fault of rtscript's own: {}", text.unwrap_or("no details"))
}

fn internal(name: &str, what: &str) -> Error {
    Diagnostic::error(ErrorKind::Internal, what)
        .at(name, 0, 0)
        .hint("please report this, with the script")
        .into()
}

const _: fn() = || {
    fn is_send_sync<T: Send + Sync>() {}
    is_send_sync::<Script>();
};
