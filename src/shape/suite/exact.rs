//! Crossings against a solver in twice the digits.

use std::{
    ops::{Add, Mul, Sub},
    sync::Arc,
};

use super::{
    super::{Quadric, Shape, Torus},
    Rng, all_crossings,
};
use crate::math::Ray;

/// A number as the sum of two, which gives about 32 digits (Dekker, "A floating-point technique for extending the
/// available precision", 1971).
#[derive(Clone, Copy, Debug)]
struct Double(f64, f64);

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

fn two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let bb = s - a;
    Double(s, (a - (s - bb)) + (b - bb))
}

fn two_product(a: f64, b: f64) -> Double {
    let split = |x: f64| {
        let big = 134_217_729.0 * x;
        let high = big - (big - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl), p) = (split(a), split(b), a * b);
    Double(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Add for Double {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let s = two_sum(self.0, o.0);
        two_sum(s.0, s.1 + self.1 + o.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + Self(-o.0, -o.1)
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = two_product(self.0, o.0);
        two_sum(p.0, p.1 + self.0 * o.1 + self.1 * o.0)
    }
}

/// A polynomial of the way along a ray, least power first.
type Polynomial = Vec<Double>;

fn times(a: &[Double], b: &[Double]) -> Polynomial {
    let mut c = vec![Double::from(0.0); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            c[i + j] = c[i + j] + *x * *y;
        }
    }
    c
}

fn plus(a: &[Double], b: &[Double]) -> Polynomial {
    let at = |c: &[Double], i: usize| c.get(i).copied().unwrap_or(Double::from(0.0));
    (0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect()
}

fn scaled(a: &[Double], by: f64) -> Polynomial {
    a.iter().map(|x| *x * by.into()).collect()
}

fn coordinates(ray: &Ray) -> [Polynomial; 3] {
    [0, 1, 2].map(|k| vec![ray.origin[k].into(), ray.dir[k].into()])
}

/// The zero next to `t`, by Newton's method in twice the digits, and the slope there.
fn zero_near(f: &Polynomial, t: f64) -> (Double, f64) {
    let mut x = Double::from(t);
    let mut slope = 0.0;
    for _ in 0..8 {
        let (mut y, mut dy) = (Double::from(0.0), Double::from(0.0));
        for c in f.iter().rev() {
            dy = dy * x + y;
            y = y * x + *c;
        }
        slope = dy.0;
        x = x - Double::from(y.0 / slope);
    }
    (x, slope)
}

/// Every crossing is within a few roundings of the ray's own numbers of a zero, where the ray does not graze.
fn agrees(shape: &Shape, ray: &Ray, f: &Polynomial, size: f64) -> usize {
    let found = all_crossings(shape, ray);
    let mut checked = 0;
    for c in &found {
        let normal = shape.surface(ray.at(c.t), c.part).normal.normalize();
        let facing = normal.dot(ray.dir.normalize()).abs();
        if facing < 0.01 {
            continue;
        }
        let (exact, _) = zero_near(f, c.t);
        let off = ((exact.0 - c.t) + exact.1).abs() * ray.dir.length();
        let rounding = 2e-15 * (size + ray.origin.length()) / facing;
        assert!(
            off < rounding,
            "{off:e} of {rounding:e}: {} for {exact:?}: {ray:?} on {shape:?}",
            c.t
        );
        checked += 1;
    }
    checked
}

fn random_ray(size: f64, rng: &mut Rng) -> Ray {
    let dir = rng.direction();
    let origin = rng.in_cube() * size - dir * size * rng.magnitude(-1.0, 2.0);
    Ray::new(origin, dir * rng.magnitude(-3.0, 3.0))
}

#[test]
fn quadrics_are_crossed_where_twice_the_digits_say() {
    let mut rng = Rng::new(71);
    let mut checked = 0;
    for _ in 0..20_000 {
        let mut c = [0.0; 10].map(|_| rng.within(-1.0, 1.0));
        c[9] = -rng.unit();
        let Ok(quadric) = Quadric::new(c, None) else {
            continue;
        };
        if !quadric.bounds().is_none_or(|b| b.size().max_element() < 20.0) {
            continue;
        }
        let ray = random_ray(1.0, &mut rng);
        let [x, y, z] = coordinates(&ray);
        let terms = [
            times(&x, &x),
            times(&y, &y),
            times(&z, &z),
            times(&x, &y),
            times(&x, &z),
            times(&y, &z),
            x,
            y,
            z,
            vec![1.0.into()],
        ];
        let f = terms
            .iter()
            .zip(c)
            .fold(vec![], |sum: Polynomial, (term, c)| plus(&sum, &scaled(term, c)));
        let shape = Shape::Quadric(Arc::new(quadric));
        let far = all_crossings(&shape, &ray)
            .iter()
            .map(|c| ray.at(c.t).length())
            .fold(1.0, f64::max);
        // The form grows with the distance, and so do its roundings.
        checked += agrees(&shape, &ray, &f, 10.0 * far * far);
    }
    assert!(checked > 10_000, "{checked}");
}

#[test]
fn tori_are_crossed_where_twice_the_digits_say() {
    let mut rng = Rng::new(72);
    let mut checked = 0;
    for _ in 0..20_000 {
        let (major, minor) = (1.0, rng.magnitude(-2.0, 0.0));
        let ray = random_ray(1.0, &mut rng);
        let [x, y, z] = coordinates(&ray);
        let level = plus(&times(&x, &x), &times(&z, &z));
        let square = plus(&level, &times(&y, &y));
        let radii = two_product(major, major) - two_product(minor, minor);
        let sum = plus(&square, &[radii]);
        let f = plus(&times(&sum, &sum), &scaled(&level, -4.0 * major * major));
        let shape = Shape::Torus(Torus::new(major, minor).unwrap());
        checked += agrees(&shape, &ray, &f, 2.0);
    }
    assert!(checked > 5_000, "{checked}");
}

/// The reference itself: a number with more digits than one has room for comes back.
#[test]
fn twice_the_digits_are_twice_the_digits() {
    let third = zero_near(&vec![Double::from(-1.0), Double::from(3.0)], 0.3).0;
    let rest = Double::from(1.0) - third * Double::from(3.0);
    assert!(rest.0.abs() < 1e-31, "{rest:?}");
    let two = zero_near(
        &vec![Double::from(-2.0), Double::from(0.0), Double::from(1.0)],
        1.4,
    )
    .0;
    let rest = two * two - Double::from(2.0);
    assert!(rest.0.abs() < 1e-30, "{rest:?}");
}
