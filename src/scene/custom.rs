//! Textures and reflectances that a program makes itself.

use std::{fmt, sync::Arc};

use super::Texture;
use crate::{
    color::Color,
    custom::Custom,
    math::{DVec2, DVec3},
};

/// A color for each point of a surface, by the program's own rule. The same answer to the same question is asked of it,
/// as of a [`CustomShape`](crate::shape::CustomShape).
pub trait CustomTexture: fmt::Debug + Send + Sync {
    /// The scene-linear color at a point with texture coordinates `uv` and object-space position `p`.
    fn color(&self, uv: DVec2, p: DVec3) -> Color;
}

/// A point whose answer to light is asked for.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ShadingPoint {
    /// In world space.
    pub position: DVec3,
    /// Unit normal for shading in world space, on the side that is looked at.
    pub normal: DVec3,
    /// Unit vector to whoever looks, in world space.
    pub to_eye: DVec3,
    /// Kd here, its texture looked up.
    pub diffuse: Color,
    /// Ks here, its texture looked up.
    pub specular: Color,
}

/// How a surface answers the light of lamps, by the program's own rule, in place of Lambert's and Blinn's. What it glows,
/// mirrors and lets through is told by the other terms of the [`Material`](super::Material).
///
/// ```
/// use rtscript::{DVec3, scene::{Material, CustomReflectance, ShadingPoint}};
///
/// /// Three steps of light, as in a drawing.
/// #[derive(Debug)]
/// struct Toon;
///
/// impl CustomReflectance for Toon {
///     fn response(&self, at: &ShadingPoint, to_light: DVec3) -> DVec3 {
///         let step = (at.normal.dot(to_light).max(0.0) * 3.0).ceil() / 3.0;
///         at.diffuse * step
///     }
/// }
///
/// let drawn = Material::default().with_reflectance(Toon);
/// assert!(drawn.reflectance.is_some());
/// ```
pub trait CustomReflectance: fmt::Debug + Send + Sync {
    /// The share of the light arriving from the unit vector `to_light` that leaves towards the eye, for each channel, the
    /// cosine of its slant included: Kd max(N.L, 0) for a matt surface. Asked also of light from behind. It should
    /// not be negative.
    fn response(&self, at: &ShadingPoint, to_light: DVec3) -> Color;
}

impl Texture {
    /// A texture of the program's own.
    #[must_use]
    pub fn custom(texture: impl CustomTexture + 'static) -> Self {
        let shared: Arc<dyn CustomTexture> = Arc::new(texture);
        Self::Custom(Custom::from(shared))
    }
}
