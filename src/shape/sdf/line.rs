//! Where a line enters and leaves the inside of a field.
//!
//! A piece of the line is divided until interval arithmetic says of each part that the field has one sign in it, or that
//! it only rises or only falls; then the signs at the ends of the part tell whether it crosses 0 (Mitchell, "Robust Ray
//! Intersection with Interval Arithmetic", 1990). So no wall is missed, however thin.
//!
//! All this looks at the field in a row of places along the line only, which are as far apart as the rounding of t: each
//! change of sign lies between two neighbors, however they were found. So what is known beforehand of parts of space
//! ([`Cells`](super::cells::Cells)) makes it faster and changes nothing.

use super::{
    interval::{Interval, floor},
    scalar::Slope,
    tape::Tape,
};
use crate::{
    math::{DVec3, Ray},
    shape::CrossingSink,
};

/// Operations of tapes that are run along one line, in pieces of it, and the most and the fewest pieces. What is left then
/// is judged by the signs at the ends of each piece.
const OPERATIONS: usize = 1 << 21;
const MOST: usize = 1 << 14;
const FEWEST: usize = 1 << 9;
/// The farther end of the line is between 2^42 and 2^43 places away from 0.
const PLACES: f64 = (1u64 << 43) as f64;

/// Memory that is used again.
#[derive(Default)]
pub(super) struct Memory {
    values: Vec<f64>,
    slopes: Vec<Slope<1>>,
    waiting: Vec<Piece>,
}

/// The part of a line that lies in a box, as a row of places.
pub(super) struct Line<'a> {
    pub(super) ray: &'a Ray,
    /// t where it begins and ends: the first place and the last. Those between lie at multiples of `step`, a power of two.
    from: f64,
    to: f64,
    step: f64,
    per_step: f64,
    /// The multiple at or before `from`, and how many steps there are.
    first: i64,
    last: i64,
    /// Pieces that may still be looked at.
    left: usize,
    memory: &'a mut Memory,
}

/// A place in the row, and the value of the field there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) at: i64,
    pub(super) value: f64,
}

impl Place {
    pub(super) fn is_inside(self) -> bool {
        self.value < 0.0
    }
}

#[derive(Clone, Copy)]
struct Piece {
    from: Place,
    to: Place,
}

impl Piece {
    fn changes(&self) -> bool {
        self.from.is_inside() != self.to.is_inside()
    }

    /// How far the field is from 0 beyond each end at least, where it rises and falls no faster than `rise` allows.
    fn certain(&self, rise: Interval) -> [f64; 2] {
        let behind = Interval {
            lo: -rise.hi,
            hi: -rise.lo,
        };
        [certain(self.from.value, rise), certain(self.to.value, behind)]
    }
}

/// How far ahead a field that has this value is not 0 at least, where it rises and falls no faster than `rise` allows: a
/// little less, for the rounding of values.
pub(super) fn certain(value: f64, rise: Interval) -> f64 {
    // The slope with which the value comes nearer to 0.
    let steep = if value < 0.0 { rise.hi } else { -rise.lo };
    if steep > 0.0 {
        let far = 0.99 * value.abs() / steep;
        if far.is_nan() { 0.0 } else { far }
    } else if value.is_nan() {
        0.0
    } else {
        // Without a slope towards 0 there is no end to it.
        f64::INFINITY
    }
}

impl<'a> Line<'a> {
    /// The places from one t to another.
    pub(super) fn new(ray: &'a Ray, from: f64, to: f64, operations: usize, memory: &'a mut Memory) -> Self {
        // The power of two at or below the larger, which is not so small that its reciprocal has no end.
        let size = from.abs().max(to.abs()).max(1e-280);
        let power = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
        let step = power * (2.0 / PLACES);
        let per_step = step.recip();
        let first = floor(from * per_step);
        let last = -floor(-to * per_step) - first;
        Self {
            ray,
            from,
            to,
            step,
            per_step,
            first,
            last: last.max(1),
            left: (OPERATIONS / operations.max(1)).clamp(FEWEST, MOST),
            memory,
        }
    }

    /// The last place; the first is 0.
    pub(super) fn last(&self) -> i64 {
        self.last
    }

    pub(super) fn t(&self, place: i64) -> f64 {
        if place <= 0 {
            self.from
        } else if place >= self.last {
            self.to
        } else {
            (self.first + place) as f64 * self.step
        }
    }

    /// The last place at or before `t`, or the first.
    pub(super) fn before(&self, t: f64) -> i64 {
        let place = floor(t.clamp(self.from, self.to) * self.per_step) - self.first;
        place.clamp(0, self.last)
    }

    pub(super) fn point(&self, place: i64) -> DVec3 {
        self.ray.at(self.t(place))
    }

    pub(super) fn look(&mut self, tape: &Tape, at: i64) -> Place {
        let value = tape.run(self.point(at).to_array(), &mut self.memory.values);
        Place { at, value }
    }

    /// Value and slope in a piece of the line.
    fn bounds(&mut self, tape: &Tape, piece: &Piece) -> Slope<1> {
        let t = Interval::new(self.t(piece.from.at), self.t(piece.to.at));
        let Ray { origin, dir } = *self.ray;
        let at = |o: f64, d: f64| {
            let d = Interval::point(d);
            Slope {
                v: Interval::point(o).add(d.mul(t)),
                d: [d],
            }
        };
        let point = [at(origin.x, dir.x), at(origin.y, dir.y), at(origin.z, dir.z)];
        tape.run(point, &mut self.memory.slopes)
    }

