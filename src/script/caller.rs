//! Functions of the language that call functions of the script.
//!
//! While they do, nothing of the run is borrowed: what they call may work on the scene itself, draw random numbers or
//! call such a function again. Its steps count as any of the script's.

use std::cell::Cell;

use rhai::{Dynamic, EvalAltResult, FnPtr, FuncArgs, NativeCallContext, Position};

use super::{
    session::{State, with_state},
    steps,
    value::{Outcome, ScriptError},
};
use crate::{
    diag::{ErrorKind, SourceLoc},
    scene::SceneError,
};

/// Why such a function failed.
pub(crate) enum Failure {
    /// By its own words.
    Said(Box<ScriptError>),
    /// By what the script's function raised, which has its place already.
    Raised(Box<EvalAltResult>),
}

impl From<Box<ScriptError>> for Failure {
    fn from(error: Box<ScriptError>) -> Self {
        Self::Said(error)
    }
}

impl From<Box<EvalAltResult>> for Failure {
    fn from(error: Box<EvalAltResult>) -> Self {
        Self::Raised(error)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Said(error.into())
    }
}

impl Failure {
    /// As the engine carries it, at the place of the call.
    pub(super) fn raise(self, source: Option<&str>, place: Position) -> Box<EvalAltResult> {
        match self {
            Self::Said(error) => error.raise_in(source, place),
            Self::Raised(error) => error,
        }
    }
}

/// The call of such a function.
pub(crate) struct Caller<'a, 'c> {
    ctx: &'a NativeCallContext<'c>,
    loc: Cell<SourceLoc>,
}

impl<'a, 'c> Caller<'a, 'c> {
    pub(super) fn new(ctx: &'a NativeCallContext<'c>) -> Self {
        let loc = Cell::new(SourceLoc::default());
        Self { ctx, loc }
    }

    /// Notes the call, does its work, and gives an error its place.
    pub(super) fn run(
        &self,
        work: impl FnOnce(&Self) -> Result<Dynamic, Failure>,
    ) -> Result<Dynamic, Box<EvalAltResult>> {
        let (source, place) = (
            self.ctx.global_runtime_state().source.as_ref(),
            self.ctx.call_position(),
        );
        let result = self
            .with(|state| {
                state.called(source, place)?;
                self.loc.set(state.builder.loc());
                Ok(())
            })
            .map_err(Failure::Said)
            .and_then(|()| work(self));
        result.map_err(|failure| failure.raise(self.ctx.call_source(), place))
    }

    /// Looks at the run.
    pub(crate) fn with<T>(&self, f: impl FnOnce(&mut State) -> Outcome<T>) -> Outcome<T> {
        with_state(f).unwrap_or_else(|| {
            Err(ScriptError::of_kind(
                ErrorKind::Internal,
                "a scene function outside a run",
            ))
        })
    }

    /// Puts something into the scene, under the place of the call: what was called meanwhile had places of its own.
    pub(crate) fn build<T>(&self, f: impl FnOnce(&mut State) -> Outcome<T>) -> Outcome<T> {
        steps::for_the_scene(
            || {
                self.with(|state| {
                    state.builder.set_loc(self.loc.get());
                    f(state)
                })
            },
            Result::is_ok,
        )
    }

    /// Calls a function of the script; `wrong_count` is the error where it takes another number of arguments.
    pub(crate) fn call(
        &self,
        f: &FnPtr,
        args: impl FuncArgs,
        wrong_count: impl FnOnce() -> Box<ScriptError>,
    ) -> Result<Dynamic, Failure> {
        f.call_within_context(self.ctx, args)
            .map_err(|error| match &*error {
                // A closure bears a name that nobody is to see, and it is there: only not with so many parameters.
                EvalAltResult::ErrorFunctionNotFound(name, _)
                    if f.is_anonymous() && name.starts_with(f.fn_name()) =>
                {
                    Failure::Said(wrong_count())
                }
                _ => Failure::Raised(error),
            })
    }
}
