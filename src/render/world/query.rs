//! A question put to the world, and its answer.

use crate::{
    accel::HasRay,
    math::{Ray, larger, max_abs},
    shape::{Crossings, triangle::TriangleHit},
};

/// A ray with what it may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) ray: Ray,
    /// Nothing nearer counts: the rounding error of the ray's start.
    pub(super) t_min: f64,
    /// A crossing of the start's own primitive this near to the start is the start.
    t_self: f64,
    /// As `t_min`, for the start's own primitive: where the ray leaves along a tangent, its two crossings are only
    /// known to the square root of rounding.
    t_min_self: f64,
    /// Number of the primitive the ray starts on, or [`Probe::NOWHERE`].
    pub(super) start: u64,
}

impl HasRay for Probe {
    #[inline(always)]
    fn ray(&self) -> &Ray {
        &self.ray
    }
}

impl Probe {
    const NOWHERE: u64 = u64::MAX;
    /// A crossing of the start's own primitive this near to it, in units of its scale, is the start.
    pub(super) const OWN_START: f64 = 1e-5;

    /// A ray that starts in free space.
    pub(crate) fn from_space(ray: Ray) -> Self {
        Self {
            ray,
            t_min: 0.0,
            t_self: 0.0,
            t_min_self: 0.0,
            start: Self::NOWHERE,
        }
    }

    /// A ray that starts on the primitive `start`. `scale` is the size of the numbers its start was computed
    /// from; the direction is a unit vector.
    ///
    /// The start's own crossing is left out by number, so the least distance need only cover the rounding of
    /// the start, some 1e-15 of `scale`, in front of *other* surfaces.
    pub(crate) fn from_surface(ray: Ray, start: u64, scale: f64) -> Self {
        let scale = larger(scale, max_abs(ray.origin));
        Self {
            ray,
            t_min: 1e-10 * scale,
            t_self: Self::OWN_START * scale,
            t_min_self: 1e-7 * scale,
            start,
        }
    }

    /// What lies on either side of the start of such a ray within the rounding of the start, and how far that is,
    /// but for the primitive it starts on.
    pub(super) fn around_surface(ray: Ray, start: u64, scale: f64) -> (Self, f64) {
        let probe = Self::from_surface(ray, start, scale);
        let reach = probe.t_min;
        let around = Self {
            t_min: -reach,
            t_min_self: f64::INFINITY,
            ..probe
        };
        (around, reach)
    }

    /// Size of the numbers the start was computed from; 0 for a ray from free space.
    pub(super) fn scale(&self) -> f64 {
        self.t_self / Self::OWN_START
    }

    pub(super) fn starts_on(&self, number: u64) -> bool {
        number == self.start
    }

    /// The number of the primitive that the ray starts on.
    pub(super) fn started_on(&self) -> Option<u64> {
        (self.start != Self::NOWHERE).then_some(self.start)
    }

    /// Whether a crossing of the start's own primitive is near enough to be the start.
    pub(super) fn is_start(&self, t: f64) -> bool {
        t.abs() <= self.t_self
    }

    /// What [`Probe::drop_start`] answers, where the start was told apart by itself.
    pub(super) fn least_beyond_start(&self, number: u64) -> f64 {
        if self.starts_on(number) {
            self.t_min_self
        } else {
            self.t_min
        }
    }

    /// No crossing of a primitive that has but one counts at or before this.
    pub(super) fn least(&self, number: u64) -> f64 {
        if self.starts_on(number) {
            self.t_self
        } else {
            self.t_min
        }
    }

    /// From where on crossings matter to this primitive, and beyond which one counts whatever else there is.
    pub(super) fn around_start(&self, number: u64) -> (f64, f64) {
        if self.starts_on(number) {
            (-self.t_self, self.t_self.max(self.t_min_self))
        } else {
            (self.t_min, self.t_min)
        }
    }

    /// Drops the start from its own primitive's crossings. The least distance that counts for this primitive.
    pub(super) fn drop_start(&self, number: u64, crossings: &mut Crossings) -> f64 {
        if !self.starts_on(number) {
            return self.t_min;
        }
        crossings.drop_start(self.t_self);
        self.t_min_self
    }
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) t: f64,
    /// Unique over all instances.
    pub(crate) number: u64,
    /// Barycentric weights of a triangle's second and third corner.
    pub(super) u: f64,
    pub(super) v: f64,
    /// Part of a shape's surface.
    pub(super) part: u32,
}

impl Hit {
    /// Some point of the primitive with this number.
    pub(super) fn of(number: u64) -> Self {
        Self {
            t: 0.0,
            number,
            u: 0.0,
            v: 0.0,
            part: 0,
        }
    }
}

/// What stands between a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blocker {
    /// Nothing.
    None,
    /// Perhaps something that lets light through, and nothing that does not.
    Transparent,
    /// Something that lets no light through.
    Opaque,
}

/// A question put to all levels, and its answer so far.
#[derive(Clone, Copy)]
pub(super) struct Query<'p> {
    pub(super) probe: &'p Probe,
    pub(super) best: Hit,
    /// Something was met that may let light through.
    met_transparent: bool,
}

impl<'p> Query<'p> {
    pub(super) fn new(probe: &'p Probe, t_max: f64) -> Self {
        let best = Hit {
            t: t_max,
            number: u64::MAX,
            u: 0.0,
            v: 0.0,
            part: 0,
        };
        Self {
            probe,
            best,
            met_transparent: false,
        }
    }

    pub(super) fn hit(&self) -> Option<Hit> {
        (self.best.number != u64::MAX).then_some(self.best)
    }

    /// The answer of a search for anything that was `stopped` or not.
    pub(super) fn blocker(&self, stopped: bool) -> Blocker {
        match (stopped, self.met_transparent) {
            (true, _) => Blocker::Opaque,
            (false, true) => Blocker::Transparent,
            (false, false) => Blocker::None,
        }
    }

    /// Takes a hit on a triangle if it is the best so far. True where that ends the search: with `ANY`, unless
    /// the triangle `may_let_through` light.
    #[inline(always)]
    pub(super) fn offer_triangle<const ANY: bool>(
        &mut self,
        number: u64,
        TriangleHit { t, u, v }: TriangleHit,
        may_let_through: impl FnOnce() -> bool,
    ) -> bool {
        let hit = Hit {
            t,
            number,
            u,
            v,
            part: 0,
        };
        t > self.probe.t_min && self.offer::<ANY>(hit, may_let_through)
    }

    /// Takes a hit if it is the best so far. True where that ends the search: with `ANY`, unless what was hit
    /// `may_let_through` light.
    #[inline(always)]
    pub(super) fn offer<const ANY: bool>(
        &mut self,
        hit: Hit,
        may_let_through: impl FnOnce() -> bool,
    ) -> bool {
        let best = &mut self.best;
        if !(hit.t < best.t || (hit.t == best.t && hit.number < best.number)) {
            return false;
        }
        if !ANY {
            *best = hit;
            return false;
        }
        if may_let_through() {
            self.met_transparent = true;
            return false;
        }
        best.number = hit.number;
        true
    }
}
