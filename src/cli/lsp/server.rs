//! One client: its messages in the order in which they come, what is known of it, and the answers.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    io::{BufReader, Read, Write},
    path::{Path, PathBuf},
    sync::mpsc::{self, Receiver},
    thread,
};

use serde_json::{Value, json};

use super::{
    check::{Checked, Checker, Job},
    colors, complete,
    diagnostics::{self, Published},
    documents::{Document, Documents, normal},
    hover, navigate, outline, signature,
    text::Encoding,
    uri,
    wire::{self, Failure, Incoming},
};
use crate::cli::guard;

/// Messages that wait; a client that sends more is not read from until some are answered.
const WAITING: usize = 256;

/// What comes in.
enum Event {
    Message(Incoming),
    End,
    Checked(Checked),
}

/// How far the session is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    New,
    Running,
    ShutDown,
}

struct Server<W> {
    to: W,
    phase: Phase,
    /// The client fills in places in what is completed.
    snippets: bool,
    documents: Documents,
    checker: Checker,
    published: BTreeMap<String, Vec<Published>>,
    /// Files that the last check of each document read.
    reads: BTreeMap<String, BTreeSet<PathBuf>>,
}

/// Serves a client until it says `exit` or goes away, and returns the exit code: 0 where it said `shutdown` before.
pub(super) fn serve(from: impl Read + Send + 'static, to: impl Write) -> u8 {
    let (sender, events) = mpsc::sync_channel(WAITING);
    let results = sender.clone();
    let checker = Checker::start(move |checked| {
        // Where nobody listens any more, nobody misses it.
        let _ = results.send(Event::Checked(checked));
    });
    let reader = thread::Builder::new().name("rtscript client".to_owned());
    let reading = reader.spawn(move || {
        let mut from = BufReader::new(from);
        loop {
            let event = match wire::read(&mut from) {
                Ok(Some(message)) => Event::Message(message),
                Ok(None) | Err(_) => Event::End,
            };
            let ends = matches!(event, Event::End);
            if sender.send(event).is_err() || ends {
                return;
            }
        }
    });
    if reading.is_err() {
        return 70;
    }
    Server::new(to, checker).run(&events)
}

/// Serves a client on this thread, without checks: the same bytes give the same answers.
#[cfg(fuzzing)]
pub(super) fn answers(bytes: &[u8]) -> Vec<u8> {
    let (mut from, mut to) = (bytes, Vec::new());
    let mut server = Server::new(&mut to, Checker::idle());
    while let Ok(Some(incoming)) = wire::read(&mut from) {
        if let Incoming::Message(message) = incoming {
            server.receive(&message);
        }
    }
    to
}

impl<W: Write> Server<W> {
    fn new(to: W, checker: Checker) -> Self {
        Self {
            to,
            phase: Phase::New,
            snippets: false,
            documents: Documents::default(),
            checker,
            published: BTreeMap::new(),
            reads: BTreeMap::new(),
        }
    }

    fn run(&mut self, events: &Receiver<Event>) -> u8 {
        let mut waiting: VecDeque<Event> = VecDeque::new();
        loop {
            if waiting.is_empty() {
                waiting.extend(events.recv().ok());
            }
            // What is cancelled is only seen by looking ahead.
            while waiting.len() < WAITING
                && let Ok(event) = events.try_recv()
            {
                match cancelled(&event) {
                    Some(id) => {
                        let request = waiting.iter().position(|e| is_request(e, &id));
                        if request.and_then(|i| waiting.remove(i)).is_some() {
                            let why = Failure::new(wire::CANCELLED, "cancelled");
                            self.send(&wire::response(&id, Err(why)));
                        }
                    }
                    None => waiting.push_back(event),
                }
            }
            match waiting.pop_front() {
                None | Some(Event::End) => return u8::from(self.phase != Phase::ShutDown),
                Some(Event::Checked(checked)) => self.publish(&checked),
                Some(Event::Message(Incoming::Malformed(why))) => {
                    let why = Failure::new(wire::PARSE_ERROR, why);
                    self.send(&wire::response(&Value::Null, Err(why)));
                }
                Some(Event::Message(Incoming::Message(message))) => {
                    if message.get("method").and_then(Value::as_str) == Some("exit") {
                        return u8::from(self.phase != Phase::ShutDown);
                    }
                    self.receive(&message);
                }
            }
        }
    }

    /// A client that went away is noticed where it is read from.
    fn send(&mut self, message: &Value) {
        let _ = wire::write(&mut self.to, message);
    }

