//! Scenes of any size, the same on every machine.

use std::sync::Arc;

use rtscript::{
    Builder, DVec3, Limits, Scene, Term,
    math::{Ray, cos, pow, sin},
    scene::{Camera, Mesh},
};

/// Numbers without any order, from 0 to 1.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A point of the cube from -1 to 1.
    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

/// A builder with room for large scenes, a camera that sees the cube from -1 to 1, one light and a gray material.
pub(crate) fn stage(width: u32, height: u32) -> Builder {
    let mut limits = Limits::default();
    limits.primitives = usize::MAX;
    let mut b = Builder::with_limits(limits);
    b.size(width, height).unwrap();
    b.camera(Camera::new(DVec3::new(1.5, 2.0, 3.5), DVec3::ZERO, DVec3::Y, 36.0).unwrap());
    b.point(DVec3::new(3.0, 5.0, 2.0), DVec3::splat(0.8)).unwrap();
    b.material_mut().diffuse = Term::color(DVec3::splat(0.7));
    b
}

/// A closed bumpy ball of `2 * n * n` triangles or a few less.
pub(crate) fn bumpy_ball(n: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let pi = std::f64::consts::PI;
    for i in 0..=n {
        for j in 0..n {
            let (a, b) = (
                pi * f64::from(i) / f64::from(n),
                2.0 * pi * f64::from(j) / f64::from(n),
            );
            let r = 0.8 + 0.1 * sin(7.0 * a) * cos(5.0 * b) + 0.02 * sin(41.0 * a) * cos(37.0 * b);
            positions.push(DVec3::new(sin(a) * cos(b), cos(a), -sin(a) * sin(b)) * r);
            if i < n {
                let at = |i: u32, j: u32| i * n + j % n;
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    Mesh::new("ball", positions, triangles).unwrap()
}

/// A mesh of about `n` triangles.
pub(crate) fn triangles(n: usize) -> Scene {
    let mut b = stage(64, 64);
    b.mesh(&Arc::new(bumpy_ball((n as f64 / 2.0).sqrt() as u32)))
        .unwrap();
    b.finish().value
}

/// `n` balls strewn in a cube, a third of it filled whatever their number.
pub(crate) fn spheres(n: usize) -> Scene {
    let mut b = stage(64, 64);
    let mut numbers = Numbers(n as u64);
    let radius = 0.86 / pow(n as f64, 1.0 / 3.0);
    for _ in 0..n {
        let center = numbers.point();
        b.sphere(center, radius * (0.5 + 0.5 * numbers.next())).unwrap();
    }
    b.finish().value
}

/// `n` placings of one mesh of 2,000 triangles.
pub(crate) fn instances(n: usize) -> Scene {
    let mut b = stage(64, 64);
    let mesh = Arc::new(bumpy_ball(32));
    let mut numbers = Numbers(n as u64);
    let size = 0.9 / pow(n as f64, 1.0 / 3.0);
    for _ in 0..n {
        b.push_transform().unwrap();
        b.translate(numbers.point()).unwrap();
        b.rotate(numbers.point() + DVec3::X * 2.0, 360.0 * numbers.next())
            .unwrap();
        b.scale(DVec3::splat(size)).unwrap();
        b.mesh(&mesh).unwrap();
        b.pop_transform().unwrap();
    }
    b.finish().value
}

/// Rays of a camera, row by row: neighbors go nearly the same way.
pub(crate) fn camera_rays(side: u32) -> Vec<Ray> {
    let eye = DVec3::new(1.5, 2.0, 3.5);
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let at = |i: u32| ((f64::from(i) + 0.5) / f64::from(side) - 0.5) * 0.65;
    (0..side * side)
        .map(|i| {
            Ray::new(
                eye,
                (forward + right * at(i % side) - up * at(i / side)).normalize(),
            )
        })
        .collect()
}

/// Rays from anywhere to anywhere: no two go the same way.
pub(crate) fn scattered_rays(count: usize) -> Vec<Ray> {
    let mut numbers = Numbers(7);
    (0..count)
        .map(|_| {
            let (from, to) = (numbers.point(), numbers.point());
            Ray::new(from, (to - from).normalize())
        })
        .collect()
}
