//! Tubes along curves.

mod tube;

use super::{Allowance, parametric::tolerance};
use crate::{
    math::{self, Bounds3, DVec3},
    scene::{Attribute, Mesh, SceneError},
};
use tube::Tube;

#[cfg(test)]
mod tests;

/// How points become a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurveKind {
    /// Through all points, smooth: a Catmull-Rom spline, the tangent at a point being half of the way between its neighbors.
    #[default]
    CatmullRom,
    /// Cubic Bezier pieces: a point on the curve, two that pull it, a point on the curve, and so on.
    Bezier,
    /// Straight from point to point, with bends rounded no more than the tube is.
    Linear,
}

/// How a tube ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurveEnd {
    /// In half a ball.
    #[default]
    Round,
    /// In a disk.
    Flat,
}

/// A closed tube along a curve, its radius as smooth as the curve.
///
/// ```
/// use rtscript::{DVec3, Limits, tessellate::{Allowance, Curve, CurveEnd, CurveKind}};
/// let mut wire = Curve::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], 0.1);
/// wire.kind = CurveKind::Linear;
/// wire.ends = CurveEnd::Flat;
/// let mesh = wire.mesh(&Allowance::of(&Limits::default()))?;
/// assert!(mesh.bounds().size().x > 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Points of the curve.
    pub points: Vec<DVec3>,
    /// The radius at each point, in object units, greater than 0.
    pub radii: Vec<f64>,
    /// Default: Catmull-Rom.
    pub kind: CurveKind,
    /// Default: round.
    pub ends: CurveEnd,
    /// Whether the last point leads back to the first, without ends. Default: false.
    pub is_closed: bool,
    /// Sides of the tube, from 3 to 256. Default: 12.
    pub sides: usize,
    /// How far the middle of the tube may be off the curve, in object units. Default: a tenth of the smallest radius.
    pub tolerance: Option<f64>,
}

/// A place along the curve.
#[derive(Clone, Copy, Debug)]
struct Station {
    point: DVec3,
    radius: f64,
    tangent: DVec3,
    /// How fast the radius grows along the curve.
    growth: f64,
}

/// A cubic piece of the curve, its radius the fourth coordinate.
#[derive(Clone, Copy, Debug)]
struct Piece {
    points: [DVec3; 4],
    radii: [f64; 4],
}

/// Halvings of a piece at most.
const LEVELS: u32 = 12;

impl Piece {
    fn at(&self, t: f64) -> Station {
        let s = 1.0 - t;
        let [a, b, c, d] = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let [e, f, g] = [s * s, 2.0 * s * t, t * t];
        let [p, q, r, w] = self.points;
        let [i, j, k, l] = self.radii;
        let velocity = ((q - p) * e + (r - q) * f + (w - r) * g) * 3.0;
        let growth = ((j - i) * e + (k - j) * f + (l - k) * g) * 3.0;
        let speed = velocity.length();
        Station {
            point: p * a + q * b + r * c + w * d,
            radius: i * a + j * b + k * c + l * d,
            tangent: velocity.try_normalize().unwrap_or(DVec3::ZERO),
            growth: if speed > 0.0 { growth / speed } else { 0.0 },
        }
    }
}

impl Curve {
    /// A smooth tube with round ends and the same radius everywhere.
    #[must_use]
    pub fn new(points: Vec<DVec3>, radius: f64) -> Self {
        Self {
            radii: vec![radius; points.len()],
            points,
            kind: CurveKind::CatmullRom,
            ends: CurveEnd::Round,
            is_closed: false,
            sides: 12,
            tolerance: None,
        }
    }

