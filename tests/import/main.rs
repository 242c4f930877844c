//! What the importers make of good files and of bad ones.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::result_large_err,
    reason = "a test that fails panics, and nobody waits for its errors"
)]
mod bad_obj;
mod convert;
mod course;
mod obj;
mod pictures;
mod texture;
