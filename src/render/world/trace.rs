//! The nearest hit, and whether anything stands in the way.

use super::{
    SurfacePoint, World,
    level::{Level, Primitive},
};
use crate::{
    accel::{
        BLOCK, Child, Control, Lanes, LeafKind, NONE, Range, Ray32, RayBlock, RayBox, RaySphere, Spheres,
        Triangles, Visitor,
    },
    math::{DVec3, Ray, max_abs},
    shape::{Crossing, Crossings, Sphere, triangle::TriangleRay},
};

/// A ray with what it may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) ray: Ray,
    /// Nothing nearer counts: the rounding error of the ray's start.
    t_min: f64,
    /// A crossing of the start's own primitive this near to the start is the start.
    t_self: f64,
    /// As `t_min`, for the start's own primitive: where the ray leaves along a tangent, its two crossings are only
    /// known to the square root of rounding.
    t_min_self: f64,
    /// Number of the primitive the ray starts on, or [`Probe::NOWHERE`].
    start: u64,
}

impl Probe {
    const NOWHERE: u64 = u64::MAX;

    /// A ray that starts in free space.
    pub(crate) fn from_space(ray: Ray) -> Self {
        Self {
            ray,
            t_min: 0.0,
            t_self: 0.0,
            t_min_self: 0.0,
            start: Self::NOWHERE,
        }
    }

    /// A ray that starts on the primitive `start`. `scale` is the size of the numbers its start was computed
    /// from; the direction is a unit vector.
    ///
    /// The start's own crossing is left out by number, so the least distance need only cover the rounding of
    /// the start, some 1e-15 of `scale`, in front of *other* surfaces.
    pub(crate) fn from_surface(ray: Ray, start: u64, scale: f64) -> Self {
        let scale = scale.max(max_abs(ray.origin));
        Self {
            ray,
            t_min: 1e-10 * scale,
            t_self: 1e-5 * scale,
            t_min_self: 1e-7 * scale,
            start,
        }
    }
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) t: f64,
    /// Unique over all instances.
    pub(crate) number: u64,
    /// Barycentric weights of a triangle's second and third corner.
    pub(super) u: f64,
    pub(super) v: f64,
    /// Part of a shape's surface.
    pub(super) part: u8,
}

/// What stands between a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blocker {
    /// Nothing.
    None,
    /// Perhaps something that lets light through, and nothing that does not.
    Transparent,
    /// Something that lets no light through.
    Opaque,
}

/// A question put to all levels, and its answer so far.
struct Query<'p> {
    probe: &'p Probe,
    best: Hit,
    /// Something was met that may let light through.
    met_transparent: bool,
}

impl<'p> Query<'p> {
    fn new(probe: &'p Probe, t_max: f64) -> Self {
        let best = Hit {
            t: t_max,
            number: u64::MAX,
            u: 0.0,
            v: 0.0,
            part: 0,
        };
        Self {
            probe,
            best,
            met_transparent: false,
        }
    }

    fn hit(&self) -> Option<Hit> {
        (self.best.number != u64::MAX).then_some(self.best)
    }
}

