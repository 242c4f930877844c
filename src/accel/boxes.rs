//! Single-precision boxes, rounded outwards, and the node that holds eight of them.

use crate::math::{Bounds3, DVec3, max_abs};

/// An axis-aligned box in f32 that contains the f64 box it was made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box32 {
    /// Smallest corner.
    pub min: [f32; 3],
    /// Largest corner.
    pub max: [f32; 3],
}

impl Box32 {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    /// The box that holds everything.
    pub const EVERYTHING: Self = Self {
        min: [f32::NEG_INFINITY; 3],
        max: [f32::INFINITY; 3],
    };

    /// The smallest f32 box around `bounds` grown by a few rounding errors of its coordinates, so that what
    /// f64 arithmetic puts on the box's face is inside.
    #[inline]
    #[must_use]
    pub fn around(bounds: &Bounds3) -> Self {
        if bounds.is_empty() {
            return Self::EMPTY;
        }
        let slack = 4e-15 * max_abs(bounds.min).max(max_abs(bounds.max));
        Self {
            min: bounds.min.to_array().map(|x| round_down(x - slack)),
            max: bounds.max.to_array().map(|x| round_up(x + slack)),
        }
    }

    /// Smallest box around both.
    #[inline]
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    /// Half its surface; without meaning for the empty box.
    #[inline]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|k| self.max[k] - self.min[k]);
        x * y + y * z + z * x
    }

    /// The size of its largest coordinate; 0 for the empty box.
    #[inline]
    #[must_use]
    pub fn extent(&self) -> f32 {
        if *self == Self::EMPTY {
            return 0.0;
        }
        let coordinates = self.min.into_iter().chain(self.max);
        coordinates.fold(0.0, |extent, x| extent.max(x.abs()))
    }

    /// The same box in f64.
    #[must_use]
    pub fn to_bounds(self) -> Bounds3 {
        let corner = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        Bounds3::new(corner(self.min), corner(self.max))
    }
}

/// Largest f32 that is not above `x`.
#[inline]
#[must_use]
pub fn round_down(x: f64) -> f32 {
    let y = x as f32;
    step(y, -i32::from(f64::from(y) > x))
}

/// Smallest f32 that is not below `x`.
#[inline]
#[must_use]
pub fn round_up(x: f64) -> f32 {
    let y = x as f32;
    step(y, i32::from(f64::from(y) < x))
}

/// The number one place above (1) or below (-1), or the same (0). Never from a zero to the other sign: a zero has the sign
/// of what was rounded to it. Without a branch, because whether there is a step to take is as good as random.
#[inline(always)]
fn step(y: f32, up: i32) -> f32 {
    let bits = y.to_bits() as i32;
    let away_from_zero = bits >> 31 | 1;
    f32::from_bits((bits + up * away_from_zero) as u32)
}

/// Eight child boxes, one array for each of the six planes, and what they lead to.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Planes min x, y, z, max x, y, z of the eight children.
    pub(super) planes: [[f32; 8]; 6],
    /// An empty lane has an empty box, which no ray enters.
    pub(super) children: [Child; 8],
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
        ],
        children: [Child::NOTHING; 8],
    };

    /// Largest size of a coordinate of the boxes; infinite sizes stand for empty boxes.
    pub(super) fn extent(&self) -> f32 {
        let planes = self.planes.as_flattened().iter();
        planes
            .map(|x| x.abs())
            .filter(|x| *x < f32::INFINITY)
            .fold(0.0, f32::max)
    }

    pub(super) fn set(&mut self, lane: usize, bounds: &Box32, child: Child) {
        for k in 0..3 {
            self.planes[k][lane] = bounds.min[k];
            self.planes[k + 3][lane] = bounds.max[k];
        }
        self.children[lane] = child;
    }
}

