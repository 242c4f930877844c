//! Intervals that hold every value which a calculation in f64 can have (Moore, "Interval Analysis", 1966).
//!
//! Every result is rounded outwards by one step, so it holds the exact values, and as rounding is monotone, those of f64
//! as well. What the functions of [`math`](crate::math) may be off by, less than one unit of the last place, is covered
//! by several steps.

use crate::math;

/// All numbers from `lo` to `hi`; never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) lo: f64,
    pub(super) hi: f64,
}

impl Interval {
    pub(super) const ALL: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    pub(super) fn point(x: f64) -> Self {
        if x.is_nan() {
            Self::ALL
        } else {
            Self { lo: x, hi: x }
        }
    }

    /// From `lo` to `hi`, in this order; everything where either is NaN.
    pub(super) fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::ALL }
    }

    /// As [`Interval::new`], larger at both ends by a step of f64 or two.
    #[inline]
    fn outwards(lo: f64, hi: f64) -> Self {
        // At least a step, which is at most so much of a number; without the branches of `next_up`.
        let step = |x: f64| x.abs() * f64::EPSILON + f64::MIN_POSITIVE;
        Self::new(lo - step(lo), hi + step(hi))
    }

    /// As [`Interval::outwards`], by as much as a function of `math` may be off.
    fn of_function(lo: f64, hi: f64) -> Self {
        let slack = |x: f64| 1e-15 * x.abs() + f64::MIN_POSITIVE;
        Self::outwards(lo - slack(lo), hi + slack(hi))
    }

    pub(super) fn hull(self, other: Self) -> Self {
        Self {
            lo: least(self.lo, other.lo),
            hi: most(self.hi, other.hi),
        }
    }

    pub(super) fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    pub(super) fn width(self) -> f64 {
        self.hi - self.lo
    }

    pub(super) fn add(self, other: Self) -> Self {
        Self::outwards(self.lo + other.lo, self.hi + other.hi)
    }

    pub(super) fn sub(self, other: Self) -> Self {
        Self::outwards(self.lo - other.hi, self.hi - other.lo)
    }

    pub(super) fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }

    #[inline]
    pub(super) fn mul(self, other: Self) -> Self {
        let products = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        let [a, b, c, d] = products;
        if (a + b + c + d).is_nan() {
            return Self::of_endless(products);
        }
        Self::outwards(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
    }

    /// From the products of the ends, some of which are infinite.
    #[cold]
    #[inline(never)]
    fn of_endless(products: [f64; 4]) -> Self {
        // 0 times infinity: the end stands for numbers without bound, each of which gives 0.
        let [a, b, c, d] = products.map(|x| if x.is_nan() { 0.0 } else { x });
        Self::outwards(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }

    pub(super) fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::ALL;
        }
        let quotients = [
            self.lo / other.lo,
            self.lo / other.hi,
            self.hi / other.lo,
            self.hi / other.hi,
        ];
        let [a, b, c, d] = quotients;
        if quotients.iter().any(|x| x.is_nan()) {
            return Self::ALL;
        }
        Self::outwards(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
    }

    pub(super) fn square(self) -> Self {
        let Self { lo, hi } = self.abs();
        Self {
            lo: (lo * lo).next_down().max(0.0),
            hi: (hi * hi).next_up(),
        }
    }

    pub(super) fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self {
                lo: 0.0,
                hi: self.hi.max(-self.lo),
            }
        }
    }

    pub(super) fn min(self, other: Self) -> Self {
        Self {
            lo: least(self.lo, other.lo),
            hi: least(self.hi, other.hi),
        }
    }

    pub(super) fn max(self, other: Self) -> Self {
        Self {
            lo: most(self.lo, other.lo),
            hi: most(self.hi, other.hi),
        }
    }

    /// Of negative numbers 0.
    pub(super) fn sqrt(self) -> Self {
        Self {
            lo: self.lo.max(0.0).sqrt().next_down().max(0.0),
            hi: self.hi.max(0.0).sqrt().next_up(),
        }
    }

    /// `self` to the power of a positive number; of negative numbers 0.
    pub(super) fn pow(self, exponent: f64) -> Self {
        let (lo, hi) = (self.lo.max(0.0), self.hi.max(0.0));
        let raised = Self::of_function(math::pow(lo, exponent), math::pow(hi, exponent));
        Self {
            lo: raised.lo.max(0.0),
            ..raised
        }
    }

    pub(super) fn sin(self) -> Self {
        self.sin_cos().0
    }

    pub(super) fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Sine and cosine, for little more than one of them.
    pub(super) fn sin_cos(self) -> (Self, Self) {
        const ONE: Interval = Interval { lo: -1.0, hi: 1.0 };
        // Beyond, places of crests are not known well enough.
        if !(self.width() < 2.0 * math::PI && self.lo.abs() < 1e6) {
            return (ONE, ONE);
        }
        // In quarters of a wave crests and troughs of both lie at whole numbers. Something is added for the rounding of
        // pi.
        let quarters = |x: f64| x * (2.0 / math::PI);
        let (first, last) = (ceil(quarters(self.lo) - 1e-9), floor(quarters(self.hi) + 1e-9));
        // Whether one of these lies between that is `at` more than a multiple of 4.
        let meets = |at: i64| first + (at - first).rem_euclid(4) <= last;
        let ((sin_lo, cos_lo), (sin_hi, cos_hi)) = (math::sin_cos(self.lo), math::sin_cos(self.hi));
        let wave = |a: f64, b: f64, crest: i64| {
            let ends = Self::of_function(least(a, b), most(a, b));
            Self {
                lo: if meets(crest + 2) {
                    -1.0
                } else {
                    most(ends.lo, -1.0)
                },
                hi: if meets(crest) { 1.0 } else { least(ends.hi, 1.0) },
            }
        };
        (wave(sin_lo, sin_hi, 1), wave(cos_lo, cos_hi, 0))
    }
}

/// The lesser of two numbers that are not NaN, which is a single instruction.
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers that are not NaN.
fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// As `f64::floor`, of numbers that an i64 holds, without a call where the processor has no instruction for it.
pub(super) fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(x < whole as f64)
}

fn ceil(x: f64) -> i64 {
    -floor(-x)
}
