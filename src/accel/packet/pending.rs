//! Triangles that rays of a packet may hit, until f64 decides.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

use super::{Decide, PACKET, RayPacket};
use crate::accel::Spot;

/// Triangles a ray may hit before f64 is asked, besides the nearest that is certain.
const PENDING: usize = 4;

/// What waits for a decision in f64.
pub(super) struct Pending {
    /// Triangles, with a lower bound of t; as many as `count` says.
    items: [[MaybeUninit<(Spot, f32)>; PENDING]; PACKET],
    count: [u8; PACKET],
}

impl Pending {
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        Self {
            items: [const { [const { MaybeUninit::uninit() }; PENDING] }; PACKET],
            count: [0; PACKET],
        }
    }
}

impl RayPacket {
    /// Notes a triangle that a ray may hit.
    #[inline(always)]
    pub(super) fn add_pending(
        &mut self,
        ray: usize,
        spot: Spot,
        lowest: f32,
        pending: &mut Pending,
        decide: &mut impl Decide,
    ) {
        let ray = ray & (PACKET - 1);
        let mut count = usize::from(pending.count[ray]);
        if count == PENDING {
            let (spots, left) = self.sift(ray, pending);
            if left > 0 {
                self.lower_bound(ray, decide.triangles(ray, &spots[..left]));
            }
            count = 0;
        }
        pending.items[ray][count & (PENDING - 1)].write((spot, lowest));
        pending.count[ray] = count as u8 + 1;
    }

    /// Takes a ray's triangles that may still count out of the list.
    #[inline(always)]
    fn sift(&self, ray: usize, pending: &mut Pending) -> ([Spot; PENDING], usize) {
        let (mut spots, mut left) = ([Spot::NOWHERE; PENDING], 0);
        for item in &pending.items[ray][..usize::from(pending.count[ray])] {
            // SAFETY: `count` of them have been written.
            let (spot, lowest) = unsafe { item.assume_init() };
            if lowest <= self.bound[ray] {
                spots[left] = spot;
                left += 1;
            }
        }
        pending.count[ray] = 0;
        (spots, left)
    }

    /// Decides what all rays may have hit.
    #[inline(always)]
    pub(super) fn decide_pending(&mut self, pending: &mut Pending, decide: &mut impl Decide) {
        const ROOM: usize = PACKET + PENDING + 1;
        let mut pairs = [(0, Spot::NOWHERE); ROOM];
        let mut count = 0;
        for ray in 0..self.len {
            let low = self.nearest_low[ray];
            if low < f32::INFINITY && low <= self.bound[ray] {
                pairs[count] = (ray as u8, Spot::from_f32(self.nearest_spot[ray]));
                count += 1;
            }
            if pending.count[ray] != 0 {
                let (spots, left) = self.sift(ray, pending);
                for spot in &spots[..left] {
                    pairs[count] = (ray as u8, *spot);
                    count += 1;
                }
            }
            if count >= PACKET {
                decide.last(&pairs[..count], self);
                count = 0;
            }
        }
        decide.last(&pairs[..count], self);
    }
}
