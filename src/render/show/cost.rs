//! What each pixel costs, counted rather than timed.

use crate::{
    color::Color,
    diag::Error,
    host::Host,
    math::Ray,
    render::{
        adaptive::Pixels,
        by_rows,
        integrator::{self, Counts, Sight, Stack},
        lighting::Lit,
        observe::{Arrived, Observer},
        shots::Shots,
        world::{Hit, Moments, Probe, SurfacePoint, World},
    },
    scene::Scene,
};

/// What one pixel costs, over all its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PixelCost {
    /// Rays from the camera, mirrored and refracted rays.
    pub rays: u64,
    /// Rays towards lights.
    pub shadow_rays: u64,
    /// Leaves of the tree whose boxes those rays touch on their way. What a render looks at is less where it finds out
    /// earlier that it need not, or looks at rays together; but this depends on the scene alone.
    pub boxes: u64,
    /// Number of the primitive that the first sample shows; `None` is the background.
    pub shows: Option<u64>,
}

impl PixelCost {
    /// Rays and boxes together.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.rays + self.shadow_rays + self.boxes
    }
}

/// What each pixel of a scene costs, rows from the top. Traces every ray.
///
/// # Errors
/// `Cancelled` where the host asks to stop, `Limit` where instancing multiplies past 2^62 primitives.
///
/// ```
/// use rtscript::{Builder, DVec3, NoHost, render::show::{PixelCost, costs, heat_map}};
/// let mut b = Builder::new();
/// b.size(8, 6)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let each: Vec<PixelCost> = costs(&scene, &NoHost)?;
/// assert!(each.iter().all(|pixel| pixel.rays >= 1 && pixel.work() >= 1));
/// assert_eq!(heat_map(&scene, &each).width(), 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn costs(scene: &Scene, host: &dyn Host) -> Result<Vec<PixelCost>, Error> {
    let world = World::compile_for(scene, host)?;
    let s = &scene.settings;
    let shots = Shots::into_world(&world, s);
    let region = s.region();
    by_rows((region.width, region.height), host, |x, y, interrupt| {
        let mut cost = PixelCost::default();
        let mut moments = Moments::new(&world);
        let (mut stack, mut counts) = (Stack::default(), Counts::default());
        let count = s.adaptive.map_or(shots.count(), |adaptive| {
            let pixels = Pixels {
                world: &world,
                shots: &shots,
                adaptive,
                interrupt,
            };
            pixels.alone((x, y)).samples * shots.eyes()
        });
        for index in 0..count {
            if interrupt.poll() {
                break;
            }
            let shot = shots.shot((x, y), index);
            let Some(probe) = shot.probe else { continue };
            let world = moments.at(&shot);
            let first = world.nearest(&probe, f64::INFINITY);
            if index == 0 {
                cost.shows = first.map(|hit| hit.number);
            }
            let mut meter = Meter {
                world,
                cost,
                under_way: None,
            };
            integrator::radiance(
                world,
                Sight::met(&probe, first),
                shot.sampler,
                interrupt,
                &mut stack,
                &mut counts,
                &mut meter,
            );
            cost = meter.cost;
        }
        (cost.rays, cost.shadow_rays) = (counts.total() - counts.shadow, counts.shadow);
        cost
    })
}

/// Counts the boxes that rays touch.
struct Meter<'w> {
    world: &'w World<'w>,
    cost: PixelCost,
    /// The ray of which it is not known yet what it meets.
    under_way: Option<Ray>,
}

impl Meter<'_> {
    fn arrive(&mut self, t: f64) {
        if let Some(ray) = self.under_way.take() {
            self.cost.boxes += self.world.leaves_touched(&Probe::from_space(ray), t);
        }
    }
}

impl Observer for Meter<'_> {
    fn ray(&mut self, ray: &Ray, _: Color, _: u32) {
        self.under_way = Some(*ray);
    }

    fn background(&mut self, _: Color, _: Color) {
        self.arrive(f64::INFINITY);
    }

    fn surface(&mut self, _: &Hit, ray: &Ray, at: &SurfacePoint<'_>) {
        self.arrive((at.position - ray.origin).length());
    }

    fn arrived(&mut self, _: &Lit<'_>, light: &Arrived<'_>) {
        self.cost.boxes += self.world.leaves_touched(light.probe, light.reach);
    }
}