    /// Its triangles: rings around the curve, turned as little as can be from one to the next (Wang, Jüttler, Zheng and
    /// Liu, "Computation of rotation minimizing frames", 2008), closed by its ends. u goes along the curve, v around it.
    ///
    /// # Errors
    /// Where there are too few points for the kind of curve, points that follow one another are the same, a radius is not
    /// greater than 0, there are not as many radii as points, or the triangles are too many.
    pub fn mesh(&self, allowance: &Allowance<'_>) -> Result<Mesh, SceneError> {
        self.check()?;
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let bound = self.tolerance.unwrap_or(smallest / 10.0);
        let mut stations = Vec::new();
        for piece in self.pieces() {
            allowance.check_stop()?;
            allowance.triangles(2 * self.sides * stations.len())?;
            divide(&piece, 0.0, 1.0, bound, LEVELS, &mut stations);
            if self.kind == CurveKind::Linear {
                stations.push(piece.at(1.0));
            }
        }
        if let Some(last) = self
            .pieces()
            .last()
            .filter(|_| self.kind != CurveKind::Linear && !self.is_closed)
        {
            stations.push(last.at(1.0));
        }
        if self.kind == CurveKind::Linear {
            stations = mitered(&stations, self.is_closed);
        }
        let rounds = self.sides.div_ceil(4).max(2);
        allowance.triangles(2 * self.sides * (stations.len() + 2 * rounds))?;
        let mut tube = Tube {
            sides: self.sides,
            ..Tube::default()
        };
        tube.around(&stations, self.is_closed, self.kind == CurveKind::Linear);
        if !self.is_closed {
            tube.end(&stations, self.ends, rounds);
        }
        let mut mesh = Mesh::new("curve", tube.positions, tube.triangles)?;
        mesh.normals = Some(Attribute {
            values: tube.normals,
            indices: tube.corners.clone(),
        });
        mesh.uvs = Some(Attribute {
            values: tube.uvs,
            indices: tube.corners,
        });
        Ok(mesh)
    }

    fn check(&self) -> Result<(), SceneError> {
        tolerance(self.tolerance)?;
        let count = self.points.len();
        let wrong = match (self.kind, self.is_closed) {
            (CurveKind::Bezier, false) if count < 4 || count % 3 != 1 => Some("4, 7, 10 ... points"),
            (CurveKind::Bezier, true) if count < 6 || !count.is_multiple_of(3) => Some("6, 9, 12 ... points"),
            (_, true) if count < 3 => Some("3 points or more"),
            (_, false) if count < 2 => Some("2 points or more"),
            _ => None,
        };
        if let Some(wanted) = wrong {
            let closed = if self.is_closed { "closed " } else { "" };
            return Err(SceneError::new(format!(
                "a {closed}curve of this kind takes {wanted}, not {count}"
            )));
        }
        if self.radii.len() != count {
            return Err(SceneError::new(format!(
                "there {} for {count} points; expected one for each",
                match self.radii.len() {
                    1 => "is 1 radius".to_owned(),
                    n => format!("are {n} radii"),
                }
            )));
        }
        if let Some((i, r)) = self
            .radii
            .iter()
            .enumerate()
            .find(|(_, r)| !(**r > 0.0 && **r <= 1e15))
        {
            return Err(SceneError::new(format!(
                "radius {i} must be greater than 0, not {r}"
            )));
        }
        if let Some(i) = self.points.iter().position(|p| !(math::max_abs(*p) <= 1e15)) {
            return Err(SceneError::new(format!(
                "point {i} is not within 1e15 of the origin"
            )));
        }
        let mut pairs = self
            .points
            .iter()
            .zip(self.points.iter().cycle().skip(1))
            .enumerate();
        let last = if self.is_closed { count } else { count - 1 };
        let same = pairs.find(|(i, (a, b))| *i < last && a == b && self.kind != CurveKind::Bezier);
        if let Some((i, _)) = same {
            let next = (i + 1) % count;
            return Err(SceneError::new(format!("points {i} and {next} are the same")));
        }
        if !(3..=256).contains(&self.sides) {
            return Err(SceneError::new(format!(
                "sides must be from 3 to 256, not {}",
                self.sides
            )));
        }
        let size = Bounds3::around(self.points.iter().copied()).size().length();
        if size == 0.0 {
            return Err(SceneError::new("all points of the curve are the same"));
        }
        Ok(())
    }

