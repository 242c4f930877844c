//! How much a picture may differ from its reference.

use super::Comparison;

/// How much a picture may differ from its reference and still pass. Every condition must hold; sizes must be equal
/// whatever is allowed.
///
/// Pictures of one version of rtscript and one edition are the same to the last bit on every machine, so a test needs
/// no tolerance to pass elsewhere. It is for what is meant to change a little: a mesh from a tool of its own, a scene
/// that is being moved to a newer edition.
///
/// ```
/// use rtscript::testing::{Tolerance, compare, from_rgb8};
/// let a = from_rgb8(2, 1, &[10, 10, 10, 20, 20, 20]);
/// let b = from_rgb8(2, 1, &[10, 10, 10, 20, 21, 20]);
/// let close = Tolerance { max_difference: 1, ..Tolerance::ANY };
/// assert!(close.allows(&compare(&a, &b)));
/// assert!(!Tolerance { share: 0.1, ..close }.allows(&compare(&a, &b)));
/// assert!(!Tolerance::EXACT.allows(&compare(&a, &b)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest difference of a channel, in steps of 8 bits, 0 to 255.
    pub max_difference: u8,
    /// Largest share of pixels that differ in any channel, 0 to 1.
    pub share: f64,
    /// Least peak signal-to-noise ratio, in decibels; equal pictures have an infinite one.
    pub psnr: f64,
    /// Whether the text of the scene may differ, too. What the script printed and warnings may not.
    pub scene_may_differ: bool,
}

impl Tolerance {
    /// No pixel may differ, and no line of the scene.
    pub const EXACT: Self = Self {
        max_difference: 0,
        share: 0.0,
        psnr: f64::INFINITY,
        scene_may_differ: false,
    };

    /// Any picture of the same size and the same scene passes: what the conditions of one's own start from, as in
    /// `Tolerance { psnr: 40.0, ..Tolerance::ANY }`.
    pub const ANY: Self = Self {
        max_difference: 255,
        share: 1.0,
        psnr: 0.0,
        scene_may_differ: false,
    };

    /// Whether two pictures that compare so are near enough. It does not see their sizes.
    #[must_use]
    pub fn allows(&self, c: &Comparison) -> bool {
        c.max <= self.max_difference
            && c.differing as f64 <= self.share * c.pixels as f64
            && c.psnr >= self.psnr
    }
}

/// [`Tolerance::EXACT`].
impl Default for Tolerance {
    fn default() -> Self {
        Self::EXACT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_condition_counts() {
        let c = Comparison {
            pixels: 100,
            differing: 10,
            max: 3,
            psnr: 40.0,
        };
        let exact = Comparison {
            differing: 0,
            max: 0,
            psnr: f64::INFINITY,
            ..c
        };
        assert!(Tolerance::EXACT.allows(&exact) && Tolerance::ANY.allows(&exact));
        assert!(!Tolerance::EXACT.allows(&c) && Tolerance::ANY.allows(&c));
        let just = Tolerance {
            max_difference: 3,
            share: 0.1,
            psnr: 40.0,
            scene_may_differ: false,
        };
        assert!(just.allows(&c));
        for short in [
            Tolerance {
                max_difference: 2,
                ..just
            },
            Tolerance { share: 0.09, ..just },
            Tolerance { psnr: 40.1, ..just },
            Tolerance {
                share: f64::NAN,
                ..just
            },
            Tolerance {
                psnr: f64::NAN,
                ..just
            },
        ] {
            assert!(!short.allows(&c), "{short:?}");
        }
    }
}
