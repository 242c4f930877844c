//! Noise over space that is the same everywhere: gradient and simplex noise, Worley's cells, and sums of octaves.
//!
//! Everything is a function of the point alone. Lattice points are told apart by an integer hash instead of a table, so
//! that nothing repeats within [`REACH`].

use std::ops::{Add, Mul, Neg, Sub};

use crate::math::DVec3;

/// How far from the origin there is noise, in any component: beyond, an f64 has no digits left for it.
pub const REACH: f64 = 1e9;

/// The most octaves a sum may have: with a lacunarity of 2 the last is finer than any picture shows.
pub const MAX_OCTAVES: u32 = 16;

/// The finalizer of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014):
/// 64 well-mixed bits.
#[must_use]
pub(crate) const fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The hash of no numbers.
const NO_HASH: u64 = 0x6e6f_6973_6500_0000;

/// The hash of some whole numbers and one more, from theirs.
#[inline(always)]
const fn hash_with(hash: u64, c: i64) -> u64 {
    mix(hash ^ c.cast_unsigned().wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Three whole numbers to 64 well-mixed bits.
#[must_use]
pub(crate) fn hash(x: i64, y: i64, z: i64) -> u64 {
    [x, y, z].into_iter().fold(NO_HASH, hash_with)
}

/// The upper bits of a hash as a number in [0, 1).
#[must_use]
pub(crate) fn unit(hash: u64) -> f64 {
    (hash >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// `p`, or the nearest point that has noise; the origin for what is no number.
fn within(p: DVec3) -> DVec3 {
    if p.is_nan() {
        return DVec3::ZERO;
    }
    p.clamp(DVec3::splat(-REACH), DVec3::splat(REACH))
}

/// Gradient noise between -1 and 1, 0 at whole points, hills of about one unit: Perlin's fifth-degree fade and twelve
/// gradients ("Improving noise", SIGGRAPH 2002). Twice differentiable. Beyond [`REACH`] it is that of the nearest point within.
///
/// ```
/// use rtscript::{DVec3, noise::perlin};
/// // Nothing at lattice points, within -1 and 1 between them.
/// assert_eq!(perlin(DVec3::new(1.0, 2.0, 3.0)), 0.0);
/// assert!(perlin(DVec3::new(1.3, 2.1, 3.7)).abs() <= 1.0);
/// ```
#[must_use]
pub fn perlin(p: DVec3) -> f64 {
    let (cell, f) = cell_of(within(p));
    in_cell(cell, f)
}

/// The unit cell that a point is in, by its least corner, and where the point is from there.
#[inline]
pub(crate) fn cell_of(p: DVec3) -> ([i64; 3], [f64; 3]) {
    let [(i, x), (j, y), (k, z)] = p.to_array().map(|p| {
        // `floor` is a call where a program is built for every processor.
        if p.abs() < REACH {
            let towards_zero = p as i64;
            let cell = towards_zero - i64::from(towards_zero as f64 > p);
            // Of minus zero it is zero.
            (cell, p - cell as f64 + 0.0)
        } else {
            let cell = p.floor();
            (cell as i64, p - cell)
        }
    });
    ([i, j, k], [x, y, z])
}

/// What gradient noise needs of a number: a value, or one that knows its gradient.
pub(crate) trait Number:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// One of two numbers, the second where `is_second`, with its sign changed where `is_negative`.
    #[inline(always)]
    fn chosen([first, second]: [Self; 2], is_second: bool, is_negative: bool) -> Self {
        let one = if is_second { second } else { first };
        if is_negative { -one } else { one }
    }
}

impl Number for f64 {
    /// In bits: what depends on a hash cannot be foreseen, so that a branch on it would be taken back every other time.
    #[inline(always)]
    fn chosen(two: [Self; 2], is_second: bool, is_negative: bool) -> Self {
        let [first, second] = two.map(Self::to_bits);
        let mask = u64::from(is_second).wrapping_neg();
        Self::from_bits(first ^ ((first ^ second) & mask) ^ u64::from(is_negative) << 63)
    }
}

/// [`perlin`] in the unit cell with this least corner, at `f` from there.
pub(crate) fn in_cell<T: Number>([i, j, k]: [i64; 3], f: [T; 3]) -> T {
    let number = T::from;
    let fade = f.map(|t| t * t * t * (t * (t * number(6.0) - number(15.0)) + number(10.0)));
    let lerp = |a: T, b: T, t: T| a + (b - a) * t;
    let [left, right] = sides(NO_HASH, i, f[0]).map(|(hash, x)| {
        let [low, high] = sides(hash, j, f[1]);
        [low, high].map(|(hash, y)| {
            let [before, behind] = sides(hash, k, f[2]);
            [
                slope(before.0, [x, y, before.1]),
                slope(behind.0, [x, y, behind.1]),
            ]
        })
    });
    let across = |[low, high]: [[T; 2]; 2]| {
        let [low, high] = [low, high].map(|[left, right]| lerp(left, right, fade[0]));
        lerp(low, high, fade[1])
    };
    let ([[a, b], [c, d]], [[e, f], [g, h]]) = (left, right);
    lerp(across([[a, e], [c, g]]), across([[b, f], [d, h]]), fade[2])
}

/// The two sides of a cell that is at `c` along an axis: their hashes, by that of the coordinates before, which the corners
/// beyond share, and where `f` is from each.
#[inline(always)]
fn sides<T: Number>(hash: u64, c: i64, f: T) -> [(u64, T); 2] {
    [
        (hash_with(hash, c), f - T::from(0.0)),
        (hash_with(hash, c.wrapping_add(1)), f - T::from(1.0)),
    ]
}

/// The dot product of a vector with one of the directions to the middles of a cube's twelve edges.
#[inline(always)]
fn slope<T: Number>(hash: u64, [x, y, z]: [T; 3]) -> T {
    let edge = hash % 12;
    // Across x and y, x and z, y and z.
    T::chosen([x, y], edge >= 8, hash & 1 != 0) + T::chosen([y, z], edge >= 4, hash & 2 != 0)
}

/// Simplex noise between -1 and 1 with the same twelve gradients: less bound to the axes than [`perlin`] (Perlin, "Noise
/// hardware", SIGGRAPH 2001 course; Gustavson, "Simplex noise demystified", 2005). The kernel's radius is the square root of 1/2,
/// with which it is continuous across the faces of the tetrahedra. Beyond [`REACH`] it is that of the nearest point within.
///
/// ```
/// use rtscript::{DVec3, noise::simplex};
/// assert!(simplex(DVec3::new(0.3, 0.1, 0.7)).abs() <= 1.0);
/// ```
#[must_use]
pub fn simplex(p: DVec3) -> f64 {
    let p = within(p);
    // The lattice of cubes squeezed along its diagonal.
    let skew = (p.x + p.y + p.z) / 3.0;
    let cell = (p + DVec3::splat(skew)).floor();
    let unskew = (cell.x + cell.y + cell.z) / 6.0;
    let d0 = p - (cell - DVec3::splat(unskew));
    // The corners in the order in which the components of the offset descend.
    let first = if d0.x >= d0.y && d0.x >= d0.z {
        DVec3::X
    } else if d0.y >= d0.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let last = if d0.z < d0.x && d0.z <= d0.y {
        DVec3::Z
    } else if d0.y < d0.x {
        DVec3::Y
    } else {
        DVec3::X
    };
    let corners = [DVec3::ZERO, first, DVec3::ONE - last, DVec3::ONE];
    let mut sum = 0.0;
    for corner in corners {
        let step = (corner.x + corner.y + corner.z) / 6.0;
        let d = d0 - corner + DVec3::splat(step);
        let near = 0.5 - d.dot(d);
        if near > 0.0 {
            let [i, j, k] = (cell + corner).to_array().map(|c| c as i64);
            let squared = near * near;
            sum += squared * squared * slope(hash(i, j, k), d.to_array());
        }
    }
    // Gustavson's factor for gradients to the middles of edges, which keeps the sum within 1.
    sum * 76.0
}

/// What [`worley`] finds about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worley {
    /// Distance to the nearest feature point.
    pub nearest: f64,
    /// Distance to the second nearest; not below `nearest`.
    pub second: f64,
    /// A number in [0, 1) that the nearest feature point's cell has to itself.
    pub cell: f64,
}

/// Cellular noise (Worley, "A cellular texture basis function", SIGGRAPH 1996): one feature point in each unit cube, moved from
/// the cube's center by `jitter` times a random offset within it, 0 for a lattice and 1 for cells without order; distances are
/// Euclid's. Exact: every cube that may hold a nearer point is looked at. `jitter` is taken within [0, 1]. Beyond [`REACH`] it is
/// that of the nearest point within.
///
/// ```
/// use rtscript::{DVec3, noise::{Worley, worley}};
/// let Worley { nearest, second, cell } = worley(DVec3::new(0.2, 0.4, 0.9), 1.0);
/// assert!(nearest <= second && (0.0..1.0).contains(&cell));
/// ```
#[must_use]
pub fn worley(p: DVec3, jitter: f64) -> Worley {
    let p = within(p);
    let jitter = if jitter.is_nan() {
        1.0
    } else {
        jitter.clamp(0.0, 1.0)
    };
    let home = p.floor();
    let [i, j, k] = home.to_array().map(|c| c as i64);
    let f = p - home;
    // Squares of distances.
    let mut found = Worley {
        nearest: f64::INFINITY,
        second: f64::INFINITY,
        cell: 0.0,
    };
    // How far the point is from a cube `n` cubes away, along one axis.
    let gap = |f: f64, n: i64| match n {
        0 => 0.0,
        n if n < 0 => f + (-n - 1) as f64,
        n => n as f64 - f,
    };
    let mut look = |x: i64, y: i64, z: i64| {
        let gap = DVec3::new(gap(f.x, x), gap(f.y, y), gap(f.z, z));
        if gap.dot(gap) >= found.second {
            return;
        }
        let h = hash(i + x, j + y, k + z);
        let random = [1, 2, 3].map(|n| unit(mix(h ^ n)) - 0.5);
        let offset =
            DVec3::new(x as f64, y as f64, z as f64) + DVec3::splat(0.5) + DVec3::from_array(random) * jitter
                - f;
        let squared = offset.dot(offset);
        if squared < found.nearest {
            found.second = found.nearest;
            found.nearest = squared;
            found.cell = unit(h);
        } else if squared < found.second {
            found.second = squared;
        }
    };
    // The nearest first, so that most of the others are left out by their distance.
    for reach in 0..=2i64 {
        for z in -reach..=reach {
            for y in -reach..=reach {
                for x in -reach..=reach {
                    if x.abs().max(y.abs()).max(z.abs()) == reach {
                        look(x, y, z);
                    }
                }
            }
        }
    }
    found.nearest = found.nearest.sqrt();
    found.second = found.second.sqrt();
    found
}

/// How the octaves of a sum follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// How many, at least 1; no more than [`MAX_OCTAVES`] are added.
    pub count: u32,
    /// Frequency of an octave over that of the one before; 2 in most uses.
    pub lacunarity: f64,
    /// Amplitude of an octave over that of the one before; 0.5 in most uses.
    pub gain: f64,
}

impl Octaves {
    /// `count` octaves, each of twice the frequency and half the amplitude of the one before.
    #[must_use]
    pub const fn new(count: u32) -> Self {
        Self {
            count,
            lacunarity: 2.0,
            gain: 0.5,
        }
    }

    /// The sum of `noise` over the octaves, divided by the sum of their amplitudes.
    fn sum(&self, p: DVec3, noise: impl Fn(DVec3) -> f64) -> f64 {
        let (mut sum, mut whole) = (0.0, 0.0);
        let (mut frequency, mut amplitude) = (1.0, 1.0);
        for octave in 0..self.count.clamp(1, MAX_OCTAVES) {
            // Apart, so that the zeros at whole points do not fall together.
            let offset = DVec3::splat(f64::from(octave) * 17.3);
            sum += amplitude * noise(p * frequency + offset);
            whole += f64::abs(amplitude);
            frequency *= self.lacunarity;
            amplitude *= self.gain;
        }
        sum / whole
    }
}

/// Fractal Brownian motion: octaves of [`perlin`] noise added up and divided by the sum of their amplitudes, so that it lies
/// between -1 and 1 (Musgrave, in Ebert et al., "Texturing and Modeling", 1994).
///
/// ```
/// use rtscript::{DVec3, noise::{Octaves, fbm, perlin}};
/// let p = DVec3::new(0.3, 0.1, 0.7);
/// assert_eq!(fbm(p, Octaves::new(1)), perlin(p));
/// let rough = Octaves { gain: 0.7, ..Octaves::new(6) };
/// assert!(fbm(p, rough).is_finite());
/// ```
#[must_use]
pub fn fbm(p: DVec3, octaves: Octaves) -> f64 {
    octaves.sum(p, perlin)
}

/// Octaves of the absolute value of [`perlin`] noise, between 0 and 1: creases where the noise changes its sign (Perlin, "An
/// image synthesizer", SIGGRAPH 1985).
///
/// ```
/// use rtscript::{DVec3, noise::{Octaves, turbulence}};
/// assert!(turbulence(DVec3::new(0.3, 0.1, 0.7), Octaves::new(4)) >= 0.0);
/// ```
#[must_use]
pub fn turbulence(p: DVec3, octaves: Octaves) -> f64 {
    octaves.sum(p, |p| perlin(p).abs())
}

/// A displacement of each point of space, each component between -1 and 1: [`fbm`] at three places far apart.
///
/// ```
/// use rtscript::{DVec3, noise::{Octaves, displacement}};
/// let p = DVec3::new(0.3, 0.1, 0.7);
/// let veined = p + 0.5 * displacement(p, Octaves::new(4));
/// assert!(veined != p);
/// ```
#[must_use]
pub fn displacement(p: DVec3, octaves: Octaves) -> DVec3 {
    let at = |x: f64, y: f64, z: f64| fbm(p + DVec3::new(x, y, z), octaves);
    DVec3::new(at(0.0, 0.0, 0.0), at(31.4, 15.9, 26.5), at(53.5, 89.7, 93.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> impl Iterator<Item = DVec3> {
        (0..4000).map(|i| DVec3::new(0.371, 0.913, 0.577) * (f64::from(i) * 0.37) - DVec3::splat(300.0))
    }

    #[test]
    fn noise_is_smooth_bounded_and_zero_at_whole_points() {
        let mut extent = (0.0f64, 0.0f64);
        for p in points() {
            let n = perlin(p);
            extent = (extent.0.min(n), extent.1.max(n));
            let step = perlin(p + DVec3::splat(1e-6)) - n;
            assert!(step.abs() < 1e-5, "{p}: {step}");
        }
        assert!(
            extent.0 > -1.0 && extent.0 < -0.6 && extent.1 < 1.0 && extent.1 > 0.6,
            "{extent:?}"
        );
        assert_eq!(perlin(DVec3::new(3.0, -7.0, 12.0)), 0.0);
        assert_ne!(perlin(DVec3::splat(0.5)), perlin(DVec3::splat(256.5)));
    }

    #[test]
    fn cells_are_those_that_floor_finds() {
        let of_floor = |p: f64| (p.floor() as i64, (p - p.floor()).to_bits());
        let sizes = [1e-300, 1e-9, 0.5, 1.0, 3.0, 1e6, REACH, 1e15, 1e18, 1e19, 1e300];
        for x in points().flat_map(|p| p.to_array()).chain([0.0, f64::INFINITY]) {
            for p in sizes
                .map(|size| x * size)
                .into_iter()
                .flat_map(|p| [p, -p, p.round(), -p.round()])
            {
                let (cell, f) = cell_of(DVec3::new(p, 0.0, -0.0));
                let found = (cell[0], f[0].to_bits());
                assert!(found == of_floor(p) || p.is_infinite() && f[0].is_nan(), "{p:e}");
                assert_eq!((&cell[1..], f[1].to_bits(), f[2].to_bits()), (&[0, 0][..], 0, 0));
            }
        }
    }

    /// [`in_cell`] as its formula has it, a corner at a time.
    #[test]
    fn noise_is_the_blend_of_its_corners() {
        for p in points().map(|p| p * 0.9) {
            let (cell, f) = cell_of(p);
            let corner = |c: [i64; 3]| {
                let [i, j, k] = [0, 1, 2].map(|axis| cell[axis] + c[axis]);
                let hash = hash(i, j, k);
                let [x, y, z] = [0, 1, 2].map(|axis| f[axis] - c[axis] as f64);
                let [a, b] = [[x, y], [x, z], [y, z]][(hash % 12 / 4) as usize];
                (if hash & 1 == 0 { a } else { -a }) + (if hash & 2 == 0 { b } else { -b })
            };
            let fade = f.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
            let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
            let along_x = |y, z| lerp(corner([0, y, z]), corner([1, y, z]), fade[0]);
            let along_y = |z| lerp(along_x(0, z), along_x(1, z), fade[1]);
            let blend = lerp(along_y(0), along_y(1), fade[2]);
            assert_eq!(perlin(p).to_bits(), blend.to_bits(), "{p}");
        }
    }

    #[test]
    fn simplex_noise_is_continuous_and_bounded() {
        let mut extent = (0.0f64, 0.0f64);
        let mut before = simplex(DVec3::ZERO);
        // Along a line that crosses many faces of tetrahedra.
        for i in 1..200_000 {
            let p = DVec3::new(0.371, -0.913, 0.577) * (f64::from(i) * 1e-3);
            let n = simplex(p);
            assert!((n - before).abs() < 0.02, "{p}: {n} after {before}");
            before = n;
            extent = (extent.0.min(n), extent.1.max(n));
        }
        assert!(
            extent.0 >= -1.0 && extent.0 < -0.5 && extent.1 <= 1.0 && extent.1 > 0.5,
            "{extent:?}"
        );
    }

    #[test]
    fn cells_are_those_of_a_search_through_all_neighbours() {
        for jitter in [0.0, 0.5, 1.0] {
            for p in points().take(1000) {
                let home = p.floor();
                let mut all = Vec::new();
                for n in 0..343 {
                    let c = home
                        + DVec3::new(
                            f64::from(n % 7 - 3),
                            f64::from(n / 7 % 7 - 3),
                            f64::from(n / 49 - 3),
                        );
                    let [i, j, k] = c.to_array().map(|c| c as i64);
                    let h = hash(i, j, k);
                    let random = [1, 2, 3].map(|n| unit(mix(h ^ n)) - 0.5);
                    let feature = c + DVec3::splat(0.5) + DVec3::from_array(random) * jitter;
                    all.push(((feature - p).length(), unit(h)));
                }
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                let found = worley(p, jitter);
                assert!((found.nearest - all[0].0).abs() < 1e-9, "{p} {jitter}");
                assert!((found.second - all[1].0).abs() < 1e-9, "{p} {jitter}");
                if all[1].0 - all[0].0 > 1e-9 {
                    assert_eq!(found.cell, all[0].1);
                }
            }
        }
    }

    #[test]
    fn sums_of_octaves_keep_their_bounds() {
        for p in points() {
            let octaves = Octaves::new(6);
            assert!(fbm(p, octaves).abs() < 1.0);
            assert!((0.0..1.0).contains(&turbulence(p, octaves)));
            assert_eq!(fbm(p, Octaves::new(1)), perlin(p));
        }
        // No number asks for no noise, and endless sums end.
        assert!(perlin(DVec3::splat(f64::NAN)).is_finite());
        assert!(simplex(DVec3::splat(1e300)).is_finite());
        assert!(
            worley(DVec3::splat(f64::NEG_INFINITY), f64::NAN)
                .nearest
                .is_finite()
        );
        assert!(fbm(DVec3::ONE, Octaves::new(u32::MAX)).is_finite());
    }
}
