//! What is different between two scenes, in things a person would name: this ball moved, that lamp is gone.

mod items;
mod motion;
mod pairs;
mod words;

use self::{
    items::{Contents, Item, lights, objects},
    pairs::{Pairing, is_one_move, same_in_full, same_lines},
};
use super::{GroupId, Object, ROOT_GROUP, Scene};
use crate::{diag::SourceLoc, math::DVec3};

pub use words::{settings, short};

/// A way in which a thing is not what it was.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Way {
    /// By so much, in the space of its group.
    Moved(DVec3),
    /// About an axis (a unit vector) by so many degrees, in the space of its group.
    Turned(DVec3, f64),
    /// By these factors along its own axes.
    Scaled(DVec3),
    /// Its matrix is another one in a way that has no shorter name.
    Placed,
    /// Something about it has another value.
    Value {
        /// What: `radius`, `diffuse`, `color`.
        what: &'static str,
        /// What it was.
        from: String,
        /// What it is.
        to: String,
    },
}

/// Something that only one scene has, or that both have and is not the same.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Change<'a> {
    /// The name of the group it is in; empty for the root.
    pub group: &'a str,
    /// What a script calls it.
    pub name: &'static str,
    /// Of an instance, what it is an instance of.
    pub of: &'a str,
    /// Where it is, in the space of its group.
    pub at: DVec3,
    /// The call that made it in the first scene, where it has it.
    pub before: Option<SourceLoc>,
    /// The call that made it in the second scene, where it has it.
    pub after: Option<SourceLoc>,
    /// The place of the call, as the caller's function tells it.
    pub place: Place,
    /// What is different, where both have it.
    pub ways: Vec<Way>,
}

/// A file and a line, the same for both scenes where they have the line in common.
pub type Place = (u32, u32);

/// Tells `report` of everything in which the scenes differ, settings and camera aside; `place` says where a call of the
/// first (false) or of the second scene stands.
///
/// Things are matched group by group, groups by their names: first what is the same in full, wherever it is made, but
/// where a line makes as many things as before and one move leads from all of them to all of those, that is taken; then
/// what comes from one line, first where all but one thing about it is the same; then what is the same but for its
/// place or its look, wherever it is made. The rest was added or removed. n log n for n things.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::compare::{Change, Place, Way, compare}};
/// let ball_at = |x| -> Result<_, rtscript::scene::SceneError> {
///     let mut b = Builder::new();
///     b.sphere(DVec3::X * x, 1.0)?;
///     Ok(b.finish().value)
/// };
/// let (before, after) = (ball_at(0.0)?, ball_at(2.0)?);
/// let mut names = Vec::new();
/// let same_place = |_: bool, loc: rtscript::diag::SourceLoc| -> Place { (loc.file.into(), loc.line) };
/// compare(&before, &after, &same_place, &mut |change: Change| names.push((change.name, change.ways.len())));
/// assert!(!names.is_empty());
/// # let _: Option<Way> = None;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare<'a>(
    before: &'a Scene,
    after: &'a Scene,
    place: &dyn Fn(bool, SourceLoc) -> Place,
    report: &mut dyn FnMut(Change<'a>),
) {
    let (before_names, after_names) = (super::source::names(before), super::source::names(after));
    let group_of = |names: &[String], name: &str| {
        let index = names.iter().position(|known| known == name)?;
        u32::try_from(index).ok().map(GroupId)
    };
    let contents = (
        Contents::new(before, before_names),
        Contents::new(after, after_names),
    );
    for (index, name) in (0u32..).zip(&contents.0.names) {
        let other = if index == ROOT_GROUP.0 {
            Some(ROOT_GROUP)
        } else {
            group_of(&contents.1.names, name)
        };
        match other {
            Some(other) => of_group((&contents.0, &contents.1), (GroupId(index), other), place, report),
            None => lone_group(&contents.0, GroupId(index), false, place, report),
        }
    }
    for (index, name) in (0u32..).zip(&contents.1.names).skip(1) {
        if group_of(&contents.0.names, name).is_none() {
            lone_group(&contents.1, GroupId(index), true, place, report);
        }
    }
}

