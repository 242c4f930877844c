//! Real roots, isolated before they are solved.
//!
//! A function's sign at a few points tells between which of them its roots are, and that their number is even
//! where it begins and ends with the same sign, however the numbers round. What is left is to find the points:
//! a polynomial in Bernstein form shows how often it changes its sign, any other function must say within which
//! bounds its slope is.

use crate::spline::Piece;

/// The zero of `f` between `lo` and `hi`, from which `f` rises, or falls where `falling`: Newton's method,
/// with a bisection wherever it leaves the bracket or does not halve its step (Press et al., Numerical
/// Recipes, 9.4). `f` gives value and slope. Ends where a step is below 1e-17, the coordinates being within
/// 1.
pub(super) fn root_between(f: impl Fn(f64) -> (f64, f64), mut lo: f64, mut hi: f64, falling: bool) -> f64 {
    let mut x = 0.5 * (lo + hi);
    let mut last_step = hi - lo;
    // Ten rounds are usual; the bound keeps the loop finite whatever the numbers are.
    for _ in 0..200 {
        let (y, slope) = f(x);
        if y == 0.0 {
            return x;
        }
        if (y < 0.0) == falling {
            hi = x;
        } else {
            lo = x;
        }
        let newton = x - y / slope;
        let good = newton > lo && newton < hi && (newton - x).abs() <= 0.5 * last_step;
        let next = if good { newton } else { 0.5 * (lo + hi) };
        last_step = (next - x).abs();
        if last_step < 1e-17 || !(next > lo && next < hi) {
            return next;
        }
        x = next;
    }
    x
}

/// Halvings after which two roots are one place.
const FINEST: u32 = 48;

/// The same where it matters that the place is found at all: with the square of this width, the value between two roots
/// is still well above what rounding takes.
const COARSEST: u32 = 20;

/// What rounding may add to a coefficient, as a part of the largest.
const ROUNDING: f64 = 1e-14;

/// More parts than this are looked at only for zeros of a high order.
const PLACES: u32 = 400;

/// How far from its place a double zero may be told.
pub(super) const CLUSTER: f64 = 1e-6;

/// The zero of `f` near `u`, if it changes its sign within [`CLUSTER`] of it; else `u` (the Illinois method; Dowell and
/// Jarratt, 1971).
pub(super) fn sharpened(f: impl Fn(f64) -> f64, u: f64) -> f64 {
    let (mut a, mut b) = (u - CLUSTER, u + CLUSTER);
    let (mut at_a, mut at_b) = (f(a), f(b));
    if !(at_a * at_b < 0.0) {
        return u;
    }
    let mut next = u;
    for _ in 0..12 {
        next = (a * at_b - b * at_a) / (at_b - at_a);
        let there = f(next);
        if there == 0.0 {
            break;
        }
        if (there < 0.0) == (at_b < 0.0) {
            at_a *= 0.5;
        } else {
            (a, at_a) = (b, at_b);
        }
        (b, at_b) = (next, there);
    }
    next
}

