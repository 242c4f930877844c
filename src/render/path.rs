//! Where on a camera sample's tree of rays a point lies, and the random numbers that belong there.

use super::{
    interrupt::Interrupt,
    lighting::Known,
    sampler::{Hashed, Sampler},
};
use crate::accel::{Exact, Four};

/// Where on a camera sample's tree of rays a point lies; keys its random numbers.
pub(super) struct Path<'i> {
    sampler: Sampler,
    /// Points shaded before this one in the same sample.
    pub(super) vertex: u64,
    /// What is known beforehand of the lights there.
    pub(super) known: Known<'i>,
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
            known: Known::default(),
            interrupt,
        }
    }

    /// A random number in [0, 1) for the `cell`-th choice about light `light` at this point.
    pub(super) fn random(&self, light: u64, cell: u64) -> f64 {
        self.sampler.get(dimension(self.vertex, light, cell))
    }

    /// [`Path::random`] for choices `2 cell` and `2 cell + 1`.
    pub(super) fn random_pair(&self, light: u64, cell: u64) -> [f64; 2] {
        self.sampler.get_pair(dimension(self.vertex, light, 2 * cell))
    }

    /// Two numbers for each of four cells of a light from cell `first` on, a multiple of four: [`Path::random`] for choices
    /// `2 cell` and `2 cell + 1`. What is prepared of the light's cells is in `pairs`.
    #[inline(always)]
    pub(super) fn pairs<L: Exact>(
        &self,
        lanes: L,
        pairs: Option<&Pairs>,
        light: u64,
        first: u64,
    ) -> [Four<L>; 2] {
        if let Some([a, b]) = pairs.and_then(|pairs| pairs.hashed(self.vertex, first))
            && let (Some(a), Some(b)) = (self.sampler.get_four(lanes, a), self.sampler.get_four(lanes, b))
        {
            return [a, b];
        }
        let numbers = self.pairs_one_by_one(light, first);
        [Four::new(lanes, numbers[0]), Four::new(lanes, numbers[1])]
    }

    #[inline(never)]
    fn pairs_one_by_one(&self, light: u64, first: u64) -> [[f64; 4]; 2] {
        let pair = |i: u64| self.random_pair(light, first + i);
        let [[a, b], [c, d], [e, f], [g, h]] = [0, 1, 2, 3].map(pair);
        [[a, c, e, g], [b, d, f, h]]
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

/// The choices about the cells of one light, as far as their numbers can be worked out for all pixels alike: for the first
/// points of samples, where there are not too many.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    /// Of four cells in a row each.
    hashed: Vec<[[Hashed; 4]; 2]>,
    /// Fours of one point of a sample.
    fours: usize,
}

impl Pairs {
    /// Points of a sample that are prepared for.
    const POINTS: u64 = 3;
    /// Cells beyond which nothing is prepared: all together stay well within the nearest cache.
    const MOST: u64 = 256;

    /// For so many cells of light `light`.
    pub(super) fn new(light: u64, cells: u64) -> Self {
        if cells > Self::MOST {
            return Self::default();
        }
        let fours = cells.div_ceil(4);
        let of_four = |vertex: u64, first: u64| {
            let hashed = |k| move |i: u64| Hashed::new(dimension(vertex, light, 2 * (first + i) + k));
            [[0, 1, 2, 3].map(hashed(0)), [0, 1, 2, 3].map(hashed(1))]
        };
        Self {
            hashed: (0..Self::POINTS)
                .flat_map(|vertex| (0..fours).map(move |four| of_four(vertex, 4 * four)))
                .collect(),
            fours: fours as usize,
        }
    }

    /// How many fours of cells are prepared for.
    pub(super) fn fours(&self) -> usize {
        self.fours
    }

    #[inline(always)]
    fn hashed(&self, vertex: u64, first: u64) -> Option<&[[Hashed; 4]; 2]> {
        self.hashed.get(self.fours * vertex as usize + first as usize / 4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        NoHost,
        accel::{self, Lanes, Task},
    };

    #[test]
    fn numbers_that_were_prepared_are_those_that_are_asked_for_one_by_one() {
        let interrupt = Interrupt::new(&NoHost);
        for sampler in [Sampler::new(3, 5, 7, 1), Sampler::in_net(3, 5, 7, 1)] {
            for (light, cells) in [(0, 4), (1, 64), (2, 9), (7, 256), (0, 257), (3, 1)] {
                let pairs = Pairs::new(light, cells);
                assert_eq!(pairs.fours > 0, cells <= Pairs::MOST);
                let mut path = Path::new(sampler, &interrupt);
                for vertex in 0..5 {
                    path.vertex = vertex;
                    for first in (0..cells).step_by(4) {
                        let [a, b] = accel::run(Asked(&path, &pairs, light, first));
                        for (i, cell) in (first..cells).take(4).enumerate() {
                            assert_eq!(a[i], path.random(light, 2 * cell));
                            assert_eq!(b[i], path.random(light, 2 * cell + 1));
                        }
                    }
                }
            }
        }
    }

    struct Asked<'t>(&'t Path<'t>, &'t Pairs, u64, u64);

    impl Task for Asked<'_> {
        type Output = [[f64; 4]; 2];

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let Self(path, pairs, light, first) = self;
            path.pairs(lanes, Some(pairs), light, first)
                .map(|four| four.to_array())
        }
    }
}
