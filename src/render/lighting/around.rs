//! Light from all around, what keeps it away, and light that air scatters.

use super::{
    Gloss, Lit, SHORT, Together,
    kinds::{Sent, sent},
    lamp::on_disk,
};
use crate::{
    color::Color,
    math::{self, DVec3, PI, Ray},
    render::{
        environment::Surround,
        integrator::Counts,
        observe::Observer,
        path::Path,
        polish::{Unfollowed, highlight_without_mirror},
        sampler::stratified,
        world::{Probe, SurfacePoint, World},
    },
    scene::{Falloff, Haze, LightKind, around},
};

/// What is not a light of the scene has numbers after those of the lights: they key random numbers.
fn after_the_lights(world: &World<'_>, which: u64) -> u64 {
    world.scene.root().lights.len() as u64 + which
}

const ENVIRONMENT: u64 = 0;
const OCCLUSION: u64 = 1;
/// From here on the haze's, for each light and then for the environment.
const HAZE: u64 = 2;

/// What an environment sends along a direction that was chosen for its brightness, as a surface's Kd and Ks take it: the
/// radiance over pi, so that 1 from everywhere gives 1.
fn from_around(surround: &Surround<'_>, at: (f64, f64)) -> Option<Sent> {
    let (dir, density) = surround.direction(at)?;
    let arriving = surround.radiance(dir) / (PI * density);
    (arriving != Color::ZERO && arriving.is_finite()).then_some(Sent {
        towards: dir,
        distance: f64::INFINITY,
        arriving,
    })
}

impl Lit<'_> {
    /// Adds what the environment sends to `sum`, as far as no ray is followed that sees it: what a surface mirrors is left to
    /// the mirrored ray, for which a rough surface chooses a direction by its own lobe, so that it is as free of noise as that
    /// one ray can be. What a program answers itself is asked for all of it.
    #[cold]
    #[inline(never)]
    pub(super) fn add_environment<O: Observer>(
        &self,
        sum: &mut Color,
        surround: &Surround<'_>,
        path: &Path<'_>,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let n = surround.n();
        if n == 0 || path.interrupt.poll() {
            return;
        }
        let number = after_the_lights(self.world, ENVIRONMENT);
        let unfollowed = self.gloss.polished.map(Unfollowed);
        let mut gloss = Gloss { ..*self.gloss };
        match &unfollowed {
            Some(unfollowed) if unfollowed.is_black() => return,
            Some(unfollowed) => gloss.custom = Some(unfollowed),
            None if gloss.custom.is_none() && gloss.specular != Color::ZERO => {
                let mirror = self.world.term(&self.at.material.mirror(), self.at);
                gloss.specular = highlight_without_mirror(gloss.specular, mirror);
                if gloss.specular == Color::ZERO && gloss.diffuse == Color::ZERO {
                    return;
                }
            }
            None => {}
        }
        let lit = Lit {
            gloss: &gloss,
            ..*self
        };
        observer.light(number as usize);
        let normal = self.at.shading_normal;
        let (right, up) = around(normal);
        // Half of them where it is bright, half by the cosine, together as one choice (the balance heuristic; Veach and
        // Guibas, "Optimally combining sampling techniques for Monte Carlo rendering", 1995).
        let all = n * n;
        let by_cosine = all / 2;
        let by_light = all - by_cosine;
        let mut together = Together::new(&lit);
        for i in 0..all {
            let random = |k: u64| path.random(number, 2 * u64::from(i) + k);
            let (dir, density) = if i < by_light {
                let Some(chosen) = surround.direction(jittered(i, by_light, random)) else {
                    continue;
                };
                chosen
            } else {
                let dir = above((right, up, normal), jittered(i - by_light, by_cosine, random));
                (dir, surround.density(dir))
            };
            let cosine = normal.dot(dir).max(0.0) / PI;
            let densities = f64::from(by_light) * density + f64::from(by_cosine) * cosine;
            let arriving = surround.radiance(dir) / (PI * densities);
            if arriving != Color::ZERO && arriving.is_finite() {
                let sent = Sent {
                    towards: dir,
                    distance: f64::INFINITY,
                    arriving,
                };
                together.add_sent(sum, &sent, counts, observer);
            }
        }
        together.finish(sum, observer);
    }
}

/// Where in the unit square sample `index` of `count` lies, jittered also where it is the only one.
fn jittered(index: u32, count: u32, random: impl Fn(u64) -> f64) -> (f64, f64) {
    if count == 1 {
        (random(0), random(1))
    } else {
        stratified(index, count, random)
    }
}

/// A direction above a point, by the cosine: from a point of the disk below the half sphere (Malley's method).
fn above((right, up, normal): (DVec3, DVec3, DVec3), (u, v): (f64, f64)) -> DVec3 {
    let (x, y) = on_disk(u, v);
    right * x + up * y + normal * (1.0 - x * x - y * y).max(0.0).sqrt()
}

/// A point of cell `cell` of n x n, jittered by two random numbers.
pub(super) fn stratum(n: u32, cell: u32, [across, up]: [f64; 2]) -> (f64, f64) {
    let place = |i: u32, jitter: f64| (f64::from(i) + jitter) / f64::from(n);
    (place(cell % n, across), place(cell / n, up))
}

