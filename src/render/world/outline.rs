//! Obstacles as the rays from one point to an area see them: which rays certainly meet them and which certainly do not,
//! for several rays at once and without a division. Between the two there is room for far more than rounding; what falls
//! there is left to the crossings themselves, so no answer depends on what is found here.

use super::level::{Level, Primitive};
use crate::{
    accel::{Exact, Four, Mask},
    math::{DAffine3, DMat3, DVec3, max_abs},
    shape::Shape,
};

/// Room for rounding, as a share of the size of the numbers: some 1e6 times what rounding does.
const SLACK: f64 = 1e-9;

/// Shadow rays look as far as this part of the way to a light, or farther: [`crate::render::lighting::SHORT`].
const REACH: f64 = 1.0 - 1e-6;

/// Numbers whose squares and products are far from the ends of what numbers can be.
fn is_ordinary(x: f64) -> bool {
    x > 1e-60 && x < 1e60
}

/// An obstacle, seen from a point outside of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Outline {
    /// Nothing is certain.
    #[default]
    Unknown,
    Ball(Ball),
    Cuboid(Cuboid),
}

/// A ball around `center`, which counts from the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    center: DVec3,
    distance2: f64,
    radius2: f64,
}

/// A box, in its own space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuboid {
    object_from_level: DMat3,
    /// The point.
    apex: DVec3,
    half: DVec3,
    /// Room for rounding of coordinates, and of products of two.
    slack: [f64; 2],
}

/// What is known of four rays.
#[derive(Clone, Copy)]
pub(crate) struct Forecast<L: Exact> {
    /// They meet nothing.
    pub(crate) misses: Mask<L>,
    /// They meet something opaque.
    pub(crate) stops: Mask<L>,
}

impl<L: Exact> Forecast<L> {
    /// Where there is nothing to meet.
    #[inline(always)]
    pub(super) fn clear(lanes: L) -> Self {
        Self {
            misses: Mask::all(lanes, true),
            stops: Mask::all(lanes, false),
        }
    }

    /// What is known with another obstacle, which is opaque or not.
    #[inline(always)]
    pub(super) fn and(self, lanes: L, (misses, meets): (Mask<L>, Mask<L>), is_opaque: bool) -> Self {
        Self {
            misses: self.misses & misses,
            stops: self.stops | (meets & Mask::all(lanes, is_opaque)),
        }
    }
}

impl Outline {
    /// The outline of a primitive as rays see it that go from `apex`, which does not lie on it, to points within
    /// `corners`. `scale` is the size of the numbers that `apex` was computed from.
    pub(super) fn new(level: &Level, index: u32, apex: DVec3, scale: f64, corners: &[DVec3; 4]) -> Self {
        let size = corners.iter().fold(scale.max(max_abs(apex)), |size, corner| {
            size.max(max_abs(*corner))
        });
        match level.primitive(index) {
            Primitive::Sphere(i) => level
                .spheres
                .get(i as usize)
                .and_then(|sphere| Ball::new(sphere.center, sphere.radius, apex, size))
                .map_or(Self::Unknown, Self::Ball),
            Primitive::Shape(i) => level
                .shapes
                .get(i as usize)
                .and_then(|placed| match &placed.shape {
                    Shape::Cuboid(cuboid) => {
                        Cuboid::new(cuboid.half(), &placed.object_from_level, apex, size)
                    }
                    _ => None,
                })
                .map_or(Self::Unknown, Self::Cuboid),
            Primitive::Triangle(_) | Primitive::Instance(_) => Self::Unknown,
        }
    }

    /// Which rays certainly miss the obstacle and which certainly meet it, `ways` being those from the point to the ends
    /// of the rays.
    #[inline(always)]
    pub(super) fn look<L: Exact>(&self, lanes: L, ways: &[Four<L>; 3]) -> (Mask<L>, Mask<L>) {
        match self {
            Self::Unknown => (Mask::all(lanes, false), Mask::all(lanes, false)),
            Self::Ball(ball) => ball.look(lanes, ways),
            Self::Cuboid(cuboid) => cuboid.look(lanes, ways),
        }
    }
}

