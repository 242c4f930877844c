//! Blocks whose objects make one solid.

use super::{Builder, GroupMark, SceneError};
use crate::{
    diag::{Code, SourceLoc},
    scene::{
        CsgOp, Geometry, GroupId, Mesh, Object, TransformId,
        csg::{has_inside, is_closed, open_object},
    },
};

impl Builder {
    /// Begins a solid that is put together from the objects that are made until [`Builder::end_csg`], each of which must
    /// be closed: solid shapes, planes (all that lies below them), closed meshes, instances of groups of such things,
    /// and solids that are put together themselves. Saves matrix and material as [`Builder::begin_group`] does; the
    /// space stays the same.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::Ray, render::World, scene::CsgOp};
    /// let mut b = Builder::new();
    /// let solid = b.begin_csg(CsgOp::Difference)?;
    /// b.sphere(DVec3::ZERO, 2.0)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.end_csg(solid, true)?;
    /// let scene = b.finish().value;
    /// let out = Ray::new(DVec3::ZERO, DVec3::X);
    /// let hit = World::compile(&scene)?.raycast(&out, 9.0).expect("the hollow has a wall");
    /// assert_eq!((hit.t, hit.number), (1.0, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    pub fn begin_csg(&mut self, op: CsgOp) -> Result<GroupMark, SceneError> {
        let mut mark = self.begin_group()?;
        let outer = std::mem::take(&mut self.group);
        self.group.name = op.name().to_owned();
        self.group.loc = self.loc;
        self.group.csg = Some(op);
        mark.set_outer(outer);
        Ok(mark)
    }

    /// Ends what [`Builder::begin_csg`] began. With `keep` the solid is placed; without, it is dropped (the block was
    /// left by an error). Of nothing there is no solid, which is warned of.
    ///
    /// # Errors
    /// Where the limit `primitives` is passed.
    pub fn end_csg(&mut self, mut mark: GroupMark, keep: bool) -> Result<(), SceneError> {
        let mut made = Ok(());
        if let Some((_, outer)) = mark.take_outer() {
            let group = std::mem::replace(&mut self.group, outer);
            if let Some(op) = group.csg.filter(|_| keep) {
                made = match group.objects.first() {
                    Some(first) => {
                        // How it looks is its objects' matter: any material will do.
                        let (material, loc) = (first.material, group.loc);
                        let id = GroupId(self.scene.groups.len() as u32);
                        self.scene.groups.push(group);
                        self.place_block(Object {
                            geometry: Geometry::Csg(id, op),
                            transform: TransformId::IDENTITY,
                            material,
                            loc,
                        })
                    }
                    None => {
                        self.warn_empty(op, group.loc);
                        Ok(())
                    }
                };
            }
        }
        self.end_group(mark);
        made
    }

    /// Adds what a block made, counted as one.
    pub(super) fn place_block(&mut self, object: Object) -> Result<(), SceneError> {
        self.primitives = self.primitives.saturating_add(1);
        if self.primitives > self.limits.primitives {
            let limit = self.limits.primitives;
            return Err(SceneError::limit("too many shapes", "primitives", limit));
        }
        self.group.objects.push(object);
        Ok(())
    }

    fn warn_empty(&mut self, op: CsgOp, loc: SourceLoc) {
        let hint = "what is made inside its braces is what it is put together from";
        self.warn_at(Code::EmptySolid, format!("the {op} is empty"), Some(hint), loc);
    }

    /// Refuses what has no inside where solids are put together.
    #[cold]
    #[inline(never)]
    pub(super) fn require_inside(&mut self, op: CsgOp, geometry: &Geometry) -> Result<(), SceneError> {
        let refused =
            |message: String, hint: &str| Err(SceneError::new(message).class(Code::NotClosed).hint(hint));
        match geometry {
            Geometry::Csg(..) => Ok(()),
            Geometry::Shape(shape) if has_inside(shape) => Ok(()),
            Geometry::Shape(_) | Geometry::Triangle(_) => refused(
                format!("a {} has no inside, which {op} {{ }} asks for", geometry.name()),
                "solids such as sphere(), box() and closed meshes have one, and plane() has all that lies below it",
            ),
            Geometry::Mesh(id) => {
                let mesh = self.scene.meshes.get(id.index());
                if mesh.is_some_and(|mesh| self.closed_meshes.is_closed(id.index(), mesh)) {
                    return Ok(());
                }
                let name = mesh.map_or("", |mesh| mesh.name.as_str());
                refused(
                    format!("the mesh {name:?} is not closed, which {op} {{ }} asks for"),
                    "each of its edges must belong to two triangles",
                )
            }
            Geometry::Instance(id) | Geometry::Moving(id) => {
                let open =
                    open_object(&self.scene, *id).map(|object| (object.geometry.name(), object.loc.line));
                let group = self.scene.groups.get(id.index());
                let name = group.map_or("", |group| group.name.as_str());
                let holder = match geometry {
                    Geometry::Moving(_) => "what moves".to_owned(),
                    _ => format!("\"{name}\""),
                };
                match open {
                    Some((what, line)) => refused(
                        format!("{holder} holds something without an inside, the {what} of line {line}"),
                        "all that is put together must be closed",
                    ),
                    None => Ok(()),
                }
            }
        }
    }

    /// Refuses lights where solids are put together, and in what moves.
    pub(super) fn require_no_solid(&self) -> Result<(), SceneError> {
        let refused =
            |message: String| Err(SceneError::new(message).hint("make the light before or after the block"));
        match (self.group.csg, self.group.motion) {
            (Some(op), _) => refused(format!(
                "a light is no part of a solid: {op} {{ }} cannot hold it"
            )),
            (None, Some(_)) => refused("a light stands still: moving { } cannot hold it".to_owned()),
            (None, None) => Ok(()),
        }
    }
}

/// Which meshes are closed, as far as that was asked.
#[derive(Debug, Default)]
pub(super) struct ClosedMeshes(Vec<Option<bool>>);

impl ClosedMeshes {
    fn is_closed(&mut self, index: usize, mesh: &Mesh) -> bool {
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        match self.0.get_mut(index) {
            Some(known) => *known.get_or_insert_with(|| is_closed(mesh)),
            None => is_closed(mesh),
        }
    }
}