    fn receive(&mut self, message: &Value) {
        let method = message.get("method").and_then(Value::as_str);
        let id = message.get("id");
        let has_id = id.is_some_and(|id| id.is_number() || id.is_string());
        let params = message.get("params").unwrap_or(&Value::Null);
        match (method, id) {
            (Some(method), Some(id)) if has_id => {
                let result = guard::guarded(|| Ok(self.request(method, params)));
                let result = result.unwrap_or_else(|e| {
                    Err(Failure::new(wire::INTERNAL_ERROR, e.diagnostic.message.clone()))
                });
                self.send(&wire::response(id, result));
            }
            (Some(method), None) => {
                if self.phase == Phase::Running {
                    // A notification that lacks something cannot be answered.
                    let _ = guard::guarded(|| Ok(self.notified(method, params)));
                }
            }
            // The answer to a request of ours, of which there are none.
            (None, Some(_))
                if has_id && (message.get("result").is_some() || message.get("error").is_some()) => {}
            (_, id) => {
                let id = id.filter(|_| has_id).unwrap_or(&Value::Null);
                let why = Failure::new(wire::INVALID_REQUEST, "expected a request or a notification");
                self.send(&wire::response(id, Err(why)));
            }
        }
    }

    fn request(&mut self, method: &str, params: &Value) -> Result<Value, Failure> {
        match (self.phase, method) {
            (Phase::New, "initialize") => return Ok(self.initialize(params)),
            (Phase::New, _) => return Err(Failure::new(wire::NOT_INITIALIZED, "initialize comes first")),
            (Phase::ShutDown, _) => {
                return Err(Failure::new(wire::INVALID_REQUEST, "the server is shut down"));
            }
            (Phase::Running, "initialize") => {
                return Err(Failure::new(wire::INVALID_REQUEST, "initialize was sent before"));
            }
            (Phase::Running, "shutdown") => {
                self.phase = Phase::ShutDown;
                for document in self.documents.all() {
                    self.checker.forget(&document.uri);
                }
                return Ok(Value::Null);
            }
            (Phase::Running, "completionItem/resolve") => return Ok(complete::resolve(params.clone())),
            (Phase::Running, _) => {}
        }
        if !METHODS.contains(&method) {
            return Err(Failure::new(
                wire::METHOD_NOT_FOUND,
                format!("there is no method {method}"),
            ));
        }
        let document = self.document(params)?;
        self.ask(method, params, document)
    }

    /// What is asked about a document.
    fn ask(&self, method: &str, params: &Value, document: &Document) -> Result<Value, Failure> {
        let offset = || {
            let place = params.get("position").and_then(|place| document.offset(place));
            place.ok_or_else(|| Failure::params("position with line and character"))
        };
        let documents = &self.documents;
        let spans = |ranges: Vec<std::ops::Range<usize>>| ranges.into_iter().map(|r| document.span(&r));
        Ok(match method {
            "textDocument/hover" => match hover::hover(documents, document, offset()?) {
                Some((range, text)) => json!({
                    "contents": { "kind": "markdown", "value": text },
                    "range": document.span(&range),
                }),
                None => Value::Null,
            },
            "textDocument/completion" => {
                Value::Array(complete::complete(documents, document, offset()?, self.snippets))
            }
            "textDocument/signatureHelp" => {
                signature::signature(documents, document, offset()?).unwrap_or(Value::Null)
            }
            "textDocument/definition" => {
                navigate::definition(documents, document, offset()?).unwrap_or(Value::Null)
            }
            "textDocument/references" => spans(navigate::references(document, offset()?))
                .map(|range| json!({ "uri": document.uri, "range": range }))
                .collect(),
            "textDocument/documentHighlight" => spans(navigate::references(document, offset()?))
                .map(|range| json!({ "range": range }))
                .collect(),
            "textDocument/prepareRename" => {
                navigate::renameable(document, offset()?).map_or(Value::Null, |range| document.span(&range))
            }
            "textDocument/rename" => {
                let name = params.get("newName").and_then(Value::as_str);
                navigate::rename(
                    document,
                    offset()?,
                    name.ok_or_else(|| Failure::params("newName"))?,
                )?
            }
            "textDocument/documentSymbol" => Value::Array(outline::symbols(document)),
            "textDocument/foldingRange" => Value::Array(outline::folds(document)),
            "textDocument/documentColor" => Value::Array(colors::colors(document)),
            "textDocument/colorPresentation" => {
                let (range, color) = (params.get("range"), params.get("color"));
                let all = range
                    .zip(color)
                    .and_then(|(r, c)| colors::presentations(document, r, c));
                Value::Array(all.ok_or_else(|| Failure::params("range and color"))?)
            }
            _ => {
                let range = params
                    .get("range")
                    .and_then(|r| document.lines.range(&document.text, r, document.encoding));
                let range = range.ok_or_else(|| Failure::params("range"))?;
                let only = params.pointer("/context/only").and_then(Value::as_array);
                let wanted = only.is_none_or(|kinds| kinds.iter().any(|k| k == "quickfix" || k == ""));
                let all = self.published.get(&document.uri).filter(|_| wanted);
                Value::Array(
                    all.map(|all| diagnostics::actions(document, all, &range))
                        .unwrap_or_default(),
                )
            }
        })
    }

    fn document(&self, params: &Value) -> Result<&Document, Failure> {
        let uri = uri_of(params).ok_or_else(|| Failure::params("textDocument with a uri"))?;
        let document = self.documents.get(uri);
        document.ok_or_else(|| Failure::params(&format!("an open document, which {uri} is not")))
    }

