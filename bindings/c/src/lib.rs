//! The C API of rtscript: `include/rtscript.h` is made from this crate by cbindgen, and its head says what holds for
//! every function. It is the only crate of the repository outside of `src/accel` with `unsafe` code, since it is
//! handed raw pointers; what a pointer must be is the caller's promise, and what can be checked is checked.

mod border;
mod diagnostic;
mod host;
mod image;
mod options;
mod run;
mod script;

pub use diagnostic::*;
pub use host::*;
pub use image::*;
pub use options::*;
pub use run::*;
pub use script::*;

use std::ffi::{CStr, c_char};

/// The version, with a zero at its end.
const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};

/// The version of rtscript, such as "0.1.0". Is never freed.
#[unsafe(no_mangle)]
pub extern "C" fn rts_version() -> *const c_char {
    VERSION.as_ptr()
}
