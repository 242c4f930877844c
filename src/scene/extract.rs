//! One group of a scene as a scene of its own.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

use super::{
    Geometry, Group, GroupId, MaterialId, MeshId, Object, ROOT_GROUP, Scene, TransformId, TriangleId,
};

impl Scene {
    /// A scene in which `group` is what is seen, in its own space, with all that it places; settings and camera are those
    /// of the whole. Textures, and what files hold of meshes, are shared. `None` where there is no such group.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// let mark = b.begin_define("pair")?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.sphere(DVec3::Y, 0.5)?;
    /// b.end_define(mark, true);
    /// let pair = b.group_called("pair")?;
    /// b.translate(DVec3::X * 10.0)?;
    /// b.instance("pair")?;
    /// let scene = b.finish().value;
    /// // The scene has one thing, the definition in its own space two.
    /// let alone = scene.extract(pair).expect("the group is there");
    /// assert_eq!((scene.root().objects.len(), alone.root().objects.len()), (1, 2));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn extract(&self, group: GroupId) -> Option<Self> {
        let mut extracted = Self {
            settings: self.settings.clone(),
            camera: self.camera,
            groups: vec![Group::default()],
            materials: Vec::new(),
            transforms: self.transforms.get(..1)?.to_vec(),
            textures: self.textures.clone(),
            meshes: Vec::new(),
            triangles: Vec::new(),
            files: self.files.clone(),
            names: BTreeMap::new(),
        };
        let mut copier = Copier {
            of: self,
            to: &mut extracted,
            groups: HashMap::new(),
            materials: HashMap::new(),
            transforms: HashMap::from([(TransformId::IDENTITY, TransformId::IDENTITY)]),
            meshes: HashMap::new(),
        };
        for id in self.placed_by(group)? {
            let group = copier.copy(id)?;
            copier.add(id, group);
        }
        let root = copier.copy(group)?;
        *extracted.groups.get_mut(ROOT_GROUP.index())? = root;
        Some(extracted)
    }

    /// The groups that a group places or puts together, directly or by another, those first that are placed by others.
    pub(super) fn placed_by(&self, group: GroupId) -> Option<BTreeSet<GroupId>> {
        let mut placed = BTreeSet::new();
        let mut waiting = vec![group];
        while let Some(id) = waiting.pop() {
            for object in &self.groups.get(id.index())?.objects {
                if let Some(inner) = object.geometry.group()
                    && placed.insert(inner)
                {
                    waiting.push(inner);
                }
            }
        }
        Some(placed)
    }
}

/// Copies what is reached, each thing once.
struct Copier<'s, 't> {
    of: &'s Scene,
    to: &'t mut Scene,
    groups: HashMap<GroupId, GroupId>,
    materials: HashMap<MaterialId, MaterialId>,
    transforms: HashMap<TransformId, TransformId>,
    meshes: HashMap<MeshId, MeshId>,
}

impl Copier<'_, '_> {
    fn copy(&mut self, id: GroupId) -> Option<Group> {
        let scene = self.of;
        let group = scene.groups.get(id.index())?;
        let mut objects = Vec::with_capacity(group.objects.len());
        for object in &group.objects {
            objects.push(self.object(object)?);
        }
        Some(Group {
            name: group.name.clone(),
            objects,
            lights: group.lights.clone(),
            loc: group.loc,
            csg: group.csg,
            motion: group.motion,
        })
    }

    fn object(&mut self, object: &Object) -> Option<Object> {
        let scene = self.of;
        let geometry = match &object.geometry {
            Geometry::Shape(shape) => Geometry::Shape(shape.clone()),
            Geometry::Triangle(id) => {
                let triangle = scene.triangles.get(id.index())?.clone();
                self.to.triangles.push(triangle);
                Geometry::Triangle(TriangleId(self.to.triangles.len() as u32 - 1))
            }
            Geometry::Mesh(id) => Geometry::Mesh(self.mesh(*id)?),
            Geometry::Instance(id) => Geometry::Instance(*self.groups.get(id)?),
            Geometry::Csg(id, op) => Geometry::Csg(*self.groups.get(id)?, *op),
            Geometry::Moving(id) => Geometry::Moving(*self.groups.get(id)?),
        };
        Some(Object {
            geometry,
            transform: self.transform(object.transform)?,
            material: self.material(object.material)?,
            loc: object.loc,
        })
    }

