//! What is around everything and between all things: environment, ambient occlusion, fog, haze.

use super::{
    SceneError, TextureId,
    literal::{Number, Vector},
};
use crate::{
    color::Color,
    math::{DVec3, brief, max_abs},
};

/// What a scene has one of and most have none of.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Environment, Fog, Haze, Occlusion, Sky, Surroundings}};
/// let mut b = Builder::new();
/// let day = Sky::Daylight { sun: DVec3::ONE, turbidity: 3.0, ground: DVec3::splat(0.3) };
/// b.environment(Some(Environment::new(day, DVec3::ONE, 0.0, 16)?))?;
/// b.fog(Some(Fog::new(DVec3::splat(0.7), 50.0, 0.0, Some(2.0))?));
/// b.ambient_occlusion(Some(Occlusion::new(1.0, 8)?));
/// b.haze(Some(Haze::new(0.01, DVec3::splat(0.9), 0.5, 4)?));
/// let around: &Surroundings = &b.settings().surroundings;
/// assert!(around.fog.is_some() && around.haze.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Seen by rays that leave the scene in place of the background, and shines.
    pub environment: Option<Environment>,
    /// What the ambient term is multiplied by.
    pub occlusion: Option<Occlusion>,
    /// A color that things fade to.
    pub fog: Option<Fog>,
    /// Air that light is seen in.
    pub haze: Option<Haze>,
}

impl Surroundings {
    /// What there is, each as the call that makes it; textures as `texture_N`.
    pub(super) fn texts(&self) -> [Option<String>; 4] {
        let vector = |v: DVec3| Vector(v).to_string();
        let environment = self.environment.map(|e| {
            let options = format!(
                "strength: {}, rotation: {}, n: {}",
                vector(e.strength),
                Number(e.rotation),
                e.n
            );
            match e.sky {
                Sky::Gradient {
                    zenith,
                    horizon,
                    ground,
                } => {
                    let [zenith, horizon, ground] = [zenith, horizon, ground].map(vector);
                    format!("sky(#{{ zenith: {zenith}, horizon: {horizon}, ground: {ground}, {options} }})")
                }
                Sky::Image(id) => format!("environment(texture_{}, #{{ {options} }})", id.0),
                Sky::Daylight {
                    sun,
                    turbidity,
                    ground,
                } => format!(
                    "daylight({}, {}, #{{ sun: false, ground: {}, {options} }})",
                    vector(sun),
                    Number(turbidity),
                    vector(ground)
                ),
            }
        });
        let occlusion = self
            .occlusion
            .map(|o| format!("ambientOcclusion({}, {})", Number(o.distance), o.n));
        let fog = self.fog.map(|fog| {
            let call = format!("fog({}, {}", vector(fog.color), Number(fog.distance));
            match fog.height {
                None => format!("{call})"),
                Some(height) => format!(
                    "{call}, #{{ base: {}, height: {} }})",
                    Number(fog.base),
                    Number(height)
                ),
            }
        });
        let haze = self.haze.map(|haze| {
            format!(
                "haze(#{{ density: {}, albedo: {}, forward: {}, n: {} }})",
                Number(haze.density),
                vector(haze.albedo),
                Number(haze.forward),
                haze.n
            )
        });
        [environment, occlusion, fog, haze]
    }

    /// As a dump has them.
    pub(super) fn lines(&self) -> impl Iterator<Item = String> + use<> {
        self.texts().into_iter().flatten()
    }

    /// The texture of the environment.
    pub(crate) fn texture(&self) -> Option<TextureId> {
        match self.environment?.sky {
            Sky::Image(id) => Some(id),
            _ => None,
        }
    }
}

/// What an environment looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sky {
    /// From the horizon's color up to the zenith's, evenly by the sine of the height; below the horizon the ground's.
    Gradient {
        /// Straight up.
        zenith: Color,
        /// Above the horizon.
        horizon: Color,
        /// Below it.
        ground: Color,
    },
    /// A picture of all directions (equirectangular): its middle is -Z, its right half +X, its upper edge +Y.
    Image(TextureId),
    /// A clear sky (Preetham, Shirley and Smits, "A practical analytic model for daylight", 1999), without the sun's
    /// disk. 1 is 20 kcd / m^2: a white floor under a high sun has about 1 then.
    Daylight {
        /// Vector to the sun, not below the horizon; any length but 0.
        sun: DVec3,
        /// Haziness of the air: 2 is very clear, 10 is hazy.
        turbidity: f64,
        /// Below the horizon.
        ground: Color,
    },
}

