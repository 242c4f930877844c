//! The kinds of numbers that a field is evaluated in: values, gradients, intervals, and intervals with their slopes.

use std::ops::{Add, Mul, Neg, Sub};

use super::{interval::Interval, noise};
use crate::math::{self, DVec3};

/// What the operations of a field need of a number.
pub(super) trait Scalar: Copy {
    fn constant(x: f64) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn neg(self) -> Self;
    fn square(self) -> Self;
    fn abs(self) -> Self;
    /// Of negative numbers 0.
    fn sqrt(self) -> Self;
    /// To the power of a positive number; of negative numbers 0.
    fn pow(self, exponent: f64) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// The root of the sum of both squares.
    fn hypot(self, other: Self) -> Self;
    /// How far it is from the nearest whole multiple of `period` that is at most `most` periods from 0.
    fn wrap(self, period: f64, most: f64) -> Self;
    /// Gradient noise at a point.
    fn noise(p: [Self; 3]) -> Self;

    // With a constant, where that is less work than with any number; the same values.
    fn add_constant(self, c: f64) -> Self {
        self.add(Self::constant(c))
    }
    fn sub_constant(self, c: f64) -> Self {
        self.sub(Self::constant(c))
    }
    fn mul_constant(self, c: f64) -> Self {
        self.mul(Self::constant(c))
    }
    fn div_constant(self, c: f64) -> Self {
        self.div(Self::constant(c))
    }
}

/// The multiple that [`Scalar::wrap`] subtracts, in periods.
pub(super) fn cell(x: f64, period: f64, most: f64) -> f64 {
    (x / period + 0.5).floor().clamp(-most, most)
}

/// The number, or 0 where it is less. Not `f64::max`: of two zeros that may be either.
fn positive(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}

impl Scalar for f64 {
    fn constant(x: f64) -> Self {
        x
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn neg(self) -> Self {
        -self
    }
    fn square(self) -> Self {
        self * self
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn sqrt(self) -> Self {
        positive(self).sqrt()
    }
    fn pow(self, exponent: f64) -> Self {
        math::pow(positive(self), exponent)
    }
    fn sin(self) -> Self {
        math::sin(self)
    }
    fn cos(self) -> Self {
        math::cos(self)
    }
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    fn hypot(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
    fn wrap(self, period: f64, most: f64) -> Self {
        self - period * cell(self, period, most)
    }
    fn noise([x, y, z]: [Self; 3]) -> Self {
        noise::value(DVec3::new(x, y, z))
    }
}

impl Scalar for Interval {
    fn constant(x: f64) -> Self {
        Self::point(x)
    }
    fn add(self, other: Self) -> Self {
        Self::add(self, other)
    }
    fn sub(self, other: Self) -> Self {
        Self::sub(self, other)
    }
    fn mul(self, other: Self) -> Self {
        Self::mul(self, other)
    }
    fn div(self, other: Self) -> Self {
        Self::div(self, other)
    }
    fn neg(self) -> Self {
        Self::neg(self)
    }
    fn square(self) -> Self {
        Self::square(self)
    }
    fn abs(self) -> Self {
        Self::abs(self)
    }
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    fn pow(self, exponent: f64) -> Self {
        Self::pow(self, exponent)
    }
    fn sin(self) -> Self {
        Self::sin(self)
    }
    fn cos(self) -> Self {
        Self::cos(self)
    }
    fn min(self, other: Self) -> Self {
        Self::min(self, other)
    }
    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }
    fn hypot(self, other: Self) -> Self {
        self.square().add(other.square()).sqrt()
    }
    fn wrap(self, period: f64, most: f64) -> Self {
        let [lo, hi] = [self.lo, self.hi].map(|x| cell(x, period, most));
        if lo == hi {
            return self.sub(Self::point(period).mul(Self::point(lo)));
        }
        // Before the first and beyond the last cell it grows on.
        let half = Self::new(-0.5 * period, 0.5 * period);
        let ends = [self.lo, self.hi].map(|x| Self::point(x).wrap(period, most));
        let [a, b] = ends;
        Self::new(half.lo.next_down(), half.hi.next_up()).hull(a).hull(b)
    }
    fn noise(p: [Self; 3]) -> Self {
        noise::bounds(p).0
    }
}

/// A value with its slopes in `N` directions, all as intervals: along a ray, or along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope<const N: usize> {
    pub(super) v: Interval,
    pub(super) d: [Interval; N],
}

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };

