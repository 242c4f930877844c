//! What changed in a scene and its scripts since a snapshot was taken.

use std::collections::BTreeMap;

use super::outcome::SourceChange;
use crate::scene::Scene;

/// Lines of a difference that are kept, of either scene.
const LINES: usize = 100;

/// Lines of the scenes' dumps that the other has not: `- ` or `+ ` before those of the first or the second. Neither
/// the place in the script nor the number in a list counts: what moved did not change.
pub(super) fn scene_changes(before: &Scene, now: &Scene) -> Vec<String> {
    let (before, now) = (before.dump(), now.dump());
    let gone = without(&before, &now).map(|line| format!("- {line}"));
    let come = without(&now, &before).map(|line| format!("+ {line}"));
    gone.take(LINES).chain(come.take(LINES)).collect()
}

/// The lines of `a` that `b` has not, or not as often.
fn without<'a>(a: &'a str, b: &'a str) -> impl Iterator<Item = &'a str> {
    let mut counts: BTreeMap<_, usize> = BTreeMap::new();
    for line in b.lines() {
        *counts.entry(meaning(line)).or_default() += 1;
    }
    a.lines()
        .filter_map(move |line| match counts.get_mut(&meaning(line)) {
            Some(count) if *count > 0 => {
                *count -= 1;
                None
            }
            _ => Some(line.trim_start()),
        })
}

/// A line of a dump without ` at 3:1` at its end, and for objects and lights without their number: kind, rest.
fn meaning(line: &str) -> (&str, &str) {
    let line = line.trim_start();
    let entity = match line.rsplit_once(" at ") {
        Some((entity, place)) if place.split(':').all(|n| n.parse::<u32>().is_ok()) => entity,
        _ => line,
    };
    for kind in ["object ", "light "] {
        if let Some((_, rest)) = entity.strip_prefix(kind).and_then(|rest| rest.split_once(' ')) {
            return (kind, rest);
        }
    }
    ("", entity)
}

/// Scripts whose text differs.
pub(super) fn source_changes(before: &[(String, String)], now: &[(String, String)]) -> Vec<SourceChange> {
    let text_in = |files: &[(String, String)], name: &str| {
        let found = files.iter().find(|(known, _)| known == name);
        found.map(|(_, text)| text.clone()).unwrap_or_default()
    };
    let mut names: Vec<&String> = Vec::new();
    for (name, _) in now.iter().chain(before) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let changes = names.into_iter().map(|name| SourceChange {
        name: name.clone(),
        before: text_in(before, name),
        after: text_in(now, name),
    });
    changes.filter(|change| change.before != change.after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, NoHost, RunOptions, testing::render_text};

    fn scene(text: &str) -> Scene {
        let text = format!("size(4, 4); {text}");
        render_text(
            "a.rhai",
            &text,
            &NoHost,
            &Limits::default(),
            &RunOptions::default(),
        )
        .unwrap()
        .scene
    }

    #[test]
    fn what_moved_in_the_script_alone_did_not_change() {
        let before = scene("light([1, 2, 3], [1, 1, 1]);\nsphere(0, 0, 0, 1);\nsphere(1, 0, 0, 1);");
        let moved =
            scene("light([1, 2, 3], [1, 1, 1]);\n\n // here\nsphere(0, 0, 0, 1);\nsphere(1, 0, 0, 1);");
        assert!(scene_changes(&before, &moved).is_empty());
        let changed = scene("sphere(1, 0, 0, 2);\nlight([1, 2, 4], [1, 1, 1]);\n\nsphere(0, 0, 0, 1);");
        assert_eq!(
            scene_changes(&before, &changed),
            [
                "- object 1 sphere { center: (1, 0, 0), radius: 1 } material 0 at 3:1",
                "- light 0 point 1 2 3 color 1 1 1 at 1:13",
                "+ object 0 sphere { center: (1, 0, 0), radius: 2 } material 0 at 1:13",
                "+ light 0 point 1 2 4 color 1 1 1 at 2:1",
            ]
        );
    }

    #[test]
    fn scripts_that_differ_are_listed_once() {
        let files = |list: &[(&str, &str)]| -> Vec<(String, String)> {
            list.iter()
                .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
                .collect()
        };
        let before = files(&[("a", "1"), ("b", "2"), ("gone", "3")]);
        let now = files(&[("a", "1"), ("b", "4"), ("b", "4"), ("new", "5")]);
        let changes = source_changes(&before, &now);
        let short: Vec<_> = changes
            .iter()
            .map(|c| (&*c.name, &*c.before, &*c.after))
            .collect();
        assert_eq!(short, [("b", "2", "4"), ("new", "", "5"), ("gone", "3", "")]);
    }
}
