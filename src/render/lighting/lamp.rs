//! What is worked out about lights once for a picture.

use super::area::Cells;
use crate::{
    math::{self, DMat3, DVec3},
    scene::{LightForm, LightKind, Scene, SurfaceLight},
};

/// What a light needs besides what the scene says of it.
#[derive(Clone, Debug)]
pub(in crate::render) enum Lamp {
    /// Nothing.
    Plain,
    /// From the world to the space where the light is a sphere of radius 1.
    Sphere(DMat3),
    /// A mesh in the world, each triangle with the area of all up to its end.
    Mesh(Vec<(f64, [DVec3; 3])>),
    /// Unit vectors to the right in the picture, up in it, and ahead, and half its height at distance 1.
    Projector([DVec3; 3], f64),
    /// The cells of an area light.
    Area(Cells),
}

impl Lamp {
    /// Those of the scene's root by their number; none where none is more than plain.
    pub(in crate::render) fn of_all(scene: &Scene) -> Vec<Self> {
        let is_plain = |kind: &LightKind| {
            !matches!(
                kind,
                LightKind::Surface(_) | LightKind::Projector(_) | LightKind::Area { .. }
            )
        };
        let lights = &scene.root().lights;
        if lights.iter().all(|light| is_plain(&light.kind)) {
            return Vec::new();
        }
        lights
            .iter()
            .zip(0..)
            .map(|(light, index)| Self::of(index, &light.kind))
            .collect()
    }

    fn of(index: u64, kind: &LightKind) -> Self {
        match kind {
            LightKind::Surface(surface) => match surface.form() {
                LightForm::Sphere => Self::Sphere(surface.placing().matrix3.inverse()),
                LightForm::Mesh(mesh) => Self::Mesh(placed(surface, mesh.triangles())),
                LightForm::Rectangle | LightForm::Disk => Self::Plain,
            },
            LightKind::Projector(projector) => {
                let frame = projector.frame();
                frame.map_or(Self::Plain, |frame| Self::Projector(frame, projector.extent()))
            }
            LightKind::Area { n, .. } => Self::Area(Cells::new(index, *n)),
            _ => Self::Plain,
        }
    }
}

/// Triangles where the light is, wound so that their fronts stay fronts in a mirror.
fn placed(surface: &SurfaceLight, triangles: &[[DVec3; 3]]) -> Vec<(f64, [DVec3; 3])> {
    let is_mirrored = surface.placing().matrix3.determinant() < 0.0;
    let mut sum = 0.0;
    triangles
        .iter()
        .map(|corners| {
            let [a, mut b, mut c] = corners.map(|p| surface.placing().transform_point3(p));
            if is_mirrored {
                (b, c) = (c, b);
            }
            sum += 0.5 * (b - a).cross(c - a).length();
            (sum, [a, b, c])
        })
        .collect()
}

/// A point of the unit disk, areas kept (Shirley and Chiu, "A low distortion map between disk and square", 1997).
pub(super) fn on_disk(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let quarter = math::PI / 4.0;
    let (r, angle) = if a.abs() > b.abs() {
        (a, quarter * (b / a))
    } else {
        (b, 2.0 * quarter - quarter * (a / b))
    };
    (r * math::cos(angle), r * math::sin(angle))
}

/// A unit vector around `axis`, all directions within the cone alike: 1 minus the cosine of the angle at the cone's edge
/// is `cap`.
pub(super) fn in_cone(axis: DVec3, cap: f64, u: f64, v: f64) -> DVec3 {
    // The disk's points keep strata compact, and the square of their distance is even.
    let (x, y) = on_disk(u, v);
    let r2 = x * x + y * y;
    let below = cap * r2;
    // sin of the angle over r.
    let spread = (cap * (2.0 - below)).max(0.0).sqrt();
    let (right, up) = crate::scene::around(axis);
    right * (x * spread) + up * (y * spread) + axis * (1.0 - below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_are_filled_evenly() {
        let axis = DVec3::new(0.6, -0.48, 0.64);
        let cap = 0.7;
        let (mut sum, mut squares, mut all) = (0.0, 0.0, DVec3::ZERO);
        for (i, j) in (0..200).flat_map(|i| (0..200).map(move |j| (i, j))) {
            let at = |k: u32| (f64::from(k) + 0.5) / 200.0;
            let dir = in_cone(axis, cap, at(i), at(j));
            assert!((dir.length() - 1.0).abs() < 1e-14);
            let below = 1.0 - dir.dot(axis);
            assert!((-1e-15..cap).contains(&below));
            sum += below / 40_000.0;
            squares += below * below / 40_000.0;
            all += dir / 40_000.0;
        }
        // Even from 0 to cap, and no side preferred.
        assert!((sum - cap / 2.0).abs() < 1e-4, "{sum}");
        assert!((squares - cap * cap / 3.0).abs() < 1e-4, "{squares}");
        assert!((all - axis * (1.0 - cap / 2.0)).length() < 1e-4, "{all}");
    }
}
