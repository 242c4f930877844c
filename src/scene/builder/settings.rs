//! Settings and camera.

use super::{Builder, SceneError, finite};
use crate::{
    color::Color,
    scene::{Camera, Encoding, Settings},
};

impl Builder {
    /// The settings as they stand.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.scene.settings
    }

    /// Picture size in pixels.
    ///
    /// # Errors
    /// Where an edge is 0, or the limits `image_side` or `pixels` are passed.
    pub fn size(&mut self, width: u32, height: u32) -> Result<(), SceneError> {
        if width == 0 || height == 0 {
            return Err(SceneError::new(format!(
                "the picture's size must be at least 1 x 1, not {width} x {height}"
            )));
        }
        let what = format!("a picture of {width} x {height} is too large");
        if width.max(height) > self.limits.image_side {
            return Err(SceneError::limit(&what, "image_side", self.limits.image_side));
        }
        if u64::from(width) * u64::from(height) > self.limits.pixels {
            return Err(SceneError::limit(&what, "pixels", self.limits.pixels));
        }
        (self.scene.settings.width, self.scene.settings.height) = (width, height);
        Ok(())
    }

    /// Rays per pixel.
    ///
    /// # Errors
    /// Where `n` is 0 or past the limit `samples`.
    pub fn samples(&mut self, n: u32) -> Result<(), SceneError> {
        if n == 0 {
            return Err(SceneError::new("there must be at least 1 sample per pixel")
                .hint("samples(1) is the default"));
        }
        if n > self.limits.samples {
            return Err(SceneError::limit(
                &format!("{n} samples are too many"),
                "samples",
                self.limits.samples,
            ));
        }
        self.scene.settings.samples = n;
        Ok(())
    }

    /// Secondary bounces, 0 for none.
    ///
    /// # Errors
    /// Past the limit `depth` (at most 64).
    pub fn max_depth(&mut self, n: u32) -> Result<(), SceneError> {
        let most = self.limits.depth.min(Settings::MAX_DEPTH);
        if n > most {
            return Err(SceneError::limit(
                &format!("{n} bounces are too many"),
                "depth",
                most,
            ));
        }
        self.scene.settings.max_depth = n;
        Ok(())
    }

    /// What a ray sees that leaves the scene.
    ///
    /// # Errors
    /// Where a component is not finite.
    pub fn background(&mut self, color: Color) -> Result<(), SceneError> {
        self.scene.settings.background = finite("the background", color)?;
        Ok(())
    }

    /// How linear light becomes 8 bits.
    pub fn encoding(&mut self, encoding: Encoding) {
        self.scene.settings.encoding = encoding;
    }

    /// Seeds every random choice of the renderer.
    pub fn seed(&mut self, seed: u64) {
        self.scene.settings.seed = seed;
    }

    /// The camera; the last call counts.
    pub fn camera(&mut self, camera: Camera) {
        self.scene.camera = camera;
    }
}
