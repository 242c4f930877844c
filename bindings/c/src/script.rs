//! From text to a run.

use std::ffi::c_char;

use rtscript::{Limits, Script};

use crate::{
    RtsDiagnostic, RtsError, RtsOptions, RtsRun, RtsStatus,
    border::{attempt, bytes, c_string, free, of, text},
    host::Guest,
};

/// Limits for one's own scripts: 60 s of script time, 20 million shapes, pictures of 256 million pixels.
pub const RTS_LIMITS_DEFAULT: u32 = 0;

/// Limits for scripts of strangers: 5 s of script time, 200,000 shapes, pictures of 2 million pixels and less.
pub const RTS_LIMITS_UNTRUSTED: u32 = 1;

/// A script that has been read and can be run any number of times, by several threads at once.
#[derive(Debug)]
pub struct RtsScript {
    script: Script,
}

/// Reads a script of `length` bytes of UTF-8 text. `name` is the file as messages are to call it. `limits` is
/// RTS_LIMITS_DEFAULT or RTS_LIMITS_UNTRUSTED and holds for its runs, too. `*script` belongs to the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_script_compile(
    name: *const c_char,
    source: *const c_char,
    length: usize,
    limits: u32,
    script: *mut *mut RtsScript,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let compile = || {
        // SAFETY: the caller's promise of a text.
        let name = unsafe { text(name, "the name of the script") }?;
        // SAFETY: the caller's promise of `length` bytes.
        let source = unsafe { bytes(source.cast(), length, "the text of the script") }?;
        let limits = match limits {
            RTS_LIMITS_DEFAULT => Limits::default(),
            RTS_LIMITS_UNTRUSTED => Limits::untrusted(),
            n => {
                return Err(RtsError::argument(format!(
                    "expected RTS_LIMITS_DEFAULT or RTS_LIMITS_UNTRUSTED as limits, not {n}"
                )));
            }
        };
        let source = str::from_utf8(source)
            .map_err(|_| RtsError::argument("the text of the script is not UTF-8 text"))?;
        Ok(RtsScript {
            script: Script::compile(name, source, &limits)?,
        })
    };
    // SAFETY: the caller's promise of places for the result and the error.
    unsafe { attempt(script, error, compile) }
}

/// Ends a script. Its runs stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_script_free(script: *mut RtsScript) {
    // SAFETY: a handle is NULL or came from here, and its user is done with it.
    unsafe { free(script) }
}

/// Runs a script up to the complete scene. `options` may be NULL. What the script renders by `render()` is rendered on
/// the way. `*run` belongs to the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_script_run(
    script: *const RtsScript,
    options: *const RtsOptions,
    run: *mut *mut RtsRun,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let start = || {
        // SAFETY: the caller's promise of a handle.
        let script = unsafe { of(script, "the script") }?;
        let none = RtsOptions::default();
        // SAFETY: the caller's promise of a handle or NULL.
        let options = unsafe { options.as_ref() }.unwrap_or(&none);
        let report = script.script.run(&Guest::new(options), &options.run())?;
        Ok(RtsRun {
            warnings: RtsDiagnostic::list(&report.warnings),
            names: (report.value.pictures.iter())
                .map(|picture| picture.name.as_deref().map(c_string))
                .collect(),
            run: report.value,
        })
    };
    // SAFETY: the caller's promise of places for the result and the error.
    unsafe { attempt(run, error, start) }
}
