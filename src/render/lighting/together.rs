//! Shadow rays that wait until there are enough of them to be traced as a packet.

use super::{
    Counts, Lit, Observer, Sent,
    area::{Samples, three_arrays},
};
use crate::{
    accel::{Exact, Few},
    color::Color,
    math::DVec3,
    render::{
        observe::Arrived,
        world::{Blocker, PACKET, Probe},
    },
};

/// Points of an area light whose shadow rays are traced together.
pub(super) struct Together<'l, 'a> {
    lit: &'l Lit<'a>,
    probes: Few<Probe, PACKET>,
    reach: Few<f64, PACKET>,
    /// What arrives where nothing is in between, and what the surface makes of it.
    light: Few<(Color, Color), PACKET>,
}

impl<'l, 'a> Together<'l, 'a> {
    #[inline(always)]
    pub(super) fn new(lit: &'l Lit<'a>) -> Self {
        Self {
            lit,
            probes: Few::empty(),
            reach: Few::empty(),
            light: Few::empty(),
        }
    }

    /// Lets a shadow ray wait. Those that wait are traced once there is no room for more.
    #[inline(always)]
    fn wait<O: Observer>(
        &mut self,
        sum: &mut Color,
        (towards, distance): (DVec3, f64),
        light: (Color, Color),
        counts: &mut Counts,
        observer: &mut O,
    ) {
        counts.shadow += 1;
        let (probe, reach) = self.lit.shadow_ray(towards, distance);
        self.probes.push(probe);
        self.reach.push(reach);
        self.light.push(light);
        if self.probes.is_full() {
            self.finish(sum, observer);
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
            let light = (color * share, response);
            self.wait(sum, (towards, distance), light, counts, observer);
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
        let light = (sent.arriving, response);
        self.wait(sum, (sent.towards, sent.distance), light, counts, observer);
    }

    /// Adds what waits, in order.
    pub(super) fn finish<O: Observer>(&mut self, sum: &mut Color, observer: &mut O) {
        let (probes, reach, world) = (self.probes.as_slice(), self.reach.as_slice(), self.lit.world);
        let mut found = [Blocker::None; PACKET];
        world.blockers(probes, reach, &mut found[..probes.len()]);
        let lights = self.light.as_slice().iter();
        for (((probe, &reach), &(arriving, response)), found) in
            probes.iter().zip(reach).zip(lights).zip(&found)
        {
            let visible = match found {
                Blocker::None => Color::ONE,
                Blocker::Opaque => Color::ZERO,
                Blocker::Transparent => world.share_through(probe, reach, None),
            };
            let added = visible * arriving * response;
            let arrived = Arrived {
                probe,
                reach,
                arriving,
                visible,
                added,
            };
            observer.arrived(self.lit, &arrived);
            *sum += added;
        }
        self.probes.clear();
        self.reach.clear();
        self.light.clear();
    }
}
