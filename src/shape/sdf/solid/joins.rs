//! Two solids made one, with edges sharp or rounded.

use super::{Around, Sdf, constant, length};
use crate::{scene::SceneError, shape::sdf::Field};

impl Sdf {
    /// What is inside of either.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self::new(
            self.field.min(&other.field),
            Around::union(self.around, other.around),
        )
    }

    /// What is inside of both.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let around = Around::intersection(self.around, other.around);
        Self::new(self.field.max(&other.field), around)
    }

    /// What is inside of this one alone.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A die with a dent in its top.
    /// let die = Sdf::cuboid(DVec3::splat(2.0))?.difference(&Sdf::sphere(0.4)?.moved(DVec3::Y));
    /// assert!(die.field().at(DVec3::Y * 0.9) > 0.0 && die.field().at(DVec3::ZERO) < 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        Self::new(self.field.max(&-&other.field), self.around)
    }

    /// As [`Sdf::union`], the two blended into one another where they are closer than about `k`.
    ///
    /// # Errors
    /// Where `k` is not a length.
    pub fn smooth_union(&self, other: &Self, k: f64) -> Result<Self, SceneError> {
        let k = length("the radius of the blend", k)?;
        let around = Around::union(self.around, other.around).map(|around| around.expanded(k * 0.25));
        Ok(Self::new(blend(&self.field, &other.field, k), around))
    }

    /// As [`Sdf::intersection`], its edges rounded.
    ///
    /// # Errors
    /// Where `k` is not a length.
    pub fn smooth_intersection(&self, other: &Self, k: f64) -> Result<Self, SceneError> {
        let k = length("the radius of the blend", k)?;
        let around = Around::intersection(self.around, other.around);
        Ok(Self::new(-blend(&-&self.field, &-&other.field, k), around))
    }

    /// As [`Sdf::difference`], the edges of the cut rounded.
    ///
    /// # Errors
    /// Where `k` is not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// let [block, bore] = [Sdf::cuboid(DVec3::splat(2.0))?, Sdf::cylinder(0.5, 3.0)?];
    /// // Near the rim of the hole the rounded cut takes away more, and the rounded part of both does, too.
    /// let rim = DVec3::new(0.55, 0.95, 0.0);
    /// assert!(block.difference(&bore).field().at(rim) < 0.0);
    /// assert!(block.smooth_difference(&bore, 0.4)?.field().at(rim) > 0.0);
    /// let within = DVec3::new(0.45, 0.95, 0.0);
    /// assert!(block.intersection(&bore).field().at(within) < 0.0);
    /// assert!(block.smooth_intersection(&bore, 0.4)?.field().at(within) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn smooth_difference(&self, other: &Self, k: f64) -> Result<Self, SceneError> {
        let k = length("the radius of the blend", k)?;
        Ok(Self::new(-blend(&-&self.field, &other.field, k), self.around))
    }
}

/// The lesser of two, less by up to k / 4 where they are alike (Quilez, "Smooth minimum", 2013, the quadratic one).
fn blend(a: &Field, b: &Field, k: f64) -> Field {
    let near = (constant(k) - (a - b).abs()).max(&constant(0.0)) * k.recip();
    a.min(b) - near.square() * (k * 0.25)
}
