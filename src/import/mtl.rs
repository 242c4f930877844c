//! Material libraries of OBJ files (Wavefront MTL), read with the place of every fault.

use std::{borrow::Cow, collections::BTreeMap};

use super::{
    text::{Source, number, quoted, whole},
    wavefront::{Statement, Unused, statements},
};
use crate::{color::Color, diag::Diagnostic};

/// A material as its file gives it: what is not given is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial<'a> {
    pub(super) ambient: Option<Color>,
    pub(super) diffuse: Option<Color>,
    pub(super) specular: Option<Color>,
    pub(super) emission: Option<Color>,
    /// `Ns`, at least 0.
    pub(super) shininess: Option<f64>,
    /// `d`, from 0 for nothing there to 1 for solid.
    pub(super) dissolve: Option<f64>,
    /// `Tr`, the other way round.
    pub(super) transparency: Option<f64>,
    /// `Ni`, greater than 0.
    pub(super) ior: Option<f64>,
    pub(super) illumination: Option<u64>,
    pub(super) ambient_map: Option<Map<'a>>,
    pub(super) diffuse_map: Option<Map<'a>>,
    pub(super) specular_map: Option<Map<'a>>,
    pub(super) emission_map: Option<Map<'a>>,
}

/// A texture file and where it is named.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map<'a> {
    pub(super) file: Cow<'a, str>,
    pub(super) at: &'a str,
}

/// A material library.
#[derive(Debug, Default)]
pub(super) struct Library<'a> {
    /// By name; of several with one name the last counts.
    pub(super) materials: BTreeMap<Cow<'a, str>, MtlMaterial<'a>>,
    /// Textures of kinds that are not used: bumps, cut-outs, reflections.
    pub(super) unused_maps: Unused<'a>,
    /// Options of textures that would change the picture.
    pub(super) unused_options: Unused<'a>,
    /// Keywords that no version of the format knows.
    pub(super) unknown: Unused<'a>,
}

/// Reads a library. Keywords count in either case, as exporters write `map_Kd` and `map_kd`.
///
/// # Errors
/// At the first statement that is wrong.
pub(super) fn parse<'a>(source: &Source<'a>) -> Result<Library<'a>, Diagnostic> {
    let mut parser = Parser {
        source,
        library: Library::default(),
        current: None,
    };
    let mut statements = statements(source);
    while let Some(statement) = statements.next() {
        parser.statement(statement)?;
    }
    parser.finish_material();
    Ok(parser.library)
}

struct Parser<'s, 'a> {
    source: &'s Source<'a>,
    library: Library<'a>,
    current: Option<(Cow<'a, str>, MtlMaterial<'a>)>,
}

impl<'a> Parser<'_, 'a> {
    fn finish_material(&mut self) {
        if let Some((name, material)) = self.current.take() {
            self.library.materials.insert(name, material);
        }
    }

    fn statement(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        let keyword = s.keyword.to_ascii_lowercase();
        if keyword == "newmtl" {
            let name = s.name_from(0);
            if name.is_empty() {
                return Err(self
                    .source
                    .error(s.keyword, "newmtl takes the name of a material; it has none"));
            }
            self.finish_material();
            self.current = Some((name, MtlMaterial::default()));
            return Ok(());
        }
        let source = self.source;
        let Some((_, m)) = &mut self.current else {
            return Err(source
                .error(
                    s.keyword,
                    format!("{} stands before any newmtl", quoted(s.keyword)),
                )
                .hint("a material begins with: newmtl name"));
        };
        match keyword.as_str() {
            "ka" => m.ambient = Some(color(source, s)?),
            "kd" => m.diffuse = Some(color(source, s)?),
            "ks" => m.specular = Some(color(source, s)?),
            "ke" => m.emission = Some(color(source, s)?),
            "ns" => m.shininess = Some(value(source, s, 0.0, f64::INFINITY)?),
            "d" => m.dissolve = Some(dissolve(source, s)?),
            "tr" => m.transparency = Some(value(source, s, 0.0, 1.0)?),
            "ni" => m.ior = Some(value(source, s, 0.0, f64::INFINITY)?).filter(|ior| *ior > 0.0),
            "illum" => m.illumination = Some(illumination(source, s)?),
            "map_ka" => m.ambient_map = Some(map(source, s, &mut self.library.unused_options)?),
            "map_kd" => m.diffuse_map = Some(map(source, s, &mut self.library.unused_options)?),
            "map_ks" => m.specular_map = Some(map(source, s, &mut self.library.unused_options)?),
            "map_ke" => m.emission_map = Some(map(source, s, &mut self.library.unused_options)?),
            "bump" | "disp" | "decal" | "norm" | "refl" => self.library.unused_maps.add(s.keyword),
            _ if keyword.starts_with("map_") => self.library.unused_maps.add(s.keyword),
            "tf" | "sharpness" | "km" | "pr" | "pm" | "ps" | "pc" | "pcr" | "aniso" | "anisor" => {}
            _ => self.library.unknown.add(s.keyword),
        }
        Ok(())
    }
}

