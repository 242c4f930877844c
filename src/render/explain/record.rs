//! The observer that writes everything down.

use super::{
    BranchOutcome, ExplainedAir, ExplainedBranch, ExplainedHit, ExplainedRay, ExplainedTexture, LightSample,
    LightTerm, Obstacle, RayKind,
};
use crate::{
    color::Color,
    math::Ray,
    render::{
        around::Air,
        integrator::split,
        lighting::{Lit, SHORT},
        observe::{Arrived, AtTheEnd, Observer},
        world::{Hit, SurfacePoint, World},
    },
    scene::Term,
};

/// Writes down the rays of one sample.
pub(super) struct Recorder<'w, 's> {
    world: &'w World<'s>,
    pub(super) rays: Vec<ExplainedRay<'s>>,
    /// Rays that will be followed: what they are, the ray they go on from and the branch there. The last is next, as
    /// in the integrator.
    waiting: Vec<(RayKind, usize, usize)>,
}

impl<'w, 's> Recorder<'w, 's> {
    pub(super) fn new(world: &'w World<'s>) -> Self {
        Self {
            world,
            rays: Vec::new(),
            waiting: Vec::new(),
        }
    }

    fn hit(&mut self) -> Option<&mut ExplainedHit<'s>> {
        self.rays.last_mut()?.hit.as_deref_mut()
    }

    fn add_branch(&mut self, branch: ExplainedBranch) -> Option<usize> {
        let hit = self.hit()?;
        hit.branches.push(branch);
        Some(hit.branches.len() - 1)
    }
}

/// The textures of the terms of what is met.
fn textures(world: &World<'_>, at: &SurfacePoint<'_>) -> Vec<ExplainedTexture> {
    let of = at.material.textures().into_iter();
    of.map(|(term, texture)| ExplainedTexture {
        term,
        texture,
        value: world.term(&Term::texture(texture), at),
    })
    .collect()
}

impl Observer for Recorder<'_, '_> {
    fn ray(&mut self, ray: &Ray, weight: Color, depth: u32) {
        let index = self.rays.len();
        let from = self.waiting.pop();
        if let Some((_, parent, branch)) = from
            && let Some(hit) = self.rays.get_mut(parent).and_then(|ray| ray.hit.as_mut())
            && let Some(branch) = hit.branches.get_mut(branch)
        {
            branch.outcome = BranchOutcome::Followed(index);
        }
        self.rays.push(ExplainedRay {
            kind: from.map_or(RayKind::Camera, |(kind, ..)| kind),
            parent: from.map(|(_, parent, _)| parent),
            depth,
            origin: ray.origin,
            direction: ray.dir,
            weight,
            added: Color::ZERO,
            air: None,
            beyond: Color::ZERO,
            hit: None,
        });
    }

    fn dimmed(&mut self, weight: Color) {
        if let Some(ray) = self.rays.last_mut() {
            ray.weight = weight;
        }
    }

    fn air(&mut self, air: &Air) {
        if let Some(ray) = self.rays.last_mut() {
            ray.air = Some(ExplainedAir {
                passed: air.passed,
                scattered: air.scattered,
            });
        }
    }

    fn background(&mut self, seen: Color, added: Color) {
        if let Some(ray) = self.rays.last_mut() {
            ray.beyond = seen;
            ray.added = added;
        }
    }

    fn surface(&mut self, hit: &Hit, ray: &Ray, at: &SurfacePoint<'_>) {
        let world = self.world;
        let Some(recorded) = self.rays.last_mut() else {
            return;
        };
        recorded.hit = Some(Box::new(ExplainedHit {
            // What is seen in place of something transparent that touches it counts from elsewhere.
            t: (at.position - ray.origin).length(),
            position: at.position,
            normal: at.shading_normal,
            geometric_normal: at.geometric_normal,
            from_front: at.from_front,
            number: hit.number,
            objects: world.objects_of(hit.number),
            material: world.material_id(hit.number),
            textures: textures(world, at),
            ambient: Color::ZERO,
            emission: Color::ZERO,
            direct: Color::ZERO,
            lights: Vec::new(),
            branches: Vec::new(),
        }));
    }

    fn light(&mut self, index: usize) {
        if let Some(hit) = self.hit() {
            hit.lights.push(LightTerm {
                light: index,
                samples: Vec::new(),
            });
        }
    }

    fn arrived(&mut self, lit: &Lit<'_>, light: &Arrived<'_>) {
        let world = self.world;
        let mut obstacles = Vec::new();
        if light.visible != Color::ONE {
            world.steps(*light.probe, light.reach, |number, share| {
                let objects = world.objects_of(number);
                obstacles.push(Obstacle { objects, share });
            });
        }
        let direction = light.probe.ray.dir;
        let [diffuse, specular] = lit
            .respond_in_parts(direction)
            .map(|response| light.visible * light.arriving * response);
        let sample = LightSample {
            direction,
            distance: light.reach / SHORT,
            arriving: light.arriving,
            visible: light.visible,
            diffuse,
            specular,
            added: light.added,
            obstacles,
        };
        if let Some(term) = self.hit().and_then(|hit| hit.lights.last_mut()) {
            term.samples.push(sample);
        }
    }

    fn shaded(&mut self, ambient: Color, emission: Color, direct: Color, added: Color) {
        if let Some(ray) = self.rays.last_mut() {
            ray.added = added;
        }
        if let Some(hit) = self.hit() {
            (hit.ambient, hit.emission, hit.direct) = (ambient, emission, direct);
        }
    }

    fn branch(&mut self, kind: RayKind, share: Color, weight: Color, followed: bool) {
        if share == Color::ZERO {
            return;
        }
        let branch = self.add_branch(ExplainedBranch {
            kind,
            share,
            weight,
            outcome: BranchOutcome::TooWeak,
        });
        if let Some(branch) = branch.filter(|_| followed) {
            self.waiting.push((kind, self.rays.len() - 1, branch));
        }
    }

    fn total_reflection(&mut self, share: Color) {
        let weight = self.rays.last().map_or(Color::ZERO, |ray| match ray.air {
            None => ray.weight * share,
            Some(air) => ray.weight * air.passed * share,
        });
        self.add_branch(ExplainedBranch {
            kind: RayKind::Refracted,
            share,
            weight,
            outcome: BranchOutcome::TotalReflection,
        });
    }

    fn deepest(&mut self, world: &World<'_>, at: &SurfacePoint<'_>, ray: &Ray, weight: Color) {
        split(world, at, ray, weight, &mut AtTheEnd(self));
    }

    fn ended(&mut self, kind: RayKind, share: Color, weight: Color, is_strong: bool) {
        self.branch(kind, share, weight, false);
        if is_strong
            && share != Color::ZERO
            && let Some(branch) = self.hit().and_then(|hit| hit.branches.last_mut())
        {
            branch.outcome = BranchOutcome::TooDeep;
        }
    }
}
