//! The script's host for as long as the script may run.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use super::{clock::Clock, link::Remote};
use crate::host::{Host, HostError};

/// Asks to stop once the script's time is over: in what the script asks for and may take long, such as a file of a few
/// megabytes with faces to be cut into triangles for minutes, the script itself takes no step.
pub(crate) struct Timed {
    host: Remote,
    clock: Arc<Clock>,
    /// Nanoseconds by `clock` when the time is over.
    until: Arc<AtomicU64>,
}

/// Sets the time of a [`Timed`].
#[derive(Clone)]
pub(crate) struct Timer {
    clock: Arc<Clock>,
    until: Arc<AtomicU64>,
}

impl Timer {
    /// A timer whose time is over at once.
    pub(crate) fn new() -> Self {
        Self {
            clock: Arc::new(Clock::start()),
            until: Arc::new(AtomicU64::new(0)),
        }
    }

    /// From now on there is so much time.
    pub(crate) fn set(&self, left: Duration) {
        let until = self.clock.elapsed().saturating_add(left).as_nanos();
        self.until
            .store(u64::try_from(until).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// `host` until the time is over.
    pub(crate) fn host(&self, host: &Remote) -> Timed {
        Timed {
            host: host.clone(),
            clock: Arc::clone(&self.clock),
            until: Arc::clone(&self.until),
        }
    }
}

impl Host for Timed {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.host.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        self.host.should_stop()
            || self.clock.elapsed().as_nanos() > u128::from(self.until.load(Ordering::Relaxed))
    }
}
