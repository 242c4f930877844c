//! Surfaces with a [`Finish`]: what they make of the light of lamps, and where their rays go on. Kept out of the integrator's
//! loop, which a scene without them runs as if there were none.

mod inside;
mod relief;

use super::{
    bounces::compensation,
    integrator::{Branch, followed, refract},
    microfacet::{Ggx, frame, fresnel_dielectric, fresnel_metal, oren_nayar},
    observe::{Observer, RayKind},
    path::Path,
    spectrum,
    world::{Hit, SurfacePoint, World},
};
use crate::{
    color::Color,
    math::{DVec2, DVec3, Exponent, Ray},
    scene::{CustomReflectance, Dispersion, Finish, ShadingPoint, Term, finish_mean},
};

use inside::absorbed;
pub(super) use inside::{Inside, dimmed};
use relief::relieve;

/// Numbers of the choices that are the same for the whole sample, and of those of a point.
const WAVELENGTH: u64 = 0;
const REFLECTED: u64 = 1;
const COATED: u64 = 3;
const WHICH: u64 = 5;
const ABSORBED: u64 = 6;

/// The number that a term is at a point, within its range.
fn number(world: &World<'_>, term: &Term, at: &SurfacePoint<'_>, [least, most]: [f64; 2]) -> f64 {
    Term::number_of(world.term(term, at)).max(least).min(most)
}

/// Index of refraction at a point.
fn index(world: &World<'_>, finish: &Finish, at: &SurfacePoint<'_>) -> f64 {
    finish
        .ior
        .as_ref()
        .map_or(at.material.ior, |ior| number(world, ior, at, Finish::INDEX))
}

/// Index of refraction and absorption coefficient of a metal at a point.
fn metal(world: &World<'_>, finish: &Finish, at: &SurfacePoint<'_>) -> Option<[Color; 2]> {
    let within = |term, [least, most]: [f64; 2]| {
        world
            .term(term, at)
            .max(Color::splat(least))
            .min(Color::splat(most))
    };
    let metal = finish.conductor.as_ref()?;
    Some([within(&metal.eta, Finish::ETA), within(&metal.k, Finish::K)])
}

/// The share of a shadow ray's light that comes through a transparent surface with a finish, `kt` being its Kt.
#[cold]
#[inline(never)]
pub(super) fn shadow_share(
    world: &World<'_>,
    finish: &Finish,
    (hit, ray): (&Hit, &Ray),
    at: &SurfacePoint<'_>,
    kt: Color,
) -> Color {
    let mut share = kt;
    let cosine = ray.dir.dot(at.shading_normal).abs();
    if let Some([eta, k]) = metal(world, finish, at) {
        share *= Color::ONE - fresnel_metal(cosine, eta, k);
    } else if finish.fresnel {
        // As the ray goes straight on, it leaves at the angle at which it came.
        share *= 1.0 - fresnel_dielectric(cosine, index(world, finish, at));
    }
    if let Some(absorption) = finish.absorption.as_ref().filter(|_| !at.from_front) {
        share *= absorbed(world, absorption, (hit.number, ray), Some(at), hit.t, 0.5);
    }
    share
}

/// A layer of varnish, its terms looked up.
#[derive(Clone, Copy, Debug)]
struct Varnish {
    strength: f64,
    rough: Option<Ggx>,
}

/// A point of a surface with a finish, all its terms looked up.
#[derive(Debug)]
pub(super) struct Polished<'s> {
    finish: &'s Finish,
    /// The normal and two directions across it.
    frame: [DVec3; 3],
    geometric_normal: DVec3,
    /// Whoever looks, in the frame; never from behind the normal, where relief leans away.
    eye: DVec3,
    diffuse: Color,
    /// The share of light that goes in at the eye's angle, which is what may come out there; black where Kd is.
    inward: Color,
    specular: Color,
    exponent: Exponent,
    mirror: Color,
    transmission: Color,
    rough: Option<Ggx>,
    /// What the rough mirror is multiplied by, where light between its tiny mirrors is not to be lost.
    boost: Option<Color>,
    /// Index of refraction and absorption coefficient of a metal.
    metal: Option<[Color; 2]>,
    /// Roughness of Kd in radians.
    sigma: f64,
    /// What is on top, as seen from outside.
    varnish: Option<Varnish>,
    /// Index of refraction behind the surface over that before it.
    eta: f64,
    /// The ray's light has one wavelength from here on, and this color.
    wavelength: Option<Color>,
    /// What the ray carried here, and what it carries behind the surface.
    inside: Inside,
    behind: Inside,
}