    fn add(&mut self, id: GroupId, group: Group) {
        let new = GroupId(self.to.groups.len() as u32);
        if !group.name.is_empty() {
            self.to.names.insert(group.name.clone(), new);
        }
        self.to.groups.push(group);
        self.groups.insert(id, new);
    }

    fn transform(&mut self, id: TransformId) -> Option<TransformId> {
        if let Some(known) = self.transforms.get(&id) {
            return Some(*known);
        }
        self.to.transforms.push(*self.of.transforms.get(id.index())?);
        let new = TransformId(self.to.transforms.len() as u32 - 1);
        self.transforms.insert(id, new);
        Some(new)
    }

    fn material(&mut self, id: MaterialId) -> Option<MaterialId> {
        if id == MaterialId::INHERIT {
            return Some(id);
        }
        if let Some(known) = self.materials.get(&id) {
            return Some(*known);
        }
        let material = self.of.materials.get(id.index())?.clone();
        self.to.materials.push(material);
        let new = MaterialId(self.to.materials.len() as u32 - 1);
        self.materials.insert(id, new);
        Some(new)
    }

    /// Faces with materials of their own keep them: those are numbers in the whole scene's list, so the mesh is copied.
    fn mesh(&mut self, id: MeshId) -> Option<MeshId> {
        if let Some(known) = self.meshes.get(&id) {
            return Some(*known);
        }
        let mut mesh = self.of.meshes.get(id.index())?.clone();
        if !mesh.face_materials.is_empty() {
            let mut own = (*mesh).clone();
            for material in &mut own.face_materials {
                *material = self.material(*material)?;
            }
            mesh = Arc::new(own);
        }
        self.to.meshes.push(mesh);
        let new = MeshId(self.to.meshes.len() as u32 - 1);
        self.meshes.insert(id, new);
        Some(new)
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Builder,
        math::{DVec3, Ray},
        render::Compiled,
        scene::{Geometry, GroupId},
    };

    #[test]
    fn what_a_group_places_comes_along_and_nothing_else() {
        let mut b = Builder::new();
        let mark = b.begin_define("unused").unwrap();
        b.sphere(DVec3::ZERO, 9.0).unwrap();
        b.end_define(mark, true);
        let mark = b.begin_define("ball").unwrap();
        b.translate(DVec3::X).unwrap();
        b.triangle([DVec3::ZERO, DVec3::Y, DVec3::Z], None).unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.end_define(mark, true);
        let mark = b.begin_define("pair").unwrap();
        b.instance("ball").unwrap();
        b.translate(DVec3::Y * 5.0).unwrap();
        b.instance("ball").unwrap();
        b.end_define(mark, true);
        b.triangle([DVec3::ZERO, DVec3::Y, DVec3::Z], None).unwrap();
        let scene = b.finish().value;
        let pair = scene.extract(scene.names["pair"]).unwrap();
        assert_eq!(pair.groups.len(), 2);
        assert_eq!((pair.triangles.len(), pair.transforms.len()), (1, 3));
        assert!(matches!(
            pair.root().objects[0].geometry,
            Geometry::Instance(GroupId(1))
        ));
        let compiled = Compiled::new(pair).unwrap();
        let ray = Ray::new(DVec3::new(1.5, 20.0, 0.0), DVec3::NEG_Y);
        let hit = compiled.world().raycast(&ray, f64::INFINITY).unwrap();
        assert!((hit.t - (15.0 - 0.75f64.sqrt())).abs() < 1e-12);
        assert!(scene.extract(GroupId(99)).is_none());
    }
}
