//! What moves while light is gathered: a level of its own, into which a ray goes as it is seen from there at its time.
//!
//! All rays that follow from one sample of a pixel have one time, and that is the world's: [`World::at_time`] is the same
//! world at another time, with which it shares all but that number. A level that moves has, for those that look at it from
//! outside, a box around all places that it is in while the shutter is open, and one tree for all times.

use std::sync::Arc;

use super::{
    World,
    level::{Level, Rare},
    query::Query,
};
use crate::{
    math::{DAffine3, Ray},
    render::shots::Shot,
};

impl<'s> World<'s> {
    /// The same world at another time, that a number from 0 to 1 stands for: from where the camera's shutter opens to
    /// where it closes. Nothing is compiled anew. A world that was just compiled is in the middle, as
    /// [`Camera::frame`](crate::scene::Camera::frame) is.
    #[must_use]
    pub fn at_time(&self, share: f64) -> Self {
        Self {
            scene: self.scene,
            levels: Arc::clone(&self.levels),
            fields: self.fields,
            keys: Vec::new(),
            packets: self.packets,
            interrupt: self.interrupt,
            lamps: Arc::clone(&self.lamps),
            is_linked: self.is_linked,
            shadows_dim: self.shadows_dim,
            around: self.around.clone(),
            uv_everywhere: self.uv_everywhere,
            needs_width: self.needs_width,
            needs_footprint: self.needs_footprint,
            time: self.scene.camera.shutter.time(share.clamp(0.0, 1.0)),
            moves: self.moves,
        }
    }

    /// Whether anything in it moves while the shutter is open.
    pub(in crate::render) fn moves(&self) -> bool {
        self.moves
    }

    /// A ray as a level sees it that it enters, given as it is without the level's motion.
    pub(super) fn entering(&self, level: &Level<'_>, ray: Ray) -> Ray {
        match &level.rare {
            Some(Rare::Moving(motion)) => ray.transformed(&motion.inverse_at(self.time)),
            Some(Rare::Solid(_)) | None => ray,
        }
    }

    /// As [`World::search`], of a level that is more than things side by side.
    #[cold]
    #[inline(never)]
    pub(super) fn search_rare<const ANY: bool>(
        &self,
        level: &Level<'s>,
        base: u64,
        ray: Ray,
        query: &mut Query<'_>,
    ) -> bool {
        match &level.rare {
            Some(Rare::Solid(_)) => self.search_solid::<ANY>(level, base, &ray, query),
            Some(Rare::Moving(_)) | None => {
                self.search::<ANY>(level, base, &self.entering(level, ray), query)
            }
        }
    }

    /// What takes the world into a level, given what takes it to where the level is without its motion.
    #[cold]
    #[inline(never)]
    pub(super) fn moved_from_world(&self, level: &Level<'_>, level_from_world: DAffine3) -> DAffine3 {
        match &level.rare {
            Some(Rare::Moving(motion)) => motion.inverse_at(self.time) * level_from_world,
            Some(Rare::Solid(_)) | None => level_from_world,
        }
    }
}

/// The world as the samples of a picture see it, one after the other.
pub(in crate::render) struct Moments<'w, 's> {
    still: &'w World<'s>,
    moving: Option<World<'s>>,
}

impl<'w, 's> Moments<'w, 's> {
    pub(in crate::render) fn new(still: &'w World<'s>) -> Self {
        Self {
            still,
            moving: still.moves.then(|| still.at_time(0.5)),
        }
    }

    /// The world at the time of a sample.
    pub(in crate::render) fn at(&mut self, shot: &Shot) -> &World<'s> {
        match &mut self.moving {
            None => self.still,
            Some(moving) => {
                moving.time = shot.time;
                moving
            }
        }
    }
}
