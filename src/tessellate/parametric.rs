//! Parametric surfaces.

use super::{
    Allowance,
    refine::{self, Charts, Division},
};
use crate::{
    math::{Bounds3, DVec3},
    scene::{Mesh, SceneError},
};

/// How a parametric surface is made into triangles.
///
/// ```
/// use rtscript::{DVec3, Limits, scene::SceneError, tessellate::{Allowance, Parametric}};
/// let sheet = Parametric { u: [0.0, 1.0], v: [0.0, 1.0], ..Parametric::default() };
/// let mut saddle = |u: f64, v: f64| Ok::<_, SceneError>(DVec3::new(u, u * v, v));
/// let mesh = sheet.mesh(&mut saddle, &Allowance::of(&Limits::default()))?;
/// assert!(mesh.triangles.len() > 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parametric {
    /// From where to where u goes. Default: 0 to 1.
    pub u: [f64; 2],
    /// From where to where v goes. Default: 0 to 1.
    pub v: [f64; 2],
    /// How far triangles may be off the surface, in object units, greater than 0. Default: a thousandth of the surface's
    /// size.
    pub tolerance: Option<f64>,
    /// Cells along u to begin with, from 3 to 1000: what is smaller than a cell and lies between its corners may be missed.
    /// Default: 8.
    pub columns: usize,
    /// Cells along v to begin with. Default: 8.
    pub rows: usize,
}

impl Default for Parametric {
    fn default() -> Self {
        Self {
            u: [0.0, 1.0],
            v: [0.0, 1.0],
            tolerance: None,
            columns: 8,
            rows: 8,
        }
    }
}

/// A share of the surface's size in which points that are to be one may differ, by rounding in the function.
const SAME: f64 = 1e-9;
/// Half of the way over which a derivative is taken, of the whole way of a parameter.
const STEP: f64 = 1e-4;

impl Parametric {
    /// The triangles of the surface `f(u, v)`: each cell is divided until edges and insides are within the tolerance, by
    /// what the function gives at their quarters, at the most ten times. The front is where u to v runs counter-clockwise,
    /// and the outside where the surface is closed.
    ///
    /// Sides that come together to within rounding, as those of a tube, are joined, and so is a side that is one point, as
    /// at the poles of a sphere. Normals are central differences.
    ///
    /// # Errors
    /// Those of `f`; where a number makes no sense, the surface has no area, or the triangles are too many.
    pub fn mesh<E: From<SceneError>>(
        &self,
        f: &mut dyn FnMut(f64, f64) -> Result<DVec3, E>,
        allowance: &Allowance<'_>,
    ) -> Result<Mesh, E> {
        self.check()?;
        let mut chart = Chart {
            f,
            u: self.u,
            v: self.v,
            wraps: [false; 2],
            poles: [[false; 2]; 2],
        };
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        let size = chart.look(4 * columns, 4 * rows)?;
        let division = Division {
            charts: 1,
            columns,
            rows,
            tolerance: self.tolerance.unwrap_or(size / 1000.0),
        };
        refine::mesh("surface", &mut chart, division, allowance)
    }

    fn check(&self) -> Result<(), SceneError> {
        for (name, [low, high]) in [("u", self.u), ("v", self.v)] {
            if !(low.is_finite() && high.is_finite() && low != high) {
                return Err(SceneError::new(format!(
                    "{name} must go from one number to another, not from {low} to {high}"
                )));
            }
        }
        for (name, n) in [("columns", self.columns), ("rows", self.rows)] {
            if !(3..=1000).contains(&n) {
                return Err(SceneError::new(format!("{name} must be from 3 to 1000, not {n}")));
            }
        }
        tolerance(self.tolerance)
    }
}

/// Refuses a bound that is none.
pub(super) fn tolerance(given: Option<f64>) -> Result<(), SceneError> {
    match given {
        Some(x) if !(x > 0.0 && x.is_finite()) => Err(SceneError::new(format!(
            "tolerance must be greater than 0, not {x}"
        ))),
        _ => Ok(()),
    }
}

struct Chart<'f, E> {
    f: &'f mut dyn FnMut(f64, f64) -> Result<DVec3, E>,
    u: [f64; 2],
    v: [f64; 2],
    /// Whether the sides u = 0 and u = 1 are one, and so for v.
    wraps: [bool; 2],
    /// Whether the sides u = 0, u = 1 and v = 0, v = 1 are one point each.
    poles: [[bool; 2]; 2],
}

