//! Pictures laid on shapes otherwise than by their texture coordinates.

use std::sync::Arc;

use super::{
    ImageTexture, Placement, Pyramid, SceneError, Texture,
    pyramid::bilinear,
    texture::{Footprint, TexturePoint},
};
use crate::{
    color::Color,
    math::{self, DAffine3, DVec2, DVec3, PI},
};

/// How a point gets its place on a picture. All but `Uv` go by the point in the space of the shape, the picture being laid on
/// the cube from -0.5 to 0.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// By the shape's own texture coordinates.
    Uv,
    /// Along the z axis: u is x + 0.5, v is y + 0.5.
    Planar,
    /// Around the y axis from pole to pole, as a map of the world: longitude 0 (the +z side) is the middle of the picture.
    Spherical,
    /// Around the y axis: v is y + 0.5.
    Cylindrical,
    /// From the side that the surface faces most: six planar pictures, upright on the four walls.
    Box,
}

impl Mapping {
    /// All of them with their names in scripts.
    pub const ALL: [(&'static str, Self); 5] = [
        ("uv", Self::Uv),
        ("planar", Self::Planar),
        ("spherical", Self::Spherical),
        ("cylindrical", Self::Cylindrical),
        ("box", Self::Box),
    ];
}

/// What lies between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureFilter {
    /// The four nearest, weighted.
    Bilinear,
    /// The nearest alone, for pixel art.
    Nearest,
    /// Copies of the picture for what is far away, chosen by the width of a pixel there; see [`Pyramid`].
    Mip,
    /// As `Mip` by the short side of what a pixel covers, at up to 16 places along the long one: floors and walls that are seen
    /// aslant stay sharp.
    Anisotropic,
}

impl TextureFilter {
    /// All of them with their names in scripts.
    pub const ALL: [(&'static str, Self); 4] = [
        ("bilinear", Self::Bilinear),
        ("nearest", Self::Nearest),
        ("mip", Self::Mip),
        ("anisotropic", Self::Anisotropic),
    ];

    /// True where it asks how wide a pixel is.
    pub(super) fn is_by_width(self) -> bool {
        matches!(self, Self::Mip | Self::Anisotropic)
    }
}

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Its outermost texels.
    Clamp,
    /// The picture mirrored.
    Mirror,
    /// Black.
    Black,
}

impl Wrap {
    /// All of them with their names in scripts.
    pub const ALL: [(&'static str, Self); 4] = [
        ("repeat", Self::Repeat),
        ("clamp", Self::Clamp),
        ("mirror", Self::Mirror),
        ("black", Self::Black),
    ];

    /// The texel that stands for number `i` of `n`.
    pub(super) fn texel(self, i: i64, n: u32) -> Option<u32> {
        let n = i64::from(n);
        let i = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let i = i.rem_euclid(2 * n);
                if i < n { i } else { 2 * n - 1 - i }
            }
            Self::Black => Some(i).filter(|i| (0..n).contains(i))?,
        };
        u32::try_from(i).ok()
    }
}

/// How a picture is laid on a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laying {
    /// How a point gets its place on the picture.
    pub mapping: Mapping,
    /// What lies between texels.
    pub filter: TextureFilter,
    /// What lies beyond the edges.
    pub wrap: Wrap,
    /// Width over which the sides of [`Mapping::Box`] melt into each other, 0 (default) to 1.
    pub blend: f64,
    /// Where the picture lies: of [`Mapping::Uv`] in texture coordinates, u and v being x and y, else in the shape's space.
    pub placement: Placement,
}

impl Default for Laying {
    fn default() -> Self {
        Self {
            mapping: Mapping::Uv,
            filter: TextureFilter::Bilinear,
            wrap: Wrap::Repeat,
            blend: 0.0,
            placement: Placement::default(),
        }
    }
}

