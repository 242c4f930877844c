//! Traversal: which primitives a ray may hit, nearest boxes first.

use super::{
    boxes::{Child, Node, round_down, round_up},
    build::Bvh,
};
use crate::math::Ray;

/// What a visitor wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// The question is answered.
    Stop,
}

/// A ray prepared for conservative box tests in f32.
///
/// The distance to a plane p is (p - o) / d. For the entry into a box it must not come out too large, for the
/// exit not too small: o is rounded to the side that makes it so, and 1/d is shrunk or stretched by 8 units in
/// the last place, more than the three roundings of the computation together. Distances that are negative may
/// then be off in the other direction, but stay negative, which is all that is asked of them.
#[derive(Clone, Copy, Debug)]
pub struct RayBox {
    /// Plane arrays to take for entry, by axis; the exit's is the other of the pair.
    near: [usize; 3],
    far: [usize; 3],
    origin_near: [f32; 3],
    origin_far: [f32; 3],
    inverse_near: [f32; 3],
    inverse_far: [f32; 3],
}

impl RayBox {
    /// Prepares a ray.
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let mut prepared = Self {
            near: [0, 1, 2],
            far: [3, 4, 5],
            origin_near: [0.0; 3],
            origin_far: [0.0; 3],
            inverse_near: [0.0; 3],
            inverse_far: [0.0; 3],
        };
        let slack = 8.0 * f64::from(f32::EPSILON);
        for k in 0..3 {
            let (o, d) = (ray.origin[k], ray.dir[k]);
            // Finite, so that 0 * inverse is 0: a ray in the plane of a face is inside.
            let inverse = |x: f64| x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
            prepared.inverse_near[k] = inverse((1.0 - slack) / d);
            prepared.inverse_far[k] = inverse((1.0 + slack) / d);
            if d.is_sign_negative() {
                (prepared.near[k], prepared.far[k]) = (k + 3, k);
                (prepared.origin_near[k], prepared.origin_far[k]) = (round_down(o), round_up(o));
            } else {
                (prepared.origin_near[k], prepared.origin_far[k]) = (round_up(o), round_down(o));
            }
        }
        prepared
    }

    /// Entry distances of the eight boxes, infinite where the ray misses or enters beyond `t_max`.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> [f32; 8] {
        let mut entry = [0.0f32; 8];
        let mut exit = [t_max; 8];
        for k in 0..3 {
            let (near, far) = (&node.planes[self.near[k]], &node.planes[self.far[k]]);
            for lane in 0..8 {
                let t_near = (near[lane] - self.origin_near[k]) * self.inverse_near[k];
                let t_far = (far[lane] - self.origin_far[k]) * self.inverse_far[k];
                entry[lane] = if t_near > entry[lane] { t_near } else { entry[lane] };
                exit[lane] = if t_far < exit[lane] { t_far } else { exit[lane] };
            }
        }
        for lane in 0..8 {
            entry[lane] = if entry[lane] <= exit[lane] {
                entry[lane]
            } else {
                f32::INFINITY
            };
        }
        entry
    }
}

/// Seven siblings wait at each of at most 30 levels (see `SAH_DEPTH` in the builder).
const STACK: usize = 7 * 34;

impl Bvh {
    /// Calls `visit` with each primitive whose surroundings the ray enters before `t_max`, roughly nearest
    /// first. `visit` may lower `t_max` to what it found.
    #[inline]
    pub fn traverse(&self, ray: &RayBox, t_max: &mut f64, mut visit: impl FnMut(u32, &mut f64) -> Control) {
        let Some(root) = self.nodes.first() else { return };
        let mut stack = [(Child(0), 0.0f32); STACK];
        let mut top = 0;
        let mut node = root;
        let mut bound = round_up(*t_max);
        loop {
            let entry = ray.enter(node, bound);
            let base = top;
            for lane in 0..8 {
                if entry[lane] < f32::INFINITY {
                    // Kept in order, the nearest on top.
                    let mut place = top;
                    while place > base && stack[place - 1].1 < entry[lane] {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = (node.children[lane], entry[lane]);
                    top += 1;
                }
            }
            node = loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let (child, entry) = stack[top];
                if entry > bound {
                    continue;
                }
                if !child.is_leaf() {
                    break &self.nodes[child.0 as usize];
                }
                for &primitive in &self.order[child.range()] {
                    if visit(primitive, t_max) == Control::Stop {
                        return;
                    }
                }
                bound = round_up(*t_max);
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::Box32,
        math::{Bounds3, DVec3},
    };

    fn boxes(n: usize) -> Vec<Bounds3> {
        let mut state = 1u64;
        let mut next = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..n)
            .map(|_| {
                let p = DVec3::new(next(), next(), next()) * 10.0 - 5.0;
                Bounds3::new(p, p + DVec3::new(next(), next(), next()) * 0.5)
            })
            .collect()
    }

    fn enters(b: &Bounds3, ray: &Ray) -> bool {
        let (mut t0, mut t1) = (0.0f64, f64::INFINITY);
        for k in 0..3 {
            let (a, b) = (
                (b.min[k] - ray.origin[k]) / ray.dir[k],
                (b.max[k] - ray.origin[k]) / ray.dir[k],
            );
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        t0 <= t1
    }

    #[test]
    fn every_box_a_ray_enters_is_visited() {
        for n in [1, 2, 7, 100, 5000] {
            let boxes = boxes(n);
            let bvh = Bvh::build(&boxes.iter().map(Box32::around).collect::<Vec<_>>());
            let mut order = bvh.order.clone();
            order.sort_unstable();
            assert!(
                order.iter().copied().eq(0..n as u32),
                "each primitive stands in the order once"
            );
            for i in 0..200u32 {
                let angle = f64::from(i);
                let dir = DVec3::new(crate::math::sin(angle), crate::math::cos(angle * 1.3), 0.3);
                let ray = Ray::new(DVec3::new(0.1, -0.2, 0.05) - dir * 3.0, dir);
                let mut seen = vec![false; n];
                bvh.traverse(&RayBox::new(&ray), &mut f64::INFINITY.clone(), |p, _| {
                    seen[p as usize] = true;
                    Control::Continue
                });
                for (b, seen) in boxes.iter().zip(seen) {
                    assert!(seen || !enters(b, &ray));
                }
            }
        }
    }

    #[test]
    fn equal_centers_neither_recurse_nor_loop() {
        let b = Box32::around(&Bounds3::new(DVec3::ZERO, DVec3::ONE));
        let bvh = Bvh::build(&vec![b; 100_000]);
        let mut count = 0;
        let ray = Ray::new(DVec3::splat(0.5), DVec3::X);
        bvh.traverse(&RayBox::new(&ray), &mut f64::INFINITY.clone(), |_, _| {
            count += 1;
            Control::Continue
        });
        assert_eq!(count, 100_000);
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_enters() {
        let b = Box32::around(&Bounds3::new(DVec3::ZERO, DVec3::ONE));
        let bvh = Bvh::build(&[b]);
        for dir in [DVec3::X, -DVec3::X, DVec3::new(1.0, 0.0, -0.0)] {
            let ray = Ray::new(DVec3::new(0.5, 1.0, 1.0), dir);
            let mut hit = false;
            bvh.traverse(&RayBox::new(&ray), &mut f64::INFINITY.clone(), |_, _| {
                hit = true;
                Control::Stop
            });
            assert!(hit, "{dir}");
        }
    }
}
