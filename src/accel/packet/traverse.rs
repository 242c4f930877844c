//! Traversal by packet: which leaves its rays may hit something in, nearest first.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

#[cfg(target_arch = "x86_64")]
use super::wide::Avx2;
use super::{
    DONE, HasRay, PACKET, ROUNDING, RayPacket, Row, Search, Sign,
    leaves::Seen,
    pending::Pending,
    wide::{Plain, Wide},
};
use crate::accel::{
    Bvh, Child, LeafKind, NONE, Spot,
    blocks::{BLOCK, Spheres, Triangles},
    boxes::Node,
    cuboids::Cuboids,
    lanes::prefetch,
};

/// Decides in f64 what a packet's rays hit. Each question is answered by the ray's new bound: nothing beyond counts
/// for it any more; [`DONE`] where nothing counts at all.
pub trait Decide {
    /// The rays go together. May lower their bounds before the tree is looked at.
    fn begin(&mut self, packet: &mut RayPacket);
    /// A ray may hit these triangles.
    fn triangles(&mut self, ray: usize, spots: &[Spot]) -> f32;
    /// As the search ends: each ray may hit the triangle it stands with. The answer goes to
    /// [`RayPacket::lower_bound`].
    fn last(&mut self, pairs: &[(u8, Spot)], packet: &mut RayPacket);
    /// A ray may hit a sphere.
    fn sphere(&mut self, ray: usize, id: u32) -> f32;
    /// Rays, one bit for each, may hit a box or a primitive of another kind. The answers go to
    /// [`RayPacket::lower_bound`].
    fn other(&mut self, rays: u64, index: u32, packet: &mut RayPacket);
    /// A ray may hit what is below a node, and hardly another ray does; nothing beyond `bound` counts.
    fn alone(&mut self, ray: usize, below: Child, bound: f32) -> f32;
    /// Whether a triangle or sphere that is certainly hit, a primitive of this number, ends the search of whoever hits it.
    fn ends(&self, id: u32) -> bool;
}

/// What a tree's leaves refer to.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// The tree.
    pub bvh: &'a Bvh,
    /// Blocks of triangles.
    pub triangles: &'a [Triangles],
    /// Blocks of spheres.
    pub spheres: &'a [Spheres],
    /// What is added to the number of a sphere for its number among all primitives.
    pub first_sphere: u32,
    /// Blocks of boxes.
    pub cuboids: &'a [Cuboids],
    /// Largest coordinate of the boxes in those.
    pub cuboid_extent: f32,
}

impl Place<'_> {
    /// Asks for a child's memory before it is needed.
    #[inline(always)]
    fn prefetch(&self, child: Child) {
        if child.is_leaf() && child.kind() == LeafKind::Triangles {
            let block = self
                .triangles
                .as_ptr()
                .wrapping_add(child.range().start)
                .cast::<u8>();
            for line in 0..size_of::<Triangles>().div_ceil(64) {
                prefetch(block.wrapping_add(64 * line));
            }
        } else {
            self.bvh.prefetch(child);
        }
    }
}

/// As many shadow rays go on by themselves from a node that no others enter, and as many others of one register.
const ALONE: [u32; 2] = [8, 2];

/// As in `accel/traverse.rs`.
const STACK: usize = 7 * (48 + 27 + 1);

#[derive(Clone, Copy)]
struct Waiting {
    child: Child,
    /// The node that holds the child's box, times eight, plus its lane.
    place: u32,
    entry: f32,
    /// Registers of rays that reach the node, one bit for each.
    groups: u32,
}

/// The planes of a box as seen from the origin, in all lanes. Where directions are mixed, which is nearer differs.
struct Slab<W: Wide> {
    near: [W::F; 3],
    far: [W::F; 3],
    mixed: bool,
}

