//! What is done with the things that a ray meets.

use crate::{accel::Control, render::world::level::Level};

/// What is done with the things a ray meets, in no particular order.
pub(super) trait Census {
    /// How far along the ray things count.
    fn reach(&self) -> f64;
    /// Whether the primitive `index` of a level counts at all.
    fn counts(&self, level: &Level, index: u32) -> bool;
    /// False where nothing in the tree of a level counts.
    fn counts_in_tree(&self, _level: &Level) -> bool {
        true
    }
    /// A primitive that counts is met at `t`, its own crossings in ascending order.
    fn meet(&mut self, level: &Level, index: u32, number: u64, t: f64) -> Control;
    /// Something that may let light through is met more often than can be listed.
    fn lose_count(&mut self) {}
}

/// Transparent surfaces along a shadow ray by distance, until something opaque is met.
pub(super) struct Found {
    pub(super) t_max: f64,
    /// Transparent surfaces this far count.
    pub(super) t_far: f64,
    pub(super) list: [(f64, u64); Self::CAPACITY],
    /// One more than the capacity where there were too many.
    pub(super) len: usize,
}

impl Found {
    pub(super) const CAPACITY: usize = 16;
}

impl Census for Found {
    fn reach(&self) -> f64 {
        self.t_far
    }

    fn lose_count(&mut self) {
        self.len = Self::CAPACITY + 1;
    }

    #[inline]
    fn counts(&self, _: &Level, _: u32) -> bool {
        true
    }

    #[inline]
    fn meet(&mut self, level: &Level, index: u32, number: u64, t: f64) -> Control {
        if !level.may_be_transparent(index) {
            return if t <= self.t_max {
                Control::Stop
            } else {
                Control::Continue
            };
        }
        // A triangle that was cut stands in several leaves.
        let known = self
            .list
            .get(..self.len)
            .is_none_or(|list| list.contains(&(t, number)));
        if t > self.t_far || known {
            return Control::Continue;
        }
        if self.len == Self::CAPACITY {
            self.len += 1;
            return Control::Continue;
        }
        let mut place = self.len;
        while place > 0 && self.list[place - 1].0 > t {
            self.list[place] = self.list[place - 1];
            place -= 1;
        }
        self.list[place] = (t, number);
        self.len += 1;
        Control::Continue
    }
}

/// Whether anything that may be opaque is met within this distance.
pub(super) struct OpaqueWithin(pub(super) f64);

impl Census for OpaqueWithin {
    fn reach(&self) -> f64 {
        self.0
    }

    #[inline]
    fn counts(&self, level: &Level, index: u32) -> bool {
        // A shared mesh is marked transparent where whatever places it may be.
        level.group.is_none() || !level.may_be_transparent(index)
    }

    fn counts_in_tree(&self, level: &Level) -> bool {
        level.group.is_none() || level.has_opaque_tree
    }

    #[inline]
    fn meet(&mut self, _: &Level, _: u32, _: u64, t: f64) -> Control {
        if t <= self.0 {
            Control::Stop
        } else {
            Control::Continue
        }
    }
}
