//! Which primitives of a level may let light through.

use super::{
    super::level::{Level, TriangleSource},
    Compiler,
};
use crate::scene::MaterialId;

impl Compiler<'_, '_> {
    /// See [`Level::transparent`]. A shared mesh takes the material of whoever places it, so it may be
    /// transparent as soon as anything is.
    pub(super) fn transparency(&self, level: &Level) -> Vec<u64> {
        let transparent: Vec<bool> = self.scene.materials.iter().map(|m| !m.is_opaque()).collect();
        if !transparent.contains(&true) {
            return Vec::new();
        }
        let objects = level
            .group
            .map_or(&[][..], |id| &self.scene.groups[id.index()].objects);
        let of_object = |object: u32| match objects.get(object as usize) {
            Some(object) => transparent.get(object.material.index()).copied().unwrap_or(true),
            None => true,
        };
        let mut bits = vec![0u64; level.primitives().div_ceil(64)];
        let mut mark = |index: usize| bits[index / 64] |= 1 << (index % 64);
        for (i, run) in level.runs.iter().enumerate() {
            let end = level
                .runs
                .get(i + 1)
                .map_or(level.triangles.len(), |next| next.first as usize);
            let inherited = of_object(run.object);
            let own = match run.source {
                TriangleSource::Mesh(id) => &self.scene.meshes[id.index()].face_materials[..],
                TriangleSource::Single(_) => &[],
            };
            for index in run.first as usize..end {
                let material = own
                    .get(index - run.first as usize)
                    .copied()
                    .unwrap_or(MaterialId::INHERIT);
                if transparent.get(material.index()).copied().unwrap_or(inherited) {
                    mark(index);
                }
            }
        }
        for (index, sphere) in level.spheres.iter().enumerate() {
            if of_object(sphere.object) {
                mark(level.triangles.len() + index);
            }
        }
        for (index, placed) in level.shapes.iter().enumerate() {
            if of_object(placed.object) {
                mark(level.triangles.len() + level.spheres.len() + index);
            }
        }
        bits
    }
}
