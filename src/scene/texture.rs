//! Textures: colors that vary over a surface.

use std::sync::Arc;

use super::{
    CustomTexture, MappedImage, Paint, Pattern, PatternTexture, Placement, SceneError, TextureFilter,
    composed::{MixTexture, PlacedTexture},
};
use crate::{
    color::{self, Color},
    custom::Custom,
    math::{DVec2, DVec3},
};

/// A color for each point of a surface.
///
/// ```
/// use rtscript::{DVec3, math::DVec2, scene::Texture};
/// let floor = Texture::Checker { even: DVec3::ONE, odd: DVec3::ZERO, size: 1.0 };
/// let at = |x| floor.color(DVec2::ZERO, DVec3::new(x, 0.5, 0.5));
/// assert!(at(0.5) != at(1.5) && at(0.5) == at(2.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// A picture over uv in [0, 1]^2, repeated outside, u to the right and v up, bilinear.
    Image(ImageTexture),
    /// Two colors in cubes of edge `size` in object space.
    Checker {
        /// Color of the cube that starts at the origin.
        even: Color,
        /// Color of its neighbours.
        odd: Color,
        /// Edge of a cube in object units, greater than 0.
        size: f64,
    },
    /// See [`CustomTexture`].
    Custom(Custom<dyn CustomTexture>),
    /// See [`Texture::pattern`].
    Pattern(Box<PatternTexture>),
    /// See [`Texture::mix`].
    Mix(Box<MixTexture>),
    /// See [`Texture::placed`].
    Placed(Box<PlacedTexture>),
    /// See [`MappedImage`].
    Mapped(Box<MappedImage>),
    /// The colors at the corners of a mesh's triangles, mixed between them by their shares of the triangle (barycentric
    /// coordinates); see [`Mesh::colors`](super::Mesh::colors). White on whatever has none.
    VertexColors,
}

/// A point of a surface, as textures see it.
///
/// ```
/// use rtscript::{DVec3, math::DVec2, scene::{Footprint, Texture, TexturePoint}};
/// let floor = Texture::Checker { even: DVec3::ONE, odd: DVec3::ZERO, size: 1.0 };
/// // Seen from so near that it has no width: no Footprint either.
/// let nothing: Option<Footprint> = None;
/// let point = TexturePoint {
///     uv: DVec2::ZERO,
///     position: DVec3::splat(0.5),
///     normal: DVec3::Y,
///     width: [0.0; 2],
///     footprint: nothing,
///     color: None,
/// };
/// assert_eq!(floor.lookup(&point), floor.color(point.uv, point.position));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates.
    pub uv: DVec2,
    /// In the space of the shape.
    pub position: DVec3,
    /// Outward normal in the space of the shape, of any length; 0 where it is not known.
    pub normal: DVec3,
    /// How wide a pixel is there, in the space of the shape and in texture coordinates; 0 where it is not known.
    pub width: [f64; 2],
    /// What a pixel covers there, where it is known that precisely.
    pub footprint: Option<Footprint>,
    /// The scene-linear color that the corners of a mesh give the point, where they have colors.
    pub color: Option<Color>,
}

/// What a pixel covers of a surface: an ellipse, by two vectors from side to side through its middle. Of a surface that is looked
/// at aslant the first is the longer one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// In the space of the shape.
    pub space: [DVec3; 2],
    /// In texture coordinates.
    pub uv: [DVec2; 2],
}

/// The texels of a picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// sRGB bytes, as picture files hold them; turned into light when looked up.
    Srgb8(Vec<[u8; 3]>),
    /// Scene-linear light.
    Linear(Vec<[f64; 3]>),
}

/// A picture used as a texture.
///
/// ```
/// use rtscript::{DVec3, math::DVec2, scene::{ImageTexture, Texels}};
/// let two = ImageTexture { name: "two".to_owned(), width: 2, height: 1, texels: Texels::Srgb8(vec![[255, 0, 0], [0, 0, 255]]) };
/// assert_eq!((two.texel(0, 0), two.texel(1, 0)), (DVec3::X, DVec3::Z));
/// assert!((two.bilinear(DVec2::new(0.5, 0.5)) - DVec3::new(0.5, 0.0, 0.5)).length() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// Where it came from, for people.
    pub name: String,
    /// Texels across, at least 1.
    pub width: u32,
    /// Texels down, at least 1.
    pub height: u32,
    /// `width * height` texels.
    pub texels: Texels,
}

impl ImageTexture {
    /// Bytes that its texels take.
    pub(crate) fn bytes(&self) -> u64 {
        let bytes = match &self.texels {
            Texels::Srgb8(texels) => size_of_val(&**texels),
            Texels::Linear(texels) => size_of_val(&**texels),
        };
        bytes as u64
    }
}

impl Texture {
    /// The color at a surface point with texture coordinates `uv` and object-space position `p`.
    #[must_use]
    pub fn color(&self, uv: DVec2, p: DVec3) -> Color {
        self.lookup(&TexturePoint {
            uv,
            position: p,
            normal: DVec3::ZERO,
            width: [0.0; 2],
            footprint: None,
            color: None,
        })
    }

