//! Where in a pixel its samples lie, how many it has, and what each counts for.

use crate::scene::SceneError;

/// How the samples of a pixel are spread: over the pixel, the lens, the shutter and the lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// Jittered in strata of equal area, in rows as square as their number allows; lights by independent numbers.
    #[default]
    Stratified,
    /// Owen-scrambled points of Sobol's sequence in every pair of dimensions, best where their number is a power of two.
    Sobol,
}

impl Sampling {
    /// Every kind with what scripts call it.
    pub const NAMES: [(&'static str, Self); 2] = [("stratified", Self::Stratified), ("sobol", Self::Sobol)];

    /// What scripts call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stratified => "stratified",
            Self::Sobol => "sobol",
        }
    }
}

/// The shape of a filter over the distance x from the middle of a pixel, in columns and in rows alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterKind {
    /// All alike.
    #[default]
    Box,
    /// Falls evenly to 0.
    Tent,
    /// A bell that falls to 0: exp(-x^2 / (2 s^2)) less its value at the radius, s a third of the radius.
    Gaussian,
    /// The cubic of Mitchell and Netravali ("Reconstruction filters in computer graphics", 1988) with B = C = 1/3, which
    /// is below 0 outside and so sharpens edges.
    Mitchell,
    /// The window of Blackman and Harris (Harris, "On the use of windows for harmonic analysis", 1978).
    BlackmanHarris,
}

impl FilterKind {
    /// Every kind with what scripts call it.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("box", Self::Box),
        ("tent", Self::Tent),
        ("gaussian", Self::Gaussian),
        ("mitchell", Self::Mitchell),
        ("blackmanHarris", Self::BlackmanHarris),
    ];

    /// What scripts call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Tent => "tent",
            Self::Gaussian => "gaussian",
            Self::Mitchell => "mitchell",
            Self::BlackmanHarris => "blackmanHarris",
        }
    }

    /// The radius in pixels that it has unless it is given another.
    ///
    /// ```
    /// use rtscript::scene::FilterKind;
    /// // A box filter takes the samples of its own pixel and no other.
    /// assert_eq!(FilterKind::Box.usual_radius(), 0.5);
    /// ```
    #[must_use]
    pub const fn usual_radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian | Self::BlackmanHarris => 1.5,
            Self::Mitchell => 2.0,
        }
    }
}

/// What the surroundings of a pixel count for in it.
///
/// Samples are drawn from the filter rather than weighted by it (Ernst, Stamminger and Greiner, "Filter importance
/// sampling", 2006), so that each pixel has samples of its own and depends on nothing else. Where a filter is below 0,
/// samples count negatively; a pixel is the sum of what its samples count, over the sum of what they count for.
///
/// ```
/// use rtscript::scene::{Filter, FilterKind};
/// let soft = Filter { radius: 3.0, ..Filter::new(FilterKind::Gaussian) };
/// soft.check()?;
/// assert!(Filter::default().is_pixel() && !soft.is_pixel());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Its shape.
    pub kind: FilterKind,
    /// Where it ends, in pixels from the middle of the pixel, in (0, 16].
    pub radius: f64,
}

impl Default for Filter {
    fn default() -> Self {
        Self::new(FilterKind::Box)
    }
}

impl Filter {
    /// Largest [`Filter::radius`].
    pub const MAX_RADIUS: f64 = 16.0;

    /// A filter of its usual radius.
    #[must_use]
    pub const fn new(kind: FilterKind) -> Self {
        Self {
            kind,
            radius: kind.usual_radius(),
        }
    }

    /// Whether it is the pixel itself.
    #[must_use]
    pub fn is_pixel(&self) -> bool {
        *self == Self::default()
    }

    /// Whether there is such a filter.
    ///
    /// # Errors
    /// Where the radius is out of its range.
    pub fn check(&self) -> Result<(), SceneError> {
        if self.radius > 0.0 && self.radius <= Self::MAX_RADIUS {
            return Ok(());
        }
        Err(SceneError::new(format!(
            "the radius of the filter must be above 0 and at most {} pixels, not {}",
            Self::MAX_RADIUS,
            self.radius
        ))
        .hint(format!(
            "{} is usual for {}",
            self.kind.usual_radius(),
            self.kind.name()
        )))
    }
}

/// Samples where they are needed: each pixel has `min` of them, and then twice as many again and again until its error is
/// below `error` or it has all [`Settings::samples`](super::Settings::samples).
///
/// The error is the standard error of the pixel's mean as it looks on a screen, whose curve is taken for a square root. A
/// pixel whose first samples are even goes on all the same where they differ from those of one of its eight neighbors by
/// more than eight times `error`: it may have missed an edge.
///
/// ```
/// use rtscript::{Builder, scene::{Adaptive, Filter, FilterKind, Sampling}};
/// let mut b = Builder::new();
/// b.sampling(Sampling::Sobol);
/// b.filter(Filter::new(FilterKind::Mitchell))?;
/// b.samples(64)?;
/// // From 8 samples on, only where the error is above 1 %.
/// b.adaptive(Some(Adaptive { error: 0.01, min: 8 }))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// Largest error, from 0 to 1, where 1 is from black to white. 0 takes all samples.
    pub error: f64,
    /// Samples that every pixel has, at least 2.
    pub min: u32,
}

impl Adaptive {
    /// Whether there are such bounds.
    ///
    /// # Errors
    /// Where a number is out of its range.
    pub fn check(&self) -> Result<(), SceneError> {
        if !(0.0..=1.0).contains(&self.error) {
            return Err(
                SceneError::new(format!("the error must lie between 0 and 1, not {}", self.error))
                    .hint("0.01 is a usual value: a hundredth of the way from black to white"),
            );
        }
        if self.min < 2 {
            return Err(SceneError::new(format!(
                "min must be at least 2, not {}: one sample says nothing of its error",
                self.min
            )));
        }
        Ok(())
    }
}
