//! The elements of a PLY file one after the other, as words or as bytes.

use super::{
    end_of,
    header::{Element, Format, Property, Scalar},
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    import::text::{Source, number, quoted},
};

const CUT_OFF: &str = "the file is cut off, or its header has a count that is too large";
const OTHERWISE: &str = "the file is damaged, or its header says otherwise how it is written";

/// What stands after the header.
pub(super) enum Body<'a> {
    Text {
        source: Source<'a>,
        lines: Box<dyn Iterator<Item = &'a str> + 'a>,
        /// The words of the line at hand that were not taken yet, in the order in which they come.
        words: std::vec::IntoIter<&'a str>,
        line: &'a str,
    },
    Bytes {
        source: Source<'a>,
        bytes: &'a [u8],
        at: usize,
        is_big: bool,
    },
}

/// The element that is being read, for messages.
#[derive(Clone, Copy)]
pub(super) struct Item<'e> {
    pub(super) element: &'e Element,
    pub(super) index: usize,
}

impl std::fmt::Display for Item<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Element { name, count, .. } = self.element;
        write!(f, "{} {} of {count}", quoted(name), self.index + 1)
    }
}

impl<'a> Body<'a> {
    pub(super) fn bytes(source: Source<'a>, bytes: &'a [u8], at: usize, format: Format) -> Self {
        Self::Bytes {
            source,
            bytes,
            at,
            is_big: format == Format::BigEndian,
        }
    }

    pub(super) fn text(source: Source<'a>, lines: impl Iterator<Item = &'a str> + 'a) -> Self {
        Self::Text {
            source,
            lines: Box::new(lines),
            words: Vec::new().into_iter(),
            line: end_of(&source),
        }
    }

    /// How many elements there can be at most: a header may claim any number.
    pub(super) fn room_for(&self, element: &Element) -> usize {
        let most = match self {
            Self::Text { source, .. } => source.text.len() / 2,
            Self::Bytes { bytes, at, .. } => {
                (bytes.len() - at.min(&bytes.len())) / element.least_size().max(1)
            }
        };
        element.count.min(most)
    }

    /// The line of the element at hand, for places.
    pub(super) fn place(&self) -> &'a str {
        match self {
            Self::Text { line, .. } => line,
            Self::Bytes { source, .. } => source.text,
        }
    }

    /// An error in the element at hand.
    pub(super) fn error(&self, message: String) -> Diagnostic {
        match self {
            Self::Text { source, line, .. } => source.error(line, message),
            Self::Bytes { source, at, .. } => {
                let message = format!("{message}, before byte {at}");
                Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0)
            }
        }
    }

    /// Begins an element: in text it has a line of its own.
    pub(super) fn begin(&mut self, item: Item<'_>) -> Result<(), Diagnostic> {
        if let Self::Text {
            source,
            lines,
            words,
            line,
        } = self
        {
            let next = lines.find(|line| !line.trim_ascii().is_empty());
            let Some(next) = next else {
                let error = source.error(line, format!("the file ends behind this line, before {item}"));
                return Err(error.hint(CUT_OFF));
            };
            *line = next;
            *words = next.split_ascii_whitespace().collect::<Vec<_>>().into_iter();
        }
        Ok(())
    }

    /// Ends an element: in text nothing more may stand in its line.
    pub(super) fn end(&mut self, item: Item<'_>) -> Result<(), Diagnostic> {
        if let Self::Text { source, words, .. } = self
            && let Some(word) = words.next()
        {
            let message = format!(
                "expected the end of the line after {item}, found {}",
                quoted(word)
            );
            return Err(source.error(word, message));
        }
        Ok(())
    }

    /// A number.
    pub(super) fn number(&mut self, kind: Scalar, item: Item<'_>, name: &str) -> Result<f64, Diagnostic> {
        match self {
            Self::Text {
                source, words, line, ..
            } => {
                let Some(word) = words.next() else {
                    let message = format!("{item} has no value for {}", quoted(name));
                    let hint = "each line has the values of one element, in the order of its properties";
                    return Err(source.error(line, message).hint(hint));
                };
                number(word).map_err(|message| source.error(word, message))
            }
            Self::Bytes {
                source,
                bytes,
                at,
                is_big,
            } => {
                let value = bytes.get(*at..).and_then(|rest| scalar(rest, kind, *is_big));
                let Some(value) = value else {
                    let message = format!("the file ends at byte {}, in {item}", bytes.len());
                    let error = Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0);
                    return Err(error.hint(CUT_OFF));
                };
                if !(value.abs() <= 1e15) {
                    let message = format!(
                        "expected a number within 1e15 for {} in {item}, found {value} at byte {at}",
                        quoted(name)
                    );
                    let error = Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0);
                    return Err(error.hint(OTHERWISE));
                }
                *at += kind.size();
                Ok(value)
            }
        }
    }

    /// The count of a list, which the file can hold.
    pub(super) fn count(
        &mut self,
        property: &Property,
        kind: Scalar,
        item: Item<'_>,
    ) -> Result<usize, Diagnostic> {
        let value = self.number(kind, item, &property.name)?;
        let room = match self {
            Self::Text { words, .. } => words.len(),
            Self::Bytes { bytes, at, .. } => (bytes.len() - *at) / property.kind.size(),
        };
        if value < 0.0 || value.fract() != 0.0 {
            let name = quoted(&property.name);
            return Err(self.error(format!(
                "expected how many numbers {name} has in {item}, found {value}"
            )));
        }
        if value > room as f64 {
            let name = quoted(&property.name);
            let error = self.error(format!(
                "{name} in {item} is to have {value} numbers, but there are at most {room}"
            ));
            return Err(match self {
                Self::Text { .. } => error.hint("a list begins with how many numbers it has"),
                Self::Bytes { .. } => error.hint(OTHERWISE),
            });
        }
        Ok(value as usize)
    }

    /// Leaves out a property.
    pub(super) fn skip(&mut self, property: &Property, item: Item<'_>) -> Result<(), Diagnostic> {
        let Some(kind) = property.count else {
            return self.number(property.kind, item, &property.name).map(drop);
        };
        let count = self.count(property, kind, item)?;
        match self {
            Self::Bytes { at, .. } => *at += count * property.kind.size(),
            Self::Text { words, .. } => words.by_ref().take(count).for_each(drop),
        }
        Ok(())
    }
}

/// A number at the beginning of `bytes`.
fn scalar(bytes: &[u8], kind: Scalar, is_big: bool) -> Option<f64> {
    macro_rules! read {
        ($t:ty) => {{
            let bytes = *bytes.first_chunk()?;
            f64::from(if is_big {
                <$t>::from_be_bytes(bytes)
            } else {
                <$t>::from_le_bytes(bytes)
            })
        }};
    }
    Some(match kind {
        Scalar::I8 => read!(i8),
        Scalar::U8 => read!(u8),
        Scalar::I16 => read!(i16),
        Scalar::U16 => read!(u16),
        Scalar::I32 => read!(i32),
        Scalar::U32 => read!(u32),
        Scalar::F32 => read!(f32),
        Scalar::F64 => read!(f64),
    })
}
