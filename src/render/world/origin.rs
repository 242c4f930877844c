//! From a hit back to the calls that made what was hit.

use super::{World, level::Primitive};
use crate::scene::{GroupId, Object};

impl<'s> World<'s> {
    /// The objects that lead to the primitive with this number: the instances on the way, outermost first, then the
    /// object that the primitive belongs to. Empty where there is no such number.
    #[must_use]
    pub fn objects_of(&self, number: u64) -> Vec<&'s Object> {
        let object = |(group, index): (GroupId, u32)| {
            let group = self.scene.groups.get(group.index())?;
            group.objects.get(index as usize)
        };
        self.places_of(number).into_iter().filter_map(object).collect()
    }

    /// [`World::objects_of`] as groups and places in them.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::Ray, render::World};
    /// let mut b = Builder::new();
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.sphere(DVec3::X * 5.0, 1.0)?;
    /// let scene = b.finish().value;
    /// let world = World::compile(&scene)?;
    /// let ray = Ray::new(DVec3::new(5.0, 5.0, 0.0), DVec3::NEG_Y);
    /// let (_, number) = world.nearest_t(&ray, 100.0).expect("it hits the second ball");
    /// let places = world.places_of(number);
    /// assert_eq!(places.iter().map(|(_, index)| *index).collect::<Vec<_>>(), [1]);
    /// assert_eq!(world.objects_of(number).len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn places_of(&self, mut number: u64) -> Vec<(GroupId, u32)> {
        let mut path = Vec::new();
        let mut level = self.root();
        while let Some(current) = level {
            let (primitive, rest) = current.by_number(number);
            let (object, inner) = match primitive {
                Primitive::Triangle(i) => (current.run(i).map(|run| run.object), None),
                Primitive::Sphere(i) => (current.spheres.get(i as usize).map(|s| s.object), None),
                Primitive::Shape(i) => (current.shapes.get(i as usize).map(|s| s.object), None),
                Primitive::Instance(i) => match current.instances.get(i as usize) {
                    Some(instance) => (Some(instance.object), Some(instance.level)),
                    None => (None, None),
                },
            };
            path.extend(object.and_then(|object| Some((current.group?, object))));
            level = inner.and_then(|level| self.levels.get(level as usize));
            number = rest;
        }
        path
    }
}
