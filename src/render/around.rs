//! What is around everything and between all things, ready for a picture. Scenes that have none of it have no such value,
//! and pay for one look at that.

use std::sync::Arc;

use super::{
    environment::Surround,
    integrator::Counts,
    lighting,
    path::Path,
    world::{SurfacePoint, World},
};
use crate::{
    color::Color,
    math::{self, DVec3, Ray},
    scene::{Fog, Haze, Occlusion, Scene, Surroundings},
};

/// The surroundings of a scene.
#[derive(Debug)]
pub(super) struct Around<'s> {
    pub(super) surround: Option<Surround<'s>>,
    pub(super) occlusion: Option<Occlusion>,
    pub(super) haze: Option<Haze>,
    fog: Option<Fog>,
}

/// What air does on the way from a point to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Air {
    /// Share of light that passes.
    pub(super) passed: Color,
    /// Light that the air itself sends.
    pub(super) scattered: Color,
}

impl<'s> Around<'s> {
    /// `None` where the scene has nothing of the kind.
    pub(super) fn new(scene: &'s Scene) -> Option<Arc<Self>> {
        let surroundings = &scene.settings.surroundings;
        (*surroundings != Surroundings::default()).then(|| {
            Arc::new(Self {
                surround: Surround::new(scene),
                occlusion: surroundings.occlusion,
                haze: surroundings.haze.filter(|haze| haze.density() > 0.0),
                fog: surroundings.fog,
            })
        })
    }

    /// What a ray sees that leaves the scene in the direction `dir`.
    #[cold]
    #[inline(never)]
    pub(super) fn beyond(&self, background: Color, dir: DVec3) -> Color {
        self.surround
            .as_ref()
            .map_or(background, |surround| surround.radiance(dir))
    }

    /// What the air does along a ray up to `t`, which may be infinite, to what is to be seen at its end; `None` where
    /// there is none: without fog and haze, and inside of what is transparent.
    #[cold]
    #[inline(never)]
    pub(super) fn air(
        &self,
        world: &World<'_>,
        (ray, t): (&Ray, f64),
        at: Option<&SurfacePoint<'_>>,
        path: &Path<'_>,
        counts: &mut Counts,
    ) -> Option<Air> {
        let is_inside = at.is_some_and(|at| !at.from_front && !at.material.transmission.is_black());
        if is_inside || (self.fog.is_none() && self.haze.is_none()) {
            return None;
        }
        let mut air = Air {
            passed: Color::ONE,
            scattered: Color::ZERO,
        };
        if let Some(haze) = &self.haze {
            air.passed *= math::exp(-haze.density() * t);
            air.scattered = lighting::scattered(world, haze, (ray, t), path, counts);
        }
        if let Some(fog) = &self.fog {
            let left = math::exp(-depth(fog, ray, t));
            air.passed *= left;
            air.scattered = air.scattered * left + fog.color() * (1.0 - left);
        }
        Some(air)
    }
}

/// Optical depth of fog along a ray with a unit vector for its direction.
fn depth(fog: &Fog, ray: &Ray, t: f64) -> f64 {
    let Some(height) = fog.height() else {
        return t / fog.distance();
    };
    let here = math::exp(-(ray.origin.y - fog.base()) / height) / fog.distance();
    // The integral of exp(-k s) from 0 to t.
    let k = ray.dir.y / height;
    let way = if t.is_infinite() {
        if k > 0.0 { 1.0 / k } else { f64::INFINITY }
    } else if (k * t).abs() < 1e-9 {
        t
    } else {
        -math::expm1(-k * t) / k
    };
    // No fog is no fog, however far.
    if here == 0.0 { 0.0 } else { here * way }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fog_is_as_deep_as_its_density_integrated() {
        let fog = Fog::new(Color::ONE, 3.0, 1.0, Some(0.7)).unwrap();
        for (y, dir, t) in [
            (2.0, DVec3::new(0.6, -0.8, 0.0), 2.5),
            (0.5, DVec3::new(0.6, 0.8, 0.0), 4.0),
            (1.3, DVec3::X, 4.0),
            (1.3, DVec3::new(1.0, 1e-12, 0.0), 4.0),
        ] {
            let ray = Ray::new(DVec3::new(0.0, y, 0.0), dir);
            let steps = 20_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let s = (f64::from(i) + 0.5) / f64::from(steps) * t;
                    math::exp(-(ray.at(s).y - 1.0) / 0.7) / 3.0 * t / f64::from(steps)
                })
                .sum();
            assert!((depth(&fog, &ray, t) - sum).abs() < 1e-7 * sum, "{dir}");
        }
        let up = Ray::new(DVec3::Y, DVec3::Y);
        assert!((depth(&fog, &up, f64::INFINITY) - 0.7 / 3.0).abs() < 1e-15);
        let down = Ray::new(DVec3::Y, DVec3::NEG_Y);
        assert_eq!(depth(&fog, &down, f64::INFINITY), f64::INFINITY);
    }
}
