//! Many rays at once: in packets where they go together, one by one where they do not. The answers are the same.

use super::{
    World,
    exact::Exact,
    level::Level,
    query::{Blocker, Hit, Probe, Query},
    trace::above,
};
use crate::{
    accel::{
        BEFORE_END, Child, DONE, Decide, Ends, HasRay, NONE, PACKET, Place, RayPacket, Search, Spot, rays,
    },
    math::{DVec3, Ray, larger, max_abs, smaller},
    shape::{
        triangle::TriangleRay,
        triangles::{MANY, ManyTriangles},
    },
};

/// Fewest rays that are traced as a packet.
const FEWEST: usize = 5;

/// How many times as far away as anything else a light and the points it shines on may be, for their rays to be traced
/// together: what the tests allow for grows with the coordinates.
const FAR: f64 = 16.0;

impl World<'_> {
    /// [`World::nearest`] for each of the probes; `hits` is as long.
    pub(crate) fn nearest_many(&self, probes: &[Probe], t_max: f64, hits: &mut [Option<Hit>]) {
        for (probes, hits) in probes.chunks(PACKET).zip(hits.chunks_mut(PACKET)) {
            let bounds = [t_max; PACKET];
            let answer = |i: usize, query: &Query<'_>, _| hits[i] = query.hit();
            if !self.together::<false>(probes, &bounds[..probes.len()], answer) {
                for (probe, hit) in probes.iter().zip(hits) {
                    *hit = self.nearest(probe, t_max);
                }
            }
        }
    }

    /// [`World::blocker`] for each of the probes, each up to its own `t_max`; all slices are as long.
    pub(crate) fn blockers(&self, probes: &[Probe], t_max: &[f64], found: &mut [Blocker]) {
        let chunks = probes.chunks(PACKET).zip(t_max.chunks(PACKET));
        for ((probes, t_max), found) in chunks.zip(found.chunks_mut(PACKET)) {
            let answer = |i: usize, query: &Query<'_>, stopped| found[i] = query.blocker(stopped);
            if !self.together::<true>(probes, t_max, answer) {
                for ((probe, t_max), found) in probes.iter().zip(t_max).zip(found) {
                    *found = self.blocker(probe, *t_max);
                }
            }
        }
    }

    /// Whether it is likely to be worth it to look together for what is before the points where neighboring rays hit
    /// something: where that is mostly triangles, which a packet decides several of at a time.
    pub(crate) fn are_neighbors(&self, hits: &[Option<Hit>]) -> bool {
        let triangles = self.root().map_or(0, |root| root.triangles.len() as u64);
        let (mut met, mut on_triangles) = (0, 0);
        for hit in hits.iter().flatten() {
            met += 1;
            on_triangles += usize::from(hit.number < triangles);
        }
        met >= FEWEST && 2 * on_triangles >= met
    }

    /// [`World::blocker`] for up to [`PACKET`] probes that all lead to `light`, each `distances` away from its start, and
    /// ask for what is before `t_max`; all slices are as long. False where they do not go together: then nothing was
    /// answered.
    ///
    /// As the rays end at one point and not at all begin at one, the tree is searched from there back to the starts. That
    /// only sorts out what cannot be in the way: what may be is met by the probes themselves.
    pub(crate) fn blockers_before(
        &self,
        light: DVec3,
        probes: &[Probe],
        [distances, t_max]: [&[f64]; 2],
        found: &mut [Blocker],
    ) -> bool {
        let n = probes.len().min(PACKET);
        let Some(root) = self.root().filter(|_| self.packets && n >= FEWEST) else {
            return false;
        };
        let (probes, distances) = (&probes[..n], &distances[..n]);
        let starts = probes.iter().map(|probe| max_abs(probe.ray.origin));
        let extent = starts.fold(0.0, larger);
        let (nearest, farthest) = distances
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least, most), d| {
                (smaller(least, *d), larger(most, *d))
            });
        let t_min = probes.iter().fold(0.0, |t, probe| larger(probe.t_min, t));
        let reach = FAR * f64::from(root.bvh.extent());
        if !(extent <= reach && max_abs(light) <= reach && t_min <= 0.1 * f64::from(BEFORE_END) * nearest) {
            return false;
        }
        let (mut primitives, mut back, mut bounds) =
            ([NONE; PACKET], [probes[0].ray; PACKET], [DONE; PACKET]);
        for (i, (probe, distance)) in probes.iter().zip(distances).enumerate() {
            primitives[i] = u32::try_from(probe.start).unwrap_or(NONE);
            back[i] = Ray::new(light, -probe.ray.dir);
            bounds[i] = above(*distance);
        }
        let search = Search {
            extent: root.extent,
            // Light is looked for up to a little before its source.
            t_min: f64::from(BEFORE_END) * farthest,
            skip: NONE,
            ends: Some(Ends {
                extent,
                primitives: &primitives[..n],
            }),
        };
        let bundle = Bundle {
            seen: &back[..n],
            bounds: &bounds[..n],
            search,
        };
        self.search_together::<true>(root, probes, t_max, &bundle, |i, query, stopped| {
            found[i] = query.blocker(stopped);
        })
    }

    /// Answers up to [`PACKET`] queries with one packet. False where they do not go together: then nothing was
    /// answered.
    fn together<'p, const ANY: bool>(
        &self,
        probes: &'p [Probe],
        t_max: &[f64],
        answer: impl FnMut(usize, &Query<'p>, bool),
    ) -> bool {
        let (Some(root), Some(first)) = (self.root(), probes.first()) else {
            return false;
        };
        if !self.packets || probes.len() < FEWEST || probes.iter().any(|probe| probe.start != first.start) {
            return false;
        }
        let n = probes.len().min(t_max.len()).min(PACKET);
        let mut bounds = [DONE; PACKET];
        for (bound, t_max) in bounds.iter_mut().zip(t_max) {
            *bound = above(*t_max);
        }
        let search = Search {
            extent: root.extent,
            t_min: probes.iter().map(|probe| probe.t_min).fold(first.t_min, larger),
            skip: u32::try_from(first.start).unwrap_or(NONE),
            ends: None,
        };
        let bundle = Bundle {
            seen: &probes[..n],
            bounds: &bounds[..n],
            search,
        };
        self.search_together::<ANY>(root, &probes[..n], t_max, &bundle, answer)
    }

    /// Searches the root with a packet for each probe's answer. False where the rays do not go together: then nothing was
    /// answered.
    #[inline(always)]
    fn search_together<'p, const ANY: bool>(
        &self,
        root: &Level<'_>,
        probes: &'p [Probe],
        t_max: &[f64],
        bundle: &Bundle<'_, impl HasRay>,
        mut answer: impl FnMut(usize, &Query<'p>, bool),
    ) -> bool {
        let n = probes.len();
        let mut queries: [Query<'_>; PACKET] =
            std::array::from_fn(|i| Query::new(&probes[i.min(n - 1)], t_max[i.min(n - 1)]));
        let queries = &mut queries[..n];
        let place = Place {
            bvh: &root.bvh,
            triangles: &root.triangle_blocks,
            spheres: &root.sphere_blocks,
            first_sphere: root.triangles.len() as u32,
            cuboids: &root.cuboid_blocks,
            cuboid_extent: root.cuboid_extent,
        };
        let mut decider = Decider::<ANY> {
            world: self,
            level: root,
            queries,
            pairs: ManyTriangles::EMPTY,
        };
        let mut packet = RayPacket::EMPTY;
        if !packet.search::<ANY>(&place, bundle.seen, bundle.bounds, &bundle.search, &mut decider) {
            return false;
        }
        let stopped = packet.done();
        for (i, query) in queries.iter().enumerate() {
            answer(i, query, stopped >> i & 1 == 1);
        }
        true
    }
}

