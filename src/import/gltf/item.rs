//! Values of a file with the way that leads to them: what is wrong is said as `meshes[3].primitives[0].indices: ...`.

use std::fmt;

use super::super::{
    json::{Json, Value},
    text::{Source, counted, quoted},
};
use crate::{
    color::Color,
    diag::{Code, Diagnostic, ErrorKind, SourceLoc},
    scene::Builder,
};

/// A file.
#[derive(Clone, Copy)]
pub(super) struct Document<'a> {
    pub(super) source: Source<'a>,
    /// Whether people see its text when they open it; in a `.glb` file lines and columns are none.
    pub(super) is_text: bool,
}

/// A value of the file.
#[derive(Clone, Copy)]
pub(super) struct Item<'p, 'a> {
    document: &'p Document<'a>,
    json: &'p Json<'a>,
    step: Step<'p, 'a>,
}

/// How a value is reached.
#[derive(Clone, Copy)]
enum Step<'p, 'a> {
    Root,
    Field(&'p Item<'p, 'a>, &'p str),
    Entry(&'p Item<'p, 'a>, usize),
}

/// The way to a value as people write it.
impl fmt::Display for Item<'_, '_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.step {
            Step::Root => Ok(()),
            Step::Field(of, name) if matches!(of.step, Step::Root) => f.write_str(name),
            Step::Field(of, name) => write!(f, "{of}.{name}"),
            Step::Entry(of, i) => write!(f, "{of}[{i}]"),
        }
    }
}

/// What a number of an entry leads to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    /// One of them: `accessor`.
    pub(super) one: &'static str,
    /// Where they are: `accessors`.
    pub(super) list: &'static str,
}

impl<'p, 'a> Item<'p, 'a> {
    /// The file itself.
    pub(super) fn root(document: &'p Document<'a>, json: &'p Json<'a>) -> Self {
        Self {
            document,
            json,
            step: Step::Root,
        }
    }

