//! The blob: balls and rods that flow into each other.

use super::{
    CrossingSink, Solidity, Surface, coordinate,
    pieces::{Framed, Line, LineOfBoxes, holds},
    positive,
    roots::{Bernstein, product},
    u_around_y,
};
use crate::{
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// Metaballs: the surface where the density of all parts together is the threshold.
///
/// Parameters: the threshold, greater than 0, and the parts, see [`BlobPart`]. At the distance d from its middle a part of
/// radius R and strength s adds s (1 - (d/R)^2)^2 to the density, and nothing beyond R, as in POV-Ray (Wyvill, McPheeters
/// and Wyvill, "Data structure for soft objects", 1986, in a lower degree). Solid where the density is above the
/// threshold. Normals outwards.
///
/// uv: as on a sphere around the middle of the bounds.
///
/// ```
/// use rtscript::{DVec3, shape::{Blob, BlobPart}};
/// let parts = vec![
///     BlobPart::ball(DVec3::NEG_X * 0.5, 1.0, 1.0),
///     BlobPart::rod(DVec3::ZERO, DVec3::X, 0.8, 1.0),
/// ];
/// let blob = Blob::new(0.3, parts)?;
/// assert_eq!(blob.threshold(), 0.3);
/// assert!(blob.parts()[0].is_ball() && !blob.parts()[1].is_ball());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Blob {
    threshold: f64,
    parts: Vec<BlobPart>,
    framed: Framed<BlobPart>,
}

/// A ball or a rod of a [`Blob`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlobPart {
    /// One end of the middle line, in object units; the center of a ball.
    pub from: DVec3,
    /// The other end of the middle line; for a ball the same point.
    pub to: DVec3,
    /// How far from the middle line the density ends, in object units, greater than 0.
    pub radius: f64,
    /// The density on the middle line; negative takes away.
    pub strength: f64,
}

impl BlobPart {
    /// A ball.
    #[must_use]
    pub const fn ball(center: DVec3, radius: f64, strength: f64) -> Self {
        Self::rod(center, center, radius, strength)
    }

    /// A rod between two points with a half ball at either end.
    #[must_use]
    pub const fn rod(from: DVec3, to: DVec3, radius: f64, strength: f64) -> Self {
        Self {
            from,
            to,
            radius,
            strength,
        }
    }

    /// Whether its middle line is a point.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        self.from == self.to
    }

    fn bounds(&self) -> Bounds3 {
        let middle = Bounds3::around([self.from, self.to]);
        Bounds3::new(middle.min - self.radius, middle.max + self.radius)
    }

    /// The vector from the nearest point of the middle line.
    fn off(&self, p: DVec3) -> DVec3 {
        let axis = self.to - self.from;
        let along = (p - self.from).dot(axis) / axis.length_squared();
        // NaN for a ball.
        let along = if along.is_nan() {
            0.0
        } else {
            along.clamp(0.0, 1.0)
        };
        p - (self.from + axis * along)
    }
}

/// The threshold and the parts; all else follows from them.
impl std::fmt::Debug for Blob {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Blob")
            .field("threshold", &self.threshold)
            .field("parts", &self.parts)
            .finish()
    }
}

impl Solidity for Blob {
    const SOLID: bool = true;
}

impl Blob {
    /// As many parts as one blob may have: along a line each may reach into each other.
    pub const MOST: usize = 10_000;

    /// The blob of these parts.
    ///
    /// # Errors
    /// Where the threshold or a radius is not greater than 0, a number is not finite or beyond 1e15, there are no parts
    /// or more than [`Blob::MOST`], or none has a positive strength.
    pub fn new(threshold: f64, mut parts: Vec<BlobPart>) -> Result<Self, SceneError> {
        positive("the blob's threshold", threshold)?;
        if parts.len() > Self::MOST {
            return Err(SceneError::new(format!(
                "the blob must have at most {} parts, not {}",
                Self::MOST,
                parts.len()
            ))
            .hint("several blobs may stand side by side"));
        }
        for (i, part) in parts.iter().enumerate() {
            positive(format_args!("the blob's part {i}: radius"), part.radius)?;
            coordinate(format_args!("the blob's part {i}: strength"), part.strength)?;
            for x in part.from.to_array().into_iter().chain(part.to.to_array()) {
                coordinate(format_args!("the blob's part {i}: center"), x)?;
            }
        }
        let bounds = parts
            .iter()
            .filter(|part| part.strength > 0.0)
            .fold(Bounds3::EMPTY, |all, part| all.union(&part.bounds()));
        if bounds.is_empty() {
            return Err(SceneError::new(
                "the blob must have a part of a strength greater than 0",
            ));
        }
        parts.sort_by_key(|part| !part.is_ball());
        let framed = Framed::new(
            bounds,
            parts.iter().copied(),
            |frame, part| BlobPart {
                from: frame.of(part.from),
                to: frame.of(part.to),
                radius: part.radius / frame.scale(),
                ..part
            },
            BlobPart::bounds,
        );
        Ok(Self {
            threshold,
            parts,
            framed,
        })
    }

