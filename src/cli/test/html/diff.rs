//! Two texts line by line.

use similar::{ChangeTag, TextDiff};

use super::escape::escape;
use crate::cli::measures::count;

/// Lines around a change that are shown with it.
const CONTEXT: usize = 3;
/// Lines of both texts together up to which they are compared: the time may grow with the square.
const COMPARED: usize = 20_000;
/// Lines shown at most.
const SHOWN: usize = 2_000;
/// Characters of a line shown at most.
const WIDTH: usize = 400;

/// What changed, as a table with the line numbers of both texts; a sentence where that would be too long.
pub(super) fn table(before: &str, after: &str) -> String {
    let (old, new) = (before.lines().count(), after.lines().count());
    if old + new > COMPARED {
        return format!(
            "<p>Too long to be compared here: {} lines, now {}.</p>\n",
            count(old as u64),
            count(new as u64)
        );
    }
    let diff = TextDiff::from_lines(before, after);
    let mut rows: Vec<String> = Vec::new();
    for (i, group) in diff.grouped_ops(CONTEXT).iter().enumerate() {
        if i > 0 {
            rows.push("<tr class=\"gap\"><td></td><td></td><td></td><td>⋯</td></tr>\n".to_owned());
        }
        for change in group.iter().flat_map(|op| diff.iter_changes(op)) {
            let (class, sign) = match change.tag() {
                ChangeTag::Equal => ("", " "),
                ChangeTag::Delete => (" class=\"del\"", "−"),
                ChangeTag::Insert => (" class=\"ins\"", "+"),
            };
            let number = |index: Option<usize>| index.map(|i| (i + 1).to_string()).unwrap_or_default();
            rows.push(format!(
                "<tr{class}><td>{}</td><td>{}</td><td>{sign}</td><td>{}</td></tr>\n",
                number(change.old_index()),
                number(change.new_index()),
                escape(&shortened(change.value()))
            ));
        }
    }
    if rows.is_empty() {
        // `lines` and the comparison differ in what they say of a line end at the end of a text.
        return "<p>The lines are the same.</p>\n".to_owned();
    }
    let left = rows.len().saturating_sub(SHOWN);
    rows.truncate(SHOWN);
    let more = match left {
        0 => String::new(),
        left => format!("<p>{} more lines are not shown.</p>\n", count(left as u64)),
    };
    format!(
        "<div class=\"scroll\"><table class=\"diff\"><tbody>\n{}</tbody></table></div>\n{more}",
        rows.concat()
    )
}

/// Lines added and lines removed, where the texts are compared at all.
pub(super) fn sizes(before: &str, after: &str) -> Option<(usize, usize)> {
    if before.lines().count() + after.lines().count() > COMPARED {
        return None;
    }
    let diff = TextDiff::from_lines(before, after);
    let number = |tag| {
        diff.iter_all_changes()
            .filter(|change| change.tag() == tag)
            .count()
    };
    Some((number(ChangeTag::Insert), number(ChangeTag::Delete)))
}

/// One line without its end, cut to length.
pub(super) fn shortened(line: &str) -> String {
    let line = line.trim_end_matches(['\n', '\r']);
    let mut chars = line.chars();
    let mut short: String = chars.by_ref().take(WIDTH).collect();
    if chars.next().is_some() {
        short.push_str(" …");
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_carry_the_numbers_of_both_texts() {
        let before: String = (1..=20).map(|i| format!("line {i}\n")).collect();
        let after = before.replace("line 2\n", "").replace("line 19\n", "line <19>\n");
        let shown = table(&before, &after);
        for row in [
            "<tr><td>1</td><td>1</td><td> </td><td>line 1</td></tr>",
            "<tr class=\"del\"><td>2</td><td></td><td>−</td><td>line 2</td></tr>",
            "<tr><td>3</td><td>2</td><td> </td><td>line 3</td></tr>",
            "<tr class=\"del\"><td>19</td><td></td><td>−</td><td>line 19</td></tr>",
            "<tr class=\"ins\"><td></td><td>18</td><td>+</td><td>line &lt;19&gt;</td></tr>",
        ] {
            assert!(shown.contains(row), "{row} is not in {shown}");
        }
        assert_eq!(shown.matches("class=\"gap\"").count(), 1);
        assert!(!shown.contains("line 10"), "{shown}");
        assert_eq!(sizes(&before, &after), Some((1, 2)));
    }

    #[test]
    fn long_texts_are_cut() {
        let wide = "x".repeat(10_000);
        let shown = table("", &wide);
        assert!(shown.len() < 1000 && shown.contains("x …"), "{shown}");
        let long: String = (0..9_000).map(|i| format!("{i}\n")).collect();
        let shown = table("", &long);
        assert!(shown.contains("<p>7,000 more lines are not shown.</p>"));
        let longer = "x\n".repeat(COMPARED + 1);
        assert!(table("", &longer).contains("0 lines, now 20,001"));
        assert_eq!(sizes("", &longer), None);
    }

    #[test]
    fn equal_lines_make_a_sentence() {
        assert!(table("a\n", "a\n").contains("the same"));
    }
}