impl World<'_> {
    /// The nearest hit before `t_max`, least number first where several are equally near.
    pub(crate) fn nearest(&self, probe: &Probe, t_max: f64) -> Option<Hit> {
        let mut query = Query::new(probe, t_max);
        self.search::<false>(self.root()?, 0, &probe.ray, &mut query);
        query.hit()
    }

    /// What else lies in the very surface that a ray met at `at`, such as the table under a block of glass that
    /// stands on it: rounding alone decides which of the two is nearer.
    pub(crate) fn touching(&self, hit: &Hit, dir: DVec3, at: &SurfacePoint<'_>) -> Option<(Hit, Ray)> {
        let mut probe = Probe::from_surface(Ray::new(at.position, dir), hit.number, at.scale);
        let reach = probe.t_min;
        (probe.t_min, probe.t_min_self) = (-reach, f64::INFINITY);
        Some((self.nearest(&probe, reach)?, probe.ray))
    }

    /// What kind of thing is met before `t_max`.
    pub(crate) fn blocker(&self, probe: &Probe, t_max: f64) -> Blocker {
        let mut query = Query::new(probe, t_max);
        let stopped = self
            .root()
            .is_some_and(|root| self.search::<true>(root, 0, &probe.ray, &mut query) == Control::Stop);
        match (stopped, query.met_transparent) {
            (true, _) => Blocker::Opaque,
            (false, true) => Blocker::Transparent,
            (false, false) => Blocker::None,
        }
    }

    /// As [`World::nearest`], without the tree.
    #[cfg(test)]
    pub(super) fn nearest_brute(&self, probe: &Probe, t_max: f64) -> Option<Hit> {
        fn all(world: &World<'_>, level: &Level, base: u64, ray: &Ray, query: &mut Query<'_>) {
            for index in 0..level.primitives() as u32 {
                if let Primitive::Instance(i) = level.primitive(index) {
                    let instance = &level.instances[i as usize];
                    let inner = &world.levels[instance.level as usize];
                    all(
                        world,
                        inner,
                        base + instance.first_number,
                        &ray.transformed(&instance.inner_from_outer),
                        query,
                    );
                } else {
                    LevelSearch::<false>::new(world, level, base, ray, query).other(index);
                }
            }
        }
        let mut query = Query::new(probe, t_max);
        all(self, self.root()?, 0, &probe.ray, &mut query);
        query.hit()
    }

    /// Searches a level whose first primitive has the number `base`; `ray` is the probe's in the level's space.
    /// With `ANY` the first opaque thing met ends the search.
    fn search<const ANY: bool>(&self, level: &Level, base: u64, ray: &Ray, query: &mut Query<'_>) -> Control {
        let mut search = LevelSearch::<ANY>::new(self, level, base, ray, query);
        for &index in &level.unbounded {
            if search.other(index) == Control::Stop {
                return Control::Stop;
            }
        }
        let ray_box = RayBox::new(&search.ray32, level.bvh.extent());
        level
            .bvh
            .traverse::<ANY>(&ray_box, search.range.possible, search.range.bound, &mut search);
        search.finish()
    }
}

/// In f32, not below `t` where it is not negative.
#[inline(always)]
fn above(t: f64) -> f32 {
    t as f32 * (1.0 + 2.0 * f32::EPSILON)
}

/// In f32, not above `t` where it is not negative and f32 has numbers as large.
#[inline(always)]
fn below(t: f64) -> f32 {
    t as f32 * (1.0 - 2.0 * f32::EPSILON)
}

/// The lanes whose bits are set.
#[inline(always)]
fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize & (BLOCK - 1);
            mask &= mask - 1;
            lane
        })
    })
}

/// Most triangles that wait for their exact test.
const WAITING: usize = 8;

/// A search of one level.
struct LevelSearch<'a, 's, 'p, const ANY: bool> {
    world: &'a World<'s>,
    level: &'a Level,
    base: u64,
    ray: &'a Ray,
    query: &'a mut Query<'p>,
    ray32: Ray32,
    ray_block: RayBlock,
    ray_sphere: Option<RaySphere>,
    range: Range,
    /// Index of the primitive that the ray starts on, where it is one of this level.
    start: u32,
    /// Triangles that may be the nearest hit, and how far away they are at least. In f32 it is nearly always known
    /// which of two hits is nearer, so that most are never looked at in f64.
    waiting: [(u32, f32); WAITING],
    waiting_count: usize,
    control: Control,
}

impl<const ANY: bool> Visitor for LevelSearch<'_, '_, '_, ANY> {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> Control {
        self.control = match leaf.kind() {
            LeafKind::Triangles => return self.triangles(lanes, leaf, bound),
            LeafKind::Spheres => self.spheres(lanes, leaf, *bound),
            LeafKind::Others => self.others(leaf),
        };
        *bound = bound.min(above(self.query.best.t));
        self.control
    }

    #[inline(always)]
    fn blocks(&self) -> (*const u8, usize) {
        if self.level.triangle_blocks.is_empty() {
            (self.level.sphere_blocks.as_ptr().cast(), size_of::<Spheres>())
        } else {
            (self.level.triangle_blocks.as_ptr().cast(), size_of::<Triangles>())
        }
    }
}

