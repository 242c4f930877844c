//! Warnings about a complete scene: a black picture always comes with a sentence.

use super::{Scene, Surroundings, Term};
use crate::{
    color::Color,
    diag::{Code, Diagnostic},
};

/// What looks wrong with a scene as a whole.
pub(super) fn warnings(scene: &Scene) -> Vec<Diagnostic> {
    let mut warnings = Vec::new();
    if scene.root().objects.is_empty() {
        let defined = if scene.names.is_empty() {
            ""
        } else {
            "; a define is only seen where instance(name) places it"
        };
        warnings.push(Diagnostic::warning(
            Code::EmptyScene,
            format!("the scene is empty: the picture shows nothing but the background{defined}"),
        ));
        return warnings;
    }
    let glows = |term: &Term| !term.is_black();
    let lit_by_itself = scene.settings.background != Color::ZERO
        || scene.settings.surroundings != Surroundings::default()
        || used_materials(scene).any(|m| glows(&m.ambient) || glows(&m.emission));
    if scene.root().lights.iter().all(|light| light.color == Color::ZERO) && !lit_by_itself {
        warnings.push(
            Diagnostic::warning(
                Code::NoLight,
                "the scene has no light, and nothing glows: the picture will be black",
            )
            .hint("add light([5, 5, 5], [1, 1, 1])"),
        );
    }
    warnings
}

fn used_materials(scene: &Scene) -> impl Iterator<Item = &super::Material> {
    let objects = scene.groups.iter().flat_map(|group| &group.objects);
    let own = objects
        .clone()
        .filter(|o| o.geometry.group().is_none())
        .filter_map(|o| scene.materials.get(o.material.index()));
    let of_meshes = scene.meshes.iter().flat_map(|mesh| &mesh.face_materials);
    own.chain(of_meshes.filter_map(|id| scene.materials.get(id.index())))
}
