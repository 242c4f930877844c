//! Matrices by what they are to achieve: to face something, to stand along something.

use super::{Builder, SceneError, finite};
use crate::math::{DAffine3, DMat3, DVec3};

impl Builder {
    /// Moves the origin to `from` and turns what is made from now on so that its +Z looks at `at` and its +Y up, as far as it can:
    /// `up` is any direction but that of the look. All three are given in the space of the current matrix.
    ///
    /// # Errors
    /// Where `at` is `from`, `up` is zero or runs along the look, or as [`Builder::multiply`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// // A lamp's head at the ceiling that looks at the middle of the floor.
    /// b.look_at(DVec3::new(3.0, 4.0, 0.0), DVec3::ZERO, DVec3::Y)?;
    /// let nose = b.current_transform().transform_point3(DVec3::Z * 5.0);
    /// assert!(nose.length() < 1e-12);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn look_at(&mut self, from: DVec3, at: DVec3, up: DVec3) -> Result<(), SceneError> {
        for (what, v) in [("from", from), ("at", at), ("up", up)] {
            finite(what, v)?;
        }
        let Some(z) = unit(at - from) else {
            return Err(SceneError::new(
                "there is nowhere to look: at is where the look comes from",
            ));
        };
        let side = unit(up).and_then(|up| unit_unless_tiny(up.cross(z)));
        let Some(x) = side else {
            return Err(SceneError::new(
                "up must be a direction other than that of the look, and it runs along it or is zero",
            ));
        };
        let turn = DMat3::from_cols(x, z.cross(x), z);
        self.multiply(DAffine3::from_mat3_translation(turn, from))
    }

    /// Turns what is made from now on so that its Y axis points along `direction` (any length but 0), on the shortest way: about
    /// the axis at right angles to both.
    ///
    /// # Errors
    /// Where `direction` is zero, or as [`Builder::multiply`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// // A tree that grows out of a slope.
    /// let slope = DVec3::new(1.0, 1.0, 0.0);
    /// b.align_to(slope)?;
    /// let top = b.current_transform().transform_point3(DVec3::Y);
    /// assert!((top - slope.normalize()).length() < 1e-12);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn align_to(&mut self, direction: DVec3) -> Result<(), SceneError> {
        finite("direction", direction)?;
        let Some(y) = unit(direction) else {
            return Err(SceneError::new("direction must have a length, and this one is 0"));
        };
        self.multiply(DAffine3::from_mat3(y_to(y)))
    }

    /// Moves, turns and stretches along Y what is made from now on, so that what reaches from y = -0.5 to 0.5 reaches from `a`
    /// to `b`: `between(a, b)` and a cylinder of height 1 make a rod.
    ///
    /// # Errors
    /// Where the points fall together, or as [`Builder::multiply`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, shape::{Cylinder, Shape}};
    /// let mut b = Builder::new();
    /// let [a, c] = [DVec3::ZERO, DVec3::new(2.0, 1.0, 0.0)];
    /// b.between(a, c)?;
    /// b.shape(Shape::Cylinder(Cylinder::new(0.05, 1.0)?))?;
    /// let ends = [-0.5, 0.5].map(|y| b.current_transform().transform_point3(DVec3::Y * y));
    /// assert!((ends[0] - a).length() < 1e-12 && (ends[1] - c).length() < 1e-12);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn between(&mut self, a: DVec3, b: DVec3) -> Result<(), SceneError> {
        finite("a", a)?;
        finite("b", b)?;
        let Some(y) = unit(b - a) else {
            return Err(SceneError::new(
                "a and b fall together, so nothing reaches from one to the other",
            ));
        };
        let mut turn = y_to(y);
        turn.y_axis = b - a;
        self.multiply(DAffine3::from_mat3_translation(turn, a + (b - a) * 0.5))
    }
}

