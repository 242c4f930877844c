//! How the index of refraction of what is transparent depends on the wavelength.

use super::{Finish, SceneError, Term};

/// Wavelength of Fraunhofer's d line in micrometers: the yellow light that an index of refraction is given for.
pub(crate) const D_LINE: f64 = 0.587_56;

/// The wavelengths that are seen, in micrometers.
const SEEN: [f64; 2] = [0.4, 0.7];
const SEEN_SQUARED: [f64; 2] = [0.16, 0.49];

/// How the index of refraction depends on the wavelength. All but [`Dispersion::Abbe`] have an index of their own at the d line;
/// where the material's differs from that, it is this much greater or less at every wavelength.
///
/// ```
/// use rtscript::scene::Dispersion;
/// // Cauchy's formula, wavelengths in micrometers: blue is bent more than red.
/// let flint = Dispersion::Cauchy { a: 1.6, b: 0.01, c: 0.0 };
/// assert!(flint.index(0.45) > flint.index(0.65));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// Abbe number (n_d - 1) / (n_F - n_C), at least 1, a [number](Term::number): the smaller, the more colors are bent apart. The
    /// material's index is that at the d line, and Cauchy's formula of two terms the rest.
    Abbe(Term),
    /// n = a + b / wavelength^2 + c / wavelength^4, in micrometers (Cauchy, "Mémoire sur la dispersion de la lumière", 1836).
    Cauchy {
        /// The index for waves of any length.
        a: f64,
        /// In square micrometers.
        b: f64,
        /// In micrometers to the fourth.
        c: f64,
    },
    /// n^2 = 1 + the sum of b wavelength^2 / (wavelength^2 - c) over up to four pairs of b and c, in square micrometers, as catalogs
    /// of glass list them (Sellmeier, "Zur Erklärung der abnormen Farbenfolge im Spectrum einiger Substanzen", 1871). Unused pairs
    /// are 0.
    Sellmeier([[f64; 2]; 4]),
}

/// Three pairs.
const fn glass(b: [f64; 3], c: [f64; 3]) -> Dispersion {
    let ([b1, b2, b3], [c1, c2, c3]) = (b, c);
    Dispersion::Sellmeier([[b1, c1], [b2, c2], [b3, c3], [0.0, 0.0]])
}

