//! Surfaces where a field is 0: signed distance fields and isosurfaces of any expression.

mod cells;
mod field;
mod interval;
mod line;
mod noise;
mod scalar;
mod solid;
mod step;
mod tape;
#[cfg(test)]
mod tests;

pub use field::Field;
pub use solid::Sdf;

use std::{cell::RefCell, fmt, sync::OnceLock};

use self::{
    cells::Cells,
    interval::Interval,
    line::{Line, Memory},
    scalar::Gradient,
    tape::Tape,
};
use super::{CrossingSink, Solidity, Surface};
use crate::{
    math::{Bounds3, DVec2, DVec3, Ray, max_abs},
    scene::SceneError,
};

/// All points of a box in which a field is negative.
///
/// Where the field is negative on a face of the box, that face closes the solid. Normals are the field's gradients, so
/// they point to where it grows; uv are the coordinates x and y, or those of a face, from 0 to 1 across the box.
///
/// Crossings are found by interval arithmetic: none is missed, however thin the wall. Of each the place is that of the
/// change of sign of the field as f64 has it, to the last digits.
///
/// ```
/// use rtscript::{DVec3, math::Bounds3, shape::{Field, Isosurface}};
/// let [x, y, z] = Field::point();
/// let within = Bounds3::new(DVec3::NEG_ONE, DVec3::ONE);
/// let saddle = Isosurface::new(y - x.square() + z.square(), within)?;
/// assert!(saddle.field().at(DVec3::NEG_Y) < 0.0);
/// assert_eq!(saddle.within(), within);
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Clone)]
pub struct Isosurface {
    field: Field,
    bounds: Bounds3,
    /// The field for rays, made for the first of them where nothing is prepared.
    tape: OnceLock<Tape>,
    /// What is known beforehand; it makes rays faster and changes nothing.
    cells: Option<Box<Cells>>,
}

impl fmt::Debug for Isosurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Isosurface")
            .field("field", &self.field)
            .field("bounds", &self.bounds)
            .finish()
    }
}

impl PartialEq for Isosurface {
    fn eq(&self, other: &Self) -> bool {
        self.field == other.field && self.bounds == other.bounds
    }
}

impl Solidity for Isosurface {
    const SOLID: bool = true;
}

thread_local! {
    /// Memory of rays, used again.
    static MEMORY: RefCell<Memory> = RefCell::default();
    static GRADIENTS: RefCell<Vec<Gradient>> = const { RefCell::new(Vec::new()) };
}

/// Part of the surface where the field is 0; the faces of the box follow, low and high by axis.
const SURFACE: u32 = 0;

impl Isosurface {
    /// The inside of a field in a box.
    ///
    /// ```
    /// use rtscript::{DVec3, math::Bounds3, shape::{Field, Isosurface, Shape}};
    /// let [x, y, z] = Field::point();
    /// let field = x.square() + y.square() * z.square() - 0.5;
    /// let bounds = Bounds3::new(DVec3::splat(-1.0), DVec3::splat(1.0));
    /// let shape = Shape::Isosurface(Isosurface::new(field, bounds)?.into());
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where the box has no volume or is not finite, or the field is too long an expression.
    pub fn new(field: Field, bounds: Bounds3) -> Result<Self, SceneError> {
        field.check()?;
        let (min, max) = (bounds.min, bounds.max);
        let is_finite = min.is_finite() && max.is_finite() && max_abs(min).max(max_abs(max)) <= 1e15;
        if !is_finite || min.cmpge(max).any() {
            let said = [min, max].map(crate::math::brief);
            return Err(SceneError::new(format!(
                "the bounds must be a box from its least to its greatest corner within 1e15, not from {} to {}",
                said[0], said[1]
            )));
        }
        Ok(Self {
            field,
            bounds,
            tape: OnceLock::new(),
            cells: None,
        })
    }

    /// The same with what rays need to find it faster, made by about so many `operations`; as it is where `is_stopped`
    /// says so.
    pub(crate) fn prepared(&self, operations: usize, is_stopped: &dyn Fn() -> bool) -> Self {
        let cells = Cells::new(Tape::new(&self.field), &self.bounds, operations, is_stopped);
        Self {
            field: self.field.clone(),
            bounds: self.bounds,
            tape: OnceLock::new(),
            cells: cells.map(Box::new),
        }
    }

    /// What it has in common with others that need to be prepared but once: the very same field in the same box.
    pub(crate) fn identity(&self) -> (usize, [u64; 6]) {
        let [a, b, c] = self.bounds.min.to_array().map(f64::to_bits);
        let [d, e, f] = self.bounds.max.to_array().map(f64::to_bits);
        (self.field.steps().as_ptr().addr(), [a, b, c, d, e, f])
    }

    fn tape(&self) -> &Tape {
        match &self.cells {
            Some(cells) => cells.whole(),
            None => self.tape.get_or_init(|| Tape::new(&self.field)),
        }
    }

    /// Bytes of what was prepared.
    pub(crate) fn prepared_bytes(&self) -> usize {
        self.cells.as_ref().map_or(0, |cells| cells.bytes())
    }

    /// The field.
    #[must_use]
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The box.
    #[must_use]
    pub fn within(&self) -> Bounds3 {
        self.bounds
    }

    pub(super) fn bounds(&self) -> Option<Bounds3> {
        Some(self.bounds)
    }

