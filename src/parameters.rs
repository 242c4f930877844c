//! What is decided outside a script: written the same way on the command line, in snapshots and in pictures.

use std::{collections::BTreeMap, fmt, str::FromStr};

use crate::diag::SourceLoc;

/// Names that every scene has and that no script can declare.
pub const RESERVED: [&str; 4] = ["size", "samples", "seed", "region"];

/// What is decided outside a script. Where it is `None`, the script decides.
///
/// As text `size=320x200 samples=4 seed=7 region=10,20,64x48 radius=0.5`, in this order, without what is `None`; `none` where all is.
/// Values with blanks or quotes stand in quotes, as Rust would write them.
///
/// ```
/// use rtscript::parameters::Parameters;
/// let mut asked: Parameters = "size=320x200 radius=0.5".parse()?;
/// asked.set("seed", "3")?;
/// let all = asked.or(&"radius=1 color=red".parse()?);
/// assert_eq!((all.size, all.seed), (Some((320, 200)), Some(3)));
/// assert_eq!((all.values["radius"].as_str(), all.values["color"].as_str()), ("0.5", "red"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Parameters {
    /// Size in pixels, across and down.
    pub size: Option<(u32, u32)>,
    /// Rays per pixel.
    pub samples: Option<u32>,
    /// Seed.
    pub seed: Option<u64>,
    /// The part of the picture that is rendered: first column, first row, columns, rows.
    pub region: Option<[u32; 4]>,
    /// Values of the parameters that the script declares by `param(name, default)`, as text.
    pub values: BTreeMap<String, String>,
}

impl Parameters {
    /// Decides one by its name: `size`, `samples`, `seed`, `region`, or a parameter of the script.
    ///
    /// # Errors
    /// What is wrong with the name, or with the value of one that every scene has.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "size" => self.size = Some(parse_size(value)?),
            "samples" => {
                let samples = value.parse().ok().filter(|n| *n > 0);
                self.samples = Some(samples.ok_or("expected a whole number above 0")?);
            }
            "seed" => self.seed = Some(value.parse().map_err(|_| "expected a whole number from 0 on")?),
            "region" => self.region = Some(parse_region(value)?),
            name if is_name(name) => {
                self.values.insert(name.to_owned(), value.to_owned());
            }
            _ => return Err(format!("'{name}' is no name of a parameter")),
        }
        Ok(())
    }

    /// These, and where they say nothing, `other`.
    #[must_use]
    pub fn or(mut self, other: &Self) -> Self {
        self.size = self.size.or(other.size);
        self.samples = self.samples.or(other.samples);
        self.seed = self.seed.or(other.seed);
        self.region = self.region.or(other.region);
        for (name, value) in &other.values {
            self.values.entry(name.clone()).or_insert_with(|| value.clone());
        }
        self
    }
}

/// Whether a script may declare a parameter of this name.
///
/// ```
/// use rtscript::parameters::is_name;
/// assert!(is_name("wheel_radius") && !is_name("2 wheels"));
/// ```
#[must_use]
pub fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    let begins = chars.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    begins && chars.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

impl fmt::Display for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.size.map(|(width, height)| format!("size={width}x{height}"));
        let samples = self.samples.map(|n| format!("samples={n}"));
        let seed = self.seed.map(|n| format!("seed={n}"));
        let region = self
            .region
            .map(|[x, y, width, height]| format!("region={x},{y},{width}x{height}"));
        let breaks = |c: char| c.is_whitespace() || c.is_control() || c == '"';
        let values = self.values.iter().map(|(name, value)| {
            if value.is_empty() || value.contains(breaks) {
                format!("{name}={value:?}")
            } else {
                format!("{name}={value}")
            }
        });
        let all: Vec<String> = [size, samples, seed, region]
            .into_iter()
            .flatten()
            .chain(values)
            .collect();
        f.write_str(if all.is_empty() { "none" } else { "" })?;
        f.write_str(&all.join(" "))
    }
}

impl FromStr for Parameters {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parameters = Self::default();
        let mut rest = text.trim();
        if rest == "none" {
            return Ok(parameters);
        }
        while !rest.is_empty() {
            let bad = || format!("expected name=value, not '{rest}'");
            let (name, after) = rest.split_once('=').ok_or_else(bad)?;
            let end = match after.strip_prefix('"') {
                Some(inner) => closing_quote(inner).ok_or_else(bad)? + 2,
                None => after.find(char::is_whitespace).unwrap_or(after.len()),
            };
            let (value, tail) = after.split_at(end);
            if value.starts_with('"') {
                parameters.set(name, &unquoted(value).ok_or_else(bad)?)?;
            } else {
                parameters.set(name, value)?;
            }
            rest = tail.trim_start();
        }
        Ok(parameters)
    }
}

/// Where the quote is that ends a text, those after a backslash passed over.
fn closing_quote(text: &str) -> Option<usize> {
    let mut escaped = false;
    text.char_indices().find_map(|(i, c)| {
        let closes = c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
        closes.then_some(i)
    })
}

