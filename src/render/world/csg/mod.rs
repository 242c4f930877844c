//! Solids put together from solids: which of the crossings of a line with all their parts are seen.
//!
//! A line is inside of a closed thing between its first and second crossing with it, its third and fourth, and so on.
//! From these spans of all parts follow those of what is put together from them, and their ends are surfaces that are
//! seen (Roth, "Ray Casting for Modeling Solids", 1982). Nothing is meshed and nothing is approximated: the ends are
//! crossings of the parts, to the bit.
//!
//! Such a solid is a level of its own, placed as an instance is, whose primitives are those of its parts; a part that is
//! put together itself, or an instance of a group, is a level inside it. So a primitive's number tells what is hit, how
//! it looks and which calls made it, as everywhere.
//!
//! Where two faces coincide, rounding alone says which is crossed first. So spans and gaps that are shorter than rounding
//! can make them count as none: what is cut flush leaves no film and what is joined face to face no wall.

mod events;
mod gather;
#[cfg(test)]
mod line;

use self::{
    events::{Event, Events},
    gather::gather,
};
use super::{
    World,
    level::Level,
    query::{Hit, Probe, Query},
};
use crate::{
    math::{Bounds3, Ray, max_abs},
    scene::CsgOp,
};

/// Spans and gaps are none where they are shorter than this in units of the numbers they are computed from: thousands of
/// times the rounding of a crossing, for those along which a ray nearly runs.
const FLAT: f64 = 1e-11;

/// A solid that is put together, as a level knows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub(super) op: CsgOp,
    /// Objects that it is put together from.
    pub(super) parts: u32,
}

impl Solid {
    /// A box around the solid, from those around its parts: `None` for what has no end.
    pub(super) fn bounds(&self, parts: &[Option<Bounds3>]) -> Option<Bounds3> {
        match self.op {
            CsgOp::Union => parts
                .iter()
                .try_fold(Bounds3::EMPTY, |all, part| part.map(|part| all.union(&part))),
            CsgOp::Difference => parts.first().copied().unwrap_or(Some(Bounds3::EMPTY)),
            CsgOp::Intersection => parts.iter().flatten().copied().reduce(|a, b| {
                let both = Bounds3::new(a.min.max(b.min), a.max.min(b.max));
                if both.is_empty() { Bounds3::EMPTY } else { both }
            }),
        }
    }
}

/// What a line is inside of.
struct Inside {
    op: CsgOp,
    parts: u32,
    /// Inside the first part.
    first: bool,
    /// How many of the parts it is inside of; of the others where the first is told apart.
    count: u32,
}

impl Inside {
    fn new(solid: Solid) -> Self {
        Self {
            op: solid.op,
            parts: solid.parts,
            first: false,
            count: 0,
        }
    }

    /// The line enters or leaves a part.
    fn pass(&mut self, part: u32, enters: bool) {
        if part == 0 && self.op == CsgOp::Difference {
            self.first = enters;
        } else if enters {
            self.count += 1;
        } else {
            self.count = self.count.saturating_sub(1);
        }
    }

    fn of_solid(&self) -> bool {
        match self.op {
            CsgOp::Union => self.count > 0,
            CsgOp::Intersection => self.count == self.parts && self.parts > 0,
            CsgOp::Difference => self.first && self.count == 0,
        }
    }
}

impl<'s> World<'s> {
    /// As [`World::search`], of a level that is a solid.
    #[cold]
    #[inline(never)]
    pub(super) fn search_solid<const ANY: bool>(
        &self,
        level: &Level<'s>,
        base: u64,
        ray: &Ray,
        query: &mut Query<'_>,
    ) -> bool {
        let mut events = Events::new(level);
        self.spans(level, base, ray, query.probe, &mut events);
        let probe = query.probe;
        for event in events.slice() {
            if !counts(event, probe) {
                continue;
            }
            if event.t > query.best.t {
                break;
            }
            let hit = Hit {
                t: event.t,
                number: event.number,
                u: event.u,
                v: event.v,
                part: event.part,
            };
            if query.offer::<ANY>(hit, || event.level.may_be_transparent(event.index)) {
                return true;
            }
            if !ANY {
                break;
            }
        }
        false
    }

