//! Meshes from lists of numbers, as scripts and programs give them.

use crate::{
    color::Color,
    math::{DVec2, DVec3},
    scene::{Attribute, Mesh, SceneError},
};

/// A mesh of `positions`, three `indices` a triangle, counter-clockwise seen from the front; without indices
/// every three positions are a triangle. `normals`, of any length but 0, and `uvs` belong to the positions, one
/// each; without normals the mesh is flat.
///
/// # Errors
/// Where there are no positions, the indices or the positions do not come in threes, an index is not that of a
/// position, there are not as many normals or uvs as positions, a number is not finite or beyond 1e15, or a normal
/// is zero. The message names the first entry that is wrong, counted from 0.
///
/// ```
/// use rtscript::{DVec3, import::mesh_from_arrays};
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// let mesh = mesh_from_arrays(corners, Some(&[0, 1, 2]), None, None)?;
/// assert_eq!(mesh.triangles, [[0, 1, 2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mesh_from_arrays(
    positions: Vec<DVec3>,
    indices: Option<&[i64]>,
    normals: Option<Vec<DVec3>>,
    uvs: Option<Vec<DVec2>>,
) -> Result<Mesh, SceneError> {
    let count = positions.len();
    if count == 0 {
        return Err(SceneError::new("the mesh has no positions"));
    }
    let triangles = match indices {
        Some(indices) => indexed(indices, count)?,
        None => in_order(count)?,
    };
    let mut mesh = Mesh::new("mesh", positions, triangles)?;
    if let Some(normals) = normals {
        check_count("normals", normals.len(), count)?;
        check_normals(&normals)?;
        mesh.normals = Some(at_the_corners(&mesh, normals));
    }
    if let Some(uvs) = uvs {
        check_count("uvs", uvs.len(), count)?;
        check_uvs(&uvs)?;
        mesh.uvs = Some(at_the_corners(&mesh, uvs));
    }
    Ok(mesh)
}

/// Gives a mesh normals with indices of their own, three a triangle, -1 where a corner has none: so corners at one place
/// may differ, as along the edges of a box.
///
/// # Errors
/// Where a normal is zero or not finite, there are not as many indices as corners, or one is not that of a normal.
///
/// ```
/// use rtscript::{DVec3, import::{mesh_from_arrays, set_normals}};
/// let mut mesh = mesh_from_arrays(vec![DVec3::ZERO, DVec3::X, DVec3::Y], None, None, None)?;
/// set_normals(&mut mesh, vec![DVec3::Z], &[0, 0, 0])?;
/// assert!(mesh.normals.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn set_normals(mesh: &mut Mesh, normals: Vec<DVec3>, indices: &[i64]) -> Result<(), SceneError> {
    check_normals(&normals)?;
    mesh.normals = Some(Attribute {
        indices: own_indices(mesh, "normal", indices, normals.len())?,
        values: normals,
    });
    Ok(())
}

/// As [`set_normals`], for texture coordinates.
///
/// # Errors
/// As [`set_normals`]; a uv may be zero.
///
/// ```
/// use rtscript::{DVec3, import::{mesh_from_arrays, set_uvs}, math::DVec2};
/// let mut mesh = mesh_from_arrays(vec![DVec3::ZERO, DVec3::X, DVec3::Y], None, None, None)?;
/// set_uvs(&mut mesh, vec![DVec2::ZERO, DVec2::X, DVec2::Y], &[0, 1, 2])?;
/// assert!(mesh.uvs.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn set_uvs(mesh: &mut Mesh, uvs: Vec<DVec2>, indices: &[i64]) -> Result<(), SceneError> {
    check_uvs(&uvs)?;
    mesh.uvs = Some(Attribute {
        indices: own_indices(mesh, "uv", indices, uvs.len())?,
        values: uvs,
    });
    Ok(())
}

/// Gives a mesh scene-linear colors: one for each position, or with `indices` of their own, three a triangle, -1 where a
/// corner has none, as for [`set_normals`]. [`Texture::VertexColors`](crate::scene::Texture::VertexColors) shows them; the
/// corners of a triangle of which one has no color are white.
///
/// # Errors
/// Where there are not as many colors as positions, or indices as corners, an index is not that of a color, or a color is
/// negative, not finite or beyond 1e15.
///
/// ```
/// use rtscript::{DVec3, import::{mesh_from_arrays, set_colors}};
/// let mut mesh = mesh_from_arrays(vec![DVec3::ZERO, DVec3::X, DVec3::Y], None, None, None)?;
/// set_colors(&mut mesh, vec![DVec3::X, DVec3::Y, DVec3::Z], None)?;
/// assert!(mesh.colors.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn set_colors(mesh: &mut Mesh, colors: Vec<Color>, indices: Option<&[i64]>) -> Result<(), SceneError> {
    for (i, color) in colors.iter().enumerate() {
        Mesh::check_color(*color, format_args!("color {i} of the mesh"))?;
    }
    mesh.colors = Some(match indices {
        Some(indices) => Attribute {
            indices: own_indices(mesh, "color", indices, colors.len())?,
            values: colors,
        },
        None => {
            check_count("colors", colors.len(), mesh.positions.len())?;
            at_the_corners(mesh, colors)
        }
    });
    Ok(())
}