/// Light from all around. Seen from a diffuse surface in the open, an environment that is 1 everywhere gives 1.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Environment, Sky}};
/// let sky = Sky::Daylight { sun: DVec3::new(1.0, 1.0, 0.0), turbidity: 3.0, ground: DVec3::splat(0.2) };
/// // Half as bright, turned by a quarter, 8 x 8 directions from each point that it lights.
/// let evening = Environment::new(sky, DVec3::splat(0.5), 90.0, 8)?;
/// assert!(matches!(evening.sky(), Sky::Daylight { .. }));
/// assert_eq!((evening.strength(), evening.rotation(), evening.n()), (DVec3::splat(0.5), 90.0, 8));
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    pub(crate) sky: Sky,
    pub(crate) strength: Color,
    pub(crate) rotation: f64,
    pub(crate) n: u32,
}

impl Environment {
    /// Points along each edge of the grid where nothing else is said.
    pub const POINTS: u32 = 4;

    /// A sky times `strength`, turned by `rotation` degrees around Y, counter-clockwise seen from above; surfaces ask it
    /// for light in `n` x `n` directions, more where it is bright. With `n` 0 it is only seen.
    ///
    /// # Errors
    /// Where a number is not finite, the sun is below the horizon, the turbidity is not in 1.7..=10, the strength is
    /// negative, or `n` is above 256.
    pub fn new(sky: Sky, strength: Color, rotation: f64, n: u32) -> Result<Self, SceneError> {
        match sky {
            Sky::Gradient {
                zenith,
                horizon,
                ground,
            } => {
                for (what, color) in [("zenith", zenith), ("horizon", horizon), ("ground", ground)] {
                    not_negative(&format!("the sky's {what}"), color)?;
                }
            }
            Sky::Image(_) => {}
            Sky::Daylight {
                sun,
                turbidity,
                ground,
            } => {
                let length = sun.length();
                if !(length > 0.0 && length.is_finite() && sun.y >= 0.0) {
                    return Err(SceneError::new(format!(
                        "the sun must stand above the horizon or on it, not in the direction {}",
                        brief(sun)
                    ))
                    .hint("the direction points towards the sun, Y being up"));
                }
                if !(1.7..=10.0).contains(&turbidity) {
                    return Err(SceneError::new(format!(
                        "the turbidity must be from 1.7 to 10, not {turbidity}"
                    ))
                    .hint("2 is a very clear day, 3 a clear one, 6 a hazy one"));
                }
                not_negative("the ground", ground)?;
            }
        }
        not_negative("the environment's strength", strength)?;
        if !(rotation.is_finite() && rotation.abs() <= 1e6) {
            return Err(SceneError::new(format!(
                "the environment's rotation must be a number of degrees within 1e6, not {rotation}"
            )));
        }
        grid("an environment", n, 0)?;
        Ok(Self {
            sky,
            strength,
            rotation,
            n,
        })
    }

    /// What it looks like.
    #[must_use]
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// What that is multiplied by.
    #[must_use]
    pub fn strength(&self) -> Color {
        self.strength
    }

    /// Degrees around Y.
    #[must_use]
    pub fn rotation(&self) -> f64 {
        self.rotation
    }

    /// Points along each edge of the grid; 0 where it does not shine.
    #[must_use]
    pub fn n(&self) -> u32 {
        self.n
    }
}

/// How much of the ambient term is left in corners: the share of the half sphere above a point, weighted by the cosine,
/// in which nothing is nearer than `distance` (Zhukov, Iones and Kronin, "An ambient light illumination model", 1998).
///
/// ```
/// use rtscript::scene::Occlusion;
/// // Corners darken within half a unit of a wall.
/// assert_eq!(Occlusion::new(0.5, 4)?.distance(), 0.5);
/// assert!(Occlusion::new(0.0, 4).is_err());
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occlusion {
    pub(crate) distance: f64,
    pub(crate) n: u32,
}

impl Occlusion {
    /// Looks up to `distance` world units far in `n` x `n` directions.
    ///
    /// # Errors
    /// Where the distance is not greater than 0, or `n` is not in 1..=256.
    pub fn new(distance: f64, n: u32) -> Result<Self, SceneError> {
        if !(distance > 0.0 && distance <= 1e15) {
            return Err(SceneError::new(format!(
                "the distance of ambient occlusion must be greater than 0 and at most 1e15, not {distance}"
            )));
        }
        grid("ambient occlusion", n, 1)?;
        Ok(Self { distance, n })
    }

    /// World units.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Directions along each edge of the grid.
    #[must_use]
    pub fn n(&self) -> u32 {
        self.n
    }
}

/// Fog that has a color of its own, whatever lights there are: of what lies at a distance d there is seen exp(-d /
/// `distance`), and the rest is fog. Where it has a height, its density is that at the height `base` times exp(-(y -
/// base) / height).
///
/// ```
/// use rtscript::{DVec3, scene::Fog};
/// // Mist over a lake at y = -1: 20 units of it hide all but 1 / e, a unit higher it is 1 / e as thick.
/// let mist = Fog::new(DVec3::splat(0.8), 20.0, -1.0, Some(1.0))?;
/// assert_eq!((mist.distance(), mist.base(), mist.height()), (20.0, -1.0, Some(1.0)));
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    pub(crate) color: Color,
    pub(crate) distance: f64,
    pub(crate) base: f64,
    pub(crate) height: Option<f64>,
}

