//! Light that arrives at a point: lights, shadows, the half-angle shading of each.

#![allow(
    clippy::indexing_slicing,
    reason = "buffers of a fixed number of samples are filled and read up to the same count"
)]

mod ahead;
mod area;
mod around;
mod faint;
mod kinds;
mod lamp;
mod surface;
#[cfg(test)]
mod tests;
mod together;

pub(super) use ahead::{Ahead, Known};
pub(super) use around::{openness, scattered};
pub(super) use faint::highlights;
pub(super) use kinds::shines_at;
pub(super) use lamp::Lamp;

use super::{
    integrator::Counts,
    observe::{Arrived, Observer},
    path::Path,
    polish::Polished,
    world::{Probe, SurfacePoint, World},
};
use area::Area;
use kinds::Sent;
use together::Together;

use crate::{
    color::Color,
    math::{DVec3, Exponent, Ray},
    scene::{CustomReflectance, LightKind, ShadingPoint},
};

/// The terms of a material that the lights need, looked up once for a point.
pub(super) struct Gloss<'s> {
    pub(super) diffuse: Color,
    pub(super) specular: Color,
    pub(super) exponent: Exponent,
    /// What answers in place of all that.
    pub(super) custom: Option<&'s dyn CustomReflectance>,
    /// The same, where it is a finish.
    pub(super) polished: Option<&'s Polished<'s>>,
}

/// What a point and the one who looks at it have to do with all lights.
pub(super) struct Lit<'a> {
    world: &'a World<'a>,
    at: &'a SurfacePoint<'a>,
    number: u64,
    to_eye: DVec3,
    gloss: &'a Gloss<'a>,
}

/// Sum over lights of V L (Kd max(N.L, 0) + Ks max(N.H, 0)^s) at a point seen from `eye`.
#[allow(
    clippy::too_many_arguments,
    reason = "one more than allowed, and all of them differ in kind"
)]
#[inline(always)]
pub(super) fn direct<O: Observer>(
    world: &World<'_>,
    at: &SurfacePoint<'_>,
    number: u64,
    eye: DVec3,
    gloss: &Gloss<'_>,
    path: &Path<'_>,
    counts: &mut Counts,
    observer: &mut O,
) -> Color {
    let mut sum = Color::ZERO;
    if gloss.diffuse == Color::ZERO && gloss.specular == Color::ZERO && gloss.custom.is_none() {
        return sum;
    }
    let lit = Lit::new(world, (at, number, eye), gloss);
    let is_hazy = world.around.as_ref().is_some_and(|around| around.haze.is_some());
    let path_to = if world.is_linked { lit.groups() } else { Vec::new() };
    for (index, light) in world.scene.root().lights.iter().enumerate() {
        if world.is_linked && !light.links.reaches(|id| path_to.contains(&id)) {
            continue;
        }
        observer.light(index);
        if is_hazy {
            lit.add_other(&mut sum, index, path, counts, observer);
            continue;
        }
        match &light.kind {
            LightKind::Directional { direction } => {
                let color = light.color;
                let way = (*direction, f64::INFINITY);
                lit.add(&mut sum, color, way, counts.luck_and_shadows(index), observer);
            }
            LightKind::Point {
                position,
                attenuation,
            } => {
                if let Some((is_lit, &way)) = path.known.of(index) {
                    let color = light.color * attenuation.at(way.1);
                    lit.add_known(&mut sum, color, way, is_lit, counts, observer);
                    continue;
                }
                let offset = *position - at.position;
                if lit.is_behind(offset) {
                    continue;
                }
                let distance = offset.length();
                let color = light.color * attenuation.at(distance);
                let way = (offset / distance, distance);
                lit.add(&mut sum, color, way, counts.luck_and_shadows(index), observer);
            }
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation,
            } => {
                if path.interrupt.poll() {
                    return Color::ZERO;
                }
                let area = Area {
                    corner: *corner,
                    edges: [*edge1, *edge2],
                    n: *n,
                    index,
                    color: light.color,
                    attenuation,
                    lamp: world.lamps.get(index),
                };
                lit.add_area(&mut sum, &area, path, counts, observer);
            }
            _ => lit.add_other(&mut sum, index, path, counts, observer),
        }
    }
    if let Some(surround) = world.around.as_ref().and_then(|around| around.surround.as_ref()) {
        lit.add_environment(&mut sum, surround, path, counts, observer);
    }
    sum
}

