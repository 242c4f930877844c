//! Portable maths: the vector types of the crate and every transcendental function it uses.
//!
//! `+ - * / sqrt` are exact by IEEE 754 and may be written anywhere. Everything else comes from the `libm`
//! crate through this file, because std's versions differ from one system to the next in the last bit
//! (`clippy.toml` forbids those). No fused multiply-add decides a value anywhere.

pub use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};

/// Ratio of a circle's circumference to its diameter.
pub const PI: f64 = std::f64::consts::PI;

macro_rules! from_libm {
    ($($(#[$doc:meta])* $name:ident($($arg:ident),+) = $libm:ident;)*) => {
        $($(#[$doc])* #[must_use] pub fn $name($($arg: f64),+) -> f64 { libm::$libm($($arg),+) })*
    };
}

from_libm! {
    /// Sine of an angle in radians.
    sin(x) = sin;
    /// Cosine of an angle in radians.
    cos(x) = cos;
    /// Tangent of an angle in radians.
    tan(x) = tan;
    /// Arc sine in radians, for x in [-1, 1].
    asin(x) = asin;
    /// Arc cosine in radians, for x in [-1, 1].
    acos(x) = acos;
    /// Arc tangent in radians.
    atan(x) = atan;
    /// Angle in radians of the point (x, y), in [-pi, pi].
    atan2(y, x) = atan2;
    /// Hyperbolic sine.
    sinh(x) = sinh;
    /// Hyperbolic cosine.
    cosh(x) = cosh;
    /// Hyperbolic tangent.
    tanh(x) = tanh;
    /// Inverse hyperbolic sine.
    asinh(x) = asinh;
    /// Inverse hyperbolic cosine, for x at or above 1.
    acosh(x) = acosh;
    /// Inverse hyperbolic tangent, for x in (-1, 1).
    atanh(x) = atanh;
    /// e to the power x.
    exp(x) = exp;
    /// e to the power x, minus 1, to the last digit where that is little.
    expm1(x) = expm1;
    /// Natural logarithm of 1 + x, to the last digit where that is little.
    log1p(x) = log1p;
    /// Natural logarithm.
    ln(x) = log;
    /// Logarithm to base 2.
    log2(x) = log2;
    /// Logarithm to base 10.
    log10(x) = log10;
    /// Cube root.
    cbrt(x) = cbrt;
    /// Length of the hypotenuse, without overflow.
    hypot(x, y) = hypot;
    /// x to the power y.
    pow(x, y) = pow;
}

/// `x` to a whole power by squaring: products only, so the same bits everywhere and cheaper than [`pow`].
///
/// ```
/// use rtscript::math::{Exponent, pow, powi};
/// assert_eq!(powi(2.0, 10), 1024.0);
/// // Made once, used for many bases.
/// assert_eq!(Exponent::new(3.0).of(2.0), pow(2.0, 3.0));
/// ```
#[inline]
#[must_use]
pub fn powi(x: f64, n: u32) -> f64 {
    let (mut base, mut n, mut product) = (x, n, 1.0);
    while n > 0 {
        if n & 1 == 1 {
            product *= base;
        }
        base *= base;
        n >>= 1;
    }
    product
}

/// The exponent of a highlight, looked at once for all the powers taken with it.
///
/// ```
/// use rtscript::math::Exponent;
/// assert_eq!(Exponent::new(2.0), Exponent::Whole(2));
/// assert_eq!(Exponent::Whole(2).of_each(&[1.0, 3.0]), [1.0, 9.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exponent {
    /// A whole number below 2^16: the power is a product.
    Whole(u32),
    /// Any other number: the power is [`pow`].
    Real(f64),
}

impl Exponent {
    /// The exponent `s`.
    #[must_use]
    pub fn new(s: f64) -> Self {
        // As `s.trunc() == s`, without a call where the processor has no instruction for it.
        if (0.0..65536.0).contains(&s) && f64::from(s as u32) == s {
            Self::Whole(s as u32)
        } else {
            Self::Real(s)
        }
    }

    /// `x` to this power, for x in [0, 1].
    #[inline]
    #[must_use]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Whole(n) => powi(x, n),
            Self::Real(s) => pow(x, s),
        }
    }

    /// [`Exponent::of`] each of several numbers, which takes little longer than one.
    #[inline]
    #[must_use]
    pub fn of_each<const N: usize>(self, x: &[f64; N]) -> [f64; N] {
        let Self::Whole(mut n) = self else {
            return x.map(|x| self.of(x));
        };
        // As `powi`.
        let (mut base, mut product) = (*x, [1.0; N]);
        while n > 0 {
            if n & 1 == 1 {
                product.iter_mut().zip(&base).for_each(|(p, b)| *p *= b);
            }
            base.iter_mut().for_each(|b| *b *= *b);
            n >>= 1;
        }
        product
    }
}

/// [`sin`] and [`cos`] of an angle in radians, to the bit, for little more than one of them.
///
/// ```
/// use rtscript::math::{cos, sin, sin_cos};
/// assert_eq!(sin_cos(0.7), (sin(0.7), cos(0.7)));
/// ```
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Sine and cosine of an angle in degrees; exact at multiples of 90, so that a quarter turn leaves no dust
/// in a matrix.
///
/// ```
/// use rtscript::math::sin_cos_degrees;
/// // Quarter turns are exact.
/// assert_eq!(sin_cos_degrees(90.0), (1.0, 0.0));
/// ```
#[must_use]
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees % 360.0;
    let quarter = match turn {
        0.0 => Some((0.0, 1.0)),
        90.0 | -270.0 => Some((1.0, 0.0)),
        180.0 | -180.0 => Some((0.0, -1.0)),
        270.0 | -90.0 => Some((-1.0, 0.0)),
        _ => None,
    };
    quarter.unwrap_or_else(|| {
        let radians = turn.to_radians();
        (sin(radians), cos(radians))
    })
}

