//! Which module may name which. `ARCHITECTURE.md` draws the picture; this test keeps it true.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// For each module the modules of this crate that it may name, itself aside.
const MAY_NAME: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("color", &["math"]),
    ("noise", &["math"]),
    ("custom", &[]),
    ("diag", &[]),
    ("limits", &[]),
    ("meter", &[]),
    ("spline", &[]),
    // A shape refuses bad parameters with the scene's error.
    (
        "shape",
        &["math", "noise", "custom", "spline", "scene::SceneError"],
    ),
    (
        "scene",
        &[
            "math", "color", "noise", "spline", "custom", "diag", "limits", "shape",
        ],
    ),
    ("accel", &["math"]),
    ("host", &["diag", "render"]),
    // What becomes triangles is a mesh of the scene.
    (
        "tessellate",
        &["math", "color", "diag", "limits", "scene", "shape"],
    ),
    (
        "render",
        &[
            "math", "color", "diag", "host", "limits", "scene", "shape", "accel",
        ],
    ),
    (
        "import",
        &[
            "math",
            "color",
            "diag",
            "host",
            "limits",
            "scene",
            "shape",
            "tessellate",
        ],
    ),
    ("parameters", &["diag"]),
    ("recipe", &["parameters"]),
    ("output", &["diag", "host", "render", "recipe"]),
    (
        "script",
        &[
            "math",
            "color",
            "noise",
            "spline",
            "diag",
            "host",
            "limits",
            "meter",
            "scene",
            "shape",
            "render",
            "import",
            "parameters",
            "tessellate",
        ],
    ),
    ("source", &["diag", "host", "limits", "scene", "import", "script"]),
    (
        "testing",
        &[
            "math",
            "color",
            "diag",
            "host",
            "limits",
            "scene",
            "render",
            "script",
            "source",
            "output",
            "parameters",
            "recipe",
        ],
    ),
    (
        "cli",
        &[
            "math",
            "color",
            "diag",
            "host",
            "limits",
            "scene",
            "render",
            "import",
            "output",
            "script",
            "source",
            "testing",
            "parameters",
            "recipe",
        ],
    ),
    ("main", &[]),
    ("lib", &[]),
];

/// Modules that know neither the language nor the command nor the system.
const PURE: &[&str] = &[
    "scene",
    "shape",
    "accel",
    "render",
    "math",
    "color",
    "noise",
    "spline",
    "tessellate",
];

/// What they must not name.
const IMPURE: [&str; 10] = [
    "rhai",
    "clap",
    "std::fs",
    "std::env",
    "std::io",
    "std::net",
    "std::process",
    "crate::cli",
    "crate::script",
    "crate::import",
];

/// Modules that may touch the file system.
const MAY_OPEN_FILES: [&str; 4] = ["host", "output", "testing", "cli"];

/// The places that ask the environment: which instructions to use, and where an assertion of a test may write. No pixel
/// depends on either.
const MAY_ASK: [&str; 2] = ["accel/lanes/mod.rs", "testing/assert/surroundings.rs"];

/// A source file: the module it belongs to and the words of its code, comments and texts left out.
struct Source {
    path: PathBuf,
    module: String,
    code: String,
    /// Every path that it names, such as `crate::scene::Scene`, with `use` lists spelled out.
    names: BTreeSet<String>,
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    collect(&root, &root, &mut sources);
    assert!(sources.len() > 20, "found only {} files", sources.len());
    sources
}

/// Reads the files of a folder and of those below, modules that exist for tests only left out.
fn collect(root: &Path, folder: &Path, sources: &mut Vec<Source>) {
    let entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    let files = entries
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "rs"));
    let texts: Vec<(&PathBuf, String)> = files
        .map(|path| (path, fs::read_to_string(path).unwrap()))
        .collect();
    let is_for_tests = |path: &PathBuf| {
        let declaration = format!(
            "#[cfg(test)]\nmod {};",
            path.file_stem().unwrap().to_string_lossy()
        );
        texts.iter().any(|(_, text)| text.contains(&declaration))
    };
    for (path, text) in texts.iter().filter(|(path, _)| !is_for_tests(path)) {
        let relative = path.strip_prefix(root).unwrap().with_extension("");
        let code = without_tests(&without_comments_and_texts(text));
        let mut names = names(&code);
        if MAY_ASK.iter().any(|file| path.ends_with(file)) {
            names.retain(|name| !starts_with_path(name, "std::env"));
        }
        sources.push(Source {
            path: path.to_path_buf(),
            module: relative.iter().next().unwrap().to_string_lossy().into_owned(),
            code,
            names,
        });
    }
    for folder in entries.iter().filter(|path| path.is_dir() && !is_for_tests(path)) {
        collect(root, folder, sources);
    }
}

/// Unit tests stand at the end of a file and may name anything.
fn without_tests(code: &str) -> String {
    code.split("#[cfg(test)]\nmod tests")
        .next()
        .unwrap_or_default()
        .to_owned()
}

