//! What happens to light at the border of two media: Fresnel's equations, and rough surfaces made of tiny mirrors.
//!
//! Directions are unit vectors in a frame whose z axis is the normal, pointing away from the surface. The formulas are those of
//! Pharr, Jakob and Humphreys, "Physically Based Rendering", fourth edition, 2023, chapter 9.

use crate::{
    color::Color,
    math::{self, DVec2, DVec3, PI},
};

/// The share of unpolarized light that a border between dielectrics mirrors (Fresnel; PBR 9.3.5). `cosine` is that of the angle
/// between ray and normal, at least 0; `eta` the index of refraction behind the border over that before it. 1 at total
/// internal reflection.
pub(super) fn fresnel_dielectric(cosine: f64, eta: f64) -> f64 {
    let cosine = cosine.clamp(0.0, 1.0);
    let squared_sine = (1.0 - cosine * cosine) / (eta * eta);
    if squared_sine >= 1.0 {
        return 1.0;
    }
    let behind = (1.0 - squared_sine).sqrt();
    let parallel = (eta * cosine - behind) / (eta * cosine + behind);
    let perpendicular = (cosine - eta * behind) / (cosine + eta * behind);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// The share that a metal mirrors, whose index of refraction is `eta` and whose absorption coefficient is `k` (PBR 9.3.6, in real
/// numbers after Born and Wolf, "Principles of Optics", 14.2).
pub(super) fn fresnel_conductor(cosine: f64, eta: f64, k: f64) -> f64 {
    let cosine = cosine.clamp(0.0, 1.0);
    let (c2, s2) = (cosine * cosine, 1.0 - cosine * cosine);
    let (eta2, k2) = (eta * eta, k * k);
    let t0 = eta2 - k2 - s2;
    let a2_plus_b2 = (t0 * t0 + 4.0 * eta2 * k2).sqrt();
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let (t1, t2) = (a2_plus_b2 + c2, 2.0 * cosine * a);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let (t3, t4) = (c2 * a2_plus_b2 + s2 * s2, t2 * s2);
    let parallel = perpendicular * (t3 - t4) / (t3 + t4);
    0.5 * (perpendicular + parallel)
}

/// [`fresnel_conductor`] for each channel.
pub(super) fn fresnel_metal(cosine: f64, eta: Color, k: Color) -> Color {
    let channel = |eta, k| fresnel_conductor(cosine, eta, k);
    Color::new(channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z))
}

/// A rough surface of tiny mirrors with slopes after Trowbridge and Reitz ("Average irregularity representation of a
/// roughened surface", 1975), called GGX by Walter et al. ("Microfacet models for refraction through rough surfaces", 2007).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ggx {
    /// Width of the distribution of slopes, greater than 0.
    alpha: f64,
}

impl Ggx {
    /// The surface of a roughness from 0 to 1, whose square is alpha (Burley, "Physically-based shading at Disney", 2012). `None`
    /// where it is as good as smooth.
    pub(super) fn new(roughness: f64) -> Option<Self> {
        let roughness = roughness.clamp(0.0, 1.0);
        let alpha = roughness * roughness;
        (alpha >= 1e-4).then_some(Self { alpha })
    }

    /// Density of the tiny mirrors with normal `h` (PBR 9.16).
    pub(super) fn d(&self, h: DVec3) -> f64 {
        let c2 = h.z * h.z;
        let s2 = h.x * h.x + h.y * h.y;
        if c2 <= 0.0 {
            return 0.0;
        }
        let alpha2 = self.alpha * self.alpha;
        let e = c2 * alpha2 + s2;
        alpha2 / (PI * e * e)
    }

