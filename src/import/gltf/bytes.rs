//! The bytes of a file's buffers: of other files, within the text, or behind it.

use std::{
    borrow::Cow,
    cell::{OnceCell, RefCell},
    collections::BTreeMap,
};

use super::{
    super::{assets::Assets, text::counted, text::quoted},
    item::{Item, Kind},
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    host::resolve,
};

/// The two parts of a `.glb` file.
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// Whether bytes are those of a `.glb` file.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(b"glTF")
}

/// The text of a `.glb` file and the bytes behind it, if it has any.
///
/// # Errors
/// Where the parts are not as long as they say, or are others.
pub(super) fn parts<'a>(name: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), Diagnostic> {
    let error = |message: String| Diagnostic::error(ErrorKind::Input, message).at(name, 0, 0);
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        let n = counted(bytes.len(), "byte", "bytes");
        return Err(error(format!("expected a header of 12 bytes, found {n}")));
    };
    if version != 2 {
        return Err(error(format!("the file is glTF {version}; expected glTF 2")));
    }
    let Some(bytes) = bytes.get(..length as usize) else {
        return Err(error(format!(
            "the header says {length} bytes, the file has {}",
            bytes.len()
        ))
        .hint("the file is cut off"));
    };
    let chunk = |at: usize| -> Result<Option<(u32, &'a [u8])>, Diagnostic> {
        let Some((length, rest)) = bytes.get(at..).and_then(|rest| rest.split_first_chunk()) else {
            return Ok(None);
        };
        let length = u32::from_le_bytes(*length);
        let kind = rest.split_first_chunk();
        let part =
            kind.and_then(|(kind, rest)| Some((u32::from_le_bytes(*kind), rest.get(..length as usize)?)));
        part.map(Some).ok_or_else(|| {
            error(format!(
                "the part of {length} bytes at byte {at} goes past the end of the file"
            ))
        })
    };
    const FIRST: usize = 12;
    let Some((JSON, text)) = chunk(FIRST)? else {
        return Err(error(format!("expected a part of JSON at byte {FIRST}")));
    };
    let second = FIRST + 8 + text.len().next_multiple_of(4);
    Ok(match chunk(second)? {
        Some((BIN, binary)) => (text, Some(binary)),
        _ => (text, None),
    })
}

const BUFFER: Kind = Kind {
    one: "buffer",
    list: "buffers",
};

/// The buffers of a file, each read when it is asked for.
pub(super) struct Buffers<'a> {
    /// What the file is called.
    name: &'a str,
    binary: Option<&'a [u8]>,
    read: Vec<OnceCell<Cow<'a, [u8]>>>,
    /// Bytes of files that were read before they were asked for.
    before: RefCell<BTreeMap<String, Vec<u8>>>,
    /// The files that were asked for, and hashes of them.
    files: RefCell<Vec<(String, blake3::Hash)>>,
}

impl<'a> Buffers<'a> {
    /// So many, of which the first may be `binary`.
    pub(super) fn new(name: &'a str, count: usize, binary: Option<&'a [u8]>) -> Self {
        Self {
            name,
            binary,
            read: vec![OnceCell::new(); count],
            before: RefCell::default(),
            files: RefCell::default(),
        }
    }

    /// Whether files are as they were when these hashes were taken. They are read for that, and not again.
    pub(super) fn are_as_before(&self, files: &[(String, blake3::Hash)], assets: &mut Assets<'_>) -> bool {
        let mut before = self.before.borrow_mut();
        files.iter().all(|(path, hash)| match assets.read(path) {
            Ok(bytes) => {
                let is_same = blake3::hash(&bytes) == *hash;
                before.insert(path.clone(), bytes);
                is_same
            }
            Err(_) => false,
        })
    }

    /// The files that were read, and hashes of them.
    pub(super) fn files(&self) -> Vec<(String, blake3::Hash)> {
        self.files.borrow().clone()
    }

    /// What the `uri` of a buffer leads to.
    fn uri(&self, uri: &Item<'_, 'a>, assets: &mut Assets<'_>) -> Result<Vec<u8>, Diagnostic> {
        if let Some(bytes) = data(uri)? {
            return Ok(bytes);
        }
        let path = file(self.name, uri)?;
        let before = self.before.borrow_mut().remove(&path);
        let bytes = match before {
            Some(bytes) => bytes,
            None => assets.read(&path).map_err(|error| uri.place(error))?,
        };
        if assets.kept().is_some() {
            self.files.borrow_mut().push((path, blake3::hash(&bytes)));
        }
        Ok(bytes)
    }

    /// Reads the buffer that `item`, an entry of `buffers`, describes.
    fn bytes(&self, i: usize, item: &Item<'_, 'a>, assets: &mut Assets<'_>) -> Result<&[u8], Diagnostic> {
        let cell = self.read.get(i).ok_or_else(|| item.error("it is one too many"))?;
        if let Some(known) = cell.get() {
            return Ok(known);
        }
        let length = item.needed("byteLength")?;
        let bytes: Cow<'a, [u8]> = match (item.get("uri")?, self.binary) {
            (Some(uri), _) => Cow::Owned(self.uri(&uri, assets)?),
            (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
            (None, _) => return Err(item.error("it has no 'uri', and the file has no bytes behind its text")),
        };
        let wanted = length.whole()?;
        if bytes.len() < wanted {
            let n = counted(bytes.len(), "byte", "bytes");
            return Err(length.error(format!("the buffer is to have {wanted} bytes, and has {n}")));
        }
        Ok(cell.get_or_init(|| bytes))
    }

