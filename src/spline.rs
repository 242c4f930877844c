//! Splines: smooth curves through points or along control points, in any number of dimensions.
//!
//! Every kind becomes cubic Bezier pieces, so that whoever works with curves has one form to deal with.

#![allow(
    clippy::indexing_slicing,
    reason = "counts are checked before pieces are made, and coordinates are below N"
)]

use std::fmt;

/// How a curve follows its points.
///
/// ```
/// use rtscript::spline::{Spline, position, tangent};
/// let pieces = Spline::CatmullRom.pieces(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]], false)?;
/// assert_eq!(position(&pieces, 1.0), Some([2.0, 0.0]));
/// assert!(tangent(&pieces, 0.0).is_some_and(|[x, y]| x > 0.0 && y > 0.0));
/// assert_eq!(Spline::of_name(Spline::CatmullRom.name()), Some(Spline::CatmullRom));
/// // A WrongCount says how many points the kind wants.
/// assert!(Spline::Bezier.pieces(&[[0.0], [1.0]], false).is_err());
/// # Ok::<(), rtscript::spline::WrongCount>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spline {
    /// Straight from point to point.
    #[default]
    Linear,
    /// Smoothly through all points, the tangent at a point being half the way between its neighbours (Catmull and
    /// Rom, "A class of local interpolating splines", 1974). At an end without neighbour the curve sets out towards
    /// the next point.
    CatmullRom,
    /// Cubic Bezier pieces one after another: a point on the curve, two control points, a point on the curve, and so
    /// on. A closed curve ends with two control points, from which it returns to its first point.
    Bezier,
}

/// A number of points that makes no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongCount {
    expected: &'static str,
    given: usize,
}

impl fmt::Display for WrongCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, not {}", self.expected, self.given)
    }
}

impl std::error::Error for WrongCount {}

impl Spline {
    /// All kinds and their names.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("linear", Self::Linear),
        ("catmullRom", Self::CatmullRom),
        ("bezier", Self::Bezier),
    ];

    /// What scripts call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::CatmullRom => "catmullRom",
            Self::Bezier => "bezier",
        }
    }

    /// The kind of this name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::NAMES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, kind)| *kind)
    }

    /// The curve's pieces in order. A closed curve returns from the last point to the first; where the last point
    /// repeats the first, it counts once.
    ///
    /// # Errors
    /// Where there are too few points, or not as many as Bezier pieces take.
    pub fn pieces<const N: usize>(
        self,
        points: &[[f64; N]],
        closed: bool,
    ) -> Result<Vec<Piece<N>>, WrongCount> {
        let given = points.len();
        let points = match points {
            [first, rest @ .., last] if closed && first == last && !rest.is_empty() => {
                points.split_last().map_or(points, |(_, without)| without)
            }
            _ => points,
        };
        let wrong = |expected| Err(WrongCount { expected, given });
        match (self, closed) {
            (Self::Bezier, false) if given < 4 || given % 3 != 1 => {
                return wrong("bezier takes 4 points, 7, 10 and so on");
            }
            (Self::Bezier, true) if points.is_empty() || !points.len().is_multiple_of(3) => {
                return wrong("a closed bezier takes 3 points, 6, 9 and so on");
            }
            (_, false) if given < 2 => return wrong("at least 2 points"),
            (Self::Linear | Self::CatmullRom, true) if points.len() < 3 => {
                return wrong("at least 3 different points");
            }
            _ => {}
        }
        let point = |k: usize| points[k % points.len()];
        let count = match (self, closed) {
            (Self::Bezier, _) => points.len() / 3,
            (_, true) => points.len(),
            (_, false) => points.len() - 1,
        };
        let piece = |i: usize| match self {
            Self::Linear => Piece::line(point(i), point(i + 1)),
            Self::Bezier => Piece(std::array::from_fn(|k| point(3 * i + k))),
            Self::CatmullRom => {
                let (a, b) = (point(i), point(i + 1));
                let before = match i {
                    0 if !closed => mix(a, b, -1.0),
                    _ => point(i + points.len() - 1),
                };
                let beyond = if !closed && i + 2 == points.len() {
                    mix(a, b, 2.0)
                } else {
                    point(i + 2)
                };
                Piece::through(before, a, b, beyond)
            }
        };
        Ok((0..count).map(piece).collect())
    }
}

fn mix<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    std::array::from_fn(|k| a[k] * (1.0 - t) + b[k] * t)
}

/// A cubic Bezier curve by its four control points (de Casteljau; Farin, "Curves and Surfaces for CAGD", 2002,
/// chapter 4).
///
/// ```
/// use rtscript::spline::Piece;
/// let piece = Piece::line([0.0, 0.0], [3.0, 0.0]);
/// assert_eq!(piece.position(0.5), [1.5, 0.0]);
/// assert_eq!((piece.derivative(0.5), piece.tangent(0.5)), ([3.0, 0.0], [3.0, 0.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<const N: usize>(pub [[f64; N]; 4]);

