//! Surfaces made of triangles: each is worked out here and becomes a [`Mesh`](crate::scene::Mesh) like any other.
//!
//! Meshes that are closed are so by their indices: each edge belongs to two triangles, which run along it in opposite
//! directions. So they have an inside whatever rounding does.

mod allowance;
mod bezier;
mod curve;
mod heights;
mod parametric;
mod refine;
mod subdivide;
mod text;

pub use allowance::Allowance;
pub use bezier::BezierPatches;
pub use curve::{Curve, CurveEnd, CurveKind};
pub use heights::{HeightField, Heights};
pub use parametric::Parametric;
pub use subdivide::{Cage, Scheme};
pub use text::{Align, Font, Text, TextSize, VerticalAlign};

#[cfg(test)]
mod suite;
