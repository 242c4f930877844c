//! Random numbers that depend on where they are used, not on when: a hash of (seed, pixel, sample, dimension).
//!
//! Nothing is drawn from a stream, so neither threads nor the order of tiles can change a picture.

mod net;

use crate::accel::{Exact, Four, Words};

/// The random numbers of one camera sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler {
    key: u64,
    /// The sample's number where the numbers are those of a net over all samples of the pixel.
    in_net: Option<u32>,
}

/// A 64-bit mix in which every input bit reaches every output bit (the finalizer of SplitMix64; Steele, Lea and
/// Flood, "Fast splittable pseudorandom number generators", 2014, with Stafford's variant 13 constants).
pub(crate) const fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// [`mix`] for each of four.
#[inline(always)]
fn mix_four<L: Exact>(x: Words<L>) -> Words<L> {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = x.xor(x.shift::<30>()).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = x.xor(x.shift::<27>()).wrapping_mul(0x94d0_49bb_1331_11eb);
    x.xor(x.shift::<31>())
}

/// What 53 bits are divided by to be a number in [0, 1).
const UNIT: f64 = 1.0 / (1u64 << 53) as f64;

/// A dimension, hashed: of the two hashes behind a random number the one that is the same for all samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hashed(u64);

impl Hashed {
    pub(crate) const fn new(dimension: u64) -> Self {
        Self(mix(dimension))
    }
}

/// The first of two dimensions for a point of the lens; those of a path are below them.
pub(crate) const LENS: u64 = 1 << 63;

/// The dimension for a time.
pub(crate) const TIME: u64 = LENS + 2;

impl Sampler {
    /// The numbers of sample `sample` of the pixel in column `x`, row `y`.
    pub(crate) fn new(seed: u64, x: u32, y: u32, sample: u32) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        Self {
            key: mix(mix(mix(seed) ^ pixel) ^ u64::from(sample)),
            in_net: None,
        }
    }

    /// As [`Sampler::new`], for points of a net in each pair of dimensions 2 i and 2 i + 1.
    pub(crate) fn in_net(seed: u64, x: u32, y: u32, sample: u32) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        Self {
            key: mix(mix(seed) ^ pixel),
            in_net: Some(sample),
        }
    }

    /// The number of a dimension, in [0, 1).
    pub(crate) fn get(&self, dimension: u64) -> f64 {
        if let Some(index) = self.in_net {
            return net::number(self.key, index, dimension);
        }
        (self.bits(dimension) >> 11) as f64 * UNIT
    }

    /// The numbers of a dimension that is even, and of the next: [`Sampler::get`] of both, in a net for less than twice the work.
    pub(crate) fn get_pair(&self, dimension: u64) -> [f64; 2] {
        match self.in_net {
            Some(index) => net::pair(self.key, index, dimension),
            None => [self.get(dimension), self.get(dimension + 1)],
        }
    }

    /// The numbers of four dimensions, whose hashes are known; `None` in a net.
    #[inline(always)]
    pub(crate) fn get_four<L: Exact>(&self, lanes: L, dimensions: &[Hashed; 4]) -> Option<Four<L>> {
        if self.in_net.is_some() {
            return None;
        }
        let [a, b, c, d] = *dimensions;
        let hashed = Words::new(lanes, &[a.0, b.0, c.0, d.0]);
        let bits = mix_four(hashed.xor(Words::splat(lanes, self.key)));
        Some(bits.shift::<11>().to_f64() * UNIT)
    }

    /// 64 random bits for a dimension; in a net the same for all samples of the pixel.
    pub(crate) fn bits(&self, dimension: u64) -> u64 {
        mix(self.key ^ mix(dimension))
    }
}

/// Where `index` comes in an order of the numbers below `count` that is drawn from `key`: each comes once (Kensler,
/// "Correlated multi-jittered sampling", 2013). Rounds of bijections of the next power of two, repeated until the number
/// is below `count`.
pub(crate) fn permuted(index: u32, count: u32, key: u64) -> u32 {
    if count <= 1 {
        return 0;
    }
    let mask = u32::MAX >> (count - 1).leading_zeros();
    let bits = mask.count_ones();
    let mut i = index & mask;
    loop {
        for round in 0..4 {
            let key = mix(key ^ round);
            i = i.wrapping_mul((key as u32) | 1).wrapping_add((key >> 32) as u32) & mask;
            i ^= i >> bits.div_ceil(2);
        }
        if i < count {
            return i;
        }
    }
}

/// Where in the unit square sample `index` of `count` lies: strata of equal area, in rows as square as `count`
/// allows, jittered by two random numbers. A single sample is the center.
#[inline(always)]
pub(crate) fn stratified(index: u32, count: u32, jitter: impl Fn(u64) -> f64) -> (f64, f64) {
    if count <= 1 {
        return (0.5, 0.5);
    }
    in_stratum(index, count, jitter)
}

/// As [`stratified`], for more than one sample.
#[inline(never)]
fn in_stratum(index: u32, count: u32, jitter: impl Fn(u64) -> f64) -> (f64, f64) {
    // `rows` rows share `count` samples as evenly as they can; a row is as high as its share.
    let rows = count.isqrt();
    let (base, longer) = (count / rows, count % rows);
    let in_longer = longer * (base + 1);
    let (column, columns, before) = if index < in_longer {
        let row = index / (base + 1);
        (index % (base + 1), base + 1, row * (base + 1))
    } else {
        let row = (index - in_longer) / base;
        ((index - in_longer) % base, base, in_longer + row * base)
    };
    let (columns, count) = (f64::from(columns), f64::from(count));
    let x = (f64::from(column) + jitter(0)) / columns;
    let y = (f64::from(before) + jitter(1) * columns) / count;
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_have_equal_areas_and_cover_the_square() {
        for count in 2..40 {
            // With jitter 0 and 1 a sample gives the corners of its stratum.
            let mut area = 0.0;
            for index in 0..count {
                let (x0, y0) = stratified(index, count, |_| 0.0);
                let (x1, y1) = stratified(index, count, |_| 1.0);
                assert!((0.0..1.0).contains(&x0) && (0.0..1.0).contains(&y0));
                let own = (x1 - x0) * (y1 - y0);
                assert!((own * f64::from(count) - 1.0).abs() < 1e-12, "{count}: {own}");
                area += own;
            }
            assert!((area - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn an_order_has_each_number_once() {
        let mut orders = std::collections::BTreeSet::new();
        for count in (1..70).chain([255, 256, 257, 1000]) {
            for key in 0..20 {
                let order: Vec<u32> = (0..count).map(|i| permuted(i, count, mix(key))).collect();
                let mut sorted = order.clone();
                sorted.sort_unstable();
                assert!(sorted.into_iter().eq(0..count), "{count}: {order:?}");
                orders.insert(order);
            }
        }
        assert!(orders.len() > 1300, "{}", orders.len());
    }

    #[test]
    fn numbers_are_even_and_apart() {
        let sampler = Sampler::new(7, 1, 2, 3);
        let mean = (0..10_000).map(|d| sampler.get(d)).sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        assert_ne!(sampler.get(0), Sampler::new(7, 2, 1, 3).get(0));
        assert_ne!(sampler.get(0), Sampler::new(8, 1, 2, 3).get(0));
        assert_ne!(sampler.get(0), Sampler::new(7, 1, 2, 4).get(0));
    }
}
