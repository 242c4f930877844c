//! Bad input with the whole of what is said about it, as data: `script.txt`, `course.txt`, `model.txt`, `gltf.txt`, `picture.txt`.
//!
//! A case is an input between `## input` and `## says`, which names the kind of the error, and below that the words.
//! `## input raw` has `\r`, `\0` and `\u{..}` escaped. Each input is there for a reason of its own.
//! `RTSCRIPT_ACCEPT=1 cargo test --test bad` writes what is said anew; the difference is to be read as a newcomer would.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::result_large_err,
    reason = "a test that fails panics, and nobody waits for its errors"
)]

mod picture;

use std::{collections::BTreeSet, env, fmt::Write as _, fs, path::PathBuf};

use rtscript::{
    Builder, Error, Limits, MemoryHost, RunOptions,
    diag::Diagnostic,
    import::{AssetCache, Assets, load_mesh, load_obj},
    script::EXAMPLE_FILES,
    source,
};

/// What is wrong with an input; `None` where nothing is.
type Check = fn(&str) -> Option<Error>;

/// Runs all cases of a file, of which there must be so many.
fn check_file(name: &str, least: usize, check: Check) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/bad")
        .join(name);
    let kept = fs::read_to_string(&path).unwrap();
    let (preface, cases) = kept.split_at(kept.find("## input").unwrap_or(kept.len()));
    let mut written = preface.to_owned();
    let mut seen = BTreeSet::new();
    let (mut passed, mut badly_said) = (Vec::new(), Vec::new());
    for case in cases.split("## input").skip(1) {
        let (input, _) = case
            .split_once("\n## says")
            .unwrap_or_else(|| panic!("without an answer: {case}"));
        let (how, text) = input.split_once('\n').unwrap_or((input, ""));
        let text = if how.trim() == "raw" {
            unescaped(text)
        } else {
            text.to_owned()
        };
        assert!(seen.insert(text.clone()), "twice in {name}: {text:?}");
        let Some(error) = check(&text) else {
            passed.push(text);
            continue;
        };
        badly_said.extend(error.all().filter_map(|d| badly_said_in(d, &text)));
        let _ = writeln!(
            written,
            "## input{how}\n{}",
            &input[how.len()..].trim_start_matches('\n')
        );
        let _ = writeln!(
            written,
            "## says {:?} [{}]\n{error}\n",
            error.kind(),
            error.diagnostic.code.name()
        );
    }
    if env::var_os("RTSCRIPT_ACCEPT").is_some() {
        fs::write(&path, &written).unwrap();
    } else if written != kept {
        let differing = written.lines().zip(kept.lines()).find(|(new, old)| new != old);
        panic!("{name}: what is said has changed, first here (new, on record): {differing:#?}");
    }
    assert!(passed.is_empty(), "nothing is wrong with {passed:#?}");
    assert!(
        badly_said.is_empty(),
        "a capital, a full stop, too much or another line's excerpt: {badly_said:#?}"
    );
    assert!(
        seen.len() >= least,
        "{} cases of at least {least} in {name}",
        seen.len()
    );
}

/// What no message has; a word of the input may stand in it as it is.
fn badly_said_in(d: &Diagnostic, input: &str) -> Option<String> {
    let word = d
        .message
        .split(|c: char| !c.is_alphanumeric())
        .next()
        .unwrap_or("");
    let capital = word.starts_with(char::is_uppercase) && !input.contains(word) && word != "OBJ";
    let full_stop = d.message.ends_with('.') && !d.message.ends_with("...");
    let lines = input.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let line = lines.split(['\n', '\r']).nth((d.line as usize).wrapping_sub(1));
    let other = d
        .source_line
        .as_deref()
        .zip(line.map(|line| line.chars().take(400).collect::<String>()));
    let of_input = d
        .file
        .as_deref()
        .is_some_and(|file| ["a.rhai", "a.test"].contains(&file));
    let misplaced = of_input && other.is_some_and(|(excerpt, line)| *excerpt != line);
    let crowded = d.message.len() > 4096 || d.message.chars().any(char::is_control);
    (capital || full_stop || crowded || misplaced).then(|| d.to_string())
}

fn unescaped(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        plain.push_str(before);
        let (c, after) = match after.split_at(1) {
            ("r", after) => ('\r', after),
            ("0", after) => ('\0', after),
            ("u", after) => {
                let (digits, after) = after[1..].split_once('}').unwrap();
                (
                    char::from_u32(u32::from_str_radix(digits, 16).unwrap()).unwrap(),
                    after,
                )
            }
            (_, after) => ('\\', after),
        };
        plain.push(c);
        rest = after;
    }
    plain + rest
}