/// A polynomial on [0, 1] by its `N` Bernstein coefficients, so of degree `N` - 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bernstein<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> Bernstein<N> {
    /// Value and slope at `u` (de Casteljau).
    #[allow(
        clippy::indexing_slicing,
        reason = "indices stay below the N that the loops end at"
    )]
    #[inline]
    pub(super) fn at(&self, u: f64) -> (f64, f64) {
        let mut c = self.0;
        // At the ends, where most pieces are found not to matter, nothing is to be mixed.
        if u == 0.0 {
            return (c[0], (c[1] - c[0]) * (N - 1) as f64);
        }
        if u == 1.0 {
            return (c[N - 1], (c[N - 1] - c[N - 2]) * (N - 1) as f64);
        }
        let mut slope = 0.0;
        for n in (1..N).rev() {
            if n == 1 {
                slope = (c[1] - c[0]) * (N - 1) as f64;
            }
            for k in 0..n {
                c[k] = c[k] * (1.0 - u) + c[k + 1] * u;
            }
        }
        (c[0], slope)
    }

    /// The polynomial on both halves of its interval, each stretched to [0, 1].
    #[allow(
        clippy::indexing_slicing,
        reason = "indices stay below the N that the loops end at"
    )]
    fn halves(&self) -> (Self, Self) {
        let (mut low, mut high) = (self.0, self.0);
        for (i, low) in low.iter_mut().enumerate().skip(1) {
            for k in 0..N - i {
                high[k] = 0.5 * (high[k] + high[k + 1]);
            }
            *low = high[0];
        }
        (Self(low), Self(high))
    }

    /// Where the coefficients change their sign: never less often than the polynomial does (Farin, "Curves and
    /// Surfaces for CAGD", 2002, 5.3).
    fn variations(&self) -> usize {
        let negative = self.0.iter().map(|c| *c < 0.0);
        let next = self.0.iter().skip(1).map(|c| *c < 0.0);
        negative.zip(next).filter(|(a, b)| a != b).count()
    }

    /// Tells `found` every place in [0, 1] where the polynomial changes its sign, in ascending order, and whether
    /// it falls there. Their number is odd exactly where one of the first and the last coefficient is negative.
    pub(super) fn sign_changes(&self, found: &mut impl FnMut(f64, bool)) {
        self.search(0.0, 1.0, FINEST, found);
    }

    /// Tells `found` every place where the polynomial is zero, touches zero or nearly does, some of them twice: within
    /// [`CLUSTER`], but of zeros of a high order, which are many places.
    pub(super) fn zeros(&self, found: &mut impl FnMut(f64)) {
        let largest = self.0.iter().fold(0.0, |a: f64, c| a.max(c.abs()));
        let mut left = PLACES;
        if largest > 0.0 {
            self.touch((0.0, 1.0), COARSEST, ROUNDING * largest, &mut left, found);
        }
    }

    fn touch(
        &self,
        (lo, hi): (f64, f64),
        depth: u32,
        noise: f64,
        left: &mut u32,
        found: &mut impl FnMut(f64),
    ) {
        if self.0.iter().all(|c| *c > noise) || self.0.iter().all(|c| *c < -noise) {
            return;
        }
        *left = left.saturating_sub(1);
        let is_clear = |c: Option<&f64>| c.is_some_and(|c| c.abs() > noise);
        let middle = 0.5 * (lo + hi);
        if self.variations() == 1 && is_clear(self.0.first()) && is_clear(self.0.last()) {
            let falls = self.0.last().is_some_and(|c| *c < 0.0);
            found(lo + (hi - lo) * root_between(|x| self.at(x), 0.0, 1.0, falls));
        } else if depth == 0 || *left == 0 {
            found(middle);
        } else {
            let (low, high) = self.halves();
            low.touch((lo, middle), depth - 1, noise, left, found);
            high.touch((middle, hi), depth - 1, noise, left, found);
        }
    }

    fn search(&self, lo: f64, hi: f64, depth: u32, found: &mut impl FnMut(f64, bool)) {
        let is_negative = |c: Option<&f64>| c.is_some_and(|c| *c < 0.0);
        let (first, last) = (is_negative(self.0.first()), is_negative(self.0.last()));
        match self.variations() {
            0 => {}
            1 => {
                let x = root_between(|x| self.at(x), 0.0, 1.0, last);
                found(lo + (hi - lo) * x, last);
            }
            _ if depth == 0 => {
                if first != last {
                    found(0.5 * (lo + hi), last);
                }
            }
            _ => {
                let (low, high) = self.halves();
                let middle = 0.5 * (lo + hi);
                low.search(lo, middle, depth - 1, found);
                high.search(middle, hi, depth - 1, found);
            }
        }
    }
}

