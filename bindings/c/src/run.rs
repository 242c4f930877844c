//! What a script left behind.

use std::{
    ffi::{CString, c_char},
    ptr,
};

use rtscript::{render, script::Run};

use crate::{
    RtsDiagnostic, RtsError, RtsImage, RtsOptions, RtsStatus,
    border::{ask, attempt, free, of},
    diagnostic::{nth, pointer},
    host::Guest,
};

/// What a script left behind: the scene, the pictures that it rendered, warnings.
#[derive(Debug)]
pub struct RtsRun {
    pub(crate) run: Run,
    pub(crate) names: Vec<Option<CString>>,
    pub(crate) warnings: Vec<RtsDiagnostic>,
}

/// Ends a run. Its images stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_free(run: *mut RtsRun) {
    // SAFETY: a handle is NULL or came from here, and its user is done with it.
    unsafe { free(run) }
}

/// The picture of a run, as the command would write it: the last one that the script rendered by `render()`; where it
/// never did, the scene is rendered now. `options` may be NULL; of them threads, progress and cancelling count here.
/// `*image` belongs to the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_render(
    run: *const RtsRun,
    options: *const RtsOptions,
    image: *mut *mut RtsImage,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let make = || {
        // SAFETY: the caller's promise of a handle.
        let run = unsafe { of(run, "the run") }?;
        let none = RtsOptions::default();
        // SAFETY: the caller's promise of a handle or NULL.
        let options = unsafe { options.as_ref() }.unwrap_or(&none);
        if let Some(last) = run.run.pictures.last() {
            return Ok(RtsImage::new(last.image.clone(), Vec::new()));
        }
        let report = render(&run.run.scene, &options.render(), &Guest::new(options))?;
        Ok(RtsImage::new(
            report.value.image,
            RtsDiagnostic::list(&report.warnings),
        ))
    };
    // SAFETY: the caller's promise of places for the result and the error.
    unsafe { attempt(image, error, make) }
}

/// How many pictures the script rendered by itself.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_picture_count(run: *const RtsRun) -> usize {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(run, 0, |run| run.run.pictures.len()) }
}

/// The name under which the script rendered one of its pictures, counted from 0: `render("name.png")`; NULL where it has
/// none. Nothing was written under it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_picture_name(run: *const RtsRun, index: usize) -> *const c_char {
    // SAFETY: a handle is NULL or live.
    unsafe {
        ask(run, ptr::null(), |run| {
            pointer(run.names.get(index).and_then(Option::as_ref))
        })
    }
}

/// One of the pictures that the script rendered by itself, counted from 0. `*image` belongs to the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_picture(
    run: *const RtsRun,
    index: usize,
    image: *mut *mut RtsImage,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let find = || {
        // SAFETY: the caller's promise of a handle.
        let pictures = &unsafe { of(run, "the run") }?.run.pictures;
        let picture = pictures.get(index).ok_or_else(|| {
            RtsError::argument(format!(
                "there is no picture {index}: the script rendered {}",
                pictures.len()
            ))
        })?;
        Ok(RtsImage::new(picture.image.clone(), Vec::new()))
    };
    // SAFETY: the caller's promise of places for the result and the error.
    unsafe { attempt(image, error, find) }
}

/// How many warnings the run has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_warning_count(run: *const RtsRun) -> usize {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(run, 0, |run| run.warnings.len()) }
}

/// One of the warnings of the run, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_run_warning(run: *const RtsRun, index: usize) -> *const RtsDiagnostic {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(run, ptr::null(), |run| nth(&run.warnings, index)) }
}
