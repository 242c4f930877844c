//! The header of a PLY file: which elements it has, and what each of them is made of.

use crate::{
    diag::{Diagnostic, nearest_names},
    import::text::{Source, lines, quoted},
};

/// How the elements are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    const NAMES: [(&str, Self); 16] = [
        ("char", Self::I8),
        ("uchar", Self::U8),
        ("short", Self::I16),
        ("ushort", Self::U16),
        ("int", Self::I32),
        ("uint", Self::U32),
        ("float", Self::F32),
        ("double", Self::F64),
        ("int8", Self::I8),
        ("uint8", Self::U8),
        ("int16", Self::I16),
        ("uint16", Self::U16),
        ("int32", Self::I32),
        ("uint32", Self::U32),
        ("float32", Self::F32),
        ("float64", Self::F64),
    ];

    /// Its bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// What stands for all of a color's channel; `None` where that is 1, and other numbers are shares of it. Types that are
    /// wider than they need to be, as `int`, hold bytes all the same.
    pub(super) const fn full(self) -> Option<f64> {
        match self {
            Self::F32 | Self::F64 => None,
            Self::U16 => Some(65535.0),
            _ => Some(255.0),
        }
    }
}

/// A property of an element: a number, or a list of them after their count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Scalar,
    /// The type of the count, where it is a list.
    pub(super) count: Option<Scalar>,
}

/// Things of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The place of a property among the others, by any of its names.
    pub(super) fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| names.contains(&p.name.as_str()))
    }

    /// Bytes that one takes at least in a binary file.
    pub(super) fn least_size(&self) -> usize {
        let sizes = self.properties.iter().map(|p| p.count.unwrap_or(p.kind).size());
        sizes.sum()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// Lines up to the one that ends it.
    pub(super) lines: usize,
}

/// Properties of all elements together, and elements: files have a few.
const MOST_PARTS: usize = 1000;

impl Header {
    /// Reads the header at the beginning of `source`.
    ///
    /// # Errors
    /// At the first line that is none of a header, and where it does not end or has no vertices or faces.
    pub(super) fn read(source: &Source<'_>) -> Result<Self, Diagnostic> {
        let mut format = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut parts = 0;
        let mut last = source.text;
        for (number, line) in lines(source.text).enumerate() {
            last = line;
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            if number == 0 {
                if words != ["ply"] {
                    return Err(source.error(line, "expected 'ply' in the first line of a PLY file"));
                }
                continue;
            }
            parts += 1;
            match words.as_slice() {
                [] | ["comment" | "obj_info", ..] => parts -= 1,
                ["format", name, version] => {
                    if *version != "1.0" {
                        let message = format!("expected format version 1.0, found {}", quoted(version));
                        return Err(source.error(version, message));
                    }
                    format = Some(match *name {
                        "ascii" => Format::Ascii,
                        "binary_little_endian" => Format::LittleEndian,
                        "binary_big_endian" => Format::BigEndian,
                        _ => {
                            let message = format!(
                                "expected ascii, binary_little_endian or binary_big_endian, found {}",
                                quoted(name)
                            );
                            return Err(source.error(name, message));
                        }
                    });
                }
                ["element", name, count] => {
                    let number = count.parse().map_err(|_| {
                        source.error(
                            count,
                            format!("expected how many there are, found {}", quoted(count)),
                        )
                    })?;
                    if elements.iter().any(|e| e.name == **name) {
                        return Err(source.error(name, format!("element {} is there twice", quoted(name))));
                    }
                    elements.push(Element {
                        name: (*name).to_owned(),
                        count: number,
                        properties: Vec::new(),
                    });
                }
                ["property", rest @ ..] => {
                    let property = property(source, line, rest)?;
                    let Some(element) = elements.last_mut() else {
                        let error = source.error(line, "a property without an element before it");
                        return Err(error.hint(
                            "write: element vertex, with the number of vertices, before their properties",
                        ));
                    };
                    if element.find(&[&property.name]).is_some() {
                        let message = format!("property {} is there twice", quoted(&property.name));
                        return Err(source.error(line, message));
                    }
                    element.properties.push(property);
                }
                ["end_header"] => {
                    let Some(format) = format else {
                        return Err(source.error(line, "the header has no line 'format ascii 1.0' or alike"));
                    };
                    return Ok(Self {
                        format,
                        elements,
                        lines: number + 1,
                    });
                }
                [keyword, ..] => return Err(unknown(source, keyword, line)),
            }
            if parts > MOST_PARTS {
                return Err(source.error(line, format!("the header has more than {MOST_PARTS} lines")));
            }
        }
        let error = source.error(last, "the header has no line 'end_header'");
        Err(error.hint("write it behind the last property; the elements follow"))
    }
}

fn unknown(source: &Source<'_>, keyword: &str, line: &str) -> Diagnostic {
    let known = [
        "format",
        "element",
        "property",
        "comment",
        "obj_info",
        "end_header",
    ];
    if known.contains(&keyword) {
        let wanted = match keyword {
            "format" => "format ascii 1.0",
            "element" => "element vertex 8",
            _ => "end_header",
        };
        return source.error(line, format!("expected a line like '{wanted}'"));
    }
    let error = source.error(
        keyword,
        format!("unknown keyword {} in the header", quoted(keyword)),
    );
    match nearest_names(keyword, known).first() {
        Some(near) => error.hint(format!("did you mean '{near}'?")),
        None => error,
    }
}

fn property(source: &Source<'_>, line: &str, words: &[&str]) -> Result<Property, Diagnostic> {
    let scalar = |word: &str| {
        let found = Scalar::NAMES.iter().find(|(name, _)| *name == word);
        found.map(|(_, scalar)| *scalar).ok_or_else(|| {
            let message = format!(
                "expected a type such as float, uchar or int, found {}",
                quoted(word)
            );
            source.error(word, message)
        })
    };
    match words {
        ["list", count, kind, name] => {
            let kind_of_count = scalar(count)?;
            if matches!(kind_of_count, Scalar::F32 | Scalar::F64) {
                return Err(source.error(
                    count,
                    "the count of a list must be of a whole type, such as uchar",
                ));
            }
            Ok(Property {
                name: (*name).to_owned(),
                kind: scalar(kind)?,
                count: Some(kind_of_count),
            })
        }
        [kind, name] if *kind != "list" => Ok(Property {
            name: (*name).to_owned(),
            kind: scalar(kind)?,
            count: None,
        }),
        _ => Err(source.error(
            line,
            "expected a line like 'property float x' or 'property list uchar int vertex_indices'",
        )),
    }
}
