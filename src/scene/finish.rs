//! What a surface may do beyond the shading equation: Fresnel's laws, metals, roughness, coats, colored glass, relief.

use super::{Dispersion, Material, SceneError, Term, TextureId};
use crate::color::Color;

/// A metal's optical constants in red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Index of refraction, 0.001 to 100.
    pub eta: Term,
    /// Absorption coefficient, 0 to 100.
    pub k: Term,
}

impl Conductor {
    /// Metals by name: the measurements of Johnson and Christy ("Optical constants of the noble metals", 1972) for copper, gold and
    /// silver, of Rakic ("Algorithm for the determination of intrinsic optical constants of metal films", 1995) for aluminium,
    /// weighted into red, green and blue by the color matching functions, as Bitterli's renderer Tungsten (2014) lists them.
    pub const METALS: [(&'static str, Self); 4] = [
        (
            "aluminium",
            Self {
                eta: Term::color(Color::new(1.657_459_9, 0.880_368_9, 0.521_228_7)),
                k: Term::color(Color::new(9.223_869_2, 6.269_523_2, 4.837_001_2)),
            },
        ),
        (
            "copper",
            Self {
                eta: Term::color(Color::new(0.200_437_7, 0.924_033_4, 1.102_212)),
                k: Term::color(Color::new(3.912_948_5, 2.452_847_7, 2.142_188)),
            },
        ),
        (
            "gold",
            Self {
                eta: Term::color(Color::new(0.143_119, 0.374_957, 1.442_478_6)),
                k: Term::color(Color::new(3.983_160_4, 2.385_720_7, 1.603_215_3)),
            },
        ),
        (
            "silver",
            Self {
                eta: Term::color(Color::new(0.155_264_6, 0.116_723_3, 0.138_380_7)),
                k: Term::color(Color::new(4.828_343_3, 3.122_245_9, 2.147_050_4)),
            },
        ),
    ];
}

/// A layer of clear varnish with index 1.5 on top of everything else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearCoat {
    /// How much of it there is, 0 to 1, a [number](Term::number).
    pub strength: Term,
    /// Its roughness, 0 to 1, a [number](Term::number).
    pub roughness: Term,
}

/// What is left of light on its way through the inside (Beer's law).
///
/// A texture in it varies inside of the solid, as veins in glass do: it is looked up at places spread over the ray's way, in the
/// space of the shape. What a texture says by texture coordinates, which the inside has none of, counts as where the light came
/// in: where the ray that looks for it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorption {
    /// The share that is left after `distance`, greater than 0 and at most 1 in each channel.
    pub color: Term,
    /// In world units, greater than 0, a [number](Term::number).
    pub distance: Term,
}

/// Relief by a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Its brightness is the height.
    pub texture: Term,
    /// How high white is above black, in the shape's own units; negative for hollows. A [number](Term::number).
    pub height: Term,
}

/// Relief by a picture of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The picture: red is to the right (along u), green up (along v), blue out of the surface, 0.5 being none.
    pub texture: TextureId,
    /// 1 as the picture says, 0 flat. A [number](Term::number).
    pub strength: Term,
}

/// What a surface does beyond the shading equation of [`Material`]. Rays are distributed: each camera sample follows one of the
/// directions that a rough surface scatters to, so that samples(n) decides about the noise.
///
/// Every term may have a texture. What it gives beyond the range of its term counts as the nearest that is within.
///
/// ```
/// use rtscript::{Builder, DVec3, Term};
/// use rtscript::scene::{Absorption, Bump, ClearCoat, Conductor, Dispersion, Finish, NormalMap};
/// let number = |v| Term::color(DVec3::splat(v));
/// let glass = Finish {
///     fresnel: true,
///     absorption: Some(Absorption { color: Term::color(DVec3::new(0.4, 0.9, 0.6)), distance: number(1.0) }),
///     dispersion: Some(Dispersion::Abbe(number(40.0))),
///     ..Finish::default()
/// };
/// let varnish = Finish {
///     clear_coat: Some(ClearCoat { strength: number(1.0), roughness: number(0.1) }),
///     ..Finish::default()
/// };
/// let (name, metal): &(&str, Conductor) = &Conductor::METALS[0];
/// let rough_metal = Finish { conductor: Some(metal.clone()), roughness: Some(number(0.3)), ..Finish::default() };
/// for finish in [glass, varnish, rough_metal] {
///     finish.check()?;
/// }
/// // Relief comes from textures: one of heights, or one of normals.
/// let (no_bump, no_map): (Option<Bump>, Option<NormalMap>) = (None, None);
/// assert_eq!((Finish::default().bump, Finish::default().normal_map), (no_bump, no_map));
/// # assert!(!name.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finish {
    /// Mirror and transparency share the light by Fresnel's equations for `ior`. Where neither Kr nor Ks is given, Kr is white.
    pub fresnel: bool,
    /// The mirror's color is that of a metal. Where neither Kr nor Ks is given, Kr is white.
    pub conductor: Option<Conductor>,
    /// Roughness of mirror and transparency from 0 to 1, the mean of the term's channels; highlights then are those of the
    /// mirror with weight Kr. `None` is smooth.
    pub roughness: Option<Term>,
    /// Roughness of Kd: standard deviation of the slopes in degrees, 0 to 90, a [number](Term::number). `None` is Lambert.
    pub oren_nayar: Option<Term>,
    /// A layer of varnish.
    pub clear_coat: Option<ClearCoat>,
    /// What the inside takes from light.
    pub absorption: Option<Absorption>,
    /// How much more the inside bends some colors than others, its `ior` being that of yellow light.
    pub dispersion: Option<Dispersion>,
    /// Relief by a texture.
    pub bump: Option<Bump>,
    /// Relief by a picture of normals.
    pub normal_map: Option<NormalMap>,
    /// What is thrown from one of the tiny mirrors of an opaque rough surface to another is not lost: rough metals are brighter
    /// and have stronger colors.
    pub multiscatter: bool,
    /// In place of [`Material::shininess`] where it varies, a [number](Term::number).
    pub shininess: Option<Term>,
    /// In place of [`Material::ior`] where it varies, a [number](Term::number) of at least 0.001.
    pub ior: Option<Term>,
}

