//! Traversal: which leaves a ray may hit something in, nearest first.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

#[cfg(target_arch = "x86_64")]
use super::lanes::Avx2;
use super::{
    boxes::{Child, Node, round_up},
    build::Bvh,
    lanes::{Lanes, Portable, Simd, prefetch},
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
    #[inline]
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
        const SLACK: f32 = 8.0 * f32::EPSILON;
        for k in 0..3 {
            let (o, d) = (ray.origin[k] as f32, ray.dir[k]);
            // A whole unit in the last place to either side, where rounding took half of one at the most.
            let ulp = o.abs() * f32::EPSILON + f32::MIN_POSITIVE;
            // Finite, so that 0 * inverse is 0: a ray in the plane of a face is inside.
            let inverse = ((1.0 / d) as f32).clamp(f32::MIN, f32::MAX);
            prepared.inverse_near[k] = inverse * (1.0 - SLACK);
            prepared.inverse_far[k] = (inverse * (1.0 + SLACK)).clamp(f32::MIN, f32::MAX);
            if d.is_sign_negative() {
                (prepared.near[k], prepared.far[k]) = (k + 3, k);
                (prepared.origin_near[k], prepared.origin_far[k]) = (o - ulp, o + ulp);
            } else {
                (prepared.origin_near[k], prepared.origin_far[k]) = (o + ulp, o - ulp);
            }
        }
        prepared
    }
}

/// Seven siblings wait at each level, and a level takes up at least one of the binary tree's: 48 by area
/// (`SAH_DEPTH` in the builder), then 27 halvings.
const STACK: usize = 7 * (48 + 27 + 1);

/// Where a ray has still to go.
#[derive(Clone, Copy)]
struct Waiting {
    child: Child,
    entry: f32,
}

impl Bvh {
    /// Calls `visit` with each leaf whose box the ray enters before `t_max`, roughly nearest first; with `ANY` in
    /// no particular order. `visit` may lower the bound it is given to what it found.
    #[inline]
    pub fn traverse<const ANY: bool>(
        &self,
        ray: &RayBox,
        t_max: f64,
        visit: impl FnMut(Child, &mut f32) -> Control,
    ) {
        let bound = round_up(t_max);
        // SAFETY: `detect` names only what the processor has.
        unsafe {
            match Simd::detect() {
                Simd::Portable => self.traverse_with::<Portable, ANY>(ray, bound, visit),
                #[cfg(target_arch = "x86_64")]
                Simd::Avx2 => self.traverse_avx2::<ANY>(ray, bound, visit),
            }
        }
    }

    /// # Safety
    /// The processor must have these features.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,lzcnt")]
    unsafe fn traverse_avx2<const ANY: bool>(
        &self,
        ray: &RayBox,
        bound: f32,
        visit: impl FnMut(Child, &mut f32) -> Control,
    ) {
        // SAFETY: the caller's promise.
        unsafe { self.traverse_with::<Avx2, ANY>(ray, bound, visit) }
    }

