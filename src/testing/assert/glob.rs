//! Files by a pattern.

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

/// Files below `folder` whose path from there `pattern` describes, sorted. Names that begin with a dot are found only
/// where the pattern says the dot.
pub(super) fn find(folder: &Path, pattern: &str) -> io::Result<Vec<PathBuf>> {
    let parts: Vec<&str> = pattern
        .split('/')
        .filter(|part| !part.is_empty() && *part != ".")
        .collect();
    let mut found = Vec::new();
    walk(folder, &parts, &mut found)?;
    found.sort();
    // Two ways through `**` may lead to one file.
    found.dedup();
    Ok(found)
}

fn walk(folder: &Path, pattern: &[&str], found: &mut Vec<PathBuf>) -> io::Result<()> {
    let Some((first, rest)) = pattern.split_first() else {
        return Ok(());
    };
    if *first == ".." {
        return walk(&folder.join(first), rest, found);
    }
    if *first == "**" {
        walk(folder, rest, found)?;
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let hidden = name.starts_with('.') && !first.starts_with('.');
        if hidden {
            continue;
        }
        if path.is_dir() {
            if *first == "**" {
                walk(&path, pattern, found)?;
            } else if matches(first, &name) {
                walk(&path, rest, found)?;
            }
        } else if (rest.is_empty() && matches(first, &name)) || *first == "**" && rest.is_empty() {
            found.push(path);
        }
    }
    Ok(())
}

/// Whether `name` is what `pattern` describes: `*` stands for any letters, `?` for one.
fn matches(pattern: &str, name: &str) -> bool {
    let pattern: Vec<char> = pattern.chars().collect();
    // How many letters of the pattern may have been used up after each letter of the name.
    let mut reached = BTreeSet::from([0]);
    let skip_stars = |reached: &mut BTreeSet<usize>| {
        for (i, _) in pattern.iter().enumerate().filter(|(_, c)| **c == '*') {
            if reached.contains(&i) {
                reached.insert(i + 1);
            }
        }
    };
    skip_stars(&mut reached);
    for letter in name.chars() {
        let mut next = BTreeSet::new();
        for i in reached {
            match pattern.get(i) {
                Some('*') => _ = next.insert(i),
                Some(c) if *c == '?' || *c == letter => _ = next.insert(i + 1),
                _ => {}
            }
        }
        skip_stars(&mut next);
        reached = next;
    }
    reached.contains(&pattern.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks_stand_for_letters() {
        for (pattern, name) in [
            ("*.rhai", "ball.rhai"),
            ("*.rhai", ".rhai"),
            ("b?ll.*", "bell.test"),
            ("*a*b*", "xaybz"),
            ("**", "anything"),
            ("", ""),
        ] {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [
            ("*.rhai", "ball.rhai.bak"),
            ("b?ll", "bll"),
            ("ball", "balls"),
            ("ball*x", "ball"),
            ("", "a"),
        ] {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }

    #[test]
    fn folders_are_walked_as_the_pattern_says() {
        let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let found = |pattern: &str| -> Vec<String> {
            let found = find(&src, pattern).unwrap();
            let names = found.iter().map(|path| {
                path.strip_prefix(&src)
                    .unwrap()
                    .to_string_lossy()
                    .replace('\\', "/")
            });
            names.collect()
        };
        assert_eq!(found("testing/assert/gl?b.rs"), ["testing/assert/glob.rs"]);
        assert_eq!(found("**/glob.rs"), ["testing/assert/glob.rs"]);
        assert_eq!(found("./lib.rs"), ["lib.rs"]);
        assert_eq!(found("**/lib.rs"), ["lib.rs"]);
        assert_eq!(found("*/glob.rs"), [""; 0]);
        assert_eq!(found("testing/../lib.rs").len(), 1);
        assert_eq!(found("testing/**"), found("testing/**/*"));
        assert!(found("**/*.rs").len() > found("*/*.rs").len());
        assert!(find(&src.join("none"), "*.rs").is_err());
    }
}
