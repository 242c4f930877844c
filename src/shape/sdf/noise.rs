//! The noise of the language, with its gradient and with bounds of both.

use super::{interval::Interval, scalar::Gradient};
use crate::{
    math::DVec3,
    noise::{Number, cell_of, in_cell},
};

impl Number for Gradient {}

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

/// The noise at a point.
pub(super) fn value(p: DVec3) -> f64 {
    let (cell, f) = cell_of(p);
    in_cell(cell, f)
}

/// The noise and its gradient.
pub(super) fn gradient(p: DVec3) -> (f64, DVec3) {
    let (cell, f) = cell_of(p);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let [x, y, z] = [0, 1, 2].map(|i: usize| Gradient {
        v: f.get(i).copied().unwrap_or(0.0),
        d: axes.get(i).copied().unwrap_or(DVec3::ZERO),
    });
    let found = in_cell(cell, [x, y, z]);
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
