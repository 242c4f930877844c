//! The way of a ray through levels inside levels, on which everything that it meets is counted.

use super::census::{Census, Found};
use crate::{
    accel::{
        BLOCK, Child, Control, Lanes, LeafKind, NONE, Range, Ray32, RayBlock, RayBox, RayCuboid, RaySphere,
        Visitor,
    },
    math::Ray,
    render::world::{
        World,
        level::{Level, Primitive},
        query::Probe,
        shaft::FewObstacles,
        trace::{lanes_of, range},
    },
    shape::{CrossingSink, Crossings, Shape, triangle::TriangleRay},
};

impl World<'_> {
    pub(super) fn walk_few(&self, few: &FewObstacles, probe: &Probe, found: &mut Found) -> Control {
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

    pub(super) fn walk_root<C: Census>(&self, probe: &Probe, census: &mut C) -> Control {
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
