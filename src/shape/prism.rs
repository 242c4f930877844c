//! The prism: an outline swept along Y.

mod wall;

use self::wall::{Course, Wall};
use super::{
    Crossing, CrossingSink, Solidity, Surface, coordinate,
    pieces::{Framed, flat_line_meets},
    positive,
    span::Span,
};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray},
    scene::SceneError,
    spline::Spline,
};

/// One or more closed outlines in x and z, swept along Y and closed by flat ends; centered in y.
///
/// Parameters in object units: the outlines, each a list of [x, z]; how the curve follows the points; the whole height.
/// A point is inside where a line from it crosses the outlines an odd number of times, so an outline within another is a
/// hole, and one within the hole is solid again, whichever way they run. Solid. Normals outwards.
///
/// uv: on the walls u along each outline, every piece between points taking the same part, and v from the bottom to the
/// top; on the ends the rectangle around all outlines, upright as on a cylinder's.
///
/// ```
/// use rtscript::{shape::Prism, spline::Spline};
/// let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let hole = vec![[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]];
/// assert_eq!(Prism::new(vec![square, hole], Spline::Linear, 2.0)?.outlines().len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Prism {
    outlines: Vec<Vec<[f64; 2]>>,
    spline: Spline,
    height: f64,
    /// Half of the height in the walls' frame.
    half: f64,
    /// Outline after outline.
    walls: Framed<Wall>,
}

/// The outlines, how they are curved, and the height; all else follows from them.
impl std::fmt::Debug for Prism {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prism")
            .field("outlines", &self.outlines)
            .field("spline", &self.spline)
            .field("height", &self.height)
            .finish()
    }
}

impl Solidity for Prism {
    const SOLID: bool = true;
}

const BOTTOM: u32 = 0;
const TOP: u32 = 1;
/// Wall i has the parts 2 + 2 i, its outside to the right of the outline, and 3 + 2 i, to the left of it.
const WALLS: u32 = 2;

/// More outline points than this are refused: their parts could not be numbered.
const MOST: usize = 10_000_000;

impl Prism {
    /// The prism over these outlines of [x, z], of this whole height in object units.
    ///
    /// # Errors
    /// Where there is no outline, one has too few points, a coordinate is not finite or beyond 1e15, all points are in
    /// one line, or the height is not greater than 0.
    pub fn new(outlines: Vec<Vec<[f64; 2]>>, spline: Spline, height: f64) -> Result<Self, SceneError> {
        positive("the prism's height", height)?;
        if outlines.is_empty() || outlines.iter().map(Vec::len).sum::<usize>() > MOST {
            return Err(SceneError::new(format!(
                "the prism must have at least one outline, and at most {MOST} points"
            )));
        }
        let mut loops = Vec::with_capacity(outlines.len());
        for (i, outline) in outlines.iter().enumerate() {
            for (j, point) in outline.iter().enumerate() {
                for (x, axis) in point.iter().zip(["x", "z"]) {
                    coordinate(format_args!("the prism's outline {i}, points[{j}], {axis}"), *x)?;
                }
            }
            let pieces = spline.pieces(outline, true).map_err(|e| {
                SceneError::new(format!("the prism's outline {i} must have {e}"))
                    .hint("an outline closes by itself: its first point need not be repeated")
            })?;
            loops.push(pieces);
        }
        let corner = |p: &[f64; 2], y: f64| DVec3::new(p[0], y, p[1]);
        let all = loops.iter().flatten().flat_map(|piece| &piece.0);
        let flat = Bounds3::around(all.map(|p| corner(p, 0.0)));
        let size = flat.size();
        if !(size.x > 0.0 && size.z > 0.0) {
            return Err(SceneError::new("the prism's points must not be in one line"));
        }
        let bounds = Bounds3::new(
            flat.min - DVec3::Y * (0.5 * height),
            flat.max + DVec3::Y * (0.5 * height),
        );
        let walls = loops.iter().flat_map(|pieces| {
            let n = pieces.len() as f64;
            pieces.iter().enumerate().map(move |(i, piece)| Wall {
                course: Course::new(piece),
                u: [i as f64 / n, (i + 1) as f64 / n],
            })
        });
        let walls = Framed::new(
            bounds,
            walls,
            |frame, wall| {
                let place = |p: DVec2| {
                    let p = frame.of(DVec3::new(p.x, 0.0, p.y));
                    DVec2::new(p.x, p.z)
                };
                Wall {
                    course: wall.course.map(place),
                    ..wall
                }
            },
            |wall| wall.course.bounds(),
        );
        Ok(Self {
            half: 0.5 * height / walls.frame().scale(),
            outlines,
            spline,
            height,
            walls,
        })
    }

