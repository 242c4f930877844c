//! Solids as fields that tell how far away they are, and what can be done with them.
//!
//! Most forms are those of Quilez, "Distance functions" (2008 and later). Each knows a box around itself: all points at
//! which the field is at most r lie in the box made larger by `growth` times r on all sides, so that what rounds, blends
//! or displaces a solid knows its box, too.

use super::{Field, Isosurface};
use crate::{
    math::{self, Bounds3, DMat3, DVec3},
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

    /// A ball around the origin.
    ///
    /// # Errors
    /// Where the radius is not a length.
    pub fn sphere(radius: f64) -> Result<Self, SceneError> {
        let radius = length("the radius", radius)?;
        let [x, y, z] = Field::point();
        let field = norm(&[&x, &y, &z]) - radius;
        Ok(Self::new(field, Some(Around::new(DVec3::splat(radius)))))
    }

    /// A box around the origin with edges of these lengths.
    ///
    /// # Errors
    /// Where one is not a length.
    pub fn cuboid(size: DVec3) -> Result<Self, SceneError> {
        for x in size.to_array() {
            length("an edge of the box", x)?;
        }
        let half = size * 0.5;
        let [x, y, z] = Field::point();
        let field = corner(&[x.abs() - half.x, y.abs() - half.y, z.abs() - half.z]);
        Ok(Self::new(field, Some(Around::new(half))))
    }

    /// A ring around the Y axis: the distance of the tube's middle from the axis, and its radius.
    ///
    /// # Errors
    /// Where one is not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// let ring = Sdf::torus(2.0, 0.5)?;
    /// // The middle of the tube is as deep inside as the tube is thick; the hole is outside.
    /// assert_eq!(ring.field().at(DVec3::X * 2.0), -0.5);
    /// assert_eq!(ring.field().at(DVec3::ZERO), 1.5);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn torus(major: f64, minor: f64) -> Result<Self, SceneError> {
        let (major, minor) = (
            length("the major radius", major)?,
            length("the minor radius", minor)?,
        );
        let [x, y, z] = Field::point();
        let field = norm(&[&(norm(&[&x, &z]) - major), &y]) - minor;
        let out = major + minor;
        Ok(Self::new(field, Some(Around::new(DVec3::new(out, minor, out)))))
    }

    /// A cylinder around the Y axis, centered at the origin.
    ///
    /// # Errors
    /// Where one is not a length.
    pub fn cylinder(radius: f64, height: f64) -> Result<Self, SceneError> {
        let (radius, height) = (length("the radius", radius)?, length("the height", height)?);
        let [x, y, z] = Field::point();
        let field = corner(&[norm(&[&x, &z]) - radius, y.abs() - height * 0.5]);
        let half = DVec3::new(radius, height * 0.5, radius);
        Ok(Self::new(field, Some(Around::new(half))))
    }

    /// All points within `radius` of the line between two points.
    ///
    /// # Errors
    /// Where the radius is not a length, the points are one, or a coordinate is beyond 1e15.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// let bone = Sdf::capsule(DVec3::ZERO, DVec3::X * 3.0, 0.5)?;
    /// assert_eq!(bone.field().at(DVec3::new(1.0, 2.0, 0.0)), 1.5);
    /// // It is round at its ends.
    /// assert_eq!(bone.bounds().map(|b| (b.min.x, b.max.x)), Some((-0.5, 3.5)));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn capsule(a: DVec3, b: DVec3, radius: f64) -> Result<Self, SceneError> {
        let radius = length("the radius", radius)?;
        for x in [a, b].into_iter().flat_map(|p| p.to_array()) {
            number("a coordinate", x)?;
        }
        length("the distance of the ends", a.distance(b))?;
        let along = b - a;
        let [x, y, z] = Field::point();
        let (px, py, pz) = (x - a.x, y - a.y, z - a.z);
        let dot = &px * along.x + &py * along.y + &pz * along.z;
        let share = (dot * along.length_squared().recip())
            .max(&constant(0.0))
            .min(&constant(1.0));
        let rest = |p: Field, along: f64| p - &share * along;
        let field = norm(&[&rest(px, along.x), &rest(py, along.y), &rest(pz, along.z)]) - radius;
        let around = Around {
            bounds: Bounds3::around([a, b]),
            growth: 1.0,
        };
        Ok(Self::new(field, Some(around.expanded(radius))))
    }

    /// A cone around the Y axis, centered at the origin, its tip up.
    ///
    /// # Errors
    /// Where one is not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A pine: a trunk, and two cones upon each other.
    /// let trunk = Sdf::cylinder(0.1, 1.0)?;
    /// let crown = Sdf::cone(0.6, 1.0)?;
    /// let pine = trunk.union(&crown.moved(DVec3::Y)).union(&crown.moved(DVec3::Y * 1.5));
    /// assert!(pine.field().at(DVec3::Y * 1.6) < 0.0);
    /// assert_eq!(pine.bounds().map(|b| (b.min.y, b.max.y)), Some((-0.5, 2.0)));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn cone(radius: f64, height: f64) -> Result<Self, SceneError> {
        let (radius, height) = (length("the radius", radius)?, length("the height", height)?);
        let [x, y, z] = Field::point();
        let slant = (radius * radius + height * height).sqrt();
        // Distances from the base and from the cone without end.
        let side = norm(&[&x, &z]) * (height / slant) + (&y - height * 0.5) * (radius / slant);
        let field = side.max(&(-y - height * 0.5));
        let around = Around {
            bounds: Bounds3::new(
                DVec3::new(-radius, -height * 0.5, -radius),
                DVec3::new(radius, height * 0.5, radius),
            ),
            // How far the tip and the rim of what is larger all around stand out.
            growth: (slant / radius).max((slant + radius) / height).max(1.0),
        };
        Ok(Self::new(field, Some(around)))
    }

    /// An ellipsoid around the origin with these radii.
    ///
    /// # Errors
    /// Where one is not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// let egg = Sdf::ellipsoid(DVec3::new(1.0, 1.4, 1.0))?;
    /// assert!(egg.field().at(DVec3::Y * 1.3) < 0.0 && egg.field().at(DVec3::X * 1.3) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn ellipsoid(radii: DVec3) -> Result<Self, SceneError> {
        for x in radii.to_array() {
            length("a radius", x)?;
        }
        let [x, y, z] = Field::point();
        let least = radii.min_element();
        let inner = norm(&[
            &(x * radii.x.recip()),
            &(y * radii.y.recip()),
            &(z * radii.z.recip()),
        ]);
        let around = Around {
            growth: radii.max_element() / least,
            ..Around::new(radii)
        };
        Ok(Self::new((inner - 1.0) * least, Some(around)))
    }

    /// All that lies below y = 0.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // The lower half of a ball: a bowl's form.
    /// let half = Sdf::sphere(1.0)?.intersection(&Sdf::plane());
    /// assert!(half.field().at(DVec3::Y * -0.5) < 0.0 && half.field().at(DVec3::Y * 0.5) > 0.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn plane() -> Self {
        let [_, y, _] = Field::point();
        Self::new(y, None)
    }

    /// A wall of this thickness along the gyroid (Schoen, 1970), a surface without end that repeats after `period`.
    ///
    /// # Errors
    /// Where one is not a length.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Sdf};
    /// // A lattice that fills a ball: without end itself, it has the ball's.
    /// let lattice = Sdf::gyroid(0.5, 0.06)?;
    /// assert!(lattice.bounds().is_none());
    /// let ball = lattice.intersection(&Sdf::sphere(1.0)?);
    /// assert_eq!(ball.bounds().map(|b| b.size()), Some(DVec3::splat(2.0)));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn gyroid(period: f64, thickness: f64) -> Result<Self, SceneError> {
        let (period, thickness) = (length("the period", period)?, length("the thickness", thickness)?);
        let k = 2.0 * math::PI / period;
        let [x, y, z] = Field::point().map(|x| x * k);
        let g = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        // It is at most this steep.
        Ok(Self::new(
            g.abs() * (k * 3f64.sqrt()).recip() - thickness * 0.5,
            None,
        ))
    }

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
        let angle = number("the angle", degrees)? * (math::PI / 180.0);
        let [x, y, z] = Field::point();
        let (s, c) = ((&y * angle).sin(), (&y * angle).cos());
        let point = [&c * &x - &s * &z, y, &s * &x + &c * &z];
        let around = self.around.map(|a| {
            let far = a
                .bounds
                .corners()
                .iter()
                .fold(0.0, |far: f64, p| far.max((p.x * p.x + p.z * p.z).sqrt()));
            let (low, high) = (a.bounds.min.y, a.bounds.max.y);
            a.around(
                [DVec3::new(-far, low, -far), DVec3::new(far, high, far)],
                2f64.sqrt(),
            )
        });
        Ok(Self::new(self.field.moved_to(&point), around))
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
        let angle = number("the angle", degrees)? * (math::PI / 180.0);
        let [x, y, z] = Field::point();
        let (s, c) = ((&x * angle).sin(), (&x * angle).cos());
        let point = [&c * &x - &s * &y, &s * &x + &c * &y, z];
        let around = self.around.map(|a| {
            let far = a
                .bounds
                .corners()
                .iter()
                .fold(0.0, |far: f64, p| far.max((p.x * p.x + p.y * p.y).sqrt()));
            let (low, high) = (a.bounds.min.z, a.bounds.max.z);
            a.around(
                [DVec3::new(-far, -far, low), DVec3::new(far, far, high)],
                2f64.sqrt(),
            )
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

/// The distance from a corner whose sides are at these distances, negative within.
fn corner(sides: &[Field]) -> Field {
    let zero = constant(0.0);
    let outside: Vec<Field> = sides.iter().map(|side| side.max(&zero)).collect();
    let outside = norm(&outside.iter().collect::<Vec<_>>());
    let inside = sides
        .iter()
        .cloned()
        .reduce(|a, b| a.max(&b))
        .unwrap_or_else(|| zero.clone());
    outside + inside.min(&zero)
}

/// The lesser of two, less by up to k / 4 where they are alike (Quilez, "Smooth minimum", 2013, the quadratic one).
fn blend(a: &Field, b: &Field, k: f64) -> Field {
    let near = (constant(k) - (a - b).abs()).max(&constant(0.0)) * k.recip();
    a.min(b) - near.square() * (k * 0.25)
}