fn own_indices(mesh: &Mesh, what: &str, indices: &[i64], count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
    let corners = 3 * mesh.triangles.len();
    if indices.len() != corners {
        return Err(SceneError::new(format!(
            "the mesh has {} {what} indices for {} triangles; expected {corners}",
            indices.len(),
            mesh.triangles.len()
        )));
    }
    let index = |i: i64| match i {
        -1 => Some(Attribute::<DVec3>::NONE),
        _ => u32::try_from(i).ok().filter(|i| (*i as usize) < count),
    };
    let checked = indices.as_chunks::<3>().0.iter();
    let checked = checked.map(|[a, b, c]| Some([index(*a)?, index(*b)?, index(*c)?]));
    if let Some(checked) = checked.collect() {
        return Ok(checked);
    }
    let wrong = indices.iter().enumerate().find(|(_, i)| index(**i).is_none());
    let (at, value) = wrong.map_or((0, 0), |(at, value)| (at, *value));
    Err(SceneError::new(format!(
        "{what} index {at} of the mesh is {value}, but there are {count}, numbered from 0; -1 is none"
    )))
}

fn check_normals(normals: &[DVec3]) -> Result<(), SceneError> {
    if let Some((i, normal)) = normals
        .iter()
        .enumerate()
        .find(|(_, n)| !(n.is_finite() && **n != DVec3::ZERO))
    {
        let what = if *normal == DVec3::ZERO {
            "zero"
        } else {
            "not finite"
        };
        return Err(SceneError::new(format!("normal {i} of the mesh is {what}"))
            .hint("a mesh without normals is flat"));
    }
    Ok(())
}

fn check_uvs(uvs: &[DVec2]) -> Result<(), SceneError> {
    if let Some(i) = uvs.iter().position(|uv| !uv.is_finite()) {
        return Err(SceneError::new(format!("uv {i} of the mesh is not finite")));
    }
    Ok(())
}

fn indexed(indices: &[i64], count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() || triangles.is_empty() {
        return Err(SceneError::new(format!(
            "the mesh has {} indices, but every triangle takes 3",
            indices.len()
        )));
    }
    let index = |i: i64| u32::try_from(i).ok().filter(|i| (*i as usize) < count);
    let checked = triangles
        .iter()
        .map(|[a, b, c]| Some([index(*a)?, index(*b)?, index(*c)?]));
    if let Some(checked) = checked.collect() {
        return Ok(checked);
    }
    let wrong = indices.iter().enumerate().find(|(_, i)| index(**i).is_none());
    let (at, value) = wrong.map_or((0, 0), |(at, value)| (at, *value));
    Err(SceneError::new(format!(
        "index {at} of the mesh is {value}, but its positions are numbered 0 to {}",
        count - 1
    )))
}

