//! The lathe: a profile turned around Y.

use super::{
    CrossingSink, Solidity, Surface, coordinates,
    pieces::{Framed, Line},
    roots::{
        Bernstein, Bounded, Range, cubic_between, hull, nearest, sign_changes, sign_changes_of_bent, slopes,
        times,
    },
    u_around_y,
};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray},
    scene::SceneError,
    spline::{Piece, Spline},
};

/// A profile turned around Y: a surface of revolution.
///
/// Parameters in object units: the profile's points [radius, y]; how the curve follows them; whether it returns to its
/// first point. Solid where it does, or where it begins and ends on the axis (radius 0): a point is inside where a way to
/// it from outside crosses the profile an odd number of times. Then normals point outwards. Any other profile makes a
/// surface, its front to the right of the profile's way, so outwards where that leads up. Where a curve swings beyond the
/// axis, that part is left out.
///
/// uv: u once around Y as on the sphere; v along the profile from its first point (0) to its last (1), every piece
/// between points taking the same part.
///
/// ```
/// use rtscript::{shape::Lathe, spline::Spline};
/// // From the bottom of a bowl to its rim.
/// let profile = vec![[0.0, 0.0], [0.8, 0.2], [1.0, 0.7]];
/// let bowl = Lathe::new(profile.clone(), Spline::CatmullRom, false)?;
/// assert_eq!((bowl.points(), bowl.is_closed()), (&profile[..], false));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Lathe {
    points: Vec<[f64; 2]>,
    spline: Spline,
    closed: bool,
    profile: Framed<Section>,
    is_solid: bool,
}

/// One piece of the profile.
#[derive(Clone, Debug, PartialEq)]
struct Section {
    piece: Piece<2>,
    /// Whether it was made as a line.
    is_straight: bool,
}

/// The points, how they are curved, and whether they close; all else follows from them.
impl std::fmt::Debug for Lathe {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lathe")
            .field("points", &self.points)
            .field("spline", &self.spline)
            .field("closed", &self.closed)
            .finish()
    }
}

impl Solidity for Lathe {
    const SOLID: bool = true;

    fn is_solid(&self) -> bool {
        self.is_solid
    }
}

impl Lathe {
    /// The profile through these points [radius, y] in object units, turned around Y.
    ///
    /// # Errors
    /// Where there are too few points, a number is not finite or beyond 1e15, a radius is negative, or all points have
    /// the radius 0.
    pub fn new(points: Vec<[f64; 2]>, spline: Spline, closed: bool) -> Result<Self, SceneError> {
        for (i, point) in points.iter().enumerate() {
            coordinates(format_args!("the lathe's points[{i}]"), point, ["radius", "y"])?;
            if point[0] < 0.0 && spline != Spline::Bezier {
                return Err(SceneError::new(format!(
                    "the lathe's points[{i}], radius, must not be negative, but it is {}",
                    point[0]
                ))
                .hint("a profile is to the right of the axis: [radius, y]"));
            }
        }
        let pieces = spline
            .pieces(&points, closed)
            .map_err(|e| SceneError::new(format!("the lathe's profile must have {e}")))?;
        let corners = || pieces.iter().flat_map(|piece| &piece.0);
        let largest = corners().fold(0.0, |a: f64, p| a.max(p[0]));
        if !(largest > 0.0) {
            return Err(SceneError::new(
                "the lathe's profile must have a radius greater than 0 somewhere",
            ));
        }
        let (low, high) = hull(&corners().map(|p| p[1]).collect::<Vec<_>>());
        let bounds = Bounds3::new(
            DVec3::new(-largest, low, -largest),
            DVec3::new(largest, high, largest),
        );
        let is_solid = closed
            || matches!((pieces.first(), pieces.last()), (Some(a), Some(b)) if a.0[0][0] == 0.0 && b.0[3][0] == 0.0);
        let profile = Framed::new(
            bounds,
            pieces.into_iter().map(|piece| Section {
                is_straight: piece == Piece::line(piece.0[0], piece.0[3]),
                piece,
            }),
            |frame, section| {
                let place = |[r, y]: [f64; 2]| {
                    let p = frame.of(DVec3::new(0.0, y, 0.0));
                    [r / frame.scale(), p.y]
                };
                Section {
                    piece: Piece(section.piece.0.map(place)),
                    ..section
                }
            },
            |section| Bounds3::around(section.piece.0.iter().map(|[r, y]| DVec3::new(*r, *y, 0.0))),
        );
        Ok(Self {
            points,
            spline,
            closed,
            profile,
            is_solid,
        })
    }

