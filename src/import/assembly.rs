//! From a checked OBJ file through its reader to a mesh.

use std::{ops::Range, panic};

use super::{assets::Assets, guard::Checked, text::Source, wavefront::Unused};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::{DVec2, DVec3},
    scene::{Attribute, Builder, MaterialId, Mesh, SceneError},
    shape::triangulate,
};

/// Corners between two questions whether to stop.
const CORNERS_PER_QUESTION: usize = 1 << 14;

/// The mesh of a checked file; `materials` are those of its `usemtl` names.
///
/// # Errors
/// Where no face has an area, where the host asks to stop, or where the reader fails in spite of the guard.
pub(super) fn mesh<'a>(
    source: &Source<'a>,
    checked: &Checked<'a>,
    materials: &[MaterialId],
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    let internal = |message: String| Diagnostic::error(ErrorKind::Internal, message).at(source.name, 0, 0);
    let read = read(checked).map_err(internal)?;
    let mut triangles = Triangles::new(&read);
    let mut degenerate = Unused::default();
    let mut face_materials = Vec::new();
    let mut question = 0;
    for (face, corners) in checked.faces.iter().zip(corners_of_faces(&read)) {
        if corners.end >= question {
            assets.check_stop()?;
            question = corners.end + CORNERS_PER_QUESTION;
        }
        let before = triangles.corners.len();
        triangles.add_face(corners);
        if triangles.corners.len() == before {
            degenerate.add(face.at);
        }
        let material = face
            .material
            .and_then(|slot| materials.get(slot as usize).copied());
        face_materials.resize(triangles.corners.len(), material.unwrap_or(MaterialId::INHERIT));
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
    if triangles.corners.is_empty() {
        let error = Diagnostic::error(ErrorKind::Input, "no face of the file has an area");
        return Err(error.at(source.name, 0, 0));
    }
    if face_materials.iter().all(|id| *id == MaterialId::INHERIT) {
        face_materials = Vec::new();
    }
    let normals: Vec<DVec3> = read
        .normals
        .as_chunks()
        .0
        .iter()
        .map(|n| DVec3::from_array(*n))
        .collect();
    let uvs: Vec<DVec2> = read
        .texcoords
        .as_chunks()
        .0
        .iter()
        .map(|t| DVec2::from_array(*t))
        .collect();
    // The guard's NaN stands for none, and a normal of length zero says nothing either.
    let normals = attribute(&normals, triangles.indices(&read.normal_indices), |n| {
        !n.is_nan() && *n != DVec3::ZERO
    });
    let uvs = attribute(&uvs, triangles.indices(&read.texcoord_indices), |uv| !uv.is_nan());
    let corners = triangles.indices(&read.indices);
    let mesh = Mesh::new(source.name, triangles.positions, corners);
    let mut mesh = mesh.map_err(|SceneError { message, .. }| internal(message))?;
    mesh.normals = normals;
    mesh.uvs = uvs;
    mesh.face_materials = face_materials;
    Ok(mesh)
}

/// What the reader makes of the checked text: one mesh with separate indices, looked over once more.
fn read(checked: &Checked<'_>) -> Result<tobj::Mesh, String> {
    let read = panic::catch_unwind(|| {
        tobj::load_obj_buf(
            &mut checked.text.as_bytes(),
            &tobj::LoadOptions::default(),
            |_| Err(tobj::LoadError::OpenFileFailed),
        )
    });
    let models = match read {
        Ok(Ok((models, _))) => models,
        Ok(Err(error)) => return Err(format!("the OBJ reader refuses the file: {error}")),
        Err(_) => return Err("the OBJ reader gave up on the file".to_owned()),
    };
    let Ok([model]) = <[tobj::Model; 1]>::try_from(models) else {
        return Err("the OBJ reader made several meshes of one".to_owned());
    };
    let mesh = model.mesh;
    let corners: usize = corners_of_faces(&mesh).map(|corners| corners.len()).sum();
    let lists = [
        (&mesh.indices, mesh.positions.len() / 3),
        (&mesh.texcoord_indices, mesh.texcoords.len() / 2),
        (&mesh.normal_indices, mesh.normals.len() / 3),
    ];
    let fits = |(indices, len): &(&Vec<u32>, usize)| {
        indices.len() == corners && indices.iter().all(|i| (*i as usize) < *len)
    };
    if corners_of_faces(&mesh).count() != checked.faces.len() || !lists.iter().all(fits) {
        return Err("the OBJ reader contradicts itself".to_owned());
    }
    Ok(mesh)
}

/// Where in the lists of indices each face has its corners.
fn corners_of_faces(mesh: &tobj::Mesh) -> impl Iterator<Item = Range<usize>> {
    // The reader gives no arities where all faces are triangles.
    let triangles = if mesh.face_arities.is_empty() {
        mesh.indices.len() / 3
    } else {
        0
    };
    let arities = mesh.face_arities.iter().map(|n| *n as usize);
    arities
        .chain(std::iter::repeat_n(3, triangles))
        .scan(0, |end, arity| {
            let start = *end;
            *end += arity;
            Some(start..*end)
        })
}

/// The triangles of the faces, each corner as its place in the reader's lists of indices.
struct Triangles<'a> {
    read: &'a tobj::Mesh,
    positions: Vec<DVec3>,
    corners: Vec<[usize; 3]>,
    /// The points of the face at hand.
    points: Vec<DVec3>,
}

impl<'a> Triangles<'a> {
    fn new(read: &'a tobj::Mesh) -> Self {
        let positions = read.positions.as_chunks().0;
        Self {
            read,
            positions: positions.iter().map(|p| DVec3::from_array(*p)).collect(),
            corners: Vec::new(),
            points: Vec::new(),
        }
    }

    /// Adds the triangles of a face that have an area.
    fn add_face(&mut self, face: Range<usize>) {
        let indices = self.read.indices.get(face.clone()).unwrap_or(&[]);
        let points = indices
            .iter()
            .filter_map(|i| self.positions.get(*i as usize).copied());
        self.points.clear();
        self.points.extend(points);
        if let [a, b, c] = self.points[..] {
            if has_area(a, b, c) {
                self.corners.push([face.start, face.start + 1, face.start + 2]);
            }
            return;
        }
        for corners in triangulate(&self.points) {
            if let [Some(a), Some(b), Some(c)] = corners.map(|i| self.points.get(i).copied())
                && has_area(a, b, c)
            {
                self.corners.push(corners.map(|i| face.start + i));
            }
        }
    }

    /// One of the reader's lists of indices, triangle by triangle.
    fn indices(&self, list: &[u32]) -> Vec<[u32; 3]> {
        let index = |corner: usize| list.get(corner).copied().unwrap_or(u32::MAX);
        self.corners.iter().map(|corners| corners.map(index)).collect()
    }
}

fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}

/// Values at the corners, without those that stand for none, which are the ones that `keep` refuses.
fn attribute<T: Copy>(
    values: &[T],
    mut indices: Vec<[u32; 3]>,
    keep: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    let mut kept = Vec::with_capacity(values.len());
    let renumbered: Vec<u32> = (values.iter())
        .map(|value| {
            if !keep(value) {
                return Attribute::<T>::NONE;
            }
            kept.push(*value);
            u32::try_from(kept.len() - 1).unwrap_or(Attribute::<T>::NONE)
        })
        .collect();
    for index in indices.as_flattened_mut() {
        *index = renumbered
            .get(*index as usize)
            .copied()
            .unwrap_or(Attribute::<T>::NONE);
    }
    if kept.is_empty() {
        return None;
    }
    Some(Attribute {
        values: kept,
        indices,
    })
}
