//! Packets through whole trees, few and small enough for Miri, which sees every unchecked access of the walk, and each
//! operation of their registers.

#![allow(unsafe_code)]

use super::{
    super::{BLOCK, Box32, Bvh, Child, Cuboids, Kinds, NONE, Primitive, Spheres, Spot, Triangles, cases},
    DONE, Decide, PACKET, Place, RayPacket, Search, rays,
    wide::{Plain, Wide},
};
use crate::{
    math::{Bounds3, DAffine3, DVec3, Ray, max_abs},
    shape::{Sphere, triangle::TriangleRay},
};

/// What stands in the tree: triangles first, then spheres, then boxes and what is neither, which is spheres again.
struct Things {
    triangles: Vec<[DVec3; 3]>,
    spheres: Vec<(DVec3, f64)>,
    boxes: Vec<Bounds3>,
    others: Vec<(DVec3, f64)>,
}

impl Things {
    fn at_random(n: usize, next: &mut impl FnMut() -> f64) -> Self {
        let mut place = || DVec3::new(next(), next(), next()) * 4.0 - 2.0;
        let mut near = |k: f64| (place(), place() * k, place() * k);
        Self {
            triangles: (0..n)
                .map(|_| near(0.5))
                .map(|(a, b, c)| [a, a + b, a + c])
                .collect(),
            spheres: (0..n).map(|_| near(0.0).0).map(|p| (p, 0.3)).collect(),
            boxes: (0..n)
                .map(|_| near(0.2))
                .map(|(a, b, c)| Bounds3::around([a, a + b, a + c]))
                .collect(),
            others: (0..n).map(|_| near(0.0).0).map(|p| (p, 0.2)).collect(),
        }
    }

    fn firsts(&self) -> [usize; 3] {
        let boxes = self.triangles.len() + self.spheres.len();
        [self.triangles.len(), boxes, boxes + self.boxes.len()]
    }

    fn count(&self) -> usize {
        self.firsts()[2] + self.others.len()
    }

    fn bounds(&self, index: usize) -> Bounds3 {
        let [spheres, boxes, others] = self.firsts();
        let around = |(center, radius): (DVec3, f64)| Bounds3::new(center - radius, center + radius);
        match index {
            i if i < spheres => Bounds3::around(self.triangles[i]),
            i if i < boxes => around(self.spheres[i - spheres]),
            i if i < others => self.boxes[i - boxes],
            i => around(self.others[i - others]),
        }
    }

    /// Where a ray first meets one of them ahead.
    fn hit(&self, index: usize, ray: &Ray) -> Option<f64> {
        let [spheres, boxes, others] = self.firsts();
        let ahead = |roots: Option<(f64, f64)>| {
            let (a, b) = roots?;
            Some(if a > 0.0 { a } else { b }).filter(|t| *t > 0.0)
        };
        let of_sphere = |(center, radius): (DVec3, f64)| ahead(Sphere::roots(center, radius, ray));
        match index {
            i if i < spheres => {
                let hit = TriangleRay::new(ray).intersect(self.triangles[i].each_ref());
                hit.map(|hit| hit.t).filter(|t| *t > 0.0)
            }
            i if i < boxes => of_sphere(self.spheres[i - spheres]),
            i if i < others => {
                let Bounds3 { min, max } = self.boxes[i - boxes];
                let (a, b) = ((min - ray.origin) / ray.dir, (max - ray.origin) / ray.dir);
                let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
                ahead((enter <= leave).then_some((enter, leave)))
            }
            i => of_sphere(self.others[i - others]),
        }
    }
}

/// Decides every question by the things themselves.
struct Exact<'a, const ANY: bool> {
    things: &'a Things,
    /// The triangles in the tree's blocks.
    blocks: &'a [[u32; BLOCK]],
    rays: &'a [Ray],
    best: Vec<f64>,
    /// Rays that went on by themselves.
    alone: usize,
}

impl<const ANY: bool> Exact<'_, ANY> {
    fn triangle(&self, spot: Spot) -> u32 {
        let (block, lane) = spot.get();
        self.blocks[block][lane]
    }

    fn ask(&mut self, ray: usize, index: u32) -> f32 {
        if let Some(t) = self.things.hit(index as usize, &self.rays[ray]) {
            self.best[ray] = self.best[ray].min(t);
        }
        match ANY && self.best[ray] < f64::INFINITY {
            true => DONE,
            false => self.best[ray] as f32 * (1.0 + 2.0 * f32::EPSILON),
        }
    }
}

