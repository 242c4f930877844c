//! How much of the world a ray goes through, counted the same way on every machine.

use super::{
    World,
    level::{Level, Primitive},
    query::Probe,
    trace::range,
};
use crate::{
    accel::{Child, Control, Lanes, LeafKind, Ray32, RayBox, Visitor},
    math::Ray,
};

impl World<'_> {
    /// Leaves whose boxes a ray touches before `t_max`, those of instances too. A thing without bounds is a leaf.
    pub(crate) fn leaves_touched(&self, probe: &Probe, t_max: f64) -> u64 {
        self.root()
            .map_or(0, |root| self.touched_in(root, &probe.ray, probe, t_max))
    }

    fn touched_in(&self, level: &Level<'_>, ray: &Ray, probe: &Probe, t_max: f64) -> u64 {
        let mut count = Count {
            world: self,
            level,
            ray,
            probe,
            t_max,
            leaves: 0,
        };
        for &index in &level.unbounded {
            count.other(index);
        }
        let ray_box = RayBox::new(&Ray32::new(ray), level.bvh.extent());
        let range = range(probe.t_min, t_max);
        level
            .bvh
            .traverse_everywhere(&ray_box, range.possible, range.bound, &mut count);
        count.leaves
    }
}

struct Count<'a, 's> {
    world: &'a World<'s>,
    level: &'a Level<'s>,
    ray: &'a Ray,
    probe: &'a Probe,
    t_max: f64,
    leaves: u64,
}

impl Count<'_, '_> {
    fn other(&mut self, index: u32) {
        self.leaves += 1;
        if let Primitive::Instance(i) = self.level.primitive(index)
            && let Some(instance) = self.level.instances.get(i as usize)
            && let Some(inner) = self.world.levels.get(instance.level as usize)
        {
            let ray = self.ray.transformed(&instance.inner_from_outer);
            let ray = self.world.entering(inner, ray);
            self.leaves += self.world.touched_in(inner, &ray, self.probe, self.t_max);
        }
    }
}

impl Visitor for Count<'_, '_> {
    fn leaf<L: Lanes>(&mut self, _: L, leaf: Child, _: &mut f32) -> Control {
        match leaf.kind() {
            LeafKind::Others => {
                let level = self.level;
                level.bvh.others(leaf).iter().for_each(|&index| self.other(index));
            }
            LeafKind::Triangles | LeafKind::Spheres | LeafKind::Cuboids => self.leaves += 1,
        }
        Control::Continue
    }

    fn blocks(&self) -> (*const u8, usize) {
        self.level.block_memory()
    }
}
