//! `rtscript lsp`: a companion for editors, which speaks the Language Server Protocol on standard input and output.
//!
//! What a document says is asked of its text as it stands (`script::analysis`), at once and on one thread. What is wrong
//! with it is found by running it dry, on threads beside that, a moment after each edit.

mod check;
mod colors;
mod complete;
mod diagnostics;
mod documents;
mod hover;
mod navigate;
mod outline;
mod server;
mod signature;
mod text;
mod uri;
mod wire;

use std::io;

/// Serves the client on standard input and output, and returns the exit code: 0 after `shutdown` and `exit`, else 1.
pub(super) fn lsp() -> u8 {
    server::serve(io::stdin(), io::stdout().lock())
}

/// What a client is answered that sends these bytes, without the checks that run beside.
#[cfg(fuzzing)]
#[must_use]
pub fn lsp_answers(bytes: &[u8]) -> Vec<u8> {
    server::answers(bytes)
}

/// What a client may ask about a document.
#[cfg(fuzzing)]
pub const LSP_METHODS: &[&str] = &server::METHODS;
