//! The watertight ray-triangle test (to be replaced by the branch that carries it).
use crate::math::{DVec3, Ray};
/// ray
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    k: [usize; 3],
    s: DVec3,
    origin: DVec3,
}
/// hit
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit {
    /// t
    pub t: f64,
    /// u
    pub u: f64,
    /// v
    pub v: f64,
}
impl TriangleRay {
    /// new
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.dir;
        let a = d.abs();
        let kz = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        if d[kz] < 0.0 {
            std::mem::swap(&mut kx, &mut ky);
        }
        Self {
            k: [kx, ky, kz],
            s: DVec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]),
            origin: ray.origin,
        }
    }
    /// intersect
    #[inline]
    #[must_use]
    pub fn intersect(&self, a: DVec3, b: DVec3, c: DVec3) -> Option<TriangleHit> {
        let [kx, ky, kz] = self.k;
        let (a, b, c) = (a - self.origin, b - self.origin, c - self.origin);
        let (ax, ay) = (a[kx] - self.s.x * a[kz], a[ky] - self.s.y * a[kz]);
        let (bx, by) = (b[kx] - self.s.x * b[kz], b[ky] - self.s.y * b[kz]);
        let (cx, cy) = (c[kx] - self.s.x * c[kz], c[ky] - self.s.y * c[kz]);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if !(det != 0.0) {
            return None;
        }
        let t = u * (self.s.z * a[kz]) + v * (self.s.z * b[kz]) + w * (self.s.z * c[kz]);
        let inv = 1.0 / det;
        Some(TriangleHit {
            t: t * inv,
            u: v * inv,
            v: w * inv,
        })
    }
}
