//! Values made of the fuzzer's bytes. Each choice takes its bytes from the front, so that a mutation of one byte changes
//! one choice, and where they end everything is 0.

use rtscript::DVec3;

/// Numbers where code that was not thought through breaks.
pub const EDGES: [f64; 32] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    1e-3,
    1e-7,
    1e-15,
    1e-150,
    5e-324,
    f64::MIN_POSITIVE,
    1e3,
    1e6,
    1e15,
    1.000_000_000_1e15,
    1e18,
    1e38,
    1e150,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    f64::EPSILON,
    1.0 - f64::EPSILON,
    180.0,
    90.0,
    360.0,
    4_294_967_296.0,
    9_007_199_254_740_993.0,
    0.1,
];

/// The bytes that are left.
#[derive(Debug)]
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    #[must_use]
    pub fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    /// Whether none are left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap_or((&0, &[]));
        self.0 = rest;
        *first
    }

    /// One of `n`, at most 256.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n.max(1)
    }

    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    pub fn bits(&mut self) -> u64 {
        (0..8).fold(0, |bits, _| bits << 8 | u64::from(self.byte()))
    }

    /// Mostly a small number of a coarse grid, for scenes in which things meet; else an edge, else any bits.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            b @ 0..=207 => (f64::from(b) - 100.0) / 16.0,
            b @ 208..=247 => EDGES[usize::from(b) % EDGES.len()],
            _ => f64::from_bits(self.bits()),
        }
    }

    /// A number that a color, a size or a radius may be, most of the time.
    pub fn positive(&mut self) -> f64 {
        match self.byte() {
            b @ 0..=223 => f64::from(b) / 64.0,
            _ => self.number(),
        }
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub fn color(&mut self) -> DVec3 {
        match self.byte() {
            b @ 0..=239 => DVec3::new(
                f64::from(b & 7) / 6.0,
                f64::from(b >> 3 & 7) / 6.0,
                f64::from(b >> 6) / 2.0,
            ),
            _ => self.vector(),
        }
    }
}
