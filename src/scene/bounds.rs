//! How far groups reach.

use super::{CsgOp, Geometry, GroupId, Object, Scene};
use crate::math::Bounds3;

impl Scene {
    /// A box around a group in its own space: empty where there is nothing in it, `None` where something in it has no end,
    /// or where there is no such group. Around what is turned it is the box around the turned box, which may be larger than
    /// need be; else it is tight. What moves counts where its motion begins.
    #[must_use]
    pub fn bounds(&self, group: GroupId) -> Option<Bounds3> {
        let mut known = Known {
            scene: self,
            meshes: vec![None; self.meshes.len()],
            groups: vec![None; self.groups.len()],
        };
        let placed = self.placed_by(group)?;
        for id in placed.into_iter().chain([group]) {
            let bounds = known.around(&self.groups.get(id.index())?.objects);
            *known.groups.get_mut(id.index())? = Some(bounds);
        }
        *known.groups.get(group.index())?.as_ref()?
    }
}

/// What was found out already.
struct Known<'s> {
    scene: &'s Scene,
    meshes: Vec<Option<Bounds3>>,
    /// `Some(None)` is a group without end.
    groups: Vec<Option<Option<Bounds3>>>,
}

impl Known<'_> {
    fn around(&mut self, objects: &[Object]) -> Option<Bounds3> {
        let mut all = Bounds3::EMPTY;
        for object in objects {
            all = all.union(&self.object(object)?);
        }
        Some(all)
    }

    fn object(&mut self, object: &Object) -> Option<Bounds3> {
        let scene = self.scene;
        let placing = scene.transforms.get(object.transform.index())?;
        let own = match &object.geometry {
            Geometry::Shape(shape) => return shape.bounds_under(placing),
            Geometry::Triangle(id) => {
                let corners = scene.triangles.get(id.index())?.positions;
                return Some(Bounds3::around(corners.map(|p| placing.transform_point3(p))));
            }
            Geometry::Mesh(id) => {
                let mesh = scene.meshes.get(id.index())?;
                *self
                    .meshes
                    .get_mut(id.index())?
                    .get_or_insert_with(|| mesh.bounds())
            }
            Geometry::Instance(id) | Geometry::Moving(id) => (*self.groups.get(id.index())?)??,
            Geometry::Csg(id, op) => self.solid(*id, *op)?,
        };
        Some(own.transformed(placing))
    }

    /// A box around what the parts in a group make together.
    fn solid(&mut self, id: GroupId, op: CsgOp) -> Option<Bounds3> {
        let parts = &self.scene.groups.get(id.index())?.objects;
        match op {
            CsgOp::Union => self.around(parts),
            CsgOp::Difference => self.object(parts.first()?),
            CsgOp::Intersection => parts
                .iter()
                .filter_map(|part| self.object(part))
                .reduce(|a, b| Bounds3::new(a.min.max(b.min), a.max.min(b.max))),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Builder,
        math::{Bounds3, DVec3},
        scene::ROOT_GROUP,
        shape::{Plane, Shape},
    };

    #[test]
    fn what_is_placed_counts_where_it_is_placed() {
        let mut b = Builder::new();
        let mark = b.begin_define("pair").unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.triangle([DVec3::X, DVec3::Y * 4.0, DVec3::NEG_Z], None)
            .unwrap();
        b.end_define(mark, true);
        let mark = b.begin_define("ground").unwrap();
        b.shape(Shape::Plane(Plane)).unwrap();
        b.end_define(mark, true);
        b.translate(DVec3::X * 10.0).unwrap();
        b.scale(DVec3::new(2.0, 1.0, 1.0)).unwrap();
        b.instance("pair").unwrap();
        let scene = b.finish().value;
        let bounds = |min, max| Some(Bounds3::new(min, max));
        assert_eq!(
            scene.bounds(scene.names["pair"]),
            bounds(DVec3::splat(-1.0), DVec3::new(1.0, 4.0, 1.0))
        );
        assert_eq!(
            scene.bounds(ROOT_GROUP),
            bounds(DVec3::new(8.0, -1.0, -1.0), DVec3::new(12.0, 4.0, 1.0))
        );
        assert_eq!(scene.bounds(scene.names["ground"]), None);
        assert!(
            Builder::new()
                .finish()
                .value
                .bounds(ROOT_GROUP)
                .unwrap()
                .is_empty()
        );
    }
}
