//! Surfaces with a [`Finish`]: what they make of the light of lamps, and where their rays go on. Kept out of the integrator's
//! loop, which a scene without them runs as if there were none.

use super::{
    integrator::{Branch, LEAST_WEIGHT, Path, refract},
    microfacet::{Ggx, frame, fresnel_dielectric, fresnel_metal, oren_nayar},
    observe::{Observer, RayKind},
    spectrum,
    world::{Hit, SurfacePoint, World},
};
use crate::{
    color::{self, Color},
    math::{self, DVec2, DVec3, Exponent, Ray},
    scene::{Absorption, CustomReflectance, Finish, MaterialId, ShadingPoint, finish_mean},
};

/// What a ray carries along from surface to surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Inside(u32);

impl Inside {
    const COLORED: u32 = 1 << 31;

    /// True where it carries anything.
    pub(super) fn is_any(self) -> bool {
        self.0 != 0
    }

    /// Inside of this material, which takes from the light.
    fn entered(self, material: Option<MaterialId>) -> Self {
        // A scene has far fewer materials than that.
        let number = material.map_or(0, |id| (id.0 + 1) & !Self::COLORED);
        Self(self.0 & Self::COLORED | number)
    }

    /// Outside again.
    pub(super) fn left(self) -> Self {
        Self(self.0 & Self::COLORED)
    }

    fn material(self) -> Option<MaterialId> {
        (self.0 & !Self::COLORED).checked_sub(1).map(MaterialId)
    }

    /// Has one wavelength from now on.
    fn colored(self) -> Self {
        Self(self.0 | Self::COLORED)
    }

    fn is_colored(self) -> bool {
        self.0 & Self::COLORED != 0
    }
}

/// Numbers of the choices that are the same for the whole sample, and of those of a point.
const WAVELENGTH: u64 = 0;
const REFLECTED: u64 = 1;
const COATED: u64 = 3;
const WHICH: u64 = 5;

/// What is left of light after `distance` through what absorbs it (Beer, 1852).
fn left_of(absorption: &Absorption, distance: f64) -> Color {
    let times = distance / absorption.distance;
    let channel = |share: f64| {
        if share >= 1.0 {
            1.0
        } else {
            math::pow(share, times)
        }
    };
    let c = absorption.color;
    Color::new(channel(c.x), channel(c.y), channel(c.z))
}

/// What is left of the light that a ray sees, having come this far through what it is inside of. `at` is where it ended, if it
/// did.
#[cold]
#[inline(never)]
pub(super) fn dimmed(
    world: &World<'_>,
    inside: Inside,
    at: Option<&SurfacePoint<'_>>,
    distance: f64,
) -> Color {
    let entered = inside
        .material()
        .and_then(|id| world.scene.materials.get(id.index()));
    // Without having seen how it came in, a ray that leaves knows what it leaves.
    let left = at.filter(|at| !at.from_front).map(|at| at.material);
    let absorption = entered
        .or(left)
        .and_then(|material| material.finish.as_ref()?.absorption.as_ref());
    absorption.map_or(Color::ONE, |absorption| left_of(absorption, distance))
}

/// The share of a shadow ray's light that comes through a transparent surface with a finish, `kt` being its Kt; `distance` is how
/// far the ray came.
#[cold]
#[inline(never)]
pub(super) fn shadow_share(
    finish: &Finish,
    at: &SurfacePoint<'_>,
    dir: DVec3,
    distance: f64,
    kt: Color,
) -> Color {
    let mut share = kt;
    let cosine = dir.dot(at.shading_normal).abs();
    if let Some(metal) = &finish.conductor {
        share *= Color::ONE - fresnel_metal(cosine, metal.eta, metal.k);
    } else if finish.fresnel {
        // As the ray goes straight on, it leaves at the angle at which it came.
        share *= 1.0 - fresnel_dielectric(cosine, at.material.ior);
    }
    if let Some(absorption) = finish.absorption.as_ref().filter(|_| !at.from_front) {
        share *= left_of(absorption, distance);
    }
    share
}

