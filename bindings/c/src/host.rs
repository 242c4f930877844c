//! What a script reaches, asked of callbacks.

use std::{
    ffi::{c_char, c_void},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use rtscript::{DirHost, Host, Image, NoHost, diag::ErrorKind, host::HostError, render::Progress};

use crate::{
    RtsOptions, RtsStatus,
    border::{attempt_only, bytes, c_string, of_mut},
};

/// Is told how far a render is: `done` of `total` pixels. What is not 0 stops it, with an error of
/// RTS_STATUS_CANCELLED. It is called now and then, from any of the threads that render, never from two of one render
/// at once.
pub type RtsProgress = Option<unsafe extern "C" fn(user: *mut c_void, done: u64, total: u64) -> i32>;

/// Is asked for the file `path`, a relative path with '/' and without '.' and '..'. It hands over the bytes by
/// rts_bytes_put, in one piece or several, and returns RTS_STATUS_OK; or RTS_STATUS_DENIED where the script may not
/// read it, and anything else where there is no such file. More than `max_bytes` is an error of RTS_STATUS_LIMIT. It is
/// called on the thread that called rts_script_run.
pub type RtsRead = Option<
    unsafe extern "C" fn(user: *mut c_void, path: *const c_char, max_bytes: u64, bytes: *mut RtsBytes) -> i32,
>;

/// Receives a line that the script printed, on the thread that called rts_script_run. The text is good until it returns.
pub type RtsPrint = Option<unsafe extern "C" fn(user: *mut c_void, text: *const c_char)>;

/// Takes the bytes of a file from the reading callback, and is good until that returns.
#[derive(Debug, Default)]
pub struct RtsBytes {
    bytes: Vec<u8>,
    max: usize,
    too_many: bool,
}

/// Appends `length` bytes to the file that the reading callback was asked for; they are copied. What is too much for
/// the script's limits is not kept.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_bytes_put(into: *mut RtsBytes, data: *const u8, length: usize) -> RtsStatus {
    let put = || {
        // SAFETY: the callback passes on what it was given, which lives until it returns and is its own until then.
        let into = unsafe { of_mut(into, "the place for the bytes") }?;
        // SAFETY: the caller's promise of `length` bytes.
        let data = unsafe { bytes(data, length, "the data") }?;
        into.too_many |= data.len() > into.max.saturating_sub(into.bytes.len());
        if !into.too_many {
            into.bytes.extend_from_slice(data);
        }
        Ok(())
    };
    // SAFETY: nobody wants the error.
    unsafe { attempt_only(std::ptr::null_mut(), put) }
}

/// A callback and what it is called with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Callback<F> {
    pub(crate) function: F,
    pub(crate) user: *mut c_void,
}

// SAFETY: the pointer is handed back to the callback and never looked at here; whoever sets a callback promises, at the
// top of the header, that it may be called from any thread.
unsafe impl<F: Send> Send for Callback<F> {}
// SAFETY: as above.
unsafe impl<F: Sync> Sync for Callback<F> {}

/// Where files come from that are not in memory.
#[derive(Debug, Default)]
pub(crate) enum Files {
    #[default]
    None,
    Folder(DirHost),
    Reader(Callback<unsafe extern "C" fn(*mut c_void, *const c_char, u64, *mut RtsBytes) -> i32>),
}

/// The host of one run or render.
pub(crate) struct Guest<'o> {
    options: &'o RtsOptions,
    stopped: AtomicBool,
    telling: Mutex<()>,
}

impl<'o> Guest<'o> {
    pub(crate) fn new(options: &'o RtsOptions) -> Self {
        Self {
            options,
            stopped: AtomicBool::new(false),
            telling: Mutex::new(()),
        }
    }
}

impl Host for Guest<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        // What is in memory comes first, and refuses whatever would lead out of the folder.
        match self.options.memory.read(path, max_bytes) {
            Err(e) if e.kind == ErrorKind::Input => {}
            known => return known,
        }
        let read = match &self.options.files {
            Files::None if self.options.has_memory => return self.options.memory.read(path, max_bytes),
            Files::None => return NoHost.read(path, max_bytes),
            Files::Folder(folder) => return folder.read(path, max_bytes),
            Files::Reader(read) => read,
        };
        let mut bytes = RtsBytes {
            max: usize::try_from(max_bytes).unwrap_or(usize::MAX),
            ..RtsBytes::default()
        };
        let plain = c_string(&plain_path(path));
        // SAFETY: the function was given as one of this type; path and place for the bytes live until it returns.
        let answer = unsafe { (read.function)(read.user, plain.as_ptr(), max_bytes, &raw mut bytes) };
        let no = |kind, what: String| Err(HostError::new(kind, what));
        match answer {
            0 if bytes.too_many => no(
                ErrorKind::Limit,
                format!("'{path}' is larger than the limit of {max_bytes} bytes for one file"),
            ),
            0 => Ok(bytes.bytes),
            n if n == RtsStatus::Denied as i32 => no(
                ErrorKind::Denied,
                format!("'{path}' may not be read: the program that runs the script refuses it"),
            ),
            _ => no(ErrorKind::Input, format!("cannot read '{path}': no such file")),
        }
    }

    fn print(&self, text: &str) {
        if let Some(print) = &self.options.print {
            let text = c_string(text);
            // SAFETY: the function was given as one of this type; the text lives until it returns.
            unsafe { (print.function)(print.user, text.as_ptr()) }
        }
    }

    fn should_stop(&self) -> bool {
        self.stopped.load(Ordering::Relaxed) || self.options.cancelled.load(Ordering::Relaxed)
    }

    fn progress(&self, progress: &Progress) {
        let Some(tell) = &self.options.progress else {
            return;
        };
        let _one_at_a_time = self.telling.lock().unwrap_or_else(PoisonError::into_inner);
        if self.stopped.load(Ordering::Relaxed) {
            return;
        }
        // SAFETY: the function was given as one of this type.
        if unsafe { (tell.function)(tell.user, progress.done, progress.total) } != 0 {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        // The run keeps it: rts_run_picture.
        Ok(())
    }
}

/// A path that stays below its folder, without the parts that lead nowhere.
fn plain_path(path: &str) -> String {
    let mut parts = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}