impl<'a, 's, 'p, const ANY: bool> LevelSearch<'a, 's, 'p, ANY> {
    #[inline(always)]
    fn new(
        world: &'a World<'s>,
        level: &'a Level,
        base: u64,
        ray: &'a Ray,
        query: &'a mut Query<'p>,
    ) -> Self {
        let probe = query.probe;
        let ray32 = Ray32::new(ray);
        let ray_block = RayBlock::new(&ray32, level.extent as f32);
        let range = Range {
            // Twice as far as the exact bound, for the rounding of tests in f32 where t is negative.
            possible: (2.0 * probe.t_min.min(0.0)) as f32,
            bound: above(query.best.t),
            certain: [above(probe.t_min), below(query.best.t)],
        };
        let start = u32::try_from(probe.start.wrapping_sub(base)).unwrap_or(NONE);
        Self {
            world,
            level,
            base,
            ray,
            ray32,
            ray_sphere: (!level.sphere_blocks.is_empty()).then(|| RaySphere::new(&ray_block)),
            ray_block,
            range,
            start,
            query,
            waiting: [(NONE, 0.0); WAITING],
            waiting_count: 0,
            control: Control::Continue,
        }
    }

    #[inline(always)]
    fn triangles<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> Control {
        let Some(block) = self.level.triangle_blocks.get(leaf.first()) else {
            return Control::Continue;
        };
        let mut range = self.range;
        if !ANY {
            (range.bound, range.certain[1]) = (*bound, *bound);
        }
        let found = block.candidates(lanes, &self.ray_block, range);
        if found.possible == 0 {
            return Control::Continue;
        }
        if ANY {
            self.control = self.any_of(&block.ids, found.possible, found.certain);
            return self.control;
        }
        let [t_least, t_most] = found.t;
        for lane in lanes_of(found.possible) {
            let index = block.ids[lane];
            if index == self.start || index == NONE {
                continue;
            }
            let mut least = f32::NEG_INFINITY;
            if found.certain >> lane & 1 == 1 {
                *bound = bound.min(t_most[lane]);
                least = t_least[lane];
            }
            if self.waiting_count == WAITING {
                self.decide();
                *bound = bound.min(above(self.query.best.t));
            }
            self.waiting[self.waiting_count % WAITING] = (index, least);
            self.waiting_count += 1;
        }
        Control::Continue
    }

