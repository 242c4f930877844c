//! Lights as lists of vectors and numbers: what a hash, a dump and a comparison say of all kinds alike.

use super::{Attenuation, LightForm, LightKind};
use crate::math::{DAffine3, DVec3};

/// A point or a vector of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightVector {
    /// What it is.
    pub(crate) name: &'static str,
    /// Its value.
    pub(crate) value: DVec3,
    /// Matrices move it, not only turn it.
    pub(crate) is_point: bool,
}

impl LightVector {
    pub(super) fn point(name: &'static str, value: DVec3) -> Self {
        Self {
            name,
            value,
            is_point: true,
        }
    }

    pub(super) fn vector(name: &'static str, value: DVec3) -> Self {
        Self {
            name,
            value,
            is_point: false,
        }
    }
}

/// A point under a matrix, without negative zeros: no matrix that a script can write would give them back.
pub(super) fn placed_point(m: &DAffine3, p: DVec3) -> DVec3 {
    m.transform_point3(p) + DVec3::ZERO
}

impl LightKind {
    /// The function of the language that makes it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Point { .. } => "light",
            Self::Directional { .. } => "directional",
            Self::Area { .. } => "areaLight",
            Self::Spot(_) => "spot",
            Self::Surface(surface) => surface.name(),
            Self::Sun(_) => "directional",
            Self::Projector(_) => "projector",
        }
    }

    /// One word for it: `point`, `directional`, `area`, `spot`, `rectangle`, `disk`, `sphere`, `mesh`, `sun`, `projector`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Point { .. } => "point",
            Self::Area { .. } => "area",
            Self::Surface(surface) => surface.word(),
            Self::Sun(_) => "sun",
            _ => self.name(),
        }
    }

    /// Where the middle of it is; `None` where it is infinitely far away.
    #[must_use]
    pub fn center(&self) -> Option<DVec3> {
        match *self {
            Self::Point { position, .. } => Some(position),
            Self::Directional { .. } | Self::Sun(_) => None,
            Self::Area {
                corner, edge1, edge2, ..
            } => Some(corner + (edge1 + edge2) * 0.5),
            Self::Spot(ref spot) => Some(spot.position()),
            Self::Surface(ref surface) => Some(surface.center()),
            Self::Projector(ref projector) => Some(projector.position()),
        }
    }

    /// The direction towards it from a point: to its center, or to where it is far away. Any length.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// b.point(DVec3::new(0.0, 4.0, 0.0), DVec3::ONE)?;
    /// b.directional(DVec3::X, DVec3::ONE)?;
    /// let scene = b.finish().value;
    /// let [lamp, sun] = [0, 1].map(|i| &scene.root().lights[i].kind);
    /// assert_eq!((lamp.word(), sun.word()), ("point", "directional"));
    /// // From a point at its side the lamp stands elsewhere; the sun does not.
    /// let here = DVec3::new(0.0, 1.0, 0.0);
    /// assert_eq!((lamp.towards(here), sun.towards(here)), (DVec3::Y * 3.0, DVec3::X));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn towards(&self, from: DVec3) -> DVec3 {
        match self {
            Self::Directional { direction } => *direction,
            Self::Sun(sun) => sun.direction(),
            _ => self.center().map_or(DVec3::ZERO, |center| center - from),
        }
    }

    /// How many points of it a surface point asks for shadows, at most.
    #[must_use]
    pub fn points(&self) -> u32 {
        match *self {
            Self::Area { n, .. } => n * n,
            Self::Surface(ref surface) => surface.n() * surface.n(),
            Self::Sun(ref sun) => sun.n() * sun.n(),
            _ => 1,
        }
    }

    /// Its fall-off with the distance, where it has one.
    #[must_use]
    pub fn attenuation(&self) -> Option<&Attenuation> {
        match self {
            Self::Point { attenuation, .. } | Self::Area { attenuation, .. } => Some(attenuation),
            Self::Directional { .. } | Self::Sun(_) => None,
            Self::Spot(spot) => Some(spot.attenuation()),
            Self::Surface(surface) => surface.attenuation(),
            Self::Projector(projector) => Some(projector.attenuation()),
        }
    }

    /// Its points and vectors, the point that says where it is first.
    pub(crate) fn vectors(&self) -> Vec<LightVector> {
        let vector = LightVector::vector;
        match *self {
            Self::Point { position, .. } => vec![LightVector::point("position", position)],
            Self::Directional { direction } => vec![vector("direction", direction)],
            Self::Area {
                corner, edge1, edge2, ..
            } => vec![
                LightVector::point("corner", corner),
                vector("edge 1", edge1),
                vector("edge 2", edge2),
            ],
            Self::Spot(ref spot) => spot.vectors(),
            Self::Surface(ref surface) => surface.vectors(),
            Self::Sun(ref sun) => sun.vectors(),
            Self::Projector(ref projector) => projector.vectors(),
        }
    }

    /// Its numbers, but for fall-off and color.
    pub(crate) fn numbers(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Point { .. } | Self::Directional { .. } => Vec::new(),
            Self::Area { n, .. } => vec![("points per edge", f64::from(n))],
            Self::Spot(ref spot) => spot.numbers(),
            Self::Surface(ref surface) => surface.numbers(),
            Self::Sun(ref sun) => sun.numbers(),
            Self::Projector(ref projector) => projector.numbers(),
        }
    }

    /// The triangles that shine.
    #[must_use]
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        match self {
            Self::Surface(surface) => match surface.form() {
                LightForm::Mesh(mesh) => mesh.triangles(),
                _ => &[],
            },
            _ => &[],
        }
    }
}