impl Dispersion {
    /// What is known by name. Schott's optical glasses (crowns BK7, BAK4 and FK51A, flints F2, SF10, SF11 and LASF9, those of them
    /// that are free of lead as N-BK7, N-BAK4, N-FK51A, N-SF11 and N-LASF9) are from its data sheets; silica from Malitson,
    /// "Interspecimen comparison of the refractive index of fused silica", 1965; sapphire (its ordinary ray) from Malitson
    /// and Dodge, "Refractive index and birefringence of synthetic sapphire", 1972, as Dodge has the formula in the "Handbook of laser
    /// science and technology", volume IV, 1986; diamond from Peter, "Über Brechungsindizes und
    /// Absorptionskonstanten des Diamanten", 1923; water at 20 degrees from Daimon and Masumura, "Measurement of the refractive
    /// index of distilled water", 2007.
    pub const GLASSES: [(&'static str, Self); 11] = [
        (
            "BAK4",
            glass(
                [1.288_346_42, 0.132_817_724, 0.945_395_373],
                [0.007_799_806_26, 0.031_563_117_7, 105.965_875],
            ),
        ),
        (
            "BK7",
            glass(
                [1.039_612_12, 0.231_792_344, 1.010_469_45],
                [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
            ),
        ),
        (
            "F2",
            glass(
                [1.345_333_59, 0.209_073_176, 0.937_357_162],
                [0.009_977_438_71, 0.047_045_076_7, 111.886_764],
            ),
        ),
        (
            "FK51A",
            glass(
                [0.971_247_817, 0.216_901_417, 0.904_651_666],
                [0.004_723_019_95, 0.015_357_561_2, 168.681_33],
            ),
        ),
        (
            "LASF9",
            glass(
                [2.000_295_47, 0.298_926_886, 1.806_918_43],
                [0.012_142_601_7, 0.053_873_623_6, 156.530_829],
            ),
        ),
        (
            "SF10",
            glass(
                [1.616_259_77, 0.259_229_334, 1.077_623_17],
                [0.012_753_455_9, 0.058_198_395_4, 116.607_68],
            ),
        ),
        (
            "SF11",
            glass(
                [1.737_596_95, 0.313_747_346, 1.898_781_01],
                [0.013_188_707, 0.062_306_814_2, 155.236_29],
            ),
        ),
        (
            "diamond",
            glass([0.3306, 4.3356, 0.0], [0.175 * 0.175, 0.106 * 0.106, 0.0]),
        ),
        (
            "sapphire",
            glass(
                [1.431_349_3, 0.650_547_13, 5.341_402_1],
                [
                    0.072_663_1 * 0.072_663_1,
                    0.119_324_2 * 0.119_324_2,
                    18.028_251 * 18.028_251,
                ],
            ),
        ),
        (
            "silica",
            glass(
                [0.696_166_3, 0.407_942_6, 0.897_479_4],
                [
                    0.068_404_3 * 0.068_404_3,
                    0.116_241_4 * 0.116_241_4,
                    9.896_161 * 9.896_161,
                ],
            ),
        ),
        (
            "water",
            Self::Sellmeier([
                [0.568_402_756_5, 0.005_101_829_712],
                [0.172_617_739_1, 0.018_211_539_36],
                [0.020_861_895_78, 0.026_207_222_93],
                [0.113_074_868_8, 10.697_927_21],
            ]),
        ),
    ];

    /// The Abbe number `abbe` everywhere.
    #[must_use]
    pub const fn abbe(abbe: f64) -> Self {
        Self::Abbe(Term::number(abbe))
    }

    /// Its own index of refraction at a wavelength in micrometers; `None` where that is the material's to say.
    #[must_use]
    pub fn index(&self, micrometers: f64) -> Option<f64> {
        let squared = micrometers * micrometers;
        match self {
            Self::Abbe(_) => None,
            Self::Cauchy { a, b, c } => Some(a + b / squared + c / (squared * squared)),
            Self::Sellmeier(pairs) => {
                let sum = pairs
                    .iter()
                    .filter(|[b, _]| *b != 0.0)
                    .fold(1.0, |sum, [b, c]| sum + b * squared / (squared - c));
                Some(sum.sqrt())
            }
        }
    }

    /// Its own index of refraction for yellow light, the d line; `None` where that is the material's to say.
    ///
    /// ```
    /// use rtscript::scene::Dispersion;
    /// // A formula says how strongly yellow light is bent; an Abbe number leaves that to the material.
    /// let cauchy = Dispersion::Cauchy { a: 1.5, b: 0.0, c: 0.0 };
    /// assert_eq!(cauchy.index_d(), Some(1.5));
    /// assert_eq!(Dispersion::abbe(40.0).index_d(), None);
    /// ```
    #[must_use]
    pub fn index_d(&self) -> Option<f64> {
        self.index(D_LINE)
    }

    pub(super) fn check(&self) -> Result<(), SceneError> {
        if let Self::Sellmeier(pairs) = self {
            let [least, most] = SEEN_SQUARED;
            for [b, c] in pairs {
                if !(b.abs() <= 1e6 && c.abs() <= 1e6) {
                    return Err(SceneError::new(format!(
                        "numbers of sellmeier must lie between -1000000 and 1000000, not {b} and {c}"
                    )));
                }
                if *b != 0.0 && (least..=most).contains(c) {
                    return Err(SceneError::new(format!(
                        "the second number of a pair of sellmeier must not lie between {least} and {most}, where light is \
                         seen, and {c} does"
                    ))
                    .hint("it is a squared wavelength in square micrometers, as catalogs list it as C1, C2 and C3"));
                }
            }
        }
        let [least, most] = [0.1, Finish::ETA[1]];
        for i in 0..=30 {
            let micrometers = SEEN[0] + 0.01 * f64::from(i);
            if let Some(n) = self.index(micrometers).filter(|n| !(least..=most).contains(n)) {
                return Err(SceneError::new(format!(
                    "the index of refraction must lie between {least} and {most} from 400 to 700 nanometers, not be {n} at \
                     {:.0}",
                    micrometers * 1e3
                ))
                .hint("wavelengths count in micrometers: glass has an A near 1.5 and a B near 0.005"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Index at the lines d, F and C as catalogs list them.
    const CATALOG: [(&str, [f64; 3]); 11] = [
        ("BAK4", [1.56883, 1.57591, 1.56575]),
        ("BK7", [1.51680, 1.52238, 1.51432]),
        ("F2", [1.62004, 1.63208, 1.61503]),
        ("FK51A", [1.48656, 1.49056, 1.48480]),
        ("LASF9", [1.85025, 1.86898, 1.84255]),
        ("SF10", [1.72825, 1.74648, 1.72085]),
        ("SF11", [1.78472, 1.80651, 1.77596]),
        ("diamond", [2.4175, 2.4355, 2.4099]),
        ("sapphire", [1.76817, 1.77551, 1.76488]),
        ("silica", [1.45846, 1.46313, 1.45637]),
        ("water", [1.33335, 1.33749, 1.33151]),
    ];

    #[test]
    fn glasses_have_the_indices_of_their_catalogs() {
        for ((name, listed), (known, glass)) in CATALOG.into_iter().zip(Dispersion::GLASSES) {
            assert_eq!(name, known);
            let tolerance = if matches!(name, "diamond" | "water") {
                6e-5
            } else {
                6e-6
            };
            for (line, expected) in [0.587_561_8, 0.486_132_7, 0.656_272_5].into_iter().zip(listed) {
                let found = glass.index(line).unwrap();
                assert!(
                    (found - expected).abs() < tolerance,
                    "{name} at {line}: {found} and not {expected}"
                );
            }
            assert!((glass.index_d().unwrap() - listed[0]).abs() < 1e-4);
            glass.check().unwrap();
        }
    }

    /// Abbe number and deviation of the relative partial dispersion P_gF from the normal line, of Schott's glasses as its catalog
    /// of 2017 lists them: how far blue is bent beyond what two other lines tell.
    const PARTIAL: [(&str, [f64; 2]); 7] = [
        ("BAK4", [55.98, -0.0010]),
        ("BK7", [64.17, -0.0009]),
        ("F2", [36.37, 0.0002]),
        ("FK51A", [84.47, 0.0342]),
        ("LASF9", [32.17, 0.0037]),
        ("SF10", [28.41, 0.0085]),
        ("SF11", [25.68, 0.0150]),
    ];

    #[test]
    fn glasses_bend_blue_light_as_their_catalogs_say() {
        const G: f64 = 0.435_834_3;
        let of = |name: &str, line: f64| {
            let (_, glass) = Dispersion::GLASSES
                .iter()
                .find(|(known, _)| *known == name)
                .unwrap();
            glass.index(line).unwrap()
        };
        for (name, [abbe, deviation]) in PARTIAL {
            let [d, f, c] = [0.587_561_8, 0.486_132_7, 0.656_272_5].map(|line| of(name, line));
            let found = (d - 1.0) / (f - c);
            assert!((found - abbe).abs() < 6e-3, "{name}: {found} and not {abbe}");
            // Schott's normal line goes through K7 and F2.
            let partial = 0.6438 - 0.001_682 * found + deviation;
            let expected = f + partial * (f - c);
            let found = of(name, G);
            assert!(
                (found - expected).abs() < 3e-6,
                "{name}: {found} and not {expected}"
            );
        }
        // From the data sheet of N-BK7, and measured by Malitson for silica.
        assert!((of("BK7", G) - 1.52668).abs() < 6e-6);
        assert!((of("silica", 0.435_835) - 1.466_690).abs() < 5e-6);
    }

    #[test]
    fn what_is_no_glass_is_refused() {
        let refused = |dispersion: Dispersion| dispersion.check().unwrap_err().message;
        let cauchy = |a, b, c| Dispersion::Cauchy { a, b, c };
        assert!(cauchy(1.5046, 0.0042, 0.0).check().is_ok());
        assert!(refused(cauchy(1.5, 4200.0, 0.0)).starts_with("the index of refraction"));
        assert!(refused(cauchy(f64::NAN, 0.0, 0.0)).starts_with("the index of refraction"));
        // A band of absorption in the middle of the spectrum.
        assert!(refused(Dispersion::Sellmeier([[1.0, 0.25]; 4])).starts_with("the second number"));
        assert!(refused(Dispersion::Sellmeier([[f64::INFINITY, 0.0]; 4])).starts_with("numbers"));
        assert!(refused(Dispersion::Sellmeier([[-9.0, 0.0]; 4])).starts_with("the index"));
    }
}
