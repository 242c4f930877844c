//! Lights.

mod far;
mod links;
mod parts;
mod spot;
mod surface;

pub use far::{Projector, Sun};
pub use links::Links;
pub use spot::Spot;
pub(crate) use surface::around;
pub use surface::{Falloff, LightForm, LightMesh, SurfaceLight};

use crate::{
    color::Color,
    diag::SourceLoc,
    math::{DAffine3, DVec3},
};

/// Fall-off of a point light with the distance d in world units: 1 / (constant + linear d + quadratic d^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    /// Term of d^0.
    pub constant: f64,
    /// Term of d^1.
    pub linear: f64,
    /// Term of d^2.
    pub quadratic: f64,
}

impl Default for Attenuation {
    fn default() -> Self {
        Self {
            constant: 1.0,
            linear: 0.0,
            quadratic: 0.0,
        }
    }
}

impl Attenuation {
    /// The share of light that arrives at distance `d`.
    #[must_use]
    pub fn at(&self, d: f64) -> f64 {
        1.0 / (self.constant + self.linear * d + self.quadratic * d * d)
    }
}

/// What kind of light, in the space of its group.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Light from one point.
    Point {
        /// Where it is.
        position: DVec3,
        /// Its fall-off.
        attenuation: Attenuation,
    },
    /// Parallel light, not attenuated.
    Directional {
        /// Unit vector towards the light.
        direction: DVec3,
    },
    /// A parallelogram of `n` x `n` cells, one jittered point light in each; its color is the total.
    Area {
        /// One corner.
        corner: DVec3,
        /// The edge from the corner to one neighbour.
        edge1: DVec3,
        /// The edge from the corner to the other neighbour.
        edge2: DVec3,
        /// Cells along each edge, at least 1.
        n: u32,
        /// Fall-off of each point.
        attenuation: Attenuation,
    },
    /// Light from one point into a cone.
    Spot(Spot),
    /// Light from the points of a surface.
    Surface(SurfaceLight),
    /// Parallel light with soft shadows.
    Sun(Sun),
    /// Light through a picture.
    Projector(Projector),
}

impl LightKind {
    /// The light in the space that `m` leads to; `None` where nothing is left of its direction or its size.
    pub(crate) fn placed(&self, m: &DAffine3) -> Option<Self> {
        Some(match *self {
            Self::Point {
                position,
                attenuation,
            } => Self::Point {
                position: m.transform_point3(position),
                attenuation,
            },
            Self::Directional { direction } => {
                let turned = m.transform_vector3(direction);
                let length = turned.length();
                if !(length > 0.0) {
                    return None;
                }
                Self::Directional {
                    direction: turned / length,
                }
            }
            Self::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation,
            } => Self::Area {
                corner: m.transform_point3(corner),
                edge1: m.transform_vector3(edge1),
                edge2: m.transform_vector3(edge2),
                n,
                attenuation,
            },
            Self::Spot(ref spot) => Self::Spot(spot.placed(m)?),
            Self::Surface(ref surface) => Self::Surface(surface.placed(m)?),
            Self::Sun(ref sun) => Self::Sun(sun.placed(m)?),
            Self::Projector(ref projector) => Self::Projector(projector.placed(m)?),
        })
    }
}

/// A light.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Attenuation, LightKind}};
/// let mut b = Builder::new();
/// // Half as bright at a distance of 1.
/// b.attenuation(Attenuation { constant: 1.0, linear: 0.0, quadratic: 1.0 })?;
/// b.point(DVec3::Y, DVec3::ONE)?;
/// let scene = b.finish().value;
/// let light = &scene.root().lights[0];
/// assert!(matches!(&light.kind, LightKind::Point { attenuation, .. } if attenuation.at(1.0) == 0.5));
/// assert_eq!(light.kind.center(), Some(DVec3::Y));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its kind and place.
    pub kind: LightKind,
    /// Its color, scene-linear; components may exceed 1.
    pub color: Color,
    /// Which shapes it reaches.
    pub links: Links,
    /// The call that made it.
    pub loc: SourceLoc,
}
