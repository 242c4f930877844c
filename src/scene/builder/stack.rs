//! The matrix stack.

use super::{Builder, Placing, SceneError, finite};
use crate::diag::Code;
use crate::math::{self, DAffine3, DMat3, DVec3};

impl Builder {
    /// The current matrix: world (or group) from object.
    #[must_use]
    pub fn current_transform(&self) -> DAffine3 {
        *self.ctm.matrix()
    }

    /// Saves the current matrix.
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    pub fn push_transform(&mut self) -> Result<(), SceneError> {
        if self.stack.len() >= self.limits.transform_depth {
            let limit = self.limits.transform_depth;
            return Err(SceneError::limit(
                "too many pushTransform and group levels",
                "transform_depth",
                limit,
            )
            .hint("every pushTransform() wants a popTransform()"));
        }
        self.stack.push((self.ctm, self.loc));
        Ok(())
    }

    /// Restores the matrix saved last.
    ///
    /// # Errors
    /// Where none is saved, or the last was saved outside the current `group` or `define` block.
    pub fn pop_transform(&mut self) -> Result<(), SceneError> {
        if self.stack.len() <= self.floor {
            let inside = if self.floor > 0 { " inside this block" } else { "" };
            return Err(
                SceneError::new(format!("popTransform without a pushTransform before it{inside}"))
                    .class(Code::PopWithoutPush)
                    .hint("each popTransform() undoes one pushTransform(); remove it or add the push"),
            );
        }
        if let Some((ctm, _)) = self.stack.pop() {
            self.ctm = ctm;
        }
        Ok(())
    }

    /// Multiplies the current matrix on the right, so that `m` acts before what was there.
    ///
    /// # Errors
    /// Where the product is not finite or beyond 1e15.
    pub fn multiply(&mut self, m: DAffine3) -> Result<(), SceneError> {
        self.ctm.multiply(&m).ok_or_else(beyond)
    }

    /// Moves what is made from now on.
    ///
    /// # Errors
    /// As [`Builder::multiply`].
    pub fn translate(&mut self, by: DVec3) -> Result<(), SceneError> {
        let by = finite("the translation", by)?;
        self.ctm.translate(by).ok_or_else(beyond)
    }

    /// Turns what is made from now on about `axis` (any length but 0) by `degrees`, right-handed.
    ///
    /// # Errors
    /// Where the axis is zero, or as [`Builder::multiply`].
    pub fn rotate(&mut self, axis: DVec3, degrees: f64) -> Result<(), SceneError> {
        let length = finite("the rotation's axis", axis)?.length();
        if !(length > 0.0) {
            return Err(
                SceneError::new("the rotation's axis is zero").hint("rotate([0, 1, 0], 45) turns about Y")
            );
        }
        if !degrees.is_finite() {
            return Err(SceneError::new("the rotation's angle is not a finite number"));
        }
        self.multiply(DAffine3::from_mat3(math::rotation(axis / length, degrees)))
    }

    /// Stretches what is made from now on along the axes.
    ///
    /// # Errors
    /// As [`Builder::multiply`].
    pub fn scale(&mut self, by: DVec3) -> Result<(), SceneError> {
        let by = finite("the scale", by)?;
        self.ctm.scale(by).ok_or_else(beyond)
    }

    /// Multiplies by a 4x4 matrix given row by row.
    ///
    /// # Errors
    /// Where it is not affine (last row 0 0 0 1), or as [`Builder::multiply`].
    pub fn mult_matrix(&mut self, rows: &[f64; 16]) -> Result<(), SceneError> {
        self.multiply(affine(rows)?)
    }

    /// Sets the current matrix to a 4x4 matrix given row by row, to the bit.
    ///
    /// # Errors
    /// As [`Builder::mult_matrix`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::DAffine3};
    /// let mut b = Builder::new();
    /// b.multiply(DAffine3::from_translation(DVec3::Y))?;
    /// // A shear, row by row, acts before what was there.
    /// b.mult_matrix(&[1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])?;
    /// assert_eq!(b.current_transform().transform_point3(DVec3::Y), DVec3::new(0.5, 2.0, 0.0));
    /// // From here on nothing of that.
    /// b.load_matrix(&[2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0])?;
    /// assert_eq!(b.current_transform().transform_point3(DVec3::Y), DVec3::Y * 2.0);
    /// b.load_identity();
    /// assert_eq!(b.current_transform(), DAffine3::IDENTITY);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn load_matrix(&mut self, rows: &[f64; 16]) -> Result<(), SceneError> {
        self.ctm = Placing::at(affine(rows)?).ok_or_else(beyond)?;
        Ok(())
    }

    /// Sets the current matrix to the identity.
    pub fn load_identity(&mut self) {
        self.ctm = Placing::IDENTITY;
    }
}

/// The matrix of 16 numbers row by row.
fn affine(rows: &[f64; 16]) -> Result<DAffine3, SceneError> {
    if let Some((i, x)) = rows.iter().enumerate().find(|(_, x)| !x.is_finite()) {
        let message = format!("matrix[{i}] must be a finite number, not {x}");
        return Err(SceneError::new(message));
    }
    let [a, b, c, x, d, e, f, y, g, h, i, z, last @ ..] = *rows;
    if last != [0.0, 0.0, 0.0, 1.0] {
        return Err(
            SceneError::new(format!("the matrix is not affine: its last row is {last:?}"))
                .hint("give the 16 numbers row by row; the last row must be 0, 0, 0, 1"),
        );
    }
    let linear = DMat3::from_cols(DVec3::new(a, d, g), DVec3::new(b, e, h), DVec3::new(c, f, i));
    Ok(DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z)))
}

#[cold]
fn beyond() -> SceneError {
    SceneError::new("the current matrix grows beyond 1e15")
        .hint("is a scale or translate repeated in a loop without pushTransform() and popTransform()?")
}
