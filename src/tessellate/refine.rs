//! Triangles over charts, divided until they lie within an error bound of the surface, without cracks.
//!
//! Whether an edge is divided depends on the edge alone, so both triangles at it agree, and triangles that lie next to one
//! another always meet edge to edge. Points are one where they have the same coordinates to the bit, whichever chart they
//! come from: so seams, poles and the edges of patches close.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::{Allowance, allowance::STEPS_PER_QUESTION};
use crate::{
    math::{DVec2, DVec3},
    scene::{Attribute, Mesh, SceneError},
};

/// Pieces of a surface, each over u and v from 0 to 1.
pub(super) trait Charts {
    /// What may go wrong when a point is asked for.
    type Error: From<SceneError>;

    /// The point at (u, v) of a chart. Where charts meet, it must have the same bits from either.
    fn point(&mut self, chart: u32, u: f64, v: f64) -> Result<DVec3, Self::Error>;

    /// The normal there, of length 1, on the side from which u to v runs counter-clockwise; `None` where there is none.
    fn normal(&mut self, chart: u32, u: f64, v: f64) -> Result<Option<DVec3>, Self::Error>;
}

/// How a surface is divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Division {
    pub(super) charts: u32,
    /// Cells of a chart to begin with.
    pub(super) columns: u32,
    pub(super) rows: u32,
    /// How far triangles may be off.
    pub(super) tolerance: f64,
}

/// Triangles at most: what is known of their edges meanwhile takes some 600 bytes each.
const MOST_TRIANGLES: usize = 2_000_000;
/// How often a cell may be halved.
const LEVELS: u32 = 10;
/// Parts of a cell: an edge that is not divided any more still has places at its quarters.
const PARTS: u32 = 1 << (LEVELS + 2);

/// A point of a chart, in parts of its cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    chart: u32,
    u: u32,
    v: u32,
}

/// The sides u = 0 and u = 1, and v = 0 and v = 1, of a chart that are one point each.
type Poles = [[bool; 2]; 2];

impl Place {
    fn between(self, other: Self) -> Self {
        Self {
            chart: self.chart,
            u: self.u.midpoint(other.u),
            v: self.v.midpoint(other.v),
        }
    }

    /// Whether an edge to `other` can be halved, and its halves be looked at.
    fn is_divisible(self, other: Self) -> bool {
        self.u.abs_diff(other.u).is_multiple_of(8) && self.v.abs_diff(other.v).is_multiple_of(8)
    }
}

/// The mesh of a surface.
///
/// # Errors
/// Those of the charts, and where the triangles are too many or somebody wants to stop.
pub(super) fn mesh<C: Charts>(
    name: &str,
    charts: &mut C,
    division: Division,
    allowance: &Allowance<'_>,
) -> Result<Mesh, C::Error> {
    let mut refiner = Refiner {
        charts,
        division,
        allowance,
        poles: Vec::new(),
        ids: BTreeMap::new(),
        places: Vec::new(),
        points: Vec::new(),
        point_ids: HashMap::new(),
        triangles: Vec::new(),
        tested: BTreeSet::new(),
        steps: 0,
    };
    refiner.begin()?;
    while refiner.refine()? {}
    refiner.finish(name)
}

struct Refiner<'a, 'b, C> {
    charts: &'a mut C,
    division: Division,
    allowance: &'a Allowance<'b>,
    /// Chart by chart.
    poles: Vec<Poles>,
    ids: BTreeMap<Place, u32>,
    /// Each place that was looked at, and which point is there.
    places: Vec<(Place, u32)>,
    points: Vec<DVec3>,
    point_ids: HashMap<[u64; 3], u32>,
    /// Corners are places; with whether its inside was looked at.
    triangles: Vec<([u32; 3], bool)>,
    /// Edges that were looked at, as places.
    tested: BTreeSet<(u32, u32)>,
    steps: usize,
}

impl<C: Charts> Refiner<'_, '_, C> {
    fn coordinates(&self, place: Place) -> (f64, f64) {
        let part = |i: u32, n: u32| f64::from(i) / (f64::from(n) * f64::from(PARTS));
        (
            part(place.u, self.division.columns),
            part(place.v, self.division.rows),
        )
    }

