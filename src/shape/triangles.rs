//! The ray-triangle test of [`triangle`](super::triangle) for many rays from one point, each with its own triangle.
//!
//! The same operations in the same order give the same bits; that they stand in loops over arrays lets the compiler
//! take several rays at once.

#![allow(clippy::indexing_slicing, reason = "lanes are counted by constants")]

use super::triangle::{TriangleHit, along_the_longest_edge, is_sliver, ordered, spans};
use crate::math::Ray;

/// Most rays at once.
pub(crate) const MANY: usize = 16;

/// One number for each ray.
type Row = [f64; MANY];

/// Rays from one point and the triangles they may hit.
pub(crate) struct ManyTriangles {
    len: usize,
    /// Directions and corners relative to the common origin, their axes in each ray's order.
    dir: [Row; 3],
    corners: [[Row; 3]; 3],
    hits: [Row; 3],
    /// 1 where a triangle is met and seen as a line, which is decided by itself.
    slivers: Row,
}

impl ManyTriangles {
    pub(crate) const EMPTY: Self = Self {
        len: 0,
        dir: [[1.0; MANY]; 3],
        corners: [[[0.0; MANY]; 3]; 3],
        hits: [[0.0; MANY]; 3],
        slivers: [0.0; MANY],
    };

    /// Adds a ray, which has a finite direction that is not zero, and its triangle; no more than [`MANY`]. The axes of
    /// the corners are in the ray's order, `axes`.
    #[inline(always)]
    pub(crate) fn push(&mut self, ray: &Ray, axes: [usize; 3], corners: [[f64; 3]; 3]) {
        let at = self.len & (MANY - 1);
        self.len = at + 1;
        let (origin, dir) = (ordered(axes, &ray.origin), ordered(axes, &ray.dir));
        for k in 0..3 {
            self.dir[k][at] = dir[k];
            for (row, corner) in self.corners.iter_mut().zip(corners) {
                row[k][at] = corner[k] - origin[k];
            }
        }
    }

    /// Tests all pairs and calls `visit` with a pair's place and where its ray meets its triangle.
    #[inline(always)]
    pub(crate) fn intersect(&mut self, mut visit: impl FnMut(usize, TriangleHit)) {
        let [dx, dy, dz] = &self.dir;
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = &self.corners;
        let [ts, us, vs] = &mut self.hits;
        // Whole registers: what lies beyond is tested too, and not looked at.
        for i in 0..self.len.next_multiple_of(4).min(MANY) {
            let (shear_x, shear_y, t_per_z) = (dx[i] / dz[i], dy[i] / dz[i], 1.0 / dz[i]);
            let (az, bz, cz) = (az[i], bz[i], cz[i]);
            let (ax, ay) = (ax[i] - shear_x * az, ay[i] - shear_y * az);
            let (bx, by) = (bx[i] - shear_x * bz, by[i] - shear_y * bz);
            let (cx, cy) = (cx[i] - shear_x * cz, cy[i] - shear_y * cz);
            let wa = cx * by - cy * bx;
            let wb = ax * cy - ay * cx;
            let wc = bx * ay - by * ax;
            let front = (wa >= 0.0) & (wb >= 0.0) & (wc >= 0.0);
            let back = (wa <= 0.0) & (wb <= 0.0) & (wc <= 0.0);
            let det = wa + wb + wc;
            let per_det = 1.0 / det;
            let sliver = is_sliver(det, [cx * by, ax * cy, bx * ay]);
            let (wa, u, v) = (wa * per_det, wb * per_det, wc * per_det);
            let t = (wa * az + u * bz + v * cz) * t_per_z;
            let on_edge = (wa == 0.0) | (wb == 0.0) | (wc == 0.0);
            let within = spans(ax, bx, cx) & spans(ay, by, cy);
            let met = (front | back) & (det != 0.0) & (!on_edge | within);
            ts[i] = if met { t } else { f64::NAN };
            us[i] = u;
            vs[i] = v;
            self.slivers[i] = if met & sliver { 1.0 } else { 0.0 };
        }
        for i in 0..self.len {
            let [t, u, v] = if self.slivers[i] == 0.0 {
                [self.hits[0][i], self.hits[1][i], self.hits[2][i]]
            } else {
                self.along_the_longest_edge(i)
            };
            if t.is_finite() {
                visit(i, TriangleHit { t, u, v });
            }
        }
        self.len = 0;
    }

    /// t, u and v where a triangle is met and seen as a line.
    #[cold]
    #[inline(never)]
    fn along_the_longest_edge(&self, i: usize) -> [f64; 3] {
        let [dx, dy, dz] = [0, 1, 2].map(|k| self.dir[k][i]);
        let corners = self.corners.map(|corner| [0, 1, 2].map(|k| corner[k][i]));
        let across = corners.map(|[x, y, z]| (x - dx / dz * z, y - dy / dz * z));
        let [wa, u, v] = along_the_longest_edge(across);
        let [az, bz, cz] = corners.map(|[_, _, z]| z);
        [(wa * az + u * bz + v * cz) * (1.0 / dz), u, v]
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{suite::Rng, triangle::TriangleRay},
        *,
    };
    use crate::math::DVec3;

    #[test]
    fn many_give_the_bits_of_one() {
        let mut rng = Rng::new(35);
        let mut met = 0;
        for round in 0..2000 {
            let scale = rng.magnitude(-6.0, 6.0);
            let origin = rng.in_cube() * scale;
            let pairs: Vec<(Ray, [DVec3; 3])> = (0..1 + round % MANY)
                .map(|i| {
                    let mut corners = [0; 3].map(|_| rng.in_cube() * scale);
                    // At corners, edges and the inside, and now and then at nothing or a degenerate triangle.
                    let aim = match i % 5 {
                        0 => corners[0],
                        1 => corners[0] + (corners[1] - corners[0]) * rng.unit(),
                        2 => rng.in_cube() * scale,
                        _ => (corners[0] + corners[1] + corners[2]) / 3.0,
                    };
                    if i % 17 == 0 {
                        corners[2] = corners[1];
                    }
                    // Now and then as good as seen from its edge.
                    if i % 7 == 6 {
                        let along = (aim - origin) * rng.unit() + rng.in_cube() * scale * 1e-12;
                        corners[2] = corners[0] + (corners[1] - corners[0]) * rng.unit() + along;
                    }
                    let mut dir = (aim - origin) * rng.magnitude(-3.0, 3.0);
                    if i % 11 == 0 {
                        dir.y = dir.x;
                    }
                    (Ray::new(origin, dir), corners)
                })
                .collect();
            let mut many = ManyTriangles::EMPTY;
            for (ray, corners) in &pairs {
                let axes = TriangleRay::axes(ray.dir);
                many.push(ray, axes, corners.map(|corner| ordered(axes, &corner)));
            }
            let mut found = vec![None; pairs.len()];
            many.intersect(|i, hit| found[i] = Some(hit));
            let bits = |hit: Option<TriangleHit>| hit.map(|h| [h.t, h.u, h.v].map(f64::to_bits));
            for ((ray, [a, b, c]), found) in pairs.into_iter().zip(found) {
                let alone = TriangleRay::new(&ray).intersect([&a, &b, &c]);
                assert_eq!(bits(found), bits(alone), "{ray:?} {a} {b} {c}");
                met += usize::from(found.is_some());
            }
        }
        assert!(met > 5_000, "{met}");
    }
}
