//! From one matrix to another in words: moved, turned, scaled.

use super::Way;
use crate::math::{self, DMat3, DVec3, PI, max_abs};

/// How far a number may be off by rounding, as a part of what it is made of.
const ROUNDING: f64 = 1e-9;

/// What leads from the first placing to the second, each the linear part of its matrix and the place of its origin.
pub(super) fn motion((a, from): (DMat3, DVec3), (b, to): (DMat3, DVec3)) -> Vec<Way> {
    let mut ways = Vec::new();
    let by = to - from;
    if max_abs(by) > ROUNDING * max_abs(from).max(max_abs(to)) {
        ways.push(Way::Moved(by));
    }
    let size = largest(&a).max(largest(&b));
    if largest(&(b - a)) <= ROUNDING * size {
        return ways;
    }
    if math::is_singular(&a) || math::is_singular(&b) {
        ways.push(Way::Placed);
        return ways;
    }
    // b = outside * a = a * inside.
    let inverse = a.inverse();
    let (outside, inside) = (b * inverse, inverse * b);
    let factors = DVec3::new(inside.x_axis.x, inside.y_axis.y, inside.z_axis.z);
    let along_axes = largest(&(inside - DMat3::from_diagonal(factors))) <= ROUNDING * largest(&inside);
    if along_axes && factors.min_element() > 0.0 {
        ways.push(Way::Scaled(factors));
        return ways;
    }
    let alike = similarity(&outside).map(|(factor, turn)| (turn, DVec3::splat(factor)));
    let Some((turn, by)) = alike.or_else(|| turn_and_scale(&a, &b)) else {
        ways.push(match along_axes {
            true => Way::Scaled(factors),
            false => Way::Placed,
        });
        return ways;
    };
    let (axis, degrees) = axis_and_angle(&turn);
    ways.push(Way::Turned(axis, degrees));
    if max_abs(by - DVec3::ONE) > ROUNDING {
        ways.push(Way::Scaled(by));
    }
    ways
}

/// The rotation outside and the factors inside that lead from `a` to `b`, where both have axes at right angles.
fn turn_and_scale(a: &DMat3, b: &DMat3) -> Option<(DMat3, DVec3)> {
    let axes = |m: &DMat3| {
        let lengths = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
        let unit = *m * DMat3::from_diagonal(DVec3::ONE / lengths);
        let product = unit.transpose() * unit;
        (largest(&(product - DMat3::IDENTITY)) <= ROUNDING).then_some((unit, lengths))
    };
    let ((a, a_lengths), (b, b_lengths)) = (axes(a)?, axes(b)?);
    let turn = b * a.transpose();
    (turn.determinant() > 0.0).then_some((turn, b_lengths / a_lengths))
}

fn largest(m: &DMat3) -> f64 {
    max_abs(m.x_axis).max(max_abs(m.y_axis)).max(max_abs(m.z_axis))
}

/// A factor and a rotation, where `m` is their product.
fn similarity(m: &DMat3) -> Option<(f64, DMat3)> {
    let factor = m.x_axis.length();
    if !(factor > 0.0 && m.determinant() > 0.0) {
        return None;
    }
    let turn = *m * (1.0 / factor);
    let unit = turn.transpose() * turn;
    (largest(&(unit - DMat3::IDENTITY)) <= ROUNDING).then_some((factor, turn))
}

/// The axis of a rotation, the first of its components that is not 0 positive where the angle allows, and the angle in
/// degrees from 0 to 180.
fn axis_and_angle(turn: &DMat3) -> (DVec3, f64) {
    let [x, y, z] = [turn.x_axis, turn.y_axis, turn.z_axis];
    let twice_sine = DVec3::new(y.z - z.y, z.x - x.z, x.y - y.x);
    let cosine = (x.x + y.y + z.z - 1.0) * 0.5;
    let degrees = math::atan2(twice_sine.length() * 0.5, cosine) * (180.0 / PI);
    if twice_sine.length() > 1e-6 {
        return (twice_sine / twice_sine.length(), degrees);
    }
    // Half a turn: turn = 2 axis axis^T - 1, whose longest column shows the axis best.
    let columns = [x + DVec3::X, y + DVec3::Y, z + DVec3::Z];
    let longest = columns.into_iter().fold(
        DVec3::X * 1e-12,
        |a, b| if b.length() > a.length() { b } else { a },
    );
    (longest / longest.length(), degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(a: DMat3, b: DMat3) -> Vec<Way> {
        motion((a, DVec3::ZERO), (b, DVec3::ZERO))
    }

    #[track_caller]
    fn assert_turned(ways: &[Way], axis: DVec3, degrees: f64) {
        let Some(Way::Turned(found, angle)) = ways.first() else {
            panic!("{ways:?}");
        };
        assert!(
            (*found - axis).length() < 1e-6 && (angle - degrees).abs() < 1e-9,
            "{ways:?}"
        );
    }

    #[test]
    fn moves_are_moves() {
        let m = math::rotation(DVec3::Y, 17.0);
        let ways = motion((m, DVec3::X), (m, DVec3::new(1.0, 2.0, 0.0)));
        assert_eq!(ways, [Way::Moved(DVec3::new(0.0, 2.0, 0.0))]);
        assert_eq!(from(m, m), []);
    }

    #[test]
    fn turns_have_axis_and_angle() {
        let a = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.0));
        let axis = DVec3::new(1.0, -2.0, 2.0) / 3.0;
        for degrees in [1e-3, 30.0, 90.0, 179.0, 180.0] {
            let ways = from(a, math::rotation(axis, degrees) * a);
            assert_eq!(ways.len(), 1);
            if degrees < 180.0 {
                assert_turned(&ways, axis, degrees);
            }
        }
        assert_turned(&from(a, math::rotation(DVec3::Z, 180.0) * a), DVec3::Z, 180.0);
        assert_turned(&from(a, math::rotation(DVec3::Y, -30.0) * a), -DVec3::Y, 30.0);
    }

    #[test]
    fn scales_are_along_the_own_axes() {
        let a = math::rotation(DVec3::new(0.6, 0.8, 0.0), 40.0);
        let by = DVec3::new(2.0, 1.0, 0.5);
        let ways = from(a, a * DMat3::from_diagonal(by));
        let [Way::Scaled(found)] = ways[..] else {
            panic!("{ways:?}");
        };
        assert!((found - by).length() < 1e-12);
        let wider = from(a, math::rotation(DVec3::X, 10.0) * a * DMat3::from_diagonal(by));
        assert_turned(&wider, DVec3::X, 10.0);
        assert!(matches!(wider[1], Way::Scaled(found) if (found - by).length() < 1e-9));
        assert_eq!(
            from(
                DMat3::IDENTITY,
                DMat3::from_diagonal(-DVec3::X + DVec3::Y + DVec3::Z)
            ),
            [Way::Scaled(DVec3::new(-1.0, 1.0, 1.0))]
        );
        let both = from(a, math::rotation(DVec3::X, 10.0) * a * 3.0);
        assert_turned(&both, DVec3::X, 10.0);
        assert!(matches!(both[1], Way::Scaled(by) if (by - DVec3::splat(3.0)).length() < 1e-9));
    }

    #[test]
    fn the_rest_is_another_matrix() {
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::Z);
        assert_eq!(from(DMat3::IDENTITY, shear), [Way::Placed]);
        assert_eq!(from(DMat3::ZERO, DMat3::IDENTITY), [Way::Placed]);
    }
}