impl Ball {
    fn new(center: DVec3, radius: f64, apex: DVec3, size: f64) -> Option<Self> {
        let center = center - apex;
        let distance = center.length();
        let room = 1e-6 * (size + distance + radius);
        let is_fit = is_ordinary(distance) && is_ordinary(radius) && distance - radius > room;
        is_fit.then_some(Self {
            center,
            distance2: distance * distance,
            radius2: radius * radius,
        })
    }

    /// By the distance between the ball's center and the line, times the length of the way.
    #[inline(always)]
    fn look<L: Exact>(&self, lanes: L, &[x, y, z]: &[Four<L>; 3]) -> (Mask<L>, Mask<L>) {
        let c = self.center;
        let length2 = x * x + y * y + z * z;
        let along = x * c.x + y * c.y + z * c.z;
        let aside2 = length2 * self.distance2 - along * along;
        let slack = SLACK * self.distance2;
        let zero = Four::splat(lanes, 0.0);
        let misses = along.below(zero) | aside2.above(length2 * (self.radius2 + slack));
        let meets =
            along.above(zero) & aside2.below(length2 * (self.radius2 - slack)) & along.below(length2 * REACH);
        (misses, meets)
    }
}

impl Cuboid {
    fn new(half: DVec3, object_from_level: &DAffine3, apex: DVec3, size: f64) -> Option<Self> {
        let matrix = object_from_level.matrix3;
        let rows = matrix.x_axis.abs() + matrix.y_axis.abs() + matrix.z_axis.abs();
        let size = max_abs(rows) * 2.0 * size + max_abs(object_from_level.translation) + max_abs(half);
        let slack = [SLACK * size, SLACK * size * size];
        let apex = object_from_level.transform_point3(apex);
        let is_outside = (0..3).any(|k| apex[k].abs() - half[k] > slack[0]);
        (is_outside && is_ordinary(size)).then_some(Self {
            object_from_level: matrix,
            apex,
            half,
            slack,
        })
    }

    /// By the six directions along which a segment and a box can be apart (Gottschalk, Lin and Manocha, "OBBTree", 1996):
    /// the box's own, and those at right angles to one of them and the segment.
    #[inline(always)]
    fn look<L: Exact>(&self, lanes: L, &[x, y, z]: &[Four<L>; 3]) -> (Mask<L>, Mask<L>) {
        let m = &self.object_from_level;
        let row = |k| m.row(k) * 0.5;
        let (rx, ry, rz) = (row(0), row(1), row(2));
        // Half the way, and its middle.
        let reach = [
            x * rx.x + y * rx.y + z * rx.z,
            x * ry.x + y * ry.y + z * ry.z,
            x * rz.x + y * rz.y + z * rz.z,
        ];
        let middle = [
            reach[0] + self.apex.x,
            reach[1] + self.apex.y,
            reach[2] + self.apex.z,
        ];
        let width = [reach[0].abs(), reach[1].abs(), reach[2].abs()];
        let (half, [slack, slack2]) = (self.half, self.slack);
        let (mut misses, mut meets) = (Mask::all(lanes, false), Mask::all(lanes, true));
        let (zero, slack2) = (Four::splat(lanes, 0.0), Four::splat(lanes, slack2));
        for (k, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let beside = middle[k].abs() - (width[k] + half[k]);
            // Also a little before the end of the way, which meets it where the whole does.
            let room = width[k] * (2.0 * (1.0 - REACH)) + slack;
            let moment = middle[a] * reach[b] - middle[b] * reach[a];
            let across = moment.abs() - (width[b] * half[a] + width[a] * half[b]);
            misses = misses | beside.above(room) | across.above(slack2);
            meets = meets & (beside + room).below(zero) & (across + slack2).below(zero);
        }
        (misses, meets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::{self, Lanes, Task, cases},
        math::{Ray, rotation},
        shape::{Crossings, Shape, Sphere},
    };

    struct Look<'t>(&'t Outline, [[f64; 4]; 3]);

