//! Pictures of something else than light: normals, texture coordinates, depth, which object, which line, what it costs.

mod cost;
pub(super) mod ramp;

pub use cost::{PixelCost, costs};

use super::{
    RenderOptions, by_rows,
    film::Image,
    on_threads,
    sampler::mix,
    world::{Probe, World},
};
use crate::{
    color::Color,
    diag::Error,
    host::Host,
    math::DVec3,
    scene::{Encoding, Scene},
};

/// What a picture shows instead of light, along the ray through the middle of each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// The normal used for shading, in world space: x, y, z from -1 to 1 as red, green, blue from 0 to 1.
    Normal,
    /// Texture coordinates: the fractions of u and v as red and green. On a triangle without any, the weights of its
    /// second and third corner.
    Uv,
    /// Distance from the camera: the nearest white, the farthest nearly black, evenly in 1 / distance, so that an endless
    /// plane leaves something to the rest.
    Depth,
    /// A color for each object, the same in every picture that has the object at the same place in its groups.
    Object,
    /// A color for each line of a script that made something.
    Line,
    /// Rays and boxes of the tree that they touch, over all samples and everything that follows from them, from black
    /// over red to white on a logarithmic scale.
    Cost,
}

/// What the middle of a pixel meets.
struct Met {
    t: f64,
    number: u64,
    normal: DVec3,
    uv: [f64; 2],
}

/// Renders what `what` says of a scene. Where nothing is met, the picture is black. It is the same on any number of
/// threads; its 8 bits are its values times 255, whatever the scene's encoding.
///
/// # Errors
/// `Cancelled` where the host asks to stop, `Limit` where instancing multiplies past 2^62 primitives.
///
/// ```
/// use rtscript::{Builder, DVec3, NoHost, RenderOptions, render::show::{Show, show}};
/// let mut b = Builder::new();
/// b.size(8, 6)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let normals = show(&b.finish().value, Show::Normal, &RenderOptions::default(), &NoHost)?;
/// assert_eq!(normals.width(), 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn show(scene: &Scene, what: Show, options: &RenderOptions, host: &dyn Host) -> Result<Image, Error> {
    on_threads(options.threads, || show_here(scene, what, host))
}

fn show_here(scene: &Scene, what: Show, host: &dyn Host) -> Result<Image, Error> {
    let region = scene.settings.region();
    if what == Show::Cost {
        let costs = costs(scene, host)?;
        return Ok(heat_map(scene, &costs));
    }
    let mut world = World::compile_for(scene, host)?;
    world.uv_everywhere = true;
    let met = met(&world, host)?;
    let depths = || met.iter().flatten().map(|met| met.t);
    let (near, far) = (
        depths().fold(f64::INFINITY, f64::min),
        depths().fold(0.0, f64::max),
    );
    let color = |met: &Met| match what {
        Show::Normal => (met.normal + DVec3::ONE) * 0.5,
        Show::Uv => Color::new(fraction(met.uv[0]), fraction(met.uv[1]), 0.0),
        Show::Depth if far > near => {
            let farthest = near / far;
            Color::splat(0.1 + 0.9 * (near / met.t - farthest) / (1.0 - farthest))
        }
        Show::Depth => Color::ONE,
        Show::Object => {
            let path = world.places_of(met.number);
            ramp::distinct(path.iter().fold(0, |key, (group, index)| {
                mix(mix(key ^ u64::from(group.0)) ^ u64::from(*index))
            }))
        }
        Show::Line | Show::Cost => {
            let loc = world.objects_of(met.number).last().map(|object| object.loc);
            let file = loc.and_then(|loc| scene.files.get(usize::from(loc.file)));
            // A scene is called by its path from where the command runs; its name alone is the same everywhere.
            let name = file.map_or("", |file| file.rsplit('/').next().unwrap_or(file));
            let key = name.bytes().fold(0, |key, byte| mix(key ^ u64::from(byte)));
            ramp::distinct(mix(key ^ loc.map_or(0, |loc| u64::from(loc.line))))
        }
    };
    let pixels = met
        .iter()
        .map(|met| met.as_ref().map_or(Color::ZERO, color).to_array());
    Ok(Image::new(
        region.width,
        region.height,
        Encoding::Raw,
        pixels.collect(),
    ))
}

