//! The superellipsoid.

use super::{
    CrossingSink, Solidity, Surface,
    pieces::{Frame, Line},
    roots::{Bounded, Range, hull, root_between, sign_changes, times},
    u_around_y,
};
use crate::{
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// A superellipsoid in the unit cube: every shape between box, cylinder, sphere and star.
///
/// Parameters: the exponents east-west `e`, of the sections across Y, and north-south `n`, of those along it; each from
/// 0.01 to 10. 1 is round, towards 0 square, 2 a rhomb, above 2 hollow with edges that run out into blades. With
/// x, y and z from -1 to 1 within the cube the surface is (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) = 1 (Barr,
/// "Superquadrics and angle-preserving transformations", 1981; POV-Ray has z for our y). Solid. Normals outwards.
///
/// uv: u once around Y as on the sphere, v by the latitude of the direction from the center.
///
/// ```
/// use rtscript::shape::Superellipsoid;
/// // A pillow.
/// assert_eq!(Superellipsoid::new(1.0, 0.2).map(|s| (s.e(), s.n())), Ok((1.0, 0.2)));
/// assert!(Superellipsoid::new(0.0, 1.0).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superellipsoid {
    e: f64,
    n: f64,
}

impl Solidity for Superellipsoid {
    const SOLID: bool = true;
}

/// Half of the unit cube.
const HALF: f64 = 0.5;

/// How much wider the searched interval is than the shape, so that it ends outside in spite of rounding.
const MARGIN: f64 = 1e-7;

impl Superellipsoid {
    /// A superellipsoid with these exponents.
    ///
    /// # Errors
    /// Where an exponent is not from 0.01 to 10.
    pub fn new(e: f64, n: f64) -> Result<Self, SceneError> {
        for (name, x) in [("east-west", e), ("north-south", n)] {
            if !(0.01..=10.0).contains(&x) {
                return Err(SceneError::new(format!(
                    "the superellipsoid's {name} exponent must be from 0.01 to 10, not {x}"
                ))
                .hint("1 is round, nearly 0 square, 2 a rhomb"));
            }
        }
        Ok(Self { e, n })
    }

    /// The exponent of sections across Y.
    #[must_use]
    pub const fn e(&self) -> f64 {
        self.e
    }

    /// The exponent of sections along Y.
    #[must_use]
    pub const fn n(&self) -> f64 {
        self.n
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(DVec3::splat(-HALF), DVec3::splat(HALF)))
    }

    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = Frame::new(DVec3::ZERO, HALF).line(ray) else {
            return;
        };
        let Some((lo, hi)) = line.within(DVec3::splat(1.0 + MARGIN)) else {
            return;
        };
        if self.e <= 2.0 && self.n <= 2.0 {
            self.cross_convex(&line, lo, hi, out);
        } else {
            self.cross_hollow(&line, lo, hi, out);
        }
    }

    /// With exponents up to 2 the surface is where a norm is 1, which along a line is convex: its tangents at two
    /// places lie below it, and where they meet is the next place to look, until it is inside or known to be nowhere.
    fn cross_convex(&self, line: &Line, lo: f64, hi: f64, out: &mut impl CrossingSink) {
        let value = |way: f64| {
            let (norm, gradient) = self.norm(line.ray.at(way));
            (norm - 1.0, gradient.dot(line.ray.dir))
        };
        let ((mut a, mut b), (mut at_a, mut at_b)) = ((lo, hi), (value(lo), value(hi)));
        for round in 0..120 {
            if !(at_a.1 < 0.0 && at_b.1 > 0.0) {
                return;
            }
            let meet = a + (at_b.0 - at_a.0 - at_b.1 * (b - a)) / (at_a.1 - at_b.1);
            if at_a.0 + at_a.1 * (meet - a) > 0.0 {
                return;
            }
            // Every third time the middle, or it may take long where one tangent is steep.
            let way = if round % 3 < 2 && meet > a && meet < b {
                meet
            } else {
                0.5 * (a + b)
            };
            if !(way > a && way < b) {
                return;
            }
            let there = value(way);
            if there.0 <= 0.0 {
                out.push(line.t(root_between(value, lo, way, true)), 0);
                if !out.is_served() {
                    out.push(line.t(root_between(value, way, hi, false)), 0);
                }
                return;
            }
            if there.1 < 0.0 {
                (a, at_a) = (way, there);
            } else {
                (b, at_b) = (way, there);
            }
        }
    }

    /// Else it is searched octant by octant, in each of which all three coordinates grow or shrink throughout.
    fn cross_hollow(&self, line: &Line, lo: f64, hi: f64, out: &mut impl CrossingSink) {
        let mut ends = [hi; 4];
        let planes = line
            .ray
            .origin
            .to_array()
            .into_iter()
            .zip(line.ray.dir.to_array());
        for (end, (o, d)) in ends.iter_mut().zip(planes) {
            let way = -o / d;
            *end = if way > lo && way < hi { way } else { hi };
        }
        ends.sort_by(f64::total_cmp);
        let power = Power { shape: self, line };
        let mut from = lo;
        for way in ends {
            if way > from {
                sign_changes(&power, from, way, &mut |way, _| out.push(line.t(way), 0));
                from = way;
            }
        }
    }

    /// The norm of which the surface is the unit sphere, and its gradient, at a point of the cube of edges 2.
    fn norm(&self, p: DVec3) -> (f64, DVec3) {
        let size = p.abs();
        let (across, norm) = self.lengths(size);
        let (p_across, p_along) = (2.0 / self.e - 1.0, 2.0 / self.n - 1.0);
        // Bounded away from 0, or blades would have no direction at all.
        let part = |x: f64, of: f64, power: f64| math::pow((x / of).clamp(1e-18, 1.0), power);
        if !(norm > 0.0) {
            return (0.0, DVec3::ZERO);
        }
        let y = sign(p.y) * part(size.y, norm, p_along);
        if across == 0.0 {
            return (norm, DVec3::new(0.0, y, 0.0));
        }
        let inner = part(across, norm, p_along);
        let x = sign(p.x) * inner * part(size.x, across, p_across);
        let z = sign(p.z) * inner * part(size.z, across, p_across);
        (norm, DVec3::new(x, y, z))
    }

    /// The distance from the axis and that from the center, as the shape measures them.
    fn lengths(&self, size: DVec3) -> (f64, f64) {
        let across = length(size.x, size.z, 2.0 / self.e);
        (across, length(across, size.y, 2.0 / self.n))
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let (_, gradient) = self.norm(p / HALF);
        if gradient == DVec3::ZERO {
            DVec3::Y
        } else {
            gradient
        }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let rho = (p.x * p.x + p.z * p.z).sqrt();
        Surface {
            normal: self.normal(p),
            uv: DVec2::new(u_around_y(p.x, p.z), math::atan2(p.y, rho) / PI + 0.5),
        }
    }
}

