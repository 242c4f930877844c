//! The reference for shapes of curves and polynomials.

use super::super::{BlobPart, Lathe, Prism, Shape, SphereSweep};
use crate::{
    math::{self, Bounds3, DVec2, DVec3},
    spline::Piece,
};

/// As [`super::reference::distance`]: exact for what is made of straight lines and spheres, else to first order near the
/// surface and right in its sign.
pub(super) fn distance(shape: &Shape, p: DVec3) -> f64 {
    let around_box = |half: DVec3| (p.abs() - half).max(DVec3::ZERO).length();
    match shape {
        Shape::Capsule(c) => around_box(DVec3::new(0.0, 0.5 * c.height() - c.radius(), 0.0)) - c.radius(),
        Shape::RoundedBox(c) => {
            let q = p.abs() - (c.size() * 0.5 - c.radius());
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - c.radius()
        }
        Shape::Superellipsoid(c) => {
            let q = p.abs() * 2.0;
            let sum = math::pow(q.x, 2.0 / c.e()) + math::pow(q.z, 2.0 / c.e());
            let all = math::pow(sum, c.e() / c.n()) + math::pow(q.y, 2.0 / c.n());
            // A norm, so that it grows as fast along every way from the center.
            (math::pow(all, 0.5 * c.n()) - 1.0) * 0.5
        }
        Shape::Quadric(c) => {
            let [x2, y2, z2, xy, xz, yz, x, y, z, one] = c.coefficients();
            let value = x2 * p.x * p.x
                + y2 * p.y * p.y
                + z2 * p.z * p.z
                + xy * p.x * p.y
                + xz * p.x * p.z
                + yz * p.y * p.z
                + x * p.x
                + y * p.y
                + z * p.z
                + one;
            let gradient = DVec3::new(
                2.0 * x2 * p.x + xy * p.y + xz * p.z + x,
                2.0 * y2 * p.y + xy * p.x + yz * p.z + y,
                2.0 * z2 * p.z + xz * p.x + yz * p.y + z,
            );
            let to_surface = first_order(value, gradient);
            match c.clip() {
                Some(b) => to_surface.max(outside(&b, p)),
                None => to_surface,
            }
        }
        Shape::Prism(c) => distance_to_prism(c, p),
        Shape::Lathe(c) => distance_to_lathe(c, p),
        Shape::SphereSweep(c) => distance_to_sweep(c, p),
        Shape::Blob(c) => {
            let (mut density, mut slope) = (0.0, DVec3::ZERO);
            for part in c.parts() {
                let (d, g) = density_of(part, p);
                density += d;
                slope += g;
            }
            first_order(c.threshold() - density, slope)
        }
        _ => panic!("none of ours"),
    }
}

fn first_order(value: f64, gradient: DVec3) -> f64 {
    if value == 0.0 {
        0.0
    } else {
        value / gradient.length()
    }
}

fn outside(b: &Bounds3, p: DVec3) -> f64 {
    (b.min - p).max(p - b.max).max_element()
}

fn density_of(part: &BlobPart, p: DVec3) -> (f64, DVec3) {
    let axis = part.to - part.from;
    let along = if axis == DVec3::ZERO {
        0.0
    } else {
        ((p - part.from).dot(axis) / axis.length_squared()).clamp(0.0, 1.0)
    };
    let off = p - (part.from + axis * along);
    let r2 = part.radius * part.radius;
    let depth = (1.0 - off.length_squared() / r2).max(0.0);
    (
        part.strength * depth * depth,
        off * (-4.0 * part.strength * depth / r2),
    )
}

