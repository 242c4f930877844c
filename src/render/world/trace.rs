//! The nearest hit, and whether anything stands in the way.

use super::{
    SurfacePoint, World,
    level::{Level, Primitive},
};
use crate::{
    accel::{BLOCK, Child, Control, LeafKind, NONE, RayBlock, RayBox, round_down, round_up},
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
                    LevelSearch {
                        world,
                        level,
                        base,
                        ray,
                        query,
                        triangle_ray: None,
                    }
                    .other::<false>(index);
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
        let mut search = LevelSearch {
            world: self,
            level,
            base,
            ray,
            query,
            triangle_ray: None,
        };
        for &index in &level.unbounded {
            if search.other::<ANY>(index) == Control::Stop {
                return Control::Stop;
            }
        }
        let ray_block = RayBlock::new(ray, level.extent);
        let t_max = search.query.best.t;
        let (t_least, t_most) = (round_up(search.query.probe.t_min), round_down(t_max));
        let mut control = Control::Continue;
        level
            .bvh
            .traverse::<ANY>(&RayBox::new(ray), t_max, |leaf, bound| {
                control = match leaf.kind() {
                    LeafKind::Triangles => {
                        search.triangles::<ANY>(leaf, &ray_block, [t_least, t_most, *bound])
                    }
                    LeafKind::Spheres => search.spheres::<ANY>(leaf, &ray_block, *bound),
                    LeafKind::Others => search.others::<ANY>(leaf),
                };
                *bound = round_up(search.query.best.t);
                control
            });
        control
    }
}

/// The lanes whose bits are set.
#[inline(always)]
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize & (BLOCK - 1);
            mask &= mask - 1;
            lane
        })
    })
}

/// A search of one level.
struct LevelSearch<'a, 's, 'p> {
    world: &'a World<'s>,
    level: &'a Level,
    base: u64,
    ray: &'a Ray,
    query: &'a mut Query<'p>,
    /// Made when the first triangle needs it.
    triangle_ray: Option<TriangleRay>,
}

impl LevelSearch<'_, '_, '_> {
    #[inline(always)]
    fn triangles<const ANY: bool>(
        &mut self,
        leaf: Child,
        ray: &RayBlock,
        [t_least, t_most, bound]: [f32; 3],
    ) -> Control {
        for block in &self.level.triangle_blocks[leaf.range()] {
            let found = block.candidates(ray, t_least, t_most, bound);
            if found.possible == 0 {
                continue;
            }
            if ANY && found.certain != 0 && self.any_blocks(&block.ids, found.certain) {
                return Control::Stop;
            }
            for lane in lanes(found.possible) {
                if self.triangle::<ANY>(block.ids[lane]) == Control::Stop {
                    return Control::Stop;
                }
            }
        }
        Control::Continue
    }

    #[inline(always)]
    fn spheres<const ANY: bool>(&mut self, leaf: Child, ray: &RayBlock, bound: f32) -> Control {
        for block in &self.level.sphere_blocks[leaf.range()] {
            for lane in lanes(block.possible(ray, bound)) {
                if self.sphere::<ANY>(block.ids[lane]) == Control::Stop {
                    return Control::Stop;
                }
            }
        }
        Control::Continue
    }

    fn others<const ANY: bool>(&mut self, leaf: Child) -> Control {
        for &index in self.level.bvh.others(leaf) {
            if self.other::<ANY>(index) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    /// Takes a hit on the level's primitive `index` if it is the best so far; with `ANY` it ends the search
    /// unless it may let light through.
    #[inline]
    fn offer<const ANY: bool>(&mut self, index: u32, hit: Hit) -> Control {
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

    /// Whether any of the lanes' triangles, all of them certainly hit, is opaque and not where the ray starts.
    #[inline]
    fn any_blocks(&mut self, ids: &[u32; BLOCK], mask: u32) -> bool {
        lanes(mask).any(|lane| {
            let is_start = self.base + u64::from(ids[lane]) == self.query.probe.start;
            !is_start && !self.level.may_be_transparent(ids[lane])
        })
    }

    #[inline]
    fn triangle<const ANY: bool>(&mut self, index: u32) -> Control {
        let number = self.base + u64::from(index);
        if number == self.query.probe.start || index == NONE {
            return Control::Continue;
        }
        let ray = self.ray;
        let triangle_ray = self.triangle_ray.get_or_insert_with(|| TriangleRay::new(ray));
        let [a, b, c] = self.level.corners(index);
        match triangle_ray.intersect(a, b, c) {
            Some(hit) if hit.t > self.query.probe.t_min => self.offer::<ANY>(
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
    fn sphere<const ANY: bool>(&mut self, i: u32) -> Control {
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
            self.offer::<ANY>(
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
    fn other<const ANY: bool>(&mut self, index: u32) -> Control {
        match self.level.primitive(index) {
            Primitive::Shape(i) => self.shape::<ANY>(index, i),
            Primitive::Instance(i) => {
                let instance = &self.level.instances[i as usize];
                let inner = &self.world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                self.world
                    .search::<ANY>(inner, self.base + instance.first_number, &ray, self.query)
            }
            Primitive::Triangle(i) => self.triangle::<ANY>(i),
            Primitive::Sphere(i) => self.sphere::<ANY>(i),
        }
    }

    fn shape<const ANY: bool>(&mut self, index: u32, i: u32) -> Control {
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
            Some(Crossing { t, part }) => self.offer::<ANY>(
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
