//! A [`Scene`] compiled for tracing.
//!
//! Each group of the scene becomes a [`Level`]: its shapes sorted by kind, what can be moved into the level's
//! space moved there, and one tree over everything. An instance is a primitive of the level that places it and
//! leads to another level. Whatever is hit has a number that is unique over all instances, in the order the
//! primitives stand in; the nearest hit is the one of least (t, number), whatever tree found it.

#![allow(
    clippy::indexing_slicing,
    reason = "a world refers by number only to what its own compilation put there"
)]

mod compile;
mod csg;
mod exact;
mod fields;
mod kept;
mod level;
mod moving;
mod origin;
mod outline;
mod packet;
mod placing;
mod query;
mod shaft;
#[cfg(test)]
mod suite;
mod surface;
#[cfg(test)]
mod tests;
mod through;
#[cfg(test)]
mod through_tests;
mod touched;
mod trace;
mod tree;

pub(crate) use crate::accel::PACKET;
pub use kept::KeptTrees;
pub(super) use moving::Moments;
pub(crate) use query::{Blocker, Hit, Probe};
pub(crate) use shaft::FewObstacles;
pub(crate) use surface::SurfacePoint;

use std::sync::Arc;

use super::{around::Around, interrupt::Interrupt, lighting::Lamp, solids};
use crate::{
    math::{Bounds3, DVec3, Ray},
    scene::Scene,
};
use level::Level;

/// A scene with its acceleration structures: what [`render`](crate::render()) traces, open to questions of
/// one's own.
///
/// ```
/// use rtscript::{Builder, DVec3, math::Ray, render::World};
/// let mut b = Builder::new();
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let world = World::compile(&scene)?;
/// let down = Ray::new(DVec3::new(0.0, 5.0, 0.0), DVec3::NEG_Y);
/// let hit = world.raycast(&down, f64::INFINITY).expect("the ray meets the sphere");
/// assert_eq!((hit.t, hit.normal), (4.0, DVec3::Y));
/// assert!(!world.is_occluded(&down, 3.9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct World<'s> {
    pub(crate) scene: &'s Scene,
    /// Levels; a level comes before the levels that place it, so the last is the root.
    levels: Arc<[Level<'s>]>,
    /// What the tree of each level is made from; empty where nothing is kept.
    keys: Vec<kept::Key>,
    /// Bytes of what is known beforehand of isosurfaces.
    fields: u64,
    /// Rays that go together are traced in packets; off for tests that compare.
    pub(crate) packets: bool,
    /// Looked at where a single question may go on for very long: in instances of instances.
    pub(super) interrupt: Option<&'s Interrupt<'s>>,
    /// What the lights of the root need besides what the scene says, by their number; empty where none needs anything.
    pub(super) lamps: Arc<[Lamp]>,
    /// Some lights do not reach all shapes.
    pub(super) is_linked: bool,
    /// What shadow rays pass brings nowhere more light than is sent, nor less than none.
    pub(super) shadows_dim: bool,
    /// Environment, ambient occlusion, fog and haze, where there is any of them.
    pub(super) around: Option<Arc<Around<'s>>>,
    /// Texture coordinates are wanted of every surface, also where no texture asks for them.
    pub(crate) uv_everywhere: bool,
    /// A texture asks how wide a pixel is.
    pub(crate) needs_width: bool,
    /// When it is, where things in it move: from 0 to 1.
    time: f64,
    /// Things in it move while the shutter is open.
    moves: bool,
    /// Textures ask what exactly a pixel covers.
    pub(crate) needs_footprint: bool,
}

/// What a ray met.
///
/// ```
/// use rtscript::{Builder, DVec3, math::Ray, render::{RayHit, World}};
/// let mut b = Builder::new();
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let world = World::compile(&scene)?;
/// let ray = Ray { origin: DVec3::Z * 5.0, dir: DVec3::NEG_Z };
/// let Some(RayHit { t, normal, number, .. }) = world.raycast(&ray, f64::INFINITY) else { panic!("a hit") };
/// assert_eq!((t, normal), (4.0, DVec3::Z));
/// assert_eq!(world.objects_of(number).len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Ray parameter: the point is `ray.at(t)`.
    pub t: f64,
    /// The primitive's number, unique over all instances.
    pub number: u64,
    /// Unit normal used for shading, turned to the side the ray came from.
    pub normal: DVec3,
}

impl<'s> World<'s> {
    /// How wide a pixel in the middle of the picture is after a way of so many units.
    pub(crate) fn pixel_width(&self, way: f64) -> f64 {
        let settings = &self.scene.settings;
        self.scene
            .camera
            .pixel_width(settings.width, settings.height, way)
    }

