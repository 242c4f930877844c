//! A whole line through a scene, for tests.

use super::{super::World, Events, Hit, Probe};
use crate::{math::Ray, shape::suite::Met};

impl World<'_> {
    /// All crossings of a ray's whole line with the surfaces of solids and closed meshes, in ascending order: of things that
    /// overlap without being put together, those that are seen from outside.
    pub(in super::super) fn crossings_of_line(&self, ray: &Ray) -> Vec<Met> {
        let Some(root) = self.root() else {
            return Vec::new();
        };
        let mut events = Events::new(root);
        self.spans(root, 0, ray, &Probe::from_space(*ray), &mut events);
        let met = events.slice().iter().map(|event| {
            let hit = Hit {
                t: event.t,
                number: event.number,
                u: event.u,
                v: event.v,
                part: event.part,
            };
            let at = self.surface(&hit, ray).expect("a hit has a surface");
            let side = if at.from_front { 1.0 } else { -1.0 };
            Met {
                t: event.t,
                patch: (event.number, event.part),
                normal: at.geometric_normal * side,
            }
        });
        met.collect()
    }
}
