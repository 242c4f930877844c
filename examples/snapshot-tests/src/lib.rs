//! Charts as pictures: a library whose product is scenes, and whose tests look at what they show.

use rtscript::{
    Builder, DVec3, Scene, Term,
    scene::{Camera, Edition, SceneError},
    shape::{Cuboid, Shape},
};

/// The color of a bar of no height.
const LOW: DVec3 = DVec3::new(0.1, 0.3, 0.8);
/// The color of a bar of height 1.
const HIGH: DVec3 = DVec3::new(0.9, 0.2, 0.1);

/// A bar chart in space, one bar for each value from 0 to 1, colored from blue to red.
///
/// # Errors
/// Where a value is not above 0: a bar without height is no box.
pub fn bar_chart(values: &[f64]) -> Result<Scene, SceneError> {
    let mut b = Builder::new();
    b.edition(Edition::E2026)?;
    b.size(120, 80)?;
    b.camera(Camera::new(
        DVec3::new(0.8, 1.3, 2.8),
        DVec3::new(0.0, 0.35, 0.0),
        DVec3::Y,
        35.0,
    )?);
    b.directional(DVec3::new(2.0, 3.0, 1.0), DVec3::ONE)?;
    b.background(DVec3::new(0.9, 0.93, 1.0))?;
    let step = 2.4 / values.len().max(1) as f64;
    for (i, value) in values.iter().enumerate() {
        b.material_mut().diffuse = Term::color(LOW.lerp(HIGH, *value));
        b.push_transform()?;
        b.translate(DVec3::new((i as f64 + 0.5) * step - 1.2, value / 2.0, 0.0))?;
        let size = DVec3::new(0.8 * step, *value, 0.8 * step);
        b.shape(Shape::Cuboid(Cuboid::new(size)?))?;
        b.pop_transform()?;
    }
    Ok(b.finish().value)
}
