//! Messages on a stream: a header with the length, then JSON-RPC 2.0 (Language Server Protocol 3.17, "Base Protocol").
//!
//! Own code rather than the crate `lsp-server`: that takes as much memory as a header asks for, and ends with the first
//! message that is not JSON.

use std::io::{self, BufRead, Read, Write};

use serde_json::{Value, json};

/// Longest message that is read, in bytes. What is longer is passed over.
const MOST: u64 = 64 << 20;

/// Longest line of a header.
const HEADER_LINE: u64 = 8 << 10;

/// A parse error, as JSON-RPC numbers them.
pub(super) const PARSE_ERROR: i32 = -32_700;
/// What was sent is no request.
pub(super) const INVALID_REQUEST: i32 = -32_600;
/// There is no such method.
pub(super) const METHOD_NOT_FOUND: i32 = -32_601;
/// The parameters are not as the method wants them.
pub(super) const INVALID_PARAMS: i32 = -32_602;
/// A fault of the server's own.
pub(super) const INTERNAL_ERROR: i32 = -32_603;
/// A request before `initialize`.
pub(super) const NOT_INITIALIZED: i32 = -32_002;
/// The client does not want the answer any more.
pub(super) const CANCELLED: i32 = -32_800;
/// The request cannot be done, through no fault of the server.
pub(super) const REQUEST_FAILED: i32 = -32_803;

/// What was read.
#[derive(Debug, PartialEq)]
pub(super) enum Incoming {
    /// A message that is JSON.
    Message(Value),
    /// Something else, and what is wrong with it.
    Malformed(String),
}

/// Reads the next message; `None` at the end of the stream.
pub(super) fn read(from: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    read_up_to(MOST, from)
}

fn read_up_to(most: u64, from: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if from.by_ref().take(HEADER_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        match line.split_once(':') {
            Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                length = value.trim().parse::<u64>().ok();
            }
            _ if line.is_empty() && length.is_some() => break,
            _ => {}
        }
    }
    let length = length.unwrap_or(0);
    if length > most {
        let passed = io::copy(&mut from.by_ref().take(length), &mut io::sink())?;
        let what = format!("a message of {length} bytes is longer than the {most} that are read");
        return Ok((passed == length).then_some(Incoming::Malformed(what)));
    }
    let mut body = Vec::new();
    from.by_ref().take(length).read_to_end(&mut body)?;
    if (body.len() as u64) < length {
        return Ok(None);
    }
    Ok(Some(match serde_json::from_slice(&body) {
        Ok(message) => Incoming::Message(message),
        Err(error) => Incoming::Malformed(format!("not JSON: {error}")),
    }))
}

/// Writes a message.
pub(super) fn write(to: &mut impl Write, message: &Value) -> io::Result<()> {
    let body = message.to_string();
    write!(to, "Content-Length: {}\r\n\r\n{body}", body.len())?;
    to.flush()
}

/// Adds a member to an object.
pub(super) fn add(object: &mut Value, name: &str, value: Value) {
    if let Some(members) = object.as_object_mut() {
        members.insert(name.to_owned(), value);
    }
}

/// The answer to a request.
pub(super) fn response(id: &Value, result: Result<Value, Failure>) -> Value {
    match result {
        Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
        Err(failure) => json!({
            "jsonrpc": "2.0",
            "id": id,
            "error": { "code": failure.code, "message": failure.message },
        }),
    }
}

/// A message that wants no answer.
pub(super) fn notification(method: &str, params: Value) -> Value {
    json!({ "jsonrpc": "2.0", "method": method, "params": params })
}

/// Why a request has no result.
#[derive(Debug, PartialEq)]
pub(super) struct Failure {
    pub(super) code: i32,
    pub(super) message: String,
}

impl Failure {
    pub(super) fn new(code: i32, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }

    /// Parameters that lack something.
    pub(super) fn params(what: &str) -> Self {
        Self::new(INVALID_PARAMS, format!("expected {what}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<Incoming> {
        let mut from = bytes;
        let mut found = Vec::new();
        while let Some(message) = read(&mut from).unwrap() {
            found.push(message);
        }
        found
    }

    #[test]
    fn messages_are_read_as_they_are_written() {
        let mut bytes = Vec::new();
        for text in ["é", "\u{1f600}", ""] {
            write(&mut bytes, &notification("a", json!({ "text": text }))).unwrap();
        }
        let found = all(&bytes);
        assert_eq!(found.len(), 3);
        assert_eq!(
            found[1],
            Incoming::Message(notification("a", json!({ "text": "\u{1f600}" })))
        );
    }

    #[test]
    fn a_message_that_is_too_long_is_passed_over() {
        let mut from = &b"Content-Length: 7\r\n\r\n[1,2,3]Content-Length: 2\r\n\r\n{}"[..];
        let first = read_up_to(4, &mut from).unwrap();
        assert!(
            matches!(&first, Some(Incoming::Malformed(why)) if why.contains("7 bytes")),
            "{first:?}"
        );
        assert_eq!(
            read_up_to(4, &mut from).unwrap(),
            Some(Incoming::Message(json!({})))
        );
    }

    #[test]
    fn what_is_no_message_is_passed_over() {
        let found = all(b"nonsense\r\n\r\nContent-Length: x\r\n\r\ncontent-length: 3\r\nA: b\r\n\r\n{x}Content-Length: 2\n\n{}");
        assert!(
            matches!(&found[0], Incoming::Malformed(why) if why.starts_with("not JSON")),
            "{found:?}"
        );
        assert_eq!(found[1..], [Incoming::Message(json!({}))]);
        assert_eq!(all(b"Content-Length: 99999999999999\r\n\r\n{}"), []);
        assert_eq!(all(b"Content-Length: 20\r\n\r\n{}"), []);
        assert_eq!(all(&[b'x'; 100_000]), []);
        let deep = format!("{}{}", "[".repeat(10_000), "]".repeat(10_000));
        let framed = format!("Content-Length: {}\r\n\r\n{deep}", deep.len());
        assert!(matches!(all(framed.as_bytes())[..], [Incoming::Malformed(_)]));
    }
}
