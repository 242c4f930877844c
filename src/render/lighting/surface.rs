//! Points of lights that have a size.

use super::{
    kinds::Sent,
    lamp::{Lamp, in_cone, on_disk},
};
use crate::{
    color::Color,
    math::{self, DMat3, DVec3},
    scene::{Falloff, LightForm, SurfaceLight},
};

/// The point `(u, v)` in [0, 1)^2 of a surface, as seen from `p`, where its color is `color`; `None` where it sends
/// nothing.
pub(super) fn sent(
    (surface, lamp, color): (&SurfaceLight, &Lamp, Color),
    p: DVec3,
    (u, v): (f64, f64),
) -> Option<Sent> {
    let m = surface.placing();
    let (point, front) = match (surface.form(), lamp) {
        (LightForm::Sphere, Lamp::Sphere(inverse)) => {
            return of_sphere((surface, inverse, color), m.translation - p, (u, v));
        }
        (LightForm::Mesh(_), Lamp::Mesh(triangles)) => on_mesh(triangles, u, v)?,
        (LightForm::Disk, _) => {
            let (x, y) = on_disk(u, v);
            (m.transform_point3(DVec3::new(x, y, 0.0)), front(&m.matrix3))
        }
        _ => (m.transform_point3(DVec3::new(u, v, 0.0)), front(&m.matrix3)),
    };
    let offset = point - p;
    let distance = offset.length();
    let towards = offset / distance;
    let share = match surface.falloff() {
        Falloff::Attenuation(attenuation) => attenuation.at(distance),
        Falloff::Physical => {
            let cosine = -towards.dot(front) / front.length();
            cosine.max(0.0) / (distance * distance)
        }
    };
    // Not where the point lies in the light, nor behind it.
    (share > 0.0 && share.is_finite() && distance > 0.0).then(|| Sent {
        towards,
        distance,
        arriving: color * share,
    })
}

/// Normal of a placed rectangle or disk, of any length, on the side of the third axis.
fn front(m: &DMat3) -> DVec3 {
    let normal = m.x_axis.cross(m.y_axis);
    if normal.dot(m.z_axis) < 0.0 {
        -normal
    } else {
        normal
    }
}

/// A point of triangles, all areas alike, with its normal.
fn on_mesh(triangles: &[(f64, [DVec3; 3])], u: f64, v: f64) -> Option<(DVec3, DVec3)> {
    let (total, _) = triangles.last()?;
    let at = u * total;
    let index = triangles
        .partition_point(|(end, _)| *end <= at)
        .min(triangles.len() - 1);
    let (end, [a, b, c]) = triangles.get(index)?;
    let begin = index
        .checked_sub(1)
        .and_then(|i| triangles.get(i))
        .map_or(0.0, |(end, _)| *end);
    // What is left of u says where in the triangle, so that strata stay strata.
    let rest = ((at - begin) / (end - begin)).clamp(0.0, 1.0);
    let s = rest.sqrt();
    let (along, across) = ((*b - *a) * s, (*c - *b) * (s * v));
    Some((*a + along + across, (*b - *a).cross(*c - *a)))
}

/// The part of a sphere that is seen, all directions in its own space alike (Shirley, Wang and Zimmerman, "Monte Carlo
/// techniques for direct lighting calculations", 1996); for a true sphere those are directions in the world as well.
/// `to_center` leads from the point that looks to the light's center. From inside all of it is seen.
fn of_sphere(
    (surface, inverse, color): (&SurfaceLight, &DMat3, Color),
    to_center: DVec3,
    (u, v): (f64, f64),
) -> Option<Sent> {
    let m = &surface.placing().matrix3;
    let center = *inverse * to_center;
    let far2 = center.length_squared();
    let far = far2.sqrt();
    // 1 minus the cosine of the cone's half angle.
    let cap = if far2 > 1.0 {
        let sin2 = 1.0 / far2;
        sin2 / (1.0 + (1.0 - sin2).sqrt())
    } else {
        2.0
    };
    let axis = if far > 0.0 { center / far } else { DVec3::Z };
    let dir = in_cone(axis, cap, u, v);
    let along = dir.dot(center);
    let half = (along * along - far2 + 1.0).max(0.0).sqrt();
    let t = if far2 > 1.0 { along - half } else { along + half };
    let there = *m * dir;
    let stretch = there.length();
    let (towards, distance) = (there / stretch, t * stretch);
    let share = match surface.falloff() {
        Falloff::Attenuation(attenuation) => attenuation.at(distance),
        Falloff::Physical => {
            // Radiance 1 / (pi r^2), r being that of a true sphere of the same volume, times the solid angle: the
            // matrix makes det / |M d|^3 of it.
            let volume = m.determinant().abs();
            let r = math::cbrt(volume);
            let spread = volume / (stretch * stretch * stretch);
            2.0 * cap * spread / (r * r)
        }
    };
    (share > 0.0 && share.is_finite() && distance > 0.0).then(|| Sent {
        towards,
        distance,
        arriving: color * share,
    })
}
