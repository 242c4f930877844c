//! What is asked of a scene that is still being built.

use super::{Builder, swap_root};
use crate::{
    diag::SourceLoc,
    math::Bounds3,
    scene::{GroupId, ROOT_GROUP, Scene},
};

impl Builder {
    /// What was made so far, inside of a define that, as a scene of its own.
    pub(crate) fn scene_so_far(&mut self) -> Option<Scene> {
        swap_root(&mut self.scene, &mut self.group);
        let scene = self.scene.extract(ROOT_GROUP);
        swap_root(&mut self.scene, &mut self.group);
        scene
    }

    /// The box around what was made so far, as [`Scene::bounds`] gives it.
    pub(crate) fn bounds_so_far(&mut self) -> Option<Bounds3> {
        swap_root(&mut self.scene, &mut self.group);
        let bounds = self.scene.bounds(ROOT_GROUP);
        swap_root(&mut self.scene, &mut self.group);
        bounds
    }

    /// The box around a group that was defined, as [`Scene::bounds`] gives it.
    pub(crate) fn bounds_of(&self, id: GroupId) -> Option<Bounds3> {
        self.scene.bounds(id)
    }

    /// A defined group as a scene of its own; see [`Scene::extract`].
    pub(crate) fn extract(&self, id: GroupId) -> Option<Scene> {
        self.scene.extract(id)
    }

    /// Differs wherever [`Builder::scene_so_far`] does.
    pub(crate) fn progress(&self) -> (usize, usize, usize, SourceLoc) {
        let objects = self.group.objects.len();
        (self.primitives, objects, self.scene.groups.len(), self.group.loc)
    }
}
