//! The recursive ray tracer of Whitted ("An improved illumination model for shaded display", 1980), as a loop.

use super::{
    interrupt::Interrupt,
    lighting::{self, Gloss, Known},
    observe::{AtTheEnd, Observer, RayKind},
    path::Path,
    polish::{self, Inside, Polished},
    sampler::Sampler,
    world::{Hit, Probe, SurfacePoint, World},
};
use crate::{
    color::Color,
    math::{DVec3, Exponent, Ray},
};

/// Rays traced, by kind.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) camera: u64,
    pub(super) shadow: u64,
    pub(super) reflected: u64,
    pub(super) refracted: u64,
    pub(super) invalid: u64,
    /// Not counted up: what the lights remember from one point to the next.
    pub(super) luck: lighting::Luck,
}

impl Counts {
    pub(super) fn add(&mut self, other: &Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
        self.invalid += other.invalid;
    }

    pub(super) fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflected + self.refracted
    }
}

/// A camera ray and what it meets first.
pub(super) struct Sight<'w, 'a> {
    pub(super) probe: &'a Probe,
    pub(super) hit: Option<Hit>,
    /// How it looks there, and which lights reach it, where that is known already. By reference: a surface's point is too
    /// large to be moved for each ray.
    pub(super) ahead: Option<(&'a SurfacePoint<'w>, Known<'a>)>,
}

impl<'a> Sight<'_, 'a> {
    /// The ray of which no more is known than what it meets.
    pub(super) fn new(world: &World<'_>, probe: &'a Probe) -> Self {
        Self::met(probe, world.nearest(probe, f64::INFINITY))
    }

    /// The ray and what it meets.
    pub(super) fn met(probe: &'a Probe, hit: Option<Hit>) -> Self {
        Self {
            probe,
            hit,
            ahead: None,
        }
    }
}

/// A ray still to be traced.
#[derive(Clone, Copy, Debug)]
struct Pending {
    probe: Probe,
    /// Share of what it sees that reaches the camera.
    weight: Color,
    depth: u32,
    inside: Inside,
    /// Length of the path before it; 0 where no texture asks.
    before: f64,
}

/// Rays that wait, kept from one camera sample to the next so that none of them allocates or clears memory.
#[derive(Debug, Default)]
pub(super) struct Stack(Vec<Pending>);

/// Points of one sample between two looks at the interrupt.
const POINTS_PER_POLL: u64 = 64;

/// The light along every camera ray that meets nothing, where that is the same for all.
pub(super) fn nothing(world: &World<'_>) -> Option<Color> {
    // A sum that begins with 0, as that of any path: it is never -0.
    let background = Color::ZERO + world.scene.settings.background;
    (world.around.is_none() && background.is_finite()).then_some(background)
}

