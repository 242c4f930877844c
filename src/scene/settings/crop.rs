//! A part of the picture.

use crate::scene::SceneError;

/// A rectangle of pixels.
///
/// ```
/// use rtscript::scene::{Crop, Region};
/// let whole = Region { x: 0, y: 0, width: 100, height: 50 };
/// let left_half = Crop::Fractions { left: 0.0, top: 0.0, right: 0.5, bottom: 1.0 };
/// left_half.check()?;
/// assert_eq!(left_half.region(&whole), Region { width: 50, ..whole });
/// assert!(whole.contains(99, 49) && whole.pixels() == 5000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Its first column.
    pub x: u32,
    /// Its first row, from the top.
    pub y: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

impl Region {
    /// Whether the pixel in this column and row lies in it.
    #[must_use]
    pub const fn contains(&self, x: u32, y: u32) -> bool {
        x >= self.x && y >= self.y && x - self.x < self.width && y - self.y < self.height
    }

    /// Pixels in it.
    #[must_use]
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Which part of the picture is rendered. Its pixels are those of the whole picture, to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crop {
    /// These pixels, as far as the picture has them.
    Pixels(Region),
    /// Shares of the picture, from 0 to 1: the part stays the same where the size changes.
    Fractions {
        /// Left edge.
        left: f64,
        /// Upper edge.
        top: f64,
        /// Right edge, beyond the left one.
        right: f64,
        /// Lower edge, below the upper one.
        bottom: f64,
    },
}

impl Crop {
    /// Whether it is a part of a picture at all.
    ///
    /// # Errors
    /// Where it has no pixels, or fractions are not in order from 0 to 1.
    pub fn check(&self) -> Result<(), SceneError> {
        match *self {
            Self::Pixels(Region { width, height, .. }) if width == 0 || height == 0 => Err(SceneError::new(
                format!("a crop must be at least 1 x 1 pixels, not {width} x {height}"),
            )),
            Self::Pixels(_) => Ok(()),
            Self::Fractions {
                left,
                top,
                right,
                bottom,
            } => {
                for (low, high, names) in [
                    (left, right, "from left to right"),
                    (top, bottom, "from top to bottom"),
                ] {
                    if !(low >= 0.0 && low < high && high <= 1.0) {
                        return Err(SceneError::new(format!(
                            "a crop in fractions must reach {names} within 0 and 1, not from {low} to {high}"
                        )));
                    }
                }
                Ok(())
            }
        }
    }

    /// Its pixels in a picture: at least one, the nearest where it lies outside.
    #[must_use]
    pub fn region(&self, whole: &Region) -> Region {
        let within = |low: u32, length: u32, all: u32| {
            let low = low.min(all.saturating_sub(1));
            (low, length.min(all - low).max(1))
        };
        let share = |low: f64, high: f64, all: u32| {
            let edge = |x: f64| (x * f64::from(all) + 0.5).floor() as u32;
            within(edge(low), edge(high).saturating_sub(edge(low)), all)
        };
        let ((x, width), (y, height)) = match *self {
            Self::Pixels(r) => (
                within(r.x, r.width, whole.width),
                within(r.y, r.height, whole.height),
            ),
            Self::Fractions {
                left,
                top,
                right,
                bottom,
            } => (share(left, right, whole.width), share(top, bottom, whole.height)),
        };
        Region { x, y, width, height }
    }

    /// The part of a smaller picture that shows the same, where that has one pixel for so many.
    #[must_use]
    pub(crate) fn coarser(self, step: u32) -> Self {
        match self {
            Self::Pixels(r) => Self::Pixels(Region {
                x: r.x / step,
                y: r.y / step,
                width: r.width.div_ceil(step),
                height: r.height.div_ceil(step),
            }),
            fractions @ Self::Fractions { .. } => fractions,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Region = Region {
        x: 0,
        y: 0,
        width: 64,
        height: 48,
    };

    fn fractions(left: f64, top: f64, right: f64, bottom: f64) -> Crop {
        Crop::Fractions {
            left,
            top,
            right,
            bottom,
        }
    }

    #[test]
    fn fractions_are_rounded_to_pixels_and_meet() {
        let region = |crop: Crop| {
            let r = crop.region(&WHOLE);
            [r.x, r.y, r.width, r.height]
        };
        assert_eq!(region(fractions(0.0, 0.0, 1.0, 1.0)), [0, 0, 64, 48]);
        assert_eq!(region(fractions(0.25, 0.5, 0.5, 1.0)), [16, 24, 16, 24]);
        for i in 1..40 {
            let at = f64::from(i) / 40.0;
            let (left, right) = (fractions(0.0, 0.0, at, 1.0), fractions(at, 0.0, 1.0, 1.0));
            assert_eq!(left.region(&WHOLE).width, right.region(&WHOLE).x);
        }
        assert_eq!(region(fractions(0.5, 0.5, 0.501, 0.501)), [32, 24, 1, 1]);
    }

    #[test]
    fn pixels_outside_are_left_out() {
        let crop = |x, y, width, height| {
            let r = Crop::Pixels(Region { x, y, width, height }).region(&WHOLE);
            [r.x, r.y, r.width, r.height]
        };
        assert_eq!(crop(60, 40, 10, 10), [60, 40, 4, 8]);
        assert_eq!(crop(100, 100, u32::MAX, 1), [63, 47, 1, 1]);
    }

    #[test]
    fn what_is_no_part_is_refused() {
        assert!(fractions(0.0, 0.0, 1.0, 1.0).check().is_ok());
        for bad in [
            fractions(0.5, 0.0, 0.5, 1.0),
            fractions(0.0, 0.0, 1.1, 1.0),
            fractions(-0.1, 0.0, 1.0, 1.0),
            fractions(0.0, f64::NAN, 1.0, 1.0),
            Crop::Pixels(Region { width: 0, ..WHOLE }),
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }
}
