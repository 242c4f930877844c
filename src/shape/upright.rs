//! What shapes around Y have in common that are told by a radius and a height.

use super::positive;
use crate::{
    math::{Bounds3, DVec3},
    scene::SceneError,
};

/// Both are lengths that the shape of this name may have.
#[inline]
pub(super) fn check(shape: &str, radius: f64, height: f64) -> Result<(), SceneError> {
    positive(format_args!("the {shape}'s radius"), radius)?;
    positive(format_args!("the {shape}'s height"), height)
}

/// The box around such a shape, centered at the origin.
pub(super) fn bounds(radius: f64, height: f64) -> Bounds3 {
    let corner = DVec3::new(radius, height * 0.5, radius);
    Bounds3::new(-corner, corner)
}

/// Its radius, its height and its box. The texts say which they are.
macro_rules! upright {
    ($shape:ident, $radius:literal, $height:literal) => {
        impl $shape {
            #[doc = $radius]
            #[must_use]
            pub const fn radius(&self) -> f64 {
                self.radius
            }

            #[doc = $height]
            #[must_use]
            pub const fn height(&self) -> f64 {
                self.height
            }

            pub(super) fn bounds(&self) -> Option<Bounds3> {
                Some(upright::bounds(self.radius, self.height))
            }
        }
    };
}
pub(super) use upright;
