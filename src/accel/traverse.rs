//! Traversal: which leaves a ray may hit something in, nearest first.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

use super::{
    boxes::{Child, Node},
    build::Bvh,
    lanes::{Lanes, Simd, Task, prefetch},
    ray::RayBox,
};

/// What a visitor wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// The question is answered.
    Stop,
}

/// Is shown the leaves that a ray may hit something in.
pub trait Visitor {
    /// Looks at a leaf with the instructions at hand; may lower the bound to what it found.
    fn leaf<L: Lanes>(&mut self, lanes: L, leaf: Child, bound: &mut f32) -> Control;

    /// Where the blocks of leaves begin, and the bytes of one: memory to be asked for before it is needed. Of two
    /// kinds, those of one.
    fn blocks(&self) -> (*const u8, usize);
}

/// One number of each axis in all lanes. Written out: what has no features of its own, as a closure, may not be
/// inlined into what has.
#[inline(always)]
fn splat<L: Lanes>(lanes: L, [x, y, z, _]: [f32; 4]) -> [L::F8; 3] {
    [lanes.splat(x), lanes.splat(y), lanes.splat(z)]
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

/// Aligned to a line of the cache, and with it all else that a walk keeps on the processor's own stack: a register of
/// eight lanes that is put there must not straddle two lines.
#[repr(align(64))]
struct Stack([MaybeUninit<Waiting>; STACK]);

/// A walk through a tree.
struct Walk<'a, V, const ANY: bool> {
    bvh: &'a Bvh,
    ray: &'a RayBox,
    t_near: f32,
    bound: f32,
    visitor: &'a mut V,
}

impl<V: Visitor, const ANY: bool> Task for Walk<'_, V, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        self.bvh.traverse_with::<_, ANY>(
            lanes,
            Child::ROOT,
            self.ray,
            self.t_near,
            self.bound,
            self.visitor,
        );
    }
}

impl Bvh {
    /// Shows `visitor` each leaf whose box the ray enters between `t_near`, which is at most 0, and `bound`,
    /// roughly nearest first; with `ANY` in the order of what they promise.
    #[inline(always)]
    pub fn traverse<const ANY: bool>(
        &self,
        ray: &RayBox,
        t_near: f32,
        bound: f32,
        visitor: &mut impl Visitor,
    ) {
        self.traverse_by::<ANY>(Simd::detect(), ray, t_near, bound, visitor);
    }

    /// As [`Bvh::traverse`] to the end, by the same instructions on every machine: it visits the same leaves everywhere.
    pub fn traverse_everywhere(&self, ray: &RayBox, t_near: f32, bound: f32, visitor: &mut impl Visitor) {
        self.traverse_by::<true>(Simd::Portable, ray, t_near, bound, visitor);
    }

    #[inline(always)]
    fn traverse_by<const ANY: bool>(
        &self,
        simd: Simd,
        ray: &RayBox,
        t_near: f32,
        bound: f32,
        visitor: &mut impl Visitor,
    ) {
        simd.run(Walk::<_, ANY> {
            bvh: self,
            ray,
            t_near,
            bound,
            visitor,
        });
    }