/// A picture laid on a shape in a way of its own.
///
/// ```
/// use rtscript::scene::{ImageTexture, Laying, MappedImage, Mapping, Texels, Texture, TextureFilter, Wrap};
/// let red = ImageTexture { name: "red".to_owned(), width: 1, height: 1, texels: Texels::Srgb8(vec![[255, 0, 0]]) };
/// let around = Laying {
///     mapping: Mapping::Spherical,
///     filter: TextureFilter::Mip,
///     wrap: Wrap::Mirror,
///     ..Laying::default()
/// };
/// let label = MappedImage::new(Texture::Image(red).into(), around)?;
/// assert_eq!(label.laying().mapping, Mapping::Spherical);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MappedImage {
    image: Arc<Texture>,
    laying: Laying,
    texture_from_object: DAffine3,
    pyramid: Option<Arc<Pyramid>>,
}

impl MappedImage {
    /// Lays a picture.
    ///
    /// # Errors
    /// Where the texture is no [`Texture::Image`], or a number is out of its range.
    pub fn new(image: Arc<Texture>, laying: Laying) -> Result<Self, SceneError> {
        Self::with_copies(image, laying, |image| Arc::new(Pyramid::new(image)))
    }

    /// As [`MappedImage::new`], with copies of the picture that may be there already: [`Pyramid::new`] of it. They are asked for
    /// by [`TextureFilter::Mip`] and [`TextureFilter::Anisotropic`] alone.
    ///
    /// # Errors
    /// As [`MappedImage::new`].
    ///
    /// ```
    /// use std::sync::Arc;
    /// use rtscript::scene::{ImageTexture, Laying, MappedImage, Pyramid, Texels, Texture, TextureFilter};
    /// let picture = ImageTexture { name: "grid".to_owned(), width: 2, height: 2, texels: Texels::Srgb8(vec![[9; 3]; 4]) };
    /// let copies = Arc::new(Pyramid::new(&picture));
    /// let image = Arc::new(Texture::Image(picture));
    /// // Two layings of one picture share its smaller copies.
    /// let laying = Laying { filter: TextureFilter::Mip, ..Laying::default() };
    /// for _ in 0..2 {
    ///     MappedImage::with_copies(image.clone(), laying, |_| copies.clone())?;
    /// }
    /// assert_eq!(Arc::strong_count(&copies), 1);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn with_copies(
        image: Arc<Texture>,
        laying: Laying,
        copies: impl FnOnce(&ImageTexture) -> Arc<Pyramid>,
    ) -> Result<Self, SceneError> {
        let Texture::Image(texels) = &*image else {
            return Err(SceneError::new("only a picture can be laid on a shape"));
        };
        if !(0.0..=1.0).contains(&laying.blend) {
            return Err(SceneError::new(format!(
                "blend must lie between 0 and 1, not {}",
                laying.blend
            )));
        }
        laying.placement.check()?;
        let pyramid = laying.filter.is_by_width().then(|| copies(texels));
        Ok(Self {
            image,
            pyramid,
            texture_from_object: laying.placement.texture_from_object(),
            laying,
        })
    }

    /// The picture.
    #[must_use]
    pub fn image(&self) -> &Arc<Texture> {
        &self.image
    }

    /// How it is laid.
    #[must_use]
    pub fn laying(&self) -> &Laying {
        &self.laying
    }

    pub(super) fn at(&self, point: &TexturePoint) -> Color {
        let Texture::Image(image) = &*self.image else {
            return Color::ZERO;
        };
        let place = |p: DVec3| {
            self.laying
                .placement
                .stir(self.texture_from_object.transform_point3(p))
        };
        let [in_space, in_uv] = point.width;
        let width = match self.laying.mapping {
            Mapping::Uv => in_uv,
            _ => in_space,
        };
        let width = width * largest(&self.texture_from_object);
        let width = match self.laying.mapping {
            // Once around is 1, and that is the longer, the farther from the axis.
            Mapping::Spherical => width / (2.0 * PI * place(point.position).length()),
            Mapping::Cylindrical => {
                let p = place(point.position);
                width / (2.0 * PI * math::hypot(p.x, p.z)).min(1.0)
            }
            _ => width,
        };
        let start = match self.laying.mapping {
            Mapping::Uv => DVec3::new(point.uv.x, point.uv.y, 0.0),
            _ => point.position,
        };
        let p = place(start);
        // `uv` is where on the picture a place lies.
        let look = |uv: &dyn Fn(DVec3) -> DVec2| {
            let footprint = point
                .footprint
                .filter(|_| self.laying.filter == TextureFilter::Anisotropic);
            let Some(Footprint { space, uv: in_uv }) = footprint else {
                return self.texel(image, uv(p), width);
            };
            let axes = match self.laying.mapping {
                Mapping::Uv => in_uv.map(|v| DVec3::new(v.x, v.y, 0.0)),
                _ => space,
            };
            let axes = axes.map(|axis| {
                // A short way, so that the seam of a picture that goes around is told from a wide pixel.
                let way = uv(place(start + axis * SHORT_WAY)) - uv(p);
                DVec2::new(way.x - (way.x + 0.5).floor(), way.y) / SHORT_WAY
            });
            self.over(image, uv(p), axes, width)
        };
        match self.laying.mapping {
            Mapping::Uv => look(&|p| DVec2::new(p.x, p.y)),
            Mapping::Planar => look(&|p| DVec2::new(p.x + 0.5, p.y + 0.5)),
            Mapping::Spherical => look(&|p| {
                let height = p.y / p.length();
                DVec2::new(longitude(p), math::asin(height.clamp(-1.0, 1.0)) / PI + 0.5)
            }),
            Mapping::Cylindrical => look(&|p| DVec2::new(longitude(p), p.y + 0.5)),
            Mapping::Box => {
                let n = self.texture_from_object.matrix3.inverse().transpose() * point.normal;
                // Seen from outside, u goes to the right on each side.
                let sides: [(f64, &dyn Fn(DVec3) -> DVec2); 3] = [
                    (n.x, &|p| DVec2::new(-p.z * sign(n.x) + 0.5, p.y + 0.5)),
                    (n.y, &|p| DVec2::new(p.x + 0.5, -p.z * sign(n.y) + 0.5)),
                    (n.z, &|p| DVec2::new(p.x * sign(n.z) + 0.5, p.y + 0.5)),
                ];
                let most = n.abs().max_element();
                let least = most * (1.0 - self.laying.blend);
                let (mut sum, mut whole) = (Color::ZERO, 0.0);
                for (along, uv) in sides {
                    let over = along.abs() - least;
                    let is_first = along.abs() == most && whole == 0.0;
                    let weight = if self.laying.blend == 0.0 {
                        f64::from(u8::from(is_first))
                    } else {
                        over.max(0.0)
                    };
                    if weight > 0.0 {
                        sum += look(uv) * weight;
                        whole += weight;
                    }
                }
                if whole > 0.0 {
                    sum / whole
                } else {
                    look(&|p| DVec2::new(p.x + 0.5, p.y + 0.5))
                }
            }
        }
    }

    /// The picture's color about `uv` over the ellipse with these axes.
    fn over(&self, image: &ImageTexture, uv: DVec2, axes: [DVec2; 2], width: f64) -> Color {
        let is_known = uv.abs().max_element() < 1e12 && axes.iter().all(|axis| axis.is_finite());
        match &self.pyramid {
            Some(pyramid) if is_known => pyramid.color_over(image, self.laying.wrap, uv, axes),
            _ => self.texel(image, uv, width),
        }
    }

    /// The picture's color at `uv` over a `width`; (0, 0) is the lower left corner.
    fn texel(&self, image: &ImageTexture, uv: DVec2, width: f64) -> Color {
        if !(uv.abs().max_element() < 1e12) {
            return Color::ZERO;
        }
        let Laying { filter, wrap, .. } = self.laying;
        if let Some(pyramid) = &self.pyramid {
            return pyramid.color(image, wrap, uv, width);
        }
        if filter == TextureFilter::Nearest {
            let x = (uv.x * f64::from(image.width)).floor();
            let y = ((1.0 - uv.y) * f64::from(image.height)).floor();
            let texel = wrap
                .texel(x as i64, image.width)
                .zip(wrap.texel(y as i64, image.height));
            return texel.map_or(Color::ZERO, |(x, y)| image.texel(x, y));
        }
        bilinear((image.width, image.height), wrap, uv, |x, y| image.texel(x, y))
    }
}

