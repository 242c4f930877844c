//! Lights that are surfaces: soft shadows.

use std::sync::Arc;

use super::{Attenuation, parts::LightVector};
use crate::{
    math::{DAffine3, DMat3, DVec3, brief, max_abs},
    scene::SceneError,
};

/// How light fades on its way from the points of a [`SurfaceLight`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// Each point shines alike in all directions, as those of [`LightKind::Area`](super::LightKind::Area), and fades by
    /// the formula.
    Attenuation(Attenuation),
    /// The surface shines as a real one does that is equally bright from all sides (Lambert): what arrives is the cosine
    /// at the light over the squared distance, in world units, and only the front shines. The color is what arrives at
    /// distance 1 where the whole light were gathered in one point and seen straight on.
    Physical,
}

/// What shines, in a space of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum LightForm {
    /// The square between (0, 0, 0) and (1, 1, 0).
    Rectangle,
    /// The disk of radius 1 around the origin in z = 0.
    Disk,
    /// The sphere of radius 1 around the origin. The points that are asked lie in the part of it that is seen.
    Sphere,
    /// Triangles.
    Mesh(Arc<LightMesh>),
}

/// Triangles that shine.
#[derive(Clone, Debug, PartialEq)]
pub struct LightMesh {
    triangles: Vec<[DVec3; 3]>,
}

impl LightMesh {
    /// Triangles by their corners, counter-clockwise seen from the front.
    ///
    /// # Errors
    /// Where there are none, all of them are without area, or a number is not finite.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Result<Self, SceneError> {
        let corners = triangles.as_flattened().iter();
        if let Some(p) = { corners }.find(|p| !p.is_finite() || max_abs(**p) > 1e15) {
            return Err(SceneError::new(format!(
                "the corners of a shining mesh must be finite numbers within 1e15, not {}",
                brief(*p)
            )));
        }
        let has_area = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a) != DVec3::ZERO;
        if !triangles.iter().any(has_area) {
            return Err(SceneError::new("a shining mesh needs a triangle with an area"));
        }
        Ok(Self { triangles })
    }

    /// Corners of the triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }
}

/// A surface that shines. It is asked for light in `n` x `n` strata, in each of which there is one jittered point, and it
/// is not seen itself. It stands under any matrix.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Falloff, LightForm, LightMesh, SurfaceLight}};
/// let lamp = SurfaceLight::disk(DVec3::Y * 3.0, DVec3::NEG_Y, 0.5, 16, Falloff::Physical)?;
/// assert_eq!((lamp.form(), lamp.n()), (&LightForm::Disk, 16));
/// let card = LightMesh::new(vec![[DVec3::ZERO, DVec3::Z, DVec3::X]])?;
/// let sign = SurfaceLight::mesh(card.into(), 16, Falloff::Physical)?;
/// let mut b = Builder::new();
/// b.surface_light(lamp, DVec3::splat(10.0))?;
/// b.surface_light(sign, DVec3::splat(2.0))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceLight {
    form: LightForm,
    placing: DAffine3,
    n: u32,
    falloff: Falloff,
}

impl SurfaceLight {
    /// Most points along an edge of the grid.
    pub const MOST: u32 = 256;

    fn new(form: LightForm, placing: DAffine3, n: u32, falloff: Falloff) -> Result<Self, SceneError> {
        if !(1..=Self::MOST).contains(&n) {
            return Err(SceneError::new(format!(
                "a soft light has a grid of 1 to {} points along each edge, not {n}",
                Self::MOST
            ))
            .hint("4 takes 16 points"));
        }
        let columns = [
            placing.matrix3.x_axis,
            placing.matrix3.y_axis,
            placing.matrix3.z_axis,
            placing.translation,
        ];
        if columns.iter().any(|v| !v.is_finite() || max_abs(*v) > 1e15) {
            return Err(SceneError::new(
                "a light's place and size must be finite numbers within 1e15",
            ));
        }
        Ok(Self {
            form,
            placing: without_negative_zeros(placing),
            n,
            falloff,
        })
    }

    /// A parallelogram whose front is where its edges turn counter-clockwise.
    ///
    /// # Errors
    /// Where a number is not finite, or `n` is not in 1..=256.
    pub fn rectangle(
        corner: DVec3,
        [edge1, edge2]: [DVec3; 2],
        n: u32,
        falloff: Falloff,
    ) -> Result<Self, SceneError> {
        let front = edge1.cross(edge2);
        let length = front.length();
        let front = if length > 0.0 { front / length } else { DVec3::Z };
        let linear = DMat3::from_cols(edge1, edge2, front);
        let placing = DAffine3::from_mat3_translation(linear, corner);
        Self::new(LightForm::Rectangle, placing, n, falloff)
    }

