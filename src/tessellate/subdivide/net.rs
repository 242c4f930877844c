//! A closed or open net of polygons on its way to a smooth surface: who meets whom, and where everything moves.

use std::collections::BTreeMap;

use super::corners::{AtCorners, Linear, divided};
use crate::{
    color::Color,
    math::{self, DVec2, DVec3, PI},
    scene::{Attribute, Mesh, SceneError},
    tessellate::Allowance,
};

/// An edge by its ends, the smaller first.
pub(super) type Edge = (u32, u32);

const fn edge(a: u32, b: u32) -> Edge {
    if a < b { (a, b) } else { (b, a) }
}

pub(super) struct Net {
    pub(super) positions: Vec<DVec3>,
    pub(super) faces: Vec<Vec<u32>>,
    /// As [`Cage::uvs`].
    pub(super) uvs: Vec<Vec<DVec2>>,
    /// As [`Cage::colors`].
    pub(super) colors: Vec<Vec<Color>>,
    pub(super) creases: BTreeMap<Edge, f64>,
}

/// What lies next to what.
pub(super) struct Topology {
    /// The faces at each edge: one or two.
    pub(super) edges: BTreeMap<Edge, [u32; 2]>,
    /// Edges from each corner, by the corners at their other ends, ascending.
    neighbors: Vec<Vec<u32>>,
    /// Faces at each corner, ascending.
    faces: Vec<Vec<u32>>,
}

const NO_FACE: u32 = u32::MAX;

fn corners_of(face: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    face.iter().copied().zip(face.iter().copied().cycle().skip(1))
}

impl Net {
    pub(super) fn topology(&self, allowance: &Allowance<'_>) -> Result<Topology, SceneError> {
        let mut directed: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut faces = vec![Vec::new(); self.positions.len()];
        for (id, face) in (0..).zip(&self.faces) {
            allowance.check_stop_at(id as usize)?;
            for (a, b) in corners_of(face) {
                if let Some(other) = directed.insert((a, b), id) {
                    return Err(SceneError::new(format!(
                        "faces {other} and {id} both run from corner {a} to corner {b}"
                    ))
                    .hint("at an edge two faces meet, which run along it in opposite directions"));
                }
                if let Some(list) = faces.get_mut(a as usize) {
                    list.push(id);
                }
            }
        }
        let mut edges: BTreeMap<Edge, [u32; 2]> = BTreeMap::new();
        let mut neighbors = vec![Vec::new(); self.positions.len()];
        for (i, (&(a, b), &face)) in directed.iter().enumerate() {
            allowance.check_stop_at(i)?;
            let opposite = directed.get(&(b, a)).copied().unwrap_or(NO_FACE);
            if edges.insert(edge(a, b), [face, opposite]).is_none() {
                for (from, to) in [(a, b), (b, a)] {
                    if let Some(list) = neighbors.get_mut(from as usize) {
                        list.push(to);
                    }
                }
            }
        }
        neighbors
            .iter_mut()
            .for_each(|list: &mut Vec<u32>| list.sort_unstable());
        Ok(Topology {
            edges,
            neighbors,
            faces,
        })
    }

    fn at(&self, corner: u32) -> DVec3 {
        self.positions.get(corner as usize).copied().unwrap_or_default()
    }

    fn face(&self, face: u32) -> &[u32] {
        self.faces.get(face as usize).map_or(&[], |face| face)
    }

    fn center(&self, face: &[u32]) -> DVec3 {
        face.iter().map(|corner| self.at(*corner)).sum::<DVec3>() / face.len() as f64
    }

    /// How sharp an edge is: endlessly at the rim.
    fn sharpness(&self, topology: &Topology, edge: Edge) -> f64 {
        match topology.edges.get(&edge) {
            Some([_, NO_FACE]) => f64::INFINITY,
            _ => self.creases.get(&edge).copied().unwrap_or(0.0),
        }
    }

