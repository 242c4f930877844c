//! The nearest hit, and whether anything stands in the way.

#[cfg(test)]
use super::level::Primitive;
use super::{
    World,
    exact::Exact,
    level::Level,
    query::{Blocker, Hit, Probe, Query},
};
use crate::{
    accel::{
        self, BLOCK, Child, Control, Few, Lanes, LeafKind, NONE, Range, Ray32, RayBlock, RayBox, RayCuboid,
        RaySphere, Spot, Task, Triangles, Visitor,
    },
    math::{Ray, smaller},
    shape::triangle::TriangleRay,
};

impl World<'_> {
    /// The nearest hit before `t_max`, least number first where several are equally near.
    pub(crate) fn nearest(&self, probe: &Probe, t_max: f64) -> Option<Hit> {
        let mut query = Query::new(probe, t_max);
        self.search::<false>(self.root()?, 0, &probe.ray, &mut query);
        query.hit()
    }

    /// What kind of thing is met before `t_max`.
    pub(crate) fn blocker(&self, probe: &Probe, t_max: f64) -> Blocker {
        let mut query = Query::new(probe, t_max);
        let stopped = self
            .root()
            .is_some_and(|root| self.search::<true>(root, 0, &probe.ray, &mut query));
        query.blocker(stopped)
    }

    /// Whether anything is met before `t_max`, in a world where nothing lets light through. `last` is the number of what
    /// was in the way of a ray like this one, which is tried first, and of what is in its own way then.
    pub(super) fn is_blocked(&self, probe: &Probe, t_max: f64, last: &mut u64) -> bool {
        let Some(root) = self.root() else {
            return false;
        };
        let mut query = Query::new(probe, t_max);
        let own = (root.primitives() - root.instances.len()) as u64;
        if *last < own {
            let mut exact = Exact::<true> {
                world: self,
                level: root,
                base: 0,
                ray: &probe.ray,
                query: &mut query,
            };
            if exact.any(*last as u32) {
                return true;
            }
        }
        let stopped = self.search::<true>(root, 0, &probe.ray, &mut query);
        *last = query.best.number;
        stopped
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
                        &world.entering(inner, ray.transformed(&instance.inner_from_outer)),
                        query,
                    );
                } else {
                    Exact::<false> {
                        world,
                        level,
                        base,
                        ray,
                        query,
                    }
                    .any(index);
                }
            }
        }
        let mut query = Query::new(probe, t_max);
        all(self, self.root()?, 0, &probe.ray, &mut query);
        query.hit()
    }

    /// Searches a level whose first primitive has the number `base`; `ray` is the probe's in the level's space.
    /// With `ANY` the first opaque thing met ends the search: then the answer is true.
    pub(super) fn search<const ANY: bool>(
        &self,
        level: &Level,
        base: u64,
        ray: &Ray,
        query: &mut Query<'_>,
    ) -> bool {
        let mut exact = Exact::<ANY> {
            world: self,
            level,
            base,
            ray,
            query,
        };
        // A group of one shape, placed many times: its box is what led here.
        if level.primitives() == 1 && level.instances.is_empty() {
            return exact.any(0);
        }
        if level.unbounded.iter().any(|&index| exact.any(index)) {
            return true;
        }
        exact.below(Child::ROOT, f32::INFINITY)
    }
}

impl<const ANY: bool> Exact<'_, '_, '_, ANY> {
    /// Searches what the level's tree has below `from`, where nothing beyond `bound` counts. True where that ended the
    /// search.
    #[inline]
    pub(super) fn below(&mut self, from: Child, bound: f32) -> bool {
        accel::run(LevelTask {
            exact: self,
            from,
            bound,
        })
    }
}

/// The search of a level's tree; true where it was stopped. Preparing the ray is part of it, so that what is prepared
/// stays in registers.
struct LevelTask<'t, 'a, 's, 'p, const ANY: bool> {
    exact: &'t mut Exact<'a, 's, 'p, ANY>,
    from: Child,
    bound: f32,
}

impl<const ANY: bool> Task for LevelTask<'_, '_, '_, '_, ANY> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let Self { exact, from, bound } = self;
        let level = exact.level;
        let ray32 = Ray32::new(exact.ray);
        let ray_box = RayBox::new(&ray32, level.bvh.extent());
        let mut search = LevelSearch::new(exact, &ray32);
        let possible = search.range.possible;
        let bound = smaller(search.range.bound, bound);
        level
            .bvh
            .traverse_with::<_, ANY>(lanes, from, &ray_box, possible, bound, &mut search);
        if !ANY {
            search.decide();
        }
        search.stopped
    }
}

/// What counts in f32 where t counts from `t_min` to `t_max` in f64.
#[inline(always)]
pub(super) fn range(t_min: f64, t_max: f64) -> Range {
    Range {
        // Twice as far as the exact bound, for the rounding of tests in f32 where t is negative.
        possible: 2.0 * smaller(t_min as f32, 0.0),
        bound: above(t_max),
        certain: [above(t_min), below(t_max)],
    }
}

