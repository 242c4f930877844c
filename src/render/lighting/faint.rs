//! Highlights that may be too faint to change a picture. Where a surface answers lights with a highlight alone, as glass
//! does, most lights add numbers that are far smaller than the last digit of what the path has gathered: whether
//! anything stands in their way need not be known.

use super::{Counts, Gloss, Lit};
use crate::{
    color::Color,
    math::DVec3,
    render::world::{SurfacePoint, World},
    scene::{Light, LightKind},
};

/// Most lights that are looked at in this way.
const MOST: usize = 4;

/// A light as a point sees it.
#[derive(Clone, Copy)]
struct Way {
    towards: DVec3,
    distance: f64,
    arriving: Color,
    response: Color,
    /// What the light may add, from the least to the most.
    range: [Color; 2],
}

impl Way {
    const DARK: Self = Self {
        towards: DVec3::ZERO,
        distance: 0.0,
        arriving: Color::ZERO,
        response: Color::ZERO,
        range: [Color::ZERO; 2],
    };

    /// Of what a light sends to a point. `None` where it is more than a point or a direction.
    #[inline(always)]
    fn of(light: &Light, lit: &Lit<'_>) -> Option<Self> {
        let (towards, distance, arriving) = match &light.kind {
            LightKind::Directional { direction } => (*direction, f64::INFINITY, light.color),
            LightKind::Point {
                position,
                attenuation,
            } => {
                let offset = *position - lit.at.position;
                if lit.is_behind(offset) {
                    return Some(Self::DARK);
                }
                let distance = offset.length();
                (
                    offset / distance,
                    distance,
                    light.color * attenuation.at(distance),
                )
            }
            _ => return None,
        };
        let response = lit.respond(towards);
        let all = arriving * response;
        all.is_finite().then(|| Self {
            towards,
            distance,
            arriving,
            response,
            range: [all.min(Color::ZERO), all.max(Color::ZERO)],
        })
    }

    /// How much it matters whether anything stands in the way.
    fn doubt(&self) -> f64 {
        (self.range[1] - self.range[0]).max_element()
    }
}

/// What [`direct`](super::direct) gives or what `whole` cannot tell from that: `whole` makes sums and products of it by
/// numbers that are the same for all. `None` where there are too many lights, or some that are more than points and
/// directions.
///
/// Rounding keeps order: with one light's part anywhere between nothing and all of it, any sum that it is added to lies
/// between the two sums that these make. Where those two are one number, so is what lies between. Whether anything
/// stands in the way is asked first of the light that may add the most.
#[inline(never)]
pub(in crate::render) fn highlights(
    world: &World<'_>,
    place: (&SurfacePoint<'_>, u64, DVec3),
    gloss: &Gloss<'_>,
    counts: &mut Counts,
    whole: impl Fn(Color) -> Color,
) -> Option<Color> {
    let lights = &world.scene.root().lights;
    if lights.len() > MOST || world.is_linked {
        return None;
    }
    let lit = Lit::new(world, place, gloss);
    let mut ways = [Way::DARK; MOST];
    let ways = ways.get_mut(..lights.len())?;
    for (way, light) in ways.iter_mut().zip(lights) {
        *way = Way::of(light, &lit)?;
    }
    loop {
        let sum = |end: usize| ways.iter().fold(Color::ZERO, |sum, way| sum + way.range[end]);
        let (least, most) = (sum(0), sum(1));
        if whole(least) == whole(most) {
            return Some(least);
        }
        let doubt = |way: &Way| way.doubt();
        let (light, way) = (ways.iter_mut().enumerate()).max_by(|a, b| doubt(a.1).total_cmp(&doubt(b.1)))?;
        if !(way.doubt() > 0.0) {
            // It is what it is, a number or not.
            return Some(least);
        }
        let (to_light, light) = ((way.towards, way.distance), counts.luck_and_shadows(light));
        way.range = [lit.arrived_after(light, to_light, (way.arriving, way.response), &mut ()); 2];
    }
}

impl World<'_> {
    /// Whether [`highlights`] may find the light of lamps to be too faint at a surface with these terms.
    #[inline(always)]
    pub(in crate::render) fn may_be_faint(&self, gloss: &Gloss<'_>) -> bool {
        gloss.diffuse == Color::ZERO
            && gloss.specular != Color::ZERO
            && gloss.custom.is_none()
            && self.around.is_none()
            && self.shadows_dim
    }
}