    /// The ends of the sharp edges at a corner, and the mean of their sharpness.
    fn sharp_at(&self, topology: &Topology, corner: u32) -> (Vec<u32>, f64) {
        let neighbors = topology
            .neighbors
            .get(corner as usize)
            .map_or(&[][..], |list| list);
        let mut sum = 0.0;
        let mut sharp = Vec::new();
        for &other in neighbors {
            let sharpness = self.sharpness(topology, edge(corner, other));
            if sharpness > 0.0 {
                sharp.push(other);
                sum += sharpness;
            }
        }
        let mean = if sharp.is_empty() {
            0.0
        } else {
            sum / sharp.len() as f64
        };
        (sharp, mean)
    }

    /// Where a corner goes in one step.
    fn moved(&self, topology: &Topology, corner: u32, is_loop: bool) -> DVec3 {
        let p = self.at(corner);
        let (sharp, sharpness) = self.sharp_at(topology, corner);
        let hard = match sharp[..] {
            [a, b] => (self.at(a) + self.at(b) + p * 6.0) / 8.0,
            _ if sharp.len() > 2 => p,
            _ => return self.smooth(topology, corner, is_loop),
        };
        if sharpness >= 1.0 {
            return hard;
        }
        // Semi-sharp (DeRose, Kass and Truong, "Subdivision surfaces in character animation", 1998).
        self.smooth(topology, corner, is_loop).lerp(hard, sharpness)
    }

    fn smooth(&self, topology: &Topology, corner: u32, is_loop: bool) -> DVec3 {
        let p = self.at(corner);
        let neighbors = topology
            .neighbors
            .get(corner as usize)
            .map_or(&[][..], |list| list);
        let faces = topology.faces.get(corner as usize).map_or(&[][..], |list| list);
        if neighbors.is_empty() || faces.is_empty() {
            return p;
        }
        let n = neighbors.len() as f64;
        let sum: DVec3 = neighbors.iter().map(|other| self.at(*other)).sum();
        if is_loop {
            let beta = loop_weight(neighbors.len());
            return p * (1.0 - n * beta) + sum * beta;
        }
        let centers: DVec3 = faces.iter().map(|face| self.center(self.face(*face))).sum();
        let middles = (sum / n + p) / 2.0;
        (centers / faces.len() as f64 + middles * 2.0 + p * (n - 3.0)) / n
    }

    /// The new corner of an edge.
    fn middle(&self, topology: &Topology, edge: Edge, faces: [u32; 2], is_loop: bool) -> DVec3 {
        let (a, b) = edge;
        let middle = (self.at(a) + self.at(b)) / 2.0;
        let sharpness = self.sharpness(topology, edge);
        if sharpness >= 1.0 {
            return middle;
        }
        let smooth = if is_loop {
            let opposite = faces.map(|face| {
                let across = self
                    .face(face)
                    .iter()
                    .find(|corner| **corner != a && **corner != b);
                across.map_or(middle, |corner| self.at(*corner))
            });
            middle * 0.75 + (opposite[0] + opposite[1]) / 8.0
        } else {
            let [f, g] = faces.map(|face| self.center(self.face(face)));
            (middle * 2.0 + f + g) / 4.0
        };
        smooth.lerp(middle, sharpness)
    }