impl RayPacket {
    /// Searches a tree with all rays at once; with `ANY` in the order in which shadow rays look. `bounds` are what
    /// each ray asks for, rounded up. False where the rays do not go together: then nothing was done.
    #[inline]
    pub fn search<const ANY: bool>(
        &mut self,
        place: &Place<'_>,
        rays: &[impl HasRay],
        bounds: &[f32],
        search: &Search<'_>,
        decide: &mut impl Decide,
    ) -> bool {
        #[cfg(target_arch = "x86_64")]
        if crate::accel::Simd::detect() >= crate::accel::Simd::Avx2 {
            // SAFETY: `detect` names only what the processor has, and AVX2 only together with FMA.
            return unsafe { self.search_avx2::<ANY>(place, rays, bounds, search, decide) };
        }
        self.search_with::<_, ANY>(Plain, place, rays, bounds, search, decide)
    }

    /// # Safety
    /// The processor must have these features.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt")]
    unsafe fn search_avx2<const ANY: bool>(
        &mut self,
        place: &Place<'_>,
        rays: &[impl HasRay],
        bounds: &[f32],
        search: &Search<'_>,
        decide: &mut impl Decide,
    ) -> bool {
        // SAFETY: the caller's promise.
        let w = unsafe { Avx2::assume() };
        self.search_with::<_, ANY>(w, place, rays, bounds, search, decide)
    }

    #[inline(always)]
    fn search_with<W: Wide, const ANY: bool>(
        &mut self,
        w: W,
        place: &Place<'_>,
        rays: &[impl HasRay],
        bounds: &[f32],
        search: &Search<'_>,
        decide: &mut impl Decide,
    ) -> bool {
        if !self.fill(w, rays, bounds, search) {
            return false;
        }
        decide.begin(self);
        if !place.bvh.nodes.is_empty() {
            self.walk::<W, ANY>(w, place, decide);
        }
        true
    }

    #[inline(always)]
    fn walk<W: Wide, const ANY: bool>(&mut self, w: W, place: &Place<'_>, decide: &mut impl Decide) {
        let nodes = &place.bvh.nodes[..];
        let mut pending = Pending::nothing();
        self.nearest_low = [f32::INFINITY; PACKET];
        let mut stack: [MaybeUninit<Waiting>; STACK] = [const { MaybeUninit::uninit() }; STACK];
        let mut top = 0usize;
        let mut farthest = self.farthest(w);
        let mut current = Waiting {
            child: Child(0),
            place: u32::MAX,
            entry: 0.0,
            groups: u32::MAX >> (32 - self.len.div_ceil(W::LANES)),
        };
        loop {
            let (active, groups) = if current.place == u32::MAX {
                (u64::MAX, current.groups)
            } else {
                // Of shadow rays many are done already, and how few are left decides whether they go alone.
                let roughly = !ANY && !current.child.is_leaf();
                self.enter(w, nodes, current.place, roughly, current.groups)
            };
            if current.child.is_leaf() {
                if active != 0 {
                    self.leaf::<W, ANY>(w, place, current.child, active, &mut pending, decide);
                    farthest = self.farthest(w);
                    if ANY && farthest == DONE {
                        return;
                    }
                }
            } else if active != 0 && Self::go_alone::<ANY>(active, groups) {
                for ray in rays(active) {
                    let bound = decide.alone(ray, current.child, self.bound[ray]);
                    self.lower_bound(ray, bound);
                }
                farthest = self.farthest(w);
                if ANY && farthest == DONE {
                    return;
                }
            } else if active != 0 {
                let index = current.child.0;
                // SAFETY: node indices come from the builder.
                let node = unsafe { nodes.get_unchecked(index as usize) };
                let (mut mask, entries) = self.children(w, node, farthest);
                let base = top;
                while mask != 0 {
                    let lane = mask.trailing_zeros();
                    mask &= mask - 1;
                    let next = Waiting {
                        child: node.children[lane as usize & 7],
                        place: index << 3 | lane,
                        entry: entries[lane as usize & 7],
                        groups,
                    };
                    place.prefetch(next.child);
                    let mut at = top;
                    // SAFETY: the stack holds seven siblings for every level the tree can have, and what is below
                    // `top` has been written.
                    unsafe {
                        // Shadow rays take children in the order the builder gave them, others the nearest first.
                        while !ANY && at > base {
                            let below = stack.get_unchecked(at - 1).assume_init();
                            if below.entry >= next.entry {
                                break;
                            }
                            stack.get_unchecked_mut(at).write(below);
                            at -= 1;
                        }
                        stack.get_unchecked_mut(at).write(next);
                    }
                    top += 1;
                }
            }
            loop {
                if top == 0 {
                    self.decide_pending(&mut pending, decide);
                    return;
                }
                top -= 1;
                // SAFETY: written before.
                current = unsafe { stack.get_unchecked(top).assume_init() };
                if ANY || current.entry <= farthest {
                    break;
                }
            }
        }
    }

