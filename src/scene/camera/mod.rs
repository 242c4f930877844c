//! Cameras: where one stands, how it maps directions to the picture, its lens, its two eyes.

mod frame;
mod lens;
mod motion;
mod stereo;
#[cfg(test)]
mod tests;

pub use self::{
    frame::{CameraFrame, Eye},
    lens::{Focus, Lens},
    motion::{Motion, Shutter},
    stereo::{Stereo, StereoLayout},
};
use crate::{
    math::{DVec3, max_abs},
    scene::SceneError,
};

/// How directions before a camera come to lie in its picture. Angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Straight lines stay straight: what gluPerspective has.
    Perspective {
        /// Vertical field of view, in (0, 180).
        fovy: f64,
    },
    /// Parallel rays: what is far away is as large as what is near.
    Orthographic {
        /// Height of what the picture shows, in world units, above 0.
        height: f64,
    },
    /// Distance from the middle of the picture goes with the angle to the view (equidistant, r = f theta). Outside of
    /// its circle there is nothing to be seen.
    Fisheye {
        /// The angle that the circle spans, in (0, 360].
        angle: f64,
        /// The circle goes through the corners of the picture and fills it; else it touches the nearer edges.
        full_frame: bool,
    },
    /// Columns are degrees of longitude, rows degrees of latitude (equirectangular): a map of everything around.
    Panorama {
        /// What the width spans, in (0, 360].
        angle: f64,
        /// What the height spans, in (0, 180].
        fovy: f64,
    },
    /// Columns are degrees around the camera; up and down is the perspective of a cylinder around it, on which upright
    /// lines stay straight.
    Cylindrical {
        /// What the width spans, in (0, 360].
        angle: f64,
        /// Vertical field of view, in (0, 180); `None` makes pixels square at the height of the camera.
        fovy: Option<f64>,
    },
}

impl Projection {
    /// What scripts and dumps call it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Perspective { .. } => "perspective",
            Self::Orthographic { .. } => "orthographic",
            Self::Fisheye { .. } => "fisheye",
            Self::Panorama { .. } => "panorama",
            Self::Cylindrical { .. } => "cylindrical",
        }
    }

    /// Whether the picture lies in a plane: the rays of straight lines of it lie in planes, too.
    ///
    /// ```
    /// use rtscript::scene::Projection;
    /// assert!(Projection::Perspective { fovy: 40.0 }.is_flat());
    /// assert!(!Projection::Panorama { angle: 360.0, fovy: 180.0 }.is_flat());
    /// ```
    #[must_use]
    pub const fn is_flat(&self) -> bool {
        matches!(self, Self::Perspective { .. } | Self::Orthographic { .. })
    }

    fn check(&self) -> Result<(), SceneError> {
        let within = |what: &str, x: f64, most: f64| {
            if x > 0.0 && x <= most {
                return Ok(());
            }
            Err(SceneError::new(format!(
                "the camera's {what} must be above 0 and at most {most} degrees, not {x}"
            )))
        };
        let view = |fovy: f64| {
            if fovy > 0.0 && fovy < 180.0 {
                return Ok(());
            }
            Err(SceneError::new(format!(
                "the field of view fovy must lie between 0 and 180 degrees, not {fovy}"
            ))
            .hint("45 is a usual value"))
        };
        match *self {
            Self::Perspective { fovy } => view(fovy),
            Self::Orthographic { height } if height > 0.0 && height.is_finite() => Ok(()),
            Self::Orthographic { height } => Err(SceneError::new(format!(
                "the height of what the camera sees must be above 0, not {height}"
            ))),
            Self::Fisheye { angle, .. } => within("angle", angle, 360.0),
            Self::Panorama { angle, fovy } => {
                within("angle", angle, 360.0).and_then(|()| within("vertical angle fovy", fovy, 180.0))
            }
            Self::Cylindrical { angle, fovy } => {
                within("angle", angle, 360.0).and_then(|()| fovy.map_or(Ok(()), view))
            }
        }
    }
}

/// A camera: where it stands, what it looks at, which way is up, how it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, in world space: the pinhole, or the middle of the lens.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub at: DVec3,
    /// A direction that points up in the picture; need not be a unit vector or at right angles to the view.
    pub up: DVec3,
    /// How directions come to lie in the picture.
    pub projection: Projection,
    /// A lens that blurs what is not in focus; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// Two eyes instead of one.
    pub stereo: Option<Stereo>,
    /// Where it goes while light is gathered, which blurs what it passes; `None` where it stands still.
    pub motion: Option<Motion>,
    /// The part of the motion that is seen.
    pub shutter: Shutter,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 0.0, 5.0),
            at: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective { fovy: 45.0 },
            lens: None,
            stereo: None,
            motion: None,
            shutter: Shutter::default(),
        }
    }
}