/// The distance between `p` and the curves, by a search that no root finding is part of: where it may be least it is
/// looked at ever closer. And whether an odd number of pieces is to the right of `p`.
fn curve_distance<const N: usize>(pieces: &[Piece<N>], measure: impl Fn([f64; N]) -> f64) -> f64 {
    let starts = pieces.iter().map(|piece| measure(piece.position(0.0)));
    let mut best = starts.fold(f64::INFINITY, f64::min);
    for piece in pieces {
        let at = |u: f64| measure(piece.position(u));
        // No point of the piece is farther from its first than its control points are apart in all, and no measure grows
        // by more than twice as much.
        let length: f64 = piece.0.windows(2).map(|w| span(&w[0], &w[1])).sum();
        if at(0.0).is_finite() && at(0.0) - 2.0 * length > best {
            continue;
        }
        let steps = 64;
        let values: Vec<f64> = (0..=steps).map(|i| at(f64::from(i) / f64::from(steps))).collect();
        for i in 0..=steps as usize {
            let is_low =
                (i == 0 || values[i - 1] >= values[i]) && (i == steps as usize || values[i + 1] >= values[i]);
            if !is_low {
                continue;
            }
            let (mut lo, mut hi) = (
                (i as f64 - 1.0).max(0.0) / f64::from(steps),
                (i as f64 + 1.0).min(f64::from(steps)) / f64::from(steps),
            );
            // Golden section.
            let g = 0.5 * (5.0f64.sqrt() - 1.0);
            let (mut a, mut b) = (hi - g * (hi - lo), lo + g * (hi - lo));
            let (mut fa, mut fb) = (at(a), at(b));
            for _ in 0..60 {
                if fa <= fb {
                    (hi, b, fb) = (b, a, fa);
                    a = hi - g * (hi - lo);
                    fa = at(a);
                } else {
                    (lo, a, fa) = (a, b, fb);
                    b = lo + g * (hi - lo);
                    fb = at(b);
                }
            }
            best = best.min(fa).min(fb).min(values[i]);
        }
    }
    best
}

fn span<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

/// Whether closed curves go around the point an odd number of times: by the angles at which points close together on them
/// are seen. Near a curve the chords between them are no measure.
fn is_within(loops: &[Vec<Piece<2>>], p: DVec2) -> bool {
    let mut odd = false;
    for piece in loops.iter().flatten() {
        let mut todo = vec![(0.0, 1.0, 40)];
        while let Some((lo, hi, depth)) = todo.pop() {
            let (a, b) = (piece.position(lo), piece.position(hi));
            let middle = piece.position(0.5 * (lo + hi));
            // No point of this part is farther from its middle.
            let speed = (0..3)
                .map(|k| (DVec2::from(piece.0[k + 1]) - DVec2::from(piece.0[k])).length() * 3.0)
                .fold(0.0, f64::max);
            let reach = speed * 0.5 * (hi - lo);
            let off = DVec2::from(middle) - p;
            if off.x < -reach || off.y.abs() > reach && (a[1] > p.y) == (b[1] > p.y) {
                continue;
            }
            if off.x >= reach || depth == 0 {
                // All of it is to the right: only its ends count.
                odd ^= (a[1] > p.y) != (b[1] > p.y);
                continue;
            }
            let at = 0.5 * (lo + hi);
            todo.extend([(lo, at, depth - 1), (at, hi, depth - 1)]);
        }
    }
    odd
}

fn prism_loops(c: &Prism) -> Vec<Vec<Piece<2>>> {
    let pieces = c.outlines().iter().map(|o| c.spline().pieces(o, true).unwrap());
    pieces.collect()
}

fn distance_to_prism(c: &Prism, p: DVec3) -> f64 {
    let loops = prism_loops(c);
    let foot = DVec2::new(p.x, p.z);
    let all: Vec<Piece<2>> = loops.concat();
    let d = curve_distance(&all, |q| foot.distance(q.into()));
    let to_walls = if is_within(&loops, foot) { -d } else { d };
    let above = p.y.abs() - 0.5 * c.height();
    if to_walls <= 0.0 || above <= 0.0 {
        return to_walls.max(above);
    }
    to_walls.hypot_of(above)
}

trait Hypot {
    fn hypot_of(self, other: f64) -> f64;
}

impl Hypot for f64 {
    fn hypot_of(self, other: f64) -> f64 {
        math::hypot(self, other)
    }
}

fn distance_to_lathe(c: &Lathe, p: DVec3) -> f64 {
    let pieces = c.spline().pieces(c.points(), c.is_closed()).unwrap();
    let foot = DVec2::new(DVec2::new(p.x, p.z).length(), p.y);
    let d = curve_distance(&pieces, |q| {
        if q[0] < 0.0 {
            f64::INFINITY
        } else {
            foot.distance(q.into())
        }
    });
    let solid = c.is_closed() || c.points()[0][0] == 0.0 && c.points()[c.points().len() - 1][0] == 0.0;
    if solid && is_within(&[pieces], foot) {
        -d
    } else {
        d
    }
}

