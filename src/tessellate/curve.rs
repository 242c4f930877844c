//! Tubes along curves.

use super::{Allowance, parametric::tolerance};
use crate::{
    math::{self, Bounds3, DVec2, DVec3},
    scene::{Attribute, Mesh, SceneError},
};

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
                "there are {} radii for {count} points; expected one for each",
                self.radii.len()
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

/// Rings and what joins them.
#[derive(Default)]
struct Tube {
    sides: usize,
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// Of normals and uvs.
    corners: Vec<[u32; 3]>,
    frames: Vec<(DVec3, DVec3)>,
}

impl Tube {
    /// Two directions across each station, turned as little as can be; where the curve is closed, the turn that is left is
    /// spread over all of it.
    fn find_frames(&mut self, stations: &[Station], is_closed: bool) {
        let Some(first) = stations.first() else { return };
        let mut across = first.tangent.any_orthonormal_vector();
        let mut turned = vec![across];
        let next = stations
            .iter()
            .skip(1)
            .chain(stations.first().filter(|_| is_closed));
        for (a, b) in stations.iter().zip(next) {
            // Two reflections: in the plane between the points, and so that tangents agree.
            let v = b.point - a.point;
            let c = v.length_squared();
            let reflect = |x: DVec3, v: DVec3, c: f64| if c > 0.0 { x - v * (2.0 / c * v.dot(x)) } else { x };
            let (r, t) = (reflect(across, v, c), reflect(a.tangent, v, c));
            let w = b.tangent - t;
            let r = reflect(r, w, w.length_squared());
            // Rounding, and tangents of no length, must not tilt the ring.
            across = (r - b.tangent * r.dot(b.tangent))
                .try_normalize()
                .unwrap_or(across);
            turned.push(across);
        }
        let mut missing = 0.0;
        if is_closed && let Some(last) = turned.pop() {
            let start = turned.first().copied().unwrap_or(last);
            missing = math::atan2(first.tangent.dot(last.cross(start)), last.dot(start));
        }
        let count = turned.len() as f64;
        let frames = turned
            .iter()
            .zip(stations)
            .enumerate()
            .map(|(i, (across, station))| {
                let angle = missing * i as f64 / count;
                let other = station.tangent.cross(*across);
                let across = *across * math::cos(angle) + other * math::sin(angle);
                (across, station.tangent.cross(across))
            });
        self.frames = frames.collect();
    }

    /// The direction of a side in a frame.
    fn side(&self, (across, other): (DVec3, DVec3), side: usize) -> DVec3 {
        let (sin, cos) = math::sin_cos_degrees(360.0 * side as f64 / self.sides as f64);
        across * cos + other * sin
    }

    fn around(&mut self, stations: &[Station], is_closed: bool, is_linear: bool) {
        self.find_frames(stations, is_closed);
        let mut lengths = vec![0.0];
        let mut length = 0.0;
        let next = stations
            .iter()
            .skip(1)
            .chain(stations.first().filter(|_| is_closed));
        for (a, b) in stations.iter().zip(next) {
            length += (b.point - a.point).length();
            lengths.push(length);
        }
        let count = stations.len();
        for i in 0..count {
            let (Some(station), Some(frame)) = (stations.get(i), self.frames.get(i).copied()) else {
                continue;
            };
            let stretched = if is_linear {
                miter(stations, i, is_closed)
            } else {
                None
            };
            for side in 0..self.sides {
                let mut out = self.side(frame, side);
                let normal = (out - station.tangent * station.growth).normalize();
                if let Some((bend, factor)) = stretched {
                    // A ring across the middle of an angle is longer where it lies in the angle.
                    out += bend * (out.dot(bend) * (factor - 1.0));
                }
                self.positions.push(station.point + out * station.radius);
                self.normals.push(normal);
            }
        }
        // uvs have a column more than positions: the seam is 1 on one side and 0 on the other.
        let rings = if is_closed { count + 1 } else { count };
        for ring in 0..rings {
            let u = if length > 0.0 {
                lengths.get(ring).copied().unwrap_or(length) / length
            } else {
                0.0
            };
            for side in 0..=self.sides {
                self.uvs.push(DVec2::new(u, side as f64 / self.sides as f64));
            }
        }
        let wide = self.sides + 1;
        // Normals go with the uvs.
        let normals = std::mem::take(&mut self.normals);
        for ring in 0..rings {
            for side in 0..wide {
                let at = ring % count.max(1) * self.sides + side % self.sides;
                self.normals.push(normals.get(at).copied().unwrap_or(DVec3::Y));
            }
        }
        for ring in 0..if is_closed { count } else { count.saturating_sub(1) } {
            let after = (ring + 1) % count.max(1);
            for side in 0..self.sides {
                let next = (side + 1) % self.sides;
                let id = |ring: usize, side: usize| (ring * self.sides + side) as u32;
                let own = |ring: usize, side: usize| (ring * wide + side) as u32;
                let (a, b, c, d) = (id(ring, side), id(ring, next), id(after, next), id(after, side));
                let (e, f, g, h) = (
                    own(ring, side),
                    own(ring, side + 1),
                    own(ring + 1, side + 1),
                    own(ring + 1, side),
                );
                self.triangles.extend([[a, b, c], [a, c, d]]);
                self.corners.extend([[e, f, g], [e, g, h]]);
            }
        }
    }

