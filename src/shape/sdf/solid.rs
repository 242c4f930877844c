//! Solids as fields that tell how far away they are, and what can be done with them.
//!
//! Most forms are those of Quilez, "Distance functions" (2008 and later). Each knows a box around itself: all points at
//! which the field is at most r lie in the box made larger by `growth` times r on all sides, so that what rounds, blends
//! or displaces a solid knows its box, too.

mod changes;
mod forms;
mod joins;

use super::{Field, Isosurface};
use crate::{
    math::{self, Bounds3, DVec3},
    scene::SceneError,
};

/// A solid as a field: negative inside, and outside roughly as large as the distance from it.
///
/// ```
/// use rtscript::{Builder, DVec3, shape::{Sdf, Shape}};
/// let ball = Sdf::sphere(1.0)?;
/// let solid = ball.smooth_union(&ball.moved(DVec3::X), 0.3)?.hollowed(0.05)?;
/// let mut b = Builder::new();
/// b.shape(Shape::Isosurface(solid.isosurface()?.into()))?;
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sdf {
    field: Field,
    around: Option<Around>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Around {
    bounds: Bounds3,
    growth: f64,
}

impl Around {
    fn new(half: DVec3) -> Self {
        Self {
            bounds: Bounds3::new(-half, half),
            growth: 1.0,
        }
    }

    fn expanded(self, by: f64) -> Self {
        let by = DVec3::splat(by.max(0.0) * self.growth);
        Self {
            bounds: Bounds3::new(self.bounds.min - by, self.bounds.max + by),
            ..self
        }
    }

    fn around(self, points: impl IntoIterator<Item = DVec3>, growth: f64) -> Self {
        Self {
            bounds: Bounds3::around(points),
            growth: self.growth * growth,
        }
    }

    fn union(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (a, b) = a.zip(b)?;
        Some(Self {
            bounds: a.bounds.union(&b.bounds),
            growth: a.growth.max(b.growth),
        })
    }

    fn intersection(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (a, b) else {
            return a.or(b);
        };
        let both = Bounds3::new(a.bounds.min.max(b.bounds.min), a.bounds.max.min(b.bounds.max));
        // Far apart: the box of either is right.
        let bounds = if both.is_empty() { a.bounds } else { both };
        let growth = if both.is_empty() {
            a.growth
        } else {
            a.growth.max(b.growth)
        };
        Some(Self { bounds, growth })
    }
}

/// A length that is greater than 0 and at most 1e15.
fn length(what: &str, x: f64) -> Result<f64, SceneError> {
    if x > 0.0 && x <= 1e15 {
        return Ok(x);
    }
    Err(SceneError::new(format!(
        "{what} must be greater than 0 and at most 1e15, not {x}"
    )))
}

/// A number of at most 1e15 in size.
fn number(what: &str, x: f64) -> Result<f64, SceneError> {
    if x.abs() <= 1e15 {
        return Ok(x);
    }
    Err(SceneError::new(format!(
        "{what} must be a number within 1e15, not {x}"
    )))
}

fn constant(x: f64) -> Field {
    Field::constant(x)
}

/// The length of a vector of fields.
fn norm(fields: &[&Field]) -> Field {
    let lengths = fields.iter().copied().cloned();
    lengths
        .reduce(|a, b| a.hypot(&b))
        .unwrap_or_else(|| constant(0.0))
}

impl Sdf {
    fn new(field: Field, around: Option<Around>) -> Self {
        Self { field, around }
    }

    /// The inside of any field, with a box around it where one is known.
    ///
    /// ```
    /// use rtscript::{DVec3, math::Bounds3, shape::{Field, Sdf}};
    /// // Piet Hein's superellipsoid, x^2.5 + y^2.5 + z^2.5 = 1, and how far it reaches.
    /// let [x, y, z] = Field::point().map(|axis| axis.abs().pow(2.5));
    /// let within = Bounds3::new(DVec3::splat(-1.1), DVec3::splat(1.1));
    /// let egg = Sdf::from_field(x + y + z - 1.0, Some(within));
    /// // It goes together with other solids.
    /// let half = egg.intersection(&Sdf::plane());
    /// assert!(half.field().at(DVec3::Y * -0.9) < 0.0 && half.field().at(DVec3::Y * 0.9) > 0.0);
    /// half.isosurface()?;
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn from_field(field: Field, within: Option<Bounds3>) -> Self {
        let around = within.map(|bounds| Around {
            bounds,
            growth: f64::INFINITY,
        });
        Self::new(field, around)
    }

    /// The field.
    #[must_use]
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// A box around it; `None` where it has no end or none is known.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds3> {
        let bounds = self.around?.bounds;
        (bounds.min.is_finite() && bounds.max.is_finite()).then_some(bounds)
    }

    /// The shape.
    ///
    /// # Errors
    /// Where no box around it is known, or it is too long an expression.
    pub fn isosurface(&self) -> Result<Isosurface, SceneError> {
        let Some(bounds) = self.bounds() else {
            return Err(
                SceneError::new("nothing tells where the field ends, so it needs bounds")
                    .hint("give them: isosurface(f, #{ bounds: [[-1, -1, -1], [1, 1, 1]] })"),
            );
        };
        // Off by a little, so that the surface does not lie in the faces of the box.
        let slack = DVec3::splat(1e-3 * math::max_abs(bounds.size()).max(1e-9));
        Isosurface::new(
            self.field.clone(),
            Bounds3::new(bounds.min - slack, bounds.max + slack),
        )
    }
}
