//! What scripts of a program can call beside rtscript's own functions.

use std::{collections::BTreeSet, fmt, sync::Arc};

use rhai::{Engine, EvalAltResult, NativeCallContext};

use super::{
    names::{BUILTINS, callable_names},
    session::with_state,
    table::entry,
    value::ScriptError,
};
use crate::scene::{Builder, SceneError};

type Change = dyn Fn(&mut Engine) + Send + Sync;

/// The language of scripts: rtscript's functions, and those of the program that runs them.
///
/// ```
/// use rhai::NativeCallContext;
/// use rtscript::{DVec3, Limits, NoHost, RunOptions, Script};
/// use rtscript::script::{Language, build, rhai};
///
/// let mut language = Language::new();
/// language.engine_mut(|engine| {
///     engine.register_fn("snowman", |ctx: NativeCallContext, height: f64| {
///         build(&ctx, |b| {
///             b.sphere(DVec3::ZERO, height / 3.0)?;
///             b.sphere(DVec3::Y * (height / 2.0), height / 5.0)
///         })
///     });
/// });
/// let script = Script::compile_in(&language, "yard.rhai", "snowman(2.5);", &Limits::default())?;
/// let run = script.run(&NoHost, &RunOptions::default())?.value;
/// assert_eq!(run.scene.root().objects.len(), 2);
/// # Ok::<(), rtscript::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Language {
    changes: Vec<Arc<Change>>,
    /// Names of the program's functions.
    names: Arc<BTreeSet<String>>,
}

impl Language {
    /// rtscript's functions alone.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Changes the engine that reads and runs scripts, before it does: registers functions, types, operators or syntax.
    /// As each script is read and run by an engine of its own, `change` is called once for each, from any thread; what
    /// functions share belongs into an `Arc`.
    ///
    /// A function of the program has precedence over one of rtscript's with the same name and parameters. Where pictures are to be
    /// the same everywhere, it must answer the same everywhere. What it places in the scene, it does by [`build`].
    ///
    /// The engine comes with the [`Limits`](crate::Limits) in force; a program that lifts them, or registers what
    /// reaches a file or a clock, has opened its own sandbox. Progress callbacks, `print`, the module resolver and the
    /// mapping of tokens are rtscript's, whatever `change` sets.
    pub fn engine_mut(&mut self, change: impl Fn(&mut Engine) + Send + Sync + 'static) -> &mut Self {
        let mut engine = Engine::new_raw();
        change(&mut engine);
        let ours = |name: &String| BUILTINS.contains(name) || entry(name).is_some();
        let new = callable_names(&engine).filter(|name| !ours(name));
        Arc::make_mut(&mut self.names).extend(new);
        self.changes.push(Arc::new(change));
        self
    }

    /// Whether the program has a function of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    pub(super) fn apply(&self, engine: &mut Engine) {
        self.changes.iter().for_each(|change| change(engine));
    }
}

impl fmt::Debug for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Language")
            .field("names", &self.names)
            .finish_non_exhaustive()
    }
}

/// Lets a function of the program work on the scene of the script that calls it: what `f` makes stands where that call
/// stands, under the current matrix and with the current material.
///
/// # Errors
/// Whatever `f` says, at the place of the call; an error too where no script of rtscript's runs on this thread, and from
/// within `f`.
pub fn build<T>(
    ctx: &NativeCallContext<'_>,
    f: impl FnOnce(&mut Builder) -> Result<T, SceneError>,
) -> Result<T, Box<EvalAltResult>> {
    let built = with_state(|state| {
        state.called(ctx.global_runtime_state().source.as_ref(), ctx.call_position())?;
        f(&mut state.builder).map_err(Box::<ScriptError>::from)
    });
    let built = built.unwrap_or_else(|| {
        let message =
            "a scene is built by a function that a running script calls, and not from within what builds it";
        Err(ScriptError::new(message))
    });
    built.map_err(|e| e.raise_in(ctx.call_source(), ctx.call_position()))
}
