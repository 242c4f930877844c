//! The variables that closures share with the code around them.
//!
//! Rhai puts such a variable into a counted cell. A closure holds its cells, a cell may hold a closure, and so on: a
//! chain that a script makes as long as it likes, in no more steps than it has links. Dropping the head of such a
//! chain drops its links by recursion, one inside the other, and no stack is deep enough for that. So each cell is
//! made here, and held here as well. Whatever a script then drops ends at the nearest cell, and cells that nobody else
//! holds are dropped one after the other. Closures that hold themselves go with the rest when the run ends.

use std::cell::RefCell;

use rhai::{Dynamic, EvalAltResult, EvalContext, Locked, Scope, Shared};

use super::vocabulary::CONSTANTS;

/// What [`EvalContext`] is told of a variable whose cell was made here. Scripts have no function that reads or writes
/// tags.
const HELD: i16 = 0x7274;

/// Cells made between two looks at which of them are still in use.
const FEWEST: usize = 64;

type Cell = Shared<Locked<Dynamic>>;

/// The cells of a run.
struct Cells {
    held: Vec<Cell>,
    /// As many as this are looked through for those that nobody else holds.
    most: usize,
}

thread_local! {
    static CELLS: RefCell<Cells> = const { RefCell::new(Cells { held: Vec::new(), most: FEWEST }) };
}

/// Lets go of the cells of a run on this thread when it goes out of scope.
pub(super) struct Held(());

impl Held {
    /// Before a run begins.
    pub(super) fn new() -> Self {
        Self(())
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let held = CELLS.with(|cells| {
            cells.try_borrow_mut().map_or_else(
                |_| Vec::new(),
                |mut cells| {
                    cells.most = FEWEST;
                    std::mem::take(&mut cells.held)
                },
            )
        });
        // What is in a cell goes while all of them are held, so nothing goes by recursion, and circles are broken.
        for cell in &held {
            drop(emptied(cell));
        }
    }
}

/// Takes the value out of a cell. One that is locked keeps it: its value is being worked on by nobody who is still
/// there.
fn emptied(cell: &Cell) -> Option<Dynamic> {
    cell.try_write().ok().map(|mut value| std::mem::take(&mut *value))
}

/// Lets go of cells that nobody else holds.
pub(super) fn sweep() {
    CELLS.with(|cells| {
        if let Ok(mut cells) = cells.try_borrow_mut() {
            cells.sweep();
        }
    });
}

impl Cells {
    fn hold(&mut self, cell: Cell) {
        self.held.push(cell);
        if self.held.len() >= self.most {
            self.sweep();
        }
    }

    fn sweep(&mut self) {
        let mut used = Vec::new();
        // The newest first: it is what may hold older ones. A cell that others hold is held on to, and one that is not
        // looked at yet too, so the drop of one cell is the drop of one value.
        for cell in std::mem::take(&mut self.held).into_iter().rev() {
            if Shared::strong_count(&cell) > 1 {
                used.push(cell);
            }
        }
        used.reverse();
        self.most = (used.len() * 2).max(FEWEST);
        self.held = used;
    }
}

/// Called for every variable that a script reads, writes or shares. The first to see one that was shared just now, when
/// no closure has its cell yet, gives it a cell of this run.
#[expect(clippy::unnecessary_wraps, reason = "what Rhai calls")]
#[inline]
pub(super) fn on_variable(
    name: &str,
    from_end: usize,
    mut context: EvalContext<'_, '_, '_, '_, '_, '_>,
) -> Result<Option<Dynamic>, Box<EvalAltResult>> {
    let scope = context.scope();
    let variable = match from_end.checked_sub(1) {
        Some(i) => scope.iter_raw().nth(i).map(|(_, _, value)| value),
        None => scope.get(name),
    };
    if variable.is_some_and(|value| value.is_shared() && i64::from(value.tag()) != i64::from(HELD)) {
        adopt(context.scope_mut(), name);
    } else if variable.is_none() {
        return Ok(constant(name));
    }
    Ok(None)
}

/// A closure shares what it names with the code around it, where constants of the language are no variables.
fn constant(name: &str) -> Option<Dynamic> {
    let found = CONSTANTS.iter().find(|constant| constant.name == name)?;
    Some(found.value.into())
}

/// Moves the variable `name` into a cell of this run.
#[cold]
fn adopt(scope: &mut Scope<'_>, name: &str) {
    if let Some(variable) = scope.get_mut(name) {
        *variable = in_a_cell(variable.take());
        return;
    }
    // Constants can only be exchanged with all of their scope. The last of that name is the one.
    let all: Vec<_> = std::mem::take(scope).into_iter().collect();
    let last = all.iter().rposition(|(other, ..)| other == name);
    for (i, (other, value, aliases)) in all.into_iter().enumerate() {
        let value = if Some(i) == last { in_a_cell(value) } else { value };
        if value.is_read_only() || Some(i) == last {
            scope.push_constant_dynamic(other.as_str(), value);
        } else {
            scope.push_dynamic(other.as_str(), value);
        }
        for alias in aliases {
            scope.set_alias(other.as_str(), alias);
        }
    }
}

/// The value, which has no other owner yet, in a cell of this run.
fn in_a_cell(value: Dynamic) -> Dynamic {
    let cell = Shared::new(Locked::new(value.flatten()));
    CELLS.with(|cells| {
        if let Ok(mut cells) = cells.try_borrow_mut() {
            cells.hold(Shared::clone(&cell));
        }
    });
    let mut variable = Dynamic::from(cell);
    variable.set_tag(HELD.into());
    variable
}
