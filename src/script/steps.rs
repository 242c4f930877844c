//! The steps of a running script: every few of them, a look at its limits, the time and the wish to stop.

use std::{
    cell::Cell,
    sync::{Arc, atomic::Ordering::Relaxed},
};

use rhai::{Dynamic, Position};

use super::{
    cells,
    link::Flags,
    session::{State, limit, with_state},
    value::{Outcome, ScriptError},
};
use crate::{diag::ErrorKind, host::Host, limits::Limits, meter};

/// Operations between two looks at the clock: some 50 microseconds.
const CHECK_EVERY: u64 = 512;

/// The steps of the script that runs on this thread.
struct Steps {
    /// Steps until the next look.
    left: Cell<u64>,
    /// Steps taken when none is left.
    until: Cell<u64>,
    /// Bytes that the thread may hold until then.
    most_held: Cell<isize>,
}

impl Steps {
    /// Plans the next look: after [`CHECK_EVERY`] steps, at the latest at the first beyond `operations`.
    fn plan(&self, taken: u64, operations: u64) {
        let next = taken
            .saturating_add(CHECK_EVERY)
            .min(operations.saturating_add(1));
        let next = next.max(taken.saturating_add(1));
        self.left.set(next - taken);
        self.until.set(next);
    }
}

thread_local! {
    static STEPS: Steps = const { Steps { left: Cell::new(0), until: Cell::new(0), most_held: Cell::new(isize::MAX) } };
}

/// A watch that tells the engine when to end the run of the current thread: too many steps, the deadline, the
/// host's wish, a used-up budget. Every few hundred steps it looks at all of them; at the time and the wish also where
/// the caller's thread says that milliseconds have passed meanwhile, for a step may be the call of a function that takes
/// as long. What ends a run once ends it for good, also where Rhai passes over an error, as
/// it does where it turns values into text.
///
/// Steps are counted here: Rhai forgets those of closures that its own functions call.
pub(super) fn watch(
    limits: &Limits,
    flags: Arc<Flags>,
) -> impl Fn(u64) -> Option<Dynamic> + Send + Sync + 'static {
    let limits = limits.clone();
    STEPS.with(|steps| {
        steps.plan(0, limits.operations);
        let most = isize::try_from(limits.script_memory).unwrap_or(isize::MAX);
        steps.most_held.set(meter::held().saturating_add(most));
    });
    move |_| {
        let goes_on = STEPS.with(|steps| {
            let left = steps.left.get().saturating_sub(1);
            steps.left.set(left);
            left > 0 && meter::held() <= steps.most_held.get()
        });
        if !goes_on {
            return look(&limits);
        }
        if flags.look.load(Relaxed) {
            flags.look.store(false, Relaxed);
            return look_at_the_time();
        }
        None
    }
}

/// Whether the run is to end for its time or the host's wish. The steps until the next look at the budgets stay what
/// they are: where a script is told of those must not depend on how fast it runs.
#[cold]
fn look_at_the_time() -> Option<Dynamic> {
    let ended = with_state(|state| {
        state.ended = state.ended.take().or_else(|| out_of_time(state));
        state.ended.clone()
    });
    let ended = ended.flatten()?;
    look_at_each_step();
    Some(Dynamic::from(*ended))
}

/// The error of a run that its host stops, or that has taken too long.
fn out_of_time(state: &State) -> Option<Box<ScriptError>> {
    if state.host.should_stop() {
        Some(ScriptError::of_kind(ErrorKind::Cancelled, "the run was stopped"))
    } else if state.time_left().is_zero() {
        Some(state.too_long())
    } else {
        None
    }
}

/// Work of a long call between two looks at whether it is to go on, counted in the cheapest things it does: a hundred
/// microseconds or so.
pub(super) const PIECE: usize = 4096;

/// What a call of one of the language's functions has left to do before it looks whether to go on. Such a call is a
/// single step, so that nobody else would look.
pub(super) struct Work {
    left: usize,
}