    /// Which children the pyramid meets before `farthest`, one bit for each, and where it enters them at the
    /// earliest.
    #[inline(always)]
    fn children<W: Wide>(&self, w: W, node: &Node, farthest: f32) -> (u32, [f32; 8]) {
        let p = &self.pyramid;
        let [main, x, y] = p.axes;
        let (near, far) = if p.backwards {
            (self.above(w, node, main), self.below(w, node, main))
        } else {
            (self.below(w, node, main), self.above(w, node, main))
        };
        let zero = w.splat(0.0);
        let enter = w.max(w.mul(near, w.splat(p.t_least)), zero);
        let mut outside = zero;
        for (i, k) in [(0, x), (1, y)] {
            let [least, most] = p.slopes[i];
            let at_least = if p.at_far[i][0] { far } else { near };
            let at_most = if p.at_far[i][1] { far } else { near };
            let beyond = w.sub(self.below(w, node, k), w.mul(at_most, w.splat(most)));
            let before = w.sub(w.mul(at_least, w.splat(least)), self.above(w, node, k));
            outside = w.max(outside, w.max(beyond, before));
        }
        // The last counts even where the others are NaN: an empty lane is behind every ray.
        let behind = w.sub(zero, w.mul(far, w.splat(p.t_most)));
        let outside = w.max(outside, behind);
        let missed = w.bits(w.below(zero, outside)) | w.bits(w.below(w.splat(farthest), enter));
        let mut entries = [0.0; 8];
        w.store(enter, &mut entries, 0);
        (!missed as u32 & 0xff, entries)
    }

    /// The children's lower planes along an axis as seen from the origin, rounded outwards.
    #[inline(always)]
    fn below<W: Wide>(&self, w: W, node: &Node, axis: usize) -> W::F {
        w.sub(w.load(&node.planes[axis], 0), w.splat(self.origin_up[axis]))
    }

    /// As [`RayPacket::below`], the upper planes.
    #[inline(always)]
    fn above<W: Wide>(&self, w: W, node: &Node, axis: usize) -> W::F {
        w.sub(w.load(&node.planes[axis + 3], 0), w.splat(self.origin_down[axis]))
    }

    /// Whether the rays are so few that each is done sooner by itself.
    #[inline(always)]
    fn go_alone<const ANY: bool>(active: u64, groups: u32) -> bool {
        let [of_shadow, of_one_register] = ALONE;
        if ANY {
            active.count_ones() <= of_shadow
        } else {
            groups.is_power_of_two() && active.count_ones() <= of_one_register
        }
    }