    fn add_own(&mut self, normal: DVec3, uv: DVec2) -> u32 {
        self.normals.push(normal);
        self.uvs.push(uv);
        self.normals.len() as u32 - 1
    }

    /// Closes both ends.
    fn end(&mut self, stations: &[Station], ends: CurveEnd, rounds: usize) {
        let last = stations.len().saturating_sub(1);
        for (at, way, u) in [(0, -1.0, 0.0), (last, 1.0, 1.0)] {
            let (Some(station), Some(frame)) = (stations.get(at).copied(), self.frames.get(at).copied())
            else {
                continue;
            };
            let out = station.tangent * way;
            let mut ring: Vec<u32> = (0..self.sides)
                .map(|side| (at * self.sides + side) as u32)
                .collect();
            let uv = |side: usize, sides: usize| DVec2::new(u, side as f64 / sides as f64);
            let (mut own, rounds) = match ends {
                CurveEnd::Flat => {
                    let flat = (0..self.sides).map(|side| self.add_own(out, uv(side, self.sides)));
                    (flat.collect::<Vec<u32>>(), 0)
                }
                CurveEnd::Round => {
                    let round: Vec<u32> = (0..self.sides)
                        .map(|side| {
                            let normal = self.side(frame, side);
                            self.add_own(normal, uv(side, self.sides))
                        })
                        .collect();
                    (round, rounds)
                }
            };
            for round in 1..rounds {
                let (sin, cos) = math::sin_cos_degrees(90.0 * round as f64 / rounds as f64);
                let (mut next_ring, mut next_own) = (Vec::new(), Vec::new());
                for side in 0..self.sides {
                    let normal = self.side(frame, side) * cos + out * sin;
                    self.positions.push(station.point + normal * station.radius);
                    next_ring.push(self.positions.len() as u32 - 1);
                    next_own.push(self.add_own(normal, uv(side, self.sides)));
                }
                self.join((&ring, &own), (&next_ring, &next_own), way > 0.0);
                (ring, own) = (next_ring, next_own);
            }
            let tip = match ends {
                CurveEnd::Flat => station.point,
                CurveEnd::Round => station.point + out * station.radius,
            };
            self.positions.push(tip);
            let (tip, tip_own) = (
                self.positions.len() as u32 - 1,
                self.add_own(out, DVec2::new(u, 0.5)),
            );
            let next = ring.iter().zip(&own).cycle().skip(1);
            for ((a, e), (b, f)) in ring.iter().zip(&own).zip(next) {
                if way > 0.0 {
                    self.triangles.push([*a, *b, tip]);
                    self.corners.push([*e, *f, tip_own]);
                } else {
                    self.triangles.push([*b, *a, tip]);
                    self.corners.push([*f, *e, tip_own]);
                }
            }
        }
    }

    /// Joins two rings, each with its positions and what else its corners have.
    fn join(
        &mut self,
        (ring, own): (&[u32], &[u32]),
        (next_ring, next_own): (&[u32], &[u32]),
        forwards: bool,
    ) {
        let at = |list: &[u32], i: usize| list.get(i % list.len().max(1)).copied().unwrap_or(0);
        for side in 0..self.sides {
            for (list, next, to) in [
                (ring, next_ring, &mut self.triangles),
                (own, next_own, &mut self.corners),
            ] {
                let (a, b) = (at(list, side), at(list, side + 1));
                let (c, d) = (at(next, side + 1), at(next, side));
                to.extend(if forwards {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[b, a, d], [b, d, c]]
                });
            }
        }
    }
}