impl Work {
    pub(super) fn new() -> Self {
        Self { left: PIECE }
    }

    /// Counts what was done.
    ///
    /// # Errors
    /// Where the run is to end, for good.
    #[inline]
    pub(super) fn done(&mut self, much: usize) -> Outcome<()> {
        if much < self.left {
            self.left -= much;
            return Ok(());
        }
        self.left = PIECE;
        with_state(goes_on).unwrap_or(Ok(()))
    }

    /// As [`Work::done`], for what works on the state of the run.
    #[inline]
    pub(super) fn done_in(&mut self, state: &mut State, much: usize) -> Outcome<()> {
        if much < self.left {
            self.left -= much;
            return Ok(());
        }
        self.left = PIECE;
        goes_on(state)
    }
}

/// The error that ends the run for its time or the host's wish, or has ended it.
#[cold]
fn goes_on(state: &mut State) -> Outcome<()> {
    state.ended = state.ended.take().or_else(|| out_of_time(state));
    match state.ended.clone() {
        Some(ended) => {
            look_at_each_step();
            Err(ended)
        }
        None => Ok(()),
    }
}

/// The error that has ended the run, for what would pass over errors of the functions it calls.
#[cold]
pub(super) fn ended() -> Outcome<()> {
    with_state(|state| state.ended.clone())
        .flatten()
        .map_or(Ok(()), Err)
}

/// Makes every further step a look, which counts the same steps as the next one would have.
fn look_at_each_step() {
    STEPS.with(|steps| {
        steps.until.set(steps.until.get() - steps.left.get());
        steps.left.set(0);
    });
}

/// Whether the run is to end.
#[cold]
fn look(limits: &Limits) -> Option<Dynamic> {
    let taken = STEPS.with(|steps| steps.until.get() - steps.left.get());
    let ended = with_state(|state| {
        if state.ended.is_none() {
            state.ended = if taken > limits.operations {
                let value = limits.operations;
                Some(limit("the script takes too many steps", "operations", value))
            } else if let Some(ended) = out_of_time(state) {
                Some(ended)
            } else if holds_too_much() {
                let value = limits.script_memory;
                Some(limit(
                    "the script's values take too much memory",
                    "script_memory",
                    value,
                ))
            } else if state.printed > limits.print_bytes {
                let value = limits.print_bytes;
                Some(limit("the script prints too much", "print_bytes", value))
            } else {
                None
            };
        }
        state.ended.clone()
    });
    let Some(ended) = ended.flatten() else {
        STEPS.with(|steps| steps.plan(taken, limits.operations));
        return None;
    };
    // With none left, every further step looks here.
    Some(Dynamic::from(*ended))
}

/// Whether the script holds more than it may, also when what nobody can reach any more is gone.
fn holds_too_much() -> bool {
    let too_much = || STEPS.with(|steps| meter::held() > steps.most_held.get());
    if !too_much() {
        return false;
    }
    cells::sweep();
    too_much()
}

/// Ends the run at its next step: a text would be longer than the limit `string_bytes`.
#[cold]
pub(super) fn end_by_string(most: usize, at: Position) {
    let first = with_state(|state| {
        let ended = || limit("the string is too long", "string_bytes", most);
        state.ended_at = at;
        state.ended.get_or_insert_with(ended);
    });
    if first.is_some() {
        look_at_each_step();
    }
}

/// Calls a function that puts something into the scene. What the thread then holds more is the scene's, which has limits
/// of its own, and not the script's.
pub(super) fn for_the_scene<T>(f: impl FnOnce() -> T, is_the_scenes: impl FnOnce(&T) -> bool) -> T {
    let before = meter::held();
    let result = f();
    let more = meter::held().saturating_sub(before);
    if more > 0 && is_the_scenes(&result) {
        STEPS.with(|steps| steps.most_held.set(steps.most_held.get().saturating_add(more)));
    }
    result
}
