//! What else is known of each pixel, as numbers beside the picture.

use super::{
    by_rows,
    film::Image,
    sampler::mix,
    show::ramp,
    world::{Probe, World},
};
use crate::{color::Color, diag::Error, host::Host, math::DVec3, scene::Encoding};

/// A kind of layer. All of them are of the ray through the middle of the pixel, as far as the first surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    /// Distance from where the ray starts, in world units; infinite where nothing is met.
    Depth,
    /// The unit normal used for shading, in world space; 0 where nothing is met.
    Normal,
    /// The diffuse term, with its texture.
    Albedo,
    /// Texture coordinates.
    Uv,
    /// A whole number below 2^24 for each object, the same in every picture that has the object at the same place in its
    /// groups; 0 where nothing is met.
    Object,
    /// The line of the script that made the object, counted from 1; 0 where nothing is met.
    Line,
}

impl LayerKind {
    /// Every kind with what scripts call it.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("depth", Self::Depth),
        ("normal", Self::Normal),
        ("albedo", Self::Albedo),
        ("uv", Self::Uv),
        ("object", Self::Object),
        ("line", Self::Line),
    ];

    /// What scripts and files call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Albedo => "albedo",
            Self::Uv => "uv",
            Self::Object => "object",
            Self::Line => "line",
        }
    }

    /// What its numbers are called, as compositing programs know them.
    #[must_use]
    pub const fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["Z"],
            Self::Normal => &["X", "Y", "Z"],
            Self::Albedo => &["R", "G", "B"],
            Self::Uv => &["U", "V"],
            Self::Object | Self::Line => &["id"],
        }
    }
}

/// A layer of a picture.
///
/// ```
/// use rtscript::{Builder, NoHost, RenderOptions, render, render::{Layer, LayerKind}};
/// let mut b = Builder::new();
/// b.size(4, 3)?;
/// let mut options = RenderOptions::default();
/// options.layers = vec![LayerKind::Normal];
/// let image = render(&b.finish().value, &options, &NoHost)?.value.image;
/// let normals: &Layer = &image.layers()[0];
/// assert_eq!(normals.values.len(), 4 * 3 * normals.kind.channels().len());
/// assert_eq!(normals.picture(4, 3).width(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What it holds.
    pub kind: LayerKind,
    /// As many numbers for each pixel as [`LayerKind::channels`] has names, rows from the top.
    pub values: Vec<f32>,
}

impl Layer {
    /// The layer as a picture to look at: the albedo as light, all else with 8 bits that are its values times 255: normals
    /// from -1 to 1 as 0 to 1, fractions of texture coordinates, what is near lighter, a color for each number.
    #[must_use]
    pub fn picture(&self, width: u32, height: u32) -> Image {
        let depths = || self.values.iter().copied().filter(|v| v.is_finite());
        let (near, far) = (
            depths().fold(f32::INFINITY, f32::min),
            depths().fold(0.0, f32::max),
        );
        let color = |pixel: &[f32]| match (self.kind, pixel) {
            (LayerKind::Normal, [x, y, z]) if [*x, *y, *z] == [0.0; 3] => Color::ZERO,
            (LayerKind::Normal, [x, y, z]) => (of([*x, *y, *z]) + DVec3::ONE) * 0.5,
            (LayerKind::Albedo, [r, g, b]) => of([*r, *g, *b]),
            (LayerKind::Uv, [u, v]) => of([u - u.floor(), v - v.floor(), 0.0]),
            (LayerKind::Depth, [z]) if !z.is_finite() => Color::ZERO,
            (LayerKind::Depth, [z]) if far > near => {
                let [near, far, z] = [near, far, *z].map(f64::from);
                Color::splat(0.1 + 0.9 * (near / z - near / far) / (1.0 - near / far))
            }
            (LayerKind::Depth, _) => Color::ONE,
            (_, [id]) if *id > 0.0 => ramp::distinct(mix(u64::from(*id as u32))),
            _ => Color::ZERO,
        };
        let pixels = self.values.chunks(self.kind.channels().len());
        let pixels = pixels.map(|pixel| color(pixel).to_array());
        let encoding = match self.kind {
            LayerKind::Albedo => Encoding::Srgb,
            _ => Encoding::Raw,
        };
        Image::new(width, height, encoding, pixels.collect())
    }
}

fn of(v: [f32; 3]) -> Color {
    Color::from_array(v.map(f64::from))
}

/// The layers of a compiled scene.
///
/// # Errors
/// `Cancelled` where the host asks to stop.
pub(super) fn layers(world: &World<'_>, kinds: &[LayerKind], host: &dyn Host) -> Result<Vec<Layer>, Error> {
    let s = &world.scene.settings;
    let region = s.region();
    let frame = world.scene.camera.frame(s.width, s.height);
    let pixels = by_rows((region.width, region.height), host, |x, y, _| {
        let mut values: Vec<f32> = Vec::new();
        let ray = frame.ray(f64::from(region.x + x) + 0.5, f64::from(region.y + y) + 0.5);
        let met = ray.and_then(|ray| {
            let hit = world.nearest(&Probe::from_space(ray), f64::INFINITY)?;
            Some((hit, world.surface(&hit, &ray)?))
        });
        for kind in kinds {
            let Some((hit, at)) = &met else {
                let nothing = if *kind == LayerKind::Depth {
                    f32::INFINITY
                } else {
                    0.0
                };
                values.extend(kind.channels().iter().map(|_| nothing));
                continue;
            };
            match kind {
                LayerKind::Depth => values.push(hit.t as f32),
                LayerKind::Normal => values.extend(at.shading_normal.to_array().map(|v| v as f32)),
                LayerKind::Albedo => {
                    let albedo = world.term(&at.material.diffuse, at);
                    values.extend(albedo.to_array().map(|v| v as f32));
                }
                LayerKind::Uv => values.extend(at.uv.to_array().map(|v| v as f32)),
                LayerKind::Object => {
                    let path = world.places_of(hit.number);
                    let key = path.iter().fold(0, |key, (group, index)| {
                        mix(mix(key ^ u64::from(group.0)) ^ u64::from(*index))
                    });
                    values.push(((key >> 40) as u32).max(1) as f32);
                }
                LayerKind::Line => {
                    let object = world.objects_of(hit.number).last().copied();
                    values.push(object.map_or(0.0, |object| object.loc.line as f32));
                }
            }
        }
        values
    })?;
    let mut first = 0;
    let layers = kinds.iter().map(|kind| {
        let channels = first..first + kind.channels().len();
        first = channels.end;
        let values = pixels
            .iter()
            .flat_map(|pixel| pixel.get(channels.clone()).unwrap_or_default());
        Layer {
            kind: *kind,
            values: values.copied().collect(),
        }
    });
    Ok(layers.collect())
}
