//! The general quadric.

use super::{
    Crossing, CrossingSink, Cuboid, Solidity, Surface, coordinate, pieces::Frame, span::Span, u_around_y,
};
use crate::{
    math::{self, Bounds3, DMat3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// All points where A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J is 0: ellipsoids, paraboloids,
/// hyperboloids, cones, cylinders, pairs of planes, where the coefficients put them.
///
/// Parameters: the ten coefficients in this order, as in POV-Ray, and a box that cuts out a part, if wanted. With a box
/// it is solid: all of the box where the polynomial is not above 0, closed by the faces of the box. Without one an
/// ellipsoid is solid, and anything else a surface without end. Normals point to where the polynomial grows, on an
/// ellipsoid outwards whatever its signs, and out of the box on its faces.
///
/// uv: on the surface, u once around the upright line through the middle, as on the sphere; v from the bottom to the top
/// of the bounds, or without end with its middle at y = 0. On the faces as on a box.
///
/// ```
/// use rtscript::{DVec3, math::Bounds3, shape::Quadric};
/// // x^2 + z^2 - y^2 = 0: a double cone, cut off at y = -1 and 1.
/// let coefficients = [1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let part = Bounds3::new(DVec3::NEG_ONE, DVec3::ONE);
/// let cone = Quadric::new(coefficients, Some(part))?;
/// assert_eq!((cone.coefficients(), cone.clip()), (coefficients, Some(part)));
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Quadric {
    coefficients: [f64; 10],
    clip: Option<Bounds3>,
    form: Form,
    frame: Frame,
    /// The form in the frame.
    framed: Form,
    /// Half edges of the box in the frame, and the box.
    cut: Option<(DVec3, Cuboid)>,
    bounds: Option<Bounds3>,
}

/// The coefficients and the box; all else follows from them.
impl std::fmt::Debug for Quadric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut s = f.debug_struct("Quadric");
        s.field("coefficients", &self.coefficients);
        if let Some(clip) = self.clip {
            s.field("min", &clip.min).field("max", &clip.max);
        }
        s.finish()
    }
}

impl Solidity for Quadric {
    const SOLID: bool = true;

    fn is_solid(&self) -> bool {
        self.bounds.is_some()
    }
}

/// p.(q p) + g.p + c.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Form {
    q: DMat3,
    g: DVec3,
    c: f64,
}

impl Form {
    fn at(&self, p: DVec3) -> f64 {
        p.dot(self.q * p + self.g) + self.c
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        self.q * p * 2.0 + self.g
    }

    /// The same seen from a frame.
    fn framed(&self, frame: &Frame) -> Self {
        let (m, s) = (frame.center(), frame.scale());
        Self {
            q: self.q * (s * s),
            g: self.gradient(m) * s,
            c: self.at(m),
        }
    }

    /// Center and half edges of the box around the ellipsoid that it is 0 on, if it is one: `q` has only
    /// eigenvalues of one sign (Sylvester), and the center has the other.
    fn ellipsoid(&self) -> Option<(DVec3, DVec3)> {
        let q = self.q;
        let minor = q.x_axis.x * q.y_axis.y - q.x_axis.y * q.y_axis.x;
        let sign = q.x_axis.x.signum();
        let size = q.x_axis.length() * q.y_axis.length() * q.z_axis.length();
        // A form that is flat but for rounding has an end nowhere near.
        if !(minor > 0.0 && q.determinant() * sign > 1e-12 * size) {
            return None;
        }
        let inverse = q.inverse();
        let center = inverse * self.g * -0.5;
        let depth = -self.at(center);
        let half2 = DVec3::new(inverse.x_axis.x, inverse.y_axis.y, inverse.z_axis.z) * depth;
        (half2.cmpgt(DVec3::ZERO).all() && half2.is_finite() && center.is_finite())
            .then(|| (center, half2.map(f64::sqrt)))
    }
}

