//! What every shape promises, tested over every shape of the list with the same seeded random rays.
//!
//! A new shape joins by a line in [`samples`] and one in each function of [`reference`]; a test insists on
//! the first, the compiler on the others. What is no shape, a scene with solids and closed meshes in it, joins as another
//! [`Subject`]: `render/world/suite.rs`.

mod curved;
mod edges;
mod equals;
mod exact;
mod limits;
mod properties;
mod reference;
pub(crate) mod shared;
mod subject;
mod transforms;

pub(crate) use edges::{inner_points, leaks};
pub(crate) use subject::{Met, Subject};

use std::sync::Arc;

use self::{shared::Case, subject::Alone};
use super::{
    Blob, BlobPart, Capsule, Cone, Crossing, Cuboid, Cylinder, Disk, Lathe, Plane, Polygon, Prism, Quadric,
    RoundedBox, Sdf, Shape, Sphere, SphereSweep, Superellipsoid, Torus,
};
use crate::{
    math::{self, Bounds3, DMat3, DVec2, DVec3, PI, Ray},
    spline::{Piece, Spline},
};

/// A profile that closes on the axis at both ends.
const VASE: [[f64; 2]; 6] = [
    [0.0, -1.0],
    [0.6, -1.0],
    [0.8, -0.3],
    [0.2, 0.5],
    [0.5, 1.0],
    [0.0, 0.9],
];

/// A corner of the cube from -1 to 1: the bits of `i` say on which side along x, y and z.
pub(crate) fn cube_corner(i: u32) -> DVec3 {
    DVec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 1.0 } else { -1.0 }))
}

/// The corners of the cube's faces, counter-clockwise seen from outside.
pub(crate) const CUBE_FACES: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Seeded random numbers: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", 2014).
pub(crate) struct Rng(u64);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub(crate) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// A point of the cube [-1, 1]^3.
    pub(crate) fn in_cube(&mut self) -> DVec3 {
        DVec3::new(
            self.within(-1.0, 1.0),
            self.within(-1.0, 1.0),
            self.within(-1.0, 1.0),
        )
    }

    /// A unit vector, uniform over the sphere (Archimedes' hat box).
    pub(crate) fn direction(&mut self) -> DVec3 {
        let y = self.within(-1.0, 1.0);
        let phi = self.within(0.0, 2.0 * PI);
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * math::cos(phi), y, r * math::sin(phi))
    }

    /// A power of ten with an exponent from `lo` to `hi`.
    pub(crate) fn magnitude(&mut self, lo: f64, hi: f64) -> f64 {
        math::pow(10.0, self.within(lo, hi))
    }

    pub(crate) fn rotation(&mut self) -> DMat3 {
        let (axis, degrees) = (self.direction(), self.within(0.0, 360.0));
        math::rotation(axis, degrees)
    }
}

pub(super) fn all_crossings(shape: &Shape, ray: &Ray) -> Vec<Crossing> {
    let mut out = Vec::new();
    shape.crossings(ray, &mut out);
    out.sort_by(|a, b| a.t.total_cmp(&b.t));
    out
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
    shapes.extend(rounded(s));
    shapes.extend(swept(s));
    shapes.extend(blobs(s));
    shapes
}

