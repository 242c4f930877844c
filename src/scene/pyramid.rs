//! Smaller and smaller copies of a picture, for what is seen from far away (Williams, "Pyramidal parametrics", SIGGRAPH 1983).

use super::{ImageTexture, Wrap};
use crate::{
    color::Color,
    math::{self, DVec2},
};

/// Copies of a picture, each half as wide and half as high as the one before, down to a single texel.
///
/// ```
/// use rtscript::{DVec3, math::DVec2, scene::{ImageTexture, Pyramid, Texels, Wrap}};
/// let two = ImageTexture { name: "two".to_owned(), width: 2, height: 1, texels: Texels::Linear(vec![[1.0; 3], [0.0; 3]]) };
/// let copies = Pyramid::new(&two);
/// // As wide as the whole picture: its mean.
/// let mean = copies.color(&two, Wrap::Repeat, DVec2::new(0.3, 0.5), 1.0);
/// assert!((mean - DVec3::splat(0.5)).length() < 1e-6);
/// ```
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
        self.color_at(image, wrap, uv, texels)
    }

    /// The picture's color about `uv` over an ellipse, by two vectors from side to side through its middle in texture coordinates.
    /// The short side decides between which copies, and up to [`Pyramid::MOST_PROBES`] places along the long side are looked at,
    /// with equal weights (McCormack, Perry, Farkas and Jouppi, "Feline: fast elliptical lines for anisotropic texture mapping",
    /// SIGGRAPH 1999, whose weights are Gaussian). A longer ellipse is looked at as if it were wider.
    ///
    /// ```
    /// use rtscript::{DVec3, math::DVec2, scene::{ImageTexture, Pyramid, Texels, Wrap}};
    /// // Black and white columns, looked at over an ellipse that is as wide as the picture and as narrow as a texel.
    /// let columns = [[0.0; 3], [1.0; 3]].repeat(8);
    /// let stripes = ImageTexture { name: "stripes".to_owned(), width: 2, height: 8, texels: Texels::Linear(columns) };
    /// let copies = Pyramid::new(&stripes);
    /// let axes = [DVec2::new(1.0, 0.0), DVec2::new(0.0, 0.125)];
    /// let color = copies.color_over(&stripes, Wrap::Repeat, DVec2::splat(0.5), axes);
    /// assert!((color - DVec3::splat(0.5)).length() < 0.01, "{color}");
    /// ```
    #[must_use]
    pub fn color_over(&self, image: &ImageTexture, wrap: Wrap, uv: DVec2, axes: [DVec2; 2]) -> Color {
        let size = DVec2::new(f64::from(image.width), f64::from(image.height));
        let [a, b] = axes.map(|axis| axis * size);
        // The ellipse is what the matrix of both makes of a circle: its axes are the roots of the eigenvalues of the matrix
        // times its transpose (Heckbert, "Fundamentals of texture mapping and image warping", 1989, appendix A).
        let (xx, xy, yy) = (
            a.x * a.x + b.x * b.x,
            a.x * a.y + b.x * b.y,
            a.y * a.y + b.y * b.y,
        );
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let apart = (half * half + xy * xy).sqrt();
        let long = (mean + apart).sqrt();
        let short = (mean - apart).max(0.0).sqrt();
        let short = short.max(long / f64::from(Self::MOST_PROBES)).max(1.0);
        let probes = (long / short).ceil();
        if !(probes > 1.0) {
            return self.color_at(image, wrap, uv, short);
        }
        // The longer of the two forms of the eigenvector, which loses no digits.
        let dir = if half >= 0.0 {
            DVec2::new(half + apart, xy)
        } else {
            DVec2::new(xy, apart - half)
        };
        let step = dir / dir.length() * (long / probes) / size;
        let probes = probes.min(f64::from(Self::MOST_PROBES)) as u32;
        let sum = (0..probes).fold(Color::ZERO, |sum, i| {
            let away = f64::from(i) - 0.5 * f64::from(probes - 1);
            sum + self.color_at(image, wrap, uv + step * away, short)
        });
        sum / f64::from(probes)
    }

    /// The most places that [`Pyramid::color_over`] looks at.
    pub const MOST_PROBES: u32 = 16;

    /// As [`Pyramid::color`] over a width in texels.
    fn color_at(&self, image: &ImageTexture, wrap: Wrap, uv: DVec2, texels: f64) -> Color {
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

    #[test]
    fn an_ellipse_that_is_a_circle_is_a_width() {
        let image = picture(32, 32, |x, y| f64::from(x * 7 + y * 5) % 11.0);
        let pyramid = Pyramid::new(&image);
        for i in 0..30 {
            let uv = DVec2::new(f64::from(i) * 0.037, f64::from(i) * 0.0713);
            let width = f64::from(i) * 0.01;
            let axes = [DVec2::new(0.0, -width), DVec2::new(width, 0.0)];
            let expected = pyramid.color(&image, Wrap::Repeat, uv, width);
            let found = pyramid.color_over(&image, Wrap::Repeat, uv, axes);
            assert!((found - expected).abs().max_element() < 1e-9, "{i}");
        }
    }

    #[test]
    fn what_lies_along_an_ellipse_stays_sharp() {
        // Stripes of four texels each, which run along v.
        let image = picture(64, 64, |x, _| f64::from(x / 4 % 2));
        let pyramid = Pyramid::new(&image);
        let uv = DVec2::new(6.0 / 64.0, 0.4);
        let axes = [DVec2::new(0.0, 0.5), DVec2::new(1.0 / 64.0, 0.0)];
        assert!(pyramid.color_over(&image, Wrap::Repeat, uv, axes).x > 0.999);
        assert!(pyramid.color(&image, Wrap::Repeat, uv, 0.5).x < 0.6);
        // Across them they are gray, and an ellipse that is too long is wider instead.
        let turned = [DVec2::new(0.5, 0.0), DVec2::new(0.0, 1.0 / 64.0)];
        assert!((pyramid.color_over(&image, Wrap::Repeat, uv, turned).x - 0.5).abs() < 0.05);
        let longer = [DVec2::new(0.0, 1e6), DVec2::new(1.0 / 64.0, 0.0)];
        assert!((pyramid.color_over(&image, Wrap::Repeat, uv, longer).x - 0.5).abs() < 1e-6);
    }

    #[test]
    fn ellipses_are_nearer_to_the_mean_than_circles() {
        let image = picture(64, 32, |x, y| {
            f64::from((x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 3 & 255) / 255.0
        });
        let pyramid = Pyramid::new(&image);
        let (mut by_ellipse, mut by_circle) = (0.0, 0.0);
        for i in 0..60 {
            let i = f64::from(i);
            let uv = DVec2::new(i * 0.173, i * 0.0917);
            let (sin, cos) = math::sin_cos_degrees(i * 17.0);
            // Texels along and across, in any direction, and leaning.
            let (long, short) = (8.0 + i % 7.0, 1.0 + i % 3.0);
            let size = DVec2::new(64.0, 32.0);
            let axes = [
                DVec2::new(cos, sin) * long / size,
                DVec2::new(-sin + 0.3 * cos, cos + 0.3 * sin) * short / size,
            ];
            let n = 40;
            let (mut sum, mut count) = (0.0, 0.0);
            for a in 0..n {
                for b in 0..n {
                    let p = DVec2::new(f64::from(a), f64::from(b)) * (2.0 / f64::from(n - 1)) - DVec2::ONE;
                    if p.length() <= 1.0 {
                        sum += image.bilinear(uv + (axes[0] * p.x + axes[1] * p.y) * 0.5).x;
                        count += 1.0;
                    }
                }
            }
            let mean = sum / count;
            by_ellipse += (pyramid.color_over(&image, Wrap::Repeat, uv, axes).x - mean).abs();
            by_circle += (pyramid.color(&image, Wrap::Repeat, uv, long / 64.0).x - mean).abs();
        }
        assert!(by_ellipse < 0.7 * by_circle, "{by_ellipse} and {by_circle}");
    }
}