impl Camera {
    /// A perspective camera at `eye` looking at `at`, `fovy` in degrees.
    ///
    /// # Errors
    /// Where `eye` is `at`, `up` is zero or parallel to the view, or `fovy` is outside (0, 180).
    pub fn new(eye: DVec3, at: DVec3, up: DVec3, fovy: f64) -> Result<Self, SceneError> {
        Self::with_projection(eye, at, up, Projection::Perspective { fovy })
    }

    /// A pinhole camera of any projection at `eye` looking at `at`.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::{Camera, Projection}};
    /// let above = Projection::Orthographic { height: 10.0 };
    /// let plan = Camera::with_projection(DVec3::Y, DVec3::ZERO, DVec3::NEG_Z, above)?;
    /// assert_eq!(plan.fovy(), None);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where `eye` is `at`, `up` is zero or parallel to the view, or a number of the projection is out of its range.
    pub fn with_projection(
        eye: DVec3,
        at: DVec3,
        up: DVec3,
        projection: Projection,
    ) -> Result<Self, SceneError> {
        projection.check()?;
        let view = eye - at;
        if max_abs(view) <= 1e-12 * max_abs(eye).max(max_abs(at)) {
            return Err(
                SceneError::new("the camera's eye and the point it looks at are the same")
                    .hint("camera(from, at, up, fovy): move one of the first two points"),
            );
        }
        let (view, unit_up) = (view / view.length(), up / up.length());
        if !(unit_up.cross(view).length() > 1e-9) {
            let what = if up == DVec3::ZERO {
                "zero"
            } else {
                "parallel to the view"
            };
            return Err(SceneError::new(format!("the camera's up vector is {what}"))
                .hint("[0, 1, 0] is a usual value; looking straight down, take [0, 0, -1]"));
        }
        Ok(Self {
            eye,
            at,
            up,
            projection,
            lens: None,
            stereo: None,
            motion: None,
            shutter: Shutter::default(),
        })
    }

    /// The same camera with this lens, or with a pinhole.
    ///
    /// # Errors
    /// Where a number of the lens is out of its range, the point in focus is not before the camera, or the projection
    /// is not flat.
    pub fn with_lens(mut self, lens: Option<Lens>) -> Result<Self, SceneError> {
        self.lens = lens;
        if let Some(lens) = &lens {
            lens.check(&self)?;
        }
        Ok(self)
    }

    /// The same camera with two eyes, or with one.
    ///
    /// # Errors
    /// Where the separation or the convergence is out of its range.
    pub fn with_stereo(mut self, stereo: Option<Stereo>) -> Result<Self, SceneError> {
        if let Some(stereo) = &stereo {
            stereo.check()?;
        }
        self.stereo = stereo;
        Ok(self)
    }

    /// The same camera on its way to another place, or standing still.
    ///
    /// # Errors
    /// Where it would have no view on its way: where it passes the point that it looks at, or looks along its up.
    pub fn with_motion(mut self, motion: Option<Motion>) -> Result<Self, SceneError> {
        if let Some(motion) = &motion {
            motion.check(&self)?;
        }
        self.motion = motion;
        Ok(self)
    }

    /// The same camera with this shutter.
    ///
    /// # Errors
    /// Where it does not open and close between 0 and 1.
    pub fn with_shutter(mut self, shutter: Shutter) -> Result<Self, SceneError> {
        shutter.check()?;
        self.shutter = shutter;
        Ok(self)
    }

    /// Vertical field of view in degrees of a perspective camera.
    #[must_use]
    pub const fn fovy(&self) -> Option<f64> {
        match self.projection {
            Projection::Perspective { fovy } => Some(fovy),
            _ => None,
        }
    }

    /// How wide a pixel in the middle of a picture of `width` times `height` pixels is, in world units, `way` units away
    /// from the camera; of parallel rays it is the same everywhere.
    #[must_use]
    pub(crate) fn pixel_width(&self, width: u32, height: u32, way: f64) -> f64 {
        let [across, down] = [width, height].map(|n| f64::from(n.max(1)));
        let degrees = match self.projection {
            Projection::Perspective { fovy } => fovy / down,
            Projection::Orthographic { height } => return height / down,
            Projection::Fisheye { angle, full_frame } => {
                let diagonal = (across * across + down * down).sqrt();
                angle / if full_frame { diagonal } else { across.min(down) }
            }
            Projection::Panorama { angle, .. } | Projection::Cylindrical { angle, .. } => angle / across,
        };
        degrees.to_radians() * way
    }

    /// Whether all rays of a picture leave one point and there is one for each point of it: a pinhole with one eye and a
    /// perspective.
    #[must_use]
    pub(crate) const fn is_plain(&self) -> bool {
        matches!(self.projection, Projection::Perspective { .. })
            && self.lens.is_none()
            && self.stereo.is_none()
            && self.motion.is_none()
    }

    /// The camera's rays for a picture of `width` x `height` pixels; of one that moves those of the middle of the time
    /// that its shutter is open.
    #[must_use]
    pub fn frame(&self, width: u32, height: u32) -> CameraFrame {
        CameraFrame::new(self, (width, height), self.shutter.time(0.5))
    }
}