impl Quadric {
    /// The quadric of these coefficients, cut out by the box `clip` if there is one.
    ///
    /// # Errors
    /// Where a number is not finite or beyond 1e15, all but the last coefficient are 0, the box has no volume, or no
    /// point is on the surface of what would be an ellipsoid.
    pub fn new(coefficients: [f64; 10], clip: Option<Bounds3>) -> Result<Self, SceneError> {
        for (name, x) in NAMES.iter().zip(coefficients) {
            // Those of a small shape are large: the squares of what its lengths divide 1 by.
            if !(x.abs() <= 1e100) {
                return Err(SceneError::new(format!(
                    "the quadric's coefficient {name} must be a finite number within 1e100, not {x}"
                )));
            }
        }
        let [a, b, c, d, e, f, g, h, i, j] = coefficients;
        if [a, b, c, d, e, f, g, h, i].iter().all(|x| *x == 0.0) {
            return Err(SceneError::new(
                "the quadric's coefficients of x, y and z must not all be 0",
            ));
        }
        let q = DMat3::from_cols(
            DVec3::new(a, 0.5 * d, 0.5 * e),
            DVec3::new(0.5 * d, b, 0.5 * f),
            DVec3::new(0.5 * e, 0.5 * f, c),
        );
        let mut form = Form {
            q,
            g: DVec3::new(g, h, i),
            c: j,
        };
        if let Some(clip) = &clip {
            for (x, axis) in clip.min.to_array().into_iter().zip(["x", "y", "z"]) {
                coordinate(format_args!("the quadric's min.{axis}"), x)?;
            }
            for (x, axis) in clip.max.to_array().into_iter().zip(["x", "y", "z"]) {
                coordinate(format_args!("the quadric's max.{axis}"), x)?;
            }
            if !clip.min.cmplt(clip.max).all() {
                return Err(SceneError::new(format!(
                    "the quadric's max must be greater than its min in x, y and z, but they are {} and {}",
                    math::brief(clip.max),
                    math::brief(clip.min)
                )));
            }
        }
        let ellipsoid = form.ellipsoid();
        let closed = ellipsoid.map(|(center, half)| Bounds3::new(center - half, center + half));
        let is_definite = form.q.determinant() != 0.0
            && Form {
                c: -1.0,
                g: DVec3::ZERO,
                ..form
            }
            .ellipsoid()
            .or(Form {
                c: 1.0,
                g: DVec3::ZERO,
                ..form
            }
            .ellipsoid())
            .is_some();
        if ellipsoid.is_none() && is_definite {
            return Err(
                SceneError::new("the quadric has no points: nowhere is the polynomial 0")
                    .hint("x^2 + y^2 + z^2 - 1 is the unit sphere: its last coefficient is negative"),
            );
        }
        if clip.is_none() && closed.is_some() && form.q.x_axis.x < 0.0 {
            form = Form {
                q: form.q * -1.0,
                g: -form.g,
                c: -form.c,
            };
        }
        let bounds = match (clip, closed) {
            // The box alone where the polynomial is above 0 within the ellipsoid.
            (Some(clip), Some(closed)) if form.q.x_axis.x > 0.0 => {
                let common = Bounds3::new(clip.min.max(closed.min), clip.max.min(closed.max));
                Some(if common.is_empty() { clip } else { common })
            }
            (Some(clip), _) => Some(clip),
            (None, closed) => closed,
        };
        let of_frame = clip.or(closed);
        let frame = of_frame.map_or(Frame::new(DVec3::ZERO, 1.0), |b| Frame::around(&b));
        let cut = match clip {
            Some(clip) => Some((clip.size() * 0.5 / frame.scale(), Cuboid::new(clip.size())?)),
            None => None,
        };
        Ok(Self {
            coefficients,
            clip,
            form,
            frame,
            framed: form.framed(&frame),
            cut,
            bounds,
        })
    }

    /// The ten coefficients.
    #[must_use]
    pub const fn coefficients(&self) -> [f64; 10] {
        self.coefficients
    }

