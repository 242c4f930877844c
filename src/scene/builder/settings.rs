//! Settings and camera.

use super::{Builder, SceneError, finite};
use crate::{
    color::Color,
    math::DAffine3,
    scene::{
        Adaptive, Attenuation, Camera, Crop, Edition, Encoding, Environment, Filter, Fog, Haze, Lens,
        Material, Motion, Occlusion, Sampling, Settings, Shutter, Sky, Stereo, Texture,
    },
};

impl Builder {
    /// The settings as they stand.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.scene.settings
    }

    /// The edition by which the scene is built and rendered, before anything is made. Without this it is the newest,
    /// [`Edition::LATEST`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::Edition};
    /// let mut b = Builder::new();
    /// b.edition(Edition::E2026)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// assert!(b.finish().value.dump().starts_with("edition 2026\n"));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where a shape, a light, a group, a matrix or a material is there already, or another edition.
    pub fn edition(&mut self, edition: Edition) -> Result<(), SceneError> {
        if let Some(first) = self.scene.settings.edition {
            return first.agree(edition);
        }
        if let Some(made) = self.first_made() {
            return Err(SceneError::new(format!(
                "the edition must come first, but there is {made} already"
            ))
            .hint(format!("call edition({edition}) before anything is made")));
        }
        self.scene.settings.edition = Some(edition);
        Ok(())
    }

    /// Something that an edition says how to make, where there is any.
    fn first_made(&self) -> Option<&'static str> {
        let made = [
            (!self.group.objects.is_empty(), "a shape"),
            (!self.group.lights.is_empty(), "a light"),
            (self.scene.groups.len() > 1, "a group"),
            (!self.stack.is_empty(), "a matrix"),
            (*self.ctm.matrix() != DAffine3::IDENTITY, "a matrix"),
            (self.material != Material::default(), "a material"),
            (self.attenuation != Attenuation::default(), "an attenuation"),
            (!self.scene.textures.is_empty(), "a texture"),
            (!self.scene.meshes.is_empty(), "a mesh"),
        ];
        made.into_iter()
            .find_map(|(is_there, what)| is_there.then_some(what))
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
    ///
    /// ```
    /// use rtscript::{Builder, scene::{Crop, Encoding}};
    /// let mut b = Builder::new();
    /// b.size(640, 480)?;
    /// // Two mirrors deep, light without a curve, the upper left quarter.
    /// b.max_depth(2)?;
    /// b.encoding(Encoding::Raw);
    /// b.crop(Some(Crop::Fractions { left: 0.0, top: 0.0, right: 0.5, bottom: 0.5 }))?;
    /// let scene = b.finish().value;
    /// assert_eq!((scene.settings.max_depth, scene.settings.encoding), (2, Encoding::Raw));
    /// assert!(scene.settings.crop.is_some());
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
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

    /// What a reflected or refracted ray must count for in its pixel to be followed, above 0 and at
    /// most 1; [`Settings::MIN_WEIGHT`] where nothing is said. 1/255, as POV-Ray has it, saves most rays in glass and changes a
    /// picture by steps of its 8 bits.
    ///
    /// # Errors
    /// Where `weight` is not above 0 or above 1.
    ///
    /// ```
    /// let mut b = rtscript::Builder::new();
    /// b.min_weight(1.0 / 255.0)?;
    /// assert!(b.min_weight(2.0).is_err());
    /// assert_eq!(b.finish().value.settings.min_weight, 1.0 / 255.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn min_weight(&mut self, weight: f64) -> Result<(), SceneError> {
        if !(weight > 0.0 && weight <= 1.0) {
            let what = format!("a ray's least weight must be above 0 and at most 1, not {weight}");
            return Err(SceneError::new(what).hint(if weight == 0.0 {
                "1 / 255 is 0, a quotient of whole numbers: write minWeight(1.0 / 255); minWeight(1e-9) follows \
                 nearly every ray"
            } else {
                "minWeight(1.0 / 255) leaves out what an 8-bit picture hardly shows"
            }));
        }
        self.scene.settings.min_weight = weight;
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

    /// What rays that leave the scene see, in place of the background, and what lights the scene from all around; the
    /// last call counts, and `None` takes it away.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::{Environment, Sky}};
    /// let mut b = Builder::new();
    /// let sky = Sky::Gradient {
    ///     zenith: DVec3::new(0.2, 0.4, 0.9),
    ///     horizon: DVec3::ONE,
    ///     ground: DVec3::splat(0.2),
    /// };
    /// b.environment(Some(Environment::new(sky, DVec3::ONE, 0.0, Environment::POINTS)?))?;
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where its texture is not one of this scene, or no picture.
    pub fn environment(&mut self, environment: Option<Environment>) -> Result<(), SceneError> {
        if let Some(Sky::Image(id)) = environment.map(|e| *e.sky())
            && !matches!(
                self.texture_at(id).map(|texture| &**texture),
                Some(Texture::Image(_))
            )
        {
            return Err(SceneError::new(
                "an environment's texture must be a picture of this scene",
            ));
        }
        self.scene.settings.surroundings.environment = environment;
        Ok(())
    }

    /// Darkens the ambient term in corners; `None` leaves it alone, as at the start.
    pub fn ambient_occlusion(&mut self, occlusion: Option<Occlusion>) {
        self.scene.settings.surroundings.occlusion = occlusion;
    }

    /// A color that all things fade to; `None` for clear air, as at the start.
    pub fn fog(&mut self, fog: Option<Fog>) {
        self.scene.settings.surroundings.fog = fog;
    }

    /// Air that light is seen in; `None` for clear air, as at the start.
    pub fn haze(&mut self, haze: Option<Haze>) {
        self.scene.settings.surroundings.haze = haze;
    }

    /// Seeds every random choice of the renderer.
    pub fn seed(&mut self, seed: u64) {
        self.scene.settings.seed = seed;
    }

    /// The camera as it stands.
    pub(crate) fn camera_now(&self) -> &Camera {
        &self.scene.camera
    }

    /// The camera with its lens and its eyes; the last call counts.
    pub fn camera(&mut self, camera: Camera) {
        self.scene.camera = camera;
    }

    /// How the camera sees, from where, with the lens, the eyes and the shutter that it had before.
    ///
    /// # Errors
    /// Where it cannot have that lens.
    pub(crate) fn view(&mut self, camera: Camera) -> Result<(), SceneError> {
        let before = self.scene.camera;
        let camera = camera.with_lens(before.lens)?.with_stereo(before.stereo)?;
        self.scene.camera = camera.with_shutter(before.shutter)?;
        Ok(())
    }

    /// The camera's lens; `None` makes it a pinhole.
    ///
    /// # Errors
    /// As [`Camera::with_lens`].
    pub fn lens(&mut self, lens: Option<Lens>) -> Result<(), SceneError> {
        self.scene.camera = self.scene.camera.with_lens(lens)?;
        Ok(())
    }

    /// Two eyes instead of one; `None` is one.
    ///
    /// # Errors
    /// As [`Camera::with_stereo`].
    pub fn stereo(&mut self, stereo: Option<Stereo>) -> Result<(), SceneError> {
        self.scene.camera = self.scene.camera.with_stereo(stereo)?;
        Ok(())
    }

    /// Where the camera goes while light is gathered; `None` leaves it where it is.
    ///
    /// # Errors
    /// As [`Camera::with_motion`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::{Camera, Focus, Lens, Motion, Shutter, Stereo, StereoLayout}};
    /// let mut b = Builder::new();
    /// b.camera(Camera::new(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0)?);
    /// // It goes sideways while the shutter is open, for half of the way.
    /// b.camera_motion(Some(Motion { eye: DVec3::new(1.0, 0.0, 5.0), at: DVec3::X, up: DVec3::Y }))?;
    /// b.shutter(Shutter { open: 0.0, close: 0.5 })?;
    /// // What is at the target is sharp, and each eye has its own half of the picture.
    /// b.lens(Some(Lens::new(0.05)))?;
    /// b.stereo(Some(Stereo { separation: 0.065, layout: StereoLayout::SideBySide, convergence: None }))?;
    /// let camera = b.finish().value.camera;
    /// assert_eq!(camera.lens.map(|lens| lens.focus), Some(Focus::Target));
    /// assert!(camera.motion.is_some() && camera.stereo.is_some());
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn camera_motion(&mut self, motion: Option<Motion>) -> Result<(), SceneError> {
        self.scene.camera = self.scene.camera.with_motion(motion)?;
        Ok(())
    }

    /// The part of the camera's motion that is seen.
    ///
    /// # Errors
    /// As [`Camera::with_shutter`].
    pub fn shutter(&mut self, shutter: Shutter) -> Result<(), SceneError> {
        self.scene.camera = self.scene.camera.with_shutter(shutter)?;
        Ok(())
    }

    /// How the samples of a pixel are spread.
    pub fn sampling(&mut self, sampling: Sampling) {
        self.scene.settings.sampling = sampling;
    }

    /// What the surroundings of a pixel count for in it.
    ///
    /// # Errors
    /// As [`Filter::check`].
    pub fn filter(&mut self, filter: Filter) -> Result<(), SceneError> {
        filter.check()?;
        self.scene.settings.filter = filter;
        Ok(())
    }

    /// Samples where they are needed, up to those of [`Builder::samples`]; `None` gives all pixels the same.
    ///
    /// # Errors
    /// As [`Adaptive::check`], and where every pixel would have more samples than the limit `samples`.
    pub fn adaptive(&mut self, adaptive: Option<Adaptive>) -> Result<(), SceneError> {
        if let Some(adaptive) = &adaptive {
            adaptive.check()?;
            if adaptive.min > self.limits.samples {
                let what = format!("at least {} samples are too many", adaptive.min);
                let error = SceneError::limit(&what, "samples", self.limits.samples);
                return Err(error.hint("min is what every pixel has: 8 is usual"));
            }
        }
        self.scene.settings.adaptive = adaptive;
        Ok(())
    }

    /// Only this part of the picture is rendered; `None` is all of it.
    ///
    /// # Errors
    /// As [`Crop::check`].
    pub fn crop(&mut self, crop: Option<Crop>) -> Result<(), SceneError> {
        crop.map_or(Ok(()), |crop| crop.check())?;
        self.scene.settings.crop = crop;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn an_edition_comes_before_what_is_made() {
        type Call = fn(&mut Builder) -> Result<(), SceneError>;
        let calls: [(Call, &str); 5] = [
            (|b| b.sphere(DVec3::ZERO, 1.0), "a shape"),
            (|b| b.directional(DVec3::ONE, DVec3::ONE), "a light"),
            (|b| b.translate(DVec3::ONE), "a matrix"),
            (|b| b.push_transform(), "a matrix"),
            (
                |b| {
                    b.material_mut().ior = 1.3;
                    Ok(())
                },
                "a material",
            ),
        ];
        for (call, what) in calls {
            let mut b = Builder::new();
            call(&mut b).unwrap();
            let e = b.edition(Edition::E2026).unwrap_err();
            let message = format!("the edition must come first, but there is {what} already");
            assert_eq!(e.message, message);
            assert_eq!(b.settings().edition, None);
            let mut b = Builder::new();
            b.edition(Edition::E2026).unwrap();
            call(&mut b).unwrap();
            b.edition(Edition::E2026).unwrap();
        }
    }

    #[test]
    fn size_and_camera_may_come_before_it() {
        let mut b = Builder::new();
        b.size(64, 48).unwrap();
        b.camera(Camera::default());
        b.seed(7);
        assert_eq!(b.settings().edition(), Edition::LATEST);
        b.edition(Edition::E2026).unwrap();
        assert_eq!(b.settings().edition, Some(Edition::E2026));
    }
}