/// What each pixel costs, from black over red to white.
///
/// ```
/// use rtscript::{Builder, NoHost, render::show::{costs, heat_map}};
/// let mut b = Builder::new();
/// b.size(8, 6)?;
/// let scene = b.finish().value;
/// assert_eq!(heat_map(&scene, &costs(&scene, &NoHost)?).height(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn heat_map(scene: &Scene, costs: &[PixelCost]) -> Image {
    let most = costs.iter().map(PixelCost::work).max().unwrap_or(0);
    let scale = |work: u64| crate::math::ln(1.0 + work as f64);
    let pixels = costs.iter().map(|cost| {
        let share = scale(cost.work()) / scale(most).max(f64::MIN_POSITIVE);
        ramp::heat(share).to_array()
    });
    let region = scene.settings.region();
    Image::new(region.width, region.height, Encoding::Raw, pixels.collect())
}

/// From 0 up to, but not including, 1.
fn fraction(x: f64) -> f64 {
    x - x.floor()
}

/// What the ray through the middle of each pixel meets, rows from the top.
fn met(world: &World<'_>, host: &dyn Host) -> Result<Vec<Option<Met>>, Error> {
    let s = &world.scene.settings;
    let frame = world.scene.camera.frame(s.width, s.height);
    let region = s.region();
    by_rows((region.width, region.height), host, |x, y, _| {
        let ray = frame.ray(f64::from(region.x + x) + 0.5, f64::from(region.y + y) + 0.5)?;
        let hit = world.nearest(&Probe::from_space(ray), f64::INFINITY)?;
        let at = world.surface(&hit, &ray)?;
        Some(Met {
            t: hit.t,
            number: hit.number,
            normal: at.shading_normal,
            uv: at.uv.to_array(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, NoHost, scene::Term};

    fn pair() -> Scene {
        let mut b = Builder::new();
        b.size(40, 20).unwrap();
        b.directional(DVec3::Z, DVec3::ONE).unwrap();
        b.material_mut().diffuse = Term::color(DVec3::splat(0.5));
        b.sphere(DVec3::new(-1.5, 0.0, 0.0), 1.0).unwrap();
        b.sphere(DVec3::new(1.5, 0.0, -1.0), 1.0).unwrap();
        b.finish().value
    }

    fn shown(what: Show) -> impl Fn(u32, u32) -> Color {
        let image = show(&pair(), what, &RenderOptions::default(), &NoHost).unwrap();
        move |x, y| image.pixel(x, y).unwrap()
    }

    #[test]
    fn each_kind_shows_what_it_says() {
        let normal = shown(Show::Normal);
        assert!(normal(13, 9).z > 0.9, "{}", normal(13, 9));
        assert!(normal(9, 10).x < 0.4 && normal(16, 10).x > 0.6);
        assert_eq!(normal(0, 0), Color::ZERO);
        let depth = shown(Show::Depth);
        assert!(depth(13, 10).x > depth(25, 10).x && depth(25, 10).x >= 0.1);
        let object = shown(Show::Object);
        assert_eq!(object(13, 9), object(15, 11));
        assert_ne!(object(13, 10), object(25, 10));
        let line = shown(Show::Line);
        assert_eq!(line(13, 10), line(25, 10));
        let uv = shown(Show::Uv);
        assert!(uv(13, 6).y > uv(13, 13).y, "{} {}", uv(13, 6), uv(13, 13));
        let cost = shown(Show::Cost);
        assert!(cost(13, 10).x > cost(0, 0).x);
    }
}
