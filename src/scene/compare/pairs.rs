//! Which thing of one scene is which of the other.

use std::collections::BTreeMap;

use super::{Place, items::Item};
use crate::math::max_abs;

/// One of so many objects of a line must differ for it to be looked at as a whole.
const MATCHED_AT_MOST: usize = 4;

/// Products of counts up to which the nearest is looked for.
const NEAREST: usize = 250_000;

/// The numbers of what the other has not, or not as often; what both have is matched in its order.
pub(super) fn same_in_full(before: &[u128], after: &[u128]) -> (Vec<u32>, Vec<u32>) {
    let sorted = |digests: &[u128]| {
        let mut sorted: Vec<(u128, u32)> = digests.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        sorted
    };
    let (before, after) = (sorted(before), sorted(after));
    let (mut gone, mut come) = (Vec::new(), Vec::new());
    let (mut a, mut b) = (before.iter().peekable(), after.iter().peekable());
    while let (Some((x, i)), Some((y, j))) = (a.peek(), b.peek()) {
        if x <= y {
            if x < y {
                gone.push(*i);
            } else {
                b.next();
            }
            a.next();
        } else {
            come.push(*j);
            b.next();
        }
    }
    gone.extend(a.map(|(_, i)| *i));
    come.extend(b.map(|(_, j)| *j));
    gone.sort_unstable();
    come.sort_unstable();
    (gone, come)
}

/// Objects by their numbers, of both scenes.
type Both = (Vec<u32>, Vec<u32>);

/// Lines that make as many objects in both scenes, of which a good part differs: all objects of each such line. Where
/// balls stand in a lattice and all are moved by its spacing, most are where another one was.
pub(super) fn same_lines(
    digests: (&[u128], &[u128]),
    places: (&[Place], &[Place]),
    (gone, come): (&[u32], &[u32]),
) -> Vec<Both> {
    let mut lines: BTreeMap<Place, (Both, [usize; 2])> = BTreeMap::new();
    for (i, place) in (0..).zip(places.0) {
        lines.entry(*place).or_default().0.0.push(i);
    }
    for (j, place) in (0..).zip(places.1) {
        lines.entry(*place).or_default().0.1.push(j);
    }
    for (list, places, which) in [(gone, places.0, 0), (come, places.1, 1)] {
        for i in list {
            let line = places.get(*i as usize).and_then(|place| lines.get_mut(place));
            if let Some(count) = line.and_then(|(_, left)| left.get_mut(which)) {
                *count += 1;
            }
        }
    }
    // What was matched must have been matched within the line, or its match would be left alone.
    let matched = |all: &[u32], left: &[u32], digests: &[u128]| {
        let matched = all.iter().filter(|i| left.binary_search(i).is_err());
        let mut matched: Vec<u128> = matched
            .filter_map(|i| digests.get(*i as usize).copied())
            .collect();
        matched.sort_unstable();
        matched
    };
    let is_candidate = |((old, new), [gone_here, come_here]): &(Both, [usize; 2])| {
        old.len() == new.len()
            && gone_here == come_here
            && *gone_here < old.len()
            && gone_here * MATCHED_AT_MOST >= old.len()
            && matched(old, gone, digests.0) == matched(new, come, digests.1)
    };
    let candidates = lines
        .into_iter()
        .filter(|(place, line)| place.1 > 0 && is_candidate(line));
    candidates.map(|(_, (both, _))| both).collect()
}

/// Whether one move leads from each thing to the other in its place of the list.
pub(super) fn is_one_move(before: &[Item<'_>], after: &[Item<'_>]) -> bool {
    let Some((first, other)) = before.first().zip(after.first()) else {
        return false;
    };
    let by = other.at - first.at;
    before.iter().zip(after).all(|(a, b)| {
        let error = max_abs(b.at - a.at - by);
        (a.kind, a.form, a.looks) == (b.kind, b.form, b.looks)
            && a.turn == b.turn
            && error <= 1e-9 * max_abs(a.at).max(max_abs(b.at))
    })
}

/// What two lists of things have in common.
pub(super) struct Pairing {
    /// For each thing of the first list its match in the second.
    matches: Vec<Option<usize>>,
    is_taken: Vec<bool>,
}

/// What a thing is compared by; `None` where it takes no part.
type Key = Option<[u128; 3]>;

