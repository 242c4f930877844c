//! Shadow rays of neighboring pixels towards one light, traced together before the pixels are shaded.

use super::{Luck, shadow_ray};
use crate::{
    math::DVec3,
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
    /// The rays to a light that are looked at together.
    probes: Vec<Probe>,
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
                reached.look_at(world, position, &self.points, hits, &mut self.probes);
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
    /// distance, which is read in its place: copied along with a single byte, it would be waited for.
    #[inline(always)]
    pub(super) fn of(&self, light: usize) -> Option<(bool, &(DVec3, f64))> {
        let reached = self.lights.get(light)?;
        let is_lit = reached.lit >> self.point & 1 == 1;
        let is_known = is_lit || reached.dark >> self.point & 1 == 1;
        is_known.then(|| (is_lit, &reached.ways[self.point % PACKET]))
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
        probes: &mut Vec<Probe>,
    ) {
        let mut which = [0u8; PACKET];
        let (mut distances, mut reach) = ([0.0; PACKET], [0.0; PACKET]);
        probes.clear();
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
            let (probe, t_max) = shadow_ray(at, hit.number, towards, distance);
            let n = probes.len();
            (which[n], distances[n], reach[n]) = (i as u8, distance, t_max);
            probes.push(probe);
        }
        let n = probes.len();
        let mut found = [Blocker::Transparent; PACKET];
        let ways = [&distances[..n], &reach[..n]];
        if world.blockers_before(light, probes, ways, &mut found[..n]) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, NoHost, Term, color::Color, math::Ray};

    /// A floor of triangles, opaque for x < 0 and of glass beyond, half of it below a roof; one lamp above, one below, one
    /// far away.
    #[test]
    fn what_is_known_beforehand_is_what_each_point_would_find() {
        let mut b = Builder::new();
        for y in [5.0, -5.0, 1e5] {
            b.point(DVec3::new(-1.0, y, 0.3), Color::ONE).unwrap();
        }
        b.material_mut().diffuse = Term::color(Color::ONE);
        let mut floor = |x: f64, kt: f64| {
            b.material_mut().transmission = Term::color(Color::splat(kt));
            let [p, q, r, s] =
                [(0.0, -2.0), (0.0, 2.0), (2.0, 2.0), (2.0, -2.0)].map(|(dx, z)| DVec3::new(x + dx, 0.0, z));
            b.triangle([p, q, r], None).unwrap();
            b.triangle([p, r, s], None).unwrap();
        };
        floor(-2.0, 0.0);
        floor(0.0, 0.5);
        b.material_mut().transmission = Term::color(Color::ZERO);
        let roof = [(-3.0, -3.0), (3.0, -3.0), (-3.0, 2.3)].map(|(x, z)| DVec3::new(x, 1.0, z));
        b.triangle(roof, None).unwrap();
        let scene = b.finish().value;
        let world = World::compile(&scene).unwrap();
        assert!(Ahead::is_of_use(&world));
        let eye = DVec3::new(0.1, 0.9, 0.0);
        let probes: Vec<Probe> = (0..PACKET)
            .map(|i| {
                let aim = DVec3::new(i as f64 % 8.0 / 10.0 - 0.55, 0.0, i as f64 / 80.0 - 0.33);
                Probe::from_space(Ray::new(eye, (aim - eye).normalize()))
            })
            .collect();
        let mut hits = [None; PACKET];
        world.nearest_many(&probes, f64::INFINITY, &mut hits);
        let (mut ahead, mut luck) = (Ahead::default(), Luck::default());
        let host = NoHost;
        ahead.look(&world, &probes, &hits, &Interrupt::new(&host), &mut luck);
        let mut found = [0; 3];
        for (i, hit) in hits.iter().enumerate() {
            let hit = hit.unwrap();
            let at = world.surface(&hit, &probes[i].ray).unwrap();
            let Some((point, known)) = ahead.of(i) else {
                assert!(at.position.x > 0.0, "nothing is known of glass alone");
                found[2] += 1;
                continue;
            };
            assert_eq!(point.position, at.position);
            let (is_lit, &(towards, distance)) = known.of(0).unwrap();
            let (probe, reach) = shadow_ray(&at, hit.number, towards, distance);
            assert_eq!(is_lit, world.blocker(&probe, reach) == Blocker::None);
            assert!((at.position + towards * distance - DVec3::new(-1.0, 5.0, 0.3)).length() < 1e-12);
            assert!(known.of(1).is_none() && known.of(2).is_none() && known.of(3).is_none());
            found[usize::from(is_lit)] += 1;
        }
        assert!(found.iter().all(|n| *n >= 8), "{found:?}");
    }

    #[test]
    fn nobody_looks_ahead_where_it_led_to_nothing() {
        let mut b = Builder::new();
        b.point(DVec3::Y * 5.0, Color::ONE).unwrap();
        b.material_mut().diffuse = Term::color(Color::ZERO);
        b.triangle(
            [
                DVec3::new(-9.0, 0.0, -9.0),
                DVec3::new(0.0, 0.0, 9.0),
                DVec3::new(9.0, 0.0, -9.0),
            ],
            None,
        )
        .unwrap();
        let scene = b.finish().value;
        let world = World::compile(&scene).unwrap();
        let probes = [Probe::from_space(Ray::new(DVec3::Y, DVec3::NEG_Y)); 8];
        let mut hits = [None; 8];
        world.nearest_many(&probes, f64::INFINITY, &mut hits);
        let (mut ahead, mut luck, host) = (Ahead::default(), Luck::default(), NoHost);
        let mut looks = 0;
        for _ in 0..64 {
            ahead.look(&world, &probes, &hits, &Interrupt::new(&host), &mut luck);
            looks += usize::from(ahead.of(0).is_some());
        }
        assert!((2..10).contains(&looks), "{looks}");
    }
}
