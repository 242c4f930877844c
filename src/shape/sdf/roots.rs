//! Where a line enters and leaves the inside of a field.
//!
//! The part of the line within the box is divided until interval arithmetic says of a piece that the field has one sign
//! in it, or that it only rises or only falls; then the signs at the ends of the piece tell whether it crosses 0
//! (Mitchell, "Robust Ray Intersection with Interval Arithmetic", 1990). Pieces that say neither are divided down to the
//! rounding of t. So no wall is missed, however thin.

use super::{field::Field, interval::Interval, scalar::Slope};
use crate::math::Ray;

/// Steps of programs that are run along one line, in pieces of it, and the most and the fewest pieces. What is left then is
/// judged by the signs at the ends of each piece.
const STEPS: usize = 1 << 21;
const MOST: usize = 1 << 14;
const FEWEST: usize = 1 << 9;
/// Pieces are not divided any more where they are this small, relative to the numbers of the line.
const SMALLEST: f64 = 1e-13;

/// A field along a line.
pub(super) struct Line<'a> {
    pub(super) field: &'a Field,
    pub(super) ray: &'a Ray,
    /// Memory of the programs.
    values: Vec<f64>,
    slopes: Vec<Slope>,
}

/// A piece of the line, with the values of the field at its ends.
#[derive(Clone, Copy)]
struct Piece {
    from: End,
    to: End,
}

/// An end of a piece: t and the value of the field.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) t: f64,
    pub(super) value: f64,
}

impl End {
    pub(super) fn is_inside(self) -> bool {
        self.value < 0.0
    }
}

impl Piece {
    fn changes(&self) -> bool {
        self.from.is_inside() != self.to.is_inside()
    }

    /// How far the field is from 0 beyond each end at least, where it rises and falls no faster than `rise` allows: a
    /// little less, for the rounding of values.
    fn certain(&self, rise: Interval) -> [f64; 2] {
        // Slopes with which the value at an end comes nearer to 0, seen from there.
        let towards = |value: f64, fall: f64, climb: f64| if value < 0.0 { climb } else { fall };
        let ahead = towards(self.from.value, -rise.lo, rise.hi);
        let behind = towards(self.to.value, rise.hi, -rise.lo);
        let far = |end: End, steep: f64| {
            let far = 0.99 * end.value.abs() / steep;
            // Without a slope towards 0 there is no end to it.
            if steep > 0.0 { far } else { f64::INFINITY }
        };
        [far(self.from, ahead), far(self.to, behind)].map(|far| if far.is_nan() { 0.0 } else { far })
    }
}

impl<'a> Line<'a> {
    pub(super) fn new(field: &'a Field, ray: &'a Ray) -> Self {
        Self {
            field,
            ray,
            values: Vec::new(),
            slopes: Vec::new(),
        }
    }

    /// The value of the field at `t`.
    pub(super) fn at(&mut self, t: f64) -> End {
        let value = self.field.run(self.ray.at(t).to_array(), &mut self.values);
        End { t, value }
    }

    /// The coordinates in a piece of the line.
    fn coordinates(&self, t: Interval) -> [Interval; 3] {
        let (o, d) = (self.ray.origin.to_array(), self.ray.dir.to_array());
        let at = |o: f64, d: f64| Interval::point(o).add(Interval::point(d).mul(t));
        let ([ox, oy, oz], [dx, dy, dz]) = (o, d);
        [at(ox, dx), at(oy, dy), at(oz, dz)]
    }

    /// Tells `found` every t between two points where the line goes in or out, in ascending order.
    pub(super) fn changes(&mut self, from: End, to: End, mut found: impl FnMut(f64)) {
        let size = from.t.abs().max(to.t.abs());
        let mut left = (STEPS / self.field.len().max(1)).clamp(FEWEST, MOST);
        let mut waiting = vec![Piece { from, to }];
        while let Some(mut piece) = waiting.pop() {
            let (a, b) = (piece.from.t, piece.to.t);
            let middle = a + (b - a) * 0.5;
            let is_small = b - a <= SMALLEST * size || !(a < middle && middle < b);
            if is_small || left == 0 {
                if piece.changes() {
                    found(self.change(piece));
                }
                continue;
            }
            left -= 1;
            let at = self.coordinates(Interval::new(a, b));
            let [x, y, z] = at;
            let d = self.ray.dir;
            let slope = |v: Interval, d: f64| Slope {
                v,
                d: Interval::point(d),
            };
            let line = [slope(x, d.x), slope(y, d.y), slope(z, d.z)];
            let Slope { v: value, d: rise } = self.field.run(line, &mut self.slopes);
            if value.lo >= 0.0 || value.hi < 0.0 {
                continue;
            }
            if rise.lo > 0.0 || rise.hi < 0.0 {
                if piece.changes() {
                    found(self.change(piece));
                }
                continue;
            }
            // The ends are moved inwards as far as the field is certain not to be 0 there.
            let [ahead, behind] = piece.certain(rise);
            if !piece.changes() && ahead + behind >= b - a {
                continue;
            }
            if ahead > 0.0 && a + ahead < b {
                piece.from = self.moved(piece.from, a + ahead);
            }
            if behind > 0.0 && b - behind > piece.from.t {
                piece.to = self.moved(piece.to, b - behind);
            }
            if piece.to.t - piece.from.t < 0.5 * (b - a) {
                waiting.push(piece);
                continue;
            }
            let middle = self.at(piece.from.t + (piece.to.t - piece.from.t) * 0.5);
            waiting.push(Piece {
                from: middle,
                to: piece.to,
            });
            waiting.push(Piece {
                from: piece.from,
                to: middle,
            });
        }
    }

    /// An end in another place, if the field has the same sign there.
    fn moved(&mut self, end: End, t: f64) -> End {
        let moved = self.at(t);
        if moved.is_inside() == end.is_inside() {
            moved
        } else {
            end
        }
    }

    /// The t at which a piece goes in or out, which it does once: by halves, and by the line through the values at the
    /// ends where that is faster, to the last digits.
    fn change(&mut self, piece: Piece) -> f64 {
        let (mut a, mut b) = (piece.from.t, piece.to.t);
        let (mut fa, mut fb) = (piece.from.value, piece.to.value);
        let begins_inside = piece.from.is_inside();
        // Which end was moved last.
        let mut moved = None;
        for round in 0..120 {
            let middle = a + (b - a) * 0.5;
            if !(a < middle && middle < b) || b - a <= 4.0 * f64::EPSILON * a.abs().max(b.abs()) {
                break;
            }
            let crossed = a + (b - a) * (fa / (fa - fb));
            let is_usable = crossed > a && crossed < b && (round < 12 || round % 2 == 0);
            let t = if is_usable { crossed } else { middle };
            let f = self.at(t).value;
            let before = (f < 0.0) == begins_inside;
            // An end that stays is given half its value, so that the next try falls beyond the crossing (Dowell and
            // Jarratt, "A modified regula falsi method", 1971).
            let stays = if moved == Some(before) { 0.5 } else { 1.0 };
            if before {
                (a, fa, fb) = (t, f, fb * stays);
            } else {
                (b, fb, fa) = (t, f, fa * stays);
            }
            moved = Some(before);
        }
        if fa.abs() <= fb.abs() { a } else { b }
    }
}