fn distance_to_sweep(c: &SphereSweep, p: DVec3) -> f64 {
    let pieces = c.spline().pieces(c.points(), false).unwrap();
    curve_distance(&pieces, |[x, y, z, r]| p.distance(DVec3::new(x, y, z)) - r.abs())
}

/// As [`super::reference::edge_distance`].
pub(super) fn edge_distance(shape: &Shape, p: DVec3) -> f64 {
    match shape {
        // Smooth, but where a blob's parts are only just one, which no random shape is.
        Shape::Capsule(_) | Shape::RoundedBox(_) | Shape::Blob(_) => f64::INFINITY,
        Shape::Superellipsoid(c) => {
            let q = p.abs().to_array();
            if c.e() > 1.5 || c.n() > 1.5 {
                q[0].min(q[1]).min(q[2])
            } else {
                f64::INFINITY
            }
        }
        Shape::Quadric(c) => {
            let Some(b) = c.clip() else {
                return f64::INFINITY;
            };
            let to_face = outside(&b, p).abs();
            let [x2, y2, z2, xy, ..] = c.coefficients();
            // The tip of a cone, and where two planes meet.
            let tip = match (xy != 0.0, y2 < 0.0 && x2 > 0.0 && z2 > 0.0) {
                (true, _) => DVec2::new(p.x, p.y).length(),
                (_, true) => p.length(),
                _ => f64::INFINITY,
            };
            let faces = [(p - b.min).abs(), (p - b.max).abs()];
            let mut near: Vec<f64> = faces.iter().flat_map(|f| f.to_array()).collect();
            near.sort_by(f64::total_cmp);
            // On a face, the surface's own distance tells how far its edge is.
            let form = distance(
                &Shape::Quadric(std::sync::Arc::new(
                    super::super::Quadric::new(c.coefficients(), Some(grown(&b))).unwrap(),
                )),
                p,
            );
            near[1].min(form.abs().max(to_face)).min(tip)
        }
        Shape::Prism(c) => {
            let foot = DVec2::new(p.x, p.z);
            let rim = (p.y.abs() - 0.5 * c.height()).abs();
            let walls = distance(shape, p * DVec3::new(1.0, 0.0, 1.0)).abs();
            let corner = c
                .outlines()
                .iter()
                .flatten()
                .map(|q| foot.distance(DVec2::from(*q)))
                .fold(f64::INFINITY, f64::min);
            // Also where an outline crosses itself, at the inner corners of the five-pointed star.
            let crossing = if c.outlines()[0].len() == 5 {
                let scale = DVec2::from(c.outlines()[0][0]).length();
                (foot.length() / scale - 0.381_966).abs()
                    * scale
                    * if foot.length() > 0.5 * scale { 9.0 } else { 1.0 }
            } else {
                f64::INFINITY
            };
            corner
                .min(rim.max(walls))
                .min(if crossing < 1e-3 { crossing } else { f64::INFINITY })
        }
        Shape::Lathe(c) => {
            let foot = DVec2::new(DVec2::new(p.x, p.z).length(), p.y);
            let corner = |q: &[f64; 2]| foot.distance(DVec2::from(*q));
            c.points().iter().map(corner).fold(foot.x, f64::min)
        }
        Shape::SphereSweep(c) => {
            // Where one piece goes into the next, and where one is in another.
            let pieces = c.spline().pieces(c.points(), false).unwrap();
            let mut each: Vec<f64> = pieces
                .iter()
                .map(|piece| {
                    curve_distance(std::slice::from_ref(piece), |[x, y, z, r]| {
                        p.distance(DVec3::new(x, y, z)) - r.abs()
                    })
                    .abs()
                })
                .collect();
            each.sort_by(f64::total_cmp);
            let joint = c
                .points()
                .iter()
                .map(|[x, y, z, r]| (p.distance(DVec3::new(*x, *y, *z)) - r).abs())
                .fold(f64::INFINITY, f64::min);
            each.get(1).copied().unwrap_or(f64::INFINITY).min(joint)
        }
        _ => panic!("none of ours"),
    }
}

fn grown(b: &Bounds3) -> Bounds3 {
    Bounds3::new(b.min - b.size(), b.max + b.size())
}