/// The share of a pixel's width over which places on a picture are looked at.
const SHORT_WAY: f64 = 1.0 / 1024.0;

/// How much a map stretches at most, along its axes.
pub(super) fn largest(map: &DAffine3) -> f64 {
    let m = map.matrix3;
    m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length())
}

/// Angle about the y axis, 0.5 on the +z side and growing to the right as seen from outside.
fn longitude(p: DVec3) -> f64 {
    math::atan2(p.x, p.z) / (2.0 * PI) + 0.5
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Texels;

    /// Red, green; blue, white below.
    fn picture() -> Arc<Texture> {
        Arc::new(Texture::Image(ImageTexture {
            name: String::new(),
            width: 2,
            height: 2,
            texels: Texels::Linear(vec![
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 1.0],
            ]),
        }))
    }

    fn laid(laying: Laying) -> impl Fn(DVec3, DVec3) -> Color {
        let image = MappedImage::new(picture(), laying).unwrap();
        move |position, normal| {
            image.at(&TexturePoint {
                uv: DVec2::new(position.x, position.y),
                position,
                normal,
                width: [0.0; 2],
                footprint: None,
                color: None,
            })
        }
    }

    fn nearest(mapping: Mapping) -> Laying {
        Laying {
            mapping,
            filter: TextureFilter::Nearest,
            ..Laying::default()
        }
    }

    #[test]
    fn every_side_of_a_box_shows_the_picture_upright() {
        let at = laid(nearest(Mapping::Box));
        // Upper left and lower right of each side as seen from outside, with the direction to the right.
        for (n, right) in [
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::NEG_X),
            (DVec3::X, DVec3::NEG_Z),
            (DVec3::NEG_X, DVec3::Z),
        ] {
            let corner = |r: f64, u: f64| n * 0.5 + right * (r * 0.25) + DVec3::Y * (u * 0.25);
            assert_eq!(at(corner(-1.0, 1.0), n), Color::X, "{n}");
            assert_eq!(at(corner(1.0, 1.0), n), Color::Y, "{n}");
            assert_eq!(at(corner(1.0, -1.0), n), Color::ONE, "{n}");
        }
        assert_eq!(at(DVec3::new(-0.25, 0.5, -0.25), DVec3::Y), Color::X);
    }

    #[test]
    fn maps_of_the_world_have_their_middle_in_front() {
        for mapping in [Mapping::Spherical, Mapping::Cylindrical] {
            let at = laid(nearest(mapping));
            assert_eq!(at(DVec3::new(-0.1, 0.2, 1.0), DVec3::Z), Color::X);
            assert_eq!(at(DVec3::new(0.1, 0.2, 1.0), DVec3::Z), Color::Y);
            assert_eq!(at(DVec3::new(0.1, -0.2, 1.0), DVec3::Z), Color::ONE);
            assert_eq!(at(DVec3::new(0.1, -0.2, -1.0), DVec3::Z), Color::ONE);
        }
    }

    #[test]
    fn edges_are_as_asked_for() {
        let beyond = |wrap| {
            laid(Laying {
                wrap,
                ..nearest(Mapping::Planar)
            })(DVec3::new(0.75, 0.25, 0.0), DVec3::Z)
        };
        assert_eq!(beyond(Wrap::Repeat), Color::X);
        assert_eq!(beyond(Wrap::Clamp), Color::Y);
        assert_eq!(beyond(Wrap::Mirror), Color::Y);
        assert_eq!(beyond(Wrap::Black), Color::ZERO);
    }

    #[test]
    fn by_texture_coordinates_it_is_the_picture_itself() {
        let at = laid(Laying::default());
        let Texture::Image(image) = &*picture() else {
            unreachable!()
        };
        for i in 0..50 {
            let p = DVec3::new(f64::from(i) * 0.137 - 2.0, f64::from(i) * 0.071, 0.0);
            let difference = at(p, DVec3::Z) - image.bilinear(DVec2::new(p.x, p.y));
            assert!(difference.abs().max_element() < 1e-9, "{p}");
        }
    }

    #[test]
    fn sides_melt_into_each_other() {
        let at = laid(Laying {
            blend: 0.5,
            ..nearest(Mapping::Box)
        });
        let mixed = at(DVec3::new(0.25, 0.25, 0.25), DVec3::new(1.0, 0.0, 1.0));
        // Half of the right side's green and red.
        assert!(
            (mixed - Color::new(0.5, 0.5, 0.0)).abs().max_element() < 1e-12,
            "{mixed}"
        );
    }
}
