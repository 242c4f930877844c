//! Shapes: what a ray meets in object space.
//!
//! A shape knows its own space only. Placing, materials and acceleration are the scene's and the renderer's.
//! Each file holds one shape: its contract, its checks, its bounds, its crossings with a ray, its surface.
//!
//! A shape answers with *all* points where the ray's whole line crosses its surface, in order. From them the
//! nearest hit follows, the parts of the line inside a solid, and an exact answer to the question that haunts
//! ray tracers: a ray that starts on the surface knows which crossing is its own start.

mod blob;
mod capsule;
mod cone;
mod crossings;
mod cuboid;
mod custom;
mod cylinder;
mod disk;
mod lathe;
mod pieces;
mod planar;
mod plane;
mod polygon;
mod prism;
mod quadric;
mod roots;
mod rounded;
mod sdf;
mod span;
mod sphere;
mod sphere_sweep;
#[cfg(test)]
pub(crate) mod suite;
mod superellipsoid;
mod torus;
pub mod triangle;
pub(crate) mod triangles;
mod triangulate;
mod upright;

pub use crate::custom::Custom;
pub use blob::{Blob, BlobPart};
pub use capsule::Capsule;
pub use cone::Cone;
pub use crossings::{Crossing, CrossingSink, Crossings};
pub use cuboid::Cuboid;
pub use custom::CustomShape;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use lathe::Lathe;
pub use plane::Plane;
pub use polygon::Polygon;
pub use prism::Prism;
pub use quadric::Quadric;
pub use rounded::RoundedBox;
pub use sdf::{Field, Isosurface, Sdf};
pub use sphere::Sphere;
pub use sphere_sweep::SphereSweep;
pub use superellipsoid::Superellipsoid;
pub use torus::Torus;
pub use triangulate::triangulate;

use std::sync::Arc;

use crate::{
    math::{self, Bounds3, DAffine3, DVec2, DVec3, PI, Ray},
    scene::SceneError,
};

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
        ///
        /// ```
        /// use rtscript::{DVec3, math::Ray, shape::{Crossings, Shape, Sphere}};
        /// let ball = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)?);
        /// let ray = Ray { origin: DVec3::new(0.0, 0.0, 5.0), dir: DVec3::NEG_Z };
        /// let mut crossings = Crossings::default();
        /// ball.crossings(&ray, &mut crossings);
        /// // In at the front, out at the back.
        /// let [enter, leave] = crossings.as_slice() else { panic!("two crossings") };
        /// assert_eq!((enter.t, leave.t), (4.0, 6.0));
        /// assert_eq!(ball.surface(ray.at(enter.t), enter.part).normal.normalize(), DVec3::Z);
        /// assert!(ball.is_solid() && ball.name() == "sphere" && ball.bounds().is_some());
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
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

            /// Whether a copy of it has more to free than itself.
            #[inline(always)]
            pub(crate) fn owns_memory(&self) -> bool {
                match self {
                    $(Self::$name(_) => std::mem::needs_drop::<$inner>(),)*
                    Self::Custom(_) => true,
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
                    $(Self::$name(s) => s.is_solid(),)*
                    Self::Custom(s) => s.is_solid(),
                }
            }

            /// Adds all crossings of the ray's whole line (behind its origin too) to `out`.
            #[inline]
            pub fn crossings(&self, ray: &Ray, out: &mut impl CrossingSink) {
                match self {
                    $(Self::$name(s) => s.crossings(ray, out),)*
                    Self::Custom(s) => custom::crossings(&**s, ray, out),
                }
            }

            /// Normal and texture coordinates at a point `p` on part `part` of the surface.
            #[must_use]
            pub fn surface(&self, p: DVec3, part: u32) -> Surface {
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
    /// See [`Isosurface`].
    Isosurface(Arc<Isosurface>) = "isosurface";
    /// See [`Capsule`].
    Capsule(Capsule) = "capsule";
    /// See [`RoundedBox`].
    RoundedBox(RoundedBox) = "roundedBox";
    /// See [`Superellipsoid`].
    Superellipsoid(Superellipsoid) = "superellipsoid";
    /// See [`Quadric`].
    Quadric(Arc<Quadric>) = "quadric";
    /// See [`Prism`].
    Prism(Arc<Prism>) = "prism";
    /// See [`Lathe`].
    Lathe(Arc<Lathe>) = "lathe";
    /// See [`SphereSweep`].
    SphereSweep(Arc<SphereSweep>) = "sphereSweep";
    /// See [`Blob`].
    Blob(Arc<Blob>) = "blob";
}

