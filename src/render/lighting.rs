//! Light that arrives at a point: lights, shadows, the half-angle shading of each.

use super::{
    integrator::{Counts, Path},
    world::{Blocker, PACKET, Probe, SurfacePoint, World},
};
use crate::{
    color::Color,
    math::{DVec3, Ray, shininess_power},
    scene::{Light, LightKind},
};

/// The terms of a material that the lights need, looked up once for a point.
pub(super) struct Gloss {
    pub(super) diffuse: Color,
    pub(super) specular: Color,
    pub(super) shininess: f64,
}

/// One point towards which a shadow ray goes.
struct LightSample {
    /// Unit vector towards the light.
    direction: DVec3,
    distance: f64,
    /// Light that arrives where nothing is in between.
    arriving: Color,
}

/// Sum over lights of V L (Kd max(N.L, 0) + Ks max(N.H, 0)^s) at a point seen from `eye`.
pub(super) fn direct(
    world: &World<'_>,
    at: &SurfacePoint<'_>,
    number: u64,
    eye: DVec3,
    gloss: &Gloss,
    path: &Path<'_>,
    counts: &mut Counts,
) -> Color {
    let mut sum = Color::ZERO;
    if gloss.diffuse == Color::ZERO && gloss.specular == Color::ZERO {
        return sum;
    }
    let to_eye = eye - at.position;
    let to_eye = to_eye / to_eye.length();
    let shade = Shade { world, at, number };
    let mut waiting = Vec::new();
    for (index, light) in world.scene.root().lights.iter().enumerate() {
        let is_area = matches!(light.kind, LightKind::Area { .. });
        if is_area && path.interrupt.poll() {
            return Color::ZERO;
        }
        for_each_sample(light, index as u64, at.position, path, |sample| {
            let response = respond(at, to_eye, &sample, gloss);
            if response == Color::ZERO {
                return;
            }
            counts.shadow += 1;
            if !is_area {
                let found = world.blocker(&shade.probe(&sample), reach(&sample));
                sum += shade.visible(&sample, found) * sample.arriving * response;
                return;
            }
            waiting.push((sample, response));
            if waiting.len() == PACKET {
                shade.add_together(&mut sum, &mut waiting);
            }
        });
        shade.add_together(&mut sum, &mut waiting);
    }
    sum
}

/// Calls `visit` with each point of a light, as seen from `p`.
fn for_each_sample(light: &Light, index: u64, p: DVec3, path: &Path<'_>, mut visit: impl FnMut(LightSample)) {
    let towards = |position: DVec3, arriving: Color| {
        let offset = position - p;
        let distance = offset.length();
        LightSample {
            direction: offset / distance,
            distance,
            arriving,
        }
    };
    match &light.kind {
        LightKind::Directional { direction } => {
            visit(LightSample {
                direction: *direction,
                distance: f64::INFINITY,
                arriving: light.color,
            });
        }
        LightKind::Point {
            position,
            attenuation,
        } => {
            let sample = towards(*position, light.color);
            visit(LightSample {
                arriving: sample.arriving * attenuation.at(sample.distance),
                ..sample
            });
        }
        LightKind::Area {
            corner,
            edge1,
            edge2,
            n,
            attenuation,
        } => {
            let cells = f64::from(n * n);
            for row in 0..*n {
                for column in 0..*n {
                    let cell = u64::from(row * n + column);
                    let (u, v) = (path.random(index, 2 * cell), path.random(index, 2 * cell + 1));
                    let a = (f64::from(column) + u) / f64::from(*n);
                    let b = (f64::from(row) + v) / f64::from(*n);
                    let sample = towards(*corner + *edge1 * a + *edge2 * b, light.color);
                    let arriving = sample.arriving * (attenuation.at(sample.distance) / cells);
                    visit(LightSample { arriving, ..sample });
                }
            }
        }
    }
}

/// Kd max(N.L, 0) + Ks max(N.H, 0)^s (Blinn, 1977, with H halfway between light and eye).
fn respond(at: &SurfacePoint<'_>, to_eye: DVec3, sample: &LightSample, gloss: &Gloss) -> Color {
    let n = at.shading_normal;
    let mut response = Color::ZERO;
    let cosine = n.dot(sample.direction);
    if cosine > 0.0 {
        response += gloss.diffuse * cosine;
    }
    if gloss.specular != Color::ZERO {
        let half = sample.direction + to_eye;
        let cosine = n.dot(half) / half.length();
        if cosine > 0.0 {
            response += gloss.specular * shininess_power(cosine.min(1.0), gloss.shininess);
        }
    }
    response
}

/// How far a shadow ray looks: a light may lie in the very surface that shows where it is, so it stops short of it.
fn reach(sample: &LightSample) -> f64 {
    sample.distance * (1.0 - 1e-7)
}

/// The point whose shadow rays are traced.
struct Shade<'a, 's> {
    world: &'a World<'s>,
    at: &'a SurfacePoint<'s>,
    number: u64,
}

impl Shade<'_, '_> {
    fn probe(&self, sample: &LightSample) -> Probe {
        let ray = Ray::new(self.at.position, sample.direction);
        Probe::from_surface(ray, self.number, self.at.scale)
    }

    /// The share of a sample's light that comes through where this was `found` in between.
    fn visible(&self, sample: &LightSample, found: Blocker) -> Color {
        match found {
            Blocker::None => Color::ONE,
            Blocker::Opaque => Color::ZERO,
            Blocker::Transparent => through(self.world, self.probe(sample), reach(sample)),
        }
    }

    /// Adds up to [`PACKET`] waiting samples and their responses to `sum`, in order; their shadow rays are traced
    /// together.
    fn add_together(&self, sum: &mut Color, waiting: &mut Vec<(LightSample, Color)>) {
        let probes: Vec<Probe> = waiting.iter().map(|(sample, _)| self.probe(sample)).collect();
        let reaches: Vec<f64> = waiting.iter().map(|(sample, _)| reach(sample)).collect();
        let mut found = vec![Blocker::None; waiting.len()];
        self.world.blockers(&probes, &reaches, &mut found);
        for ((sample, response), found) in waiting.drain(..).zip(found) {
            *sum += self.visible(&sample, found) * sample.arriving * response;
        }
    }
}

/// The product of Kt of the transparent surfaces that a ray meets; 0 behind anything opaque.
fn through(world: &World<'_>, mut probe: Probe, mut rest: f64) -> Color {
    let dir = probe.ray.dir;
    let mut through = Color::ONE;
    // Each turn passes one transparent surface. Nobody looks through more than these.
    for _ in 0..1024 {
        let Some(hit) = world.nearest(&probe, rest) else {
            return through;
        };
        let Some(surface) = world.surface(&hit, &probe.ray) else {
            return Color::ZERO;
        };
        through *= world.term(&surface.material.transmission, &surface);
        if through == Color::ZERO {
            return through;
        }
        rest -= hit.t;
        probe = Probe::from_surface(Ray::new(surface.position, dir), hit.number, surface.scale);
    }
    Color::ZERO
}
