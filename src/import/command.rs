//! The commands of the course's scene format: one a line, each a name and its values.

use super::text::{Source, number, quoted, whole, words};
use crate::{
    color::Color,
    diag::{Code, Diagnostic, nearest_names},
    math::DVec3,
    scene::Attenuation,
};

/// One command with its values as they stand in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Command<'a> {
    Size(u64, u64),
    MaxDepth(u64),
    Output(&'a str),
    Camera {
        eye: DVec3,
        at: DVec3,
        up: DVec3,
        fovy: f64,
    },
    Sphere(DVec3, f64),
    /// `maxverts` and `maxvertnorms`: hints for programs that allocate by them.
    Capacity,
    Vertex(DVec3),
    VertexNormal(DVec3, DVec3),
    Tri([usize; 3]),
    TriNormal([usize; 3]),
    Translate(DVec3),
    Rotate(DVec3, f64),
    Scale(DVec3),
    PushTransform,
    PopTransform,
    Directional(DVec3, Color),
    Point(DVec3, Color),
    Attenuation(Attenuation),
    Ambient(Color),
    Diffuse(Color),
    Specular(Color),
    Shininess(f64),
    Emission(Color),
}

/// Every command with the values it takes.
const COMMANDS: [(&str, &str); 24] = [
    ("size", "width height"),
    ("maxdepth", "depth"),
    ("output", "filename"),
    (
        "camera",
        "eyex eyey eyez centerx centery centerz upx upy upz fovy",
    ),
    ("sphere", "x y z radius"),
    ("maxverts", "count"),
    ("maxvertnorms", "count"),
    ("vertex", "x y z"),
    ("vertexnormal", "x y z nx ny nz"),
    ("tri", "v1 v2 v3"),
    ("trinormal", "v1 v2 v3"),
    ("translate", "x y z"),
    ("rotate", "x y z degrees"),
    ("scale", "x y z"),
    ("pushTransform", ""),
    ("popTransform", ""),
    ("directional", "x y z r g b"),
    ("point", "x y z r g b"),
    ("attenuation", "constant linear quadratic"),
    ("ambient", "r g b"),
    ("diffuse", "r g b"),
    ("specular", "r g b"),
    ("shininess", "exponent"),
    ("emission", "r g b"),
];

/// As many values as any command takes.
const MOST_VALUES: usize = 10;

impl<'a> Command<'a> {
    /// The command of a line and the word that names it; `None` where the line holds none.
    pub(super) fn parse(source: &Source<'a>, line: &'a str) -> Result<Option<(&'a str, Self)>, Diagnostic> {
        let mut words = words(line);
        let Some(name) = words.next() else {
            return Ok(None);
        };
        let Some((_, usage)) = COMMANDS.iter().find(|(known, _)| *known == name) else {
            return Err(unknown(source, name));
        };
        let mut values = Values {
            source,
            words: [""; MOST_VALUES],
            next: 0,
        };
        let wanted = usage.split_ascii_whitespace().count();
        let mut given = 0;
        let mut surplus = None;
        for word in words {
            match values.words.get_mut(given) {
                Some(slot) if given < wanted => *slot = word,
                _ => surplus = surplus.or(Some(word)),
            }
            given += 1;
        }
        if given != wanted {
            let error = wrong_count(source, surplus.unwrap_or(name), (name, usage), given);
            return Err(match (line.contains("//"), line.contains('#')) {
                (true, _) => error.hint("comments begin with #"),
                (_, true) if given < wanted => error.hint("what follows # is a comment"),
                _ => error,
            });
        }
        Ok(Some((name, Self::with_values(name, &mut values)?)))
    }

    fn with_values(name: &str, v: &mut Values<'_, 'a>) -> Result<Self, Diagnostic> {
        Ok(match name {
            "size" => Self::Size(v.whole()?, v.whole()?),
            "maxdepth" => Self::MaxDepth(v.whole()?),
            "output" => Self::Output(v.word()),
            "camera" => Self::Camera {
                eye: v.vector()?,
                at: v.vector()?,
                up: v.vector()?,
                fovy: v.number()?,
            },
            "sphere" => Self::Sphere(v.vector()?, v.number()?),
            "maxverts" | "maxvertnorms" => {
                v.whole()?;
                Self::Capacity
            }
            "vertex" => Self::Vertex(v.vector()?),
            "vertexnormal" => Self::VertexNormal(v.vector()?, v.vector()?),
            "tri" => Self::Tri(v.indices()?),
            "trinormal" => Self::TriNormal(v.indices()?),
            "translate" => Self::Translate(v.vector()?),
            "rotate" => Self::Rotate(v.vector()?, v.number()?),
            "scale" => Self::Scale(v.vector()?),
            "pushTransform" => Self::PushTransform,
            "popTransform" => Self::PopTransform,
            "directional" => Self::Directional(v.vector()?, v.vector()?),
            "point" => Self::Point(v.vector()?, v.vector()?),
            "attenuation" => Self::Attenuation(Attenuation {
                constant: v.number()?,
                linear: v.number()?,
                quadratic: v.number()?,
            }),
            "ambient" => Self::Ambient(v.vector()?),
            "diffuse" => Self::Diffuse(v.vector()?),
            "specular" => Self::Specular(v.vector()?),
            "shininess" => Self::Shininess(v.not_negative()?),
            "emission" => Self::Emission(v.vector()?),
            _ => return Err(unknown(v.source, name)),
        })
    }
}

