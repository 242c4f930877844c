//! The host's wish to stop, asked often enough that no scene makes it wait: a single pixel can take minutes, with
//! thousands of samples, with a tree of 2^64 rays between mirrors of glass, or with lights of 65,536 points.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::{
    diag::{Diagnostic, Error, ErrorKind},
    host::Host,
};

/// Whether to stop, for all threads of a render.
pub(super) struct Interrupt<'h> {
    host: &'h dyn Host,
    stopped: AtomicBool,
}

impl<'h> Interrupt<'h> {
    pub(super) fn new(host: &'h dyn Host) -> Self {
        Self {
            host,
            stopped: AtomicBool::new(false),
        }
    }

    /// True once the host has asked to stop; what is being computed is then dropped, so any value does.
    pub(super) fn poll(&self) -> bool {
        if self.is_stopped() {
            return true;
        }
        if self.host.should_stop() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.is_stopped()
    }

    /// True where a [`Interrupt::poll`] was: the picture is not whole.
    pub(super) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

/// What comes of a render that the host stopped.
pub(super) fn cancelled() -> Error {
    Diagnostic::error(ErrorKind::Cancelled, "the render was stopped").into()
}
