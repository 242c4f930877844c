//! Scenes that are written differently and must give the same picture, and scenes that must not.
//!
//! A scene says so in a comment of its own: `// same as: <path>` or `// unlike: <path>`, the path counted from
//! `tests/scenes`. In a course scene the comment begins with `#`.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    fs,
    path::{Path, PathBuf},
};

use rtscript::{
    Image,
    script::RunOptions,
    testing::{compare, find_scenes, render_file},
};

/// What a scene says about another.
struct Claim {
    scene: PathBuf,
    other: PathBuf,
    equal: bool,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes")
}

/// The other scene's path and whether it must be equal, where `line` claims something.
fn claim(line: &str) -> Option<(&str, bool)> {
    let line = line.trim();
    let comment = line.strip_prefix("//").or_else(|| line.strip_prefix('#'))?;
    let comment = comment.trim();
    let same = comment.strip_prefix("same as:").map(|path| (path, true));
    let claim = same.or_else(|| comment.strip_prefix("unlike:").map(|path| (path, false)));
    claim.map(|(path, equal)| (path.trim(), equal))
}

fn claims() -> Vec<Claim> {
    let root = root();
    let mut claims = Vec::new();
    for scene in find_scenes(&root).unwrap() {
        // Scenes that must fail may be no text at all.
        let text = String::from_utf8_lossy(&fs::read(&scene).unwrap()).into_owned();
        for (other, equal) in text.lines().filter_map(claim) {
            claims.push(Claim {
                scene: scene.clone(),
                other: root.join(other),
                equal,
            });
        }
    }
    claims
}

fn picture(scene: &Path) -> Result<Image, String> {
    let rendered = render_file(scene, &RunOptions::default());
    rendered
        .map(|r| r.image)
        .map_err(|e| format!("{}: {e}", scene.display()))
}

/// What is wrong with a claim.
fn fault(claim: &Claim) -> Option<String> {
    let (a, b) = match (picture(&claim.scene), picture(&claim.other)) {
        (Ok(a), Ok(b)) => (a, b),
        (Err(message), _) | (_, Err(message)) => return Some(message),
    };
    if (a.hash() == b.hash()) == claim.equal {
        return None;
    }
    let (scene, other) = (claim.scene.display(), claim.other.display());
    let c = compare(&a, &b);
    Some(if claim.equal {
        format!(
            "{} of {} pixels differ, by {} at most:\n  {scene}\n  {other}",
            c.differing, c.pixels, c.max
        )
    } else {
        format!("both are the same picture:\n  {scene}\n  {other}")
    })
}

#[test]
fn scenes_are_the_same_as_they_say_and_unlike_where_they_say() {
    let claims = claims();
    for equal in [true, false] {
        assert!(claims.iter().any(|c| c.equal == equal), "no scene is compared");
    }
    let faults: Vec<String> = claims.iter().filter_map(fault).collect();
    assert!(
        faults.is_empty(),
        "{} of {} pairs:\n{}",
        faults.len(),
        claims.len(),
        faults.join("\n")
    );
}

#[test]
fn a_false_claim_is_a_fault() {
    let scene = |name: &str| root().join(name);
    let claim = |scene, other, equal| Claim { scene, other, equal };
    let (raw, srgb) = ("image/encoding/raw.rhai", "image/encoding/srgb.rhai");
    assert!(fault(&claim(scene(raw), scene(srgb), true)).is_some_and(|f| f.contains("pixels differ")));
    assert!(fault(&claim(scene(raw), scene(raw), false)).is_some_and(|f| f.contains("the same picture")));
    assert!(fault(&claim(scene(raw), scene("image/encoding/none.rhai"), true)).is_some());
}
