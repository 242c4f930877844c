//! A light that shines into a cone.

use super::{
    Attenuation,
    parts::{LightVector, placed_point},
};
use crate::{
    math::{self, DAffine3, DVec3, Exponent, Ray},
    scene::SceneError,
};

/// Light from one point into a cone around the direction to its target.
///
/// Of the light that a [`LightKind::Point`](super::LightKind::Point) would send, there arrives the share
/// s(a) max(cos a, 0)^`tightness` at the angle a from the axis, where s goes from 0 at `angle` to 1 at `angle - penumbra`
/// as 3x^2 - 2x^3 of where cos a lies between the two cosines: the smooth edge of three.js and of pbrt, with the
/// tightness of POV-Ray. Without penumbra the edge is sharp, and light on it arrives.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Attenuation, Spot}};
/// let spot = Spot::new(DVec3::Y * 3.0, DVec3::ZERO, (20.0, 5.0), 0.0, Attenuation::default())?;
/// // All of it straight down, nothing to the side.
/// assert_eq!((spot.share(DVec3::NEG_Y), spot.share(DVec3::X)), (1.0, 0.0));
/// Builder::new().spot(spot, DVec3::ONE)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    position: DVec3,
    target: DVec3,
    angle: f64,
    penumbra: f64,
    tightness: f64,
    attenuation: Attenuation,
    /// Cosines of the angles at which there is nothing left, and at which all is there.
    cosines: [f64; 2],
}

impl Spot {
    /// A light at `position` that shines at `target`, up to `angle` degrees from that direction, above 0 and at most
    /// 180. The last `penumbra` degrees of it are the soft edge, and `tightness` gathers the light in the middle: 0 is
    /// even light.
    ///
    /// # Errors
    /// Where the angle is out of that range, the penumbra is negative or larger than the angle, the tightness is
    /// negative or more than 1e6, position and target are the same, or a number is not finite.
    pub fn new(
        position: DVec3,
        target: DVec3,
        (angle, penumbra): (f64, f64),
        tightness: f64,
        attenuation: Attenuation,
    ) -> Result<Self, SceneError> {
        if !(angle > 0.0 && angle <= 180.0) {
            return Err(SceneError::new(format!(
                "a spot light's angle must be above 0 and at most 180 degrees, not {angle}"
            ))
            .hint(
                "it is measured from the axis to the edge of the cone: 30 makes a cone of 60 degrees across",
            ));
        }
        if !(penumbra >= 0.0 && penumbra <= angle) {
            return Err(SceneError::new(format!(
                "a spot light's penumbra must be from 0 to its angle of {angle} degrees, not {penumbra}"
            ))
            .hint("the soft edge lies inside of the cone"));
        }
        if !(0.0..=1e6).contains(&tightness) {
            return Err(SceneError::new(format!(
                "a spot light's tightness must be from 0 to 1e6, not {tightness}"
            )));
        }
        let axis = (target - position).length();
        if !(axis > 0.0 && axis.is_finite()) {
            return Err(
                SceneError::new("a spot light needs a target that is not its position")
                    .hint("spot(position, target, color, angle): the target is the point that it shines at"),
            );
        }
        let cosine = |degrees: f64| math::sin_cos_degrees(degrees).1;
        Ok(Self {
            position,
            target,
            angle,
            penumbra,
            tightness,
            attenuation,
            cosines: [cosine(angle), cosine(angle - penumbra)],
        })
    }

