//! Textures: which of them a scene's materials name, and the constants that they stand in.

use std::{fmt, sync::Arc};

use super::Writer;
use crate::scene::{
    ImageTexture, LightKind, Material, MaterialId, Scene, Texels, Texture, TextureId,
    literal::{Components, Number, Text, Vector},
};

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

impl Writer<'_> {
    /// A constant for each texture but those that the files of meshes bring with them: what shares a texture goes on
    /// sharing it.
    pub(super) fn textures(&mut self) -> fmt::Result {
        let scene = self.scene;
        let of_files = scene
            .textures
            .iter()
            .enumerate()
            .filter(|(i, _)| self.is_named.get(*i) == Some(&true));
        let named: Vec<_> = of_files.collect();
        if !named.is_empty() {
            self.out.write_char('\n')?;
        }
        for (i, texture) in named {
            let id = TextureId(u32::try_from(i).unwrap_or(u32::MAX));
            match (&**texture, self.files.textures.get(&id)) {
                (_, Some(path)) => self.call(format_args!("const texture_{i} = image({});", Text(path)))?,
                (Texture::Checker { even, odd, size }, None) => self.call(format_args!(
                    "const texture_{i} = checker({}, {}, {});",
                    Vector(*even),
                    Vector(*odd),
                    Number(*size)
                ))?,
                (Texture::Image(image), None) => self.image(i, image)?,
                (
                    Texture::Pattern(_)
                    | Texture::Mix(_)
                    | Texture::Placed(_)
                    | Texture::Mapped(_)
                    | Texture::VertexColors,
                    None,
                ) => {
                    let name = |part: &Arc<Texture>| Some(format!("texture_{}", scene.texture_number(part)?));
                    let call = texture.call(&name);
                    self.call(format_args!("const texture_{i} = {call};"))?;
                }
                (Texture::Custom(texture), None) => self.call(format_args!(
                    "const texture_{i} = customTexture({});",
                    Text(&texture.identity())
                ))?,
            }
        }
        Ok(())
    }

    /// A picture that no file holds.
    pub(super) fn image(&mut self, i: usize, image: &ImageTexture) -> fmt::Result {
        let (width, height) = (image.width, image.height);
        self.call(format_args!(
            "const texture_{i} = image(#{{ width: {width}, height: {height}, pixels: ["
        ))?;
        match &image.texels {
            Texels::Linear(texels) => {
                for [r, g, b] in texels {
                    self.call(format_args!(
                        "    {}, {}, {},",
                        Number(*r),
                        Number(*g),
                        Number(*b)
                    ))?;
                }
            }
            Texels::Srgb8(_) => {
                for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    self.call(format_args!("    {},", Components(image.texel(x, y))))?;
                }
            }
        }
        self.call("] });")
    }
}