/// A point of a surface with a finish, all its terms looked up.
#[derive(Debug)]
pub(super) struct Polished<'s> {
    finish: &'s Finish,
    /// The normal and two directions across it.
    frame: [DVec3; 3],
    geometric_normal: DVec3,
    to_eye: DVec3,
    /// Whether it is seen from outside, as what is opaque always is.
    from_outside: bool,
    diffuse: Color,
    specular: Color,
    exponent: Exponent,
    mirror: Color,
    transmission: Color,
    rough: Option<Ggx>,
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
        let (mut ior, mut wavelength) = (material.ior, None);
        if let Some(abbe) = finish.dispersion
            && transmission != Color::ZERO
        {
            let (nm, color) = spectrum::wavelength(path.of_sample(WAVELENGTH));
            ior = spectrum::index_at(ior, spectrum::cauchy_b(ior, abbe), nm).max(1e-3);
            wavelength = (!inside.is_colored()).then_some(color);
        }
        let from_outside = at.from_front || transmission == Color::ZERO;
        let behind = if at.from_front {
            let absorbs = finish.absorption.is_some();
            inside.entered(absorbs.then(|| world.material_id(hit.number)).flatten())
        } else {
            inside.left()
        };
        let n = at.shading_normal;
        let (t, b) = frame(n);
        Self {
            finish,
            frame: [t, b, n],
            geometric_normal: at.geometric_normal,
            to_eye: -ray.dir,
            from_outside,
            diffuse: term(&material.diffuse),
            specular,
            exponent: Exponent::new(material.shininess),
            mirror,
            transmission,
            rough: finish
                .roughness
                .as_ref()
                .and_then(|roughness| Ggx::new(finish_mean(term(roughness)))),
            eta: if from_outside { ior } else { 1.0 / ior },
            wavelength,
            inside,
            behind,
        }
    }

    fn local(&self, v: DVec3) -> DVec3 {
        let [t, b, n] = self.frame;
        let local = DVec3::new(v.dot(t), v.dot(b), v.dot(n));
        local / local.length()
    }

    fn world(&self, v: DVec3) -> DVec3 {
        let [t, b, n] = self.frame;
        let world = t * v.x + b * v.y + n * v.z;
        world / world.length()
    }

    /// Whoever looks, in the frame of the normal; never from behind it, where relief leans away.
    fn eye(&self) -> DVec3 {
        let eye = self.local(self.to_eye);
        let up = DVec3::new(eye.x, eye.y, eye.z.max(1e-4));
        up / up.length()
    }

    /// The share that goes to the mirror, and the share that goes in.
    fn shares(&self, cosine: f64) -> (Color, Color) {
        if let Some(metal) = &self.finish.conductor {
            let mirrored = fresnel_metal(cosine, metal.eta, metal.k);
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
        let coat = self.finish.clear_coat.filter(|_| self.from_outside);
        coat.map_or(0.0, |coat| coat.strength * fresnel_dielectric(cosine, COAT))
    }

    /// The color of light from the unit vector `to_light` that leaves towards the eye.
    fn answer(&self, to_light: DVec3) -> Color {
        let (eye, light) = (self.eye(), self.local(to_light));
        let half = eye + light;
        let half = if half.length_squared() > 1e-18 {
            half / half.length()
        } else {
            DVec3::Z
        };
        let cosine = eye.dot(half);
        // What goes in at the eye's angle is what may come out there.
        let (_, inward) = self.shares(eye.z);
        let sigma = self.finish.oren_nayar.to_radians();
        let mut sum = self.diffuse * inward * oren_nayar(sigma, eye, light);
        let (mirrored, _) = self.shares(cosine);
        match &self.rough {
            Some(rough) => sum += self.mirror * mirrored * rough.highlight(eye, light),
            None if self.specular != Color::ZERO && half.z > 0.0 => {
                sum += self.specular * mirrored * self.exponent.of(half.z.min(1.0));
            }
            None => {}
        }
        if let Some(coat) = self.finish.clear_coat.filter(|_| self.from_outside) {
            sum *= 1.0 - self.coat(eye.z);
            if let Some(rough) = Ggx::new(coat.roughness) {
                sum += Color::splat(self.coat(cosine) * rough.highlight(eye, light));
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
        weight: Color,
        path: &Path<'_>,
        observer: &mut O,
    ) -> (Option<Branch>, Option<Branch>) {
        let pair = |cell: u64| DVec2::new(path.of_surface(cell), path.of_surface(cell + 1));
        let eye = self.eye();
        let h = match &self.rough {
            Some(rough) => rough.visible(eye, pair(REFLECTED)),
            None => DVec3::Z,
        };
        let cosine = eye.dot(h).max(0.0);
        let (to_mirror, inward) = self.shares(cosine);
        let under_coat = 1.0 - self.coat(eye.z);
        let (dir, left) = self.mirrored(eye, h, self.rough.as_ref());
        let mut kr = self.mirror * to_mirror * (left * under_coat);
        let kt = self.transmission * under_coat;
        let mut followed = |kind, share: Color, weight: Color| {
            let weight = weight * share;
            let is_followed = weight.max_element() >= LEAST_WEIGHT;
            observer.branch(kind, share, weight, is_followed);
            is_followed.then_some(weight)
        };
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
                    through = followed(RayKind::Refracted, share, weight).map(|weight| Branch {
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
        if let Some(coat) = self.finish.clear_coat.filter(|_| self.from_outside) {
            let rough = Ggx::new(coat.roughness);
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
        let mirror = followed(RayKind::Reflected, share, weight).map(|weight| Branch {
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

/// The varnish's index of refraction.
const COAT: f64 = 1.5;

impl CustomReflectance for Polished<'_> {
    fn response(&self, _: &ShadingPoint, to_light: DVec3) -> Color {
        self.answer(to_light)
    }
}

/// How far apart the points are that relief is measured at, as a share of the ray's length: about half a pixel, so that an edge is
/// seen and a grain too fine to be seen is not. (PBR 10.5.3 takes half a pixel, too.)
const STEP: f64 = 5e-4;

/// Turns the shading normal as the relief says.
fn relieve<'s>(world: &World<'s>, finish: &Finish, hit: &Hit, ray: &Ray, at: &mut SurfacePoint<'s>) {
    if finish.bump.is_none() && finish.normal_map.is_none() {
        return;
    }
    let n = at.shading_normal;
    let (t, b) = frame(n);
    let moved = |offset: DVec3| world.beside(hit, ray, at, offset);
    let trial = at.scale.max(1e-3) * 1e-6;
    // World units in one of the shape's, along each direction.
    let stretched = |dir: DVec3| {
        let object = moved(dir * trial)?.object_position() - at.object_position();
        Some(trial / object.length()).filter(|s| s.is_finite())
    };
    let (Some(along_t), Some(along_b)) = (stretched(t), stretched(b)) else {
        return;
    };
    let step = ((at.position - ray.origin).length() * STEP).max(trial);
    let corners = [t * step, t * -step, b * step, b * -step].map(moved);
    let [Some(t1), Some(t0), Some(b1), Some(b0)] = corners else {
        return;
    };
    // Heights count outward, and the normal looks to the eye.
    let side = if at.from_front { 1.0 } else { -1.0 };
    let mut normal = n;
    if let Some(map) = &finish.normal_map {
        let round = |d: DVec2| DVec2::new(d.x - (d.x + 0.5).floor(), d.y - (d.y + 0.5).floor());
        let (dt, db) = (round(t1.uv - t0.uv), round(b1.uv - b0.uv));
        let det = dt.x * db.y - dt.y * db.x;
        let along_u = (t * db.y - b * dt.y) / det;
        let along_v = (b * dt.x - t * db.x) / det;
        if let Some(texture) = world.scene.textures.get(map.texture.index())
            && (along_u + along_v).is_finite()
        {
            let texel = texture.lookup(&at.texture_point());
            // A picture's bytes are the numbers themselves here, and no light.
            let texel = if texture.is_srgb() {
                Color::new(
                    color::srgb_from_linear(texel.x),
                    color::srgb_from_linear(texel.y),
                    color::srgb_from_linear(texel.z),
                )
            } else {
                texel
            };
            let [x, y, z] = (texel * 2.0 - Color::ONE).to_array();
            let (u, v) = (along_u / along_u.length(), along_v / along_v.length());
            normal = (u * x + v * y) * (map.strength * side) + n * z.max(1e-3);
            normal /= normal.length();
        }
    }
    if let Some(bump) = &finish.bump {
        let height = |at: &SurfacePoint<'_>| color::luminance(world.term(&bump.texture, at)) * bump.height;
        let slope_t = (height(&t1) - height(&t0)) * along_t / (2.0 * step);
        let slope_b = (height(&b1) - height(&b0)) * along_b / (2.0 * step);
        normal -= (t * slope_t + b * slope_b) * side;
        normal /= normal.length();
    }
    if normal.is_finite() {
        at.shading_normal = normal;
    }
}
