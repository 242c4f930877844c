//! The perspective camera of gluLookAt.

use crate::{
    math::{DVec3, Ray, max_abs, sin_cos_degrees},
    scene::SceneError,
};

/// A pinhole camera: where it stands, what it looks at, which way is up, how much it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, in world space.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub at: DVec3,
    /// A direction that points up in the picture; need not be a unit vector or at right angles to the view.
    pub up: DVec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fovy: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 0.0, 5.0),
            at: DVec3::ZERO,
            up: DVec3::Y,
            fovy: 45.0,
        }
    }
}

impl Camera {
    /// A camera at `eye` looking at `at`, `fovy` in degrees.
    ///
    /// # Errors
    /// Where `eye` is `at`, `up` is zero or parallel to the view, or `fovy` is outside (0, 180).
    pub fn new(eye: DVec3, at: DVec3, up: DVec3, fovy: f64) -> Result<Self, SceneError> {
        if !(fovy > 0.0 && fovy < 180.0) {
            return Err(SceneError::new(format!(
                "the field of view fovy must lie between 0 and 180 degrees, not {fovy}"
            ))
            .hint("45 is a usual value"));
        }
        let view = eye - at;
        if max_abs(view) <= 1e-12 * max_abs(eye).max(max_abs(at)) {
            return Err(
                SceneError::new("the camera's eye and the point it looks at are the same")
                    .hint("camera(from, at, up, fovy): move one of the first two points"),
            );
        }
        let (view, unit_up) = (view / view.length(), up / up.length());
        if !(unit_up.cross(view).length() > 1e-9) {
            let what = if up == DVec3::ZERO {
                "zero"
            } else {
                "parallel to the view"
            };
            return Err(SceneError::new(format!("the camera's up vector is {what}"))
                .hint("[0, 1, 0] is a usual value; looking straight down, take [0, 0, -1]"));
        }
        Ok(Self { eye, at, up, fovy })
    }

    /// The camera's rays for a picture of `width` x `height` pixels.
    #[must_use]
    pub fn frame(&self, width: u32, height: u32) -> CameraFrame {
        let w = (self.eye - self.at) / (self.eye - self.at).length();
        let u = self.up.cross(w);
        let u = u / u.length();
        let v = w.cross(u);
        let (sin, cos) = sin_cos_degrees(self.fovy * 0.5);
        let tan_y = sin / cos;
        let (width, height) = (f64::from(width), f64::from(height));
        CameraFrame {
            eye: self.eye,
            u,
            v,
            w,
            tan_x: tan_y * width / height,
            tan_y,
            width,
            height,
        }
    }
}

/// The camera's orthonormal frame and the extent of its picture plane at distance 1.
#[derive(Clone, Copy, Debug)]
pub struct CameraFrame {
    eye: DVec3,
    u: DVec3,
    v: DVec3,
    w: DVec3,
    tan_x: f64,
    tan_y: f64,
    width: f64,
    height: f64,
}

impl CameraFrame {
    /// The ray through the point (`x`, `y`) of the picture, in pixels from its top left corner: pixel (i, j)
    /// has its center at (i + 0.5, j + 0.5). The direction is a unit vector.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let a = self.tan_x * ((x - self.width * 0.5) / (self.width * 0.5));
        let b = self.tan_y * ((self.height * 0.5 - y) / (self.height * 0.5));
        let dir = self.u * a + self.v * b - self.w;
        Ray::new(self.eye, dir / dir.length())
    }

    /// A point as the camera sees it: to the right, up, and straight ahead of it.
    #[must_use]
    pub(crate) fn camera_from_world(&self, p: DVec3) -> DVec3 {
        let p = p - self.eye;
        DVec3::new(p.dot(self.u), p.dot(self.v), -p.dot(self.w))
    }

    /// Half the width and half the height of the picture plane at distance 1.
    #[must_use]
    pub(crate) fn extent(&self) -> [f64; 2] {
        [self.tan_x, self.tan_y]
    }

    /// Where in the picture the line from `a` to `b` is seen, in pixels from the top left corner, as far as it lies in
    /// front of the camera; `None` where none of it does. The ends may lie beyond the picture.
    #[must_use]
    pub fn project(&self, a: DVec3, b: DVec3) -> Option<[[f64; 2]; 2]> {
        let [da, db] = [a, b].map(|p| (self.eye - p).dot(self.w));
        // A pinhole sees up to 90 degrees from its axis, where a picture's plane is infinitely far away.
        let near = 1e-6 * da.abs().max(db.abs());
        if !(da > near || db > near) {
            return None;
        }
        let at_near = a + (b - a) * ((near - da) / (db - da));
        let ends = [
            if da > near { a } else { at_near },
            if db > near { b } else { at_near },
        ];
        Some(ends.map(|p| {
            let p = p - self.eye;
            let depth = -p.dot(self.w);
            [
                (p.dot(self.u) / (depth * self.tan_x) + 1.0) * 0.5 * self.width,
                (1.0 - p.dot(self.v) / (depth * self.tan_y)) * 0.5 * self.height,
            ]
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_picture_looks_at_the_target() {
        let camera = Camera::new(
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(-1.0, 0.5, 0.0),
            DVec3::Y,
            50.0,
        )
        .unwrap();
        let ray = camera.frame(64, 48).ray(32.0, 24.0);
        let wanted = (camera.at - camera.eye).normalize();
        assert!((ray.dir - wanted).length() < 1e-15);
    }

    #[test]
    fn fovy_spans_the_height() {
        let frame = Camera::new(DVec3::Z, DVec3::ZERO, DVec3::Y, 90.0)
            .unwrap()
            .frame(200, 100);
        let top = frame.ray(100.0, 0.0).dir;
        assert!((top.y + top.z).abs() < 1e-15, "45 degrees up: {top}");
        let right = frame.ray(200.0, 50.0).dir;
        assert!((right.x + 2.0 * right.z).abs() < 1e-15, "twice as wide: {right}");
    }

    #[test]
    fn what_a_ray_goes_through_is_seen_where_it_came_from() {
        let camera = Camera::new(DVec3::new(1.0, 2.0, 6.0), DVec3::X, DVec3::Y, 70.0).unwrap();
        let frame = camera.frame(64, 48);
        let points = [[3.0, 7.0], [60.0, 44.5]];
        let [a, b] = [(points[0], 2.0), (points[1], 9.0)].map(|([x, y], t)| frame.ray(x, y).at(t));
        let near = |seen: [[f64; 2]; 2], wanted: [[f64; 2]; 2]| {
            let pairs = seen.as_flattened().iter().zip(wanted.as_flattened());
            pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{seen:?} {wanted:?}"));
        };
        near(frame.project(a, b).unwrap(), points);
        let behind = camera.eye * 2.0 - a;
        assert_eq!(frame.project(behind, behind), None);
        near([frame.project(behind, b).unwrap()[1]; 2], [points[1]; 2]);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let new = |eye, up, fovy| Camera::new(eye, DVec3::ZERO, up, fovy);
        assert!(new(DVec3::ZERO, DVec3::Y, 45.0).is_err());
        assert!(new(DVec3::Y, DVec3::Y, 45.0).is_err());
        assert!(new(DVec3::Z, DVec3::ZERO, 45.0).is_err());
        for fovy in [0.0, 180.0, -1.0, f64::NAN] {
            assert!(new(DVec3::Z, DVec3::Y, fovy).is_err(), "{fovy}");
        }
    }
}
