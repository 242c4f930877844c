//! Cameras and lights that stand inside of something opaque.

use super::{World, called, placed};
use crate::{
    diag::{Code, Diagnostic},
    math::brief,
    render::solids,
    scene::LightKind,
};

/// Lights looked at, at most: hundreds of them light a scene even where one stands in a wall.
const LIGHTS: usize = 64;
/// Surfaces that a ray is followed through, at most.
const SURFACES: usize = 128;

/// Warnings about the camera and the lights.
pub(super) fn warnings(world: &World<'_>) -> Vec<Diagnostic> {
    let scene = world.scene;
    let around = |point| solids::around(world, point, SURFACES, |at| at.material.is_opaque());
    let lights: Vec<_> = scene
        .root()
        .lights
        .iter()
        // A surface that shines may well be that of a lamp that is to be seen.
        .filter(|light| !matches!(light.kind, LightKind::Surface(_)))
        .filter_map(|light| Some((light, light.kind.center()?)))
        .take(LIGHTS)
        .map(|(light, position)| (light, position, around(position)))
        .collect();
    let of_camera = around(scene.camera.eye);
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