/// What points have in common with those before them, which changes the time a picture takes and nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Luck {
    /// Looking for the obstacles before area lights.
    obstacles: Tries,
    /// Looking ahead at the lights of neighboring pixels.
    ahead: Tries,
    /// The primitives that stood before lights, by the number of the light; any number will do at the beginning.
    before: [u64; Self::LIGHTS],
}

impl Luck {
    /// Lights that have a primitive each.
    const LIGHTS: usize = 4;

    /// What stood before the light of this number.
    #[inline(always)]
    fn before(&mut self, light: usize) -> &mut u64 {
        &mut self.before[light % Self::LIGHTS]
    }
}

/// Whether something that may spare work led to anything lately. After misses in a row it is left out for a while.
#[derive(Clone, Copy, Debug, Default)]
struct Tries {
    misses: u32,
    pause: u32,
}

impl Tries {
    fn are_worth_one(&mut self) -> bool {
        let now = self.pause == 0;
        self.pause = self.pause.saturating_sub(1);
        now
    }

    fn remember(&mut self, found: bool) {
        self.misses = if found { 0 } else { (self.misses + 1).min(6) };
        self.pause = (1 << self.misses) - 1;
    }
}

impl Counts {
    /// What stood before the light of this number lately, and the count of shadow rays.
    #[inline(always)]
    fn luck_and_shadows(&mut self, light: usize) -> (&mut u64, &mut u64) {
        (self.luck.before(light), &mut self.shadow)
    }
}

impl<'w> Lit<'w> {
    /// A point with the number of what it lies on, seen from `eye`.
    #[inline(always)]
    fn new(
        world: &'w World<'w>,
        (at, number, eye): (&'w SurfacePoint<'w>, u64, DVec3),
        gloss: &'w Gloss<'w>,
    ) -> Self {
        let to_eye = eye - at.position;
        Self {
            world,
            at,
            number,
            to_eye: to_eye / to_eye.length(),
            gloss,
        }
    }
}

