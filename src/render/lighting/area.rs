//! Area lights: their points as a surface sees them, several at once, and the light that comes from there.

use super::{Counts, Gloss, Lamp, Lit, Observer, Path, Tries, together::Together};
use crate::{
    accel::{self, Exact, Four, Lanes, Mask, Task},
    color::Color,
    math::DVec3,
    render::{path::Pairs, world::FewObstacles},
    scene::Attenuation,
};

/// How many points of a light are looked at together.
const LANES: usize = 4;

/// Of each point the unit vector to it, its distance, and the light's share.
type Points = [(DVec3, f64, f64); LANES];

/// The lanes of three channels or coordinates.
type Channels = [[f64; LANES]; 3];

/// Points towards which shadow rays go, looked at together.
#[derive(Clone, Copy)]
pub(super) struct Samples<L: Exact> {
    lanes: L,
    /// How many there are; what is in the lanes after them does not matter.
    pub(super) len: usize,
    /// Ways to the points.
    offset: [Four<L>; 3],
    /// Unit vectors towards the light.
    direction: [Four<L>; 3],
    distance: Four<L>,
    /// Share of the light's color that arrives where nothing is in between.
    share: Four<L>,
}

impl<L: Exact> Samples<L> {
    /// Points at these offsets from the point that is shaded; a light without end of fall-off `attenuation` is
    /// divided among `cells` such points.
    #[inline(always)]
    fn new(lanes: L, len: usize, offset: [Four<L>; 3], attenuation: &Attenuation, cells: f64) -> Self {
        let [x, y, z] = offset;
        let distance = (x * x + y * y + z * z).sqrt();
        Self {
            lanes,
            len,
            direction: [x / distance, y / distance, z / distance],
            share: fall_off(lanes, attenuation, distance, cells),
            offset,
            distance,
        }
    }

    /// The unit vector towards each point, its distance, and the light's share.
    #[inline(always)]
    pub(super) fn each(&self) -> Points {
        let [x, y, z] = three_arrays(self.direction);
        let (distance, share) = (self.distance.to_array(), self.share.to_array());
        std::array::from_fn(|i| (DVec3::new(x[i], y[i], z[i]), distance[i], share[i]))
    }
}

/// `attenuation.at(distance) / cells`; a light that does not fall off needs no division for each point.
#[inline(always)]
fn fall_off<L: Exact>(lanes: L, attenuation: &Attenuation, distance: Four<L>, cells: f64) -> Four<L> {
    let even = attenuation.linear == 0.0 && attenuation.quadratic == 0.0;
    if even && distance.below(Four::splat(lanes, f64::INFINITY)).bits() == ALL {
        Four::splat(lanes, attenuation.at(0.0) / cells)
    } else {
        Four::new(lanes, distance.to_array().map(|d| attenuation.at(d) / cells))
    }
}

/// The lanes of three coordinates or channels. (What maps an array calls a function, which costs more than all of this.)
#[inline(always)]
pub(super) fn three_arrays<L: Exact>([a, b, c]: [Four<L>; 3]) -> Channels {
    [a.to_array(), b.to_array(), c.to_array()]
}

/// The bits of all lanes.
const ALL: u32 = (1 << LANES) - 1;

/// A light of n x n cells, one jittered point in each.
pub(super) struct Area<'l> {
    pub(super) corner: DVec3,
    pub(super) edges: [DVec3; 2],
    pub(super) n: u32,
    /// Among the lights.
    pub(super) index: usize,
    pub(super) color: Color,
    pub(super) attenuation: &'l Attenuation,
    /// What is worked out about it.
    pub(super) lamp: Option<&'l Lamp>,
}

