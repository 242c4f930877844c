//! What a ray hits for certain: every test in f64, one primitive at a time.

use super::{
    World,
    level::{Level, Primitive},
    query::{Hit, Query},
};
use crate::{
    accel::Triangles,
    math::Ray,
    shape::{
        Crossing, CrossingSink, Crossings, Shape,
        triangle::{TriangleHit, TriangleRay},
    },
};

/// One ray's tests of a level's primitives; each tells whether it ends the search.
pub(super) struct Exact<'a, 's, 'p, const ANY: bool> {
    pub(super) world: &'a World<'s>,
    pub(super) level: &'a Level<'s>,
    /// Number of the level's first primitive.
    pub(super) base: u64,
    /// The query's ray in the level's space.
    pub(super) ray: &'a Ray,
    pub(super) query: &'a mut Query<'p>,
}

impl<const ANY: bool> Exact<'_, '_, '_, ANY> {
    /// A primitive of any kind.
    pub(super) fn any(&mut self, index: u32) -> bool {
        match self.level.primitive(index) {
            Primitive::Shape(i) => self.shape(index, i),
            Primitive::Instance(_) if self.world.is_stopped() => false,
            Primitive::Instance(i) => {
                let instance = &self.level.instances[i as usize];
                let inner = &self.world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                if inner.rare.is_some() {
                    let base = self.base + instance.first_number;
                    return self.world.search_rare::<ANY>(inner, base, ray, self.query);
                }
                self.world
                    .search::<ANY>(inner, self.base + instance.first_number, &ray, self.query)
            }
            Primitive::Triangle(i) => {
                !self.starts_on(i) && {
                    let hit = TriangleRay::new(self.ray).intersect(self.level.corners_of(i));
                    self.offer_triangle(i, hit)
                }
            }
            Primitive::Sphere(i) => self.sphere(i),
        }
    }

    /// The triangle in a lane of a block; `ray` is this ray, prepared.
    #[inline(always)]
    pub(super) fn triangle_in(&mut self, ray: &TriangleRay, block: &Triangles, lane: usize) -> bool {
        let index = block.ids[lane];
        if self.starts_on(index) {
            return false;
        }
        let corners = self.level.corners_in(block, lane, ray.order());
        self.offer_triangle(index, ray.intersect_ordered(corners))
    }

    #[inline(always)]
    fn starts_on(&self, index: u32) -> bool {
        self.query.probe.starts_on(self.base + u64::from(index))
    }

    /// Where this ray meets a triangle.
    #[inline(always)]
    fn offer_triangle(&mut self, index: u32, hit: Option<TriangleHit>) -> bool {
        let (number, level) = (self.base + u64::from(index), self.level);
        hit.is_some_and(|hit| {
            self.query
                .offer_triangle::<ANY>(number, hit, || level.may_be_transparent(index))
        })
    }

    #[inline]
    pub(super) fn sphere(&mut self, i: u32) -> bool {
        let Some(sphere) = self.level.spheres.get(i as usize) else {
            return false;
        };
        let index = self.level.triangles.len() as u32 + i;
        let number = self.base + u64::from(index);
        let probe = self.query.probe;
        let is_start = probe.starts_on(number);
        let Some((t0, t1)) = sphere.roots(self.ray, probe, number) else {
            return false;
        };
        let t = if is_start {
            let mut crossings = Crossings::default();
            crossings.push(t0, 0);
            crossings.push(t1, 0);
            let t_min = probe.drop_start(number, &mut crossings);
            match crossings.first_within(t_min, f64::INFINITY) {
                Some(crossing) => crossing.t,
                None => return false,
            }
        } else if t0 > probe.t_min {
            t0
        } else {
            t1
        };
        t > probe.t_min && self.offer(index, t, 0)
    }

    fn shape(&mut self, index: u32, i: u32) -> bool {
        let placed = &self.level.shapes[i as usize];
        let number = self.base + u64::from(index);
        if !placed.may_cross(self.ray, self.query.probe.least(number), self.query.best.t) {
            return false;
        }
        let mut crossings = if self.query.probe.starts_on(number) {
            // Which of them is the start is not told before all are known.
            Crossings::default()
        } else {
            Crossings::until_beyond(self.query.probe.t_min)
        };
        if let Shape::Isosurface(_) = placed.shape {
            crossings = placed.near_crossings(self.ray, self.query.probe, number, self.query.best.t, true);
        } else {
            placed
                .shape
                .crossings(&self.ray.transformed(&placed.object_from_level), &mut crossings);
        }
        let t_min = self.query.probe.drop_start(number, &mut crossings);
        crossings
            .first_within(t_min, f64::INFINITY)
            .is_some_and(|Crossing { t, part }| self.offer(index, t, part))
    }

    /// Notes which primitive ends the search, where no test in f64 was needed.
    #[inline(always)]
    pub(super) fn stop_at(&mut self, index: u32) {
        self.query.best.number = self.base + u64::from(index);
    }

    #[inline]
    fn offer(&mut self, index: u32, t: f64, part: u32) -> bool {
        let hit = Hit {
            t,
            number: self.base + u64::from(index),
            u: 0.0,
            v: 0.0,
            part,
        };
        let level = self.level;
        self.query.offer::<ANY>(hit, || level.may_be_transparent(index))
    }
}
