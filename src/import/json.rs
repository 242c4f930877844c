//! JSON (RFC 8259), as far as model files need it: values that know their place in the text, so that what is wrong with one
//! can be said there.

use std::borrow::Cow;

use super::{
    assets::Assets,
    text::{Source, quoted},
};
use crate::diag::Diagnostic;

/// Values of one file: each takes some fifty bytes, and the largest scenes have a few hundred thousand.
const MOST_VALUES: usize = 1 << 21;
/// Arrays and objects within one another.
const DEEPEST: usize = 128;
/// Values between two questions whether to stop.
const VALUES_PER_QUESTION: usize = 1 << 14;

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Json<'a> {
    /// From here on, in the text that it was read from.
    pub(super) at: &'a str,
    pub(super) value: Value<'a>,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Null,
    Bool(bool),
    /// Finite.
    Number(f64),
    String(Cow<'a, str>),
    Array(Vec<Json<'a>>),
    /// Of several entries with one name the first counts.
    Object(Vec<(Cow<'a, str>, Json<'a>)>),
}

impl Value<'_> {
    /// What it is, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "true or false",
            Self::Number(_) => "a number",
            Self::String(_) => "a string",
            Self::Array(_) => "an array",
            Self::Object(_) => "an object",
        }
    }
}

/// Reads a text that is one value.
///
/// # Errors
/// At the first character that does not fit; where there are too many values, or the host asks to stop.
pub(super) fn parse<'a>(source: &Source<'a>, assets: &Assets<'_>) -> Result<Json<'a>, Diagnostic> {
    let mut parser = Parser {
        source,
        assets,
        rest: source.text,
        values: 0,
    };
    let value = parser.value(0)?;
    parser.space();
    match parser.rest.is_empty() {
        true => Ok(value),
        false => Err(parser.unexpected("the end of the file")),
    }
}

struct Parser<'s, 'a> {
    source: &'s Source<'a>,
    assets: &'s Assets<'s>,
    rest: &'a str,
    values: usize,
}

