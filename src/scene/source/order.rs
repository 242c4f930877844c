//! The order in which a scene was built, as far as its handles tell.
//!
//! Handles count up in the order in which things are first used. A text that uses them in that order gives every
//! handle its number again, and with it the scene its hash.

use crate::scene::{Geometry, Group, GroupId, MeshId, Object, Scene, TransformId};

/// Handles of one kind.
struct Handles {
    /// For each handle how many that are used stand before it.
    ranks: Vec<u32>,
    /// How many were used so far.
    seen: u32,
}

impl Handles {
    fn new(count: usize, used: impl Iterator<Item = usize>) -> Self {
        let mut is_used = vec![false; count];
        for i in used {
            if let Some(used) = is_used.get_mut(i) {
                *used = true;
            }
        }
        let mut before = 0;
        let ranks = is_used.iter().map(|used| {
            let rank = before;
            before += u32::from(*used);
            rank
        });
        Self {
            ranks: ranks.collect(),
            seen: 0,
        }
    }

    fn rank(&self, i: usize) -> u32 {
        self.ranks.get(i).copied().unwrap_or(0)
    }

    /// True where the handle is known already, or is the next one.
    fn has_come(&self, i: usize) -> bool {
        self.rank(i) <= self.seen
    }

    fn see(&mut self, i: usize) {
        self.seen = self.seen.max(self.rank(i) + 1);
    }
}

/// What was written so far, by handles.
pub(super) struct Order {
    transforms: Handles,
    triangles: Handles,
    materials: Handles,
    meshes: Handles,
    /// The first group that is not written yet.
    pub(super) next_group: usize,
}

impl Order {
    pub(super) fn new(scene: &Scene) -> Self {
        let objects = || scene.groups.iter().flat_map(|group| &group.objects);
        let of_faces = scene.meshes.iter().flat_map(|mesh| &mesh.face_materials);
        let materials = objects().map(|o| o.material.index()).chain(
            of_faces
                .map(|id| id.index())
                .filter(|i| *i < scene.materials.len()),
        );
        let triangles = objects().filter_map(|o| match o.geometry {
            Geometry::Triangle(id) => Some(id.index()),
            _ => None,
        });
        let meshes = objects().filter_map(|o| match o.geometry {
            Geometry::Mesh(id) => Some(id.index()),
            _ => None,
        });
        let mut transforms = Handles::new(
            scene.transforms.len(),
            objects()
                .map(|o| o.transform.index())
                .chain([TransformId::IDENTITY.index()]),
        );
        transforms.see(TransformId::IDENTITY.index());
        Self {
            transforms,
            triangles: Handles::new(scene.triangles.len(), triangles),
            materials: Handles::new(scene.materials.len(), materials),
            meshes: Handles::new(scene.meshes.len(), meshes),
            next_group: 1,
        }
    }

    /// True where nothing that is not written yet can have come before the object.
    pub(super) fn has_come(&self, scene: &Scene, object: &Object) -> bool {
        let geometry = match object.geometry {
            // Its parts are written in its place.
            Geometry::Csg(id, _) | Geometry::Moving(id) => {
                let first = scene
                    .groups
                    .get(id.index())
                    .and_then(|group| group.objects.first());
                return first.is_none_or(|first| self.has_come(scene, first));
            }
            Geometry::Shape(_) => true,
            Geometry::Triangle(id) => self.triangles.has_come(id.index()),
            Geometry::Mesh(id) => self.meshes.has_come(id.index()),
            Geometry::Instance(id) => id.index() < self.next_group,
        };
        geometry
            && self.transforms.has_come(object.transform.index())
            && (self.materials.has_come(object.material.index()) || self.brings_materials(scene, object))
    }

    /// The file of a mesh brings materials of its own, which come before that of the object.
    fn brings_materials(&self, scene: &Scene, object: &Object) -> bool {
        let Geometry::Mesh(id) = object.geometry else {
            return false;
        };
        let mesh = scene.meshes.get(id.index());
        let has_materials = mesh.is_some_and(|mesh| !mesh.face_materials.is_empty());
        has_materials && self.is_new_mesh(id)
    }

    /// True where no object before was made of the mesh.
    pub(super) fn is_new_mesh(&self, id: MeshId) -> bool {
        self.meshes.rank(id.index()) >= self.meshes.seen
    }