    /// The traversal itself, for any lanes.
    ///
    /// # Safety
    /// The processor must have the instructions of `L`.
    #[inline(always)]
    unsafe fn traverse_with<L: Lanes, const ANY: bool>(
        &self,
        ray: &RayBox,
        mut bound: f32,
        mut visit: impl FnMut(Child, &mut f32) -> Control,
    ) {
        // SAFETY: the caller promises the instructions of `L`. Node indices come from the builder, which makes
        // each child's index that of a node; the stack holds seven siblings for every level the tree can have.
        unsafe {
            if self.nodes.is_empty() {
                return;
            }
            let nodes = self.nodes.as_ptr();
            let near = ray.near;
            let far = ray.far;
            let origin_near = ray.origin_near.map(|x| L::splat(x));
            let origin_far = ray.origin_far.map(|x| L::splat(x));
            let inverse_near = ray.inverse_near.map(|x| L::splat(x));
            let inverse_far = ray.inverse_far.map(|x| L::splat(x));
            let zero = L::splat(0.0);
            let mut stack: [MaybeUninit<Waiting>; STACK] = [const { MaybeUninit::uninit() }; STACK];
            let mut top = 0usize;
            let mut current = Child(0);
            loop {
                while !current.is_leaf() {
                    let node = &*nodes.add(current.0 as usize);
                    let distance = |plane: usize, origin: L::F, inverse: L::F| {
                        L::mul(L::sub(L::load(node.planes.get_unchecked(plane)), origin), inverse)
                    };
                    let enter_x = distance(near[0], origin_near[0], inverse_near[0]);
                    let enter_y = distance(near[1], origin_near[1], inverse_near[1]);
                    let enter_z = distance(near[2], origin_near[2], inverse_near[2]);
                    let leave_x = distance(far[0], origin_far[0], inverse_far[0]);
                    let leave_y = distance(far[1], origin_far[1], inverse_far[1]);
                    let leave_z = distance(far[2], origin_far[2], inverse_far[2]);
                    let enter = L::max(L::max(enter_x, enter_y), L::max(enter_z, zero));
                    let leave = L::min(L::min(leave_x, leave_y), L::min(leave_z, L::splat(bound)));
                    let mut mask = L::at_most(enter, leave);
                    if mask == 0 {
                        break;
                    }
                    let child = |lane: u32| *node.children.get_unchecked(lane as usize & 7);
                    let first = mask.trailing_zeros();
                    mask &= mask - 1;
                    if mask == 0 {
                        current = child(first);
                        continue;
                    }
                    if ANY {
                        // Children stand in ascending order of what they promise.
                        mask |= 1 << first;
                        let last = 31 - mask.leading_zeros();
                        mask ^= 1 << last;
                        current = child(last);
                        self.prefetch(current);
                        while mask != 0 {
                            let next = child(mask.trailing_zeros());
                            mask &= mask - 1;
                            self.prefetch(next);
                            stack.get_unchecked_mut(top).write(Waiting {
                                child: next,
                                entry: 0.0,
                            });
                            top += 1;
                        }
                        continue;
                    }
                    let entries = L::store(enter);
                    let waiting = |lane: u32| Waiting {
                        child: child(lane),
                        entry: entries[lane as usize & 7],
                    };
                    let second = mask.trailing_zeros();
                    mask &= mask - 1;
                    let (mut a, mut b) = (waiting(first), waiting(second));
                    self.prefetch(a.child);
                    self.prefetch(b.child);
                    if b.entry < a.entry {
                        std::mem::swap(&mut a, &mut b);
                    }
                    let base = top;
                    stack.get_unchecked_mut(top).write(b);
                    top += 1;
                    if mask == 0 {
                        current = a.child;
                        continue;
                    }
                    stack.get_unchecked_mut(top).write(a);
                    top += 1;
                    while mask != 0 {
                        let next = waiting(mask.trailing_zeros());
                        mask &= mask - 1;
                        self.prefetch(next.child);
                        // Kept in order, the nearest on top.
                        let mut place = top;
                        while place > base {
                            let below = stack.get_unchecked(place - 1).assume_init();
                            if below.entry >= next.entry {
                                break;
                            }
                            stack.get_unchecked_mut(place).write(below);
                            place -= 1;
                        }
                        stack.get_unchecked_mut(place).write(next);
                        top += 1;
                    }
                    top -= 1;
                    current = stack.get_unchecked(top).assume_init().child;
                }
                if current.is_leaf() && visit(current, &mut bound) == Control::Stop {
                    return;
                }
                loop {
                    if top == 0 {
                        return;
                    }
                    top -= 1;
                    let next = stack.get_unchecked(top).assume_init();
                    if ANY || next.entry <= bound {
                        current = next.child;
                        break;
                    }
                }
            }
        }
    }

