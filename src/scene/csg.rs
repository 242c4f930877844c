//! Solids put together from solids: union, intersection, difference.

use std::fmt;

use super::{Geometry, GroupId, Mesh, Object, Scene};
use crate::{math::DVec3, shape::Shape};

/// How the solids of a [`Group`](super::Group) make one (constructive solid geometry: Requicha and Voelcker,
/// "Constructive Solid Geometry", 1977).
///
/// Each object of the group is one solid, an instance the union of all that is in its group. The surface that is seen is
/// part of the surfaces of these solids and looks as they do, so a cut has the material of what cut it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CsgOp {
    /// What is inside of any of them.
    Union,
    /// What is inside of all of them.
    Intersection,
    /// What is inside of the first and of none of the others.
    Difference,
}

impl CsgOp {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Union, Self::Intersection, Self::Difference];

    /// What the script calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }

    /// Whether the object with this index is cut away, so that its surface is seen from within.
    ///
    /// ```
    /// use rtscript::scene::CsgOp;
    /// // The second part of a difference is a hole in the first.
    /// assert!(!CsgOp::Difference.cuts(0) && CsgOp::Difference.cuts(1));
    /// assert!(!CsgOp::Union.cuts(1));
    /// ```
    #[must_use]
    pub const fn cuts(self, index: u32) -> bool {
        matches!(self, Self::Difference) && index > 0
    }
}

impl fmt::Display for CsgOp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Whether a shape has an inside: a plane has all that lies below it.
pub(super) fn has_inside(shape: &Shape) -> bool {
    matches!(shape, Shape::Plane(_)) || shape.is_solid()
}

/// The first object of a group, or of the groups that it places, that has no inside.
pub(super) fn open_object(scene: &Scene, id: GroupId) -> Option<&Object> {
    let mut seen = vec![false; scene.groups.len()];
    let mut waiting = vec![id];
    while let Some(id) = waiting.pop() {
        match seen.get_mut(id.index()) {
            Some(seen @ false) => *seen = true,
            _ => continue,
        }
        for object in scene.groups.get(id.index()).into_iter().flat_map(|g| &g.objects) {
            match &object.geometry {
                // What is in it was looked at when it was made.
                Geometry::Csg(..) => {}
                Geometry::Instance(inner) | Geometry::Moving(inner) => waiting.push(*inner),
                Geometry::Shape(shape) if has_inside(shape) => {}
                Geometry::Mesh(mesh) if scene.meshes.get(mesh.index()).is_some_and(|m| is_closed(m)) => {}
                _ => return Some(object),
            }
        }
    }
    None
}

/// Whether a mesh bounds a volume: each of its edges, told by where its ends are, belongs to an even number of
/// triangles. Then every line crosses it an even number of times.
pub(super) fn is_closed(mesh: &Mesh) -> bool {
    // -0 is 0.
    let bits = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut edges = Vec::with_capacity(3 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let corner = |i: u32| mesh.positions.get(i as usize).copied().map(bits);
        let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else {
            return false;
        };
        for (p, q) in [(a, b), (b, c), (c, a)] {
            // An edge without length has nothing on either side.
            if p != q {
                edges.push(if p < q { (p, q) } else { (q, p) });
            }
        }
    }
    edges.sort_unstable();
    !edges.is_empty()
        && edges
            .chunk_by(|a, b| a == b)
            .all(|same| same.len().is_multiple_of(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron(faces: &[[u32; 3]]) -> Mesh {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        Mesh::new("t", corners, faces.to_vec()).unwrap()
    }

    #[test]
    fn a_mesh_is_closed_where_every_edge_has_two_sides() {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        assert!(is_closed(&tetrahedron(&faces)));
        assert!(!is_closed(&tetrahedron(&faces[..3])));
        assert!(!is_closed(&tetrahedron(&[])));
    }

    #[test]
    fn corners_that_stand_in_one_place_are_one() {
        let mut mesh = tetrahedron(&[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        mesh.positions
            .extend([DVec3::X, DVec3::Y, DVec3::new(-0.0, 0.0, 1.0)]);
        mesh.triangles[3] = [4, 5, 6];
        assert!(is_closed(&mesh));
    }
}
