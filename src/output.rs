//! Pictures to files: encoding by the name's ending, and writing that leaves the whole new file or the old one.
//!
//! No encoder writes a time stamp or anything else the picture does not hold. A picture's identity is
//! [`Image::hash`], never the bytes of a file, which may change with the encoder's version.

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder};

use crate::{diag::ErrorKind, host::HostError, recipe::Recipe, render::Image};

/// Quality of JPEG files, of 100: no visible blocks, a third of the size of a PNG.
const JPEG_QUALITY: u8 = 95;

/// A kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lossless, compressed: `.png`.
    Png,
    /// Lossy: `.jpg`, `.jpeg`.
    Jpeg,
    /// Lossless, not compressed (binary portable pixmap, `P6`): `.ppm`.
    Ppm,
}

impl Format {
    /// Every ending that is known, with its format.
    pub const ENDINGS: [(&'static str, Self); 4] = [
        ("png", Self::Png),
        ("jpg", Self::Jpeg),
        ("jpeg", Self::Jpeg),
        ("ppm", Self::Ppm),
    ];

    /// The format that the ending of `path` asks for, upper or lower case.
    ///
    /// # Errors
    /// `Output` where the ending is missing or unknown; the message lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, HostError> {
        let ending = path.extension().map(|e| e.to_string_lossy().into_owned());
        let known = |ending: &String| {
            let mut endings = Self::ENDINGS.iter();
            endings.find(|(name, _)| ending.eq_ignore_ascii_case(name))
        };
        if let Some((_, format)) = ending.as_ref().and_then(known) {
            return Ok(*format);
        }
        let list: Vec<String> = Self::ENDINGS.iter().map(|(name, _)| format!(".{name}")).collect();
        let what = match ending {
            Some(ending) => format!("the ending '.{ending}' is not a picture format"),
            None => "the name has no ending that says the picture format".to_owned(),
        };
        Err(refused(path, format!("{what}; known are {}", list.join(", "))))
    }
}

/// Encodes a picture into a writer.
///
/// # Errors
/// What the writer reports.
pub fn encode_into(image: &Image, format: Format, out: &mut impl Write) -> io::Result<()> {
    let (width, height) = (image.width(), image.height());
    match format {
        Format::Png => encode_png(image, None, &mut *out)?,
        Format::Jpeg => JpegEncoder::new_with_quality(&mut *out, JPEG_QUALITY)
            .write_image(&image.rgb8(), width, height, ExtendedColorType::Rgb8)
            .map_err(into_io)?,
        Format::Ppm => {
            write!(out, "P6\n{width} {height}\n255\n")?;
            out.write_all(&image.rgb8())?;
        }
    }
    out.flush()
}

/// Encodes a PNG that carries its recipe as a text chunk.
///
/// # Errors
/// What the writer reports.
pub fn encode_png_with(image: &Image, recipe: &Recipe) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(image, Some(recipe), &mut bytes)?;
    Ok(bytes)
}

fn encode_png(image: &Image, recipe: Option<&Recipe>, out: impl Write) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    if let Some(recipe) = recipe {
        writer.write_text_chunk(&recipe.chunk())?;
    }
    writer.write_image_data(&image.rgb8())?;
    Ok(writer.finish()?)
}

/// Encodes a picture into bytes.
///
/// # Errors
/// What the encoder reports, such as a size the format cannot hold.
pub fn encode(image: &Image, format: Format) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_into(image, format, &mut bytes)?;
    Ok(bytes)
}

/// Writes a picture to a file in the format its ending asks for, whole or not at all.
///
/// # Errors
/// `Output`, naming the path, where the ending is unknown or the file cannot be written.
pub fn save(path: &Path, image: &Image) -> Result<(), HostError> {
    let format = Format::from_path(path)?;
    let bytes = encode(image, format).map_err(|e| refused(path, reason(&e)))?;
    write_atomically(path, &bytes)
}

/// As [`save`], with the recipe in the file where its format has a place for it: PNG.
///
/// # Errors
/// As [`save`].
pub fn save_with(path: &Path, image: &Image, recipe: &Recipe) -> Result<(), HostError> {
    if Format::from_path(path)? != Format::Png {
        return save(path, image);
    }
    let bytes = encode_png_with(image, recipe).map_err(|e| refused(path, reason(&e)))?;
    write_atomically(path, &bytes)
}