/// The share of the half sphere above a point, by the cosine, in which nothing is near; for each color, since what is
/// transparent lets its Kt through.
#[cold]
#[inline(never)]
pub(in crate::render) fn openness(
    world: &World<'_>,
    at: &SurfacePoint<'_>,
    number: u64,
    path: &Path<'_>,
    counts: &mut Counts,
) -> Color {
    let occlusion = world.around.as_ref().and_then(|around| around.occlusion);
    let Some(occlusion) = occlusion else {
        return Color::ONE;
    };
    if path.interrupt.poll() {
        return Color::ZERO;
    }
    let n = occlusion.n();
    let key = after_the_lights(world, OCCLUSION);
    let normal = at.shading_normal;
    let (right, up) = around(normal);
    let mut sum = Color::ZERO;
    for cell in 0..n * n {
        let dir = above(
            (right, up, normal),
            stratum(n, cell, path.random_pair(key, cell.into())),
        );
        // What a smoothed normal lets point below the true surface sees that surface.
        if dir.dot(at.geometric_normal) > 0.0 {
            counts.shadow += 1;
            let probe = Probe::from_surface(Ray::new(at.position, dir), number, at.scale);
            sum += world.share_through(&probe, occlusion.distance(), None);
        }
    }
    sum / f64::from(n * n)
}

/// Light that haze scatters towards the start of a ray on its way of length `t`, by single scattering: stratified places
/// on the ray, for lights that fade with the square of the distance evenly by the angle as the light sees it (Kulla and
/// Fajardo, "Importance sampling techniques for path tracing in participating media", 2012), for others by what is left
/// of the light from there.
pub(in crate::render) fn scattered(
    world: &World<'_>,
    haze: &Haze,
    (ray, t): (&Ray, f64),
    path: &Path<'_>,
    counts: &mut Counts,
) -> Color {
    let mut sum = Color::ZERO;
    let lights = &world.scene.root().lights;
    let places = |number: u64, center: Option<DVec3>, span: (f64, f64)| {
        let key = after_the_lights(world, HAZE + number);
        (0..haze.n()).filter_map(move |i| {
            let random = move |k: u64| path.random(key, 3 * u64::from(i) + k);
            let x = (f64::from(i) + random(0)) / f64::from(haze.n());
            let (s, density) = match center {
                Some(center) => by_angle(ray, span, center, x),
                None => by_share(haze.density(), span, x),
            }?;
            Some((s, density, (random(1), random(2))))
        })
    };
    let mut add = |s: f64, density: f64, sent: &Sent| {
        let mut way = s;
        if sent.distance.is_finite() {
            way += sent.distance;
        }
        let cosine = sent.towards.dot(ray.dir);
        let share = haze.density() * math::exp(-haze.density() * way) * phase(haze.forward(), cosine)
            / (density * f64::from(haze.n()));
        let arriving = sent.arriving * haze.albedo() * share;
        if arriving != Color::ZERO && arriving.is_finite() {
            counts.shadow += 1;
            let probe = Probe::from_space(Ray::new(ray.at(s), sent.towards));
            sum += arriving * world.share_through(&probe, sent.distance * SHORT, None);
        }
    };
    for (index, light) in lights.iter().enumerate() {
        if path.interrupt.poll() {
            return Color::ZERO;
        }
        let fades = match &light.kind {
            LightKind::Surface(surface) if *surface.falloff() == Falloff::Physical => true,
            kind => kind.attenuation().is_some_and(|a| a.quadratic > 0.0),
        };
        let center = light.kind.center().filter(|_| fades);
        let span = match &light.kind {
            LightKind::Spot(spot) => spot.span(ray).map(|(a, b)| (a.max(0.0), b.min(t))),
            _ => Some((0.0, t)),
        };
        let Some(span) = span.filter(|(a, b)| a < b) else {
            continue;
        };
        for (s, density, at) in places(index as u64, center, span) {
            if let Some(sent) = sent(world, index, ray.at(s), at) {
                add(s, density, &sent);
            }
        }
    }
    let surround = world.around.as_ref().and_then(|around| around.surround.as_ref());
    if let Some(surround) = surround.filter(|surround| surround.n() > 0) {
        for (s, density, at) in places(lights.len() as u64, None, (0.0, t)) {
            if let Some(sent) = from_around(surround, at) {
                add(s, density, &sent);
            }
        }
    }
    sum
}

/// A place on a ray with its density, even by the angle at `center`.
fn by_angle(ray: &Ray, (from, to): (f64, f64), center: DVec3, x: f64) -> Option<(f64, f64)> {
    let offset = center - ray.origin;
    let along = offset.dot(ray.dir);
    // A ray through the light itself has no angles.
    let aside = (offset - ray.dir * along).length().max(1e-6 * offset.length());
    if !(aside > 0.0) {
        return None;
    }
    let begin = math::atan((from - along) / aside);
    let end = if to.is_finite() {
        math::atan((to - along) / aside)
    } else {
        PI / 2.0
    };
    let beside = aside * math::tan(begin + (end - begin) * x);
    let s = (along + beside).clamp(from, to);
    let density = aside / ((end - begin) * (aside * aside + beside * beside));
    (s.is_finite() && density > 0.0).then_some((s, density))
}

/// A place on a ray with its density, as light fades in the haze.
fn by_share(density: f64, (from, to): (f64, f64), x: f64) -> Option<(f64, f64)> {
    let lost = -math::expm1(-density * (to - from));
    if !(lost > 0.0) {
        return None;
    }
    let way = (-math::log1p(-x * lost) / density).min(to - from);
    Some((from + way, density * math::exp(-density * way) / lost))
}

/// Henyey and Greenstein's function ("Diffuse radiation in the galaxy", 1941) times pi, since the color of a light is what a white
/// surface makes of it.
fn phase(g: f64, cosine: f64) -> f64 {
    let below = (1.0 + g * g - 2.0 * g * cosine).max(1e-12);
    0.25 * (1.0 - g * g) / (below * below.sqrt())
}
