//! Which textures a surface has, and what they are where a ray meets it.

use serde_json::{Value, json};

use super::text::color;
use crate::{
    render::explain::{ExplainedHit, ExplainedTexture},
    scene::{Material, Scene, Texture},
};

/// Characters of a texture's text that people are shown.
const LONGEST: usize = 160;

/// The call that makes a texture; those of the scene that are within it by their numbers.
fn call(scene: &Scene, texture: &Texture) -> String {
    texture.call(&|inner| Some(format!("texture {}", scene.texture_number(inner)?)))
}

/// What the textures of a material's terms are, each once.
pub(super) fn calls(scene: &Scene, material: &Material) -> Vec<String> {
    let mut numbers: Vec<usize> = material.textures().iter().map(|(_, id)| id.index()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let text = |number: usize| {
        let mut text = call(scene, scene.textures.get(number)?);
        if let Some((end, _)) = text.char_indices().nth(LONGEST) {
            text.truncate(end);
            text.push_str("...");
        }
        Some(format!("texture {number} is {text}"))
    };
    numbers.into_iter().filter_map(text).collect()
}

/// What each texture is at a point, by the terms that it stands for.
pub(super) fn values(hit: &ExplainedHit<'_>) -> Vec<String> {
    let text = |used: &ExplainedTexture| {
        let (number, value) = (used.texture.index(), color(used.value));
        format!("{:8}  texture {number}, here {value}", used.term)
    };
    hit.textures.iter().map(text).collect()
}

/// The same for programs, with the calls in full.
pub(super) fn json(scene: &Scene, hit: &ExplainedHit<'_>) -> Vec<Value> {
    let value = |used: &ExplainedTexture| {
        let number = used.texture.index();
        json!({
            "term": used.term,
            "texture": number,
            "text": scene.textures.get(number).map(|texture| call(scene, texture)),
            "value": used.value.to_array(),
        })
    };
    hit.textures.iter().map(value).collect()
}
