//! The sphere sweep: a sphere that moves along a curve and changes its size.

use super::{
    CrossingSink, Solidity, Surface, coordinates,
    pieces::{Framed, Line, LineOfBoxes},
    roots::{Bernstein, derivative, nearest, product, sharpened},
};
use crate::{
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
    spline::{Piece, Spline},
};

/// All that a sphere passes which moves along a curve while its radius changes: a tube with round ends.
///
/// Parameters in object units: center and radius at each point, as [x, y, z, r], and how the curve follows the points.
/// Along straight lines it is the convex hull of each two neighbouring spheres. Solid. Normals outwards. What lies inside
/// another part of the sweep is no surface.
///
/// uv: u around the curve, without twist from its beginning on; v from the first point (0) to the last (1), every piece
/// between points taking the same part.
///
/// ```
/// use rtscript::{shape::SphereSweep, spline::Spline};
/// // Each ball is x, y, z, radius.
/// let worm = SphereSweep::new(vec![[0.0, 0.0, 0.0, 0.3], [1.0, 0.5, 0.0, 0.2], [2.0, 0.0, 0.0, 0.1]], Spline::CatmullRom)?;
/// assert_eq!(worm.points().len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct SphereSweep {
    points: Vec<[f64; 4]>,
    spline: Spline,
    path: Framed<Piece<4>>,
    /// A direction across the curve at the beginning of each piece, from where u counts.
    across: Vec<DVec3>,
}

/// The points and how they are curved; all else follows from them.
impl std::fmt::Debug for SphereSweep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SphereSweep")
            .field("points", &self.points)
            .field("spline", &self.spline)
            .finish()
    }
}

impl Solidity for SphereSweep {
    const SOLID: bool = true;
}

impl SphereSweep {
    /// The sweep through these centers and radii [x, y, z, r] in object units.
    ///
    /// # Errors
    /// Where there are too few points, a number is not finite or beyond 1e15, or a radius is negative or all are 0.
    pub fn new(points: Vec<[f64; 4]>, spline: Spline) -> Result<Self, SceneError> {
        for (i, point) in points.iter().enumerate() {
            let what = format_args!("the sphere sweep's points[{i}]");
            coordinates(what, point, ["x", "y", "z", "radius"])?;
            if point[3] < 0.0 {
                return Err(SceneError::new(format!(
                    "the sphere sweep's points[{i}], radius, must not be negative, but it is {}",
                    point[3]
                )));
            }
        }
        if points.iter().all(|p| p[3] == 0.0) {
            return Err(SceneError::new(
                "the sphere sweep must have a radius greater than 0 somewhere",
            ));
        }
        let pieces = spline
            .pieces(&points, false)
            .map_err(|e| SceneError::new(format!("the sphere sweep must have {e}")))?;
        let bounds = pieces
            .iter()
            .fold(Bounds3::EMPTY, |all, piece| all.union(&around(piece)));
        let path = Framed::new(
            bounds,
            pieces,
            |frame, piece| {
                Piece(piece.0.map(|[x, y, z, r]| {
                    let p = frame.of(DVec3::new(x, y, z));
                    [p.x, p.y, p.z, r / frame.scale()]
                }))
            },
            around,
        );
        Ok(Self {
            across: directions_across(path.pieces()),
            points,
            spline,
            path,
        })
    }

    /// Centers and radii, [x, y, z, r].
    #[must_use]
    pub fn points(&self) -> &[[f64; 4]] {
        &self.points
    }

    /// How the curve follows its points.
    #[must_use]
    pub const fn spline(&self) -> Spline {
        self.spline
    }

    pub(super) fn pieces(&self) -> usize {
        self.path.pieces().len()
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.path.bounds())
    }

    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = self.path.frame().line(ray) else {
            return;
        };
        let mut runs = Vec::new();
        let boxes = LineOfBoxes::new(&line.ray);
        self.path.each(
            |b| boxes.meets(b),
            |i, piece| runs_inside(piece, i, &line, &mut runs),
        );
        runs.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.piece.cmp(&b.piece)));
        let mut current: Option<(Run, u32)> = None;
        let mut push = |run: Run, last: u32| {
            out.push(line.t(run.from), run.piece);
            out.push(line.t(run.to), last);
        };
        for run in runs {
            current = match current {
                Some((whole, last)) if run.from <= whole.to => {
                    let longer = run.to > whole.to;
                    let to = if longer { run.to } else { whole.to };
                    Some((Run { to, ..whole }, if longer { run.piece } else { last }))
                }
                Some((whole, last)) => {
                    push(whole, last);
                    Some((run, run.piece))
                }
                None => Some((run, run.piece)),
            };
        }
        if let Some((whole, last)) = current {
            push(whole, last);
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let q = self.path.frame().of(p);
        let i = part as usize;
        let (Some(piece), Some(across)) = (self.path.pieces().get(i), self.across.get(i)) else {
            return Surface {
                normal: DVec3::Y,
                uv: DVec2::ZERO,
            };
        };
        // The sphere that reaches farthest beyond the point.
        let u = nearest(piece, [q.x, q.y, q.z, 0.0], [1.0, 1.0, 1.0, -1.0]);
        let [x, y, z, _] = piece.position(u);
        let out = q - DVec3::new(x, y, z);
        let (from, to) = (direction(piece, 0.0), direction(piece, u));
        let right = carried(*across, from, to);
        let angle = math::atan2(out.dot(to.cross(right)), out.dot(right)) / (2.0 * PI) + 0.5;
        let v = (i as f64 + u) / self.pieces() as f64;
        Surface {
            normal: if out == DVec3::ZERO { DVec3::Y } else { out },
            uv: DVec2::new(angle, v).clamp(DVec2::ZERO, DVec2::ONE),
        }
    }
}