/// What a leaf holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum LeafKind {
    /// Blocks of triangles.
    Triangles = 0,
    /// Blocks of spheres.
    Spheres = 1,
    /// Blocks of boxes.
    Cuboids = 2,
    /// Places of the primitive order, to be looked at one by one.
    Others = 3,
}

/// A node's index, or a leaf: consecutive blocks or places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(pub(super) u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const KIND_SHIFT: u32 = 29;
    const COUNT_SHIFT: u32 = 27;
    const FIRST: u32 = (1 << Self::COUNT_SHIFT) - 1;
    /// Most blocks or places in a leaf.
    pub(super) const LEAF_MAX: usize = 4;
    /// Most blocks or places in a tree.
    pub(super) const PLACES_MAX: usize = Self::FIRST as usize;
    /// The first node, from which all others are reached.
    pub const ROOT: Self = Self(0);
    /// In an empty lane.
    pub(super) const NOTHING: Self = Self(u32::MAX);

    pub(super) fn node(index: usize) -> Self {
        debug_assert!(index < Self::LEAF as usize);
        Self(index as u32)
    }

    pub(super) fn leaf(kind: LeafKind, first: usize, count: usize) -> Self {
        debug_assert!((1..=Self::LEAF_MAX).contains(&count) && first <= Self::PLACES_MAX);
        Self(
            Self::LEAF
                | (kind as u32) << Self::KIND_SHIFT
                | (count as u32 - 1) << Self::COUNT_SHIFT
                | first as u32,
        )
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// What a leaf holds.
    #[inline(always)]
    #[must_use]
    pub fn kind(self) -> LeafKind {
        match self.0 >> Self::KIND_SHIFT & 3 {
            0 => LeafKind::Triangles,
            1 => LeafKind::Spheres,
            2 => LeafKind::Cuboids,
            _ => LeafKind::Others,
        }
    }

    /// The first block or place that a leaf covers; a leaf that is a block covers no other.
    #[inline(always)]
    #[must_use]
    pub fn first(self) -> usize {
        (self.0 & Self::FIRST) as usize
    }

    /// Blocks, or places of the primitive order, that a leaf covers.
    #[inline(always)]
    #[must_use]
    pub fn range(self) -> std::ops::Range<usize> {
        let first = self.first();
        first..first + (self.0 >> Self::COUNT_SHIFT & 3) as usize + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_never_loses_a_point() {
        for x in [0.1, -0.1, 1.0, 1e15, -3.5e-20, 16_777_217.0, 0.0] {
            assert!(f64::from(round_down(x)) <= x && x <= f64::from(round_up(x)));
        }
        let tiny = f64::from(f32::from_bits(1));
        for x in [
            0.0,
            0.3 * tiny,
            1.0,
            1.0 + 1e-9,
            1.0 - 1e-9,
            1e30,
            f64::from(f32::MAX),
            1e300,
            f64::INFINITY,
        ] {
            for x in [x, -x] {
                let near = x as f32;
                let (down, up) = (
                    if f64::from(near) > x {
                        near.next_down()
                    } else {
                        near
                    },
                    if f64::from(near) < x { near.next_up() } else { near },
                );
                assert_eq!(
                    (round_down(x).to_bits(), round_up(x).to_bits()),
                    (down.to_bits(), up.to_bits())
                );
            }
        }
        assert!(round_down(f64::NAN).is_nan() && round_up(f64::NAN).is_nan());
        let b = Box32::around(&Bounds3::new(DVec3::splat(-1.0), DVec3::splat(1.0)));
        assert!(b.min[0] < -1.0 && b.max[0] > 1.0);
        assert_eq!(Box32::around(&Bounds3::EMPTY), Box32::EMPTY);
    }

    #[test]
    fn children_remember_their_range() {
        let leaf = Child::leaf(LeafKind::Spheres, 12_345, 3);
        assert!(leaf.is_leaf() && !Child(5).is_leaf());
        assert_eq!((leaf.kind(), leaf.range()), (LeafKind::Spheres, 12_345..12_348));
    }
}
