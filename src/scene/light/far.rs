//! A sun of some size, and a projector of pictures.

use super::{
    Attenuation,
    parts::{LightVector, placed_point},
};
use crate::{
    math::{self, DAffine3, DVec3, brief},
    scene::{SceneError, TextureId},
};

/// Parallel light from a disk in the sky: a [`LightKind::Directional`](super::LightKind::Directional) with soft shadows.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::Sun};
/// // Half a degree wide, as the real one.
/// let sun = Sun::new(DVec3::new(1.0, 2.0, 1.0), 0.53, 16)?;
/// assert_eq!(sun.angle(), 0.53);
/// assert!(sun.direction().y > sun.direction().x);
/// Builder::new().sun(sun, DVec3::ONE)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    direction: DVec3,
    angle: f64,
    n: u32,
}

impl Sun {
    /// A sun in the direction `direction`, `angle` degrees from its middle to its edge, above 0 and at most 90, asked in
    /// `n` x `n` points.
    ///
    /// # Errors
    /// Where the direction is zero or not finite, the angle is out of that range, or `n` is not in 1..=256.
    pub fn new(direction: DVec3, angle: f64, n: u32) -> Result<Self, SceneError> {
        let length = direction.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(SceneError::new(format!(
                "the light's direction must not be zero, and it is {}",
                brief(direction)
            )));
        }
        if !(angle > 0.0 && angle <= 90.0) {
            return Err(SceneError::new(format!(
                "the angle of a light from far away must be above 0 and at most 90 degrees, not {angle}"
            ))
            .hint("it is measured from the middle to the edge; the sun's is 0.27"));
        }
        if !(1..=256).contains(&n) {
            return Err(SceneError::new(format!(
                "a soft light has a grid of 1 to 256 points along each edge, not {n}"
            )));
        }
        Ok(Self { direction, angle, n })
    }

    /// Vector to its middle, in a scene a unit vector.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Degrees from its middle to its edge.
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Points along each edge of the grid.
    #[must_use]
    pub fn n(&self) -> u32 {
        self.n
    }

    pub(in crate::scene) fn with_direction(&self, direction: DVec3) -> Self {
        Self { direction, ..*self }
    }

    pub(super) fn placed(&self, m: &DAffine3) -> Option<Self> {
        let turned = m.transform_vector3(self.direction);
        let length = turned.length();
        (length > 0.0).then(|| self.with_direction(turned / length + DVec3::ZERO))
    }

    pub(super) fn vectors(&self) -> Vec<LightVector> {
        vec![LightVector::vector("direction", self.direction)]
    }

    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("angle", self.angle), ("points per edge", f64::from(self.n))]
    }
}

/// Light from one point through a picture, as a slide projector sends it.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Attenuation, Projector, Texture}};
/// let mut b = Builder::new();
/// let slide = b.texture(&Texture::Checker { even: DVec3::ONE, odd: DVec3::X, size: 0.1 }.into());
/// let [from, at, up] = [DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y];
/// let projector = Projector::new([from, at, up], 30.0, slide, Attenuation::default())?;
/// assert_eq!((projector.position(), projector.target(), projector.up()), (from, at, up));
/// assert_eq!(projector.fovy(), 30.0);
/// b.projector(projector, DVec3::ONE)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Projector {
    position: DVec3,
    target: DVec3,
    up: DVec3,
    fovy: f64,
    image: TextureId,
    attenuation: Attenuation,
}

impl Projector {
    /// A projector at `position` whose picture's middle falls on `target` with `up` pointing up in it, `fovy` degrees
    /// from its top to its bottom, above 0 and below 180; as wide as the picture `image` asks for.
    ///
    /// # Errors
    /// Where `fovy` is out of that range, position and target are the same, `up` points along the line between them, or
    /// a number is not finite.
    pub fn new(
        [position, target, up]: [DVec3; 3],
        fovy: f64,
        image: TextureId,
        attenuation: Attenuation,
    ) -> Result<Self, SceneError> {
        if !(fovy > 0.0 && fovy < 180.0) {
            return Err(SceneError::new(format!(
                "a projector's fovy must be between 0 and 180 degrees, not {fovy}"
            )));
        }
        let projector = Self {
            position,
            target,
            up,
            fovy,
            image,
            attenuation,
        };
        if projector.frame().is_none() {
            return Err(SceneError::new(
                "a projector needs a target that is not its position, and an up that does not point along the line between them",
            ));
        }
        Ok(projector)
    }

    /// Where it is.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Where the middle of the picture falls.
    #[must_use]
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// Up in the picture.
    #[must_use]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Degrees from the top to the bottom of the picture.
    #[must_use]
    pub fn fovy(&self) -> f64 {
        self.fovy
    }

    /// The picture.
    #[must_use]
    pub fn image(&self) -> TextureId {
        self.image
    }

    /// Its fall-off.
    #[must_use]
    pub fn attenuation(&self) -> &Attenuation {
        &self.attenuation
    }

    /// Unit vectors to the right in the picture, up in it, and ahead; `None` where there are none.
    pub(crate) fn frame(&self) -> Option<[DVec3; 3]> {
        let unit = |v: DVec3| {
            let length = v.length();
            (length > 0.0 && length.is_finite()).then(|| v / length)
        };
        let ahead = unit(self.target - self.position)?;
        let right = ahead.cross(unit(self.up)?);
        let right = unit(right).filter(|_| right.length() > 1e-9)?;
        Some([right, right.cross(ahead), ahead])
    }

    /// Half the height of the picture at distance 1.
    pub(crate) fn extent(&self) -> f64 {
        let (sin, cos) = math::sin_cos_degrees(self.fovy * 0.5);
        sin / cos
    }

    pub(super) fn placed(&self, m: &DAffine3) -> Option<Self> {
        let placed = Self {
            position: placed_point(m, self.position),
            target: placed_point(m, self.target),
            up: m.transform_vector3(self.up) + DVec3::ZERO,
            ..self.clone()
        };
        placed.frame().is_some().then_some(placed)
    }

    pub(super) fn vectors(&self) -> Vec<LightVector> {
        vec![
            LightVector::point("position", self.position),
            LightVector::point("target", self.target),
            LightVector::vector("up", self.up),
        ]
    }

    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("fovy", self.fovy), ("texture", f64::from(self.image.0))]
    }
}
