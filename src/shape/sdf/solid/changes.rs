//! A solid moved, bent, repeated, or with another surface.

use super::{Around, Sdf, length, number};
use crate::{
    math::{self, Bounds3, DMat3, DVec3},
    scene::SceneError,
    shape::sdf::Field,
};

impl Sdf {
    /// Moved.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        let [x, y, z] = Field::point();
        let around = self.around.map(|a| Around {
            bounds: Bounds3::new(a.bounds.min + by, a.bounds.max + by),
            ..a
        });
        Self::new(self.field.moved_to(&[x - by.x, y - by.y, z - by.z]), around)
    }

    /// Turned about `axis` (any length but 0) by `degrees`, right-handed.
    ///
    /// # Errors
    /// Where the axis has no direction, or the angle is no number.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A plank along x that is turned to stand upright, and made twice as large.
    /// let plank = Sdf::cuboid(DVec3::new(4.0, 0.2, 1.0))?;
    /// let wall = plank.turned(DVec3::Z, 90.0)?.scaled(2.0)?;
    /// assert!(wall.field().at(DVec3::Y * 3.9) < 0.0 && plank.field().at(DVec3::Y * 3.9) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn turned(&self, axis: DVec3, degrees: f64) -> Result<Self, SceneError> {
        let size = axis.length();
        if !(size > 0.0 && size.is_finite() && degrees.is_finite()) {
            return Err(SceneError::new(
                "the axis must have a direction, and the angle be a number",
            ));
        }
        let turn = math::rotation(axis / size, degrees);
        let around = self.around.map(|a| {
            let turned = a.bounds.corners().map(|p| turn * p);
            // A box that is turned grows by more than what is in it.
            a.around(turned, 3f64.sqrt())
        });
        Ok(Self::new(self.under(&turn.transpose()), around))
    }

    /// The field of points that a matrix takes there.
    fn under(&self, m: &DMat3) -> Field {
        let [x, y, z] = Field::point();
        let row = |i: usize| {
            let row = m.row(i);
            &x * row.x + &y * row.y + &z * row.z
        };
        self.field.moved_to(&[row(0), row(1), row(2)])
    }

    /// Stretched alike in all directions.
    ///
    /// # Errors
    /// Where the factor is not greater than 0.
    pub fn scaled(&self, by: f64) -> Result<Self, SceneError> {
        let by = length("the factor", by)?;
        let [x, y, z] = Field::point().map(|x| x * by.recip());
        let around = self.around.map(|a| Around {
            bounds: Bounds3::new(a.bounds.min * by, a.bounds.max * by),
            ..a
        });
        Ok(Self::new(self.field.moved_to(&[x, y, z]) * by, around))
    }

    /// Larger by `by` on all sides, which rounds edges; smaller where it is negative.
    ///
    /// # Errors
    /// Where it is not a number within 1e15.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A pebble: a flat box whose edges are rounded by growing it. Corners grow least.
    /// let pebble = Sdf::cuboid(DVec3::new(1.0, 0.5, 1.0))?.rounded(0.25)?;
    /// assert_eq!(pebble.bounds().map(|b| b.size()), Some(DVec3::new(1.5, 1.0, 1.5)));
    /// assert!(pebble.field().at(DVec3::new(0.7, 0.45, 0.7)) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn rounded(&self, by: f64) -> Result<Self, SceneError> {
        let by = number("the distance", by)?;
        Ok(Self::new(&self.field - by, self.around.map(|a| a.expanded(by))))
    }

    /// A wall of this thickness along its surface, half of it on either side.
    ///
    /// # Errors
    /// Where it is not a length.
    pub fn hollowed(&self, thickness: f64) -> Result<Self, SceneError> {
        let half = length("the thickness", thickness)? * 0.5;
        Ok(Self::new(
            self.field.abs() - half,
            self.around.map(|a| a.expanded(half)),
        ))
    }

    /// Turned about the Y axis by so many degrees for each unit of height.
    ///
    /// # Errors
    /// Where it is not a number.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A bar that turns by a quarter on its way from y = 0 to y = 1.
    /// let bar = Sdf::cuboid(DVec3::new(2.0, 4.0, 0.2))?;
    /// let twisted = bar.twisted(90.0)?;
    /// let [below, above] = [DVec3::X * 0.9, DVec3::new(0.9, 1.0, 0.0)];
    /// assert!(twisted.field().at(below) < 0.0 && twisted.field().at(above) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn twisted(&self, degrees: f64) -> Result<Self, SceneError> {
        self.turned_along(1, [0, 2], degrees)
    }

    /// Bent about the Z axis by so many degrees for each unit along x.
    ///
    /// # Errors
    /// Where it is not a number.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A straight rod that becomes an arch.
    /// let rod = Sdf::capsule(DVec3::NEG_X * 2.0, DVec3::X * 2.0, 0.2)?;
    /// let arch = rod.bent(30.0)?;
    /// let end = DVec3::X * 2.0;
    /// assert!(rod.field().at(end) < 0.0 && arch.field().at(end) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn bent(&self, degrees: f64) -> Result<Self, SceneError> {
        self.turned_along(0, [0, 1], degrees)
    }

    /// Turned in the plane of two axes by so many degrees for each unit along an axis.
    #[allow(clippy::indexing_slicing, reason = "axes are 0, 1 and 2")]
    fn turned_along(
        &self,
        axis: usize,
        [first, second]: [usize; 2],
        degrees: f64,
    ) -> Result<Self, SceneError> {
        let angle = number("the angle", degrees)? * (math::PI / 180.0);
        let mut point = Field::point();
        let (s, c) = ((&point[axis] * angle).sin(), (&point[axis] * angle).cos());
        let (x, y) = (point[first].clone(), point[second].clone());
        point[first] = &c * &x - &s * &y;
        point[second] = &s * &x + &c * &y;
        let around = self.around.map(|a| {
            let far = a.bounds.corners().iter().fold(0.0, |far: f64, p| {
                far.max((p[first] * p[first] + p[second] * p[second]).sqrt())
            });
            let (mut low, mut high) = (a.bounds.min, a.bounds.max);
            for k in [first, second] {
                (low[k], high[k]) = (-far, far);
            }
            a.around([low, high], 2f64.sqrt())
        });
        Ok(Self::new(self.field.moved_to(&point), around))
    }

    /// Copies `period` apart along each axis (0 for none), `count` to either side, or without end.
    ///
    /// # Errors
    /// Where a period is negative or no number, or all are 0.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // Five pearls in a row.
    /// let pearls = Sdf::sphere(0.4)?.repeated(DVec3::X, Some(2))?;
    /// let at = |x| pearls.field().at(DVec3::X * x);
    /// assert!(at(0.0) < 0.0 && at(0.5) > 0.0 && at(-2.0) < 0.0 && at(3.0) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn repeated(&self, period: DVec3, count: Option<u32>) -> Result<Self, SceneError> {
        let periods = period.to_array();
        if !periods.iter().all(|p| (0.0..=1e15).contains(p)) || period == DVec3::ZERO {
            return Err(SceneError::new("the periods must be 0 or greater, and not all 0")
                .hint("a period of 0 does not repeat along that axis"));
        }
        let most = count.map_or(1e15, f64::from);
        let mut point = Field::point();
        for (x, period) in point.iter_mut().zip(periods) {
            if period > 0.0 {
                *x = x.wrap(period, most);
            }
        }
        let around = self.around.filter(|_| count.is_some()).map(|a| {
            let reach = period * most;
            Around {
                bounds: Bounds3::new(a.bounds.min - reach, a.bounds.max + reach),
                ..a
            }
        });
        Ok(Self::new(self.field.moved_to(&point), around))
    }

    /// With what lies on the positive side of an axis (0, 1, 2 for x, y, z) mirrored to the other.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // One ear makes two.
    /// let ears = Sdf::sphere(0.3)?.moved(DVec3::X).mirrored(0);
    /// assert!(ears.field().at(DVec3::X) < 0.0 && ears.field().at(DVec3::NEG_X) < 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn mirrored(&self, axis: usize) -> Self {
        let mut point = Field::point();
        if let Some(x) = point.get_mut(axis) {
            *x = x.abs();
        }
        let around = self.around.map(|a| {
            let mut flip = DVec3::ONE;
            if let Some(x) = flip.as_mut().get_mut(axis) {
                *x = -1.0;
            }
            let ends = [a.bounds.min, a.bounds.max];
            a.around(ends.into_iter().chain(ends.map(|p| p * flip)), 1.0)
        });
        Self::new(self.field.moved_to(&point), around)
    }

    /// With its surface raised and lowered by up to `amount` by noise whose hills are about `size` across.
    ///
    /// # Errors
    /// Where `amount` is not a number, or `size` not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A rock: a ball whose surface lies up to 0.1 above or below where it was.
    /// let rock = Sdf::sphere(1.0)?.displaced(0.1, 0.4)?;
    /// assert!(rock.field().at(DVec3::X * 0.85) < 0.0 && rock.field().at(DVec3::X * 1.15) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn displaced(&self, amount: f64, size: f64) -> Result<Self, SceneError> {
        let (amount, size) = (number("the amount", amount)?, length("the size", size)?);
        let point = Field::point().map(|x| x * size.recip());
        let field = &self.field + &(Field::noise(&point) * amount);
        Ok(Self::new(
            field,
            self.around.map(|a| a.expanded(1.04 * amount.abs())),
        ))
    }
}
