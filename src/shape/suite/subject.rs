//! What the shared properties are asked of: a shape in its own space, or whatever else lines cross.

use super::{
    super::{Crossings, Shape},
    Rng, all_crossings, edges, is_curved, reference,
};
use crate::math::{Bounds3, DVec3, Ray, max_abs};

/// A crossing of a line with a surface, and the surface there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub(crate) t: f64,
    /// A piece of the surface without an edge or a corner inside of it: a triangle, a side of a solid.
    pub(crate) patch: (u64, u32),
    /// Outwards, of any length.
    pub(crate) normal: DVec3,
}

/// Anything with a surface.
pub(crate) trait Subject: Sync {
    /// For messages.
    fn label(&self) -> String;

    /// A box around it; `None` where it has no end.
    fn bounds(&self) -> Option<Bounds3>;

    /// Half the longest edge of the bounds and their center; of what has no end, those of its interesting part.
    fn extent(&self) -> (f64, DVec3);

    /// Whether a line crosses it an even number of times.
    fn is_solid(&self) -> bool;

    /// All crossings of the ray's whole line, in ascending order.
    fn crossings(&self, ray: &Ray) -> Vec<Met>;

    /// What a ray meets first that starts where `ray` met `start` and goes on: its ray parameter from there, and the patch.
    /// No crossing is nearer to another than `near`.
    fn onwards(&self, ray: &Ray, start: &Met, near: f64) -> Option<(f64, (u64, u32))>;

    /// Whether a point is inside, asked in another way than by crossings of its line; `None` where it is too near to the
    /// surface to say.
    fn contains(&self, p: DVec3) -> Option<bool>;

    /// How near the point of a crossing is to the surface and its bounds, in units of the rounding of a point of the ray.
    fn rounding(&self) -> f64;

    /// Distance to the nearest edge or tip that lies within a patch; infinite where there is none.
    fn edge_distance(&self, p: DVec3) -> f64;

    /// A point where two patches meet, or two pieces of a curve, or where a texture has its seam.
    fn edge_point(&self, rng: &mut Rng) -> DVec3;

    /// How deep in it a point is that is inside, roughly.
    fn depth(&self, p: DVec3) -> f64;

    /// Whether a ray from a point inside of it meets the surface, as a picture asks for it.
    fn holds(&self, ray: &Ray) -> bool;
}

/// A shape, `s` times as large as a unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alone<'a> {
    pub(super) shape: &'a Shape,
    pub(super) s: f64,
}

impl Subject for Alone<'_> {
    fn label(&self) -> String {
        format!("{:?}", self.shape)
    }

    fn bounds(&self) -> Option<Bounds3> {
        self.shape.bounds()
    }

    fn extent(&self) -> (f64, DVec3) {
        self.bounds()
            .map_or((self.s, DVec3::ZERO), |b| (max_abs(b.size()) * 0.5, b.center()))
    }

    fn is_solid(&self) -> bool {
        self.shape.is_solid()
    }

    fn crossings(&self, ray: &Ray) -> Vec<Met> {
        let found = all_crossings(self.shape, ray).into_iter();
        let surface = found.map(|c| Met {
            t: c.t,
            patch: (0, c.part),
            normal: self.shape.normal(ray.at(c.t), c.part),
        });
        surface.collect()
    }

    fn onwards(&self, ray: &Ray, start: &Met, near: f64) -> Option<(f64, (u64, u32))> {
        let mut rest = Crossings::default();
        let onwards = Ray::new(ray.at(start.t), ray.dir);
        self.shape.crossings(&onwards, &mut rest);
        rest.drop_start(near);
        let next = rest.first_within(0.0, f64::INFINITY)?;
        Some((next.t, (0, next.part)))
    }

    fn contains(&self, p: DVec3) -> Option<bool> {
        let (size, center) = self.extent();
        let depth = reference::distance(self.shape, p);
        (depth.abs() >= 1e-12 * (size + max_abs(center) + max_abs(p))).then_some(depth < 0.0)
    }

    fn rounding(&self) -> f64 {
        // A curve's point is rounded once more for each of its coordinates and its frame.
        if is_curved(self.shape) { 5.0 } else { 1.0 }
    }

    fn edge_distance(&self, p: DVec3) -> f64 {
        reference::edge_distance(self.shape, p)
    }

    fn edge_point(&self, rng: &mut Rng) -> DVec3 {
        edges::of_shape(self.shape, rng)
    }

    fn depth(&self, p: DVec3) -> f64 {
        -reference::distance(self.shape, p)
    }

    fn holds(&self, _: &Ray) -> bool {
        true
    }
}