/// A group that only one of the scenes has.
fn lone_group<'a>(
    contents: &Contents<'a>,
    id: GroupId,
    is_new: bool,
    place: &dyn Fn(bool, SourceLoc) -> Place,
    report: &mut dyn FnMut(Change<'a>),
) {
    let group = contents.scene.groups.get(id.index());
    // A solid that is put together is told of as the object that it is, and so is what moves together.
    let Some(group) = group.filter(|group| !group.is_in_place()) else {
        return;
    };
    report(Change {
        group: "",
        name: "define",
        of: &group.name,
        at: DVec3::ZERO,
        before: (!is_new).then_some(group.loc),
        after: is_new.then_some(group.loc),
        place: place(is_new, group.loc),
        ways: Vec::new(),
    });
}

/// Objects and lights of one group.
fn of_group<'a>(
    (before, after): (&Contents<'a>, &Contents<'a>),
    (a, b): (GroupId, GroupId),
    place: &dyn Fn(bool, SourceLoc) -> Place,
    report: &mut dyn FnMut(Change<'a>),
) {
    let (Some(old), Some(new)) = (
        before.scene.groups.get(a.index()),
        after.scene.groups.get(b.index()),
    ) else {
        return;
    };
    let digests = (before.digests(&old.objects), after.digests(&new.objects));
    let (mut gone, mut come) = same_in_full(&digests.0, &digests.1);
    let item = |is_new: bool, loc| place(is_new, loc);
    let items = |gone: &[u32], come: &[u32]| {
        let gone = objects(before, old, gone, &|loc| item(false, loc));
        (gone, objects(after, new, come, &|loc| item(true, loc)))
    };
    if !gone.is_empty() && !come.is_empty() {
        let places = |objects: &[Object], is_new| -> Vec<Place> {
            objects.iter().map(|object| item(is_new, object.loc)).collect()
        };
        let places = (places(&old.objects, false), places(&new.objects, true));
        for (a, b) in same_lines((&digests.0, &digests.1), (&places.0, &places.1), (&gone, &come)) {
            let (old, new) = items(&a, &b);
            if is_one_move(&old, &new) {
                gone.extend(a);
                come.extend(b);
            }
        }
        for list in [&mut gone, &mut come] {
            list.sort_unstable();
            list.dedup();
        }
    }
    drop(digests);
    let (gone, come) = items(&gone, &come);
    of_items((before, after), &old.name, (gone, come), report);
    let gone = lights(before.scene, old, &|loc| item(false, loc));
    let come = lights(after.scene, new, &|loc| item(true, loc));
    let digests = |items: &[Item<'_>]| -> Vec<u128> { items.iter().map(|item| item.full).collect() };
    let left = same_in_full(&digests(&gone), &digests(&come));
    let keep = |items: Vec<Item<'a>>, left: &[u32]| -> Vec<Item<'a>> {
        let kept = left.iter().filter_map(|i| items.get(*i as usize).cloned());
        kept.collect()
    };
    let left = (keep(gone, &left.0), keep(come, &left.1));
    of_items((before, after), &old.name, left, report);
}

fn of_items<'a>(
    contents: (&Contents<'a>, &Contents<'a>),
    group: &'a str,
    (gone, come): (Vec<Item<'a>>, Vec<Item<'a>>),
    report: &mut dyn FnMut(Change<'a>),
) {
    let pairing = Pairing::of(&gone, &come);
    let lone = |item: &Item<'a>, is_new: bool| Change {
        group,
        name: item.name,
        of: item.of,
        at: item.at,
        before: (!is_new).then_some(item.loc),
        after: is_new.then_some(item.loc),
        place: item.place,
        ways: Vec::new(),
    };
    for item in pairing.lone_before().filter_map(|i| gone.get(i)) {
        report(lone(item, false));
    }
    for item in pairing.lone_after().filter_map(|i| come.get(i)) {
        report(lone(item, true));
    }
    for (a, b) in pairing.pairs() {
        let (Some(a), Some(b)) = (gone.get(a), come.get(b)) else {
            continue;
        };
        report(Change {
            before: Some(a.loc),
            ways: words::ways(contents, a, b),
            ..lone(b, true)
        });
    }
}

#[cfg(test)]
mod tests;