    /// The bytes of an entry of `bufferViews`, and how far apart its elements lie where it says so.
    pub(super) fn view(
        &self,
        root: &Item<'_, 'a>,
        item: &Item<'_, 'a>,
        assets: &mut Assets<'_>,
    ) -> Result<(&[u8], Option<usize>), Diagnostic> {
        let number = item.needed("buffer")?;
        let i = number.index(BUFFER, self.read.len())?;
        let buffers = root.needed(BUFFER.list)?;
        let buffer = buffers
            .entry(i)?
            .ok_or_else(|| number.error("there is no such buffer"))?;
        let bytes = self.bytes(i, &buffer, assets)?;
        let (start, length) = (
            item.whole_or("byteOffset", 0)?,
            item.needed("byteLength")?.whole()?,
        );
        let view = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let Some(view) = view else {
            return Err(item.error(format!(
                "bytes {start} to {} are not all in buffer {i}, which has {}",
                start.saturating_add(length),
                bytes.len()
            )));
        };
        let stride = match item.get("byteStride")? {
            None => None,
            Some(stride) => Some(match stride.whole()? {
                n @ 1..=252 => n,
                _ => return Err(stride.error("expected a number of bytes from 4 to 252")),
            }),
        };
        Ok((view, stride))
    }
}

/// What a `uri` leads to: a file beside `name`, or its own text in base64.
pub(super) fn file_or_data(
    name: &str,
    uri: &Item<'_, '_>,
    assets: &mut Assets<'_>,
) -> Result<Vec<u8>, Diagnostic> {
    match data(uri)? {
        Some(bytes) => Ok(bytes),
        None => assets.read(&file(name, uri)?).map_err(|error| uri.place(error)),
    }
}

/// The bytes of a `data:` uri; `None` where it is another.
pub(super) fn data(uri: &Item<'_, '_>) -> Result<Option<Vec<u8>>, Diagnostic> {
    let Some(data) = uri.string()?.strip_prefix("data:") else {
        return Ok(None);
    };
    let Some((_, text)) = data.split_once(";base64,") else {
        return Err(uri.error("expected data in base64, as data:application/octet-stream;base64,AAAA"));
    };
    match base64(text.as_bytes()) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(at) => Err(uri.error(format!("the data is no base64 at byte {at} of it"))),
    }
}

/// The path of a file that a `uri` names.
pub(super) fn file(name: &str, uri: &Item<'_, '_>) -> Result<String, Diagnostic> {
    let text = uri.string()?;
    let scheme = text.split_once(':').map(|(scheme, _)| scheme);
    if scheme.is_some_and(|s| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric())) {
        let message = format!(
            "{uri}: {} is not beside the file; only such files are read",
            quoted(text)
        );
        return Err(uri.place(Diagnostic::error(ErrorKind::Denied, message)));
    }
    let path = unescaped(text).ok_or_else(|| uri.error(format!("{} is no uri of UTF-8", quoted(text))))?;
    Ok(resolve(name, &path))
}

/// A uri with `%20` and the like turned into what they stand for; a `%` that stands for nothing stays.
fn unescaped(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let digits = after.first_chunk::<2>().filter(|_| byte == b'%');
        let code = digits.and_then(|digits| {
            let text = std::str::from_utf8(digits).ok()?;
            let is_hex = digits.iter().all(u8::is_ascii_hexdigit);
            is_hex.then(|| u8::from_str_radix(text, 16).ok())?
        });
        bytes.push(code.unwrap_or(byte));
        rest = if code.is_some() {
            after.get(2..).unwrap_or(&[])
        } else {
            after
        };
    }
    String::from_utf8(bytes).ok()
}

/// The bytes that base64 (RFC 4648) stands for.
///
/// # Errors
/// With the place of the first byte that is none of it.
fn base64(text: &[u8]) -> Result<Vec<u8>, usize> {
    let end = text.iter().rposition(|b| *b != b'=').map_or(0, |last| last + 1);
    let mut bytes = Vec::with_capacity(end / 4 * 3 + 3);
    let (mut bits, mut count) = (0u32, 0);
    for (i, byte) in text.iter().take(end).enumerate() {
        let digit = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return Err(i),
        };
        bits = bits << 6 | u32::from(digit);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    match end % 4 {
        1 => Err(end),
        _ => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_read_with_and_without_its_end() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm8", "fo"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text.as_bytes()).unwrap(), bytes.as_bytes(), "{text}");
        }
        assert_eq!(base64(b"+/-_").unwrap(), [0xfb, 0xff, 0xbf]);
        assert_eq!(base64(b"Zm9*"), Err(3));
        assert_eq!(base64(b"Zm9vY"), Err(5));
        assert_eq!(base64(b"Z=9v"), Err(1));
    }

    #[test]
    fn uris_are_unescaped() {
        assert_eq!(unescaped("a%20b%C3%A9.bin").unwrap(), "a b\u{e9}.bin");
        assert_eq!(unescaped("100%").unwrap(), "100%");
        assert_eq!(unescaped("%+1%2").unwrap(), "%+1%2");
        assert_eq!(unescaped("%ff"), None);
    }
}