    /// Which rays of the `groups` enter a child's box before their bound, and which groups they are in. `roughly` it is
    /// enough where the first and the last group enter: then the others are likely to as well, and stay.
    #[inline(always)]
    fn enter<W: Wide>(&self, w: W, nodes: &[Node], place: u32, roughly: bool, groups: u32) -> (u64, u32) {
        // SAFETY: a place is made of a node's index.
        let node = unsafe { nodes.get_unchecked((place >> 3) as usize) };
        let lane = place as usize & 7;
        let mixed = self.signs.contains(&Sign::Mixed);
        let (mut near, mut far) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            near[k] = node.planes[k][lane] - self.origin_up[k];
            far[k] = node.planes[k + 3][lane] - self.origin_down[k];
            if self.signs[k] == Sign::Negative && !mixed {
                (near[k], far[k]) = (far[k], near[k]);
            }
        }
        let slab = Slab {
            near: w.splat3(near),
            far: w.splat3(far),
            mixed,
        };
        if roughly && groups != 0 {
            let (first, last) = (groups.trailing_zeros(), 31 - groups.leading_zeros());
            let enters = self.enter_group(w, &slab, first as usize);
            if enters != 0 && (first == last || self.enter_group(w, &slab, last as usize) != 0) {
                return (enters << (first as usize * W::LANES), groups);
            }
        }
        let (mut active, mut entered, mut rest) = (0, 0, groups);
        while rest != 0 {
            let group = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let here = self.enter_group(w, &slab, group);
            active |= here << (group * W::LANES);
            entered |= u32::from(here != 0) << group;
        }
        (active, entered)
    }

    /// Which rays of a group enter a box before their bound.
    #[inline(always)]
    fn enter_group<W: Wide>(&self, w: W, slab: &Slab<W>, group: usize) -> u64 {
        let inverse = w.load3(&self.inverse, group);
        let mut enter = w.splat(0.0);
        let mut leave = w.load(&self.bound, group);
        for (k, inverse) in inverse.into_iter().enumerate() {
            let (mut a, mut b) = (w.mul(slab.near[k], inverse), w.mul(slab.far[k], inverse));
            if slab.mixed {
                (a, b) = (w.min(a, b), w.max(a, b));
            }
            enter = w.max(enter, a);
            leave = w.min(leave, b);
        }
        let missed = w.bits(w.below(w.mul(leave, w.splat(1.0 + ROUNDING)), enter));
        !missed & u64::MAX >> (PACKET - W::LANES)
    }

    #[inline(always)]
    fn leaf<W: Wide, const ANY: bool>(
        &mut self,
        w: W,
        place: &Place<'_>,
        leaf: Child,
        mut active: u64,
        pending: &mut Pending,
        decide: &mut impl Decide,
    ) {
        match leaf.kind() {
            LeafKind::Triangles => {
                let mut lowest: Row = [0.0; PACKET];
                for (at, block) in leaf.range().zip(&place.triangles[leaf.range()]) {
                    let seen = Seen::new(block, self);
                    for lane in 0..BLOCK {
                        let id = block.ids[lane];
                        if id == NONE || id == self.skip {
                            continue;
                        }
                        let spot = Spot::new(at, lane);
                        let met = self.triangle::<W, ANY>(w, &seen, (lane, spot), active, &mut lowest);
                        let mut possible = met.possible;
                        if ANY && met.certain != 0 && decide.ends(id) {
                            for ray in rays(met.certain) {
                                self.bound[ray] = DONE;
                            }
                            possible &= !met.certain;
                            active &= !met.certain;
                            if active == 0 {
                                return;
                            }
                        }
                        for ray in rays(possible) {
                            if self.own[ray] != id {
                                self.add_pending(ray, spot, lowest[ray], pending, decide);
                            }
                        }
                    }
                }
            }
            LeafKind::Spheres => {
                for block in &place.spheres[leaf.range()] {
                    for lane in 0..BLOCK {
                        let id = block.ids[lane];
                        let mut met = self.sphere::<W, ANY>(w, block, lane, active);
                        let index = place.first_sphere.wrapping_add(id);
                        if ANY && met.certain != 0 && decide.ends(index) {
                            for ray in rays(met.certain) {
                                if self.own[ray] == index {
                                    met.certain &= !(1 << ray);
                                } else {
                                    self.bound[ray] = DONE;
                                }
                            }
                            met.possible &= !met.certain;
                            active &= !met.certain;
                            if active == 0 {
                                return;
                            }
                        }
                        for ray in rays(met.possible) {
                            self.lower_bound(ray, decide.sphere(ray, id));
                        }
                    }
                }
            }
            LeafKind::Cuboids => {
                let slack = self.cuboid_slack(place.cuboid_extent);
                for block in &place.cuboids[leaf.range()] {
                    for lane in 0..BLOCK {
                        let id = block.ids[lane];
                        if id != NONE {
                            let mask = self.cuboid(w, block, lane, slack, active);
                            if mask != 0 {
                                decide.other(mask, id, self);
                            }
                        }
                    }
                }
            }
            LeafKind::Others => {
                for &index in place.bvh.others(leaf) {
                    decide.other(active, index, self);
                }
            }
        }
    }
}

/// The rays whose bits are set.
#[inline(always)]
pub fn rays(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let ray = mask.trailing_zeros() as usize & (PACKET - 1);
            mask &= mask - 1;
            ray
        })
    })
}