impl Finish {
    /// Refuses what is none.
    ///
    /// # Errors
    /// Where a number is out of the range that its field names.
    pub fn check(&self) -> Result<(), SceneError> {
        // What a texture gives is brought into its range where it is looked up.
        let channels = |name: &str, term: &Term, [least, most]: [f64; 2]| {
            let given = term.color.to_array();
            match given.into_iter().find(|x| !(least..=most).contains(x)) {
                Some(x) if term.texture.is_none() => Err(SceneError::new(format!(
                    "{name} must lie between {least} and {most}, not {x}"
                ))),
                _ => Ok(()),
            }
        };
        let number = |name: &str, term: &Term, range| {
            let value = Term::number(Term::number_of(term.color));
            channels(
                name,
                &Term {
                    color: value.color,
                    ..*term
                },
                range,
            )
        };
        if let Some(sigma) = &self.oren_nayar {
            number("sigma", sigma, Self::SIGMA)?;
        }
        if let Some(Conductor { eta, k }) = &self.conductor {
            channels("eta", eta, Self::ETA)?;
            channels("k", k, Self::K)?;
        }
        if let Some(ClearCoat { strength, roughness }) = &self.clear_coat {
            number("strength", strength, Self::SHARE)?;
            number("roughness", roughness, Self::SHARE)?;
        }
        if let Some(roughness) = &self.roughness {
            number("roughness", roughness, Self::SHARE)?;
        }
        if let Some(Absorption { color, distance }) = &self.absorption {
            channels("color", color, Self::LEFT)?;
            number("distance", distance, Self::DISTANCE)?;
        }
        match &self.dispersion {
            Some(Dispersion::Abbe(abbe)) => number("abbe", abbe, Self::ABBE)?,
            Some(dispersion) => dispersion.check()?,
            None => {}
        }
        if let Some(bump) = &self.bump {
            number("height", &bump.height, [-1e6, 1e6])?;
        }
        if let Some(map) = &self.normal_map {
            number("strength", &map.strength, [-10.0, 10.0])?;
        }
        if let Some(shininess) = &self.shininess {
            number("s", shininess, [0.0, f64::INFINITY])?;
        }
        if let Some(ior) = &self.ior {
            number("n", ior, Self::INDEX)?;
        }
        Ok(())
    }

    pub(crate) const SIGMA: [f64; 2] = [0.0, 90.0];
    pub(crate) const ETA: [f64; 2] = [1e-3, 100.0];
    pub(crate) const K: [f64; 2] = [0.0, 100.0];
    pub(crate) const SHARE: [f64; 2] = [0.0, 1.0];
    pub(crate) const LEFT: [f64; 2] = [1e-9, 1.0];
    pub(crate) const DISTANCE: [f64; 2] = [1e-9, 1e15];
    pub(crate) const ABBE: [f64; 2] = [1.0, 1e6];
    pub(crate) const INDEX: [f64; 2] = [1e-3, 1e6];