    /// An object without entries in place of one that is not there.
    pub(super) fn nothing(of: &Item<'p, 'a>) -> Self {
        static NOTHING: Json<'static> = Json {
            at: "",
            value: Value::Object(Vec::new()),
        };
        Self {
            json: &NOTHING,
            ..*of
        }
    }

    /// An error at this value.
    pub(super) fn error(&self, message: impl fmt::Display) -> Diagnostic {
        self.place(Diagnostic::error(
            ErrorKind::Input,
            match self.step {
                Step::Root => message.to_string(),
                _ => format!("{self}: {message}"),
            },
        ))
    }

    /// Gives an error this place.
    pub(super) fn place(&self, error: Diagnostic) -> Diagnostic {
        let Document { source, is_text } = self.document;
        match is_text {
            true => source.place(error, self.json.at),
            false => error.at(source.name, 0, 0),
        }
    }

    /// Warns of something at this value.
    pub(super) fn warn(&self, builder: &mut Builder, message: impl fmt::Display, hint: Option<&str>) {
        let message = match self.step {
            Step::Root => message.to_string(),
            _ => format!("{self}: {message}"),
        };
        let Document { source, is_text } = self.document;
        let outside = builder.loc();
        let file = builder.file(source.name);
        let nowhere = SourceLoc {
            line: 0,
            column: 0,
            file,
        };
        builder.set_loc(if *is_text {
            source.loc(self.json.at, file)
        } else {
            nowhere
        });
        builder.warn(Code::IgnoredInput, message, hint);
        builder.set_loc(outside);
    }

    fn wrong(&self, wanted: impl fmt::Display) -> Diagnostic {
        let found = match &self.json.value {
            Value::Number(_) => {
                let is_end = |c: char| matches!(c, ',' | '}' | ']') || c.is_ascii_whitespace();
                let word: String = self
                    .json
                    .at
                    .chars()
                    .take_while(|c| !is_end(*c))
                    .take(40)
                    .collect();
                word
            }
            Value::String(s) => quoted(s),
            Value::Bool(b) => b.to_string(),
            other => other.kind().to_owned(),
        };
        self.error(format!("expected {wanted}, found {found}"))
    }

    /// Its place in the text, or the text's beginning where nobody sees the text.
    pub(super) fn at(&self) -> &'a str {
        let Document { source, is_text } = self.document;
        if *is_text {
            self.json.at
        } else {
            source.text.get(..0).unwrap_or_default()
        }
    }

    /// The value of that name, if it is there.
    pub(super) fn get(&'p self, name: &'p str) -> Result<Option<Self>, Diagnostic> {
        let Value::Object(entries) = &self.json.value else {
            return Err(self.wrong("an object"));
        };
        let found = entries.iter().find(|(known, _)| known == name);
        Ok(found.map(|(_, json)| Self {
            json,
            step: Step::Field(self, name),
            ..*self
        }))
    }

    /// As [`Item::get`] of what must be there.
    pub(super) fn needed(&'p self, name: &'p str) -> Result<Self, Diagnostic> {
        let missing = || self.error(format!("it has no {}", quoted(name)));
        self.get(name)?.ok_or_else(missing)
    }

    /// The entries of an array.
    pub(super) fn entries(&'p self) -> Result<impl ExactSizeIterator<Item = Self> + 'p, Diagnostic> {
        let Value::Array(items) = &self.json.value else {
            return Err(self.wrong("an array"));
        };
        Ok(items.iter().enumerate().map(|(i, json)| Self {
            json,
            step: Step::Entry(self, i),
            ..*self
        }))
    }

    /// Entry `i` of an array.
    pub(super) fn entry(&'p self, i: usize) -> Result<Option<Self>, Diagnostic> {
        let Value::Array(items) = &self.json.value else {
            return Err(self.wrong("an array"));
        };
        Ok(items.get(i).map(|json| Self {
            json,
            step: Step::Entry(self, i),
            ..*self
        }))
    }

    /// How many entries the array of that name has.
    pub(super) fn count(&self, name: &str) -> Result<usize, Diagnostic> {
        match self.get(name)? {
            Some(all) => Ok(all.entries()?.len()),
            None => Ok(0),
        }
    }

    /// The names of an object's entries.
    pub(super) fn names(&self) -> Result<impl Iterator<Item = &'p str>, Diagnostic> {
        match &self.json.value {
            Value::Object(entries) => Ok(entries.iter().map(|(name, _)| &**name)),
            _ => Err(self.wrong("an object")),
        }
    }

    pub(super) fn number(&self) -> Result<f64, Diagnostic> {
        match self.json.value {
            Value::Number(x) => Ok(x),
            _ => Err(self.wrong("a number")),
        }
    }

    /// A number from `least` to `most`.
    pub(super) fn within(&self, least: f64, most: f64) -> Result<f64, Diagnostic> {
        let x = self.number()?;
        if (least..=most).contains(&x) {
            return Ok(x);
        }
        Err(match most.is_finite() {
            true => self.wrong(format_args!("a number from {} to {}", short(least), short(most))),
            false => self.wrong(format_args!("a number of at least {}", short(least))),
        })
    }

    /// A whole number, 0 or greater.
    pub(super) fn whole(&self) -> Result<usize, Diagnostic> {
        match self.json.value {
            Value::Number(x) if x >= 0.0 && x.fract() == 0.0 && x <= 9.007e15 => Ok(x as usize),
            _ => Err(self.wrong("a whole number, 0 or greater")),
        }
    }

    pub(super) fn string(&self) -> Result<&'p str, Diagnostic> {
        match &self.json.value {
            Value::String(s) => Ok(s),
            _ => Err(self.wrong("a string")),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool, Diagnostic> {
        match self.json.value {
            Value::Bool(b) => Ok(b),
            _ => Err(self.wrong("true or false")),
        }
    }

    /// So many numbers.
    pub(super) fn numbers<const N: usize>(&'p self) -> Result<[f64; N], Diagnostic> {
        let entries = self.entries()?;
        if entries.len() != N {
            let found = counted(entries.len(), "entry", "entries");
            return Err(self.error(format!("expected {N} numbers, found {found}")));
        }
        let mut numbers = [0.0; N];
        for (number, entry) in numbers.iter_mut().zip(entries) {
            *number = entry.number()?;
        }
        Ok(numbers)
    }

    /// The number of one of `count` things.
    pub(super) fn index(&self, kind: Kind, count: usize) -> Result<usize, Diagnostic> {
        let i = self.whole()?;
        if i < count {
            return Ok(i);
        }
        let there_are = match count {
            0 => format!("{} has none", kind.list),
            1 => format!("{} has one, numbered 0", kind.list),
            n => format!("{} has {n}, numbered from 0", kind.list),
        };
        Err(self.error(format!("there is no {} {i}: {there_are}", kind.one)))
    }

    /// Three numbers of at most `most`, or what counts where they are not there.
    pub(super) fn color_or(&'p self, name: &'p str, default: f64, most: f64) -> Result<Color, Diagnostic> {
        let Some(item) = self.get(name)? else {
            return Ok(Color::splat(default));
        };
        let color = item.numbers()?;
        for entry in item.entries()? {
            entry.within(0.0, most)?;
        }
        Ok(Color::from_array(color))
    }

    /// As [`Item::get`] and then [`Item::number`], or what counts where it is not there.
    pub(super) fn number_or(&'p self, name: &'p str, default: f64) -> Result<f64, Diagnostic> {
        self.get(name)?.map_or(Ok(default), |item| item.number())
    }

    /// As [`Item::number_or`], from 0 to 1.
    pub(super) fn share_or(&'p self, name: &'p str, default: f64) -> Result<f64, Diagnostic> {
        self.get(name)?.map_or(Ok(default), |item| item.within(0.0, 1.0))
    }

    /// As [`Item::number_or`], for a whole number.
    pub(super) fn whole_or(&'p self, name: &'p str, default: usize) -> Result<usize, Diagnostic> {
        self.get(name)?.map_or(Ok(default), |item| item.whole())
    }
}

/// A number without long rows of zeros.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 | 1e-3..1e6 => x.to_string(),
        _ => format!("{x:e}"),
    }
}