/// The direction into the angle at a station of straight pieces, and by how much the ring is longer there, at most 4 times.
fn miter(stations: &[Station], i: usize, is_closed: bool) -> Option<(DVec3, f64)> {
    let count = stations.len();
    let before = match i.checked_sub(1) {
        Some(before) => before,
        None if is_closed => count - 1,
        None => return None,
    };
    let after = if i + 1 < count {
        i + 1
    } else if is_closed {
        0
    } else {
        return None;
    };
    let (a, b, c) = (stations.get(before)?, stations.get(i)?, stations.get(after)?);
    let (coming, going) = ((b.point - a.point).normalize(), (c.point - b.point).normalize());
    let bend = (going - coming).try_normalize()?;
    let bend = (bend - b.tangent * bend.dot(b.tangent)).try_normalize()?;
    let half = b.tangent.dot(coming).max(0.25);
    Some((bend, 1.0 / half))
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::Limits;

    fn made(curve: &Curve) -> Mesh {
        curve.mesh(&Allowance::of(&Limits::default())).unwrap()
    }

    fn random_points(rng: &mut suite::Rng, count: usize) -> Vec<DVec3> {
        (0..count)
            .map(|i| DVec3::new(i as f64 * 2.0, 1.5 * rng.unit(), 1.5 * rng.unit()))
            .collect()
    }

    #[test]
    fn tubes_of_every_kind_are_closed() {
        let mut rng = suite::Rng::new(11);
        for kind in [CurveKind::CatmullRom, CurveKind::Bezier, CurveKind::Linear] {
            for ends in [CurveEnd::Round, CurveEnd::Flat] {
                for is_closed in [false, true] {
                    for sides in [3, 4, 13] {
                        let count = if is_closed { 9 } else { 7 };
                        let mut curve = Curve::new(random_points(&mut rng, count), 0.2);
                        if is_closed {
                            for (i, p) in curve.points.iter_mut().enumerate() {
                                let (sin, cos) = math::sin_cos_degrees(40.0 * i as f64);
                                *p = DVec3::new(4.0 * cos, p.y, 4.0 * sin);
                            }
                        }
                        curve.radii.iter_mut().for_each(|r| *r += 0.2 * rng.unit());
                        (curve.kind, curve.ends, curve.is_closed, curve.sides) =
                            (kind, ends, is_closed, sides);
                        let mesh = made(&curve);
                        suite::check_closed(&mesh);
                        suite::check_normals(&mesh, if sides > 4 { 0.2 } else { 0.0 });
                        assert_eq!(
                            mesh.normals.as_ref().unwrap().values.len(),
                            mesh.uvs.as_ref().unwrap().values.len()
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_straight_tube_is_a_cylinder_and_a_ring_a_torus() {
        let mut rod = Curve::new(vec![DVec3::ZERO, DVec3::X * 5.0], 0.5);
        rod.sides = 64;
        rod.ends = CurveEnd::Flat;
        let share = |volume: f64, exact: f64| 1.0 - volume / exact;
        let less = share(suite::volume(&made(&rod)), math::PI * 0.25 * 5.0);
        assert!(less > 0.0 && less < 0.002, "{less}");
        rod.ends = CurveEnd::Round;
        let less = share(suite::volume(&made(&rod)), math::PI * (0.25 * 5.0 + 0.5 / 3.0));
        assert!(less > 0.0 && less < 0.005, "{less}");
        let corners = (0..16).map(|i| {
            let (sin, cos) = math::sin_cos_degrees(22.5 * f64::from(i));
            DVec3::new(3.0 * cos, 0.0, 3.0 * sin)
        });
        let mut ring = Curve::new(corners.collect(), 0.5);
        (ring.is_closed, ring.sides, ring.tolerance) = (true, 64, Some(0.0005));
        let less = share(
            suite::volume(&made(&ring)),
            2.0 * math::PI * math::PI * 3.0 * 0.25,
        );
        assert!(less.abs() < 0.01, "{less}");
    }

    #[test]
    fn the_middle_is_within_the_tolerance() {
        let mut rng = suite::Rng::new(12);
        for bound in [0.1, 0.01, 0.001] {
            let mut curve = Curve::new(random_points(&mut rng, 6), 0.3);
            (curve.tolerance, curve.sides) = (Some(bound), 8);
            let mesh = made(&curve);
            // The middle of each ring, found again from its corners.
            let rings: Vec<DVec3> = mesh
                .positions
                .chunks(8)
                .map(|ring| ring.iter().sum::<DVec3>() / 8.0)
                .collect();
            let ends: Vec<(DVec3, DVec3)> = rings.windows(2).map(|w| (w[0], w[1])).collect();
            for piece in curve.pieces() {
                for i in 0..=200 {
                    let p = piece.at(f64::from(i) / 200.0).point;
                    let off = ends.iter().map(|(a, b)| {
                        let t = ((p - *a).dot(*b - *a) / (*b - *a).length_squared()).clamp(0.0, 1.0);
                        (*a + (*b - *a) * t - p).length()
                    });
                    let off = off.fold(f64::INFINITY, f64::min);
                    assert!(off <= bound * 1.01, "{off} for {bound}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let message = |curve: &Curve| {
            curve
                .mesh(&Allowance::of(&Limits::default()))
                .unwrap_err()
                .message
        };
        let mut curve = Curve::new(vec![DVec3::X], 1.0);
        assert_eq!(
            message(&curve),
            "a curve of this kind takes 2 points or more, not 1"
        );
        curve = Curve::new(vec![DVec3::X, DVec3::X, DVec3::Y], 1.0);
        assert_eq!(message(&curve), "points 0 and 1 are the same");
        curve.points[0] = DVec3::Z;
        curve.radii[2] = 0.0;
        assert_eq!(message(&curve), "radius 2 must be greater than 0, not 0");
        curve.radii.pop();
        assert_eq!(
            message(&curve),
            "there are 2 radii for 3 points; expected one for each"
        );
        curve.kind = CurveKind::Bezier;
        assert_eq!(
            message(&curve),
            "a curve of this kind takes 4, 7, 10 ... points, not 3"
        );
    }
}