impl<E: From<SceneError>> Chart<'_, E> {
    fn at(&mut self, u: f64, v: f64) -> Result<DVec3, E> {
        let along = |[low, high]: [f64; 2], t: f64| if t == 1.0 { high } else { low + (high - low) * t };
        (self.f)(along(self.u, u), along(self.v, v))
    }

    /// Finds out which sides come together, and how large the surface is.
    fn look(&mut self, columns: u32, rows: u32) -> Result<f64, E> {
        let mut side = |count: u32, at: &dyn Fn(f64) -> (f64, f64)| -> Result<Vec<DVec3>, E> {
            let places = (0..=count).map(|i| at(f64::from(i) / f64::from(count)));
            places.map(|(u, v)| self.at(u, v)).collect()
        };
        let left = side(rows, &|t| (0.0, t))?;
        let right = side(rows, &|t| (1.0, t))?;
        let low = side(columns, &|t| (t, 0.0))?;
        let high = side(columns, &|t| (t, 1.0))?;
        let middle = side(columns, &|t| (t, 0.5))?;
        let upright = side(rows, &|t| (0.5, t))?;
        let all = [&left, &right, &low, &high, &middle, &upright];
        let size = Bounds3::around(all.into_iter().flatten().copied())
            .size()
            .length();
        let near = |a: &DVec3, b: &DVec3| (*a - *b).length() <= SAME * size;
        let joined = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).all(|(a, b)| near(a, b));
        let is_point = |side: &[DVec3]| {
            side.first()
                .is_some_and(|first| side.iter().all(|p| near(p, first)))
        };
        self.wraps = [joined(&left, &right), joined(&low, &high)];
        self.poles = [
            [is_point(&left), is_point(&right)],
            [is_point(&low), is_point(&high)],
        ];
        Ok(size)
    }

    /// The one of several names of a point by which it is asked for.
    fn canonical(&self, mut u: f64, mut v: f64) -> (f64, f64) {
        let [[left, right], [low, high]] = self.poles;
        if (v == 0.0 && low) || (v == 1.0 && high) {
            u = 0.0;
        }
        if (u == 0.0 && left) || (u == 1.0 && right) {
            v = 0.0;
        }
        let [wraps_u, wraps_v] = self.wraps;
        (
            if wraps_u && u == 1.0 { 0.0 } else { u },
            if wraps_v && v == 1.0 { 0.0 } else { v },
        )
    }

    /// The derivative along one parameter, by central differences, at a side that is not joined one-sided of second order.
    fn derivative(&mut self, t: f64, wraps: bool, at: impl Fn(f64) -> (f64, f64)) -> Result<DVec3, E> {
        let mut point = |t: f64| {
            let (u, v) = at(if wraps { t - t.floor() } else { t });
            self.at(u, v)
        };
        if wraps || (t - STEP >= 0.0 && t + STEP <= 1.0) {
            return Ok(point(t + STEP)? - point(t - STEP)?);
        }
        let way = if t < 0.5 { STEP } else { -STEP };
        let (here, next, after) = (point(t)?, point(t + way)?, point(t + 2.0 * way)?);
        Ok((next * 4.0 - after - here * 3.0) * way.signum())
    }
}