/// The product of two polynomials in Bernstein form, of degree `L` - 1 = (`M` - 1) + (`N` - 1).
#[allow(
    clippy::indexing_slicing,
    reason = "i + j is below L, of which the assertion is part of the type"
)]
pub(super) fn product<const M: usize, const N: usize, const L: usize>(
    a: &Bernstein<M>,
    b: &Bernstein<N>,
) -> Bernstein<L> {
    const { assert!(M + N == L + 1) }
    let mut c = [0.0; L];
    for (i, x) in a.0.iter().enumerate() {
        for (j, y) in b.0.iter().enumerate() {
            c[i + j] += CHOOSE[M - 1][i] * CHOOSE[N - 1][j] / CHOOSE[L - 1][i + j] * (x * y);
        }
    }
    Bernstein(c)
}

/// The derivative of a polynomial, which has one coefficient less.
#[allow(
    clippy::indexing_slicing,
    reason = "k + 1 is below M, of which the assertion is part of the type"
)]
pub(super) fn derivative<const M: usize, const N: usize>(a: &Bernstein<M>) -> Bernstein<N> {
    const { assert!(M == N + 1) }
    Bernstein(std::array::from_fn(|k| (a.0[k + 1] - a.0[k]) * (M - 1) as f64))
}

/// A cubic on the part of its interval from `lo` to `hi`, stretched to [0, 1] (by its blossom; Farin, 2002, 4.4).
#[inline]
pub(super) fn cubic_between(c: &[f64; 4], lo: f64, hi: f64) -> [f64; 4] {
    if lo == 0.0 && hi == 1.0 {
        return *c;
    }
    let mix = |a: f64, b: f64, u: f64| a * (1.0 - u) + b * u;
    let blossom = |u: f64, v: f64, w: f64| {
        let [a, b, c, d] = *c;
        let (ab, bc, cd) = (mix(a, b, u), mix(b, c, u), mix(c, d, u));
        mix(mix(ab, bc, v), mix(bc, cd, v), w)
    };
    [
        blossom(lo, lo, lo),
        blossom(lo, lo, hi),
        blossom(lo, hi, hi),
        blossom(hi, hi, hi),
    ]
}

/// From the least to the greatest of some numbers.
pub(super) fn hull(numbers: &[f64]) -> Range {
    let (lo, hi) = (f64::INFINITY, f64::NEG_INFINITY);
    numbers
        .iter()
        .fold((lo, hi), |(lo, hi), x| (lo.min(*x), hi.max(*x)))
}

/// From the least to the greatest slope of a cubic over an interval of length `width` on which it has these
/// coefficients.
pub(super) fn slopes([a, b, c, d]: &[f64; 4], width: f64) -> Range {
    let (lo, hi) = hull(&[b - a, c - b, d - c]);
    (3.0 / width * lo, 3.0 / width * hi)
}