/// Light along a camera ray, of which it is known what it meets first.
pub(super) fn radiance<'w, 'a, O: Observer>(
    world: &World<'w>,
    Sight {
        probe,
        mut hit,
        ahead,
    }: Sight<'w, 'a>,
    sampler: Sampler,
    interrupt: &'a Interrupt<'a>,
    Stack(waiting): &mut Stack,
    counts: &mut Counts,
    observer: &mut O,
) -> Color {
    let settings = &world.scene.settings;
    let mut path = Path::new(sampler, interrupt);
    let mut first = ahead.map(|(point, known)| {
        path.known = known;
        point
    });
    let mut sum = Color::ZERO;
    waiting.clear();
    // Changed in place, because it is too large to be moved for each ray.
    let mut current = Pending {
        probe: *probe,
        weight: Color::ONE,
        depth: 0,
        inside: Inside::default(),
        before: 0.0,
    };
    counts.camera += 1;
    loop {
        if interrupt.is_stopped() {
            return Color::ZERO;
        }
        let ray = &current.probe.ray;
        let Pending {
            mut weight,
            depth,
            inside,
            mut before,
            ..
        } = current;
        observer.ray(ray, weight, depth);
        let goes_on = 'point: {
            let footprint;
            let (mut own, mut relieved) = (None, None);
            let point = match first.take() {
                None => {
                    if let Some(hit) = &hit {
                        world.surface_into(hit, ray, &mut own);
                    }
                    if let (Some(hit), Some(at)) = (&mut hit, &mut own) {
                        if !at.material.transmission.is_black() {
                            prefer_opaque(world, &current.probe, hit, at);
                        }
                        if world.needs_width {
                            before += (at.position - ray.origin).length();
                            if at.material.is_textured() {
                                let width = world.pixel_width(before);
                                world.measure(hit, ray, at, width);
                                if world.needs_footprint {
                                    footprint = world.footprint(hit, ray, at, width);
                                    at.footprint = footprint.as_ref();
                                }
                            }
                        }
                    }
                    own.as_ref()
                }
                ready => ready,
            };
            let (Some(hit), Some(mut at)) = (&hit, point) else {
                if inside.is_any() {
                    weight *= polish::dimmed(world, inside, ray, None, &path);
                    observer.dimmed(weight);
                }
                let mut seen = settings.background;
                let mut added = weight * seen;
                if let Some(around) = &world.around {
                    seen = around.beyond(seen, ray.dir);
                    added = weight * seen;
                    let way = (ray, f64::INFINITY);
                    if let Some(air) = around.air(world, way, None, &path, counts) {
                        observer.air(&air);
                        added = weight * (air.passed * seen + air.scattered);
                    }
                    // The next way through air has numbers of its own.
                    path.vertex += 1;
                }
                observer.background(seen, added);
                sum += added;
                break 'point false;
            };
            let mut polished = None;
            if inside.is_any() || at.material.finish.is_some() {
                weight *= polish::dimmed(world, inside, ray, Some((hit, at)), &path);
                observer.dimmed(weight);
                if let Some(finish) = at.material.finish.as_deref() {
                    let relieved = relieved.insert(*at);
                    polished = Some(Polished::new(world, finish, (hit, ray), relieved, inside, &path));
                    at = relieved;
                }
            }
            observer.surface(hit, ray, at);
            let term = |term| world.term(term, at);
            let m = at.material;
            let gloss = Gloss {
                diffuse: term(&m.diffuse),
                specular: term(&m.specular),
                exponent: Exponent::new(m.shininess),
                custom: match &polished {
                    Some(polished) if m.reflectance.is_none() => Some(polished),
                    _ => m.reflectance.as_deref(),
                },
                polished: polished.as_ref().filter(|_| m.reflectance.is_none()),
            };
            let (mut ambient, emission) = (term(&m.ambient), term(&m.emission));
            if let Some(around) = &world.around
                && around.occlusion.is_some()
                && ambient != Color::ZERO
            {
                ambient *= lighting::openness(world, at, hit.number, &path, counts);
            }
            let mut faint = None;
            if !O::WATCHES && world.may_be_faint(&gloss) {
                let place = (at, hit.number, ray.origin);
                let whole = |direct| sum + weight * (ambient + emission + direct);
                faint = lighting::highlights(world, place, &gloss, counts, whole);
            }
            let direct = match faint {
                Some(direct) => direct,
                None => lighting::direct(world, at, hit.number, ray.origin, &gloss, &path, counts, observer),
            };
            let mut added = weight * (ambient + emission + direct);
            if let Some(around) = &world.around {
                // Where something transparent touches something opaque, the hit counts from elsewhere.
                let way = (ray, (at.position - ray.origin).length());
                if let Some(air) = around.air(world, way, Some(at), &path, counts) {
                    observer.air(&air);
                    added = weight * (air.passed * (ambient + emission + direct) + air.scattered);
                    weight *= air.passed;
                }
            }
            observer.shaded(ambient, emission, direct, added);
            sum += added;
            path.vertex += 1;
            path.known = Known::default();
            if path.vertex.is_multiple_of(POINTS_PER_POLL) && interrupt.poll() {
                return Color::ZERO;
            }
            if depth == settings.max_depth {
                match &polished {
                    None => observer.deepest(world, at, ray, weight),
                    Some(polished) if O::WATCHES => {
                        polished.split(world, weight, &path, &mut AtTheEnd(observer));
                    }
                    Some(_) => {}
                }
                break 'point false;
            }
            let (mirrored, refracted) = match &polished {
                None => split(world, at, ray, weight, observer),
                Some(polished) => polished.split(world, weight, &path, observer),
            };
            counts.reflected += u64::from(mirrored.is_some());
            counts.refracted += u64::from(refracted.is_some());
            let onward = |branch: &Branch, inside: Inside| Pending {
                probe: Probe::from_surface(Ray::new(at.position, branch.dir), hit.number, at.scale),
                weight: branch.weight,
                depth: depth + 1,
                inside: branch.inside.unwrap_or(inside),
                before,
            };
            match (&mirrored, &refracted) {
                (Some(mirrored), Some(refracted)) => {
                    // The mirrored ray goes first. So one waits at each depth.
                    waiting.push(onward(refracted, inside.left()));
                    current = onward(mirrored, inside);
                }
                (Some(mirrored), None) => current = onward(mirrored, inside),
                (None, Some(refracted)) => current = onward(refracted, inside.left()),
                (None, None) => break 'point false,
            }
            true
        };
        if !goes_on {
            let Some(next) = waiting.pop() else {
                break;
            };
            current = next;
        }
        hit = world.nearest(&current.probe, f64::INFINITY);
    }
    if sum.is_finite() {
        sum
    } else {
        counts.invalid += 1;
        Color::ZERO
    }
}