impl<const ANY: bool> Decide for Exact<'_, ANY> {
    fn begin(&mut self, _: &mut RayPacket) {}

    fn triangles(&mut self, ray: usize, spots: &[Spot]) -> f32 {
        let spots = spots.iter();
        spots
            .map(|spot| self.ask(ray, self.triangle(*spot)))
            .fold(f32::INFINITY, f32::min)
    }

    fn last(&mut self, pairs: &[(u8, Spot)], packet: &mut RayPacket) {
        for (ray, spot) in pairs {
            let bound = self.ask(usize::from(*ray), self.triangle(*spot));
            packet.lower_bound(usize::from(*ray), bound);
        }
    }

    fn sphere(&mut self, ray: usize, id: u32) -> f32 {
        match id {
            NONE => f32::INFINITY,
            id => self.ask(ray, id),
        }
    }

    fn other(&mut self, mask: u64, index: u32, packet: &mut RayPacket) {
        for ray in rays(mask).filter(|ray| *ray < self.rays.len()) {
            let bound = self.ask(ray, index);
            packet.lower_bound(ray, bound);
        }
    }

    fn alone(&mut self, ray: usize, _: Child, _: f32) -> f32 {
        self.alone += 1;
        let all = 0..self.things.count() as u32;
        all.map(|index| self.ask(ray, index))
            .fold(f32::INFINITY, f32::min)
    }

    fn ends(&self, _: u32) -> bool {
        ANY
    }
}

fn blocks<B: Copy>(leaves: &[[u32; BLOCK]], empty: B, set: impl Fn(&mut B, usize, u32)) -> Vec<B> {
    let block = |ids: &[u32; BLOCK]| {
        let mut block = empty;
        for (lane, id) in ids.iter().enumerate().filter(|(_, id)| **id != NONE) {
            set(&mut block, lane, *id);
        }
        block
    };
    leaves.iter().map(block).collect()
}

/// Searches with a packet; whether the rays went together.
fn search<const ANY: bool>(place: &Place<'_>, extent: f64, exact: &mut Exact<'_, ANY>) -> Option<u64> {
    let mut packet = RayPacket::EMPTY;
    let bounds = vec![f32::INFINITY; exact.rays.len()];
    let search = Search {
        extent,
        t_min: 0.0,
        skip: NONE,
        ends: None,
    };
    let rays = exact.rays;
    let together = packet.search::<ANY>(place, rays, &bounds, &search, exact);
    together.then(|| packet.done())
}