    /// A disk, its front being where `normal` points.
    ///
    /// # Errors
    /// Where the normal is zero, the radius is not greater than 0, a number is not finite, or `n` is not in 1..=256.
    pub fn disk(
        center: DVec3,
        normal: DVec3,
        radius: f64,
        n: u32,
        falloff: Falloff,
    ) -> Result<Self, SceneError> {
        let length = normal.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(SceneError::new(format!(
                "a disk light's normal must be a direction, not {}",
                brief(normal)
            ))
            .hint("it points to where the light shines: [0, -1, 0] for a lamp on the ceiling"));
        }
        let radius = checked_radius("a disk light", radius)?;
        let z = normal / length;
        let (x, y) = around(z);
        let linear = DMat3::from_cols(x * radius, y * radius, z);
        Self::new(
            LightForm::Disk,
            DAffine3::from_mat3_translation(linear, center),
            n,
            falloff,
        )
    }

    /// A sphere.
    ///
    /// # Errors
    /// Where the radius is not greater than 0, a number is not finite, or `n` is not in 1..=256.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::{Falloff, SurfaceLight}};
    /// let bulb = SurfaceLight::sphere(DVec3::Y * 2.0, 0.1, 8, Falloff::Physical)?;
    /// assert_eq!(bulb.falloff(), &Falloff::Physical);
    /// // A unit sphere, made small and moved to its place.
    /// assert_eq!(bulb.placing().transform_point3(DVec3::Y), DVec3::Y * 2.1);
    /// let [right, down] = [DVec3::X, DVec3::NEG_Y];
    /// let window = SurfaceLight::rectangle(DVec3::new(-0.5, 2.0, 0.0), [right, down], 8, Falloff::Physical)?;
    /// assert_eq!(window.placing().transform_point3(DVec3::X), DVec3::new(0.5, 2.0, 0.0));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn sphere(center: DVec3, radius: f64, n: u32, falloff: Falloff) -> Result<Self, SceneError> {
        let radius = checked_radius("a sphere light", radius)?;
        let linear = DMat3::from_diagonal(DVec3::splat(radius));
        Self::new(
            LightForm::Sphere,
            DAffine3::from_mat3_translation(linear, center),
            n,
            falloff,
        )
    }

    /// A mesh, each part of it as bright as its area is large.
    ///
    /// # Errors
    /// Where `n` is not in 1..=256.
    pub fn mesh(mesh: Arc<LightMesh>, n: u32, falloff: Falloff) -> Result<Self, SceneError> {
        Self::new(LightForm::Mesh(mesh), DAffine3::IDENTITY, n, falloff)
    }

    /// What shines.
    #[must_use]
    pub fn form(&self) -> &LightForm {
        &self.form
    }

    /// Where it is: world (or group) from its own space.
    #[must_use]
    pub fn placing(&self) -> &DAffine3 {
        &self.placing
    }

    /// Points along each edge of the grid.
    #[must_use]
    pub fn n(&self) -> u32 {
        self.n
    }

    /// How its light fades.
    #[must_use]
    pub fn falloff(&self) -> &Falloff {
        &self.falloff
    }

    /// The same without its place.
    pub(in crate::scene) fn unplaced(&self) -> Self {
        Self {
            placing: DAffine3::IDENTITY,
            ..self.clone()
        }
    }

    pub(super) fn placed(&self, m: &DAffine3) -> Option<Self> {
        let placing = without_negative_zeros(*m * self.placing);
        let is_flat = matches!(self.form, LightForm::Sphere) && crate::math::is_singular(&placing.matrix3);
        (!is_flat).then(|| Self {
            placing,
            ..self.clone()
        })
    }

    pub(super) fn word(&self) -> &'static str {
        match self.form {
            LightForm::Rectangle => "rectangle",
            LightForm::Disk => "disk",
            LightForm::Sphere => "sphere",
            LightForm::Mesh(_) => "mesh",
        }
    }

    pub(super) fn name(&self) -> &'static str {
        match self.form {
            LightForm::Rectangle => "areaLight",
            LightForm::Disk => "diskLight",
            LightForm::Sphere => "sphereLight",
            LightForm::Mesh(_) => "meshLight",
        }
    }

    pub(super) fn center(&self) -> DVec3 {
        let local = match &self.form {
            LightForm::Rectangle => DVec3::new(0.5, 0.5, 0.0),
            LightForm::Disk | LightForm::Sphere => DVec3::ZERO,
            LightForm::Mesh(mesh) => {
                crate::math::Bounds3::around(mesh.triangles.as_flattened().iter().copied()).center()
            }
        };
        self.placing.transform_point3(local)
    }

    pub(super) fn attenuation(&self) -> Option<&Attenuation> {
        match &self.falloff {
            Falloff::Attenuation(attenuation) => Some(attenuation),
            Falloff::Physical => None,
        }
    }

    pub(super) fn vectors(&self) -> Vec<LightVector> {
        let m = &self.placing.matrix3;
        let mut vectors = vec![LightVector::point("place", self.placing.translation)];
        let axes = [("x axis", m.x_axis), ("y axis", m.y_axis), ("z axis", m.z_axis)];
        vectors.extend(axes.map(|(name, value)| LightVector::vector(name, value)));
        vectors
    }

    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        let physical = if self.falloff == Falloff::Physical {
            1.0
        } else {
            0.0
        };
        let mut numbers = vec![("points per edge", f64::from(self.n)), ("physical", physical)];
        if let LightForm::Mesh(mesh) = &self.form {
            numbers.push(("triangles", mesh.triangles.len() as f64));
        }
        numbers
    }
}

fn checked_radius(what: &str, radius: f64) -> Result<f64, SceneError> {
    if radius > 0.0 && radius <= 1e15 {
        return Ok(radius);
    }
    Err(SceneError::new(format!(
        "{what}'s radius must be greater than 0 and at most 1e15, not {radius}"
    )))
}

/// No matrix that a script can write would give them back.
fn without_negative_zeros(m: DAffine3) -> DAffine3 {
    let linear = DMat3::from_cols(
        m.matrix3.x_axis + DVec3::ZERO,
        m.matrix3.y_axis + DVec3::ZERO,
        m.matrix3.z_axis + DVec3::ZERO,
    );
    DAffine3::from_mat3_translation(linear, m.translation + DVec3::ZERO)
}

/// Two unit vectors that make a right-handed frame with the unit vector `z` (Duff et al., "Building an orthonormal
/// basis, revisited", 2017).
pub(crate) fn around(z: DVec3) -> (DVec3, DVec3) {
    let sign = if z.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    (
        DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
        DVec3::new(b, sign + z.y * z.y * a, -z.y),
    )
}
