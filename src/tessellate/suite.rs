//! What holds for the meshes of this room.

use std::collections::BTreeMap;

pub(super) use crate::shape::suite::Rng;
use crate::{math::DVec3, scene::Mesh};

/// How often each directed edge occurs without its opposite.
fn open_edges(mesh: &Mesh) -> BTreeMap<(u32, u32), i32> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            assert_ne!(i, j, "a triangle with a corner twice");
            let (key, way) = if i < j { ((i, j), 1) } else { ((j, i), -1) };
            *edges.entry(key).or_insert(0) += way;
        }
    }
    edges.retain(|_, count| *count != 0);
    edges
}

/// Every edge belongs to two triangles, in opposite directions.
pub(super) fn check_closed(mesh: &Mesh) {
    let mut uses = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *uses.entry(edge).or_insert(0) += 1;
        }
    }
    let twice = uses.iter().find(|(_, count)| **count != 1);
    assert_eq!(twice, None, "an edge is used twice in one direction");
    let open = open_edges(mesh);
    assert!(
        open.is_empty(),
        "{} edges are open, first {:?}",
        open.len(),
        open.first_key_value().map(|((a, b), n)| (
            mesh.positions[*a as usize],
            mesh.positions[*b as usize],
            n
        ))
    );
    assert!(volume(mesh) > 0.0, "inside out: {}", volume(mesh));
}

/// The volume inside of a closed mesh; negative where it is inside out.
pub(super) fn volume(mesh: &Mesh) -> f64 {
    let of_face = |face| {
        let [a, b, c] = mesh.corners(face);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.triangles.len()).map(of_face).sum()
}

/// Normals have length 1 and lie on the front of their triangles: the cosine is `least` or more.
pub(super) fn check_normals(mesh: &Mesh, least: f64) {
    let normals = mesh.normals.as_ref().unwrap();
    assert_eq!(normals.indices.len(), mesh.triangles.len());
    for face in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(face);
        let flat = (b - a).cross(c - a);
        if flat.length() < 1e-12 {
            continue;
        }
        let flat = flat.normalize();
        let at: [DVec3; 3] = normals.corners(face).unwrap();
        for n in at {
            assert!((n.length() - 1.0).abs() < 1e-9, "{n} at {a}");
            assert!(n.dot(flat) >= least, "{} at {a} {b} {c}", n.dot(flat));
        }
    }
}

/// Edges that only one triangle has.
pub(super) fn open(mesh: &Mesh) -> Vec<(u32, u32)> {
    open_edges(mesh).into_keys().collect()
}

/// The distance of a point from a triangle (Ericson, "Real-time collision detection", 2005, 5.1.5, by its edges).
pub(super) fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_edge = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + (b - a) * t - p).length()
    };
    let n = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(a, b)| (b - a).cross(p - a).dot(n) >= 0.0);
    if inside && n.length() > 0.0 {
        return (p - a).dot(n.normalize()).abs();
    }
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}
