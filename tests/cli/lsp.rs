//! `rtscript lsp`, as an editor talks to it.

use std::{
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Child, ChildStdin, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::Duration,
};

use serde_json::{Value, json};

use super::*;

/// Longer than the slowest machine takes for any answer.
const DEADLINE: Duration = Duration::from_secs(300);

/// A client with a server of its own.
struct Client {
    folder: Folder,
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    /// Notifications that came while something else was waited for.
    kept: Vec<Value>,
    id: u64,
}

impl Client {
    /// A session in a folder, initialized.
    fn new(folder: Folder, capabilities: Value) -> (Self, Value) {
        let mut child = folder
            .command(&["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (sender, from) = channel();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            while let Some(message) = read(&mut out) {
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        let mut client = Self {
            to: child.stdin.take().unwrap(),
            folder,
            child,
            from,
            kept: Vec::new(),
            id: 0,
        };
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        let answer = client.ask("initialize", params);
        client.tell("initialized", json!({}));
        (client, answer)
    }

    fn send(&mut self, message: &Value) {
        let body = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        self.to.flush().unwrap();
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request and waits for its result.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.id += 1;
        self.send(&json!({ "jsonrpc": "2.0", "id": self.id, "method": method, "params": params }));
        loop {
            let message = self.from.recv_timeout(DEADLINE).expect("an answer");
            if message["id"] == self.id {
                assert!(message["error"].is_null(), "{method}: {message}");
                return message["result"].clone();
            }
            self.kept.push(message);
        }
    }

    /// Waits for the diagnostics of a version of a file.
    fn diagnostics(&mut self, name: &str, version: u64) -> Vec<Value> {
        let uri = self.uri(name);
        let wanted = |m: &Value| {
            let params = &m["params"];
            m["method"] == "textDocument/publishDiagnostics"
                && params["uri"] == uri
                && params["version"] == version
        };
        let found = match self.kept.iter().position(wanted) {
            Some(i) => self.kept.remove(i),
            None => loop {
                let message = self.from.recv_timeout(DEADLINE).expect("diagnostics");
                if wanted(&message) {
                    break message;
                }
                self.kept.push(message);
            },
        };
        found["params"]["diagnostics"].as_array().unwrap().clone()
    }

    fn uri(&self, name: &str) -> String {
        uri_of(&self.folder.path(name))
    }

    fn open(&mut self, name: &str, text: &str) {
        let uri = self.uri(name);
        let document = json!({ "uri": uri, "languageId": "rtscript", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Asks about a place, line and column from 0.
    fn at(&mut self, method: &str, name: &str, line: u32, column: u32) -> Value {
        let params = json!({
            "textDocument": { "uri": self.uri(name) },
            "position": { "line": line, "character": column },
        });
        self.ask(method, params)
    }

    fn change(&mut self, name: &str, version: u64, changes: Value) {
        let document = json!({ "uri": self.uri(name), "version": version });
        self.tell(
            "textDocument/didChange",
            json!({ "textDocument": document, "contentChanges": changes }),
        );
    }

    /// Ends the session and returns the exit code.
    fn end(mut self) -> i32 {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.child.wait().unwrap().code().expect("it ends by itself")
    }
}

fn uri_of(path: &Path) -> String {
    format!("file://{}", path.display())
}

fn read(from: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if from.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim().split_once(": ") {
            Some(("Content-Length", n)) => length = n.parse().unwrap(),
            _ if line.trim().is_empty() => break,
            _ => {}
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).ok()?;
    Some(serde_json::from_slice(&body).unwrap())
}

fn range(line: u32, from: u32, to: u32) -> Value {
    json!({
        "start": { "line": line, "character": from },
        "end": { "line": line, "character": to },
    })
}

const SCENE: &str = "// \u{1f600}
light([0, 0, 5], [4, 2, 0]);
diffuse(\"#ff8000\");
/// A tower of `n` balls.
fn tower(n) {
    for i in 0..n { sphere(0, i, 0, 0.5); }
}
tower(3);
/* \u{1f600} */ spere(1, 2);
";

#[test]
fn a_session_from_the_first_word_to_the_last() {
    let (mut client, answer) = Client::new(
        Folder::new(),
        json!({ "textDocument": { "completion": { "completionItem": { "snippetSupport": true } } } }),
    );
    assert_eq!(answer["capabilities"]["positionEncoding"], "utf-16");
    assert_eq!(answer["serverInfo"]["name"], "rtscript");

    client.open("scene.rhai", SCENE);
    let found = client.diagnostics("scene.rhai", 1);
    let [error] = found.as_slice() else {
        panic!("{found:?}");
    };
    // The smiling face counts for two.
    assert_eq!(error["range"], range(8, 9, 14));
    assert_eq!(error["severity"], 1);
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("did you mean sphere?"),
        "{error}"
    );

    let hover = client.at("textDocument/hover", "scene.rhai", 1, 2);
    assert_eq!(hover["range"], range(1, 0, 5));
    assert!(
        hover["contents"]["value"].as_str().unwrap().contains("position"),
        "{hover}"
    );
    let hover = client.at("textDocument/hover", "scene.rhai", 7, 1);
    assert!(
        hover["contents"]["value"]
            .as_str()
            .unwrap()
            .contains("A tower of"),
        "{hover}"
    );

    let items = client.at("textDocument/completion", "scene.rhai", 8, 11);
    let labels: Vec<&str> = items
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|i| i["label"].as_str())
        .collect();
    assert!(
        labels.contains(&"sphere") && labels.contains(&"tower"),
        "{labels:?}"
    );

    let help = client.at("textDocument/signatureHelp", "scene.rhai", 5, 37);
    assert_eq!(help["signatures"][0]["label"], "sphere(center, radius)");
    assert_eq!(help["activeParameter"], 1);

    let place = client.at("textDocument/definition", "scene.rhai", 7, 2);
    assert_eq!(place["range"], range(4, 3, 8));

    let document = json!({ "uri": client.uri("scene.rhai") });
    let colors = client.ask("textDocument/documentColor", json!({ "textDocument": document }));
    let ranges: Vec<&Value> = colors.as_array().unwrap().iter().map(|c| &c["range"]).collect();
    assert_eq!(ranges, [&range(1, 17, 26), &range(2, 8, 17)]);
    assert_eq!(colors[1]["color"]["green"], 128.0 / 255.0);
    let params = json!({
        "textDocument": document,
        "range": colors[0]["range"],
        "color": { "red": 0, "green": 0, "blue": 1, "alpha": 1 },
    });
    let presentations = client.ask("textDocument/colorPresentation", params);
    assert_eq!(presentations[0]["textEdit"]["newText"], "[0, 0, 4]");

    let params = json!({
        "textDocument": document,
        "range": error["range"],
        "context": { "diagnostics": [error] },
    });
    let fixes = client.ask("textDocument/codeAction", params);
    let edit = fixes[0]["edit"]["changes"][client.uri("scene.rhai")][0].clone();
    assert_eq!(edit["newText"], "sphere");

    let rest = json!({ "range": range(8, 15, 19), "text": "0, 0, 0, 1" });
    client.change("scene.rhai", 2, json!([edit_as_change(&edit), rest_after(&rest)]));
    assert_eq!(client.diagnostics("scene.rhai", 2), Vec::<Value>::new());
    assert_eq!(client.end(), 0);
}

/// An edit as a client sends it back.
fn edit_as_change(edit: &Value) -> Value {
    json!({ "range": edit["range"], "text": edit["newText"] })
}

/// The same one column further: `sphere` is longer than `spere`.
fn rest_after(change: &Value) -> Value {
    let column = |end: &str| change["range"][end]["character"].as_u64().unwrap() as u32 + 1;
    let line = change["range"]["start"]["line"].as_u64().unwrap() as u32;
    json!({ "range": range(line, column("start"), column("end")), "text": change["text"] })
}

#[test]
fn an_unsaved_module_is_seen_by_the_script_that_imports_it() {
    let folder = Folder::new();
    folder.write("parts.rhai", "fn ball() { spere(1, 2); }\n");
    let (mut client, answer) = Client::new(
        folder,
        json!({ "general": { "positionEncodings": ["utf-8", "utf-16"] } }),
    );
    assert_eq!(answer["capabilities"]["positionEncoding"], "utf-8");
    client.open(
        "scene.rhai",
        "light([0, 0, 5], [1, 1, 1]); diffuse(1, 1, 1);\nimport \"parts\" as parts;\n/* \u{1f600} */ parts::ball();\n",
    );
    let found = client.diagnostics("scene.rhai", 1);
    assert!(
        found[0]["message"]
            .as_str()
            .unwrap()
            .starts_with("parts.rhai:1: unknown function spere"),
        "{found:?}"
    );
    assert_eq!(found[0]["range"]["start"]["line"], 2);
    let there = &found[0]["relatedInformation"][0]["location"];
    assert_eq!(there["uri"], client.uri("parts.rhai"));
    let place = client.at("textDocument/definition", "scene.rhai", 2, 20);
    assert_eq!(
        place,
        json!({ "uri": client.uri("parts.rhai"), "range": range(0, 3, 7) })
    );

    // Mended in the editor, not on disk.
    client.open("parts.rhai", "fn ball() { sphere(0, 0, 0, 1); }\n");
    while !client.diagnostics("scene.rhai", 1).is_empty() {}
    assert_eq!(client.diagnostics("parts.rhai", 1), Vec::<Value>::new());
    assert_eq!(client.end(), 0);
}

#[test]
fn a_script_without_an_end_keeps_nobody_waiting() {
    let (mut client, _) = Client::new(Folder::new(), json!({}));
    client.open("scene.rhai", "loop { }");
    client.open("other.rhai", "sphere(");
    let hover = client.at("textDocument/hover", "other.rhai", 0, 1);
    assert!(hover["contents"].is_object(), "{hover}");
    assert_eq!(client.diagnostics("other.rhai", 1).len(), 1);
    client.change(
        "scene.rhai",
        2,
        json!([{ "text": "light([0, 0, 5], [1, 1, 1]); diffuse(1, 1, 1); sphere(0, 0, 0, 1);" }]),
    );
    assert_eq!(client.diagnostics("scene.rhai", 2), Vec::<Value>::new());
    assert_eq!(client.end(), 0);
}

#[test]
fn without_a_shutdown_the_exit_code_is_1() {
    let (client, _) = Client::new(Folder::new(), json!({}));
    let Client {
        mut child,
        to,
        folder,
        ..
    } = client;
    drop(to);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    drop(folder);
}
