//! Objects in their groups: which block they stand in, under which matrix.

use std::fmt;

use super::{
    Writer,
    calls::Load,
    order::{self, NEVER, next_uses, own_lights},
};
use crate::scene::{CsgOp, Geometry, Group, Object, ROOT_GROUP, TransformId, literal::Text};

/// A matrix that is saved because more objects than one stand under it.
struct Saved {
    transform: TransformId,
    /// The next object under it.
    next: u32,
}

impl Writer<'_> {
    /// Lights, objects and the groups among them.
    pub(super) fn group(&mut self, group: &Group, bound: usize) -> fmt::Result {
        let next = next_uses(group, &mut self.latest);
        let mut lights = own_lights(self.scene, group).into_iter();
        self.lights(group, lights.next())?;
        let mut saved: Vec<Saved> = Vec::new();
        for (object, next) in group.objects.iter().zip(next) {
            while self.order.next_group < bound && !self.order.has_come(self.scene, object) {
                let id = self.order.next_define(self.scene, bound);
                self.define(id)?;
            }
            match object.geometry {
                Geometry::Csg(id, op) => self.csg(&mut saved, id.index(), op)?,
                Geometry::Moving(id) => self.moving(&mut saved, (object, next), id.index())?,
                _ => self.placed(&mut saved, object, next)?,
            }
            self.order.see(self.scene, object);
            if order::brought(self.scene, object).is_some() {
                self.lights(group, lights.next())?;
            }
        }
        self.restore(&mut saved, 0)
    }

    pub(super) fn defines_before(&mut self, bound: usize) -> fmt::Result {
        while self.order.next_group < bound {
            let id = self.order.next_define(self.scene, bound);
            self.define(id)?;
        }
        Ok(())
    }

    fn define(&mut self, id: usize) -> fmt::Result {
        let scene = self.scene;
        let (Some(group), Some(name)) = (scene.groups.get(id), self.names.get(id)) else {
            self.order.next_group = id + 1;
            return Ok(());
        };
        debug_assert!(id != ROOT_GROUP.index());
        if group.is_in_place() {
            self.order.next_group = id + 1;
            return Ok(());
        }
        let head = format!("define {} {{", Text(name));
        self.line(|out| out.write_str(&head), group.loc)?;
        let outside = self.material.take();
        self.inside(group, id, false)?;
        self.material = outside;
        self.call("}")
    }

    /// What stands between the braces of a group's block: under a matrix of its own where it begins `from_identity`, and
    /// under that around it where it does not.
    fn inside(&mut self, group: &Group, id: usize, from_identity: bool) -> fmt::Result {
        self.depth += 1;
        if from_identity {
            self.call("loadIdentity();")?;
        }
        self.group(group, id)?;
        self.defines_before(id)?;
        self.depth -= 1;
        self.order.next_group = id + 1;
        Ok(())
    }

    /// The block of a solid that is put together.
    fn csg(&mut self, saved: &mut Vec<Saved>, id: usize, op: CsgOp) -> fmt::Result {
        let scene = self.scene;
        let Some(group) = scene.groups.get(id) else {
            return Ok(());
        };
        let needed = saved.iter().rposition(|s| s.next != NEVER).map_or(0, |i| i + 1);
        self.restore(saved, needed)?;
        self.line(|out| write!(out, "{op} {{"), group.loc)?;
        let outside = self.material;
        self.inside(group, id, !saved.is_empty())?;
        self.material = outside;
        self.call("}")
    }

    /// The block of what moves together, under the matrix of the place from which it moves.
    fn moving(&mut self, saved: &mut Vec<Saved>, (object, next): (&Object, u32), id: usize) -> fmt::Result {
        let scene = self.scene;
        let Some((group, motion)) = scene
            .groups
            .get(id)
            .and_then(|group| Some((group, group.motion?)))
        else {
            return Ok(());
        };
        let load = self.matrix(saved, object, next)?;
        let outside = load.map_or(String::new(), |load| format!("group {{ {load} "));
        self.line(|out| write!(out, "{outside}moving {motion} {{"), group.loc)?;
        let material = self.material;
        self.inside(group, id, false)?;
        self.material = material;
        self.call(if outside.is_empty() { "}" } else { "} }" })
    }

    /// An object under its matrix.
    fn placed(&mut self, saved: &mut Vec<Saved>, object: &Object, next: u32) -> fmt::Result {
        let load = self.matrix(saved, object, next)?;
        self.material(object)?;
        self.object(load.as_deref(), object)
    }

    /// Makes the matrix of an object the current one, where others after it stand under it, too; the call that does so
    /// for it alone where they do not.
    fn matrix(
        &mut self,
        saved: &mut Vec<Saved>,
        object: &Object,
        next: u32,
    ) -> Result<Option<String>, fmt::Error> {
        let id = object.transform;
        if let Some(at) = saved.iter().rposition(|s| s.transform == id) {
            self.restore(saved, at + 1)?;
            if let Some(saved) = saved.last_mut() {
                saved.next = next;
            }
            return Ok(None);
        }
        let needed = saved.iter().rposition(|s| s.next != NEVER).map_or(0, |i| i + 1);
        self.restore(saved, needed)?;
        if id == TransformId::IDENTITY {
            return Ok((!saved.is_empty()).then_some("loadIdentity();".to_owned()));
        }
        let load = Load(&self.scene.world_from_object(object)).to_string();
        if next == NEVER {
            return Ok(Some(load));
        }
        self.call(format_args!("pushTransform(); {load}"))?;
        self.depth += 1;
        saved.push(Saved { transform: id, next });
        Ok(None)
    }

    /// Goes back to where `depth` matrices are saved.
    fn restore(&mut self, saved: &mut Vec<Saved>, depth: usize) -> fmt::Result {
        while saved.len() > depth {
            saved.pop();
            self.depth = self.depth.saturating_sub(1);
            self.call("popTransform();")?;
        }
        Ok(())
    }
}