impl Area<'_> {
    /// Its points from cell `first` on, as seen from `p`.
    #[inline(always)]
    fn samples<L: Exact>(&self, lanes: L, first: u32, p: DVec3, path: &Path<'_>) -> Samples<L> {
        let cells = self.n * self.n;
        let len = LANES.min((cells - first) as usize);
        let known = match self.lamp {
            Some(Lamp::Area(cells)) => Some(cells),
            _ => None,
        };
        let pairs = known.map(|cells| &cells.pairs);
        let [a, b] = path.pairs(lanes, pairs, self.index as u64, u64::from(first));
        let place = known.and_then(|cells| cells.places.get(first as usize / LANES));
        let [column, row] = match place {
            Some(place) => *place,
            None => places(self.n, first),
        };
        let (a, b) = (Four::new(lanes, column) + a, Four::new(lanes, row) + b);
        let n = f64::from(self.n);
        // A division by a power of 2 is a product, to the bit.
        let (a, b) = if self.n.is_power_of_two() {
            (a * (1.0 / n), b * (1.0 / n))
        } else {
            (a / n, b / n)
        };
        let offset = [
            self.offset(lanes, [a, b], p, 0),
            self.offset(lanes, [a, b], p, 1),
            self.offset(lanes, [a, b], p, 2),
        ];
        Samples::new(lanes, len, offset, self.attenuation, f64::from(cells))
    }

    /// One coordinate of the ways from `p` to places on it.
    #[inline(always)]
    fn offset<L: Exact>(&self, lanes: L, [a, b]: [Four<L>; 2], p: DVec3, axis: usize) -> Four<L> {
        let [edge1, edge2] = self.edges;
        Four::splat(lanes, self.corner[axis]) + a * edge1[axis] + b * edge2[axis] - p[axis]
    }

    fn corners(&self) -> [DVec3; 4] {
        let [edge1, edge2] = self.edges;
        [
            self.corner,
            self.corner + edge1,
            self.corner + edge1 + edge2,
            self.corner + edge2,
        ]
    }
}

/// What is worked out about the cells of a light once for a picture, unless there are very many.
#[derive(Clone, Debug)]
pub(in crate::render) struct Cells {
    pairs: Pairs,
    /// Columns and rows of four in a row each.
    places: Vec<[[f64; LANES]; 2]>,
}

impl Cells {
    /// Those of the light of this number, n x n.
    pub(super) fn new(light: u64, n: u32) -> Self {
        let pairs = Pairs::new(light, u64::from(n) * u64::from(n));
        let firsts = (0..n * n).step_by(LANES);
        Self {
            places: firsts.take(pairs.fours()).map(|first| places(n, first)).collect(),
            pairs,
        }
    }
}

/// Columns and rows of four cells from cell `first` on, of n x n.
fn places(n: u32, first: u32) -> [[f64; LANES]; 2] {
    let cells = [0, 1, 2, 3].map(|i| first + i);
    [
        cells.map(|cell| f64::from(cell % n)),
        cells.map(|cell| f64::from(cell / n)),
    ]
}

/// Adding what comes from an area light, with whatever instructions there are: arithmetic in f64 gives the same with all of
/// them.
struct AddArea<'t, 'a, O> {
    lit: &'t Lit<'a>,
    sum: &'t mut Color,
    area: &'t Area<'t>,
    path: &'t Path<'t>,
    counts: &'t mut Counts,
    observer: &'t mut O,
}

impl<O: Observer> Task for AddArea<'_, '_, O> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self {
            lit,
            sum,
            area,
            path,
            counts,
            observer,
        } = self;
        let at = lit.at.position;
        let firsts = (0..area.n * area.n).step_by(LANES);
        if let Some(few) = lit.obstacles(area, &mut counts.luck.obstacles) {
            for first in firsts {
                let samples = area.samples(lanes, first, at, path);
                lit.add_samples(sum, area.color, &samples, &few, counts, observer);
            }
            return;
        }
        let mut together = Together::new(lit);
        for first in firsts {
            let samples = area.samples(lanes, first, at, path);
            together.add(sum, area.color, &samples, counts, observer);
        }
        together.finish(sum, observer);
    }
}

