//! Textures: colors that vary over a surface.

use super::CustomTexture;
use crate::{
    color::{self, Color},
    custom::Custom,
    math::{DVec2, DVec3},
};

/// A color for each point of a surface.
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

impl Texture {
    /// The color at a surface point with texture coordinates `uv` and object-space position `p`.
    #[must_use]
    pub fn color(&self, uv: DVec2, p: DVec3) -> Color {
        match self {
            Self::Image(image) => image.bilinear(uv),
            Self::Custom(texture) => texture.color(uv, p),
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
