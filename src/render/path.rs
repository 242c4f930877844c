//! Where on a camera sample's tree of rays a point lies, and the random numbers that belong there.

use super::{
    interrupt::Interrupt,
    sampler::{Hashed, Sampler},
};

/// Where on a camera sample's tree of rays a point lies; keys its random numbers.
pub(super) struct Path<'i> {
    sampler: Sampler,
    /// Points shaded before this one in the same sample.
    pub(super) vertex: u64,
    /// Asked where one point may take long.
    pub(super) interrupt: &'i Interrupt<'i>,
}

/// No light has this number.
const SURFACE: u64 = (1 << 18) - 1;

/// Added to the numbers of choices that belong to a whole sample.
const SAMPLE: u64 = 1 << 17;

/// The dimension of a choice. Dimensions 0 and 1 are the pixel's jitter. A light has at most 2 * 256^2 choices.
#[inline(always)]
const fn dimension(vertex: u64, light: u64, cell: u64) -> u64 {
    2 + (vertex << 36 | light << 18 | cell)
}

impl<'i> Path<'i> {
    /// The first point of a sample.
    #[inline(always)]
    pub(super) fn new(sampler: Sampler, interrupt: &'i Interrupt<'i>) -> Self {
        Self {
            sampler,
            vertex: 0,
            interrupt,
        }
    }

    /// A random number in [0, 1) for the `cell`-th choice about light `light` at this point.
    pub(super) fn random(&self, light: u64, cell: u64) -> f64 {
        self.sampler.get(dimension(self.vertex, light, cell))
    }

    /// [`Path::random`] for `N` choices from `first` on about a light, which `choices` were made for; numbers of choices
    /// beyond all there are mean nothing.
    #[inline(always)]
    pub(super) fn randoms<const N: usize>(
        &self,
        choices: Option<&Choices>,
        light: u64,
        first: u64,
    ) -> [f64; N] {
        if let Some(hashed) = choices.and_then(|choices| choices.hashed(self.vertex, first))
            && let Some(numbers) = self.sampler.get_each(hashed)
        {
            return numbers;
        }
        std::array::from_fn(|i| self.random(light, first + i as u64))
    }

    /// As [`Path::random`] for the `cell`-th choice about where rays go on from this point.
    pub(super) fn of_surface(&self, cell: u64) -> f64 {
        self.random(SURFACE, cell)
    }

    /// As [`Path::of_surface`] for a choice that is one and the same for all points of a sample.
    pub(super) fn of_sample(&self, cell: u64) -> f64 {
        self.sampler.get(2 + (SURFACE << 18 | SAMPLE | cell))
    }
}

/// The choices about one light, as far as their numbers can be worked out for all pixels alike: of the first points of
/// samples, where there are not too many.
#[derive(Clone, Debug, Default)]
pub(super) struct Choices {
    hashed: Vec<Hashed>,
    /// How many a point has here, a few more than the light asks for, so that they can be taken several at once.
    at_a_point: usize,
}

impl Choices {
    /// Points of a sample that are prepared for.
    const POINTS: u64 = 3;
    /// Choices of a point beyond which nothing is prepared: all together stay well within the nearest cache.
    const MOST: u64 = 512;
    /// How many may be asked for at once.
    const AT_ONCE: u64 = 8;

    /// The first `count` choices about light `light`.
    pub(super) fn new(light: u64, count: u64) -> Self {
        if count > Self::MOST {
            return Self::default();
        }
        let count = count.next_multiple_of(Self::AT_ONCE);
        let points = 0..Self::POINTS;
        Self {
            hashed: points
                .flat_map(|vertex| (0..count).map(move |cell| Hashed::new(dimension(vertex, light, cell))))
                .collect(),
            at_a_point: count as usize,
        }
    }

    #[inline(always)]
    fn hashed<const N: usize>(&self, vertex: u64, first: u64) -> Option<&[Hashed; N]> {
        let first = self.at_a_point.checked_mul(vertex as usize)? + first as usize;
        self.hashed.get(first..)?.first_chunk()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoHost;

    #[test]
    fn numbers_that_were_prepared_are_those_that_are_asked_for_one_by_one() {
        let interrupt = Interrupt::new(&NoHost);
        for sampler in [Sampler::new(3, 5, 7, 1), Sampler::in_net(3, 5, 7, 1)] {
            for (light, count) in [(0, 8), (1, 128), (2, 18), (7, 512), (0, 513), (3, 2)] {
                let choices = Choices::new(light, count);
                assert_eq!(choices.at_a_point > 0, count <= Choices::MOST);
                let mut path = Path::new(sampler, &interrupt);
                for vertex in 0..5 {
                    path.vertex = vertex;
                    for first in (0..count).step_by(8) {
                        let all: [f64; 8] = path.randoms(Some(&choices), light, first);
                        for (number, i) in all.into_iter().zip(first..count) {
                            assert_eq!(number, path.random(light, i));
                        }
                    }
                }
            }
        }
    }
}