/// Blanks out comments, strings and characters, so that words in them do not count.
fn without_comments_and_texts(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut code = String::new();
    let mut i = 0;
    let starts = |i: usize, what: &str| {
        what.chars()
            .enumerate()
            .all(|(k, c)| chars.get(i + k) == Some(&c))
    };
    while i < chars.len() {
        let end = if starts(i, "//") {
            end_of(&chars, i, "\n").map(|end| end - 1)
        } else if starts(i, "/*") {
            end_of(&chars, i + 2, "*/")
        } else if chars[i] == 'r' && (starts(i, "r\"") || starts(i, "r#")) && !follows_word(&chars, i) {
            let hashes = chars[i + 1..].iter().take_while(|c| **c == '#').count();
            let close = format!("\"{}", "#".repeat(hashes));
            let is_text = chars.get(i + 1 + hashes) == Some(&'"');
            if is_text {
                end_of(&chars, i + 2 + hashes, &close)
            } else {
                Some(i + 1)
            }
        } else if chars[i] == '"' {
            end_of_string(&chars, i)
        } else if chars[i] == '\'' {
            end_of_char(&chars, i)
        } else {
            code.push(chars[i]);
            i += 1;
            continue;
        };
        code.push(' ');
        i = end.unwrap_or(chars.len()).max(i + 1);
    }
    code
}

fn follows_word(chars: &[char], i: usize) -> bool {
    i > 0 && (chars[i - 1].is_alphanumeric() || chars[i - 1] == '_')
}

fn end_of(chars: &[char], from: usize, what: &str) -> Option<usize> {
    let what: Vec<char> = what.chars().collect();
    (from..chars.len())
        .find(|&i| chars[i..].starts_with(&what))
        .map(|i| i + what.len())
}

fn end_of_string(chars: &[char], start: usize) -> Option<usize> {
    let mut i = start + 1;
    while *chars.get(i)? != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    Some(i + 1)
}

/// A character ends at its second quote; a lifetime is one quote and no text.
fn end_of_char(chars: &[char], start: usize) -> Option<usize> {
    match (chars.get(start + 1)?, chars.get(start + 2)) {
        ('\\', _) => end_of(chars, start + 3, "'"),
        (_, Some('\'')) => Some(start + 3),
        _ => Some(start + 1),
    }
}

/// Every `a::b::c` of the code; in `a::{b, c::{d}}` each branch.
fn names(code: &str) -> BTreeSet<String> {
    let compact: String = code.split_whitespace().collect::<Vec<_>>().join(" ");
    let compact = compact.replace(" ::", "::").replace(":: ", "::");
    let mut names = BTreeSet::new();
    // Prefixes of the braces that are open: Some for `path::{`, None for any other brace.
    let mut open: Vec<Option<String>> = Vec::new();
    let mut word = String::new();
    for c in compact.chars() {
        if c.is_alphanumeric() || c == '_' || c == ':' {
            word.push(c);
            continue;
        }
        let prefix = open.last().cloned().flatten().unwrap_or_default();
        if c == '{' && word.ends_with("::") {
            open.push(Some(prefix + &word));
        } else {
            if !word.is_empty() {
                names.insert(prefix + &word);
            }
            match c {
                '{' => open.push(None),
                '}' => drop(open.pop()),
                _ => {}
            }
        }
        word.clear();
    }
    names
}

fn starts_with_path(name: &str, path: &str) -> bool {
    name.strip_prefix(path)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
}

/// What the crate's root shows again, and where it comes from: `Scene` to `scene::Scene`. An exported macro stands in
/// the root, whatever module makes it.
fn shown_again(sources: &[Source]) -> BTreeMap<String, String> {
    let root = sources.iter().find(|source| source.module == "lib").unwrap();
    let paths = root.names.iter().filter(|name| name.contains("::"));
    let mut shown: BTreeMap<String, String> = paths
        .filter_map(|path| Some((path.rsplit_once("::")?.1.to_owned(), path.clone())))
        .collect();
    for source in sources {
        for macro_rules in source.code.split("#[macro_export]\nmacro_rules!").skip(1) {
            let name = macro_rules.split_whitespace().next().unwrap_or_default();
            shown.insert(name.to_owned(), format!("{}::{name}", source.module));
        }
    }
    shown
}

#[test]
fn names_are_found_through_lists_and_not_in_texts() {
    let code = r##"
        use crate::{diag::{Error, Report}, math};
        // crate::cli
        fn f<'a>(x: &'a str) -> char { let s = "crate::script \" x"; let r = r#"rhai"#; std::fs::read(x); '"' }
    "##;
    let found = names(&without_comments_and_texts(code));
    for wanted in [
        "crate::diag::Error",
        "crate::diag::Report",
        "crate::math",
        "std::fs::read",
    ] {
        assert!(found.contains(wanted), "{wanted} in {found:?}");
    }
    assert!(
        !found
            .iter()
            .any(|n| n.contains("cli") || n.contains("script") || n.contains("rhai")),
        "{found:?}"
    );
}

