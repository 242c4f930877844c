//! The language: what scripts mean, and what is said of those that mean nothing.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test that fails panics"
)]

mod assets;
mod calling;
mod editions;
mod host;
mod language;
mod limits;
mod maths;
mod mistakes;
mod modules;
mod params;
mod runs;
mod scenes;