    /// The number of a place, its point worked out where it is new.
    fn id(&mut self, place: Place) -> Result<u32, C::Error> {
        if let Some(id) = self.ids.get(&place) {
            return Ok(*id);
        }
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS_PER_QUESTION) {
            self.allowance.check_stop()?;
        }
        let (u, v) = self.coordinates(place);
        // Zeros of both signs are one place.
        let p = self.charts.point(place.chart, u, v)? + DVec3::ZERO;
        if !(crate::math::max_abs(p) <= 1e15) {
            return Err(SceneError::new(format!(
                "the point at u = {u}, v = {v} is not within 1e15 of the origin"
            ))
            .into());
        }
        let points = &mut self.points;
        let point = *self
            .point_ids
            .entry(p.to_array().map(f64::to_bits))
            .or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            });
        let id = self.places.len() as u32;
        self.places.push((place, point));
        self.ids.insert(place, id);
        Ok(id)
    }

    fn place(&self, id: u32) -> Place {
        let first = Place { chart: 0, u: 0, v: 0 };
        self.places.get(id as usize).map_or(first, |(place, _)| *place)
    }

    /// The number of the point at a place.
    fn point_id(&self, id: u32) -> u32 {
        self.places.get(id as usize).map_or(0, |(_, point)| *point)
    }

    fn point(&self, id: u32) -> DVec3 {
        self.points
            .get(self.point_id(id) as usize)
            .copied()
            .unwrap_or_default()
    }

    /// Finds the sides that are one point.
    fn find_poles(&mut self, chart: u32) -> Result<Poles, C::Error> {
        let (columns, rows) = (self.division.columns * PARTS, self.division.rows * PARTS);
        let mut is_point = |at: &dyn Fn(u32) -> (u32, u32), end: u32| -> Result<bool, C::Error> {
            let mut first = None;
            for i in (0..=end).step_by(PARTS as usize / 2) {
                let (u, v) = at(i);
                let id = self.id(Place { chart, u, v })?;
                let point = self.point_id(id);
                if *first.get_or_insert(point) != point {
                    return Ok(false);
                }
            }
            Ok(true)
        };
        Ok([
            [is_point(&|i| (0, i), rows)?, is_point(&|i| (columns, i), rows)?],
            [
                is_point(&|i| (i, 0), columns)?,
                is_point(&|i| (i, rows), columns)?,
            ],
        ])
    }

    /// The ends of an edge: one that is at a pole has no direction of its own, and takes that of the other, so that all
    /// edges between two points are one.
    fn ends(&self, i: u32, j: u32) -> (Place, Place) {
        let (mut a, mut b) = (self.place(i), self.place(j));
        let (columns, rows) = (self.division.columns * PARTS, self.division.rows * PARTS);
        let [[left, right], [low, high]] = self.poles.get(a.chart as usize).copied().unwrap_or_default();
        let in_v = |p: Place| (p.v == 0 && low) || (p.v == rows && high);
        let in_u = |p: Place| (p.u == 0 && left) || (p.u == columns && right);
        match (in_v(a), in_v(b)) {
            (true, false) => a.u = b.u,
            (false, true) => b.u = a.u,
            _ => {}
        }
        match (in_u(a), in_u(b)) {
            (true, false) => a.v = b.v,
            (false, true) => b.v = a.v,
            _ => {}
        }
        (a, b)
    }

    /// Adds a triangle, unless it is but an edge.
    fn add(
        &mut self,
        to: &mut Vec<([u32; 3], bool)>,
        corners: [u32; 3],
        known: bool,
    ) -> Result<(), SceneError> {
        let [a, b, c] = corners.map(|corner| self.point_id(corner));
        if a != b && b != c && c != a {
            self.allowance.triangles(to.len() + 1)?;
            if to.len() >= MOST_TRIANGLES {
                return Err(SceneError::new(format!(
                    "the surface takes more than {MOST_TRIANGLES} triangles to be within the tolerance of {}",
                    self.division.tolerance
                ))
                .hint("give a larger tolerance"));
            }
            to.push((corners, known));
        }
        Ok(())
    }

    fn begin(&mut self) -> Result<(), C::Error> {
        let Division {
            charts,
            columns,
            rows,
            ..
        } = self.division;
        let mut triangles = Vec::new();
        for chart in 0..charts {
            let poles = self.find_poles(chart)?;
            self.poles.push(poles);
            for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
                let mut corner = |u: u32, v: u32| {
                    self.id(Place {
                        chart,
                        u: u * PARTS,
                        v: v * PARTS,
                    })
                };
                let (a, b) = (corner(column, row)?, corner(column + 1, row)?);
                let (c, d) = (corner(column + 1, row + 1)?, corner(column, row + 1)?);
                // Diagonals that alternate have no direction as a whole.
                let halves = if (row + column) % 2 == 0 {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                for half in halves {
                    self.add(&mut triangles, half, false)?;
                }
            }
        }
        self.triangles = triangles;
        Ok(())
    }

    /// Looks at all that was not looked at yet and divides what is off; false where nothing was.
    fn refine(&mut self) -> Result<bool, C::Error> {
        let mut marked: BTreeSet<(u32, u32)> = BTreeSet::new();
        let mut triangles = std::mem::take(&mut self.triangles);
        for (corners, known) in &mut triangles {
            let [a, b, c] = *corners;
            let mut is_off = false;
            for (i, j) in [(a, b), (b, c), (c, a)] {
                if self.tested.insert((i.min(j), i.max(j))) && self.is_edge_off(i, j)? {
                    marked.insert(self.edge(i, j));
                }
                is_off |= marked.contains(&self.edge(i, j));
            }
            if !is_off && !*known {
                *known = true;
                if self.is_inside_off([a, b, c])? {
                    marked.extend([(a, b), (b, c), (c, a)].map(|(i, j)| self.edge(i, j)));
                }
            }
        }
        if marked.is_empty() {
            self.triangles = triangles;
            return Ok(false);
        }
        let mut divided = Vec::with_capacity(triangles.len() * 2);
        for (corners, known) in triangles {
            self.divide(&mut divided, corners, known, &marked)?;
        }
        self.triangles = divided;
        Ok(true)
    }

    /// An edge by its points, which both sides know.
    fn edge(&self, i: u32, j: u32) -> (u32, u32) {
        let (a, b) = (self.point_id(i), self.point_id(j));
        (a.min(b), a.max(b))
    }

    fn is_edge_off(&mut self, i: u32, j: u32) -> Result<bool, C::Error> {
        let (a, b) = self.ends(i, j);
        if !a.is_divisible(b) {
            return Ok(false);
        }
        let (start, end) = (self.point(i), self.point(j));
        let middle = a.between(b);
        for place in [middle, a.between(middle), middle.between(b)] {
            let id = self.id(place)?;
            let (p, along) = (self.point(id) - start, end - start);
            let t = (p.dot(along) / along.length_squared()).clamp(0.0, 1.0);
            if !((p - along * t).length() <= self.division.tolerance) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether the surface leaves the plane of a triangle between its edges.
    fn is_inside_off(&mut self, corners: [u32; 3]) -> Result<bool, C::Error> {
        let [a, b, c] = corners;
        let edges = [self.ends(a, b), self.ends(b, c), self.ends(c, a)];
        if !edges.iter().all(|(a, b)| a.is_divisible(*b)) {
            return Ok(false);
        }
        let middles = edges.map(|(a, b)| a.between(b));
        let [p, q, r] = corners.map(|corner| self.point(corner));
        let normal = (q - p).cross(r - p).normalize_or_zero();
        for (one, other) in middles.iter().zip(middles.iter().cycle().skip(1)) {
            let id = self.id(one.between(*other))?;
            if !((self.point(id) - p).dot(normal).abs() <= self.division.tolerance) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// A triangle in as many as its marked edges ask for.
    fn divide(
        &mut self,
        to: &mut Vec<([u32; 3], bool)>,
        [a, b, c]: [u32; 3],
        known: bool,
        marked: &BTreeSet<(u32, u32)>,
    ) -> Result<(), C::Error> {
        let mut middle = |i: u32, j: u32| -> Result<Option<u32>, C::Error> {
            if !marked.contains(&self.edge(i, j)) {
                return Ok(None);
            }
            let (a, b) = self.ends(i, j);
            self.id(a.between(b)).map(Some)
        };
        let (ab, bc, ca) = (middle(a, b)?, middle(b, c)?, middle(c, a)?);
        let parts: &[[u32; 3]] = match (ab, bc, ca) {
            (None, None, None) => return Ok(self.add(to, [a, b, c], known)?),
            (Some(m), None, None) => &[[a, m, c], [m, b, c]],
            (None, Some(m), None) => &[[b, m, a], [m, c, a]],
            (None, None, Some(m)) => &[[c, m, b], [m, a, b]],
            (Some(ab), Some(bc), None) => &self.three(a, b, c, ab, bc),
            (None, Some(bc), Some(ca)) => &self.three(b, c, a, bc, ca),
            (Some(ab), None, Some(ca)) => &self.three(c, a, b, ca, ab),
            (Some(ab), Some(bc), Some(ca)) => &[[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]],
        };
        for part in parts {
            self.add(to, *part, false)?;
        }
        Ok(())
    }

    /// The parts of the triangle `a`, `b`, `c` whose edges at `b` are halved: a corner, and what is left along its shorter
    /// diagonal.
    fn three(&self, a: u32, b: u32, c: u32, ab: u32, bc: u32) -> [[u32; 3]; 3] {
        let length = |i: u32, j: u32| (self.point(i) - self.point(j)).length_squared();
        if length(a, bc) <= length(ab, c) {
            [[ab, b, bc], [a, ab, bc], [a, bc, c]]
        } else {
            [[ab, b, bc], [a, ab, c], [ab, bc, c]]
        }
    }

    fn finish(self, name: &str) -> Result<Mesh, C::Error> {
        if self.triangles.is_empty() {
            return Err(SceneError::new("the surface has no area").into());
        }
        let mut flat = vec![DVec3::ZERO; self.points.len()];
        for (corners, _) in &self.triangles {
            let [p, q, r] = corners.map(|corner| self.point(corner));
            for corner in corners {
                if let Some(sum) = flat.get_mut(self.point_id(*corner) as usize) {
                    *sum += (q - p).cross(r - p);
                }
            }
        }
        const NEW: u32 = u32::MAX;
        let mut vertices = vec![NEW; self.points.len()];
        let mut attributes = vec![NEW; self.places.len()];
        let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
        let (mut faces, mut corners_of_faces) = (Vec::new(), Vec::new());
        for (corners, _) in &self.triangles {
            let (mut face, mut own) = ([0; 3], [0; 3]);
            for ((corner, vertex), attribute) in corners.iter().zip(&mut face).zip(&mut own) {
                let point = self.point_id(*corner) as usize;
                if let Some(known) = vertices.get_mut(point) {
                    if *known == NEW {
                        *known = positions.len() as u32;
                        positions.push(self.point(*corner));
                    }
                    *vertex = *known;
                }
                if let Some(known) = attributes.get_mut(*corner as usize) {
                    if *known == NEW {
                        *known = uvs.len() as u32;
                        let place = self.place(*corner);
                        let (u, v) = self.coordinates(place);
                        uvs.push(DVec2::new(u, v));
                        let normal = match self.charts.normal(place.chart, u, v)? {
                            Some(normal) => normal,
                            None => {
                                let sum = flat.get(point).copied().unwrap_or_default();
                                sum.try_normalize().unwrap_or(DVec3::Y)
                            }
                        };
                        normals.push(normal);
                    }
                    *attribute = *known;
                }
            }
            faces.push(face);
            corners_of_faces.push(own);
        }
        let mut mesh = Mesh::new(name, positions, faces)?;
        mesh.normals = Some(Attribute {
            values: normals,
            indices: corners_of_faces.clone(),
        });
        mesh.uvs = Some(Attribute {
            values: uvs,
            indices: corners_of_faces,
        });
        turn_outwards(&mut mesh);
        Ok(mesh)
    }
}

/// Turns a mesh over that is closed and inside out.
pub(super) fn turn_outwards(mesh: &mut Mesh) {
    let mut open: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for [a, b, c] in &mesh.triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            let way = if i < j { 1 } else { -1 };
            *open.entry((*i.min(j), *i.max(j))).or_insert(0) += way;
        }
    }
    if open.values().any(|count| *count != 0) {
        return;
    }
    // Seen from a point of its own, so that what lies far from the origin does not drown in rounding.
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let volume: f64 = (0..mesh.triangles.len())
        .map(|face| {
            let [a, b, c] = mesh.corners(face).map(|p| p - origin);
            a.dot(b.cross(c))
        })
        .sum();
    if volume < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        if let Some(normals) = &mut mesh.normals {
            normals.values.iter_mut().for_each(|n| *n = -*n);
            normals.indices.iter_mut().for_each(|t| t.swap(1, 2));
        }
        if let Some(uvs) = &mut mesh.uvs {
            uvs.indices.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
}