fn in_order(count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
    if !count.is_multiple_of(3) {
        return Err(SceneError::new(format!(
            "the mesh has {count} positions and no indices, but every triangle takes 3"
        ))
        .hint("give indices: [...], three for each triangle, counted from 0"));
    }
    let end = u32::try_from(count).map_err(|_| SceneError::new("the mesh has too many positions"))?;
    Ok((0..end / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn check_count(what: &str, given: usize, positions: usize) -> Result<(), SceneError> {
    if given == positions {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "the mesh has {given} {what} for {positions} positions; expected one for each"
    )))
}

fn at_the_corners<T>(mesh: &Mesh, values: Vec<T>) -> Attribute<T> {
    Attribute {
        values,
        indices: mesh.triangles.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn attributes_follow_the_positions() {
        let normals = vec![DVec3::Z * 2.0; 4];
        let uvs = square().iter().map(|p| p.truncate()).collect();
        let mesh = mesh_from_arrays(square(), Some(&[0, 1, 2, 0, 2, 3]), Some(normals), Some(uvs)).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.corners(1)[2], DVec3::Y);
        assert_eq!(mesh.uvs.unwrap().corners(1).unwrap()[2], DVec2::Y);
        assert_eq!(mesh.normals.unwrap().corners(0).unwrap(), [DVec3::Z * 2.0; 3]);
    }

    #[test]
    fn corners_may_have_indices_of_their_own() {
        let mut mesh = mesh_from_arrays(square(), Some(&[0, 1, 2, 0, 2, 3]), None, None).unwrap();
        set_normals(&mut mesh, vec![DVec3::Z, DVec3::X], &[0, 0, 0, 1, 1, -1]).unwrap();
        let normals = mesh.normals.as_ref().unwrap();
        assert_eq!(normals.corners(0).unwrap(), [DVec3::Z; 3]);
        assert_eq!((normals.indices[1], normals.corners(1)), ([1, 1, u32::MAX], None));
        let message = |error: Result<(), SceneError>| error.unwrap_err().message;
        assert_eq!(
            message(set_uvs(&mut mesh, vec![DVec2::X], &[0, 0, 0])),
            "the mesh has 3 uv indices for 2 triangles; expected 6"
        );
        assert_eq!(
            message(set_uvs(&mut mesh, vec![DVec2::X], &[0, 0, 1, 0, -2, 0])),
            "uv index 2 of the mesh is 1, but there are 1, numbered from 0; -1 is none"
        );
        assert_eq!(
            message(set_normals(&mut mesh, vec![DVec3::ZERO], &[0; 6])),
            "normal 0 of the mesh is zero"
        );
    }

    #[test]
    fn colors_are_those_of_positions_or_of_corners() {
        let mut mesh = mesh_from_arrays(square(), Some(&[0, 1, 2, 0, 2, 3]), None, None).unwrap();
        let colors = vec![Color::X, Color::Y, Color::Z, Color::ONE];
        set_colors(&mut mesh, colors, None).unwrap();
        let corners = |mesh: &Mesh, face| mesh.colors.as_ref().unwrap().corners(face);
        assert_eq!(corners(&mesh, 1), Some([Color::X, Color::Z, Color::ONE]));
        set_colors(&mut mesh, vec![Color::Y], Some(&[0, 0, 0, 0, -1, 0])).unwrap();
        assert_eq!(
            (corners(&mesh, 0), corners(&mesh, 1)),
            (Some([Color::Y; 3]), None)
        );
        let mut message = |colors, indices| set_colors(&mut mesh, colors, indices).unwrap_err().message;
        assert_eq!(
            message(vec![Color::X; 3], None),
            "the mesh has 3 colors for 4 positions; expected one for each"
        );
        assert_eq!(
            message(vec![Color::X], Some(&[0; 5])),
            "the mesh has 5 color indices for 2 triangles; expected 6"
        );
        for bad in [-0.1, f64::NAN, f64::INFINITY, 2e15] {
            assert_eq!(
                message(vec![Color::X, Color::new(0.0, bad, 1.0)], None),
                format!("color 1 of the mesh must be finite numbers from 0 to 1e15, not [0, {bad}, 1]")
            );
        }
    }

    #[test]
    fn without_indices_three_positions_are_a_triangle() {
        let mut positions = square();
        positions.extend([DVec3::X, DVec3::Y]);
        let mesh = mesh_from_arrays(positions, None, None, None).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!((mesh.normals, mesh.uvs), (None, None));
    }

    #[test]
    fn the_first_wrong_entry_is_named() {
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        let message = |positions, indices: Option<&[i64]>, normals, uvs| {
            mesh_from_arrays(positions, indices, normals, uvs)
                .unwrap_err()
                .message
        };
        let three = Some(&[0, 1, 2][..]);
        assert_eq!(message(vec![], None, None, None), "the mesh has no positions");
        assert_eq!(
            message(square(), None, None, None),
            "the mesh has 4 positions and no indices, but every triangle takes 3"
        );
        for indices in [&[0, 1, 2, 3][..], &[]] {
            assert_eq!(
                message(square(), Some(indices), None, None),
                format!(
                    "the mesh has {} indices, but every triangle takes 3",
                    indices.len()
                )
            );
        }
        for bad in [4, -1, i64::MAX, i64::MIN, 1 << 32] {
            assert_eq!(
                message(square(), Some(&[0, 1, 2, 0, bad, -7]), None, None),
                format!("index 4 of the mesh is {bad}, but its positions are numbered 0 to 3")
            );
        }
        assert_eq!(
            message(vec![DVec3::X, DVec3::Y, nan], None, None, None),
            "position 2 of the mesh is not a finite point within 1e15 of the origin"
        );
        assert_eq!(
            message(square(), three, Some(vec![DVec3::X; 3]), None),
            "the mesh has 3 normals for 4 positions; expected one for each"
        );
        let one_bad = |bad| Some(vec![DVec3::X, bad, DVec3::X, DVec3::X]);
        assert_eq!(
            message(square(), three, one_bad(DVec3::ZERO), None),
            "normal 1 of the mesh is zero"
        );
        assert_eq!(
            message(square(), three, one_bad(nan), None),
            "normal 1 of the mesh is not finite"
        );
        assert_eq!(
            message(square(), three, None, Some(vec![DVec2::X; 5])),
            "the mesh has 5 uvs for 4 positions; expected one for each"
        );
        assert_eq!(
            message(
                square(),
                three,
                None,
                Some(vec![DVec2::X, DVec2::X, DVec2::X, DVec2::NAN])
            ),
            "uv 3 of the mesh is not finite"
        );
    }
}
