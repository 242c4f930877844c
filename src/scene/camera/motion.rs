//! A camera that moves while light is gathered.

use super::Camera;
use crate::{math::DVec3, scene::SceneError};

/// The part of a motion during which light is gathered: from `open` to `close`, where the motion goes from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    /// When it opens, from 0 on.
    pub open: f64,
    /// When it closes, not before it opens, up to 1.
    pub close: f64,
}

impl Default for Shutter {
    fn default() -> Self {
        Self {
            open: 0.0,
            close: 1.0,
        }
    }
}

impl Shutter {
    /// The time that a number from 0 to 1 stands for.
    #[must_use]
    pub(crate) fn time(&self, share: f64) -> f64 {
        self.open + (self.close - self.open) * share
    }

    pub(super) fn check(&self) -> Result<(), SceneError> {
        let Self { open, close } = *self;
        if open >= 0.0 && open <= close && close <= 1.0 {
            return Ok(());
        }
        Err(SceneError::new(format!(
            "the shutter must open and close between 0 and 1, in this order, not at {open} and {close}"
        )))
    }
}

/// Where a camera stands when its motion ends. What it looks from, looks at and has as up go there in straight lines, at
/// an even pace.
///
/// ```
/// use rtscript::{DVec3, scene::{Camera, Motion, Shutter}};
/// let eye = DVec3::new(0.0, 1.0, 5.0);
/// // Half a unit to the right while light is gathered, of which the first half counts.
/// let moved = Motion { eye: eye + 0.5 * DVec3::X, at: DVec3::ZERO, up: DVec3::Y };
/// let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, 40.0)?
///     .with_motion(Some(moved))?
///     .with_shutter(Shutter { open: 0.0, close: 0.5 })?;
/// assert_eq!(camera.shutter.close, 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where it stands.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub at: DVec3,
    /// A direction that points up in the picture.
    pub up: DVec3,
}

/// Times at which a motion is looked at before it is taken.
const TIMES: u32 = 256;

impl Motion {
    /// Whether it leaves the camera a view at each of many times.
    pub(super) fn check(&self, camera: &Camera) -> Result<(), SceneError> {
        let moving = Camera {
            motion: Some(*self),
            ..*camera
        };
        for i in 0..=TIMES {
            let time = f64::from(i) / f64::from(TIMES);
            let Camera { eye, at, up, .. } = moving.at_time(time);
            Camera::with_projection(eye, at, up, camera.projection).map_err(|e| {
                let message = format!("{}, when {time} of its motion is done", e.message);
                SceneError { message, ..e }
            })?;
        }
        Ok(())
    }
}

impl Camera {
    /// The camera as it stands at a time of its motion, from 0 to 1.
    #[must_use]
    pub(crate) fn at_time(&self, time: f64) -> Self {
        let Some(Motion { eye, at, up }) = self.motion else {
            return *self;
        };
        let between = |from: DVec3, to: DVec3| from + (to - from) * time;
        Self {
            eye: between(self.eye, eye),
            at: between(self.at, at),
            up: between(self.up, up),
            ..*self
        }
    }
}
