//! One level: the primitives of a group in the group's space.

use std::borrow::Cow;

use super::{csg::Solid, query::Probe};
use crate::{
    accel::{Bvh, Corners, Cuboids, Spheres, Triangles, prefetch},
    math::{Bounds3, DAffine3, DMat3, DVec3, Ray},
    scene::{AnimatedTransform, GroupId, MeshId, TriangleId},
    shape::{Cuboid, Shape, Sphere, triangle::ordered},
};

/// The primitives of one group. Their numbers run through the kinds in the order of the fields: triangles,
/// spheres, shapes, instances.
#[derive(Debug, Default)]
pub(crate) struct Level<'s> {
    /// The group it was made from; `None` for a mesh placed several times.
    pub(super) group: Option<GroupId>,
    /// What it is more than things that stand side by side.
    pub(super) rare: Option<Rare>,
    /// The scene's own where one mesh is all there is and stands where it was made.
    pub(super) vertices: Cow<'s, [DVec3]>,
    pub(super) triangles: Cow<'s, [[u32; 3]]>,
    /// Where each run of triangles comes from, in ascending order of `first`.
    pub(super) runs: Vec<TriangleRun>,
    pub(super) spheres: Vec<PlacedSphere>,
    pub(super) shapes: Vec<PlacedShape>,
    pub(super) instances: Vec<Instance>,
    pub(super) bvh: Bvh,
    pub(super) triangle_blocks: Vec<Triangles>,
    pub(super) sphere_blocks: Vec<Spheres>,
    pub(super) cuboid_blocks: Vec<Cuboids>,
    /// Largest coordinate of triangles and spheres.
    pub(super) extent: f64,
    /// Largest coordinate of boxes.
    pub(super) cuboid_extent: f32,
    /// Primitives without bounds, which every ray must try.
    pub(super) unbounded: Vec<u32>,
    /// A box around everything; `None` where something has no end.
    pub(super) bounds: Option<Bounds3>,
    /// One bit for each primitive that may let light through; empty where none does.
    pub(super) transparent: Vec<u64>,
    /// Some primitive in the tree lets no light through, or is an instance.
    pub(super) has_opaque_tree: bool,
    /// Numbers that this level's primitives take, those of placed levels included.
    pub(super) numbers: u64,
}

/// What a level may be more than things that stand side by side.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rare {
    /// What is in it makes one solid.
    Solid(Solid),
    /// It moves while the shutter is open, in the space of what places it; never the root.
    Moving(AnimatedTransform),
}

/// Consecutive triangles of one object.
#[derive(Debug)]
pub(super) struct TriangleRun {
    /// First triangle of the run in its level.
    pub(super) first: u32,
    /// Index of the object in its group, or [`Level::NO_OBJECT`] in the level of a mesh placed several times.
    pub(super) object: u32,
    pub(super) source: TriangleSource,
    /// The object's matrix mirrors, so that the corners turn the other way.
    pub(super) mirrored: bool,
    /// What takes a mesh's normals into the level, where they are not the same there.
    pub(super) normal_matrix: Option<Box<DMat3>>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum TriangleSource {
    Single(TriangleId),
    Mesh(MeshId),
}

/// A sphere that is round in its level's space.
#[derive(Debug)]
pub(super) struct PlacedSphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) object: u32,
}

impl PlacedSphere {
    /// Where the ray crosses the sphere, which has this number; `None` where it does not, or starts on it and leaves it.
    #[inline(always)]
    pub(super) fn roots(&self, ray: &Ray, probe: &Probe, number: u64) -> Option<(f64, f64)> {
        let (center, radius) = (self.center, self.radius);
        if probe.starts_on(number) && Sphere::is_left(center, radius, ray, probe.least_beyond_start(number)) {
            return None;
        }
        Sphere::roots(center, radius, ray)
    }
}

/// Any other shape, with the way into its space.
#[derive(Debug)]
pub(super) struct PlacedShape {
    pub(super) shape: Shape,
    pub(super) object_from_level: DAffine3,
    pub(super) object: u32,
}

impl PlacedShape {
    /// False where the ray certainly crosses the shape nowhere within (`least`, `most`], found without a division;
    /// of planes only, which every ray must try.
    #[inline]
    pub(super) fn may_cross(&self, ray: &Ray, least: f64, most: f64) -> bool {
        if !matches!(self.shape, Shape::Plane(_)) {
            return true;
        }
        // Height above the plane and its growth, to the bit as the crossing itself has them.
        let DAffine3 {
            matrix3: m,
            translation,
        } = &self.object_from_level;
        let along = |v: DVec3| m.x_axis.y * v.x + m.y_axis.y * v.y + m.z_axis.y * v.z;
        let (height, growth) = (along(ray.origin) + translation.y, along(ray.dir));
        let leaves = least >= 0.0 && height * growth > 0.0;
        // Twice the distance, for the rounding of products and quotient.
        let too_far = height.abs() > 2.0 * least.abs().max(most.abs()) * growth.abs();
        let too_near = 2.0 * height.abs() < least * growth.abs();
        !(leaves || too_far || too_near)
    }
}

