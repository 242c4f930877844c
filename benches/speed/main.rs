//! How fast each part of the way from script to picture is: `cargo bench --bench speed`, with a word after `--`
//! for those whose name holds it, such as `cargo bench --bench speed -- traversal`.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod build;
#[path = "../common/mod.rs"]
mod common;
mod scripts;
mod shading;
mod start;
mod traversal;

fn main() {
    divan::main();
}
