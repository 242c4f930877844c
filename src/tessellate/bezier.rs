//! Bicubic Bezier patches.

use super::{
    Allowance, parametric,
    refine::{self, Charts, Division},
};
use crate::{
    math::{Bounds3, DVec3},
    scene::{Mesh, SceneError},
};

/// Bicubic patches that may share sides: rows of four control points, u along a row, v from row to row.
///
/// ```
/// use rtscript::{DVec3, Limits, tessellate::{Allowance, BezierPatches}};
/// let flat = std::array::from_fn(|i| DVec3::new((i % 4) as f64, 0.0, (i / 4) as f64));
/// let sheet = BezierPatches { patches: vec![flat], tolerance: None };
/// assert!(!sheet.mesh(&Allowance::of(&Limits::default()))?.triangles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatches {
    /// Sixteen control points each.
    pub patches: Vec<[DVec3; 16]>,
    /// How far triangles may be off the surface, in object units, greater than 0. Default: a thousandth of its size.
    pub tolerance: Option<f64>,
}

impl BezierPatches {
    /// Their triangles, with exact normals. Patches with the same control points along a side meet there without a crack.
    /// The front is where u to v runs counter-clockwise, and the outside where the patches enclose something.
    ///
    /// # Errors
    /// Where there are no patches, a number makes no sense, the patches have no area, or the triangles are too many.
    pub fn mesh(&self, allowance: &Allowance<'_>) -> Result<Mesh, SceneError> {
        parametric::tolerance(self.tolerance)?;
        if self.patches.is_empty() {
            return Err(SceneError::new("there are no patches"));
        }
        let points = self.patches.iter().flatten().copied();
        if let Some(wrong) = points.clone().position(|p| !(crate::math::max_abs(p) <= 1e15)) {
            return Err(SceneError::new(format!(
                "point {} of patch {} is not within 1e15 of the origin",
                wrong % 16,
                wrong / 16
            )));
        }
        allowance.triangles(self.patches.len().saturating_mul(2))?;
        let size = Bounds3::around(points).size().length();
        let division = Division {
            charts: self.patches.len() as u32,
            columns: 2,
            rows: 2,
            tolerance: self.tolerance.unwrap_or(size / 1000.0),
        };
        refine::mesh("bezierPatch", &mut Patches(&self.patches), division, allowance)
    }
}

struct Patches<'a>(&'a [[DVec3; 16]]);

/// Point and derivative, but for a factor, of a cubic by de Casteljau's algorithm. Written so that the curve run backwards
/// has the same bits: 1 - t is exact for the places that are asked for.
fn cubic([a, b, c, d]: [DVec3; 4], t: f64) -> (DVec3, DVec3) {
    if a == b && a == c && a == d {
        // Rounding would make several points of one.
        return (a, DVec3::ZERO);
    }
    let s = 1.0 - t;
    let mix = |a: DVec3, b: DVec3| a * s + b * t;
    let (ab, bc, cd) = (mix(a, b), mix(b, c), mix(c, d));
    let (abc, bcd) = (mix(ab, bc), mix(bc, cd));
    (mix(abc, bcd), bcd - abc)
}

impl Patches<'_> {
    /// The point and both derivatives.
    fn at(&self, chart: u32, u: f64, v: f64) -> (DVec3, DVec3, DVec3) {
        let Some(points) = self.0.get(chart as usize) else {
            return (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        };
        let (rows, _) = points.as_chunks::<4>();
        let row = |i: usize| cubic(rows.get(i).copied().unwrap_or_default(), u);
        let [a, b, c, d] = [0, 1, 2, 3].map(row);
        let (point, along_v) = cubic([a.0, b.0, c.0, d.0], v);
        let (along_u, _) = cubic([a.1, b.1, c.1, d.1], v);
        (point, along_u, along_v)
    }
}