impl Shape {
    /// A box around it where `to_from_object` takes it, tight for spheres; `None` where it has no end.
    ///
    /// ```
    /// use rtscript::{DVec3, math::DAffine3, shape::{Shape, Sphere}};
    /// let ball = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)?);
    /// // A turned ball is as wide as before, where the turned box around it would be wider.
    /// let turned = DAffine3::from_rotation_z(0.7);
    /// let size = ball.bounds_under(&turned).map(|b| b.size());
    /// assert!(size.is_some_and(|size| (size - DVec3::splat(2.0)).length() < 1e-9));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn bounds_under(&self, to_from_object: &DAffine3) -> Option<Bounds3> {
        match self {
            Self::Sphere(sphere) => Some(sphere.bounds_under(to_from_object)),
            shape => shape.bounds().map(|b| b.transformed(to_from_object)),
        }
    }

    /// How many pieces it is made of, which counts for [`Limits::primitives`](crate::Limits::primitives).
    pub(crate) fn pieces(&self) -> usize {
        match self {
            Self::Prism(s) => s.pieces(),
            Self::Lathe(s) => s.pieces(),
            Self::SphereSweep(s) => s.pieces(),
            Self::Blob(s) => s.parts().len(),
            _ => 1,
        }
    }

    /// The normal of [`Shape::surface`] alone: the texture coordinates of round shapes are angles, which cost
    /// more than the rest.
    #[inline]
    pub(crate) fn normal(&self, p: DVec3, part: u32) -> DVec3 {
        match self {
            Self::Sphere(s) => s.normal(p),
            Self::Cylinder(s) => s.normal(p, part),
            Self::Cone(s) => s.normal(p, part),
            Self::Torus(s) => s.normal(p),
            Self::Capsule(s) => s.normal(p),
            Self::RoundedBox(s) => s.normal(p),
            Self::Superellipsoid(s) => s.normal(p),
            Self::Blob(s) => s.normal(p),
            _ => self.surface(p, part).normal,
        }
    }
}

/// Whether a shape encloses a volume.
trait Solidity {
    const SOLID: bool;

    /// [`Solidity::SOLID`], but where it depends on the shape's parameters.
    fn is_solid(&self) -> bool {
        Self::SOLID
    }
}

impl<T: Solidity> Solidity for Arc<T> {
    const SOLID: bool = T::SOLID;

    fn is_solid(&self) -> bool {
        T::is_solid(self)
    }
}

/// A length a shape may have: greater than 0 and at most 1e15, which NaN is not. `what` names it in the
/// message.
#[inline]
fn positive(what: impl std::fmt::Display, x: f64) -> Result<(), SceneError> {
    if x > 0.0 && x <= 1e15 {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "{what} must be greater than 0 and at most 1e15, not {x}"
    )))
}

/// A coordinate a shape may have: within 1e15, which neither NaN nor infinity is. `what` names it in the message.
fn coordinate(what: impl std::fmt::Display, x: f64) -> Result<(), SceneError> {
    if x.abs() <= 1e15 {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "{what} must be a finite number within 1e15, not {x}"
    )))
}

/// Checks the coordinates of a point that a shape is made from; `what` names the point, `axes` its coordinates.
fn coordinates<const N: usize>(
    what: impl std::fmt::Display,
    point: &[f64; N],
    axes: [&str; N],
) -> Result<(), SceneError> {
    let mut each = point.iter().zip(axes);
    each.try_for_each(|(x, axis)| coordinate(format_args!("{what}, {axis},"), *x))
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