impl<'s> Polished<'s> {
    /// The surface at a hit of `ray`; `at` gets the normal of its relief.
    #[cold]
    #[inline(never)]
    pub(super) fn new(
        world: &World<'s>,
        finish: &'s Finish,
        (hit, ray): (&Hit, &Ray),
        at: &mut SurfacePoint<'s>,
        inside: Inside,
        path: &Path<'_>,
    ) -> Self {
        relieve(world, finish, hit, ray, at);
        let material = at.material;
        let term = |term| world.term(term, at);
        let specular = term(&material.specular);
        let mirror = match &material.reflection {
            Some(reflection) => term(reflection),
            None if material.specular.is_black() && (finish.fresnel || finish.conductor.is_some()) => {
                Color::ONE
            }
            None => specular,
        };
        let transmission = term(&material.transmission);
        let (mut ior, mut wavelength) = (index(world, finish, at), None);
        if let Some(dispersion) = &finish.dispersion
            && transmission != Color::ZERO
        {
            let (nm, color) = spectrum::wavelength(path.of_sample(WAVELENGTH));
            let bent = match dispersion {
                Dispersion::Abbe(abbe) => {
                    let abbe = number(world, abbe, at, Finish::ABBE);
                    spectrum::index_at(ior, spectrum::cauchy_b(ior, abbe), nm)
                }
                own => spectrum::shifted_index(own, ior, nm),
            };
            ior = bent.max(1e-3);
            wavelength = (!inside.is_colored()).then_some(color);
        }
        // What is opaque is always seen from outside.
        let from_outside = at.from_front || transmission == Color::ZERO;
        let behind = if at.from_front {
            let absorbs = finish.absorption.is_some();
            inside.entered(absorbs.then_some(hit.number))
        } else {
            inside.left()
        };
        let n = at.shading_normal;
        let (t, b) = frame(n);
        let frame = [t, b, n];
        let eye = local(&frame, -ray.dir);
        let eye = DVec3::new(eye.x, eye.y, eye.z.max(1e-4));
        let roughness = finish
            .roughness
            .as_ref()
            .map(|roughness| finish_mean(term(roughness)));
        let mut polished = Self {
            finish,
            frame,
            geometric_normal: at.geometric_normal,
            eye: eye / eye.length(),
            diffuse: term(&material.diffuse),
            inward: Color::ZERO,
            specular,
            exponent: Exponent::new(finish.shininess.as_ref().map_or(material.shininess, |shininess| {
                number(world, shininess, at, [0.0, f64::INFINITY])
            })),
            mirror,
            transmission,
            rough: roughness.and_then(Ggx::new),
            boost: None,
            metal: metal(world, finish, at),
            sigma: finish
                .oren_nayar
                .as_ref()
                .map_or(0.0, |sigma| number(world, sigma, at, Finish::SIGMA).to_radians()),
            varnish: finish
                .clear_coat
                .as_ref()
                .filter(|_| from_outside)
                .map(|coat| Varnish {
                    strength: number(world, &coat.strength, at, Finish::SHARE),
                    rough: Ggx::new(number(world, &coat.roughness, at, Finish::SHARE)),
                }),
            eta: if from_outside { ior } else { 1.0 / ior },
            wavelength,
            inside,
            behind,
        };
        if polished.diffuse != Color::ZERO {
            (_, polished.inward) = polished.shares(polished.eye.z);
        }
        if finish.multiscatter
            && let Some(roughness) =
                roughness.filter(|_| polished.rough.is_some() && transmission == Color::ZERO)
        {
            polished.boost = Some(compensation(roughness, polished.eye.z, |cosine| {
                polished.mirror * polished.shares(cosine).0
            }));
        }
        polished
    }