/// -1, 0 or 1.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// (a^p + b^p)^(1/p) for numbers from 0 on, without overflow.
fn length(a: f64, b: f64, p: f64) -> f64 {
    let (less, more) = (a.min(b), a.max(b));
    if less == 0.0 {
        return more;
    }
    if p == 2.0 {
        return (a * a + b * b).sqrt();
    }
    more * math::pow(1.0 + math::pow(less / more, p), 1.0 / p)
}

/// The norm of which the surface is the unit sphere, less 1, along a line within an octant.
struct Power<'a> {
    shape: &'a Superellipsoid,
    line: &'a Line,
}

impl Bounded for Power<'_> {
    fn at(&self, way: f64) -> (f64, f64) {
        let (norm, gradient) = self.shape.norm(self.line.ray.at(way));
        (norm - 1.0, gradient.dot(self.line.ray.dir))
    }

    fn within(&self, lo: f64, hi: f64) -> (Range, Range) {
        let (a, b) = (self.line.ray.at(lo), self.line.ray.at(hi));
        let (least, most) = (a.abs().min(b.abs()), a.abs().max(b.abs()));
        // A coordinate that rounding takes past 0 within an octant.
        let least = DVec3::select((a * b).cmplt(DVec3::ZERO), DVec3::ZERO, least);
        let (across, norm) = {
            let ((al, nl), (ah, nh)) = (self.shape.lengths(least), self.shape.lengths(most));
            ((al, ah), (nl, nh))
        };
        let value = (norm.0 - 1.0 - 1e-14, norm.1 - 1.0 + 1e-14);
        let (p_across, p_along) = (2.0 / self.shape.e - 1.0, 2.0 / self.shape.n - 1.0);
        // (x / of)^power, which grows with x and shrinks with `of` where the power is positive.
        let part = |x: Range, of: Range, power: f64| {
            let ends = [x.0 / of.1, (x.1 / of.0).min(1.0)];
            if ends.iter().any(|x| x.is_nan()) {
                return (0.0, f64::INFINITY);
            }
            hull(&ends.map(|x| math::pow(x, power)))
        };
        let inner = part(across, norm, p_along);
        let d = self.line.ray.dir;
        let middle = self.line.ray.at(0.5 * (lo + hi));
        let (mut slowest, mut fastest) = (0.0, 0.0);
        for (x, d, range) in [
            (middle.x, d.x, part((least.x, most.x), across, p_across)),
            (middle.z, d.z, part((least.z, most.z), across, p_across)),
            (middle.y, d.y, part((least.y, most.y), norm, p_along)),
        ]
        .into_iter()
        .enumerate()
        .map(|(i, (x, d, range))| (x, d, if i < 2 { times(inner, range) } else { range }))
        {
            let speed = sign(x) * d;
            if speed != 0.0 {
                let (a, b) = times(range, (speed, speed));
                slowest += a;
                fastest += b;
            }
        }
        (value, (slowest, fastest))
    }
}