/// In f32, not below `t` where it is not negative.
#[inline(always)]
pub(super) fn above(t: f64) -> f32 {
    t as f32 * (1.0 + 2.0 * f32::EPSILON)
}

/// In f32, not above `t` where it is not negative and f32 has numbers as large.
#[inline(always)]
fn below(t: f64) -> f32 {
    t as f32 * (1.0 - 2.0 * f32::EPSILON)
}

/// The lanes whose bits are set.
#[inline(always)]
pub(super) fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize & (BLOCK - 1);
            mask &= mask - 1;
            lane
        })
    })
}

/// Most triangles and boxes that wait for their exact test.
const WAITING: usize = 4;

/// What may be the nearest hit, and how far away it is at least.
#[derive(Clone, Copy)]
struct Waiting {
    index: u32,
    least: f32,
    /// Where a triangle stands.
    spot: Spot,
}

impl Waiting {
    const NOTHING: Self = Self {
        index: NONE,
        least: 0.0,
        spot: Spot::NOWHERE,
    };
}

/// A search of one level.
struct LevelSearch<'t, 'a, 's, 'p, const ANY: bool> {
    /// Where it is: what was written number by number would have to be read so to be moved.
    exact: &'t mut Exact<'a, 's, 'p, ANY>,
    ray_block: RayBlock,
    /// Prepared once a sphere or a box is met.
    ray_sphere: Option<RaySphere>,
    ray_cuboid: Option<RayCuboid>,
    range: Range,
    /// Index of the primitive that the ray starts on, where it is one of this level.
    start: u32,
    /// Triangles and boxes that may be the nearest hit, and how far away they are at least. In f32 it is nearly always known
    /// which of two hits is nearer, so that most are never looked at in f64.
    waiting: Few<Waiting, WAITING>,
    stopped: bool,
}

impl<const ANY: bool> Visitor for LevelSearch<'_, '_, '_, '_, ANY> {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> Control {
        // Asked first: a branch that can be foreseen, where four ways would be a jump through a table.
        self.stopped = if leaf.kind() == LeafKind::Triangles {
            self.triangles(lanes, leaf, bound)
        } else {
            match leaf.kind() {
                LeafKind::Triangles => false,
                LeafKind::Spheres => self.spheres(lanes, leaf, bound),
                LeafKind::Cuboids => self.cuboids(leaf, bound),
                LeafKind::Others => self.others(leaf, bound),
            }
        };
        if ANY && self.stopped {
            Control::Stop
        } else {
            Control::Continue
        }
    }

    #[inline(always)]
    fn blocks(&self) -> (*const u8, usize) {
        self.exact.level.block_memory()
    }
}

impl<'t, 'a, 's, 'p, const ANY: bool> LevelSearch<'t, 'a, 's, 'p, ANY> {
    #[inline(always)]
    fn new(exact: &'t mut Exact<'a, 's, 'p, ANY>, ray32: &Ray32) -> Self {
        let (probe, t_max) = (exact.query.probe, exact.query.best.t);
        let level = exact.level;
        Self {
            ray_block: RayBlock::new(ray32, level.extent as f32),
            ray_sphere: None,
            ray_cuboid: None,
            range: range(probe.t_min, t_max),
            start: u32::try_from(probe.start.wrapping_sub(exact.base)).unwrap_or(NONE),
            exact,
            waiting: Few::empty(),
            stopped: false,
        }
    }

    /// Lowers the bound to the best hit so far.
    #[inline(always)]
    fn lower(&self, bound: &mut f32) {
        *bound = smaller(above(self.exact.query.best.t), *bound);
    }

    #[inline(always)]
    fn triangles<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> bool {
        let at = leaf.first();
        let Some(block) = self.exact.level.triangle_blocks.get(at) else {
            return false;
        };
        let mut range = self.range;
        if !ANY {
            (range.bound, range.certain[1]) = (*bound, *bound);
        }
        let found = block.candidates(lanes, &self.ray_block, range);
        if found.possible == 0 {
            return false;
        }
        if ANY {
            return self.any_of(block, found.possible, found.certain);
        }
        let [t_least, t_most] = found.t;
        for lane in lanes_of(found.possible) {
            let index = block.ids[lane];
            if index == self.start {
                continue;
            }
            let mut least = f32::NEG_INFINITY;
            if found.certain >> lane & 1 == 1 {
                *bound = smaller(t_most[lane], *bound);
                least = t_least[lane];
            }
            let spot = Spot::new(at, lane);
            self.wait(Waiting { index, least, spot }, bound);
            self.exact.level.ask_for_corners_in(block, lane);
        }
        false
    }

    /// Notes a primitive that may be the nearest hit, and how far away it is at least.
    #[inline(always)]
    fn wait(&mut self, waiting: Waiting, bound: &mut f32) {
        if self.waiting.is_full() {
            self.decide_now();
            self.lower(bound);
        }
        self.waiting.push(waiting);
    }

