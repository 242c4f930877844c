//! Four f64 at once, exact: sums, products, quotients and roots are those of one number alone, to the bit, with every set
//! of instructions. So these may decide what a picture shows, where the lanes of f32 may not.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use super::Portable;

/// What a set of instructions has for four f64. A comparison sets all bits of a lane or none.
pub trait Exact: Copy {
    /// Four f64.
    type D4: Copy;
    /// The lanes from memory.
    fn load_f64(self, from: &[f64; 4]) -> Self::D4;
    /// The lanes as an array.
    fn store_f64(self, a: Self::D4) -> [f64; 4];
    /// a + b
    fn add(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// a - b
    fn sub(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// a b
    fn mul(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// a / b
    fn div(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// The square root.
    fn sqrt(self, a: Self::D4) -> Self::D4;
    /// Where a < b; nowhere where either is NaN.
    fn below(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// Where a and b differ, or either is NaN.
    fn differs(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// The bits of both.
    fn and(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// The bits of either.
    fn or(self, a: Self::D4, b: Self::D4) -> Self::D4;
    /// The sign bits, the first lane's in bit 0.
    fn signs(self, a: Self::D4) -> u32;

    /// Four u64.
    type U4: Copy;
    /// The lanes from memory.
    fn load_u64(self, from: &[u64; 4]) -> Self::U4;
    /// The bits in one of the two.
    fn xor(self, a: Self::U4, b: Self::U4) -> Self::U4;
    /// a + b modulo 2^64
    fn add_words(self, a: Self::U4, b: Self::U4) -> Self::U4;
    /// a b modulo 2^64
    fn mul_words(self, a: Self::U4, b: Self::U4) -> Self::U4;
    /// a / 2^N, rounded down.
    fn shift<const N: i32>(self, a: Self::U4) -> Self::U4;
    /// As numbers; all are below 2^53.
    fn to_f64(self, a: Self::U4) -> Self::D4;
}

/// Four u64.
#[derive(Clone, Copy)]
pub struct Words<L: Exact> {
    lanes: L,
    u4: L::U4,
}

impl<L: Exact> Words<L> {
    /// These words.
    #[inline(always)]
    pub fn new(lanes: L, from: &[u64; 4]) -> Self {
        let u4 = lanes.load_u64(from);
        Self { lanes, u4 }
    }

    /// One word in all lanes.
    #[inline(always)]
    pub fn splat(lanes: L, x: u64) -> Self {
        Self::new(lanes, &[x; 4])
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(L, L::U4, L::U4) -> L::U4) -> Self {
        let lanes = self.lanes;
        let u4 = f(lanes, self.u4, other.u4);
        Self { lanes, u4 }
    }

    /// The bits in one of the two.
    #[inline(always)]
    pub fn xor(self, other: Self) -> Self {
        self.with(other, L::xor)
    }

    /// The sums modulo 2^64.
    #[inline(always)]
    pub fn wrapping_add(self, x: u64) -> Self {
        self.with(Self::splat(self.lanes, x), L::add_words)
    }

    /// The products modulo 2^64.
    #[inline(always)]
    pub fn wrapping_mul(self, x: u64) -> Self {
        self.with(Self::splat(self.lanes, x), L::mul_words)
    }

    /// Divided by 2^N, rounded down.
    #[inline(always)]
    pub fn shift<const N: i32>(self) -> Self {
        Self {
            u4: self.lanes.shift::<N>(self.u4),
            ..self
        }
    }

    /// As numbers; all are below 2^53.
    #[inline(always)]
    pub fn to_f64(self) -> Four<L> {
        let lanes = self.lanes;
        let d4 = lanes.to_f64(self.u4);
        Four { lanes, d4 }
    }
}

/// Four f64. Operators work lane by lane.
#[derive(Clone, Copy)]
pub struct Four<L: Exact> {
    lanes: L,
    d4: L::D4,
}

/// Yes or no for each of four lanes.
#[derive(Clone, Copy)]
pub struct Mask<L: Exact>(Four<L>);

impl<L: Exact> Four<L> {
    /// These numbers.
    #[inline(always)]
    pub fn new(lanes: L, from: [f64; 4]) -> Self {
        let d4 = lanes.load_f64(&from);
        Self { lanes, d4 }
    }

    /// One number in all lanes.
    #[inline(always)]
    pub fn splat(lanes: L, x: f64) -> Self {
        Self::new(lanes, [x; 4])
    }

    /// One number in all lanes of another of these.
    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Self::splat(self.lanes, x)
    }

    /// The lanes.
    #[inline(always)]
    pub fn to_array(self) -> [f64; 4] {
        self.lanes.store_f64(self.d4)
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(L, L::D4, L::D4) -> L::D4) -> Self {
        let lanes = self.lanes;
        let d4 = f(lanes, self.d4, other.d4);
        Self { lanes, d4 }
    }

    /// The square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self {
            d4: self.lanes.sqrt(self.d4),
            ..self
        }
    }

    /// The numbers without their signs.
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.with(self.all(f64::from_bits(u64::MAX >> 1)), L::and)
    }

    /// Where this is less than the other; nowhere where either is NaN.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<L> {
        Mask(self.with(other, L::below))
    }

    /// Where this is not the other, or either is NaN.
    #[inline(always)]
    pub fn differs(self, other: Self) -> Mask<L> {
        Mask(self.with(other, L::differs))
    }

    /// Where this is more than the other; nowhere where either is NaN.
    #[inline(always)]
    pub fn above(self, other: Self) -> Mask<L> {
        other.below(self)
    }
}

impl<L: Exact> Mask<L> {
    /// The same answer for all lanes.
    #[inline(always)]
    pub fn all(lanes: L, is_set: bool) -> Self {
        let bits = if is_set { u64::MAX } else { 0 };
        Self(Four::splat(lanes, f64::from_bits(bits)))
    }

    /// Yes for so many lanes, no for those after them.
    #[inline(always)]
    pub fn first(lanes: L, count: usize) -> Self {
        Self(
            Four::new(lanes, [0.0, 1.0, 2.0, 3.0])
                .below(Four::splat(lanes, count as f64))
                .0,
        )
    }

    /// The numbers where this is set, 0 elsewhere.
    #[inline(always)]
    pub fn keep(self, numbers: Four<L>) -> Four<L> {
        self.0.with(numbers, L::and)
    }

    /// One bit for each lane, the first in bit 0.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0.lanes.signs(self.0.d4)
    }
}

impl<L: Exact> BitAnd for Mask<L> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0.with(other.0, L::and))
    }
}