    fn initialize(&mut self, params: &Value) -> Value {
        self.phase = Phase::Running;
        self.documents.encoding =
            Encoding::negotiate(params.pointer("/capabilities/general/positionEncodings"));
        let snippets = "/capabilities/textDocument/completion/completionItem/snippetSupport";
        self.snippets = params.pointer(snippets).and_then(Value::as_bool).unwrap_or(false);
        json!({
            "capabilities": {
                "positionEncoding": self.documents.encoding.name(),
                // Changes come as parts of the text.
                "textDocumentSync": { "openClose": true, "change": 2, "save": { "includeText": false } },
                "hoverProvider": true,
                "completionProvider": { "triggerCharacters": [".", ":", "\"", "/"], "resolveProvider": true },
                "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
                "definitionProvider": true,
                "referencesProvider": true,
                "documentHighlightProvider": true,
                "renameProvider": { "prepareProvider": true },
                "documentSymbolProvider": true,
                "foldingRangeProvider": true,
                "colorProvider": true,
                "codeActionProvider": { "codeActionKinds": ["quickfix"] },
            },
            "serverInfo": { "name": "rtscript", "version": env!("CARGO_PKG_VERSION") },
        })
    }

    /// A notification; `None` where it lacks something or is not known.
    fn notified(&mut self, method: &str, params: &Value) -> Option<()> {
        match method {
            "textDocument/didOpen" => {
                let opened = params.get("textDocument")?;
                let uri = uri_of(params)?.to_owned();
                self.documents
                    .open(&uri, version(opened), opened.get("text")?.as_str()?);
                self.check(&uri);
            }
            "textDocument/didChange" => {
                let uri = uri_of(params)?.to_owned();
                let changes = params.get("contentChanges")?.as_array()?;
                self.documents
                    .change(&uri, version(params.get("textDocument")?), changes)?;
                self.check(&uri);
            }
            "textDocument/didSave" => self.check(uri_of(params)?),
            "textDocument/didClose" => {
                let closed = self.documents.close(uri_of(params)?)?;
                self.checker.forget(&closed.uri);
                self.published.remove(&closed.uri);
                self.reads.remove(&closed.uri);
                self.send(&diagnostics::message(&closed.uri, None, &[]));
                if let Some(path) = &closed.path {
                    self.check_readers(path);
                }
            }
            "workspace/didChangeWatchedFiles" => {
                for change in params.get("changes")?.as_array()? {
                    if let Some(path) = change.get("uri").and_then(Value::as_str).and_then(uri::to_path) {
                        self.check_readers(&normal(&path));
                    }
                }
            }
            _ => {}
        }
        Some(())
    }

    /// Checks a document and those that read it.
    fn check(&self, uri: &str) {
        let Some(document) = self.documents.get(uri) else {
            return;
        };
        self.checker.schedule(Job::new(document, self.documents.texts()));
        if let Some(path) = &document.path {
            self.check_readers(path);
        }
    }

    fn check_readers(&self, path: &Path) {
        let readers = self.reads.iter().filter(|(_, reads)| reads.contains(path));
        for document in readers.filter_map(|(uri, _)| self.documents.get(uri)) {
            self.checker.schedule(Job::new(document, self.documents.texts()));
        }
    }

    fn publish(&mut self, checked: &Checked) {
        let document = self.documents.get(&checked.uri);
        let Some(document) =
            document.filter(|d| d.version == checked.version && self.phase == Phase::Running)
        else {
            return;
        };
        let all = diagnostics::published(document, checked);
        let message = diagnostics::message(&checked.uri, Some(checked.version), &all);
        self.reads.insert(checked.uri.clone(), checked.reads.clone());
        self.published.insert(checked.uri.clone(), all);
        self.send(&message);
    }
}

/// Requests about a document.
pub(super) const METHODS: [&str; 13] = [
    "textDocument/hover",
    "textDocument/completion",
    "textDocument/signatureHelp",
    "textDocument/definition",
    "textDocument/references",
    "textDocument/documentHighlight",
    "textDocument/prepareRename",
    "textDocument/rename",
    "textDocument/documentSymbol",
    "textDocument/foldingRange",
    "textDocument/documentColor",
    "textDocument/colorPresentation",
    "textDocument/codeAction",
];

fn uri_of(params: &Value) -> Option<&str> {
    params.pointer("/textDocument/uri").and_then(Value::as_str)
}

fn version(document: &Value) -> i64 {
    document.get("version").and_then(Value::as_i64).unwrap_or(0)
}

/// The request that a message cancels.
fn cancelled(event: &Event) -> Option<Value> {
    match event {
        Event::Message(Incoming::Message(message)) if message.get("method")? == "$/cancelRequest" => {
            message.pointer("/params/id").cloned()
        }
        _ => None,
    }
}

fn is_request(event: &Event, id: &Value) -> bool {
    matches!(event, Event::Message(Incoming::Message(m)) if m.get("id") == Some(id) && m.get("method").is_some())
}

#[cfg(test)]
mod tests;
