//! Subdivision surfaces: Catmull-Clark for polygons, Loop for triangles.

use std::{
    collections::BTreeMap,
    ops::{Add, Div},
};

use super::{Allowance, allowance::STEPS_PER_QUESTION};
use crate::{
    color::Color,
    math::{self, DVec2, DVec3, PI},
    scene::{Attribute, Mesh, SceneError},
};

/// Which rule divides the faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Loop where all faces are triangles, Catmull-Clark elsewhere.
    #[default]
    Auto,
    /// Each face into quads (Catmull and Clark, 1978).
    CatmullClark,
    /// Each triangle into four (Loop, 1987). All faces must be triangles.
    Loop,
}

/// A cage of polygons, to be divided into a smooth surface.
///
/// ```
/// use rtscript::{DVec3, Limits, tessellate::{Allowance, Cage, Scheme}};
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
/// let mut cage = Cage::new(corners, vec![vec![0, 1, 2, 3]], 2);
/// cage.scheme = Scheme::CatmullClark;
/// // Each level makes four faces of one; a face is two triangles.
/// assert_eq!(cage.mesh(&Allowance::of(&Limits::default()))?.triangles.len(), 2 * 4 * 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Cage {
    /// Corners.
    pub positions: Vec<DVec3>,
    /// Corners of each face as indices into `positions`, counter-clockwise seen from the front.
    pub faces: Vec<Vec<u32>>,
    /// Texture coordinates of each face, one for each of its corners or none; empty where no face has any. They are divided
    /// within each face, linearly, so that seams stay where they are.
    pub uvs: Vec<Vec<DVec2>>,
    /// Scene-linear colors of each face, in the same form and divided in the same way.
    pub colors: Vec<Vec<Color>>,
    /// Edges that stay sharp: their two ends, and for how many levels. Edges at the rim always do.
    pub creases: Vec<([u32; 2], f64)>,
    /// How often faces are divided, at most 8.
    pub levels: u32,
    /// Default: by the faces.
    pub scheme: Scheme,
    /// Whether the corners are moved to where endless division would bring them. Default: true.
    pub to_the_limit: bool,
}

/// Triangles at most: what is known of their edges meanwhile takes a few hundred bytes each.
const MOST_TRIANGLES: usize = 4_000_000;
/// Levels at most.
const MOST_LEVELS: u32 = 8;

impl Cage {
    /// A cage without creases, texture coordinates and colors.
    #[must_use]
    pub const fn new(positions: Vec<DVec3>, faces: Vec<Vec<u32>>, levels: u32) -> Self {
        Self {
            positions,
            faces,
            uvs: Vec::new(),
            colors: Vec::new(),
            creases: Vec::new(),
            levels,
            scheme: Scheme::Auto,
            to_the_limit: true,
        }
    }

    /// Its triangles, with the normals of the smooth surface; along creases each side has its own.
    ///
    /// # Errors
    /// Where there are no faces, one has fewer than three corners, a corner twice or one that there is not, three faces meet
    /// at an edge or two run along it the same way, a crease is no edge, texture coordinates or colors are not as many as corners, or the
    /// triangles are too many.
    pub fn mesh(&self, allowance: &Allowance<'_>) -> Result<Mesh, SceneError> {
        let is_loop = self.check()?;
        let growth = 4usize.saturating_pow(self.levels);
        let cuts: usize = self.faces.iter().map(|face| face.len() - 2).sum();
        // A face of n corners becomes n quads.
        let corners: usize = self.faces.iter().map(Vec::len).sum();
        let most = match (is_loop, self.levels) {
            (true, _) | (_, 0) => cuts.saturating_mul(growth),
            _ => corners.saturating_mul(growth / 4).saturating_mul(2),
        };
        allowance.triangles(most)?;
        if most > MOST_TRIANGLES {
            return Err(SceneError::new(format!(
                "{} levels make more than {MOST_TRIANGLES} triangles of this cage",
                self.levels
            )));
        }
        let mut net = Net {
            positions: self.positions.clone(),
            faces: self.faces.clone(),
            uvs: self.uvs.clone(),
            colors: self.colors.clone(),
            creases: self
                .creases
                .iter()
                .map(|([a, b], sharpness)| ((*a.min(b), *a.max(b)), *sharpness))
                .collect(),
        };
        let mut topology = net.topology()?;
        if let Some(((a, b), _)) = net
            .creases
            .iter()
            .find(|(edge, _)| !topology.edges.contains_key(edge))
        {
            return Err(SceneError::new(format!(
                "the crease from {a} to {b} is no edge of a face"
            )));
        }
        for _ in 0..self.levels {
            allowance.check_stop()?;
            net = net.divided(&topology, is_loop, allowance)?;
            topology = net.topology()?;
        }
        if self.to_the_limit && self.levels > 0 {
            net.positions = net.limit(&topology, is_loop);
        }
        net.mesh(&topology)
    }