impl<L: Exact> BitOr for Mask<L> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0.with(other.0, L::or))
    }
}

/// An operator between fours, and between a four and one number.
macro_rules! operator {
    ($($operator:ident, $name:ident;)*) => {$(
        impl<L: Exact> $operator for Four<L> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, L::$name)
            }
        }

        impl<L: Exact> $operator<f64> for Four<L> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                self.with(self.all(other), L::$name)
            }
        }
    )*};
}

operator! {
    Add, add;
    Sub, sub;
    Mul, mul;
    Div, div;
}

impl Exact for Portable {
    type D4 = [f64; 4];

    #[inline(always)]
    fn load_f64(self, from: &[f64; 4]) -> Self::D4 {
        *from
    }

    #[inline(always)]
    fn store_f64(self, a: Self::D4) -> [f64; 4] {
        a
    }

    #[inline(always)]
    fn add(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn sub(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn mul(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn div(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| a[i] / b[i])
    }

    #[inline(always)]
    fn sqrt(self, a: Self::D4) -> Self::D4 {
        a.map(f64::sqrt)
    }

    #[inline(always)]
    fn below(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| f64::from_bits(if a[i] < b[i] { u64::MAX } else { 0 }))
    }

    #[inline(always)]
    fn differs(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| f64::from_bits(if a[i] != b[i] { u64::MAX } else { 0 }))
    }