    /// Notes that the object was written.
    pub(super) fn see(&mut self, scene: &Scene, object: &Object) {
        match object.geometry {
            Geometry::Triangle(id) => self.triangles.see(id.index()),
            Geometry::Mesh(id) if self.is_new_mesh(id) => {
                self.meshes.see(id.index());
                let mesh = scene.meshes.get(id.index());
                for material in mesh.iter().flat_map(|mesh| &mesh.face_materials) {
                    if material.index() < scene.materials.len() {
                        self.materials.see(material.index());
                    }
                }
            }
            Geometry::Shape(_)
            | Geometry::Mesh(_)
            | Geometry::Instance(_)
            | Geometry::Csg(..)
            | Geometry::Moving(_) => {}
        }
        self.transforms.see(object.transform.index());
        self.materials.see(object.material.index());
    }

    /// The group to be written next, of those before `bound`: the first whose own objects can come now. Those before
    /// it are written inside it.
    pub(super) fn next_define(&self, scene: &Scene, bound: usize) -> usize {
        let can_come = |id: &usize| {
            let first = scene.groups.get(*id).and_then(|group| group.objects.first());
            first.is_none_or(|object| self.has_come(scene, object))
        };
        // The parts of a solid are written where it stands, and so is what moves.
        let is_defined = |id: &usize| scene.groups.get(*id).is_none_or(|group| !group.is_in_place());
        let defined = || (self.next_group..bound).filter(is_defined);
        defined()
            .find(can_come)
            .or_else(|| defined().next())
            .unwrap_or(self.next_group)
    }
}

/// For each object of a group the next one under the same matrix.
pub(super) fn next_uses(group: &Group, latest: &mut [u32]) -> Vec<u32> {
    let mut next = vec![NEVER; group.objects.len()];
    for (i, (object, next)) in group.objects.iter().zip(&mut next).enumerate().rev() {
        if let Some(latest) = latest.get_mut(object.transform.index()) {
            *next = *latest;
            *latest = i as u32;
        }
    }
    for object in &group.objects {
        if let Some(latest) = latest.get_mut(object.transform.index()) {
            *latest = NEVER;
        }
    }
    next
}

/// In [`next_uses`]: none uses it.
pub(super) const NEVER: u32 = u32::MAX;

/// Names of the groups, each different: what `define` called them, with a number where the name was given before.
pub(in crate::scene) fn names(scene: &Scene) -> Vec<String> {
    let mut taken = std::collections::BTreeSet::new();
    let named = scene.groups.iter().map(|group| {
        let mut name = group.name.clone();
        let mut number = 2;
        while !taken.insert(name.clone()) {
            name = format!("{} ({number})", group.name);
            number += 1;
        }
        name
    });
    named.collect()
}

/// The lights of a group that it has from its own calls, in parts: those before the first object that brings lights
/// with it, those between it and the second, and so on. An instance brings those of its group, one after the other.
pub(in crate::scene) fn own_lights(scene: &Scene, group: &Group) -> Vec<std::ops::Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    for object in &group.objects {
        let Some(brought) = brought(scene, object) else {
            continue;
        };
        let m = scene.world_from_object(object);
        let is_here = |at: &usize| {
            let placed = group.lights.get(*at..at + brought.len());
            placed.is_some_and(|placed| {
                placed.iter().zip(brought).all(|(placed, light)| {
                    placed.color == light.color
                        && placed.links == light.links
                        && light.kind.placed(&m).as_ref() == Some(&placed.kind)
                })
            })
        };
        // Taking the first that fits leaves the most for those that follow.
        let at = (start..group.lights.len()).find(is_here).unwrap_or(start);
        parts.push(start..at);
        start = (at + brought.len()).min(group.lights.len());
    }
    parts.push(start..group.lights.len());
    parts
}

/// The lights that an instance brings with it.
pub(super) fn brought<'a>(scene: &'a Scene, object: &Object) -> Option<&'a [crate::scene::Light]> {
    let Geometry::Instance(GroupId(id)) = object.geometry else {
        return None;
    };
    let lights = &scene.groups.get(id as usize)?.lights;
    (!lights.is_empty()).then_some(lights)
}
