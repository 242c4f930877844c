//! Kinds of lights that are rarer than points, directions and areas: kept away from the loop over those.

use super::{
    Lit, Together,
    around::stratum,
    lamp::{Lamp, in_cone},
    surface,
};
use crate::{
    color::Color,
    math::{self, DVec2, DVec3},
    render::{integrator::Counts, observe::Observer, path::Path, world::World},
    scene::{GroupId, LightKind, Projector, Scene},
};

/// Light on its way from a point of a light, if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sent {
    /// Unit vector to where it comes from.
    pub(super) towards: DVec3,
    /// How far away that is; may be infinite.
    pub(super) distance: f64,
    /// How much arrives.
    pub(super) arriving: Color,
}

/// What the point `at` in [0, 1)^2 of the light of number `index` sends to `p` were it the whole light; `None` where
/// that is nothing.
pub(super) fn sent(world: &World<'_>, index: usize, p: DVec3, at: (f64, f64)) -> Option<Sent> {
    let light = world.scene.root().lights.get(index)?;
    let lamp = world.lamps.get(index).unwrap_or(&Lamp::Plain);
    let from = |position: DVec3, share: Color, attenuation: &crate::scene::Attenuation| {
        let offset = position - p;
        let distance = offset.length();
        (share != Color::ZERO).then(|| Sent {
            towards: offset / distance,
            distance,
            arriving: light.color * attenuation.at(distance) * share,
        })
    };
    match &light.kind {
        LightKind::Spot(spot) => {
            let share = spot.share(p - spot.position());
            from(spot.position(), Color::splat(share), spot.attenuation())
        }
        LightKind::Projector(projector) => {
            let share = projected(world.scene, projector, lamp, p)?;
            from(projector.position(), share, projector.attenuation())
        }
        LightKind::Surface(light_surface) => surface::sent((light_surface, lamp, light.color), p, at),
        LightKind::Sun(sun) => {
            let half = math::sin_cos_degrees(0.5 * sun.angle()).0;
            Some(Sent {
                towards: in_cone(sun.direction(), 2.0 * half * half, at.0, at.1),
                distance: f64::INFINITY,
                arriving: light.color,
            })
        }
        LightKind::Point {
            position,
            attenuation,
        } => from(*position, Color::ONE, attenuation),
        LightKind::Directional { direction } => Some(Sent {
            towards: *direction,
            distance: f64::INFINITY,
            arriving: light.color,
        }),
        LightKind::Area {
            corner,
            edge1,
            edge2,
            attenuation,
            ..
        } => from(*corner + *edge1 * at.0 + *edge2 * at.1, Color::ONE, attenuation),
    }
}

/// Whether any of some points of the light of number `index` shines at `p`, whatever stands in between: `p` is in the
/// cone of a spot, in the picture of a projector, on the front of a surface.
pub(in crate::render) fn shines_at(world: &World<'_>, index: usize, p: DVec3) -> bool {
    const ALONG: u32 = 4;
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(ALONG);
    (0..ALONG * ALONG).any(|i| sent(world, index, p, (middle(i % ALONG), middle(i / ALONG))).is_some())
}

/// The color of the picture on its way to `p`; `None` beyond its edges and behind the projector.
fn projected(scene: &Scene, projector: &Projector, lamp: &Lamp, p: DVec3) -> Option<Color> {
    let Lamp::Projector([right, up, ahead], extent) = lamp else {
        return None;
    };
    let texture = scene.textures.get(projector.image().index())?;
    let offset = p - projector.position();
    let depth = offset.dot(*ahead);
    if !(depth > 0.0) {
        return None;
    }
    let aspect = match &**texture {
        crate::scene::Texture::Image(image) => f64::from(image.width) / f64::from(image.height),
        _ => 1.0,
    };
    let y = offset.dot(*up) / (depth * extent);
    let x = offset.dot(*right) / (depth * extent * aspect);
    let is_within = x.abs() < 1.0 && y.abs() < 1.0;
    is_within.then(|| texture.color(DVec2::new(0.5 + 0.5 * x, 0.5 + 0.5 * y), DVec3::new(x, y, 0.0)))
}

impl Lit<'_> {
    /// The groups that lead to what is lit.
    #[cold]
    #[inline(never)]
    pub(super) fn groups(&self) -> Vec<GroupId> {
        let places = self.world.places_of(self.number).into_iter();
        places.map(|(group, _)| group).collect()
    }

    /// Adds what a light of a rarer kind sends to `sum`.
    #[cold]
    #[inline(never)]
    pub(super) fn add_other<O: Observer>(
        &self,
        sum: &mut Color,
        index: usize,
        path: &Path<'_>,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let Some(light) = self.world.scene.root().lights.get(index) else {
            return;
        };
        let points = light.kind.points();
        let has_a_size = matches!(
            light.kind,
            LightKind::Area { .. } | LightKind::Surface(_) | LightKind::Sun(_)
        );
        if !has_a_size {
            let is_behind = light
                .kind
                .center()
                .is_some_and(|c| self.is_behind(c - self.at.position));
            if !is_behind && let Some(mut sent) = sent(self.world, index, self.at.position, (0.0, 0.0)) {
                self.fade(&mut sent);
                let way = (sent.towards, sent.distance);
                self.add(sum, sent.arriving, way, counts.luck_and_shadows(index), observer);
            }
            return;
        }
        if path.interrupt.poll() {
            return;
        }
        let n = points.isqrt();
        let mut together = Together::new(self);
        for cell in 0..points {
            let at = stratum(n, cell, path.random_pair(index as u64, cell.into()));
            if let Some(mut sent) = sent(self.world, index, self.at.position, at) {
                self.fade(&mut sent);
                sent.arriving /= f64::from(points);
                together.add_sent(sum, &sent, counts, observer);
            }
        }
        together.finish(sum, observer);
    }

    /// What haze leaves of light. That from infinitely far away is taken for what it is where it arrives.
    fn fade(&self, sent: &mut Sent) {
        let haze = self.world.around.as_ref().and_then(|around| around.haze);
        if let Some(haze) = haze
            && sent.distance.is_finite()
        {
            sent.arriving *= math::exp(-haze.density() * sent.distance);
        }
    }
}
