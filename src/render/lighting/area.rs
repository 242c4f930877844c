//! Points of lights as a surface sees them, several at once.

use super::Path;
use crate::{math::DVec3, scene::Attenuation};

/// Points towards which shadow rays go, looked at together: one array for each number, so that arithmetic is done
/// for several at once, each in the order in which one alone would have it.
pub(super) struct Samples {
    /// How many there are; what is in the lanes after them does not matter.
    pub(super) len: usize,
    /// Unit vectors towards the light.
    pub(super) direction: [Lanes; 3],
    pub(super) distance: Lanes,
    /// Share of the light's color that arrives where nothing is in between.
    pub(super) share: Lanes,
}

/// Enough to keep divisions going; lights of 2 x 2 and 3 x 3 points fill whole ones, or nearly.
pub(super) const LANES: usize = 4;
pub(super) type Lanes = [f64; LANES];

/// As `array::from_fn`, which leaves calls that are too dear here.
#[inline(always)]
pub(super) fn each(mut f: impl FnMut(usize) -> f64) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}

/// [`each`] for three coordinates or channels.
#[inline(always)]
pub(super) fn three(mut f: impl FnMut(usize) -> Lanes) -> [Lanes; 3] {
    let mut all = [[0.0; LANES]; 3];
    for (k, lanes) in all.iter_mut().enumerate() {
        *lanes = f(k);
    }
    all
}

impl Samples {
    /// Points at these offsets from the point that is shaded; a light without end of fall-off `attenuation` is
    /// divided among `cells` such points.
    #[inline(always)]
    pub(super) fn new(len: usize, offset: [Lanes; 3], attenuation: &Attenuation, cells: f64) -> Self {
        let [x, y, z] = &offset;
        let distance = each(|i| (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt());
        Self {
            len,
            direction: three(|k| each(|i| offset[k][i] / distance[i])),
            share: fall_off(attenuation, &distance, cells),
            distance,
        }
    }

    #[inline(always)]
    pub(super) fn towards(&self, i: usize) -> DVec3 {
        DVec3::new(self.direction[0][i], self.direction[1][i], self.direction[2][i])
    }
}

/// `attenuation.at(distance) / cells`; a light that does not fall off needs no division for each point.
#[inline(always)]
fn fall_off(attenuation: &Attenuation, distance: &Lanes, cells: f64) -> Lanes {
    let even = attenuation.linear == 0.0 && attenuation.quadratic == 0.0;
    if even && distance.iter().all(|d| d.is_finite()) {
        [attenuation.at(0.0) / cells; LANES]
    } else {
        each(|i| attenuation.at(distance[i]) / cells)
    }
}

/// A light of n x n cells, one jittered point in each.
pub(super) struct Area {
    pub(super) corner: DVec3,
    pub(super) edges: [DVec3; 2],
    pub(super) n: u32,
    /// Among the lights.
    pub(super) index: u64,
}

impl Area {
    /// Its points from cell `first` on, as seen from `p`.
    pub(super) fn samples(
        &self,
        first: u32,
        p: DVec3,
        attenuation: &Attenuation,
        path: &Path<'_>,
    ) -> Samples {
        let cells = self.n * self.n;
        let (mut a, mut b) = ([0.0; LANES], [0.0; LANES]);
        let len = LANES.min((cells - first) as usize);
        let (mut row, mut column) = (first / self.n, first % self.n);
        for i in 0..len {
            let cell = u64::from(first) + i as u64;
            a[i] = f64::from(column) + path.random(self.index, 2 * cell);
            b[i] = f64::from(row) + path.random(self.index, 2 * cell + 1);
            column += 1;
            if column == self.n {
                (row, column) = (row + 1, 0);
            }
        }
        let n = f64::from(self.n);
        // A division by a power of 2 is a product, to the bit.
        let (a, b) = if self.n.is_power_of_two() {
            (each(|i| a[i] * (1.0 / n)), each(|i| b[i] * (1.0 / n)))
        } else {
            (each(|i| a[i] / n), each(|i| b[i] / n))
        };
        let [edge1, edge2] = self.edges;
        let offset = three(|k| each(|i| self.corner[k] + edge1[k] * a[i] + edge2[k] * b[i] - p[k]));
        Samples::new(len, offset, attenuation, f64::from(cells))
    }

    pub(super) fn corners(&self) -> [DVec3; 4] {
        let [edge1, edge2] = self.edges;
        [
            self.corner,
            self.corner + edge1,
            self.corner + edge1 + edge2,
            self.corner + edge2,
        ]
    }
}
