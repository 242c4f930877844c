//! Where the corners of a block's triangles are, and which triangle is meant.

use super::blocks::BLOCK;

/// Where a triangle's three corners are: in the block itself, or by their numbers, which take half of the room here that
/// they take elsewhere if they are small enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corners(u64);

impl Corners {
    /// Bits of a number.
    const BITS: u32 = 21;
    /// Numbers that do not fit are to be looked up. No three that fit have the top bit.
    pub const ELSEWHERE: Self = Self(u64::MAX);
    /// What the block has in f32 are the corners themselves, to the bit: [`Triangles::exact`](super::Triangles::exact).
    pub const HERE: Self = Self(u64::MAX - 1);

    /// Those numbers, or [`Corners::ELSEWHERE`].
    #[must_use]
    pub fn new(corners: [u32; 3]) -> Self {
        if corners.iter().any(|corner| corner >> Self::BITS != 0) {
            return Self::ELSEWHERE;
        }
        let [a, b, c] = corners.map(u64::from);
        Self(a | b << Self::BITS | c << (2 * Self::BITS))
    }

    /// The numbers, where they are here.
    #[inline(always)]
    #[must_use]
    pub fn get(self) -> Option<[u32; 3]> {
        let Self(bits) = self;
        let number = |at: u32| (bits >> (at * Self::BITS)) as u32 & ((1 << Self::BITS) - 1);
        (bits < Self::HERE.0).then(|| [number(0), number(1), number(2)])
    }
}

/// A triangle by its place among all blocks of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot(u32);

impl Spot {
    /// No triangle's.
    pub const NOWHERE: Self = Self(u32::MAX);

    /// A lane of a block, of which there are no more than [`Child`](super::Child) can refer to.
    #[inline(always)]
    #[must_use]
    pub fn new(block: usize, lane: usize) -> Self {
        Self((block * BLOCK + lane) as u32)
    }

    /// The block and the lane.
    #[inline(always)]
    #[must_use]
    pub fn get(self) -> (usize, usize) {
        let Self(at) = self;
        (at as usize / BLOCK, at as usize % BLOCK)
    }

    /// As a number of the same bits, to wait in a register of f32.
    #[inline(always)]
    pub(super) fn to_f32(self) -> f32 {
        f32::from_bits(self.0)
    }

    /// The opposite of [`Spot::to_f32`].
    #[inline(always)]
    pub(super) fn from_f32(bits: f32) -> Self {
        Self(bits.to_bits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::{Triangles, cases, random},
        math::DVec3,
    };

    #[test]
    fn numbers_of_corners_come_back_or_are_looked_up_and_a_block_fills_its_lines() {
        assert_eq!(size_of::<Triangles>(), 3 * 64);
        let most = (1 << Corners::BITS) - 1;
        for corners in [
            [0; 3],
            [most; 3],
            [1, most, 0],
            [most, 0, 7],
            [12_345, 678, most - 9],
        ] {
            assert_eq!(Corners::new(corners).get(), Some(corners));
        }
        for corners in [
            [most + 1, 0, 0],
            [0, most + 1, 0],
            [0, 0, u32::MAX],
            [u32::MAX; 3],
        ] {
            assert_eq!(Corners::new(corners).get(), None);
        }
    }

    #[test]
    fn corners_of_f32_stand_in_the_block_to_the_bit_and_others_are_named() {
        let mut next = random(11);
        let (mut here, mut named) = (0, 0);
        for round in 0..cases(20_000) {
            let scale = [1.0, 1e-12, 1e12, 300.0][round % 4];
            let size = [1e-3, 1.0, 1e-6][round / 4 % 3];
            let mut vector = |k: f64| (DVec3::new(next(), next(), next()) * 2.0 - 1.0) * k;
            let a = vector(scale);
            let mut corners = [a, a + vector(scale * size), a + vector(scale * size)];
            let of_f32 = round % 5 != 0;
            if of_f32 {
                corners = corners.map(|p| p.to_array().map(|x| f64::from(x as f32)).into());
            }
            let mut block = Triangles::EMPTY;
            block.set(1, 7, corners, [3, 4, 5]);
            if block.corners[1] == Corners::HERE {
                here += 1;
                let bits = |p: [f64; 3]| p.map(f64::to_bits);
                let axes = [[0, 1, 2], [1, 2, 0], [2, 0, 1]][round % 3];
                let expected = corners.map(|p| bits(axes.map(|k| p[k])));
                assert_eq!(block.exact(1, axes).map(bits), expected, "{corners:?}");
            } else {
                named += 1;
                assert_eq!(block.corners[1].get(), Some([3, 4, 5]));
            }
            assert!(of_f32 || block.corners[1] != Corners::HERE, "{corners:?}");
        }
        // Of an edge from nearly 0 to somewhere the difference may have no room in f32.
        assert!(here > cases(8_000) && named > cases(2_000), "{here} {named}");
        let mut block = Triangles::EMPTY;
        block.set(
            0,
            1,
            [DVec3::ZERO, DVec3::new(-0.0, 1.0, 0.0), DVec3::X],
            [0, 1, 2],
        );
        assert_ne!(block.corners[0], Corners::HERE, "the sum of 0 and -0 is 0");
        block.set(0, 1, [DVec3::ZERO, DVec3::Y, DVec3::X], [0, 1, 2]);
        assert_eq!(block.corners[0], Corners::HERE);
    }
}
