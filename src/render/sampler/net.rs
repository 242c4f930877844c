//! Owen-scrambled Sobol points: in every elementary interval as many as there should be, at random places within.
//!
//! Points in two dimensions are padded: each pair of dimensions has the first two of Sobol's sequence, with a shuffled
//! order and a scrambling of its own (Burley, "Practical hash-based Owen scrambling", 2020; Kollig and Keller, "Efficient
//! multidimensional sampling", 2002).

use super::mix;

/// The number in [0, 1) that point `index` has in a dimension; `key` is that of the pixel.
#[cold]
#[inline(never)]
pub(super) fn number(key: u64, index: u32, dimension: u64) -> f64 {
    let point = Point::new(key, index, dimension);
    match dimension & 1 {
        0 => point.first(),
        _ => point.second(),
    }
}

/// The numbers in a dimension that is even and in the next.
#[cold]
#[inline(never)]
pub(super) fn pair(key: u64, index: u32, dimension: u64) -> [f64; 2] {
    let point = Point::new(key, index, dimension);
    [point.first(), point.second()]
}

/// A point in a pair of dimensions.
struct Point {
    /// The hash of pixel and dimensions.
    pair: u64,
    /// Its place in the shuffled order.
    shuffled: u32,
}

impl Point {
    #[inline(always)]
    fn new(key: u64, index: u32, dimension: u64) -> Self {
        let pair = mix(key ^ mix(dimension >> 1));
        Self {
            pair,
            shuffled: scrambled(index.reverse_bits(), pair as u32).reverse_bits(),
        }
    }

    #[inline(always)]
    fn first(&self) -> f64 {
        self.number(0, self.shuffled)
    }

    #[inline(always)]
    fn second(&self) -> f64 {
        self.number(1, second_reversed(self.shuffled))
    }

    #[inline(always)]
    fn number(&self, which: u64, reversed: u32) -> f64 {
        let seed = mix(self.pair ^ which) >> 32;
        f64::from(scrambled(reversed, seed as u32).reverse_bits()) * (1.0 / (1u64 << 32) as f64)
    }
}

/// Sobol's second dimension in 32 bits with the last one first, as the scrambling wants it; of the first dimension that is
/// the number itself. Bit k of the number adds row k of Pascal's triangle modulo 2, which is the product of a factor for each
/// bit of k (Lucas, 1878).
const fn second_reversed(mut x: u32) -> u32 {
    x ^= (x & 0xaaaa_aaaa) >> 1;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^ x >> 16
}

/// Owen's scrambling by a hash of a number whose bits are reversed: each bit is flipped or not, depending on those below it
/// alone, so that points that share an elementary interval go on sharing one (Owen, "Randomly permuted (t,m,s)-nets and
/// (t,s)-sequences", 1995; the hash is that of Laine and Karras, 2011, as Burley has it).
fn scrambled(reversed: u32, seed: u32) -> u32 {
    let mut x = reversed.wrapping_add(seed);
    for factor in [0x6c50_b47c_u32, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(factor);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether each elementary interval of area 1/n holds one of the first n = 2^k points from `first` on, a multiple of n.
    fn is_net(points: &[(f64, f64)]) -> bool {
        let n = points.len();
        let k = n.ilog2();
        (0..=k).all(|across| {
            let (columns, rows) = (1 << across, 1 << (k - across));
            let mut held = vec![0; n];
            for (x, y) in points {
                let (column, row) = ((x * f64::from(columns)) as usize, (y * f64::from(rows)) as usize);
                held[row * columns as usize + column] += 1;
            }
            held.iter().all(|count| *count == 1)
        })
    }

    #[test]
    fn every_power_of_two_of_points_is_a_net() {
        for key in 0..20 {
            let key = mix(key);
            for pair in [0, 1, 5, 1 << 40] {
                for (k, first) in [(0, 0), (3, 0), (4, 16), (6, 64), (8, 0), (8, 256)] {
                    let points: Vec<(f64, f64)> = (first..first + (1 << k))
                        .map(|i| (number(key, i, 2 * pair), number(key, i, 2 * pair + 1)))
                        .collect();
                    assert!(is_net(&points), "2^{k} points from {first}");
                }
            }
        }
        // A test that could not fail would say nothing.
        assert!(!is_net(&[(0.1, 0.1), (0.2, 0.2)]));
    }

    #[test]
    fn pairs_are_the_numbers_of_both_dimensions() {
        for (key, index, dimension) in (0..1000).map(|i| (mix(i), i as u32 % 300, mix(i + 7) >> 20 << 1)) {
            let one_by_one = [dimension, dimension + 1].map(|dimension| number(key, index, dimension));
            assert_eq!(pair(key, index, dimension), one_by_one);
        }
    }

    #[test]
    fn scrambling_flips_bits_by_those_below_them() {
        for seed in [1, 77, 0x8000_0000, u32::MAX] {
            for x in [0, 1, 0x1234_5678, 0xffff_0000] {
                for bit in 0..32 {
                    let flipped = scrambled(x, seed) ^ scrambled(x ^ (1 << bit), seed);
                    assert_eq!(flipped << (31 - bit), 1 << 31, "bit {bit} of {x:x}");
                }
            }
        }
    }

    /// With Sobol's direction numbers, one for each bit.
    #[test]
    fn the_second_dimension_is_sobols() {
        for i in 0..10_000u32 {
            let index = i.wrapping_mul(0x9e37_79b9);
            let (mut direction, mut point) = (1u32 << 31, 0);
            for bit in 0..32 {
                if index >> bit & 1 == 1 {
                    point ^= direction;
                }
                direction ^= direction >> 1;
            }
            assert_eq!(second_reversed(index).reverse_bits(), point, "{index:x}");
        }
    }

    #[test]
    fn pixels_and_dimensions_are_even_and_apart() {
        let mean = |f: &dyn Fn(u64) -> f64| (0..4096).map(f).sum::<f64>() / 4096.0;
        assert!(
            (mean(&|i| number(mix(i), 0, 0)) - 0.5).abs() < 0.02,
            "over pixels"
        );
        assert!((mean(&|i| number(7, 3, i)) - 0.5).abs() < 0.02, "over dimensions");
        let product = mean(&|i| (number(mix(i), 0, 0) - 0.5) * (number(mix(i), 0, 1) - 0.5));
        assert!(product.abs() < 0.005, "{product}");
        let product = mean(&|i| (number(mix(i), 5, 0) - 0.5) * (number(mix(i), 5, 2) - 0.5));
        assert!(product.abs() < 0.005, "{product}");
    }
}