impl<const N: usize> Slope<N> {
    const LEVEL: [Interval; N] = [ZERO; N];

    fn is_constant(&self) -> bool {
        self.d == Self::LEVEL
    }

    /// Slopes from those of two.
    fn both(self, other: Self, slope: impl Fn(Interval, Interval) -> Interval) -> [Interval; N] {
        let mut d = self.d;
        for (d, other) in d.iter_mut().zip(other.d) {
            *d = slope(*d, other);
        }
        d
    }

    /// A function of one number: its value, and its own slope there.
    fn chain(self, v: Interval, slope: Interval) -> Self {
        // A constant stays one, also where the slope has no bound.
        let d = self.d.map(|d| if d == ZERO { ZERO } else { slope.mul(d) });
        Self { v, d }
    }

    /// One of two.
    fn either(self, other: Self, v: Interval, takes_self: bool, takes_other: bool) -> Self {
        let d = match (takes_self, takes_other) {
            (true, false) => self.d,
            (false, true) => other.d,
            _ => self.both(other, Interval::hull),
        };
        Self { v, d }
    }
}

impl<const N: usize> Scalar for Slope<N> {
    fn constant(x: f64) -> Self {
        Self {
            v: Interval::point(x),
            d: Self::LEVEL,
        }
    }
    fn add(self, other: Self) -> Self {
        Self {
            v: self.v.add(other.v),
            d: self.both(other, Interval::add),
        }
    }
    fn sub(self, other: Self) -> Self {
        Self {
            v: self.v.sub(other.v),
            d: self.both(other, Interval::sub),
        }
    }
    fn mul(self, other: Self) -> Self {
        Self {
            v: self.v.mul(other.v),
            d: self.both(other, |a, b| a.mul(other.v).add(self.v.mul(b))),
        }
    }
    fn div(self, other: Self) -> Self {
        let v = self.v.div(other.v);
        Self {
            v,
            d: self.both(other, |a, b| a.sub(v.mul(b)).div(other.v)),
        }
    }
    fn neg(self) -> Self {
        Self {
            v: self.v.neg(),
            d: self.d.map(Interval::neg),
        }
    }
    fn square(self) -> Self {
        self.chain(self.v.square(), self.v.mul(Interval::point(2.0)))
    }
    fn abs(self) -> Self {
        let sign = Interval::new(
            if self.v.lo > 0.0 { 1.0 } else { -1.0 },
            if self.v.hi < 0.0 { -1.0 } else { 1.0 },
        );
        self.chain(self.v.abs(), sign)
    }
    fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        let slope = if v.lo > 0.0 {
            Interval::point(0.5).div(v)
        } else {
            Interval::new(0.0, f64::INFINITY)
        };
        self.chain(v, slope)
    }
    fn pow(self, exponent: f64) -> Self {
        let v = self.v.pow(exponent);
        let slope = if self.v.lo > 0.0 {
            Interval::point(exponent).mul(v.div(self.v))
        } else if exponent >= 1.0 {
            Interval::point(exponent).mul(self.v.pow(exponent - 1.0))
        } else {
            Interval::new(0.0, f64::INFINITY)
        };
        self.chain(v, slope.hull(if self.v.lo > 0.0 { slope } else { ZERO }))
    }
    fn sin(self) -> Self {
        let (sin, cos) = self.v.sin_cos();
        self.chain(sin, cos)
    }
    fn cos(self) -> Self {
        let (sin, cos) = self.v.sin_cos();
        self.chain(cos, sin.neg())
    }
    fn min(self, other: Self) -> Self {
        let (a, b) = (self.v.hi < other.v.lo, other.v.hi < self.v.lo);
        self.either(other, self.v.min(other.v), a, b)
    }
    fn max(self, other: Self) -> Self {
        let (a, b) = (self.v.lo > other.v.hi, other.v.lo > self.v.hi);
        self.either(other, self.v.max(other.v), a, b)
    }
    fn hypot(self, other: Self) -> Self {
        let v = Scalar::hypot(self.v, other.v);
        if self.is_constant() && other.is_constant() {
            return Self { v, d: Self::LEVEL };
        }
        let d = self.both(other, |a, b| {
            // A length changes no faster than its vector does, also where it is 0 and has no slope.
            let most = Scalar::hypot(a, b).hi;
            if v.lo > 0.0 {
                let slope = self.v.mul(a).add(other.v.mul(b)).div(v);
                Interval::new(slope.lo.max(-most), slope.hi.min(most))
            } else {
                Interval::new(-most, most)
            }
        });
        Self { v, d }
    }
    fn wrap(self, period: f64, most: f64) -> Self {
        let is_one = cell(self.v.lo, period, most) == cell(self.v.hi, period, most);
        let v = self.v.wrap(period, most);
        // It jumps from cell to cell.
        let d = self
            .d
            .map(|d| if is_one || d == ZERO { d } else { Interval::ALL });
        Self { v, d }
    }
    fn noise(p: [Self; 3]) -> Self {
        let (v, slopes) = noise::bounds(p.map(|x| x.v));
        let mut d = Self::LEVEL;
        for (x, slope) in p.iter().zip(slopes) {
            for (d, along) in d.iter_mut().zip(x.d) {
                if along != ZERO {
                    *d = d.add(slope.mul(along));
                }
            }
        }
        Self { v, d }
    }

    fn add_constant(self, c: f64) -> Self {
        let v = self.v.add(Interval::point(c));
        Self { v, ..self }
    }
    fn sub_constant(self, c: f64) -> Self {
        let v = self.v.sub(Interval::point(c));
        Self { v, ..self }
    }
    fn mul_constant(self, c: f64) -> Self {
        self.chain(self.v.mul(Interval::point(c)), Interval::point(c))
    }
    fn div_constant(self, c: f64) -> Self {
        let c = Interval::point(c);
        let d = self.d.map(|d| if d == ZERO { ZERO } else { d.div(c) });
        Self { v: self.v.div(c), d }
    }
}

