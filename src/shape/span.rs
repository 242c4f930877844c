//! The part of a line inside a convex solid, as one interval.
//!
//! A box, a cylinder and a cone are intersections of simpler convex sets, and so is the line's part in them:
//! clip the interval set by set and either nothing is left or exactly two ends. A rim or an edge cannot be
//! counted once or three times by it, however the numbers round (Kay and Kajiya, "Ray Tracing Complex
//! Scenes", 1986).

use super::{Crossing, CrossingSink};

/// An interval of ray parameters, `enter.t <= exit.t`, never NaN; unbounded ends are infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    enter: Crossing,
    exit: Crossing,
}

impl Span {
    /// The whole line.
    const LINE: Self = Self {
        enter: Crossing {
            t: f64::NEG_INFINITY,
            part: 0,
        },
        exit: Crossing {
            t: f64::INFINITY,
            part: 0,
        },
    };

    /// From `t0` to `t1`, both ends on part `part`; `None` where they are out of order or NaN.
    #[inline]
    pub(super) fn new(t0: f64, t1: f64, part: u32) -> Option<Self> {
        (t0 <= t1).then_some(Self {
            enter: Crossing { t: t0, part },
            exit: Crossing { t: t1, part },
        })
    }

    /// From one crossing to another; `None` where they are out of order or NaN.
    #[inline]
    pub(super) fn between(enter: Crossing, exit: Crossing) -> Option<Self> {
        (enter.t <= exit.t).then_some(Self { enter, exit })
    }

    /// Both ends.
    #[inline]
    pub(super) const fn ends(self) -> [Crossing; 2] {
        [self.enter, self.exit]
    }

    /// The whole line where `inside` holds, nothing where not.
    #[inline]
    pub(super) fn line_if(inside: bool) -> Option<Self> {
        inside.then_some(Self::LINE)
    }

    /// Where the coordinate `o + t d` lies in `[-half, half]`; the parts are those of the lower and the
    /// upper end of the coordinate. A coordinate that stands still (`d` = 0) is inside up to and with the
    /// ends, so a ray in the plane of a face is inside. An infinite `d` has no points.
    #[inline]
    pub(super) fn slab(o: f64, d: f64, half: f64, low: u32, high: u32) -> Option<Self> {
        if d == 0.0 {
            return Self::line_if(o.abs() <= half);
        }
        let near = Crossing {
            t: (-half - o) / d,
            part: low,
        };
        let far = Crossing {
            t: (half - o) / d,
            part: high,
        };
        let (enter, exit) = if d > 0.0 { (near, far) } else { (far, near) };
        (enter.t <= exit.t && d.abs() <= f64::MAX).then_some(Self { enter, exit })
    }

    /// What both hold; `None` where they do not meet. Where two ends fall together, `self` names the part.
    #[inline]
    pub(super) fn clip(self, other: Self) -> Option<Self> {
        let enter = if other.enter.t > self.enter.t {
            other.enter
        } else {
            self.enter
        };
        let exit = if other.exit.t < self.exit.t {
            other.exit
        } else {
            self.exit
        };
        (enter.t <= exit.t).then_some(Self { enter, exit })
    }

    /// Adds both ends, or neither: the ray of zero direction inside a solid leaves an unbounded interval and
    /// has no crossing.
    #[inline]
    pub(super) fn push(self, out: &mut impl CrossingSink) {
        if self.enter.t.is_finite() && self.exit.t.is_finite() {
            out.push(self.enter.t, self.enter.part);
            out.push(self.exit.t, self.exit.part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};

    #[test]
    fn a_slab_is_closed_and_knows_its_ends() {
        let span = Span::slab(3.0, -2.0, 1.0, 7, 8).unwrap();
        assert_eq!((span.enter.t, span.enter.part), (1.0, 8));
        assert_eq!((span.exit.t, span.exit.part), (2.0, 7));
        assert!(Span::slab(1.0, 0.0, 1.0, 0, 0).is_some(), "in the plane");
        assert!(Span::slab(1.1, 0.0, 1.0, 0, 0).is_none(), "beside");
        for d in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(Span::slab(0.0, d, 1.0, 0, 0).is_none(), "{d}");
        }
        for o in [f64::NAN, f64::INFINITY] {
            assert!(Span::slab(o, 0.0, 1.0, 0, 0).is_none(), "{o}");
        }
    }

    #[test]
    fn clipping_leaves_two_ends_or_none() {
        let a = Span::new(1.0, 3.0, 1).unwrap();
        let touching = a.clip(Span::new(3.0, 5.0, 2).unwrap()).unwrap();
        assert_eq!((touching.enter.t, touching.exit.t), (3.0, 3.0));
        assert_eq!((touching.enter.part, touching.exit.part), (2, 1));
        assert!(a.clip(Span::new(4.0, 5.0, 2).unwrap()).is_none());
        assert!(Span::new(f64::NAN, 1.0, 0).is_none());
        assert!(Span::new(2.0, 1.0, 0).is_none());
    }

    #[test]
    fn an_unbounded_interval_has_no_crossings() {
        let mut out = Crossings::default();
        Span::LINE.push(&mut out);
        Span::new(0.0, f64::INFINITY, 0).unwrap().push(&mut out);
        assert!(out.as_slice().is_empty());
    }
}
