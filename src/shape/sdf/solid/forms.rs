//! Solids to begin with.

use super::{Around, Sdf, constant, length, norm, number};
use crate::{
    math::{self, Bounds3, DVec3},
    scene::SceneError,
    shape::sdf::Field,
};

impl Sdf {
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