impl Lit<'_> {
    /// Adds what comes from an area light to `sum`.
    #[inline(never)]
    pub(super) fn add_area<O: Observer>(
        &self,
        sum: &mut Color,
        area: &Area<'_>,
        path: &Path<'_>,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        accel::run(AddArea {
            lit: self,
            sum,
            area,
            path,
            counts,
            observer,
        });
    }

    /// What may stand before an area light, where that is little.
    fn obstacles(&self, area: &Area<'_>, tries: &mut Tries) -> Option<FewObstacles> {
        // One ray finds out as much.
        if area.n == 1 || !tries.are_worth_one() {
            return None;
        }
        let rays = (area.n * area.n) as usize;
        let few = self.world.obstacles(self.at, self.number, area.corners(), rays);
        tries.remember(few.is_some());
        few
    }

    /// As [`Lit::add`] for each of several points in turn, `color` being the light's and `few` all that may be in between.
    #[inline(always)]
    fn add_samples<L: Exact, O: Observer>(
        &self,
        sum: &mut Color,
        color: Color,
        samples: &Samples<L>,
        few: &FewObstacles,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let lanes = samples.lanes;
        let response = self.respond_to_all(samples);
        let zero = Four::splat(lanes, 0.0);
        let lit = response[0].differs(zero) | response[1].differs(zero) | response[2].differs(zero);
        let lit = lit & Mask::first(lanes, samples.len);
        counts.shadow += u64::from(lit.bits().count_ones());
        let forecast = few.forecast(lanes, &samples.offset);
        let known = forecast.misses | forecast.stops;
        let share = samples.share;
        let arriving = [share * color[0], share * color[1], share * color[2]];
        if O::WATCHES || lit.bits() & !known.bits() != 0 {
            let known = [lit.bits(), forecast.misses.bits(), forecast.stops.bits()];
            let light = [three_arrays(arriving), three_arrays(response)];
            return self.add_one_by_one(sum, few, known, (&samples.each(), &light), observer);
        }
        // To add 0 changes no sum: one that began with 0 is never -0. Nor does a factor of 1 change a product.
        let visible = forecast.misses.keep(Four::splat(lanes, 1.0));
        let [x, y, z] = three_arrays([
            lit.keep(visible * arriving[0] * response[0]),
            lit.keep(visible * arriving[1] * response[1]),
            lit.keep(visible * arriving[2] * response[2]),
        ]);
        for i in 0..LANES {
            *sum += Color::new(x[i], y[i], z[i]);
        }
    }

    /// As [`Lit::add_samples`] where a ray may or may not meet something, or somebody wants to know of each: of those that
    /// are `lit`, it is known which `misses` what there is and which something opaque `stops`.
    #[inline(never)]
    fn add_one_by_one<O: Observer>(
        &self,
        sum: &mut Color,
        few: &FewObstacles,
        [lit, misses, stops]: [u32; 3],
        (points, [arriving, response]): (&Points, &[Channels; 2]),
        observer: &mut O,
    ) {
        let is = |bits: u32, i: usize| bits >> i & 1 == 1;
        for (i, (towards, distance, _)) in points.iter().enumerate().filter(|(i, _)| is(lit, *i)) {
            let at = |[r, g, b]: &Channels| Color::new(r[i], g[i], b[i]);
            let (probe, reach) = self.shadow_ray(*towards, *distance);
            let visible = if is(misses, i) {
                Color::ONE
            } else if is(stops, i) {
                Color::ZERO
            } else {
                self.world.share_through(&probe, reach, Some(few))
            };
            *sum += self.seen((&probe, reach), visible, (at(arriving), at(response)), observer);
        }
    }

    /// As [`Lit::respond`] for each of several points.
    #[inline(always)]
    pub(super) fn respond_to_all<L: Exact>(&self, samples: &Samples<L>) -> [Four<L>; 3] {
        let lanes = samples.lanes;
        if let Some(custom) = self.gloss.custom {
            let colors = samples
                .each()
                .map(|(towards, ..)| self.respond_as(custom, towards));
            return [0, 1, 2].map(|k| Four::new(lanes, colors.map(|color| color[k])));
        }
        let n = self.at.shading_normal;
        let [x, y, z] = samples.direction;
        let cosine = x * n.x + y * n.y + z * n.z;
        let Gloss {
            diffuse,
            specular,
            exponent,
            ..
        } = *self.gloss;
        let zero = Four::splat(lanes, 0.0);
        let is_lit = cosine.above(zero);
        let response = [
            is_lit.keep(cosine * diffuse[0]),
            is_lit.keep(cosine * diffuse[1]),
            is_lit.keep(cosine * diffuse[2]),
        ];
        if specular == Color::ZERO {
            return response;
        }
        // Halfway between light and eye.
        let (x, y, z) = (x + self.to_eye.x, y + self.to_eye.y, z + self.to_eye.z);
        let length = (x * x + y * y + z * z).sqrt();
        let cosine = (x * n.x + y * n.y + z * n.z) / length;
        let is_lit = cosine.above(zero);
        let power = Four::new(lanes, exponent.of_each(&cosine.to_array().map(|x| x.min(1.0))));
        [
            response[0] + is_lit.keep(power * specular[0]),
            response[1] + is_lit.keep(power * specular[1]),
            response[2] + is_lit.keep(power * specular[2]),
        ]
    }
}
