//! The nodes of a file: which meshes stand where.

use super::{
    MESH, NODE, SCENE,
    item::Item,
    shape::{Place, Triangles},
};
use crate::{
    diag::Diagnostic,
    math::{DAffine3, DMat3, DVec3},
    scene::Builder,
};

/// Adds the meshes of all nodes of the file's scene, each node before its children.
///
/// # Errors
/// Where a number leads nowhere, a node is the child of two, or of itself by any way, or a mesh is malformed.
pub(super) fn add_all<'a>(
    root: &Item<'_, 'a>,
    triangles: &mut Triangles<'a, '_, '_>,
    builder: &mut Builder,
) -> Result<(), Diagnostic> {
    let count = root.count(NODE.list)?;
    let mut is_placed = vec![false; count];
    let mut open = Vec::new();
    let all_scenes = root.get(SCENE.list)?;
    let chosen = match (&all_scenes, root.get("scene")?) {
        (Some(scenes), Some(number)) => scenes.entry(number.index(SCENE, root.count(SCENE.list)?)?)?,
        (Some(scenes), None) => scenes.entry(0)?,
        (None, _) => None,
    };
    match &chosen {
        Some(scene) => {
            if let Some(roots) = scene.get("nodes")? {
                for number in roots.entries()? {
                    open.push(child(&number, &mut is_placed, DAffine3::IDENTITY)?);
                }
            }
        }
        None => open.extend(parentless(root, count)?.map(|i| (i, DAffine3::IDENTITY))),
    }
    open.reverse();
    let nodes = root.get(NODE.list)?;
    while let Some((i, outer)) = open.pop() {
        let Some(node) = nodes.as_ref().map_or(Ok(None), |nodes| nodes.entry(i))? else {
            continue;
        };
        triangles.assets.check_stop()?;
        let world = outer * local(&node)?;
        if let Some(number) = node.get("mesh")? {
            let j = number.index(MESH, root.count(MESH.list)?)?;
            let meshes = root.needed(MESH.list)?;
            if let Some(mesh) = meshes.entry(j)? {
                let skin = node.get("skin")?;
                if let Some(skin) = &skin
                    && triangles.is_first_of("skins")
                {
                    let message = "skins do not bend the mesh: it stands as it was made";
                    skin.warn(builder, message, None);
                }
                // What has a skin stands where its joints are, and not where its node is.
                let place = Place::new(if skin.is_some() { DAffine3::IDENTITY } else { world });
                let weights = node.get("weights")?;
                triangles.add_mesh(root, &mesh, weights.as_ref(), &place, builder)?;
            }
        }
        if let Some(children) = node.get("children")? {
            let before = open.len();
            for number in children.entries()? {
                open.push(child(&number, &mut is_placed, world)?);
            }
            open.get_mut(before..).unwrap_or_default().reverse();
        }
    }
    Ok(())
}

/// The node with that number, which has no other parent.
fn child(
    number: &Item<'_, '_>,
    is_placed: &mut [bool],
    world: DAffine3,
) -> Result<(usize, DAffine3), Diagnostic> {
    let i = number.index(NODE, is_placed.len())?;
    match is_placed.get_mut(i) {
        Some(placed @ false) => *placed = true,
        _ => {
            return Err(number.error(format!(
                "node {i} is there already: a node has one parent, and is not below itself"
            )));
        }
    }
    Ok((i, world))
}

/// The nodes that are no children, for files without a scene.
fn parentless(root: &Item<'_, '_>, count: usize) -> Result<impl Iterator<Item = usize> + use<>, Diagnostic> {
    let mut is_child = vec![false; count];
    if let Some(nodes) = root.get(NODE.list)? {
        for node in nodes.entries()? {
            if let Some(children) = node.get("children")? {
                for number in children.entries()? {
                    if let Some(child) = is_child.get_mut(number.index(NODE, count)?) {
                        *child = true;
                    }
                }
            }
        }
    }
    Ok((0..count).filter(move |i| is_child.get(*i) == Some(&false)))
}

/// The matrix of a node in its parent's space.
fn local(node: &Item<'_, '_>) -> Result<DAffine3, Diagnostic> {
    if let Some(item) = node.get("matrix")? {
        // Column by column.
        let m = item.numbers::<16>()?;
        let [ax, ay, az, aw, bx, by, bz, bw, cx, cy, cz, cw, x, y, z, w] = m;
        if [aw, bw, cw, w] != [0.0, 0.0, 0.0, 1.0] {
            return Err(item.error(format!(
                "the last row of the matrix is {aw}, {bw}, {cw}, {w}; expected 0, 0, 0, 1"
            )));
        }
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(
                DVec3::new(ax, ay, az),
                DVec3::new(bx, by, bz),
                DVec3::new(cx, cy, cz),
            ),
            translation: DVec3::new(x, y, z),
        });
    }
    let scale = node.get("scale")?.map_or(Ok([1.0; 3]), |item| item.numbers())?;
    let turn = match node.get("rotation")? {
        Some(item) => turned(&item)?,
        None => DMat3::IDENTITY,
    };
    let translation = node
        .get("translation")?
        .map_or(Ok([0.0; 3]), |item| item.numbers())?;
    let [x, y, z] = scale;
    Ok(DAffine3 {
        matrix3: DMat3::from_cols(turn.x_axis * x, turn.y_axis * y, turn.z_axis * z),
        translation: DVec3::from_array(translation),
    })
}

/// The matrix of a quaternion x, y, z, w, of any length but 0.
fn turned(item: &Item<'_, '_>) -> Result<DMat3, Diagnostic> {
    let [x, y, z, w] = item.numbers::<4>()?;
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    if !s.is_finite() || s == 0.0 {
        return Err(item.error("expected a quaternion of length 1"));
    }
    Ok(DMat3::from_cols(
        DVec3::new(
            1.0 - s * (y * y + z * z),
            s * (x * y + w * z),
            s * (x * z - w * y),
        ),
        DVec3::new(
            s * (x * y - w * z),
            1.0 - s * (x * x + z * z),
            s * (y * z + w * x),
        ),
        DVec3::new(
            s * (x * z + w * y),
            s * (y * z - w * x),
            1.0 - s * (x * x + y * y),
        ),
    ))
}
