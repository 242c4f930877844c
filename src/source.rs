//! One way in for every kind of scene file: the bytes of a script or of a course scene to a [`Run`].

use crate::{
    diag::{Diagnostic, Error, ErrorKind, Report},
    host::Host,
    import,
    limits::Limits,
    scene::{AssetFiles, Builder, Crop},
    script::{Run, RunOptions, Script},
};

/// What a scene file is written in; its name's ending says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A Rhai script: any ending but those below.
    Script,
    /// A scene of the CSE167 course: `.test`.
    Course,
}

impl SourceKind {
    /// The kind that the ending of `name` asks for, upper or lower case.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        match name.rsplit_once('.') {
            Some((_, ending)) if ending.eq_ignore_ascii_case("test") => Self::Course,
            _ => Self::Script,
        }
    }
}

/// The text of a scene file: UTF-8, not empty, a byte order mark at its start dropped.
///
/// # Errors
/// `Limit` where there are more bytes than the limit `source_bytes`; `Input` with the place where they are not
/// UTF-8, or where there is nothing but blanks.
pub fn text(name: &str, bytes: Vec<u8>, limits: &Limits) -> Result<String, Error> {
    if bytes.len() > limits.source_bytes {
        let limit = limits.source_bytes;
        return Err(Diagnostic::error(
            ErrorKind::Limit,
            format!("the file is too large: the limit 'source_bytes' is {limit}"),
        )
        .at(name, 0, 0)
        .into());
    }
    let mut text = String::from_utf8(bytes).map_err(|e| {
        let valid = e.as_bytes().get(..e.utf8_error().valid_up_to());
        let valid = String::from_utf8_lossy(valid.unwrap_or_default());
        let line = valid.matches('\n').count() as u32 + 1;
        let column = valid.rsplit('\n').next().unwrap_or_default().chars().count() as u32 + 1;
        Diagnostic::error(ErrorKind::Input, "the file is not UTF-8 text")
            .at(name, line, column)
            .hint("save it as UTF-8; a picture or a model is named by the script, not given to the command")
    })?;
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    if text.trim().is_empty() {
        return Err(Diagnostic::error(ErrorKind::Input, "the file is empty")
            .at(name, 1, 1)
            .hint(match SourceKind::from_name(name) {
                SourceKind::Course => "a scene is a list of commands, one a line: camera 0 0 4 0 0 0 0 1 0 45, ambient 1 0 0, sphere 0 0 0 1",
                SourceKind::Script => "a scene is a list of calls: light([5, 5, 5], [1, 1, 1]); diffuse([1, 0, 0]); sphere(0, 0, 0, 1);",
            })
            .into());
    }
    Ok(text)
}

/// Runs a script, or reads a course scene, up to the complete scene. What a script renders by itself is rendered
/// on the way; where [`Run::pictures`] is empty, the scene is left to be rendered.
///
/// # Errors
/// Whatever is wrong with the source or a file it names, with its place; `Limit`, `Denied` and `Cancelled` as
/// `host` and `limits` say.
pub fn load(
    name: &str,
    text: &str,
    host: &dyn Host,
    limits: &Limits,
    options: &RunOptions,
) -> Result<Report<Run>, Error> {
    match SourceKind::from_name(name) {
        SourceKind::Script => Script::compile(name, text, limits)?.run(host, options),
        SourceKind::Course => load_course(name, text, limits, options),
    }
}

fn load_course(name: &str, text: &str, limits: &Limits, options: &RunOptions) -> Result<Report<Run>, Error> {
    if let Some(parameter) = options.parameters.keys().next() {
        return Err(Diagnostic::error(
            ErrorKind::Script,
            format!("the scene has no parameter \"{parameter}\": the course's format has none"),
        )
        .at(name, 0, 0)
        .hint("rtscript convert makes a script of it")
        .into());
    }
    let mut builder = Builder::with_limits(limits.clone());
    let mut build = || -> Result<(), Error> {
        import::load_course(name, text, &mut builder)?;
        if let Some((width, height)) = options.size {
            builder.size(width, height).map_err(Diagnostic::from)?;
        }
        if let Some(samples) = options.samples {
            builder.samples(samples).map_err(Diagnostic::from)?;
        }
        if let Some(seed) = options.seed {
            builder.seed(seed);
        }
        if let Some(region) = options.region {
            let crop = Crop::Pixels(region);
            builder.crop(Some(crop)).map_err(Diagnostic::from)?;
        }
        Ok(())
    };
    if let Err(mut error) = build() {
        error.more = import::further_course_errors(name, text, error.diagnostic.line);
        error.warnings.extend(builder.take_warnings());
        return Err(error);
    }
    let Report {
        value: scene,
        warnings,
    } = builder.finish();
    let run = Run {
        scene,
        pictures: Vec::new(),
        parameters: Vec::new(),
        files: AssetFiles::default(),
        calls: Vec::new(),
    };
    Ok(Report { value: run, warnings })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(bytes: &[u8]) -> Result<String, String> {
        text("a.rhai", bytes.to_vec(), &Limits::untrusted()).map_err(|d| d.to_string())
    }

    #[test]
    fn the_ending_says_the_kind() {
        assert_eq!(SourceKind::from_name("a/scene1.TEST"), SourceKind::Course);
        for script in ["a.rhai", "test", "a.test.rhai", "<stdin>"] {
            assert_eq!(SourceKind::from_name(script), SourceKind::Script, "{script}");
        }
    }

    #[test]
    fn a_byte_order_mark_is_dropped() {
        assert_eq!(text_of(b"\xef\xbb\xbfsphere();"), Ok("sphere();".to_owned()));
    }

    #[test]
    fn what_is_no_text_is_refused_with_its_place() {
        let error = text_of(b"size(1, 1);\n// caf\xe9").unwrap_err();
        assert!(
            error.starts_with("a.rhai:2:7: error: the file is not UTF-8 text"),
            "{error}"
        );
        for empty in [&b""[..], b" \r\n\t", b"\xef\xbb\xbf"] {
            let error = text_of(empty).unwrap_err();
            assert!(
                error.starts_with("a.rhai:1:1: error: the file is empty"),
                "{error}"
            );
        }
        let error = text_of(&[b' '; 300_000]).unwrap_err();
        assert!(error.contains("'source_bytes' is 262144"), "{error}");
    }
}
