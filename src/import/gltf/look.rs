//! From the materials of a file (metal and roughness) to those of the shading equation.

mod extensions;
mod paint;

use std::collections::BTreeSet;

use self::{
    extensions::conductor,
    paint::{BLACK, dimmed, gray, inverted, mixed, product},
};
use super::{
    super::assets::Assets,
    MATERIAL,
    item::Item,
    pictures::{Channel, Found, Pictures},
    uv::Layer,
};
use crate::{
    color::Color,
    diag::Diagnostic,
    scene::{Builder, Finish, Material, MaterialId, NormalMap, Paint, Term, Texture},
};

/// The largest factor of what has none in the format.
const BRIGHTEST: f64 = 1e6;
/// Extensions of materials that are read.
const READ: [&str; 8] = [
    "KHR_materials_unlit",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_dispersion",
];

/// The materials of a file with these numbers, those that are `colored` times the colors of vertices.
///
/// # Errors
/// Where a number is out of its range or leads nowhere, or a picture cannot be read.
pub(super) fn materials<'a>(
    root: &Item<'_, 'a>,
    (used, colored): (&[usize], &BTreeSet<usize>),
    pictures: Pictures<'a, '_>,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Vec<MaterialId>, Diagnostic> {
    let mut ids = Vec::new();
    if used.is_empty() {
        return Ok(ids);
    }
    let light = builder.material().ambient.color;
    let mut look = Look {
        root,
        light,
        layer: Layer::default(),
        pictures,
        assets,
        builder,
        is_colored: false,
        warned: BTreeSet::new(),
    };
    let all = root.needed(MATERIAL.list)?;
    for i in used {
        look.assets.check_stop()?;
        let Some(item) = all.entry(*i)? else { continue };
        look.layer = Layer::of_material(root, Some(*i))?;
        look.is_colored = colored.contains(i);
        let material = look.material(&item)?;
        ids.push(look.builder.material_id(&material));
    }
    Ok(ids)
}

struct Look<'l, 'i, 'a, 's, 'h> {
    root: &'l Item<'i, 'a>,
    /// The ambient light.
    light: Color,
    /// How the textures of the material at hand are laid.
    layer: Layer,
    pictures: Pictures<'a, 's>,
    assets: &'l mut Assets<'h>,
    builder: &'l mut Builder,
    /// Whether vertices with the material at hand have colors.
    is_colored: bool,
    warned: BTreeSet<String>,
}

/// How the light that meets a surface is shared out.
struct Shares {
    /// What comes back from all of it, once it went in.
    diffuse: Paint,
    /// What is mirrored head on.
    mirror: Paint,
}

impl<'a> Look<'_, '_, 'a, '_, '_> {
    fn warn(&mut self, item: &Item<'_, 'a>, what: &str, message: &str) {
        if self.warned.insert(what.to_owned()) {
            item.warn(self.builder, message, None);
        }
    }

    /// The texture at an entry of `of`, if there is one.
    fn texture(
        &mut self,
        of: &Item<'_, 'a>,
        name: &str,
        channel: Channel,
    ) -> Result<Option<Found>, Diagnostic> {
        let Some(entry) = of.get(name)? else {
            return Ok(None);
        };
        if Layer::of(&entry)? != self.layer {
            let message = "textures of one material lie on different texture coordinates, but only those of the \
                           first one are used";
            self.warn(&entry, "layer", message);
        }
        self.pictures
            .find(self.root, &entry, channel, self.assets, self.builder)
            .map(Some)
    }

    /// `factor` times a channel of the texture at an entry of `of`.
    fn share(
        &mut self,
        of: &Item<'_, 'a>,
        (factor, default): (&str, f64),
        name: &str,
        channel: Channel,
    ) -> Result<Paint, Diagnostic> {
        let factor = of.share_or(factor, default)?;
        Ok(match self.texture(of, name, channel)? {
            _ if factor == 0.0 => BLACK,
            None => gray(factor),
            Some(Found { same: Some(byte), .. }) => gray(factor * f64::from(byte) / 255.0),
            Some(Found { texture, .. }) => Paint {
                color: Color::splat(factor),
                texture: Some(texture),
            },
        })
    }

    fn term(&mut self, paint: &Paint) -> Term {
        Term {
            color: paint.color,
            texture: paint
                .texture
                .as_ref()
                .map(|texture| self.builder.texture(texture)),
        }
    }

