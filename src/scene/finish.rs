//! What a surface may do beyond the shading equation: Fresnel's laws, metals, roughness, coats, colored glass, relief.

use super::{
    Material, SceneError, Term, TextureId,
    literal::{Components, Number, Vector},
};
use crate::{color::Color, math::DVec3};

/// A metal's optical constants in red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Index of refraction.
    pub eta: Color,
    /// Absorption coefficient.
    pub k: Color,
}

impl Conductor {
    /// Metals by name: the measurements of Johnson and Christy ("Optical constants of the noble metals", 1972) for copper, gold and
    /// silver, of Rakic ("Algorithm for the determination of intrinsic optical constants of metal films", 1995) for aluminium,
    /// weighted into red, green and blue by the color matching functions, as Bitterli's renderer Tungsten (2014) lists them.
    pub const METALS: [(&'static str, Self); 4] = [
        (
            "aluminium",
            Self {
                eta: Color::new(1.657_459_9, 0.880_368_9, 0.521_228_7),
                k: Color::new(9.223_869_2, 6.269_523_2, 4.837_001_2),
            },
        ),
        (
            "copper",
            Self {
                eta: Color::new(0.200_437_7, 0.924_033_4, 1.102_212),
                k: Color::new(3.912_948_5, 2.452_847_7, 2.142_188),
            },
        ),
        (
            "gold",
            Self {
                eta: Color::new(0.143_119, 0.374_957, 1.442_478_6),
                k: Color::new(3.983_160_4, 2.385_720_7, 1.603_215_3),
            },
        ),
        (
            "silver",
            Self {
                eta: Color::new(0.155_264_6, 0.116_723_3, 0.138_380_7),
                k: Color::new(4.828_343_3, 3.122_245_9, 2.147_050_4),
            },
        ),
    ];
}

/// A layer of clear varnish with index 1.5 on top of everything else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearCoat {
    /// How much of it there is, 0 to 1.
    pub strength: f64,
    /// Its roughness, 0 to 1.
    pub roughness: f64,
}

/// What is left of light on its way through the inside (Beer's law).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorption {
    /// The share that is left after `distance`, greater than 0 and at most 1 in each channel.
    pub color: Color,
    /// In world units, greater than 0.
    pub distance: f64,
}

/// Relief by a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Its brightness is the height.
    pub texture: Term,
    /// How high white is above black, in the shape's own units; negative for hollows.
    pub height: f64,
}

/// Relief by a picture of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The picture: red is to the right (along u), green up (along v), blue out of the surface, 0.5 being none.
    pub texture: TextureId,
    /// 1 as the picture says, 0 flat.
    pub strength: f64,
}

/// What a surface does beyond the shading equation of [`Material`]. Rays are distributed: each camera sample follows one of the
/// directions that a rough surface scatters to, so that samples(n) decides about the noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finish {
    /// Mirror and transparency share the light by Fresnel's equations for `ior`. Where neither Kr nor Ks is given, Kr is white.
    pub fresnel: bool,
    /// The mirror's color is that of a metal. Where neither Kr nor Ks is given, Kr is white.
    pub conductor: Option<Conductor>,
    /// Roughness of mirror and transparency from 0 to 1, the mean of the term's channels; highlights then are those of the
    /// mirror with weight Kr. `None` is smooth.
    pub roughness: Option<Term>,
    /// Roughness of Kd: standard deviation of the slopes in degrees, 0 (Lambert) to 90.
    pub oren_nayar: f64,
    /// A layer of varnish.
    pub clear_coat: Option<ClearCoat>,
    /// What the inside takes from light.
    pub absorption: Option<Absorption>,
    /// Abbe number of the inside, whose `ior` is that of yellow light: the smaller, the more colors are bent apart.
    pub dispersion: Option<f64>,
    /// Relief by a texture.
    pub bump: Option<Bump>,
    /// Relief by a picture of normals.
    pub normal_map: Option<NormalMap>,
}

impl Finish {
    /// Refuses what is none.
    ///
    /// # Errors
    /// Where a number is out of the range that its field names.
    pub fn check(&self) -> Result<(), SceneError> {
        let within = |name: &str, x: f64, least: f64, most: f64| {
            if (least..=most).contains(&x) {
                return Ok(());
            }
            Err(SceneError::new(format!(
                "{name} must lie between {least} and {most}, not {x}"
            )))
        };
        within("sigma", self.oren_nayar, 0.0, 90.0)?;
        if let Some(Conductor { eta, k }) = self.conductor {
            for (name, v, least) in [("eta", eta, 1e-3), ("k", k, 0.0)] {
                for x in v.to_array() {
                    within(name, x, least, 100.0)?;
                }
            }
        }
        if let Some(ClearCoat { strength, roughness }) = self.clear_coat {
            within("strength", strength, 0.0, 1.0)?;
            within("roughness", roughness, 0.0, 1.0)?;
        }
        if let Some(roughness) = self.roughness.filter(|r| r.texture.is_none()) {
            within("roughness", mean(roughness.color), 0.0, 1.0)?;
        }
        if let Some(Absorption { color, distance }) = self.absorption {
            for x in color.to_array() {
                within("color", x, 1e-9, 1.0)?;
            }
            within("distance", distance, 1e-9, 1e15)?;
        }
        if let Some(abbe) = self.dispersion {
            within("abbe", abbe, 1.0, 1e6)?;
        }
        if let Some(bump) = &self.bump {
            within("height", bump.height, -1e6, 1e6)?;
        }
        if let Some(map) = &self.normal_map {
            within("strength", map.strength, -10.0, 10.0)?;
        }
        Ok(())
    }

