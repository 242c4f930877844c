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
            for texture in scene.materials.get(id.index()).into_iter().flat_map(terms) {
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

/// Textures of a material in the order in which `material(#{ })` looks at its terms: that of their keys.
pub(super) fn terms(material: &Material) -> Vec<TextureId> {
    let of = |term: Term| term.texture;
    let mut all = vec![
        ("ambient", of(material.ambient)),
        ("diffuse", of(material.diffuse)),
        ("emission", of(material.emission)),
        ("reflection", material.reflection.and_then(of)),
        ("specular", of(material.specular)),
        ("transmission", of(material.transmission)),
    ];
    if let Some(finish) = &material.finish {
        all.extend(finish.textures());
    }
    // Those of one key stay in their order.
    all.sort_by_key(|(key, _)| *key);
    all.into_iter().filter_map(|(_, texture)| texture).collect()
}
