//! Triangle meshes.

use std::fmt;

use crate::{
    color::Color,
    math::{Bounds3, DVec2, DVec3, max_abs},
    scene::{MaterialId, SceneError},
};

/// Values at the corners of a mesh's triangles, with indices of their own as in an OBJ file.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute<T> {
    /// The values.
    pub values: Vec<T>,
    /// For each triangle the values at its corners; [`Attribute::NONE`] where a corner has none.
    pub indices: Vec<[u32; 3]>,
}

impl<T: Copy> Attribute<T> {
    /// The index of a corner without a value.
    pub const NONE: u32 = u32::MAX;

    /// The values at the corners of triangle `face`; `None` where any corner has none.
    #[must_use]
    pub fn corners(&self, face: usize) -> Option<[T; 3]> {
        let [a, b, c] = *self.indices.get(face)?;
        let value = |i: u32| self.values.get(i as usize).copied();
        Some([value(a)?, value(b)?, value(c)?])
    }
}

/// A triangle mesh in its object space.
///
/// ```
/// use rtscript::{Builder, DVec3, math::DVec2, scene::{Attribute, Mesh}};
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// let mut mesh = Mesh::new("card", corners, vec![[0, 1, 2]])?;
/// mesh.uvs = Some(Attribute { values: vec![DVec2::ZERO, DVec2::X, DVec2::Y], indices: vec![[0, 1, 2]] });
/// assert_eq!(mesh.corners(0), [DVec3::ZERO, DVec3::X, DVec3::Y]);
/// assert_eq!(mesh.bounds().size(), DVec3::new(1.0, 1.0, 0.0));
/// let mut b = Builder::new();
/// b.mesh(&mesh.into())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Where it came from, for people.
    pub name: String,
    /// Vertices.
    pub positions: Vec<DVec3>,
    /// Corners of each triangle as indices into `positions`; counter-clockwise is the front.
    pub triangles: Vec<[u32; 3]>,
    /// Normals at the corners, not necessarily unit vectors. A mesh without them is flat.
    pub normals: Option<Attribute<DVec3>>,
    /// Texture coordinates at the corners.
    pub uvs: Option<Attribute<DVec2>>,
    /// Scene-linear colors at the corners, which [`Texture::VertexColors`](super::Texture::VertexColors) shows.
    pub colors: Option<Attribute<Color>>,
    /// Material of each triangle, or empty where all look as the object that places the mesh.
    pub face_materials: Vec<MaterialId>,
}

impl Mesh {
    /// Whether a vertex may have this color.
    ///
    /// # Errors
    /// Where it is negative, not finite or beyond 1e15; the message says of `what`.
    pub(crate) fn check_color(color: Color, what: fmt::Arguments<'_>) -> Result<(), SceneError> {
        if color.is_finite() && color.min_element() >= 0.0 && max_abs(color) <= 1e15 {
            return Ok(());
        }
        Err(SceneError::new(format!(
            "{what} must be finite numbers from 0 to 1e15, not {color}"
        )))
    }

    /// A mesh of positions and triangles, checked. Attributes may be set afterwards.
    ///
    /// # Errors
    /// Where an index is out of range, or a coordinate is not finite or beyond 1e15.
    pub fn new(name: &str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, SceneError> {
        if let Some(i) = positions
            .iter()
            .position(|p| !(crate::math::max_abs(*p) <= 1e15 && p.is_finite()))
        {
            return Err(SceneError::new(format!(
                "position {i} of the mesh is not a finite point within 1e15 of the origin"
            )));
        }
        let count = positions.len();
        let outside = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= count);
        if let Some((i, triangle)) = triangles.iter().enumerate().find(|(_, t)| outside(t)) {
            return Err(SceneError::new(format!(
                "triangle {i} of the mesh has the vertex {}, but there are {count} vertices, counted from 0",
                triangle.iter().max().copied().unwrap_or(0)
            )));
        }
        Ok(Self {
            name: name.to_owned(),
            positions,
            triangles,
            normals: None,
            uvs: None,
            colors: None,
            face_materials: Vec::new(),
        })
    }

    /// The corners of triangle `face`.
    ///
    /// # Panics
    /// Where there is no such triangle.
    #[must_use]
    #[allow(clippy::indexing_slicing, reason = "[`Mesh::new`] checks every index")]
    pub fn corners(&self, face: usize) -> [DVec3; 3] {
        self.triangles[face].map(|i| self.positions[i as usize])
    }

    /// Smallest box around all vertices.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3::around(self.positions.iter().copied())
    }
}