    fn pieces(&self) -> Vec<Piece> {
        let count = self.points.len();
        let at = |i: isize| -> (DVec3, f64) {
            let last = count as isize - 1;
            let value = |i: isize| {
                let i = i.rem_euclid(count.max(1) as isize) as usize;
                let point = self.points.get(i).copied().unwrap_or_default();
                (point, self.radii.get(i).copied().unwrap_or(0.0))
            };
            if self.is_closed || (0..=last).contains(&i) {
                return value(i);
            }
            // Beyond an end the curve goes on straight.
            let (end, before) = if i < 0 {
                (value(0), value(1))
            } else {
                (value(last), value(last - 1))
            };
            (end.0 * 2.0 - before.0, end.1 * 2.0 - before.1)
        };
        let steps = if self.is_closed { count } else { count - 1 };
        if self.kind == CurveKind::Bezier {
            return (0..steps / 3)
                .map(|i| {
                    let of = [0, 1, 2, 3].map(|k| at((3 * i + k) as isize));
                    Piece {
                        points: of.map(|(p, _)| p),
                        radii: of.map(|(_, r)| r),
                    }
                })
                .collect();
        }
        (0..steps as isize)
            .map(|i| {
                let [a, b, c, d] = [-1, 0, 1, 2].map(|k| at(i + k));
                if self.kind == CurveKind::Linear {
                    let along = |t: f64| (b.0 + (c.0 - b.0) * t, b.1 + (c.1 - b.1) * t);
                    let of = [b, along(1.0 / 3.0), along(2.0 / 3.0), c];
                    return Piece {
                        points: of.map(|(p, _)| p),
                        radii: of.map(|(_, r)| r),
                    };
                }
                let pull = |from: f64, p: f64, q: f64| from + (q - p) / 6.0;
                let least = b.1.min(c.1) * 0.1;
                Piece {
                    points: [b.0, b.0 + (c.0 - a.0) / 6.0, c.0 - (d.0 - b.0) / 6.0, c.0],
                    // Where radii swing, the curve of them may not swing below nothing.
                    radii: [
                        b.1,
                        pull(b.1, a.1, c.1).max(least),
                        pull(c.1, d.1, b.1).max(least),
                        c.1,
                    ],
                }
            })
            .collect()
    }
}

/// Adds the stations of a piece from `from` up to but without `to`.
fn divide(piece: &Piece, from: f64, to: f64, bound: f64, levels: u32, stations: &mut Vec<Station>) {
    let (start, end) = (piece.at(from), piece.at(to));
    let is_off = [0.25, 0.5, 0.75].into_iter().any(|t| {
        let station = piece.at(from + (to - from) * t);
        let chord = start.point + (end.point - start.point) * t;
        let radius = start.radius + (end.radius - start.radius) * t;
        !((station.point - chord).length() <= bound && (station.radius - radius).abs() <= bound)
    });
    // Directions that turn much look broken however close the chord is.
    let turns = start.tangent.dot(end.tangent) < 0.97;
    if levels > 0 && (is_off || turns) {
        let middle = from.midpoint(to);
        divide(piece, from, middle, bound, levels - 1, stations);
        divide(piece, middle, to, bound, levels - 1, stations);
    } else {
        stations.push(start);
    }
}

/// One station at each bend of straight pieces, across the middle of the angle.
fn mitered(stations: &[Station], is_closed: bool) -> Vec<Station> {
    let pairs: Vec<&[Station]> = stations.chunks(2).collect();
    let mut result = Vec::new();
    for (i, pair) in pairs.iter().enumerate() {
        let before = if i > 0 {
            pairs.get(i - 1)
        } else {
            pairs.last().filter(|_| is_closed)
        };
        let (Some(start), Some(end)) = (pair.first(), pair.last()) else {
            continue;
        };
        let tangent = before
            .and_then(|pair| pair.last())
            .map_or(start.tangent, |before| {
                (before.tangent + start.tangent)
                    .try_normalize()
                    .unwrap_or(start.tangent)
            });
        result.push(Station { tangent, ..*start });
        if i + 1 == pairs.len() && !is_closed {
            result.push(*end);
        }
    }
    result
}
