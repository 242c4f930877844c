//! Shapes: what a ray meets in object space.
//!
//! A shape knows its own space only. Placing, materials and acceleration are the scene's and the renderer's.
//! Each file holds one shape: its contract, its checks, its bounds, its crossings with a ray, its surface.
//!
//! A shape answers with *all* points where the ray's whole line crosses its surface, in order. From them the
//! nearest hit follows, the parts of the line inside a solid, and an exact answer to the question that haunts
//! ray tracers: a ray that starts on the surface knows which crossing is its own start.

mod cone;
mod cuboid;
mod custom;
mod cylinder;
mod disk;
mod planar;
mod plane;
mod polygon;
mod span;
mod sphere;
#[cfg(test)]
mod suite;
mod torus;
pub mod triangle;
pub(crate) mod triangles;
mod triangulate;

pub use cone::Cone;
pub use cuboid::Cuboid;
pub use custom::CustomShape;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use plane::Plane;
pub use polygon::Polygon;
pub use sphere::Sphere;
pub use torus::Torus;
pub use triangulate::triangulate;

use std::sync::Arc;

use crate::{
    custom::Custom,
    math::{self, Bounds3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

/// A point where a line crosses a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter.
    pub t: f64,
    /// Which part of the surface: a face of a box, the side or a cap of a cylinder; 0 where there is one
    /// part.
    pub part: u8,
}

/// Crossings of one line with one shape, in ascending order of `t`.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    items: [Crossing; Self::CAPACITY],
    len: usize,
    is_cut: bool,
}

impl Default for Crossings {
    fn default() -> Self {
        Self {
            items: [Crossing { t: 0.0, part: 0 }; Self::CAPACITY],
            len: 0,
            is_cut: false,
        }
    }
}

impl Crossings {
    /// As many as a line can have with one shape of ours (a torus has up to 4).
    pub const CAPACITY: usize = 4;

    /// Adds a crossing in its place; NaN is dropped. Of more than [`Self::CAPACITY`] those stay that matter to a ray from
    /// t = 0 on: the nearest to its origin, which may be its own start, and the first after it.
    #[inline]
    #[allow(
        clippy::indexing_slicing,
        reason = "there is room for one more than `len`, as was just asked"
    )]
    pub fn push(&mut self, t: f64, part: u8) {
        if t.is_nan() || self.len == Self::CAPACITY && !self.make_room(t) {
            return;
        }
        let mut i = self.len;
        while i > 0 && self.items[i - 1].t > t {
            self.items[i] = self.items[i - 1];
            i -= 1;
        }
        self.items[i] = Crossing { t, part };
        self.len += 1;
    }

    /// Where there is no room for a crossing at `t`, drops the one that matters least; false where that is the new one.
    #[cold]
    #[inline(never)]
    #[allow(clippy::indexing_slicing, reason = "all places are taken")]
    fn make_room(&mut self, t: f64) -> bool {
        self.is_cut = true;
        let behind = self.items.iter().filter(|c| c.t <= 0.0).count() + usize::from(t <= 0.0);
        let another = if behind > 1 {
            // The farthest behind the origin.
            self.items[0].t < t
        } else {
            t < self.items[Self::CAPACITY - 1].t
        };
        if another {
            if behind > 1 {
                self.items.copy_within(1.., 0);
            }
            self.len -= 1;
        }
        another
    }

    /// Whether crossings were dropped because there were more than [`Self::CAPACITY`].
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The crossings in order.
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "`len` is at most the capacity, which `push` sees to"
    )]
    pub fn as_slice(&self) -> &[Crossing] {
        &self.items[..self.len]
    }

    /// Drops the crossing that is the ray's own start on this surface: the one nearest to t = 0, if it is
    /// within `t_self`.
    pub fn drop_start(&mut self, t_self: f64) {
        let distances = self.as_slice().iter().map(|crossing| crossing.t.abs());
        let nearest = distances.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((i, _)) = nearest.filter(|(_, distance)| *distance <= t_self) {
            self.items.copy_within(i + 1..self.len, i);
            self.len -= 1;
        }
    }

    /// The first crossing with `t_min < t < t_max`.
    #[must_use]
    pub fn first_within(&self, t_min: f64, t_max: f64) -> Option<Crossing> {
        self.as_slice()
            .iter()
            .copied()
            .find(|c| c.t > t_min && c.t < t_max)
    }
}

/// The surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Outward (front) normal in object space, not necessarily a unit vector.
    pub normal: DVec3,
    /// Texture coordinates in [0, 1]^2 (a plane repeats them without end).
    pub uv: DVec2,
}

