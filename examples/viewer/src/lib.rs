//! A window onto a script: its picture while it is traced, and again whenever the script or a file that it uses changes.
//!
//! All but the window itself is here, so that it can be tested without one: `canvas` has the pixels, `watched` tells when
//! files change, and `viewer` starts renders and ends them.

pub mod canvas;
pub mod viewer;
pub mod watched;