impl Charts for Patches<'_> {
    type Error = SceneError;

    fn point(&mut self, chart: u32, u: f64, v: f64) -> Result<DVec3, SceneError> {
        Ok(self.at(chart, u, v).0)
    }

    fn normal(&mut self, chart: u32, u: f64, v: f64) -> Result<Option<DVec3>, SceneError> {
        let extent = self.0.get(chart as usize).map_or(0.0, |points| {
            Bounds3::around(points.iter().copied()).size().length()
        });
        // Where control points coincide, as at the tip of a lid, the normal is that right beside.
        for inwards in [0.0, 1e-5, 1e-3] {
            let beside = |t: f64| t + (0.5 - t) * inwards;
            let (_, du, dv) = self.at(chart, beside(u), beside(v));
            let normal = du.cross(dv);
            if normal.length() > 1e-12 * extent * extent {
                return Ok(normal.try_normalize());
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::Limits;

    /// A closed pillow of two patches that share their rims, one of them laid out the other way, and a random one.
    fn pillow(rng: &mut suite::Rng) -> Vec<[DVec3; 16]> {
        let mut points = |lift: f64| -> [DVec3; 16] {
            std::array::from_fn(|i| {
                let (x, z) = ((i % 4) as f64, (i / 4) as f64);
                let inner = (i % 4 == 1 || i % 4 == 2) && (i / 4 == 1 || i / 4 == 2);
                let y = if inner { lift * (1.0 + rng.unit()) } else { 0.0 };
                DVec3::new(x, y, z)
            })
        };
        let (above, below) = (points(1.0), points(-1.0));
        // Rows become columns: sides meet that run along u in one patch and along v in the other.
        let turned = std::array::from_fn(|i| below[4 * (i % 4) + i / 4]);
        vec![above, turned]
    }

    #[test]
    fn patches_that_share_sides_close() {
        let mut rng = suite::Rng::new(7);
        for tolerance in [0.1, 0.01, 0.002] {
            let patches = BezierPatches {
                patches: pillow(&mut rng),
                tolerance: Some(tolerance),
            };
            let mesh = patches.mesh(&Allowance::of(&Limits::default())).unwrap();
            suite::check_closed(&mesh);
            suite::check_normals(&mesh, 0.2);
        }
    }

    #[test]
    fn points_and_normals_are_those_of_bernsteins_polynomials() {
        let mut rng = suite::Rng::new(8);
        for _ in 0..20 {
            let points: [DVec3; 16] = std::array::from_fn(|i| {
                DVec3::new((i % 4) as f64, rng.unit(), (i / 4) as f64 + 0.3 * rng.unit())
            });
            let weights = |t: f64| {
                let s = 1.0 - t;
                [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
            };
            let at = |u: f64, v: f64| -> DVec3 {
                let (bu, bv) = (weights(u), weights(v));
                (0..16).map(|i| points[i] * bu[i % 4] * bv[i / 4]).sum()
            };
            let patches = BezierPatches {
                patches: vec![points],
                tolerance: Some(0.01),
            };
            let mesh = patches.mesh(&Allowance::of(&Limits::default())).unwrap();
            let (uvs, normals) = (mesh.uvs.as_ref().unwrap(), mesh.normals.as_ref().unwrap());
            for face in 0..mesh.triangles.len() {
                let (corners, uv) = (mesh.corners(face), uvs.corners(face).unwrap());
                for (i, n) in normals.corners(face).unwrap().into_iter().enumerate() {
                    assert!((at(uv[i].x, uv[i].y) - corners[i]).length() < 1e-12);
                    let (u, v) = (uv[i].x, uv[i].y);
                    let du = at(u + 1e-5, v) - at(u - 1e-5, v);
                    let dv = at(u, v + 1e-5) - at(u, v - 1e-5);
                    assert!(n.dot(du.cross(dv).normalize()) > 1.0 - 1e-8);
                }
                for t in [0.2, 0.5, 0.7] {
                    let middle = uv[0] * (1.0 - t) + (uv[1] + uv[2]) * (t / 2.0);
                    let off = suite::distance(at(middle.x, middle.y), corners);
                    assert!(off <= 0.0105, "{off}");
                }
            }
        }
    }

    #[test]
    fn sides_that_are_one_point_close() {
        // A ball of eight patches, each with a side that is a pole, by the usual constant for a quarter of a circle.
        const K: f64 = 0.552_284_749_8;
        let arc = [(1.0, 0.0), (1.0, K), (K, 1.0), (0.0, 1.0)];
        let patches: Vec<[DVec3; 16]> = (0..8)
            .map(|octant| {
                let quarter = |x: f64, z: f64| match octant % 4 {
                    0 => (x, z),
                    1 => (-z, x),
                    2 => (-x, -z),
                    _ => (z, -x),
                };
                let up = if octant < 4 { 1.0 } else { -1.0 };
                std::array::from_fn(|i| {
                    let ((cx, cz), (r, y)) = (arc[i % 4], arc[i / 4]);
                    let (x, z) = quarter(cx * r, cz * r);
                    // Below, the patch is laid out the other way round, so that it faces outwards too.
                    let (cx, cz) = arc[3 - i % 4];
                    let (bx, bz) = quarter(cx * r, cz * r);
                    if up > 0.0 {
                        DVec3::new(x, y, z)
                    } else {
                        DVec3::new(bx, -y, bz)
                    }
                })
            })
            .collect();
        for tolerance in [0.1, 0.01, 0.001] {
            let ball = BezierPatches {
                patches: patches.clone(),
                tolerance: Some(tolerance),
            };
            let mesh = ball.mesh(&Allowance::of(&Limits::default())).unwrap();
            suite::check_closed(&mesh);
            suite::check_normals(&mesh, 0.3);
            let less = 1.0 - suite::volume(&mesh) / (4.0 * crate::math::PI / 3.0);
            assert!(less < 4.0 * tolerance && less > -0.002, "{less}");
        }
    }

    #[test]
    fn corners_where_points_coincide_have_normals() {
        let cone: [DVec3; 16] = std::array::from_fn(|i| {
            let (x, y) = ((i % 4) as f64 - 1.5, (i / 4) as f64);
            DVec3::new(x * y, 0.3 * y * y, y)
        });
        let patches = BezierPatches {
            patches: vec![cone],
            tolerance: None,
        };
        let mesh = patches.mesh(&Allowance::of(&Limits::default())).unwrap();
        suite::check_normals(&mesh, 0.8);
        let none = BezierPatches {
            patches: vec![[DVec3::ONE; 16]],
            tolerance: None,
        };
        assert!(none.mesh(&Allowance::of(&Limits::default())).is_err());
    }
}
