//! What may stand between a point and an area light, found once for all rays from one to the other.

use super::{
    SurfacePoint, World,
    level::{Level, Primitive},
    outline::{Forecast, Outline},
};
use crate::{
    accel::{Exact, Four, LeafKind, NONE, Shaft},
    math::{DAffine3, DVec3},
    shape::Shape,
};

/// All that rays from a point to an area light may meet: a few primitives of the root, none of them an instance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FewObstacles {
    indices: [u32; Self::CAPACITY],
    len: usize,
    /// What they look like, and whether they are opaque.
    outlines: [(Outline, bool); Self::CAPACITY],
}

impl FewObstacles {
    /// Beyond this a search of the tree is cheaper for each ray.
    const CAPACITY: usize = 3;

    fn push(&mut self, level: &Level, index: u32) -> bool {
        // What takes long to test had better have its box tested before.
        let slow = matches!(level.primitive(index), Primitive::Shape(i)
        if level.shapes.get(i as usize).is_some_and(|placed| {
            !matches!(
                placed.shape,
                Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Disk(_) | Shape::Plane(_) | Shape::Polygon(_)
            )
        }));
        let Some(place) = self.indices.get_mut(self.len).filter(|_| !slow) else {
            return false;
        };
        *place = index;
        self.len += 1;
        true
    }

    /// What rays meet of them that go these ways from the point they were found for, as far as that is certain.
    #[inline(always)]
    pub(crate) fn forecast<L: Exact>(&self, lanes: L, ways: &[Four<L>; 3]) -> Forecast<L> {
        let mut forecast = Forecast::clear(lanes);
        for (outline, is_opaque) in self.outlines.iter().take(self.len) {
            forecast = forecast.and(lanes, outline.look(lanes, ways), *is_opaque);
        }
        forecast
    }

    pub(super) fn indices(&self) -> &[u32] {
        self.indices.get(..self.len).unwrap_or_default()
    }
}

/// A point from which an area is seen.
struct View<'a> {
    apex: DVec3,
    corners: [DVec3; 4],
    /// Size of the numbers `apex` was computed from.
    scale: f64,
    /// Primitive on which `apex` lies.
    start: u64,
    /// The whole area is on the outer side of the plane that touches the surface in `apex`.
    leaves_outwards: bool,
    level: &'a Level<'a>,
    shaft: Shaft,
}

impl World<'_> {
    /// What rays may meet from a point on the primitive `start` to the parallelogram with these corners; `None`
    /// where that may be more than a few things, or takes longer to find out than it can save this many rays.
    pub(crate) fn obstacles(
        &self,
        at: &SurfacePoint<'_>,
        start: u64,
        corners: [DVec3; 4],
        rays: usize,
    ) -> Option<FewObstacles> {
        let mut few = FewObstacles::default();
        let level = self.root()?;
        let apex = at.position;
        let view = View {
            apex,
            corners,
            scale: at.scale,
            start,
            leaves_outwards: at.from_front
                && corners.iter().all(|corner| {
                    let towards = *corner - apex;
                    at.geometric_normal.dot(towards) > 1e-6 * towards.length()
                }),
            level,
            shaft: Shaft::new(apex, corners),
        };
        let known = level
            .unbounded
            .iter()
            .all(|&index| !view.may_meet(index) || few.push(level, index))
            && level
                .bvh
                .touching(&view.shaft, 2 * rays, |leaf| match leaf.kind() {
                    LeafKind::Triangles => level.triangle_blocks[leaf.range()]
                        .iter()
                        .flat_map(|block| block.ids)
                        .filter(|&id| id != NONE)
                        .all(|id| !view.may_meet(id) || few.push(level, id)),
                    LeafKind::Spheres => level.sphere_blocks[leaf.range()]
                        .iter()
                        .flat_map(|block| block.ids)
                        .filter(|&id| id != NONE)
                        .map(|id| level.triangles.len() as u32 + id)
                        .all(|index| !view.may_meet(index) || few.push(level, index)),
                    LeafKind::Cuboids => level.cuboid_blocks[leaf.range()]
                        .iter()
                        .flat_map(|block| block.ids)
                        .filter(|&id| id != NONE)
                        .all(|index| !view.may_meet(index) || few.push(level, index)),
                    LeafKind::Others => level.bvh.others(leaf).iter().all(|&index| {
                        !matches!(level.primitive(index), Primitive::Instance(_))
                            && (!view.may_meet(index) || few.push(level, index))
                    }),
                });
        known.then(|| {
            for (outline, index) in few.outlines.iter_mut().zip(few.indices).take(few.len) {
                // From its own surface it looks like nothing that is certain.
                if u64::from(index) != start {
                    let seen = Outline::new(level, index, apex, at.scale, &corners);
                    *outline = (seen, !level.may_be_transparent(index));
                }
            }
            few
        })
    }
}

