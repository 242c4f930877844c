//! A matrix of the stack, with what has been found out about it.

use crate::{
    math::{self, DAffine3, DMat3, DVec3, max_abs},
    scene::TransformId,
};

/// A finite affine matrix that knows its place in the scene, once it has one, and whether it flattens space.
/// Scripts place thousands of shapes under one matrix and return to it after every push and pop, so what was
/// found out goes on the stack with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placing {
    matrix: DAffine3,
    id: Option<TransformId>,
    linear: Option<Linear>,
}

/// What depends on the upper left 3 x 3 alone, which translations leave as it is.
#[derive(Clone, Copy, Debug)]
struct Linear {
    is_singular: bool,
    /// No entry is -0.0. Then a product with a matrix of zeros beside its diagonal is, to the bit, the product
    /// with the diagonal: adding a zero of either sign changes nothing but -0.0.
    is_plain: bool,
}

impl Linear {
    fn of(m: &DMat3) -> Self {
        Self {
            is_singular: math::is_singular(m),
            is_plain: is_plain(m),
        }
    }
}

fn is_plain(m: &DMat3) -> bool {
    !has_negative_zero(m.to_cols_array())
}

#[inline]
fn has_negative_zero<const N: usize>(numbers: [f64; N]) -> bool {
    numbers.into_iter().any(|x| x.to_bits() == 1 << 63)
}

impl Placing {
    pub(super) const IDENTITY: Self = Self {
        matrix: DAffine3::IDENTITY,
        id: Some(TransformId::IDENTITY),
        linear: Some(Linear {
            is_singular: false,
            is_plain: true,
        }),
    };

    /// A matrix as it is; `None` where a number is beyond 1e15.
    pub(super) fn at(matrix: DAffine3) -> Option<Self> {
        let within = is_within(&matrix.matrix3) && max_abs(matrix.translation) <= 1e15;
        (within && matrix.is_finite()).then_some(Self {
            matrix,
            id: None,
            linear: None,
        })
    }

    /// World (or group) from object.
    pub(super) fn matrix(&self) -> &DAffine3 {
        &self.matrix
    }

    #[inline]
    fn linear(&mut self) -> Linear {
        *self
            .linear
            .get_or_insert_with(|| Linear::of(&self.matrix.matrix3))
    }

    /// See [`math::is_singular`].
    #[inline]
    pub(super) fn is_singular(&mut self) -> bool {
        self.linear().is_singular
    }

    /// Its handle, the same as long as the matrix is the same.
    #[inline]
    pub(super) fn id(&mut self, transforms: &mut Vec<DAffine3>) -> TransformId {
        if let Some(id) = self.id {
            return id;
        }
        let id = if self.matrix == DAffine3::IDENTITY {
            TransformId::IDENTITY
        } else {
            if transforms.last() != Some(&self.matrix) {
                transforms.push(self.matrix);
            }
            TransformId(transforms.len() as u32 - 1)
        };
        self.id = Some(id);
        id
    }

    /// Multiplies by `m` on the right; `None`, leaving all as it was, where a number would be beyond 1e15.
    pub(super) fn multiply(&mut self, m: &DAffine3) -> Option<()> {
        *self = Self::at(self.matrix * *m)?;
        Some(())
    }

    /// [`Placing::multiply`] by a translation.
    #[inline]
    pub(super) fn translate(&mut self, by: DVec3) -> Option<()> {
        if !self.linear().is_plain {
            return self.multiply(&DAffine3::from_translation(by));
        }
        let translation = self.matrix.matrix3 * by + self.matrix.translation;
        if !(translation.is_finite() && max_abs(translation) <= 1e15) {
            return None;
        }
        self.matrix.translation = translation;
        self.id = None;
        Some(())
    }

    /// [`Placing::multiply`] by a matrix that stretches by `by` along the axes.
    #[inline]
    pub(super) fn scale(&mut self, by: DVec3) -> Option<()> {
        let m = &self.matrix.matrix3;
        let product = DMat3::from_cols(m.x_axis * by.x, m.y_axis * by.y, m.z_axis * by.z);
        if !is_plain(&product) || has_negative_zero(self.matrix.translation.to_array()) {
            return self.multiply(&DAffine3::from_mat3(DMat3::from_diagonal(by)));
        }
        if !(product.is_finite() && is_within(&product)) {
            return None;
        }
        self.matrix.matrix3 = product;
        self.id = None;
        self.linear = None;
        Some(())
    }
}

