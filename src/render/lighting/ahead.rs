//! Shadow rays of neighboring pixels towards one light, traced together before the pixels are shaded.

use super::{Luck, shadow_ray};
use crate::{
    math::{DVec3, Ray},
    render::{
        interrupt::Interrupt,
        world::{Blocker, Hit, PACKET, Probe, SurfacePoint, World},
    },
    scene::LightKind,
};

/// Lights that are looked at, the first of the scene: a table of them stays in the nearest caches.
const LIGHTS: usize = 8;

/// What camera rays see that were traced together, found out for all of them before the first is shaded.
#[derive(Debug, Default)]
pub(in crate::render) struct Ahead<'w> {
    /// Where they hit something; empty where that was not looked at.
    points: Vec<Option<SurfacePoint<'w>>>,
    /// Which lights reach the points, by the number of the light.
    lights: Vec<Reached>,
}

/// Points as bits of a number, and the ways from them.
#[derive(Clone, Copy, Debug)]
struct Reached {
    /// Nothing is before the light.
    lit: u64,
    /// Something is that lets no light through.
    dark: u64,
    /// The unit vector towards the light, and its distance, for the points in either.
    ways: [(DVec3, f64); PACKET],
}

impl Reached {
    const NOTHING: Self = Self {
        lit: 0,
        dark: 0,
        ways: [(DVec3::ZERO, 0.0); PACKET],
    };
}

/// Of one point, which lights reach it, as far as that is known beforehand.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::render) struct Known<'a> {
    lights: &'a [Reached],
    point: usize,
}

impl<'w> Ahead<'w> {
    /// Whether it is of use to look ahead: where there is light from a point, no air between it and a surface, and a surface is
    /// no more than its point.
    pub(in crate::render) fn is_of_use(world: &World<'_>) -> bool {
        let is_hazy = world.around.as_ref().is_some_and(|around| around.haze.is_some());
        let mut lights = world.scene.root().lights.iter();
        world.packets
            && !is_hazy
            && !world.needs_width
            && !world.is_linked
            && lights.any(|light| matches!(light.kind, LightKind::Point { .. }))
    }

    /// Looks at the points where up to [`PACKET`] rays hit something and at what is before the lights there, if that
    /// is likely to be of use.
    #[inline(never)]
    pub(in crate::render) fn look(
        &mut self,
        world: &World<'w>,
        probes: &[Probe],
        hits: &[Option<Hit>],
        interrupt: &Interrupt<'_>,
        luck: &mut Luck,
    ) {
        if !world.are_neighbors(hits) || !luck.ahead.are_worth_one() {
            self.points.clear();
            return;
        }
        self.points.resize(probes.len(), None);
        let mut met = 0;
        for ((probe, hit), point) in probes.iter().zip(hits).zip(&mut self.points) {
            match hit {
                Some(hit) => {
                    world.surface_into(hit, &probe.ray, point);
                    met += 1;
                }
                None => *point = None,
            }
        }
        let lights = &world.scene.root().lights;
        self.lights.resize(lights.len().min(LIGHTS), Reached::NOTHING);
        let mut known = 0;
        for (light, reached) in lights.iter().zip(&mut self.lights) {
            (reached.lit, reached.dark) = (0, 0);
            if let LightKind::Point { position, .. } = light.kind
                && !interrupt.poll()
            {
                reached.look_at(world, position, &self.points, hits);
                known += (reached.lit | reached.dark).count_ones();
            }
        }
        luck.ahead.remember(2 * known >= met);
    }

    /// What was found out about ray `i`: where it hits something opaque, and which lights reach that.
    #[inline(always)]
    pub(in crate::render) fn of(&self, i: usize) -> Option<(&SurfacePoint<'w>, Known<'_>)> {
        // Where something transparent touches something opaque, the opaque one is what is seen.
        let is_settled = |at: &&SurfacePoint<'_>| at.material.transmission.is_black();
        let point = self.points.get(i)?.as_ref().filter(is_settled)?;
        let known = Known {
            lights: &self.lights,
            point: i,
        };
        Some((point, known))
    }
}

impl Known<'_> {
    /// Whether the light of this number reaches the point, where that is known, and the way there: the unit vector and the
    /// distance.
    #[inline(always)]
    pub(super) fn of(&self, light: usize) -> Option<(bool, (DVec3, f64))> {
        let reached = self.lights.get(light)?;
        let is_lit = reached.lit >> self.point & 1 == 1;
        let is_known = is_lit || reached.dark >> self.point & 1 == 1;
        is_known.then(|| (is_lit, reached.ways[self.point % PACKET]))
    }
}

impl Reached {
    /// Finds out which of the points a light reaches, of those that face it and let no light through themselves.
    fn look_at(
        &mut self,
        world: &World<'_>,
        light: DVec3,
        points: &[Option<SurfacePoint<'_>>],
        hits: &[Option<Hit>],
    ) {
        let mut which = [0u8; PACKET];
        let (mut distances, mut reach) = ([0.0; PACKET], [0.0; PACKET]);
        let mut probes = [Probe::from_space(Ray::new(light, DVec3::ZERO)); PACKET];
        let mut n = 0;
        for (i, (point, hit)) in points.iter().zip(hits).enumerate().take(PACKET) {
            let (Some(at), Some(hit)) = (point, hit) else {
                continue;
            };
            let offset = light - at.position;
            let material = at.material;
            if !(at.shading_normal.dot(offset) > 0.0)
                || material.diffuse.is_black()
                || !material.transmission.is_black()
            {
                continue;
            }
            let distance = offset.length();
            let towards = offset / distance;
            self.ways[i] = (towards, distance);
            which[n] = i as u8;
            distances[n] = distance;
            (probes[n], reach[n]) = shadow_ray(at, hit.number, towards, distance);
            n += 1;
        }
        let mut found = [Blocker::Transparent; PACKET];
        let ways = [&distances[..n], &reach[..n]];
        if world.blockers_before(light, &probes[..n], ways, &mut found[..n]) {
            for (which, found) in which[..n].iter().zip(&found) {
                let bit = 1 << which;
                match found {
                    Blocker::None => self.lit |= bit,
                    Blocker::Opaque => self.dark |= bit,
                    Blocker::Transparent => {}
                }
            }
        }
    }
}