    fn check(&self) -> Result<bool, SceneError> {
        if self.levels > MOST_LEVELS {
            return Err(SceneError::new(format!(
                "levels must be from 0 to {MOST_LEVELS}, not {}",
                self.levels
            )));
        }
        if self.faces.is_empty() {
            return Err(SceneError::new("there are no faces"));
        }
        let count = self.positions.len();
        for (i, face) in self.faces.iter().enumerate() {
            if face.len() < 3 {
                return Err(SceneError::new(format!(
                    "face {i} has {} corners; expected 3 or more",
                    face.len()
                )));
            }
            if let Some(corner) = face.iter().find(|corner| **corner as usize >= count) {
                return Err(SceneError::new(format!(
                    "face {i} has the corner {corner}, but there are {count} positions, numbered from 0"
                )));
            }
            let mut sorted = face.clone();
            sorted.sort_unstable();
            if let Some((corner, _)) = sorted.iter().zip(sorted.iter().skip(1)).find(|(a, b)| a == b) {
                return Err(SceneError::new(format!("face {i} has the corner {corner} twice")));
            }
        }
        if let Some(i) = self.positions.iter().position(|p| !(math::max_abs(*p) <= 1e15)) {
            return Err(SceneError::new(format!(
                "position {i} is not within 1e15 of the origin"
            )));
        }
        if !self.uvs.is_empty() {
            self.check_count(&self.uvs, "texture coordinates")?;
            self.check_uvs()?;
        }
        if !self.colors.is_empty() {
            self.check_count(&self.colors, "colors")?;
            self.check_colors()?;
        }
        if let Some(([a, b], sharpness)) = self.creases.iter().find(|(_, s)| !(*s >= 0.0)) {
            return Err(SceneError::new(format!(
                "the crease from {a} to {b} must be 0 or sharper, not {sharpness}"
            )));
        }
        let triangles = self.faces.iter().all(|face| face.len() == 3);
        match self.scheme {
            Scheme::Auto => Ok(triangles),
            Scheme::CatmullClark => Ok(false),
            Scheme::Loop if triangles => Ok(true),
            Scheme::Loop => Err(
                SceneError::new("Loop's rule takes triangles, but a face has more corners")
                    .hint("scheme: \"catmullClark\" takes any polygons"),
            ),
        }
    }
}

impl Cage {
    fn check_count<T>(&self, values: &[Vec<T>], what: &str) -> Result<(), SceneError> {
        let (given, wanted) = (values.len(), self.faces.len());
        if given != wanted {
            return Err(SceneError::new(format!(
                "there are {what} for {given} faces; expected {wanted}"
            )));
        }
        for (i, (values, face)) in values.iter().zip(&self.faces).enumerate() {
            if !values.is_empty() && values.len() != face.len() {
                return Err(SceneError::new(format!(
                    "face {i} has {} corners and {} {what}; expected as many",
                    face.len(),
                    values.len()
                )));
            }
        }
        Ok(())
    }

    fn check_colors(&self) -> Result<(), SceneError> {
        let is_wrong = |c: &Color| !(c.is_finite() && c.min_element() >= 0.0 && math::max_abs(*c) <= 1e15);
        for (i, colors) in self.colors.iter().enumerate() {
            if let Some(color) = colors.iter().find(|c| is_wrong(c)) {
                return Err(SceneError::new(format!(
                    "a color of face {i} must be finite numbers from 0 to 1e15, not {color}"
                )));
            }
        }
        Ok(())
    }

