//! The nearest hit, and whether anything stands in the way.

use super::{
    World,
    level::{Level, Primitive},
};
use crate::{
    accel::{BLOCK, Control, LeafKind, NONE, RayBlock, RayBox, round_down, round_up},
    math::{Ray, max_abs},
    shape::{Crossings, Sphere, triangle::TriangleRay},
};

/// A ray with what it may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) ray: Ray,
    /// Nothing nearer counts: the rounding error of the ray's start.
    t_min: f64,
    /// A crossing of the start's own primitive this near to the start is the start.
    t_self: f64,
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

impl World<'_> {
    /// The nearest hit before `t_max`, least number first where several are equally near.
    pub(crate) fn nearest(&self, probe: &Probe, t_max: f64) -> Option<Hit> {
        let mut best = Hit {
            t: t_max,
            number: u64::MAX,
            u: 0.0,
            v: 0.0,
            part: 0,
        };
        if let Some(root) = self.root() {
            self.search::<false>(root, 0, &probe.ray, probe, &mut best);
        }
        (best.number != u64::MAX).then_some(best)
    }

    /// Whether anything at all is met before `t_max`.
    pub(crate) fn occluded(&self, probe: &Probe, t_max: f64) -> bool {
        let mut best = Hit {
            t: t_max,
            number: u64::MAX,
            u: 0.0,
            v: 0.0,
            part: 0,
        };
        self.root()
            .is_some_and(|root| self.search::<true>(root, 0, &probe.ray, probe, &mut best) == Control::Stop)
    }

    /// As [`World::nearest`], without the tree.
    #[cfg(test)]
    pub(super) fn nearest_brute(&self, probe: &Probe, t_max: f64) -> Option<Hit> {
        fn all(world: &World<'_>, level: &Level, base: u64, ray: &Ray, probe: &Probe, best: &mut Hit) {
            for index in 0..level.primitives() as u32 {
                if let Primitive::Instance(i) = level.primitive(index) {
                    let instance = &level.instances[i as usize];
                    let inner = &world.levels[instance.level as usize];
                    let ray = ray.transformed(&instance.inner_from_outer);
                    all(world, inner, base + instance.first_number, &ray, probe, best);
                } else {
                    let mut search = LevelSearch {
                        world,
                        level,
                        base,
                        ray,
                        probe,
                        best,
                        triangle_ray: None,
                    };
                    search.other::<false>(index);
                }
            }
        }
        let mut best = Hit {
            t: t_max,
            number: u64::MAX,
            u: 0.0,
            v: 0.0,
            part: 0,
        };
        all(self, self.root()?, 0, &probe.ray, probe, &mut best);
        (best.number != u64::MAX).then_some(best)
    }

    /// Whether shadows must look at the material of what they meet.
    pub(crate) fn has_transparency(&self) -> bool {
        self.has_transparency
    }

    /// Searches a level whose first primitive has the number `base`; `ray` is the probe's in the level's space.
    /// With `ANY` the first thing met ends the search.
    fn search<const ANY: bool>(
        &self,
        level: &Level,
        base: u64,
        ray: &Ray,
        probe: &Probe,
        best: &mut Hit,
    ) -> Control {
        let mut search = LevelSearch {
            world: self,
            level,
            base,
            ray,
            probe,
            best,
            triangle_ray: None,
        };
        for &index in &level.unbounded {
            if search.other::<ANY>(index) == Control::Stop {
                return Control::Stop;
            }
        }
        let ray_block = RayBlock::new(ray, level.extent);
        let t_least = round_up(probe.t_min);
        let t_most = round_down(search.best.t);
        let mut control = Control::Continue;
        let t_max = search.best.t;
        level
            .bvh
            .traverse::<ANY>(&RayBox::new(ray), t_max, |leaf, bound| {
                match leaf.kind() {
                    LeafKind::Triangles => {
                        for block in &level.triangle_blocks[leaf.range()] {
                            let found = block.candidates(&ray_block, t_least, t_most, *bound);
                            if found.possible == 0 {
                                continue;
                            }
                            if ANY && found.certain != 0 && search.is_not_start(&block.ids, found.certain) {
                                control = Control::Stop;
                                return control;
                            }
                            for lane in lanes(found.possible) {
                                if search.triangle(block.ids[lane]) && ANY {
                                    control = Control::Stop;
                                    return control;
                                }
                            }
                        }
                    }
                    LeafKind::Spheres => {
                        for block in &level.sphere_blocks[leaf.range()] {
                            for lane in lanes(block.possible(&ray_block, *bound)) {
                                if search.sphere(block.ids[lane]) && ANY {
                                    control = Control::Stop;
                                    return control;
                                }
                            }
                        }
                    }
                    LeafKind::Others => {
                        for &index in level.bvh.others(leaf) {
                            control = search.other::<ANY>(index);
                            if control == Control::Stop {
                                return control;
                            }
                        }
                    }
                }
                *bound = round_up(search.best.t);
                Control::Continue
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

/// A search of one level: the exact tests.
struct LevelSearch<'a, 's> {
    world: &'a World<'s>,
    level: &'a Level,
    base: u64,
    ray: &'a Ray,
    probe: &'a Probe,
    best: &'a mut Hit,
    /// Made when the first triangle needs it.
    triangle_ray: Option<TriangleRay>,
}

impl LevelSearch<'_, '_> {
    /// Takes a hit if it is the best so far.
    #[inline]
    fn offer(&mut self, hit: Hit) -> bool {
        let better = hit.t < self.best.t || (hit.t == self.best.t && hit.number < self.best.number);
        if better {
            *self.best = hit;
        }
        better
    }

    /// Whether any of the lanes is something else than the primitive the ray starts on.
    #[inline]
    fn is_not_start(&self, ids: &[u32; BLOCK], mask: u32) -> bool {
        lanes(mask).any(|lane| self.base + u64::from(ids[lane]) != self.probe.start)
    }

    #[inline]
    fn triangle(&mut self, index: u32) -> bool {
        let number = self.base + u64::from(index);
        if number == self.probe.start || index == NONE {
            return false;
        }
        let ray = self.ray;
        let triangle_ray = self.triangle_ray.get_or_insert_with(|| TriangleRay::new(ray));
        let [a, b, c] = self.level.corners(index);
        match triangle_ray.intersect(a, b, c) {
            Some(hit) if hit.t > self.probe.t_min => self.offer(Hit {
                t: hit.t,
                number,
                u: hit.u,
                v: hit.v,
                part: 0,
            }),
            _ => false,
        }
    }

    #[inline]
    fn sphere(&mut self, index: u32) -> bool {
        let Some(sphere) = self.level.spheres.get(index as usize) else {
            return false;
        };
        let number = self.base + self.level.triangles.len() as u64 + u64::from(index);
        let Some((t0, t1)) = Sphere::roots(sphere.center, sphere.radius, self.ray) else {
            return false;
        };
        let t_min = self.probe.t_min;
        let t = if number == self.probe.start {
            let mut crossings = Crossings::default();
            crossings.push(t0, 0);
            crossings.push(t1, 0);
            crossings.drop_start(self.probe.t_self);
            match crossings.first_within(t_min, f64::INFINITY) {
                Some(crossing) => crossing.t,
                None => return false,
            }
        } else if t0 > t_min {
            t0
        } else {
            t1
        };
        t > t_min
            && self.offer(Hit {
                t,
                number,
                u: 0.0,
                v: 0.0,
                part: 0,
            })
    }

    /// A primitive that is in no block.
    fn other<const ANY: bool>(&mut self, index: u32) -> Control {
        let met = match self.level.primitive(index) {
            Primitive::Shape(i) => self.shape(index, i),
            Primitive::Instance(i) => {
                let instance = &self.level.instances[i as usize];
                let inner = &self.world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                return self.world.search::<ANY>(
                    inner,
                    self.base + instance.first_number,
                    &ray,
                    self.probe,
                    self.best,
                );
            }
            Primitive::Triangle(i) => self.triangle(i),
            Primitive::Sphere(i) => self.sphere(i),
        };
        if met && ANY {
            Control::Stop
        } else {
            Control::Continue
        }
    }

    fn shape(&mut self, index: u32, i: u32) -> bool {
        let placed = &self.level.shapes[i as usize];
        let number = self.base + u64::from(index);
        let mut crossings = Crossings::default();
        placed
            .shape
            .crossings(&self.ray.transformed(&placed.object_from_level), &mut crossings);
        if number == self.probe.start {
            crossings.drop_start(self.probe.t_self);
        }
        match crossings.first_within(self.probe.t_min, f64::INFINITY) {
            Some(crossing) => self.offer(Hit {
                t: crossing.t,
                number,
                u: 0.0,
                v: 0.0,
                part: crossing.part,
            }),
            None => false,
        }
    }
}