fn rounded(s: f64) -> Vec<Shape> {
    let mut shapes = vec![
        Shape::Capsule(Capsule::new(0.25 * s, s).unwrap()),
        Shape::Capsule(Capsule::new(0.01 * s, 3.0 * s).unwrap()),
        Shape::Capsule(Capsule::new(s, 2.0 * s).unwrap()),
        Shape::RoundedBox(RoundedBox::new(DVec3::splat(s), 0.1 * s).unwrap()),
        Shape::RoundedBox(RoundedBox::new(DVec3::new(3.0, 0.2, 0.7) * s, 0.1 * s).unwrap()),
        Shape::RoundedBox(RoundedBox::new(DVec3::new(1.0, 2.0, 3.0) * s, 1e-3 * s).unwrap()),
    ];
    if s == 1.0 {
        for (e, n) in [
            (1.0, 1.0),
            (0.2, 0.2),
            (0.3, 1.5),
            (2.0, 2.0),
            (1.0, 0.1),
            (3.0, 0.5),
            (0.7, 4.0),
            (3.0, 3.0),
        ] {
            shapes.push(Shape::Superellipsoid(Superellipsoid::new(e, n).unwrap()));
        }
    }
    let clip = Some(Bounds3::new(
        DVec3::new(-1.0, -1.5, -2.0) * s,
        DVec3::new(1.0, 1.0, 1.5) * s,
    ));
    let (l, q) = (1.0 / s, 1.0 / (s * s));
    let forms = [
        (
            [
                q,
                2.0 * q,
                0.5 * q,
                0.3 * q,
                -0.2 * q,
                0.1 * q,
                0.4 * l,
                0.0,
                -0.3 * l,
                -1.0,
            ],
            None,
        ),
        ([q, 2.0 * q, 0.5 * q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], clip),
        ([q, -q, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], clip),
        ([q, -q, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.2], clip),
        ([q, -q, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2], clip),
        ([q, 0.0, q, 0.0, 0.0, 0.0, 0.0, -l, 0.0, 0.0], clip),
        ([-q, 0.0, q, 0.0, 0.0, 0.0, 0.0, l, 0.0, 0.0], clip),
        ([-q, -q, -q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], clip),
        ([0.0, 0.0, 0.0, q, 0.0, 0.0, 0.0, 0.0, 0.0, -0.25], clip),
        ([q, 0.0, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.25], clip),
        ([q, 0.0, q, 0.0, 0.0, 0.0, 0.0, -l, 0.0, 0.0], None),
    ];
    for (coefficients, clip) in forms {
        shapes.push(Shape::Quadric(Arc::new(
            Quadric::new(coefficients, clip).unwrap(),
        )));
    }
    shapes
}

/// Points on an uneven ring, with neighbours far and near.
pub(super) fn ring(n: usize) -> Vec<[f64; 2]> {
    let corner = |i: usize| {
        let (s, c) = math::sin_cos_degrees(360.0 * i as f64 / n as f64);
        let r = if i.is_multiple_of(2) { 1.0 } else { 0.6 };
        [r * c, r * s]
    };
    (0..n).map(corner).collect()
}

/// The outline of a gear.
fn teeth(n: usize) -> Vec<[f64; 2]> {
    let corner = |i: usize| {
        let (s, c) = math::sin_cos_degrees(360.0 * i as f64 / n as f64);
        let r = if i % 4 < 2 { 1.0 } else { 0.8 };
        [r * c, r * s]
    };
    (0..n).map(corner).collect()
}

/// A square of many points in a line, two of them one, around a notch.
fn in_line() -> Vec<[f64; 2]> {
    let tenth = |i: i32| f64::from(i) / 10.0;
    let bottom = (-10..10).map(|i| [tenth(i), -1.0]);
    let right = (-10..10).map(|i| [1.0, tenth(i)]);
    let top = (-9..=10).rev().map(|i| [tenth(i), 1.0]);
    let rest = [
        [-1.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.5],
        [0.5, 0.5],
        [0.5, -0.5],
        [-1.0, -0.5],
    ];
    bottom.chain(right).chain(top).chain(rest).collect()
}

/// Corners of angles down to a thousandth of a degree.
fn needles() -> Vec<[f64; 2]> {
    vec![
        [-1.0, -0.5],
        [1.0, 0.0],
        [-0.9, -0.4],
        [1.0, 0.4],
        [-0.9, -0.399],
        [1.0, 0.400_03],
        [-1.0, 0.5],
    ]
}

/// Bezier pieces of which two are straight lines.
fn mixed() -> Vec<[f64; 2]> {
    let (a, b, c) = ([-1.0, -0.7], [1.0, -0.7], [0.6, 0.9]);
    let lines = [Piece::line(a, b), Piece::line(b, c)];
    let curve = [c, [0.1, 0.2], [-1.5, 1.4]];
    let straight = lines.iter().flat_map(|line| line.0.into_iter().take(3));
    straight.chain(curve).collect()
}