/// Writes a file so that `path` holds either all of `bytes` or what it held before, whatever happens in between:
/// into a temporary file beside it, to the disk, then renamed. A link at `path` is replaced, not followed.
///
/// # Errors
/// `Output`, naming the path and the system's reason.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), HostError> {
    write_atomically_with(path, |file| file.write_all(bytes))
}

/// As [`write_atomically`], all of what `write` writes.
pub(crate) fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> io::Result<()>,
) -> Result<(), HostError> {
    let write = || -> io::Result<()> {
        let (mut temporary, mut file) = Temporary::beside(path)?;
        write(&mut file)?;
        file.sync_all()?;
        drop(file);
        temporary.rename_to(path)?;
        sync_folder(&folder_of(path));
        Ok(())
    };
    write().map_err(|e| refused(path, reason(&e)))
}

/// Whether a picture can be written to `path`, asked before the render is paid for: the ending is known, and
/// [`check_writable`].
///
/// # Errors
/// `Output`, naming the path and what stands in the way.
pub fn check_target(path: &Path, inputs: &[PathBuf]) -> Result<(), HostError> {
    Format::from_path(path)?;
    check_writable(path, inputs)
}

/// Whether a file can be written to `path`: its folder exists and takes new files, and what is there already is
/// neither a folder, nor a device or pipe, nor one of `inputs`.
///
/// # Errors
/// `Output`, naming the path and what stands in the way.
pub fn check_writable(path: &Path, inputs: &[PathBuf]) -> Result<(), HostError> {
    let folder = folder_of(path);
    match fs::metadata(&folder) {
        Ok(m) if m.is_dir() => {}
        Ok(_) => return Err(refused(path, format!("'{}' is not a folder", folder.display()))),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(refused(
                path,
                format!("there is no folder '{}'", folder.display()),
            ));
        }
        Err(e) => return Err(refused(path, reason(&e))),
    }
    match fs::metadata(path) {
        Ok(m) if m.is_dir() => return Err(refused(path, "it is a folder")),
        Ok(m) if !m.is_file() => return Err(refused(path, "it is not a regular file")),
        _ => {}
    }
    if let Ok(real) = fs::canonicalize(path) {
        let is_input = |input: &PathBuf| fs::canonicalize(input).is_ok_and(|input| input == real);
        if inputs.iter().any(is_input) {
            return Err(refused(path, "it is one of the files the picture is made from"));
        }
    }
    // Only trying tells: permissions, read-only mounts, full tables of files.
    Temporary::beside(path)
        .map(drop)
        .map_err(|e| refused(path, reason(&e)))
}

/// The system's reason in words, without its number.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    match text.find(" (os error") {
        Some(end) => text[..end].to_lowercase(),
        None => text,
    }
}

fn refused(path: &Path, why: impl std::fmt::Display) -> HostError {
    HostError::new(
        ErrorKind::Output,
        format!("cannot write '{}': {why}", path.display()),
    )
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn into_io(error: image::ImageError) -> io::Error {
    match error {
        image::ImageError::IoError(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

/// A file `.NAME.PID.tmp` that is removed again unless it was renamed to its final name.
struct Temporary {
    path: Option<PathBuf>,
}

impl Temporary {
    /// Creates the file in the folder of `target`, never following or reusing what is there.
    fn beside(target: &Path) -> io::Result<(Self, fs::File)> {
        let Some(name) = target.file_name() else {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        };
        // Names may be 255 bytes long: the temporary one must not be longer than that either.
        let name: String = name.to_string_lossy().chars().take(48).collect();
        let pid = std::process::id();
        let mut attempt = 0u32;
        loop {
            let suffix = if attempt == 0 {
                String::new()
            } else {
                format!("-{attempt}")
            };
            let path = folder_of(target).join(format!(".{name}.{pid}{suffix}.tmp"));
            match fs::OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Self { path: Some(path) }, file)),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => attempt += 1,
                Err(e) => return Err(e),
            }
        }
    }

    fn rename_to(&mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.path {
            fs::rename(path, target)?;
        }
        self.path = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            // Nothing more can be done about a file that cannot be removed; the error that led here is reported.
            let _ = fs::remove_file(path);
        }
    }
}

