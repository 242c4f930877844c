//! Kinds of lights that are rarer than points, directions and areas: kept away from the loop over those.

use super::Lit;
use crate::{
    color::Color,
    math::DVec3,
    render::{
        integrator::{Counts, Path},
        observe::Observer,
    },
    scene::{Light, LightKind},
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

/// What a light sends to `p`, which none of its points sees otherwise than the others; `None` where that is nothing.
fn from_a_point(light: &Light, p: DVec3) -> Option<Sent> {
    match &light.kind {
        LightKind::Spot(spot) => {
            let offset = spot.position() - p;
            let share = spot.share(-offset);
            if share == 0.0 {
                return None;
            }
            let distance = offset.length();
            Some(Sent {
                towards: offset / distance,
                distance,
                arriving: light.color * (spot.attenuation().at(distance) * share),
            })
        }
        _ => None,
    }
}

impl Lit<'_> {
    /// Adds what a light of a rarer kind sends to `sum`.
    #[cold]
    #[inline(never)]
    pub(super) fn add_other<O: Observer>(
        &self,
        sum: &mut Color,
        light: &Light,
        _path: &Path<'_>,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        if let LightKind::Spot(spot) = &light.kind
            && self.is_behind(spot.position() - self.at.position)
        {
            return;
        }
        if let Some(sent) = from_a_point(light, self.at.position) {
            self.add(sum, sent.arriving, sent.towards, sent.distance, counts, observer);
        }
    }
}
