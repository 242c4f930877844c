//! Two eyes.

use crate::scene::SceneError;

/// Where the pictures of the two eyes go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StereoLayout {
    /// The left eye's in the left half, the right eye's in the right half.
    #[default]
    SideBySide,
    /// The left eye's in the upper half, the right eye's in the lower half.
    TopBottom,
    /// Both in one: red of the left eye, green and blue of the right eye, for glasses of red and cyan.
    Anaglyph,
}

impl StereoLayout {
    /// Every layout with what scripts call it.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("side-by-side", Self::SideBySide),
        ("top-bottom", Self::TopBottom),
        ("anaglyph", Self::Anaglyph),
    ];

    /// What scripts call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SideBySide => "side-by-side",
            Self::TopBottom => "top-bottom",
            Self::Anaglyph => "anaglyph",
        }
    }
}

/// Two eyes beside each other instead of one between them.
///
/// Both see what lies at the distance of convergence at the same place of their pictures: a screen at that distance,
/// nearer things before it and farther ones behind. Flat projections converge on a plane, with parallel axes and pictures
/// that are shifted rather than turned ("off axis"), so that nothing is displaced vertically. The other projections
/// converge on a sphere. In panoramic and cylindrical pictures each column is seen by eyes that look that way
/// (omnidirectional stereo; Peleg, Ben-Ezra and Pritch, "Omnistereo: panoramic stereo imaging", 2001).
///
/// ```
/// use rtscript::{DVec3, scene::{Camera, Stereo, StereoLayout}};
/// let eyes = Stereo { separation: 0.065, layout: StereoLayout::SideBySide, convergence: Some(3.0) };
/// let camera = Camera::new(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0)?.with_stereo(Some(eyes))?;
/// assert_eq!(camera.stereo.map(|s| s.layout.name()), Some("side-by-side"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// From eye to eye, in world units, above 0.
    pub separation: f64,
    /// Where the two pictures go.
    pub layout: StereoLayout,
    /// Distance at which the eyes see the same, in world units, above 0, infinite for parallel eyes; `None` is the
    /// distance of the point looked at where the projection is flat, else infinite.
    pub convergence: Option<f64>,
}

impl Stereo {
    pub(super) fn check(&self) -> Result<(), SceneError> {
        if !(self.separation > 0.0 && self.separation.is_finite()) {
            return Err(SceneError::new(format!(
                "the separation of the eyes must be above 0, not {}",
                self.separation
            ))
            .hint("6.5 cm is that of people, in the unit of the scene"));
        }
        match self.convergence {
            Some(distance) if !(distance > 0.0) => Err(SceneError::new(format!(
                "the convergence must be a distance above 0, not {distance}"
            ))),
            _ => Ok(()),
        }
    }
}