impl<'a> Parser<'_, 'a> {
    fn space(&mut self) {
        self.rest = self.rest.trim_start_matches([' ', '\t', '\n', '\r']);
    }

    fn error(&self, message: impl Into<String>) -> Diagnostic {
        self.source.error(self.rest, message)
    }

    fn unexpected(&self, wanted: &str) -> Diagnostic {
        match self.rest.chars().next() {
            Some(c) => self.error(format!("expected {wanted}, found {}", quoted(&c.to_string()))),
            None => self.error(format!("expected {wanted}, found the end of the file")),
        }
    }

    /// True where `token` comes next, which then is behind.
    fn take(&mut self, token: char) -> bool {
        self.space();
        let after = self.rest.strip_prefix(token);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    fn value(&mut self, depth: usize) -> Result<Json<'a>, Diagnostic> {
        self.space();
        self.values += 1;
        if self.values > MOST_VALUES {
            return Err(self.error(format!("the file has more than {MOST_VALUES} values of JSON")));
        }
        if self.values.is_multiple_of(VALUES_PER_QUESTION) {
            self.assets.check_stop()?;
        }
        if depth > DEEPEST {
            return Err(self.error(format!("more than {DEEPEST} arrays and objects in one another")));
        }
        let at = self.rest;
        let value = match at.as_bytes().first() {
            Some(b'{') => self.object(depth)?,
            Some(b'[') => self.array(depth)?,
            Some(b'"') => Value::String(self.string()?),
            Some(b'-' | b'0'..=b'9') => Value::Number(self.number()?),
            _ => self.word()?,
        };
        Ok(Json { at, value })
    }

    fn word(&mut self) -> Result<Value<'a>, Diagnostic> {
        let words = [
            ("null", Value::Null),
            ("true", Value::Bool(true)),
            ("false", Value::Bool(false)),
        ];
        for (word, value) in words {
            if let Some(after) = self.rest.strip_prefix(word) {
                self.rest = after;
                return Ok(value);
            }
        }
        Err(self.unexpected("a value"))
    }

    fn object(&mut self, depth: usize) -> Result<Value<'a>, Diagnostic> {
        let mut entries = Vec::new();
        self.take('{');
        if self.take('}') {
            return Ok(Value::Object(entries));
        }
        loop {
            self.space();
            if !self.rest.starts_with('"') {
                return Err(self.unexpected("a name in quotes"));
            }
            let name = self.string()?;
            if !self.take(':') {
                return Err(self.unexpected("':'"));
            }
            entries.push((name, self.value(depth + 1)?));
            if self.take('}') {
                return Ok(Value::Object(entries));
            }
            if !self.take(',') {
                return Err(self.unexpected("',' or '}'"));
            }
        }
    }

    fn array(&mut self, depth: usize) -> Result<Value<'a>, Diagnostic> {
        let mut items = Vec::new();
        self.take('[');
        if self.take(']') {
            return Ok(Value::Array(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            if self.take(']') {
                return Ok(Value::Array(items));
            }
            if !self.take(',') {
                return Err(self.unexpected("',' or ']'"));
            }
        }
    }

    fn number(&mut self) -> Result<f64, Diagnostic> {
        let is_of_number = |c: char| matches!(c, '0'..='9' | '+' | '-' | '.' | 'e' | 'E');
        let end = self.rest.find(|c| !is_of_number(c)).unwrap_or(self.rest.len());
        let (word, after) = self.rest.split_at(end);
        let digits = word.strip_prefix('-').unwrap_or(word).as_bytes();
        // What Rust reads and JSON does not know.
        let is_json = match digits {
            [b'0', b'0'..=b'9', ..] => false,
            [b'0'..=b'9', ..] => !word.contains(".e") && !word.contains(".E") && !word.ends_with('.'),
            _ => false,
        };
        match word.parse::<f64>() {
            Ok(x) if is_json && x.is_finite() => {
                self.rest = after;
                Ok(x)
            }
            Ok(x) if is_json && !x.is_finite() => {
                Err(self.error(format!("the number {} is too large", quoted(word))))
            }
            _ => Err(self.error(format!("expected a number, found {}", quoted(word)))),
        }
    }

    /// A string in quotes, which come next.
    fn string(&mut self) -> Result<Cow<'a, str>, Diagnostic> {
        let open = self.rest;
        let mut rest = open.get(1..).unwrap_or("");
        let mut owned: Option<String> = None;
        loop {
            let end = rest
                .bytes()
                .position(|b| matches!(b, b'"' | b'\\' | 0..=0x1f))
                .unwrap_or(rest.len());
            let (plain, after) = rest.split_at(end);
            self.rest = after;
            match after.as_bytes() {
                [b'"', ..] => {
                    self.rest = after.get(1..).unwrap_or("");
                    return Ok(match owned {
                        Some(text) => Cow::Owned(text + plain),
                        None => Cow::Borrowed(plain),
                    });
                }
                [b'\\', ..] => {
                    let text = owned.get_or_insert_default();
                    text.push_str(plain);
                    text.push(self.escape()?);
                    rest = self.rest;
                }
                [] => {
                    self.rest = open;
                    return Err(self.error("the string does not end"));
                }
                _ => return Err(self.error("a string holds no line ends and no other control characters")),
            }
        }
    }

    /// The character that an escape stands for, which comes next.
    fn escape(&mut self) -> Result<char, Diagnostic> {
        let bad = self.error("expected an escape as \\n or \\u00e9");
        let mut chars = self.rest.chars().skip(1);
        let c = match chars.next() {
            Some(c @ ('"' | '\\' | '/')) => c,
            Some('b') => '\u{8}',
            Some('f') => '\u{c}',
            Some('n') => '\n',
            Some('r') => '\r',
            Some('t') => '\t',
            Some('u') => {
                let (c, length) = unicode(self.rest).ok_or(bad)?;
                self.rest = self.rest.get(length..).unwrap_or("");
                return Ok(c);
            }
            _ => return Err(bad),
        };
        self.rest = self.rest.get(2..).unwrap_or("");
        Ok(c)
    }
}

