//! What every function does with pointers and with faults, once.

use std::{
    ffi::{CStr, CString, c_char},
    panic::{AssertUnwindSafe, catch_unwind},
    ptr, slice,
};

use crate::{RtsError, RtsStatus};

/// A text for C. A zero inside would end it early, so it becomes the character that stands for what cannot be shown.
pub(crate) fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

/// Does what may fail and tells how it ended: the result in `out`, or the error in `error`.
///
/// # Safety
/// `out` and `error` are NULL or may be written to.
pub(crate) unsafe fn attempt<T>(
    out: *mut *mut T,
    error: *mut *mut RtsError,
    f: impl FnOnce() -> Result<T, RtsError>,
) -> RtsStatus {
    // SAFETY: as this function's own.
    unsafe {
        put(out, ptr::null_mut());
        attempt_only(error, || {
            let into = if out.is_null() {
                Err(RtsError::argument("the place for the result is NULL"))
            } else {
                f()
            };
            let value = into?;
            put(out, Box::into_raw(Box::new(value)));
            Ok(())
        })
    }
}

/// Does what may fail and has no result.
///
/// # Safety
/// `error` is NULL or may be written to.
pub(crate) unsafe fn attempt_only(
    error: *mut *mut RtsError,
    f: impl FnOnce() -> Result<(), RtsError>,
) -> RtsStatus {
    let result = catch_unwind(AssertUnwindSafe(f)).unwrap_or_else(|_| Err(RtsError::internal()));
    let (status, what) = match result {
        Ok(()) => (RtsStatus::Ok, ptr::null_mut()),
        Err(e) => (e.status, Box::into_raw(Box::new(e))),
    };
    // SAFETY: `error` as this function's own; `what` is NULL or was just made by `Box::into_raw`.
    unsafe {
        if error.is_null() {
            free(what);
        } else {
            put(error, what);
        }
    }
    status
}

/// Asks something of a handle; of NULL, and where the answer fails, `none`.
///
/// # Safety
/// `handle` is NULL or a live handle.
pub(crate) unsafe fn ask<'a, T: 'a, R>(handle: *const T, none: R, f: impl FnOnce(&'a T) -> R) -> R {
    // SAFETY: as this function's own.
    match unsafe { handle.as_ref() } {
        Some(handle) => catch_unwind(AssertUnwindSafe(|| f(handle))).unwrap_or(none),
        None => none,
    }
}

/// Ends a handle.
///
/// # Safety
/// `handle` is NULL or was made by `Box::into_raw`, and nobody uses it any more.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: as this function's own.
        let owned = unsafe { Box::from_raw(handle) };
        // There is nobody left to tell of a fault.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(owned)));
    }
}

/// Writes to a place that may be missing.
///
/// # Safety
/// `place` is NULL or may be written to.
pub(crate) unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: as this function's own.
        unsafe { place.write(value) }
    }
}

/// What a handle refers to.
///
/// # Safety
/// `handle` is NULL or a live handle that nobody changes during `'a`.
pub(crate) unsafe fn of<'a, T>(handle: *const T, what: &str) -> Result<&'a T, RtsError> {
    // SAFETY: as this function's own.
    unsafe { handle.as_ref() }.ok_or_else(|| null(what))
}

/// What a handle refers to, to be changed.
///
/// # Safety
/// `handle` is NULL or a live handle that nobody else uses during `'a`.
pub(crate) unsafe fn of_mut<'a, T>(handle: *mut T, what: &str) -> Result<&'a mut T, RtsError> {
    // SAFETY: as this function's own.
    unsafe { handle.as_mut() }.ok_or_else(|| null(what))
}

/// A text that ends in a zero.
///
/// # Safety
/// `text` is NULL or points to bytes that end in a zero and that nobody changes during `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a str, RtsError> {
    if text.is_null() {
        return Err(null(what));
    }
    // SAFETY: as this function's own, and it is not NULL.
    unsafe { CStr::from_ptr(text) }
        .to_str()
        .map_err(|_| RtsError::argument(format!("{what} is not UTF-8 text")))
}

/// Bytes that may be none, in which case `bytes` may be NULL.
///
/// # Safety
/// `bytes` is NULL or points to `length` bytes that nobody changes during `'a`.
pub(crate) unsafe fn bytes<'a>(bytes: *const u8, length: usize, what: &str) -> Result<&'a [u8], RtsError> {
    match (bytes.is_null(), length) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(null(what)),
        (_, length) if length > isize::MAX as usize => Err(RtsError::argument(format!(
            "the length of {what} is not one that memory can have"
        ))),
        // SAFETY: as this function's own; it is not NULL, and no longer than a slice may be.
        _ => Ok(unsafe { slice::from_raw_parts(bytes, length) }),
    }
}

fn null(what: &str) -> RtsError {
    RtsError::argument(format!("{what} is NULL"))
}
