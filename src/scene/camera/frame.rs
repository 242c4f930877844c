//! A camera's rays for a picture of a given size.

use super::{Camera, Lens, Projection, StereoLayout};
use crate::math::{DVec2, DVec3, Ray, asin, atan2, hypot, max_abs, sin_cos_degrees};

/// One of two eyes, or the one between them.
///
/// ```
/// use rtscript::scene::Eye;
/// // What a camera without stereo looks with.
/// assert_eq!(Eye::default(), Eye::Middle);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Eye {
    /// Where the camera stands.
    #[default]
    Middle,
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

impl Eye {
    const fn side(self) -> f64 {
        match self {
            Self::Middle => 0.0,
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}

/// The camera's orthonormal frame and the extent of its picture plane.
///
/// ```
/// use rtscript::{DVec3, scene::{Camera, CameraFrame}};
/// let camera = Camera::new(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0)?;
/// let frame: CameraFrame = camera.frame(100, 100);
/// // The ray through the middle of the picture looks at the target.
/// let ray = frame.ray(50.0, 50.0).expect("every place has a ray here");
/// assert!(ray.dir.normalize().abs_diff_eq(DVec3::NEG_Z, 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CameraFrame {
    eye: DVec3,
    u: DVec3,
    v: DVec3,
    w: DVec3,
    /// What lies at the right edge and at the upper edge of a view: the tangent of an angle (perspective; the upper edge
    /// of a cylinder), a distance (orthographic), or degrees.
    tan_x: f64,
    tan_y: f64,
    /// Size of the view of one eye in pixels.
    width: f64,
    height: f64,
    projection: Projection,
    lens: Option<(Lens, f64)>,
    stereo: Option<Eyes>,
    /// The camera and the size of the picture, where other times have other rays.
    moving: Option<(Camera, (u32, u32))>,
}

#[derive(Clone, Copy, Debug)]
struct Eyes {
    /// From the middle to each eye.
    half: f64,
    /// Infinite for parallel eyes.
    convergence: f64,
    layout: StereoLayout,
}

impl CameraFrame {
    pub(super) fn new(moving: &Camera, size: (u32, u32), time: f64) -> Self {
        let camera = &moving.at_time(time);
        let (width, height) = size;
        let w = (camera.eye - camera.at) / (camera.eye - camera.at).length();
        let u = camera.up.cross(w);
        let u = u / u.length();
        let v = w.cross(u);
        let (mut width, mut height) = (f64::from(width), f64::from(height));
        match camera.stereo.map(|stereo| stereo.layout) {
            Some(StereoLayout::SideBySide) => width *= 0.5,
            Some(StereoLayout::TopBottom) => height *= 0.5,
            Some(StereoLayout::Anaglyph) | None => {}
        }
        let tangent = |degrees: f64| {
            let (sin, cos) = sin_cos_degrees(degrees * 0.5);
            sin / cos
        };
        let (tan_x, tan_y) = match camera.projection {
            Projection::Perspective { fovy } => {
                let tan_y = tangent(fovy);
                (tan_y * width / height, tan_y)
            }
            Projection::Orthographic { height: seen } => (seen * 0.5 * width / height, seen * 0.5),
            Projection::Fisheye { angle, full_frame } => {
                let radius = match full_frame {
                    true => hypot(width, height) * 0.5,
                    false => width.min(height) * 0.5,
                };
                let degrees_per_pixel = angle * 0.5 / radius;
                (degrees_per_pixel * width * 0.5, degrees_per_pixel * height * 0.5)
            }
            Projection::Panorama { angle, fovy } => (angle * 0.5, fovy * 0.5),
            Projection::Cylindrical { angle, fovy } => {
                let square = angle.to_radians() * 0.5 * height / width;
                (angle * 0.5, fovy.map_or(square, tangent))
            }
        };
        Self {
            eye: camera.eye,
            u,
            v,
            w,
            tan_x,
            tan_y,
            width,
            height,
            projection: camera.projection,
            moving: camera.motion.map(|_| (*moving, size)),
            lens: camera.lens.map(|lens| (lens, lens.distance(camera))),
            stereo: camera.stereo.map(|stereo| Eyes {
                half: stereo.separation * 0.5,
                convergence: stereo.convergence.unwrap_or(match camera.projection.is_flat() {
                    true => (camera.at - camera.eye).length(),
                    false => f64::INFINITY,
                }),
                layout: stereo.layout,
            }),
        }
    }

