//! Work that waits, in two lanes.
//!
//! Nobody can tell from a script how long it will take. So each is first worked on for a short slice. What is not done
//! then has to begin again, later, in the long lane: a picture depends on its script alone, so nothing but the slice is
//! lost. One worker never leaves the short lane. However many scripts without end come in, a quick one waits for no more
//! than a slice for each that came before it.

use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

/// Where something waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lane {
    /// Where everything begins.
    Short,
    /// For what took longer than a slice.
    Long,
}

/// The two lanes; `T` is what waits.
#[derive(Debug)]
pub struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    capacity: [usize; 2],
}

#[derive(Debug)]
struct State<T> {
    lanes: [VecDeque<T>; 2],
    is_closed: bool,
}

impl<T> Queue<T> {
    /// A queue in which so many wait at most.
    pub fn new(short: usize, long: usize) -> Self {
        Self {
            state: Mutex::new(State {
                lanes: [VecDeque::new(), VecDeque::new()],
                is_closed: false,
            }),
            changed: Condvar::new(),
            capacity: [short, long],
        }
    }

    /// Adds to the end of a lane.
    ///
    /// # Errors
    /// Gives it back where the lane is full or the queue closed.
    pub fn push(&self, lane: Lane, item: T) -> Result<(), T> {
        let mut state = self.state();
        if state.is_closed || state.lanes[lane as usize].len() >= self.capacity[lane as usize] {
            return Err(item);
        }
        state.lanes[lane as usize].push_back(item);
        // Not one: the worker that wakes might not be one that takes from this lane.
        self.changed.notify_all();
        Ok(())
    }

    /// Takes what waited longest in one of these lanes, the first of them first; waits until there is something. `None`
    /// once the queue is closed and they are empty.
    pub fn take(&self, lanes: &[Lane]) -> Option<(Lane, T)> {
        let mut state = self.state();
        loop {
            for lane in lanes {
                if let Some(item) = state.lanes[*lane as usize].pop_front() {
                    return Some((*lane, item));
                }
            }
            if state.is_closed {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// How many wait in the short and in the long lane.
    pub fn waiting(&self) -> [usize; 2] {
        let state = self.state();
        [state.lanes[0].len(), state.lanes[1].len()]
    }

    /// Takes nothing more; what waits is still worked on.
    pub fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
    }

    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_bounded_and_taken_from_in_order() {
        let queue = Queue::new(2, 1);
        assert_eq!(queue.push(Lane::Short, 1), Ok(()));
        assert_eq!(queue.push(Lane::Short, 2), Ok(()));
        assert_eq!(queue.push(Lane::Short, 3), Err(3));
        assert_eq!(queue.push(Lane::Long, 4), Ok(()));
        assert_eq!(queue.take(&[Lane::Short]), Some((Lane::Short, 1)));
        assert_eq!(queue.take(&[Lane::Long, Lane::Short]), Some((Lane::Long, 4)));
        queue.close();
        assert_eq!(queue.push(Lane::Long, 5), Err(5));
        assert_eq!(queue.take(&[Lane::Long, Lane::Short]), Some((Lane::Short, 2)));
        assert_eq!(queue.take(&[Lane::Short]), None);
    }
}
