//! All crossings of a line with the primitives of a level.

use super::{
    super::{
        World,
        level::{Level, Primitive},
        query::Probe,
        trace::lanes_of,
    },
    events::{Event, Events},
};
use crate::{
    accel::{
        BLOCK, Child, Control, Lanes, LeafKind, NONE, Range, Ray32, RayBlock, RayBox, RayCuboid, RaySphere,
        Visitor,
    },
    math::{Ray, max_abs},
    shape::{CrossingSink, Shape, Sphere, triangle::TriangleRay},
};

/// Adds all crossings of a line with the primitives of a level, those of levels inside it after they are resolved, in
/// any order. The answer are the objects that the line is inside of before all crossings.
pub(super) fn gather<'a, 's>(
    world: &'a World<'s>,
    level: &'a Level<'s>,
    base: u64,
    ray: &Ray,
    probe: &Probe,
    events: &mut Events<'a, 's>,
) -> Vec<u32> {
    let from = events.len();
    let mut gather = Gather {
        world,
        level,
        base,
        ray,
        probe,
        events,
        prepared: None,
        triangle_ray: None,
        endless: Vec::new(),
    };
    for &index in &level.unbounded {
        gather.primitive(index);
    }
    // Tests in f32 are only certain of what lies ahead of a ray: they are given one that starts before all there is.
    let ahead = before(ray, f64::from(level.bvh.extent()));
    let ray32 = Ray32::new(&ahead);
    gather.prepared = (level.has_blocks() || !level.cuboid_blocks.is_empty()).then(|| {
        let ray_block = RayBlock::new(&ray32, level.extent as f32);
        Prepared {
            ray_sphere: RaySphere::new(&ray_block),
            ray_cuboid: RayCuboid::new(&ray32, level.cuboid_extent),
            ray_block,
        }
    });
    let ray_box = RayBox::new(&ray32, level.bvh.extent());
    level
        .bvh
        .traverse::<true>(&ray_box, ALL.possible, ALL.bound, &mut gather);
    let endless = gather.endless;
    mark_start(level, base, probe, events.from(from));
    endless
}

/// Everything ahead of a ray.
const ALL: Range = Range {
    possible: 0.0,
    bound: f32::INFINITY,
    certain: [f32::INFINITY, 0.0],
};

/// A ray along the same line that starts before everything whose coordinates are at most `extent` in size. What the
/// shift costs in digits is small beside the distance that all of it then has, which tests in f32 allow for.
fn before(ray: &Ray, extent: f64) -> Ray {
    let length2 = ray.dir.length_squared();
    let away = (2.0 * extent).max(1e-6 * max_abs(ray.origin));
    let t = -ray.origin.dot(ray.dir) / length2 - away / length2.sqrt();
    if t < 0.0 {
        Ray::new(ray.at(t), ray.dir)
    } else {
        *ray
    }
}

/// Marks the crossing that is the start of the ray: of those with the primitive that it starts on the nearest to it, if
/// it is near. A triangle has but one.
fn mark_start(level: &Level<'_>, base: u64, probe: &Probe, events: &mut [Event<'_, '_>]) {
    // Levels inside this one have marked theirs.
    let own = (level.primitives() - level.instances.len()) as u64;
    let is_here = probe
        .started_on()
        .is_some_and(|start| start >= base && start - base < own);
    if !is_here {
        return;
    }
    let own = events.iter_mut().filter(|event| probe.starts_on(event.number));
    let nearest = own.min_by(|a, b| a.t.abs().total_cmp(&b.t.abs()));
    if let Some(event) = nearest
        && (event.is_triangle || probe.is_start(event.t))
    {
        event.is_start = true;
    }
}

/// A ray prepared for the tests of blocks.
#[derive(Clone, Copy)]
struct Prepared {
    ray_block: RayBlock,
    ray_sphere: RaySphere,
    ray_cuboid: RayCuboid,
}

struct Gather<'g, 'a, 's> {
    world: &'a World<'s>,
    level: &'a Level<'s>,
    base: u64,
    ray: &'g Ray,
    probe: &'g Probe,
    events: &'g mut Events<'a, 's>,
    prepared: Option<Prepared>,
    /// Made when the first triangle needs it.
    triangle_ray: Option<TriangleRay>,
    endless: Vec<u32>,
}