/// What the tree is searched with for several probes: rays from one point, and how far they look.
struct Bundle<'a, R> {
    seen: &'a [R],
    bounds: &'a [f32],
    search: Search<'a>,
}

/// Decides what the rays of a packet hit, as a search does for one.
struct Decider<'a, 's, 'p, const ANY: bool> {
    world: &'a World<'s>,
    level: &'a Level<'s>,
    queries: &'a mut [Query<'p>],
    pairs: ManyTriangles,
}

impl<'s, 'p, const ANY: bool> Decider<'_, 's, 'p, ANY> {
    /// Asks for one ray and returns the ray's bound.
    #[inline(always)]
    fn ask(&mut self, ray: usize, question: impl FnOnce(&mut Exact<'_, 's, 'p, ANY>) -> bool) -> f32 {
        let query = &mut self.queries[ray];
        let mut exact = Exact {
            world: self.world,
            level: self.level,
            base: 0,
            ray: &query.probe.ray,
            query,
        };
        if question(&mut exact) {
            DONE
        } else if ANY {
            f32::INFINITY
        } else {
            above(exact.query.best.t)
        }
    }
}

impl<const ANY: bool> Decide for Decider<'_, '_, '_, ANY> {
    fn begin(&mut self, packet: &mut RayPacket) {
        for &index in &self.level.unbounded {
            self.other(u64::MAX >> (PACKET - self.queries.len()), index, packet);
        }
    }

    #[inline(always)]
    fn last(&mut self, pairs: &[(u8, Spot)], packet: &mut RayPacket) {
        let level = self.level;
        for pairs in pairs.chunks(MANY) {
            for &(ray, spot) in pairs {
                let ((block, lane), query) = (spot.get(), &self.queries[usize::from(ray)]);
                let (block, ray) = (&level.triangle_blocks[block], &query.probe.ray);
                let axes = TriangleRay::axes(ray.dir);
                self.pairs.push(ray, axes, level.corners_in(block, lane, axes));
            }
            let queries = &mut *self.queries;
            self.pairs.intersect(|i, hit| {
                let ((block, lane), ray) = (pairs[i].1.get(), usize::from(pairs[i].0));
                let id = level.triangle_blocks[block].ids[lane];
                let number = u64::from(id);
                if queries[ray].offer_triangle::<ANY>(number, hit, || level.may_be_transparent(id)) {
                    packet.lower_bound(ray, DONE);
                }
            });
        }
    }

    #[inline(always)]
    fn triangles(&mut self, ray: usize, spots: &[Spot]) -> f32 {
        self.ask(ray, |exact| {
            let own = TriangleRay::new(exact.ray);
            spots.iter().any(|spot| {
                let (block, lane) = spot.get();
                exact.triangle_in(&own, &exact.level.triangle_blocks[block], lane)
            })
        })
    }

    #[inline(always)]
    fn sphere(&mut self, ray: usize, id: u32) -> f32 {
        self.ask(ray, |exact| exact.sphere(id))
    }

    fn other(&mut self, mask: u64, index: u32, packet: &mut RayPacket) {
        for ray in rays(mask) {
            let bound = self.ask(ray, |exact| exact.any(index));
            packet.lower_bound(ray, bound);
        }
    }

    fn alone(&mut self, ray: usize, below: Child, bound: f32) -> f32 {
        self.ask(ray, |exact| exact.below(below, bound))
    }

    #[inline(always)]
    fn ends(&self, id: u32) -> bool {
        !self.level.may_be_transparent(id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, DVec3};

    #[test]
    fn neighbors_go_together_and_strangers_do_not() {
        let mut b = Builder::new();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        let scene = b.finish().value;
        let mut world = World::compile(&scene).unwrap();
        let fan = |spread: f64, apart: f64| -> Vec<Probe> {
            (0..PACKET)
                .map(|i| {
                    let (x, y) = (i as f64 / 64.0 - 0.5, (i % 8) as f64 / 8.0 - 0.5);
                    let dir = DVec3::new(x * spread, y * spread, -1.0);
                    Probe::from_space(Ray::new(DVec3::new(x * apart, 0.0, 5.0), dir))
                })
                .collect()
        };
        let together = |world: &World<'_>, probes: &[Probe]| {
            let mut answers = 0;
            let t_max = [f64::INFINITY; PACKET];
            let went = world.together::<false>(probes, &t_max[..probes.len()], |_, _, _| answers += 1);
            assert_eq!(answers, if went { probes.len() } else { 0 });
            went
        };
        assert!(together(&world, &fan(0.1, 0.0)));
        assert!(!together(&world, &fan(0.1, 0.1)), "not from one point");
        assert!(!together(&world, &fan(3.0, 0.0)), "not in one direction");
        assert!(!together(&world, &fan(f64::NAN, 0.0)), "not rays");
        assert!(!together(&world, &fan(0.1, 0.0)[..FEWEST - 1]), "too few");
        world.packets = false;
        assert!(!together(&world, &fan(0.1, 0.0)), "not allowed");
    }
}
