//! The noise of the language, with its gradient and with bounds of both.

use super::{interval::Interval, scalar::Scalar};
use crate::{math::DVec3, noise::hash};

/// No value is beyond this, nor any slope along an axis: at most 1 by the gradients themselves, and 15/8, the steepest of
/// the fade, times a difference of at most 3 between two sides of a cell.
const MOST: f64 = 1.04;
const STEEPEST: f64 = 1.0 + 3.0 * 15.0 / 8.0;

/// No slope changes faster than this along any axis. With u the fade, at most 15/8 steep and 10 / sqrt(3) bent, along one
/// axis: 2 u' times a difference of 2 of gradients, and u'' times a difference of at most 3 between sides; across: u' times
/// such a difference twice, and u'^2 times twice the difference of sides.
const BENT: f64 = 30.0;
/// More than the rounding of a value and of a gradient, whose terms are at most some tens.
const ROUNDING: f64 = 1e-12;

/// Gradient noise with Perlin's fifth-degree fade and twelve gradients ("Improving noise", SIGGRAPH 2002), the gradients
/// chosen by an integer hash, in a cell whose least corner is `cell`, at `f` from there.
fn in_cell<T: Scalar>(cell: [i64; 3], f: [T; 3]) -> T {
    let constant = T::constant;
    let fade = f.map(|t| {
        let inner = t
            .mul(t.mul(constant(6.0)).sub(constant(15.0)))
            .add(constant(10.0));
        t.mul(t).mul(t).mul(inner)
    });
    let lerp = |a: T, b: T, t: T| a.add(b.sub(a).mul(t));
    let corner = |x: i64, y: i64, z: i64| {
        let [i, j, k] = cell;
        let hash = hash(i.wrapping_add(x), j.wrapping_add(y), k.wrapping_add(z));
        let [dx, dy, dz] = [(f[0], x), (f[1], y), (f[2], z)].map(|(f, c)| f.sub(constant(c as f64)));
        let [a, b] = match hash % 12 / 4 {
            0 => [dx, dy],
            1 => [dx, dz],
            _ => [dy, dz],
        };
        let signed = |bit: u64, x: T| if hash & bit == 0 { x } else { x.neg() };
        signed(1, a).add(signed(2, b))
    };
    let along_x = |y, z| lerp(corner(0, y, z), corner(1, y, z), fade[0]);
    let along_y = |z| lerp(along_x(0, z), along_x(1, z), fade[1]);
    lerp(along_y(0), along_y(1), fade[2])
}

/// The noise at a point.
pub(super) fn value(p: DVec3) -> f64 {
    let cell = p.floor();
    in_cell(cell.to_array().map(|c| c as i64), (p - cell).to_array())
}

/// The noise and its gradient.
pub(super) fn gradient(p: DVec3) -> (f64, DVec3) {
    use super::scalar::Gradient;
    let cell = p.floor();
    let f = (p - cell).to_array();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let [x, y, z] = [0, 1, 2].map(|i: usize| Gradient {
        v: f.get(i).copied().unwrap_or(0.0),
        d: axes.get(i).copied().unwrap_or(DVec3::ZERO),
    });
    let found = in_cell(cell.to_array().map(|c| c as i64), [x, y, z]);
    (found.v, found.d)
}

/// Bounds of the noise in a box, and of its slopes along the axes: from those at its center, by how much slopes change at
/// most (Taylor). The fifth-degree fade makes slopes continuous, also from cell to cell.
pub(super) fn bounds(p: [Interval; 3]) -> (Interval, [Interval; 3]) {
    let most = Interval::new(-MOST, MOST);
    let steepest = Interval::new(-STEEPEST, STEEPEST);
    let half = p.map(|x| 0.5 * x.width());
    let reach = half.iter().sum::<f64>();
    let center = DVec3::from(p.map(|x| x.lo + 0.5 * x.width()));
    // Half a cell away nothing is left of what is known at the center.
    let is_near = reach < 0.5 && crate::math::max_abs(center) < 1e9;
    if !is_near {
        return (most, [steepest; 3]);
    }
    let (v, d) = gradient(center);
    let rest = 0.5 * BENT * reach * reach + ROUNDING;
    let away = half
        .iter()
        .zip(d.to_array())
        .map(|(half, d)| half * d.abs())
        .sum::<f64>()
        + rest;
    let turned = BENT * reach + ROUNDING;
    let slopes = d.to_array().map(|d| Interval::new(d - turned, d + turned));
    let within = |x: Interval, most: Interval| Interval::new(x.lo.max(most.lo), x.hi.min(most.hi));
    let v = Interval::new(v - away, v + away);
    (within(v, most), slopes.map(|slope| within(slope, steepest)))
}