    /// The color at a surface point.
    #[must_use]
    pub fn lookup(&self, point: &TexturePoint) -> Color {
        let (uv, p) = (point.uv, point.position);
        match self {
            Self::Image(image) => image.bilinear(uv),
            Self::Custom(texture) => texture.color(uv, p),
            Self::Pattern(pattern) => pattern.at(point),
            Self::Mix(mix) => mix.at(point),
            Self::Placed(placed) => placed.at(point),
            Self::Mapped(image) => image.at(point),
            Self::VertexColors => point.color.unwrap_or(Color::ONE),
            Self::Checker { even, odd, size } => {
                // Half a millionth of a cube inwards, so that a face in the plane of a boundary takes one color
                // instead of rounding noise.
                let cell = |x: f64| (x / size + 5e-7).floor();
                let sum = cell(p.x) + cell(p.y) + cell(p.z);
                if sum.rem_euclid(2.0) == 0.0 { *even } else { *odd }
            }
        }
    }
}

impl Texture {
    /// [`Texture::VertexColors`]: the same one for all who ask, so that a scene has it once.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use rtscript::{Builder, Term, DVec3, scene::Texture};
    /// // A surface in the colors of its mesh's vertices.
    /// let mut b = Builder::new();
    /// let colors = b.texture(&Texture::vertex_colors());
    /// b.material_mut().diffuse = Term { color: DVec3::ONE, texture: Some(colors) };
    /// assert!(Arc::ptr_eq(&Texture::vertex_colors(), &Texture::vertex_colors()));
    /// ```
    #[must_use]
    pub fn vertex_colors() -> Arc<Self> {
        static SHARED: std::sync::LazyLock<Arc<Texture>> =
            std::sync::LazyLock::new(|| Arc::new(Texture::VertexColors));
        Arc::clone(&SHARED)
    }

    /// A pattern in the space of the shape.
    ///
    /// # Errors
    /// Where a number of the pattern is out of its range, or the textures in its colors are too many.
    pub fn pattern(pattern: Pattern) -> Result<Self, SceneError> {
        Ok(Self::Pattern(Box::new(PatternTexture::new(pattern)?)))
    }

    /// `a` where `mask` is black, `b` where it is white, in each channel of its own the share that the mask has there.
    ///
    /// # Errors
    /// Where the textures in it are too many.
    pub fn mix(a: Paint, b: Paint, mask: Paint) -> Result<Self, SceneError> {
        Ok(Self::Mix(Box::new(MixTexture::new(a, b, mask)?)))
    }

    /// A texture scaled, turned, moved and stirred. What has texture coordinates instead of a place in space, such as a
    /// picture, is so in these: u and v count as x and y.
    ///
    /// # Errors
    /// Where a number is out of its range, or the textures in it are too many.
    pub fn placed(texture: Paint, placement: Placement) -> Result<Self, SceneError> {
        Ok(Self::Placed(Box::new(PlacedTexture::new(texture, placement)?)))
    }

    /// True where it is a picture of sRGB bytes, however it is laid.
    pub(crate) fn is_srgb(&self) -> bool {
        match self {
            Self::Image(image) => matches!(image.texels, Texels::Srgb8(_)),
            Self::Mapped(mapped) => mapped.image().is_srgb(),
            _ => false,
        }
    }

    /// True where the width of a pixel matters to it.
    pub(crate) fn asks_for_width(&self) -> bool {
        match self {
            Self::Mapped(mapped) => mapped.laying().filter.is_by_width(),
            _ => self.parts().into_iter().any(|part| part.asks_for_width()),
        }
    }

    /// True where it shows the colors of vertices.
    pub(crate) fn shows_vertex_colors(&self) -> bool {
        matches!(self, Self::VertexColors) || self.parts().into_iter().any(|part| part.shows_vertex_colors())
    }

    /// True where it matters to it what exactly a pixel covers.
    pub(crate) fn asks_for_footprint(&self) -> bool {
        match self {
            Self::Mapped(mapped) => mapped.laying().filter == TextureFilter::Anisotropic,
            _ => self.parts().into_iter().any(|part| part.asks_for_footprint()),
        }
    }

    /// How much there is to look up at a point.
    pub(super) fn size(&self) -> Size {
        match self {
            Self::Image(_) | Self::Checker { .. } | Self::Custom(_) | Self::VertexColors => Size::ONE,
            Self::Pattern(pattern) => pattern.size(),
            Self::Mix(mix) => mix.size(),
            Self::Placed(placed) => placed.size(),
            Self::Mapped(_) => Size { lookups: 2, depth: 2 },
        }
    }