    pub(super) fn divided(
        &self,
        topology: &Topology,
        is_loop: bool,
        allowance: &Allowance<'_>,
    ) -> Result<Self, SceneError> {
        let mut positions = Vec::new();
        for corner in 0..self.positions.len() as u32 {
            allowance.check_stop_at(corner as usize)?;
            positions.push(self.moved(topology, corner, is_loop));
        }
        let mut middles = BTreeMap::new();
        let mut creases = BTreeMap::new();
        for (i, (&edge_here, &faces)) in topology.edges.iter().enumerate() {
            allowance.check_stop_at(i)?;
            let id = positions.len() as u32;
            positions.push(self.middle(topology, edge_here, faces, is_loop));
            middles.insert(edge_here, id);
            let sharpness = self.creases.get(&edge_here).copied().unwrap_or(0.0) - 1.0;
            if sharpness > 0.0 {
                let (a, b) = edge_here;
                creases.insert(edge(a, id), sharpness);
                creases.insert(edge(b, id), sharpness);
            }
        }
        let middle = |a: u32, b: u32| middles.get(&edge(a, b)).copied().unwrap_or(a);
        let mut faces = Vec::new();
        for (i, face) in self.faces.iter().enumerate() {
            allowance.check_stop_at(i)?;
            if let ([a, b, c], true) = (face.as_slice(), is_loop) {
                let (ab, bc, ca) = (middle(*a, *b), middle(*b, *c), middle(*c, *a));
                faces.extend([
                    vec![*a, ab, ca],
                    vec![ab, *b, bc],
                    vec![ca, bc, *c],
                    vec![ab, bc, ca],
                ]);
                continue;
            }
            let center = positions.len() as u32;
            positions.push(self.center(face));
            let before = face.iter().cycle().skip(face.len() - 1);
            for ((a, b), before) in corners_of(face).zip(before) {
                faces.push(vec![a, middle(a, b), center, middle(*before, a)]);
            }
        }
        Ok(Self {
            positions,
            faces,
            uvs: self.divided_values(&self.uvs, is_loop),
            colors: self.divided_values(&self.colors, is_loop),
            creases,
        })
    }

    /// What each face has at its corners, divided as the faces are.
    fn divided_values<T: Linear>(&self, values: &[Vec<T>], is_loop: bool) -> Vec<Vec<T>> {
        let each = self.faces.iter().zip(values);
        each.flat_map(|(face, values)| divided(face.len(), values, is_loop))
            .collect()
    }

    /// Where endless division would bring the corners.
    pub(super) fn limit(
        &self,
        topology: &Topology,
        is_loop: bool,
        allowance: &Allowance<'_>,
    ) -> Result<Vec<DVec3>, SceneError> {
        let at_limit = |corner: u32| {
            let p = self.at(corner);
            let (sharp, _) = self.sharp_at(topology, corner);
            match sharp[..] {
                [a, b] => return (self.at(a) + self.at(b) + p * 4.0) / 6.0,
                _ if sharp.len() > 2 => return p,
                _ => {}
            }
            let neighbors = topology
                .neighbors
                .get(corner as usize)
                .map_or(&[][..], |list| list);
            let n = neighbors.len() as f64;
            if neighbors.is_empty() {
                return p;
            }
            let sum: DVec3 = neighbors.iter().map(|other| self.at(*other)).sum();
            if is_loop {
                let chi = 1.0 / (3.0 / (8.0 * loop_weight(neighbors.len())) + n);
                return p * (1.0 - n * chi) + sum * chi;
            }
            // Halstead, Kass and DeRose, "Efficient, fair interpolation using Catmull-Clark surfaces", 1993: all faces are
            // quads after a step, and the corners across them count once.
            let faces = topology.faces.get(corner as usize).map_or(&[][..], |list| list);
            let across: DVec3 = faces
                .iter()
                .map(|face| {
                    let face = self.face(*face);
                    let place = face.iter().position(|c| *c == corner).unwrap_or(0);
                    face.get((place + 2) % face.len().max(1))
                        .map_or(p, |c| self.at(*c))
                })
                .sum();
            (p * (n * n) + sum * 4.0 + across) / (n * (n + 5.0))
        };
        let corners = 0..self.positions.len() as u32;
        corners
            .map(|corner| {
                allowance.check_stop_at(corner as usize)?;
                Ok(at_limit(corner))
            })
            .collect()
    }

