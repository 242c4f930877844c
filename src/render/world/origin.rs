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
