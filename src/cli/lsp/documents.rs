//! The documents that the client has open, and the files beside them.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
    sync::{Arc, OnceLock},
};

use serde_json::Value;

use super::{
    text::{Encoding, Lines},
    uri,
};
use crate::{host, limits::Limits, script::analysis::Analysis};

/// Texts of open files, by path.
pub(super) type Texts = Arc<BTreeMap<PathBuf, Arc<str>>>;

/// A text, as the client has it or as it is on disk.
#[derive(Debug)]
pub(super) struct Document {
    pub(super) uri: String,
    /// Where it is saved, or will be; `None` for one that has no place yet.
    pub(super) path: Option<PathBuf>,
    pub(super) version: i64,
    pub(super) text: Arc<str>,
    pub(super) lines: Lines,
    pub(super) encoding: Encoding,
    analysis: OnceLock<Analysis>,
}

impl Document {
    pub(super) fn new(uri: &str, version: i64, text: impl Into<Arc<str>>, encoding: Encoding) -> Self {
        let text = text.into();
        Self {
            uri: uri.to_owned(),
            path: uri::to_path(uri).map(|path| normal(&path)),
            version,
            lines: Lines::of(&text),
            text,
            encoding,
            analysis: OnceLock::new(),
        }
    }

    /// What the text says. One that is too large to be run is not looked at.
    pub(super) fn analysis(&self) -> &Analysis {
        self.analysis.get_or_init(|| {
            if self.text.len() > Limits::default().source_bytes {
                Analysis::of("")
            } else {
                Analysis::of(Arc::clone(&self.text))
            }
        })
    }

    /// What messages call it.
    pub(super) fn name(&self) -> String {
        match &self.path {
            Some(path) => path.to_string_lossy().replace('\\', "/"),
            None => self.uri.clone(),
        }
    }

    /// The folder its files are read below.
    pub(super) fn folder(&self) -> Option<&Path> {
        self.path.as_deref().and_then(Path::parent)
    }

    /// The byte of a place of the protocol.
    pub(super) fn offset(&self, place: &Value) -> Option<usize> {
        self.lines.offset(&self.text, place, self.encoding)
    }

    /// A range for the client.
    pub(super) fn span(&self, range: &std::ops::Range<usize>) -> Value {
        self.lines.span(&self.text, range, self.encoding)
    }

    /// Replaces a part, or everything where there is no range.
    fn change(&mut self, change: &Value) -> Option<()> {
        let new = change.get("text")?.as_str()?;
        let text = match change.get("range").filter(|r| !r.is_null()) {
            None => new.to_owned(),
            Some(range) => {
                let range = self.lines.range(&self.text, range, self.encoding)?;
                [self.text.get(..range.start)?, new, self.text.get(range.end..)?].concat()
            }
        };
        self.lines = Lines::of(&text);
        self.text = text.into();
        self.analysis = OnceLock::new();
        Some(())
    }
}

/// All open documents, by URI.
#[derive(Debug, Default)]
pub(super) struct Documents {
    pub(super) encoding: Encoding,
    open: BTreeMap<String, Document>,
}

impl Documents {
    pub(super) fn get(&self, uri: &str) -> Option<&Document> {
        self.open.get(uri)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Document> {
        self.open.values()
    }

    pub(super) fn open(&mut self, uri: &str, version: i64, text: &str) {
        let document = Document::new(uri, version, text, self.encoding);
        self.open.insert(uri.to_owned(), document);
    }

    /// Applies the changes in order; `None` where the document is not open or a change makes no sense.
    pub(super) fn change(&mut self, uri: &str, version: i64, changes: &[Value]) -> Option<()> {
        let document = self.open.get_mut(uri)?;
        document.version = version;
        changes.iter().try_for_each(|change| document.change(change))
    }

    pub(super) fn close(&mut self, uri: &str) -> Option<Document> {
        self.open.remove(uri)
    }

    /// The texts as they stand, for a check that goes on while they change.
    pub(super) fn texts(&self) -> Texts {
        let of_files = self
            .open
            .values()
            .filter_map(|d| Some((d.path.clone()?, Arc::clone(&d.text))));
        Arc::new(of_files.collect())
    }

    /// Calls `answer` with the file that a script names, as it is open or else as it is on disk.
    pub(super) fn beside<T>(
        &self,
        script: &Document,
        file: &str,
        answer: impl FnOnce(&Document) -> T,
    ) -> Option<T> {
        let folder = script.folder()?;
        let path = normal(&folder.join(file));
        if let Some(open) = self
            .open
            .values()
            .find(|d| d.path.as_deref() == Some(path.as_path()))
        {
            return Some(answer(open));
        }
        let most = Limits::default().source_bytes as u64;
        let bytes = host::read_below(folder, file, most).ok()?;
        let text = String::from_utf8(bytes).ok()?;
        Some(answer(&Document::new(
            &uri::of_path(&path),
            0,
            text,
            self.encoding,
        )))
    }

    /// As [`Documents::beside`], for a module by the name in its import.
    pub(super) fn module<T>(
        &self,
        script: &Document,
        name: &str,
        answer: impl FnOnce(&Document) -> T,
    ) -> Option<T> {
        self.beside(script, &module_file(name), answer)
    }
}

/// The file of a module, from the name in its import.
pub(super) fn module_file(name: &str) -> String {
    if name.ends_with(".rhai") {
        name.to_owned()
    } else {
        format!("{name}.rhai")
    }
}

/// The path without `.` and `..`, by its words alone.
pub(super) fn normal(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => drop(parts.pop()),
            other => parts.push(other),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn at(line: u32, from: u32, to: u32, text: &str) -> Value {
        let place = |character| json!({ "line": line, "character": character });
        json!({ "range": { "start": place(from), "end": place(to) }, "text": text })
    }

    #[test]
    fn changes_are_applied_in_order() {
        let mut documents = Documents::default();
        documents.open("file:///a.rhai", 1, "let \u{1f600} = 1;\nsphere(1);");
        let changes = [at(0, 4, 6, "x"), at(1, 7, 8, "2, 3"), at(9, 0, 9, "\n// end")];
        documents.change("file:///a.rhai", 2, &changes).unwrap();
        let document = documents.get("file:///a.rhai").unwrap();
        assert_eq!(&*document.text, "let x = 1;\nsphere(2, 3);\n// end");
        assert_eq!(document.version, 2);
        documents
            .change("file:///a.rhai", 3, &[json!({ "text": "new" })])
            .unwrap();
        assert_eq!(&*documents.get("file:///a.rhai").unwrap().text, "new");
        for bad in [json!({}), json!({ "text": 1 }), json!({ "range": 3, "text": "" })] {
            assert_eq!(documents.change("file:///a.rhai", 4, &[bad]), None);
        }
        assert_eq!(documents.change("file:///b.rhai", 1, &[]), None);
    }

    #[test]
    fn paths_are_compared_without_their_detours() {
        assert_eq!(normal(Path::new("/a/./b/../c.rhai")), Path::new("/a/c.rhai"));
    }
}