fn swept(s: f64) -> Vec<Shape> {
    let times = |points: &[[f64; 2]], s: f64| points.iter().map(|p| p.map(|x| x * s)).collect::<Vec<_>>();
    let star = times(&ring(10), s);
    let hole = times(&ring(6), 0.3 * s);
    let crossed: Vec<[f64; 2]> = [0, 2, 4, 1, 3].iter().map(|i| star[2 * i]).collect();
    let prism = |outlines: &[&Vec<[f64; 2]>], kind, height: f64| {
        let outlines = outlines.iter().map(|o| o.to_vec()).collect();
        Shape::Prism(Arc::new(Prism::new(outlines, kind, height * s).unwrap()))
    };
    let lathe = |points: &[[f64; 2]], kind, closed| {
        Shape::Lathe(Arc::new(Lathe::new(times(points, s), kind, closed).unwrap()))
    };
    let sweep = |points: &[[f64; 4]], kind| {
        let points = points.iter().map(|p| p.map(|x| x * s)).collect();
        Shape::SphereSweep(Arc::new(SphereSweep::new(points, kind).unwrap()))
    };
    let tire: Vec<[f64; 2]> = ring(8).into_iter().map(|[x, y]| [2.0 + x, y]).collect();
    let path = [
        [0.0, 0.0, 0.0, 0.3],
        [1.0, 0.5, 0.0, 0.1],
        [1.5, -0.5, 1.0, 0.4],
        [0.0, -0.5, 1.5, 0.2],
        [-0.5, 0.4, 0.2, 0.0],
    ];
    vec![
        prism(&[&star], Spline::Linear, 1.0),
        prism(&[&star, &hole], Spline::CatmullRom, 0.3),
        prism(&[&crossed], Spline::Linear, 2.0),
        prism(&[&hole[..].to_vec()], Spline::Bezier, 4.0),
        prism(
            &[&times(&teeth(400), s), &hole, &times(&ring(6), 0.1 * s)],
            Spline::Linear,
            0.4,
        ),
        prism(&[&times(&in_line(), s)], Spline::Linear, 1.0),
        prism(&[&times(&needles(), s)], Spline::Linear, 1.0),
        prism(&[&times(&mixed(), s)], Spline::Bezier, 0.7),
        lathe(&VASE, Spline::Linear, false),
        lathe(&VASE, Spline::CatmullRom, false),
        lathe(&tire, Spline::CatmullRom, true),
        lathe(&tire, Spline::Linear, true),
        lathe(&VASE[1..5], Spline::CatmullRom, false),
        sweep(&path, Spline::Linear),
        sweep(&path, Spline::CatmullRom),
        sweep(&path[..4], Spline::Bezier),
        sweep(&[[0.0, 0.0, 0.0, 0.5], [0.0, 2.0, 0.0, 0.5]], Spline::Linear),
        sweep(&[[0.0, 0.0, 0.0, 1.0], [0.2, 0.2, 0.0, 0.5]], Spline::Linear),
    ]
}

fn blobs(s: f64) -> Vec<Shape> {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * s;
    let ball = BlobPart::ball(at(0.0, 0.0, 0.0), s, 1.0);
    let several = vec![
        ball,
        BlobPart::ball(at(1.1, 0.2, 0.0), 0.9 * s, 1.5),
        BlobPart::ball(at(0.5, -0.2, 0.8), 0.7 * s, -1.0),
        BlobPart::rod(at(-1.0, -1.0, 0.0), at(0.0, 1.5, 0.5), 0.6 * s, 1.2),
    ];
    [vec![ball], several]
        .into_iter()
        .map(|parts| Shape::Blob(Arc::new(Blob::new(0.4, parts).unwrap())))
        .collect()
}

/// Whether the shape is made of curves or of polynomials of a high degree.
fn is_curved(shape: &Shape) -> bool {
    matches!(
        shape,
        Shape::Superellipsoid(_) | Shape::Prism(_) | Shape::Lathe(_) | Shape::SphereSweep(_) | Shape::Blob(_)
    )
}

/// Calls `check` with many rays on every shape at five scales. Shapes of curves, of which everything takes longer, get
/// fewer rays.
fn for_all(rays: usize, mut check: impl FnMut(&Shape, &Case<'_>)) {
    let mut rng = Rng::new(1);
    for s in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for shape in samples(s) {
            let alone = Alone { shape: &shape, s };
            for _ in 0..if is_curved(&shape) { rays / 50 } else { rays } {
                check(&shape, &Case::random(&alone, &mut rng));
            }
        }
    }
}