    fn check_uvs(&self) -> Result<(), SceneError> {
        for (i, uvs) in self.uvs.iter().enumerate() {
            if uvs
                .iter()
                .any(|uv| !(uv.is_finite() && uv.abs().max_element() <= 1e15))
            {
                return Err(SceneError::new(format!(
                    "a texture coordinate of face {i} is not a finite number within 1e15"
                )));
            }
        }
        Ok(())
    }
}

/// An edge by its ends, the smaller first.
type Edge = (u32, u32);

const fn edge(a: u32, b: u32) -> Edge {
    if a < b { (a, b) } else { (b, a) }
}

struct Net {
    positions: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    /// As [`Cage::uvs`].
    uvs: Vec<Vec<DVec2>>,
    /// As [`Cage::colors`].
    colors: Vec<Vec<Color>>,
    creases: BTreeMap<Edge, f64>,
}

/// What lies next to what.
struct Topology {
    /// The faces at each edge: one or two.
    edges: BTreeMap<Edge, [u32; 2]>,
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
    fn topology(&self) -> Result<Topology, SceneError> {
        let mut directed: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut faces = vec![Vec::new(); self.positions.len()];
        for (id, face) in (0..).zip(&self.faces) {
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
        for (&(a, b), &face) in &directed {
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

    fn divided(
        &self,
        topology: &Topology,
        is_loop: bool,
        allowance: &Allowance<'_>,
    ) -> Result<Self, SceneError> {
        let mut positions = Vec::new();
        for corner in 0..self.positions.len() as u32 {
            if (corner as usize).is_multiple_of(STEPS_PER_QUESTION) {
                allowance.check_stop()?;
            }
            positions.push(self.moved(topology, corner, is_loop));
        }
        let mut middles = BTreeMap::new();
        let mut creases = BTreeMap::new();
        for (i, (&edge_here, &faces)) in topology.edges.iter().enumerate() {
            if i.is_multiple_of(STEPS_PER_QUESTION) {
                allowance.check_stop()?;
            }
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
            if i.is_multiple_of(STEPS_PER_QUESTION) {
                allowance.check_stop()?;
            }
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
    fn limit(&self, topology: &Topology, is_loop: bool) -> Vec<DVec3> {
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
        (0..self.positions.len() as u32).map(at_limit).collect()
    }

    /// Triangles, with a normal for each corner and each side of the creases at it: the mean of the faces there by their
    /// angles.
    fn mesh(&self, topology: &Topology) -> Result<Mesh, SceneError> {
        let mut normals = Vec::new();
        // For each face and each of its corners the number of its normal.
        let mut ids: Vec<Vec<u32>> = self.faces.iter().map(|face| vec![u32::MAX; face.len()]).collect();
        for corner in 0..self.positions.len() as u32 {
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

/// What may be mixed.
trait Linear: Copy + Default + Add<Output = Self> + Div<f64, Output = Self> {}

impl Linear for DVec2 {}
impl Linear for Color {}

/// What faces have at their corners, on its way to the corners of triangles.
struct AtCorners<'n, T> {
    values: &'n [Vec<T>],
    /// The number of the first value of the face at hand.
    first: u32,
    indices: Vec<[u32; 3]>,
}

impl<'n, T: Linear> AtCorners<'n, T> {
    fn new(values: &'n [Vec<T>]) -> Self {
        Self {
            values,
            first: 0,
            indices: Vec::new(),
        }
    }

    /// Adds a triangle of the face at hand, by the places of its corners among those of the face.
    fn add(&mut self, face: usize, corners: [usize; 3]) {
        if let Some(own) = self.values.get(face) {
            let none = Attribute::<T>::NONE;
            let index = |i: usize| {
                if i < own.len() {
                    self.first + i as u32
                } else {
                    none
                }
            };
            self.indices.push(corners.map(index));
        }
    }

    /// Goes on behind a face.
    fn next(&mut self, face: usize) {
        self.first += self.values.get(face).map_or(0, Vec::len) as u32;
    }

    fn attribute(self) -> Option<Attribute<T>> {
        (!self.indices.is_empty()).then(|| Attribute {
            values: self.values.concat(),
            indices: self.indices,
        })
    }
}

/// What the faces that one of so many corners is divided into have at their corners, in their order.
fn divided<T: Linear>(corners: usize, values: &[T], is_loop: bool) -> Vec<Vec<T>> {
    if values.is_empty() {
        return vec![Vec::new(); if is_loop { 4 } else { corners }];
    }
    if let ([a, b, c], true) = (values, is_loop) {
        let (a, b, c) = (*a, *b, *c);
        let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
        return vec![
            vec![a, ab, ca],
            vec![ab, b, bc],
            vec![ca, bc, c],
            vec![ab, bc, ca],
        ];
    }
    let count = values.len();
    let sum = values.iter().fold(T::default(), |sum, value| sum + *value);
    let center = sum / count as f64;
    let at = |i: usize| values.get(i % count).copied().unwrap_or_default();
    let corner = |i: usize| {
        let (before, value, next) = (at(i + count - 1), at(i), at(i + 1));
        vec![value, (value + next) / 2.0, center, (before + value) / 2.0]
    };
    (0..count).map(corner).collect()
}

/// What a neighbor counts for at a smooth corner of a triangle net (Loop, "Smooth subdivision surfaces based on triangles",
/// 1987).
fn loop_weight(neighbors: usize) -> f64 {
    let n = neighbors as f64;
    let cos = 0.375 + 0.25 * math::cos(2.0 * PI / n);
    (0.625 - cos * cos) / n
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::Limits;

    fn made(cage: &Cage) -> Mesh {
        cage.mesh(&Allowance::of(&Limits::default())).unwrap()
    }

    fn cube() -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let corner = |i: u32| {
            DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - DVec3::ONE
        };
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        ((0..8).map(corner).collect(), faces.map(|f| f.to_vec()).to_vec())
    }

    fn octahedron() -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let positions = vec![
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
        ];
        let faces = [
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        (positions, faces.map(|f| f.to_vec()).to_vec())
    }

    #[test]
    fn closed_cages_stay_closed_and_smooth() {
        for levels in 0..4 {
            for (positions, faces) in [cube(), octahedron()] {
                let mesh = made(&Cage::new(positions, faces, levels));
                suite::check_closed(&mesh);
                suite::check_normals(&mesh, 0.4);
            }
        }
        let (positions, faces) = cube();
        assert_eq!(made(&Cage::new(positions, faces, 3)).triangles.len(), 6 * 64 * 2);
    }

    #[test]
    fn corners_at_the_limit_do_not_move_with_further_levels() {
        for (positions, faces) in [cube(), octahedron()] {
            let few = made(&Cage::new(positions.clone(), faces.clone(), 1));
            let many = made(&Cage::new(positions, faces, 4));
            // The corners of a level come first in the next.
            for (a, b) in few.positions.iter().zip(&many.positions) {
                assert!((*a - *b).length() < 1e-12, "{a} {b}");
            }
        }
    }

    #[test]
    fn colors_are_divided_as_texture_coordinates_are() {
        for (positions, faces) in [cube(), octahedron()] {
            let of = |corner: &u32| DVec2::new(f64::from(*corner), f64::from(*corner * *corner));
            let uvs: Vec<Vec<DVec2>> = faces.iter().map(|face| face.iter().map(of).collect()).collect();
            let color = |uv: &DVec2| Color::new(uv.x, uv.y, 1.0);
            let mut cage = Cage {
                colors: uvs.iter().map(|face| face.iter().map(color).collect()).collect(),
                uvs,
                ..Cage::new(positions, faces, 2)
            };
            // One face has none.
            cage.colors[3].clear();
            let mesh = made(&cage);
            let (uvs, colors) = (mesh.uvs.as_ref().unwrap(), mesh.colors.as_ref().unwrap());
            let faces = mesh.triangles.len() / cage.faces.len();
            for i in 0..mesh.triangles.len() {
                let expected = uvs.corners(i).unwrap().map(|uv| color(&uv));
                let expected = (i / faces != 3).then_some(expected);
                assert_eq!(colors.corners(i), expected, "triangle {i}");
            }
            cage.colors[0][1].y = f64::NAN;
            let error = |cage: &Cage| cage.check().unwrap_err().message;
            assert!(
                error(&cage).starts_with("a color of face 0 must be finite numbers from 0 to 1e15, not [")
            );
            cage.colors[0].pop();
            assert!(error(&cage).starts_with("face 0 has "), "{}", error(&cage));
            cage.colors.pop();
            let wanted = format!(
                "there are colors for {0} faces; expected {1}",
                cage.faces.len() - 1,
                cage.faces.len()
            );
            assert_eq!(error(&cage), wanted);
        }
    }

    #[test]
    fn a_flat_net_of_squares_is_a_spline() {
        // On a regular grid Catmull-Clark is the uniform bicubic B-spline, which keeps what is linear.
        let positions: Vec<DVec3> = (0..49)
            .map(|i| DVec3::new((i % 7) as f64, 0.3 * (i % 7) as f64, (i / 7) as f64))
            .collect();
        let faces: Vec<Vec<u32>> = (0..36)
            .map(|i| {
                let a = i / 6 * 7 + i % 6;
                vec![a, a + 7, a + 8, a + 1]
            })
            .collect();
        let mesh = made(&Cage::new(positions.clone(), faces.clone(), 2));
        for p in &mesh.positions {
            assert!((p.y - 0.3 * p.x).abs() < 1e-12, "{p}");
        }
        // One corner lifted: the spline there has 4/6 squared of it.
        let mut lifted = positions;
        lifted.iter_mut().for_each(|p| p.y = 0.0);
        lifted[24].y = 1.0;
        let mesh = made(&Cage::new(lifted, faces, 2));
        assert!(
            (mesh.positions[24].y - 4.0 / 9.0).abs() < 1e-12,
            "{}",
            mesh.positions[24]
        );
    }

    #[test]
    fn texture_coordinates_are_linear_within_each_face() {
        let lifted = |(positions, faces): (Vec<DVec3>, Vec<Vec<u32>>), scheme| {
            // Of the first face none, of all others their own corner of a picture and some more.
            let uvs = |(i, face): (usize, &Vec<u32>)| match i {
                0 => Vec::new(),
                _ => (0..face.len())
                    .map(|k| DVec2::new(i as f64 + (k % 2) as f64, k as f64 * 0.5))
                    .collect(),
            };
            let cage = Cage {
                uvs: faces.iter().enumerate().map(uvs).collect(),
                scheme,
                ..Cage::new(positions, faces, 2)
            };
            (made(&cage), cage)
        };
        for (net, scheme) in [
            (cube(), Scheme::CatmullClark),
            (octahedron(), Scheme::CatmullClark),
            (octahedron(), Scheme::Loop),
        ] {
            let (mesh, cage) = lifted(net, scheme);
            let uvs = mesh.uvs.as_ref().unwrap();
            let per_face = mesh.triangles.len() / cage.faces.len();
            let corners = |i: usize, cage: &Cage| cage.uvs[i].clone();
            for (i, own) in (0..cage.faces.len()).map(|i| (i, corners(i, &cage))) {
                let all = i * per_face..(i + 1) * per_face;
                if i == 0 {
                    assert!(
                        all.clone().all(|t| uvs.corners(t).is_none()),
                        "the first has none"
                    );
                    continue;
                }
                // The corners of the face are there as they were, and the areas add up to that of the face.
                let found: Vec<[DVec2; 3]> = all.map(|t| uvs.corners(t).unwrap()).collect();
                for uv in &own {
                    assert!(
                        found.iter().flatten().any(|other| other == uv),
                        "{uv} of face {i}"
                    );
                }
                let area = |p: &[DVec2]| {
                    let next = p.iter().cycle().skip(1);
                    p.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
                };
                let sum: f64 = found.iter().map(|t| area(t)).sum();
                assert!((sum - area(&own)).abs() < 1e-12, "face {i}: {sum}");
            }
            // The shape knows nothing of it.
            let plain = made(&Cage {
                uvs: Vec::new(),
                ..cage
            });
            assert_eq!(
                (plain.positions, plain.triangles, plain.normals),
                (mesh.positions, mesh.triangles, mesh.normals)
            );
        }
    }

    #[test]
    fn a_square_keeps_its_picture() {
        // On a flat grid the surface and the picture are both those of the grid.
        let positions: Vec<DVec3> = (0..9)
            .map(|i| DVec3::new((i % 3) as f64, (i / 3) as f64, 0.0))
            .collect();
        let faces: Vec<Vec<u32>> = [0u32, 1, 3, 4].map(|a| vec![a, a + 1, a + 4, a + 3]).to_vec();
        let uv = |corner: &u32| {
            let p = positions[*corner as usize];
            DVec2::new(p.x, p.y)
        };
        let uvs: Vec<Vec<DVec2>> = faces.iter().map(|face| face.iter().map(uv).collect()).collect();
        let cage = Cage {
            uvs,
            to_the_limit: false,
            levels: 3,
            ..Cage::new(positions.clone(), faces, 3)
        };
        let mesh = made(&cage);
        let uvs = mesh.uvs.as_ref().unwrap();
        for t in 0..mesh.triangles.len() {
            for (p, uv) in mesh.corners(t).iter().zip(uvs.corners(t).unwrap()) {
                // Rims shrink at their corners, nothing else moves.
                let is_inside = (0.7..1.3).contains(&p.x) && (0.7..1.3).contains(&p.y);
                assert!(
                    !is_inside || (DVec2::new(p.x, p.y) - uv).length() < 0.02,
                    "{p} {uv}"
                );
            }
        }
    }

    #[test]
    fn creases_stay_sharp_as_long_as_they_are() {
        let (positions, faces) = cube();
        let top = [[2, 3], [3, 7], [7, 6], [6, 2]];
        let mut cage = Cage::new(positions, faces, 4);
        let volume = |cage: &Cage| suite::volume(&made(cage));
        let mut last = volume(&cage);
        for sharpness in [0.5, 1.0, 2.0, 10.0] {
            cage.creases = top.map(|edge| (edge, sharpness)).to_vec();
            let larger = volume(&cage);
            assert!(larger > last, "{larger} for {sharpness}");
            last = larger;
        }
        assert_eq!(made(&cage).bounds().max.y, 1.0);
        suite::check_closed(&made(&cage));
        cage.creases = vec![([0, 7], 1.0)];
        let error = cage.mesh(&Allowance::of(&Limits::default())).unwrap_err();
        assert_eq!(error.message, "the crease from 0 to 7 is no edge of a face");
    }

    #[test]
    fn what_is_no_cage_is_refused() {
        let (positions, faces) = cube();
        let message = |faces: Vec<Vec<u32>>, levels| {
            let cage = Cage::new(positions.clone(), faces, levels);
            cage.mesh(&Allowance::of(&Limits::default())).unwrap_err().message
        };
        assert_eq!(message(Vec::new(), 1), "there are no faces");
        assert_eq!(
            message(vec![vec![0, 1]], 1),
            "face 0 has 2 corners; expected 3 or more"
        );
        assert_eq!(message(vec![vec![0, 1, 1]], 1), "face 0 has the corner 1 twice");
        assert_eq!(
            message(vec![vec![0, 1, 8]], 1),
            "face 0 has the corner 8, but there are 8 positions, numbered from 0"
        );
        assert_eq!(
            message(vec![vec![0, 1, 2], vec![0, 1, 3]], 1),
            "faces 0 and 1 both run from corner 0 to corner 1"
        );
        let of_uvs = |uvs: Vec<Vec<DVec2>>| {
            let cage = Cage {
                uvs,
                ..Cage::new(positions.clone(), faces.clone(), 1)
            };
            cage.mesh(&Allowance::of(&Limits::default())).unwrap_err().message
        };
        assert_eq!(
            of_uvs(vec![Vec::new(); 5]),
            "there are texture coordinates for 5 faces; expected 6"
        );
        let mut uvs = vec![Vec::new(); 6];
        uvs[2] = vec![DVec2::ZERO; 3];
        assert_eq!(
            of_uvs(uvs.clone()),
            "face 2 has 4 corners and 3 texture coordinates; expected as many"
        );
        uvs[2] = vec![DVec2::NAN; 4];
        assert_eq!(
            of_uvs(uvs),
            "a texture coordinate of face 2 is not a finite number within 1e15"
        );
        assert_eq!(message(faces.clone(), 9), "levels must be from 0 to 8, not 9");
        let few = Limits {
            primitives: 700,
            ..Limits::default()
        };
        let error = Cage::new(positions.clone(), faces, 3)
            .mesh(&Allowance::of(&few))
            .unwrap_err();
        assert!(error.message.contains("'primitives'"));
    }
}