impl Visitor for Gather<'_, '_, '_> {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, lanes: L, leaf: Child, _: &mut f32) -> Control {
        self.look(lanes, leaf);
        Control::Continue
    }

    #[inline(always)]
    fn blocks(&self) -> (*const u8, usize) {
        self.level.block_memory()
    }
}

/// Takes the crossings of a shape.
struct Sink<'g, 'a, 's> {
    events: &'g mut Events<'a, 's>,
    event: Event<'a, 's>,
}

impl CrossingSink for Sink<'_, '_, '_> {
    fn push(&mut self, t: f64, part: u32) {
        if !t.is_nan() {
            self.events.push(Event {
                t,
                part,
                ..self.event
            });
        }
    }
}

impl<'a, 's> Gather<'_, 'a, 's> {
    #[inline(always)]
    fn look<L: Lanes>(&mut self, lanes: L, leaf: Child) {
        let level = self.level;
        match (leaf.kind(), self.prepared) {
            (LeafKind::Others, _) => {
                for &index in level.bvh.others(leaf) {
                    self.primitive(index);
                }
            }
            (LeafKind::Triangles, Some(ray)) => {
                if let Some(block) = level.triangle_blocks.get(leaf.first()) {
                    let found = block.candidates(lanes, &ray.ray_block, ALL);
                    self.lanes(&block.ids, 0, found.possible);
                }
            }
            (LeafKind::Spheres, Some(ray)) => {
                if let Some(block) = level.sphere_blocks.get(leaf.first()) {
                    let [possible, _] = block.candidates(lanes, &ray.ray_block, &ray.ray_sphere, ALL);
                    self.lanes(&block.ids, level.triangles.len() as u32, possible);
                }
            }
            (LeafKind::Cuboids, Some(ray)) => {
                if let Some(block) = level.cuboid_blocks.get(leaf.first()) {
                    let found = block.candidates(&ray.ray_cuboid, ALL);
                    self.lanes(&block.ids, 0, found.possible);
                }
            }
            (_, None) => {}
        }
    }

    fn lanes(&mut self, ids: &[u32; BLOCK], first: u32, mask: u32) {
        for lane in lanes_of(mask) {
            if ids[lane] != NONE {
                self.primitive(first + ids[lane]);
            }
        }
    }

    fn primitive(&mut self, index: u32) {
        let (world, level) = (self.world, self.level);
        let number = self.base + u64::from(index);
        let event = |object: u32| Event {
            number,
            ..Event::new(level, index, object)
        };
        match level.primitive(index) {
            Primitive::Instance(_) if world.is_stopped() => {}
            Primitive::Instance(i) => {
                let instance = &level.instances[i as usize];
                let inner = &world.levels[instance.level as usize];
                let ray = self.ray.transformed(&instance.inner_from_outer);
                let from = self.events.len();
                let base = self.base + instance.first_number;
                if world.spans(inner, base, &ray, self.probe, self.events) {
                    self.endless.push(instance.object);
                }
                for event in self.events.from(from) {
                    event.object = instance.object;
                }
            }
            Primitive::Triangle(i) => {
                let ray = self.ray;
                let triangle_ray = self.triangle_ray.get_or_insert_with(|| TriangleRay::new(ray));
                if let (Some(hit), Some(run)) = (triangle_ray.cross(level.corners_of(i)), level.run(i)) {
                    self.events.push(Event {
                        t: hit.t,
                        u: hit.u,
                        v: hit.v,
                        is_triangle: true,
                        ..event(run.object)
                    });
                }
            }
            Primitive::Sphere(i) => {
                let Some(sphere) = level.spheres.get(i as usize) else {
                    return;
                };
                if let Some((t0, t1)) = Sphere::roots(sphere.center, sphere.radius, self.ray) {
                    let event = event(sphere.object);
                    self.events.push(Event { t: t0, ..event });
                    self.events.push(Event { t: t1, ..event });
                }
            }
            Primitive::Shape(i) => {
                let placed = &level.shapes[i as usize];
                let ray = self.ray.transformed(&placed.object_from_level);
                if let Shape::Plane(_) = placed.shape {
                    // All that lies below it: a line that rises was there from its beginning.
                    let begins_below = ray.dir.y > 0.0 || ray.dir.y == 0.0 && ray.origin.y < 0.0;
                    if begins_below {
                        self.endless.push(placed.object);
                    }
                }
                let mut sink = Sink {
                    event: event(placed.object),
                    events: self.events,
                };
                placed.shape.crossings(&ray, &mut sink);
            }
        }
    }
}