fn wrong_count(source: &Source<'_>, s: Statement<'_, '_>, wanted: &str) -> Diagnostic {
    let given = s.args.len();
    source.error(s.keyword, format!("{} takes {wanted}, not {given}", s.keyword))
}

fn read(source: &Source<'_>, word: &str) -> Result<f64, Diagnostic> {
    number(word).map_err(|message| source.no_number(word, message))
}

/// Three numbers, or one for all three.
fn color(source: &Source<'_>, s: Statement<'_, '_>) -> Result<Color, Diagnostic> {
    match s.args {
        [kind, ..] if matches!(*kind, "spectral" | "xyz") => {
            let message = format!("expected a color as 3 numbers (r g b), found {}", quoted(kind));
            Err(source.error(kind, message))
        }
        [gray] => Ok(Color::splat(read(source, gray)?)),
        [r, g, b] => Ok(Color::new(read(source, r)?, read(source, g)?, read(source, b)?)),
        _ => Err(wrong_count(source, s, "3 numbers (r g b)")),
    }
}

/// One number from `least` to `most`.
fn value(source: &Source<'_>, s: Statement<'_, '_>, least: f64, most: f64) -> Result<f64, Diagnostic> {
    let [word] = s.args else {
        return Err(wrong_count(source, s, "1 number"));
    };
    in_range(source, word, least, most)
}

fn in_range(source: &Source<'_>, word: &str, least: f64, most: f64) -> Result<f64, Diagnostic> {
    let x = read(source, word)?;
    if (least..=most).contains(&x) {
        return Ok(x);
    }
    let wanted = if most.is_finite() {
        format!("from {least} to {most}")
    } else {
        format!("of at least {least}")
    };
    Err(source.error(
        word,
        format!("expected a number {wanted}, found {}", quoted(word)),
    ))
}

/// `d 0.5`, or `d -halo 0.5`, which asks for a rim that is more solid; it is read without the rim.
fn dissolve(source: &Source<'_>, s: Statement<'_, '_>) -> Result<f64, Diagnostic> {
    match s.args {
        [word] | ["-halo", word] => in_range(source, word, 0.0, 1.0),
        _ => Err(wrong_count(source, s, "1 number")),
    }
}

fn illumination(source: &Source<'_>, s: Statement<'_, '_>) -> Result<u64, Diagnostic> {
    let [word] = s.args else {
        return Err(wrong_count(source, s, "1 number (0 to 10)"));
    };
    whole(word).map_err(|message| source.error(word, message))
}

