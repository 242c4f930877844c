//! Which textures a scene's materials name.

use crate::scene::{LightKind, Material, MaterialId, Scene};

/// For each texture whether objects name it themselves, or nothing does: not those that only files bring.
pub(super) fn is_named(scene: &Scene) -> Vec<bool> {
    let used = |materials: &mut dyn Iterator<Item = MaterialId>| {
        let (mut is_known, mut is_used) = (
            vec![false; scene.materials.len()],
            vec![false; scene.textures.len()],
        );
        for id in materials {
            let Some(known @ false) = is_known.get_mut(id.index()) else {
                continue;
            };
            *known = true;
            let material = scene.materials.get(id.index());
            for (_, texture) in material.into_iter().flat_map(Material::textures) {
                if let Some(used) = is_used.get_mut(texture.index()) {
                    *used = true;
                }
            }
        }
        is_used
    };
    let objects = scene.groups.iter().flat_map(|group| &group.objects);
    let faces = scene.meshes.iter().flat_map(|mesh| &mesh.face_materials);
    let mut by_objects = used(&mut objects.map(|object| object.material));
    for light in scene.groups.iter().flat_map(|group| &group.lights) {
        if let LightKind::Projector(projector) = &light.kind
            && let Some(used) = by_objects.get_mut(projector.image().index())
        {
            *used = true;
        }
    }
    let of_environment = scene.settings.surroundings.texture();
    if let Some(used) = of_environment.and_then(|id| by_objects.get_mut(id.index())) {
        *used = true;
    }
    let mut by_faces = used(&mut faces.copied());
    // What a file's textures are made of came with them. The parts of a texture stand before it.
    for i in (0..by_faces.len()).rev() {
        if by_faces.get(i) == Some(&true)
            && let Some(texture) = scene.textures.get(i)
        {
            for part in texture.parts() {
                let number = scene
                    .texture_number(part)
                    .and_then(|number| by_faces.get_mut(number));
                if let Some(used) = number {
                    *used = true;
                }
            }
        }
    }
    let both = by_objects.into_iter().zip(by_faces);
    both.map(|(by_object, by_face)| by_object || !by_face).collect()
}