    /// Where it is.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The point it shines at.
    #[must_use]
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// Degrees from the axis at which the last light is.
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Degrees of the soft edge, inside of the cone.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::{Attenuation, Spot}};
    /// // 20 degrees to where its light ends, of which 5 are the soft edge.
    /// let spot = Spot::new(DVec3::Y * 3.0, DVec3::ZERO, (20.0, 5.0), 2.0, Attenuation::default())?;
    /// assert_eq!((spot.target(), spot.angle(), spot.penumbra(), spot.tightness()), (DVec3::ZERO, 20.0, 5.0, 2.0));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn penumbra(&self) -> f64 {
        self.penumbra
    }

    /// Power of the cosine by which light is gathered in the middle.
    #[must_use]
    pub fn tightness(&self) -> f64 {
        self.tightness
    }

    /// Its fall-off.
    #[must_use]
    pub fn attenuation(&self) -> &Attenuation {
        &self.attenuation
    }

    /// Share of the light that leaves along `out`, which has any length but 0.
    #[must_use]
    #[inline]
    pub fn share(&self, out: DVec3) -> f64 {
        let axis = self.target - self.position;
        let along = axis.dot(out);
        let lengths2 = axis.dot(axis) * out.dot(out);
        let [outer, inner] = self.cosines;
        // Most points lie outside of most cones: that takes no root and no division.
        if outer > 0.0 && (along <= 0.0 || along * along < 0.999_999 * outer * outer * lengths2) {
            return 0.0;
        }
        let cosine = (along / lengths2.sqrt()).clamp(-1.0, 1.0);
        // A cone of 180 degrees leaves nothing out.
        let edge = if cosine >= inner {
            1.0
        } else if cosine <= outer {
            0.0
        } else {
            let x = (cosine - outer) / (inner - outer);
            x * x * (3.0 - 2.0 * x)
        };
        if self.tightness == 0.0 {
            edge
        } else {
            edge * Exponent::new(self.tightness).of(cosine.max(0.0))
        }
    }

    /// Where a ray, with a unit vector for its direction, is in the cone; `None` where it is nowhere. Cones of 90 degrees
    /// and more are taken for everything.
    pub(crate) fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        let [cosine, _] = self.cosines;
        if cosine < 1e-3 {
            return Some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let axis = self.target - self.position;
        let axis = axis / axis.length();
        let from = ray.origin - self.position;
        let (ahead, along, c2) = (ray.dir.dot(axis), from.dot(axis), cosine * cosine);
        // (p . axis)^2 = cos^2 p^2, which the cone behind the light fulfils as well.
        let a = ahead * ahead - c2;
        let b = ahead * along - c2 * ray.dir.dot(from);
        let c = along * along - c2 * from.dot(from);
        let root = b * b - a * c;
        if !(root > 0.0) || a == 0.0 {
            return (a == 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let root = root.sqrt();
        let (one, two) = ((-b - root) / a, (-b + root) / a);
        let (first, last) = (one.min(two), one.max(two));
        if a < 0.0 {
            let is_ahead = along + ahead * 0.5 * (first + last) > 0.0;
            is_ahead.then_some((first, last))
        } else if ahead > 0.0 {
            Some((last, f64::INFINITY))
        } else {
            Some((f64::NEG_INFINITY, first))
        }
    }

    pub(super) fn placed(&self, m: &DAffine3) -> Option<Self> {
        let (position, target) = (placed_point(m, self.position), placed_point(m, self.target));
        let axis = (target - position).length();
        (axis > 0.0).then(|| Self {
            position,
            target,
            ..self.clone()
        })
    }

    pub(super) fn vectors(&self) -> Vec<LightVector> {
        vec![
            LightVector::point("position", self.position),
            LightVector::point("target", self.target),
        ]
    }

    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("angle", self.angle),
            ("penumbra", self.penumbra),
            ("tightness", self.tightness),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(angle: f64, penumbra: f64, tightness: f64) -> Spot {
        let at = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, -3.0, 3.0));
        Spot::new(at.0, at.1, (angle, penumbra), tightness, Attenuation::default()).unwrap()
    }

    /// The direction at `degrees` from straight down, of another length.
    fn out(degrees: f64) -> DVec3 {
        let (sin, cos) = math::sin_cos_degrees(degrees);
        DVec3::new(0.6 * sin, -cos, 0.8 * sin) * 2.5
    }

    #[test]
    fn the_edge_follows_its_formula() {
        let spot = spot(30.0, 12.0, 0.0);
        let cosine = |degrees: f64| math::cos(degrees.to_radians());
        for tenth in 0..1800 {
            let degrees = f64::from(tenth) * 0.1 + 0.05;
            let x = (cosine(degrees) - cosine(30.0)) / (cosine(18.0) - cosine(30.0));
            let x = x.clamp(0.0, 1.0);
            let expected = x * x * (3.0 - 2.0 * x);
            assert!((spot.share(out(degrees)) - expected).abs() < 1e-12, "{degrees}");
        }
    }

    #[test]
    fn a_ray_is_in_the_cone_where_its_span_says() {
        let spot = spot(25.0, 0.0, 0.0);
        let (mut inside, mut rays) = (0, 0);
        for i in 0..400u32 {
            let x = |k: u32| f64::from((i * 7919 + k * 104_729) % 1000) / 500.0 - 1.0;
            let origin = DVec3::new(1.0 + 3.0 * x(1), 2.0 + 3.0 * x(2), 3.0 + 3.0 * x(3));
            let dir = DVec3::new(x(4), x(5), x(6) + 0.001).normalize();
            let ray = Ray::new(origin, dir);
            let span = spot.span(&ray);
            rays += u32::from(span.is_some());
            for step in -40..40 {
                let t = f64::from(step) * 0.217;
                let is_in = spot.share(ray.at(t) - spot.position()) > 0.0;
                let expected = span.is_some_and(|(a, b)| a < t && t < b);
                assert_eq!(is_in, expected, "{ray:?} at {t}: {span:?}");
                inside += u32::from(is_in);
            }
        }
        assert!(inside > 500 && rays > 50 && rays < 400, "{inside} {rays}");
    }

    #[test]
    fn wide_cones_reach_backwards() {
        assert_eq!(spot(180.0, 0.0, 0.0).share(out(179.0)), 1.0);
        assert_eq!(spot(180.0, 0.0, 0.0).share(out(180.0)), 1.0);
        assert_eq!(spot(120.0, 0.0, 0.0).share(out(119.9)), 1.0);
        assert_eq!(spot(120.0, 0.0, 0.0).share(out(120.1)), 0.0);
        assert_eq!(spot(90.0, 0.0, 0.0).share(out(90.1)), 0.0);
    }

    #[test]
    fn tightness_is_a_power_of_the_cosine() {
        let spot = spot(80.0, 0.0, 10.0);
        for degrees in [0.0, 20.0, 50.0, 79.0] {
            let expected = math::pow(math::cos(f64::to_radians(degrees)), 10.0);
            assert!((spot.share(out(degrees)) - expected).abs() < 1e-13, "{degrees}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let at = |angle, penumbra, tightness, target| {
            Spot::new(
                DVec3::ZERO,
                target,
                (angle, penumbra),
                tightness,
                Attenuation::default(),
            )
            .unwrap_err()
            .message
        };
        assert!(at(0.0, 0.0, 0.0, DVec3::X).contains("angle must be above 0 and at most 180 degrees, not 0"));
        assert!(at(f64::NAN, 0.0, 0.0, DVec3::X).contains("not NaN"));
        assert!(at(20.0, 21.0, 0.0, DVec3::X).contains("from 0 to its angle of 20 degrees, not 21"));
        assert!(at(20.0, 5.0, -1.0, DVec3::X).contains("tightness"));
        assert!(at(20.0, 5.0, 0.0, DVec3::ZERO).contains("target"));
    }
}
