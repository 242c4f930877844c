//! What takes from the light on its way through, and what a ray remembers of it.

use super::ABSORBED;
use crate::{
    color::Color,
    math::{self, Ray},
    render::{
        path::Path,
        world::{Hit, SurfacePoint, World},
    },
    scene::{Absorption, Finish, Term},
};

/// What a ray carries along from surface to surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::render) struct Inside(u64);

impl Inside {
    const COLORED: u64 = 1 << 63;

    /// True where it carries anything.
    pub(in crate::render) fn is_any(self) -> bool {
        self.0 != 0
    }

    /// Inside of what the primitive with this number bounds, which takes from the light.
    pub(super) fn entered(self, primitive: Option<u64>) -> Self {
        // A scene has far fewer primitives than that.
        let number = primitive.map_or(0, |number| (number + 1) & !Self::COLORED);
        Self(self.0 & Self::COLORED | number)
    }

    /// Outside again.
    pub(in crate::render) fn left(self) -> Self {
        Self(self.0 & Self::COLORED)
    }

    pub(super) fn primitive(self) -> Option<u64> {
        (self.0 & !Self::COLORED).checked_sub(1)
    }

    /// Has one wavelength from now on.
    pub(super) fn colored(self) -> Self {
        Self(self.0 | Self::COLORED)
    }

    pub(super) fn is_colored(self) -> bool {
        self.0 & Self::COLORED != 0
    }
}

/// What is left of light after `distance` through what absorbs it: `color` is left after `unit` (Beer, 1852).
fn left_of(color: Color, unit: f64, distance: f64) -> Color {
    let times = distance / unit;
    let channel = |share: f64| {
        if share >= 1.0 {
            1.0
        } else {
            math::pow(share, times)
        }
    };
    Color::new(channel(color.x), channel(color.y), channel(color.z))
}

/// Places on a way through what varies that are looked at, each standing for an equal part of it.
const PLACES: u32 = 16;

/// What is left of light on the way that `ray` goes to `end`, or for good, inside of what the primitive `number` bounds. `end` is on
/// the surface of the same. `moved` from 0 to 1 is where in each part of the way its place is.
pub(super) fn absorbed(
    world: &World<'_>,
    absorption: &Absorption,
    (number, ray): (u64, &Ray),
    end: Option<&SurfacePoint<'_>>,
    distance: f64,
    moved: f64,
) -> Color {
    let Absorption {
        color,
        distance: unit,
    } = absorption;
    if color.texture.is_none() && unit.texture.is_none() {
        return left_of(color.color, Term::number_of(unit.color), distance);
    }
    let uv = end.map(|end| end.uv);
    let left_over = |t: f64, length: f64| {
        let Some(mut place) = world.place_near(number, ray, ray.at(t)) else {
            return Color::ONE;
        };
        // No pixel is seen there.
        place.width = [0.0; 2];
        place.footprint = None;
        if let Some(uv) = uv {
            place.uv = uv;
        }
        let at = |term: &Term| world.term_at(term, || place);
        let color = at(color);
        let [least, most] = Finish::LEFT.map(Color::splat);
        let [nearest, farthest] = Finish::DISTANCE;
        let unit = Term::number_of(at(unit)).max(nearest).min(farthest);
        left_of(color.max(least).min(most), unit, length)
    };
    if !distance.is_finite() {
        return left_over(0.0, distance);
    }
    let part = distance / f64::from(PLACES);
    (0..PLACES).fold(Color::ONE, |left, i| {
        left * left_over((f64::from(i) + moved) * part, part)
    })
}

/// What is left of the light that a ray sees, having come this far through what it is inside of. `end` is where it ended, if it
/// did.
#[cold]
#[inline(never)]
pub(in crate::render) fn dimmed(
    world: &World<'_>,
    inside: Inside,
    ray: &Ray,
    end: Option<(&Hit, &SurfacePoint<'_>)>,
    path: &Path<'_>,
) -> Color {
    let leaves = end.filter(|(_, at)| !at.from_front);
    // Without having seen how it came in, a ray that leaves knows what it leaves.
    let Some(number) = inside.primitive().or(leaves.map(|(hit, _)| hit.number)) else {
        return Color::ONE;
    };
    let id = world.material_id(number);
    let material = id.and_then(|id| world.scene.materials.get(id.index()));
    let Some(absorption) = material.and_then(|material| material.finish.as_ref()?.absorption.as_ref()) else {
        return Color::ONE;
    };
    let distance = end.map_or(f64::INFINITY, |(_, at)| (at.position - ray.origin).length());
    let own = leaves.filter(|(hit, _)| world.material_id(hit.number) == id);
    let moved = path.of_surface(ABSORBED);
    let way = (number, ray);
    absorbed(world, absorption, way, own.map(|(_, at)| at), distance, moved)
}
