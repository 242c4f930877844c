//! Which line of one script is which of the other.

use similar::{DiffOp, TextDiff};

use crate::{
    cli::subject::Subject,
    diag::SourceLoc,
    scene::{Scene, compare::Place},
};

/// Lines of both texts together up to which they are compared: the time may grow with the square.
const COMPARED: usize = 20_000;

/// Added to the number of a line, or of a file, that the other scene has not.
const ALONE: u32 = 1 << 31;

/// The files of the first scene as the second has them.
pub(super) struct Lines {
    files: Vec<File>,
}

/// A file of the first scene.
struct File {
    /// Its number in the second scene.
    number: u32,
    /// For each line, from 0, its number in the second scene; a file that is not listed has the same lines there.
    lines: Vec<u32>,
}

impl Lines {
    pub(super) fn of((old, before): (&Subject, &Scene), (new, after): (&Subject, &Scene)) -> Self {
        let files = before.files.iter().enumerate().map(|(i, name)| {
            // The first is the scene itself, whatever it is called; modules are beside it.
            let beside = |name: &str, scene: &Scene| {
                let main = scene.files.first().map_or("", String::as_str);
                let folder = main.rfind('/').map_or("", |i| main.get(..=i).unwrap_or(""));
                name.strip_prefix(folder).unwrap_or(name).to_owned()
            };
            let found = match i {
                0 => (!after.files.is_empty()).then_some(0),
                _ => after
                    .files
                    .iter()
                    .position(|other| beside(other, after) == beside(name, before)),
            };
            let Some(found) = found else {
                return File {
                    number: ALONE + i as u32,
                    lines: Vec::new(),
                };
            };
            let other = after.files.get(found).map_or("", String::as_str);
            let texts = old.text_of(name).zip(new.text_of(other));
            File {
                number: found as u32,
                lines: texts.map_or_else(Vec::new, |(a, b)| lines(&a, &b)),
            }
        });
        Self {
            files: files.collect(),
        }
    }

    /// A place in the first or in the second scene, as one of the second.
    pub(super) fn place(&self, is_new: bool, loc: SourceLoc) -> Place {
        let file = u32::from(loc.file);
        if is_new {
            return (file, loc.line);
        }
        let Some(file) = self.files.get(usize::from(loc.file)) else {
            return (ALONE + file, loc.line);
        };
        let index = (loc.line as usize).checked_sub(1);
        let line = index.and_then(|i| file.lines.get(i).copied());
        (file.number, line.unwrap_or(loc.line))
    }
}

/// The numbers of the lines of `a` in `b`.
fn lines(a: &str, b: &str) -> Vec<u32> {
    let count = a.lines().count();
    if a == b || count + b.lines().count() > COMPARED {
        return Vec::new();
    }
    let mut numbers: Vec<u32> = (0..count as u32).map(|i| ALONE + i + 1).collect();
    for op in TextDiff::from_lines(a, b).ops() {
        // Lines that were changed stand for one another in their order.
        let (old, new, len) = match *op {
            DiffOp::Equal {
                old_index,
                new_index,
                len,
            } => (old_index, new_index, len),
            DiffOp::Replace {
                old_index,
                old_len,
                new_index,
                new_len,
            } => (old_index, new_index, old_len.min(new_len)),
            DiffOp::Delete { .. } | DiffOp::Insert { .. } => continue,
        };
        for (number, i) in numbers.iter_mut().skip(old).zip(new..new + len) {
            *number = i as u32 + 1;
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_follow_what_was_put_before_them() {
        assert_eq!(lines("a\nb\nc\n", "x\na\nB\nc\n"), [2, 3, 4]);
        assert_eq!(lines("a\nb\nc\n", "a\nc\n"), [1, ALONE + 2, 2]);
        assert_eq!(lines("a\n", "a\n"), Vec::<u32>::new());
    }
}