/// Makes a rename survive a power cut. Only unix has a call for it; there, a folder that cannot be opened or does
/// not know the call has the file all the same.
fn sync_folder(folder: &Path) {
    if cfg!(unix)
        && let Ok(folder) = fs::File::open(folder)
    {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Encoding;

    /// A folder of the test's own, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("rtscript-output-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = fs::read_dir(&self.0)
                .unwrap()
                .map(|e| e.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).unwrap();
        }
    }

    fn gradient() -> Image {
        let pixels = (0..35).map(|i| [f64::from(i) / 34.0, 0.5, 1.5 - f64::from(i) / 20.0]);
        Image::new(7, 5, Encoding::Srgb, pixels.collect())
    }

    #[test]
    fn lossless_files_hold_the_very_pixels() {
        let image = gradient();
        let png = image::load_from_memory(&encode(&image, Format::Png).unwrap()).unwrap();
        assert_eq!(png.to_rgb8().into_raw(), image.rgb8());
        let ppm = encode(&image, Format::Ppm).unwrap();
        assert!(ppm.starts_with(b"P6\n7 5\n255\n"));
        assert!(ppm.ends_with(&image.rgb8()));
    }

    #[test]
    fn jpeg_is_near() {
        let image = Image::new(16, 16, Encoding::Srgb, vec![[0.2, 0.4, 0.6]; 256]);
        let jpeg = image::load_from_memory(&encode(&image, Format::Jpeg).unwrap())
            .unwrap()
            .to_rgb8()
            .into_raw();
        assert_eq!(jpeg.len(), 768);
        assert!(jpeg.iter().zip(image.rgb8()).all(|(a, b)| a.abs_diff(b) <= 3));
    }

    #[test]
    fn the_ending_says_the_format() {
        assert_eq!(Format::from_path(Path::new("a/b.PNG")), Ok(Format::Png));
        assert_eq!(Format::from_path(Path::new("b.jpeg")), Ok(Format::Jpeg));
        let message = |name: &str| Format::from_path(Path::new(name)).unwrap_err().message;
        assert_eq!(
            message("b.xyz"),
            "cannot write 'b.xyz': the ending '.xyz' is not a picture format; known are .png, .jpg, .jpeg, .ppm"
        );
        assert!(message("png").contains("no ending"));
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_stays() {
        let folder = Folder::new("replace");
        let path = folder.0.join("a.ppm");
        write_atomically(&path, b"old").unwrap();
        save(&path, &gradient()).unwrap();
        assert_eq!(
            fs::read(&path).unwrap(),
            encode(&gradient(), Format::Ppm).unwrap()
        );
        assert_eq!(folder.names(), ["a.ppm"]);
    }

    #[test]
    fn a_write_that_fails_leaves_the_old_file_and_no_temporary_one() {
        let folder = Folder::new("fail");
        let path = folder.0.join("taken.png");
        fs::create_dir_all(path.join("inside")).unwrap();
        let error = write_atomically(&path, b"new").unwrap_err();
        assert_eq!(error.kind, ErrorKind::Output);
        assert_eq!(folder.names(), ["taken.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_replaced_not_followed() {
        let folder = Folder::new("link");
        let (real, link) = (folder.0.join("real.ppm"), folder.0.join("link.ppm"));
        fs::write(&real, "keep").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"keep");
        assert_eq!(fs::read(&link).unwrap(), b"new");
    }

    #[test]
    fn targets_are_refused_before_the_render() {
        let folder = Folder::new("check");
        let at = |name: &str| folder.0.join(name);
        fs::create_dir(at("folder.png")).unwrap();
        fs::write(at("input.png"), "").unwrap();
        let why = |name: &str| check_target(&at(name), &[at("input.png")]).unwrap_err().message;
        assert!(why("folder.png").ends_with("it is a folder"));
        assert!(why("missing/a.png").contains("there is no folder"));
        assert!(why("input.png/a.png").contains("is not a folder"));
        assert!(why("input.png").contains("made from"));
        assert!(why("a.gif").contains("known are"));
        assert_eq!(check_target(&at("new.png"), &[at("input.png")]), Ok(()));
        let long = "n".repeat(251) + ".png";
        assert_eq!(check_target(&at(&long), &[]), Ok(()));
        assert_eq!(folder.names(), ["folder.png", "input.png"]);
    }
}
