//! What looks wrong with a scene, found by looking at it as the renderer does: before a render, after one that shows
//! nothing, and more closely where somebody asks.

mod dark;
mod enclosed;
mod look;
#[cfg(test)]
mod tests;
mod view;

use super::{film::Image, world::World};
use crate::{
    color::Color,
    diag::{Code, Diagnostic, Error, SourceLoc},
    host::Host,
    scene::{Geometry, Material, Object, Scene},
};

/// What looks wrong with a scene, with the places of the calls that made it: as a render finds before and after it traces,
/// and by a coarse look through the camera also faces that lie in one plane, and lines whose shapes no ray meets. Less
/// work than a render of 160 x 120 pixels with one sample.
///
/// # Errors
/// `Cancelled` where the host asks to stop, `Limit` where instancing multiplies past 2^62 primitives.
///
/// ```
/// use rtscript::{Builder, DVec3, NoHost, render::inspect};
/// let mut b = Builder::new();
/// // Two balls in one place.
/// b.sphere(DVec3::ZERO, 1.0)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// for finding in inspect(&b.finish().value, &NoHost)? {
///     println!("{finding}");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect(scene: &Scene, host: &dyn Host) -> Result<Vec<Diagnostic>, Error> {
    let world = World::compile(scene)?;
    let mut warnings = before(&world);
    let mut seen = look::look(&world, host)?;
    let has = |codes: &[Code]| warnings.iter().any(|d| codes.contains(&d.code));
    let are_told = [
        (Code::UnseenShape, has(&[Code::OutOfView])),
        (
            Code::Unlit,
            has(&[Code::OutOfView, Code::CameraInside, Code::LightInside]),
        ),
    ];
    seen.retain(|d| !are_told.contains(&(d.code, true)));
    warnings.extend(seen);
    Ok(warnings)
}

/// What can be told before a ray of the picture is traced, at the cost of a few rays for each light.
pub(super) fn before(world: &World<'_>) -> Vec<Diagnostic> {
    if world.scene.root().objects.is_empty() {
        return Vec::new();
    }
    let mut warnings: Vec<Diagnostic> = view::out_of_view(world).into_iter().collect();
    warnings.extend(enclosed::warnings(world));
    warnings
}

/// Why a finished picture shows nothing, where it does and none of the warnings before says why.
pub(super) fn after(world: &World<'_>, image: &Image, before: &[Diagnostic]) -> Option<Diagnostic> {
    let scene = world.scene;
    let is_explained = before.iter().any(|d| {
        matches!(
            d.code,
            Code::OutOfView | Code::CameraInside | Code::LightInside | Code::NoLight
        )
    });
    if is_explained || scene.root().objects.is_empty() {
        return None;
    }
    let first = image.pixels().first()?;
    if !image.is_black() && !image.pixels().iter().all(|pixel| pixel == first) {
        return None;
    }
    dark::why(world, image)
}

/// A warning where there is light and no material that answers it: at the start, diffuse and specular are black. A scene
/// may want that, so only who looks at a picture for the first time is to be told.
///
/// ```
/// use rtscript::{Builder, render::unanswered};
/// // An ordinary scene leaves nothing open.
/// assert!(unanswered(&Builder::new().finish().value).is_none());
/// ```
pub fn unanswered(scene: &Scene) -> Option<Diagnostic> {
    let is_lit = scene.root().lights.iter().any(|light| light.color != Color::ZERO);
    let answers = |m: &Material| {
        !m.diffuse.is_black()
            || !m.specular.is_black()
            || m.reflection.is_some()
            || !m.is_opaque()
            || m.finish.is_some()
    };
    if !is_lit || scene.root().objects.is_empty() || scene.materials.iter().any(answers) {
        return None;
    }
    Some(
        Diagnostic::warning(
            Code::Unlit,
            "no material answers the light: diffuse and specular are black, as they are at the start",
        )
        .hint("write diffuse(0.8, 0.8, 0.8) before the shapes"),
    )
}

/// The thing with its line, for a sentence: `the sphere of line 3`.
pub(super) fn called(scene: &Scene, object: &Object) -> String {
    let what = match &object.geometry {
        Geometry::Triangle(_) => "triangle",
        other => other.name(),
    };
    match object.loc {
        SourceLoc { line: 0, .. } => format!("the {what}"),
        SourceLoc { line, file: 0, .. } => format!("the {what} of line {line}"),
        loc => {
            let file = scene.files.get(usize::from(loc.file)).map_or("", String::as_str);
            format!("the {what} of {file}:{}", loc.line)
        }
    }
}

/// Puts a diagnostic where something was made.
pub(super) fn placed(scene: &Scene, diagnostic: Diagnostic, loc: SourceLoc) -> Diagnostic {
    match scene.files.get(usize::from(loc.file)) {
        Some(file) if loc.line > 0 => diagnostic.at(file, loc.line, u32::from(loc.column)),
        _ => diagnostic,
    }
}