    fn material(&mut self, item: &Item<'_, 'a>) -> Result<Material, Diagnostic> {
        let nothing = Item::nothing(item);
        let metal_and_roughness = item.get("pbrMetallicRoughness")?;
        let pbr = metal_and_roughness.as_ref().unwrap_or(&nothing);
        let given = item.get("extensions")?;
        let extensions = given.as_ref().unwrap_or(&nothing);
        for name in extensions.names()? {
            if !READ.contains(&name) {
                self.warn(extensions, name, &format!("{name} is not used"));
            }
        }
        let [r, g, b, solid] = match pbr.get("baseColorFactor")? {
            Some(item) => {
                for entry in item.entries()? {
                    entry.within(0.0, 1.0)?;
                }
                item.numbers()?
            }
            None => [1.0; 4],
        };
        let color = Color::new(r, g, b);
        let base = Paint {
            color,
            texture: self
                .texture(pbr, "baseColorTexture", Channel::Picture)?
                .map(|found| found.texture),
        };
        let base = match self.is_colored {
            true => product(&base, &Paint::texture(Texture::vertex_colors()), item)?,
            false => base,
        };
        let alpha = self.alpha(item, pbr, solid)?;
        let emission = self.emission(item, extensions)?;
        let mut material = Material {
            ambient: Term::BLACK,
            emission: self.term(&emission),
            reflection: Some(Term::BLACK),
            ..Material::default()
        };
        if extensions.get("KHR_materials_unlit")?.is_some() {
            let seen = product(&base, &alpha, item)?;
            material.emission = self.term(&seen);
            self.see_through(&mut material, &alpha, item)?;
            return Ok(material);
        }
        let metallic = self.share(
            pbr,
            ("metallicFactor", 1.0),
            "metallicRoughnessTexture",
            Channel::Blue,
        )?;
        let roughness = self.share(
            pbr,
            ("roughnessFactor", 1.0),
            "metallicRoughnessTexture",
            Channel::Green,
        )?;
        let ior = self.ior(extensions)?;
        let head_on = ((ior - 1.0) / (ior + 1.0)) * ((ior - 1.0) / (ior + 1.0));
        let specular = self.specular(extensions)?;
        let clear = self.transmission(extensions)?;
        let not_metal = inverted(&metallic, item)?;
        let inner = product(&base, &not_metal, item)?;
        let shares = Shares {
            diffuse: product(&inner, &inverted(&clear, item)?, item)?,
            mirror: mixed(
                dimmed(&gray(head_on), specular),
                base.clone(),
                metallic.clone(),
                item,
            )?,
        };
        let solid = product(&shares.diffuse, &alpha, item)?;
        material.diffuse = self.term(&solid);
        let ambient = dimmed(&self.occluded(&solid, item)?, self.light);
        material.ambient = self.term(&ambient);
        if alpha.color != Color::ONE || alpha.texture.is_some() {
            self.highlight(&mut material, &shares.mirror, &alpha, &roughness, item)?;
            self.see_through(&mut material, &alpha, item)?;
            let finish = self.relief(item)?;
            return self.finished(material, finish, item);
        }
        let mut finish = self.relief(item)?;
        finish.roughness = match roughness.texture {
            None if roughness.color == Color::ZERO => None,
            _ => Some(self.term(&roughness)),
        };
        self.coat(extensions, &mut finish)?;
        let is_clear = clear.color != Color::ZERO;
        let kt = product(&inner, &clear, item)?;
        material.transmission = self.term(&kt);
        let volume = extensions.get("KHR_materials_volume")?;
        let is_thick = match &volume {
            Some(volume) => volume.number_or("thicknessFactor", 0.0)? > 0.0,
            None => false,
        };
        if is_clear && !is_thick {
            // A pane without a thickness bends nothing, and its index says how much it mirrors.
            material.ior = 1.0;
        } else {
            material.ior = ior;
        }
        if let Some(volume) = volume.filter(|_| is_clear && is_thick) {
            self.inside(&volume, extensions, &mut finish)?;
        }
        let is_metal = metallic.color == Color::ONE && metallic.texture.is_none();
        let is_plain = metallic.color == Color::ZERO;
        if is_metal && base.texture.is_none() {
            finish.conductor = Some(conductor(base.color));
            material.reflection = Some(Term::color(Color::ONE));
        } else if is_plain && material.ior != 1.0 {
            finish.fresnel = true;
            material.reflection = Some(Term::color(specular));
        } else {
            material.reflection = Some(self.term(&shares.mirror));
        }
        self.finished(material, finish, item)
    }

    fn finished(
        &mut self,
        mut material: Material,
        finish: Finish,
        item: &Item<'_, 'a>,
    ) -> Result<Material, Diagnostic> {
        material
            .change_finish(|own| *own = finish)
            .map_err(|error| item.error(error))?;
        Ok(material)
    }

