//! What holds of every answer.

use rtscript::{
    Error, Limits, MemoryHost, RunOptions, Scene, Script,
    diag::{Diagnostic, ErrorKind},
    script::Run,
};

/// Bytes of a message, without notes and hints.
const MOST_MESSAGE: usize = 4 << 10;
/// Bytes of all that is said of one error.
const MOST_TEXT: usize = 16 << 10;

/// The limits of scripts of strangers, and less where that much would keep the fuzzer waiting.
#[must_use]
pub fn limits() -> Limits {
    let mut limits = Limits::untrusted();
    limits.operations = 100_000;
    limits.source_bytes = 32 << 10;
    limits.primitives = 5_000;
    limits.texture_side = 256;
    limits.decode_bytes = 4 << 20;
    limits.file_bytes = 1 << 20;
    limits.image_side = 64;
    limits.pixels = 1_024;
    limits.samples = 4;
    limits.depth = 4;
    limits.lights = 16;
    limits.print_bytes = 4 << 10;
    // The operations end a script; that time does on a busy machine must not look like a finding.
    limits.script_time = std::time::Duration::from_secs(600);
    limits
}

/// A host with the files that the language's examples name.
#[must_use]
pub fn host() -> MemoryHost {
    let mut host = MemoryHost::new();
    for (name, bytes) in rtscript::script::EXAMPLE_FILES {
        host.insert(name, *bytes);
    }
    host
}

/// An error or a warning can be shown: it has words, not too many, on lines of their own, and its place is in the file.
/// `texts` are the files that are known, by name.
pub fn check(diagnostic: &Diagnostic, texts: &[(&str, &str)]) {
    let d = diagnostic;
    assert_ne!(d.kind, ErrorKind::Internal, "a fault of rtscript's own: {d}");
    assert!(!d.message.is_empty(), "an error without words: {d:?}");
    assert!(
        d.message.len() <= MOST_MESSAGE,
        "a message of {} bytes",
        d.message.len()
    );
    let text = d.to_string();
    assert!(
        text.len() <= MOST_TEXT,
        "{} bytes are said of one error",
        text.len()
    );
    let lines = [&d.message].into_iter().chain(&d.notes).chain(&d.hints);
    for line in lines {
        let control = line.chars().find(|c| c.is_control());
        assert!(control.is_none(), "{control:?} in a message: {line:?}");
    }
    let known = texts.iter().find(|(name, _)| Some(*name) == d.file.as_deref());
    let Some((_, text)) = known.filter(|_| d.line > 0) else {
        assert!(d.line == 0 || d.file.is_some(), "a line without a file: {d:?}");
        return;
    };
    // The end of a text that ends with a line end is on the line after it; CR alone ends a line, too.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let line = text.split('\n').nth(d.line as usize - 1);
    let line = line.unwrap_or_else(|| panic!("line {} is not in the file: {d}", d.line));
    let most = line.chars().count() as u32 + 1;
    assert!(
        d.column <= most,
        "column {} is not in the line {line:?}: {d}",
        d.column
    );
}

/// The same of all that a failed run tells.
pub fn check_error(error: &Error, texts: &[(&str, &str)]) {
    error.all().chain(&error.warnings).for_each(|d| check(d, texts));
}

/// A scene written out as a script builds the same scene again, and is written out as the same text again.
pub fn check_source(run: &Run, host: &MemoryHost, same_scene: bool) {
    let (flat, again) = (source_of(run), run_flat(run, host));
    if same_scene {
        assert_eq!(
            again.scene.hash(),
            run.scene.hash(),
            "another scene\n{}\n{}",
            flat,
            difference(&run.scene, &again.scene)
        );
        assert_eq!(source_of(&again), flat, "another text");
    } else {
        // Handles of calls that failed are left over in the first scene; the second has none of them.
        let third = run_flat(&again, host);
        assert_eq!(third.scene.hash(), again.scene.hash(), "another scene\n{flat}");
    }
}

fn source_of(run: &Run) -> String {
    let mut text = String::new();
    run.write_source(false, &mut text)
        .expect("a String takes any text");
    text
}

fn run_flat(run: &Run, host: &MemoryHost) -> Run {
    let flat = source_of(run);
    let script = Script::compile("flat.rhai", &flat, &Limits::default());
    let script = script.unwrap_or_else(|e| panic!("the text is no script: {e}\n{flat}"));
    let again = script.run(host, &RunOptions::default());
    again
        .unwrap_or_else(|e| panic!("the text does not run: {e}\n{flat}"))
        .value
}

fn difference(a: &Scene, b: &Scene) -> String {
    let (a, b) = (a.dump(), b.dump());
    let mut lines = a.lines().zip(b.lines()).filter(|(a, b)| a != b);
    lines
        .next()
        .map_or_else(String::new, |(a, b)| format!("{a}\n{b}"))
}