    fn world(&self, v: DVec3) -> DVec3 {
        let [t, b, n] = self.frame;
        let world = t * v.x + b * v.y + n * v.z;
        world / world.length()
    }

    /// The share that goes to the mirror, and the share that goes in.
    fn shares(&self, cosine: f64) -> (Color, Color) {
        if let Some([eta, k]) = self.metal {
            let mirrored = fresnel_metal(cosine, eta, k);
            return (mirrored, Color::ONE - mirrored);
        }
        if self.finish.fresnel {
            let mirrored = fresnel_dielectric(cosine, self.eta);
            return (Color::splat(mirrored), Color::splat(1.0 - mirrored));
        }
        (Color::ONE, Color::ONE)
    }

    /// The share that the varnish mirrors.
    fn coat(&self, cosine: f64) -> f64 {
        let varnish = self.varnish.as_ref();
        varnish.map_or(0.0, |varnish| varnish.strength * fresnel_dielectric(cosine, COAT))
    }

    /// The color of light from the unit vector `to_light` that leaves towards the eye. Of light that rays meet, too, only what
    /// no ray is followed for: the same light would count twice.
    fn answer(&self, to_light: DVec3, is_met_by_rays: bool) -> Color {
        let (eye, light) = (self.eye, local(&self.frame, to_light));
        let mut sum = self.diffuse * self.inward * oren_nayar(self.sigma, eye, light);
        let half = || {
            let half = eye + light;
            if half.length_squared() > 1e-18 {
                half / half.length()
            } else {
                DVec3::Z
            }
        };
        match &self.rough {
            Some(_) if is_met_by_rays => {}
            Some(rough) => {
                let half = half();
                let (mirrored, _) = self.shares(eye.dot(half));
                let boosted = self.boost.map_or(mirrored, |boost| mirrored * boost);
                sum += self.mirror * boosted * rough.highlight(eye, light, half);
            }
            None => {
                let specular = if is_met_by_rays {
                    highlight_without_mirror(self.specular, self.mirror)
                } else {
                    self.specular
                };
                if specular != Color::ZERO {
                    let half = half();
                    if half.z > 0.0 {
                        let (mirrored, _) = self.shares(eye.dot(half));
                        sum += specular * mirrored * self.exponent.of(half.z.min(1.0));
                    }
                }
            }
        }
        if let Some(varnish) = &self.varnish {
            sum *= 1.0 - self.coat(eye.z);
            if let Some(rough) = varnish.rough.filter(|_| !is_met_by_rays) {
                let half = half();
                sum += Color::splat(self.coat(eye.dot(half)) * rough.highlight(eye, light, half));
            }
        }
        sum
    }

    /// A direction mirrored by the normal `h`, and what is left of the light there.
    fn mirrored(&self, eye: DVec3, h: DVec3, rough: Option<&Ggx>) -> (DVec3, f64) {
        let onward = h * (2.0 * eye.dot(h)) - eye;
        let share = rough.map_or(1.0, |rough| {
            if onward.z > 0.0 {
                rough.share(eye, onward)
            } else {
                0.0
            }
        });
        let mut dir = self.world(onward);
        let below = dir.dot(self.geometric_normal);
        if below < 0.0 {
            // Relief may lean a mirror into the surface itself: light from there is that from just above.
            dir -= self.geometric_normal * (2.0 * below);
        }
        (dir, share)
    }