/// The character of `\u00e9`, or of two such that stand for one, and how many bytes they take. Half of a pair is the
/// character for what is none.
fn unicode(text: &str) -> Option<(char, usize)> {
    let unit = |from: usize| {
        let digits = text.get(from..from + 6)?.strip_prefix("\\u")?;
        let are_digits = digits.bytes().all(|b| b.is_ascii_hexdigit());
        are_digits.then(|| u32::from_str_radix(digits, 16).ok())?
    };
    let first = unit(0)?;
    if (0xd800..0xdc00).contains(&first)
        && let Some(second) = unit(6).filter(|second| (0xdc00..0xe000).contains(second))
    {
        let code = 0x10000 + ((first - 0xd800) << 10) + (second - 0xdc00);
        return Some((char::from_u32(code)?, 12));
    }
    Some((char::from_u32(first).unwrap_or(char::REPLACEMENT_CHARACTER), 6))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, MemoryHost, diag::ErrorKind, import::AssetCache};

    fn read(text: &str) -> Result<String, String> {
        fn show(json: &Json<'_>) -> String {
            match &json.value {
                Value::Null => "null".to_owned(),
                Value::Bool(b) => b.to_string(),
                Value::Number(x) => x.to_string(),
                Value::String(s) => format!("{s:?}"),
                Value::Array(items) => format!("[{}]", items.iter().map(show).collect::<Vec<_>>().join(",")),
                Value::Object(entries) => {
                    let entries = entries
                        .iter()
                        .map(|(name, json)| format!("{name}:{}", show(json)));
                    format!("{{{}}}", entries.collect::<Vec<_>>().join(","))
                }
            }
        }
        let (host, limits, mut cache) = (MemoryHost::new(), Limits::default(), AssetCache::default());
        let assets = Assets::new(&host, &limits, &mut cache);
        let source = Source::new("a.json", text, ErrorKind::Input);
        let error = |d: Diagnostic| format!("{}:{}: {}", d.line, d.column, d.message);
        parse(&source, &assets).map(|json| show(&json)).map_err(error)
    }

    #[test]
    fn values_are_read() {
        let text =
            " {\"a\" : [1, -2.5e-1,0 ,true,null], \"\\u00e9\\\"\\uD83D\\uDE00\\ud800\": {}, \"b\":[] }\r\n";
        assert_eq!(
            read(text).unwrap(),
            "{a:[1,-0.25,0,true,null],\u{e9}\"\u{1f600}\u{fffd}:{},b:[]}"
        );
        assert_eq!(read("\u{feff}1").unwrap(), "1");
        assert_eq!(read("\"\\/\\b\\n\"").unwrap(), "\"/\\u{8}\\n\"");
    }

    #[test]
    fn what_is_none_is_refused_at_its_place() {
        for (text, message) in [
            ("", "1:1: expected a value, found the end of the file"),
            ("[1,\n 2,]", "2:4: expected a value, found ']'"),
            ("{a: 1}", "1:2: expected a name in quotes, found 'a'"),
            ("{\"a\" 1}", "1:6: expected ':', found '1'"),
            ("{\"a\": 1 \"b\"", "1:9: expected ',' or '}', found '\"'"),
            ("[1 2]", "1:4: expected ',' or ']', found '2'"),
            ("1 1", "1:3: expected the end of the file, found '1'"),
            ("[\"abc", "1:2: the string does not end"),
            ("[\"a\\x\"]", "1:4: expected an escape as \\n or \\u00e9"),
            ("[\"\\u12\"]", "1:3: expected an escape as \\n or \\u00e9"),
            (
                "\"a\nb\"",
                "1:3: a string holds no line ends and no other control characters",
            ),
            ("1e999", "1:1: the number '1e999' is too large"),
            ("01", "1:1: expected a number, found '01'"),
            ("1.", "1:1: expected a number, found '1.'"),
            ("-.5", "1:1: expected a number, found '-.5'"),
            ("NaN", "1:1: expected a value, found 'N'"),
        ] {
            assert_eq!(read(text).unwrap_err(), message, "{text}");
        }
    }

    #[test]
    fn neither_depth_nor_number_is_without_bound() {
        let deep = "[".repeat(100_000);
        assert_eq!(
            read(&deep).unwrap_err(),
            "1:130: more than 128 arrays and objects in one another"
        );
        let many = format!("[{}0]", "0,".repeat(MOST_VALUES));
        assert!(
            read(&many)
                .unwrap_err()
                .ends_with("the file has more than 2097152 values of JSON")
        );
    }
}
