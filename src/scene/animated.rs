//! What moves while light is gathered.

use std::fmt;

use super::{
    SceneError,
    literal::{Number, Vector},
};
use crate::{
    diag::Code,
    math::{self, Bounds3, DAffine3, DMat3, DVec3, brief, max_abs},
};

/// A transform that changes evenly with time: the identity at time 0, and all of it done at time 1. In between a move is
/// a straight line, a turn the same axis with part of the angle, so that what turns stays in shape and a point of it goes
/// along an arc, and each stretch a straight line from 1; first the stretch acts, then the turn, then the move. (The parts
/// that Shoemake and Duff, "Matrix animation and polar decomposition", Graphics Interface 1992, take a matrix apart into,
/// as the animated transforms of Pharr, Jakob and Humphreys, "Physically Based Rendering", 2.9, do; here they are given,
/// so a turn may be more than half a circle.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnimatedTransform {
    /// How far it moves, in the space of what holds it.
    pub translate: DVec3,
    /// The axis of the turn, through the origin of its own space; any length but 0.
    pub axis: DVec3,
    /// The angle of the turn in degrees, right-handed; more than 360 is more than one turn.
    pub degrees: f64,
    /// Factors along the axes in the end, above 0.
    pub scale: DVec3,
}

impl Default for AnimatedTransform {
    /// No motion.
    fn default() -> Self {
        Self {
            translate: DVec3::ZERO,
            axis: DVec3::Y,
            degrees: 0.0,
            scale: DVec3::ONE,
        }
    }
}

/// Pieces that a whole turn is divided into where the space that a motion sweeps is looked for.
const PIECES: f64 = 64.0;
/// Most pieces of a motion.
const MOST_PIECES: f64 = 1024.0;

impl AnimatedTransform {
    /// Whether there is any motion.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::AnimatedTransform};
    /// let still = AnimatedTransform::default();
    /// let falling = AnimatedTransform { translate: DVec3::NEG_Y, ..still };
    /// assert!(falling.moves() && !still.moves());
    /// ```
    #[must_use]
    pub fn moves(&self) -> bool {
        self.translate != DVec3::ZERO || self.degrees != 0.0 || self.scale != DVec3::ONE
    }

    /// The transform at a time from 0 to 1.
    ///
    /// ```
    /// use rtscript::{DVec3, scene::AnimatedTransform};
    /// let wheel = AnimatedTransform { axis: DVec3::Z, degrees: 180.0, ..AnimatedTransform::default() };
    /// let top = wheel.at(0.5).transform_point3(DVec3::X);
    /// assert!((top - DVec3::Y).length() < 1e-15);
    /// ```
    #[must_use]
    pub fn at(&self, time: f64) -> DAffine3 {
        let linear = self.turn(time) * DMat3::from_diagonal(self.stretch(time));
        DAffine3::from_mat3_translation(linear, self.translate * time)
    }

    /// The inverse of [`AnimatedTransform::at`].
    #[must_use]
    pub(crate) fn inverse_at(&self, time: f64) -> DAffine3 {
        if self.degrees == 0.0 && self.scale == DVec3::ONE {
            return DAffine3::from_translation(-(self.translate * time));
        }
        let (back, stretch) = (self.turn(time).transpose(), self.stretch(time));
        let columns = [back.x_axis, back.y_axis, back.z_axis].map(|column| column / stretch);
        let linear = DMat3::from_cols(columns[0], columns[1], columns[2]);
        DAffine3::from_mat3_translation(linear, linear * -(self.translate * time))
    }

    fn turn(&self, time: f64) -> DMat3 {
        if self.degrees == 0.0 {
            return DMat3::IDENTITY;
        }
        math::rotation(self.axis / self.axis.length(), self.degrees * time)
    }

    fn stretch(&self, time: f64) -> DVec3 {
        DVec3::ONE + (self.scale - DVec3::ONE) * time
    }