/// A level placed in another.
#[derive(Debug)]
pub(super) struct Instance {
    /// Index of the placed level.
    pub(super) level: u32,
    pub(super) object: u32,
    pub(super) inner_from_outer: DAffine3,
    /// Number of its first primitive, counted from the placing level's first.
    pub(super) first_number: u64,
}

/// What a primitive number of a level stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Primitive {
    Triangle(u32),
    Sphere(u32),
    Shape(u32),
    Instance(u32),
}

impl Level<'_> {
    pub(super) const NO_OBJECT: u32 = u32::MAX;

    /// How what is in it makes one solid; `None` where things stand side by side.
    #[inline]
    pub(super) fn solid(&self) -> Option<Solid> {
        match self.rare {
            Some(Rare::Solid(solid)) => Some(solid),
            Some(Rare::Moving(_)) | None => None,
        }
    }

    /// Whether an object is cut away from the solid that the level is, so that its surface is seen from within.
    #[inline]
    pub(super) fn is_cut_by(&self, object: u32) -> bool {
        self.solid().is_some_and(|solid| solid.op.cuts(object))
    }

    /// Primitives, an instance counted as one.
    pub(super) fn primitives(&self) -> usize {
        self.triangles.len() + self.spheres.len() + self.shapes.len() + self.instances.len()
    }

    #[inline]
    pub(super) fn primitive(&self, index: u32) -> Primitive {
        let mut rest = index as usize;
        if rest < self.triangles.len() {
            return Primitive::Triangle(index);
        }
        rest -= self.triangles.len();
        if rest < self.spheres.len() {
            return Primitive::Sphere(rest as u32);
        }
        rest -= self.spheres.len();
        if rest < self.shapes.len() {
            return Primitive::Shape(rest as u32);
        }
        Primitive::Instance((rest - self.shapes.len()) as u32)
    }

    /// The primitive with this number, and the number left over inside it where it is an instance.
    pub(super) fn by_number(&self, number: u64) -> (Primitive, u64) {
        let own = (self.primitives() - self.instances.len()) as u64;
        if number < own {
            return (self.primitive(number as u32), 0);
        }
        let after = self
            .instances
            .partition_point(|instance| instance.first_number <= number);
        let index = after.saturating_sub(1);
        let first = self
            .instances
            .get(index)
            .map_or(0, |instance| instance.first_number);
        (Primitive::Instance(index as u32), number - first)
    }

    /// The corners of a triangle, where they lie in memory.
    #[inline(always)]
    pub(super) fn corners_of(&self, triangle: u32) -> [&DVec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        let at = |i: u32| &self.vertices[i as usize];
        [at(a), at(b), at(c)]
    }

    #[inline]
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.corners_of(triangle).map(|corner| *corner)
    }

    /// The corners of a block's triangle, with their axes in this order.
    #[inline(always)]
    pub(super) fn corners_in(&self, block: &Triangles, lane: usize, axes: [usize; 3]) -> [[f64; 3]; 3] {
        if block.corners[lane] == Corners::HERE {
            return block.exact(lane, axes);
        }
        let [a, b, c] = self.numbers_in(block, lane);
        [
            ordered(axes, &self.vertices[a as usize]),
            ordered(axes, &self.vertices[b as usize]),
            ordered(axes, &self.vertices[c as usize]),
        ]
    }

    /// The numbers of the corners of a block's triangle.
    #[inline(always)]
    fn numbers_in(&self, block: &Triangles, lane: usize) -> [u32; 3] {
        let known = block.corners[lane].get();
        known.unwrap_or_else(|| self.triangles[block.ids[lane] as usize])
    }

    /// Asks for the memory of the corners of a block's triangle, where they are not in the block.
    #[inline(always)]
    pub(super) fn ask_for_corners_in(&self, block: &Triangles, lane: usize) {
        if block.corners[lane] != Corners::HERE {
            self.ask_for_corners(self.numbers_in(block, lane));
        }
    }

    /// Asks for the memory of a triangle's corners before they are needed.
    #[inline(always)]
    pub(super) fn ask_for_corners(&self, corners: [u32; 3]) {
        for corner in corners {
            prefetch(self.vertices.as_ptr().wrapping_add(corner as usize));
        }
    }

    /// The boxes that stand in blocks: index of the primitive, shape and the way into its space.
    pub(super) fn cuboids(&self) -> impl Iterator<Item = (u32, &Cuboid, &DAffine3)> {
        let first = (self.triangles.len() + self.spheres.len()) as u32;
        (first..)
            .zip(&self.shapes)
            .filter_map(|(index, placed)| match &placed.shape {
                Shape::Cuboid(cuboid) => Some((index, cuboid, &placed.object_from_level)),
                _ => None,
            })
    }

    /// A box that stands in blocks.
    pub(super) fn cuboid(&self, index: u32) -> Option<(&Cuboid, &DAffine3)> {
        let Primitive::Shape(i) = self.primitive(index) else {
            return None;
        };
        let placed = self.shapes.get(i as usize)?;
        match &placed.shape {
            Shape::Cuboid(cuboid) => Some((cuboid, &placed.object_from_level)),
            _ => None,
        }
    }

    /// Whether there are blocks of triangles or spheres.
    #[inline]
    pub(super) fn has_blocks(&self) -> bool {
        !(self.triangle_blocks.is_empty() && self.sphere_blocks.is_empty())
    }

    /// Where the blocks of one kind begin, and the bytes of one: what a search asks for before it needs it.
    #[inline(always)]
    pub(super) fn block_memory(&self) -> (*const u8, usize) {
        if !self.triangle_blocks.is_empty() {
            (self.triangle_blocks.as_ptr().cast(), size_of::<Triangles>())
        } else if !self.sphere_blocks.is_empty() {
            (self.sphere_blocks.as_ptr().cast(), size_of::<Spheres>())
        } else {
            (self.cuboid_blocks.as_ptr().cast(), size_of::<Cuboids>())
        }
    }

    /// Whether a primitive may let light through. An instance answers for itself.
    #[inline]
    pub(super) fn may_be_transparent(&self, index: u32) -> bool {
        self.transparent
            .get(index as usize / 64)
            .is_some_and(|bits| bits >> (index % 64) & 1 == 1)
    }

    /// How much light a primitive can block, roughly.
    #[inline]
    pub(super) fn blocking_area(&self, index: u32, bounds: Option<Bounds3>) -> f64 {
        match self.primitive(index) {
            Primitive::Triangle(i) => {
                let [a, b, c] = self.corners(i);
                (b - a).cross(c - a).length()
            }
            _ => bounds.map_or(0.0, |b| {
                let size = b.size();
                size.x * size.y + size.y * size.z + size.z * size.x
            }),
        }
    }

    /// The run that holds a triangle.
    pub(super) fn run(&self, triangle: u32) -> Option<&TriangleRun> {
        let after = self.runs.partition_point(|run| run.first <= triangle);
        self.runs.get(after.checked_sub(1)?)
    }

    pub(super) fn bytes(&self) -> usize {
        owned(&self.vertices)
            + owned(&self.triangles)
            + size_of_val(&*self.runs)
            + size_of_val(&*self.spheres)
            + size_of_val(&*self.shapes)
            + size_of_val(&*self.instances)
            + size_of_val(&*self.transparent)
            + size_of_val(&*self.triangle_blocks)
            + size_of_val(&*self.sphere_blocks)
            + size_of_val(&*self.cuboid_blocks)
            + self.bvh.bytes()
    }
}

