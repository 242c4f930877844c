//! Subdivision surfaces: Catmull-Clark for polygons, Loop for triangles.

mod corners;
mod net;
#[cfg(test)]
mod tests;

use super::Allowance;
use crate::{
    color::Color,
    math::{self, DVec2, DVec3},
    scene::{Mesh, SceneError},
};
use net::Net;

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
        let mut topology = net.topology(allowance)?;
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
            topology = net.topology(allowance)?;
        }
        if self.to_the_limit && self.levels > 0 {
            net.positions = net.limit(&topology, is_loop, allowance)?;
        }
        net.mesh(&topology, allowance)
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
        for (i, colors) in self.colors.iter().enumerate() {
            for color in colors {
                Mesh::check_color(*color, format_args!("a color of face {i}"))?;
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
