//! Searches in which it matters what lets light through: what a shadow ray passes on its way, and whether
//! something opaque lies in a transparent surface.

use super::{
    SurfacePoint, World,
    level::{Level, Primitive},
    query::{Blocker, Hit, Probe},
    shaft::FewObstacles,
    trace::{lanes_of, range},
};
use crate::{
    accel::{
        BLOCK, Child, Control, Lanes, LeafKind, NONE, Range, Ray32, RayBlock, RayBox, RayCuboid, RaySphere,
        Visitor,
    },
    color::Color,
    math::{Ray, max_abs},
    render::polish::shadow_share,
    shape::{CrossingSink, Crossings, Shape, triangle::TriangleRay},
};

/// What a shadow ray passes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Passage {
    /// This share of the light comes through.
    Share(Color),
    /// One search cannot tell: surfaces lie too close together, vary from point to point, or are too many.
    Unclear,
}

impl World<'_> {
    /// The share of light that comes through along a ray up to `t_max`: nothing behind anything opaque, the product
    /// of Kt of the transparent surfaces in between otherwise, in the order in which the ray meets them. `few` is
    /// what it may meet, where that is known.
    pub(crate) fn share_through(&self, probe: &Probe, t_max: f64, few: Option<&FewObstacles>) -> Color {
        let passage = match few {
            Some(few) => self.passage(probe, t_max, |found| self.walk_few(few, probe, found)),
            None if self.may_be_transparent() => {
                self.passage(probe, t_max, |found| self.walk_root(probe, found))
            }
            None => Passage::Share(match self.blocker(probe, t_max) {
                Blocker::None => Color::ONE,
                Blocker::Transparent | Blocker::Opaque => Color::ZERO,
            }),
        };
        match passage {
            Passage::Share(share) => share,
            Passage::Unclear => self.share_by_steps(*probe, t_max),
        }
    }

    /// As [`World::share_through`] where it is not known what the ray may meet, but what stood in the way of the ray
    /// before, which is the `last` and is looked at first.
    #[inline]
    pub(crate) fn share_after(&self, probe: &Probe, t_max: f64, last: &mut u64) -> Color {
        if self.may_be_transparent() {
            return self.share_through(probe, t_max, None);
        }
        if self.is_blocked(probe, t_max, last) {
            Color::ZERO
        } else {
            Color::ONE
        }
    }

    /// As [`World::share_through`], from surface to surface, a search for each: however near to each other they
    /// are and whatever they look like.
    pub(super) fn share_by_steps(&self, probe: Probe, t_max: f64) -> Color {
        self.steps(probe, t_max, |_, _| {})
    }

    /// As [`World::share_by_steps`], telling `met` the number and Kt of each surface on the way.
    pub(crate) fn steps(&self, mut probe: Probe, t_max: f64, mut met: impl FnMut(u64, Color)) -> Color {
        let dir = probe.ray.dir;
        let mut rest = t_max;
        let mut share = Color::ONE;
        // Each turn passes one transparent surface. Nobody looks through more than these.
        for _ in 0..1024 {
            if self.is_stopped() {
                return Color::ZERO;
            }
            let Some(hit) = self.nearest(&probe, rest) else {
                return share;
            };
            let Some(surface) = self.surface(&hit, &probe.ray) else {
                return Color::ZERO;
            };
            let mut transmission = self.term(&surface.material.transmission, &surface);
            if let Some(finish) = &surface.material.finish {
                transmission = shadow_share(self, finish, (&hit, &probe.ray), &surface, transmission);
            }
            met(hit.number, transmission);
            share *= transmission;
            if share == Color::ZERO {
                return share;
            }
            rest -= hit.t;
            probe = Probe::from_surface(Ray::new(surface.position, dir), hit.number, surface.scale);
        }
        Color::ZERO
    }

    /// Whether anything may let light through. If not, a shadow ray need only ask for a blocker.
    fn may_be_transparent(&self) -> bool {
        self.root().is_some_and(|root| !root.transparent.is_empty())
    }

    /// What comes through by a single search. A ray that goes from surface to surface finds the same, but for
    /// surfaces so near each other that it might take the one for its own start, which this leaves open.
    fn passage(&self, probe: &Probe, t_max: f64, search: impl Fn(&mut Found) -> Control) -> Passage {
        let scale = probe.scale().max(max_abs(probe.ray.origin));
        // An endless ray has no end that a surface could be near to.
        let slack = if t_max.is_finite() {
            near(scale, t_max)
        } else {
            0.0
        };
        let mut found = Found {
            t_max,
            t_far: t_max + slack,
            list: [(0.0, 0); Found::CAPACITY],
            len: 0,
        };
        if search(&mut found) == Control::Stop {
            return Passage::Share(Color::ZERO);
        }
        let Some(list) = found.list.get(..found.len) else {
            return Passage::Unclear;
        };
        let mut share = Color::ONE;
        let mut before = f64::NEG_INFINITY;
        for &(t, number) in list {
            if t - before < near(scale, t) || (t - t_max).abs() <= slack {
                return Passage::Unclear;
            }
            before = t;
            let Some(material) = self.material(number) else {
                return Passage::Unclear;
            };
            if material.transmission.texture.is_some() || material.finish.is_some() {
                return Passage::Unclear;
            }
            share *= material.transmission.color;
        }
        Passage::Share(share)
    }

    /// What else lies in the very surface that a ray met at `at`, such as the table under a block of glass that
    /// stands on it: rounding alone decides which of the two is nearer. `None` where nothing that may be opaque does.
    pub(crate) fn touching(&self, hit: &Hit, ray: &Ray, at: &SurfacePoint<'_>) -> Option<(Hit, Ray)> {
        let (probe, reach) = Probe::around_surface(Ray::new(at.position, ray.dir), hit.number, at.scale);
        if self.walk_root(&probe, &mut OpaqueWithin(reach)) == Control::Continue {
            return None;
        }
        Some((self.nearest(&probe, reach)?, probe.ray))
    }

    fn walk_few(&self, few: &FewObstacles, probe: &Probe, found: &mut Found) -> Control {
        let Some(level) = self.root() else {
            return Control::Continue;
        };
        let mut walk = Walk::new(self, level, 0, &probe.ray, probe, found);
        for &index in few.indices() {
            if walk.primitive(index) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    fn walk_root<C: Census>(&self, probe: &Probe, census: &mut C) -> Control {
        let Some(root) = self.root() else {
            return Control::Continue;
        };
        self.walk(root, 0, &probe.ray, probe, census)
    }

    /// Counts everything the ray meets in a level whose first primitive has the number `base`.
    fn walk<C: Census>(
        &self,
        level: &Level<'_>,
        base: u64,
        ray: &Ray,
        probe: &Probe,
        census: &mut C,
    ) -> Control {
        let mut walk = Walk::new(self, level, base, ray, probe, census);
        if level.primitives() == 1 && level.instances.is_empty() {
            return walk.primitive(0);
        }
        for &index in &level.unbounded {
            if walk.primitive(index) == Control::Stop {
                return Control::Stop;
            }
        }
        if !walk.census.counts_in_tree(level) {
            return Control::Continue;
        }
        let ray32 = Ray32::new(ray);
        let range = range(probe.t_min, walk.census.reach());
        let ray_box = RayBox::new(&ray32, level.bvh.extent());
        walk.prepared = Some(Prepared {
            ray32,
            range,
            for_blocks: None,
        });
        level
            .bvh
            .traverse::<true>(&ray_box, range.possible, range.bound, &mut walk);
        walk.control
    }
}

/// How near two surfaces are where a ray that starts on one may take the other for its start: twice the distance
/// within which it looks for that, which grows with the numbers involved.
fn near(scale: f64, t: f64) -> f64 {
    2.0 * Probe::OWN_START * (scale + t.abs())
}

/// What is done with the things a ray meets, in no particular order.
trait Census {
    /// How far along the ray things count.
    fn reach(&self) -> f64;
    /// Whether the primitive `index` of a level counts at all.
    fn counts(&self, level: &Level, index: u32) -> bool;
    /// False where nothing in the tree of a level counts.
    fn counts_in_tree(&self, _level: &Level) -> bool {
        true
    }
    /// A primitive that counts is met at `t`, its own crossings in ascending order.
    fn meet(&mut self, level: &Level, index: u32, number: u64, t: f64) -> Control;
    /// Something that may let light through is met more often than can be listed.
    fn lose_count(&mut self) {}
}

/// Transparent surfaces along a shadow ray by distance, until something opaque is met.
struct Found {
    t_max: f64,
    /// Transparent surfaces this far count.
    t_far: f64,
    list: [(f64, u64); Self::CAPACITY],
    /// One more than the capacity where there were too many.
    len: usize,
}

impl Found {
    const CAPACITY: usize = 16;
}

impl Census for Found {
    fn reach(&self) -> f64 {
        self.t_far
    }

    fn lose_count(&mut self) {
        self.len = Self::CAPACITY + 1;
    }

    #[inline]
    fn counts(&self, _: &Level, _: u32) -> bool {
        true
    }

    #[inline]
    fn meet(&mut self, level: &Level, index: u32, number: u64, t: f64) -> Control {
        if !level.may_be_transparent(index) {
            return if t <= self.t_max {
                Control::Stop
            } else {
                Control::Continue
            };
        }
        // A triangle that was cut stands in several leaves.
        let known = self
            .list
            .get(..self.len)
            .is_none_or(|list| list.contains(&(t, number)));
        if t > self.t_far || known {
            return Control::Continue;
        }
        if self.len == Self::CAPACITY {
            self.len += 1;
            return Control::Continue;
        }
        let mut place = self.len;
        while place > 0 && self.list[place - 1].0 > t {
            self.list[place] = self.list[place - 1];
            place -= 1;
        }
        self.list[place] = (t, number);
        self.len += 1;
        Control::Continue
    }
}

/// Whether anything that may be opaque is met within this distance.
struct OpaqueWithin(f64);

impl Census for OpaqueWithin {
    fn reach(&self) -> f64 {
        self.0
    }

    #[inline]
    fn counts(&self, level: &Level, index: u32) -> bool {
        // A shared mesh is marked transparent where whatever places it may be.
        level.group.is_none() || !level.may_be_transparent(index)
    }

    fn counts_in_tree(&self, level: &Level) -> bool {
        level.group.is_none() || level.has_opaque_tree
    }

    #[inline]
    fn meet(&mut self, _: &Level, _: u32, _: u64, t: f64) -> Control {
        if t <= self.0 {
            Control::Stop
        } else {
            Control::Continue
        }
    }
}

/// A census of one level.
struct Walk<'a, 's, C> {
    world: &'a World<'s>,
    level: &'a Level<'s>,
    base: u64,
    ray: &'a Ray,
    probe: &'a Probe,
    census: &'a mut C,
    /// Of searches through the tree.
    prepared: Option<Prepared>,
    /// Made when the first triangle needs it.
    triangle_ray: Option<TriangleRay>,
    control: Control,
}

/// A ray on its way through a tree.
struct Prepared {
    ray32: Ray32,
    range: Range,
    /// Made when the first block of triangles or spheres is met.
    for_blocks: Option<(RayBlock, RaySphere)>,
}

impl Prepared {
    /// Prepares the ray for the blocks of a level.
    #[inline(always)]
    fn for_blocks(&mut self, level: &Level) -> &(RayBlock, RaySphere) {
        self.for_blocks.get_or_insert_with(|| {
            let ray_block = RayBlock::new(&self.ray32, level.extent as f32);
            (ray_block, RaySphere::new(&ray_block))
        })
    }
}

impl<C: Census> Visitor for Walk<'_, '_, C> {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, lanes: L, leaf: Child, _: &mut f32) -> Control {
        self.control = self.look(lanes, leaf);
        self.control
    }

    #[inline(always)]
    fn blocks(&self) -> (*const u8, usize) {
        self.level.block_memory()
    }
}

