//! Boxes around what a level holds: what its tree is built from, and what the level itself is known by.

use rayon::prelude::*;

use super::{
    super::level::{Level, Primitive},
    Compiler, PIECE,
};
use crate::{
    accel::{self, Box32},
    math::Bounds3,
};

/// Triangles between the question for a triangle's corners and their use.
const AHEAD: usize = 16;

pub(super) fn union(primitives: &[accel::Primitive]) -> Box32 {
    primitives
        .par_chunks(PIECE)
        .map(accel::Primitive::around)
        .reduce(|| Box32::EMPTY, |a, b| a.union(&b))
}

impl Compiler<'_, '_> {
    /// What the builder knows of a primitive.
    pub(super) fn boxed(&self, level: &Level, index: u32) -> accel::Primitive {
        if self.interrupt.is_stopped() || (index as usize).is_multiple_of(PIECE) && self.interrupt.poll() {
            return accel::Primitive::new(index, Box32::EMPTY, 0.0);
        }
        if let Some(corners) = level.triangles.get(index as usize + AHEAD) {
            level.ask_for_corners(*corners);
        }
        // Where there are many, they are triangles: nothing else is asked of those.
        let bounds = match (index as usize) < level.triangles.len() {
            true => Some(Bounds3::around(level.corners(index))),
            false => self.bounds(level, index),
        };
        let area = level.blocking_area(index, bounds) as f32;
        let around = bounds.map_or(Box32::EVERYTHING, |b| Box32::around(&b));
        accel::Primitive::new(index, around, area).with_cuboid(level.cuboid(index).is_some())
    }

    /// A box around each object of a level; `None` for what has no end.
    #[cold]
    #[inline(never)]
    pub(super) fn parts(&self, level: &Level, count: u32) -> Vec<Option<Bounds3>> {
        let mut parts = vec![Some(Bounds3::EMPTY); count as usize];
        for index in 0..level.primitives() as u32 {
            let object = match level.primitive(index) {
                Primitive::Triangle(i) => level.run(i).map_or(0, |run| run.object),
                Primitive::Sphere(i) => level.spheres[i as usize].object,
                Primitive::Shape(i) => level.shapes[i as usize].object,
                Primitive::Instance(i) => level.instances[i as usize].object,
            };
            if let Some(part) = parts.get_mut(object as usize) {
                let both = part.as_ref().zip(self.bounds(level, index));
                *part = both.map(|(a, b)| a.union(&b));
            }
        }
        parts
    }

    /// A box around a primitive in its level's space; `None` where it has no end.
    #[inline]
    fn bounds(&self, level: &Level, index: u32) -> Option<Bounds3> {
        match level.primitive(index) {
            Primitive::Triangle(i) => Some(Bounds3::around(level.corners(i))),
            Primitive::Sphere(i) => {
                let sphere = &level.spheres[i as usize];
                Some(Bounds3::new(
                    sphere.center - sphere.radius,
                    sphere.center + sphere.radius,
                ))
            }
            Primitive::Shape(i) => {
                let placed = &level.shapes[i as usize];
                let level_from_object = placed.object_from_level.inverse();
                placed.shape.bounds_under(&level_from_object)
            }
            Primitive::Instance(i) => {
                let instance = &level.instances[i as usize];
                let inner = &self.levels[instance.level as usize];
                inner
                    .bounds
                    .map(|b| b.transformed(&instance.inner_from_outer.inverse()))
            }
        }
    }
}