#[test]
fn edges_point_down_only() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_NAME.iter().copied().collect();
    let mut wrong = Vec::new();
    let sources = sources();
    let shown_again = shown_again(&sources);
    for source in sources.iter().filter(|s| s.module != "lib") {
        let Some(may) = allowed.get(source.module.as_str()) else {
            wrong.push(format!(
                "{}: a module this test does not know",
                source.path.display()
            ));
            continue;
        };
        for name in &source.names {
            let Some(target) = name.strip_prefix("crate::") else {
                continue;
            };
            let first = target.split("::").next().unwrap_or_default();
            let target = shown_again.get(first).map_or(target, String::as_str);
            let own = starts_with_path(target, &source.module);
            if !own && !may.iter().any(|path| starts_with_path(target, path)) {
                wrong.push(format!("{} names {name}", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What a first program names, and nothing else: the rest is found in its module.
const AT_THE_ROOT: [&str; 16] = [
    "Builder",
    "DVec3",
    "DirHost",
    "Error",
    "Host",
    "Image",
    "Limits",
    "MemoryHost",
    "NoHost",
    "RenderOptions",
    "Report",
    "RunOptions",
    "Scene",
    "Script",
    "Term",
    "render",
];

#[test]
fn the_root_shows_what_a_first_program_names() {
    let root = sources()
        .into_iter()
        .find(|source| source.module == "lib")
        .unwrap();
    let shown: Vec<&str> = root
        .code
        .split("pub use ")
        .skip(1)
        .filter_map(|rest| rest.split_once(';'))
        .flat_map(|(list, _)| list.rsplit_once("::").map_or(list, |(_, last)| last).split(','))
        .map(|name| name.trim().trim_start_matches('{').trim_end_matches('}'))
        .filter(|name| !name.is_empty())
        .collect();
    let shown: BTreeSet<&str> = shown.into_iter().collect();
    assert_eq!(shown, AT_THE_ROOT.into_iter().collect());
}

#[test]
fn the_core_knows_neither_language_nor_command_nor_system() {
    let mut wrong = Vec::new();
    for source in sources().iter().filter(|s| PURE.contains(&s.module.as_str())) {
        for name in &source.names {
            if IMPURE.iter().any(|path| starts_with_path(name, path)) {
                wrong.push(format!("{} names {name}", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_are_opened_by_hosts_and_writers_only() {
    for source in sources()
        .iter()
        .filter(|s| !MAY_OPEN_FILES.contains(&s.module.as_str()))
    {
        for name in &source.names {
            assert!(
                !starts_with_path(name, "std::fs"),
                "{} names {name}",
                source.path.display()
            );
        }
    }
}

#[test]
fn the_picture_asks_neither_clock_nor_environment() {
    for source in sources()
        .iter()
        .filter(|s| !["cli", "main"].contains(&s.module.as_str()))
    {
        for name in &source.names {
            let asks = ["std::env", "SystemTime", "std::time::SystemTime"];
            assert!(
                !asks.iter().any(|path| starts_with_path(name, path)),
                "{} names {name}",
                source.path.display()
            );
        }
    }
}

#[test]
fn unsafe_code_stands_in_accel_and_the_meter_only() {
    for source in sources()
        .iter()
        .filter(|s| !["accel", "meter"].contains(&s.module.as_str()))
    {
        let words = source.code.split(|c: char| !c.is_alphanumeric() && c != '_');
        assert_eq!(
            words.filter(|word| *word == "unsafe").count(),
            0,
            "{}",
            source.path.display()
        );
    }
}

/// Name and version of every package of a lock file.
fn packages(lock: &str) -> BTreeSet<(String, String)> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(lock)).unwrap();
    let of = |package: &str, key: &str| {
        let value = package.lines().find_map(|line| line.strip_prefix(key));
        value.unwrap().trim_matches('"').to_owned()
    };
    let packages = text.split("[[package]]\n").skip(1);
    packages
        .map(|p| (of(p, "name = "), of(p, "version = ")))
        .collect()
}

/// An example that is a crate of its own must not be tested with other versions of what this crate uses, nor one without
/// dependencies of its own need a download.
#[test]
fn examples_have_the_versions_of_this_crate() {
    let own = packages("Cargo.lock");
    let others = |example: &str| -> Vec<(String, String)> {
        let theirs = packages(&format!("examples/{example}/Cargo.lock"));
        theirs.difference(&own).cloned().collect()
    };
    let names: Vec<_> = others("snapshot-tests")
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert_eq!(
        names,
        ["snapshot-tests"],
        "copy Cargo.lock over the example's and run cargo metadata there"
    );
    // What the command or a test needs besides may differ: the web server and the window have dependencies of their own.
    let library = ["rhai", "glam", "libm", "rayon", "image", "png", "blake3"];
    for example in ["thumbnails", "viewer"] {
        for (name, version) in others(example) {
            assert!(
                !library.contains(&&*name),
                "{example} is locked to {name} {version}, which rtscript is not"
            );
        }
    }
}