fn unit(v: DVec3) -> Option<DVec3> {
    // Divided first, so that neither very long nor very short vectors lose their square.
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| {
        let v = v / largest;
        v / v.length()
    })
}

/// As [`unit`], `None` also where nothing but rounding is left of a product of unit vectors.
fn unit_unless_tiny(v: DVec3) -> Option<DVec3> {
    (v.abs().max_element() > 1e-12).then(|| unit(v))?
}

/// The shortest turn of +Y to the unit vector `y` (Moller and Hughes, "Efficiently building a matrix to rotate one vector to
/// another", 1999); half a turn about X where that is -Y.
fn y_to(y: DVec3) -> DMat3 {
    if y.y < 0.0 {
        // By way of -Y, where the formula is well conditioned: half a turn about X, then the turn from -Y.
        let turn = shortest(DVec3::new(-y.x, -y.y, -y.z));
        return DMat3::from_cols(turn.x_axis, -turn.y_axis, -turn.z_axis);
    }
    shortest(y)
}

/// The shortest turn of +Y to `y`, which is not below the ground.
fn shortest(y: DVec3) -> DMat3 {
    let k = 1.0 / (1.0 + y.y);
    DMat3::from_cols(
        DVec3::new(1.0 - y.x * y.x * k, -y.x, -y.x * y.z * k),
        y,
        DVec3::new(-y.x * y.z * k, -y.z, 1.0 - y.z * y.z * k),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> impl Iterator<Item = DVec3> {
        let axis = [-1.0, -1e-9, 0.0, 0.3, 1.0];
        let all = axis
            .into_iter()
            .flat_map(move |x| axis.into_iter().map(move |y| (x, y)));
        all.flat_map(move |(x, y)| axis.into_iter().map(move |z| DVec3::new(x, y, z)))
            .filter(|d| *d != DVec3::ZERO)
    }

    fn is_rotation(m: DMat3) -> bool {
        let off = m.transpose() * m - DMat3::IDENTITY;
        off.to_cols_array().iter().all(|x| x.abs() < 1e-14) && (m.determinant() - 1.0).abs() < 1e-14
    }

    #[test]
    fn y_goes_where_it_is_told_by_a_rotation() {
        for d in directions() {
            let mut b = Builder::new();
            b.align_to(d * 1e7).unwrap();
            let m = b.current_transform().matrix3;
            assert!(is_rotation(m), "{d}: {m}");
            assert!((m.y_axis - d.normalize()).length() < 1e-14, "{d}");
        }
        assert!(Builder::new().align_to(DVec3::ZERO).is_err());
    }

    #[test]
    fn a_look_faces_its_aim_with_its_head_up() {
        let (from, up) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.1, 0.9, -0.3));
        for d in directions() {
            let mut b = Builder::new();
            b.look_at(from, from + d, up).unwrap();
            let m = b.current_transform();
            assert!(is_rotation(m.matrix3), "{d}");
            let look = from + d - from;
            assert!((m.matrix3.z_axis - look.normalize()).length() < 1e-14);
            assert!(m.matrix3.y_axis.dot(up) > 0.0);
            assert_eq!(m.translation, from);
        }
        assert!(Builder::new().look_at(from, from, up).is_err());
        assert!(Builder::new().look_at(from, from + up * 2.0, up).is_err());
    }

    #[test]
    fn what_is_between_reaches_from_one_to_the_other() {
        for d in directions() {
            let a = DVec3::new(4.0, -1.0, 2.0);
            let mut b = Builder::new();
            b.between(a, a + d).unwrap();
            let m = b.current_transform();
            assert!((m.transform_point3(DVec3::Y * -0.5) - a).length() < 1e-14);
            assert!((m.transform_point3(DVec3::Y * 0.5) - (a + d)).length() < 1e-14);
            assert!((m.matrix3.x_axis.length() - 1.0).abs() < 1e-14);
        }
        assert!(Builder::new().between(DVec3::X, DVec3::X).is_err());
    }
}
