//! The nearest hit, and whether anything stands in the way.

use super::{
    World,
    level::{Level, Primitive},
};
use crate::{
    accel::{Control, RayBox},
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
        let triangle_ray = TriangleRay::new(ray);
        let mut control = Control::Continue;
        let mut t_max = best.t;
        let mut visit = |index: u32, t_max: &mut f64| {
            let found = match level.primitive(index) {
                Primitive::Triangle(i) => {
                    let number = base + u64::from(index);
                    if number == probe.start {
                        return Control::Continue;
                    }
                    let [a, b, c] = level.corners(i);
                    triangle_ray
                        .intersect(a, b, c)
                        .filter(|hit| hit.t > probe.t_min && hit.t <= best.t)
                        .map(|hit| Hit {
                            t: hit.t,
                            number,
                            u: hit.u,
                            v: hit.v,
                            part: 0,
                        })
                }
                Primitive::Sphere(i) => {
                    let sphere = &level.spheres[i as usize];
                    let number = base + u64::from(index);
                    Sphere::roots(sphere.center, sphere.radius, ray).and_then(|(t0, t1)| {
                        let t = if number == probe.start {
                            let mut crossings = Crossings::default();
                            crossings.push(t0, 0);
                            crossings.push(t1, 0);
                            crossings.drop_start(probe.t_self);
                            crossings.first_within(probe.t_min, f64::INFINITY)?.t
                        } else if t0 > probe.t_min {
                            t0
                        } else {
                            t1
                        };
                        (t > probe.t_min && t <= best.t).then_some(Hit {
                            t,
                            number,
                            u: 0.0,
                            v: 0.0,
                            part: 0,
                        })
                    })
                }
                Primitive::Shape(i) => {
                    let placed = &level.shapes[i as usize];
                    let number = base + u64::from(index);
                    let mut crossings = Crossings::default();
                    placed
                        .shape
                        .crossings(&ray.transformed(&placed.object_from_level), &mut crossings);
                    if number == probe.start {
                        crossings.drop_start(probe.t_self);
                    }
                    crossings
                        .first_within(probe.t_min, f64::INFINITY)
                        .filter(|crossing| crossing.t <= best.t)
                        .map(|crossing| Hit {
                            t: crossing.t,
                            number,
                            u: 0.0,
                            v: 0.0,
                            part: crossing.part,
                        })
                }
                Primitive::Instance(i) => {
                    let instance = &level.instances[i as usize];
                    let inner = &self.levels[instance.level as usize];
                    let inner_ray = ray.transformed(&instance.inner_from_outer);
                    let found =
                        self.search::<ANY>(inner, base + instance.first_number, &inner_ray, probe, best);
                    *t_max = best.t;
                    control = found;
                    return found;
                }
            };
            let Some(hit) = found.filter(|hit| hit.t < best.t || hit.number < best.number) else {
                return Control::Continue;
            };
            if ANY {
                control = Control::Stop;
                return Control::Stop;
            }
            *best = hit;
            *t_max = hit.t;
            Control::Continue
        };
        for &index in &level.unbounded {
            if visit(index, &mut t_max) == Control::Stop {
                return Control::Stop;
            }
        }
        level.bvh.traverse(&RayBox::new(ray), &mut t_max, visit);
        control
    }
}
