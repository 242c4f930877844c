//! Light that arrives at a point: lights, shadows, the half-angle shading of each.

use super::{
    integrator::{Counts, Path},
    world::{Blocker, Probe, SurfacePoint, World},
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
    for (index, light) in world.scene.root().lights.iter().enumerate() {
        if matches!(light.kind, LightKind::Area { .. }) && path.interrupt.poll() {
            return Color::ZERO;
        }
        for_each_sample(light, index as u64, at.position, path, |sample| {
            let response = respond(at, to_eye, &sample, gloss);
            if response == Color::ZERO {
                return;
            }
            let visible = visibility(world, at, number, &sample, counts);
            sum += visible * sample.arriving * response;
        });
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

/// The share of light that comes through: 0 behind anything opaque, the product of Kt of the transparent
/// surfaces in between otherwise.
fn visibility(
    world: &World<'_>,
    at: &SurfacePoint<'_>,
    number: u64,
    sample: &LightSample,
    counts: &mut Counts,
) -> Color {
    counts.shadow += 1;
    // A light may lie in the very surface that shows where it is: stop short of it.
    let mut rest = sample.distance * (1.0 - 1e-7);
    let mut probe = Probe::from_surface(Ray::new(at.position, sample.direction), number, at.scale);
    match world.blocker(&probe, rest) {
        Blocker::None => return Color::ONE,
        Blocker::Opaque => return Color::ZERO,
        Blocker::Transparent => {}
    }
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
        probe = Probe::from_surface(
            Ray::new(surface.position, sample.direction),
            hit.number,
            surface.scale,
        );
    }
    Color::ZERO
}
