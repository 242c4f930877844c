//! Why a pixel has its value: the tree of rays behind it, with every term that was added up.

mod record;
#[cfg(test)]
mod tests;

pub(crate) use super::shots::Mean;
use super::{
    adaptive::Pixels,
    integrator::{self, Counts, Sight, Stack},
    interrupt::Interrupt,
    observe::RayKind,
    shots::Shots,
    world::{Moments, World},
};
use crate::{
    color::Color,
    diag::{Diagnostic, Error, ErrorKind},
    host::Host,
    math::DVec3,
    scene::{MaterialId, Object, TextureId},
};
use record::Recorder;

/// Why a pixel has its value.
///
/// ```
/// use rtscript::{Builder, DVec3, NoHost, render::World};
/// use rtscript::render::explain::{BranchOutcome, ExplainedAir, ExplainedBranch, ExplainedHit, ExplainedRay, ExplainedSample, ExplainedTexture, Explanation, LightSample, LightTerm, Obstacle};
/// let mut b = Builder::new();
/// b.size(9, 9)?;
/// b.point(DVec3::Z * 5.0, DVec3::ONE)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let world = World::compile(&scene)?;
/// let why: Explanation = world.explain(4, 4, &NoHost)?;
/// let sample: &ExplainedSample = &why.samples[0];
/// let ray: &ExplainedRay = &sample.rays[0];
/// let hit: &ExplainedHit = ray.hit.as_ref().expect("the ball");
/// let lights: &[LightTerm] = &hit.lights;
/// let textures: &[ExplainedTexture] = &hit.textures;
/// let mirrored: &[ExplainedBranch] = &hit.branches;
/// let air: Option<&ExplainedAir> = ray.air.as_ref();
/// let falls_in: Vec<&LightSample> = lights.iter().flat_map(|light| &light.samples).collect();
/// let in_the_way: Vec<&Obstacle> = falls_in.iter().flat_map(|light| &light.obstacles).collect();
/// assert!(air.is_none() && in_the_way.is_empty() && textures.is_empty());
/// let ended = mirrored.iter().filter(|branch| matches!(branch.outcome, BranchOutcome::TooDeep));
/// println!("{} rays had no depth left", ended.count());
/// println!("{} lights and {} rays that go on", lights.len(), mirrored.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Explanation<'s> {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Scene-linear value: the mean of the samples, to the bit what a render gives.
    pub value: Color,
    /// Its camera rays in order, with what follows from them.
    pub samples: Vec<ExplainedSample<'s>>,
}

/// One camera ray and all that follows from it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExplainedSample<'s> {
    /// Scene-linear value; black where it was no finite number.
    pub value: Color,
    /// What it counts for in the mean of the pixel, each channel against the sum of all weights: 1, but for the channels
    /// that an eye of an anaglyph does not show.
    pub weight: Color,
    /// The moment that it sees, from 0 to 1, where anything moves while the shutter is open, the camera or a thing.
    pub time: Option<f64>,
    /// The camera ray first, then each ray followed at once by the mirrored ray that leaves where it ends, with all
    /// that follows from that, then by the refracted one.
    pub rays: Vec<ExplainedRay<'s>>,
}

/// One ray and what it met.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExplainedRay<'s> {
    /// Where it comes from.
    pub kind: RayKind,
    /// Index among the sample's rays of the ray that this one goes on from; `None` for the camera's.
    pub parent: Option<usize>,
    /// Surfaces between the camera and its start.
    pub depth: u32,
    /// Its start, in world space.
    pub origin: DVec3,
    /// Its direction, a unit vector.
    pub direction: DVec3,
    /// Share of what it sees that reaches the camera.
    pub weight: Color,
    /// What this ray adds to the sample's value: `weight` times the background, or times what its hit sends out.
    pub added: Color,
    /// Fog and haze between its start and what it sees, where there are any.
    pub air: Option<ExplainedAir>,
    /// What it sees where it meets nothing: the background, or the environment in its direction.
    pub beyond: Color,
    /// What it met; `None` is the background.
    pub hit: Option<Box<ExplainedHit<'s>>>,
}

/// What air does to what a ray sees.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExplainedAir {
    /// Share of what is seen that passes it.
    pub passed: Color,
    /// What it adds.
    pub scattered: Color,
}