    /// The nearest hit of a ray with 0 < t <= `t_max`. The ray's direction may have any length but 0.
    #[must_use]
    pub fn raycast(&self, ray: &Ray, t_max: f64) -> Option<RayHit> {
        let hit = self.nearest(&Probe::from_space(*ray), t_max)?;
        let normal = self.surface(&hit, ray)?.shading_normal;
        Some(RayHit {
            t: hit.t,
            number: hit.number,
            normal,
        })
    }

    /// Whether a ray meets anything with 0 < t <= `t_max`, transparent things included.
    #[must_use]
    pub fn is_occluded(&self, ray: &Ray, t_max: f64) -> bool {
        self.blocker(&Probe::from_space(*ray), t_max) != Blocker::None
    }

    /// As [`World::raycast`], with t and the primitive's number only.
    #[must_use]
    pub fn nearest_t(&self, ray: &Ray, t_max: f64) -> Option<(f64, u64)> {
        self.nearest(&Probe::from_space(*ray), t_max)
            .map(|hit| (hit.t, hit.number))
    }

    /// [`World::nearest_t`] of each ray. Rays that leave one point in nearly one direction, 64 in a row, are
    /// traced together, which is faster; the answers are the same.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::Ray, render::World};
    /// let mut b = Builder::new();
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// let world = World::compile(&scene)?;
    /// // A range finder that looks down from a row of places.
    /// let rays: Vec<Ray> = (0..3).map(|x| Ray::new(DVec3::new(f64::from(x), 5.0, 0.0), DVec3::NEG_Y)).collect();
    /// let distances: Vec<Option<f64>> = world.nearest_t_many(&rays, 100.0).into_iter().map(|hit| Some(hit?.0)).collect();
    /// assert_eq!(distances, [Some(4.0), Some(5.0), None]);
    /// assert_eq!(world.nearest_t(&rays[0], 100.0).map(|(t, _)| t), Some(4.0));
    /// assert!(world.bytes() > 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn nearest_t_many(&self, rays: &[Ray], t_max: f64) -> Vec<Option<(f64, u64)>> {
        let mut found = Vec::with_capacity(rays.len());
        let mut probes = Vec::with_capacity(PACKET);
        for rays in rays.chunks(PACKET) {
            probes.clear();
            probes.extend(rays.iter().map(|ray| Probe::from_space(*ray)));
            let mut hits = [None; PACKET];
            self.nearest_many(&probes, t_max, &mut hits[..rays.len()]);
            found.extend(
                hits[..rays.len()]
                    .iter()
                    .map(|hit| hit.map(|hit| (hit.t, hit.number))),
            );
        }
        found
    }

    /// [`World::is_occluded`] of each ray with its own `t_max`, for as many as there are of both. Together as in
    /// [`World::nearest_t_many`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::Ray, render::World};
    /// let mut b = Builder::new();
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// let world = World::compile(&scene)?;
    /// // Is the ball between the lamp and these two places on the floor?
    /// let lamp = DVec3::Y * 5.0;
    /// let places = [DVec3::NEG_Y, DVec3::new(3.0, -1.0, 0.0)];
    /// let rays = places.map(|place| Ray::new(lamp, (place - lamp).normalize()));
    /// let distances = places.map(|place| (place - lamp).length() - 1e-6);
    /// assert_eq!(world.are_occluded(&rays, &distances), [true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn are_occluded(&self, rays: &[Ray], t_max: &[f64]) -> Vec<bool> {
        let mut occluded = Vec::with_capacity(rays.len());
        let mut probes = Vec::with_capacity(PACKET);
        for (rays, t_max) in rays.chunks(PACKET).zip(t_max.chunks(PACKET)) {
            let n = rays.len().min(t_max.len());
            probes.clear();
            probes.extend(rays.iter().map(|ray| Probe::from_space(*ray)));
            let mut found = [Blocker::None; PACKET];
            self.blockers(&probes[..n], &t_max[..n], &mut found[..n]);
            occluded.extend(found[..n].iter().map(|found| *found != Blocker::None));
        }
        occluded
    }

    /// Primitives that can be hit, each level counted once.
    #[must_use]
    pub fn primitives(&self) -> u64 {
        self.levels.iter().map(|level| level.primitives() as u64).sum()
    }

    /// Bytes of the compiled form, without the scene it refers to.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.bytes() as u64).sum::<u64>() + self.fields
    }

    /// A box around everything; `None` where something has no end, or where there is nothing.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds3> {
        self.root()?.bounds
    }

    /// Whether a point is inside of a solid or of a closed mesh, as three rays from it find that leave it in different
    /// directions. A point on a surface may be either.
    #[must_use]
    pub fn is_inside(&self, point: DVec3) -> bool {
        !solids::around(self, point, usize::MAX, |_| true).is_empty()
    }

    /// True once nobody wants an answer any more: any will do.
    #[inline]
    pub(super) fn is_stopped(&self) -> bool {
        self.interrupt.is_some_and(Interrupt::is_stopped)
    }

    fn root(&self) -> Option<&Level<'s>> {
        self.levels.last()
    }
}