    /// Asks for a node's memory before it is needed.
    #[inline(always)]
    fn prefetch(&self, child: Child) {
        if !child.is_leaf() {
            let node = self.nodes.as_ptr().wrapping_add(child.0 as usize).cast::<u8>();
            for line in 0..size_of::<Node>() / 64 {
                prefetch(node.wrapping_add(64 * line));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::{Box32, Kinds, LeafKind, Primitive},
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

    /// A tree with its blocks as plain lists.
    fn build(boxes: &[Bounds3], kinds: Kinds) -> (Bvh, [Vec<Vec<u32>>; 2]) {
        let mut blocks = [const { Vec::new() }; 2];
        let primitives: Vec<Primitive> = boxes
            .iter()
            .map(|b| Primitive {
                bounds: Box32::around(b),
                area: 1.0,
            })
            .collect();
        let bvh = Bvh::build(&primitives, kinds, |kind, indices| {
            blocks[kind as usize].push(indices.to_vec())
        });
        (bvh, blocks)
    }

    /// The primitives whose leaves a ray visits, with both sets of instructions.
    fn visited(bvh: &Bvh, blocks: &[Vec<Vec<u32>>; 2], ray: &Ray) -> Vec<u32> {
        let prepared = RayBox::new(ray);
        let primitives = |leaf: Child| match leaf.kind() {
            LeafKind::Others => bvh.others(leaf).to_vec(),
            kind => leaf
                .range()
                .flat_map(|block| blocks[kind as usize][block].clone())
                .collect(),
        };
        let (mut fast, mut plain) = (Vec::new(), Vec::new());
        bvh.traverse::<false>(&prepared, f64::INFINITY, |leaf, _| {
            fast.extend(primitives(leaf));
            Control::Continue
        });
        // SAFETY: plain arithmetic.
        unsafe {
            bvh.traverse_with::<Portable, true>(&prepared, f32::INFINITY, |leaf, _| {
                plain.extend(primitives(leaf));
                Control::Continue
            });
        }
        fast.sort_unstable();
        plain.sort_unstable();
        assert_eq!(fast, plain, "the instructions do not matter");
        fast
    }

    #[test]
    fn every_box_a_ray_enters_is_visited() {
        for n in [1, 2, 7, 100, 5000] {
            let boxes = boxes(n);
            for kinds in [(0, 0), (n, 0), (n / 3, n / 3)] {
                let kinds = Kinds {
                    triangles: kinds.0,
                    spheres: kinds.1,
                };
                let (bvh, blocks) = build(&boxes, kinds);
                for i in 0..100u32 {
                    let angle = f64::from(i);
                    let dir = DVec3::new(crate::math::sin(angle), crate::math::cos(angle * 1.3), 0.3);
                    let ray = Ray::new(DVec3::new(0.1, -0.2, 0.05) - dir * 3.0, dir);
                    let seen = visited(&bvh, &blocks, &ray);
                    for (b, index) in boxes.iter().zip(0..) {
                        assert!(seen.binary_search(&index).is_ok() || !enters(b, &ray));
                    }
                }
            }
        }
    }

    #[test]
    fn equal_centers_neither_recurse_nor_loop() {
        let boxes = vec![Bounds3::new(DVec3::ZERO, DVec3::ONE); 100_000];
        let (bvh, blocks) = build(
            &boxes,
            Kinds {
                triangles: 30_000,
                spheres: 30_000,
            },
        );
        let ray = Ray::new(DVec3::splat(0.5), DVec3::X);
        assert!(visited(&bvh, &blocks, &ray).into_iter().eq(0..100_000));
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_enters() {
        let (bvh, blocks) = build(&[Bounds3::new(DVec3::ZERO, DVec3::ONE)], Kinds::default());
        for dir in [DVec3::X, -DVec3::X, DVec3::new(1.0, 0.0, -0.0)] {
            let ray = Ray::new(DVec3::new(0.5, 1.0, 1.0), dir);
            assert_eq!(visited(&bvh, &blocks, &ray), [0], "{dir}");
        }
    }
}