/// What a ray met, and what is to be seen there.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExplainedHit<'s> {
    /// Distance along the ray.
    pub t: f64,
    /// The point, in world space.
    pub position: DVec3,
    /// Unit normal that is used for shading, turned to the side that the ray came from.
    pub normal: DVec3,
    /// Unit normal of the true surface, turned likewise.
    pub geometric_normal: DVec3,
    /// Whether the ray came from the front: the outside of a solid.
    pub from_front: bool,
    /// Number of the primitive, unique over all instances.
    pub number: u64,
    /// The objects that lead to it: instances outermost first, last what was hit.
    pub objects: Vec<&'s Object>,
    /// How it looks; `None` where it cannot be told.
    pub material: Option<MaterialId>,
    /// The textures of its terms and what they are here.
    pub textures: Vec<ExplainedTexture>,
    /// Ka.
    pub ambient: Color,
    /// Ke.
    pub emission: Color,
    /// Sum of what the lights add.
    pub direct: Color,
    /// What each light adds; none where the material answers no light.
    pub lights: Vec<LightTerm<'s>>,
    /// The rays that could go on: refracted, mirrored.
    pub branches: Vec<ExplainedBranch>,
}

/// A texture of a material's term where a ray met it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExplainedTexture {
    /// The term, as `material(#{ })` calls it: `diffuse`, `roughness`. One that takes two of them, such as `clearCoat`, may come
    /// twice.
    pub term: &'static str,
    /// Which texture.
    pub texture: TextureId,
    /// What it is at the point. Where the term has a color beside the texture, as in `texture * 0.5`, that is left out.
    pub value: Color,
}

impl ExplainedHit<'_> {
    /// What the point sends out by itself: Ka + Ke and what the lights add.
    #[must_use]
    pub fn local(&self) -> Color {
        let mut direct = Color::ZERO;
        for sample in self.lights.iter().flat_map(|light| &light.samples) {
            direct += sample.added;
        }
        self.ambient + self.emission + direct
    }
}

/// What a light adds at a point.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LightTerm<'s> {
    /// Index among the lights of the root group; their number stands for the environment.
    pub light: usize,
    /// Points of the light that shadow rays went to. Those are missing to which the surface answers nothing, because
    /// they lie behind it.
    pub samples: Vec<LightSample<'s>>,
}

impl LightTerm<'_> {
    /// Sum of what its points add.
    #[must_use]
    pub fn added(&self) -> Color {
        self.samples.iter().fold(Color::ZERO, |sum, s| sum + s.added)
    }
}

/// What one point of a light adds.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LightSample<'s> {
    /// Unit vector from the surface to it.
    pub direction: DVec3,
    /// Distance to it; infinite for a directional light.
    pub distance: f64,
    /// Light that arrives where nothing is in between.
    pub arriving: Color,
    /// Share of that which comes through.
    pub visible: Color,
    /// What the diffuse term makes of what comes through.
    pub diffuse: Color,
    /// What the highlight makes of it.
    pub specular: Color,
    /// What it adds: the sum of both, but for rounding.
    pub added: Color,
    /// What is in between, nearest first, up to the first opaque thing.
    pub obstacles: Vec<Obstacle<'s>>,
}

/// Something between a point and a light.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle<'s> {
    /// The objects that lead to it, outermost first.
    pub objects: Vec<&'s Object>,
    /// Share of light that it lets through: its Kt. 0 for what is opaque.
    pub share: Color,
}

/// A ray that could go on from a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExplainedBranch {
    /// Reflected or refracted.
    pub kind: RayKind,
    /// Kr or Kt at the point; a mirror's holds Kt at total internal reflection.
    pub share: Color,
    /// Share of what it would see that would reach the camera.
    pub weight: Color,
    /// What became of it.
    pub outcome: BranchOutcome,
}

/// What became of a ray that could go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchOutcome {
    /// It is the ray with this index.
    Followed(usize),
    /// Its weight is below the scene's `minWeight` in every channel.
    TooWeak,
    /// The path is as deep as the scene's `maxDepth` allows.
    TooDeep,
    /// Nothing is refracted at this angle: total internal reflection. Its share is in the mirror's.
    TotalReflection,
}

impl ExplainedSample<'_> {
    /// The value, added up from every light's terms on: to the bit [`ExplainedSample::value`], unless that is black
    /// because it was no finite number.
    #[must_use]
    pub fn sum(&self) -> Color {
        let mut sum = Color::ZERO;
        for ray in &self.rays {
            let sent = ray.hit.as_ref().map_or(ray.beyond, |hit| hit.local());
            sum += match ray.air {
                None => ray.weight * sent,
                Some(air) => ray.weight * (air.passed * sent + air.scattered),
            };
        }
        sum
    }
}