fn of_script(text: &str) -> Option<Error> {
    let mut host = MemoryHost::new()
        .with("wrong.rhai", "let a = ;")
        .with("bytes.rhai", [0xff]);
    for (name, bytes) in EXAMPLE_FILES {
        host.insert(name, *bytes);
    }
    let mut options = RunOptions::default();
    options.dry = true;
    let limits = Limits::default();
    let text = source::text("a.rhai", text.as_bytes().to_vec(), &limits);
    text.and_then(|text| source::load("a.rhai", &text, &host, &limits, &options))
        .err()
}

fn of_course(text: &str) -> Option<Error> {
    let (limits, host, options) = (Limits::untrusted(), MemoryHost::new(), RunOptions::default());
    let load = |text: &str| source::load("a.test", text, &host, &limits, &options).err();
    let error = source::text("a.test", text.as_bytes().to_vec(), &limits);
    let error = error.map_or_else(Some, |text| load(&text));
    if !text.contains('\r') && !text.trim().is_empty() {
        let windows = load(&text.replace('\n', "\r\n"));
        assert_eq!(
            windows.map(|e| e.to_string()),
            error.as_ref().map(ToString::to_string)
        );
    }
    error
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A model of another kind than OBJ, as it is.
fn of_file(name: &str, text: &str) -> Option<Error> {
    let (host, limits) = (MemoryHost::new().with(name, text), Limits::default());
    let mut cache = AssetCache::default();
    let mut assets = Assets::new(&host, &limits, &mut cache);
    let loaded = load_mesh(name, &mut assets, &mut Builder::new());
    loaded.err().map(Error::from)
}

/// `ply:` and `stl:` stand before whole files; `obj:` stands before lines of a model after three vertices and before a face; `mtl:` before those of its material
/// library after `newmtl a`; `file:` before a whole model; `library:` before a whole library.
fn of_model(text: &str) -> Option<Error> {
    let (kind, text) = text.split_once('\n').unwrap_or((text, ""));
    let user = format!("mtllib a.mtl\n{CORNERS}usemtl a\nf 1 2 3\n");
    let host = MemoryHost::new().with("text.png", "hello").with("empty.png", "");
    let host = host.with("cut.png", picture::made("png, cut 20"));
    let host = match kind {
        "obj:" => host.with("a.obj", format!("{CORNERS}{text}\nf 1 2 3\n")),
        "mtl:" => host
            .with("a.obj", user)
            .with("a.mtl", format!("newmtl a\n{text}\n")),
        "ply:" => return of_file("a.ply", text),
        "stl:" => return of_file("a.stl", text),
        "file:" => host.with("a.obj", text),
        "library:" => host.with("a.obj", user).with("a.mtl", text),
        _ => panic!("what is {kind:?}?"),
    };
    let mut cache = AssetCache::default();
    let limits = Limits::untrusted();
    let mut assets = Assets::new(&host, &limits, &mut cache);
    load_obj("a.obj", &mut assets, &mut Builder::new())
        .err()
        .map(Error::from)
}

/// What is put in place of what, in `base.gltf`. Its buffer has three corners, as many texture coordinates, and their numbers.
fn of_gltf(text: &str) -> Option<Error> {
    const BASE: &str = include_str!("base.gltf");
    let (old, new) = text.split_once("=>").unwrap();
    assert!(BASE.contains(old.trim()), "{old} is not there");
    let changed = BASE.replacen(old.trim(), new.trim(), 1);
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    let uvs = [[0.0f32, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let numbers = corners.iter().flatten().chain(uvs.iter().flatten());
    let mut bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 3]);
    let host = MemoryHost::new()
        .with("a.gltf", changed.as_bytes())
        .with("a.bin", bytes)
        .with("white.png", picture::made("png"));
    let (limits, mut cache) = (Limits::untrusted(), AssetCache::default());
    let mut assets = Assets::new(&host, &limits, &mut cache);
    let loaded = load_mesh("a.gltf", &mut assets, &mut Builder::new());
    loaded.err().map(Error::from)
}

fn of_picture(text: &str) -> Option<Error> {
    let bytes = picture::made(text);
    let (limits, host) = (Limits::untrusted(), MemoryHost::new().with("a.png", bytes));
    let mut cache = AssetCache::default();
    let texture = Assets::new(&host, &limits, &mut cache).texture("a.png");
    texture.err().map(Error::from)
}

#[test]
fn scripts() {
    check_file("script.txt", 200, of_script);
}

#[test]
fn course_scenes() {
    check_file("course.txt", 80, of_course);
}

#[test]
fn models_and_materials() {
    check_file("model.txt", 120, of_model);
}

#[test]
fn gltf_files() {
    assert!(of_gltf("2.0 => 2.0").is_none());
    check_file("gltf.txt", 80, of_gltf);
}

#[test]
fn pictures() {
    check_file("picture.txt", 80, of_picture);
}