    /// The pictures and textures that it looks up itself.
    pub(super) fn parts(&self) -> Vec<&Arc<Self>> {
        match self {
            Self::Image(_) | Self::Checker { .. } | Self::Custom(_) | Self::VertexColors => Vec::new(),
            Self::Pattern(pattern) => {
                let entries = pattern.pattern().colors.entries().iter();
                entries.filter_map(|(_, paint)| paint.texture.as_ref()).collect()
            }
            Self::Mix(mix) => mix
                .paints()
                .into_iter()
                .filter_map(|p| p.texture.as_ref())
                .collect(),
            Self::Placed(placed) => placed.paint().texture.iter().collect(),
            Self::Mapped(image) => vec![image.image()],
        }
    }
}

/// How much there is to look up at a point for one texture: what is made of textures must end soon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    lookups: u32,
    depth: u32,
}

impl Size {
    const ONE: Self = Self { lookups: 1, depth: 1 };

    /// That of a texture made of `parts`.
    pub(super) fn of<'p>(parts: impl IntoIterator<Item = &'p Paint>) -> Result<Self, SceneError> {
        let mut size = Self { lookups: 1, depth: 0 };
        for part in parts.into_iter().filter_map(|paint| paint.texture.as_ref()) {
            let part = part.size();
            size.lookups = size.lookups.saturating_add(part.lookups);
            size.depth = size.depth.max(part.depth);
        }
        size.depth += 1;
        if size.lookups > MOST_LOOKUPS || size.depth > DEEPEST {
            return Err(SceneError::new(format!(
                "a texture may be made of {MOST_LOOKUPS} textures in all, {DEEPEST} in one another, and this one is made \
                 of {} and {}",
                size.lookups, size.depth
            )));
        }
        Ok(size)
    }
}

/// The most textures in one, counted as often as they are looked up.
const MOST_LOOKUPS: u32 = 256;

/// The most textures in one another.
const DEEPEST: u32 = 32;

impl ImageTexture {
    /// Scene-linear color of the texel in column `x`, row `y` from the top; black where there is none.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> Color {
        let index = y as usize * self.width as usize + x as usize;
        let texel = match &self.texels {
            Texels::Srgb8(texels) => texels.get(index).map(|texel| texel.map(linear_from_byte)),
            Texels::Linear(texels) => texels.get(index).copied(),
        };
        texel.map_or(Color::ZERO, Color::from_array)
    }

    /// Bilinear lookup with repetition; texel (0, 0) is the top left one, at u = 0 and v = 1.
    #[must_use]
    pub fn bilinear(&self, uv: DVec2) -> Color {
        if !uv.is_finite() {
            return Color::ZERO;
        }
        let x = (uv.x - uv.x.floor()) * f64::from(self.width) - 0.5;
        let y = (1.0 - (uv.y - uv.y.floor())) * f64::from(self.height) - 0.5;
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let wrap = |i: f64, n: u32| (i as i64).rem_euclid(i64::from(n)) as u32;
        let (xa, xb) = (wrap(x0, self.width), wrap(x0 + 1.0, self.width));
        let (ya, yb) = (wrap(y0, self.height), wrap(y0 + 1.0, self.height));
        let top = self.texel(xa, ya) * (1.0 - fx) + self.texel(xb, ya) * fx;
        let bottom = self.texel(xa, yb) * (1.0 - fx) + self.texel(xb, yb) * fx;
        top * (1.0 - fy) + bottom * fy
    }
}

#[allow(clippy::indexing_slicing, reason = "the table has an entry for every byte")]
fn linear_from_byte(byte: u8) -> f64 {
    static TABLE: std::sync::LazyLock<[f64; 256]> =
        std::sync::LazyLock::new(|| std::array::from_fn(|i| color::linear_from_srgb(i as f64 / 255.0)));
    TABLE[usize::from(byte)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> ImageTexture {
        let texels = Texels::Linear(vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
        ]);
        ImageTexture {
            name: String::new(),
            width: 2,
            height: 2,
            texels,
        }
    }

    #[test]
    fn the_first_texel_is_the_top_left_one() {
        let image = two_by_two();
        assert_eq!(image.bilinear(DVec2::new(0.25, 0.75)), Color::X);
        assert_eq!(image.bilinear(DVec2::new(0.75, 0.25)), Color::ONE);
    }

    #[test]
    fn lookups_repeat_and_blend() {
        let image = two_by_two();
        let uv = DVec2::new(0.5, 0.75);
        assert_eq!(image.bilinear(uv), Color::new(0.5, 0.5, 0.0));
        assert_eq!(image.bilinear(uv + DVec2::new(-3.0, 7.0)), image.bilinear(uv));
        assert_eq!(image.bilinear(DVec2::new(f64::NAN, 0.0)), Color::ZERO);
    }

    #[test]
    fn checkers_alternate_across_the_origin() {
        let checker = Texture::Checker {
            even: Color::ONE,
            odd: Color::ZERO,
            size: 1.0,
        };
        let at = |x: f64| checker.color(DVec2::ZERO, DVec3::new(x, 0.0, 0.5)).x;
        assert_eq!([at(-1.5), at(-0.5), at(0.5), at(1.5)], [1.0, 0.0, 1.0, 0.0]);
    }
}