/// Where something transparent touches something opaque, as a block of glass touches the table it stands on, what a
/// ray shows is the opaque one: it would be seen through the other anyway, and which of the two is nearer is a matter
/// of rounding. `at` is where the ray meets something transparent.
#[inline(never)]
fn prefer_opaque<'s>(world: &World<'s>, probe: &Probe, hit: &mut Hit, at: &mut SurfacePoint<'s>) {
    if let Some((other, ray)) = world.touching(hit, &probe.ray, at)
        && let Some(behind) = world.surface(&other, &ray)
        && behind.material.transmission.is_black()
    {
        (*hit, *at) = (other, behind);
    }
}

/// A ray that goes on from a surface.
pub(super) struct Branch {
    pub(super) dir: DVec3,
    /// Share of what it sees that reaches the camera.
    pub(super) weight: Color,
    /// What it carries along, where the surface has a say in that.
    pub(super) inside: Option<Inside>,
}

/// The weight of a ray that a surface sends `share` on with, of the `weight` that the surface has; `None` where it is
/// too small to be followed.
pub(super) fn followed<O: Observer>(
    world: &World<'_>,
    kind: RayKind,
    share: Color,
    weight: Color,
    observer: &mut O,
) -> Option<Color> {
    let weight = weight * share;
    let is_followed = weight.max_element() >= world.scene.settings.min_weight;
    observer.branch(kind, share, weight, is_followed);
    is_followed.then_some(weight)
}

/// The mirrored and the refracted ray at a surface that `weight` of what it sends out reaches the camera from,
/// those that are worth following. Total internal reflection adds Kt to the mirror.
pub(super) fn split<O: Observer>(
    world: &World<'_>,
    at: &SurfacePoint<'_>,
    ray: &Ray,
    weight: Color,
    observer: &mut O,
) -> (Option<Branch>, Option<Branch>) {
    let n = at.shading_normal;
    let mut kr = world.term(&at.material.mirror(), at);
    let kt = world.term(&at.material.transmission, at);
    let mut through = None;
    if kt != Color::ZERO {
        let eta = if at.from_front {
            1.0 / at.material.ior
        } else {
            at.material.ior
        };
        match refract(ray.dir, n, eta) {
            Some(dir) => {
                through = followed(world, RayKind::Refracted, kt, weight, observer).map(|weight| Branch {
                    dir,
                    weight,
                    inside: None,
                });
            }
            None => {
                observer.total_reflection(kt);
                kr += kt;
            }
        }
    }
    let mirror = followed(world, RayKind::Reflected, kr, weight, observer).map(|weight| {
        let mirrored = ray.dir - n * (2.0 * ray.dir.dot(n));
        Branch {
            dir: mirrored / mirrored.length(),
            weight,
            inside: None,
        }
    });
    (mirror, through)
}

/// Snell's law: the direction of the unit vector `dir` behind a surface with unit normal `n` on the ray's side,
/// `eta` being the index of refraction before it over that behind it. `None` at total internal reflection.
/// (Heckbert, "Writing a ray tracer", in Glassner, An Introduction to Ray Tracing, 1989.)
pub(super) fn refract(dir: DVec3, n: DVec3, eta: f64) -> Option<DVec3> {
    let cosine = -dir.dot(n);
    let k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if !(k >= 0.0) {
        return None;
    }
    let refracted = dir * eta + n * (eta * cosine - k.sqrt());
    Some(refracted / refracted.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    #[test]
    fn refraction_obeys_snell() {
        for degrees in [0.0, 10.0, 30.0, 45.0, 60.0, 89.0] {
            let (sin, cos) = math::sin_cos_degrees(degrees);
            let dir = DVec3::new(sin, -cos, 0.0);
            for (eta, ior) in [(1.0 / 1.5, 1.5), (1.0 / 2.4, 2.4), (1.0, 1.0)] {
                let refracted = refract(dir, DVec3::Y, eta).unwrap();
                assert!((refracted.x * ior - sin).abs() < 1e-15, "{degrees} {ior}");
                assert!((refracted.length() - 1.0).abs() < 1e-15 && refracted.y < 0.0);
            }
        }
    }

    #[test]
    fn beyond_the_critical_angle_nothing_leaves() {
        let critical = math::asin(1.0 / 1.5).to_degrees();
        let leaving = |degrees: f64| {
            let (sin, cos) = math::sin_cos_degrees(degrees);
            refract(DVec3::new(sin, -cos, 0.0), DVec3::Y, 1.5)
        };
        assert!(leaving(critical - 1e-6).is_some());
        assert!(leaving(critical + 1e-6).is_none());
    }
}
