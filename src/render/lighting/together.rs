//! Shadow rays that wait until there are enough of them to be traced as a packet.

use super::{
    Counts, Lit, Observer, Sent,
    area::{Samples, three_arrays},
};
use crate::{
    accel::Exact,
    color::Color,
    render::{
        observe::Arrived,
        world::{Blocker, PACKET, Probe},
    },
};

/// Points of an area light whose shadow rays are traced together.
pub(super) struct Together<'l, 'a> {
    lit: &'l Lit<'a>,
    len: usize,
    probes: [Probe; PACKET],
    reach: [f64; PACKET],
    /// What arrives where nothing is in between, and what the surface makes of it.
    arriving: [Color; PACKET],
    response: [Color; PACKET],
}

impl<'l, 'a> Together<'l, 'a> {
    pub(super) fn new(lit: &'l Lit<'a>) -> Self {
        let (probe, reach) = lit.shadow_ray(lit.at.shading_normal, 0.0);
        Self {
            lit,
            len: 0,
            probes: [probe; PACKET],
            reach: [reach; PACKET],
            arriving: [Color::ZERO; PACKET],
            response: [Color::ZERO; PACKET],
        }
    }

    /// As [`Lit::add`] for each of several points in turn, now or later.
    #[inline(always)]
    pub(super) fn add<L: Exact, O: Observer>(
        &mut self,
        sum: &mut Color,
        color: Color,
        samples: &Samples<L>,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let [r, g, b] = three_arrays(self.lit.respond_to_all(samples));
        let points = samples.each().into_iter().take(samples.len);
        for (i, (towards, distance, share)) in points.enumerate() {
            let response = Color::new(r[i], g[i], b[i]);
            if response == Color::ZERO {
                continue;
            }
            counts.shadow += 1;
            let at = self.len % PACKET;
            (self.probes[at], self.reach[at]) = self.lit.shadow_ray(towards, distance);
            self.arriving[at] = color * share;
            self.response[at] = response;
            self.len += 1;
            if self.len == PACKET {
                self.finish(sum, observer);
            }
        }
    }

    /// As [`Lit::add`], now or later.
    pub(super) fn add_sent<O: Observer>(
        &mut self,
        sum: &mut Color,
        sent: &Sent,
        counts: &mut Counts,
        observer: &mut O,
    ) {
        let response = self.lit.respond(sent.towards);
        if response == Color::ZERO {
            return;
        }
        counts.shadow += 1;
        let at = self.len % PACKET;
        (self.probes[at], self.reach[at]) = self.lit.shadow_ray(sent.towards, sent.distance);
        (self.arriving[at], self.response[at]) = (sent.arriving, response);
        self.len += 1;
        if self.len == PACKET {
            self.finish(sum, observer);
        }
    }

    /// Adds what waits, in order.
    pub(super) fn finish<O: Observer>(&mut self, sum: &mut Color, observer: &mut O) {
        let (len, world) = (self.len.min(PACKET), self.lit.world);
        let mut found = [Blocker::None; PACKET];
        world.blockers(&self.probes[..len], &self.reach[..len], &mut found[..len]);
        for (i, found) in found[..len].iter().enumerate() {
            let visible = match found {
                Blocker::None => Color::ONE,
                Blocker::Opaque => Color::ZERO,
                Blocker::Transparent => world.share_through(&self.probes[i], self.reach[i], None),
            };
            let added = visible * self.arriving[i] * self.response[i];
            let arrived = Arrived {
                probe: &self.probes[i],
                reach: self.reach[i],
                arriving: self.arriving[i],
                visible,
                added,
            };
            observer.arrived(self.lit, &arrived);
            *sum += added;
        }
        self.len = 0;
    }
}