    /// Tells `met` what is seen of a solid along a line, in the order in which the line meets it: the level that the
    /// primitive belongs to, its index there, its number and t. Ends where `met` says so, which is the answer.
    #[cold]
    #[inline(never)]
    pub(super) fn meet_solid(
        &self,
        level: &Level<'s>,
        base: u64,
        ray: &Ray,
        probe: &Probe,
        mut met: impl FnMut(&Level<'s>, u32, u64, f64) -> bool,
    ) -> bool {
        let mut events = Events::new(level);
        self.spans(level, base, ray, probe, &mut events);
        events
            .slice()
            .iter()
            .any(|event| counts(event, probe) && met(event.level, event.index, event.number, event.t))
    }

    /// Adds where a line enters and leaves a level, a solid or things that stand side by side, in ascending order. True
    /// where the line is inside before all of them.
    fn spans<'a>(
        &'a self,
        level: &'a Level<'s>,
        base: u64,
        ray: &Ray,
        probe: &Probe,
        events: &mut Events<'a, 's>,
    ) -> bool {
        let from = events.len();
        let ray = &self.entering(level, *ray);
        let endless = gather(self, level, base, ray, probe, events);
        let solid = level.solid().unwrap_or(Solid {
            op: CsgOp::Union,
            parts: 1,
        });
        let size = max_abs(ray.origin) / max_abs(ray.dir);
        let kept = resolve(solid, &endless, events.from(from), size);
        events.truncate(from + kept.len);
        kept.begins_inside
    }
}

/// Whether a crossing is one that a ray asks for.
fn counts(event: &Event<'_, '_>, probe: &Probe) -> bool {
    !event.is_start && event.t > probe.least_beyond_start(event.number) && event.t < f64::INFINITY
}

struct Kept {
    len: usize,
    begins_inside: bool,
}

/// Keeps of the crossings of all parts, in any order, those with the surface of the whole: the first ones, in ascending
/// order. The line begins inside of the `endless` parts; `size` is that of the numbers of the ray.
fn resolve(solid: Solid, endless: &[u32], events: &mut [Event<'_, '_>], size: f64) -> Kept {
    // Every part by itself, to tell where it is entered and where left.
    events.sort_unstable_by(|a, b| {
        let by_part = a.object.cmp(&b.object);
        by_part.then(a.t.total_cmp(&b.t)).then(a.number.cmp(&b.number))
    });
    let mut len = 0;
    let mut part = None;
    let mut inside = false;
    for i in 0..events.len() {
        let mut event = events[i];
        // A triangle that was cut stands in several leaves.
        let again = |last: &Event<'_, '_>| last.is_triangle && last.number == event.number;
        if part == Some(event.object) && len > 0 && again(&events[len - 1]) {
            continue;
        }
        if part != Some(event.object) {
            part = Some(event.object);
            inside = endless.contains(&event.object);
        }
        inside = !inside;
        event.enters = inside;
        event.order = len as u32;
        events[len] = event;
        len += 1;
    }
    let events = &mut events[..len];
    events.sort_unstable_by(|a, b| {
        let by_t = a.t.total_cmp(&b.t);
        by_t.then(a.number.cmp(&b.number)).then(a.order.cmp(&b.order))
    });
    let mut now = Inside::new(solid);
    endless.iter().for_each(|&part| now.pass(part, true));
    let begins_inside = now.of_solid();
    let mut was = begins_inside;
    let mut kept = 0;
    for i in 0..events.len() {
        let event = events[i];
        now.pass(event.object, event.enters);
        if now.of_solid() == was {
            continue;
        }
        was = !was;
        let flat = |last: &Event<'_, '_>| event.t - last.t <= FLAT * size.max(event.t.abs());
        if kept > 0 && flat(&events[kept - 1]) {
            kept -= 1;
        } else {
            events[kept] = event;
            kept += 1;
        }
    }
    Kept {
        len: kept,
        begins_inside,
    }
}

#[cfg(test)]
mod tests;