impl<E: From<SceneError>> Charts for Chart<'_, E> {
    type Error = E;

    fn point(&mut self, _: u32, u: f64, v: f64) -> Result<DVec3, E> {
        let (u, v) = self.canonical(u, v);
        self.at(u, v)
    }

    fn normal(&mut self, _: u32, u: f64, v: f64) -> Result<Option<DVec3>, E> {
        let [[left, right], [low, high]] = self.poles;
        if (v == 0.0 && low) || (v == 1.0 && high) || (u == 0.0 && left) || (u == 1.0 && right) {
            return Ok(None);
        }
        let [wraps_u, wraps_v] = self.wraps;
        let du = self.derivative(u, wraps_u, |t| (t, v))?;
        let dv = self.derivative(v, wraps_v, |t| (u, t))?;
        Ok(du.cross(dv).try_normalize().filter(|n| n.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::{
        Limits,
        math::{PI, cos, sin},
    };

    fn made(parametric: Parametric, f: impl Fn(f64, f64) -> DVec3) -> Mesh {
        let mut f = |u: f64, v: f64| -> Result<DVec3, SceneError> { Ok(f(u, v)) };
        parametric
            .mesh(&mut f, &Allowance::of(&Limits::default()))
            .unwrap()
    }

    /// The largest distance of points of the surface, which are asked for densely, from the mesh: first from the triangle
    /// at the same u and v, and where that is `far`, as beside poles, from all of them.
    fn farthest(mesh: &Mesh, far: f64, f: impl Fn(f64, f64) -> DVec3) -> f64 {
        let uvs = mesh.uvs.as_ref().unwrap();
        let mut worst: f64 = 0.0;
        for face in 0..mesh.triangles.len() {
            let (corners, uv) = (mesh.corners(face), uvs.corners(face).unwrap());
            for (i, j) in (0..=6).flat_map(|i| (0..=6 - i).map(move |j| (i, j))) {
                let (s, t) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
                let at = uv[0] * (1.0 - s - t) + uv[1] * s + uv[2] * t;
                let p = f(at.x, at.y);
                let mut off = suite::distance(p, corners);
                if off > far {
                    let all = (0..mesh.triangles.len()).map(|face| suite::distance(p, mesh.corners(face)));
                    off = all.fold(off, f64::min);
                }
                worst = worst.max(off);
            }
        }
        worst
    }

    fn torus(u: f64, v: f64) -> DVec3 {
        let (u, v) = (2.0 * PI * u, 2.0 * PI * v);
        let r = 2.0 + 0.5 * cos(v);
        DVec3::new(r * cos(u), 0.5 * sin(v), r * sin(u))
    }

    fn ball(u: f64, v: f64) -> DVec3 {
        let (u, v) = (2.0 * PI * u, PI * v);
        DVec3::new(sin(v) * cos(u), cos(v), sin(v) * sin(u))
    }

    #[test]
    fn triangles_are_within_the_tolerance_and_closed_where_the_surface_is() {
        for tolerance in [0.1, 0.01, 0.003] {
            for (f, volume) in [
                (torus as fn(f64, f64) -> DVec3, 2.0 * PI * PI * 2.0 * 0.25),
                (ball, 4.0 * PI / 3.0),
            ] {
                let parametric = Parametric {
                    tolerance: Some(tolerance),
                    ..Parametric::default()
                };
                let mesh = made(parametric, f);
                suite::check_closed(&mesh);
                suite::check_normals(&mesh, 0.3);
                let off = farthest(&mesh, tolerance, f);
                assert!(off <= tolerance * 1.05, "{off} for {tolerance}");
                let less = 1.0 - suite::volume(&mesh) / volume;
                assert!(less < tolerance * 8.0 && less > 0.0, "{less} for {tolerance}");
            }
        }
    }

    #[test]
    fn what_is_flat_stays_coarse_and_what_bends_is_divided_without_cracks() {
        let tolerance = Some(0.001);
        let flat = made(Parametric::default(), |u, v| DVec3::new(u, 0.0, v));
        assert_eq!(flat.triangles.len(), 128);
        let bump = |u: f64, v: f64| {
            let r = (u - 0.3) * (u - 0.3) + (v - 0.4) * (v - 0.4);
            DVec3::new(u, 0.2 * crate::math::exp(-60.0 * r), v)
        };
        let mesh = made(
            Parametric {
                tolerance,
                ..Parametric::default()
            },
            bump,
        );
        assert!(farthest(&mesh, 0.001, bump) <= 0.00105);
        assert!(mesh.triangles.len() < 4000, "{}", mesh.triangles.len());
        // Open edges lie on the sides of the square alone.
        for (a, b) in suite::open(&mesh) {
            let (a, b) = (mesh.positions[a as usize], mesh.positions[b as usize]);
            let on_a_side =
                (a.x == b.x && (a.x == 0.0 || a.x == 1.0)) || (a.z == b.z && (a.z == 0.0 || a.z == 1.0));
            assert!(on_a_side, "{a} {b}");
        }
    }

    #[test]
    fn normals_are_those_of_the_formula() {
        let mesh = made(Parametric::default(), ball);
        let normals = mesh.normals.as_ref().unwrap();
        for face in 0..mesh.triangles.len() {
            for (p, n) in mesh.corners(face).into_iter().zip(normals.corners(face).unwrap()) {
                // The poles have none of their own, and get that of the triangles around.
                let least = if p.y.abs() > 0.999 { 0.999 } else { 1.0 - 1e-12 };
                assert!(n.dot(p) > least, "{n} at {p}");
            }
        }
    }

    #[test]
    fn errors_come_through_and_nonsense_is_refused() {
        let allowance = Allowance::of(&Limits::default());
        let mut failing = |u: f64, _: f64| -> Result<DVec3, SceneError> {
            if u > 0.4 {
                Err(SceneError::new("no"))
            } else {
                Ok(DVec3::X * u)
            }
        };
        let error = Parametric::default().mesh(&mut failing, &allowance).unwrap_err();
        assert_eq!(error.message, "no");
        let mut fine = |u: f64, v: f64| -> Result<DVec3, SceneError> { Ok(torus(u, v)) };
        let mut message =
            |parametric: Parametric| parametric.mesh(&mut fine, &allowance).unwrap_err().message;
        let default = Parametric::default();
        assert_eq!(
            message(Parametric {
                u: [1.0, 1.0],
                ..default
            }),
            "u must go from one number to another, not from 1 to 1"
        );
        assert_eq!(
            message(Parametric { rows: 2, ..default }),
            "rows must be from 3 to 1000, not 2"
        );
        assert_eq!(
            message(Parametric {
                tolerance: Some(-1.0),
                ..default
            }),
            "tolerance must be greater than 0, not -1"
        );
        let mut line = |u: f64, _: f64| -> Result<DVec3, SceneError> { Ok(DVec3::X * u) };
        assert_eq!(
            default.mesh(&mut line, &allowance).unwrap_err().message,
            "the surface has no area"
        );
        let few = Limits {
            primitives: 500,
            ..Limits::default()
        };
        let fine_ones = Parametric {
            tolerance: Some(1e-6),
            ..default
        };
        let error = fine_ones.mesh(&mut fine, &Allowance::of(&few)).unwrap_err();
        assert!(error.message.contains("'primitives'"));
    }
}
