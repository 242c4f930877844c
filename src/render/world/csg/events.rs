//! The crossings of one line with the parts of a solid.

use super::super::level::Level;

/// A crossing with a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event<'a, 's> {
    pub(super) t: f64,
    pub(super) number: u64,
    /// As in a [`Hit`](super::Hit).
    pub(super) u: f64,
    pub(super) v: f64,
    pub(super) part: u32,
    /// The part of the solid that it belongs to: an object of the group that is looked at.
    pub(super) object: u32,
    /// The level that the primitive belongs to, and its index there.
    pub(super) level: &'a Level<'s>,
    pub(super) index: u32,
    /// Its place among those of all parts, one part after the other.
    pub(super) order: u32,
    pub(super) enters: bool,
    /// The start of the ray itself.
    pub(super) is_start: bool,
    pub(super) is_triangle: bool,
}

impl<'a, 's> Event<'a, 's> {
    pub(super) fn new(level: &'a Level<'s>, index: u32, object: u32) -> Self {
        Self {
            t: 0.0,
            number: 0,
            u: 0.0,
            v: 0.0,
            part: 0,
            object,
            level,
            index,
            order: 0,
            enters: false,
            is_start: false,
            is_triangle: false,
        }
    }
}

/// Crossings that are kept without asking for memory.
const FEW: usize = 24;

/// A list of crossings, which asks for memory only where they are many.
pub(super) struct Events<'a, 's> {
    few: [Event<'a, 's>; FEW],
    len: usize,
    /// All of them, once they are more than few.
    many: Vec<Event<'a, 's>>,
}

impl<'a, 's> Events<'a, 's> {
    /// No crossings; `level` is any.
    pub(super) fn new(level: &'a Level<'s>) -> Self {
        Self {
            few: [(); FEW].map(|()| Event::new(level, 0, 0)),
            len: 0,
            many: Vec::new(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn push(&mut self, event: Event<'a, 's>) {
        if !self.many.is_empty() {
            self.many.push(event);
        } else if let Some(place) = self.few.get_mut(self.len) {
            *place = event;
        } else {
            self.many.reserve(4 * FEW);
            self.many.extend_from_slice(&self.few);
            self.many.push(event);
        }
        self.len += 1;
    }

    pub(super) fn slice(&self) -> &[Event<'a, 's>] {
        let all = if self.many.is_empty() {
            &self.few[..]
        } else {
            &self.many[..]
        };
        all.get(..self.len).unwrap_or_default()
    }

    /// Those from place `from` on.
    pub(super) fn from(&mut self, from: usize) -> &mut [Event<'a, 's>] {
        let all = if self.many.is_empty() {
            &mut self.few[..]
        } else {
            &mut self.many[..]
        };
        all.get_mut(from..self.len).unwrap_or_default()
    }

    pub(super) fn truncate(&mut self, len: usize) {
        if self.many.is_empty() {
            self.len = self.len.min(len);
        } else if len <= FEW {
            for (place, event) in self.few.iter_mut().zip(self.many.iter().take(len)) {
                *place = *event;
            }
            self.many.clear();
            self.len = len;
        } else {
            self.many.truncate(len);
            self.len = self.many.len();
        }
    }
}