/// Rotation about a unit `axis` by `degrees`, right-handed (Rodrigues' formula; Foley et al., 1990, 5.6).
///
/// ```
/// use rtscript::{DVec3, math::rotation};
/// // A quarter turn about Y takes X to -Z.
/// assert_eq!(rotation(DVec3::Y, 90.0) * DVec3::X, DVec3::NEG_Z);
/// ```
#[must_use]
pub fn rotation(axis: DVec3, degrees: f64) -> DMat3 {
    let (s, c) = sin_cos_degrees(degrees);
    let (x, y, z, k) = (axis.x, axis.y, axis.z, 1.0 - c);
    DMat3::from_cols(
        DVec3::new(c + x * x * k, y * x * k + z * s, z * x * k - y * s),
        DVec3::new(x * y * k - z * s, c + y * y * k, z * y * k + x * s),
        DVec3::new(x * z * k + y * s, y * z * k - x * s, c + z * z * k),
    )
}

/// True where the matrix flattens space: |det| is nothing beside the product of the column lengths, which
/// unlike a fixed bound does not mistake a small scale for a flat one.
///
/// ```
/// use rtscript::{DVec3, math::{DMat3, is_singular}};
/// assert!(is_singular(&DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))));
/// assert!(!is_singular(&DMat3::IDENTITY));
/// ```
#[must_use]
pub fn is_singular(m: &DMat3) -> bool {
    let volume = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    !(volume > 0.0 && m.determinant().abs() > 1e-12 * volume)
}

/// Largest absolute component. Where one is NaN, so may this be.
///
/// ```
/// use rtscript::{DVec3, math::max_abs};
/// assert_eq!(max_abs(DVec3::new(1.0, -3.0, 2.0)), 3.0);
/// ```
#[must_use]
pub fn max_abs(v: DVec3) -> f64 {
    larger(larger(v.x.abs(), v.y.abs()), v.z.abs())
}

/// The larger of two numbers, and the second where either is NaN: one operation, where `f64::max` takes four.
#[inline(always)]
pub(crate) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The smaller of two numbers, and the second where either is NaN.
#[inline(always)]
pub(crate) fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// A ray `origin + t * dir`. `dir` need not be a unit vector: under an instance's inverse matrix it is not,
/// which keeps `t` comparable between spaces.
///
/// ```
/// use rtscript::{DVec3, math::{DAffine3, Ray}};
/// let ray = Ray { origin: DVec3::ZERO, dir: 2.0 * DVec3::X };
/// assert_eq!(ray.at(3.0), 6.0 * DVec3::X);
/// let moved = ray.transformed(&DAffine3::from_translation(DVec3::Y));
/// assert_eq!(moved.at(3.0), DVec3::new(6.0, 1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start of the ray.
    pub origin: DVec3,
    /// Direction; `t` counts multiples of it.
    pub dir: DVec3,
}