impl<'s> World<'s> {
    /// Why the pixel in column `x`, row `y` from the top has its value. The whole trees of rays of all its samples are
    /// in it; [`World::explain_sample`] takes one after the other.
    ///
    /// # Errors
    /// `Script` outside the picture, `Cancelled` where the host asks to stop.
    pub fn explain(&self, x: u32, y: u32, host: &dyn Host) -> Result<Explanation<'s>, Error> {
        let count = self.samples_at(x, y, host)?;
        let mut samples = Vec::new();
        let mut mean = Mean::default();
        for index in 0..count {
            let sample = self.explain_sample(x, y, index, host)?;
            mean.add(sample.value, sample.weight);
            samples.push(sample);
        }
        Ok(Explanation {
            x,
            y,
            value: mean.value(),
            samples,
        })
    }

    /// How many camera rays the pixel in column `x`, row `y` has: its samples, times the eyes of an anaglyph.
    ///
    /// # Errors
    /// As [`World::explain`].
    pub fn samples_at(&self, x: u32, y: u32, host: &dyn Host) -> Result<u32, Error> {
        let s = &self.scene.settings;
        let region = s.region();
        if x >= region.width || y >= region.height {
            return Err(Diagnostic::error(
                ErrorKind::Script,
                format!(
                    "there is no pixel {x},{y} in a picture of {} x {}: they count from 0,0 at the top left",
                    region.width, region.height
                ),
            )
            .into());
        }
        let shots = Shots::into_world(self, s);
        let Some(adaptive) = s.adaptive else {
            return Ok(shots.count());
        };
        let pixels = Pixels {
            world: self,
            shots: &shots,
            adaptive,
            interrupt: &Interrupt::new(host),
        };
        Ok(pixels.alone((x, y)).samples * shots.eyes())
    }

    /// As [`World::explain`] for the pixel's sample `index` alone, counted from 0.
    ///
    /// # Errors
    /// As [`World::explain`]; `Script` where there is no such sample.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, NoHost, Term, render::World};
    /// let mut b = Builder::new();
    /// b.size(9, 9)?;
    /// b.samples(4)?;
    /// b.material_mut().diffuse = Term::number(0.8);
    /// b.point(DVec3::Z * 5.0, DVec3::ONE)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// let world = World::compile(&scene)?;
    /// assert_eq!(world.samples_at(4, 4, &NoHost)?, 4);
    /// // The last of the pixel's camera rays, by itself.
    /// let last = world.explain_sample(4, 4, 3, &NoHost)?;
    /// let hit = last.rays[0].hit.as_ref().expect("the ball");
    /// // All that is seen is what the point sends out by itself: nothing is mirrored.
    /// assert_eq!(last.value, hit.local());
    /// let lit = hit.lights.iter().fold(DVec3::ZERO, |sum, light| sum + light.added());
    /// assert!(lit.x > 0.0 && lit.x <= hit.local().x);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn explain_sample(
        &self,
        x: u32,
        y: u32,
        index: u32,
        host: &dyn Host,
    ) -> Result<ExplainedSample<'s>, Error> {
        let s = &self.scene.settings;
        let shots = Shots::into_world(self, s);
        let count = self.samples_at(x, y, host)?;
        if index >= count {
            return Err(Diagnostic::error(
                ErrorKind::Script,
                format!("there is no sample {index}: a pixel has {count} here, counted from 0"),
            )
            .into());
        }
        let shot = shots.shot((x, y), index);
        let time = shots.moves().then_some(shot.time);
        let interrupt = Interrupt::new(host);
        let Some(probe) = shot.probe else {
            return Ok(ExplainedSample {
                value: Color::ZERO,
                weight: shot.weight,
                time,
                rays: Vec::new(),
            });
        };
        let mut moments = Moments::new(self);
        let world = moments.at(&shot);
        let mut recorder = Recorder::new(world);
        let first = Sight::new(world, &probe);
        let (mut stack, mut counts) = (Stack::default(), Counts::default());
        let value = integrator::radiance(
            world,
            first,
            shot.sampler,
            &interrupt,
            &mut stack,
            &mut counts,
            &mut recorder,
        );
        if interrupt.is_stopped() {
            return Err(Diagnostic::error(ErrorKind::Cancelled, "the explanation was stopped").into());
        }
        Ok(ExplainedSample {
            value,
            weight: shot.weight,
            time,
            rays: recorder.rays,
        })
    }
}