#[inline]
fn is_within(m: &DMat3) -> bool {
    max_abs(m.x_axis).max(max_abs(m.y_axis)).max(max_abs(m.z_axis)) <= 1e15
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(m: &DAffine3) -> [u64; 12] {
        m.to_cols_array().map(f64::to_bits)
    }

    /// Matrices with zeros of both signs in every place that may have one.
    fn matrices() -> Vec<DAffine3> {
        let zeros = [0.0, -0.0];
        let mut found = vec![DAffine3::IDENTITY];
        for (zero, other) in [(0.0, 0.0), (0.0, -0.0), (-0.0, 0.0), (-0.0, -0.0)] {
            for sign in [1.0, -1.0] {
                let m = DMat3::from_cols_array(&[
                    sign * 1.5,
                    zero,
                    other,
                    zero,
                    -0.7,
                    -sign * 0.3,
                    2.0,
                    other,
                    0.4,
                ]);
                found.extend(zeros.map(|z| DAffine3::from_mat3_translation(m, DVec3::new(z, -1e-300, 3.0))));
            }
        }
        found.push(DAffine3::from_mat3(math::rotation(DVec3::X, 30.0)));
        found.push(DAffine3::from_mat3(math::rotation(DVec3::Y, -180.0)));
        found
    }

    fn at(matrix: DAffine3) -> Placing {
        Placing::at(matrix).unwrap()
    }

    #[test]
    fn shortcuts_give_the_bits_of_the_whole_product() {
        let vectors = [
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(-0.0, 0.0, -2.5),
            DVec3::new(0.0, -0.0, 0.0),
            DVec3::new(-1e-200, 1e14, -1e-320),
            DVec3::splat(1.0 / 3.0),
        ];
        for matrix in matrices() {
            for v in vectors {
                let mut moved = at(matrix);
                moved.translate(v).unwrap();
                let whole = matrix * DAffine3::from_translation(v);
                assert_eq!(bits(moved.matrix()), bits(&whole), "{matrix} translated by {v}");
                assert_eq!(moved.is_singular(), math::is_singular(&matrix.matrix3));
                let mut scaled = at(matrix);
                assert!(!scaled.is_singular());
                scaled.scale(v).unwrap();
                let whole = matrix * DAffine3::from_mat3(DMat3::from_diagonal(v));
                assert_eq!(bits(scaled.matrix()), bits(&whole), "{matrix} scaled by {v}");
                assert_eq!(scaled.is_singular(), math::is_singular(&whole.matrix3));
            }
        }
    }

    #[test]
    fn what_leads_beyond_bounds_is_refused_and_changes_nothing() {
        let mut placing = Placing::IDENTITY;
        placing.translate(DVec3::splat(9e14)).unwrap();
        placing.scale(DVec3::splat(1e10)).unwrap();
        let before = bits(placing.matrix());
        assert!(placing.translate(DVec3::X * 1e10).is_none());
        assert!(placing.scale(DVec3::splat(1e10)).is_none());
        assert!(
            placing
                .multiply(&DAffine3::from_scale(DVec3::splat(1e300)))
                .is_none()
        );
        assert_eq!(bits(placing.matrix()), before);
    }

    #[test]
    fn a_matrix_keeps_its_handle_and_the_identity_has_the_first() {
        let mut transforms = vec![DAffine3::IDENTITY];
        let mut there = Placing::IDENTITY;
        there.translate(DVec3::X).unwrap();
        let (mut other, mut back) = (there, there);
        assert_eq!(there.id(&mut transforms), TransformId(1));
        other.translate(DVec3::Y).unwrap();
        assert_eq!(other.id(&mut transforms), TransformId(2));
        assert_eq!(there.id(&mut transforms), TransformId(1));
        back.translate(-DVec3::X).unwrap();
        assert_eq!(back.id(&mut transforms), TransformId::IDENTITY);
        assert_eq!(transforms.len(), 3);
    }
}