impl Ray {
    /// Ray from `origin` along `dir`.
    #[must_use]
    pub const fn new(origin: DVec3, dir: DVec3) -> Self {
        Self { origin, dir }
    }

    /// The point `origin + t * dir`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.dir * t
    }

    /// The same ray seen from another space; `t` keeps its meaning.
    #[must_use]
    pub fn transformed(&self, to_from_here: &DAffine3) -> Self {
        Self {
            origin: to_from_here.transform_point3(self.origin),
            dir: to_from_here.transform_vector3(self.dir),
        }
    }
}

/// An axis-aligned box, empty where `min > max`.
///
/// ```
/// use rtscript::{DVec3, math::{Bounds3, DAffine3}};
/// let unit = Bounds3::new(DVec3::ZERO, DVec3::ONE);
/// assert_eq!((unit.center(), unit.size()), (DVec3::splat(0.5), DVec3::ONE));
/// let moved = unit.transformed(&DAffine3::from_translation(DVec3::X));
/// assert_eq!(unit.union(&moved).size(), DVec3::new(2.0, 1.0, 1.0));
/// assert_eq!(Bounds3::around(unit.corners()), unit);
/// assert!(!unit.is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Bounds3 {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        min: DVec3::splat(f64::INFINITY),
        max: DVec3::splat(f64::NEG_INFINITY),
    };

    /// Box between two corners, given in order.
    #[must_use]
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// Smallest box around `points`.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// Smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// True where the box holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// The box's center.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
            DVec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }

    /// Smallest box around this box after an affine map.
    #[must_use]
    pub fn transformed(&self, to_from_here: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::around(self.corners().map(|p| to_from_here.transform_point3(p)))
    }
}

/// A vector in a sentence, as a script has it, with four digits to a number: `[0, 1.333, -2e-9]`.
pub(crate) fn brief(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(|x| {
        let rounded = format!("{x:.3e}").parse().unwrap_or(x);
        match f64::abs(rounded) {
            0.0 => "0".to_owned(),
            size if (1e-4..1e9).contains(&size) => format!("{rounded}"),
            _ => format!("{rounded:e}"),
        }
    });
    format!("[{x}, {y}, {z}]")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_in_sentences_are_short() {
        assert_eq!(
            brief(DVec3::new(-0.0, 4.0 / 3.0, -2.00004e-9)),
            "[0, 1.333, -2e-9]"
        );
        assert_eq!(brief(DVec3::new(12345.6, 1e300, f64::NAN)), "[12350, 1e300, NaN]");
    }

    #[test]
    fn quarter_turns_are_exact() {
        let m = rotation(DVec3::Z, 90.0);
        assert_eq!(m * DVec3::X, DVec3::Y);
        assert_eq!(rotation(DVec3::X, -450.0) * DVec3::Y, -DVec3::Z);
    }

    #[test]
    fn small_scales_are_not_singular() {
        assert!(!is_singular(&DMat3::from_diagonal(DVec3::splat(1e-9))));
        assert!(is_singular(&DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))));
        assert!(is_singular(&DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Y)));
    }

    #[test]
    fn whole_powers_are_products() {
        assert_eq!(powi(0.5, 10), 0.5f64.recip().recip() / 512.0);
        assert_eq!(Exponent::new(0.0).of(0.0), 1.0);
        assert_eq!(Exponent::new(-0.0), Exponent::Whole(0));
        assert_eq!(Exponent::new(65536.0), Exponent::Real(65536.0));
        assert_eq!(Exponent::new(0.5).of(0.25), 0.5);
        let x = [0.0, 0.3, 0.999, 1.0];
        for s in [0.0, 1.0, 7.0, 200.0, 2.5] {
            let exponent = Exponent::new(s);
            assert_eq!(exponent.of_each(&x), x.map(|x| exponent.of(x)));
        }
    }
}