    /// The profile's points, [radius, y].
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// How the profile follows its points.
    #[must_use]
    pub const fn spline(&self) -> Spline {
        self.spline
    }

    /// Whether the profile returns to its first point.
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        self.closed
    }

    pub(super) fn pieces(&self) -> usize {
        self.profile.pieces().len()
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.profile.bounds())
    }

    /// Seen from the axis, a line is one bent curve: its distance from the axis over its height. A steep one has one
    /// distance for each height; the profile crosses the line where its radius is that. A level one is taken as two
    /// branches, coming and going, from where it is nearest to the axis; each has one height for each radius.
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = self.profile.frame().line(ray) else {
            return;
        };
        let mut met = Vec::new();
        let way = Way::new(&line);
        self.profile.each(
            |b| way.may_meet(b),
            |i, section| {
                way.cross(section, &mut |u, t| {
                    let at = line.ray.at(t);
                    let [r, y] = section.piece.tangent(u);
                    let rho = (at.x * at.x + at.z * at.z).sqrt();
                    let around = (at.x * line.ray.dir.x + at.z * line.ray.dir.z) / rho;
                    let facing = if rho > 0.0 { y * around } else { 0.0 } - r * line.ray.dir.y;
                    met.push((t, i, facing));
                });
            },
        );
        met.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (k, (way, piece, facing)) in met.into_iter().enumerate() {
            // The way out leaves along the outward normal.
            let is_right = !self.is_solid || (facing > 0.0) == (k % 2 == 1);
            out.push(line.t(way), 2 * piece + u32::from(!is_right));
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let q = self.profile.frame().of(p);
        let rho = (q.x * q.x + q.z * q.z).sqrt();
        let i = (part / 2) as usize;
        let Some(Section { piece, .. }) = self.profile.pieces().get(i) else {
            return Surface {
                normal: DVec3::Y,
                uv: DVec2::ZERO,
            };
        };
        let u = nearest(piece, [rho, q.y], [1.0, 1.0]);
        let [r, y] = piece.tangent(u);
        let radial = if rho > 0.0 {
            DVec3::new(q.x / rho, 0.0, q.z / rho)
        } else {
            DVec3::ZERO
        };
        let right = radial * y - DVec3::Y * r;
        let normal = if part.is_multiple_of(2) { right } else { -right };
        let v = (i as f64 + u) / self.pieces() as f64;
        Surface {
            // Nothing where a profile that leads along the axis is met on it.
            normal: if normal == DVec3::ZERO { DVec3::Y } else { normal },
            uv: DVec2::new(u_around_y(p.x, p.z), v.clamp(0.0, 1.0)),
        }
    }
}

/// A line by its distance from the axis.
#[derive(Clone, Copy, Debug)]
enum Way {
    Steep(Steep),
    Level(Level),
}

/// At the height y a line is at `at + lean * (y - from)` across Y.
#[derive(Clone, Copy, Debug)]
struct Steep {
    at: DVec2,
    lean: DVec2,
    from: f64,
    rise: f64,
}

/// At the distance rho from the axis a line is at the height `from + rise * w` and at the way `start + stretch * w`, where
/// w^2 = rho^2 - nearest^2, w being negative before the nearest point.
#[derive(Clone, Copy, Debug)]
struct Level {
    nearest: f64,
    from: f64,
    rise: f64,
    start: f64,
    stretch: f64,
}

impl Way {
    fn new(line: &Line) -> Self {
        let (o, d) = (line.ray.origin, line.ray.dir);
        let across = DVec2::new(d.x, d.z);
        let at = DVec2::new(o.x, o.z);
        if d.y.abs() >= 0.7 {
            return Self::Steep(Steep {
                at,
                lean: across / d.y,
                from: o.y,
                rise: d.y,
            });
        }
        let speed = across.length();
        let start = -at.dot(across) / (speed * speed);
        Self::Level(Level {
            nearest: (across.perp_dot(at) / speed).abs(),
            from: o.y + d.y * start,
            rise: d.y / speed,
            start,
            stretch: 1.0 / speed,
        })
    }

