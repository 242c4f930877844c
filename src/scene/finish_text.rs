//! Finishes as the options of `material(#{ })`.

use super::{
    Absorption, Bump, ClearCoat, Conductor, Dispersion, Finish, NormalMap, Term, TextureId,
    literal::{Components, Number, Vector},
};
use crate::color::Color;

/// Writes a texture.
type TextureText<'t> = &'t dyn Fn(TextureId) -> String;

/// A term as a script says it.
fn term_text(t: &Term, texture: TextureText<'_>) -> String {
    match t.texture {
        None => Vector(t.color).to_string(),
        Some(id) if t.color == Color::ONE => texture(id),
        Some(id) => format!("{} * vec3({})", texture(id), Components(t.color)),
    }
}

/// A term that is a number.
pub(crate) fn number_text(t: &Term, texture: TextureText<'_>) -> String {
    match t.texture {
        None if t.color == Color::splat(t.color.x) => Number(t.color.x).to_string(),
        _ => term_text(t, texture),
    }
}

impl Finish {
    /// What is set, as the keys of `material(#{ })` have it.
    pub(crate) fn options(&self, texture: TextureText<'_>) -> Vec<(&'static str, String)> {
        let Self {
            fresnel,
            conductor,
            roughness,
            oren_nayar,
            clear_coat,
            absorption,
            dispersion,
            bump,
            normal_map,
            multiscatter,
            shininess,
            ior,
        } = self;
        let term = |t: &Term| term_text(t, texture);
        let number = |t: &Term| number_text(t, texture);
        let mut set = Vec::new();
        if let Some(Absorption { color, distance }) = absorption {
            let (color, distance) = (term(color), number(distance));
            set.push((
                "absorption",
                format!("#{{ color: {color}, distance: {distance} }}"),
            ));
        }
        if let Some(Bump { texture, height }) = bump {
            let (texture, height) = (term(texture), number(height));
            set.push(("bump", format!("#{{ texture: {texture}, height: {height} }}")));
        }
        if let Some(ClearCoat { strength, roughness }) = clear_coat {
            let (strength, roughness) = (number(strength), number(roughness));
            set.push((
                "clearCoat",
                format!("#{{ strength: {strength}, roughness: {roughness} }}"),
            ));
        }
        if let Some(Conductor { eta, k }) = conductor {
            set.push(("conductor", format!("#{{ eta: {}, k: {} }}", term(eta), term(k))));
        }
        if let Some(dispersion) = dispersion {
            let text = match dispersion {
                Dispersion::Abbe(abbe) => number(abbe),
                Dispersion::Cauchy { a, b, c } => {
                    format!("#{{ cauchy: [{}, {}, {}] }}", Number(*a), Number(*b), Number(*c))
                }
                Dispersion::Sellmeier(pairs) => {
                    let pairs = pairs.map(|[b, c]| format!("[{}, {}]", Number(b), Number(c)));
                    format!("#{{ sellmeier: [{}] }}", pairs.join(", "))
                }
            };
            set.push(("dispersion", text));
        }
        if *fresnel {
            set.push(("fresnel", "true".to_owned()));
        }
        if let Some(ior) = ior {
            set.push(("ior", number(ior)));
        }
        if *multiscatter {
            set.push(("multiscatter", "true".to_owned()));
        }
        if let Some(NormalMap {
            texture: id,
            strength,
        }) = normal_map
        {
            let (image, strength) = (texture(*id), number(strength));
            set.push((
                "normalMap",
                format!("#{{ image: {image}, strength: {strength} }}"),
            ));
        }
        if let Some(sigma) = oren_nayar {
            set.push(("orenNayar", number(sigma)));
        }
        if let Some(roughness) = roughness {
            set.push(("roughness", term(roughness)));
        }
        if let Some(shininess) = shininess {
            set.push(("shininess", number(shininess)));
        }
        set
    }

    /// As [`Finish::text`] with what is not set, so that nothing is left of a finish before; but for `ior` and `shininess`, which
    /// every material has.
    pub(crate) fn whole_text(&self, texture: TextureText<'_>) -> String {
        let set = self.options(texture);
        let keys = [
            ("absorption", "()"),
            ("bump", "()"),
            ("clearCoat", "()"),
            ("conductor", "()"),
            ("dispersion", "()"),
            ("fresnel", "false"),
            ("multiscatter", "false"),
            ("normalMap", "()"),
            ("orenNayar", "0"),
            ("roughness", "()"),
        ];
        let whole = keys.map(|(key, none)| {
            let found = set.iter().find(|(name, _)| *name == key);
            format!("{key}: {}", found.map_or(none, |(_, text)| text))
        });
        whole.join(", ")
    }

    /// [`Finish::options`] in one line.
    pub(crate) fn text(&self, texture: TextureText<'_>) -> String {
        let options = self.options(texture).into_iter();
        let options: Vec<String> = options.map(|(key, value)| format!("{key}: {value}")).collect();
        options.join(", ")
    }
}