    /// The outlines, each of points [x, z].
    #[must_use]
    pub fn outlines(&self) -> &[Vec<[f64; 2]>] {
        &self.outlines
    }

    /// How the outlines follow their points.
    #[must_use]
    pub const fn spline(&self) -> Spline {
        self.spline
    }

    /// The whole height.
    #[must_use]
    pub const fn height(&self) -> f64 {
        self.height
    }

    pub(super) fn pieces(&self) -> usize {
        self.walls.pieces().len()
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.walls.bounds())
    }

    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = self.walls.frame().line(ray) else {
            return;
        };
        let (o, d) = (line.ray.origin, line.ray.dir);
        let Some(slab) = Span::slab(o.y, d.y, self.half, BOTTOM, TOP) else {
            return;
        };
        let level = (d.x * d.x + d.z * d.z).sqrt();
        // So nearly upright that it does not leave the place within the height: the squares would vanish.
        if level * self.half <= 1e-30 * d.y.abs() {
            let beyond = self.walls_met(DVec2::new(o.x, o.z), DVec2::X);
            if beyond.iter().filter(|c| c.along > 0.0).count() % 2 == 1 {
                let [enter, exit] = slab.ends();
                out.push(line.t(enter.t), enter.part);
                out.push(line.t(exit.t), exit.part);
            }
            return;
        }
        let mut met = self.walls_met(DVec2::new(o.x, o.z), DVec2::new(d.x, d.z) / level);
        met.sort_by(|a, b| a.along.total_cmp(&b.along).then(a.wall.cmp(&b.wall)));
        let (pairs, _) = met.as_chunks::<2>();
        for [enter, exit] in pairs {
            let span = Span::between(enter.crossing(level, true), exit.crossing(level, false));
            if let Some(span) = span.and_then(|span| slab.clip(span)) {
                let [enter, exit] = span.ends();
                out.push(line.t(enter.t), enter.part);
                out.push(line.t(exit.t), exit.part);
            }
        }
    }

    /// Where a line in the plane of the outlines crosses them. A point that two pieces share is on one side of the
    /// line for both, so the number is even.
    fn walls_met(&self, o: DVec2, d: DVec2) -> Vec<Met> {
        let mut met = Vec::new();
        self.walls.each(
            |b| flat_line_meets(o, d, b),
            |i, wall| {
                wall.course.cross(o, d, &mut |along, falls| {
                    met.push(Met {
                        along,
                        wall: i,
                        falls,
                    });
                });
            },
        );
        met
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let q = self.walls.frame().of(p);
        if part < WALLS {
            let bounds = self.walls.bounds();
            let (min, size) = (bounds.min, bounds.size());
            let u = (p.x - min.x) / size.x;
            let v = (p.z - min.z) / size.z;
            let (normal, v) = if part == BOTTOM {
                (DVec3::NEG_Y, v)
            } else {
                (DVec3::Y, 1.0 - v)
            };
            return Surface {
                normal,
                uv: DVec2::new(u, v).clamp(DVec2::ZERO, DVec2::ONE),
            };
        }
        let number = (part - WALLS) / 2;
        let Some(wall) = self.walls.pieces().get(number as usize) else {
            return Surface {
                normal: DVec3::Y,
                uv: DVec2::ZERO,
            };
        };
        let (at, way) = wall.course.nearest(DVec2::new(q.x, q.z));
        let right = DVec3::new(way.y, 0.0, -way.x);
        let u = wall.u[0] + (wall.u[1] - wall.u[0]) * at;
        let normal = if part.is_multiple_of(2) { right } else { -right };
        Surface {
            normal: if normal == DVec3::ZERO { DVec3::X } else { normal },
            uv: DVec2::new(u, 0.5 * (q.y / self.half) + 0.5).clamp(DVec2::ZERO, DVec2::ONE),
        }
    }
}

/// A line in the plane of the outlines crosses a wall.
struct Met {
    /// How far along the line.
    along: f64,
    wall: u32,
    /// The outline goes from the line's left to its right.
    falls: bool,
}

impl Met {
    /// The crossing of a line that goes `level` in the plane for each of its ways. Where the outline goes to the
    /// line's right, what is to the outline's right looks towards the line's beginning.
    fn crossing(&self, level: f64, enters: bool) -> Crossing {
        Crossing {
            t: self.along / level,
            part: WALLS + 2 * self.wall + u32::from(self.falls != enters),
        }
    }
}
