//! A thin lens: what is not in focus is blurred, in the shape of the aperture.

use super::Camera;
use crate::{
    math::{DVec2, DVec3, brief, sin_cos_degrees},
    scene::SceneError,
};

/// What a lens brings to a sharp point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Focus {
    /// What is as far ahead of the camera as the point that it looks at.
    #[default]
    Target,
    /// What is so far ahead of the camera, along its view, above 0.
    Distance(f64),
    /// What is as far ahead of the camera as this point of the world.
    Point(DVec3),
}

/// A thin lens (Cook, Porter and Carpenter, "Distributed ray tracing", 1984): rays through one point of the picture
/// leave the aperture anywhere and meet in the plane in focus.
///
/// A point at distance `d` ahead of the camera is spread over a circle of radius `radius |d - f| / f`, measured in the
/// plane at distance `d`, `f` being the distance in focus.
///
/// ```
/// use rtscript::{DVec3, scene::{Camera, Focus, Lens}};
/// let mut lens = Lens::new(0.05);
/// lens.focus = Focus::Distance(4.0);
/// lens.blades = 6;
/// let camera = Camera::new(DVec3::new(0.0, 1.0, 5.0), DVec3::ZERO, DVec3::Y, 40.0)?.with_lens(Some(lens))?;
/// assert!(camera.lens.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture in world units, above 0; of a polygon that of its corners.
    pub radius: f64,
    /// What is sharp.
    pub focus: Focus,
    /// Edges of the aperture, a regular polygon, 3 to 64; 0 for a circle.
    pub blades: u32,
    /// How far the polygon is turned, counterclockwise as seen from the camera, in degrees; without, a corner points up.
    pub rotation: f64,
}

impl Lens {
    /// Most [`Lens::blades`].
    pub const MAX_BLADES: u32 = 64;

    /// A round lens that is focused on what the camera looks at.
    #[must_use]
    pub const fn new(radius: f64) -> Self {
        Self {
            radius,
            focus: Focus::Target,
            blades: 0,
            rotation: 0.0,
        }
    }

    pub(super) fn check(&self, camera: &Camera) -> Result<(), SceneError> {
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return Err(SceneError::new(format!(
                "the radius of the lens must be above 0, not {}",
                self.radius
            )));
        }
        if self.blades > Self::MAX_BLADES || (1..3).contains(&self.blades) {
            return Err(SceneError::new(format!(
                "a lens has 3 to {} blades, or 0 for a round aperture, not {}",
                Self::MAX_BLADES,
                self.blades
            )));
        }
        if !self.rotation.is_finite() {
            return Err(SceneError::new(format!(
                "the rotation of the lens must be a finite number of degrees, not {}",
                self.rotation
            )));
        }
        if !camera.projection.is_flat() {
            return Err(SceneError::new(format!(
                "a {} camera has no lens, only perspective and orthographic ones have",
                camera.projection.name()
            ))
            .hint("leave out lens(...), or call it for another camera"));
        }
        let distance = self.distance(camera);
        if distance > 0.0 && distance.is_finite() {
            return Ok(());
        }
        Err(match self.focus {
            Focus::Point(point) => SceneError::new(format!(
                "the point in focus must lie before the camera, and {} does not",
                brief(point)
            )),
            _ => SceneError::new(format!("the distance in focus must be above 0, not {distance}")),
        })
    }

    /// Distance of the plane in focus from the camera.
    pub(super) fn distance(&self, camera: &Camera) -> f64 {
        let view = camera.at - camera.eye;
        match self.focus {
            Focus::Target => view.length(),
            Focus::Distance(distance) => distance,
            Focus::Point(point) => (point - camera.eye).dot(view) / view.length(),
        }
    }

    /// The point of the aperture, of radius 1, that two even numbers in [0, 1) stand for: points are as dense everywhere.
    #[must_use]
    pub(crate) fn point(&self, u: f64, v: f64) -> DVec2 {
        match self.blades {
            0 => in_disk(u, v),
            blades => in_polygon(blades, self.rotation, u, v),
        }
    }
}

/// The square onto the disk, neighbors onto neighbors (Shirley and Chiu, "A low distortion map between disk and square",
/// 1997).
fn in_disk(u: f64, v: f64) -> DVec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (r, degrees) = if a.abs() > b.abs() {
        (a, 45.0 * (b / a))
    } else {
        (b, 90.0 - 45.0 * (a / b))
    };
    let (sin, cos) = sin_cos_degrees(degrees);
    DVec2::new(r * cos, r * sin)
}

/// One of the triangles between the middle and an edge, then a point in it.
fn in_polygon(blades: u32, rotation: f64, u: f64, v: f64) -> DVec2 {
    let n = f64::from(blades);
    let triangle = (u * n).floor().min(n - 1.0);
    let along = (u * n - triangle).clamp(0.0, 1.0);
    let corner = |i: f64| {
        let (sin, cos) = sin_cos_degrees(90.0 + rotation + 360.0 * i / n);
        DVec2::new(cos, sin)
    };
    let (a, b) = (corner(triangle), corner(triangle + 1.0));
    (a + (b - a) * along) * v.sqrt()
}