impl<'a, 's, C: Census> Walk<'a, 's, C> {
    fn new(
        world: &'a World<'s>,
        level: &'a Level<'s>,
        base: u64,
        ray: &'a Ray,
        probe: &'a Probe,
        census: &'a mut C,
    ) -> Self {
        Self {
            world,
            level,
            base,
            ray,
            probe,
            census,
            prepared: None,
            triangle_ray: None,
            control: Control::Continue,
        }
    }

    #[inline(always)]
    fn look<L: Lanes>(&mut self, lanes: L, leaf: Child) -> Control {
        let level = self.level;
        match leaf.kind() {
            LeafKind::Others => {
                for &index in level.bvh.others(leaf) {
                    if self.primitive(index) == Control::Stop {
                        return Control::Stop;
                    }
                }
            }
            LeafKind::Triangles => {
                if let Some(block) = level.triangle_blocks.get(leaf.first()) {
                    let counted = self.counted(&block.ids, 0);
                    if counted != 0
                        && let Some(ray) = &mut self.prepared
                    {
                        let range = ray.range;
                        let (ray_block, _) = ray.for_blocks(level);
                        let found = block.candidates(lanes, ray_block, range);
                        return self.lanes(&block.ids, 0, counted & found.possible);
                    }
                }
            }
            LeafKind::Spheres => {
                if let Some(block) = level.sphere_blocks.get(leaf.first()) {
                    let first = level.triangles.len() as u32;
                    let counted = self.counted(&block.ids, first);
                    if counted != 0
                        && let Some(ray) = &mut self.prepared
                    {
                        let range = ray.range;
                        let (ray_block, ray_sphere) = ray.for_blocks(level);
                        let [possible, _] = block.candidates(lanes, ray_block, ray_sphere, range);
                        return self.lanes(&block.ids, first, counted & possible);
                    }
                }
            }
            LeafKind::Cuboids => {
                if let Some(block) = level.cuboid_blocks.get(leaf.first()) {
                    let counted = self.counted(&block.ids, 0);
                    if counted != 0
                        && let Some(ray) = &self.prepared
                    {
                        let ray_cuboid = RayCuboid::new(&ray.ray32, level.cuboid_extent);
                        let found = block.candidates(&ray_cuboid, ray.range);
                        return self.lanes(&block.ids, 0, counted & found.possible);
                    }
                }
            }
        }
        Control::Continue
    }