    /// As [`Bvh::traverse`], with the instructions at hand, of what is below `from`.
    #[inline(always)]
    pub fn traverse_with<L: Lanes, const ANY: bool>(
        &self,
        lanes: L,
        from: Child,
        ray: &RayBox,
        t_near: f32,
        mut bound: f32,
        visitor: &mut impl Visitor,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let nodes = self.nodes.as_ptr();
        let (near, far) = (ray.near, ray.far);
        let inverse_near = splat(lanes, ray.inverse_near);
        let inverse_far = splat(lanes, ray.inverse_far);
        let offset_near = splat(lanes, ray.offset_near);
        let offset_far = splat(lanes, ray.offset_far);
        let t_near = lanes.splat(t_near);
        let (node_memory, block_memory) = ((nodes.cast(), size_of::<Node>()), visitor.blocks());
        let ask_for = |child: Child| prefetch_child(child, node_memory, block_memory);
        let Stack(stack) = &mut Stack([const { MaybeUninit::uninit() }; STACK]);
        let mut top = 0usize;
        let mut current = from;
        loop {
            while !current.is_leaf() {
                // SAFETY: node indices come from the builder, which makes each child's index that of a node.
                let node = unsafe { &*nodes.add(current.0 as usize) };
                // SAFETY: `near` and `far` are the places of its planes.
                let plane = |at: usize| unsafe { &*node.planes.as_ptr().byte_add(at) };
                let enter_x = lanes.mul_add(lanes.load(plane(near[0])), inverse_near[0], offset_near[0]);
                let enter_y = lanes.mul_add(lanes.load(plane(near[1])), inverse_near[1], offset_near[1]);
                let enter_z = lanes.mul_add(lanes.load(plane(near[2])), inverse_near[2], offset_near[2]);
                let leave_x = lanes.mul_add(lanes.load(plane(far[0])), inverse_far[0], offset_far[0]);
                let leave_y = lanes.mul_add(lanes.load(plane(far[1])), inverse_far[1], offset_far[1]);
                let leave_z = lanes.mul_add(lanes.load(plane(far[2])), inverse_far[2], offset_far[2]);
                let enter = lanes.max(lanes.max(enter_x, enter_y), lanes.max(enter_z, t_near));
                let leave = lanes.min(
                    lanes.min(leave_x, leave_y),
                    lanes.min(leave_z, lanes.splat(bound)),
                );
                let mut mask = lanes.at_most(enter, leave);
                if mask == 0 {
                    break;
                }
                let child = |lane: u32| node.children[lane as usize & 7];
                let first = mask.trailing_zeros();
                mask &= mask - 1;
                if mask == 0 {
                    current = child(first);
                    ask_for(current);
                    continue;
                }
                let mut push = |at: usize, waiting: Waiting| {
                    // SAFETY: the stack holds seven siblings for every level the tree can have.
                    unsafe { stack.get_unchecked_mut(at).write(waiting) };
                };
                if ANY {
                    // Children stand in ascending order of what they promise.
                    mask |= 1 << first;
                    let last = 31 - mask.leading_zeros();
                    mask ^= 1 << last;
                    current = child(last);
                    ask_for(current);
                    while mask != 0 {
                        let next = child(mask.trailing_zeros());
                        mask &= mask - 1;
                        ask_for(next);
                        push(
                            top,
                            Waiting {
                                child: next,
                                entry: 0.0,
                            },
                        );
                        top += 1;
                    }
                    continue;
                }
                let entries = lanes.store(enter);
                let waiting = |lane: u32| Waiting {
                    child: child(lane),
                    entry: entries[lane as usize & 7],
                };
                let second = mask.trailing_zeros();
                mask &= mask - 1;
                let (mut a, mut b) = (waiting(first), waiting(second));
                ask_for(a.child);
                ask_for(b.child);
                if b.entry < a.entry {
                    std::mem::swap(&mut a, &mut b);
                }
                let base = top;
                push(top, b);
                top += 1;
                if mask == 0 {
                    current = a.child;
                    continue;
                }
                push(top, a);
                top += 1;
                while mask != 0 {
                    let next = waiting(mask.trailing_zeros());
                    mask &= mask - 1;
                    ask_for(next.child);
                    // Kept in order, the nearest on top.
                    let mut place = top;
                    while place > base {
                        // SAFETY: written above, in this turn.
                        let below = unsafe { stack.get_unchecked(place - 1).assume_init() };
                        if below.entry >= next.entry {
                            break;
                        }
                        // SAFETY: as in `push`.
                        unsafe { stack.get_unchecked_mut(place).write(below) };
                        place -= 1;
                    }
                    // SAFETY: as in `push`.
                    unsafe { stack.get_unchecked_mut(place).write(next) };
                    top += 1;
                }
                top -= 1;
                // SAFETY: all places below `top` have been written.
                current = unsafe { stack.get_unchecked(top).assume_init() }.child;
            }
            if current.is_leaf() && visitor.leaf(lanes, current, &mut bound) == Control::Stop {
                return;
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                // SAFETY: all places below `top` have been written.
                let next = unsafe { stack.get_unchecked(top).assume_init() };
                if ANY || next.entry <= bound {
                    current = next.child;
                    break;
                }
            }
        }
    }
    /// Asks for the memory of a node before it is needed.
    #[inline(always)]
    pub(super) fn prefetch(&self, child: Child) {
        let nodes = self.nodes.as_ptr().cast();
        prefetch_child(child, (nodes, size_of::<Node>()), (nodes, 0));
    }
}