/// All products of a number of `a` and one of `b`.
pub(super) fn times(a: Range, b: Range) -> Range {
    let products = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    if products.iter().any(|x| x.is_nan()) {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    hull(&products)
}

/// Where in [0, 1] the sum of `signs[k] * (piece[k] - target[k])^2` is least.
pub(super) fn nearest<const N: usize>(piece: &Piece<N>, target: [f64; N], signs: [f64; N]) -> f64 {
    let mut sum = Bernstein([0.0; 7]);
    for (k, (x, sign)) in target.into_iter().zip(signs).enumerate() {
        let off = Bernstein(piece.coordinate(k).map(|c| c - x));
        let square: Bernstein<7> = product(&off, &off);
        sum.0
            .iter_mut()
            .zip(square.0)
            .for_each(|(sum, c)| *sum += sign * c);
    }
    let value = |u: f64| {
        let off = piece.position(u).into_iter().zip(target).zip(signs);
        off.map(|((p, x), sign)| sign * (p - x) * (p - x)).sum::<f64>()
    };
    let (mut best, mut least) = (0.0, value(0.0));
    let mut offer = |u: f64| {
        let there = value(u);
        if there < least {
            (best, least) = (u, there);
        }
    };
    offer(1.0);
    let slope: Bernstein<6> = derivative(&sum);
    slope.zeros(&mut offer);
    best
}

/// The highest degree that a product may have.
const DEGREE: usize = 10;

/// Binomial coefficients: `CHOOSE[n][k]` is n over k.
#[allow(
    clippy::indexing_slicing,
    reason = "n and k are at most the degree, and it runs when compiled"
)]
const CHOOSE: [[f64; DEGREE + 1]; DEGREE + 1] = {
    let mut rows = [[0.0; DEGREE + 1]; DEGREE + 1];
    let mut n = 0;
    while n <= DEGREE {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + rows[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    rows
};

/// From `.0` to `.1`, both included.
pub(super) type Range = (f64, f64);

/// A continuous function of one number that can bound itself.
pub(super) trait Bounded {
    /// Value and slope at `x`. Equal bits for equal `x`.
    fn at(&self, x: f64) -> (f64, f64);

    /// Between what its values and its slopes are from `lo` to `hi`; too wide is right, and NaN stands for
    /// anything.
    fn within(&self, lo: f64, hi: f64) -> (Range, Range);
}

/// Tells `found` every place between `lo` and `hi` where `f` changes its sign, in ascending order, and whether it
/// falls there. Where it cannot be without a root, `f` is halved until it rises or falls throughout (interval
/// Newton; Moore, "Interval Analysis", 1966). Their number is odd exactly where `f` is negative at one end only.
pub(super) fn sign_changes(f: &impl Bounded, lo: f64, hi: f64, found: &mut impl FnMut(f64, bool)) {
    let (first, last) = (f.at(lo).0 < 0.0, f.at(hi).0 < 0.0);
    let mut search = Search {
        f,
        found,
        left: INTERVALS,
    };
    search.between((lo, first), (hi, last), FINEST);
}

/// As [`sign_changes`], of a function that is bent to one side throughout, so that it has two zeros at most; `middle` is
/// halfway between them, if there are two.
pub(super) fn sign_changes_of_bent(
    f: &impl Bounded,
    lo: f64,
    hi: f64,
    middle: f64,
    found: &mut impl FnMut(f64),
) {
    let (first, last) = (f.at(lo).0 < 0.0, f.at(hi).0 < 0.0);
    if first != last {
        found(root_between(|x| f.at(x), lo, hi, last));
    } else if lo < middle && middle < hi {
        let there = f.at(middle).0 < 0.0;
        if there != first {
            found(root_between(|x| f.at(x), lo, middle, there));
            found(root_between(|x| f.at(x), middle, hi, last));
        }
    }
}

/// More intervals than this are looked at only where a function is zero along a part of its way but for rounding.
const INTERVALS: u32 = 1000;

/// What rounding makes of 0, in the numbers of shapes of a size of 1.
const NOISE: f64 = 4e-16;

struct Search<'a, F, G> {
    f: &'a F,
    found: &'a mut G,
    left: u32,
}

impl<F: Bounded, G: FnMut(f64, bool)> Search<'_, F, G> {
    fn between(&mut self, (lo, first): (f64, bool), (hi, last): (f64, bool), depth: u32) {
        let ((least, most), (slowest, fastest)) = self.f.within(lo, hi);
        if first == last && (least > 0.0 || most < 0.0 || slowest > 0.0 || fastest < 0.0) {
            return;
        }
        let is_monotone = slowest >= 0.0 || fastest <= 0.0;
        let is_nothing = least.abs().max(most.abs()) <= NOISE;
        self.left = self.left.saturating_sub(1);
        if first != last && is_monotone || is_nothing || depth == 0 || self.left == 0 {
            if first != last {
                (self.found)(root_between(|x| self.f.at(x), lo, hi, last), last);
            }
            return;
        }
        let middle = 0.5 * (lo + hi);
        let (y, _) = self.f.at(middle);
        // No value is farther from that in the middle than the steepest slope leads.
        let reach = if slowest <= fastest {
            slowest.abs().max(fastest.abs()) * (0.5 * (hi - lo))
        } else {
            f64::INFINITY
        };
        if first == last && y.abs() > reach {
            return;
        }
        let there = y < 0.0;
        self.between((lo, first), (middle, there), depth - 1);
        self.between((middle, there), (hi, last), depth - 1);
    }
}

#[cfg(test)]
mod tests;
