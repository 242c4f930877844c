//! Textures made of textures.

use super::{
    Paint, Placement, SceneError,
    mapped::largest,
    texture::{Footprint, Size, TexturePoint},
};
use crate::{
    color::Color,
    math::{DAffine3, DVec2, DVec3},
};

/// Two textures and a mask; see [`Texture::mix`](super::Texture::mix).
///
/// ```
/// use rtscript::{DVec3, scene::{MixTexture, Paint, Pattern, PatternKind, Texture}};
/// let rust = Paint::color(DVec3::new(0.5, 0.2, 0.1));
/// let steel = Paint::color(DVec3::splat(0.6));
/// let where_it_rusts = Paint::texture(Texture::pattern(Pattern::new(PatternKind::Granite))?.into());
/// let Texture::Mix(mix) = Texture::mix(steel, rust, where_it_rusts)? else { panic!("a mix") };
/// let mix: &MixTexture = &mix;
/// assert_eq!(mix.paints()[0].color, DVec3::splat(0.6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MixTexture {
    a: Paint,
    b: Paint,
    mask: Paint,
    size: Size,
}

impl MixTexture {
    pub(super) fn new(a: Paint, b: Paint, mask: Paint) -> Result<Self, SceneError> {
        let size = Size::of([&a, &b, &mask])?;
        Ok(Self { a, b, mask, size })
    }

    /// What shows where the mask is black, what where it is white, and the mask.
    #[must_use]
    pub fn paints(&self) -> [&Paint; 3] {
        [&self.a, &self.b, &self.mask]
    }

    pub(super) fn size(&self) -> Size {
        self.size
    }

    pub(super) fn at(&self, point: &TexturePoint) -> Color {
        let share = self.mask.at(point);
        if share == Color::ZERO {
            return self.a.at(point);
        }
        if share == Color::ONE {
            return self.b.at(point);
        }
        self.a.at(point) * (Color::ONE - share) + self.b.at(point) * share
    }
}

/// A texture that lies elsewhere; see [`Texture::placed`](super::Texture::placed).
///
/// ```
/// use rtscript::{DVec3, scene::{Paint, PlacedTexture, Placement, Texture}};
/// let gray = Paint::color(DVec3::splat(0.5));
/// let Texture::Placed(placed) = Texture::placed(gray.clone(), Placement::default())? else { panic!("placed") };
/// let placed: &PlacedTexture = &placed;
/// assert_eq!(placed.paint(), &gray);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedTexture {
    paint: Paint,
    placement: Placement,
    texture_from_object: DAffine3,
    size: Size,
}

impl PlacedTexture {
    pub(super) fn new(paint: Paint, placement: Placement) -> Result<Self, SceneError> {
        placement.check()?;
        let size = Size::of([&paint])?;
        let texture_from_object = placement.texture_from_object();
        Ok(Self {
            paint,
            placement,
            texture_from_object,
            size,
        })
    }

    /// What lies there.
    #[must_use]
    pub fn paint(&self) -> &Paint {
        &self.paint
    }

    /// Where it lies.
    #[must_use]
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    pub(super) fn size(&self) -> Size {
        self.size
    }

    pub(super) fn at(&self, point: &TexturePoint) -> Color {
        let at = |p: DVec3| self.placement.stir(self.texture_from_object.transform_point3(p));
        let uv = at(DVec3::new(point.uv.x, point.uv.y, 0.0));
        // A normal goes by the transpose of the inverse.
        let object_from_texture = self.texture_from_object.matrix3.inverse();
        self.paint.at(&TexturePoint {
            uv: DVec2::new(uv.x, uv.y),
            position: at(point.position),
            normal: object_from_texture.transpose() * point.normal,
            width: point
                .width
                .map(|width| width * largest(&self.texture_from_object)),
            footprint: point.footprint.map(|footprint| {
                let turned = |v: DVec3| self.texture_from_object.transform_vector3(v);
                Footprint {
                    space: footprint.space.map(turned),
                    uv: footprint
                        .uv
                        .map(|v| turned(DVec3::new(v.x, v.y, 0.0)))
                        .map(|v| DVec2::new(v.x, v.y)),
                }
            }),
            color: point.color,
        })
    }
}
