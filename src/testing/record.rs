//! A snapshot of a scene file as `rtscript test` keeps it: text, small, readable in a review.

use std::fmt::{self, Write as _};

use super::{
    RenderedFile,
    snapshot::{GRID, Look},
};
use crate::{
    diag::on_one_line,
    parameters::{Parameters, unquoted},
};

const HEAD: &str = "rtscript snapshot 1";

/// A picture on record.
///
/// ```text
/// rtscript snapshot 1
/// version 0.1.0
/// edition 2026
/// parameters size=320x200
/// size 320 x 200
/// samples 4
/// hash 9873d7cbfecb2edc72b5f628804edd45
/// scene 25d1f70fd5a63c5f3a0bd9a7dd9e8c1b
/// holds objects 13 lights 1 materials 14
/// mean 0.247269 0.247269 0.130211
/// luma
///   00 00 00 00 00 00 00 00
///   (8 rows of 8 cells)
/// ```
///
/// and after it, where there are any, a line for each picture that the script rendered before the last
/// (`before "name.png" 320 x 200 hash ...`), each warning and each line that it printed.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, parameters::Parameters, testing::{Snapshot, render_text}};
/// let made = render_text("a.rhai", "size(8, 6); sphere(0, 0, 0, 1);", &NoHost, &Limits::default(), &RunOptions::default())?;
/// let snapshot = Snapshot::of(&made, &Parameters::default());
/// let read = Snapshot::parse(&snapshot.to_string()).expect("it was just written");
/// assert!(read.guards(&snapshot));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Version of the rtscript that took it.
    pub version: String,
    /// Year of the [edition](crate::scene::Edition) by which the scene was rendered.
    pub edition: u32,
    /// What was decided outside the script; a test decides the same.
    pub parameters: Parameters,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Rays per pixel.
    pub samples: u32,
    /// [`Image::hash`](crate::Image::hash) of the picture.
    pub hash: String,
    /// [`Scene::hash`](crate::Scene::hash) of the scene it shows.
    pub scene: String,
    /// What the scene holds, with how many: [`Scene::holds`](crate::Scene::holds).
    pub holds: Vec<(String, u64)>,
    /// What the picture looks like.
    pub look: Look,
    /// Pictures that the script rendered before the last: name if any, size, hash.
    pub earlier: Vec<(Option<String>, (u32, u32), String)>,
    /// Warnings of the script and the render, each with its place.
    pub warnings: Vec<String>,
    /// Lines that the script printed.
    pub printed: Vec<String>,
}

impl Snapshot {
    /// The snapshot of a scene file that was rendered under these parameters.
    #[must_use]
    pub fn of(rendered: &RenderedFile, parameters: &Parameters) -> Self {
        let image = &rendered.image;
        let earlier = rendered.earlier.iter().map(|picture| {
            let size = (picture.image.width(), picture.image.height());
            (picture.name.clone(), size, picture.image.hash())
        });
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            edition: rendered.scene.settings.edition().year(),
            parameters: parameters.clone(),
            width: image.width(),
            height: image.height(),
            samples: rendered.scene.settings.samples,
            hash: image.hash(),
            scene: rendered.scene.hash(),
            holds: rendered
                .scene
                .holds()
                .into_iter()
                .map(|(what, count)| (what.to_owned(), count))
                .collect(),
            look: Look::of(image),
            earlier: earlier.collect(),
            warnings: rendered.warnings.iter().map(ToString::to_string).collect(),
            printed: rendered.printed.lines().map(str::to_owned).collect(),
        }
    }

    /// Whether everything that a test guards is the same: the pictures, the warnings, what was printed. A scene that
    /// was written in another way and gives the same picture is the same to a test.
    #[must_use]
    pub fn guards(&self, actual: &Self) -> bool {
        let guarded = |s: &Self| {
            let size = (s.width, s.height);
            (
                size,
                s.hash.clone(),
                s.earlier.clone(),
                s.warnings.clone(),
                s.printed.clone(),
            )
        };
        guarded(self) == guarded(actual)
    }

    /// Reads the text of a snapshot.
    ///
    /// # Errors
    /// The number of the line that cannot be read, from 1, and what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, (u32, String)> {
        let mut snapshot = Self::default();
        // A line end may have been translated more than once.
        let mut lines = text.lines().map(|line| line.trim_end_matches('\r')).zip(1..);
        match lines.next() {
            Some((HEAD, _)) => {}
            _ => return Err((1, format!("expected '{HEAD}'"))),
        }
        while let Some((line, number)) = lines.next() {
            let read = if line == "luma" {
                let mut rows = lines.by_ref().take(GRID);
                snapshot.look.luma.iter_mut().try_for_each(|cells| {
                    let (row, _) = rows.next()?;
                    let mut values = row.split_whitespace();
                    cells.iter_mut().try_for_each(|cell| {
                        *cell = u8::from_str_radix(values.next()?, 16).ok()?;
                        Some(())
                    })
                })
            } else {
                snapshot.read(line)
            };
            read.ok_or_else(|| (number, on_one_line(format!("'{line}' is no line of a snapshot"))))?;
        }
        if snapshot.hash.is_empty() {
            return Err((1, "there is no line 'hash'".to_owned()));
        }
        Ok(snapshot)
    }

    fn read(&mut self, line: &str) -> Option<()> {
        let (key, value) = line.split_once(' ')?;
        let size = |text: &str| {
            let (width, height) = text.split_once(" x ")?;
            Some((width.parse().ok()?, height.parse().ok()?))
        };
        match key {
            "version" => self.version = value.to_owned(),
            "edition" => self.edition = value.parse().ok()?,
            "parameters" => self.parameters = value.parse().ok()?,
            "size" => (self.width, self.height) = size(value)?,
            "samples" => self.samples = value.parse().ok()?,
            "hash" => self.hash = value.to_owned(),
            "scene" => self.scene = value.to_owned(),
            "holds" => {
                let words: Vec<&str> = value.split_whitespace().collect();
                for pair in words.chunks(2) {
                    let [name, count] = pair else { return None };
                    self.holds.push(((*name).to_owned(), count.parse().ok()?));
                }
            }
            "mean" => {
                let mut values = value.split_whitespace();
                for channel in &mut self.look.mean {
                    *channel = values.next()?.parse().ok()?;
                }
            }
            "before" => {
                let (rest, hash) = value.rsplit_once(" hash ")?;
                let (name, dimensions) = match rest.rsplit_once("\" ") {
                    Some((name, dimensions)) => (Some(unquoted(&format!("{name}\""))?), dimensions),
                    None => (None, rest.strip_prefix("unnamed ")?),
                };
                self.earlier.push((name, size(dimensions)?, hash.to_owned()));
            }
            "warning" => self.warnings.push(unquoted(value)?),
            "printed" => self.printed.push(unquoted(value)?),
            _ => return None,
        }
        Some(())
    }
}

