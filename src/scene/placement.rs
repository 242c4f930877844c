//! Where a texture lies in the space of its shape.

use super::SceneError;
use crate::{
    math::{self, DAffine3, DVec3},
    noise::{self, Octaves},
};

/// Where a texture lies in the space of its shape, and how it is stirred: it is scaled first, then turned, then moved.
///
/// ```
/// use rtscript::{DVec3, scene::{Paint, Pattern, PatternKind, Placement, Texture}};
/// let bricks = Texture::pattern(Pattern::new(PatternKind::Brick))?;
/// let small = Placement { scale: DVec3::splat(0.2), ..Placement::default() };
/// let Texture::Placed(placed) = Texture::placed(Paint::texture(bricks.into()), small)? else { panic!("placed") };
/// assert_eq!(placed.placement().scale, DVec3::splat(0.2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// How much larger it is along its own axes; no component is 0. Default 1, 1, 1.
    pub scale: DVec3,
    /// Degrees about the axes x, y and z, in this order. Default 0.
    pub rotate: DVec3,
    /// Where its origin lies, in object units. Default 0.
    pub translate: DVec3,
    /// How far its points are stirred, in its own units; see [`noise::displacement`]. Default 0.
    pub turbulence: f64,
    /// Octaves of that, 1 to [`noise::MAX_OCTAVES`]. Default 6.
    pub octaves: u32,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            scale: DVec3::ONE,
            rotate: DVec3::ZERO,
            translate: DVec3::ZERO,
            turbulence: 0.0,
            octaves: 6,
        }
    }
}

impl Placement {
    /// Refuses what places nothing.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let Self {
            scale,
            rotate,
            translate,
            turbulence,
            octaves,
        } = *self;
        for (name, v) in [("scale", scale), ("rotate", rotate), ("translate", translate)] {
            if !(v.abs().max_element() <= noise::REACH) {
                return Err(SceneError::new(format!(
                    "{name} of a texture must be finite numbers within 1e9, not {v}"
                )));
            }
        }
        if scale.abs().min_element() < 1e-9 {
            return Err(SceneError::new(format!(
                "scale of a texture must not have a component below 1e-9, but it is {scale}"
            )));
        }
        if !(turbulence.abs() <= 1e6) {
            return Err(SceneError::new(format!(
                "turbulence must be a number within 1e6, not {turbulence}"
            )));
        }
        octaves_in_range(octaves)
    }

    /// From the space of the shape to that of the texture, without what stirs it.
    pub(super) fn texture_from_object(&self) -> DAffine3 {
        let axes = [
            (DVec3::X, self.rotate.x),
            (DVec3::Y, self.rotate.y),
            (DVec3::Z, self.rotate.z),
        ];
        let mut object_from_texture = DAffine3::from_scale(self.scale);
        for (axis, degrees) in axes {
            if degrees != 0.0 {
                let turn = math::rotation(axis, degrees);
                object_from_texture = DAffine3::from_mat3(turn) * object_from_texture;
            }
        }
        object_from_texture.translation += self.translate;
        object_from_texture.inverse()
    }

    /// A point in the texture's space, stirred.
    pub(super) fn stir(&self, p: DVec3) -> DVec3 {
        if self.turbulence == 0.0 {
            return p;
        }
        p + noise::displacement(p, Octaves::new(self.octaves)) * self.turbulence
    }
}

/// Refuses a number of octaves that is none.
pub(super) fn octaves_in_range(octaves: u32) -> Result<(), SceneError> {
    if (1..=noise::MAX_OCTAVES).contains(&octaves) {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "octaves must lie between 1 and {}, not {octaves}",
        noise::MAX_OCTAVES
    )))
}