    /// The eyes that each point of the picture is seen with.
    pub(crate) fn eyes(&self) -> &'static [Eye] {
        match &self.stereo {
            Some(eyes) if eyes.layout == StereoLayout::Anaglyph => &[Eye::Left, Eye::Right],
            _ => &[Eye::Middle],
        }
    }

    /// Whether other times have other rays.
    pub(crate) fn moves(&self) -> bool {
        self.moving.is_some()
    }

    /// The rays at the time that a number from 0 to 1 stands for, from where the shutter opens to where it closes.
    pub(crate) fn at_time(&self, share: f64) -> Self {
        self.moving.map_or(*self, |(camera, size)| {
            Self::new(&camera, size, camera.shutter.time(share))
        })
    }

    /// Whether rays leave more than one point of a lens.
    pub(crate) fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// The ray through the point (`x`, `y`) of the picture, in pixels from its top left corner: pixel (i, j)
    /// has its center at (i + 0.5, j + 0.5). The direction is a unit vector. Of a lens that through its middle, of an
    /// anaglyph that between the eyes; `None` where the picture shows nothing, outside the circle of a fisheye.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> Option<Ray> {
        self.shot([x, y], Eye::Middle, None)
    }

    /// The ray of a perspective camera without lens and with one eye, from what [`CameraFrame::across`] and
    /// [`CameraFrame::up`] say of its place.
    #[inline(always)]
    #[must_use]
    pub(crate) fn pinhole(&self, across: DVec3, up: DVec3) -> Ray {
        let dir = across + up - self.w;
        Ray::new(self.eye, dir / dir.length())
    }

    /// What the place across the picture adds to a direction; the same for a whole column.
    #[inline(always)]
    pub(crate) fn across(&self, x: f64) -> DVec3 {
        self.u * self.a(x)
    }

    /// What the place down the picture adds to a direction; the same for a whole row.
    #[inline(always)]
    pub(crate) fn up(&self, y: f64) -> DVec3 {
        self.v * self.b(y)
    }

    /// How far the place across is from the middle, in the projection's unit: at its edges `tan_x`.
    #[inline(always)]
    fn a(&self, x: f64) -> f64 {
        self.tan_x * ((x - self.width * 0.5) / (self.width * 0.5))
    }

    /// How far the place down is above the middle: at its edges `tan_y`.
    #[inline(always)]
    fn b(&self, y: f64) -> f64 {
        self.tan_y * ((self.height * 0.5 - y) / (self.height * 0.5))
    }

    /// As [`CameraFrame::ray`], for one eye where the picture is that of both, through the point of the lens that two
    /// numbers in [0, 1) stand for.
    #[must_use]
    pub(crate) fn shot(&self, [x, y]: [f64; 2], eye: Eye, aperture: Option<[f64; 2]>) -> Option<Ray> {
        let (x, y, eye) = self.view_of(x, y, eye);
        let (a, b) = (self.a(x), self.b(y));
        let (mut origin, mut right) = (self.eye, self.u);
        // Before it is made a unit vector; where the projection is flat, it reaches the plane at distance 1.
        let mut dir = match self.projection {
            Projection::Perspective { .. } => self.u * a + self.v * b - self.w,
            Projection::Orthographic { .. } => {
                origin += self.u * a + self.v * b;
                -self.w
            }
            Projection::Fisheye { angle, .. } => {
                let r = hypot(a, b);
                if r > angle * 0.5 {
                    return None;
                }
                let (sin, cos) = sin_cos_degrees(r);
                let aside = if r > 0.0 { sin / r } else { 0.0 };
                self.u * (a * aside) + self.v * (b * aside) - self.w * cos
            }
            Projection::Panorama { .. } => {
                let ((sin, cos), (up, level)) = (sin_cos_degrees(a), sin_cos_degrees(b));
                right = self.u * cos + self.w * sin;
                (self.u * sin - self.w * cos) * level + self.v * up
            }
            Projection::Cylindrical { .. } => {
                let (sin, cos) = sin_cos_degrees(a);
                right = self.u * cos + self.w * sin;
                self.u * sin - self.w * cos + self.v * b
            }
        };
        if let Some(eyes) = self.stereo.filter(|_| eye != Eye::Middle) {
            let offset = right * (eyes.half * eye.side());
            if !self.projection.is_flat() {
                dir /= dir.length();
            }
            origin += offset;
            // Both eyes aim at the point that the one between them sees at the distance of convergence.
            dir -= offset / eyes.convergence;
        }
        if let (Some((lens, focus)), Some([u, v])) = (&self.lens, aperture) {
            let point = lens.point(u, v) * lens.radius;
            let offset = self.u * point.x + self.v * point.y;
            origin += offset;
            dir -= offset / *focus;
        }
        Some(Ray::new(origin, dir / dir.length()))
    }

    /// The place in the view of one eye, and which one that is, where each has a part of the picture.
    fn view_of(&self, x: f64, y: f64, eye: Eye) -> (f64, f64, Eye) {
        match self.stereo.map(|eyes| eyes.layout) {
            Some(StereoLayout::SideBySide) if x < self.width => (x, y, Eye::Left),
            Some(StereoLayout::SideBySide) => (x - self.width, y, Eye::Right),
            Some(StereoLayout::TopBottom) if y < self.height => (x, y, Eye::Left),
            Some(StereoLayout::TopBottom) => (x, y - self.height, Eye::Right),
            Some(StereoLayout::Anaglyph) | None => (x, y, eye),
        }
    }

    /// A point as the camera sees it: to the right, up, and straight ahead of it.
    #[must_use]
    pub(crate) fn camera_from_world(&self, p: DVec3) -> DVec3 {
        let p = p - self.eye;
        DVec3::new(p.dot(self.u), p.dot(self.v), -p.dot(self.w))
    }

    /// Half the width and half the height of what is seen at distance `ahead` of the camera, as `base + slope * ahead`;
    /// `None` where the picture is not flat or there are two eyes.
    #[must_use]
    pub(crate) fn extent(&self) -> Option<[[f64; 2]; 2]> {
        match self.projection {
            _ if self.stereo.is_some() => None,
            Projection::Perspective { .. } => Some([[0.0, 0.0], [self.tan_x, self.tan_y]]),
            Projection::Orthographic { .. } => Some([[self.tan_x, self.tan_y], [0.0, 0.0]]),
            _ => None,
        }
    }

    /// Where in the picture the line from `a` to `b` is seen, in pixels from the top left corner, as far as it lies in
    /// front of the camera; `None` where none of it does, and where lines do not stay straight or are seen twice. The ends
    /// may lie beyond the picture.
    #[must_use]
    pub fn project(&self, a: DVec3, b: DVec3) -> Option<[[f64; 2]; 2]> {
        if self.stereo.is_some() || !self.projection.is_flat() {
            return None;
        }
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
            let depth = match self.projection {
                Projection::Perspective { .. } => -p.dot(self.w),
                _ => 1.0,
            };
            [
                (p.dot(self.u) / (depth * self.tan_x) + 1.0) * 0.5 * self.width,
                (1.0 - p.dot(self.v) / (depth * self.tan_y)) * 0.5 * self.height,
            ]
        }))
    }

    /// As [`CameraFrame::project`], in as many straight pieces as it takes, for every camera: of two eyes each sees it.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::{Camera, Projection}};
    /// let eye = [DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y];
    /// let [a, b] = [DVec3::new(-1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
    /// // Straight lines stay straight in a perspective: one piece, level and in the upper half.
    /// let straight = Camera::new(eye[0], eye[1], eye[2], 40.0)?.frame(100, 100);
    /// let [from, to] = straight.project(a, b).expect("it is in view");
    /// assert!((from[1] - to[1]).abs() < 1e-9 && from[1] < 50.0 && from[0] < to[0]);
    /// // A fisheye bends them.
    /// let fisheye = Projection::Fisheye { angle: 180.0, full_frame: false };
    /// let bent = Camera::with_projection(eye[0], eye[1], eye[2], fisheye)?.frame(100, 100);
    /// assert!(bent.project(a, b).is_none() && bent.paths(a, b).len() > 1);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn paths(&self, a: DVec3, b: DVec3) -> Vec<[[f64; 2]; 2]> {
        if let Some(line) = self.project(a, b) {
            return vec![line];
        }
        let eyes: &[Eye] = match self.stereo {
            Some(_) => &[Eye::Left, Eye::Right],
            None => &[Eye::Middle],
        };
        let mut pieces = Vec::new();
        for &eye in eyes {
            let points =
                (0..=PIECES).map(|i| self.seen(a + (b - a) * (f64::from(i) / f64::from(PIECES)), eye));
            let points: Vec<_> = points.collect();
            for pair in points.windows(2) {
                let &[Some(from), Some(to)] = pair else { continue };
                // What leaves a picture on one side and comes back on the other is no line across it.
                let far = (to - from).abs();
                if far.x < self.width * 0.5 && far.y < self.height * 0.5 {
                    pieces.push([from.to_array(), to.to_array()]);
                }
            }
        }
        pieces
    }

    /// Where in the picture an eye sees a point, if it does.
    fn seen(&self, p: DVec3, eye: Eye) -> Option<DVec2> {
        let p = self.camera_from_world(p);
        let (mut x, y, mut z) = (p.x, p.y, p.z);
        let mut place = DVec2::ZERO;
        if let Some(eyes) = self.stereo {
            let side = eyes.half * eye.side();
            match self.projection {
                Projection::Panorama { .. } | Projection::Cylindrical { .. } => {
                    // The tangent from the point to the circle on which the eyes are.
                    let r = hypot(x, z);
                    if r <= eyes.half {
                        return None;
                    }
                    // What the convergence turns rays by, at the horizon; elsewhere it is a little more.
                    let turn = side / eyes.convergence;
                    let c = 1.0 / (1.0 + turn * turn).sqrt();
                    let sin = side * c / r;
                    let cos = (1.0 - sin * sin).sqrt();
                    // As far as it is from the eye rather than from the middle.
                    (x, z) = ((x * cos - z * sin) * cos, (z * cos + x * sin) * cos);
                    (x, z) = ((x + z * turn) * c, (z - x * turn) * c);
                }
                Projection::Fisheye { .. } => {
                    // q / t + s is the unit vector that the ray from the middle has.
                    x -= side;
                    let s = side / eyes.convergence;
                    let k = 1.0 - s * s;
                    let root = (x * x * s * s + k * (x * x + y * y + z * z)).sqrt();
                    x += s * (x * s + root) / k;
                }
                Projection::Perspective { .. } | Projection::Orthographic { .. } => {
                    x += side * (z / eyes.convergence - 1.0);
                }
            }
            match (eyes.layout, eye) {
                (StereoLayout::SideBySide, Eye::Right) => place.x = self.width,
                (StereoLayout::TopBottom, Eye::Right) => place.y = self.height,
                _ => {}
            }
        }
        let (a, b) = match self.projection {
            Projection::Perspective { .. } if z > 1e-6 * max_abs(p) => (x / z, y / z),
            Projection::Orthographic { .. } if z > 0.0 => (x, y),
            Projection::Perspective { .. } | Projection::Orthographic { .. } => return None,
            Projection::Fisheye { angle, .. } => {
                let aside = hypot(x, y);
                let degrees = atan2(aside, z).to_degrees();
                if degrees > angle * 0.5 || !(aside > 0.0) {
                    return None;
                }
                (x / aside * degrees, y / aside * degrees)
            }
            Projection::Panorama { .. } => {
                let sine = y / DVec3::new(x, y, z).length();
                (atan2(x, z).to_degrees(), asin(sine.clamp(-1.0, 1.0)).to_degrees())
            }
            Projection::Cylindrical { .. } => (atan2(x, z).to_degrees(), y / hypot(x, z)),
        };
        let seen = DVec2::new(
            (a / self.tan_x + 1.0) * 0.5 * self.width,
            (1.0 - b / self.tan_y) * 0.5 * self.height,
        );
        let inside = seen.x >= 0.0 && seen.x <= self.width && seen.y >= 0.0 && seen.y <= self.height;
        inside.then_some(seen + place)
    }
}

/// Straight pieces that a line is drawn in where it is a curve.
const PIECES: u32 = 64;