impl<const N: usize> Piece<N> {
    /// The straight line from `a` to `b`, at even speed.
    #[must_use]
    pub fn line(a: [f64; N], b: [f64; N]) -> Self {
        Self([a, mix(a, b, 1.0 / 3.0), mix(b, a, 1.0 / 3.0), b])
    }

    /// The Catmull-Rom piece from `a` to `b` between their neighbours.
    ///
    /// ```
    /// use rtscript::spline::Piece;
    /// // From (0, 0) to (2, 1), as a curve that comes from (-2, 1) and goes on to (4, 0).
    /// let piece = Piece::through([-2.0, 1.0], [0.0, 0.0], [2.0, 1.0], [4.0, 0.0]);
    /// assert_eq!((piece.position(0.0), piece.position(1.0)), ([0.0, 0.0], [2.0, 1.0]));
    /// // It leaves a point parallel to the line between its neighbours, and x goes evenly here.
    /// assert_eq!(piece.tangent(0.0), [2.0, 0.0]);
    /// let thirds = [0.0, 2.0 / 3.0, 4.0 / 3.0, 2.0];
    /// assert!(piece.coordinate(0).iter().zip(thirds).all(|(x, third)| (x - third).abs() < 1e-12));
    /// ```
    #[must_use]
    pub fn through(before: [f64; N], a: [f64; N], b: [f64; N], beyond: [f64; N]) -> Self {
        let from = std::array::from_fn(|k| a[k] + (b[k] - before[k]) / 6.0);
        let to = std::array::from_fn(|k| b[k] - (beyond[k] - a[k]) / 6.0);
        Self([a, from, to, b])
    }

    /// Coordinate `k` of the control points.
    #[must_use]
    pub fn coordinate(&self, k: usize) -> [f64; 4] {
        self.0.map(|p| p.get(k).copied().unwrap_or(0.0))
    }

    /// The point at `u` in [0, 1].
    #[must_use]
    pub fn position(&self, u: f64) -> [f64; N] {
        self.levels(u).0
    }

    /// The derivative at `u` in [0, 1].
    #[must_use]
    pub fn derivative(&self, u: f64) -> [f64; N] {
        self.levels(u).1
    }

    /// Point and derivative.
    fn levels(&self, u: f64) -> ([f64; N], [f64; N]) {
        let [a, b, c, d] = self.0;
        let (ab, bc, cd) = (mix(a, b, u), mix(b, c, u), mix(c, d, u));
        let (abc, bcd) = (mix(ab, bc, u), mix(bc, cd, u));
        let slope = std::array::from_fn(|k| 3.0 * (bcd[k] - abc[k]));
        (mix(abc, bcd, u), slope)
    }

    /// The direction of travel at `u`, not a unit vector: where the derivative vanishes because control points
    /// fall together, that in which the curve goes on.
    #[must_use]
    pub fn tangent(&self, u: f64) -> [f64; N] {
        let derivative = self.derivative(u);
        if derivative.iter().any(|x| *x != 0.0) {
            return derivative;
        }
        let [a, b, c, d] = self.0;
        let chords = if u <= 0.5 {
            [(a, b), (a, c), (a, d)]
        } else {
            [(c, d), (b, d), (a, d)]
        };
        let chord = |(p, q): ([f64; N], [f64; N])| std::array::from_fn(|k| q[k] - p[k]);
        let mut directions = chords.map(chord).into_iter();
        directions
            .find(|d: &[f64; N]| d.iter().any(|x| *x != 0.0))
            .unwrap_or([0.0; N])
    }
}

/// The piece at `t` in [0, 1] along a curve, every piece taking the same part of it, and the parameter there;
/// `None` where there is no piece.
fn at<const N: usize>(pieces: &[Piece<N>], t: f64) -> Option<(&Piece<N>, f64)> {
    let along = t.clamp(0.0, 1.0) * pieces.len() as f64;
    // NaN becomes the first.
    let i = (along as usize).min(pieces.len().checked_sub(1)?);
    Some((pieces.get(i)?, (along - i as f64).clamp(0.0, 1.0)))
}

/// The point at `t` in [0, 1] along a curve of several pieces, each taking the same part of it; `None` where there
/// are no pieces.
///
/// ```
/// use rtscript::spline::{Piece, position};
/// let pieces = [Piece::line([0.0], [1.0]), Piece::line([1.0], [5.0])];
/// assert_eq!(position(&pieces, 0.75), Some([3.0]));
/// ```
#[must_use]
pub fn position<const N: usize>(pieces: &[Piece<N>], t: f64) -> Option<[f64; N]> {
    at(pieces, t).map(|(piece, u)| piece.position(u))
}