    /// A box around all places that a box is taken to from one time to another.
    ///
    /// A point p goes along f(t) = d t + R(w t) s(t) p with s(t) linear. Between two times h apart f leaves the chord
    /// between its ends by at most h^2 / 8 times the largest |f''| (the error of linear interpolation), and
    /// |f''| <= w^2 |s p| + 2 w |s' p|. A point of the box is a mean of its corners, and so is where it goes.
    #[must_use]
    pub(crate) fn swept(&self, bounds: &Bounds3, from: f64, to: f64) -> Bounds3 {
        if bounds.is_empty() {
            return Bounds3::EMPTY;
        }
        let corners: [DVec3; 8] = bounds.corners();
        let turns = self.degrees.abs() * (to - from) / 360.0;
        let pieces = (turns * PIECES).ceil().clamp(1.0, MOST_PIECES);
        let mut chords = Bounds3::EMPTY;
        for i in 0..=pieces as u32 {
            let there = self.at(from + (to - from) * (f64::from(i) / pieces));
            chords = chords.union(&Bounds3::around(corners.map(|p| there.transform_point3(p))));
        }
        let farthest = |factor: DVec3| {
            corners
                .iter()
                .fold(0.0, |most: f64, p| most.max((*p * factor).length()))
        };
        // A length is convex in t, so it is largest at one of the ends.
        let radius = farthest(self.stretch(from)).max(farthest(self.stretch(to)));
        let speed = self.degrees.abs().to_radians();
        let bend = speed * speed * radius + 2.0 * speed * farthest(self.scale - DVec3::ONE);
        let step = (to - from) / pieces;
        let off = step * step / 8.0 * bend;
        let chords = Bounds3::new(chords.min - off, chords.max + off);
        // However fast it turns, no point of it is farther from the moving origin.
        let (a, b) = (self.translate * from, self.translate * to);
        let ball = Bounds3::new(a.min(b) - radius, a.max(b) + radius);
        let both = Bounds3::new(chords.min.max(ball.min), chords.max.min(ball.max));
        // Far more than the rounding of all this.
        let slack = 1e-12 * (max_abs(both.min).max(max_abs(both.max)));
        Bounds3::new(both.min - slack, both.max + slack)
    }

    /// The same motion, told in one way only: what does nothing has its default.
    pub(super) fn told_plainly(self) -> Self {
        let default = Self::default();
        let (axis, degrees) = match self.degrees {
            0.0 => (default.axis, default.degrees),
            degrees => (self.axis, degrees),
        };
        Self {
            translate: match self.translate == DVec3::ZERO {
                true => default.translate,
                false => self.translate,
            },
            axis,
            degrees,
            scale: self.scale,
        }
    }

    /// # Errors
    /// Where a number is not finite or beyond 1e15, the axis is 0, or a factor is not above 0.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let Self {
            translate,
            axis,
            degrees,
            scale,
        } = *self;
        let within = |v: DVec3| v.is_finite() && max_abs(v) <= 1e15;
        let wrong = |what: &str, given: String| -> Result<(), SceneError> {
            Err(SceneError::new(format!("{what}, not {given}")))
        };
        if !within(translate) {
            return wrong("translate must be finite numbers within 1e15", brief(translate));
        }
        if !within(axis) {
            return wrong(
                "the axis of rotate must be finite numbers within 1e15",
                brief(axis),
            );
        }
        if !(axis.length() > 0.0) {
            return Err(
                SceneError::new("the axis of rotate is zero").hint("rotate: [0, 1, 0, 45] turns about Y")
            );
        }
        if !degrees.is_finite() {
            return wrong("the angle of rotate must be a finite number", degrees.to_string());
        }
        if !(within(scale) && scale.min_element() > 0.0) {
            let refused = wrong(
                "the factors of scale must be above 0 and within 1e15",
                brief(scale),
            );
            return refused.map_err(|e| e.class(Code::SingularMatrix));
        }
        Ok(())
    }
}