/// Asks for the memory of a node or a leaf before it is needed. `nodes` and `blocks` are the addresses of the
/// first and the bytes from one to the next.
#[inline(always)]
fn prefetch_child(child: Child, nodes: (*const u8, usize), blocks: (*const u8, usize)) {
    let (first, stride) = if child.is_leaf() { blocks } else { nodes };
    let at = first.wrapping_add(child.first() * stride);
    for line in 0..4 {
        prefetch(at.wrapping_add(64 * line));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accel::{BLOCK, Box32, Kinds, LeafKind, NONE, Primitive, cases, ray::Ray32},
        math::{Bounds3, DVec3, Ray},
    };

    fn boxes(n: usize) -> Vec<Bounds3> {
        let mut next = crate::accel::random(1);
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
    fn build(boxes: &[Bounds3], kinds: Kinds) -> (Bvh, [Vec<[u32; BLOCK]>; 2]) {
        let primitives = boxes
            .iter()
            .zip(0..)
            .map(|(b, index)| Primitive::new(index, Box32::around(b), 1.0))
            .collect();
        let (bvh, leaves) = Bvh::build(primitives, kinds, 0.0, |_| [DVec3::ZERO; 3], || false);
        (bvh, [leaves.triangles, leaves.spheres])
    }

    /// Notes what it is shown.
    #[derive(Default)]
    struct Shown(Vec<Child>);

    impl Visitor for Shown {
        fn leaf<L: Lanes>(&mut self, _: L, leaf: Child, _: &mut f32) -> Control {
            self.0.push(leaf);
            Control::Continue
        }

        fn blocks(&self) -> (*const u8, usize) {
            (std::ptr::null(), 0)
        }
    }

    /// The primitives whose leaves a ray visits.
    fn visited<const ANY: bool>(
        bvh: &Bvh,
        blocks: &[Vec<[u32; BLOCK]>; 2],
        ray: &Ray,
        simd: Simd,
    ) -> Vec<u32> {
        let prepared = RayBox::new(&Ray32::new(ray), bvh.extent());
        let mut leaves = Shown::default();
        bvh.traverse_by::<ANY>(simd, &prepared, 0.0, f32::INFINITY, &mut leaves);
        let primitives = |leaf: &Child| match leaf.kind() {
            LeafKind::Others => bvh.others(*leaf).to_vec(),
            kind => leaf
                .range()
                .flat_map(|block| blocks[kind as usize][block])
                .filter(|&index| index != NONE)
                .collect(),
        };
        let mut seen: Vec<u32> = leaves.0.iter().flat_map(primitives).collect();
        seen.sort_unstable();
        seen
    }

    #[test]
    fn every_box_a_ray_enters_is_visited() {
        for n in [1, 2, 7, 100, 5000].map(cases) {
            let boxes = boxes(n);
            for kinds in [(0, 0), (n, 0), (n / 3, n / 3)] {
                let kinds = Kinds {
                    triangles: kinds.0,
                    spheres: kinds.1,
                };
                let (bvh, blocks) = build(&boxes, kinds);
                for i in 0..cases(100) {
                    let angle = i as f64;
                    let dir = DVec3::new(crate::math::sin(angle), crate::math::cos(angle * 1.3), 0.3);
                    let ray = Ray::new(DVec3::new(0.1, -0.2, 0.05) - dir * 3.0, dir);
                    for simd in Simd::all() {
                        let seen = visited::<false>(&bvh, &blocks, &ray, simd);
                        assert_eq!(seen, visited::<true>(&bvh, &blocks, &ray, simd), "{simd:?}");
                        for (b, index) in boxes.iter().zip(0..) {
                            assert!(seen.binary_search(&index).is_ok() || !enters(b, &ray), "{simd:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn equal_centers_neither_recurse_nor_loop() {
        let boxes = vec![Bounds3::new(DVec3::ZERO, DVec3::ONE); cases(100_000)];
        let (bvh, blocks) = build(
            &boxes,
            Kinds {
                triangles: cases(30_000),
                spheres: cases(30_000),
            },
        );
        let ray = Ray::new(DVec3::splat(0.5), DVec3::X);
        for simd in Simd::all() {
            assert!(
                visited::<false>(&bvh, &blocks, &ray, simd)
                    .into_iter()
                    .eq(0..cases(100_000) as u32)
            );
        }
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_enters() {
        let (bvh, blocks) = build(&[Bounds3::new(DVec3::ZERO, DVec3::ONE)], Kinds::default());
        for dir in [DVec3::X, -DVec3::X, DVec3::new(1.0, 0.0, -0.0)] {
            let ray = Ray::new(DVec3::new(0.5, 1.0, 1.0), dir);
            for simd in Simd::all() {
                assert_eq!(visited::<false>(&bvh, &blocks, &ray, simd), [0], "{dir} {simd:?}");
            }
        }
    }
}