    /// The density on the surface.
    #[must_use]
    pub const fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The parts, balls first.
    #[must_use]
    pub fn parts(&self) -> &[BlobPart] {
        &self.parts
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.framed.bounds())
    }

    /// Along the line, a part's density is made of fourth powers, each from one way to another. Between neighbouring
    /// ends of those ways the sum is one polynomial, whose signs tell where it passes the threshold. What they say at the
    /// beginning of a stretch is held against the end of the one before, so that the number is even.
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let Some(line) = self.framed.frame().line(ray) else {
            return;
        };
        let mut stretches = Vec::new();
        let boxes = LineOfBoxes::new(&line.ray);
        self.framed.each(
            |b| boxes.meets(b),
            |_, part| add_stretches(part, &line, &mut stretches),
        );
        stretches.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.to.total_cmp(&b.to)));
        let mut ends: Vec<f64> = stretches.iter().flat_map(|s| [s.from, s.to]).collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let mut coming = stretches.iter().peekable();
        let mut active: Vec<&Stretch> = Vec::new();
        let (mut inside, mut last) = (false, 0.0);
        for (from, to) in ends.iter().copied().zip(ends.iter().copied().skip(1)) {
            active.retain(|s| s.to > from);
            while let Some(next) = coming.next_if(|s| s.from <= from) {
                active.push(next);
            }
            let mut lack = Bernstein([self.threshold; 5]);
            for stretch in &active {
                let density = stretch.density(from, to);
                lack.0.iter_mut().zip(density.0).for_each(|(l, d)| *l -= d);
            }
            if (lack.0[0] < 0.0) != inside {
                out.push(line.t(from), 0);
                inside = !inside;
            }
            lack.sign_changes(&mut |u, _| {
                out.push(line.t(from + (to - from) * u), 0);
                inside = !inside;
            });
            if out.is_served() {
                return;
            }
            last = to;
        }
        if inside {
            out.push(line.t(last), 0);
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let q = self.framed.frame().of(p);
        let mut normal = DVec3::ZERO;
        self.framed.each(
            |b| holds(b, q),
            |_, part| {
                let off = part.off(q);
                let square = 1.0 / (part.radius * part.radius);
                let depth = (1.0 - off.dot(off) * square).max(0.0);
                normal += off * (part.strength * depth * square);
            },
        );
        if normal == DVec3::ZERO { DVec3::Y } else { normal }
    }

    pub(super) fn surface(&self, p: DVec3, _part: u32) -> Surface {
        let q = p - self.framed.frame().center();
        let rho = (q.x * q.x + q.z * q.z).sqrt();
        Surface {
            normal: self.normal(p),
            uv: DVec2::new(u_around_y(q.x, q.z), math::atan2(q.y, rho) / PI + 0.5),
        }
    }
}

/// A part of a line along which one part of the blob has the density s (1 - (k (x - middle)^2 + aside) / R^2)^2.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: f64,
    to: f64,
    /// k / R^2.
    curve: f64,
    middle: f64,
    /// 1 - aside / R^2.
    top: f64,
    strength: f64,
}

impl Stretch {
    /// The density from one way to another, as a polynomial on [0, 1].
    fn density(&self, from: f64, to: f64) -> Bernstein<5> {
        let (a, b) = (from - self.middle, to - self.middle);
        let root = Bernstein([a * a, a * b, b * b].map(|square| self.top - self.curve * square));
        let mut square: Bernstein<5> = product(&root, &root);
        square.0.iter_mut().for_each(|c| *c *= self.strength);
        square
    }
}

/// The stretches of a part: that along a ball's, or along those of a rod's two half balls and what is between.
fn add_stretches(part: &BlobPart, line: &Line, stretches: &mut Vec<Stretch>) {
    let (o, d) = (line.ray.origin, line.ray.dir);
    let axis = part.to - part.from;
    let length = axis.length();
    let mut add = |curve: f64, middle: f64, aside: f64, (lo, hi): (f64, f64)| {
        let square = 1.0 / (part.radius * part.radius);
        let top = 1.0 - aside * square;
        if !(top > 0.0) {
            return;
        }
        let reach = (top / (curve * square)).sqrt();
        let (from, to) = ((middle - reach).max(lo), (middle + reach).min(hi));
        if from < to && from.is_finite() && to.is_finite() {
            stretches.push(Stretch {
                from,
                to,
                curve: curve * square,
                middle,
                top,
                strength: part.strength,
            });
        }
    };
    let mut ball = |center: DVec3, within: (f64, f64)| {
        let middle = (center - o).dot(d);
        let aside = (o + d * middle - center).length_squared();
        add(1.0, middle, aside, within);
    };
    let all = (f64::NEG_INFINITY, f64::INFINITY);
    if !(length > 0.0) {
        ball(part.from, all);
        return;
    }
    let axis = axis / length;
    // How far along the rod the line is: start + speed * way.
    let (start, speed) = ((o - part.from).dot(axis), d.dot(axis));
    let (enter, exit) = (-start / speed, (length - start) / speed);
    if speed == 0.0 {
        // Across the rod, beside one of the three throughout.
        if start < 0.0 {
            ball(part.from, all);
        } else if start > length {
            ball(part.to, all);
        }
    } else if speed > 0.0 {
        ball(part.from, (all.0, enter));
        ball(part.to, (exit, all.1));
    } else {
        ball(part.from, (enter, all.1));
        ball(part.to, (all.0, exit));
    }
    let between = if speed == 0.0 {
        if !(0.0..=length).contains(&start) {
            return;
        }
        all
    } else {
        (enter.min(exit), enter.max(exit))
    };
    let (across, leaves) = ((o - part.from) - axis * start, d - axis * speed);
    let curve = leaves.length_squared();
    if curve > 1e-24 {
        let middle = -across.dot(leaves) / curve;
        add(
            curve,
            middle,
            (across + leaves * middle).length_squared(),
            between,
        );
    } else {
        // Along the rod the distance stays; no way is longer than the rod.
        add(f64::MIN_POSITIVE, 0.0, across.length_squared(), between);
    }
}