/// The direction of travel at `t` as in [`position()`], not a unit vector.
///
/// ```
/// use rtscript::spline::{Piece, tangent};
/// let pieces = [Piece::line([0.0, 0.0], [0.0, 2.0])];
/// assert_eq!(tangent(&pieces, 0.3), Some([0.0, 2.0]));
/// ```
#[must_use]
pub fn tangent<const N: usize>(pieces: &[Piece<N>], t: f64) -> Option<[f64; N]> {
    at(pieces, t).map(|(piece, u)| piece.tangent(u))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 2.0], [3.0, 1.0], [4.0, -2.0], [0.5, -3.0]];

    #[test]
    fn curves_pass_their_points_smoothly() {
        for closed in [false, true] {
            let pieces = Spline::CatmullRom.pieces(&POINTS, closed).unwrap();
            assert_eq!(pieces.len(), if closed { 5 } else { 4 });
            for (i, piece) in pieces.iter().enumerate() {
                assert_eq!(piece.position(0.0), POINTS[i]);
                assert_eq!(piece.position(1.0), POINTS[(i + 1) % 5]);
                let Some(next) = pieces.get((i + 1) % 5) else {
                    continue;
                };
                let (out, on) = (piece.derivative(1.0), next.derivative(0.0));
                assert!((0..2).all(|k| (out[k] - on[k]).abs() < 1e-14), "{i}");
            }
        }
        let pieces = Spline::CatmullRom.pieces(&POINTS, false).unwrap();
        // Half the way from the neighbour before to the one after.
        let along = tangent(&pieces, 0.25).unwrap();
        assert!((along[0] - 1.5).abs() < 1e-14 && (along[1] - 0.5).abs() < 1e-14);
        assert_eq!(position(&pieces, 0.5), Some(POINTS[2]));
        assert_eq!(position(&pieces, 7.0), Some(POINTS[4]));
        assert_eq!(position::<2>(&[], 0.5), None);
    }

    #[test]
    fn derivatives_are_those_of_positions() {
        for kind in [Spline::Linear, Spline::CatmullRom] {
            for piece in kind.pieces(&POINTS, true).unwrap() {
                for u in [0.1, 0.4, 0.9] {
                    let (a, b) = (piece.position(u - 1e-6), piece.position(u + 1e-6));
                    let slope = piece.derivative(u);
                    assert!((0..2).all(|k| ((b[k] - a[k]) / 2e-6 - slope[k]).abs() < 1e-8));
                }
            }
        }
    }

    #[test]
    fn bezier_pieces_share_their_ends() {
        let points: Vec<[f64; 1]> = (0..7).map(|i| [f64::from(i * i)]).collect();
        let open = Spline::Bezier.pieces(&points, false).unwrap();
        assert_eq!(open[1].0, [[9.0], [16.0], [25.0], [36.0]]);
        let closed = Spline::Bezier.pieces(&points[..6], true).unwrap();
        assert_eq!(closed[1].0, [[9.0], [16.0], [25.0], [0.0]]);
        let error = Spline::Bezier.pieces(&points[..5], false).unwrap_err();
        assert_eq!(error.to_string(), "bezier takes 4 points, 7, 10 and so on, not 5");
    }

    #[test]
    fn a_closed_curve_counts_a_repeated_end_once() {
        let mut points = POINTS.to_vec();
        points.push(POINTS[0]);
        for kind in [Spline::Linear, Spline::CatmullRom] {
            assert_eq!(kind.pieces(&points, true), kind.pieces(&POINTS, true));
        }
        assert!(
            Spline::Linear
                .pieces(&[POINTS[0], POINTS[1], POINTS[0]], true)
                .is_err()
        );
        assert!(Spline::Linear.pieces(&POINTS[..1], false).is_err());
        assert!(Spline::Bezier.pieces::<2>(&[], true).is_err());
    }

    #[test]
    fn where_control_points_fall_together_the_tangent_looks_on() {
        let piece = Piece([[0.0, 0.0], [0.0, 0.0], [0.0, 2.0], [1.0, 2.0]]);
        assert_eq!(piece.tangent(0.0), [0.0, 2.0]);
        let piece = Piece([[0.0, 0.0], [0.0, 1.0], [3.0, 3.0], [3.0, 3.0]]);
        assert_eq!(piece.tangent(1.0), [3.0, 2.0]);
        assert_eq!(Piece([[1.0]; 4]).tangent(0.5), [0.0]);
    }

    #[test]
    fn names_lead_back() {
        for (name, kind) in Spline::NAMES {
            assert_eq!(Spline::of_name(name), Some(kind));
            assert_eq!(kind.name(), name);
        }
        assert_eq!(Spline::of_name("cubic"), None);
    }
}