/// A value with its gradient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gradient {
    pub(super) v: f64,
    pub(super) d: DVec3,
}

impl Gradient {
    fn chain(self, v: f64, slope: f64) -> Self {
        let d = if self.d == DVec3::ZERO {
            self.d
        } else {
            self.d * slope
        };
        Self { v, d }
    }
}

impl From<f64> for Gradient {
    fn from(x: f64) -> Self {
        Self { v: x, d: DVec3::ZERO }
    }
}

impl Add for Gradient {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            v: self.v + other.v,
            d: self.d + other.d,
        }
    }
}

impl Sub for Gradient {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            v: self.v - other.v,
            d: self.d - other.d,
        }
    }
}

impl Mul for Gradient {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            v: self.v * other.v,
            d: self.d * other.v + other.d * self.v,
        }
    }
}

impl Neg for Gradient {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            v: -self.v,
            d: -self.d,
        }
    }
}

impl Scalar for Gradient {
    fn constant(x: f64) -> Self {
        x.into()
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        let v = self.v / other.v;
        Self {
            v,
            d: (self.d - other.d * v) / other.v,
        }
    }
    fn neg(self) -> Self {
        -self
    }
    fn square(self) -> Self {
        self.chain(self.v * self.v, 2.0 * self.v)
    }
    fn abs(self) -> Self {
        self.chain(self.v.abs(), if self.v < 0.0 { -1.0 } else { 1.0 })
    }
    fn sqrt(self) -> Self {
        let v = Scalar::sqrt(self.v);
        self.chain(v, if v > 0.0 { 0.5 / v } else { 0.0 })
    }
    fn pow(self, exponent: f64) -> Self {
        let v = Scalar::pow(self.v, exponent);
        self.chain(
            v,
            if self.v > 0.0 {
                exponent * (v / self.v)
            } else {
                0.0
            },
        )
    }
    fn sin(self) -> Self {
        self.chain(math::sin(self.v), math::cos(self.v))
    }
    fn cos(self) -> Self {
        self.chain(math::cos(self.v), -math::sin(self.v))
    }
    fn min(self, other: Self) -> Self {
        if self.v <= other.v { self } else { other }
    }
    fn max(self, other: Self) -> Self {
        if self.v >= other.v { self } else { other }
    }
    fn hypot(self, other: Self) -> Self {
        let v = Scalar::hypot(self.v, other.v);
        let d = self.d * self.v + other.d * other.v;
        Self {
            v,
            d: if v > 0.0 { d / v } else { DVec3::ZERO },
        }
    }
    fn wrap(self, period: f64, most: f64) -> Self {
        Self {
            v: Scalar::wrap(self.v, period, most),
            d: self.d,
        }
    }
    fn noise(p: [Self; 3]) -> Self {
        let [x, y, z] = p;
        let (v, d) = noise::gradient(DVec3::new(x.v, y.v, z.v));
        Self {
            v,
            d: x.d * d.x + y.d * d.y + z.d * d.z,
        }
    }
}