    /// Whether any of a block's triangles ends the search.
    #[inline]
    fn any_of(&mut self, ids: &[u32; BLOCK], possible: u32, certain: u32) -> Control {
        for lane in lanes_of(certain) {
            if ids[lane] != self.start && !self.level.may_be_transparent(ids[lane]) {
                return Control::Stop;
            }
        }
        let ray = TriangleRay::new(self.ray);
        for lane in lanes_of(possible) {
            if self.triangle(&ray, ids[lane]) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    /// Decides which of the waiting triangles is hit first, the last found first: it is the nearest, but for
    /// rounding.
    #[inline(always)]
    fn decide(&mut self) {
        if self.waiting_count == 0 {
            return;
        }
        let ray = TriangleRay::new(self.ray);
        while self.waiting_count > 0 {
            self.waiting_count -= 1;
            let (index, least) = self.waiting[self.waiting_count % WAITING];
            if f64::from(least) <= self.query.best.t {
                self.triangle(&ray, index);
            }
        }
    }

    #[inline(always)]
    fn finish(&mut self) -> Control {
        if !ANY {
            self.decide();
        }
        self.control
    }

    #[inline(always)]
    fn spheres<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: f32) -> Control {
        let (Some(block), Some(ray)) = (self.level.sphere_blocks.get(leaf.first()), &self.ray_sphere) else {
            return Control::Continue;
        };
        let range = Range { bound, ..self.range };
        let [possible, certain] = block.candidates(lanes, &self.ray_block, ray, range);
        if ANY && certain != 0 {
            let first = self.level.triangles.len() as u32;
            let blocks = |index: u32| index != self.start && !self.level.may_be_transparent(index);
            if lanes_of(certain).any(|lane| blocks(first + block.ids[lane])) {
                return Control::Stop;
            }
        }
        for lane in lanes_of(possible) {
            if self.sphere(block.ids[lane]) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    fn others(&mut self, leaf: Child) -> Control {
        // What they ask of the query is its best hit.
        self.decide();
        for &index in self.level.bvh.others(leaf) {
            if self.other(index) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    /// Takes a hit on the level's primitive `index` if it is the best so far; with `ANY` it ends the search
    /// unless it may let light through.
    #[inline]
    fn offer(&mut self, index: u32, hit: Hit) -> Control {
        let best = &mut self.query.best;
        if !(hit.t < best.t || (hit.t == best.t && hit.number < best.number)) {
            return Control::Continue;
        }
        if !ANY {
            *best = hit;
            return Control::Continue;
        }
        if self.level.may_be_transparent(index) {
            self.query.met_transparent = true;
            return Control::Continue;
        }
        Control::Stop
    }

    #[inline(always)]
    fn triangle(&mut self, ray: &TriangleRay, index: u32) -> Control {
        let number = self.base + u64::from(index);
        if index == self.start || index == NONE {
            return Control::Continue;
        }
        match ray.intersect(self.level.corners_of(index)) {
            Some(hit) if hit.t > self.query.probe.t_min => self.offer(
                index,
                Hit {
                    t: hit.t,
                    number,
                    u: hit.u,
                    v: hit.v,
                    part: 0,
                },
            ),
            _ => Control::Continue,
        }
    }

    #[inline]
    fn sphere(&mut self, i: u32) -> Control {
        let Some(sphere) = self.level.spheres.get(i as usize) else {
            return Control::Continue;
        };
        let index = self.level.triangles.len() as u32 + i;
        let number = self.base + u64::from(index);
        let Some((t0, t1)) = Sphere::roots(sphere.center, sphere.radius, self.ray) else {
            return Control::Continue;
        };
        let probe = self.query.probe;
        let t = if number == probe.start {
            let mut crossings = Crossings::default();
            crossings.push(t0, 0);
            crossings.push(t1, 0);
            crossings.drop_start(probe.t_self);
            match crossings.first_within(probe.t_min_self, f64::INFINITY) {
                Some(crossing) => crossing.t,
                None => return Control::Continue,
            }
        } else if t0 > probe.t_min {
            t0
        } else {
            t1
        };
        if t > probe.t_min {
            self.offer(
                index,
                Hit {
                    t,
                    number,
                    u: 0.0,
                    v: 0.0,
                    part: 0,
                },
            )
        } else {
            Control::Continue
        }
    }

    /// A primitive of any kind.
    fn other(&mut self, index: u32) -> Control {
        match self.level.primitive(index) {
            Primitive::Shape(i) => self.shape(index, i),
            Primitive::Instance(i) => {
                let instance = &self.level.instances[i as usize];
                let inner = &self.world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                self.world
                    .search::<ANY>(inner, self.base + instance.first_number, &ray, self.query)
            }
            Primitive::Triangle(i) => self.triangle(&TriangleRay::new(self.ray), i),
            Primitive::Sphere(i) => self.sphere(i),
        }
    }

    fn shape(&mut self, index: u32, i: u32) -> Control {
        let placed = &self.level.shapes[i as usize];
        let number = self.base + u64::from(index);
        let probe = self.query.probe;
        let mut crossings = Crossings::default();
        placed
            .shape
            .crossings(&self.ray.transformed(&placed.object_from_level), &mut crossings);
        let mut t_min = probe.t_min;
        if number == probe.start {
            crossings.drop_start(probe.t_self);
            t_min = probe.t_min_self;
        }
        match crossings.first_within(t_min, f64::INFINITY) {
            Some(Crossing { t, part }) => self.offer(
                index,
                Hit {
                    t,
                    number,
                    u: 0.0,
                    v: 0.0,
                    part,
                },
            ),
            None => Control::Continue,
        }
    }
}