fn unknown(source: &Source<'_>, name: &str) -> Diagnostic {
    let error = source
        .error(name, format!("unknown command {}", quoted(name)))
        .class(Code::UnknownFunction);
    let names = COMMANDS.map(|(name, _)| name);
    // A call as scripts have them, and words that begin one of the commands.
    let called = name
        .split_once('(')
        .and_then(|(called, _)| COMMANDS.iter().find(|(known, _)| *known == called));
    if let Some((known, usage)) = called {
        return error.hint(format!(
            "values stand without brackets and commas: {known} {usage}"
        ));
    }
    if name == "light" {
        return error.hint("lights are point x y z r g b and directional x y z r g b");
    }
    let begun = names
        .iter()
        .copied()
        .filter(|known| name.len() > 2 && known.starts_with(name));
    match nearest_names(name, names).into_iter().chain(begun).next() {
        Some(near) => error.hint(format!("did you mean '{near}'?")),
        None => error.hint(format!("the commands are: {}", names.join(" "))),
    }
}

fn wrong_count(source: &Source<'_>, at: &str, (name, usage): (&str, &str), given: usize) -> Diagnostic {
    let takes = match usage.split_ascii_whitespace().count() {
        0 => "no values".to_owned(),
        1 => format!("1 value ({usage})"),
        n => format!("{n} values ({usage})"),
    };
    let error = source
        .error(at, format!("{name} takes {takes}, not {given}"))
        .class(Code::ArgumentCount);
    error.hint(format!("write: {}", format!("{name} {usage}").trim_end()))
}

/// The values of one command, taken in order.
struct Values<'s, 'a> {
    source: &'s Source<'a>,
    words: [&'a str; MOST_VALUES],
    next: usize,
}

impl<'a> Values<'_, 'a> {
    fn word(&mut self) -> &'a str {
        let word = self.words.get(self.next).copied().unwrap_or("");
        self.next += 1;
        word
    }

    fn read<T>(&mut self, read: impl Fn(&str) -> Result<T, String>) -> Result<T, Diagnostic> {
        let word = self.word();
        read(word).map_err(|message| self.source.no_number(word, message).class(Code::ArgumentType))
    }

    fn number(&mut self) -> Result<f64, Diagnostic> {
        self.read(number)
    }

    fn not_negative(&mut self) -> Result<f64, Diagnostic> {
        self.read(|word| match number(word)? {
            x if x < 0.0 => Err(format!("expected a number of at least 0, found {}", quoted(word))),
            x => Ok(x),
        })
    }

    fn vector(&mut self) -> Result<DVec3, Diagnostic> {
        Ok(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    fn whole(&mut self) -> Result<u64, Diagnostic> {
        self.read(whole)
    }

    fn indices(&mut self) -> Result<[usize; 3], Diagnostic> {
        let [a, b, c] = [self.read(whole)?, self.read(whole)?, self.read(whole)?];
        Ok([a, b, c].map(|i| usize::try_from(i).unwrap_or(usize::MAX)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::ErrorKind;

    #[test]
    fn every_command_reads_its_values() {
        for (name, usage) in COMMANDS {
            let values: Vec<String> = (1..=usage.split(' ').filter(|w| !w.is_empty()).count())
                .map(|i| i.to_string())
                .collect();
            let text = format!("  {name} {} # comment", values.join("\t"));
            let source = Source::new("a.test", &text, ErrorKind::Script);
            let (word, command) = Command::parse(&source, &text).unwrap().unwrap();
            assert_eq!(word, name);
            let shown = format!("{command:?}").to_lowercase();
            let wanted = if name.starts_with("max") && name != "maxdepth" {
                "capacity"
            } else {
                name
            };
            assert!(shown.starts_with(&wanted.to_lowercase()), "{shown}");
        }
    }

    #[test]
    fn comments_and_blanks_hold_no_command() {
        for text in ["", "   ", "# sphere 0 0 0 1", "\t#x"] {
            let source = Source::new("a.test", text, ErrorKind::Script);
            assert_eq!(Command::parse(&source, text), Ok(None));
        }
    }
}
