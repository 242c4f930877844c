//! The terms of the shading equation
//!
//! `I = Ka + Ke + sum over lights of V L (Kd max(N.L, 0) + Ks max(N.H, 0)^s) + Kr I_reflected + Kt I_transmitted`

use std::sync::Arc;

use super::{CustomReflectance, Finish};
use crate::{color::Color, custom::Custom, scene::TextureId};

/// A color, or a color times a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Scene-linear factor.
    pub color: Color,
    /// Looked up at each point and multiplied by `color`.
    pub texture: Option<TextureId>,
}

impl Term {
    /// No light at all.
    pub const BLACK: Self = Self::color(Color::ZERO);

    /// The same color everywhere.
    #[must_use]
    pub const fn color(color: Color) -> Self {
        Self { color, texture: None }
    }

    /// A texture as it is.
    #[must_use]
    pub const fn texture(texture: TextureId) -> Self {
        Self {
            color: Color::ONE,
            texture: Some(texture),
        }
    }

    /// The same number in each channel: for the terms that are numbers, such as roughness. Of what has other channels these take
    /// the mean.
    #[must_use]
    pub const fn number(x: f64) -> Self {
        Self::color(Color::splat(x))
    }

    /// The number that a value of the term stands for.
    pub(crate) fn number_of(value: Color) -> f64 {
        // The mean of three equal numbers may differ from them by its rounding.
        if value == Color::splat(value.x) {
            value.x
        } else {
            super::finish_mean(value)
        }
    }

    /// True where the term adds nothing anywhere.
    ///
    /// ```
    /// use rtscript::{DVec3, Term};
    /// assert!(Term::color(DVec3::ZERO).is_black());
    /// // A number is the same in each channel.
    /// assert_eq!(Term::number(0.3), Term::color(DVec3::splat(0.3)));
    /// ```
    #[must_use]
    pub fn is_black(&self) -> bool {
        self.color == Color::ZERO
    }
}

impl From<f64> for Term {
    /// [`Term::number`].
    fn from(x: f64) -> Self {
        Self::number(x)
    }
}

/// How a surface answers light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Ka, constant. Default .2 .2 .2.
    pub ambient: Term,
    /// Ke, constant. Default black.
    pub emission: Term,
    /// Kd. Default black.
    pub diffuse: Term,
    /// Ks of the highlight. Default black.
    pub specular: Term,
    /// Exponent s of the highlight, at least 0. Default 1.
    pub shininess: f64,
    /// Kr of the mirror; `None` is Ks.
    pub reflection: Option<Term>,
    /// Kt of what is seen through. Default black.
    pub transmission: Term,
    /// Index of refraction inside, against 1 outside. Default 1.5.
    pub ior: f64,
    /// The program's own rule in place of the sum over lights. Default `None`.
    pub reflectance: Option<Custom<dyn CustomReflectance>>,
    /// What the surface does beyond the shading equation; see [`Material::change_finish`]. Default `None`.
    pub finish: Option<Arc<Finish>>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            ambient: Term::color(Color::splat(0.2)),
            emission: Term::BLACK,
            diffuse: Term::BLACK,
            specular: Term::BLACK,
            shininess: 1.0,
            reflection: None,
            transmission: Term::BLACK,
            ior: 1.5,
            reflectance: None,
            finish: None,
        }
    }
}

impl Material {
    /// Kr: the mirror's weight, Ks unless it was given.
    ///
    /// ```
    /// use rtscript::{DVec3, Term, scene::Material};
    /// let mut metal = Material::default();
    /// metal.specular = Term::number(0.4);
    /// // A mirror as its highlights, until it is given a weight of its own.
    /// assert_eq!(metal.mirror(), Term::number(0.4));
    /// metal.reflection = Some(Term::number(0.9));
    /// assert_eq!(metal.mirror(), Term::number(0.9));
    /// ```
    #[must_use]
    pub fn mirror(&self) -> Term {
        self.reflection.unwrap_or(self.specular)
    }

    /// Whether any of its terms has a texture.
    pub(crate) fn is_textured(&self) -> bool {
        let terms = [
            Some(self.ambient),
            Some(self.emission),
            Some(self.diffuse),
            Some(self.specular),
            self.reflection,
            Some(self.transmission),
        ];
        let finish = self.finish.as_ref();
        terms.iter().flatten().any(|term| term.texture.is_some())
            || finish.is_some_and(|finish| finish.textures().iter().any(|(_, texture)| texture.is_some()))
    }

    /// The same with the program's own answer to the light of lamps.
    #[must_use]
    pub fn with_reflectance(mut self, reflectance: impl CustomReflectance + 'static) -> Self {
        let shared: Arc<dyn CustomReflectance> = Arc::new(reflectance);
        self.reflectance = Some(Custom::from(shared));
        self
    }

    /// Lets no light through.
    pub(crate) fn is_opaque(&self) -> bool {
        self.transmission.is_black()
    }

    /// The textures of its terms with the keys of `material(#{ })` that they belong to, in the order of those; of one key in the order
    /// in which it takes them.
    pub(crate) fn textures(&self) -> Vec<(&'static str, TextureId)> {
        let of = |term: Term| term.texture;
        let mut all = vec![
            ("ambient", of(self.ambient)),
            ("diffuse", of(self.diffuse)),
            ("emission", of(self.emission)),
            ("reflection", self.reflection.and_then(of)),
            ("specular", of(self.specular)),
            ("transmission", of(self.transmission)),
        ];
        if let Some(finish) = &self.finish {
            all.extend(finish.textures());
        }
        all.sort_by_key(|(key, _)| *key);
        all.into_iter()
            .filter_map(|(key, texture)| Some((key, texture?)))
            .collect()
    }

    /// Lets a shadow ray bring at most what a light sends, whatever the place; false where that is not plain.
    pub(crate) fn only_dims(&self) -> bool {
        let Term { color, texture } = &self.transmission;
        let is_share = color.cmpge(Color::ZERO).all() && color.cmple(Color::ONE).all();
        self.is_opaque() || texture.is_none() && is_share && self.finish.is_none()
    }

    /// Its parts as bits, equal exactly where two materials are the same.
    pub(crate) fn key(&self) -> MaterialKey {
        let term = |t: &Term| {
            let [x, y, z] = t.color.to_array().map(f64::to_bits);
            [x, y, z, t.texture.map_or(0, |id| u64::from(id.0) + 1)]
        };
        MaterialKey {
            terms: [
                &self.ambient,
                &self.emission,
                &self.diffuse,
                &self.specular,
                &self.transmission,
            ]
            .map(term),
            reflection: self.reflection.as_ref().map(term),
            numbers: [self.shininess.to_bits(), self.ior.to_bits()],
            reflectance: self.reflectance.as_ref().map(Custom::identity),
            finish: self
                .finish
                .as_ref()
                .map(|finish| finish.text(&|id| id.0.to_string())),
        }
    }
}

/// See [`Material::key`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct MaterialKey {
    terms: [[u64; 4]; 5],
    reflection: Option<[u64; 4]>,
    numbers: [u64; 2],
    reflectance: Option<String>,
    finish: Option<String>,
}