/// What `{:?}` made of a text, undone.
pub(crate) fn unquoted(text: &str) -> Option<String> {
    let inner = text.strip_prefix('"')?.strip_suffix('"')?;
    let mut plain = String::new();
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            plain.push(c);
            continue;
        }
        plain.push(match chars.next()? {
            'n' => '\n',
            'r' => '\r',
            't' => '\t',
            '0' => '\0',
            'u' => {
                let rest = chars.as_str().strip_prefix('{')?;
                let (digits, after) = rest.split_once('}')?;
                chars = after.chars();
                char::from_u32(u32::from_str_radix(digits, 16).ok()?)?
            }
            c @ ('"' | '\\' | '\'') => c,
            _ => return None,
        });
    }
    Some(plain)
}

/// `640x480` to its two numbers, both at least 1.
pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let edge = |digits: &str| digits.parse::<u32>().ok().filter(|&n| n > 0);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some((edge(width)?, edge(height)?)))
        .ok_or_else(|| "expected two whole numbers above 0 with an x between, such as 640x480".to_owned())
}

/// `10,20,64x48`: first column, first row, columns, rows.
pub(crate) fn parse_region(text: &str) -> Result<[u32; 4], String> {
    let parsed = || {
        let mut parts = text.splitn(3, ',');
        let (x, y) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
        let (width, height) = parse_size(parts.next()?).ok()?;
        Some([x, y, width, height])
    };
    parsed()
        .ok_or_else(|| "expected the first column, the first row and a size, such as 10,20,64x48".to_owned())
}

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// `true` or `false`.
    Bool,
    /// A whole number.
    Int,
    /// Any finite number.
    Number,
    /// Any text.
    Text,
}

impl ParameterKind {
    /// As `rtscript params` names it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Int => "int",
            Self::Number => "number",
            Self::Text => "string",
        }
    }
}

/// A parameter that a script declared.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, Script, parameters::ParameterKind};
/// let script = Script::compile("a.rhai", r#"param("radius", 0.5, #{ min: 0.1, max: 2.0 }); sphere(0, 0, 0, 1);"#, &Limits::default())?;
/// let declared = script.run(&NoHost, &RunOptions::default())?.value.parameters;
/// assert_eq!((declared[0].name.as_str(), declared[0].kind), ("radius", ParameterKind::Number));
/// assert_eq!(declared[0].expected(), "a number from 0.1 to 2");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Declared {
    /// Its name.
    pub name: String,
    /// What it takes.
    pub kind: ParameterKind,
    /// Its value where none is given, as text.
    pub default: String,
    /// Its value in this run, as text.
    pub value: String,
    /// The least number that it takes.
    pub min: Option<f64>,
    /// The greatest number that it takes.
    pub max: Option<f64>,
    /// All values that it takes; empty where that is not limited.
    pub choices: Vec<String>,
    /// What it means; empty where the script does not say.
    pub doc: String,
    /// The call that declared it.
    pub loc: SourceLoc,
}

impl Declared {
    /// What it takes in words: `a number from 0 to 2`.
    #[must_use]
    pub fn expected(&self) -> String {
        if !self.choices.is_empty() {
            return format!("one of {}", self.choices.join(", "));
        }
        let kind = match self.kind {
            ParameterKind::Bool => return "true or false".to_owned(),
            ParameterKind::Text => return "a text".to_owned(),
            ParameterKind::Int => "a whole number",
            ParameterKind::Number => "a number",
        };
        match (self.min, self.max) {
            (None, None) => kind.to_owned(),
            (Some(min), None) => format!("{kind} from {min} on"),
            (None, Some(max)) => format!("{kind} up to {max}"),
            (Some(min), Some(max)) => format!("{kind} from {min} to {max}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        assert_eq!(parse_size("1X1"), Ok((1, 1)));
        for bad in [
            "640",
            "640x",
            "x480",
            "0x480",
            "640x0",
            "-1x5",
            "640 x 480",
            "1x2x3",
            "99999999999x1",
        ] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn text_and_back() {
        for text in [
            "none",
            "size=1x2",
            "size=320x200 samples=4 seed=18446744073709551615",
            "seed=0",
            r#"seed=0 _a=-0.5 b=é= title="a \"b\\\" c=d" z="""#,
        ] {
            assert_eq!(text.parse::<Parameters>().unwrap().to_string(), text);
        }
        for bad in ["size", "size=3", "a-b=1", "seed=-1", "samples=0", "=1", "a=\"b"] {
            assert!(bad.parse::<Parameters>().is_err(), "{bad}");
        }
    }

    #[test]
    fn what_is_said_comes_before_the_rest() {
        let said: Parameters = "seed=1 a=2".parse().unwrap();
        let rest: Parameters = "size=3x4 seed=5 a=6 b=7".parse().unwrap();
        assert_eq!(said.or(&rest).to_string(), "size=3x4 seed=1 a=2 b=7");
    }

    #[test]
    fn quotes_are_undone() {
        for text in ["", "a\\b\"c'", "\u{0}\u{1b}\u{202e}\t\r\n", "é日本"] {
            assert_eq!(unquoted(&format!("{text:?}")).as_deref(), Some(text));
        }
        for bad in ["", "\"", "a", "\"\\", "\"\\q\"", "\"\\u{110000}\"", "\"\\u41\""] {
            assert_eq!(unquoted(bad), None, "{bad}");
        }
    }
}
