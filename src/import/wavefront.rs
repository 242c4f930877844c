//! What OBJ and MTL files have in common: a statement is a keyword with its arguments, on one line or on several
//! that end in a backslash.

use std::borrow::Cow;

use super::text::{Source, lines};
use crate::{
    diag::{Code, Diagnostic, ErrorKind},
    scene::Builder,
};

/// The text of a file, with whatever is no UTF-8 replaced: names in old encodings still match one another.
///
/// # Errors
/// Where the bytes are no text at all.
pub(super) fn text<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, Diagnostic> {
    let error = |message: &str| Err(Diagnostic::error(ErrorKind::Input, message).at(name, 0, 0));
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => error("the file is UTF-16 text; expected UTF-8"),
        _ if bytes.contains(&0) => error("the file is not text"),
        _ => Ok(String::from_utf8_lossy(bytes)),
    }
}

/// The statements of a file, one at a time.
pub(super) struct Statements<'a, L> {
    text: &'a str,
    lines: L,
    words: Vec<&'a str>,
}

/// All statements of `source`.
pub(super) fn statements<'a>(source: &Source<'a>) -> Statements<'a, impl Iterator<Item = &'a str> + use<'a>> {
    Statements {
        text: source.text,
        lines: lines(source.text),
        words: Vec::new(),
    }
}

/// One statement.
#[derive(Clone, Copy)]
pub(super) struct Statement<'s, 'a> {
    text: &'a str,
    pub(super) keyword: &'a str,
    pub(super) args: &'s [&'a str],
}

impl<'a, L: Iterator<Item = &'a str>> Statements<'a, L> {
    /// The next statement.
    pub(super) fn next(&mut self) -> Option<Statement<'_, 'a>> {
        self.words.clear();
        while let Some(line) = self.lines.next() {
            if !self.take_words(line) && !self.words.is_empty() {
                break;
            }
        }
        let (keyword, args) = self.words.split_first()?;
        Some(Statement {
            text: self.text,
            keyword,
            args,
        })
    }

    /// Takes the words of one line up to a comment; true where the statement goes on in the next line.
    fn take_words(&mut self, line: &'a str) -> bool {
        for word in line.split_ascii_whitespace() {
            // A name may hold any character, and after a name no comment is known to follow.
            if word.starts_with('#') && !self.words.first().is_some_and(|keyword| takes_name(keyword)) {
                return false;
            }
            self.words.push(word);
        }
        let Some(last) = self.words.last_mut().filter(|last| last.ends_with('\\')) else {
            return false;
        };
        *last = last.trim_end_matches('\\');
        if last.is_empty() {
            self.words.pop();
        }
        true
    }
}

fn takes_name(keyword: &str) -> bool {
    let keyword = keyword.to_ascii_lowercase();
    matches!(keyword.as_str(), "mtllib" | "usemtl" | "newmtl" | "g" | "o") || keyword.starts_with("map_")
}

impl<'a> Statement<'_, 'a> {
    /// The arguments from `first` on as one name, spaces and all; empty where there are none.
    pub(super) fn name_from(&self, first: usize) -> Cow<'a, str> {
        let args = self.args.get(first..).unwrap_or(&[]);
        let (Some(start), Some(end)) = (args.first(), args.last()) else {
            return Cow::Borrowed("");
        };
        let base = self.text.as_ptr() as usize;
        let range = start.as_ptr() as usize - base..end.as_ptr() as usize - base + end.len();
        match self.text.get(range) {
            Some(name) if !name.contains(['\n', '\r']) => Cow::Borrowed(name),
            _ => Cow::Owned(args.join(" ")),
        }
    }
}

/// Statements that are not used, for one warning about all of them.
#[derive(Debug, Default)]
pub(super) struct Unused<'a> {
    count: usize,
    first: Option<&'a str>,
}

impl<'a> Unused<'a> {
    pub(super) fn add(&mut self, at: &'a str) {
        self.count += 1;
        self.first.get_or_insert(at);
    }

    /// Warns at the first one, where there is any; `message` gets their number.
    pub(super) fn warn(
        &self,
        source: &Source<'_>,
        builder: &mut Builder,
        message: impl FnOnce(usize) -> String,
        hint: Option<&str>,
    ) {
        if let Some(at) = self.first {
            warn_at(source, at, builder, message(self.count), hint);
        }
    }
}

/// A warning at a word of the file.
pub(super) fn warn_at(
    source: &Source<'_>,
    at: &str,
    builder: &mut Builder,
    message: String,
    hint: Option<&str>,
) {
    let outside = builder.loc();
    let file = builder.file(source.name);
    builder.set_loc(source.loc(at, file));
    builder.warn(Code::IgnoredInput, message, hint);
    builder.set_loc(outside);
}