    /// The part of a line in the box: t and face of both ends.
    fn clip(&self, ray: &Ray) -> Option<[(f64, u32); 2]> {
        let mut from = (f64::NEG_INFINITY, SURFACE);
        let mut to = (f64::INFINITY, SURFACE);
        let (min, max) = (self.bounds.min.to_array(), self.bounds.max.to_array());
        let line = ray.origin.to_array().into_iter().zip(ray.dir.to_array());
        for (axis, ((o, d), (min, max))) in (0u32..).zip(line.zip(min.into_iter().zip(max))) {
            if d == 0.0 {
                if !(min <= o && o <= max) {
                    return None;
                }
                continue;
            }
            let (low, high) = (((min - o) / d, 1 + 2 * axis), ((max - o) / d, 2 + 2 * axis));
            let (near, far) = if d > 0.0 { (low, high) } else { (high, low) };
            if near.0 > from.0 {
                from = near;
            }
            if far.0 < to.0 {
                to = far;
            }
        }
        let is_piece = from.0 < to.0 && from.0.is_finite() && to.0.is_finite();
        is_piece.then_some([from, to])
    }

    /// Apart from the crossings of shapes that take no time.
    #[cold]
    #[inline(never)]
    pub(super) fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
        let is_ray = ray.origin.is_finite() && ray.dir.is_finite() && ray.dir != DVec3::ZERO;
        let Some([from, to]) = self.clip(ray).filter(|_| is_ray) else {
            return;
        };
        let (least, most) = out.span();
        if !(least <= to.0 && from.0 <= most) {
            return;
        }
        let mut memory = MEMORY.take();
        let mut line = Line::new(ray, from.0, to.0, self.tape().len(), &mut memory);
        let places = [line.before(least), (line.before(most) + 1).min(line.last())];
        let faces = [from.1, to.1];
        match &self.cells {
            Some(cells) if cells.suits(ray, &self.bounds) => {
                cells.changes(&mut line, places, faces, out);
            }
            _ => self.changes(&mut line, places, faces, out),
        }
        MEMORY.set(memory);
    }

    /// As [`Cells::changes`].
    fn changes(
        &self,
        line: &mut Line<'_>,
        [from, to]: [i64; 2],
        faces: [u32; 2],
        out: &mut impl CrossingSink,
    ) {
        let (begin, end) = (line.look(self.tape(), from), line.look(self.tape(), to));
        if from == 0 && begin.is_inside() {
            out.push(line.t(from), faces[0]);
        }
        if !out.is_served() {
            line.changes(self.tape(), [begin, end], Interval::ALL, out, SURFACE);
        }
        if to == line.last() && end.is_inside() && !out.is_served() {
            out.push(line.t(to), faces[1]);
        }
    }

    pub(super) fn surface(&self, p: DVec3, part: u32) -> Surface {
        let across = ((p - self.bounds.min) / self.bounds.size()).clamp(DVec3::ZERO, DVec3::ONE);
        let axis = |n: u32| {
            [DVec3::X, DVec3::Y, DVec3::Z]
                .get(n as usize)
                .copied()
                .unwrap_or(DVec3::Z)
        };
        let (normal, uv) = match part {
            SURFACE => (self.gradient(p), DVec2::new(across.x, across.y)),
            face => {
                let side = if face % 2 == 1 { -1.0 } else { 1.0 };
                let uv = match (face - 1) / 2 {
                    0 => DVec2::new(across.z, across.y),
                    1 => DVec2::new(across.x, across.z),
                    _ => DVec2::new(across.x, across.y),
                };
                (axis((face - 1) / 2) * side, uv)
            }
        };
        Surface { normal, uv }
    }

    /// The gradient; up where there is none, as in the tip of a cone.
    fn gradient(&self, p: DVec3) -> DVec3 {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
        let mut point = p.to_array().into_iter().zip(axes).map(|(v, d)| Gradient { v, d });
        let mut next = || {
            point.next().unwrap_or(Gradient {
                v: 0.0,
                d: DVec3::ZERO,
            })
        };
        let at = [next(), next(), next()];
        let mut memory = GRADIENTS.take();
        let known = self
            .cells
            .as_ref()
            .and_then(|cells| cells.gradient(p, at, &mut memory));
        let found = known.unwrap_or_else(|| self.tape().run(at, &mut memory)).d;
        GRADIENTS.set(memory);
        let size = max_abs(found);
        if size > 0.0 && size.is_finite() {
            found / size
        } else {
            DVec3::Y
        }
    }
}

impl Field {
    /// Bounds of its values in a box: at least as wide as they are.
    ///
    /// ```
    /// use rtscript::{DVec3, math::Bounds3, shape::Field};
    /// let [x, y, _] = Field::point();
    /// let within = Bounds3::new(DVec3::new(1.0, -2.0, 0.0), DVec3::new(3.0, 2.0, 0.0));
    /// let (least, greatest) = (x + y.square()).range(&within);
    /// // From x = 1 and y = 0 to x = 3 and y = 2.
    /// assert!(least <= 1.0 && greatest >= 7.0 && greatest < 7.1);
    /// ```
    #[must_use]
    pub fn range(&self, within: &Bounds3) -> (f64, f64) {
        let (min, max) = (within.min, within.max);
        let at = [
            Interval::new(min.x, max.x),
            Interval::new(min.y, max.y),
            Interval::new(min.z, max.z),
        ];
        let Interval { lo, hi } = self.run(at, &mut Vec::new());
        (lo, hi)
    }
}
