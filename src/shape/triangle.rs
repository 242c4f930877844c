//! The watertight ray-triangle test.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, in f64: corners are moved
//! to the ray's origin and sheared so that the ray runs along one axis; three edge functions then decide. Two
//! triangles that share an edge evaluate the same products with opposite signs, so no ray slips between them.
//! There is no fused multiply-add in it, so the signs are those on every machine.