    /// How solid the surface is: `alphaMode`, and the fourth number of the base color.
    fn alpha(&mut self, item: &Item<'_, 'a>, pbr: &Item<'_, 'a>, factor: f64) -> Result<Paint, Diagnostic> {
        let factor = factor.clamp(0.0, 1.0);
        let Some(mode) = item.get("alphaMode")? else {
            return Ok(gray(1.0));
        };
        match mode.string()? {
            "OPAQUE" => Ok(gray(1.0)),
            "BLEND" => Ok(match self.texture(pbr, "baseColorTexture", Channel::Alpha)? {
                None => gray(factor),
                Some(Found { same: Some(byte), .. }) => gray(factor * f64::from(byte) / 255.0),
                Some(Found { texture, .. }) => Paint {
                    color: Color::splat(factor),
                    texture: Some(texture),
                },
            }),
            "MASK" => {
                let cutoff = item.number_or("alphaCutoff", 0.5)?;
                // The least byte that is solid.
                let least = (0..=255u8).find(|byte| factor * f64::from(*byte) / 255.0 >= cutoff);
                let Some(least) = least else {
                    return Ok(BLACK);
                };
                Ok(
                    match self.texture(pbr, "baseColorTexture", Channel::Mask(least))? {
                        None => gray(1.0),
                        Some(Found { same: Some(byte), .. }) => gray(f64::from(byte) / 255.0),
                        Some(Found { texture, .. }) => Paint::texture(texture),
                    },
                )
            }
            other => Err(mode.error(format!("expected 'OPAQUE', 'MASK' or 'BLEND', found '{other}'"))),
        }
    }

    /// Lets through what is not solid, straight on.
    fn see_through(
        &mut self,
        material: &mut Material,
        alpha: &Paint,
        item: &Item<'_, 'a>,
    ) -> Result<(), Diagnostic> {
        let through = inverted(alpha, item)?;
        material.transmission = self.term(&through);
        if !material.transmission.is_black() {
            material.ior = 1.0;
        }
        Ok(())
    }

    /// A highlight as wide and as bright as that of a rough mirror, on what is partly solid: a rough mirror would dim what is
    /// seen through it.
    fn highlight(
        &mut self,
        material: &mut Material,
        mirror: &Paint,
        alpha: &Paint,
        roughness: &Paint,
        item: &Item<'_, 'a>,
    ) -> Result<(), Diagnostic> {
        // Of a texture the factor alone.
        let r = roughness.color.x.max(0.05);
        let exponent = 2.0 / (r * r * r * r) - 2.0;
        let seen = product(mirror, alpha, item)?;
        material.specular = self.term(&dimmed(&seen, Color::splat((exponent + 2.0) / 8.0)));
        material.shininess = exponent;
        Ok(())
    }

    fn emission(&mut self, item: &Item<'_, 'a>, extensions: &Item<'_, 'a>) -> Result<Paint, Diagnostic> {
        let factor = item.color_or("emissiveFactor", 0.0, BRIGHTEST)?;
        let strength = match extensions.get("KHR_materials_emissive_strength")? {
            Some(item) => match item.get("emissiveStrength")? {
                Some(item) => item.within(0.0, BRIGHTEST)?,
                None => 1.0,
            },
            None => 1.0,
        };
        let color = factor * strength;
        if color == Color::ZERO {
            return Ok(BLACK);
        }
        let texture = self.texture(item, "emissiveTexture", Channel::Picture)?;
        Ok(Paint {
            color,
            texture: texture.map(|found| found.texture),
        })
    }

    /// What ambient light leaves of a paint where corners are dark.
    fn occluded(&mut self, paint: &Paint, item: &Item<'_, 'a>) -> Result<Paint, Diagnostic> {
        let Some(entry) = item.get("occlusionTexture")? else {
            return Ok(paint.clone());
        };
        let strength = entry.share_or("strength", 1.0)?;
        if paint.color * self.light == Color::ZERO || strength == 0.0 {
            return Ok(paint.clone());
        }
        let Some(found) = self.texture(item, "occlusionTexture", Channel::Red)? else {
            return Ok(paint.clone());
        };
        let open = mixed(
            gray(1.0 - strength),
            gray(1.0),
            Paint::texture(found.texture),
            item,
        )?;
        product(paint, &open, item)
    }

    /// Relief by the normal texture.
    fn relief(&mut self, item: &Item<'_, 'a>) -> Result<Finish, Diagnostic> {
        let mut finish = Finish::default();
        if let Some(found) = self.texture(item, "normalTexture", Channel::Picture)? {
            let entry = item.needed("normalTexture")?;
            let scale = entry.number_or("scale", 1.0)?.clamp(-10.0, 10.0);
            finish.normal_map = Some(NormalMap {
                texture: self.builder.texture(&found.texture),
                strength: scale.into(),
            });
        }
        Ok(finish)
    }
}