    /// The mirrored and the refracted ray, those that are worth following.
    #[cold]
    #[inline(never)]
    pub(super) fn split<O: Observer>(
        &self,
        world: &World<'_>,
        weight: Color,
        path: &Path<'_>,
        observer: &mut O,
    ) -> (Option<Branch>, Option<Branch>) {
        let pair = |cell: u64| DVec2::new(path.of_surface(cell), path.of_surface(cell + 1));
        let eye = self.eye;
        let h = match &self.rough {
            Some(rough) => rough.visible(eye, pair(REFLECTED)),
            None => DVec3::Z,
        };
        let cosine = eye.dot(h).max(0.0);
        let (to_mirror, inward) = self.shares(cosine);
        let under_coat = 1.0 - self.coat(eye.z);
        let (dir, left) = self.mirrored(eye, h, self.rough.as_ref());
        let mut kr = self.mirror * to_mirror * (left * under_coat);
        if let Some(boost) = self.boost {
            kr *= boost;
        }
        let kt = self.transmission * under_coat;
        let mut through = None;
        let mut totally = None;
        if kt != Color::ZERO {
            match refract(-eye, h, 1.0 / self.eta) {
                Some(onward) => {
                    let share = match &self.rough {
                        Some(rough) if onward.z < 0.0 => {
                            rough.share(eye, DVec3::new(onward.x, onward.y, -onward.z))
                        }
                        Some(_) => 0.0,
                        None => 1.0,
                    };
                    let share = kt * inward * share * self.wavelength.unwrap_or(Color::ONE);
                    let inside = if self.wavelength.is_some() {
                        self.behind.colored()
                    } else {
                        self.behind
                    };
                    through =
                        followed(world, RayKind::Refracted, share, weight, observer).map(|weight| Branch {
                            dir: self.world(onward),
                            weight,
                            inside: Some(inside),
                        });
                }
                None => {
                    totally = Some(kt);
                    kr = if self.finish.fresnel {
                        self.mirror.max(self.transmission) * (left * under_coat)
                    } else {
                        kr + kt * left
                    };
                }
            }
        }
        let (mut dir, mut share) = (dir, kr);
        if let Some(varnish) = &self.varnish {
            let rough = varnish.rough;
            let h = rough.map_or(DVec3::Z, |rough| rough.visible(eye, pair(COATED)));
            let (coat_dir, left) = self.mirrored(eye, h, rough.as_ref());
            let own = self.coat(eye.dot(h).max(0.0)) * left;
            // One of the two mirrors is followed, the brighter one more often.
            let of_coat = own / (own + kr.max_element());
            if of_coat.is_finite() {
                if path.of_surface(WHICH) < of_coat {
                    (dir, share) = (coat_dir, Color::splat(own / of_coat));
                } else {
                    share = kr / (1.0 - of_coat);
                }
            }
        }
        let mirror = followed(world, RayKind::Reflected, share, weight, observer).map(|weight| Branch {
            dir,
            weight,
            inside: Some(self.inside),
        });
        if let Some(kt) = totally {
            observer.total_reflection(kt);
        }
        (mirror, through)
    }
}

/// The direction of a vector in a frame.
fn local([t, b, n]: &[DVec3; 3], v: DVec3) -> DVec3 {
    let local = DVec3::new(v.dot(*t), v.dot(*b), v.dot(*n));
    local / local.length()
}

/// The varnish's index of refraction.
const COAT: f64 = 1.5;

impl CustomReflectance for Polished<'_> {
    fn response(&self, _: &ShadingPoint, to_light: DVec3) -> Color {
        self.answer(to_light, false)
    }
}

/// A surface as it answers light that the rays meet, too, which are followed from it.
#[derive(Debug)]
pub(super) struct Unfollowed<'p, 's>(pub(super) &'p Polished<'s>);

impl Unfollowed<'_, '_> {
    /// True where it answers nothing.
    pub(super) fn is_black(&self) -> bool {
        let Self(polished) = self;
        polished.diffuse == Color::ZERO
            && (polished.rough.is_some()
                || highlight_without_mirror(polished.specular, polished.mirror) == Color::ZERO)
    }
}

impl CustomReflectance for Unfollowed<'_, '_> {
    fn response(&self, _: &ShadingPoint, to_light: DVec3) -> Color {
        self.0.answer(to_light, true)
    }
}

/// What is left of Ks for light that mirrored rays meet: Ks is what the surface mirrors in all, and Kr of that is seen in the
/// mirror.
pub(super) fn highlight_without_mirror(specular: Color, mirror: Color) -> Color {
    (specular - mirror).max(Color::ZERO)
}