    #[inline(always)]
    fn and(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| f64::from_bits(a[i].to_bits() & b[i].to_bits()))
    }

    #[inline(always)]
    fn or(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        [0, 1, 2, 3].map(|i| f64::from_bits(a[i].to_bits() | b[i].to_bits()))
    }

    #[inline(always)]
    fn signs(self, a: Self::D4) -> u32 {
        (0..4).fold(0, |bits, i| bits | u32::from(a[i].is_sign_negative()) << i)
    }

    type U4 = [u64; 4];

    #[inline(always)]
    fn load_u64(self, from: &[u64; 4]) -> Self::U4 {
        *from
    }

    #[inline(always)]
    fn xor(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        [0, 1, 2, 3].map(|i| a[i] ^ b[i])
    }

    #[inline(always)]
    fn add_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        [0, 1, 2, 3].map(|i| a[i].wrapping_add(b[i]))
    }

    #[inline(always)]
    fn mul_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        [0, 1, 2, 3].map(|i| a[i].wrapping_mul(b[i]))
    }

    #[inline(always)]
    fn shift<const N: i32>(self, a: Self::U4) -> Self::U4 {
        a.map(|x| x >> N)
    }

    #[inline(always)]
    fn to_f64(self, a: Self::U4) -> Self::D4 {
        a.map(|x| x as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Lanes, Simd, Task};

    const A: [f64; 8] = [1.0, -2.5, 0.1, 0.0, -0.0, f64::INFINITY, f64::NAN, 1e300];
    const B: [f64; 8] = [3.0, -2.5, 0.7, 0.0, 1.0, f64::INFINITY, 1.0, 1e-300];

    /// What comes of all operations on four of the numbers: bits, for NaN and -0.
    struct All(usize);

    impl Task for All {
        type Output = (Vec<[u64; 4]>, Vec<u32>);

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let four = |from: &[f64; 8]| Four::new(lanes, [0, 1, 2, 3].map(|i| from[(self.0 + i) % 8]));
            let (a, b) = (four(&A), four(&B));
            // The sign and the bits of a NaN that comes of arithmetic are the processor's.
            let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
            let numbers = [
                a + b,
                a - b,
                a * b,
                a / b,
                a.sqrt(),
                a.abs(),
                a + 0.1,
                a * 3.0,
                a.below(b).keep(b),
                (a.above(b) | a.below(b)).keep(a),
                Mask::all(lanes, true).keep(b),
                Mask::all(lanes, false).keep(b),
            ];
            let masks = [
                a.below(b),
                a.above(b),
                a.below(b) & a.above(b * 0.5),
                a.below(b) | a.above(b * 0.5),
                a.differs(b),
                Mask::first(lanes, self.0 % 5),
                Mask::all(lanes, true),
            ];
            (
                numbers.map(|x| x.to_array().map(bits)).to_vec(),
                masks.map(Mask::bits).to_vec(),
            )
        }
    }

    /// What comes of all operations on words; numbers as bits.
    struct AllOfWords;

    impl Task for AllOfWords {
        type Output = [[u64; 4]; 6];

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let a = Words::new(lanes, &[u64::MAX, 0x9e37_79b9_7f4a_7c15, 1 << 63 | 12_345, 0]);
            let b = Words::new(lanes, &[7, u64::MAX - 1, 0x8000_0001_0000_0003, 99]);
            // What is seen of words is the number of their upper bits, and that of their lower ones.
            let upper = |x: Words<L>| x.shift::<11>().to_f64().to_array().map(f64::to_bits);
            let lower = |x: Words<L>| upper(x.wrapping_mul(1 << 53));
            [
                upper(a.xor(b)),
                upper(a.wrapping_add(0xbf58_476d_1ce4_e5b9)),
                upper(a.wrapping_mul(0xbf58_476d_1ce4_e5b9)),
                lower(b.wrapping_mul(0x94d0_49bb_1331_11eb)),
                upper(b.shift::<31>().xor(a)),
                upper(Words::splat(lanes, u64::MAX)),
            ]
        }
    }

    #[test]
    fn words_are_those_of_plain_arithmetic() {
        let plain = AllOfWords.run(Portable);
        let product = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11;
        assert_eq!(plain[2][1], (product as f64).to_bits());
        assert_eq!(plain[5], [((1u64 << 53) - 1) as f64; 4].map(f64::to_bits));
        for simd in Simd::all() {
            assert_eq!(simd.run(AllOfWords), plain, "{simd:?}");
        }
    }

    #[test]
    fn four_lanes_are_what_one_number_alone_is() {
        for first in 0..8 {
            let plain = All(first).run(Portable);
            let (x, y) = (A[first], B[first]);
            let alone = [x + y, x - y, x * y, x / y, x.sqrt(), x.abs(), x + 0.1, x * 3.0];
            for (found, wanted) in plain.0.iter().zip(alone) {
                assert!(found[0] == wanted.to_bits() || wanted.is_nan(), "{x} {y}");
            }
            assert_eq!(plain.1[0] & 1 == 1, x < y);
            assert_eq!(plain.1[4] & 1 == 1, x != y);
            assert_eq!(plain.1[5], (1 << (first % 5)) - 1);
            assert_eq!(plain.1[6], 0b1111);
            for simd in Simd::all() {
                assert_eq!(simd.run(All(first)), plain, "{simd:?}");
            }
        }
    }
}