impl Lit<'_> {
    /// True only where light from `offset` adds nothing: so far behind the surface that no rounding gives N.L or,
    /// where there is a highlight, N.H a sign other than minus. Spares most lights a root and four divisions.
    #[inline]
    fn is_behind(&self, offset: DVec3) -> bool {
        if self.gloss.custom.is_some() {
            return false;
        }
        let n = self.at.shading_normal;
        let along = n.dot(offset);
        let mut least = 1e-7;
        if self.gloss.specular != Color::ZERO {
            // N.H has the sign of N.L + N.V.
            least += n.dot(self.to_eye).max(0.0);
        }
        along < 0.0 && along * along > least * least * offset.dot(offset)
    }

    /// Adds what comes from one point of a light to `sum`.
    #[inline]
    fn add<O: Observer>(
        &self,
        sum: &mut Color,
        arriving: Color,
        way: (DVec3, f64),
        last: (&mut u64, &mut u64),
        observer: &mut O,
    ) {
        let response = self.respond(way.0);
        if response != Color::ZERO {
            *sum += self.arrived_after(last, way, (arriving, response), observer);
        }
    }

    /// As [`Lit::add`], where it is known whether anything opaque is before the point.
    #[inline]
    fn add_known<O: Observer>(
        &self,
        sum: &mut Color,
        arriving: Color,
        (towards, distance): (DVec3, f64),
        is_lit: bool,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let response = self.respond(towards);
        if response != Color::ZERO {
            counts.shadow += 1;
            let (probe, reach) = self.shadow_ray(towards, distance);
            let visible = if is_lit { Color::ONE } else { Color::ZERO };
            *sum += self.seen((&probe, reach), visible, (arriving, response), observer);
        }
    }

    /// What is added for light that `arriving` of arrives from a point of a light where nothing is in between. What stood in the way lately is looked at first; counts the ray.
    #[inline]
    fn arrived_after<O: Observer>(
        &self,
        (last, shadows): (&mut u64, &mut u64),
        (towards, distance): (DVec3, f64),
        (arriving, response): (Color, Color),
        observer: &mut O,
    ) -> Color {
        *shadows += 1;
        let (probe, reach) = self.shadow_ray(towards, distance);
        let visible = self.world.share_after(&probe, reach, last);
        self.seen((&probe, reach), visible, (arriving, response), observer)
    }

    /// What is added for light that this share of comes through.
    #[inline(always)]
    fn seen<O: Observer>(
        &self,
        (probe, reach): (&Probe, f64),
        visible: Color,
        (arriving, response): (Color, Color),
        observer: &mut O,
    ) -> Color {
        let added = visible * arriving * response;
        let arrived = Arrived {
            probe,
            reach,
            arriving,
            visible,
            added,
        };
        observer.arrived(self, &arrived);
        added
    }

    /// The diffuse and the specular part of [`Lit::respond`]; what a program's own rule gives counts as diffuse.
    pub(super) fn respond_in_parts(&self, towards: DVec3) -> [Color; 2] {
        let Gloss {
            diffuse,
            specular,
            exponent,
            custom,
            ..
        } = *self.gloss;
        if let Some(custom) = custom {
            return [self.respond_as(custom, towards), Color::ZERO];
        }
        [(diffuse, Color::ZERO), (Color::ZERO, specular)].map(|(diffuse, specular)| {
            let gloss = &Gloss {
                diffuse,
                specular,
                exponent,
                custom: None,
                polished: None,
            };
            Lit { gloss, ..*self }.respond(towards)
        })
    }

    /// Kd max(N.L, 0) + Ks max(N.H, 0)^s (Blinn, 1977, with H halfway between light and eye).
    #[inline]
    fn respond(&self, towards: DVec3) -> Color {
        if let Some(custom) = self.gloss.custom {
            return self.respond_as(custom, towards);
        }
        let n = self.at.shading_normal;
        let mut response = Color::ZERO;
        let cosine = n.dot(towards);
        if cosine > 0.0 {
            response += self.gloss.diffuse * cosine;
        }
        if self.gloss.specular != Color::ZERO {
            let half = towards + self.to_eye;
            let along = n.dot(half);
            // Behind the surface before the division as after it.
            let cosine = if along > 0.0 { along / half.length() } else { 0.0 };
            if cosine > 0.0 {
                response += self.gloss.specular * self.gloss.exponent.of(cosine.min(1.0));
            }
        }
        response
    }

    #[cold]
    #[inline(never)]
    fn respond_as(&self, custom: &dyn CustomReflectance, towards: DVec3) -> Color {
        let at = ShadingPoint {
            position: self.at.position,
            normal: self.at.shading_normal,
            to_eye: self.to_eye,
            diffuse: self.gloss.diffuse,
            specular: self.gloss.specular,
        };
        custom.response(&at, towards)
    }

    /// The ray to a point of a light, and how far it looks.
    #[inline]
    fn shadow_ray(&self, towards: DVec3, distance: f64) -> (Probe, f64) {
        shadow_ray(self.at, self.number, towards, distance)
    }
}

/// The ray from a point on the primitive `number` to a point of a light, and how far it looks.
#[inline(always)]
fn shadow_ray(at: &SurfacePoint<'_>, number: u64, towards: DVec3, distance: f64) -> (Probe, f64) {
    let probe = Probe::from_surface(Ray::new(at.position, towards), number, at.scale);
    // A light may lie in the very surface that shows where it is: stop short of it.
    (probe, distance * SHORT)
}

/// How much of the way to a light a shadow ray looks.
pub(super) const SHORT: f64 = 1.0 - 1e-7;
