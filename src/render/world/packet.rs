//! Many rays at once: in packets where they go together, one by one where they do not. The answers are the same.

use super::{
    World,
    exact::Exact,
    level::Level,
    query::{Blocker, Hit, Probe, Query},
    trace::above,
};
use crate::{
    accel::{DONE, Decide, NONE, PACKET, Place, RayPacket, Search, rays},
    math::Ray,
    shape::{
        triangle::TriangleRay,
        triangles::{MANY, ManyTriangles},
    },
};

/// Fewest rays that are traced as a packet.
const FEWEST: usize = 5;

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

    /// Answers up to [`PACKET`] queries with one packet. False where they do not go together: then nothing was
    /// answered.
    fn together<'p, const ANY: bool>(
        &self,
        probes: &'p [Probe],
        t_max: &[f64],
        mut answer: impl FnMut(usize, &Query<'p>, bool),
    ) -> bool {
        let (Some(root), Some(first)) = (self.root(), probes.first()) else {
            return false;
        };
        if !self.packets || probes.len() < FEWEST || probes.iter().any(|probe| probe.start != first.start) {
            return false;
        }
        let n = probes.len().min(t_max.len()).min(PACKET);
        let own: [Ray; PACKET] = std::array::from_fn(|i| probes[i.min(n - 1)].ray);
        let mut queries: [Query<'_>; PACKET] =
            std::array::from_fn(|i| Query::new(&probes[i.min(n - 1)], t_max[i.min(n - 1)]));
        let t_min = probes.iter().map(|probe| probe.t_min).fold(first.t_min, f64::max);
        let queries = &mut queries[..n];
        let Some(stopped) = self.search_packet::<ANY>(root, 0, &own[..n], queries, (first.start, t_min))
        else {
            return false;
        };
        for (i, query) in queries.iter().enumerate() {
            answer(i, query, stopped >> i & 1 == 1);
        }
        true
    }

    /// Searches a level whose first primitive has the number `base` with rays of the level's space, one for each
    /// query. Returns one bit for each whose search was ended; `None` where the rays do not go together: then
    /// nothing was done.
    fn search_packet<const ANY: bool>(
        &self,
        level: &Level,
        base: u64,
        own: &[Ray],
        queries: &mut [Query<'_>],
        (start, t_min): (u64, f64),
    ) -> Option<u64> {
        let skip = start
            .checked_sub(base)
            .filter(|&index| index < level.triangles.len() as u64);
        let search = Search {
            extent: level.extent,
            t_min,
            skip: skip.map_or(NONE, |index| index as u32),
        };
        let place = Place {
            bvh: &level.bvh,
            triangles: &level.triangle_blocks,
            spheres: &level.sphere_blocks,
            cuboids: &level.cuboid_blocks,
            cuboid_extent: level.cuboid_extent,
        };
        let mut bounds = [DONE; PACKET];
        for (bound, query) in bounds.iter_mut().zip(&*queries) {
            *bound = above(query.best.t);
        }
        let mut decider = Decider::<ANY> {
            world: self,
            level,
            base,
            own,
            queries,
            pairs: ManyTriangles::EMPTY,
        };
        let mut packet = RayPacket::EMPTY;
        let n = own.len().min(PACKET);
        packet
            .search::<ANY>(&place, own, &bounds[..n], &search, &mut decider)
            .then(|| packet.done())
    }
}

/// Decides what the rays of a packet hit, as a search does for one.
struct Decider<'a, 's, 'p, const ANY: bool> {
    world: &'a World<'s>,
    level: &'a Level<'s>,
    base: u64,
    own: &'a [Ray],
    queries: &'a mut [Query<'p>],
    pairs: ManyTriangles,
}

impl<'s, 'p, const ANY: bool> Decider<'_, 's, 'p, ANY> {
    /// Asks for one ray and returns the ray's bound.
    #[inline(always)]
    fn ask(&mut self, ray: usize, question: impl FnOnce(&mut Exact<'_, 's, 'p, ANY>) -> bool) -> f32 {
        let mut exact = Exact {
            world: self.world,
            level: self.level,
            base: self.base,
            ray: &self.own[ray],
            query: &mut self.queries[ray],
        };
        if question(&mut exact) {
            DONE
        } else {
            above(exact.query.best.t)
        }
    }
}

impl<const ANY: bool> Decide for Decider<'_, '_, '_, ANY> {
    fn begin(&mut self, packet: &mut RayPacket) {
        for &index in &self.level.unbounded {
            self.other(u64::MAX >> (PACKET - self.own.len()), index, packet);
        }
    }

    #[inline(always)]
    fn last(&mut self, pairs: &[(u8, u32)], packet: &mut RayPacket) {
        let (level, base) = (self.level, self.base);
        for pairs in pairs.chunks(MANY) {
            for &(ray, id) in pairs {
                self.pairs.push(&self.own[usize::from(ray)], level.corners(id));
            }
            let queries = &mut *self.queries;
            self.pairs.intersect(|i, hit| {
                let (ray, id) = (usize::from(pairs[i].0), pairs[i].1);
                let number = base + u64::from(id);
                if queries[ray].offer_triangle::<ANY>(number, hit, || level.may_be_transparent(id)) {
                    packet.lower_bound(ray, DONE);
                }
            });
        }
    }

    #[inline(always)]
    fn triangles(&mut self, ray: usize, ids: &[u32]) -> f32 {
        self.ask(ray, |exact| {
            let own = TriangleRay::new(exact.ray);
            ids.iter().any(|&id| exact.triangle_of(&own, id))
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
