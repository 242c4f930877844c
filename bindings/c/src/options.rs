//! What the caller decides.

use std::{
    ffi::{c_char, c_void},
    sync::atomic::{AtomicBool, Ordering},
};

use rtscript::{DirHost, MemoryHost, RenderOptions, RunOptions, parameters::Parameters};

use crate::{
    RtsError, RtsPrint, RtsProgress, RtsRead, RtsStatus,
    border::{ask, attempt_only, bytes, free, of_mut, text},
    host::{Callback, Files},
};

/// Most threads of one render: far more than make it faster anywhere.
const MOST_THREADS: u32 = 1024;

/// What the caller decides about a run or a render: parameters, threads, files, callbacks.
#[derive(Debug, Default)]
pub struct RtsOptions {
    parameters: Parameters,
    threads: u32,
    pub(crate) memory: MemoryHost,
    pub(crate) has_memory: bool,
    pub(crate) files: Files,
    pub(crate) print: Option<Callback<unsafe extern "C" fn(*mut c_void, *const c_char)>>,
    pub(crate) progress: Option<Callback<unsafe extern "C" fn(*mut c_void, u64, u64) -> i32>>,
    pub(crate) cancelled: AtomicBool,
}

impl RtsOptions {
    pub(crate) fn render(&self) -> RenderOptions {
        let mut options = RenderOptions::default();
        options.threads = self.threads as usize;
        options
    }

    pub(crate) fn run(&self) -> RunOptions {
        let mut options = RunOptions::from(&self.parameters);
        options.render = self.render();
        options
    }
}

/// Options that decide nothing: the script's own size and samples, no files, all processors. Belongs to the caller.
#[unsafe(no_mangle)]
pub extern "C" fn rts_options_new() -> *mut RtsOptions {
    Box::into_raw(Box::default())
}

/// Ends options.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_free(options: *mut RtsOptions) {
    // SAFETY: a handle is NULL or came from here, and its user is done with it.
    unsafe { free(options) }
}

/// Decides a parameter: "size" ("640x480"), "samples", "seed", or one that the script declares by
/// `param(name, default)`, as text: "0.5", "true". One that the script does not declare is an error of the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_set(
    options: *mut RtsOptions,
    name: *const c_char,
    value: *const c_char,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        // SAFETY: the caller's promise of a text.
        let name = unsafe { text(name, "the name of the parameter") }?;
        // SAFETY: as above.
        let value = unsafe { text(value, "the value of the parameter") }?;
        let set = options.parameters.set(name, value);
        set.map_err(|what| RtsError::argument(format!("the parameter '{name}' cannot be '{value}': {what}")))
    };
    // SAFETY: the caller's promise of a place for the error.
    unsafe { attempt_only(error, set) }
}

/// Renders with so many threads, at most 1024; 0, as it is at first, takes one for each processor.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_threads(options: *mut RtsOptions, threads: u32) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        if threads > MOST_THREADS {
            return Err(RtsError::argument(format!(
                "expected at most {MOST_THREADS} threads, not {threads}"
            )));
        }
        options.threads = threads;
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Lets scripts read regular files below a folder, and nothing outside of it. Takes the place of a reading callback.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_folder(options: *mut RtsOptions, folder: *const c_char) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        // SAFETY: the caller's promise of a text.
        options.files = Files::Folder(DirHost::new(unsafe { text(folder, "the folder") }?));
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Lets scripts read `length` bytes as the file `path`, a relative path with '/'. They are copied. Files in memory come
/// before those of a folder or a callback.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_file(
    options: *mut RtsOptions,
    path: *const c_char,
    data: *const u8,
    length: usize,
) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        // SAFETY: the caller's promise of a text.
        let path = unsafe { text(path, "the path of the file") }?;
        // SAFETY: the caller's promise of `length` bytes.
        let data = unsafe { bytes(data, length, "the data of the file") }?;
        options.memory.insert(path, data);
        options.has_memory = true;
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Asks `read` for the files that a script reads; NULL for none. Takes the place of a folder.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_reader(
    options: *mut RtsOptions,
    read: RtsRead,
    user: *mut c_void,
) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        options.files = read.map_or(Files::None, |function| Files::Reader(Callback { function, user }));
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Hands what scripts print to `print`; NULL, as it is at first, drops it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_print(
    options: *mut RtsOptions,
    print: RtsPrint,
    user: *mut c_void,
) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        options.print = print.map(|function| Callback { function, user });
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Tells `progress` how far a render is, those that the script begins by `render()` included; NULL for nobody. What it
/// returns can stop the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_progress(
    options: *mut RtsOptions,
    progress: RtsProgress,
    user: *mut c_void,
) -> RtsStatus {
    let set = || {
        // SAFETY: the caller's promise of a handle of its own.
        let options = unsafe { of_mut(options, "the options") }?;
        options.progress = progress.map(|function| Callback { function, user });
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), set) }
}

/// Stops every run and render that uses these options, now and later, with an error of RTS_STATUS_CANCELLED. May be
/// called from any thread while they are in use. A script that is being read is not stopped.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_options_cancel(options: *const RtsOptions) {
    // SAFETY: a handle is NULL or live; what is changed is an atomic.
    unsafe {
        ask(options, (), |options| {
            options.cancelled.store(true, Ordering::Relaxed)
        })
    }
}