    /// Tells `out` every t between two places where the line goes in or out, in ascending order, as far as it asks. The
    /// field is that of `tape` there, and rises by no more and no less than `rise`.
    pub(super) fn changes(
        &mut self,
        tape: &Tape,
        [from, to]: [Place; 2],
        rise: Interval,
        out: &mut impl CrossingSink,
        part: u32,
    ) {
        let mut next = Some(Piece { from, to });
        let known = rise;
        self.memory.waiting.clear();
        while let Some(piece) = next.take().or_else(|| self.memory.waiting.pop()) {
            if piece.to.at - piece.from.at <= 1 {
                if piece.changes() {
                    out.push(self.between(piece), part);
                    if out.is_served() {
                        return;
                    }
                }
                continue;
            }
            // First by what is known beforehand, then by the bounds of this very piece.
            let mut found = self.judge(&piece, known);
            let mut rise = known;
            if matches!(found, Verdict::Open) {
                if self.left == 0 {
                    found = Verdict::Once;
                } else {
                    self.left -= 1;
                    let Slope { v: value, d: [own] } = self.bounds(tape, &piece);
                    if value.lo >= 0.0 || value.hi < 0.0 {
                        continue;
                    }
                    rise = Interval::new(own.lo.max(known.lo), own.hi.min(known.hi));
                    found = self.judge(&piece, rise);
                }
            }
            match found {
                Verdict::Never => {}
                Verdict::Once => {
                    if piece.changes() {
                        let neighbors = self.narrowed(tape, piece);
                        out.push(self.between(neighbors), part);
                        if out.is_served() {
                            return;
                        }
                    }
                }
                Verdict::Open => next = Some(self.divided(tape, piece, rise)),
            }
        }
    }

    /// What the slope tells of a piece.
    fn judge(&self, piece: &Piece, rise: Interval) -> Verdict {
        if rise.lo > 0.0 || rise.hi < 0.0 {
            return Verdict::Once;
        }
        if !piece.changes() {
            let [ahead, behind] = piece.certain(rise);
            if ahead + behind >= self.t(piece.to.at) - self.t(piece.from.at) {
                return Verdict::Never;
            }
        }
        Verdict::Open
    }

    /// The first part of a piece, of whose ends as much is left out as is certain not to be 0; what follows waits.
    fn divided(&mut self, tape: &Tape, piece: Piece, rise: Interval) -> Piece {
        let Piece { mut from, mut to } = piece;
        let [ahead, behind] = piece.certain(rise);
        if ahead > 0.0 {
            let place = self.before(self.t(from.at) + ahead);
            if place > from.at && place < to.at {
                from = self.moved(tape, from, place);
            }
        }
        if behind > 0.0 {
            let place = self.before(self.t(to.at) - behind) + 1;
            if place > from.at && place < to.at {
                to = self.moved(tape, to, place);
            }
        }
        let length = to.at - from.at;
        if length <= 1 || length < (piece.to.at - piece.from.at) / 2 {
            return Piece { from, to };
        }
        let middle = self.look(tape, from.at + length / 2);
        self.memory.waiting.push(Piece { from: middle, to });
        Piece { from, to: middle }
    }

    /// An end in another place, if the field has the same sign there.
    fn moved(&mut self, tape: &Tape, end: Place, at: i64) -> Place {
        let moved = self.look(tape, at);
        if moved.is_inside() == end.is_inside() {
            moved
        } else {
            end
        }
    }

    /// The two neighbors between which a piece goes in or out, which it does once: by the line through the values at the
    /// ends, where an end that stays counts for less the slower this is (Anderson and Björck, "A new high order method of
    /// regula falsi type", 1973), and by halves where that does not help.
    fn narrowed(&mut self, tape: &Tape, piece: Piece) -> Piece {
        let Piece { mut from, mut to } = piece;
        let (mut weight_from, mut weight_to) = (from.value, to.value);
        // The lengths of the last three looks: after three more it must be half.
        let mut lengths = [i64::MAX; 3];
        // Which end was moved last.
        let mut moved = None;
        while to.at - from.at > 1 {
            let length = to.at - from.at;
            let [oldest, older, old] = lengths;
            lengths = [older, old, length];
            let share = weight_from / (weight_from - weight_to);
            let at = if (0.0..=1.0).contains(&share) && length <= oldest / 2 {
                from.at + ((length as f64 * share) as i64).clamp(1, length - 1)
            } else {
                from.at + length / 2
            };
            let place = self.look(tape, at);
            let is_from = place.is_inside() == from.is_inside();
            // How much an end counts that stays once more, after another that goes from one value to another.
            let counts = |before: f64| {
                let less = 1.0 - place.value / before;
                match moved == Some(is_from) {
                    true if less > 0.0 => less,
                    true => 0.5,
                    false => 1.0,
                }
            };
            if is_from {
                weight_to *= counts(from.value);
                (from, weight_from) = (place, place.value);
            } else {
                weight_from *= counts(to.value);
                (to, weight_to) = (place, place.value);
            }
            moved = Some(is_from);
        }
        Piece { from, to }
    }

    /// The t between two neighbors at which the line through their values is 0.
    fn between(&self, Piece { from, to }: Piece) -> f64 {
        let (a, b) = (self.t(from.at), self.t(to.at));
        let share = from.value / (from.value - to.value);
        if (0.0..=1.0).contains(&share) {
            (a + (b - a) * share).clamp(a, b)
        } else {
            a
        }
    }
}

/// What is known of a piece.
enum Verdict {
    /// The field is not 0 in it.
    Never,
    /// It goes in or out once where the signs at its ends differ, and not at all otherwise.
    Once,
    Open,
}
