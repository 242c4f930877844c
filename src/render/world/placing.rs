//! What matrices do to points, normals and spheres.

use crate::math::{DAffine3, DMat3, DVec3};

/// A point where `placing` takes it; the same bits where it leaves it alone.
pub(super) fn place(placing: &DAffine3, p: DVec3) -> DVec3 {
    if *placing == DAffine3::IDENTITY {
        p
    } else {
        placing.transform_point3(p)
    }
}

/// Takes normals to where `placing` takes points.
pub(super) fn normal_matrix(placing: &DAffine3) -> DMat3 {
    placing.matrix3.inverse().transpose()
}

/// The factor by which a matrix scales all lengths alike; `None` where it does not, to 14 digits.
pub(super) fn similarity(m: &DMat3) -> Option<f64> {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let scale2 = x.length_squared();
    let small = 1e-14 * scale2;
    let same = |a: f64, b: f64| (a - b).abs() <= small;
    let alike = same(y.length_squared(), scale2)
        && same(z.length_squared(), scale2)
        && same(x.dot(y), 0.0)
        && same(y.dot(z), 0.0)
        && same(z.dot(x), 0.0);
    alike.then(|| scale2.sqrt())
}
