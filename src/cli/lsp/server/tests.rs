use std::io::Cursor;

use super::*;

fn request(id: u64, method: &str, params: Value) -> Value {
    json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params })
}

fn framed(messages: &[Value]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for message in messages {
        wire::write(&mut bytes, message).unwrap();
    }
    bytes
}

/// The exit code and all that was answered.
fn served(bytes: Vec<u8>) -> (u8, Vec<Value>) {
    let mut out = Vec::new();
    let code = serve(Cursor::new(bytes), &mut out);
    (code, written(&out))
}

fn written(mut out: &[u8]) -> Vec<Value> {
    let mut answers = Vec::new();
    while let Some(Incoming::Message(message)) = wire::read(&mut out).unwrap() {
        answers.push(message);
    }
    answers
}

fn opened(text: &str) -> Value {
    wire::notification(
        "textDocument/didOpen",
        json!({ "textDocument": { "uri": "file:///x/a.rhai", "version": 1, "languageId": "rtscript", "text": text } }),
    )
}

#[test]
fn a_session_has_a_beginning_and_an_end() {
    let hover =
        json!({ "textDocument": { "uri": "file:///x/a.rhai" }, "position": { "line": 0, "character": 1 } });
    let (code, answers) = served(framed(&[
        request(1, "textDocument/hover", hover.clone()),
        request(2, "initialize", json!({ "capabilities": {} })),
        request(3, "initialize", json!({})),
        wire::notification("initialized", json!({})),
        opened("sphere(1);"),
        request(4, "textDocument/hover", hover.clone()),
        request(5, "textDocument/unknown", hover.clone()),
        request(
            6,
            "textDocument/hover",
            json!({ "textDocument": { "uri": "file:///none" } }),
        ),
        request(
            7,
            "textDocument/hover",
            json!({ "textDocument": { "uri": "file:///x/a.rhai" } }),
        ),
        wire::notification("textDocument/unknown", json!({})),
        request(8, "shutdown", Value::Null),
        request(9, "textDocument/hover", hover),
        wire::notification("exit", Value::Null),
    ]));
    assert_eq!(code, 0);
    let codes: Vec<(u64, i64)> = answers
        .iter()
        .filter_map(|a| Some((a["id"].as_u64()?, a["error"]["code"].as_i64().unwrap_or(0))))
        .collect();
    let wanted = [
        (1, -32_002),
        (2, 0),
        (3, -32_600),
        (4, 0),
        (5, -32_601),
        (6, -32_602),
        (7, -32_602),
        (8, 0),
        (9, -32_600),
    ];
    assert_eq!(codes, wanted);
    let hover = answers.iter().find(|a| a["id"] == 4).unwrap();
    assert!(
        hover["result"]["contents"]["value"]
            .as_str()
            .unwrap()
            .contains("radius")
    );
}

#[test]
fn an_end_without_shutdown_is_an_error() {
    let initialize = request(1, "initialize", json!({}));
    assert_eq!(served(framed(std::slice::from_ref(&initialize))).0, 1);
    let exit = wire::notification("exit", Value::Null);
    assert_eq!(served(framed(&[initialize.clone(), exit])).0, 1);
    let shutdown = request(2, "shutdown", Value::Null);
    assert_eq!(served(framed(&[initialize, shutdown])).0, 0);
}

#[test]
fn what_is_no_message_is_answered_and_the_session_goes_on() {
    let mut bytes = b"Content-Length: 3\r\n\r\n{x}".to_vec();
    bytes.extend(framed(&[
        json!([1, 2]),
        json!({ "id": {}, "method": "initialize" }),
        json!({ "id": 9 }),
        json!({ "id": 9, "result": 3 }),
        json!("text"),
        request(1, "initialize", Value::Null),
    ]));
    let (_, answers) = served(bytes);
    let codes: Vec<Option<i64>> = answers.iter().map(|a| a["error"]["code"].as_i64()).collect();
    let invalid = Some(-32_600);
    assert_eq!(codes, [Some(-32_700), invalid, invalid, invalid, invalid, None]);
}

