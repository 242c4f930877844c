//! From a checked OBJ file to a mesh.

use std::ops::Range;

use super::{
    assets::Assets,
    guard::{Checked, Corner},
    text::Source,
    wavefront::Unused,
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::DVec3,
    scene::{Attribute, Builder, MaterialId, Mesh, SceneError},
    shape::triangulate,
};

/// Corners between two questions whether to stop.
const CORNERS_PER_QUESTION: usize = 1 << 14;
/// Corners of a face that takes longer to cut into triangles than a question.
const MANY_CORNERS: usize = 64;

/// The mesh of a checked file, its materials being places among the names that `usemtl` gives.
///
/// # Errors
/// Where no face has an area, or where the host asks to stop.
pub(super) fn mesh<'a>(
    source: &Source<'a>,
    checked: Checked<'a>,
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    let mut corners = checked.corners;
    // Before the corners' positions are numbered anew: colors take the same order.
    let mut of_colors: Vec<u32> = match checked.colors.is_empty() {
        true => Vec::new(),
        false => corners.iter().map(|corner| corner.position).collect(),
    };
    let colors = in_order_of_use(&checked.colors, |_| true, of_colors.iter_mut(), assets)?;
    let positions = in_order_of_use(
        &checked.positions,
        |_| true,
        corners.iter_mut().map(|c| &mut c.position),
        assets,
    )?;
    let uvs = in_order_of_use(
        &checked.uvs,
        |_| true,
        corners.iter_mut().map(|c| &mut c.uv),
        assets,
    )?;
    // A normal of length zero says nothing.
    let says_something = |n: &DVec3| *n != DVec3::ZERO;
    let normals = in_order_of_use(
        &checked.normals,
        says_something,
        corners.iter_mut().map(|c| &mut c.normal),
        assets,
    )?;
    let mut triangles = Triangles {
        corners: &corners,
        positions: &positions,
        found: Vec::with_capacity(corners.len() / 3),
        points: Vec::new(),
    };
    let mut degenerate = Unused::default();
    let mut face_materials = Vec::new();
    let (mut start, mut question) = (0, 0);
    for face in &checked.faces {
        if face.end >= question || face.end - start > MANY_CORNERS {
            assets.check_stop()?;
            question = face.end + CORNERS_PER_QUESTION;
        }
        let before = triangles.found.len();
        triangles.add_face(start..face.end);
        start = face.end;
        if triangles.found.len() == before {
            degenerate.add(face.at);
        }
        let material = face.material.map(MaterialId);
        face_materials.resize(triangles.found.len(), material.unwrap_or(MaterialId::INHERIT));
    }
    degenerate.warn(
        source,
        builder,
        |n| match n {
            1 => "a face without area is left out".to_owned(),
            n => format!("{n} faces without area are left out, this is the first"),
        },
        None,
    );
    if triangles.found.is_empty() {
        let error = Diagnostic::error(ErrorKind::Input, "no face of the file has an area");
        return Err(error.at(source.name, 0, 0));
    }
    if face_materials.iter().all(|id| *id == MaterialId::INHERIT) {
        face_materials = Vec::new();
    }
    let normals = (!normals.is_empty()).then(|| Attribute {
        values: normals,
        indices: triangles.indices(|corner| corner.normal),
    });
    let uvs = (!uvs.is_empty()).then(|| Attribute {
        values: uvs,
        indices: triangles.indices(|corner| corner.uv),
    });
    let faces = triangles.indices(|corner| corner.position);
    let colors = (!colors.is_empty()).then(|| Attribute {
        values: colors,
        indices: faces.clone(),
    });
    let mesh = Mesh::new(source.name, positions, faces);
    let mut mesh = mesh.map_err(|SceneError { message, .. }| {
        Diagnostic::error(ErrorKind::Internal, message).at(source.name, 0, 0)
    })?;
    mesh.normals = normals;
    mesh.uvs = uvs;
    mesh.colors = colors;
    mesh.face_materials = face_materials;
    Ok(mesh)
}

/// The values that `uses` name, in the order of their first use, but for those that `keep` refuses. The uses are
/// changed to their places there, or to [`Corner::NONE`].
///
/// # Errors
/// Where the host asks to stop.
fn in_order_of_use<'u, T: Copy>(
    values: &[T],
    keep: impl Fn(&T) -> bool,
    uses: impl Iterator<Item = &'u mut u32>,
    assets: &Assets<'_>,
) -> Result<Vec<T>, Diagnostic> {
    let mut places = vec![Corner::NONE; values.len()];
    let mut used = Vec::new();
    for (i, index) in uses.enumerate() {
        if i.is_multiple_of(CORNERS_PER_QUESTION) {
            assets.check_stop()?;
        }
        let found = places.get_mut(*index as usize).zip(values.get(*index as usize));
        *index = match found {
            Some((place, value)) if *place == Corner::NONE && keep(value) => {
                *place = u32::try_from(used.len()).unwrap_or(Corner::NONE);
                used.push(*value);
                *place
            }
            Some((place, _)) => *place,
            None => Corner::NONE,
        };
    }
    Ok(used)
}

/// The triangles of the faces.
struct Triangles<'c> {
    /// The corners of all faces, their positions being places in `positions`.
    corners: &'c [Corner],
    positions: &'c [DVec3],
    /// The corners of each triangle, as places in `corners`.
    found: Vec<[u32; 3]>,
    /// The points of the face at hand.
    points: Vec<DVec3>,
}

impl Triangles<'_> {
    /// Adds the triangles of a face that have an area.
    fn add_face(&mut self, face: Range<usize>) {
        let start = face.start as u32;
        let corners = self.corners.get(face).unwrap_or(&[]);
        let point = |corner: &Corner| self.positions.get(corner.position as usize).copied();
        self.points.clear();
        self.points.extend(corners.iter().filter_map(point));
        if let [a, b, c] = self.points[..] {
            if has_area(a, b, c) {
                self.found.push([start, start + 1, start + 2]);
            }
            return;
        }
        for corners in triangulate(&self.points) {
            if let [Some(a), Some(b), Some(c)] = corners.map(|i| self.points.get(i).copied())
                && has_area(a, b, c)
            {
                self.found.push(corners.map(|i| start + i as u32));
            }
        }
    }

    /// What `of` gives for the corners, triangle by triangle.
    fn indices(&self, of: impl Fn(&Corner) -> u32) -> Vec<[u32; 3]> {
        let index = |corner: u32| self.corners.get(corner as usize).map_or(Corner::NONE, &of);
        self.found.iter().map(|corners| corners.map(index)).collect()
    }
}

fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}
