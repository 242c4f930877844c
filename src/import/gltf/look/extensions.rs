//! What extensions say of a material.

use super::{BRIGHTEST, Look, paint::BLACK};
use crate::{
    color::Color,
    diag::Diagnostic,
    import::gltf::{item::Item, pictures::Channel},
    scene::{Absorption, ClearCoat, Conductor, Dispersion, Finish, Paint, Term},
};

/// The index of refraction of what is no metal, where the file says nothing else.
const IOR: f64 = 1.5;

impl<'a> Look<'_, '_, 'a, '_, '_> {
    /// The index of refraction. 0 stands for what mirrors everything.
    pub(super) fn ior(&mut self, extensions: &Item<'_, 'a>) -> Result<f64, Diagnostic> {
        let Some(item) = extensions.get("KHR_materials_ior")? else {
            return Ok(IOR);
        };
        match item.get("ior")? {
            None => Ok(IOR),
            Some(item) => match item.number()? {
                0.0 => Ok(1e3),
                x if (1.0..=1e3).contains(&x) => Ok(x),
                x => Err(item.error(format!("expected 0 or a number from 1 to 1000, found {x}"))),
            },
        }
    }

    /// By how much what is no metal mirrors more or less than its index says.
    pub(super) fn specular(&mut self, extensions: &Item<'_, 'a>) -> Result<Color, Diagnostic> {
        let Some(item) = extensions.get("KHR_materials_specular")? else {
            return Ok(Color::ONE);
        };
        for name in ["specularTexture", "specularColorTexture"] {
            if let Some(entry) = item.get(name)? {
                self.warn(&entry, name, "the texture is not used, its factor is");
            }
        }
        let color = item.color_or("specularColorFactor", 1.0, BRIGHTEST)?;
        Ok(color * item.share_or("specularFactor", 1.0)?)
    }

    /// The share of what goes in that goes through.
    pub(super) fn transmission(&mut self, extensions: &Item<'_, 'a>) -> Result<Paint, Diagnostic> {
        match extensions.get("KHR_materials_transmission")? {
            None => Ok(BLACK),
            Some(item) => self.share(
                &item,
                ("transmissionFactor", 0.0),
                "transmissionTexture",
                Channel::Red,
            ),
        }
    }

    pub(super) fn coat(&mut self, extensions: &Item<'_, 'a>, finish: &mut Finish) -> Result<(), Diagnostic> {
        let Some(item) = extensions.get("KHR_materials_clearcoat")? else {
            return Ok(());
        };
        for name in [
            "clearcoatTexture",
            "clearcoatRoughnessTexture",
            "clearcoatNormalTexture",
        ] {
            if let Some(entry) = item.get(name)? {
                self.warn(&entry, name, "the texture is not used, its factor is");
            }
        }
        let strength = item.share_or("clearcoatFactor", 0.0)?;
        if strength > 0.0 {
            finish.clear_coat = Some(ClearCoat {
                strength: strength.into(),
                roughness: item.share_or("clearcoatRoughnessFactor", 0.0)?.into(),
            });
        }
        Ok(())
    }

    /// What is inside of glass.
    pub(super) fn inside(
        &mut self,
        volume: &Item<'_, 'a>,
        extensions: &Item<'_, 'a>,
        finish: &mut Finish,
    ) -> Result<(), Diagnostic> {
        if let Some(distance) = volume.get("attenuationDistance")? {
            let color = volume.color_or("attenuationColor", 1.0, 1.0)?;
            let color = color.max(Color::splat(1e-9));
            if color != Color::ONE {
                let distance = distance.within(1e-9, 1e15)?;
                finish.absorption = Some(Absorption {
                    color: Term::color(color),
                    distance: distance.into(),
                });
            }
        }
        if let Some(item) = extensions.get("KHR_materials_dispersion")? {
            let dispersion = item.number_or("dispersion", 0.0)?;
            if dispersion > 0.0 {
                // It is given as 20 over the Abbe number.
                finish.dispersion = Some(Dispersion::Abbe((20.0 / dispersion).clamp(1.0, 1e6).into()));
            }
        }
        Ok(())
    }
}

/// A metal of the color that it mirrors head on: Gulbrandsen, "Artist friendly metallic Fresnel", JCGT 3(4), 2014, halfway
/// between its extremes, where the color at other angles is close to Schlick's.
pub(super) fn conductor(head_on: Color) -> Conductor {
    let [r, g, b] = head_on.to_array().map(|r| {
        // Beyond, the constants leave their range.
        let r = r.clamp(0.0, 0.97);
        let root = r.sqrt();
        let eta = 0.5 * (1.0 - r) / (1.0 + r) + 0.5 * (1.0 + root) / (1.0 - root);
        let k2 = ((eta + 1.0) * (eta + 1.0) * r - (eta - 1.0) * (eta - 1.0)) / (1.0 - r);
        (eta, k2.max(0.0).sqrt())
    });
    Conductor {
        eta: Term::color(Color::new(r.0, g.0, b.0)),
        k: Term::color(Color::new(r.1, g.1, b.1)),
    }
}
