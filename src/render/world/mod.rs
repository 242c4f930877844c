//! A [`Scene`] compiled for tracing.
//!
//! Each group of the scene becomes a [`Level`]: its shapes sorted by kind, what can be moved into the level's
//! space moved there, and one tree over everything. An instance is a primitive of the level that places it and
//! leads to another level. Whatever is hit has a number that is unique over all instances, in the order the
//! primitives stand in; the nearest hit is the one of least (t, number), whatever tree found it.

mod compile;
mod level;
mod surface;
#[cfg(test)]
mod tests;
mod trace;

pub(crate) use surface::SurfacePoint;
pub(crate) use trace::Probe;

use crate::scene::Scene;
use level::Level;

/// A scene with its acceleration structures.
#[derive(Debug)]
pub(crate) struct World<'s> {
    pub(crate) scene: &'s Scene,
    /// Levels; a level comes before the levels that place it, so the last is the root.
    levels: Vec<Level>,
    /// Whether any material lets light through, so that shadows must look at what they meet.
    has_transparency: bool,
}

impl World<'_> {
    /// Primitives that can be hit, each level counted once.
    pub(crate) fn primitives(&self) -> u64 {
        self.levels.iter().map(|level| level.primitives() as u64).sum()
    }

    /// Bytes of the compiled form, without the scene it refers to.
    pub(crate) fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.bytes() as u64).sum()
    }

    fn root(&self) -> Option<&Level> {
        self.levels.last()
    }
}