    /// Whether the line may meet the ring of a box of radii x and heights y, which is a little too wide.
    fn may_meet(&self, b: &Bounds3) -> bool {
        match self {
            Self::Steep(s) => {
                let (least, most) = s.distances(b.min.y - s.from, b.max.y - s.from);
                least <= b.max.x && most >= b.min.x
            }
            Self::Level(l) => {
                if b.max.x < l.nearest {
                    return false;
                }
                let far = (b.max.x * b.max.x - l.nearest * l.nearest).max(0.0).sqrt();
                let near = (b.min.x.max(0.0) * b.min.x.max(0.0) - l.nearest * l.nearest)
                    .max(0.0)
                    .sqrt();
                let of = |a: f64, b: f64| hull(&[l.from + l.rise * a, l.from + l.rise * b]);
                [of(near, far), of(-far, -near)]
                    .into_iter()
                    .any(|(low, high)| low <= b.max.y && high >= b.min.y)
            }
        }
    }

    /// Tells `found` where along the piece and along the line they cross.
    fn cross(&self, section: &Section, found: &mut impl FnMut(f64, f64)) {
        let (r, y) = (section.piece.coordinate(0), section.piece.coordinate(1));
        match self {
            Self::Steep(s) => {
                let gap = Gap { r, y, way: s };
                let mut met = |u: f64| found(u, (Bernstein(y).at(u).0 - s.from) / s.rise);
                if section.is_straight {
                    sign_changes_of_bent(&gap, 0.0, 1.0, s.middle(&r, &y), &mut met);
                } else {
                    sign_changes(&gap, 0.0, 1.0, &mut |u, _| met(u));
                }
            }
            Self::Level(l) => {
                // The parts of the piece that are as far from the axis as the line is at least.
                let mut from = (r[0] >= l.nearest).then_some((0.0, false));
                let mut part = |from: (f64, bool), to: (f64, bool)| {
                    for side in [-1.0, 1.0] {
                        let rise = Rise {
                            r,
                            y,
                            way: l,
                            side,
                            from,
                            to,
                        };
                        let mut met = |u: f64| found(u, l.start + side * l.stretch * rise.way_at(u));
                        if section.is_straight {
                            sign_changes_of_bent(&rise, from.0, to.0, l.middle(&r, &y), &mut met);
                        } else {
                            sign_changes(&rise, from.0, to.0, &mut |u, _| met(u));
                        }
                    }
                };
                Bernstein(r.map(|r| r - l.nearest)).sign_changes(&mut |u, falls| {
                    if falls {
                        part(from.take().unwrap_or((u, true)), (u, true));
                    } else {
                        from = Some((u, true));
                    }
                });
                if let Some(from) = from {
                    part(from, (1.0, false));
                }
            }
        }
    }
}

impl Steep {
    /// Halfway between the two places at which the line is as far from the axis as a straight piece of the profile, where
    /// there are two: the squares of both distances differ by a quadratic.
    fn middle(&self, [r, .., r_end]: &[f64; 4], [y, .., y_end]: &[f64; 4]) -> f64 {
        let (p, dp) = (self.at + self.lean * (y - self.from), self.lean * (y_end - y));
        let dr = r_end - r;
        (r * dr - p.dot(dp)) / (dp.length_squared() - dr * dr)
    }

    /// Distance from the axis `w` above the line's origin, and how fast it grows.
    fn distance(&self, w: f64) -> (f64, f64) {
        let p = self.at + self.lean * w;
        let rho = p.length();
        (rho, p.dot(self.lean) / rho)
    }

    /// The least and the greatest distance between two heights.
    fn distances(&self, a: f64, b: f64) -> Range {
        let most = self.distance(a).0.max(self.distance(b).0);
        let nearest = -self.at.dot(self.lean) / self.lean.length_squared();
        // NaN for a line along the axis: then any height will do.
        let least = if nearest.is_nan() { a } else { nearest.clamp(a, b) };
        (self.distance(least).0.min(most), most)
    }
}

impl Level {
    /// As [`Steep::middle`], for the heights on either branch.
    fn middle(&self, [r, .., r_end]: &[f64; 4], [y, .., y_end]: &[f64; 4]) -> f64 {
        let (dr, dy, square) = (r_end - r, y_end - y, self.rise * self.rise);
        (square * r * dr - (y - self.from) * dy) / (dy * dy - square * dr * dr)
    }
}