    /// Smith's auxiliary function (PBR 9.19).
    fn lambda(&self, w: DVec3) -> f64 {
        let c2 = w.z * w.z;
        if c2 <= 0.0 {
            return f64::INFINITY;
        }
        let tan2 = (w.x * w.x + w.y * w.y) / c2;
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// Share of the tiny mirrors that is seen from `w` (PBR 9.20).
    pub(super) fn g1(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// Share of them that is seen from both, where height joins the two (PBR 9.23).
    pub(super) fn g(&self, a: DVec3, b: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(a) + self.lambda(b))
    }

    /// What is left of light that a sample of [`Ggx::visible`] sends from `to_eye` to `onward`.
    pub(super) fn share(&self, to_eye: DVec3, onward: DVec3) -> f64 {
        let share = self.g(to_eye, onward) / self.g1(to_eye);
        if share.is_finite() { share } else { 0.0 }
    }

    /// Density of the normals of [`Ggx::visible`] seen from `w`.
    #[cfg(test)]
    fn pdf(&self, w: DVec3, h: DVec3) -> f64 {
        self.g1(w) / w.z.abs() * self.d(h) * w.dot(h).max(0.0)
    }

    /// The normal of one of the tiny mirrors seen from `w`, for two random numbers in [0, 1): Heitz, "Sampling the GGX
    /// distribution of visible normals", JCGT 2018 (PBR 9.6.4).
    pub(super) fn visible(&self, w: DVec3, u: DVec2) -> DVec3 {
        let stretched = DVec3::new(self.alpha * w.x, self.alpha * w.y, w.z);
        let wh = stretched / stretched.length();
        let flat = (wh.x * wh.x + wh.y * wh.y).sqrt();
        let t1 = if wh.z < 0.99999 && flat > 0.0 {
            DVec3::new(-wh.y, wh.x, 0.0) / flat
        } else {
            DVec3::X
        };
        let t2 = wh.cross(t1);
        let r = u.x.sqrt();
        let phi = 2.0 * PI * u.y;
        let (x, y) = (r * math::cos(phi), r * math::sin(phi));
        let s = 0.5 * (1.0 + wh.z);
        let y = (1.0 - s) * (1.0 - x * x).max(0.0).sqrt() + s * y;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let n = t1 * x + t2 * y + wh * z;
        let h = DVec3::new(self.alpha * n.x, self.alpha * n.y, n.z.max(1e-6));
        h / h.length()
    }

    /// What a lamp's light from `to_light` adds to what is seen from `to_eye` by the mirrors themselves, those with the normal
    /// `half` between the two, Fresnel's factor left out: pi D G / (4 cos). The pi is that of this program's lamps, whose light a
    /// white matt surface sends on whole.
    pub(super) fn highlight(&self, to_eye: DVec3, to_light: DVec3, half: DVec3) -> f64 {
        if to_eye.z <= 0.0 || to_light.z <= 0.0 {
            return 0.0;
        }
        PI * self.d(half) * self.g(to_eye, to_light) / (4.0 * to_eye.z)
    }
}

/// The matt surface of Oren and Nayar ("Generalization of Lambert's reflectance model", SIGGRAPH 1994) in the form whose
/// energy never exceeds that of the light, by Fujii ("A tiny improvement of Oren-Nayar reflectance model", 2013): the share of a
/// lamp's light, its cosine included. `sigma` is the standard deviation of the slopes in radians; at 0 it is Lambert's cosine.
pub(super) fn oren_nayar(sigma: f64, to_eye: DVec3, to_light: DVec3) -> f64 {
    if to_light.z <= 0.0 {
        return 0.0;
    }
    if sigma == 0.0 {
        return to_light.z;
    }
    // Fujii's "improved" model takes sigma between 0 and 1 as it is.
    let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * sigma);
    let b = sigma * a;
    let cos_eye = to_eye.z.max(0.0);
    let s = to_eye.dot(to_light) - cos_eye * to_light.z;
    let t = if s > 0.0 { to_light.z.max(cos_eye) } else { 1.0 };
    to_light.z * (a + b * s / t)
}

/// Two unit vectors that make a right-handed frame with `n` (Duff et al., "Building an orthonormal basis, revisited", JCGT 2017).
pub(super) fn frame(n: DVec3) -> (DVec3, DVec3) {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

#[cfg(test)]
#[path = "microfacet_tests.rs"]
mod tests;
