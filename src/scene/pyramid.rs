//! Smaller and smaller copies of a picture, for what is seen from far away (Williams, "Pyramidal parametrics", SIGGRAPH 1983).

use super::{ImageTexture, Wrap};
use crate::{
    color::Color,
    math::{self, DVec2},
};

/// Copies of a picture, each half as wide and half as high as the one before, down to a single texel.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    /// From half the picture's size on.
    levels: Vec<Level>,
}

/// One copy: scene-linear light, in rows from the top.
#[derive(Clone, Debug, PartialEq)]
struct Level {
    width: u32,
    height: u32,
    /// Single precision, to take a third more memory than a picture of bytes and no more.
    texels: Vec<[f32; 3]>,
}

impl Level {
    fn texel(&self, x: u32, y: u32) -> Color {
        let texel = self.texels.get(y as usize * self.width as usize + x as usize);
        texel.map_or(Color::ZERO, |texel| Color::from_array(texel.map(f64::from)))
    }
}

impl Pyramid {
    /// Bytes that the copies of a picture take, but for a few: a third of its texels, in single precision.
    pub(crate) fn bytes_of(image: &ImageTexture) -> u64 {
        let texels = u64::from(image.width) * u64::from(image.height);
        texels * size_of::<[f32; 3]>() as u64 / 3
    }

    /// The copies of a picture.
    #[must_use]
    pub fn new(image: &ImageTexture) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        let (mut width, mut height) = (image.width, image.height);
        while width > 1 || height > 1 {
            let last = levels.last();
            let above = |x: u32, y: u32| {
                let (x, y) = (x.min(width - 1), y.min(height - 1));
                last.map_or_else(|| image.texel(x, y), |level| level.texel(x, y))
            };
            let (w, h) = (width.div_ceil(2), height.div_ceil(2));
            let mut texels = Vec::with_capacity(w as usize * h as usize);
            for y in 0..h {
                for x in 0..w {
                    let top = above(2 * x, 2 * y) + above(2 * x + 1, 2 * y);
                    let bottom = above(2 * x, 2 * y + 1) + above(2 * x + 1, 2 * y + 1);
                    texels.push(((top + bottom) * 0.25).to_array().map(|v| v as f32));
                }
            }
            (width, height) = (w, h);
            levels.push(Level {
                width,
                height,
                texels,
            });
        }
        Self { levels }
    }

    /// The picture's color about `uv` over a width of `width` in texture coordinates, (0, 0) being the lower left corner: between
    /// the two copies whose texels are next to as wide.
    #[must_use]
    pub fn color(&self, image: &ImageTexture, wrap: Wrap, uv: DVec2, width: f64) -> Color {
        let texels = width * f64::from(image.width.max(image.height));
        let most = self.levels.len() as f64;
        let level = if texels > 1.0 {
            math::log2(texels).min(most)
        } else {
            0.0
        };
        let (below, share) = (level.floor(), level - level.floor());
        let at = |level: f64| match (level as usize).checked_sub(1).and_then(|i| self.levels.get(i)) {
            Some(level) => bilinear((level.width, level.height), wrap, uv, |x, y| level.texel(x, y)),
            None => bilinear((image.width, image.height), wrap, uv, |x, y| image.texel(x, y)),
        };
        if share == 0.0 {
            return at(below);
        }
        at(below) * (1.0 - share) + at(below + 1.0) * share
    }
}

/// The four texels about `uv`, weighted.
pub(super) fn bilinear(
    (width, height): (u32, u32),
    wrap: Wrap,
    uv: DVec2,
    texel: impl Fn(u32, u32) -> Color,
) -> Color {
    let (x, y) = (
        uv.x * f64::from(width) - 0.5,
        (1.0 - uv.y) * f64::from(height) - 0.5,
    );
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let at = |x: f64, y: f64| {
        let place = wrap.texel(x as i64, width).zip(wrap.texel(y as i64, height));
        place.map_or(Color::ZERO, |(x, y)| texel(x, y))
    };
    let row = |y: f64| at(x0, y) * (1.0 - fx) + at(x0 + 1.0, y) * fx;
    row(y0) * (1.0 - fy) + row(y0 + 1.0) * fy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Texels;

    fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> f64) -> ImageTexture {
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        ImageTexture {
            name: String::new(),
            width,
            height,
            texels: Texels::Linear(texels.map(|(x, y)| [color(x, y); 3]).collect()),
        }
    }

    #[test]
    fn from_far_away_a_picture_is_its_mean() {
        let image = picture(16, 8, |x, y| f64::from(x * y % 5) * 0.25);
        let mean = (0..128).map(|i| image.texel(i % 16, i / 16).x).sum::<f64>() / 128.0;
        let pyramid = Pyramid::new(&image);
        for (u, width) in [(0.1, 1.0), (0.7, 40.0), (0.5, 1e9)] {
            let found = pyramid.color(&image, Wrap::Repeat, DVec2::new(u, 0.3), width).x;
            assert!((found - mean).abs() < 1e-6, "{found} and not {mean}");
        }
    }

    #[test]
    fn from_near_it_is_the_picture() {
        let image = picture(5, 7, |x, y| f64::from(x + 3 * y));
        let pyramid = Pyramid::new(&image);
        for i in 0..40 {
            let uv = DVec2::new(f64::from(i) * 0.07, f64::from(i) * 0.113);
            let found = pyramid.color(&image, Wrap::Repeat, uv, 0.1);
            assert!((found - image.bilinear(uv)).abs().max_element() < 1e-9, "{uv}");
        }
    }

    #[test]
    fn fine_squares_turn_gray_little_by_little() {
        let image = picture(64, 64, |x, y| f64::from((x + y) % 2));
        let pyramid = Pyramid::new(&image);
        // In the middle of a white texel.
        let at = |texels: f64| {
            let uv = DVec2::new(10.5 / 64.0, 1.0 - 11.5 / 64.0);
            pyramid.color(&image, Wrap::Repeat, uv, texels / 64.0).x
        };
        assert_eq!(at(1.0), 1.0);
        assert!((at(2.0) - 0.5).abs() < 1e-6);
        let mut before = at(1.0);
        for i in 1..=20 {
            let now = at(1.0 + f64::from(i) * 0.05);
            assert!(now <= before && before - now < 0.1, "{i}");
            before = now;
        }
    }
}
