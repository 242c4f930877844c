//! Packets: up to 64 rays from one point through the tree at once.
//!
//! Rays that leave one point in nearly one direction, as those of neighboring pixels or those towards the samples
//! of an area light do, meet the same nodes and the same leaves. A packet reads these once. At inner nodes the
//! pyramid around all its rays is tested against eight children at once, at leaves eight rays at once against one
//! box, then against one triangle, sphere or box. As with single rays all of this is a conservative filter in f32, and
//! what it lets through is decided in f64, ray by ray: a packet finds what its rays would find alone.
//!
//! (Overbeck, Ramamoorthi and Mark, "Large ray packets for real-time Whitted ray tracing", 2008; Wald, Ize,
//! Kensler, Knoll and Parker, "Ray tracing animated scenes using coherent grid traversal", 2006, for the pyramid.)

mod leaves;
mod pending;
#[cfg(test)]
mod tests;
mod traverse;
mod wide;

use super::boxes::round_up;
use crate::math::{DVec3, Ray, max_abs};
use leaves::Slack;
use wide::Wide;

pub use traverse::{Decide, Place, rays};

/// Most rays of a packet.
pub const PACKET: usize = 64;

/// One number for each ray.
type Row = [f32; PACKET];

/// The bound of a ray that looks for nothing more.
pub const DONE: f32 = f32::NEG_INFINITY;

/// Relative error that a few f32 operations may have added up: 8 units in the last place.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Widest pyramid that is worth it: the range of slopes across the main axis.
const WIDEST: f32 = 0.7;

/// Rays from one point, prepared for the f32 tests of a level.
#[derive(Debug)]
pub struct RayPacket {
    /// Rays in it; the others' bound is [`DONE`].
    len: usize,
    /// The common origin: rounded to nearest, up and down.
    origin: [f32; 3],
    origin_up: [f32; 3],
    origin_down: [f32; 3],
    dir: [Row; 3],
    /// 1 / dir, finite.
    inverse: [Row; 3],
    /// Nothing beyond counts: the distance of what a ray certainly meets, rounded up.
    bound: Row,
    /// The nearest triangle that is certainly hit (a [`Spot`](super::Spot)), and the distance rounded down; infinite
    /// where there is none.
    nearest_spot: Row,
    nearest_low: Row,
    /// Nothing nearer counts as certain.
    t_least: f32,
    /// Nor what lies beyond this share of the bound.
    certain_share: f32,
    /// The primitive that all rays start on.
    skip: u32,
    /// The primitive that each ray starts or ends on.
    own: [u32; PACKET],
    slack: Slack,
    pyramid: Pyramid,
    /// What all rays' directions agree about, by axis.
    signs: [Sign; 3],
}

/// Signs of the rays' directions along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    Positive,
    Negative,
    Mixed,
}

/// The pyramid around all rays: with depth w along the main axis, x and y lie between slope times w.
#[derive(Clone, Copy, Debug, Default)]
struct Pyramid {
    /// The main axis, along which all directions have one sign, and the two across.
    axes: [usize; 3],
    backwards: bool,
    /// Least and greatest slope of both axes across, rounded outwards, for w that counts along +axis.
    slopes: [[f32; 2]; 2],
    /// Whether each slope's line is farthest out at the far plane.
    at_far: [[bool; 2]; 2],
    /// Bounds of t per unit of coordinate along the axis, rounded outwards, with the axis' sign.
    t_least: f32,
    t_most: f32,
}

/// What a packet takes rays from, wherever they are.
pub trait HasRay {
    /// The ray.
    fn ray(&self) -> &Ray;
}

impl HasRay for Ray {
    #[inline(always)]
    fn ray(&self) -> &Ray {
        self
    }
}

/// What a packet is made for.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// Largest coordinate of the level's triangles and spheres.
    pub extent: f64,
    /// Least distance that counts, for every ray.
    pub t_min: f64,
    /// The primitive that the rays start on, or [`NONE`](super::NONE).
    pub skip: u32,
    /// Where they end, if they are followed backwards.
    pub ends: Option<Ends<'a>>,
}

/// Where rays end that lead from one point to one of their own each: shadow rays towards a light, followed backwards. What
/// is decided in f64 is the ray from the end to the light; that the two differ by the rounding of an end is within what the
/// tests allow for.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a> {
    /// Largest coordinate of them all.
    pub extent: f64,
    /// The primitive that each lies on, or [`NONE`](super::NONE).
    pub primitives: &'a [u32],
}

