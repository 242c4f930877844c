//! The last net: a panic becomes a message and an exit code.

use std::{
    any::Any,
    panic::{self, AssertUnwindSafe},
    sync::{Mutex, PoisonError},
};

use crate::diag::{Diagnostic, Error, ErrorKind};

/// What the panic said and where, from the hook, which alone knows the place.
static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Keeps panics from printing by themselves; [`guarded`] reports them.
pub(super) fn silence() {
    panic::set_hook(Box::new(|info| {
        let message = said(info.payload()).unwrap_or("no message");
        let place = info
            .location()
            .map(|at| format!(" ({}:{})", at.file(), at.line()))
            .unwrap_or_default();
        let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
        // A panic on another thread often makes a second one: the first is the cause.
        last.get_or_insert(format!("{message}{place}"));
    }));
}

/// Runs `f`; a panic inside comes out as an `Internal` error.
pub(super) fn guarded<T>(f: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    panic::catch_unwind(AssertUnwindSafe(f)).unwrap_or_else(|payload| {
        let last = LAST.lock().unwrap_or_else(PoisonError::into_inner).take();
        let message = last.or_else(|| said(&*payload).map(str::to_owned));
        Err(Diagnostic::error(
            ErrorKind::Internal,
            format!("a fault of rtscript's own: {}", message.unwrap_or_default()),
        )
        .hint("please report it together with the scene that caused it")
        .into())
    })
}

fn said(payload: &(dyn Any + Send)) -> Option<&str> {
    let fixed = payload.downcast_ref::<&str>().copied();
    fixed.or_else(|| payload.downcast_ref::<String>().map(String::as_str))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_internal_error() {
        let error = guarded::<()>(|| panic!("the sky fell")).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Internal);
        assert!(error.to_string().contains("the sky fell"), "{error}");
        assert_eq!(guarded(|| Ok(7)), Ok(7));
    }
}