    /// The textures of its terms, with the keys of `material(#{ })` that they belong to; those of one key in the order in which it
    /// takes them.
    pub(crate) fn textures(&self) -> [(&'static str, Option<TextureId>); 15] {
        let of = |term: Option<Term>| term.and_then(|term| term.texture);
        let Self {
            fresnel: _,
            conductor,
            roughness,
            oren_nayar,
            clear_coat,
            absorption,
            dispersion,
            bump,
            normal_map,
            multiscatter: _,
            shininess,
            ior,
        } = *self;
        let abbe = match dispersion {
            Some(Dispersion::Abbe(abbe)) => Some(abbe),
            _ => None,
        };
        [
            ("absorption", of(absorption.map(|absorption| absorption.color))),
            ("absorption", of(absorption.map(|absorption| absorption.distance))),
            ("bump", of(bump.map(|bump| bump.texture))),
            ("bump", of(bump.map(|bump| bump.height))),
            ("clearCoat", of(clear_coat.map(|coat| coat.strength))),
            ("clearCoat", of(clear_coat.map(|coat| coat.roughness))),
            ("conductor", of(conductor.map(|metal| metal.eta))),
            ("conductor", of(conductor.map(|metal| metal.k))),
            ("dispersion", of(abbe)),
            ("ior", of(ior)),
            ("normalMap", normal_map.map(|map| map.texture)),
            ("normalMap", of(normal_map.map(|map| map.strength))),
            ("orenNayar", of(oren_nayar)),
            ("roughness", of(roughness)),
            ("shininess", of(shininess)),
        ]
    }
}

impl Material {
    /// Changes what the surface does beyond the shading equation.
    ///
    /// # Errors
    /// As [`Finish::check`]; the material then is as before.
    ///
    /// ```
    /// use rtscript::scene::{Dispersion, Material};
    /// let mut glass = Material::default();
    /// glass.set_ior(1.5)?;
    /// glass.set_shininess(200.0)?;
    /// glass.set_dispersion(Dispersion::abbe(40.0))?;
    /// glass.change_finish(|finish| finish.fresnel = true)?;
    /// assert_eq!((glass.ior, glass.shininess), (1.5, 200.0));
    /// // What is out of its range changes nothing.
    /// assert!(glass.set_ior(-1.0).is_err());
    /// assert_eq!(glass.ior, 1.5);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn change_finish(&mut self, change: impl FnOnce(&mut Finish)) -> Result<(), SceneError> {
        let mut finish = self.finish.as_deref().cloned().unwrap_or_default();
        change(&mut finish);
        finish.check()?;
        self.finish = (finish != Finish::default()).then(|| std::sync::Arc::new(finish));
        Ok(())
    }

    /// The exponent of the highlight: a number as [`Material::shininess`], or a texture as [`Finish::shininess`].
    ///
    /// # Errors
    /// Where the number is negative.
    pub fn set_shininess(&mut self, shininess: impl Into<Term>) -> Result<(), SceneError> {
        let (number, varying) = number_or_texture(shininess.into(), Self::default().shininess);
        if !(number >= 0.0) {
            return Err(SceneError::new(format!("s must be 0 or greater, not {number}")));
        }
        self.change_finish(|finish| finish.shininess = varying)?;
        self.shininess = number;
        Ok(())
    }

    /// How much more the inside bends some colors than others. What has an index of refraction of its own sets [`Material::ior`], too.
    ///
    /// # Errors
    /// Where a number is out of its range.
    pub fn set_dispersion(&mut self, dispersion: Dispersion) -> Result<(), SceneError> {
        self.change_finish(|finish| finish.dispersion = Some(dispersion))?;
        match dispersion.index_d() {
            Some(ior) => self.set_ior(ior),
            None => Ok(()),
        }
    }

    /// The index of refraction: a number as [`Material::ior`], or a texture as [`Finish::ior`].
    ///
    /// # Errors
    /// Where the number is not greater than 0.
    pub fn set_ior(&mut self, ior: impl Into<Term>) -> Result<(), SceneError> {
        let (number, varying) = number_or_texture(ior.into(), Self::default().ior);
        if !(number > 0.0) {
            return Err(SceneError::new(format!("n must be greater than 0, not {number}")));
        }
        self.change_finish(|finish| finish.ior = varying)?;
        self.ior = number;
        Ok(())
    }
}

/// The number that a term is everywhere, or `usual` and the term itself.
fn number_or_texture(term: Term, usual: f64) -> (f64, Option<Term>) {
    match term.texture {
        None => (Term::number_of(term.color), None),
        Some(_) => (usual, Some(term)),
    }
}

/// The mean of three channels.
pub(crate) fn mean(c: Color) -> f64 {
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
        let glass = |color, distance| {
            Some(Absorption {
                color: Term::color(color),
                distance: Term::number(distance),
            })
        };
        assert!(refused(&|f| f.oren_nayar = Some(91.0.into())).starts_with("sigma"));
        assert!(refused(&|f| f.absorption = glass(Color::ZERO, 1.0)).starts_with("color"));
        assert!(refused(&|f| f.absorption = glass(Color::ONE, 0.0)).starts_with("distance"));
        assert!(refused(&|f| f.dispersion = Some(Dispersion::abbe(f64::NAN))).starts_with("abbe"));
        assert!(refused(&|f| f.roughness = Some(Term::color(Color::splat(2.0)))).starts_with("roughness"));
    }
}
