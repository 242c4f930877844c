//! The test corpus on any target: every scene of `tests/scenes` at its own size, every script of the gallery small,
//! and of each a line of text that says what came out, to be compared with the line of another target or with what is
//! on record.

use std::{collections::BTreeMap, time::Duration};

use rtscript::{Error, Host, Limits, MemoryHost, RunOptions, source, testing::render_text};

#[cfg(target_family = "wasm")]
mod module;

/// Size of a script of the gallery, as in `tests/gallery.rs`, whose hashes are on record.
const GALLERY_SIZE: (u32, u32) = (48, 36);

/// The files of the corpus by path from the root of the repository, with `/`.
#[derive(Clone, Debug, Default)]
pub struct Corpus {
    /// Scenes and what they read.
    pub files: BTreeMap<String, Vec<u8>>,
}

impl Corpus {
    /// The scenes among the files, sorted.
    pub fn scenes(&self) -> Vec<String> {
        let paths = self.files.keys();
        paths.filter(|path| is_scene(path)).cloned().collect()
    }

    /// Renders a scene from memory and says what came out.
    pub fn line(&self, path: &str, options: &RunOptions) -> String {
        let Some(bytes) = self.files.get(path) else {
            return format!("{path} missing");
        };
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
        let mut assets = MemoryHost::new();
        for (asset, bytes) in &self.files {
            let below = asset.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/'));
            if let Some(below) = below {
                assets.insert(below, bytes.clone());
            }
        }
        line(path, name, bytes.clone(), &assets, options)
    }

    /// One run of bytes with all files, for a target that has none: of each the lengths of path and contents (32 bits,
    /// least byte first), the path, the contents.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (path, contents) in &self.files {
            for part in [path.as_bytes(), contents] {
                bytes.extend((part.len() as u32).to_le_bytes());
            }
            bytes.extend(path.as_bytes());
            bytes.extend(contents);
        }
        bytes
    }

    /// What [`Corpus::to_bytes`] made; `None` where it did not.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let mut corpus = Self::default();
        while let Some((lengths, rest)) = bytes.split_first_chunk::<8>() {
            let [a, b, c, d, e, f, g, h] = *lengths;
            let [path, contents] = [[a, b, c, d], [e, f, g, h]].map(u32::from_le_bytes);
            let (path, rest) = rest.split_at_checked(path as usize)?;
            let (contents, rest) = rest.split_at_checked(contents as usize)?;
            let path = str::from_utf8(path).ok()?.to_owned();
            corpus.files.insert(path, contents.to_vec());
            bytes = rest;
        }
        bytes.is_empty().then_some(corpus)
    }
}

/// Whether a file is a scene: those of the tests in any folder, those of the gallery at its top, where the modules lie
/// below.
pub fn is_scene(path: &str) -> bool {
    match path.strip_prefix("scripts/") {
        Some(name) => !name.contains('/') && name.ends_with(".rhai"),
        None => path.ends_with(".rhai") || path.ends_with(".test"),
    }
}

/// What comes of a scene: [`record`], then a hash of the linear values of its pixels to the last bit. A script of the
/// gallery is rendered small. `bytes` are the scene, `name` what messages call it, `assets` what it reads.
pub fn line(path: &str, name: &str, bytes: Vec<u8>, assets: &dyn Host, options: &RunOptions) -> String {
    let mut options = options.clone();
    if path.starts_with("scripts/") {
        (options.size, options.samples) = (Some(GALLERY_SIZE), Some(1));
    }
    // The deadline is the one limit that depends on the machine, and an emulator is slow.
    let mut limits = Limits::default();
    limits.script_time = Duration::from_secs(3600);
    let rendered = source::text(name, bytes, &limits)
        .and_then(|text| render_text(name, &text, assets, &limits, &options));
    match rendered {
        Ok(rendered) => {
            let line = record(path, &rendered.image.hash(), &rendered.snapshot());
            let mut linear = blake3::Hasher::new();
            for channel in rendered.image.pixels().as_flattened() {
                linear.update(&channel.to_bits().to_le_bytes());
            }
            format!("{line} {}", &linear.finalize().to_hex()[..16])
        }
        Err(error) if path.contains("/errors/") => {
            format!("{} none", record(path, "error", &error_text(&error)))
        }
        Err(error) => format!("{path} error {:?}", error_text(&error)),
    }
}

/// What can be on record for a scene: its path, the hash of its pixels (`error` where there are none), and a hash of its
/// snapshot, which is the text of the scene, of its warnings and of what it printed, or of its error (`none` for the
/// gallery, of which the hashes of pixels alone are on record).
pub fn record(path: &str, pixels: &str, snapshot: &str) -> String {
    if path.starts_with("scripts/") {
        return format!("{path} {pixels} none");
    }
    let hash = blake3::hash(snapshot.trim().as_bytes()).to_hex();
    format!("{path} {pixels} {}", &hash[..16])
}

/// The error as `tests/scenes.rs` records it.
fn error_text(error: &Error) -> String {
    let mut lines = Vec::new();
    for diagnostic in error.warnings.iter().chain([&*error.diagnostic]) {
        lines.push(diagnostic.to_string());
        let excerpt = diagnostic.source_line.as_ref();
        lines.extend(excerpt.map(|line| format!("  line: {}", line.trim())));
    }
    lines.push(format!("kind: {:?}", error.kind()));
    lines.join("\n")
}
