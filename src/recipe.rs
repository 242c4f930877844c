//! What a picture was made from, as its PNG file carries it.
//!
//! A recipe is text, so that any program that shows the text chunks of a PNG shows it:
//!
//! ```text
//! rtscript recipe 1
//! version 0.1.0
//! hash 9873d7cbfecb2edc72b5f628804edd45
//! parameters size=320x200 seed=3
//! file "scene.rhai" 26
//! light(); sphere(0, 0, 0, 1);
//! ```
//!
//! Each script follows its `file` line, which tells its length in bytes, and ends with a line end of its own.
//! Pictures and models that a script reads are not in it, and neither is any path but those that the script uses.

use std::fmt::Write as _;

use png::text_metadata::ITXtChunk;

use crate::parameters::{Parameters, unquoted};

/// Keyword of the text chunk.
const KEYWORD: &str = "rtscript recipe";
const HEAD: &str = "rtscript recipe 1";
/// Most bytes of text that are unpacked: a small file may hold a chunk that unpacks to gigabytes.
const MOST_BYTES: usize = 64 << 20;

/// What a picture was made from.
///
/// ```
/// use rtscript::{parameters::Parameters, recipe::Recipe};
/// let mut recipe = Recipe::new("scene.rhai", "import \"ball\" as ball;", &Parameters::default());
/// recipe.add("ball.rhai", "sphere(0, 0, 0, 1);");
/// assert_eq!(Recipe::parse(&recipe.to_text()), Some(recipe));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recipe {
    /// Version of the rtscript that made it.
    pub version: String,
    /// [`Image::hash`](crate::Image::hash) of the picture.
    pub hash: String,
    /// What was decided outside the script.
    pub parameters: Parameters,
    /// Names and texts of the scripts, the scene itself first, then its modules by their paths from its folder.
    pub files: Vec<(String, String)>,
}

impl Recipe {
    /// What a picture of the scene file `name` is made from: its text, and what was decided outside it.
    #[must_use]
    pub fn new(name: &str, text: &str, parameters: &Parameters) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            hash: String::new(),
            parameters: parameters.clone(),
            files: vec![(name.to_owned(), text.to_owned())],
        }
    }

    /// Adds a script that was read, unless it is there.
    pub fn add(&mut self, name: &str, text: &str) {
        if self.files.iter().all(|(known, _)| known != name) {
            self.files.push((name.to_owned(), text.to_owned()));
        }
    }

    /// The recipe of the picture with this hash.
    #[must_use]
    pub fn of_picture(&self, hash: String) -> Self {
        Self { hash, ..self.clone() }
    }

    /// As text, which [`Recipe::parse`] reads.
    #[must_use]
    pub fn to_text(&self) -> String {
        let Self {
            version,
            hash,
            parameters,
            files,
        } = self;
        let mut text = format!("{HEAD}\nversion {version}\nhash {hash}\nparameters {parameters}\n");
        for (name, content) in files {
            // Writing into a String does not fail.
            let _ = writeln!(text, "file {name:?} {}\n{content}", content.len());
        }
        text
    }

    /// Reads what [`Recipe::to_text`] wrote; `None` where it is anything else.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let mut recipe = Self::default();
        let mut rest = text.strip_prefix(HEAD)?.strip_prefix('\n')?;
        while let Some((line, after)) = rest.split_once('\n') {
            rest = after;
            let (key, value) = line.split_once(' ').unwrap_or((line, ""));
            match key {
                "version" => recipe.version = value.to_owned(),
                "hash" => recipe.hash = value.to_owned(),
                "parameters" => recipe.parameters = value.parse().ok()?,
                "file" => {
                    let (name, length) = value.rsplit_once(' ')?;
                    let content = rest.get(..length.parse().ok()?)?;
                    rest = rest[content.len()..].strip_prefix('\n')?;
                    recipe.files.push((unquoted(name)?, content.to_owned()));
                }
                // A later version may say more.
                _ => {}
            }
        }
        Some(recipe)
    }

    /// The recipe in the bytes of a PNG file; `None` where there is none, or where it cannot be read.
    #[must_use]
    pub fn of_png(bytes: &[u8]) -> Option<Self> {
        let limits = png::Limits { bytes: MOST_BYTES };
        let decoder = png::Decoder::new_with_limits(std::io::Cursor::new(bytes), limits);
        let reader = decoder.read_info().ok()?;
        let mut chunks = reader.info().utf8_text.iter();
        let mut chunk = chunks.find(|chunk| chunk.keyword == KEYWORD)?.clone();
        chunk.decompress_text_with_limit(MOST_BYTES).ok()?;
        Self::parse(&chunk.get_text().ok()?)
    }

    /// The text chunk that holds it.
    pub(crate) fn chunk(&self) -> ITXtChunk {
        let mut chunk = ITXtChunk::new(KEYWORD, self.to_text());
        chunk.compressed = true;
        chunk
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{output, testing::from_rgb8};

    fn recipe() -> Recipe {
        Recipe {
            version: "0.1.0".to_owned(),
            hash: "abc".to_owned(),
            parameters: "size=32x20 seed=3".parse().unwrap(),
            files: vec![
                ("scene \"a\".rhai".to_owned(), "file \"x\" 3\nabc\n".to_owned()),
                ("lib/ünì\n.rhai".to_owned(), String::new()),
            ],
        }
    }

    #[test]
    fn text_and_back() {
        assert_eq!(Recipe::parse(&recipe().to_text()), Some(recipe()));
        assert_eq!(
            Recipe::parse(&Recipe::default().to_text()),
            Some(Recipe::default())
        );
        let cut = recipe().to_text();
        for end in (0..cut.len()).filter(|end| cut.is_char_boundary(*end)) {
            // Whatever is missing, there is an answer.
            let _ = Recipe::parse(&cut[..end]);
        }
        assert_eq!(Recipe::parse("rtscript recipe 2\n"), None);
        assert_eq!(Recipe::parse("rtscript recipe 1\nfile \"a\" 99\nabc\n"), None);
    }

    #[test]
    fn a_png_carries_it_and_shows_the_same_pixels() {
        let image = from_rgb8(4, 2, &[7; 24]);
        let bytes = output::encode_png_with(&image, &recipe()).unwrap();
        assert_eq!(Recipe::of_png(&bytes), Some(recipe()));
        let decoded = image::load_from_memory(&bytes).unwrap().to_rgb8();
        assert_eq!(decoded.as_raw(), &image.rgb8());
        let plain = output::encode(&image, output::Format::Png).unwrap();
        assert_eq!(Recipe::of_png(&plain), None);
        assert_eq!(Recipe::of_png(&bytes[..50]), None);
        assert_eq!(Recipe::of_png(b"no picture"), None);
    }
}