macro_rules! shapes {
    ($($(#[$doc:meta])* $name:ident($inner:ty) = $text:literal;)*) => {
        /// Any shape, in its own object space.
        ///
        /// A program's own need none of what follows; see [`CustomShape`].
        ///
        /// # Adding a shape
        /// 1. A file of its own, beginning with its contract: pose, parameters, units, normals, uv. In it
        ///    the type; `new`, which refuses what is no shape and names the parameter; `Solidity`; `bounds`,
        ///    `crossings` and `surface` as the others have them. The usual pose is centered at the origin,
        ///    axis Y, within the unit cube by default.
        /// 2. A line in `shapes!` of `shape/mod.rs`. Large ones go there in an [`Arc`], so that an object
        ///    stays small.
        /// 3. Its lines in `shape/suite`, which tests what all shapes promise.
        /// 4. Its entry in `script/api/shapes.rs`, and a scene in `tests/scenes/shapes`.
        ///
        /// What `crossings` promises: *all* crossings of the whole line, an even number where the shape is
        /// solid. Directions are of any length and `t` counts multiples of them, so nothing may be compared
        /// with an absolute epsilon. A ray with a number that is not finite, or without direction, crosses
        /// nothing.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $name($inner),)*
            /// See [`CustomShape`].
            Custom(Custom<dyn CustomShape>),
        }

        impl Shape {
            /// What scripts call the shapes of the list.
            #[cfg(test)]
            const NAMES: &[&str] = &[$($text,)*];

            /// What the script calls it.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    Self::Custom(shape) => CustomShape::name(&**shape),
                    $(Self::$name(_) => $text,)*
                }
            }

            /// A box around it; `None` where it has no end.
            #[must_use]
            pub fn bounds(&self) -> Option<Bounds3> {
                match self {
                    $(Self::$name(s) => s.bounds(),)*
                    Self::Custom(s) => s.bounds(),
                }
            }

            /// True where it encloses a volume, so that a line crosses it an even number of times.
            #[must_use]
            pub fn is_solid(&self) -> bool {
                match self {
                    $(Self::$name(_) => <$inner as Solidity>::SOLID,)*
                    Self::Custom(s) => s.is_solid(),
                }
            }

            /// Adds all crossings of the ray's whole line (behind its origin too) to `out`.
            #[inline]
            pub fn crossings(&self, ray: &Ray, out: &mut Crossings) {
                match self {
                    $(Self::$name(s) => s.crossings(ray, out),)*
                    Self::Custom(s) => custom::crossings(&**s, ray, out),
                }
            }

            /// Normal and texture coordinates at a point `p` on part `part` of the surface.
            #[must_use]
            pub fn surface(&self, p: DVec3, part: u8) -> Surface {
                match self {
                    $(Self::$name(s) => s.surface(p, part),)*
                    Self::Custom(s) => s.surface(p, part),
                }
            }
        }
    };
}

shapes! {
    /// See [`Sphere`].
    Sphere(Sphere) = "sphere";
    /// See [`Cuboid`].
    Cuboid(Cuboid) = "box";
    /// See [`Cylinder`].
    Cylinder(Cylinder) = "cylinder";
    /// See [`Cone`].
    Cone(Cone) = "cone";
    /// See [`Disk`].
    Disk(Disk) = "disk";
    /// See [`Torus`].
    Torus(Torus) = "torus";
    /// See [`Plane`].
    Plane(Plane) = "plane";
    /// See [`Polygon`].
    Polygon(Arc<Polygon>) = "polygon";
}

impl Shape {
    /// The normal of [`Shape::surface`] alone: the texture coordinates of round shapes are angles, which cost
    /// more than the rest.
    #[inline]
    pub(crate) fn normal(&self, p: DVec3, part: u8) -> DVec3 {
        match self {
            Self::Sphere(s) => s.normal(p),
            Self::Cylinder(s) => s.normal(p, part),
            Self::Cone(s) => s.normal(p, part),
            Self::Torus(s) => s.normal(p),
            _ => self.surface(p, part).normal,
        }
    }
}

/// Whether a shape encloses a volume.
trait Solidity {
    const SOLID: bool;
}

impl<T: Solidity> Solidity for Arc<T> {
    const SOLID: bool = T::SOLID;
}

/// A length a shape may have: greater than 0 and at most 1e15, which NaN is not. `what` names it in the
/// message.
#[inline]
fn positive(what: &str, x: f64) -> Result<(), SceneError> {
    if x > 0.0 && x <= 1e15 {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "{what} must be greater than 0 and at most 1e15, not {x}"
    )))
}

/// The u that all round shapes share: once around Y from -Z over -X to +Z at 0.5 and on over +X, so that a
/// picture is unmirrored from outside.
fn u_around_y(x: f64, z: f64) -> f64 {
    math::atan2(x, z) / (2.0 * PI) + 0.5
}

/// uv of the disk of `radius` cut out of a picture, for coordinates to the right and up from its center.
fn cap_uv(right: f64, up: f64, radius: f64) -> DVec2 {
    let uv = DVec2::new(right, up) / (2.0 * radius) + 0.5;
    uv.clamp(DVec2::ZERO, DVec2::ONE)
}
