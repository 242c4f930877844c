//! Whether anything lies in what the camera sees.

use super::World;
use crate::{
    diag::{Code, Diagnostic},
    math::{Bounds3, DVec3, brief},
    scene::{Camera, Scene},
};

/// A warning where certainly nothing lies in view.
pub(super) fn out_of_view(world: &World<'_>) -> Option<Diagnostic> {
    let bounds = world.bounds()?;
    let side = side(world.scene, &bounds)?;
    let middle = (bounds.min + bounds.max) * 0.5;
    let Camera { eye, .. } = world.scene.camera;
    Some(
        Diagnostic::warning(
            Code::OutOfView,
            format!("nothing is in view: all there is lies {side}"),
        )
        .note(format!(
            "the scene reaches from {} to {}, the camera stands at {}",
            brief(bounds.min),
            brief(bounds.max),
            brief(eye)
        ))
        .hint(format!(
            "look at its middle: camera({}, {}, [0, 1, 0], 45)",
            brief(eye),
            brief(middle)
        )),
    )
}

/// On which side of the view a box lies that is outside of it altogether.
pub(super) fn side(scene: &Scene, bounds: &Bounds3) -> Option<&'static str> {
    let s = &scene.settings;
    let frame = scene.camera.frame(s.width, s.height);
    let corners = bounds.corners().map(|corner| frame.camera_from_world(corner));
    let [[base_x, base_y], [tan_x, tan_y]] = frame.extent()?;
    // Signed distances that are negative outside, not in any unit. A box that is outside of no single plane may still
    // be out of view; that is for rays to find out.
    let outside = |inside: &dyn Fn(DVec3) -> f64| corners.iter().all(|p| inside(*p) < 0.0);
    let sides: [(&str, &dyn Fn(DVec3) -> f64); 5] = [
        ("behind the camera", &|p| p.z),
        ("to the left of what the camera sees", &|p| {
            p.x + base_x + p.z * tan_x
        }),
        ("to the right of what the camera sees", &|p| {
            p.z * tan_x + base_x - p.x
        }),
        ("below what the camera sees", &|p| p.y + base_y + p.z * tan_y),
        ("above what the camera sees", &|p| p.z * tan_y + base_y - p.y),
    ];
    let found = sides.into_iter().find(|(_, inside)| outside(inside));
    found.map(|(side, _)| side)
}
