//! Cameras and lights that stand inside of something opaque.

use std::collections::BTreeMap;

use super::{World, called, placed};
use crate::{
    diag::{Code, Diagnostic},
    math::{DVec3, Ray, brief},
    render::world::Probe,
    scene::{Geometry, GroupId, LightKind, Object},
};

/// Lights looked at, at most: hundreds of them light a scene even where one stands in a wall.
const LIGHTS: usize = 64;
/// Surfaces that a ray is followed through, at most.
const SURFACES: usize = 128;

/// Where an object stands: through which groups.
type Place = Vec<(GroupId, u32)>;

/// Warnings about the camera and the lights.
pub(super) fn warnings(world: &World<'_>) -> Vec<Diagnostic> {
    let scene = world.scene;
    let lights: Vec<_> = scene
        .root()
        .lights
        .iter()
        .filter_map(|light| match &light.kind {
            LightKind::Point { position, .. } => Some((light, *position)),
            LightKind::Area {
                corner, edge1, edge2, ..
            } => Some((light, *corner + (*edge1 + *edge2) * 0.5)),
            LightKind::Directional { .. } => None,
        })
        .take(LIGHTS)
        .map(|(light, position)| (light, position, around(world, position)))
        .collect();
    let of_camera = around(world, scene.camera.eye);
    let mut warnings = Vec::new();
    // Who stands inside with a light looks at a room.
    let dark = of_camera
        .iter()
        .find(|(place, _)| !lights.iter().any(|(_, _, around)| around.contains_key(*place)));
    if let Some((_, object)) = dark {
        let what = called(scene, object);
        let d = Diagnostic::warning(Code::CameraInside, format!("the camera is inside {what}"))
            .note(format!("it stands at {}", brief(scene.camera.eye)))
            .hint("move one of them, or put a light in there as well");
        warnings.push(placed(scene, d, object.loc));
    }
    for (light, position, around) in &lights {
        if let Some((_, object)) = around.iter().find(|(place, _)| !of_camera.contains_key(*place)) {
            let what = called(scene, object);
            let d = Diagnostic::warning(
                Code::LightInside,
                format!("the light is inside {what}, which lets none of it out"),
            )
            .note(format!("it stands at {}", brief(*position)))
            .hint("move one of them; a bulb around a light needs a transmission(...)");
            warnings.push(placed(scene, d, light.loc));
        }
    }
    warnings
}

/// The opaque solids that a point is inside of: three rays in different directions must all say so.
fn around<'s>(world: &World<'s>, point: DVec3) -> BTreeMap<Place, &'s Object> {
    let directions = [
        DVec3::new(0.36, 0.48, 0.8),
        DVec3::new(-0.8, 0.36, -0.48),
        DVec3::new(0.48, -0.8, -0.36),
    ];
    let [first, second, third] = directions.map(|dir| left_by(world, Ray::new(point, dir)));
    let is_left = |place: &Place| second.contains_key(place) && third.contains_key(place);
    first.into_iter().filter(|(place, _)| is_left(place)).collect()
}

/// The opaque solids that a ray leaves more often than it enters them.
fn left_by<'s>(world: &World<'s>, mut ray: Ray) -> BTreeMap<Place, &'s Object> {
    let mut balance: BTreeMap<Place, (i64, &'s Object)> = BTreeMap::new();
    let mut probe = Probe::from_space(ray);
    for _ in 0..SURFACES {
        let Some(hit) = world.nearest(&probe, f64::INFINITY) else {
            break;
        };
        let Some(at) = world.surface(&hit, &ray) else {
            break;
        };
        let object = world.objects_of(hit.number).last().copied();
        if let Some(object) = object.filter(|o| at.material.is_opaque() && is_solid(o)) {
            let entry = balance.entry(world.places_of(hit.number)).or_insert((0, object));
            entry.0 += if at.from_front { -1 } else { 1 };
        }
        ray = Ray::new(at.position, ray.dir);
        probe = Probe::from_surface(ray, hit.number, at.scale);
    }
    let left = balance.into_iter().filter(|(_, (balance, _))| *balance > 0);
    left.map(|(place, (_, object))| (place, object)).collect()
}

/// Whether it has an inside; a mesh may have one.
fn is_solid(object: &Object) -> bool {
    match &object.geometry {
        Geometry::Shape(shape) => shape.is_solid(),
        Geometry::Mesh(_) => true,
        Geometry::Triangle(_) | Geometry::Instance(_) => false,
    }
}