    /// Whether any of a block's triangles ends the search.
    #[inline]
    fn any_of(&mut self, block: &Triangles, possible: u32, certain: u32) -> bool {
        let ids = &block.ids;
        let ends =
            |lane: &usize| ids[*lane] != self.start && !self.exact.level.may_be_transparent(ids[*lane]);
        if let Some(lane) = lanes_of(certain).find(ends) {
            self.exact.stop_at(ids[lane]);
            return true;
        }
        let ray = TriangleRay::new(self.exact.ray);
        lanes_of(possible).any(|lane| self.exact.triangle_in(&ray, block, lane))
    }

    /// Decides which of the waiting triangles and boxes is hit first, the last found first: it is the nearest, but for
    /// rounding.
    #[inline(always)]
    fn decide(&mut self) {
        let Some(last) = self.waiting.pop() else {
            return;
        };
        if !self.exact.level.cuboid_blocks.is_empty() {
            self.decide_any(last);
            return;
        }
        let ray = TriangleRay::new(self.exact.ray);
        let mut next = Some(last);
        while let Some(Waiting { least, spot, .. }) = next {
            let (block, lane) = spot.get();
            if f64::from(least) <= self.exact.query.best.t
                && let Some(block) = self.exact.level.triangle_blocks.get(block)
            {
                self.exact.triangle_in(&ray, block, lane);
            }
            next = self.waiting.pop();
        }
    }

    /// As [`Self::decide`] before the end, which is rare.
    #[cold]
    #[inline(never)]
    fn decide_now(&mut self) {
        self.decide();
    }

    /// As [`Self::decide`] where boxes may be among those that wait.
    #[inline(never)]
    fn decide_any(&mut self, last: Waiting) {
        let mut next = Some(last);
        while let Some(Waiting { index, least, .. }) = next {
            if f64::from(least) <= self.exact.query.best.t {
                self.exact.any(index);
            }
            next = self.waiting.pop();
        }
    }

    #[inline(always)]
    fn spheres<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> bool {
        let level = self.exact.level;
        let Some(block) = level.sphere_blocks.get(leaf.first()) else {
            return false;
        };
        let ray = match self.ray_sphere {
            Some(ray) => ray,
            None => *self.ray_sphere.insert(RaySphere::new(&self.ray_block)),
        };
        let range = Range {
            bound: *bound,
            ..self.range
        };
        let [possible, certain] = block.candidates(lanes, &self.ray_block, &ray, range);
        if ANY && certain != 0 {
            let first = level.triangles.len() as u32;
            let ends = |index: u32| index != self.start && !level.may_be_transparent(index);
            if let Some(lane) = lanes_of(certain).find(|lane| ends(first + block.ids[*lane])) {
                self.exact.stop_at(first + block.ids[lane]);
                return true;
            }
        }
        if lanes_of(possible).any(|lane| self.exact.sphere(block.ids[lane])) {
            return true;
        }
        self.lower(bound);
        false
    }

    /// A function of its own: the search of other leaves is the faster for it.
    #[inline(never)]
    fn cuboids(&mut self, leaf: Child, bound: &mut f32) -> bool {
        let level = self.exact.level;
        let Some(block) = level.cuboid_blocks.get(leaf.first()) else {
            return false;
        };
        let ray = *self
            .ray_cuboid
            .get_or_insert_with(|| RayCuboid::new(&Ray32::new(self.exact.ray), level.cuboid_extent));
        let mut range = self.range;
        if !ANY {
            (range.bound, range.certain[1]) = (*bound, *bound);
        }
        let found = block.candidates(&ray, range);
        if found.possible == 0 {
            return false;
        }
        if ANY {
            let ends = |index: u32| index != self.start && !level.may_be_transparent(index);
            if let Some(lane) = lanes_of(found.certain).find(|lane| ends(block.ids[*lane])) {
                self.exact.stop_at(block.ids[lane]);
                return true;
            }
            return lanes_of(found.possible).any(|lane| self.exact.any(block.ids[lane]));
        }
        let [least, most] = found.t;
        for lane in lanes_of(found.certain) {
            if block.ids[lane] != self.start {
                *bound = smaller(most[lane], *bound);
            }
        }
        for lane in lanes_of(found.possible) {
            if least[lane] <= *bound {
                let waiting = Waiting {
                    index: block.ids[lane],
                    least: least[lane],
                    ..Waiting::NOTHING
                };
                self.wait(waiting, bound);
            }
        }
        false
    }

    #[inline(never)]
    fn others(&mut self, leaf: Child, bound: &mut f32) -> bool {
        // What they ask of the query is its best hit.
        self.decide_now();
        let others = self.exact.level.bvh.others(leaf);
        let stopped = others.iter().any(|&index| self.exact.any(index));
        self.lower(bound);
        stopped
    }
}
