//! Places of samples by what a pixel filter says.

#![allow(
    clippy::indexing_slicing,
    reason = "cells are found below the length of the tables"
)]

use crate::{
    math::{PI, cos, exp, powi},
    scene::{Filter, FilterKind},
};

/// Pieces that a filter is cut into, in each of which it is taken to be even.
const CELLS: usize = 1024;

/// A filter along one axis, ready to draw from.
#[derive(Debug)]
pub(super) struct Places {
    radius: f64,
    /// The share of the filter, without signs, up to the end of each cell.
    shares: Vec<f64>,
    /// The cells at which the filter is below 0.
    is_negative: Vec<bool>,
}

impl Places {
    /// Tables for a filter; `None` for the pixel itself, which needs none.
    pub(super) fn new(filter: &Filter) -> Option<Self> {
        if filter.is_pixel() {
            return None;
        }
        let values: Vec<f64> = (0..CELLS)
            .map(|i| value(filter, cell(i, 0.5) * filter.radius))
            .collect();
        let total: f64 = values.iter().map(|v| v.abs()).sum();
        let mut sum = 0.0;
        let mut shares: Vec<f64> = values
            .iter()
            .map(|v| {
                sum += v.abs();
                sum / total
            })
            .collect();
        if let Some(last) = shares.last_mut() {
            *last = 1.0;
        }
        Some(Self {
            radius: filter.radius,
            shares,
            is_negative: values.iter().map(|v| *v < 0.0).collect(),
        })
    }

    /// How far from the middle of a pixel the sample lies that an even number in [0, 1) stands for, and the sign of the
    /// filter there.
    pub(super) fn place(&self, u: f64) -> (f64, f64) {
        let i = self.shares.partition_point(|share| *share <= u).min(CELLS - 1);
        let before = if i == 0 { 0.0 } else { self.shares[i - 1] };
        let width = self.shares[i] - before;
        let within = if width > 0.0 { (u - before) / width } else { 0.5 };
        let sign = if self.is_negative[i] { -1.0 } else { 1.0 };
        (cell(i, within) * self.radius, sign)
    }
}

/// A place in a cell, in radii from the middle.
fn cell(i: usize, within: f64) -> f64 {
    (i as f64 + within) * (2.0 / CELLS as f64) - 1.0
}

/// A filter at `x` pixels from the middle, not normalized.
fn value(filter: &Filter, x: f64) -> f64 {
    let r = filter.radius;
    let x = x.abs();
    match filter.kind {
        FilterKind::Box => 1.0,
        FilterKind::Tent => 1.0 - x / r,
        FilterKind::Gaussian => {
            let bell = |x: f64| exp(-4.5 * (x / r) * (x / r));
            bell(x) - bell(r)
        }
        FilterKind::Mitchell => {
            // B = C = 1/3, on [0, 2].
            let x = 2.0 * x / r;
            if x < 1.0 {
                7.0 * powi(x, 3) - 12.0 * powi(x, 2) + 16.0 / 3.0
            } else {
                -7.0 / 3.0 * powi(x, 3) + 12.0 * powi(x, 2) - 20.0 * x + 32.0 / 3.0
            }
        }
        FilterKind::BlackmanHarris => {
            let angle = PI * (x / r + 1.0);
            0.35875 - 0.48829 * cos(angle) + 0.14128 * cos(2.0 * angle) - 0.01168 * cos(3.0 * angle)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filters() -> impl Iterator<Item = Filter> {
        FilterKind::NAMES
            .into_iter()
            .map(|(_, kind)| Filter::new(kind))
            .chain([Filter {
                kind: FilterKind::Box,
                radius: 1.25,
            }])
    }

    #[test]
    fn places_are_as_dense_as_the_filter_says() {
        const BINS: usize = 16;
        const N: usize = 160_000;
        for filter in filters() {
            let Some(places) = Places::new(&filter) else {
                assert!(filter.is_pixel());
                continue;
            };
            let mut bins = [0.0; BINS];
            for i in 0..N {
                let (x, sign) = places.place((i as f64 + 0.5) / N as f64);
                assert!(x.abs() <= filter.radius);
                let bin = ((x / filter.radius + 1.0) * 0.5 * BINS as f64) as usize;
                bins[bin.min(BINS - 1)] += sign / N as f64;
            }
            // The integral of the filter over each bin, and of its absolute value over all, by Simpson's rule.
            let integral = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| {
                let step = (to - from) / 2000.0;
                let sum: f64 = (0..1000)
                    .map(|i| {
                        let x = from + f64::from(i) * 2.0 * step;
                        f(x) + 4.0 * f(x + step) + f(x + 2.0 * step)
                    })
                    .sum();
                sum * step / 3.0
            };
            let f = |x: f64| value(&filter, x);
            let r = filter.radius;
            let all = integral(-r, r, &|x| f(x).abs());
            for (i, got) in bins.iter().enumerate() {
                let edge = |i: usize| (i as f64 / BINS as f64 * 2.0 - 1.0) * r;
                let wanted = integral(edge(i), edge(i + 1), &f) / all;
                assert!((got - wanted).abs() < 1e-4, "{filter:?} bin {i}: {got} {wanted}");
            }
        }
    }

    #[test]
    fn filters_are_what_their_authors_say() {
        let at = |kind, x| value(&Filter::new(kind), x);
        assert!((at(FilterKind::Mitchell, 0.0) / 6.0 - 8.0 / 9.0).abs() < 1e-15);
        assert!((at(FilterKind::Mitchell, 1.0) / 6.0 - 1.0 / 18.0).abs() < 1e-15);
        assert!(at(FilterKind::Mitchell, 1.5) < 0.0 && at(FilterKind::Mitchell, 2.0).abs() < 1e-14);
        // Two pieces of one curve.
        let (a, b) = (
            at(FilterKind::Mitchell, 1.0 - 1e-9),
            at(FilterKind::Mitchell, 1.0),
        );
        assert!((a - b).abs() < 1e-7);
        assert!((at(FilterKind::BlackmanHarris, 0.0) - 1.0).abs() < 1e-12);
        assert!((at(FilterKind::BlackmanHarris, 1.5) - 6e-5).abs() < 1e-12);
        assert!(at(FilterKind::Gaussian, 1.5).abs() < 1e-15);
        for (_, kind) in FilterKind::NAMES {
            let x = kind.usual_radius() * 0.3;
            assert_eq!(at(kind, x).to_bits(), at(kind, -x).to_bits());
        }
    }
}