    /// The box that cuts out a part.
    #[must_use]
    pub const fn clip(&self) -> Option<Bounds3> {
        self.clip
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        self.bounds
    }

    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = self.frame.line(ray) else {
            return;
        };
        let (o, d) = (line.ray.origin, line.ray.dir);
        let turned = self.framed.q * d;
        let a = d.dot(turned);
        let b = o.dot(turned) + 0.5 * self.framed.g.dot(d);
        let inside = not_above_zero(a, b, self.framed.at(o));
        let Some((half, _)) = self.cut else {
            // Where both ends are infinite nothing is crossed.
            for end in inside.into_iter().flatten().flat_map(Span::ends) {
                let t = line.t(end.t);
                if t.is_finite() {
                    out.push(t, SURFACE);
                }
            }
            return;
        };
        let faces = Span::slab(o.x, d.x, half.x, 1, 2)
            .and_then(|x| x.clip(Span::slab(o.y, d.y, half.y, 3, 4)?))
            .and_then(|xy| xy.clip(Span::slab(o.z, d.z, half.z, 5, 6)?));
        let Some(faces) = faces else { return };
        for span in inside.into_iter().flatten().filter_map(|span| span.clip(faces)) {
            let [enter, exit] = span.ends();
            out.push(line.t(enter.t), enter.part);
            out.push(line.t(exit.t), exit.part);
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let from_middle = p - self.frame.center();
        if let (Some((_, cuboid)), 1..) = (&self.cut, part) {
            return cuboid.surface(from_middle, part - 1);
        }
        let gradient = self.form.gradient(p);
        let v = match self.bounds {
            Some(b) => (p.y - b.min.y) / b.size().y,
            None => math::atan(p.y) / PI + 0.5,
        };
        Surface {
            // Nothing at the tip of a cone.
            normal: if gradient == DVec3::ZERO {
                DVec3::Y
            } else {
                gradient
            },
            uv: DVec2::new(u_around_y(from_middle.x, from_middle.z), v.clamp(0.0, 1.0)),
        }
    }
}

const NAMES: [&str; 10] = ["A", "B", "C", "D", "E", "F", "G", "H", "I", "J"];

/// The part of a closed quadric that is no face of its box.
const SURFACE: u32 = 0;

/// Where a x^2 + 2 b x + c is not above 0, as up to two intervals in order.
///
/// The discriminant is taken without cancellation, so that grazing lines do not flicker, and the roots in the form that
/// never subtracts near-equal numbers (Press et al., Numerical Recipes, 5.6).
fn not_above_zero(a: f64, b: f64, c: f64) -> [Option<Span>; 2] {
    let (all, none) = (Span::line_if(true), None);
    let span = |from: f64, to: f64| {
        let end = |t: f64| Crossing { t, part: SURFACE };
        Span::between(end(from), end(to))
    };
    let (before, beyond) = (f64::NEG_INFINITY, f64::INFINITY);
    if a == 0.0 {
        let root = -0.5 * c / b;
        return match b.total_cmp(&0.0) {
            _ if b == 0.0 => [if c <= 0.0 { all } else { none }, none],
            std::cmp::Ordering::Less => [span(root, beyond), none],
            _ => [span(before, root), none],
        };
    }
    let discriminant = difference_of_products(b, b, a, c);
    if !(discriminant >= 0.0) {
        return [if a < 0.0 { all } else { none }, none];
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    let (x0, x1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
    let (x0, x1) = (x0.min(x1), x0.max(x1));
    if a > 0.0 {
        [span(x0, x1), none]
    } else {
        [span(before, x0), span(x1, beyond)]
    }
}

/// a b - c d, rounded once or twice (Kahan's algorithm, with the errors of the products from Dekker, "A floating-point
/// technique for extending the available precision", 1971, in place of a fused operation).
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (ab, ab_error) = exact_product(a, b);
    let (cd, cd_error) = exact_product(c, d);
    let exact = (ab - cd) + (ab_error - cd_error);
    // The splitting overflows where the product hardly does.
    if exact.is_nan() { ab - cd } else { exact }
}

/// The rounded product and what rounding took.
fn exact_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let big = 134_217_729.0 * x;
        let high = big - (big - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let product = a * b;
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}