impl fmt::Display for Snapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            version,
            edition,
            parameters,
            width,
            height,
            samples,
            hash,
            scene,
            holds,
            look,
            earlier,
            warnings,
            printed,
        } = self;
        writeln!(
            f,
            "{HEAD}\nversion {version}\nedition {edition}\nparameters {parameters}"
        )?;
        writeln!(
            f,
            "size {width} x {height}\nsamples {samples}\nhash {hash}\nscene {scene}"
        )?;
        if !holds.is_empty() {
            let mut line = "holds".to_owned();
            for (name, count) in holds {
                write!(line, " {name} {count}")?;
            }
            writeln!(f, "{line}")?;
        }
        write!(f, "{look}")?;
        for (name, (width, height), hash) in earlier {
            let name = name
                .as_ref()
                .map_or("unnamed".to_owned(), |name| format!("{name:?}"));
            writeln!(f, "before {name} {width} x {height} hash {hash}")?;
        }
        for warning in warnings {
            writeln!(f, "warning {warning:?}")?;
        }
        for line in printed {
            writeln!(f, "printed {line:?}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot() -> Snapshot {
        Snapshot {
            version: "0.1.0".to_owned(),
            edition: 2026,
            parameters: "size=32x20".parse().unwrap(),
            width: 32,
            height: 20,
            samples: 4,
            hash: "0123".to_owned(),
            scene: "4567".to_owned(),
            holds: vec![("objects".to_owned(), 3), ("lights".to_owned(), 1)],
            look: Look {
                mean: [0.25, 0.5, 0.125],
                luma: std::array::from_fn(|row| std::array::from_fn(|column| (row * 32 + column) as u8)),
            },
            earlier: vec![
                (Some("a \"b\" 1 x 2.png".to_owned()), (3, 4), "89".to_owned()),
                (None, (5, 6), "ab".to_owned()),
            ],
            warnings: vec!["a.rhai:1:2: warning: dark\n  hint: light()".to_owned()],
            printed: vec![String::new(), "x\ty".to_owned()],
        }
    }

    #[test]
    fn text_and_back() {
        let text = snapshot().to_string();
        assert_eq!(Snapshot::parse(&text), Ok(snapshot()), "{text}");
        let windows = text.replace('\n', "\r\n");
        assert_eq!(Snapshot::parse(&windows), Ok(snapshot()));
        assert_eq!(Snapshot::parse(&windows.replace('\r', "\r\r")), Ok(snapshot()));
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let text = snapshot().to_string();
        for (from, to, line) in [
            ("rtscript snapshot 1", "rtscript snapshot 2", 1),
            ("size 32 x 20", "size 32x20", 5),
            ("  00 01", "  00 0g", 11),
            ("hash 0123\n", "", 1),
            ("printed \"\"", "printed", 23),
            ("samples", "smples", 6),
        ] {
            let found = Snapshot::parse(&text.replacen(from, to, 1)).unwrap_err();
            assert_eq!(found.0, line, "{from} -> {to}: {}", found.1);
        }
        assert!(Snapshot::parse("").is_err());
        for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
            // Whatever is missing, there is an answer.
            let _ = Snapshot::parse(&text[..end]);
        }
    }

    #[test]
    fn a_test_guards_pictures_warnings_and_prints() {
        type Change = fn(&mut Snapshot);
        let changes: [(Change, bool); 8] = [
            (|s| s.version.push('1'), true),
            (|s| s.scene.push('1'), true),
            (|s| s.holds.clear(), true),
            (|s| s.hash.push('1'), false),
            (|s| s.width = 1, false),
            (|s| s.earlier[0].2.push('1'), false),
            (|s| s.warnings.clear(), false),
            (|s| s.printed[0].push('1'), false),
        ];
        for (i, (change, same)) in changes.iter().enumerate() {
            let mut actual = snapshot();
            change(&mut actual);
            assert_eq!(snapshot().guards(&actual), *same, "change {i}");
        }
    }
}