#[test]
fn packets_find_what_their_rays_hit() {
    let mut next = super::super::random(3);
    let (mut hits, mut alone) = (0, [0; 2]);
    for round in 0..cases(200) {
        // Enough for lists of triangles that overflow, and for a tree of several levels.
        let things = Things::at_random([1, 9, cases(30)][round % 3], &mut next);
        let [spheres, first_box, others] = things.firsts();
        let primitive = |index: usize| {
            let around = Box32::around(&things.bounds(index));
            Primitive::new(index as u32, around, 1.0).with_cuboid((first_box..others).contains(&index))
        };
        let kinds = Kinds {
            triangles: spheres,
            spheres: first_box - spheres,
        };
        let corners = |index: u32| things.triangles[index as usize];
        let primitives: Vec<Primitive> = (0..things.count()).map(primitive).collect();
        let (bvh, leaves) = Bvh::build(primitives, kinds, 0.1, corners, || false);
        let place = Place {
            bvh: &bvh,
            triangles: &blocks(&leaves.triangles, Triangles::EMPTY, |block, lane, id| {
                block.set(lane, id, corners(id), [id; 3]);
            }),
            spheres: &blocks(&leaves.spheres, Spheres::EMPTY, |block, lane, id| {
                let (center, radius) = things.spheres[id as usize - spheres];
                block.set(lane, id, center, radius);
            }),
            first_sphere: 0,
            cuboids: &blocks(&leaves.cuboids, Cuboids::EMPTY, |block, lane, id| {
                let Bounds3 { min, max } = things.boxes[id as usize - first_box];
                block.set(
                    lane,
                    id,
                    &DAffine3::from_translation((min + max) * -0.5),
                    (max - min) * 0.5,
                );
            }),
            cuboid_extent: things
                .boxes
                .iter()
                .map(|b| max_abs(b.min).max(max_abs(b.max)))
                .fold(0.0, f64::max) as f32,
        };
        let origin = DVec3::new(next(), next(), next()).normalize() * if round % 4 == 3 { 0.5 } else { 6.0 };
        let towards = if round % 4 == 3 { origin } else { -origin };
        let count = [5, 8, 37, PACKET][round / 3 % 4];
        let rays: Vec<Ray> = (0..count)
            .map(|_| Ray::new(origin, towards + DVec3::new(next(), next(), next()) * 0.6 - 0.3))
            .collect();
        let exact = |rays| {
            (0..things.count())
                .map(|i| things.hit(i, rays))
                .collect::<Vec<_>>()
        };
        let nearest: Vec<f64> = rays
            .iter()
            .map(|ray| exact(ray).into_iter().flatten().fold(f64::INFINITY, f64::min))
            .collect();
        let best = vec![f64::INFINITY; count];
        let (things, blocks, rays) = (&things, &leaves.triangles[..], &rays[..]);
        let extent = f64::from(bvh.extent());
        let mut one = Exact::<false> {
            things,
            blocks,
            rays,
            best: best.clone(),
            alone: 0,
        };
        if search(&place, extent, &mut one).is_none() {
            continue;
        }
        assert_eq!(one.best, nearest, "round {round}");
        let mut any = Exact::<true> {
            things,
            blocks,
            rays,
            best,
            alone: 0,
        };
        let done = search(&place, extent, &mut any).expect("the same rays went together");
        for (i, t) in nearest.iter().enumerate() {
            assert_eq!(done >> i & 1 == 1, *t < f64::INFINITY, "round {round}, ray {i}");
            hits += usize::from(*t < f64::INFINITY);
        }
        alone[0] += one.alone;
        alone[1] += any.alone;
    }
    assert!(hits > cases(1000) / 10, "{hits}");
    assert!(alone.into_iter().all(|n| n > cases(200) / 10), "{alone:?}");
}

/// What comes of all operations on registers of rays, with numbers for which nothing is rounded: bits, for NaN and -0.
fn operations<W: Wide>(w: W) -> (Vec<[u32; 8]>, [u64; 3], [f32; 3]) {
    let from = [
        [
            1.0,
            -2.0,
            0.5,
            0.0,
            -0.0,
            9.0,
            f32::NAN,
            1e30,
            2.0,
            -3.0,
            0.25,
            0.0,
            1.0,
            4.0,
            1.0,
            -1e30,
        ],
        [0.5; 16],
        [-4.0; 16],
    ];
    let [a, half, four] = w.load3(&from, 0);
    let b = w.load(&from[0], 1);
    let mask = w.below(a, b);
    let values = [
        w.sub(b, half),
        w.mul(b, four),
        w.div(b, half),
        w.mul_add(b, half, four),
        w.add(half, four),
        w.min(a, b),
        w.max(a, b),
        w.sign(b),
        w.flip(a, b),
        w.select(mask, half, four),
        w.dot([half, half, four], w.splat3([2.0, 4.0, 1.0])),
        w.broadcast3(&from, 9)[0],
    ];
    let stored = values.map(|value| {
        let mut to = [0.0; 16];
        w.store(value, &mut to, 1);
        std::array::from_fn(|i| to[8 + i].to_bits())
    });
    let masks = [
        w.bits(mask),
        w.bits(w.and(mask, w.below(b, four))),
        w.bits(w.below(b, a)),
    ];
    (stored.to_vec(), masks, [w.least(b), w.most(b), w.least(half)])
}

#[test]
fn registers_of_rays_are_those_of_plain_arithmetic() {
    let plain = operations(Plain);
    assert_eq!((plain.1[0], plain.2), (0b0001_0001, [-1e30, 4.0, 0.5]));
    #[cfg(target_arch = "x86_64")]
    if super::super::Simd::detect() >= super::super::Simd::Avx2 {
        // SAFETY: the processor has the instructions.
        assert_eq!(operations(unsafe { super::wide::Avx2::assume() }), plain);
    }
}