    impl Task for Look<'_> {
        type Output = [u32; 2];

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let [x, y, z] = self.1;
            let ways = [Four::new(lanes, x), Four::new(lanes, y), Four::new(lanes, z)];
            let (misses, meets) = self.0.look(lanes, &ways);
            [misses.bits(), meets.bits()]
        }
    }

    /// Balls and boxes of all sizes, near and far, turned and stretched, looked at along rays that are aimed at their
    /// middles, beside them and closely at their edges: what is certain is what the crossings say, and most is certain.
    #[test]
    fn what_is_certain_is_true() {
        let mut random = accel::random(29);
        let mut random = move || 2.0 * random() - 1.0;
        let mut next = move || DVec3::new(random(), random(), random());
        let (mut certain, mut all) = ([0; 2], 0);
        for case in 0..cases(60_000) {
            let size = crate::math::pow(10.0, if case % 4 == 0 { next().x * 12.0 } else { 0.0 });
            let apex = next() * 6.0 * size;
            let center = next() * 3.0 * size;
            let half = (next().abs() + 0.02) * size;
            let stretch = DVec3::ONE + next() * 0.9 * f64::from(case % 3 == 0);
            let turn = rotation(next().normalize(), next().x * 180.0);
            let level_from_object =
                DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(stretch), center);
            let object_from_level = level_from_object.inverse();
            let ball = Shape::Sphere(Sphere::new(center, half.x).unwrap());
            let cuboid = Shape::Cuboid(crate::shape::Cuboid::new(half * 2.0).unwrap());
            let (shape, into) = match case % 2 {
                0 => (ball, DAffine3::IDENTITY),
                _ => (cuboid, object_from_level),
            };
            // Ends of rays: behind the thing, beside it, in it, on its edge, almost on its edge.
            let ends = [0, 1, 2, 3].map(|_| {
                let mut on_it = next() * 1.5;
                if case % 5 == 0 {
                    on_it = on_it.signum() * if next().x > 0.0 { DVec3::ONE } else { on_it.abs() };
                    on_it *= 1.0 + next().x * 1e-12;
                }
                let p = match case % 2 {
                    0 => {
                        center
                            + on_it.normalize() * half.x * (1.0 + 0.7 * next().x * f64::from(case % 5 != 0))
                    }
                    _ => level_from_object.transform_point3(on_it * half),
                };
                apex + (p - apex)
                    * if next().x > -0.5 {
                        2.0 + next().x
                    } else {
                        1.0 + next().x
                    }
            });
            let around = ends.iter().fold(size * 6.0, |m, end| m.max(max_abs(*end)));
            let outline = match &shape {
                Shape::Sphere(_) => {
                    Ball::new(center, half.x, apex, around).map_or(Outline::Unknown, Outline::Ball)
                }
                _ => Cuboid::new(half, &into, apex, around).map_or(Outline::Unknown, Outline::Cuboid),
            };
            let ways = [0, 1, 2].map(|k| ends.map(|end| end[k] - apex[k]));
            let [misses, meets] = accel::run(Look(&outline, ways));
            for (i, end) in ends.iter().enumerate() {
                let distance = (*end - apex).length();
                let ray = Ray::new(apex, (*end - apex) / distance);
                let mut crossings = Crossings::default();
                shape.crossings(&ray.transformed(&into), &mut crossings);
                let (least, most) = (1e-10 * around, distance * crate::render::lighting::SHORT);
                let is_met = crossings.first_within(least, most).is_some();
                let [misses, meets] = [misses, meets].map(|bits| bits >> i & 1 == 1);
                assert!(!misses || !is_met, "{case}: {shape:?} {ray:?} {distance}");
                assert!(!meets || is_met, "{case}: {shape:?} {ray:?} {distance}");
                certain[usize::from(is_met)] += usize::from(misses || meets);
                all += 1;
            }
        }
        assert!(
            certain[0] * 5 > all && certain[1] * 5 > all,
            "{certain:?} of {all}"
        );
        assert!((certain[0] + certain[1]) * 10 > all * 8, "{certain:?} of {all}");
    }
}
