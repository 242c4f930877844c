//! Places in a text: bytes here; lines and columns in the client's units there; lines and characters in messages.

use std::ops::Range;

use serde_json::{Value, json};

/// In what a client counts columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    #[default]
    Utf16,
    Utf32,
}

impl Encoding {
    /// The first of those offered that is cheap here, UTF-16 where nothing is offered.
    pub(super) fn negotiate(offered: Option<&Value>) -> Self {
        let offered: Vec<&str> = offered
            .and_then(Value::as_array)
            .map(|list| list.iter().filter_map(Value::as_str).collect())
            .unwrap_or_default();
        match () {
            () if offered.contains(&"utf-8") => Self::Utf8,
            () if offered.contains(&"utf-16") || !offered.contains(&"utf-32") => Self::Utf16,
            () => Self::Utf32,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "utf-8",
            Self::Utf16 => "utf-16",
            Self::Utf32 => "utf-32",
        }
    }

    fn width(self, c: char) -> usize {
        match self {
            Self::Utf8 => c.len_utf8(),
            Self::Utf16 => c.len_utf16(),
            Self::Utf32 => 1,
        }
    }
}

/// Where the lines of a text begin. A line ends with a line feed, a carriage return or both.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate().filter(|(i, b)| match **b {
            b'\n' => true,
            b'\r' => bytes.get(i + 1) != Some(&b'\n'),
            _ => false,
        });
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect();
        Self { starts }
    }

    fn line<'t>(&self, text: &'t str, line: usize) -> &'t str {
        let start = self.starts.get(line).copied().unwrap_or(text.len());
        let end = self.starts.get(line + 1).copied().unwrap_or(text.len());
        let line = text.get(start..end).unwrap_or_default();
        line.trim_end_matches(['\r', '\n'])
    }

    /// The byte of a place. A line or a column past the end counts as the end.
    pub(super) fn offset(&self, text: &str, place: &Value, encoding: Encoding) -> Option<usize> {
        let number = |key| {
            place
                .get(key)
                .and_then(Value::as_u64)
                .map(|n| usize::try_from(n).unwrap_or(usize::MAX))
        };
        let (line, column) = (number("line")?, number("character")?);
        let Some(start) = self.starts.get(line) else {
            return Some(text.len());
        };
        let line = self.line(text, line);
        let mut passed = 0;
        for (i, c) in line.char_indices() {
            if passed >= column {
                return Some(start + i);
            }
            passed += encoding.width(c);
        }
        Some(start + line.len())
    }

    /// The bytes of a range.
    pub(super) fn range(&self, text: &str, range: &Value, encoding: Encoding) -> Option<Range<usize>> {
        let place = |key| self.offset(text, range.get(key)?, encoding);
        let (start, end) = (place("start")?, place("end")?);
        Some(start.min(end)..end.max(start))
    }

    /// The place of a byte, as the client counts.
    pub(super) fn place(&self, text: &str, offset: usize, encoding: Encoding) -> Value {
        let line = self.starts.partition_point(|s| *s <= offset).saturating_sub(1);
        let start = self.starts.get(line).copied().unwrap_or(0);
        let before = text.get(start..offset.min(text.len())).unwrap_or_default();
        let column: usize = before.chars().map(|c| encoding.width(c)).sum();
        json!({ "line": line, "character": column })
    }

    /// A range as the client counts.
    pub(super) fn span(&self, text: &str, range: &Range<usize>, encoding: Encoding) -> Value {
        json!({
            "start": self.place(text, range.start, encoding),
            "end": self.place(text, range.end, encoding),
        })
    }
}

/// The bytes of the word at a message's line and column, both from 1: lines end with a line feed only there. Without a
/// column the line, without a line the first one.
pub(super) fn word_at(text: &str, line: u32, column: u32) -> Range<usize> {
    let mark = if text.starts_with('\u{feff}') { 3 } else { 0 };
    let mut start = mark;
    let body = text.get(mark..).unwrap_or_default();
    let wanted = line.max(1) as usize - 1;
    for (i, this) in body.split_inclusive('\n').enumerate() {
        if i == wanted {
            let this = this.trim_end_matches(['\r', '\n']);
            let word = crate::cli::report::token(this, if line == 0 { 0 } else { column });
            return start + word.start..start + word.end;
        }
        start += this.len();
    }
    start..start
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a\r\né\u{1f600}x\rb\n\n";

    #[test]
    fn places_go_there_and_back_in_every_encoding() {
        let lines = Lines::of(TEXT);
        for encoding in [Encoding::Utf8, Encoding::Utf16, Encoding::Utf32] {
            for (offset, c) in TEXT.char_indices().filter(|(_, c)| !matches!(c, '\n' | '\r')) {
                let place = lines.place(TEXT, offset, encoding);
                assert_eq!(lines.offset(TEXT, &place, encoding), Some(offset), "{c}");
            }
        }
        let at = TEXT.find('x').unwrap();
        for (encoding, column) in [(Encoding::Utf8, 6), (Encoding::Utf16, 3), (Encoding::Utf32, 2)] {
            assert_eq!(
                lines.place(TEXT, at, encoding),
                json!({ "line": 1, "character": column })
            );
        }
        assert_eq!(
            lines.place(TEXT, TEXT.len(), Encoding::Utf8),
            json!({ "line": 4, "character": 0 })
        );
    }

    #[test]
    fn what_is_past_the_end_is_the_end() {
        let lines = Lines::of(TEXT);
        let offset = |line: u64, column: u64| {
            lines.offset(
                TEXT,
                &json!({ "line": line, "character": column }),
                Encoding::Utf16,
            )
        };
        assert_eq!(offset(0, 99), Some(1));
        assert_eq!(offset(99, 0), Some(TEXT.len()));
        assert_eq!(offset(u64::MAX, u64::MAX), Some(TEXT.len()));
        // In the middle of a character of two units: at its end.
        assert_eq!(offset(1, 2), Some(TEXT.find('x').unwrap()));
        assert_eq!(lines.offset(TEXT, &json!({ "line": -1 }), Encoding::Utf16), None);
    }

    #[test]
    fn utf_8_is_taken_where_it_is_offered() {
        let chosen = |offered: Value| Encoding::negotiate(Some(&offered)).name();
        assert_eq!(chosen(json!(["utf-16", "utf-8"])), "utf-8");
        assert_eq!(chosen(json!(["utf-32"])), "utf-32");
        assert_eq!(chosen(json!(["latin-1", 3])), "utf-16");
        assert_eq!(Encoding::negotiate(None).name(), "utf-16");
    }

    #[test]
    fn messages_find_their_word() {
        let word = |text: &'static str, line, column| &text[word_at(text, line, column)];
        assert_eq!(word("a;\n  spere(1);", 2, 3), "spere");
        assert_eq!(word("a;\n  spere(1);", 2, 0), "spere(1);");
        assert_eq!(word("\u{feff}spere(1);", 1, 1), "spere");
        assert_eq!(word("a", 9, 9), "");
        assert_eq!(word("first line\nsecond", 0, 0), "first line");
    }
}