impl View<'_> {
    /// False where no ray from the point to the area meets a primitive whose box the shaft touches.
    fn may_meet(&self, index: u32) -> bool {
        let is_start = self.start == u64::from(index);
        match self.level.primitive(index) {
            // Its one crossing is the start.
            Primitive::Triangle(_) if is_start => false,
            Primitive::Triangle(i) => self.shaft.touches_triangle(self.level.corners(i)),
            Primitive::Sphere(_) if is_start => !self.leaves_outwards,
            Primitive::Sphere(i) => self
                .level
                .spheres
                .get(i as usize)
                .is_none_or(|sphere| self.shaft.touches_sphere(sphere.center, sphere.radius)),
            Primitive::Shape(i) => self.level.shapes.get(i as usize).is_none_or(|placed| {
                match &placed.shape {
                    Shape::Plane(_) => self.may_cross_plane(&placed.object_from_level, is_start),
                    // A convex solid is all on one side of the plane that touches it.
                    Shape::Cuboid(_) if is_start && self.leaves_outwards => false,
                    Shape::Cuboid(cuboid) => {
                        let level_from_object = placed.object_from_level.inverse();
                        let (m, half) = (level_from_object.matrix3, cuboid.half());
                        let edges = [m.x_axis * half.x, m.y_axis * half.y, m.z_axis * half.z];
                        self.shaft.touches_cuboid(level_from_object.translation, edges)
                    }
                    Shape::Sphere(_) | Shape::Cylinder(_) | Shape::Cone(_) => {
                        !(is_start && self.leaves_outwards)
                    }
                    _ => true,
                }
            }),
            Primitive::Instance(_) => true,
        }
    }

    /// Whether rays may cross the plane y = 0 of a space.
    fn may_cross_plane(&self, object_from_level: &DAffine3, is_start: bool) -> bool {
        let height = |p: DVec3| object_from_level.transform_point3(p).y;
        let row = object_from_level.matrix3.row(1);
        // Far more than the rounding of a height, whose terms are at most this large.
        let size = crate::math::max_abs(self.apex).max(self.scale);
        let size = self
            .corners
            .iter()
            .fold(size, |s, c| s.max(crate::math::max_abs(*c)));
        let slack = 1e-12
            * ((row.x.abs() + row.y.abs() + row.z.abs()) * size + object_from_level.translation.y.abs());
        let heights = self.corners.map(height);
        let above = heights.iter().all(|h| *h > slack);
        let below = heights.iter().all(|h| *h < -slack);
        if !(above || below) {
            return true;
        }
        let h = height(self.apex);
        if if above { h > slack } else { h < -slack } {
            return false;
        }
        // A crossing counts for the plane itself from 1e-7 of the scale on (`Probe::from_surface`). A ray to a
        // point of height H rises from the apex' |h| to 0 within |h| / |H| of its length.
        let least = heights.iter().fold(f64::INFINITY, |m, h| m.min(h.abs()));
        let longest = self
            .corners
            .iter()
            .fold(0.0, |m: f64, c| m.max((*c - self.apex).length()));
        !(is_start && (h.abs() + slack) * longest < 1e-8 * self.scale * least)
    }
}
