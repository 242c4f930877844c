//! The language server: any bytes on its stream, and every question about any text.

use serde_json::{Value, json};

const URI: &str = "file:///scenes/a.rhai";

const CHANGE: &str = "textDocument/didChange";

pub fn run(data: &[u8]) {
    let Some((choice, rest)) = data.split_first() else {
        return;
    };
    if choice.is_multiple_of(8) {
        check(&rtscript::cli::lsp_answers(rest), None);
        return;
    }
    let (places, text) = rest.split_at(rest.len().min(8));
    let text = String::from_utf8_lossy(text);
    let messages = messages(*choice, places, &text);
    let stream: Vec<u8> = messages.iter().flat_map(framed).collect();
    check(&rtscript::cli::lsp_answers(&stream), Some(messages.len()));
}

/// A session about one text: each question at each of the places.
fn messages(choice: u8, places: &[u8], text: &str) -> Vec<Value> {
    let encoding = ["utf-8", "utf-16", "utf-32"][usize::from(choice) % 3];
    let capabilities = json!({ "general": { "positionEncodings": [encoding] } });
    let mut messages = vec![
        json!({ "id": 0, "method": "initialize", "params": { "capabilities": capabilities } }),
        json!({ "method": "textDocument/didOpen", "params": { "textDocument": { "uri": URI, "version": 1, "text": text } } }),
    ];
    for (pair, id) in places.chunks(2).zip(1..) {
        let line = i64::from(pair[0]) - 2;
        let character = i64::from(pair.last().copied().unwrap_or(0)) - 2;
        let place = json!({ "line": line, "character": character });
        let range = json!({ "start": place, "end": { "line": line + 1, "character": character } });
        for question in rtscript::cli::LSP_METHODS.iter().copied().chain([CHANGE]) {
            let params = json!({
                "textDocument": { "uri": URI, "version": 2 },
                "position": place,
                "range": range,
                "newName": "renamed",
                "color": { "red": 0.5, "green": 1, "blue": 0, "alpha": 1 },
                "contentChanges": [{ "range": range, "text": "x(" }],
            });
            messages.push(match question {
                CHANGE => json!({ "method": question, "params": params }),
                _ => json!({ "id": id, "method": question, "params": params }),
            });
        }
    }
    messages
}

fn framed(message: &Value) -> Vec<u8> {
    let mut message = message.clone();
    message["jsonrpc"] = json!("2.0");
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

/// Answers are messages, none of them about a fault of the server's own.
fn check(mut answers: &[u8], asked: Option<usize>) {
    let mut count = 0;
    while !answers.is_empty() {
        let end = answers
            .windows(4)
            .position(|four| four == b"\r\n\r\n")
            .expect("the end of a header");
        let header = std::str::from_utf8(&answers[..end]).expect("a header is text");
        let length: usize = header
            .strip_prefix("Content-Length: ")
            .and_then(|n| n.parse().ok())
            .expect("a length");
        let body = &answers[end + 4..end + 4 + length];
        answers = &answers[end + 4 + length..];
        let answer: Value = serde_json::from_slice(body).expect("an answer is JSON");
        assert_ne!(answer.pointer("/error/code"), Some(&json!(-32_603)), "{answer}");
        count += 1;
    }
    if let Some(asked) = asked {
        assert!(count <= asked, "{count} answers to {asked} messages");
    }
}