#[test]
fn what_is_cancelled_while_it_waits_is_not_done() {
    let (sender, events) = mpsc::channel();
    for message in [
        request(1, "initialize", json!({})),
        request(2, "textDocument/hover", json!({})),
        wire::notification("$/cancelRequest", json!({ "id": 2 })),
        wire::notification("$/cancelRequest", json!({ "id": 7 })),
    ] {
        sender.send(Event::Message(Incoming::Message(message))).unwrap();
    }
    drop(sender);
    let mut out = Vec::new();
    Server::new(&mut out, Checker::start(|_| ())).run(&events);
    let answers = written(&out);
    let codes: Vec<&Value> = answers.iter().map(|a| &a["error"]["code"]).collect();
    assert_eq!(
        (&answers[0]["id"], codes),
        (&json!(2), vec![&json!(-32_800), &Value::Null])
    );
}

#[test]
fn every_request_is_answered_or_cancelled_once() {
    let mut messages = vec![request(0, "initialize", json!({})), opened("let a = 1; a")];
    let color = json!({ "textDocument": { "uri": "file:///x/a.rhai" } });
    for id in 1..100 {
        messages.push(request(id, "textDocument/documentColor", color.clone()));
        messages.push(wire::notification("$/cancelRequest", json!({ "id": id })));
    }
    let (_, answers) = served(framed(&messages));
    let mut ids: Vec<u64> = answers.iter().filter_map(|a| a["id"].as_u64()).collect();
    ids.sort_unstable();
    assert_eq!(ids, (0..100).collect::<Vec<_>>());
    for answer in answers.iter().filter(|a| a["error"].is_object()) {
        assert_eq!(answer["error"]["code"], -32_800);
    }
}

/// Messages cut, changed and put together at random: the server ends by itself and answers in JSON.
#[test]
fn no_message_is_too_strange() {
    let mut state = 3u64;
    let mut random = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n.max(1)
    };
    let values = [
        json!(null),
        json!(-1),
        json!(1e300),
        json!("x"),
        json!([]),
        json!({}),
        json!({ "line": 4_000_000_000u64, "character": 4_000_000_000u64 }),
        json!({ "line": 0, "character": 3 }),
        json!({ "start": { "line": 1, "character": 9 }, "end": { "line": 0, "character": 0 } }),
        json!({ "uri": "file:///x/a.rhai", "version": 2, "text": "fn f(é) { sphere(é, [" }),
        json!([{ "text": "\u{1f600} \"" }, { "range": { "start": { "line": 0, "character": 1 }, "end": { "line": 9, "character": 9 } }, "text": "(" }]),
    ];
    let keys = [
        "textDocument",
        "position",
        "range",
        "color",
        "newName",
        "contentChanges",
        "context",
        "capabilities",
    ];
    let mut methods: Vec<&str> = METHODS.to_vec();
    methods.extend([
        "textDocument/didOpen",
        "textDocument/didChange",
        "textDocument/didClose",
        "textDocument/didSave",
        "workspace/didChangeWatchedFiles",
        "completionItem/resolve",
        "initialize",
    ]);
    for _ in 0..60 {
        let mut messages = vec![
            request(0, "initialize", json!({})),
            opened("let a = [1, 2]; diffuse(a"),
        ];
        for id in 0..40 {
            let mut params = json!({ "textDocument": { "uri": "file:///x/a.rhai" }, "position": { "line": 0, "character": 20 } });
            for _ in 0..random(4) {
                params[keys[random(keys.len())]] = values[random(values.len())].clone();
            }
            let method = methods[random(methods.len())];
            messages.push(if random(2) == 0 {
                request(id, method, params)
            } else {
                wire::notification(method, params)
            });
        }
        let mut bytes = framed(&messages);
        for _ in 0..random(3) {
            let at = random(bytes.len());
            bytes[at] = u8::try_from(random(256)).unwrap();
        }
        if random(2) == 0 {
            bytes.truncate(random(bytes.len()));
        }
        let (code, answers) = served(bytes);
        assert!(code <= 1, "{code}");
        for answer in answers {
            assert_ne!(answer["error"]["code"], wire::INTERNAL_ERROR, "{answer}");
        }
    }
}
