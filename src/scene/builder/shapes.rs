//! Materials, textures and shapes.

use std::sync::Arc;

use super::{Builder, SceneError, finite};
use crate::{
    math::DVec3,
    scene::{Geometry, Material, MaterialId, Mesh, MeshId, Texture, TextureId, Triangle, TriangleId},
    shape::{Shape, Sphere},
};

impl Builder {
    /// The current material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The current material, to be changed.
    pub fn material_mut(&mut self) -> &mut Material {
        self.material_id = None;
        &mut self.material
    }

    /// Sets the current material.
    pub fn set_material(&mut self, material: Material) {
        *self.material_mut() = material;
    }

    /// The handle of a material, the same for equal ones.
    ///
    /// ```
    /// use rtscript::{Builder, Term, scene::Texture, DVec3};
    /// let mut b = Builder::new();
    /// let floor = b.texture(&Texture::Checker { even: DVec3::ONE, odd: DVec3::ZERO, size: 1.0 }.into());
    /// assert!(matches!(b.texture_at(floor).map(|t| &**t), Some(Texture::Checker { .. })));
    /// // Two materials that are equal are one.
    /// let mut matt = b.material_mut().clone();
    /// matt.diffuse = Term { color: DVec3::ONE, texture: Some(floor) };
    /// let first = b.material_id(&matt);
    /// assert_eq!(first, b.material_id(&matt.clone()));
    /// ```
    pub fn material_id(&mut self, material: &Material) -> MaterialId {
        let materials = &mut self.scene.materials;
        *self.material_ids.entry(material.key()).or_insert_with(|| {
            materials.push(material.clone());
            MaterialId(materials.len() as u32 - 1)
        })
    }

    /// The texture behind a handle.
    #[must_use]
    pub fn texture_at(&self, id: TextureId) -> Option<&Arc<Texture>> {
        self.scene.textures.get(id.index())
    }

    /// Whether any term of the current material shows the colors of vertices.
    pub(crate) fn shows_vertex_colors(&self) -> bool {
        let Material {
            ambient,
            emission,
            diffuse,
            specular,
            shininess: _,
            reflection,
            transmission,
            ior: _,
            reflectance: _,
            finish,
        } = &self.material;
        let terms = [ambient, emission, diffuse, specular, transmission].map(|term| term.texture);
        let reflection = reflection.as_ref().and_then(|term| term.texture);
        let finish = finish
            .iter()
            .flat_map(|finish| finish.textures())
            .map(|(_, id)| id);
        let all = terms.into_iter().chain([reflection]).chain(finish).flatten();
        all.filter_map(|id| self.texture_at(id))
            .any(|texture| texture.shows_vertex_colors())
    }

    /// Adds a texture, to be named in a [`Term`](crate::scene::Term). The same `Arc` twice gives the same handle. Pictures
    /// that it is made of are added before it.
    pub fn texture(&mut self, texture: &Arc<Texture>) -> TextureId {
        for part in texture.parts() {
            if !part.parts().is_empty() || matches!(**part, Texture::Image(_)) {
                self.texture(part);
            }
        }
        let textures = &mut self.scene.textures;
        let index = textures
            .iter()
            .position(|t| Arc::ptr_eq(t, texture))
            .unwrap_or_else(|| {
                textures.push(Arc::clone(texture));
                textures.len() - 1
            });
        TextureId(index as u32)
    }

    /// A shape under the current matrix in the current material.
    ///
    /// # Errors
    /// Where the current matrix is singular, or the limit `primitives` is passed.
    #[inline(always)]
    pub fn shape(&mut self, shape: Shape) -> Result<(), SceneError> {
        self.require_invertible("a", shape.name())?;
        let pieces = shape.pieces();
        self.add(Geometry::Shape(shape), pieces)
    }

    /// A sphere.
    ///
    /// # Errors
    /// As [`Sphere::new`] and [`Builder::shape`].
    #[inline(always)]
    pub fn sphere(&mut self, center: DVec3, radius: f64) -> Result<(), SceneError> {
        self.shape(Shape::Sphere(Sphere::new(center, radius)?))
    }

    /// A triangle, smooth where it has normals. It may lie flat under a singular matrix.
    ///
    /// # Errors
    /// Where a number is not finite, a normal is zero, or the limit `primitives` is passed.
    pub fn triangle(&mut self, positions: [DVec3; 3], normals: Option<[DVec3; 3]>) -> Result<(), SceneError> {
        for p in positions {
            finite("a corner of the triangle", p)?;
        }
        for n in normals.into_iter().flatten() {
            if finite("a normal of the triangle", n)? == DVec3::ZERO {
                return Err(SceneError::new("a normal of the triangle is zero"));
            }
        }
        let id = TriangleId(self.scene.triangles.len() as u32);
        self.scene.triangles.push(Triangle { positions, normals });
        self.add(Geometry::Triangle(id), 1)
    }

    /// A mesh. The same `Arc` twice shares its memory and its acceleration structure.
    ///
    /// # Errors
    /// Where the limit `primitives` is passed.
    pub fn mesh(&mut self, mesh: &Arc<Mesh>) -> Result<(), SceneError> {
        let known = self.scene.meshes.iter().position(|m| Arc::ptr_eq(m, mesh));
        let index = known.unwrap_or_else(|| {
            self.scene.meshes.push(Arc::clone(mesh));
            self.scene.meshes.len() - 1
        });
        self.add(
            Geometry::Mesh(MeshId(index as u32)),
            if known.is_some() { 1 } else { mesh.triangles.len() },
        )
    }
}