    /// The textures of its terms, in the order of their names.
    pub(crate) fn textures(&self) -> [Option<TextureId>; 3] {
        [
            self.bump.and_then(|bump| bump.texture.texture),
            self.normal_map.map(|map| map.texture),
            self.roughness.and_then(|roughness| roughness.texture),
        ]
    }

    /// What is set, as the keys of `material(#{ })` have it.
    pub(crate) fn options(&self, texture: &dyn Fn(TextureId) -> String) -> Vec<(&'static str, String)> {
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
        } = self;
        let term = |t: &Term| match t.texture {
            None => Vector(t.color).to_string(),
            Some(id) if t.color == Color::ONE => texture(id),
            Some(id) => format!("{} * vec3({})", texture(id), Components(t.color)),
        };
        let mut set = Vec::new();
        if let Some(Absorption { color, distance }) = absorption {
            let (color, distance) = (Vector(*color), Number(*distance));
            set.push((
                "absorption",
                format!("#{{ color: {color}, distance: {distance} }}"),
            ));
        }
        if let Some(Bump { texture, height }) = bump {
            let (texture, height) = (term(texture), Number(*height));
            set.push(("bump", format!("#{{ texture: {texture}, height: {height} }}")));
        }
        if let Some(ClearCoat { strength, roughness }) = clear_coat {
            let (strength, roughness) = (Number(*strength), Number(*roughness));
            set.push((
                "clearCoat",
                format!("#{{ strength: {strength}, roughness: {roughness} }}"),
            ));
        }
        if let Some(Conductor { eta, k }) = conductor {
            set.push((
                "conductor",
                format!("#{{ eta: {}, k: {} }}", Vector(*eta), Vector(*k)),
            ));
        }
        if let Some(abbe) = dispersion {
            set.push(("dispersion", Number(*abbe).to_string()));
        }
        if *fresnel {
            set.push(("fresnel", "true".to_owned()));
        }
        if let Some(NormalMap {
            texture: id,
            strength,
        }) = normal_map
        {
            let (image, strength) = (texture(*id), Number(*strength));
            set.push((
                "normalMap",
                format!("#{{ image: {image}, strength: {strength} }}"),
            ));
        }
        if *oren_nayar != 0.0 {
            set.push(("orenNayar", Number(*oren_nayar).to_string()));
        }
        if let Some(roughness) = roughness {
            set.push(("roughness", term(roughness)));
        }
        set
    }

    /// As [`Finish::text`] with what is not set, so that nothing is left of a finish before.
    pub(crate) fn whole_text(&self, texture: &dyn Fn(TextureId) -> String) -> String {
        let set = self.options(texture);
        let keys = [
            ("absorption", "()"),
            ("bump", "()"),
            ("clearCoat", "()"),
            ("conductor", "()"),
            ("dispersion", "()"),
            ("fresnel", "false"),
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
    pub(crate) fn text(&self, texture: &dyn Fn(TextureId) -> String) -> String {
        let options = self.options(texture).into_iter();
        let options: Vec<String> = options.map(|(key, value)| format!("{key}: {value}")).collect();
        options.join(", ")
    }
}

impl Material {
    /// Changes what the surface does beyond the shading equation.
    ///
    /// # Errors
    /// As [`Finish::check`]; the material then is as before.
    pub fn change_finish(&mut self, change: impl FnOnce(&mut Finish)) -> Result<(), SceneError> {
        let mut finish = self.finish.as_deref().cloned().unwrap_or_default();
        change(&mut finish);
        finish.check()?;
        self.finish = (finish != Finish::default()).then(|| std::sync::Arc::new(finish));
        Ok(())
    }
}

/// The mean of three channels.
pub(crate) fn mean(c: DVec3) -> f64 {
    (c.x + c.y + c.z) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finish_that_does_nothing_is_none() {
        let mut m = Material::default();
        m.change_finish(|f| f.fresnel = true).unwrap();
        assert!(m.finish.is_some());
        m.change_finish(|f| f.fresnel = false).unwrap();
        assert_eq!(m, Material::default());
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_name() {
        let refused = |change: &dyn Fn(&mut Finish)| {
            let mut m = Material::default();
            let message = m.change_finish(|f| change(f)).unwrap_err().message;
            assert_eq!(m, Material::default());
            message
        };
        let glass = |color, distance| Some(Absorption { color, distance });
        assert!(refused(&|f| f.oren_nayar = 91.0).starts_with("sigma"));
        assert!(refused(&|f| f.absorption = glass(Color::ZERO, 1.0)).starts_with("color"));
        assert!(refused(&|f| f.absorption = glass(Color::ONE, 0.0)).starts_with("distance"));
        assert!(refused(&|f| f.dispersion = Some(f64::NAN)).starts_with("abbe"));
        assert!(refused(&|f| f.roughness = Some(Term::color(Color::splat(2.0)))).starts_with("roughness"));
    }
}
