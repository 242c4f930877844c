//! What a point is inside of.

use std::collections::BTreeMap;

use super::world::{Probe, SurfacePoint, World};
use crate::{
    math::{DVec3, Ray},
    scene::{Geometry, GroupId, Object},
};

/// Where an object stands: through which groups.
pub(super) type Place = Vec<(GroupId, u32)>;

/// The solids with surfaces that count which a point is inside of: three rays in different directions must all say so.
/// A ray is followed through `most` surfaces.
pub(super) fn around<'s>(
    world: &World<'s>,
    point: DVec3,
    most: usize,
    counts: impl Fn(&SurfacePoint<'_>) -> bool,
) -> BTreeMap<Place, &'s Object> {
    let directions = [
        DVec3::new(0.36, 0.48, 0.8),
        DVec3::new(-0.8, 0.36, -0.48),
        DVec3::new(0.48, -0.8, -0.36),
    ];
    let [first, second, third] = directions.map(|dir| left_by(world, Ray::new(point, dir), most, &counts));
    let is_left = |place: &Place| second.contains_key(place) && third.contains_key(place);
    first.into_iter().filter(|(place, _)| is_left(place)).collect()
}

/// The solids that a ray leaves more often than it enters them.
fn left_by<'s>(
    world: &World<'s>,
    mut ray: Ray,
    most: usize,
    counts: impl Fn(&SurfacePoint<'_>) -> bool,
) -> BTreeMap<Place, &'s Object> {
    let mut balance: BTreeMap<Place, (i64, &'s Object)> = BTreeMap::new();
    let mut probe = Probe::from_space(ray);
    for _ in 0..most {
        if world.is_stopped() {
            break;
        }
        let Some(hit) = world.nearest(&probe, f64::INFINITY) else {
            break;
        };
        let Some(at) = world.surface(&hit, &ray) else {
            break;
        };
        let (place, object) = solid_of(world, hit.number);
        if let Some(object) = object.filter(|o| is_solid(o) && counts(&at)) {
            let entry = balance.entry(place).or_insert((0, object));
            entry.0 += if at.from_front { -1 } else { 1 };
        }
        ray = Ray::new(at.position, ray.dir);
        probe = Probe::from_surface(ray, hit.number, at.scale);
    }
    let left = balance.into_iter().filter(|(_, (balance, _))| *balance > 0);
    left.map(|(place, (_, object))| (place, object)).collect()
}

/// The object that a surface belongs to: of what is put together from several, the whole.
fn solid_of<'s>(world: &World<'s>, number: u64) -> (Place, Option<&'s Object>) {
    let (mut place, objects) = (world.places_of(number), world.objects_of(number));
    let whole = objects
        .iter()
        .position(|o| matches!(o.geometry, Geometry::Csg(..)));
    match whole {
        Some(whole) => {
            place.truncate(whole + 1);
            (place, objects.get(whole).copied())
        }
        None => (place, objects.last().copied()),
    }
}

/// Whether it has an inside; a mesh may have one.
fn is_solid(object: &Object) -> bool {
    match &object.geometry {
        Geometry::Shape(shape) => shape.is_solid(),
        Geometry::Mesh(_) | Geometry::Csg(..) => true,
        Geometry::Triangle(_) | Geometry::Instance(_) | Geometry::Moving(_) => false,
    }
}