/// How much farther from the axis a steep line is than a piece of the profile at its height. Not negative on the axis, so
/// that a profile which begins and ends there is crossed an even number of times.
struct Gap<'a> {
    r: [f64; 4],
    y: [f64; 4],
    way: &'a Steep,
}

impl Bounded for Gap<'_> {
    fn at(&self, u: f64) -> (f64, f64) {
        let ((r, r_slope), (y, y_slope)) = (Bernstein(self.r).at(u), Bernstein(self.y).at(u));
        let (rho, growth) = self.way.distance(y - self.way.from);
        (rho - r, growth * y_slope - r_slope)
    }

    fn within(&self, lo: f64, hi: f64) -> (Range, Range) {
        let (r, y) = (cubic_between(&self.r, lo, hi), cubic_between(&self.y, lo, hi));
        let (low, high) = hull(&y);
        let (a, b) = (low - self.way.from, high - self.way.from);
        let (radii, distances) = (hull(&r), self.way.distances(a, b));
        // The distance is convex, so it grows ever faster.
        let growths = (self.way.distance(a).1, self.way.distance(b).1);
        let by_height = times(growths, slopes(&y, hi - lo));
        let by_radius = slopes(&r, hi - lo);
        (
            (distances.0 - radii.1, distances.1 - radii.0),
            (by_height.0 - by_radius.1, by_height.1 - by_radius.0),
        )
    }
}

/// How much higher a piece of the profile is than a branch of a level line at its distance from the axis.
struct Rise<'a> {
    r: [f64; 4],
    y: [f64; 4],
    way: &'a Level,
    /// -1 for the branch that comes, 1 for the one that goes.
    side: f64,
    /// Where the part of the piece begins and ends, and whether that is where the line is nearest to the axis. There both
    /// branches are one point, to the bit.
    from: (f64, bool),
    to: (f64, bool),
}

impl Rise<'_> {
    /// How far along the line, from the nearest point, the distance is that of the profile.
    fn way_at(&self, u: f64) -> f64 {
        if self.is_nearest(u) {
            return 0.0;
        }
        self.along(Bernstein(self.r).at(u).0)
    }

    /// Whether the part of the piece begins or ends there because the line is nearest to the axis.
    fn is_nearest(&self, u: f64) -> bool {
        u == self.from.0 && self.from.1 || u == self.to.0 && self.to.1
    }

    fn along(&self, r: f64) -> f64 {
        ((r - self.way.nearest) * (r + self.way.nearest)).max(0.0).sqrt()
    }
}

impl Bounded for Rise<'_> {
    fn at(&self, u: f64) -> (f64, f64) {
        let ((r, r_slope), (y, y_slope)) = (Bernstein(self.r).at(u), Bernstein(self.y).at(u));
        let along = if self.is_nearest(u) { 0.0 } else { self.along(r) };
        let rise = self.side * self.way.rise;
        // NaN where both are 0: the slope is unknown there.
        let growth = if rise == 0.0 { 0.0 } else { rise * (r / along) };
        (y - self.way.from - rise * along, y_slope - growth * r_slope)
    }

    fn within(&self, lo: f64, hi: f64) -> (Range, Range) {
        let (r, y) = (cubic_between(&self.r, lo, hi), cubic_between(&self.y, lo, hi));
        let (radii, heights) = (hull(&r), hull(&y));
        let (least, most) = (self.along(radii.0.max(self.way.nearest)), self.along(radii.1));
        let rise = self.side * self.way.rise;
        let climbed = times((rise, rise), (least, most));
        let height = slopes(&y, hi - lo);
        let value = (
            heights.0 - self.way.from - climbed.1,
            heights.1 - self.way.from - climbed.0,
        );
        if rise == 0.0 {
            return (value, height);
        }
        // r / sqrt(r^2 - nearest^2) shrinks as r grows.
        let ratios = (radii.1 / most, radii.0.max(self.way.nearest) / least);
        if ratios.0.is_nan() || ratios.1.is_nan() {
            return (value, (f64::NEG_INFINITY, f64::INFINITY));
        }
        let growth = times(times((rise, rise), ratios), slopes(&r, hi - lo));
        (value, (height.0 - growth.1, height.1 - growth.0))
    }
}
