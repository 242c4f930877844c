//! Which textures a scene's materials name.

use crate::scene::{LightKind, Material, MaterialId, Scene, Term, TextureId};

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
            for texture in scene
                .materials
                .get(id.index())
                .into_iter()
                .flat_map(terms)
                .flatten()
            {
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
    let by_faces = used(&mut faces.copied());
    let both = by_objects.into_iter().zip(by_faces);
    both.map(|(by_object, by_face)| by_object || !by_face).collect()
}

/// Textures of a material in the order in which `material(#{ })` looks at its terms.
pub(super) fn terms(material: &Material) -> impl Iterator<Item = Option<TextureId>> + use<> {
    let [bump, normal_map, roughness] = material
        .finish
        .as_ref()
        .map_or([None; 3], |finish| finish.textures());
    let of = |term: Term| term.texture;
    [
        of(material.ambient),
        bump,
        of(material.diffuse),
        of(material.emission),
        normal_map,
        material.reflection.and_then(of),
        roughness,
        of(material.specular),
        of(material.transmission),
    ]
    .into_iter()
}
