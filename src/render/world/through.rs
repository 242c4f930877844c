//! Searches in which it matters what lets light through: what a shadow ray passes on its way, and whether
//! something opaque lies in a transparent surface.

mod census;
mod walk;

use super::{
    SurfacePoint, World,
    query::{Blocker, Hit, Probe},
    shaft::FewObstacles,
};
use crate::{
    accel::Control,
    color::Color,
    math::{Ray, max_abs},
    render::polish::shadow_share,
};
use census::{Found, OpaqueWithin};

/// What a shadow ray passes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Passage {
    /// This share of the light comes through.
    Share(Color),
    /// One search cannot tell: surfaces lie too close together, vary from point to point, or are too many.
    Unclear,
}

impl World<'_> {
    /// The share of light that comes through along a ray up to `t_max`: nothing behind anything opaque, the product
    /// of Kt of the transparent surfaces in between otherwise, in the order in which the ray meets them. `few` is
    /// what it may meet, where that is known.
    pub(crate) fn share_through(&self, probe: &Probe, t_max: f64, few: Option<&FewObstacles>) -> Color {
        let passage = match few {
            Some(few) => self.passage(probe, t_max, |found| self.walk_few(few, probe, found)),
            None if self.may_be_transparent() => {
                self.passage(probe, t_max, |found| self.walk_root(probe, found))
            }
            None => Passage::Share(match self.blocker(probe, t_max) {
                Blocker::None => Color::ONE,
                Blocker::Transparent | Blocker::Opaque => Color::ZERO,
            }),
        };
        match passage {
            Passage::Share(share) => share,
            Passage::Unclear => self.share_by_steps(*probe, t_max),
        }
    }

    /// As [`World::share_through`] where it is not known what the ray may meet, but what stood in the way of the ray
    /// before, which is the `last` and is looked at first.
    #[inline]
    pub(crate) fn share_after(&self, probe: &Probe, t_max: f64, last: &mut u64) -> Color {
        if self.may_be_transparent() {
            return self.share_through(probe, t_max, None);
        }
        if self.is_blocked(probe, t_max, last) {
            Color::ZERO
        } else {
            Color::ONE
        }
    }

    /// As [`World::share_through`], from surface to surface, a search for each: however near to each other they
    /// are and whatever they look like.
    pub(super) fn share_by_steps(&self, probe: Probe, t_max: f64) -> Color {
        self.steps(probe, t_max, |_, _| {})
    }

    /// As [`World::share_by_steps`], telling `met` the number and Kt of each surface on the way.
    pub(crate) fn steps(&self, mut probe: Probe, t_max: f64, mut met: impl FnMut(u64, Color)) -> Color {
        let dir = probe.ray.dir;
        let mut rest = t_max;
        let mut share = Color::ONE;
        // Each turn passes one transparent surface. Nobody looks through more than these.
        for _ in 0..1024 {
            if self.is_stopped() {
                return Color::ZERO;
            }
            let Some(hit) = self.nearest(&probe, rest) else {
                return share;
            };
            let Some(surface) = self.surface(&hit, &probe.ray) else {
                return Color::ZERO;
            };
            let mut transmission = self.term(&surface.material.transmission, &surface);
            if let Some(finish) = &surface.material.finish {
                transmission = shadow_share(self, finish, (&hit, &probe.ray), &surface, transmission);
            }
            met(hit.number, transmission);
            share *= transmission;
            if share == Color::ZERO {
                return share;
            }
            rest -= hit.t;
            probe = Probe::from_surface(Ray::new(surface.position, dir), hit.number, surface.scale);
        }
        Color::ZERO
    }

    /// Whether anything may let light through. If not, a shadow ray need only ask for a blocker.
    fn may_be_transparent(&self) -> bool {
        self.root().is_some_and(|root| !root.transparent.is_empty())
    }

    /// What comes through by a single search. A ray that goes from surface to surface finds the same, but for
    /// surfaces so near each other that it might take the one for its own start, which this leaves open.
    fn passage(&self, probe: &Probe, t_max: f64, search: impl Fn(&mut Found) -> Control) -> Passage {
        let scale = probe.scale().max(max_abs(probe.ray.origin));
        // An endless ray has no end that a surface could be near to.
        let slack = if t_max.is_finite() {
            near(scale, t_max)
        } else {
            0.0
        };
        let mut found = Found {
            t_max,
            t_far: t_max + slack,
            list: [(0.0, 0); Found::CAPACITY],
            len: 0,
        };
        if search(&mut found) == Control::Stop {
            return Passage::Share(Color::ZERO);
        }
        let Some(list) = found.list.get(..found.len) else {
            return Passage::Unclear;
        };
        let mut share = Color::ONE;
        let mut before = f64::NEG_INFINITY;
        for &(t, number) in list {
            if t - before < near(scale, t) || (t - t_max).abs() <= slack {
                return Passage::Unclear;
            }
            before = t;
            let Some(material) = self.material(number) else {
                return Passage::Unclear;
            };
            if material.transmission.texture.is_some() || material.finish.is_some() {
                return Passage::Unclear;
            }
            share *= material.transmission.color;
        }
        Passage::Share(share)
    }

    /// What else lies in the very surface that a ray met at `at`, such as the table under a block of glass that
    /// stands on it: rounding alone decides which of the two is nearer. `None` where nothing that may be opaque does.
    pub(crate) fn touching(&self, hit: &Hit, ray: &Ray, at: &SurfacePoint<'_>) -> Option<(Hit, Ray)> {
        let (probe, reach) = Probe::around_surface(Ray::new(at.position, ray.dir), hit.number, at.scale);
        if self.walk_root(&probe, &mut OpaqueWithin(reach)) == Control::Continue {
            return None;
        }
        Some((self.nearest(&probe, reach)?, probe.ray))
    }
}

/// How near two surfaces are where a ray that starts on one may take the other for its start: twice the distance
/// within which it looks for that, which grows with the numbers involved.
fn near(scale: f64, t: f64) -> f64 {
    2.0 * Probe::OWN_START * (scale + t.abs())
}