/// Bytes that are not the scene's.
#[allow(clippy::ptr_arg, reason = "the question is which of the two it is")]
fn owned<T: Clone>(values: &Cow<'_, [T]>) -> usize {
    match values {
        Cow::Borrowed(_) => 0,
        Cow::Owned(values) => size_of_val(&**values),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{
        super::{query::Probe, tests::vector},
        *,
    };
    use crate::{
        math::rotation,
        shape::{Crossings, Plane},
    };

    proptest! {
        /// Rays that start on a plane, but for rounding, or anywhere, and leave it steeply or along it.
        #[test]
        fn a_plane_that_is_left_out_has_no_crossing_that_counts(
            (axis, place, origin, dir) in (vector(1.0), vector(9.0), vector(9.0), vector(1.0)),
            (angle, height, growth) in (0.0..360.0f64, -18.0..1.0f64, -18.0..1.0f64),
            (is_start, below, down) in any::<(bool, bool, bool)>(),
            most in prop_oneof![Just(f64::INFINITY), 1e-9..20.0f64],
        ) {
            prop_assume!(axis.length() > 1e-3);
            let level_from_object = DAffine3::from_mat3_translation(rotation(axis.normalize(), angle), place);
            let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
            let origin = DVec3::new(origin.x, sign(below) * crate::math::pow(10.0, height), origin.z);
            let dir = DVec3::new(dir.x, sign(down) * crate::math::pow(10.0, growth), dir.z).normalize();
            let ray = Ray::new(
                level_from_object.transform_point3(origin),
                level_from_object.transform_vector3(dir),
            );
            let placed = PlacedShape {
                shape: Shape::Plane(Plane),
                object_from_level: level_from_object.inverse(),
                object: 0,
            };
            let number = 7;
            let probe = Probe::from_surface(ray, if is_start { number } else { 8 }, 0.0);
            let mut crossings = Crossings::default();
            placed.shape.crossings(&ray.transformed(&placed.object_from_level), &mut crossings);
            let t_min = probe.drop_start(number, &mut crossings);
            let counts = crossings.first_within(t_min, f64::INFINITY).is_some_and(|c| c.t <= most);
            prop_assert!(!counts || placed.may_cross(&ray, probe.least(number), most));
        }
    }
}