/// The box around all spheres of a piece.
fn around(piece: &Piece<4>) -> Bounds3 {
    let largest = piece.coordinate(3).iter().fold(0.0, |a: f64, r| a.max(r.abs()));
    let centers = Bounds3::around(piece.0.iter().map(|[x, y, z, _]| DVec3::new(*x, *y, *z)));
    Bounds3::new(centers.min - largest, centers.max + largest)
}

/// The unit vector in which the curve travels.
fn direction(piece: &Piece<4>, u: f64) -> DVec3 {
    let [x, y, z, _] = piece.tangent(u);
    DVec3::new(x, y, z).try_normalize().unwrap_or(DVec3::Y)
}

/// A vector across `from`, turned along with it to `to` by the shortest way.
fn carried(v: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let along = 1.0 + from.dot(to);
    if along > 1e-9 {
        v - (from + to) * (v.dot(to) / along)
    } else {
        v
    }
}

fn directions_across(pieces: &[Piece<4>]) -> Vec<DVec3> {
    let mut across: Option<(DVec3, DVec3)> = None;
    let next = |piece: &Piece<4>| {
        let start = direction(piece, 0.0);
        let right = match across {
            Some((end, right)) => carried(right, end, start),
            None => start.any_orthonormal_vector(),
        };
        let end = direction(piece, 1.0);
        across = Some((end, carried(right, start, end)));
        right
    };
    pieces.iter().map(next).collect()
}

/// A part of a line inside the sweep of one piece, by its ways.
#[derive(Clone, Copy, Debug)]
struct Run {
    from: f64,
    to: f64,
    piece: u32,
}

/// The parts of a line within the sweep of a piece.
///
/// The sphere at `u` covers the way from s - sqrt(D) to s + sqrt(D), s being how far along the line its center is and D
/// the square of its radius less that of the center's distance from the line. Where D is not negative from one `u` to
/// another, those ways run into each other, and what they cover together is one way: from the least beginning to the
/// greatest end. Both are at an end of these `u` or where 4 s'^2 D = D'^2, a polynomial of degree 10 for a cubic.
fn runs_inside(piece: &Piece<4>, number: u32, line: &Line, runs: &mut Vec<Run>) {
    let (o, d) = (line.ray.origin, line.ray.dir);
    let (right, up) = d.any_orthonormal_pair();
    let off = piece.0.map(|[x, y, z, _]| DVec3::new(x, y, z) - o);
    let along = Bernstein(off.map(|w| w.dot(d)));
    let aside = [right, up].map(|axis| Bernstein(off.map(|w| w.dot(axis))));
    let radius = Bernstein(piece.coordinate(3));
    let mut covered: Bernstein<7> = product(&radius, &radius);
    for side in &aside {
        let square: Bernstein<7> = product(side, side);
        covered.0.iter_mut().zip(square.0).for_each(|(c, s)| *c -= s);
    }
    if covered.0.iter().all(|c| *c < 0.0) {
        return;
    }
    // The powers above cancel; here each is taken by itself.
    let reach = |u: f64| {
        let (r, x, y) = (radius.at(u).0, aside[0].at(u).0, aside[1].at(u).0);
        let root = (r * r - x * x - y * y).max(0.0).sqrt();
        let s = along.at(u).0;
        (s - root, s + root)
    };
    let mut turns = Vec::new();
    let (speed, bend): (Bernstein<3>, Bernstein<6>) = (derivative(&along), derivative(&covered));
    let speed2: Bernstein<5> = product(&speed, &speed);
    let mut turning: Bernstein<11> = product(&speed2, &covered);
    let bend2: Bernstein<11> = product(&bend, &bend);
    for (t, b) in turning.0.iter_mut().zip(bend2.0) {
        *t = 4.0 * *t - b;
    }
    // Both ways' ends turn near together where the line is square to the curve: there the powers tell no more than that.
    let turn = |u: f64, side: f64| {
        let ((r, dr), (x, dx), (y, dy)) = (radius.at(u), aside[0].at(u), aside[1].at(u));
        let root = (r * r - x * x - y * y).max(0.0).sqrt();
        along.at(u).1 * root + side * (r * dr - x * dx - y * dy)
    };
    turning.zeros(&mut |u| turns.extend([-1.0, 1.0].map(|side| sharpened(|u| turn(u, side), u))));

    let mut run = |from: f64, to: f64| {
        let mut whole = reach(from);
        for u in turns.iter().copied().filter(|u| *u > from && *u < to).chain([to]) {
            let (a, b) = reach(u);
            whole = (whole.0.min(a), whole.1.max(b));
        }
        runs.push(Run {
            from: whole.0,
            to: whole.1,
            piece: number,
        });
    };
    let mut from = (covered.0[0] >= 0.0).then_some(0.0);
    covered.sign_changes(&mut |u, falls| {
        if falls {
            run(from.take().unwrap_or(u), u);
        } else {
            from = Some(u);
        }
    });
    if let Some(from) = from {
        run(from, 1.0);
    }
}
