//! The triangles around a curve.

use super::{CurveEnd, Station};
use crate::math::{self, DVec2, DVec3};

/// Rings and what joins them.
#[derive(Default)]
pub(super) struct Tube {
    pub(super) sides: usize,
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Of normals and uvs.
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) frames: Vec<(DVec3, DVec3)>,
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

    pub(super) fn around(&mut self, stations: &[Station], is_closed: bool, is_linear: bool) {
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
    pub(super) fn end(&mut self, stations: &[Station], ends: CurveEnd, rounds: usize) {
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