/// The stages of matching, the strictest first.
const STAGES: [fn(&Item<'_>) -> Key; 6] = [
    |item| Some([with_place(item)?, item.form, item.looks]),
    |item| Some([with_place(item)?, item.form, item.matrix]),
    |item| Some([with_place(item)?, item.matrix, item.looks]),
    |item| Some([with_place(item)?, 0, 0]),
    |item| Some([item.kind, item.form, item.looks]),
    |item| Some([item.kind, item.form, item.matrix]),
];

/// Kind and line; `None` where the line is unknown.
fn with_place(item: &Item<'_>) -> Option<u128> {
    let (file, line) = item.place;
    let place = u128::from(file) << 32 | u128::from(line);
    (line > 0).then_some(item.kind ^ place)
}

impl Pairing {
    pub(super) fn of(before: &[Item<'_>], after: &[Item<'_>]) -> Self {
        let mut pairing = Self {
            matches: vec![None; before.len()],
            is_taken: vec![false; after.len()],
        };
        for key in STAGES {
            pairing.stage(before, after, key);
        }
        pairing
    }

    fn stage(&mut self, before: &[Item<'_>], after: &[Item<'_>], key: fn(&Item<'_>) -> Key) {
        let sorted = |items: &[Item<'_>], is_left: &dyn Fn(usize) -> bool| {
            let left = items.iter().enumerate().filter(|(i, _)| is_left(*i));
            let mut keys: Vec<_> = left.filter_map(|(i, item)| Some((key(item)?, i))).collect();
            keys.sort_unstable();
            keys
        };
        let gone = sorted(before, &|i| self.matches.get(i).is_some_and(Option::is_none));
        let come = sorted(after, &|i| self.is_taken.get(i) == Some(&false));
        let mut others = come.chunk_by(|a, b| a.0 == b.0).peekable();
        for run in gone.chunk_by(|a, b| a.0 == b.0) {
            let Some((key, _)) = run.first() else { continue };
            while others
                .next_if(|other| other.first().is_some_and(|(k, _)| k < key))
                .is_some()
            {}
            let Some(other) = others.next_if(|other| other.first().is_some_and(|(k, _)| k == key)) else {
                continue;
            };
            self.pair(run, other, (before, after));
        }
    }

    /// Matches things of one key: in their order where there are as many, otherwise each with the nearest.
    fn pair(
        &mut self,
        gone: &[([u128; 3], usize)],
        come: &[([u128; 3], usize)],
        (before, after): (&[Item<'_>], &[Item<'_>]),
    ) {
        if gone.len() == come.len() || gone.len() * come.len() > NEAREST {
            for ((_, i), (_, j)) in gone.iter().zip(come) {
                self.take(*i, *j);
            }
            return;
        }
        let distance = |i: usize, j: usize| {
            let (a, b) = (before.get(i), after.get(j));
            a.zip(b).map_or(f64::INFINITY, |(a, b)| (a.at - b.at).length())
        };
        let mut distances: Vec<(f64, usize, usize)> = Vec::new();
        for (_, i) in gone {
            distances.extend(come.iter().map(|(_, j)| (distance(*i, *j), *i, *j)));
        }
        distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, i, j) in distances {
            if self.matches.get(i).is_some_and(Option::is_none) && self.is_taken.get(j) == Some(&false) {
                self.take(i, j);
            }
        }
    }

    fn take(&mut self, i: usize, j: usize) {
        if let (Some(place), Some(taken)) = (self.matches.get_mut(i), self.is_taken.get_mut(j)) {
            *place = Some(j);
            *taken = true;
        }
    }

    /// Things of the first list without a match.
    pub(super) fn lone_before(&self) -> impl Iterator<Item = usize> {
        let lone = self.matches.iter().enumerate();
        lone.filter_map(|(i, found)| found.is_none().then_some(i))
    }

    /// Things of the second list without a match.
    pub(super) fn lone_after(&self) -> impl Iterator<Item = usize> {
        let lone = self.is_taken.iter().enumerate();
        lone.filter_map(|(j, taken)| (!taken).then_some(j))
    }

    /// Things of both lists that are matched.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let matches = self.matches.iter().enumerate();
        matches.filter_map(|(i, found)| Some((i, (*found)?)))
    }
}
