//! Numbers that a message tells otherwise than they were given.

use std::{cell::RefCell, fmt::Display};

use super::SceneError;

/// Numbers whose text in a message is not the one under which they were given: counts beyond `u32`, which the builder hears
/// of as the largest there is, because every limit refuses that, and whole numbers that a float rounds.
#[derive(Debug, Default)]
pub(crate) struct Told(RefCell<Vec<(String, String)>>);

impl Told {
    /// A count as the builder takes it.
    pub(crate) fn count<N: Copy + Display + TryInto<u32>>(&self, given: N) -> u32 {
        given.try_into().unwrap_or_else(|_| {
            self.note(u32::MAX, given);
            u32::MAX
        })
    }

    /// Notes that what was `given` is told as another number.
    pub(crate) fn note(&self, told: impl Display, given: impl Display) {
        self.0.borrow_mut().push((told.to_string(), given.to_string()));
    }

    /// Puts the numbers into a message that were given in place of those that it tells.
    pub(crate) fn put_right(&self, message: &mut String) {
        for (told, given) in self.0.borrow().iter() {
            *message = message.replacen(told, given, 1);
        }
    }

    /// As [`Told::put_right`].
    pub(crate) fn as_given(&self, mut error: SceneError) -> SceneError {
        self.put_right(&mut error.message);
        error
    }
}
