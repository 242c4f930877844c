//! Which texture coordinates a texture is laid by. A mesh has one set of them, that of its material's first texture.

use super::{MATERIAL, item::Item};
use crate::{
    diag::Diagnostic,
    math::{self, DVec2},
};

/// A set of texture coordinates, and how they are moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Layer {
    set: usize,
    moved: Option<Moved>,
}

/// `KHR_texture_transform`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moved {
    offset: DVec2,
    scale: DVec2,
    /// Cosine and sine of the angle.
    turn: [f64; 2],
}

/// The textures of a material and where they stand in it, in the order in which they decide about the set.
const TEXTURES: [&[&str]; 5] = [
    &["pbrMetallicRoughness", "baseColorTexture"],
    &["pbrMetallicRoughness", "metallicRoughnessTexture"],
    &["normalTexture"],
    &["emissiveTexture"],
    &["occlusionTexture"],
];

impl Layer {
    /// That of the material with that number.
    pub(super) fn of_material(root: &Item<'_, '_>, material: Option<usize>) -> Result<Self, Diagnostic> {
        let Some(i) = material else {
            return Ok(Self::default());
        };
        let materials = root.needed(MATERIAL.list)?;
        let Some(material) = materials.entry(i)? else {
            return Ok(Self::default());
        };
        for way in TEXTURES {
            if let Some(layer) = along(&material, way)? {
                return Ok(layer);
            }
        }
        Ok(Self::default())
    }

    /// That of an entry as `baseColorTexture`.
    pub(super) fn of(texture: &Item<'_, '_>) -> Result<Self, Diagnostic> {
        let set = texture.whole_or("texCoord", 0)?;
        let extensions = texture.get("extensions")?;
        let Some(extensions) = &extensions else {
            return Ok(Self { set, moved: None });
        };
        let Some(item) = extensions.get("KHR_texture_transform")? else {
            return Ok(Self { set, moved: None });
        };
        let offset = item.get("offset")?.map_or(Ok([0.0; 2]), |item| item.numbers())?;
        let scale = item.get("scale")?.map_or(Ok([1.0; 2]), |item| item.numbers())?;
        let angle = item.number_or("rotation", 0.0)?;
        Ok(Self {
            set: item.whole_or("texCoord", set)?,
            moved: Some(Moved {
                offset: DVec2::from_array(offset),
                scale: DVec2::from_array(scale),
                turn: [math::cos(angle), math::sin(angle)],
            }),
        })
    }

    /// The attribute of a primitive that has the set.
    pub(super) fn attribute(&self) -> String {
        format!("TEXCOORD_{}", self.set)
    }

    /// Texture coordinates as ours are: moved, and v upwards.
    pub(super) fn place(&self, uv: DVec2) -> DVec2 {
        let uv = match self.moved {
            None => uv,
            Some(Moved {
                offset,
                scale,
                turn: [cos, sin],
            }) => {
                let uv = uv * scale;
                // Counter-clockwise as it is seen, v being downwards.
                DVec2::new(cos * uv.x + sin * uv.y, cos * uv.y - sin * uv.x) + offset
            }
        };
        DVec2::new(uv.x, 1.0 - uv.y)
    }
}

/// The layer of the texture at the end of a way of names, if it is there.
fn along(item: &Item<'_, '_>, way: &[&str]) -> Result<Option<Layer>, Diagnostic> {
    let Some((name, rest)) = way.split_first() else {
        return Layer::of(item).map(Some);
    };
    match item.get(name)? {
        Some(next) => along(&next, rest),
        None => Ok(None),
    }
}
