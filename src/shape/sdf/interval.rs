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

    /// As [`Interval::new`], a step larger at both ends.
    fn outwards(lo: f64, hi: f64) -> Self {
        if lo <= hi {
            Self {
                lo: lo.next_down(),
                hi: hi.next_up(),
            }
        } else {
            Self::ALL
        }
    }

    /// As [`Interval::outwards`], by as much as a function of `math` may be off.
    fn of_function(lo: f64, hi: f64) -> Self {
        let slack = |x: f64| 1e-15 * x.abs() + f64::MIN_POSITIVE;
        Self::outwards(lo - slack(lo), hi + slack(hi))
    }

    pub(super) fn hull(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
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

    pub(super) fn mul(self, other: Self) -> Self {
        let products = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        // 0 times infinity: the end stands for numbers without bound, each of which gives 0.
        let products = products.map(|x| if x.is_nan() { 0.0 } else { x });
        let [a, b, c, d] = products;
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
        if quotients.iter().any(|x| x.is_nan()) {
            return Self::ALL;
        }
        let [a, b, c, d] = quotients;
        Self::outwards(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
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
            lo: self.lo.min(other.lo),
            hi: self.hi.min(other.hi),
        }
    }

    pub(super) fn max(self, other: Self) -> Self {
        Self {
            lo: self.lo.max(other.lo),
            hi: self.hi.max(other.hi),
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
        self.wave(math::sin, 0.5 * math::PI)
    }

    pub(super) fn cos(self) -> Self {
        self.wave(math::cos, 0.0)
    }

    /// A wave of length 2 pi with its crest at `crest`.
    fn wave(self, f: fn(f64) -> f64, crest: f64) -> Self {
        const ONE: Interval = Interval { lo: -1.0, hi: 1.0 };
        // Beyond, places of crests are not known well enough.
        if !(self.width() < 2.0 * math::PI && self.lo.abs() < 1e6) {
            return ONE;
        }
        // Crests are met where a whole number of waves lies between, with something added for the rounding of pi.
        let waves = |x: f64, at: f64| (x - at) / (2.0 * math::PI);
        let meets = |at: f64| {
            let (first, last) = (waves(self.lo, at) - 1e-9, waves(self.hi, at) + 1e-9);
            last.floor() >= first.ceil()
        };
        let (a, b) = (f(self.lo), f(self.hi));
        let ends = Self::of_function(a.min(b), a.max(b));
        Self {
            lo: if meets(crest + math::PI) {
                -1.0
            } else {
                ends.lo.max(-1.0)
            },
            hi: if meets(crest) { 1.0 } else { ends.hi.min(1.0) },
        }
    }
}