    /// Triangles, with a normal for each corner and each side of the creases at it: the mean of the faces there by their
    /// angles.
    pub(super) fn mesh(&self, topology: &Topology, allowance: &Allowance<'_>) -> Result<Mesh, SceneError> {
        let mut normals = Vec::new();
        // For each face and each of its corners the number of its normal.
        let mut ids: Vec<Vec<u32>> = self.faces.iter().map(|face| vec![u32::MAX; face.len()]).collect();
        for corner in 0..self.positions.len() as u32 {
            allowance.check_stop_at(corner as usize)?;
            let faces = topology.faces.get(corner as usize).map_or(&[][..], |list| list);
            for sector in self.sectors(topology, corner, faces) {
                let sum: DVec3 = sector.iter().map(|face| self.angle_weighted(*face, corner)).sum();
                let id = normals.len() as u32;
                normals.push(sum.try_normalize().unwrap_or(DVec3::Y));
                for face in sector {
                    let place = self.face(face).iter().position(|c| *c == corner);
                    let slot = place.and_then(|place| ids.get_mut(face as usize)?.get_mut(place));
                    if let Some(slot) = slot {
                        *slot = id;
                    }
                }
            }
        }
        let (mut triangles, mut corners) = (Vec::new(), Vec::new());
        let (mut uvs, mut colors) = (AtCorners::new(&self.uvs), AtCorners::new(&self.colors));
        for (i, (face, ids)) in self.faces.iter().zip(&ids).enumerate() {
            allowance.check_stop_at(i)?;
            let points: Vec<DVec3> = face.iter().map(|corner| self.at(*corner)).collect();
            for t in crate::shape::triangulate(&points) {
                triangles.push(t.map(|i| face.get(i).copied().unwrap_or(0)));
                corners.push(t.map(|i| ids.get(i).copied().unwrap_or(0)));
                uvs.add(i, t);
                colors.add(i, t);
            }
            uvs.next(i);
            colors.next(i);
        }
        let mut mesh = Mesh::new("subdivide", self.positions.clone(), triangles)?;
        mesh.normals = Some(Attribute {
            values: normals,
            indices: corners,
        });
        mesh.uvs = uvs.attribute();
        mesh.colors = colors.attribute();
        Ok(mesh)
    }

    /// The faces at a corner, in parts that no sharp edge divides.
    fn sectors(&self, topology: &Topology, corner: u32, faces: &[u32]) -> Vec<Vec<u32>> {
        let mut left: Vec<u32> = faces.to_vec();
        let mut sectors = Vec::new();
        while let Some(first) = left.pop() {
            let mut sector = vec![first];
            let mut i = 0;
            while let Some(face) = sector.get(i).copied() {
                i += 1;
                for (a, b) in corners_of(self.face(face)) {
                    if (a != corner && b != corner) || self.sharpness(topology, edge(a, b)) > 0.0 {
                        continue;
                    }
                    let sides = topology.edges.get(&edge(a, b)).copied().unwrap_or([NO_FACE; 2]);
                    for side in sides {
                        if let Some(place) = left.iter().position(|other| *other == side) {
                            left.swap_remove(place);
                            sector.push(side);
                        }
                    }
                }
            }
            sector.sort_unstable();
            sectors.push(sector);
        }
        sectors
    }

    /// The normal of a face at a corner, as long as its angle there.
    fn angle_weighted(&self, face: u32, corner: u32) -> DVec3 {
        let face = self.face(face);
        let count = face.len().max(1);
        let place = face.iter().position(|c| *c == corner).unwrap_or(0);
        let p = self.at(corner);
        let other = |step: usize| face.get((place + step) % count).map_or(p, |c| self.at(*c)) - p;
        let (next, before) = (other(1), other(count - 1));
        let normal = next.cross(before);
        let angle = math::atan2(normal.length(), next.dot(before));
        normal.normalize_or_zero() * angle
    }
}

/// What a neighbor counts for at a smooth corner of a triangle net (Loop, "Smooth subdivision surfaces based on triangles",
/// 1987).
fn loop_weight(neighbors: usize) -> f64 {
    let n = neighbors as f64;
    let cos = 0.375 + 0.25 * math::cos(2.0 * PI / n);
    (0.625 - cos * cos) / n
}
