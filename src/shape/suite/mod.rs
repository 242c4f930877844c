//! What every shape promises, tested over every shape of the list with the same seeded random rays.
//!
//! A new shape joins by a line in [`samples`] and one in each function of [`reference`]; a test insists on
//! the first, the compiler on the others.

mod limits;
mod properties;
mod reference;
mod transforms;

use std::sync::Arc;

use super::{Cone, Crossing, Crossings, Cuboid, Cylinder, Disk, Plane, Polygon, Sdf, Shape, Sphere, Torus};
use crate::math::{self, DMat3, DVec2, DVec3, PI, Ray, max_abs};

/// Seeded random numbers: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", 2014).
pub(super) struct Rng(u64);

impl Rng {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub(super) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// A point of the cube [-1, 1]^3.
    pub(super) fn in_cube(&mut self) -> DVec3 {
        DVec3::new(
            self.within(-1.0, 1.0),
            self.within(-1.0, 1.0),
            self.within(-1.0, 1.0),
        )
    }

    /// A unit vector, uniform over the sphere (Archimedes' hat box).
    pub(super) fn direction(&mut self) -> DVec3 {
        let y = self.within(-1.0, 1.0);
        let phi = self.within(0.0, 2.0 * PI);
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * math::cos(phi), y, r * math::sin(phi))
    }

    /// A power of ten with an exponent from `lo` to `hi`.
    pub(super) fn magnitude(&mut self, lo: f64, hi: f64) -> f64 {
        math::pow(10.0, self.within(lo, hi))
    }

    pub(super) fn rotation(&mut self) -> DMat3 {
        let (axis, degrees) = (self.direction(), self.within(0.0, 360.0));
        math::rotation(axis, degrees)
    }
}

pub(super) fn all_crossings(shape: &Shape, ray: &Ray) -> Vec<Crossing> {
    let mut out = Crossings::default();
    shape.crossings(ray, &mut out);
    out.as_slice().to_vec()
}

/// An L, a star with sharp points, and a square with a square hole reached over a bridge.
pub(super) fn outlines() -> Vec<Vec<DVec2>> {
    let l = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)];
    let star = (0..10).map(|i| {
        let (s, c) = math::sin_cos_degrees(36.0 * f64::from(i));
        DVec2::new(c, s) * if i % 2 == 0 { 1.0 } else { 0.3 }
    });
    let holed = [
        (0, 0),
        (4, 0),
        (4, 4),
        (0, 4),
        (0, 0),
        (1, 1),
        (1, 3),
        (3, 3),
        (3, 1),
        (1, 1),
    ];
    let whole = |points: &[(i32, i32)]| {
        points
            .iter()
            .map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y)))
            .collect()
    };
    vec![whole(&l), star.collect(), whole(&holed)]
}

/// Every shape, with even and uneven proportions, `s` times as large as a unit.
fn samples(s: f64) -> Vec<Shape> {
    let mut shapes = vec![
        Shape::Sphere(Sphere::new(DVec3::ZERO, 0.5 * s).unwrap()),
        Shape::Sphere(Sphere::new(DVec3::new(1.0, -2.0, 3.0) * s, 2.0 * s).unwrap()),
        Shape::Cuboid(Cuboid::new(DVec3::splat(s)).unwrap()),
        Shape::Cuboid(Cuboid::new(DVec3::new(3.0, 0.01, 0.7) * s).unwrap()),
        Shape::Cylinder(Cylinder::new(0.5 * s, s).unwrap()),
        Shape::Cylinder(Cylinder::new(2.0 * s, 0.01 * s).unwrap()),
        Shape::Cylinder(Cylinder::new(0.01 * s, 3.0 * s).unwrap()),
        Shape::Cone(Cone::new(0.5 * s, s).unwrap()),
        Shape::Cone(Cone::new(2.0 * s, 0.1 * s).unwrap()),
        Shape::Cone(Cone::new(0.1 * s, 3.0 * s).unwrap()),
        Shape::Disk(Disk::new(0.5 * s).unwrap()),
        Shape::Torus(Torus::new(2.0 * s, 0.5 * s).unwrap()),
        Shape::Torus(Torus::new(s, s).unwrap()),
        Shape::Torus(Torus::new(s, 1e-3 * s).unwrap()),
        Shape::Plane(Plane),
        Shape::Isosurface(Arc::new(Sdf::sphere(0.5 * s).unwrap().isosurface().unwrap())),
    ];
    let mut rng = Rng::new(7);
    for outline in outlines() {
        for turn in [DMat3::IDENTITY, rng.rotation()] {
            let points = outline.iter().map(|p| turn * p.extend(0.25) * s).collect();
            shapes.push(Shape::Polygon(Arc::new(Polygon::new(points).unwrap())));
        }
    }
    shapes
}

/// Half the longest edge of the bounds and their center; for the plane that of its interesting part.
fn extent(shape: &Shape, s: f64) -> (f64, DVec3) {
    shape
        .bounds()
        .map_or((s, DVec3::ZERO), |b| (max_abs(b.size()) * 0.5, b.center()))
}

/// A ray that means to meet the shape: at any point of its bounds or just beside, often exactly at an edge,
/// a rim or the center of them, often along an axis, from near and from far, with a direction of any length.
fn random_ray(shape: &Shape, s: f64, rng: &mut Rng) -> Ray {
    let (size, center) = extent(shape, s);
    let half = shape.bounds().map_or(DVec3::splat(s), |b| b.size() * 0.5);
    let snapped = [-1.0, 0.0, 1.0];
    let mut coordinate = |half: f64| {
        half * if rng.chance(0.2) {
            snapped[rng.below(3)]
        } else {
            rng.within(-1.2, 1.2)
        }
    };
    let target = center + DVec3::new(coordinate(half.x), coordinate(half.y), coordinate(half.z));
    let mut dir = rng.direction();
    if rng.chance(0.2) {
        dir[rng.below(3)] = 0.0;
        if rng.chance(0.5) {
            dir = [DVec3::X, DVec3::NEG_Y, DVec3::Z][rng.below(3)];
        }
    }
    let origin = target - dir * size * rng.magnitude(-2.0, 3.0);
    Ray::new(origin, dir * rng.magnitude(-6.0, 6.0))
}

/// Calls `check` with every shape at five scales, its crossings with many rays, and a label for messages.
fn for_all(rays: usize, mut check: impl FnMut(&Shape, f64, &Ray, &[Crossing], &str)) {
    let mut rng = Rng::new(1);
    for s in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for shape in samples(s) {
            for i in 0..rays {
                let ray = random_ray(&shape, s, &mut rng);
                let found = all_crossings(&shape, &ray);
                let label = format!("ray {i} {ray:?} on {shape:?}: {found:?}");
                check(&shape, s, &ray, &found, &label);
            }
        }
    }
}
