//! Blocks whose objects move while light is gathered.

use super::{Builder, GroupMark, Placing, SceneError};
use crate::{
    diag::SourceLoc,
    scene::{AnimatedTransform, Geometry, GroupId, MaterialId, Object},
};

impl Builder {
    /// Begins what moves together: all objects that are made until [`Builder::end_moving`], in a space of its own that
    /// stands under the current matrix when the motion begins, and moves there as `motion` says while the
    /// [shutter](crate::scene::Shutter) is open. Saves matrix and material as [`Builder::begin_group`] does, and the matrix
    /// within is the identity.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::Ray, render::World, scene::AnimatedTransform};
    /// let mut b = Builder::new();
    /// b.translate(DVec3::Y * 3.0)?;
    /// let along = AnimatedTransform { translate: DVec3::X * 4.0, ..AnimatedTransform::default() };
    /// let moving = b.begin_moving(along)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.end_moving(moving, true)?;
    /// let scene = b.finish().value;
    /// let world = World::compile(&scene)?;
    /// let up = Ray::new(DVec3::X * 4.0, DVec3::Y);
    /// assert_eq!(world.at_time(0.0).raycast(&up, 9.0), None);
    /// assert_eq!(world.at_time(1.0).raycast(&up, 9.0).map(|hit| hit.t), Some(2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where a number of the motion is out of its range, the current matrix is singular, or the limit `transform_depth`
    /// is passed.
    pub fn begin_moving(&mut self, motion: AnimatedTransform) -> Result<GroupMark, SceneError> {
        motion.check()?;
        self.require_invertible("a", "moving block")?;
        let mut mark = self.begin_group()?;
        let outer = std::mem::take(&mut self.group);
        self.group.name = "moving".to_owned();
        self.group.loc = self.loc;
        self.group.motion = Some(motion.told_plainly());
        self.ctm = Placing::IDENTITY;
        mark.set_outer(outer);
        Ok(mark)
    }

    /// Ends what [`Builder::begin_moving`] began. With `keep` it is placed; without, it is dropped (the block was left by
    /// an error). Where nothing was made there is nothing that moves.
    ///
    /// # Errors
    /// Where the limit `primitives` is passed, or what it is to be a part of asks for solids and something in it is none.
    pub fn end_moving(&mut self, mut mark: GroupMark, keep: bool) -> Result<(), SceneError> {
        let made = mark
            .take_outer()
            .map(|(_, outer)| std::mem::replace(&mut self.group, outer));
        self.end_group(mark);
        let Some(group) = made.filter(|_| keep) else {
            return Ok(());
        };
        let Some(first) = group.objects.first() else {
            return Ok(());
        };
        // How it looks is its objects' matter: any material will do.
        let (material, loc) = (first.material, group.loc);
        let geometry = Geometry::Moving(GroupId(self.scene.groups.len() as u32));
        self.scene.groups.push(group);
        let placed = self.place_moving(geometry, material, loc);
        if placed.is_err() {
            self.scene.groups.pop();
        }
        placed
    }

    fn place_moving(
        &mut self,
        geometry: Geometry,
        material: MaterialId,
        loc: SourceLoc,
    ) -> Result<(), SceneError> {
        if let Some(op) = self.group.csg {
            self.require_inside(op, &geometry)?;
        }
        let transform = self.ctm.id(&mut self.scene.transforms);
        self.place_block(Object {
            geometry,
            transform,
            material,
            loc,
        })
    }
}