/// A texture's file name after its options.
fn map<'a>(
    source: &Source<'a>,
    s: Statement<'_, 'a>,
    unused_options: &mut Unused<'a>,
) -> Result<Map<'a>, Diagnostic> {
    let mut next = 0;
    while let Some(option) = s.args.get(next).copied() {
        // How many values the option has, and which of them leave the picture as it is without the option.
        let (values, neutral): (usize, &[f64]) = match option {
            "-s" => (3, &[1.0]),
            "-o" | "-t" => (3, &[0.0]),
            "-mm" => (2, &[0.0, 1.0]),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-bm" | "-boost" | "-imfchan"
            | "-type" => (1, &[]),
            _ => break,
        };
        let given = s.args.get(next + 1..).unwrap_or(&[]);
        // `-s 2` and `-s 2 2 1` are both allowed, so a number belongs to the option unless it is the last word.
        let numbers = given
            .iter()
            .map_while(|word| word.parse::<f64>().ok())
            .take(values);
        let numbers: Vec<f64> = numbers.take(given.len().saturating_sub(1)).collect();
        let taken = if neutral.is_empty() { values } else { numbers.len() };
        if taken == 0 || given.len() < taken {
            return Err(source.error(
                option,
                format!("the option {option} of {} lacks its value", s.keyword),
            ));
        }
        let changes = match neutral {
            [] => option == "-clamp" && given.first() == Some(&"on"),
            neutral => numbers
                .iter()
                .zip(neutral.iter().cycle())
                .any(|(x, same)| x != same),
        };
        if changes {
            unused_options.add(option);
        }
        next += 1 + taken;
    }
    let file = s.name_from(next);
    let at = s.args.get(next).copied().unwrap_or(s.keyword);
    if file.is_empty() {
        return Err(source.error(
            at,
            format!("{} takes the name of a picture file; it has none", s.keyword),
        ));
    }
    let unquoted = |name: &'a str| {
        name.strip_prefix('"')
            .and_then(|n| n.strip_suffix('"'))
            .unwrap_or(name)
    };
    let file = match file {
        Cow::Borrowed(name) => Cow::Borrowed(unquoted(name)),
        owned @ Cow::Owned(_) => owned,
    };
    Ok(Map { file, at })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::ErrorKind;

    fn one(text: &str) -> MtlMaterial<'_> {
        let source = Source::new("a.mtl", text, ErrorKind::Input);
        let library = parse(&source).unwrap();
        library.materials.into_values().next().unwrap()
    }

    #[test]
    fn file_names_follow_their_options() {
        let file = |line: &str| {
            let text = format!("newmtl a\n{line}\n");
            one(&text).diffuse_map.unwrap().file.into_owned()
        };
        for (line, wanted) in [
            ("map_Kd a.png", "a.png"),
            ("MAP_KD my cow #2.png  ", "my cow #2.png"),
            ("map_Kd -s 2 2 1 a b.png", "a b.png"),
            ("map_Kd -s 2 3.png", "3.png"),
            ("map_Kd -s 2 2 1 7", "7"),
            ("map_Kd -o 0.5 -clamp on -bm 1.0 a.png", "a.png"),
            ("map_Kd -mm 0 1 -blendu off \"a b.png\"", "a b.png"),
            ("map_Kd -foo.png", "-foo.png"),
            ("map_Kd -s 1 1 1 \\\n a.png", "a.png"),
        ] {
            assert_eq!(file(line), wanted, "{line}");
        }
    }

    #[test]
    fn only_options_that_would_show_are_reported() {
        let unused = |line: &str| {
            let text = format!("newmtl a\n{line} a.png\n");
            let source = Source::new("a.mtl", &text, ErrorKind::Input);
            let library = parse(&source).unwrap();
            format!("{:?}", library.unused_options).contains("count: 1")
        };
        assert!(unused("map_Kd -s 2 2 1") && unused("map_Kd -o .5 0 0") && unused("map_Kd -clamp on"));
        assert!(!unused("map_Kd -s 1 1 1") && !unused("map_Kd -o 0 0 0") && !unused("map_Kd -clamp off"));
        assert!(!unused("map_Kd -mm 0 1") && unused("map_Kd -mm 0 2"));
    }

    #[test]
    fn the_last_of_one_name_counts() {
        let text = "newmtl a b\nKd 1 0 0\nnewmtl a b\nKd .5\nNi 0\nd -halo .25\n";
        let material = one(text);
        assert_eq!(material.diffuse, Some(Color::splat(0.5)));
        assert_eq!(material.ior, None);
        assert_eq!(material.dissolve, Some(0.25));
    }
}