impl Fog {
    /// Fog through which 1 / e is seen at `distance` world units; with a height, at y = `base`.
    ///
    /// # Errors
    /// Where a number is not finite, or the distance or the height is not greater than 0.
    pub fn new(color: Color, distance: f64, base: f64, height: Option<f64>) -> Result<Self, SceneError> {
        not_negative("the fog's color", color)?;
        for (what, x) in [("distance", Some(distance)), ("height", height)] {
            if let Some(x) = x.filter(|x| !(*x > 0.0 && *x <= 1e15)) {
                return Err(SceneError::new(format!(
                    "the fog's {what} must be greater than 0 and at most 1e15, not {x}"
                )));
            }
        }
        if !(base.abs() <= 1e15) {
            return Err(SceneError::new(format!(
                "the fog's base must be a number within 1e15, not {base}"
            )));
        }
        Ok(Self {
            color,
            distance,
            // Without a height it is nowhere special.
            base: if height.is_some() { base } else { 0.0 },
            height,
        })
    }

    /// What everything fades to.
    #[must_use]
    pub fn color(&self) -> Color {
        self.color
    }

    /// World units until 1 / e is left.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The y where that is so.
    #[must_use]
    pub fn base(&self) -> f64 {
        self.base
    }

    /// World units upwards until the fog is 1 / e as dense; `None` where it is as dense everywhere.
    #[must_use]
    pub fn height(&self) -> Option<f64> {
        self.height
    }
}

/// Air, even everywhere, that takes light away and scatters it once towards the eye: beams and halos of the lights.
///
/// ```
/// use rtscript::{DVec3, scene::Haze};
/// // Smoke that swallows half of what it takes away, and scatters the rest mostly forwards.
/// let smoke = Haze::new(0.1, DVec3::splat(0.5), 0.6, 4)?;
/// assert_eq!((smoke.density(), smoke.albedo(), smoke.forward()), (0.1, DVec3::splat(0.5), 0.6));
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    pub(crate) density: f64,
    pub(crate) albedo: Color,
    pub(crate) forward: f64,
    pub(crate) n: u32,
}

impl Haze {
    /// Haze that leaves exp(-`density` d) of light after d world units, of which it scatters the share `albedo`, by the
    /// function of Henyey and Greenstein (1941) with mean cosine `forward`: 0 is to all sides alike, towards 1 ahead.
    /// Each ray asks for light at `n` places.
    ///
    /// # Errors
    /// Where the density is negative or above 1e6, a component of the albedo is not in 0..=1, `forward` is not within
    /// 0.99, or `n` is not in 1..=1024.
    pub fn new(density: f64, albedo: Color, forward: f64, n: u32) -> Result<Self, SceneError> {
        if !(0.0..=1e6).contains(&density) {
            return Err(SceneError::new(format!(
                "the haze's density must be from 0 to 1e6 per world unit, not {density}"
            )));
        }
        if !(albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0) {
            return Err(SceneError::new(format!(
                "the haze's albedo must be a color from 0 to 1, not {}",
                brief(albedo)
            )));
        }
        if !(forward.abs() <= 0.99) {
            return Err(SceneError::new(format!(
                "the haze's forward must be from -0.99 to 0.99, not {forward}"
            )));
        }
        if !(1..=1024).contains(&n) {
            return Err(SceneError::new(format!(
                "haze asks for light at 1 to 1024 places along a ray, not {n}"
            )));
        }
        Ok(Self {
            density,
            albedo,
            forward,
            n,
        })
    }

    /// Share that is lost for each world unit, for short ways.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Share of what is lost that is scattered.
    #[must_use]
    pub fn albedo(&self) -> Color {
        self.albedo
    }

    /// Mean cosine of the angle by which light is scattered.
    #[must_use]
    pub fn forward(&self) -> f64 {
        self.forward
    }

    /// Places along a ray.
    #[must_use]
    pub fn n(&self) -> u32 {
        self.n
    }
}

fn not_negative(what: &str, color: Color) -> Result<(), SceneError> {
    if color.is_finite() && color.min_element() >= 0.0 && max_abs(color) <= 1e15 {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "{what} must be a color without negative parts, not {}",
        brief(color)
    )))
}

fn grid(what: &str, n: u32, least: u32) -> Result<(), SceneError> {
    if (least..=256).contains(&n) {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "{what} has a grid of {least} to 256 directions along each edge, not {n}"
    )))
}