/// What of a way that is followed backwards may hold certain hits: as much as that is left out before its end.
pub const BEFORE_END: f32 = 1e-5;

impl RayPacket {
    /// A packet of no rays, to be filled.
    pub const EMPTY: Self = Self {
        len: 0,
        origin: [0.0; 3],
        origin_up: [0.0; 3],
        origin_down: [0.0; 3],
        dir: [[0.0; PACKET]; 3],
        inverse: [[0.0; PACKET]; 3],
        bound: [DONE; PACKET],
        nearest_spot: [0.0; PACKET],
        nearest_low: [f32::INFINITY; PACKET],
        t_least: 0.0,
        certain_share: 1.0,
        skip: super::NONE,
        own: [super::NONE; PACKET],
        slack: Slack::NONE,
        pyramid: Pyramid {
            axes: [2, 0, 1],
            backwards: false,
            slopes: [[0.0; 2]; 2],
            at_far: [[false; 2]; 2],
            t_least: 0.0,
            t_most: 0.0,
        },
        signs: [Sign::Mixed; 3],
    };

    /// Rays for which nothing counts any more, one bit for each.
    #[must_use]
    pub fn done(&self) -> u64 {
        let bounds = self.bound.iter().enumerate();
        bounds.fold(0, |mask, (i, bound)| mask | u64::from(*bound == DONE) << i)
    }

    /// Lets nothing count beyond `t` for a ray.
    #[inline]
    pub fn lower_bound(&mut self, ray: usize, t: f32) {
        let bound = &mut self.bound[ray & (PACKET - 1)];
        *bound = bound.min(t);
    }

    /// Fills the packet with rays that ask for t up to `bounds`. False where it is not worth it or where numbers
    /// leave the range in which the error bounds hold: one origin, one main direction, sizes within reason.
    #[inline(always)]
    fn fill<W: Wide>(&mut self, w: W, rays: &[impl HasRay], bounds: &[f32], search: &Search<'_>) -> bool {
        let Some(first) = rays.first() else {
            return false;
        };
        if rays.len() > PACKET || bounds.len() != rays.len() || !(search.t_min >= 0.0) {
            return false;
        }
        let Ray { origin, dir } = *first.ray();
        let mut together = true;
        for (i, ray) in rays.iter().enumerate() {
            let ray = ray.ray();
            together &= ray.origin == origin;
            for k in 0..3 {
                self.dir[k][i] = ray.dir[k] as f32;
            }
        }
        let groups = rays.len().div_ceil(W::LANES);
        for i in rays.len()..groups * W::LANES {
            for k in 0..3 {
                self.dir[k][i] = self.dir[k][0];
            }
        }
        self.bound[..rays.len()].copy_from_slice(bounds);
        self.bound[rays.len()..].fill(DONE);
        if !together || !self.place(origin, search) {
            return false;
        }
        self.len = rays.len();
        self.span(w, groups, dir)
    }

    /// Takes note of the origin. False where it or the level is too large or too small.
    #[inline(always)]
    fn place(&mut self, origin: DVec3, search: &Search<'_>) -> bool {
        let ends = search.ends.map_or(0.0, |ends| ends.extent);
        self.origin = origin.to_array().map(|x| x as f32);
        // A whole unit in the last place to either side, where rounding took half of one at the most.
        // Rays that are followed backwards are off by less of their ends' coordinates.
        let ulp = |x: f32| x.abs().max(ends as f32) * f32::EPSILON + f32::MIN_POSITIVE;
        self.origin_up = self.origin.map(|x| x + ulp(x));
        self.origin_down = self.origin.map(|x| x - ulp(x));
        self.t_least = round_up(search.t_min);
        self.skip = search.skip;
        match search.ends {
            None => self.own.fill(search.skip),
            Some(Ends { primitives, .. }) => {
                self.certain_share = 1.0 - BEFORE_END;
                for (own, id) in self.own.iter_mut().zip(primitives) {
                    *own = *id;
                }
            }
        }
        let size = if search.extent == 0.0 {
            1.0
        } else {
            search.extent.max(max_abs(origin)).max(ends)
        };
        self.slack = Slack::new(size as f32 * (1.0 + ROUNDING), 0.0);
        (1e-6..=1e9).contains(&size) && max_abs(origin) <= 1e9
    }