/// The options that a script gives to `moving`.
impl fmt::Display for AnimatedTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            translate,
            axis,
            degrees,
            scale,
        } = *self;
        let parts = [
            (translate != DVec3::ZERO).then(|| format!("translate: {}", Vector(translate))),
            (degrees != 0.0).then(|| format!("rotate: [{}, {}]", Vector(axis), Number(degrees))),
            (scale != DVec3::ONE).then(|| format!("scale: {}", Vector(scale))),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() {
            return f.write_str("#{}");
        }
        write!(f, "#{{ {} }}", parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(range: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-range..range).prop_map(DVec3::from)
    }

    prop_compose! {
        fn motion()(
            translate in prop_oneof![Just(DVec3::ZERO), vector(20.0)],
            axis in vector(1.0).prop_filter("an axis has a length", |axis| axis.length() > 1e-3),
            degrees in prop_oneof![Just(0.0), -90.0..90.0f64, -2000.0..2000.0f64, Just(1e7), Just(-180.0)],
            scale in prop_oneof![
                Just(DVec3::ONE),
                prop::array::uniform3(0.01..9.0f64).prop_map(DVec3::from),
            ],
        ) -> AnimatedTransform {
            AnimatedTransform { translate, axis, degrees, scale }
        }
    }

    proptest! {
        #[test]
        fn a_swept_box_contains_the_box_at_all_times(
            motion in motion(),
            (a, b) in (vector(5.0), vector(5.0)),
            times in (0.0..1.0f64, 0.0..1.0f64),
        ) {
            let (from, to) = (times.0.min(times.1), times.0.max(times.1));
            let bounds = Bounds3::around([a, b]);
            let swept = motion.swept(&bounds, from, to);
            for i in 0..=2000 {
                let there = motion.at(from + (to - from) * f64::from(i) / 2000.0);
                let corners: [DVec3; 8] = bounds.corners();
                for p in corners.into_iter().chain([(a + b) / 2.0]) {
                    let p = there.transform_point3(p);
                    prop_assert!(p.cmpge(swept.min).all() && p.cmple(swept.max).all(), "{p} {swept:?}");
                }
            }
        }

        #[test]
        fn the_inverse_goes_back(motion in motion(), p in vector(5.0), time in 0.0..=1.0f64) {
            let there = motion.at(time).transform_point3(p);
            let back = motion.inverse_at(time).transform_point3(there);
            // A stretch by 0.01 makes a hundred times the rounding.
            prop_assert!((back - p).length() < 1e-11, "{p} {back}");
        }

        #[test]
        fn what_turns_stays_at_its_radius(motion in motion(), p in vector(5.0), time in 0.0..=1.0f64) {
            let turn = AnimatedTransform { degrees: motion.degrees, axis: motion.axis, ..AnimatedTransform::default() };
            let there = turn.at(time).transform_point3(p);
            let axis = motion.axis.normalize();
            prop_assert!((there.length() - p.length()).abs() < 1e-13 * (1.0 + p.length()));
            prop_assert!((there.dot(axis) - p.dot(axis)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_swept_box_is_little_more_than_need_be() {
        let arm = Bounds3::new(DVec3::new(0.9, -0.1, -0.1), DVec3::new(1.1, 0.1, 0.1));
        let turn = |degrees| AnimatedTransform {
            axis: DVec3::Z,
            degrees,
            ..AnimatedTransform::default()
        };
        let quarter = turn(90.0).swept(&arm, 0.0, 1.0);
        let least = Bounds3::new(DVec3::new(-0.1, -0.1, -0.1), DVec3::new(1.1045, 1.1045, 0.1));
        assert!(
            (quarter.min - least.min).abs().max_element() < 0.005,
            "{quarter:?}"
        );
        assert!(
            (quarter.max - least.max).abs().max_element() < 0.005,
            "{quarter:?}"
        );
        let many = turn(36e6).swept(&arm, 0.0, 1.0);
        assert!(
            many.max.max_element() < 1.12 && many.min.min_element() > -1.12,
            "{many:?}"
        );
        let along = AnimatedTransform {
            translate: DVec3::X,
            scale: DVec3::splat(2.0),
            ..AnimatedTransform::default()
        };
        let moved = along.swept(&arm, 0.0, 1.0);
        let whole = Bounds3::new(DVec3::new(0.9, -0.2, -0.2), DVec3::new(3.2, 0.2, 0.2));
        assert!((moved.min - whole.min).abs().max_element() < 1e-11);
        assert!((moved.max - whole.max).abs().max_element() < 1e-11);
    }

    #[test]
    fn motions_are_refused_by_the_name_of_what_is_wrong() {
        let ok = AnimatedTransform::default();
        let refused = |motion: AnimatedTransform| motion.check().unwrap_err().message;
        assert!(ok.check().is_ok() && !ok.moves());
        let translate = DVec3::new(0.0, f64::NAN, 0.0);
        assert!(refused(AnimatedTransform { translate, ..ok }).starts_with("translate must"));
        assert!(
            refused(AnimatedTransform {
                axis: DVec3::ZERO,
                ..ok
            })
            .contains("axis of rotate")
        );
        let degrees = f64::INFINITY;
        assert!(refused(AnimatedTransform { degrees, ..ok }).contains("angle of rotate"));
        for scale in [DVec3::new(1.0, 0.0, 1.0), DVec3::splat(-1.0)] {
            assert!(refused(AnimatedTransform { scale, ..ok }).contains("above 0"));
        }
    }

    #[test]
    fn options_tell_what_there_is_of_a_motion() {
        let text = |motion: AnimatedTransform| motion.told_plainly().to_string();
        let ok = AnimatedTransform::default();
        let zero = AnimatedTransform {
            translate: DVec3::new(-0.0, 0.0, 0.0),
            axis: DVec3::X,
            degrees: -0.0,
            ..ok
        };
        assert_eq!(text(zero), "#{}");
        assert!(zero.told_plainly().degrees.is_sign_positive());
        let all = AnimatedTransform {
            translate: DVec3::X,
            axis: DVec3::Z,
            degrees: 90.0,
            scale: DVec3::splat(0.5),
        };
        assert_eq!(
            text(all),
            "#{ translate: [1, 0, 0], rotate: [[0, 0, 1], 90], scale: [0.5, 0.5, 0.5] }"
        );
    }
}
