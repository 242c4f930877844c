//! Isosurfaces of a world: what is known of them before any ray comes, and the rays that need not know all of them.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    super::interrupt::Interrupt,
    level::{Level, PlacedShape},
    query::Probe,
};
use crate::{
    diag::Error,
    math::Ray,
    scene::Settings,
    shape::{CrossingSink, Crossings, Isosurface, Shape},
};

/// Operations for each ray of the camera that are done beforehand, and the fewest and the most of them in all: a part of
/// what the rays will take.
const FOR_EACH_RAY: usize = 8;
const FEWEST: usize = 1 << 13;
const MOST: usize = 1 << 21;

/// Prepares the isosurfaces of all levels, each once however often it is placed: bytes of what was made. Pictures do not
/// depend on it.
///
/// # Errors
/// Where the interrupt says so.
pub(super) fn prepare(
    levels: &mut [Level<'_>],
    settings: &Settings,
    interrupt: &Interrupt<'_>,
) -> Result<u64, Error> {
    let mut prepared = BTreeMap::new();
    let of_all = |levels: &mut [Level<'_>], f: &mut dyn FnMut(&mut Arc<Isosurface>)| {
        for placed in levels.iter_mut().flat_map(|level| &mut level.shapes) {
            if let Shape::Isosurface(surface) = &mut placed.shape {
                f(surface);
            }
        }
    };
    of_all(levels, &mut |surface| {
        prepared.insert(surface.identity(), None);
    });
    if prepared.is_empty() {
        return Ok(0);
    }
    let [width, height, samples] = [settings.width, settings.height, settings.samples].map(|n| n as usize);
    let rays = width.saturating_mul(height).saturating_mul(samples);
    let operations = rays.saturating_mul(FOR_EACH_RAY).clamp(FEWEST, MOST) / prepared.len();
    let mut bytes = 0;
    of_all(levels, &mut |surface| {
        let Some(known) = prepared.get_mut(&surface.identity()) else {
            return;
        };
        let made = known.get_or_insert_with(|| {
            let made = surface.prepared(operations, &|| interrupt.poll());
            bytes += made.prepared_bytes() as u64;
            Arc::new(made)
        });
        *surface = Arc::clone(made);
    });
    match interrupt.poll() {
        true => Err(interrupt.reason().into()),
        false => Ok(bytes),
    }
}

/// Takes the crossings of an isosurface that matter to a ray.
struct Near {
    crossings: Crossings,
    least: f64,
    most: f64,
    /// One beyond this is the last that matters.
    enough: f64,
    is_served: bool,
}

impl CrossingSink for Near {
    fn push(&mut self, t: f64, part: u32) {
        self.crossings.push(t, part);
        self.is_served |= t > self.enough;
    }

    fn span(&self) -> (f64, f64) {
        (self.least, self.most)
    }

    fn is_served(&self) -> bool {
        self.is_served
    }
}

impl PlacedShape {
    /// The crossings that matter to a probe that counts nothing beyond `most`, among them its own start: all of them, or
    /// those up to the first that counts. `ray` is the probe's, in the level's space.
    #[cold]
    #[inline(never)]
    pub(super) fn near_crossings(
        &self,
        ray: &Ray,
        probe: &Probe,
        number: u64,
        most: f64,
        is_first_enough: bool,
    ) -> Crossings {
        let (least, enough) = probe.around_start(number);
        let mut near = Near {
            crossings: Crossings::default(),
            least,
            most,
            enough: if is_first_enough { enough } else { f64::INFINITY },
            is_served: false,
        };
        self.shape
            .crossings(&ray.transformed(&self.object_from_level), &mut near);
        near.crossings
    }
}