    /// Finds the pyramid. False where the rays go too many ways.
    #[inline(always)]
    fn span<W: Wide>(&mut self, w: W, groups: usize, first: DVec3) -> bool {
        let longest = max_abs(first);
        let main = (0..3).find(|&k| first[k].abs() == longest).unwrap_or(2);
        let across = [(main + 1) % 3, (main + 2) % 3];
        let backwards = first[main] < 0.0;
        let forward = w.splat(if backwards { -1.0 } else { 1.0 });
        let (zero, largest) = (w.splat(0.0), w.splat(f32::MAX));
        let smallest = w.splat(f32::MIN);
        // Least and greatest of: slope, slope, depth, three directions.
        let mut least = [largest; 6];
        let mut most = [smallest; 6];
        let mut sizes = zero;
        let mut sane = true;
        for group in 0..groups {
            // Minus zero becomes zero, so that its inverse has the sign that comparisons find.
            let d = [
                w.add(w.load(&self.dir[0], group), zero),
                w.add(w.load(&self.dir[1], group), zero),
                w.add(w.load(&self.dir[2], group), zero),
            ];
            let mut inverse = d;
            let mut size = zero;
            for k in 0..3 {
                inverse[k] = w.max(w.min(w.div(w.splat(1.0), d[k]), largest), smallest);
                w.store(inverse[k], &mut self.inverse[k], group);
                size = w.add(size, w.max(d[k], w.sub(zero, d[k])));
            }
            let depth = w.mul(d[main], forward);
            let per_depth = w.mul(inverse[main], forward);
            let all = u64::MAX >> (PACKET - W::LANES);
            sane &= w.bits(w.and(w.below(size, w.splat(1e4)), w.below(w.splat(1e-3), depth))) == all;
            sizes = w.max(sizes, size);
            let values = [
                w.mul(d[across[0]], per_depth),
                w.mul(d[across[1]], per_depth),
                per_depth,
                d[0],
                d[1],
                d[2],
            ];
            for i in 0..6 {
                least[i] = w.min(least[i], values[i]);
                most[i] = w.max(most[i], values[i]);
            }
        }
        if !sane {
            return false;
        }
        let (least, most) = (
            [
                w.least(least[0]),
                w.least(least[1]),
                w.least(least[2]),
                w.least(least[3]),
                w.least(least[4]),
                w.least(least[5]),
            ],
            [
                w.most(most[0]),
                w.most(most[1]),
                w.most(most[2]),
                w.most(most[3]),
                w.most(most[4]),
                w.most(most[5]),
            ],
        );
        if most[0] - least[0] > WIDEST || most[1] - least[1] > WIDEST {
            return false;
        }
        self.slack = Slack::new(self.slack.size, w.most(sizes) * (1.0 + ROUNDING));
        self.signs = [0, 1, 2].map(|k| match (least[3 + k] >= 0.0, most[3 + k] < 0.0) {
            (true, _) => Sign::Positive,
            (_, true) => Sign::Negative,
            _ => Sign::Mixed,
        });
        // A product of slope and depth may round either way, so a slope moves away from the rays by as much.
        let out = |x: f32, by: f32| x + x.abs() * by;
        let slopes = [0, 1].map(|i| [out(least[i], -ROUNDING), out(most[i], ROUNDING)]);
        let sign = if backwards { -1.0 } else { 1.0 };
        self.pyramid = Pyramid {
            axes: [main, across[0], across[1]],
            backwards,
            slopes: slopes.map(|s| s.map(|slope| slope * sign)),
            at_far: slopes.map(|[least, most]| [least < 0.0, most >= 0.0]),
            t_least: least[2] * (1.0 - ROUNDING) * sign,
            t_most: most[2] * (1.0 + ROUNDING) * sign,
        };
        true
    }

    /// The largest bound of all rays.
    #[inline(always)]
    fn farthest<W: Wide>(&self, w: W) -> f32 {
        let mut farthest = w.load(&self.bound, 0);
        for group in 1..self.len.div_ceil(W::LANES) {
            farthest = w.max(farthest, w.load(&self.bound, group));
        }
        w.most(farthest)
    }
}