    /// The lanes of a block that count; a lane's primitive is its id after `first`.
    #[inline]
    fn counted(&self, ids: &[u32; BLOCK], first: u32) -> u32 {
        let counts = |id: u32| id != NONE && self.census.counts(self.level, first + id);
        (0..BLOCK).fold(0, |mask, lane| mask | u32::from(counts(ids[lane])) << lane)
    }

    /// Looks at the lanes of a block whose bits are set.
    #[inline]
    fn lanes(&mut self, ids: &[u32; BLOCK], first: u32, mask: u32) -> Control {
        for lane in lanes_of(mask) {
            if self.primitive(first + ids[lane]) == Control::Stop {
                return Control::Stop;
            }
        }
        Control::Continue
    }

    fn primitive(&mut self, index: u32) -> Control {
        let number = self.base + u64::from(index);
        let mut crossings = Crossings::default();
        match self.level.primitive(index) {
            Primitive::Instance(_) if self.world.is_stopped() => return Control::Stop,
            Primitive::Instance(i) => {
                let instance = &self.level.instances[i as usize];
                let inner = &self.world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                let base = self.base + instance.first_number;
                if inner.rare.is_some() {
                    return self.rare(inner, base, ray);
                }
                return self.world.walk(inner, base, &ray, self.probe, self.census);
            }
            _ if !self.census.counts(self.level, index) => return Control::Continue,
            Primitive::Triangle(i) => {
                if !self.probe.starts_on(number) {
                    let ray = self.ray;
                    let triangle_ray = self.triangle_ray.get_or_insert_with(|| TriangleRay::new(ray));
                    if let Some(hit) = triangle_ray.intersect(self.level.corners_of(i)) {
                        crossings.push(hit.t, 0);
                    }
                }
            }
            Primitive::Sphere(i) => {
                let sphere = self.level.spheres.get(i as usize);
                let Some((t0, t1)) = sphere.and_then(|s| s.roots(self.ray, self.probe, number)) else {
                    return Control::Continue;
                };
                if !self.probe.starts_on(number) {
                    return self.meet(index, number, &[t0, t1], self.probe.t_min);
                }
                crossings.push(t0, 0);
                crossings.push(t1, 0);
            }
            Primitive::Shape(i) => {
                let placed = &self.level.shapes[i as usize];
                if !placed.may_cross(self.ray, self.probe.least(number), self.census.reach()) {
                    return Control::Continue;
                }
                if let Shape::Isosurface(_) = placed.shape {
                    let is_opaque = !self.level.may_be_transparent(index);
                    let reach = self.census.reach();
                    crossings = placed.near_crossings(self.ray, self.probe, number, reach, is_opaque);
                } else {
                    let ray = self.ray.transformed(&placed.object_from_level);
                    placed.shape.crossings(&ray, &mut crossings);
                }
                if crossings.is_cut() && self.level.may_be_transparent(index) {
                    self.census.lose_count();
                }
            }
        }
        let least = self.probe.drop_start(number, &mut crossings);
        let mut t = [0.0; Crossings::CAPACITY];
        let found = crossings.as_slice();
        for (t, crossing) in t.iter_mut().zip(found) {
            *t = crossing.t;
        }
        self.meet(index, number, t.get(..found.len()).unwrap_or_default(), least)
    }

    /// Counts what is seen of a level that is more than things side by side.
    #[cold]
    #[inline(never)]
    fn rare(&mut self, level: &Level<'s>, base: u64, ray: Ray) -> Control {
        if level.solid().is_none() {
            let ray = self.world.entering(level, ray);
            return self.world.walk(level, base, &ray, self.probe, self.census);
        }
        self.solid(level, base, &ray)
    }

    /// Counts what is seen of a solid that is put together.
    fn solid(&mut self, level: &Level<'s>, base: u64, ray: &Ray) -> Control {
        let census = &mut *self.census;
        let stopped = self
            .world
            .meet_solid(level, base, ray, self.probe, |level, index, number, t| {
                census.counts(level, index) && census.meet(level, index, number, t) == Control::Stop
            });
        if stopped { Control::Stop } else { Control::Continue }
    }

    /// Counts a primitive's own crossings, in ascending order, beyond `least`.
    #[inline]
    fn meet(&mut self, index: u32, number: u64, crossings: &[f64], least: f64) -> Control {
        for &t in crossings {
            if t > least
                && t < f64::INFINITY
                && self.census.meet(self.level, index, number, t) == Control::Stop
            {
                return Control::Stop;
            }
        }
        Control::Continue
    }
}
